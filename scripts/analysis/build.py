"""How fast trees over triangles are built, ours and Embree's, and what rays pay on them."""
import statistics

from .data import distinct, numbers, where
from .drawing import line, plt
from .spreads import ratios, spread, text, threads_text
from .summary import Finding, Picture, Summary, Table
from .verdict import Verdict, is_at_least, why_open

OURS = "ours"
SAH = "embree-sah"
ROBUST = "embree-robust"
RAYS = ["camera", "first_bounce", "fourth_bounce", "shadow"]
LEAST = 0.95  # of rays a second, and of a random line's visits the other way round


def rate_column(rays):
    return f"{rays}_mrays_per_s"


def meshes(rows):
    """(name, rows) of each."""
    for kind, triangles in distinct(rows, "kind", "triangles"):
        yield f"{triangles} {kind}", where(rows, kind=kind, triangles=triangles)


def ratio(rows, column, builder, to):
    """Of two builders, over the runs side by side."""
    return spread(ratios(*(numbers(where(rows, builder=b), column) for b in (builder, to))))


def builders_table(rows):
    table = Table("What is built, in what time and memory, and what rays pay on it",
                  ["mesh", "threads", "builder", "seconds", "of these, binary tree", "M triangles/s", "bytes a triangle",
                   "peak bytes a triangle", "nodes by SAH", "leaves by SAH", "leaf fill", "depth",
                   *(f"{rays.replace('_', ' ')}, M rays/s" for rays in RAYS)])

    def median(here, column, digits, scale=1.0):
        values = numbers(here, column)
        return f"{statistics.median(values) * scale:.{digits}f}" if values else ""
    for mesh, of_mesh in meshes(rows):
        for threads in distinct(of_mesh, "threads"):
            for builder in distinct(where(of_mesh, threads=threads), "builder"):
                here = where(of_mesh, threads=threads, builder=builder)
                a_triangle = 1 / here[0]["triangles"]
                table.rows.append([
                    mesh, str(threads), builder, text(spread(numbers(here, "seconds")), 4), median(here, "binary_seconds", 4),
                    median(here, "mtriangles_per_s", 2), median(here, "tree_bytes", 1, a_triangle),
                    median(here, "peak_bytes", 0, a_triangle), median(here, "node_visits", 2),
                    median(here, "leaf_visits", 2), median(here, "leaf_fill", 2), median(here, "depth", 0),
                    *(median(here, rate_column(rays), 2) for rays in RAYS)])
    return table


def cost_finding(rows):
    """Of the rays, and of the mesh, where our tree does worst."""
    claim = (f"our tree costs rays no more than Embree's binned SAH: at least {LEAST:g} times the rays a second, and a "
             f"random line at most {1 / LEAST:.2f} times the visits")
    if not where(rows, builder=SAH):
        return Finding(claim, why="this build has no Embree")
    rows = where(rows, threads=1)  # that built; rays are traced by one in all rows
    rates = {f"{rays.replace('_', ' ')} rays of {mesh}": ratio(here, rate_column(rays), OURS, SAH)
             for mesh, here in meshes(rows) for rays in RAYS}
    visits = {mesh: max(ratio(here, column, OURS, SAH).high for column in ("node_visits", "leaf_visits"))
              for mesh, here in meshes(rows)}
    rays, worst = min(rates.items(), key=lambda item: item[1].median)
    mesh, most = max(visits.items(), key=lambda item: item[1])
    ours = f"least for {rays}: {text(worst)}; visits at most {most:.3f} times those, for {mesh}"
    if most > 1 / LEAST:
        return Finding(claim, ours, Verdict.DOES_NOT_HOLD)
    return Finding(claim, ours, is_at_least(worst, LEAST), why_open(worst, LEAST))


def time_finding(rows, threads):
    """Of the mesh where ours leads least."""
    claim = f"our tree is built at least as fast as that of a robust scene of Embree's, by {threads_text(threads)}"
    rows = where(rows, threads=threads)
    if not where(rows, builder=ROBUST):
        return Finding(claim, why="there is no Embree for so many threads")
    found = {mesh: ratio(here, "mtriangles_per_s", OURS, ROBUST) for mesh, here in meshes(rows)}
    mesh, worst = min(found.items(), key=lambda item: item[1].median)
    return Finding(claim, f"least for {mesh}: {text(worst)} times the triangles a second", is_at_least(worst, 1),
                   why_open(worst, 1))


def time(run, rows):
    kinds, threads = distinct(rows, "kind"), distinct(rows, "threads")
    figure, axes = plt.subplots(len(threads), len(kinds), figsize=(4.6 * len(kinds) + 2.2, 3.4 * len(threads) + 0.8),
                                sharex=True, sharey="row", squeeze=False)
    for across, count in zip(axes, threads):
        for axis, kind in zip(across, kinds):
            here = where(rows, kind=kind, threads=count)
            for index, builder in enumerate(distinct(rows, "builder")):
                of_builder = where(here, builder=builder)
                sizes = distinct(of_builder, "triangles")
                line(axis, sizes, [spread([1e9 * row["seconds"] / row["triangles"]
                                           for row in where(of_builder, triangles=size)]) for size in sizes],
                     index=index, label=builder, linestyle="--" if builder.startswith("embree") else "-")
            axis.set_xscale("log")
            axis.set_yscale("log")
            axis.yaxis.set_major_locator(plt.LogLocator(subs=(1, 2, 5)))
            axis.yaxis.set_major_formatter("{x:g}")
            axis.yaxis.set_minor_formatter(plt.NullFormatter())
            axis.set_title(f"{kind}, {threads_text(count)}")
        across[0].set_ylabel("nanoseconds a triangle")
    for axis in axes[-1]:
        axis.set_xlabel("triangles")
    axes[0][-1].legend(loc="upper left", bbox_to_anchor=(1, 1))
    return figure


def summarise(run, rows):
    summary = Summary(findings=[cost_finding(rows), *(time_finding(rows, threads) for threads in distinct(rows, "threads"))],
                      tables=[builders_table(rows)])
    summary.pictures = [Picture(
        "time", "How long trees take to build",
        "Nanoseconds for each triangle by the number of triangles, a line for each builder, with a band from the lowest to the "
        "highest run. What to see: how far ours is from Embree's builder of the same kind (embree-sah), what Embree's whole "
        "scenes take, and that a line which rises has outgrown a cache.")]
    summary.notes += [
        "ours is what compile() does for triangles, and the tree is compile()'s own, to the bit, for any number of threads. "
        "embree-sah is the same but for the binary tree, which is by rtcBuildBVH: binned SAH, two children, leaves of up to 8 "
        "priced by the block; what handing it over takes is not in its time, and is in its peak. Its high quality differs by "
        "spatial splits alone, which are left out. embree-robust and embree-split are scenes of Embree's own triangles, of "
        "high quality; the time is that of rtcCommitScene. Embree splits triangles between leaves only where a scene is not "
        "robust, so that its rays may slip through edges.",
        "SAH: how many nodes and leaves a random line through the root's box meets on average, by their areas; a leaf is a "
        "block of up to 8 triangles. Every tree is checked before its row is kept: ours and embree-sah by the same hits as "
        "compile()'s tree, to the bit, of all rays that are timed; Embree's by at most one hit in a thousand at another distance. Rays are "
        "traced in one thread: over ours and embree-sah by single rays of ours, over Embree's scenes by Embree's.",
        "Peaks are pages that became resident, beyond vertices and which triangles have them (Embree's scenes: 12 bytes a "
        "triangle of their own for that); they say little of meshes that are small. Builds begin with memory that is fresh "
        "from the system."]
    return summary


PICTURES = {"time": time}
