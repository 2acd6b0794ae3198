"""What all pictures share: one style that reads in grey and for the colour-blind.

Colours are Okabe and Ito's, which differ in lightness too; lines also differ in marker, bars in hatch.
"""
import textwrap
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

from . import data

COLOURS = ["#0072B2", "#E69F00", "#009E73", "#D55E00", "#56B4E9", "#CC79A7", "#000000", "#F0E442"]
MARKERS = ["o", "s", "^", "D", "v", "P", "X", "*"]
HATCHES = ["", "//", "..", "xx", "\\\\", "++", "oo", "--"]

plt.rcParams.update({
    "figure.dpi": 100, "savefig.dpi": 150, "font.size": 10, "axes.titlesize": 11, "axes.spines.top": False,
    "axes.spines.right": False, "axes.grid": True, "axes.axisbelow": True, "grid.color": "#DDDDDD", "grid.linewidth": 0.6,
    "legend.frameon": False, "svg.hashsalt": "raypool", "hatch.linewidth": 0.5,
})


def remember(artist, spreads, along="y", name=""):
    """For points.py, which tells who looks at a point: its spread, along which axis, and of what, if no legend has that."""
    artist.spreads, artist.along, artist.name = spreads, along, name


def bars(axes, places, spreads, height=0.8, **style):
    """Horizontal bars with whiskers from the lowest to the highest run."""
    medians = [s[0] for s in spreads]
    errors = [[s[0] - s[1] for s in spreads], [s[2] - s[0] for s in spreads]]
    drawn = axes.barh(places, medians, height=height, xerr=errors, edgecolor="black", linewidth=0.6,
                      error_kw={"elinewidth": 1, "capsize": 2.5}, **style)
    drawn.spreads = spreads  # for points.py


def line(axes, x, spreads, index=0, **style):
    """A line through medians with a band from the lowest to the highest run."""
    style.setdefault("color", COLOURS[index % len(COLOURS)])
    style.setdefault("marker", MARKERS[index % len(MARKERS)])
    remember(axes.plot(x, [s[0] for s in spreads], markersize=5, **style)[0], spreads)
    axes.fill_between(x, [s[1] for s in spreads], [s[2] for s in spreads], color=style["color"], alpha=0.18, linewidth=0)


def write(figure, path, metadata):
    """As the kind of picture that the path's ending says, there whole or not at all."""
    data.write(path, lambda beside: figure.savefig(beside, format=str(path).rpartition(".")[2], metadata=metadata))


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
