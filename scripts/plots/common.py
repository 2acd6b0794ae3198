"""What all pictures share: reading a study's folder, and one style that reads in grey and for the colour-blind.

Colours are Okabe and Ito's, which differ in lightness too; lines also differ in marker, bars in hatch.
"""
import csv
import json
import statistics
import textwrap
from collections import defaultdict
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

COLOURS = ["#0072B2", "#E69F00", "#009E73", "#D55E00", "#56B4E9", "#CC79A7", "#000000", "#F0E442"]
MARKERS = ["o", "s", "^", "D", "v", "P", "X", "*"]
HATCHES = ["", "//", "..", "xx", "\\\\", "++", "oo", "--"]

plt.rcParams.update({
    "figure.dpi": 100, "savefig.dpi": 150, "font.size": 10, "axes.titlesize": 11, "axes.spines.top": False,
    "axes.spines.right": False, "axes.grid": True, "axes.axisbelow": True, "grid.color": "#DDDDDD", "grid.linewidth": 0.6,
    "legend.frameon": False, "svg.hashsalt": "raypool", "hatch.linewidth": 0.5,
})


class Row(dict):
    """A row of data.csv; numbers are numbers, and what does not exist is None."""


def _value(text):
    if text == "":
        return None
    try:
        return float(text)
    except ValueError:
        return text


TEXT_COLUMNS = {"case", "hash"}


def read(folder):
    """run.json with the folder that it is in, and the rows of data.csv."""
    folder = Path(folder)
    run = {**json.loads((folder / "run.json").read_text()), "folder": str(folder)}
    with open(folder / "data.csv", newline="") as file:
        rows = [Row({k: v if k in TEXT_COLUMNS else _value(v) for k, v in row.items()}) for row in csv.DictReader(file)]
    return run, rows


def where(rows, **wanted):
    return [row for row in rows if all(row[key] == value for key, value in wanted.items())]


def distinct(rows, *columns):
    """The different values (tuples, of more than one column), in the order of their first rows."""
    found = [tuple(row[c] for c in columns) for row in rows]
    return list(dict.fromkeys(f[0] if len(columns) == 1 else f for f in found))


def spread(rows, column):
    """Median, lowest, highest."""
    values = [row[column] for row in rows if row[column] is not None]
    return statistics.median(values), min(values), max(values)


def grouped(rows, *columns):
    """Rows by the values of columns, in order."""
    groups = defaultdict(list)
    for row in rows:
        groups[tuple(row[c] for c in columns)].append(row)
    return groups


def bars(axes, places, spreads, height=0.8, **style):
    """Horizontal bars with whiskers from the lowest to the highest run."""
    medians = [s[0] for s in spreads]
    errors = [[s[0] - s[1] for s in spreads], [s[2] - s[0] for s in spreads]]
    axes.barh(places, medians, height=height, xerr=errors, edgecolor="black", linewidth=0.6,
              error_kw={"elinewidth": 1, "capsize": 2.5}, **style)


def line(axes, x, spreads, index=0, **style):
    """A line through medians with a band from the lowest to the highest run."""
    style.setdefault("color", COLOURS[index % len(COLOURS)])
    style.setdefault("marker", MARKERS[index % len(MARKERS)])
    axes.plot(x, [s[0] for s in spreads], markersize=5, **style)
    axes.fill_between(x, [s[1] for s in spreads], [s[2] for s in spreads], color=style["color"], alpha=0.18, linewidth=0)


def write(figure, path, metadata):
    """A picture that is there whole or not at all."""
    path = path.resolve()
    beside = path.with_name(f".{path.name}.tmp")
    try:
        figure.savefig(beside, format=path.suffix[1:], metadata=metadata)
        beside.replace(path)
    finally:
        beside.unlink(missing_ok=True)


def save(figure, folder, run, picture):
    """Title above, caption and origin below; as <name>.svg and <name>.png."""
    width = figure.get_figwidth()
    caption = textwrap.fill(picture["caption"], int(width * 15.5))
    environment = run["environment"]
    origin = f"{environment['cpu']}, {environment['cores']} cores, {environment['compiler']}, commit {environment['commit']}"
    lines = caption.count("\n") + 2
    bottom = (lines * 0.16 + 0.12) / figure.get_figheight()
    figure.tight_layout(rect=(0, bottom, 1, 1 - 0.32 / figure.get_figheight()))
    figure.suptitle(picture["title"], fontsize=13, fontweight="bold", x=0.01, ha="left", va="top", y=0.995)
    figure.text(0.01, 0.01, caption + "\n" + origin, fontsize=8.5, va="bottom", ha="left", color="#333333", linespacing=1.25)
    for ending, metadata in (("svg", {"Date": None}), ("png", None)):
        write(figure, Path(folder) / f"{picture['name']}.{ending}", metadata)
    plt.close(figure)
