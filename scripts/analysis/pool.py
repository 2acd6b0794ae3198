"""How large a pool must be to beat recursion, whose and refilled when; and how full it is from round to round."""
from .crossover import AtCapacity, best, crossover
from .data import distinct, grouped, numbers, where
from .drawing import COLOURS, line, plt
from .spreads import ratios, spread, text, threads_text
from .summary import Finding, Picture, Summary, Table
from .verdict import Verdict, is_at_least, why_open

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
            spreads = [spread(ratios(numbers(runs, "mpaths_per_s"), recursion)) for _, runs in groups]
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


PAPER_POOL = "the paper's pool"
OPPOSITE = {Verdict.HOLDS: Verdict.DOES_NOT_HOLD, Verdict.DOES_NOT_HOLD: Verdict.HOLDS,
            Verdict.CANNOT_TELL: Verdict.CANNOT_TELL}


def to_recursion(here, rows):
    """Of rows of one case, to the recursion of the same thread count in `here`."""
    return spread(ratios(numbers(rows, "mpaths_per_s"), numbers(where(here, axis="recursion"), "mpaths_per_s")))


def ratios_by_capacity(here, pool):
    rows = where(here, axis="capacity", engine=pool)
    return [AtCapacity(size, to_recursion(here, where(rows, capacity=size))) for size in sorted(distinct(rows, "capacity"))]


def pools_of(rows):
    """In the order of the picture's lines."""
    return distinct(where(rows, axis="capacity"), "engine")


def by_capacity(here, threads):
    table = Table(f"Ratio to recursion by capacity, {threads_text(threads)}",
                  ["pool", *(str(at.capacity) for at in ratios_by_capacity(here, PAPER_POOL))])
    table.rows = [[pool, *(text(at.ratio) for at in ratios_by_capacity(here, pool))] for pool in pools_of(here)]
    return table


def crossings(rows, counts):
    table = Table("The smallest capacity that beats recursion in every run", ["pool", *map(threads_text, counts)])
    table.rows = [[pool, *(str(crossover(ratios_by_capacity(where(rows, threads=threads), pool))) for threads in counts)]
                  for pool in pools_of(rows)]
    return table


def by_sort(here, threads):
    table = Table(f"Sorting by material, {threads_text(threads)}",
                  ["pool", "capacity", "ratio to recursion, unsorted", "sorted", "sorted over unsorted"])
    everything = where(here, axis="sort")
    for pool in distinct(everything, "engine"):
        unsorted, by_material = (where(everything, engine=pool, sort=sort) for sort in ("none", "material"))
        gain = ratios(numbers(by_material, "mpaths_per_s"), numbers(unsorted, "mpaths_per_s"))
        table.rows.append([pool, str(unsorted[0]["capacity"]), text(to_recursion(here, unsorted)),
                           text(to_recursion(here, by_material)), text(spread(gain))])
    return table


def by_batch(rows):
    everything = where(rows, axis="batch")
    here = where(rows, threads=everything[0]["threads"])
    batches = distinct(everything, "batch")
    table = Table(f"Ratio to recursion by batch, {threads_text(everything[0]['threads'])}", ["pool", *map(str, batches)])
    table.rows = [[pool, *(text(to_recursion(here, where(everything, engine=pool, batch=batch))) for batch in batches)]
                  for pool in distinct(everything, "engine")]
    return table


def by_depth(rows):
    """How the pool that drains thins out, its fillings added up."""
    drained = where(rows, axis="rounds", refill="drain")
    table = Table(f"Rounds of a shared pool of {drained[0]['capacity']} records that drains, by depth",
                  ["depth", "fillings that get there", "records, mean", "of those at depth 1", "survive", "lanes filled"])
    fillings = len(where(drained, depth=1))
    at_first = 0
    for depth in distinct(drained, "depth"):
        here = where(drained, depth=depth)
        records, survivors, lanes = (sum(numbers(here, column)) for column in ("records_in", "records_out", "lanes"))
        at_first = at_first or records
        if depth <= 10 or depth % 10 == 0:  # data.csv has all
            table.rows.append([str(depth), str(len(here)), f"{records / fillings:.1f}", f"{100 * records / at_first:.3g} %",
                               f"{100 * survivors / records:.0f} %", f"{100 * records / lanes:.0f} %"])
    return table


def slower_finding(here, threads, pool, which):
    """The best capacity of a pool decides whether it is slower than recursion."""
    at = best(ratios_by_capacity(here, pool))
    return Finding(f"the pool is slower than recursion (here: lines, dynamic): {which}",
                   f"at its best capacity, {at.capacity} records, {text(at.ratio)} times as fast as recursion, "
                   f"{threads_text(threads)}", OPPOSITE[is_at_least(at.ratio, 1)], why_open(at.ratio, 1),
                   source="Figure 8", paper="slower")


def summarise(run, rows):
    counts = distinct(where(rows, axis="recursion"), "threads")
    by_count = {threads: where(rows, threads=threads) for threads in counts}
    summary = Summary()
    summary.tables = [*(by_capacity(here, threads) for threads, here in by_count.items()), crossings(rows, counts),
                      *(by_sort(here, threads) for threads, here in by_count.items()), by_batch(rows), by_depth(rows)]
    summary.findings = [slower_finding(by_count[counts[-1]], counts[-1], *pool) for pool in (
        (PAPER_POOL, "as the paper has it, a ray at a time"),
        ("shared, drain", "the same pool with wide stages and streams"),
        ("thread, regenerate, beam", "a pool for each thread, refilled at once"))]
    summary.pictures = [
        Picture("capacity", "How large a pool must be to beat recursion",
                "Each line is a pool, by its capacity: how many times as fast as recursion, with a band from the lowest to "
                "the highest run. What to see: where a line rises above 1, the pool wins. Compare the paper's pool, a ray at "
                "a time (black), with the same pool made wide (red, orange) and with pools of the threads' own (blue)."),
        Picture("rounds", "How full the pool is, round by round",
                "Left: records in a shared pool, from round to round, while the same paths are rendered. Right: the pool "
                "that drains, its fillings added up: what is left of its records, and how full the registers are that treat "
                "them. What to see: for how many of its rounds a pool that drains works on next to nothing, and that one "
                "that is refilled at once stays full and needs fewer.")]
    summary.notes.append(
        "Capacity is of each pool; the largest holds every path of the render. To beat recursion is to be faster in "
        "every one of the runs taken side by side. Batches of a shared pool are at most 4096 records, and small enough "
        "that each thread finds two. Making the pool is part of the time: a large pool of a short render pays for it.")
    return summary


PICTURES = {"capacity": capacity, "rounds": rounds}
