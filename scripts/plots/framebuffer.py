"""Interleaved against planar sums: time in pairs, and cache misses beside it."""
from common import COLOURS, bars, distinct, plt, spread, where

LAYOUTS = {"interleaved": {"color": COLOURS[0], "hatch": ""}, "planar": {"color": COLOURS[1], "hatch": "//"}}


def size_text(row):
    size = row["framebuffer_bytes"] / 1024
    return f"{size / 1024:.1f} MiB" if size >= 1024 else f"{size:.0f} KiB"


def pairs(axis, groups, spread_of):
    """Two bars, one a layout, for each (label, rows)."""
    for i, (layout, style) in enumerate(LAYOUTS.items()):
        bars(axis, [place + (i - 0.5) * 0.38 for place in range(len(groups))],
             [spread_of(where(rows, layout=layout)) for _, rows in groups], height=0.38, label=layout, **style)
    axis.set_yticks(range(len(groups)), [label for label, _ in groups])
    axis.invert_yaxis()
    medians = [spread_of(where(rows, layout=layout))[0] for _, rows in groups for layout in LAYOUTS]
    axis.set_xlim(0, 1.4 * max(medians) or 1)  # a disturbed run may lie beyond
    axis.grid(axis="y", visible=False)


def ns_per_sample(rows):
    return spread([{"ns": row["seconds"] * row["threads"] / row["paths"] * 1e9} for row in rows], "ns")


def misses_percent(rows):
    """Misses of the first-level cache, of all accesses to data that were counted."""
    rates = []
    for row in rows:
        has_writes = row["d1_write_misses"] is not None
        misses = row["d1_read_misses"] + (row["d1_write_misses"] if has_writes else 0)
        accesses = row["data_reads"] + (row["data_writes"] if has_writes else 0)
        rates.append({"rate": 100 * misses / accesses if accesses else 0})
    return spread(rates, "rate")


def framebuffer(run, rows):
    clock = where(rows, source="clock")
    counted = [row for row in rows if row["source"] != "clock"]
    panels = 2 if counted else 1
    figure, axes = plt.subplots(1, panels, figsize=(2 + 5 * panels, 5.4), squeeze=False)
    left = axes[0][0]

    groups = []
    for engine, width, threads in distinct(clock, "engine", "width", "threads"):
        here = where(clock, engine=engine, width=width, threads=threads)
        groups.append((f"{engine}\n{size_text(here[0])} of sums, {threads:.0f} thread{'s' if threads > 1 else ''}", here))
    pairs(left, sorted(groups, key=lambda group: group[0].split("\n")[0]), ns_per_sample)
    left.set_title("time", loc="left")
    left.set_xlabel("nanoseconds of a thread for each sample")

    groups = []
    for engine, width, part in distinct(counted, "engine", "width", "part"):
        here = where(counted, engine=engine, width=width, part=part)
        what = {"render": "whole render", "accumulate": "adding to the sums"}[part]
        groups.append((f"{engine}\n{size_text(here[0])} of sums, {what}", here))
    if counted:
        right = axes[0][1]
        pairs(right, sorted(groups, key=lambda group: (group[0].split("\n")[0], "adding" in group[0])), misses_percent)
        right.set_title(f"first-level cache misses, by {counted[0]['source']}", loc="left")
        right.set_xlabel("% of accesses to data")
    left.legend(loc="lower right", bbox_to_anchor=(1, 1), ncol=2)
    return figure


PICTURES = {"framebuffer": framebuffer}
