"""How fast hits are found: packets, streams and Embree against single rays of recursion, on the same rays."""
import statistics

from .data import distinct, numbers, where
from .drawing import line, plt
from .spreads import ratios, spread, text
from .summary import Finding, Picture, Summary, Table
from .verdict import is_at_least, judged, why_open

SINGLE = "single rays"
EMBREE_SINGLE = "Embree, single rays"
LEAST = 0.95
RARE = 100_000


def rate_ratio(here, search, to):
    """Of two searches, over the runs side by side."""
    return spread(ratios(*(numbers(where(here, search=s), "mrays_per_s") for s in (search, to))))


def scenes(rows):
    """(name, rows) of each scene."""
    for kind in distinct(rows, "kind"):
        for triangles in distinct(where(rows, kind=kind), "triangles"):
            yield f"{triangles} {kind}", where(rows, kind=kind, triangles=triangles)


def ratio(run, rows):
    kinds, meshes = distinct(rows, "rays"), distinct(rows, "kind")
    searches = [search for search in distinct(rows, "search") if search != SINGLE]
    figure, axes = plt.subplots(len(meshes), len(kinds), figsize=(4.0 * len(kinds) + 2.2, 3.6 * len(meshes) + 0.8),
                                sharex=True, sharey=True, squeeze=False)
    for across, mesh in zip(axes, meshes):
        for axis, kind in zip(across, kinds):
            here = where(rows, kind=mesh, rays=kind)
            sizes = distinct(here, "triangles")
            for index, search in enumerate(searches):
                if where(here, search=search):
                    line(axis, sizes, [rate_ratio(where(here, triangles=size), search, SINGLE) for size in sizes], index=index,
                         label=search, linestyle="--" if search.startswith("Embree") else "-")
            axis.axhline(1, color="black", linewidth=2, label=SINGLE)
            axis.set_xscale("log")
            axis.set_ylim(bottom=0)
            axis.set_title(f"{mesh}: {kind} rays")
        across[0].set_ylabel("times as fast as single rays")
    for axis in axes[-1]:
        axis.set_xlabel("triangles")
    axes[0][-1].legend(*axes[0][0].get_legend_handles_labels(), loc="upper left", bbox_to_anchor=(1, 1))
    return figure


def ratio_table(rows, kind):
    searches = distinct(where(rows, rays=kind), "search")
    table = Table(f"{kind} rays: times as fast as {SINGLE}".capitalize(),
                  ["scene", "rays", f"{SINGLE}, M rays/s", *searches[1:]])
    for scene, here in scenes(where(rows, rays=kind)):
        single = where(here, search=SINGLE)
        table.rows.append([scene, str(single[0]["ray_count"]),
                           f"{statistics.median(numbers(single, 'mrays_per_s')):.2f}",
                           *(text(rate_ratio(here, search, SINGLE)) for search in searches[1:])])
    return table


def against_embree(rows):
    """Of the rays where single rays of ours lead Embree's least."""
    claim = f"single rays of ours are at least {LEAST:g} times as fast as Embree's on the same rays"
    if not where(rows, search=EMBREE_SINGLE):
        return Finding(claim, why="this build has no Embree")
    found = {f"{kind} rays of {scene}": rate_ratio(here, SINGLE, EMBREE_SINGLE)
             for kind in distinct(rows, "rays") for scene, here in scenes(where(rows, rays=kind))}
    rays, worst = min(found.items(), key=lambda item: item[1].median)
    return Finding(claim, f"least for {rays}: {text(worst)}", is_at_least(worst, LEAST), why_open(worst, LEAST))


def same_hits(rows):
    """Of one run of each search: all of them trace the same rays."""
    claim = f"beside ties, at most one ray in {RARE} meets something else by Embree's own triangles"
    theirs = [row for row in rows if row["search"].startswith("Embree") and row["repeat"] == 0]
    if not theirs:
        return Finding(claim, why="this build has no Embree")
    closest = [row for row in theirs if row["far_apart"] is not None]
    hidden = [row for row in theirs if row["far_apart"] is None]
    others, far, dark = (sum(numbers(of, column))
                         for of, column in ((closest, "others"), (closest, "far_apart"), (hidden, "others")))
    ours = (f"of {sum(numbers(closest, 'ray_count'))} rays {others} met another primitive, {far} of them at another "
            f"distance; of {sum(numbers(hidden, 'ray_count'))} shadow rays {dark} differ")
    return Finding(claim, ours, judged((far + dark) * RARE <= sum(numbers(theirs, "ray_count"))))


def summarise(run, rows):
    summary = Summary(findings=[against_embree(rows), same_hits(rows)],
                      tables=[ratio_table(rows, kind) for kind in distinct(rows, "rays")])
    summary.pictures = [Picture(
        "ratio", "How fast hits are found by rays together, and by Embree",
        "Rate over that of single rays of recursion on the same rays, by the number of triangles, with a band from the lowest "
        "to the highest run. What to see: that packets are for camera rays alone, that streams gain on all rays, and how "
        "long they must be where the mesh is large.")]
    summary.notes.append(
        "One thread. The rays are those of a render, in the order of their paths; every search reads them from the same "
        "columns. Streams are the stages of the pool; its beams, which are for camera rays, are not among them. Embree has "
        "triangles of its own, in a robust scene of high quality; the walls and the lamp are tested by our kernels for all. Its "
        "packets are told that camera rays are coherent, and that others are not.")
    return summary


PICTURES = {"ratio": ratio}
