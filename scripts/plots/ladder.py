"""Time of a thread for each ray, rung by rung, stacked by where it went."""
import statistics

from common import COLOURS, distinct, plt, where

BLUE, ORANGE, GREEN, RED, SKY, PINK, BLACK, YELLOW = COLOURS

# Column, label, colour, hatch: useful work in blue and green, traffic in orange and yellow, waiting in red and pink.
PARTS = [
    ("generate_s", "generate camera rays", "#004C78", ""),
    ("intersect_s", "intersect", SKY, ""),
    ("shade_s", "shade", GREEN, ""),
    ("sort_s", "sort", "#7FD1B9", "xx"),
    ("accumulate_s", "accumulate", "#C8EFE4", ".."),
    ("traffic_s", "move records (estimate)", ORANGE, "//"),
    ("append_s", "append to the next round", YELLOW, "//"),
    ("barrier_s", "wait at barriers", RED, "\\\\"),
    ("end_s", "wait at the end", PINK, "\\\\"),
    ("rest", "rest", "#FFFFFF", ""),
]
WHOLE = ("whole path, not split", "#999999", "")


def thread_ns(row):
    return row["seconds"] * row["threads"] / row["segments"] * 1e9


def parts_of(rows):
    """Parts of a bar whose length is the median run without clocks, in the shares of the runs with clocks."""
    split = [row for row in rows if row["clocks"] == "on"]
    length = statistics.median(thread_ns(row) for row in rows if row["clocks"] == "off")
    if not split:
        return [(length, *WHOLE)]
    in_all = [row["seconds"] * row["threads"] for row in split]
    shares = [statistics.median(row[column] / whole for row, whole in zip(split, in_all)) for column, *_ in PARTS[:-1]]
    shares.append(max(0, 1 - sum(shares)))
    return [(length * share / sum(shares), *style) for share, (_, *style) in zip(shares, PARTS)]


def ratio_text(rows, recursive):
    ratios = [row["mpaths_per_s"] / base["mpaths_per_s"] for row, base in zip(rows, recursive)]
    return f"{statistics.median(ratios):.2f}×  ({min(ratios):.2f} to {max(ratios):.2f})"


def ladder(run, rows):
    engines = distinct(rows, "engine")
    counts = sorted(distinct(rows, "threads"))
    figure, axes = plt.subplots(1, len(counts), figsize=(6 + 4.5 * len(counts), 6.2), sharex=True, sharey=True, squeeze=False)
    labels = {}
    # A shared pool on a busy machine can wait without measure: its bar ends in an arrow.
    limit = 2 * max(sum(part[0] for part in parts_of(where(rows, engine="recursive", threads=count))) for count in counts)
    longest = 0
    for axis, count in zip(axes[0], counts):
        recursive = where(rows, engine="recursive", threads=count)
        for place, engine in enumerate(engines):
            of_engine = where(rows, engine=engine, threads=count)
            left = 0
            for length, label, colour, hatch in parts_of(of_engine):
                shown = min(length, limit - left)
                if shown > 0:
                    bar = axis.barh(place, shown, left=left, height=0.75, color=colour, hatch=hatch, edgecolor="black",
                                    linewidth=0.5)
                    labels.setdefault(label, bar)
                left += length
            arrow = "" if left <= limit else f" → {left:.0f} ns "
            axis.text(min(left, limit), place, arrow + "  " + ratio_text(where(of_engine, clocks="off"), recursive),
                      va="center", fontsize=9)
            longest = max(longest, min(left, limit))
        axis.set_yticks(range(len(engines)), engines)
        axis.set_title(f"{count:.0f} thread{'s' if count > 1 else ''}")
        axis.set_xlabel("nanoseconds of a thread for each ray")
        axis.grid(axis="y", visible=False)
    axes[0][0].set_xlim(0, longest * (1.55 if longest < limit else 1.8))
    axes[0][0].invert_yaxis()
    order = [label for _, label, *_ in PARTS] + [WHOLE[0]]
    shown = [label for label in order if label in labels]
    axes[0][-1].legend([labels[label] for label in shown], shown, loc="upper left", bbox_to_anchor=(1, 1))
    return figure


PICTURES = {"ladder": ladder}
