"""Error curves, a panel a case; and images that a naive method ruined, beside ours."""
from pathlib import Path

from common import COLOURS, MARKERS, distinct, plt, where

LINES = {"naive": "--", "ours": "-", "other": ":"}
PALETTE = {"naive": [COLOURS[3], COLOURS[1], COLOURS[5]], "ours": [COLOURS[0], COLOURS[6], COLOURS[2]],
           "other": [COLOURS[4], COLOURS[2]]}
ROWS = {"spheres": "1", "leaving": "2", "boxes": "3", "scattering": "4", "paths": "56", "others": "78+"}


def belongs(row, rows):
    first = "8" if row["row"].startswith("10") else row["row"][0]  # large images go with the checkers
    return first in rows


def order(row):
    return (99, row) if row == "+" else (int(row[:-1]), row[-1])


def panel(axis, case, rows):
    methods = distinct(rows, "method")
    values = distinct(where(rows, method=methods[0]), "value")
    errors = [row["error"] for row in rows]
    positive = [e for e in errors if e > 0]
    tolerance = rows[0]["tolerance"]
    floor = min(positive + ([tolerance] if tolerance > 0 else []) + [1e-3]) / 8
    is_log = min(values) > 0 and max(values) >= 50 * min(values)
    places = values if is_log else range(len(values))
    seen = dict.fromkeys(LINES, 0)
    for i, method in enumerate(methods):
        of_method = where(rows, method=method)
        kind = of_method[0]["method_kind"]
        colour = PALETTE[kind][seen[kind]]
        seen[kind] += 1
        axis.plot(places, [max(row["error"], floor) for row in of_method], linestyle=LINES[kind], color=colour,
                  marker=MARKERS[i], markersize=4.5, linewidth=2.2 if kind == "ours" else 1.3, label=method,
                  zorder=3 if kind == "ours" else 2, clip_on=False)
    if tolerance > 0:
        axis.axhline(tolerance, color="#888888", linewidth=1)
    held = sum(row["is_asked"] == 1 for row in where(rows, method=methods[0]))
    if held < len(values):
        axis.axvspan(places[held - 1], places[len(values) - 1], color="#EEEEEE", zorder=0)
    if is_log:
        axis.set_xscale("log")
        if values[0] > values[-1]:
            axis.invert_xaxis()
    else:
        axis.set_xticks(list(places), [f"{v:g}" for v in values])
    axis.set_yscale("log")
    axis.set_ylim(bottom=floor)
    axis.set_title(f"{rows[0]['row']}  {case}", fontsize=9.5, loc="left")
    axis.set_xlabel(rows[0]["parameter"], fontsize=8)
    axis.set_ylabel(rows[0]["measure"].split(", ")[0], fontsize=7.5)
    axis.tick_params(labelsize=7.5)
    axis.legend(fontsize=6.8, loc="best", handlelength=3)


def curves(name):
    def draw(run, rows):
        rows = [row for row in where(rows, kind="curve") if belongs(row, ROWS[name])]
        cases = sorted(distinct(rows, "id"), key=lambda case: order(where(rows, id=case)[0]["row"]))
        columns = 3
        lines = -(-len(cases) // columns)
        figure, axes = plt.subplots(lines, columns, figsize=(13, 3.1 * lines + 0.9), squeeze=False)
        for axis, case in zip(axes.flat, cases):
            panel(axis, case, where(rows, id=case))
        for axis in axes.flat[len(cases):]:
            axis.set_visible(False)
        return figure
    return draw


def images(name):
    def draw(run, rows):
        folder = Path(run["folder"])
        figure, axes = plt.subplots(1, 3, figsize=(13, 3.9))
        share = {row["method_kind"]: row["error"] for row in where(rows, kind="image", id=name)}
        titles = {"naive": f"naive: {100 * share['naive']:.1f} % of the pixels wrong",
                  "ours": f"ours: {100 * share['ours']:.1f} % differ from double",
                  "difference": "naive less double, absolute"}
        for axis, part in zip(axes, titles):
            axis.imshow(plt.imread(folder / f"{name}_{part}.png"), interpolation="nearest")
            axis.set_title(titles[part])
            axis.axis("off")
        return figure
    return draw


PICTURES = {**{name: curves(name) for name in ROWS},
            **{name: images(name) for name in ("acne", "leak", "glass", "coincidence", "ground", "checker")}}
