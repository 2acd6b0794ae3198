"""Scenes from files, from those that are built in, and from dicts."""

from __future__ import annotations

import json
import math
import os
from collections.abc import Mapping
from typing import Any, Union

from . import _core
from ._core import Scene
from ._errors import InputError

SceneSource = Union[str, "os.PathLike[str]", Mapping[str, Any]]

_MOST_LEVELS = 32  # of arrays and objects within each other, as in a file


def load(source: SceneSource, *, folder: str | os.PathLike[str] | None = None, name: str | None = None) -> Scene:
    """Reads a scene: docs/scene-format.md says of what it is made.

    source -- a file; if there is none of that name, a built-in scene (scenes() lists them); or what such a file holds,
              as a dict. Lists, tuples, and numpy's arrays and numbers are all welcome in it.
    folder -- below which a dict's files lie, such as textures and meshes; default: the working folder.
    name   -- of a dict's scene, and what stands for a file in messages; default: "scene".

    Raises InputError, whose `place` is the JSON pointer of what was refused. The GIL is released meanwhile.
    """
    if isinstance(source, Mapping):
        name = "scene" if name is None else name
        text = json.dumps(_plain(source, name, "", 0))
        return _core.parse_text(text, name, os.fsencode("." if folder is None else folder))
    if folder is not None or name is not None:
        raise InputError("folder and name: do nothing beside a file, which has its own")
    file = os.fsencode(source)
    if b"\0" in file:
        raise InputError("a file's name has no byte that is zero")
    return _core.load_named(file)


def as_scene(source: Scene | SceneSource) -> Scene:
    """The scene, which is read first where it is none yet."""
    return source if isinstance(source, Scene) else load(source)


def _plain(value: Any, name: str, place: str, level: int) -> Any:
    """The value as JSON has it. What JSON has not is refused with the place, as the reader refuses values."""

    def refuse(rule: str, got: str) -> InputError:
        at = f"{place}: " if place else ""
        return InputError(f"{name}: {at}must {rule}, got {got}", place or None)

    if hasattr(value, "tolist"):  # numpy's arrays and numbers
        value = value.tolist()
    if value is None or isinstance(value, (bool, int, str)):
        return value
    if isinstance(value, float):
        if not math.isfinite(value):
            raise refuse("be a finite number", str(value))
        return value
    if level == _MOST_LEVELS:
        raise refuse(f"not nest deeper than {_MOST_LEVELS} levels", "more")
    if isinstance(value, Mapping):
        for key in value:
            if not isinstance(key, str):
                raise refuse("have keys that are strings", repr(key))
        return {key: _plain(member, name, f"{place}/{_token(key)}", level + 1) for key, member in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(item, name, f"{place}/{i}", level + 1) for i, item in enumerate(value)]
    raise refuse("be a value that JSON has", f"a {type(value).__name__}")


def _token(key: str) -> str:
    return key.replace("~", "~0").replace("/", "~1")
