"""raypool.load(): scenes from files, built-in ones and dicts; and the places of what is refused."""

import copy
import json
import os
import pathlib
import pickle
import sys
import tempfile
import unittest

import numpy as np
import raypool
from place import SCENE, SOURCE

sys.path.append(str(SOURCE / "tests/scenes"))
from validate_schema import patched


def hash_of(scene):
    return raypool.render(scene, spp=2, width=16, threads=1)[1]["hash"]


class Load(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory(prefix="raypool-test-")
        self.addCleanup(scratch.cleanup)
        self.folder = pathlib.Path(scratch.name)

    def refusal(self, *arguments, **keywords):
        with self.assertRaises(raypool.InputError) as caught:
            raypool.load(*arguments, **keywords)
        self.assertIsInstance(caught.exception, ValueError)
        return caught.exception

    def test_gives_a_scene_that_says_what_it_is(self):
        scene = raypool.load("cornell")
        self.assertIsInstance(scene, raypool.Scene)
        self.assertEqual((scene.name, scene.width, scene.height), ("cornell", 400, 400))
        self.assertIn("cornell", repr(scene))
        self.assertIn("400 x 400", repr(scene))
        described = json.loads((SOURCE / "scenes/cornell.json").read_text())
        self.assertEqual(scene.description, described["description"])
        kinds = [shape["type"] for shape in described["shapes"]]
        self.assertEqual(scene.counts["quads"], kinds.count("quad"))
        self.assertEqual(scene.counts["materials"], len(described["materials"]))
        self.assertEqual(scene.counts["triangles"], 0)
        with self.assertRaises(AttributeError):
            scene.width = 3

    def test_knows_every_builtin_scene(self):
        names = {path.stem for path in (SOURCE / "scenes").glob("*.json") if not path.stem.endswith(".schema")}
        self.assertEqual(set(raypool.scenes()), names)
        self.assertGreater(raypool.load("paper").counts["spheres"], 480)

    def test_reads_files_by_any_kind_of_path(self):
        file = self.folder / "ball.json"
        file.write_text(json.dumps(SCENE))
        for path in (file, str(file)):
            self.assertEqual(raypool.load(path).name, "ball")
        odd = os.fsdecode(os.fsencode(self.folder) + b"/b\xffll.json")
        pathlib.Path(odd).write_text(json.dumps(SCENE))
        self.assertEqual(raypool.load(odd).width, 8)
        pathlib.Path(odd).write_text("{")
        self.assertIn(":1:2", str(self.refusal(odd)))

    def test_makes_the_same_scene_of_a_dict_and_of_a_file_of_the_same_text(self):
        file = self.folder / "ball.json"
        file.write_text(json.dumps(SCENE))
        self.assertEqual(hash_of(raypool.load(SCENE)), hash_of(file))
        self.assertEqual(raypool.load(SCENE).name, "scene")
        self.assertEqual(raypool.load(SCENE, name="ball").name, "ball")
        moved = copy.deepcopy(SCENE)
        moved["shapes"][0]["center"] = [0, 0.5, 0]
        self.assertNotEqual(hash_of(moved), hash_of(SCENE))

    def test_takes_tuples_and_numpy_in_a_dict(self):
        scene = copy.deepcopy(SCENE)
        scene["image"] = {"width": np.int64(8), "height": np.int32(6)}
        scene["background"] = (0.25, 0.5, 1)
        scene["shapes"][0]["center"] = np.zeros(3, np.float32)
        scene["shapes"][0]["radius"] = np.float32(1)
        self.assertEqual(hash_of(scene), hash_of(SCENE))

    def test_looks_for_the_files_of_a_dict_below_its_folder(self):
        file = SOURCE / "scenes/textures/textures.json"
        scene = json.loads(file.read_text())
        self.assertEqual(hash_of(raypool.load(scene, folder=file.parent)), hash_of(file))
        self.assertRegex(self.refusal(scene, folder=self.folder).place, "^/textures/[a-z]+/file$")
        self.assertIn("folder", str(self.refusal("paper", folder=self.folder)))
        self.assertIn("name", str(self.refusal("paper", name="other")))

    def test_refuses_each_broken_rule_with_the_place(self):
        shared = json.loads((SOURCE / "tests/scenes/refusals.json").read_text())
        count = 0
        for case in shared["cases"]:
            scene = patched(shared["base"], case["patch"])
            if not isinstance(scene, dict):
                continue
            with self.subTest(case["says"]):
                error = self.refusal(scene, name="a.json", folder=SOURCE / "scenes/textures")
                self.assertEqual(str(error), "a.json: " + case["says"])
                place = case["says"].split(": must ")[0]
                self.assertEqual(error.place, place if place.startswith("/") else None)
            count += 1
        self.assertGreater(count, 150)

    def test_refuses_what_json_has_not_with_the_place(self):
        for value, got in ((float("nan"), "nan"), (float("inf"), "inf"), (np.float64("-inf"), "-inf"),
                           (object(), "a object"), ({1: 2}, "1"), (b"x", "a bytes")):
            scene = copy.deepcopy(SCENE)
            scene["shapes"][1]["a/b~"] = [0, value]
            error = self.refusal(scene)
            self.assertEqual(error.place, "/shapes/1/a~1b~0/1")
            self.assertTrue(str(error).startswith("scene: /shapes/1/a~1b~0/1: must "), error)
            self.assertTrue(str(error).endswith(f", got {got}"), error)
        endless = copy.deepcopy(SCENE)
        endless["shapes"].append(endless["shapes"])
        self.assertIn("must not nest deeper than 32 levels", str(self.refusal(endless)))

    def test_refuses_what_is_no_json_with_line_and_column(self):
        file = self.folder / "bad.json"
        file.write_text('{\n  "a": }')
        error = self.refusal(file)
        self.assertEqual(error.place, "2:8")
        self.assertTrue(str(error).startswith(f"{file}:2:8: syntax error"), error)
        again = pickle.loads(pickle.dumps(error))
        self.assertEqual((str(again), again.place), (str(error), error.place))

    def test_refuses_what_is_not_there(self):
        error = self.refusal("no_such_scene")
        self.assertIn("no_such_scene: no such file, and no built-in scene of that name", str(error))
        self.assertIsNone(error.place)
        self.refusal("paper\0.json")
        with self.assertRaises(TypeError):
            raypool.load(3)


if __name__ == "__main__":
    unittest.main()
