"""Engines side by side."""

from __future__ import annotations

import inspect
import math
import statistics
from collections.abc import Mapping, Sequence
from typing import Any

from . import _core
from ._core import Scene
from ._errors import ImagesDiffer, InputError
from ._render import render, render_by
from ._scene import SceneSource, as_scene

_OPTIONS = [name for name in inspect.signature(render).parameters if name not in ("scene", "progress")]


def compare(
    scene: Scene | SceneSource,
    engines: Sequence[str | Mapping[str, Any]] | None = None,
    *,
    repeats: int = 5,
    **options: Any,
) -> list[dict[str, Any]]:
    """Renders a scene by several engines in turn, checks that the image is the same, and tells how fast each was.

    engines -- names, or dicts of options of render() that are each one's own, such as {"engine": "wavefront",
               "pool_rays": 1024} with an optional "name"; default: all engines(). The first is what others are held to.
    repeats -- runs of each, at least 1. They are interleaved, in another order each time.
    options -- of render(), for all of them.

    Returns a row each, a dict that pandas.DataFrame takes:
        name           -- of the engine, or of its dict
        engine         -- its name in engines()
        hash           -- the same in all rows
        seconds        -- a list, by repeat: the engine's own time, without reading and compiling the scene
        mpaths_per_s   -- a list, by repeat: million paths a second
        ratio          -- a list, by repeat: how many times as fast as the first engine in the same repeat
        ratio_median   -- its median
        segments       -- rays traced, the same in all rows

    Raises ImagesDiffer where hashes are not the same, InputError as render() does. Ctrl-C is answered between runs, each
    of which is in one piece: a callback, or a look at signals, would be timed with it.
    """
    if repeats < 1:
        raise InputError(f"repeats: must be at least 1, got {repeats}")
    names = list(_core.engines()) if engines is None else engines
    contenders = [_contender(entry, options) for entry in names]
    if not contenders:
        raise InputError("engines: must name one at least")
    loaded = as_scene(scene)
    reports: list[list[dict[str, Any]]] = [[] for _ in contenders]
    for turn in range(repeats):
        for i in _order(turn, len(contenders)):
            reports[i].append(render_by(loaded, contenders[i][1], None, in_pieces=False)[1])

    hashes = {name: {report["hash"] for report in made} for (name, _), made in zip(contenders, reports)}
    if len(set().union(*hashes.values())) > 1:
        raise ImagesDiffer(hashes)
    return [_row(name, made, reports[0]) for (name, _), made in zip(contenders, reports)]


def _contender(entry: str | Mapping[str, Any], options: Mapping[str, Any]) -> tuple[str, dict[str, Any]]:
    """A name that tells it apart, and all its options."""
    own = {"engine": entry} if isinstance(entry, str) else dict(entry)
    label = own.pop("name", None)
    for name in {**options, **own}:
        if name not in _OPTIONS:
            raise TypeError(f"compare() got an unexpected option {name!r}")
    if label is None:
        label = ", ".join(str(value) if key == "engine" else f"{key}={value}" for key, value in own.items())
    return label, {**options, **own}


def _order(turn: int, count: int) -> list[int]:
    """Another stride each turn, so that none always follows the same other."""
    stride = turn + 1
    while math.gcd(stride, count) != 1:
        stride += 1
    return [(turn + i * stride) % count for i in range(count)]


def _row(name: str, reports: list[dict[str, Any]], first: list[dict[str, Any]]) -> dict[str, Any]:
    seconds = [report["seconds"]["render"] for report in reports]
    ratio = [other["seconds"]["render"] / own for own, other in zip(seconds, first)]
    return {
        "name": name,
        "engine": reports[0]["settings"]["engine"],
        "hash": reports[0]["hash"],
        "seconds": seconds,
        "mpaths_per_s": [report["mpaths_per_s"] for report in reports],
        "ratio": ratio,
        "ratio_median": statistics.median(ratio),
        "segments": reports[0]["segments"],
    }
