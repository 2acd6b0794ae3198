"""raypool.render(): the command's images, figures and refusals."""

import ast
import inspect
import json
import pathlib
import re
import tempfile
import unittest

import numpy as np
import raypool
from place import COMMAND, SCENE, SOURCE, run_command
from raypool import _core

GOLDEN = json.loads((SOURCE / "tests/equivalence/golden_hashes.json").read_text())


class Image(unittest.TestCase):
    def golden(self, name, scene=None, **options):
        """Renders as tests/equivalence/golden_test.cpp does, by every engine and in both precisions."""
        loaded = raypool.load(scene or name)
        size = {"width": 40, "height": loaded.height * 40 // loaded.width}
        options = {"light_sampling": "none", "spp": 8, "depth": 50, **options}
        for engine in raypool.engines():
            for precision in ("float", "double"):
                with self.subTest(name, engine=engine, precision=precision):
                    _, report = raypool.render(loaded, engine=engine, precision=precision, **size, **options)
                    self.assertEqual(report["hash"], GOLDEN[name][precision])

    def test_is_the_committed_one(self):
        for name in ("one_sphere", "paper", "mirror_corridor"):
            self.golden(name)
        self.golden("small_lamp", light_sampling="mis")
        self.golden("instances", SOURCE / "scenes/meshes/instances.json", light_sampling="mis")
        self.golden("cornell_by_sobol_and_roulette", "cornell", light_sampling="mis", sampler="sobol", roulette=True)
        self.golden("glass_stack_split", "glass_stack", split_depth=2)

    def test_is_an_array_of_linear_floats(self):
        image, report = raypool.render("paper", width=32, height=20, spp=2)
        self.assertEqual((image.dtype, image.shape), (np.float32, (20, 32, 3)))
        self.assertTrue(image.flags.c_contiguous and image.flags.writeable)
        self.assertAlmostEqual(float(image.mean(dtype=float)), report["sums"]["mean_radiance"], 6)
        image[:] = 0  # it is the caller's
        sky = raypool.render(SCENE, depth=1, spp=1, light_sampling="none")[0]
        self.assertTrue(np.array_equal(sky[0, 0], np.float32([0.25, 0.5, 1])), "row 0 is at the top")
        self.assertTrue(np.array_equal(sky[5, 0], np.float32([0, 0, 0])))

    def test_has_the_size_that_is_asked_for(self):
        for size, shape in (({}, (6, 8)), ({"width": 4}, (3, 4)), ({"height": 3}, (3, 4)),
                            ({"width": 5, "height": 7}, (7, 5))):
            image, report = raypool.render(SCENE, spp=1, **size)
            self.assertEqual(image.shape, (*shape, 3))
            self.assertEqual((report["settings"]["height"], report["settings"]["width"]), shape)
        self.assertEqual(raypool.load(SCENE).width, 8)

    def test_of_a_crop_is_a_part_of_the_whole(self):
        whole, _ = raypool.render("cornell", width=20, spp=4)
        for crop in ((3, 5, 13, 9), "3,5,13,9"):
            calls = []
            part, report = raypool.render("cornell", width=20, spp=4, crop=crop,
                                          progress=lambda *paths: calls.append(paths))
            self.assertTrue(np.array_equal(part, whole[5:9, 3:13]))
            self.assertEqual((report["paths"], calls[-1]), (160, (160, 160)))

    def test_has_channels_beside_it_where_they_are_asked_for(self):
        plain, report = raypool.render("cornell", width=20, spp=6)
        self.assertNotIn("aovs", report)
        image, with_aovs = raypool.render("cornell", width=20, spp=6, aovs=True)
        self.assertTrue(np.array_equal(image, plain))
        self.assertEqual(with_aovs["hash"], report["hash"])
        aovs = with_aovs["aovs"]
        self.assertEqual({name: values.shape for name, values in aovs.items()},
                         {name: (20, 20) for name in ("A", "Z", "samples")} |
                         {name: (20, 20, 3) for name in ("N", "albedo", "variance")})
        self.assertTrue((aovs["samples"] == 6).all() and aovs["A"][10, 10] == 1 and aovs["A"].min() < 1)
        red, green, blue = aovs["albedo"][10, 2]  # the wall at the left, which is green and faces -x, to the right here
        self.assertGreater(green, 2 * max(red, blue))
        self.assertLess(aovs["N"][10, 2, 0], -0.99)
        part = raypool.render("cornell", width=20, spp=6, aovs=True, crop=(3, 5, 13, 9))[1]["aovs"]
        for name, values in part.items():
            self.assertTrue(np.array_equal(values, aovs[name][5:9, 3:13]), name)

    def test_of_parts_is_that_of_the_whole(self):
        whole = raypool.render(SCENE, spp=6)[0].astype(float)
        parts = [raypool.render(SCENE, spp=6, samples=samples)[0].astype(float) for samples in ((0, 2), "2:6")]
        self.assertLess(np.abs(whole - (2 * parts[0] + 4 * parts[1]) / 6).max(), 1e-6)

    def test_stops_where_the_target_error_is_reached(self):
        image, report = raypool.render("half_sky", width=32, target_error=0.008, spp=5000)
        self.assertLessEqual(report["adaptive"]["rmse_estimate"], 0.008)
        self.assertLess(report["adaptive"]["samples_per_pixel"]["most"], 5000)
        truth, _ = raypool.render("half_sky", width=32, spp=4096, seed=7)
        self.assertLess(np.sqrt(np.mean((image.astype(float) - truth) ** 2)), 0.012)


class Report(unittest.TestCase):
    def test_adds_up(self):
        _, report = raypool.render("paper", width=40, spp=4, threads=3, engine="recursive", seed=2**64 - 1)
        threads = report["threads"]
        self.assertEqual(len(threads), 3)
        self.assertEqual(report["paths"], 40 * 23 * 4)
        for figure in ("paths", "segments"):
            self.assertEqual(sum(thread[figure] for thread in threads), report[figure])
        for thread in threads:
            self.assertGreaterEqual(min(thread["busy_s"], thread["wait_s"]), 0)
        seconds = report["seconds"]
        self.assertGreater(seconds["total"], seconds["read"] + seconds["compile"] + seconds["render"] - 1e-6)
        self.assertAlmostEqual(report["mpaths_per_s"], report["paths"] * 1e-6 / seconds["render"])
        self.assertEqual(report["settings"]["seed"], 2**64 - 1)
        self.assertIn("motion", report["features"])
        self.assertIn("version", report["environment"])
        counted = raypool.render("paper", width=40, spp=1, count_work=True)[1]
        self.assertGreater(sum(thread["box_tests"] for thread in counted["threads"]), 0)
        self.assertGreater(len(counted["rounds"]), 0)

    def test_of_a_number_of_threads_leaves_the_next_render_its_own(self):
        before = raypool.render(SCENE, spp=1)[1]["settings"]["threads"]
        self.assertEqual(raypool.render(SCENE, spp=1, threads=before + 2)[1]["settings"]["threads"], before + 2)
        self.assertEqual(raypool.render(SCENE, spp=1)[1]["settings"]["threads"], before)


class Refusal(unittest.TestCase):
    CASES = ({"spp": 0}, {"spp": 2.5}, {"spp": True}, {"width": 0}, {"width": 65537},
             {"height": 0}, {"crop": (5, 0, 5, 9)}, {"crop": "x"}, {"depth": -1}, {"seed": -1},
             {"engine": "fast"}, {"engine": ""}, {"sampler": "halton"}, {"precision": "half"}, {"threads": 5000},
             {"schedule": "dynamic,0"}, {"grain": "tile:0"}, {"light_sampling": "all"}, {"split_depth": 99},
             {"target_error": -1}, {"target_error": 0.1, "spp": 1}, {"samples": (3, 2)}, {"samples": "x"},
             {"engine": "recursive", "pool_rays": 64}, {"pool_rays": "2TB"}, {"pool_scope": "none"},
             {"schedule": "balanced", "grain": "line"}, {"pool_scope": "thread", "accumulator": "fast"},
             {"samples": (0, 2), "target_error": 0.1}, {"pool_batch": 4}, {"stage_width": "scalar", "intersect": "pairs"})

    @unittest.skipUnless(COMMAND, "no command `raypool` to compare with")
    def test_has_the_words_of_the_command(self):
        for options in self.CASES:
            with self.subTest(options), self.assertRaises(raypool.InputError) as caught:
                raypool.render("one_sphere", **options)
            arguments = []
            for name, value in options.items():
                if isinstance(value, tuple):
                    value = (":" if name == "samples" else ",").join(map(str, value))
                option = "--" + name.replace("_", "-")
                arguments.append(option if value is True else f"{option}={value}")
            said = run_command("render", "one_sphere", *arguments)
            self.assertEqual(said.returncode, 2, options)
            text = said.stderr.replace(" (see --help)", "").replace(",gpu}", "}")  # an engine of the command alone
            self.assertEqual(text, f"raypool: {caught.exception}\n", options)

    def test_names_the_option(self):
        for options in self.CASES:
            with self.subTest(options), self.assertRaises(raypool.InputError) as caught:
                raypool.render("one_sphere", **options)
            self.assertIn(caught.exception.place, ["--" + name.replace("_", "-") for name in options])
        with self.assertRaises(TypeError):
            raypool.render("one_sphere", output="image.png")


@unittest.skipUnless(COMMAND, "no command `raypool` to compare with")
class Command(unittest.TestCase):
    def test_makes_the_same_image_and_the_same_record(self):
        cases = ({}, {"engine": "recursive", "threads": 2, "schedule": "dynamic,4", "grain": "tile:8"},
                 {"precision": "double", "sampler": "sobol", "seed": 5}, {"roulette": True, "depth": 12},
                 {"pool_scope": "shared", "pool_rays": "64KB", "count_work": True}, {"target_error": 0.05},
                 {"height": 20, "crop": "1,2,11,12"})
        for options in cases:
            image, report = raypool.render("cornell", **{"width": 30, "spp": 40, **options})
            arguments = [f"--{name.replace('_', '-')}" + ("" if value is True else f"={value}")
                         for name, value in options.items()]
            with self.subTest(options), tempfile.TemporaryDirectory(prefix="raypool-test-") as folder:
                done = run_command("render", "cornell", "--width=30", "--spp=40", "-o", "i.pfm", "--stats", "s.json",
                                   *arguments, folder=folder)
                self.assertIn(done.returncode, (0, 1), done.stderr)  # 1: the target is missed
                stats = json.loads((pathlib.Path(folder) / "s.json").read_text())
                data = (pathlib.Path(folder) / "i.pfm").read_bytes().split(b"\n", 3)[3]
            self.assertEqual(stats.keys(), report.keys())
            for part in ("hash", "paths", "segments", "settings", "features", "sums", "samples_done", "adaptive"):
                self.assertEqual(report.get(part), stats.get(part), part)
            self.assertEqual(report["seconds"].keys(), stats["seconds"].keys())
            pixels = np.frombuffer(data, "<f4").reshape(image.shape)[::-1]  # a PFM file begins at the bottom
            self.assertTrue(np.array_equal(pixels, image))

    def test_has_every_option_of_render(self):
        offered = set(re.findall(r"--([a-z][a-z-]*)", run_command("render", "--help").stdout))
        ours = {name.replace("_", "-") for name in inspect.signature(raypool.render).parameters}
        self.assertEqual(ours - offered, {"scene", "progress"})


class Types(unittest.TestCase):
    def test_of_the_compiled_part_are_declared(self):
        folder = pathlib.Path(raypool.__file__).parent
        self.assertTrue((folder / "py.typed").is_file())
        tree = ast.parse((folder / "_core.pyi").read_text())
        declared = {node.name: node for node in tree.body if isinstance(node, (ast.FunctionDef, ast.ClassDef))}
        there = {name for name in dir(_core) if not name.startswith("_")}
        self.assertEqual(set(declared), there)
        attributes = {node.name for node in declared["Scene"].body if isinstance(node, ast.FunctionDef)}
        self.assertEqual(attributes, {name for name in dir(_core.Scene) if not name.startswith("_")})

    def test_and_docstrings_are_there(self):
        for name in raypool.__all__:
            thing = getattr(raypool, name)
            if callable(thing) and getattr(thing, "__module__", "").startswith("raypool"):
                self.assertGreater(len(thing.__doc__ or ""), 20, name)
        parameters = inspect.signature(raypool.render).parameters
        for name in parameters:
            self.assertTrue(re.search(rf"\b{name}\b", raypool.render.__doc__) or
                            list(parameters).index(name) in range(list(parameters).index("pool_scope"),
                                                                  list(parameters).index("accumulator")), name)


if __name__ == "__main__":
    unittest.main()
