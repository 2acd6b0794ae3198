"""What the newest committed results of each study say is what the analysis makes of their rows."""
import importlib
import json
import re
import unittest

import support
from analysis import data, page, report, reproduction

RESULTS = support.SOURCE / "docs/results/2026-11-28-amd-epyc-2-cores"  # the paper's experiments among them
LATER = [support.SOURCE / "docs/results" / name for name in ("2026-11-29-amd-epyc-2-cores", "2026-11-30-amd-epyc-2-cores")]

# These runs are older than the record of facts, which were so on that machine.
FACTS = {"framebuffer": {"second_level_cache_bytes": 2**20, "simulated_first_level": "32768,8,64",
                         "simulated_last_level": "1048576,16,64"},
         "scaling": {"cores": 2}}


def said_by(text):
    """What a page says, and its points say: not how it looks, and where versions of matplotlib draw what."""
    text = re.sub(r"<style>.*?</style>|<script>.*?</script>|<meta http-equiv[^>]*>", "", text, flags=re.DOTALL)
    return re.sub(r"<svg.*?</svg>", lambda found: "\n".join(re.findall('aria-label="([^"]*)"', found[0])), text, flags=re.DOTALL)


class ResultsTest(unittest.TestCase):
    maxDiff = None

    def test_are_what_their_rows_say(self):
        runs = {}
        for folder in sorted(folder for machine in [RESULTS, *LATER] for folder in machine.iterdir()):
            if not folder.is_dir():
                continue
            with self.subTest(str(folder)):
                run, rows = data.read(folder)
                written = {key: run[key] for key in ("findings", "pictures", "tables", "notes")}
                module = importlib.import_module("analysis." + run["study"].replace("-", "_"))
                said = module.summarise({"facts": FACTS.get(run["study"], {}), **run}, rows).as_json()
                self.assertEqual(json.loads(json.dumps(said)), written)
                self.assertEqual(page.summary_page({**run, **said}), (folder / "summary.md").read_text())
                self.assertEqual(said_by(report.study_page(folder, run, rows)), said_by((folder / "index.html").read_text()))
                self.assertLessEqual({picture["name"] for picture in run["pictures"]}, set(module.PICTURES))
                runs[run["study"]] = {**run, **said}
        paper = [runs[study] for study in ("load", "schedules", "scaling", "pool", "framebuffer")]
        self.assertEqual(reproduction.reproduction_page(paper), (RESULTS / "summary.md").read_text())


if __name__ == "__main__":
    unittest.main()
