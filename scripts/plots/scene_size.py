"""Ratio to recursion, and time of a ray, by the number of shapes."""
import statistics

from common import COLOURS, distinct, line, plt, spread, where

BLUE, ORANGE, GREEN, RED, SKY, PINK, BLACK, YELLOW = COLOURS


def timed(rows):
    return [row for row in rows if not str(row["way"]).startswith(("cache misses", "lists"))]


def name_of(way):
    return way if isinstance(way, str) else f"{way:.0f} records"


def panels(rows, label):
    """A panel for each kind, in a row for each depth; of the most threads."""
    threads = max(distinct(rows, "threads"))
    rows = where(timed(rows), threads=threads)
    kinds, depths = distinct(rows, "kind"), distinct(rows, "depth")
    figure, axes = plt.subplots(len(depths), len(kinds), figsize=(4.2 * len(kinds) + 1.8, 3.9 * len(depths) + 0.8),
                                sharex=True, sharey="row", squeeze=False)
    for across, depth in zip(axes, depths):
        for axis, kind in zip(across, kinds):
            axis.set_xscale("log")
            axis.set_title(f"{kind}, depth {depth:.0f}, {threads:.0f} thread{'s' if threads > 1 else ''}")
            yield figure, axis, where(rows, depth=depth, kind=kind)
        across[0].set_ylabel(label)
        across[-1].legend(loc="upper left", bbox_to_anchor=(1, 1))
    for axis in axes[-1]:
        axis.set_xlabel("shapes")


def ratios(here, way, shapes):
    base = [row["mpaths_per_s"] for row in where(here, way="recursion", shapes=shapes)]
    values = [row["mpaths_per_s"] / other for row, other in zip(where(here, way=way, shapes=shapes), base)]
    return statistics.median(values), min(values), max(values)


def ratio(run, rows):
    for figure, axis, here in panels(rows, "times as fast as recursion"):
        sizes = distinct(here, "shapes")
        ways = [way for way in distinct(here, "way") if way not in ("recursion", "automatic")]
        for index, way in enumerate(ways):
            line(axis, sizes, [ratios(here, way, size) for size in sizes], index=index, label=name_of(way), linestyle="--")
        line(axis, sizes, [ratios(here, "automatic", size) for size in sizes], color=BLACK, marker="*", label="automatic")
        axis.axhline(1, color="black", linewidth=2, label="recursion")
    for axis in figure.axes:  # after the last panel, since rows share an axis that stops growing here
        axis.set_ylim(bottom=0)
    return figure


def time(run, rows):
    for figure, axis, here in panels(rows, "nanoseconds of a thread for a ray"):
        sizes = distinct(here, "shapes")
        for way, label, style in (("recursion", "recursion", {"color": RED, "marker": "s", "linestyle": "--"}),
                                  ("automatic", "pool", {"color": BLUE, "marker": "o"})):
            line(axis, sizes, [spread(where(here, way=way, shapes=size), "ns_per_segment") for size in sizes], label=label,
                 **style)
        axis.set_yscale("log")
    return figure


SHORT_LIST = 12  # rays; kShortList of wavefront/stream.h


def lists(run, rows):
    rows = where(rows, way="lists, automatic")
    kinds = distinct(rows, "kind")
    figure, axes = plt.subplots(2, len(kinds), figsize=(4.2 * len(kinds) + 1.8, 7.0), sharex=True, sharey="row",
                                squeeze=False)
    for above, below, kind in zip(axes[0], axes[1], kinds):
        for index, shapes in enumerate(distinct(where(rows, kind=kind), "shapes")):
            here = where(rows, kind=kind, shapes=shapes)
            lengths = [row["list_rays"] / row["lists"] for row in here]
            line(above, [row["level"] for row in here], [(value, value, value) for value in lengths], index=index,
                 label=f"{shapes:.0f} shapes")
            full = [row for row in here if row["lanes"] > 0]
            fills = [(row["list_rays"] - row["single_rays"]) / row["lanes"] for row in full]
            line(below, [row["level"] for row in full], [(value, value, value) for value in fills], index=index)
        above.axhspan(0.5, SHORT_LIST, color="0.9")
        above.set_yscale("log")
        above.set_title(kind)
        below.set_ylim(0, 1.05)
        below.set_xlabel("level of the trees")
    axes[0][0].set_ylabel("rays of a list")
    axes[1][0].set_ylabel("lanes in use")
    axes[0][-1].legend(loc="upper left", bbox_to_anchor=(1, 1))
    return figure


PICTURES = {"ratio": ratio, "time": time, "lists": lists}
