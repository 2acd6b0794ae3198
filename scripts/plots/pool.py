"""Ratio to recursion by capacity, and how full a pool is from round to round."""
import statistics

from common import COLOURS, distinct, grouped, line, plt, where

BLUE, ORANGE, GREEN, RED, SKY, PINK, BLACK, YELLOW = COLOURS

# Colour says whose the pool is, the shape of the marker and the line when camera rays enter.
STYLES = {
    "thread, regenerate, beam": {"color": "#004C78", "marker": "*", "linestyle": "-"},
    "thread, regenerate, fused": {"color": "#004C78", "marker": "*", "linestyle": "-"},  # the fastest of runs before beams
    "thread, regenerate": {"color": BLUE, "marker": "o", "linestyle": "-"},
    "thread, drain": {"color": SKY, "marker": "s", "linestyle": "--"},
    "shared, regenerate": {"color": RED, "marker": "^", "linestyle": "-"},
    "shared, drain": {"color": ORANGE, "marker": "D", "linestyle": "--"},
    "the paper's pool": {"color": BLACK, "marker": "X", "linestyle": ":"},
}


def count_text(value):
    for unit, size in (("M", 2**20), ("K", 2**10)):
        if value >= size:
            return f"{value / size:.3g} {unit}"
    return f"{value:.0f}"


def capacity(run, rows):
    counts = sorted(distinct(where(rows, axis="recursion"), "threads"))
    figure, axes = plt.subplots(1, len(counts), figsize=(5 + 4 * len(counts), 5.6), sharey=True, squeeze=False)
    highest = 1
    for axis, count in zip(axes[0], counts):
        here = where(rows, threads=count)
        recursion = [row["mpaths_per_s"] for row in where(here, axis="recursion")]
        for engine, style in STYLES.items():
            groups = sorted(grouped(where(here, axis="capacity", engine=engine), "capacity").items())
            if not groups:
                continue
            spreads = []
            for _, runs in groups:
                ratios = [row["mpaths_per_s"] / base for row, base in zip(runs, recursion)]
                spreads.append((statistics.median(ratios), min(ratios), max(ratios)))
            highest = max(highest, *(s[0] for s in spreads))
            line(axis, [key[0] for key, _ in groups], spreads, label=engine, **style)
        axis.axhline(1, color="black", linewidth=2, label="recursion")
        axis.set_xscale("log", base=4)
        ticks = sorted(distinct(where(here, axis="capacity"), "capacity"))
        axis.set_xticks(ticks, [count_text(t) for t in ticks[:-1]] + ["all"])
        axis.minorticks_off()
        axis.set_title(f"{count:.0f} thread{'s' if count > 1 else ''}")
        axis.set_xlabel("capacity of a pool, records (all: every path of the render)")
    axes[0][0].set_ylim(0, highest * 1.25)  # a disturbed run may lie above
    axes[0][0].set_ylabel("times as fast as recursion")
    axes[0][-1].legend(loc="upper left", bbox_to_anchor=(1, 1))
    return figure


def rounds(run, rows):
    figure, (left, right) = plt.subplots(1, 2, figsize=(11, 4.8))
    rows = where(rows, axis="rounds")
    for refill, label, style in (("regenerate", "refilled at once", {"color": RED, "linestyle": "--"}),
                                 ("drain", "drained, then refilled", {"color": BLUE, "linestyle": "-"})):
        here = where(rows, refill=refill)
        left.plot([row["round"] for row in here], [row["records_in"] for row in here], linewidth=1.8, label=label, **style)
    left.set_ylim(0, 1.2 * max([row["records_in"] for row in rows], default=1))
    left.yaxis.set_major_formatter(lambda value, _: f"{value / 1000:g}")
    left.set_xlabel("round")
    left.set_ylabel("thousand records in the pool")
    left.legend(loc="upper center", ncol=2)

    drained = where(rows, refill="drain")
    by_depth = sorted(grouped(drained, "depth").items())
    depths = [key[0] for key, _ in by_depth]
    first = sum(row["records_in"] for row in by_depth[0][1]) if by_depth else 1
    left_over = [100 * sum(row["records_in"] for row in group) / first for _, group in by_depth]
    lanes = [100 * sum(row["records_in"] for row in group) / sum(row["lanes"] for row in group) for _, group in by_depth]
    right.plot(depths, lanes, color=ORANGE, marker="s", markersize=4, linestyle="--", label="lanes of registers in use")
    right.plot(depths, left_over, color=BLUE, marker="o", markersize=4, label="records left, of those at depth 1")
    right.set_yscale("log")
    right.set_ylim(top=130)
    right.yaxis.set_major_formatter(lambda value, _: f"{value:g} %")
    right.set_xlabel("depth: rounds since the pool was filled")
    right.set_title("the pool that drains")
    left.set_title(f"shared pool of {drained[0]['capacity']:.0f} records" if drained else "shared pool")
    right.legend(loc="lower left")
    return figure


PICTURES = {"capacity": capacity, "rounds": rounds}
