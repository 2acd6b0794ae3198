"""Efficiency by threads and by width: replayed lines, measured marks, and the paper's figures in grey."""
from statistics import median

from common import COLOURS, MARKERS, distinct, plt, where

PAPER = {  # speedup over threads at width 1200; efficiency, flat in width
    "paper, basic (width 1200)": {1: 1, 2: 1.869 / 2, 4: 3.192 / 4, 8: 4.836 / 8, 16: 6.333 / 16, 32: 7.425 / 32, 64: 7.985 / 64},
    "paper, static,1": {2: 0.93, 4: 0.86, 8: 0.70, 16: 0.46},
}


def measured(rows, way, width, threads):
    """Efficiency of each repeat."""
    one = {row["repeat"]: row["seconds"] for row in where(rows, source="measured", way=way, width=width, threads=1)}
    many = where(rows, source="measured", way=way, width=width, threads=threads)
    return [100 * one[row["repeat"]] / row["seconds"] / threads for row in many]


def marks(axis, x, values, **style):
    middle = median(values)
    axis.errorbar(x, middle, yerr=[[middle - min(values)], [max(values) - middle]], capsize=3, elinewidth=1, **style)


def scaling(run, rows):
    replayed = where(rows, source="replayed")
    ways, widths = distinct(replayed, "way"), sorted(distinct(replayed, "width"))
    wide = min(widths, key=lambda w: (abs(w - 1200), -w))
    cores = max(row["threads"] for row in where(rows, source="measured"))
    threads = sorted(distinct(replayed, "threads"))
    shown = max(n for n in threads if n <= 16)
    figure, (left, right) = plt.subplots(1, 2, figsize=(14, 5.6), sharey=True)
    for i, way in enumerate(ways):
        colour, marker = COLOURS[i], MARKERS[i]
        points = sorted(where(replayed, way=way, width=wide), key=lambda row: row["threads"])
        left.plot([p["threads"] for p in points], [100 * p["efficiency"] for p in points], color=colour, marker=marker,
                  markersize=4, label=way)
        if cores > 1:
            marks(left, cores * (1 + 0.03 * (i - 2)), measured(rows, way, wide, cores), color=colour, marker=marker,
                  markersize=9, markerfacecolor="white", markeredgewidth=1.5)
        points = sorted(where(replayed, way=way, threads=shown), key=lambda row: row["width"])
        right.plot([p["width"] for p in points], [100 * p["efficiency"] for p in points], color=colour, marker=marker,
                   markersize=5)
        if cores > 1:
            right.plot(widths, [median(measured(rows, way, w, cores)) for w in widths], color=colour, marker=marker,
                       markersize=8, markerfacecolor="white", linestyle=":", linewidth=1)
    if cores > 1:
        loops = {n: [row["loop_seconds"] for row in where(rows, source="measured", threads=n)] for n in (1, cores)}
        left.plot(cores, 100 * median(loops[1]) / median(loops[cores]), marker="_", markersize=26, markeredgewidth=2,
                  color="black", linestyle="none", label="compute loop, measured")
    for (name, points), style in zip(PAPER.items(), ("-", "--")):
        points = {n: e for n, e in points.items() if n <= threads[-1]}
        left.plot(list(points), [100 * e for e in points.values()], color="#888888", linestyle=style, linewidth=2, label=name)
    left.set_xscale("log", base=2)
    left.set_xticks(threads, [f"{n:.0f}" for n in threads])
    left.minorticks_off()
    left.set_xlabel("threads")
    left.set_ylabel("efficiency, %")
    left.set_title(f"width {wide:.0f}")
    right.set_xlabel("image width, pixels")
    right.set_xticks(widths, [f"{w:.0f}" for w in widths])
    right.set_title(f"{shown:.0f} threads, replayed" + (f"; {cores:.0f} threads, measured (dotted)" if cores > 1 else ""))
    left.set_ylim(bottom=0)
    right.legend(*left.get_legend_handles_labels(), loc="upper left", bbox_to_anchor=(1, 1), fontsize=8.5)
    return figure


PICTURES = {"scaling": scaling}
