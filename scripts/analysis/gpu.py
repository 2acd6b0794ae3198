"""The paper's Table 3: times of a CPU's threads and of a GPU, by the width of the image."""
from .data import distinct, numbers, where
from .drawing import line, plt
from .spreads import ratios, spread, text, threads_text
from .summary import Finding, Picture, Summary, Table
from .verdict import is_at_least, why_open

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
    threads = max(count for count in distinct(where(here, engine=engine), "threads") if count <= 16)
    cpu = numbers(where(here, engine=engine, threads=threads), "seconds")
    form, found = max(((form, spread(ratios(cpu, numbers(where(of_gpu, engine=form), "seconds"))))
                       for form in distinct(of_gpu, "engine")), key=lambda item: item[1].median)
    return Finding(claim, f"{text(found)} by {form} over {engine}, {threads_text(threads)}, {width} wide",
                   is_at_least(found, least), why_open(found, least), paper=paper)


def summarise(run, rows):
    widest = max(distinct(rows, "width"))
    pool = next(row["engine"] for row in rows if not is_gpu(row) and row["engine"] != "recursive")
    summary = Summary(tables=[times(rows)])
    summary.findings = [
        lead(rows, widest, "recursive", 2, "a GPU is at least twice as fast as 16 threads", paper=PAPER),
        lead(rows, widest, pool, 10, "a GPU that keeps its threads busy is at least ten times as fast as the pool by 16 threads",
             forms=("gpu mega-regenerate", "gpu wave"))]
    summary.pictures = [Picture(
        "table3", "A CPU's threads and a GPU, by the width of the image",
        "Seconds of a render, both axes in powers: dashed by threads of the CPU, solid by a GPU, the whole of it with copies. "
        "What to see: whether lines are as steep as each other, so that a lead does not depend on the width.")]
    summary.notes.append(
        "Images of one width have one hash, or the study stops. The paper's times are of 16 threads of four sockets and of a GPU "
        "of its time, in a scene that is not published.")
    return summary


PICTURES = {"table3": table3}
