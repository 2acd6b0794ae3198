"""Efficiency of every schedule, replayed for many threads; and the replay held against real runs."""
from statistics import median
from typing import NamedTuple

from .data import distinct, numbers, where
from .drawing import COLOURS, MARKERS, plt, remember
from .spreads import Spread, ratios, spread, text
from .summary import Finding, Picture, Summary, Table
from .verdict import Verdict, judged


def replay(run, rows):
    rows = where(rows, kind="replayed")
    groups = distinct(rows, "group")
    figure, axes = plt.subplots(2, 2, figsize=(14, 8), sharex=True, sharey=True)
    for axis, group in zip(axes.flat, groups):
        own = where(rows, group=group)
        for i, way in enumerate(distinct(own, "way")):
            points = sorted(where(own, way=way), key=lambda row: row["threads"])
            threads = [row["threads"] for row in points]
            colour = COLOURS[i % len(COLOURS)]
            axis.plot(threads, [100 * row["efficiency_time"] for row in points], color=colour,
                      marker=MARKERS[i % len(MARKERS)], markersize=4.5, label=way)
            axis.plot(threads, [100 * row["efficiency_costs"] for row in points], color=colour, linestyle="--", linewidth=0.9)
        threads = sorted(distinct(own, "threads"))
        axis.plot(threads, [100 * max(row["efficiency_bound"] for row in where(own, threads=n)) for n in threads],
                  color="black", linestyle=":", linewidth=1.2, label="perfect balance")
        axis.set_title(group)
        axis.set_xscale("log", base=2)
        ticks = [t for t in sorted(distinct(own, "threads")) if t == 1 or t ** 0.5 == int(t ** 0.5) or t < 4]
        axis.set_xticks(ticks, [f"{t:.0f}" for t in ticks])
        axis.minorticks_off()
        axis.set_ylim(0, 103)
        axis.legend(loc="upper left", bbox_to_anchor=(1, 1), fontsize=8.5)
    for axis in axes[:, 0]:
        axis.set_ylabel("efficiency, %")
    for axis in axes[1]:
        axis.set_xlabel("threads")
    return figure


def reality(run, rows):
    real = where(rows, kind="real")
    most = max(distinct(real, "threads"))
    ways = distinct(real, "way")
    figure, axes = plt.subplots(1, 2, figsize=(12, 5.2), sharey=True)
    for place, way in enumerate(ways):
        replayed = {row["threads"]: row["efficiency_costs"] for row in where(rows, kind="replayed", way=way)}
        one = {row["repeat"]: row["seconds"] for row in where(real, way=way, threads=1)}
        shared = where(real, way=way, threads=most)
        clock = [100 * one[row["repeat"]] / row["seconds"] / most for row in shared]
        balance = [100 * row["processor_balance"] for row in shared]
        axes[0].plot(100 * replayed[most] / replayed[1], place, marker="d", color="#888888", linestyle="none", markersize=5,
                     label="replayed, equal speeds")
        for axis, measured, column in ((axes[0], clock, "predicted"), (axes[1], balance, "predicted_balance")):
            predicted = 100 * median(row[column] for row in shared)
            middle = median(measured)
            ground = axis.barh(place, 6, left=predicted - 3, height=0.75, color="#D9D9D9", label="within 3 points")
            ground.is_data = False  # for points.py
            axis.plot(predicted, place - 0.15, marker="D", color=COLOURS[0], linestyle="none", markersize=6.5,
                      label="replayed, their speeds")
            drawn = axis.errorbar(middle, place + 0.18, xerr=[[middle - min(measured)], [max(measured) - middle]],
                                  color=COLOURS[3], marker="o", markerfacecolor="white", markersize=6.5, capsize=2.5,
                                  elinewidth=1, linestyle="none", label="measured")
            remember(drawn[0], [spread(measured)], "x", "measured")
    for axis, what in zip(axes, ("speedup / threads, by the clock, %", "mean / largest processor time, %")):
        axis.set_xlabel(f"{what}, {most:.0f} threads")
        axis.grid(axis="y", visible=False)
    axes[0].set_yticks(range(len(ways)), ways)
    axes[0].invert_yaxis()
    handles = dict(zip(*reversed(axes[0].get_legend_handles_labels())))
    axes[1].legend(handles.values(), handles.keys(), loc="upper left", bbox_to_anchor=(1, 1), fontsize=9)
    return figure


BELIEVED = 3  # points of efficiency between replay and reality
QUIET = 2 * BELIEVED  # points between the quartiles
OURS = 0.97  # of the time on a processor
THREAD_POOLS = "a pool for each thread"
DEFAULT_POOL = "a pool each, balanced (default)"


def percent(value):
    return f"{100 * value:.1f}"


class Repeated:
    """An efficiency over repeats; the noise is between its quartiles, in points."""

    def __init__(self, values):
        self.efficiency = spread(values)
        ordered, quarter = sorted(values), len(values) // 4
        self.noise = 100 * (ordered[-1 - quarter] - ordered[quarter])

    def __str__(self):
        return f"{percent(self.efficiency.median)} ({percent(self.efficiency.low)} to {percent(self.efficiency.high)})"


class Comparison(NamedTuple):
    """Predicted and measured efficiency of a way. By the clock it is speedup over threads, by processor time balance
    alone."""
    equal: float  # predicted for threads of equal speed
    predicted_clock: float
    predicted_balance: float
    clock: Repeated
    balance: Repeated
    on_processor: float
    slowest: Spread  # thread, when all do the same
    fastest: Spread


def compare(rows, way, threads):
    replayed = {row["threads"]: row["efficiency_costs"] for row in where(rows, kind="replayed", way=way)}
    makespans = [1 / (n * replayed[n]) for n in (1, threads)]  # of work 1
    alone, shared = (where(rows, kind="real", way=way, threads=n) for n in (1, threads))
    speedups = ratios(numbers(alone, "seconds"), numbers(shared, "seconds"))
    return Comparison(makespans[0] / (threads * makespans[1]), median(numbers(shared, "predicted")),
                      median(numbers(shared, "predicted_balance")), Repeated([s / threads for s in speedups]),
                      Repeated(numbers(shared, "processor_balance")), median(numbers(shared, "on_processor")),
                      spread(numbers(shared, "speed_low")), spread(numbers(shared, "speed_high")))


def judge(way, c, threads):
    """By the clock where the machine was ours and the runs agree; by processor time where other work spoilt the clock."""
    is_clock = c.on_processor >= OURS and c.clock.noise <= QUIET
    measured, predicted = (c.clock, c.predicted_clock) if is_clock else (c.balance, c.predicted_balance)
    miss = 100 * abs(predicted - measured.efficiency.median)
    finding = Finding(f"a replay tells the efficiency of {way}",
                      f"predicted {percent(predicted)} ({percent(c.equal)} if both threads were as fast as one alone), "
                      f"measured {measured} % by {'the clock' if is_clock else 'processor time'}",
                      paper=f"within {BELIEVED:.0f} points")
    if threads == 1:
        finding.why = "one thread has nothing to share out"
    elif measured.noise > QUIET:
        finding.why = f"the middle half of the runs is {measured.noise:.0f} points wide: the machine was not quiet"
    elif not is_clock and "static" not in way and miss > BELIEVED:
        finding.why = ("other work took the machine, and a loop that hands out work on demand gives a disturbed thread "
                       "less")
    else:
        finding.verdict = judged(miss <= BELIEVED)
        if not is_clock:
            finding.why = ("by balance of processor time; the clock is spoilt by other work (busiest thread "
                           f"{100 * c.on_processor:.0f} % of the time on a processor, runs {c.clock.noise:.0f} points wide)")
    return finding


def add_comparison(summary, rows):
    """Replay against reality: a verdict for each schedule."""
    real = where(rows, kind="real")
    threads = max(numbers(real, "threads"))
    table = Table(f"Replay against reality, {threads} threads, efficiency in %",
                  ["way", "predicted, equal speed", "predicted, their speeds", "by the clock", "balance: predicted",
                   "balance: by processor time", "slowest thread's speed", "fastest"])
    for way in distinct(real, "way"):
        c = compare(rows, way, threads)
        table.rows.append([way, percent(c.equal), percent(c.predicted_clock), str(c.clock), percent(c.predicted_balance),
                           str(c.balance), text(c.slowest), text(c.fastest)])
        summary.findings.append(judge(way, c, threads))
    summary.tables.append(table)


def pool_finding(replayed, threads):
    """The fast pool's balance at 64 threads."""
    reach = 1.02
    loads = {row["way"]: row["max_over_mean"] for row in where(replayed, group=THREAD_POOLS, threads=threads)}
    best = min(loads, key=loads.get)
    finding = Finding(f"the fast pool can be balanced over {threads} threads",
                      f"{loads[best]:.3f} by \"{best}\"; {loads[DEFAULT_POOL]:.3f} by \"{DEFAULT_POOL}\"",
                      paper=f"max/mean of tests at most {reach}")
    if threads < 64:
        finding.verdict, finding.why = Verdict.CANNOT_TELL, "takes a replay of 64 threads"
    else:
        finding.verdict = judged(loads[best] <= reach)
    return finding


def efficiencies(replayed, column, title):
    shown = distinct(replayed, "threads")[1::2]
    table = Table(title, ["way", *map(str, shown)])
    for way in distinct(replayed, "way"):
        found = {row["threads"]: row[column] for row in where(replayed, way=way)}
        table.rows.append([way, *(percent(found[n]) for n in shown)])
    return table


def costs(rows, title, header, name, **digits):
    """What was measured or fitted, a line each: its name, and columns with so many digits."""
    return Table(title, header, [[str(row[name]), *(f"{row[column]:.{n}f}" for column, n in digits.items())]
                                 for row in rows])


def summarise(run, rows):
    summary = Summary()
    replayed = where(rows, kind="replayed")
    counts = distinct(replayed, "threads")
    add_comparison(summary, rows)
    summary.findings.append(pool_finding(replayed, max(n for n in counts if n <= 64)))
    if len(counts) > 1:
        summary.tables += [
            efficiencies(replayed, "efficiency_tests", "Balance alone, counted in tests: efficiency in %, by threads"),
            efficiencies(replayed, "efficiency_costs",
                         "In modelled seconds, with chunk fetches and barriers: efficiency in %, by threads")]
    summary.tables += [
        costs(where(rows, kind="openmp"), "What OpenMP costs here", ["threads", "chunk fetch, ns", "barrier, ns"],
              "threads", fetch_ns=0, barrier_ns=0),
        costs(where(rows, kind="model"), "What a segment is taken to cost",
              ["engine", "ns", "ns for each box or primitive test"], "way", segment_ns=1, test_ns=2)]
    fit_error = numbers(where(rows, kind="model"), "fit_error")[0]

    summary.pictures = [
        Picture("replay", "How far each schedule would scale, if threads were all that it takes",
                "Each line is one way to share out the same recorded work; thin dashed lines add what fetching chunks and "
                "waiting at barriers cost here, the dotted line is the best that these grains allow. What to see: at how "
                "many threads each way leaves the top. It is where the grain runs out: there are as many lines as the image "
                "is high, as many batches as fit into the pool."),
        Picture("reality", "Replay against reality",
                "Filled: predicted by replay at the speeds that the threads have when all do the same, with a band "
                f"of {BELIEVED:.0f} points either side; small grey: if all were as fast as one alone. Open, with whiskers "
                "from the lowest to the highest run: measured. Left by the clock, right by processor time, which "
                "shows balance alone where other work disturbs the clock. What to see: the open marks lie within the bands.")]
    summary.notes = [
        "Replay against reality: beside each real run all threads traced the same lines at once, which shows what a "
        "perfectly balanced run of this work reaches, and how fast each thread is. Cores of a virtual machine differ in "
        "speed: static schedules then wait for the slowest, and dynamic ones give it less.",
        "What a segment costs was fitted to the recursive tracer's processor time, line by line on one thread; lines "
        f"lie around it with a standard deviation of {100 * fit_error:.1f} % of their mean. For pools it is scaled to "
        "their own time.",
        "Pools test rays in streams and packets, so a segment's tests by a single ray stand in for theirs. A path of a "
        "shared pool stays in its batch; equal shares are cut anew from the rays still alive. Loops and the default pool "
        "are held against real runs here: what is said of other pools is a prediction.",
        "A replay knows balance, chunk fetches and barriers, and nothing of memory, caches or sockets: it bounds "
        "efficiency from above. Beyond the cores of this machine a chunk fetch costs what it costs with all of them, "
        "and a barrier grows with the logarithm of the threads; a round has three barriers."]
    return summary


PICTURES = {"replay": replay, "reality": reality}
