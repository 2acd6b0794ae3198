"""The paper's Table 3: times of a CPU's threads and of a GPU, by the width of the image; and how full forms keep a GPU."""
from .data import distinct, numbers, where
from .drawing import COLOURS, MARKERS, line, plt
from .spreads import ratios, spread, text, threads_text
from .summary import Finding, Picture, Summary, Table
from .verdict import is_at_least, judged, why_open

PAPER = "23.9/12.1, 46.2/19.2, 91.2/36.2, 204.9/73.9, 362.9/127.7 s (16 threads/CUDA) for widths 400, 560, 800, 1200, 1600"
NO_GPU = "no rows of a GPU: none was in the machine, or the build has no nvcc"


def is_gpu(row):
    return row["device"] is not None


def ways(rows):
    """(name, rows) of each engine by its threads, and of each form of the GPU."""
    for engine, threads in distinct(rows, "engine", "threads"):
        here = where(rows, engine=engine, threads=threads)
        yield engine if is_gpu(here[0]) else f"{engine}, {threads_text(threads)}", here


def table3(run, rows):
    rows = where(rows, kind="render")
    figure, axis = plt.subplots(figsize=(9.5, 5.2))
    for index, (name, here) in enumerate(ways(rows)):
        widths = distinct(here, "width")
        line(axis, widths, [spread(numbers(where(here, width=width), "seconds")) for width in widths], index=index, label=name,
             linestyle="-" if is_gpu(here[0]) else "--")
    axis.set_xscale("log")
    axis.set_yscale("log")
    axis.set_xticks(distinct(rows, "width"), [f"{width:.0f}" for width in distinct(rows, "width")])
    axis.minorticks_off()
    axis.set_xlabel("width of the image, pixels")
    axis.set_ylabel("seconds")
    axis.legend(loc="upper left", bbox_to_anchor=(1, 1))
    return figure


def occupancy(run, rows):
    rows = where(rows, kind="occupancy")
    figure, (left, right) = plt.subplots(1, 2, figsize=(10, 4.6), sharex=True)
    for index, form in enumerate(distinct(rows, "engine")):
        here = where(rows, engine=form)
        rounds = [row["round"] for row in here]
        style = {"color": COLOURS[index], "marker": MARKERS[index], "markersize": 4, "linewidth": 1.2, "label": form}
        left.plot(rounds, [row["live"] / row["lanes"] for row in here], **style)
        right.plot(rounds, [row["live"] for row in here], **style)
    left.set_ylabel("share of lanes that trace a segment")
    left.set_ylim(0, 1.05)
    right.set_ylabel("paths under way")
    right.set_yscale("log")
    for axis in (left, right):
        axis.set_xscale("log")
        axis.set_xlabel("round")
        axis.xaxis.set_major_formatter(plt.FuncFormatter(lambda x, _: f"{x:g}"))
    right.legend(loc="lower left")
    return figure


def busy(rows):
    """The share of the lanes of all rounds that traced a segment."""
    return sum(numbers(rows, "live")) / sum(numbers(rows, "lanes"))


def fullness(rows):
    table = Table("How full forms keep the lanes of warps, over all rounds", ["form", "threads or records", "rounds", "lanes busy"])
    for form in distinct(rows, "engine"):
        here = where(rows, engine=form)
        room = "one a path" if here[0]["room"] is None else f"{here[0]['room']:,}"
        table.rows.append([form, room, str(len(here)), f"{busy(here):.3f}"])
    return table


def fullness_finding(rows):
    claim = "forms that take new paths keep at least twice the lanes busy that a thread a path does"
    shares = {form: busy(where(rows, engine=form)) for form in distinct(rows, "engine")}
    mega = shares.pop("gpu mega", None)
    if mega is None or not shares:
        return Finding(claim, why="not all forms were asked for")
    ours = f"gpu mega {mega:.3f}; " + ", ".join(f"{form} {share:.3f}" for form, share in shares.items())
    return Finding(claim, ours, judged(min(shares.values()) >= 2 * mega))


def times(rows):
    table = Table("Seconds of a render; of a GPU, kernels alone as well", ["width", "by", "seconds", "kernels", "M paths/s", "hash"])
    for width in distinct(rows, "width"):
        for name, here in ways(where(rows, width=width)):
            kernels = numbers(here, "kernel_seconds")
            table.rows.append([str(width), name, text(spread(numbers(here, "seconds")), 3),
                               text(spread(kernels), 3) if kernels else "", text(spread(numbers(here, "mpaths_per_s"))),
                               here[0]["hash"]])
    return table


def lead(rows, width, engine, least, claim, forms=None, paper=""):
    """Of the fastest form over an engine of the CPU by most threads up to the paper's 16."""
    here = where(rows, width=width)
    of_gpu = [row for row in here if is_gpu(row) and (forms is None or row["engine"] in forms)]
    if not of_gpu:
        return Finding(claim, why=NO_GPU, paper=paper)
    threads = max((count for count in distinct(where(here, engine=engine), "threads") if count <= 16), default=None)
    if threads is None:
        return Finding(claim, why="no rows of a CPU", paper=paper)
    cpu = numbers(where(here, engine=engine, threads=threads), "seconds")
    form, found = max(((form, spread(ratios(cpu, numbers(where(of_gpu, engine=form), "seconds"))))
                       for form in distinct(of_gpu, "engine")), key=lambda item: item[1].median)
    return Finding(claim, f"{text(found)} by {form} over {engine}, {threads_text(threads)}, {width} wide",
                   is_at_least(found, least), why_open(found, least), paper=paper)


def add_times(summary, rows):
    widest = max(distinct(rows, "width"))
    pool = next((row["engine"] for row in rows if not is_gpu(row) and row["engine"] != "recursive"), None)
    summary.tables.append(times(rows))
    summary.findings += [
        lead(rows, widest, "recursive", 2, "a GPU is at least twice as fast as 16 threads", paper=PAPER),
        lead(rows, widest, pool, 10, "a GPU that keeps its threads busy is at least ten times as fast as the pool by 16 threads",
             forms=("gpu mega-regenerate", "gpu wave"))]
    summary.pictures.append(Picture(
        "table3", "A CPU's threads and a GPU, by the width of the image",
        "Seconds of a render, both axes in powers: dashed by threads of the CPU, solid by a GPU, the whole of it with copies. "
        "What to see: whether lines are as steep as each other, so that a lead does not depend on the width."))
    summary.notes.append(
        "Images of one width have one hash, or the study stops. The paper's times are of 16 threads of four sockets and of a GPU "
        "of its time, in a scene that is not published.")


def add_fullness(summary, rows):
    summary.tables.append(fullness(rows))
    summary.findings.append(fullness_finding(rows))
    summary.pictures.append(Picture(
        "occupancy", "How full each form keeps a GPU, round by round",
        "Counted from the lengths of paths, on no GPU: a round is a segment of every path under way, all warps in step. Left: of the "
        "lanes of warps that have a path, those that trace a segment. Right: such paths. What to see: a thread a path waits for the "
        "longest path of its warp; threads that take new paths, and a pool, stay full until no path is left to begin."))


def summarise(run, rows):
    summary = Summary()
    for kind, add in (("render", add_times), ("occupancy", add_fullness)):
        if where(rows, kind=kind):
            add(summary, where(rows, kind=kind))
    return summary


PICTURES = {"table3": table3, "occupancy": occupancy}
