"""The layers of the house: a table of what each folder includes, and a failure for an arrow upward.

Run as `layers_test.py SOURCE_FOLDER`.
"""
import collections
import pathlib
import re
import sys
import unittest

SOURCE = pathlib.Path(sys.argv.pop(1))

CORE = ["core/base", "core/math", "core/image", "core/scene", "core/geometry", "core/shading", "core/film",
        "core/runtime"]
ENGINES = ["recursive", "wavefront", "gpu"]
BENCH = ["bench/naive", "bench/accuracy", "bench/peers", "bench/stability", "bench/studies", "bench"]

# What a folder may include, beside itself.
ALLOWED = {folder: set(CORE[:i]) for i, folder in enumerate(CORE)}
ALLOWED.update({engine: set(CORE) for engine in ENGINES})
ALLOWED["cluster"] = set(CORE)
ALLOWED["bench/naive"] = {"core/base", "core/math", "core/geometry", "core/shading"}
ALLOWED["bench/peers"] = {*CORE, *ENGINES}
ALLOWED["bench/accuracy"] = {*CORE, *ENGINES}
ALLOWED["bench/stability"] = {*CORE, *ENGINES, "bench/naive"}
ALLOWED["bench/studies"] = {*CORE, *ENGINES, "cluster", *BENCH[:4]}
ALLOWED["bench"] = {*CORE, *ENGINES}
ALLOWED["cli"] = {*CORE, *ENGINES, "cluster", "bench/accuracy", "bench/peers", "bench/studies"}
ALLOWED["python"] = {*CORE, *ENGINES, "cli"}

# Libraries that only these folders may include, so that no other needs them.
LIBRARIES = {"png.h": {"core/image"}, "Imf": {"core/image"}, "mpi.h": {"cluster"}, "embree3/": {"bench/peers"}, "cuda_runtime": {"gpu"},
             "immintrin.h": {"core/math"}, "xmmintrin.h": {"core/math"}, "arm_neon.h": {"core/math"},
             "CLI/": {"cli"}, "pybind11/": {"python"},
             "xxhash.h": {"core/base", "core/scene", "core/film", "bench/accuracy"},
             "boost/": {"core/image", "bench/accuracy"}}


def folder_of(path):
    """The folder of the table that holds a file named from the root; None where there is none."""
    return next((folder for folder in sorted(ALLOWED, key=len, reverse=True) if path.startswith(folder + "/")), None)


def includes():
    """(file, folder, what it includes) for each include of the product's C++ files."""
    for top in sorted(SOURCE.iterdir()):
        if not top.is_dir() or top.name.startswith((".", "build")) or top.name in ("docs", "tests"):
            continue
        for path in sorted(top.rglob("*")):
            if path.suffix not in (".h", ".cpp", ".cu"):
                continue
            name = path.relative_to(SOURCE).as_posix()
            for included in re.findall(r'^\s*#\s*include\s+[<"]([^">]+)', path.read_text(), re.MULTILINE):
                yield name, folder_of(name), included


class Layers(unittest.TestCase):
    def test_include_only_those_above_them(self):
        table = collections.defaultdict(set)
        wrong = []
        for name, folder, included in includes():
            self.assertIsNotNone(folder, f"{name} is in no layer")
            to = folder_of(included)
            if to is None or to == folder:
                continue
            table[folder].add(to)
            if to not in ALLOWED[folder]:
                wrong.append(f"{name} includes {included}")
        for folder in ALLOWED:
            print(f"{folder:16} -> {', '.join(sorted(table[folder])) or 'nothing of raypool'}")
        self.assertEqual(wrong, [])

    def test_keep_libraries_to_themselves(self):
        wrong = [f"{name} includes <{included}>" for name, folder, included in includes()
                 for library, owners in LIBRARIES.items() if included.startswith(library) and folder not in owners]
        self.assertEqual(wrong, [])

    def test_hold_all_files(self):
        self.assertGreater(len({name for name, _, _ in includes()}), 200)
        self.assertEqual([path.name for path in (SOURCE / "core").iterdir() if path.suffix in (".h", ".cpp")], [])


if __name__ == "__main__":
    unittest.main()
