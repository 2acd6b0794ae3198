"""Time of each way of handing out the image, by engine and thread count: the paper's Figures 9 and 10."""
from .data import distinct, numbers, where
from .drawing import COLOURS, HATCHES, bars, plt
from .spreads import ratios, spread, text
from .summary import Finding, Picture, Summary, Table
from .verdict import is_at_least, why_open

BASIC = "lines, static (the paper's basic)"


def schedules(run, rows):
    engines, ways = distinct(rows, "engine"), distinct(rows, "way")
    threads = sorted(distinct(rows, "threads"))
    figure, axes = plt.subplots(1, len(engines), figsize=(10, 5.2), sharey=True, squeeze=False)
    for axis, engine in zip(axes[0], engines):
        height = 0.8 / len(threads)
        for i, count in enumerate(threads):
            places = [w + (i - (len(threads) - 1) / 2) * height for w in range(len(ways))]
            bars(axis, places, [spread(seconds(rows, engine, way, count)) for way in ways],
                 height=height, color=COLOURS[i], hatch=HATCHES[i], label=f"{count:.0f} thread{'s' if count > 1 else ''}")
        axis.set_yticks(range(len(ways)), ways)
        axis.set_title(engine)
        axis.set_xlabel("seconds")
        axis.grid(axis="y", visible=False)
        axis.set_xlim(left=0)
        axis.xaxis.set_major_locator(plt.MaxNLocator(5))
    axes[0][0].invert_yaxis()
    axes[0][-1].legend(loc="upper left", bbox_to_anchor=(1, 1))
    return figure


def seconds(rows, engine, way, threads):
    return numbers(where(rows, engine=engine, way=way, threads=threads), "seconds")


def times(rows, engine, most):
    table = Table(f"{engine}, {most} threads", ["way", "seconds", "ratio to basic", "speedup over one thread"])
    for way in distinct(rows, "way"):
        time = seconds(rows, engine, way, most)
        table.rows.append([way, text(spread(time), 3), text(spread(ratios(seconds(rows, engine, BASIC, most), time))),
                           text(spread(ratios(seconds(rows, engine, way, 1), time)))])
    return table


def faster_finding(rows, most, way, source, claim, paper):
    gain = spread(ratios(seconds(rows, "recursive", BASIC, most), seconds(rows, "recursive", way, most)))
    finding = Finding(claim, f"{text(gain)} times as fast, {most} threads, width {rows[0]['width']}", source=source,
                      paper=paper, why="one thread has nothing to share out")
    if most > 1:
        finding.verdict, finding.why = is_at_least(gain, 1), why_open(gain, 1)
    return finding


def summarise(run, rows):
    most = max(numbers(rows, "threads"))
    summary = Summary(tables=[times(rows, engine, most) for engine in distinct(rows, "engine")])
    summary.findings = [
        faster_finding(rows, most, "lines, static,1", "Figure 9", "static,1 is faster than the default schedule of lines",
                       "15 % faster (width 800, 40 spp, depth 125, 8 threads)"),
        faster_finding(rows, most, "pixels, static,1 (the paper's collapse)", "Figure 10",
                       "single pixels (collapse) are faster than the default schedule of lines", "faster")]
    summary.pictures.append(Picture(
        "schedules", "Time by schedule",
        "Each bar is the median time of a way to hand out the image, each whisker its lowest and highest "
        "run. Within an engine the bars differ by balance only: the work is the same. What to see: how much "
        "longer the default schedule of lines takes than the others once there is more than one thread."))
    return summary


PICTURES = {"schedules": schedules}
