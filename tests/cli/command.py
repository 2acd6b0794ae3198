"""Runs the raypool command in a folder of its own. The tests beside this file are called with the path of the command."""

import copy
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

SCENE = {
    "description": "A grey ball on a mirror.",
    "image": {"width": 8, "height": 6},
    "camera": {"look_from": [0, 1, 5], "look_at": [0, 0, 0]},
    "background": [0.25, 0.5, 1],
    "textures": {"tiles": {"type": "checker_uv", "even": [0.1, 0.1, 0.1], "odd": [0.9, 0.9, 0.9], "scale": 0.1}},
    "materials": {
        "grey": {"type": "diffuse", "albedo": [0.7, 0.7, 0.7]},
        "tiled": {"type": "diffuse", "albedo": "tiles"},
        "mirror": {"type": "metal", "albedo": [1, 1, 1], "fuzz": 0},
        "glass": {"type": "dielectric", "ior": 1.5},
    },
    "shapes": [
        {"type": "sphere", "center": [0, 0, 0], "radius": 1, "material": "grey"},
        {"type": "plane", "point": [0, -1, 0], "normal": [0, 1, 0], "material": "mirror"},
        {"type": "quad", "corner": [-1, 0, -2], "edge_u": [2, 0, 0], "edge_v": [0, 2, 0], "material": "grey"},
    ],
}


def changed(scene, pointer, value=None):
    """A copy of the scene with the value at a JSON pointer replaced; removed where the value is None."""
    scene = copy.deepcopy(scene)
    *folders, last = pointer.strip("/").split("/")
    place = scene
    for key in folders:
        place = place[int(key)] if isinstance(place, list) else place[key]
    last = int(last) if isinstance(place, list) else last
    if value is None:
        del place[last]
    else:
        place[last] = value
    return scene


class CommandTest(unittest.TestCase):
    command = ""
    always = {}  # variables of the environment that every command of the test has

    def setUp(self):
        scratch = tempfile.TemporaryDirectory(prefix="raypool-test-")
        self.addCleanup(scratch.cleanup)
        self.folder = pathlib.Path(scratch.name)
        (self.folder / "scene.json").write_text(json.dumps(SCENE))

    def write(self, name, content):
        """Writes a scene, a text or bytes, and returns the name."""
        if isinstance(content, dict):
            content = json.dumps(content)
        (self.folder / name).write_bytes(content if isinstance(content, bytes) else content.encode())
        return name

    def listing(self):
        """What lies in the folder: names, and the bytes of files."""
        return {
            str(path.relative_to(self.folder)): path.read_bytes() if path.is_file() else None
            for path in sorted(self.folder.rglob("*"))
        }

    def run_command(self, *arguments, environment=None, **keywords):
        """The finished process. OpenMP is told nothing but what the test says; what libraries of OpenMP say of that on
        stderr, each its own lines, is left out."""
        clean = {name: value for name, value in os.environ.items() if not name.startswith(("OMP_", "GOMP_", "KMP_"))}
        keywords.setdefault("timeout", 60)
        keywords.setdefault("stdout", subprocess.PIPE)
        keywords.setdefault("stderr", subprocess.PIPE)
        keywords = {"text": True, "errors": "backslashreplace", **keywords}
        result = subprocess.run(
            [self.command, *map(str, arguments)], cwd=self.folder, env={**clean, **self.always, **(environment or {})},
            stdin=subprocess.DEVNULL, check=False, **keywords)
        if environment and isinstance(result.stderr, str):
            result.stderr = re.sub(r"^(OMP|libgomp): .*\n|^\n", "", result.stderr, flags=re.MULTILINE)
        return result

    def run_well(self, *arguments, **keywords):
        """The finished process, which must have ended well and said nothing on stderr."""
        result = self.run_command(*arguments, **keywords)
        self.assertEqual((result.returncode, result.stderr or ""), (0, ""), arguments)
        return result

    def stats(self, *arguments, **keywords):
        """Renders scene.json, unless told otherwise, and returns what --stats wrote."""
        if not arguments or str(arguments[0]).startswith("-"):
            arguments = ("scene.json", *arguments)
        self.run_well("render", *arguments, "--stats", "stats.json", "--quiet", **keywords)
        return json.loads((self.folder / "stats.json").read_text())

    def pixels(self, name):
        """Width, height and the floats of a PFM file."""
        import array

        kind, size, scale, data = (self.folder / name).read_bytes().split(b"\n", 3)
        self.assertEqual((kind, float(scale)), (b"PF", -1.0))
        width, height = map(int, size.split())
        values = array.array("f", data)
        self.assertEqual(len(values), 3 * width * height)
        return width, height, values

    def assert_one_line(self, result, status, *named):
        self.assertEqual(result.returncode, status, f"{result.args}: {result.stderr}")
        self.assertRegex(result.stderr, r"\Araypool: [^\n]+\n\Z", result.args)
        for part in named:
            self.assertIn(part, result.stderr, result.args)

    def assert_refused(self, *arguments, named, **keywords):
        """Bad input: exit 2, one line on stderr naming what was wrong, and not a byte written elsewhere."""
        before = self.listing()
        result = self.run_command(*arguments, **keywords)
        self.assert_one_line(result, 2, *([named] if isinstance(named, str) else named))
        self.assertEqual(result.stdout, "", arguments)
        self.assertEqual(self.listing(), before, arguments)


def main():
    CommandTest.command = os.path.abspath(sys.argv.pop(1))
    unittest.main()
