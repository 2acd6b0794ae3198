"""Renders by the options of the command."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _core
from ._core import Scene
from ._scene import SceneSource, as_scene

Report = dict[str, Any]
Progress = Callable[[int, int], object]
Image = NDArray[np.float32]

_SEPARATORS = {"samples": ":", "crop": ","}  # in the texts of options that may be tuples


def render(
    scene: Scene | SceneSource,
    *,
    engine: str | None = None,
    spp: int | None = None,
    samples: tuple[int, int] | str | None = None,
    target_error: float | None = None,
    width: int | None = None,
    height: int | None = None,
    crop: tuple[int, int, int, int] | str | None = None,
    depth: int | None = None,
    seed: int | None = None,
    sampler: str | None = None,
    roulette: bool = False,
    light_sampling: str | None = None,
    split_depth: int | None = None,
    precision: str | None = None,
    threads: int | None = None,
    schedule: str | None = None,
    grain: str | None = None,
    count_work: bool = False,
    aovs: bool = False,
    pool_scope: str | None = None,
    pool_rays: int | str | None = None,
    pool_batch: int | None = None,
    refill: str | None = None,
    stage_width: str | None = None,
    intersect: str | None = None,
    camera: str | None = None,
    sort: str | None = None,
    append: str | None = None,
    accumulator: str | None = None,
    progress: Progress | None = None,
) -> tuple[Image, Report]:
    """Renders a scene as the command `raypool render` does: for the same options, the same image to the last bit.

    Returns the image, float32 of shape (height, width, 3), linear radiance with sRGB's primaries, row 0 at the top; and
    the report, what `--stats` writes: "hash" over the image's exact sums, "seconds" by part, "paths", "segments",
    "mpaths_per_s", "threads" (a dict each: "paths", "segments", "busy_s", "wait_s", ...), "settings", "features",
    "environment" and more. With count_work, engines with a pool add their "rounds".

    scene          -- a Scene, or what load() takes
    engine         -- one of engines(); default: the fastest
    spp            -- samples per pixel, within [1, 2^31 - 1]; default: 100
    samples        -- only samples (A, B), which are A to B - 1 of the spp
    target_error   -- RMSE in radiance, within [1e-9, 1e9]: pixels get samples, at most spp, until it is reached; the
                      report's "adaptive" says whether it was
    width, height  -- in pixels, each within [1, 65536]; one follows from the other by the scene's shape
    crop           -- only the pixels (X0, Y0, X1, Y1): columns X0 to X1 - 1 of rows Y0 to Y1 - 1, counted from the top
                      left; the image has these pixels alone
    depth          -- most segments of a path; default: 50
    seed           -- of all random numbers, within [0, 2^64); default: 0
    sampler        -- "independent" (default) or "sobol"
    roulette       -- end paths that carry little by chance, without bias
    light_sampling -- "none", "light" or "mis" (default)
    split_depth    -- follow both rays at the first so many hits on glass; default: 0
    precision      -- "float" (default) or "double"
    threads        -- within [1, 4096]; default: OMP_NUM_THREADS
    schedule       -- "balanced", or "static", "dynamic", "guided" or "tasks" and a chunk: "dynamic,4"
    grain          -- what a loop iteration renders, unless balanced: "pixel", "line" or "tile:16"
    count_work     -- count box and primitive tests (slower)
    aovs           -- the report's "aovs" then has arrays for what a pixel shows beside radiance: "A" (alpha), "Z" (depth)
                      and "samples" of shape (height, width), and "N" (normal), "albedo" and "variance" of shape
                      (height, width, 3); docs/command.md says what each is
    pool_scope to accumulator -- of the wavefront engine, as `raypool render --help` has them
    progress       -- called in this thread with (paths done, paths in all) about twice a second; with target_error,
                      "in all" is what spp allows at most. What it raises ends the render and comes out.

    Raises InputError for what the command refuses, in its words. Ctrl-C is a KeyboardInterrupt within about a second,
    or, where one sample of every pixel takes longer, after that. The GIL is released; several Python threads may
    render at once, each with `threads` of its own.
    """
    options = dict(locals())  # the first statement: what was given, by name
    for name in ("scene", "progress"):
        del options[name]
    return render_by(as_scene(scene), options, progress, in_pieces=True)


def render_by(
    scene: Scene, options: Mapping[str, Any], progress: Progress | None, in_pieces: bool
) -> tuple[Image, Report]:
    """render() by options as a mapping; in one piece for those who time it: no callback, and Ctrl-C waits."""
    image, stats, channels = _core.render(scene, _arguments(options), progress, in_pieces)
    report = json.loads(stats)
    if channels:
        report["aovs"] = {name: channels[name] for name in ("A", "Z", "samples")} | {
            layer: np.stack([channels[f"{layer}.{part}"] for part in parts], axis=-1)
            for layer, parts in (("N", "XYZ"), ("albedo", "RGB"), ("variance", "RGB"))
        }
    return image, report


def _arguments(options: Mapping[str, Any]) -> list[str]:
    """The options as the command is given them. What is None or False is not given."""
    arguments = []
    for name, value in options.items():
        option = "--" + name.replace("_", "-")
        if value is None or (isinstance(value, (bool, np.bool_)) and not value):
            continue
        if isinstance(value, (bool, np.bool_)):
            arguments.append(option)
        elif name in _SEPARATORS and not isinstance(value, str):
            arguments.append(f"{option}={_SEPARATORS[name].join(map(str, value))}")
        else:
            arguments.append(f"{option}={value}")
    return arguments
