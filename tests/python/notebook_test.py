"""The example of docs/python.md runs, from its first cell to its last, and leaves its pictures."""

import os
import pathlib
import re
import runpy
import tempfile
import unittest

from place import SOURCE

os.environ["MPLBACKEND"] = "Agg"
os.environ.setdefault("OMP_NUM_THREADS", "2")
EXAMPLE = SOURCE / "docs/examples/notebook.py"


class Notebook(unittest.TestCase):
    def test_runs_and_leaves_its_pictures(self):
        here = os.getcwd()
        self.addCleanup(os.chdir, here)
        with tempfile.TemporaryDirectory(prefix="raypool-test-") as folder:
            os.chdir(folder)
            made = runpy.run_path(str(EXAMPLE))
            pictures = {path.name: path.read_bytes() for path in pathlib.Path(folder).iterdir()}
            os.chdir(here)
        self.assertEqual(set(pictures), {"load.png", "sweep.png", "image.png"})
        for name, content in pictures.items():
            self.assertTrue(content.startswith(b"\x89PNG") and len(content) > 2000, name)
        sweep = made["sweep"]
        self.assertEqual(sweep.groupby(["spp", "sampler"])["hash"].nunique().max(), 1)  # whatever the engine
        self.assertGreater(sweep["mpaths_per_s"].min(), 0)

    def test_shows_the_load_in_ten_lines(self):
        cells = re.split(r"^# %%", EXAMPLE.read_text(), flags=re.MULTILINE)[1:]
        load = next(cell for cell in cells if "load.png" in cell)
        lines = [line for line in load.splitlines()[1:] if line.strip() and not line.lstrip().startswith("#")]
        self.assertLessEqual(len(lines), 10)


if __name__ == "__main__":
    unittest.main()
