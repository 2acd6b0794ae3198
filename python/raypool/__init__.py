"""Ray pools against recursion on a CPU, from Python: one image by every engine, and the figures of how it was made.

    image, report = raypool.render("paper", spp=4, width=200)

load() reads a scene, render() renders one, compare() holds engines against each other. docs/python.md is the page.
"""

from ._compare import compare
from ._core import Scene, __version__, engines, scenes
from ._errors import ImagesDiffer, InputError
from ._render import Image, Progress, Report, render
from ._scene import SceneSource, load

__all__ = [
    "Image",
    "ImagesDiffer",
    "InputError",
    "Progress",
    "Report",
    "Scene",
    "SceneSource",
    "__version__",
    "compare",
    "engines",
    "load",
    "render",
    "scenes",
]
