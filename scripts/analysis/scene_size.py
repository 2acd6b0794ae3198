"""From which size of scene on a pool beats recursion: ratio, time of a ray and lists, by the number of shapes."""
import statistics

from .crossover import AtCapacity, best, crossover
from .data import distinct, numbers, where
from .drawing import COLOURS, line, plt
from .spreads import ratios, spread, text, threads_text
from .summary import Finding, Picture, Summary, Table
from .verdict import is_at_least, why_open

COUNTED = "cache misses, "  # before the name of a way
AUTOMATIC_LISTS = "lists, automatic"

BLUE, ORANGE, GREEN, RED, SKY, PINK, BLACK, YELLOW = COLOURS


def timed(rows):
    return [row for row in rows if not row["way"].startswith((COUNTED, "lists, "))]


def grid(count, below=1):
    """A figure with `count` panels, up to three a row, each of `below` axes under one another: (axes, ...) a panel."""
    across = min(count, 3)
    down = -(-count // across)
    figure, axes = plt.subplots(below * down, across, figsize=(4.4 * across + 2.6, 3.6 * below * down + 0.8), sharex=True,
                                sharey=below == 1 or "row", squeeze=False)
    for axis in axes.flat:
        axis.tick_params(labelbottom=True)
    panels = [axes[below * row:below * (row + 1), column] for row in range(down) for column in range(across)]
    for panel in panels[count:]:
        for axis in panel:
            axis.set_visible(False)
    return figure, panels[:count]


def add_legend(figure):
    """One for all panels, in the order in which its lines are first drawn."""
    named = {}
    for axis in figure.axes:
        for handle, label in zip(*axis.get_legend_handles_labels()):
            named.setdefault(label, handle)
    top_right = figure.axes[figure.axes[0].get_gridspec().ncols - 1]
    top_right.legend(named.values(), named.keys(), loc="upper left", bbox_to_anchor=(1, 1))


def panels(rows, label):
    """A panel for each depth and kind; of the most threads."""
    threads = max(distinct(rows, "threads"))
    rows = where(timed(rows), threads=threads)
    places = sorted(distinct(rows, "depth", "kind"), key=lambda place: place[0])
    figure, found = grid(len(places))
    for (axis,), (depth, kind) in zip(found, places):
        axis.set_xscale("log")
        axis.set_title(f"{kind}, depth {depth:.0f}, {threads_text(threads)}")
        axis.set_ylabel(label)
        axis.set_xlabel("shapes")
        yield figure, axis, where(rows, depth=depth, kind=kind)
    add_legend(figure)


def way_ratio(here, way, to="recursion", **more):
    """Of a way to another, over the runs side by side."""
    return spread(ratios(*(numbers(where(here, way=w, **more), "mpaths_per_s") for w in (way, to))))


def ratio(run, rows):
    for figure, axis, here in panels(rows, "times as fast as recursion"):
        sizes = distinct(here, "shapes")
        for index, capacity in enumerate(capacities(here)):
            of_capacity = distinct(where(here, way=str(capacity)), "shapes")
            line(axis, of_capacity, [way_ratio(here, str(capacity), shapes=size) for size in of_capacity], index=index,
                 label=f"{capacity} records", linestyle="--")
        line(axis, sizes, [way_ratio(here, "automatic", shapes=size) for size in sizes], color=BLACK, marker="*",
             label="automatic")
        axis.axhline(1, color="black", linewidth=2, label="recursion")
    for axis in figure.axes:  # after the last panel, since panels share an axis that stops growing here
        axis.set_ylim(bottom=0)
    return figure


def time(run, rows):
    for figure, axis, here in panels(rows, "nanoseconds of a thread for a ray"):
        sizes = distinct(here, "shapes")
        for way, label, style in (("recursion", "recursion", {"color": RED, "marker": "s", "linestyle": "--"}),
                                  ("automatic", "pool", {"color": BLUE, "marker": "o"})):
            line(axis, sizes, [spread(numbers(where(here, way=way, shapes=size), "ns_per_segment")) for size in sizes],
                 label=label, **style)
        axis.set_yscale("log")
    return figure


SHORT_LIST = 12  # rays; kShortList of wavefront/stream.h


def lists(run, rows):
    rows = where(rows, way=AUTOMATIC_LISTS)
    kinds = distinct(rows, "kind")
    sizes = sorted(distinct(rows, "shapes"))
    figure, found = grid(len(kinds), below=2)
    for (above, below), kind in zip(found, kinds):
        for shapes in distinct(where(rows, kind=kind), "shapes"):
            here = where(rows, kind=kind, shapes=shapes)
            index = sizes.index(shapes)
            lengths = [row["list_rays"] / row["lists"] for row in here]
            line(above, [row["level"] for row in here], [(value, value, value) for value in lengths], index=index,
                 label=f"{shapes:.0f} shapes")
            full = [row for row in here if row["lanes"] > 0]
            fills = [(row["list_rays"] - row["single_rays"]) / row["lanes"] for row in full]
            line(below, [row["level"] for row in full], [(value, value, value) for value in fills], index=index)
        above.axhspan(0.5, SHORT_LIST, color="0.9")
        above.set_yscale("log")
        above.set_title(kind)
        below.set_ylim(0, 1.05)
        below.set_xlabel("level of the trees")
        above.set_ylabel("rays of a list")
        below.set_ylabel("lanes in use")
    add_legend(figure)
    return figure


def capacities(rows):
    """The ways that are a number of records."""
    return [int(way) for way in distinct(rows, "way") if way.isdigit()]


def places(rows, threads, depth):
    """(name, rows) of each scene that was rendered so."""
    for kind in distinct(where(rows, threads=threads, depth=depth), "kind"):
        of_kind = where(rows, threads=threads, depth=depth, kind=kind)
        for shapes in distinct(of_kind, "shapes"):
            yield f"{shapes} {kind}", where(of_kind, shapes=shapes)


def ratio_table(rows, threads, depth):
    sizes = capacities(where(rows, threads=threads, depth=depth))
    table = Table(f"Ratio to recursion, {threads_text(threads)}, depth {depth}",
                  ["scene", "trees, MB", "recursion, ns a ray", *map(str, sizes), "automatic", "its records", "best",
                   "beats recursion from"])
    for scene, here in places(rows, threads, depth):
        measured = {size: way_ratio(here, str(size)) for size in capacities(here)}
        ordered = [AtCapacity(*item) for item in measured.items()]
        recursion = where(here, way="recursion")
        table.rows.append([scene, f"{1e-6 * recursion[0]['tree_bytes']:.2f}",
                           f"{statistics.median(numbers(recursion, 'ns_per_segment')):.0f}",
                           *(text(measured[size]) if size in measured else "" for size in sizes),
                           text(way_ratio(here, "automatic")), str(where(here, way="automatic")[0]["capacity"]),
                           *([str(best(ordered).capacity), str(crossover(ordered))] if ordered else ["", ""])])
    return table


def miss_table(rows, depth):
    """No rows where nothing can count them."""
    table = Table(f"Cache misses of reads, for each ray, 1 thread, depth {depth}",
                  ["scene", "way", "first level", "last level", "counted by"])

    def a_ray(of_way, column):
        counts = numbers(of_way, column)
        return f"{counts[0] / of_way[0]['segments']:.2f}" if counts else ""
    for scene, here in places(rows, 1, depth):
        for way in distinct(here, "way"):
            of_way = where(here, way=way)
            if way.startswith(COUNTED):
                table.rows.append([scene, way.removeprefix(COUNTED), a_ray(of_way, "d1_read_misses"),
                                   a_ray(of_way, "ll_read_misses"), of_way[0]["source"]])
    return table


def list_table(rows, depth):
    """Of the default pool. A ray that entered a child is in the list of the next level, unless it went on alone."""
    table = Table(f"Lists of the default pool by level of the trees, 1 thread, depth {depth}",
                  ["scene", "level", "rays a list", "lane fill", "rays that enter it in a list, of all rays",
                   "of these, go on alone"])
    for scene, here in places(rows, 1, depth):
        for level in distinct(where(here, way=AUTOMATIC_LISTS), "level"):
            row = where(here, way=AUTOMATIC_LISTS, level=level)[0]
            rays, alone = row["list_rays"], row["single_rays"]
            fill = f"{100 * (rays - alone) / row['lanes']:.0f} %" if rays > alone else ""
            table.rows.append([scene, str(level), f"{rays / row['lists']:.1f}", fill, f"{rays / row['segments']:.3f}",
                               f"{100 * alone / rays:.0f} %"])
    return table


def lead_finding(rows, threads, depth, least):
    """Of the scene where the default pool leads least."""
    found = {scene: way_ratio(here, "automatic") for scene, here in places(rows, threads, depth)}
    scene, worst = min(found.items(), key=lambda item: item[1].median)
    return Finding(f"the default pool is at least {least:g} times as fast as recursion at every size",
                   f"least for {scene}: {text(worst)}, {threads_text(threads)}, depth {depth}",
                   is_at_least(worst, least), why_open(worst, least))


PEERS = [("recursion", "embree-mesh-1"), ("recursion", "embree-1"), ("automatic", "embree-mesh-packet"),
         ("automatic", "embree-packet")]


def add_peers(summary, rows, depth):
    """Recursion and the default pool over the same path tracer on Embree; nothing where there is none."""
    meshes = [(scene, here) for scene, here in places(rows, 1, depth) if where(here, way="embree-mesh-packet")]
    if not meshes:
        return
    pairs = [(way, peer) for way, peer in PEERS if all(where(here, way=peer) for _, here in meshes)]
    table = Table(f"Ratio to path tracers over Embree, 1 thread, depth {depth}",
                  ["scene", *(f"{'pool' if way == 'automatic' else way} to {peer}" for way, peer in pairs)])
    table.rows = [[scene, *(text(way_ratio(here, way, peer)) for way, peer in pairs)] for scene, here in meshes]
    summary.tables.append(table)
    least = 1.5
    found = {scene: way_ratio(here, "automatic", "embree-mesh-packet") for scene, here in meshes}
    scene, worst = min(found.items(), key=lambda item: item[1].median)
    summary.findings.append(Finding(
        f"the default pool is at least {least:g} times as fast as packets over Embree's own triangles at every size",
        f"least for {scene}: {text(worst)}, 1 thread, depth {depth}", is_at_least(worst, least), why_open(worst, least)))


def summarise(run, rows):
    summary = Summary()
    depths = distinct(rows, "depth")
    for threads in distinct(rows, "threads"):
        summary.tables += [ratio_table(rows, threads, depth) for depth in depths]
        summary.findings += [lead_finding(rows, threads, depths[-1], least) for least in (2, 1)]
    add_peers(summary, rows, depths[-1])
    tables = [table(rows, depth) for depth in depths for table in (list_table, miss_table)]
    summary.tables += [table for table in tables if table.rows]
    summary.pictures = [
        Picture("ratio", "How the pool's lead depends on the size of the scene",
                "Ratio to recursion by the number of shapes, a line for each capacity, with a band from the lowest to the "
                "highest run; black: the capacity that the trees' bytes choose. What to see: whether a line falls below 1, "
                "and that small pools lead in small scenes and large ones in large scenes."),
        Picture("time", "What a ray costs as the scene grows",
                "Nanoseconds of a thread for each ray, by the number of shapes: recursion, and the pool of automatic "
                "capacity. What to see: where the lines bend upward, the trees have outgrown a cache.")]
    if where(rows, way=AUTOMATIC_LISTS):
        summary.pictures.append(Picture(
            "lists", "How long the lists of rays are on the way down",
            "Above, rays of a list by the level of the trees, a line for each number of shapes, of the pool of automatic "
            "capacity; below, how full the registers are that take them. Grey: shorter lists are taken apart, and their rays "
            "go on alone. What to see: how far down a pool's rays share nodes, and that registers stay full there."))
    summary.notes.append(
        "Spheres, quads and clusters are made by scenes/generate: a ray across the shapes meets two of them whatever "
        "their number, so paths are equally long. Meshes are made by scenes/generate_mesh and stand in a room under a "
        "lamp that is sampled. Making the pool is part of the time. The best capacity is that of the "
        "highest median, and need not differ from its neighbours. Cache misses are counted where the processor lets "
        "us, elsewhere simulated: 32 KiB and 1 MiB, in smaller images, with up to 10^5 shapes. Camera rays are in no "
        "list: they go down in beams.")
    return summary


PICTURES = {"ratio": ratio, "time": time, "lists": lists}
