"""Interleaved against planar sums: time in pairs, and cache misses beside it."""
from statistics import median

from .data import distinct, numbers, where
from .drawing import COLOURS, bars, plt
from .spreads import ratios, spread, text, threads_text
from .summary import Finding, Picture, Summary, Table
from .verdict import LEAST_RUNS, Verdict, judged

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
    return spread([row["seconds"] * row["threads"] / row["paths"] * 1e9 for row in rows])


def misses_percent(rows):
    """By run: misses of the first-level cache, of all accesses to data that were counted."""
    rates = []
    for row in rows:
        has_writes = row["d1_write_misses"] is not None
        misses = row["d1_read_misses"] + (row["d1_write_misses"] if has_writes else 0)
        accesses = row["data_reads"] + (row["data_writes"] if has_writes else 0)
        rates.append(100 * misses / accesses if accesses else 0)
    return spread(rates)


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


SHARED_POOL = "the paper's pool, shared"  # what the paper's claims are held against


def misses_of(rows):
    """The rows with counts, from whichever source there is."""
    return where(rows, source="hardware counters") or where(rows, source="cachegrind")


def sums_text(rows):
    return f"{rows[0]['framebuffer_bytes'] / 1024:.0f} KiB"


def times(clock):
    """And what interleaving gains the shared pool, of all threads and the larger image."""
    table = Table("Time", ["pool", "width", "framebuffer", "threads", "interleaved, s", "planar, s",
                           "planar over interleaved"])
    most, largest = max(numbers(clock, "threads")), max(numbers(clock, "width"))
    gains = []
    for engine in distinct(clock, "engine"):
        for width in distinct(clock, "width"):
            for threads in distinct(clock, "threads"):
                here = where(clock, engine=engine, width=width, threads=threads)
                interleaved, planar = (numbers(where(here, layout=layout), "seconds") for layout in LAYOUTS)
                gain = ratios(planar, interleaved)
                if (engine, threads, width) == (SHARED_POOL, most, largest):
                    gains = gain
                table.rows.append([engine, str(width), sums_text(here), str(threads), text(spread(interleaved), 3),
                                   text(spread(planar), 3), text(spread(gain))])
    return table, gains


def miss_rate(rows):
    """Of accesses to data, in percent: misses of the first-level cache."""
    def middle(column):
        values = numbers(rows, column)
        return median(values) if values else 0
    has_writes = bool(numbers(rows, "d1_write_misses"))  # which not every processor counts
    accesses = middle("data_reads") + (middle("data_writes") if has_writes else 0)
    return 0 if accesses == 0 else 100 * (middle("d1_read_misses") + middle("d1_write_misses")) / accesses


def per_sample(rows, column):
    values = numbers(rows, column)
    return f"{median(values) / rows[0]['paths']:.3f}" if values else ""


def misses(counted):
    table = Table(f"Cache misses of one thread, by {counted[0]['source']}",
                  ["pool", "part", "width", "framebuffer", "layout", "first-level misses",
                   "first-level write misses, a sample", "last-level read misses, a sample",
                   "last-level write misses, a sample"])
    for engine in distinct(counted, "engine"):
        for part in distinct(counted, "part"):
            for width in distinct(counted, "width"):
                for layout in distinct(counted, "layout"):
                    rows = where(counted, engine=engine, part=part, width=width, layout=layout)
                    if rows:
                        counts = ("d1_write_misses", "ll_read_misses", "ll_write_misses")
                        table.rows.append([engine, part, str(width), sums_text(rows), layout, f"{miss_rate(rows):.2f} %",
                                           *(per_sample(rows, column) for column in counts)])
    return table


def about_misses(run, counted):
    """The paper's claim, held against the shared pool and the larger image."""
    least_gain = 0.95  # the paper's is 8/11; a twentieth less is not what it speaks of
    finding = Finding("an interleaved framebuffer has fewer cache misses than three planes", source="Figure 11",
                      paper="11 % to 8 %")
    if not counted:
        finding.why = f"no hardware counters, and {run['facts']['why_nothing_is_simulated']}"
        return finding
    width = max(numbers(counted, "width"))

    def rate_of(part, layout):
        return miss_rate(where(counted, engine=SHARED_POOL, part=part, width=width, layout=layout))
    planar, interleaved = rate_of("render", "planar"), rate_of("render", "interleaved")
    if planar == 0:
        finding.why = "nothing was counted"
        return finding
    finding.ours = (f"{planar:.2f} % to {interleaved:.2f} % of accesses to data, first-level cache, "
                    f"by {counted[0]['source']}")
    if len(distinct(counted, "part")) > 1:
        finding.ours += (f"; of those that add to the sums, {rate_of('accumulate', 'planar'):.2f} % to "
                         f"{rate_of('accumulate', 'interleaved'):.2f} %")
    finding.verdict = judged(interleaved < least_gain * planar)
    if finding.verdict == Verdict.DOES_NOT_HOLD:
        finding.why = "of the whole render, not a twentieth fewer"
    return finding


def about_time(gain, threads):
    nothing = 1.02  # two in a hundred: below what runs differ by
    finding = Finding("an interleaved framebuffer is no gain in time",
                      f"planes take {text(gain, 3)} times as long, the paper's pool, {threads_text(threads)}",
                      source="Figure 11", paper="none")
    if gain.runs < LEAST_RUNS:
        finding.why = f"fewer than {LEAST_RUNS} runs"
    elif gain.high < nothing:
        finding.verdict = Verdict.HOLDS
    elif gain.low > 1 and gain.median >= nothing:
        finding.verdict = Verdict.DOES_NOT_HOLD
    else:
        finding.why = "the runs are too far apart to exclude a gain of 2 %"
    return finding


def notes(run, counted):
    facts = run["facts"]
    if facts["second_level_cache_bytes"] > 0:
        yield f"Second-level cache here: {facts['second_level_cache_bytes'] // 1024} KiB."
    yield ("Time: of the whole render, with making the planes and putting them together at its end. Not in it for any "
           "layout: the framebuffer's own making.")
    if counted and counted[0]["source"] == "cachegrind":
        yield ("Misses: no hardware counters here, so by cachegrind, which simulates caches (bytes, ways, line: "
               f"{facts['simulated_first_level']} and {facts['simulated_last_level']}) and counts the same every time. "
               "`render` is the functions of the wavefront engine, but for putting planes together at the end; "
               "`accumulate` is what of that adds to the framebuffer.")


def summarise(run, rows):
    clock, counted = where(rows, source="clock"), misses_of(rows)
    table, gains = times(clock)
    summary = Summary(tables=[table, *([misses(counted)] if counted else [])])
    summary.findings = [about_misses(run, counted), about_time(spread(gains), distinct(clock, "threads")[-1])]
    beside = " Right: first-level cache misses of one thread." if counted else ""
    summary.pictures.append(Picture(
        "framebuffer", "Three sums side by side, or three planes",
        f"Left: time of a thread for each sample, median with lowest and highest run, taken in turns.{beside} What to "
        "see: whether the two bars of a pair differ by more than their whiskers. Most of what a pool reads and writes "
        "are records, not sums."))
    summary.notes = list(notes(run, counted))
    return summary


PICTURES = {"framebuffer": framebuffer}
