"""The compiled part of raypool. What the package in __init__.py says holds; call that."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

__version__: str

class Scene:
    """A scene that raypool.load() has read. It does not change, and threads may share it."""

    @property
    def name(self) -> str: ...
    @property
    def description(self) -> str: ...
    @property
    def width(self) -> int: ...
    @property
    def height(self) -> int: ...
    @property
    def counts(self) -> dict[str, int]: ...

def load_named(name: bytes | str) -> Scene: ...
def parse_text(text: str, name: str, folder: bytes | str) -> Scene: ...
def scenes() -> list[str]: ...
def engines() -> dict[str, str]: ...
def render(
    scene: Scene,
    arguments: list[str],
    progress: Callable[[int, int], object] | None,
    in_pieces: bool,
) -> tuple[NDArray[np.float32], str, dict[str, NDArray[np.float32]]]:
    """The image, the report as JSON, and AOVs by the names of their channels."""
