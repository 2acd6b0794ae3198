"""What the tests beside this file share: the source tree, and the command to compare with, if there is one."""

import os
import pathlib
import shutil
import subprocess

SOURCE = pathlib.Path(__file__).resolve().parents[2]
COMMAND = os.environ.get("RAYPOOL_COMMAND") or shutil.which("raypool")

SCENE = {
    "description": "A grey ball on a mirror.",
    "image": {"width": 8, "height": 6},
    "camera": {"look_from": [0, 1, 5], "look_at": [0, 0, 0]},
    "background": [0.25, 0.5, 1],
    "materials": {"grey": {"type": "diffuse", "albedo": [0.7, 0.7, 0.7]},
                  "mirror": {"type": "metal", "albedo": [1, 1, 1], "fuzz": 0}},
    "shapes": [{"type": "sphere", "center": [0, 0, 0], "radius": 1, "material": "grey"},
               {"type": "plane", "point": [0, -1, 0], "normal": [0, 1, 0], "material": "mirror"}],
}


def run_command(*arguments, folder="."):
    """The finished process of `raypool`."""
    return subprocess.run([COMMAND, *map(str, arguments)], cwd=folder, text=True, capture_output=True, check=False,
                          stdin=subprocess.DEVNULL, timeout=300)
