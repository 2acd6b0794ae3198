"""From recursion to the fastest pool, rung by rung: rates, and where the time of a thread for each ray goes."""
from statistics import median

from .data import distinct, numbers, where
from .drawing import COLOURS, plt
from .spreads import ratios, spread, text, threads_text
from .summary import Finding, Picture, Summary, Table, rungs_table
from .verdict import is_at_least, why_open

BLUE, ORANGE, GREEN, RED, SKY, PINK, BLACK, YELLOW = COLOURS

# Column, label, colour, hatch: useful work in blue and green, traffic in orange and yellow, waiting in red and pink.
PARTS = [
    ("generate_s", "generate camera rays", "#004C78", ""),
    ("intersect_s", "intersect", SKY, ""),
    ("shade_s", "shade", GREEN, ""),
    ("shadow_s", "trace shadow rays", "#9E9AC8", ""),
    ("sort_s", "sort", "#7FD1B9", "xx"),
    ("accumulate_s", "accumulate", "#C8EFE4", ".."),
    ("traffic_s", "move records (estimate)", ORANGE, "//"),
    ("append_s", "append to the next round", YELLOW, "//"),
    ("barrier_s", "wait at barriers", RED, "\\\\"),
    ("end_s", "wait at the end", PINK, "\\\\"),
    ("rest", "rest", "#FFFFFF", ""),
]
SHORT = {"shadow_s": "shadow rays", "traffic_s": "moved records (estimate)", "barrier_s": "barriers",
         "end_s": "waiting at the end"}
WHOLE = ("whole path, not split", "#999999", "")


def parts_in(rows):
    """PARTS without shadow rays where there are none."""
    return [part for part in PARTS if part[0] != "shadow_s" or any(row.get("shadow_s") for row in rows)]


def thread_ns(row):
    return row["seconds"] * row["threads"] / row["segments"] * 1e9


def parts_of(rows):
    """Parts of a bar whose length is the median run without clocks, in the shares of the runs with clocks."""
    split = [row for row in rows if row["clocks"] == "on"]
    length = median(thread_ns(row) for row in rows if row["clocks"] == "off")
    if not split:
        return [(length, *WHOLE)]
    in_all = [row["seconds"] * row["threads"] for row in split]
    shown = parts_in(split)
    shares = [median(row[column] / whole for row, whole in zip(split, in_all)) for column, *_ in shown[:-1]]
    shares.append(max(0, 1 - sum(shares)))
    return [(length * share / sum(shares), *style) for share, (_, *style) in zip(shares, shown)]


def ratio_text(rows, recursive):
    ratio = spread(ratios(numbers(rows, "mpaths_per_s"), numbers(recursive, "mpaths_per_s")))
    return f"{ratio.median:.2f}×  ({ratio.low:.2f} to {ratio.high:.2f})"


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
                                    linewidth=0.5, label=label)
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


def rate(rows, engine):
    return numbers(where(rows, clocks="off", engine=engine), "mpaths_per_s")


def clock_cost(engine_rows):
    """Time with clocks over time without, where there are both."""
    on, off = (numbers(where(engine_rows, clocks=clocks), "seconds") for clocks in ("on", "off"))
    return ratios(on, off)


def rates(here, threads):
    table = Table(f"Rates, {threads_text(threads)}", ["rung", "M paths/s", "ratio to recursive", "waiting",
                                                      "cost of the clocks"])
    for engine in distinct(here, "engine"):
        rows = where(here, engine=engine)
        waits, cost = numbers(where(rows, clocks="off"), "waiting"), clock_cost(rows)
        table.rows.append([engine, text(spread(rate(here, engine))),
                           text(spread(ratios(rate(here, engine), rate(here, "recursive")))),
                           f"{100 * median(waits):.1f} %" if waits else "", text(spread(cost)) if cost else ""])
    return table


def parts(here, threads):
    split = where(here, clocks="on")
    columns = [column for column, *_ in parts_in(split)[:-1]]
    table = Table(f"Time of a thread for each segment, ns, {threads_text(threads)}",
                  ["rung", *(SHORT.get(column, column.removesuffix("_s")) for column in columns), "rest", "in all"])
    for engine in distinct(split, "engine"):
        rows = where(split, engine=engine)
        in_all = median(thread_ns(row) for row in rows)
        found = [median(numbers(rows, column)) / rows[0]["segments"] * 1e9 for column in columns]
        rest = in_all
        for ns in found:
            rest -= ns
        table.rows.append([engine, *(f"{ns:.2f}" for ns in (*found, max(rest, 0), in_all))])
    return table


def goal(rows, engine, claim, threads, least, note):
    here = where(rows, threads=threads)
    ratio = spread(ratios(rate(here, engine), rate(here, "recursive")))
    return Finding(claim, f"{text(ratio)} ({engine}), {threads_text(threads)}", is_at_least(ratio, least),
                   why_open(ratio, least), paper=f"at least {least:g} times as fast{note}")


def goals(run, rows):
    """What the project set out to reach."""
    least, registers = {16: (4, "AVX-512"), 8: (2.5, "AVX2"), 4: (1, "NEON")}[run["environment"]["simd"]["stage_lanes"]["float"]]
    yield goal(rows, "beam", "a pool is much faster than the best recursion", 1, least, f" ({registers})")
    if max(numbers(rows, "threads")) == 2:
        yield goal(rows, "shared-stream", "the paper's shared pool, with wide stages, is faster than recursion", 2, 1.5, "")


def summarise(run, rows):
    summary = Summary(findings=list(goals(run, rows)))
    overheads = []
    for threads in distinct(rows, "threads"):
        here = where(rows, threads=threads)
        summary.tables += [rates(here, threads), parts(here, threads)]
        for engine in distinct(here, "engine"):
            overheads += clock_cost(where(here, engine=engine))
    summary.tables += rungs_table(run)
    summary.pictures.append(Picture(
        "ladder", "Where the time goes, rung by rung",
        "Each bar is the time of a thread for one ray (median run, so shorter is better); at its end, how many "
        "times as fast as recursion, with the lowest and highest run. What to see: which part of a bar "
        "each step shortens: useful work is blue and green, waiting red, moving records orange. A whole path of "
        "recursion, or of Embree, has no stages to tell apart."))
    summary.notes = [
        f"The split is that of runs with clocks on, which take {text(spread(overheads), 3)} times as long (all rungs); "
        "rates and ratios are of runs with clocks off.",
        "Moved records: an estimate, from the number of records shaded and a pass, measured beside each run, that "
        "reads and writes records and does nothing else; it is taken off shading.",
        "Barriers: waiting for the slowest thread of a round and the barrier itself, which a clock cannot tell "
        "apart. The rest of a bar is what no clock saw: starting threads, clearing memory, the loops themselves."]
    return summary


PICTURES = {"ladder": ladder}
