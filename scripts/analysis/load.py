"""Work of each thread under every way of sharing it out: the paper's Figure 5, and the same of pools."""
from .data import distinct, numbers, where
from .drawing import COLOURS, plt
from .spreads import coefficient_of_variation, max_over_mean
from .summary import Finding, Picture, Summary, Table, rungs_table
from .verdict import Verdict, judged

SHARES = "one of all paths, equal shares"  # a way
EVEN = 1.02  # max/mean that counts as balanced


def rays(row):
    """Shadow rays are rays too; older runs had none."""
    return row["segments"] + row.get("shadow_rays", 0)


def by_scene(rows):
    """Rows of each scene; older runs had one, and no name of it."""
    if "scene" not in rows[0]:
        return {"": rows}
    return {scene: where(rows, scene=scene) for scene in distinct(rows, "scene")}


def samples_lights(rows):
    return any(row.get("shadow_rays") for row in rows)


def load(run, rows):
    return load_of_scene(next(iter(by_scene(rows).values())))


def load_lights(run, rows):
    return load_of_scene(next(own for own in by_scene(rows).values() if samples_lights(own)))


def load_of_scene(rows):
    rows = where(rows, repeat=0)
    ways = distinct(rows, "group", "way")
    ways.sort(key=lambda way: way[0] != "recursion")
    columns = 4
    lines = -(-len(ways) // columns)
    figure, axes = plt.subplots(lines, columns, figsize=(11.5, 0.9 + 2.05 * lines), sharex=True, sharey=True, squeeze=False)
    for axis, (group, way) in zip(axes.flat, ways):
        own = sorted(where(rows, group=group, way=way), key=lambda row: row["thread"])
        tests = [row["tests"] for row in own]
        mean = sum(tests) / len(tests) or 1
        mean_rays = sum(rays(row) for row in own) / len(own) or 1
        threads = [row["thread"] for row in own]
        axis.bar(threads, [t / mean for t in tests], label="tests", width=0.85,
                 color=COLOURS[4] if group == "recursion" else COLOURS[1],
                 edgecolor="black" if len(own) <= 32 else "none", linewidth=0.5)
        axis.plot(threads, [rays(row) / mean_rays for row in own], label="rays", marker="o", color="black",
                  markerfacecolor="white", markersize=4 if len(own) <= 32 else 1.5, linestyle="none")
        axis.axhline(1, color="black", linewidth=0.9)
        name = f"pool: {way}" if group == "pool" else way
        source = "" if own[0]["source"] == "counted" else f"  ({own[0]['source']})"
        axis.set_title(f"{name}\n$\\bf{{{max(tests) / mean:.3f}}}${source}", fontsize=9.5)
        axis.grid(axis="x", visible=False)
    axes[0][0].set_ylim(bottom=0)  # of all, once the tallest bar is there
    for axis in axes.flat[len(ways):]:
        axis.set_visible(False)
    for axis in axes[:, 0]:
        axis.set_ylabel("work / mean")
    for column in range(columns):
        last = max((i for i in range(lines) if i * columns + column < len(ways)), default=0)
        axes[last][column].set_xlabel("thread")
        axes[last][column].tick_params(labelbottom=True)
    return figure


def first_run(rows, way):
    """Counts are the same in all."""
    return where(rows, way=way, repeat=0)


def load_of(rows, way, unit):
    return max_over_mean(in_units(first_run(rows, way), unit))


def in_units(rows, unit):
    return [rays(row) for row in rows] if unit == "rays" else numbers(rows, unit)


def rendered(rows):
    """What the load is of; older runs did not say so."""
    if "width" not in rows[0]:
        return ""
    return f", {rows[0]['width']} x {rows[0]['height']} pixels, {rows[0]['samples']} samples a pixel"


def loads(scene, rows, threads):
    is_timed = any(row["busy_s"] is not None for row in rows)
    table = Table((f"{scene}, lights sampled: load of {threads} threads" if samples_lights(rows) else
                   f"Load of {threads} threads") + rendered(rows),
                  ["way", "source", "tests: max/mean", "tests: CV", "rays: max/mean", "rays: CV",
                   *(["busy: max/mean"] if is_timed else [])])
    for group in ("recursion", "pool"):
        for way in distinct(where(rows, group=group), "way"):
            run = first_run(rows, way)
            busy = numbers(run, "busy_s")
            cells = [f"{figure(in_units(run, unit)):.3f}" for unit in ("tests", "rays")
                     for figure in (max_over_mean, coefficient_of_variation)]
            busy_cells = [f"{max_over_mean(busy):.3f}" if busy else ""] if is_timed else []
            table.rows.append([way, run[0]["source"], *cells, *busy_cells])
    return table


def shared_out(threads, claim, ours, is_true, **more):
    if threads == 1:
        return Finding(claim, ours, Verdict.CANNOT_TELL, "one thread has nothing to share out", **more)
    return Finding(claim, ours, judged(is_true), **more)


def rays_are_work(rows):
    """Whether equal shares of the rays are equal shares of the tests, in this scene."""
    return load_of(rows, SHARES, "tests") <= EVEN


def last_panel(rows, threads):
    """What to see in it, where there is anything."""
    if threads == 1 or not where(rows, way=SHARES):
        return "."
    return ("; and, in the last panel, whose dots are on the line, that its bars are" +
            (", too: in this scene equal rays are equal work." if rays_are_work(rows) else " not: equal rays are not equal work."))


def findings(rows, threads):
    basic, static1, collapse = (load_of(rows, way, "tests") for way in (
        "lines, static (default)", "lines, static,1", "pixels, static,1 (collapse)"))
    yield shared_out(
        threads, "the default schedule of lines is the worst balanced, static,1 better, pixel by pixel the best",
        f"max/mean of tests {basic:.3f}, {static1:.3f} and {collapse:.3f}, {threads} threads",
        basic > static1 > collapse, source="Figure 5", paper="histograms of 8 threads, width 800")
    rays, tests = (load_of(rows, SHARES, unit) for unit in ("rays", "tests"))
    yield shared_out(
        threads, "a pool that shares out its rays evenly shares out its work evenly",
        f"equal shares of every round: max/mean of rays {rays:.3f}, of tests {tests:.3f}, {threads} threads",
        rays_are_work(rows))


def same_with_lights(scene, rows, threads):
    """What sampling lights does to the paper's ways."""
    ways = ("lines, static (default)", "pixels, static,1 (collapse)")
    default, collapse = (load_of(rows, way, "tests") for way in ways)
    part = sum(row["shadow_rays"] for row in rows) / sum(rays(row) for row in rows)
    return shared_out(
        threads, f"where lights are sampled ({scene}, mis) pixel by pixel is better balanced than the default, too",
        f"max/mean of tests {collapse:.3f} and {default:.3f}; {100 * part:.0f} % of the rays are shadow rays",
        collapse < default)


def summarise(run, rows):
    threads = rows[0]["threads"]
    scenes = by_scene(rows)
    first = next(iter(scenes.values()))
    summary = Summary(tables=[loads(scene, own, threads) for scene, own in scenes.items()] + rungs_table(run),
                      findings=list(findings(first, threads)))
    with_lights = {scene: own for scene, own in scenes.items() if samples_lights(own)}
    summary.findings += [same_with_lights(scene, own, threads) for scene, own in with_lights.items()]
    summary.pictures.append(Picture(
        "load", f"Work of each of {threads} threads",
        "Each bar is a thread's box and primitive tests, each white dot the rays that it traced, both over the mean "
        "(the line at 1). The number is max/mean of tests: 1 is perfect balance, and all threads wait for the tallest "
        "bar. What to see: which ways leave tall bars" + last_panel(first, threads)))
    if with_lights and len(scenes) > 1:
        summary.pictures.append(Picture(
            "load_lights", f"The same where lights are sampled: {next(iter(with_lights))}",
            "Shadow rays count as rays, and their tests as tests: a hit on what is diffuse has one more ray to trace, one "
            "on mirrors and glass has not. What to see: whether the ways that are uneven above are so here."))
    summary.notes = [
        "Loops of recursion are named by their grain and their schedule; `default` is that of OpenMP, as in the paper. CV is "
        "the standard deviation over the mean.",
        f"Three pools are no rung of the ladder: `fused` by two other ways of sharing out the image, and `{SHARES}`, the pool of "
        "the paper's description, which holds all paths and hands out each round in equal parts.",
        "Static schedules, and every pool, are counted in a real run. Loops that hand out work as threads ask for it "
        "are counted too where there are enough cores, and replayed from the recorded costs of all paths where there "
        "are not. Pools count the tests that their streams and packets make, replays those of single rays.",
        "Pools: lines, or batches of the shared pools, in turn (static,1) where nothing else is said. What a thread of a "
        "shared pool traces depends on who fetches camera rays first, so its counts differ a little from run to run; "
        "and sums over rounds do not show what threads wait for each other within a round: the replay study does."]
    return summary


PICTURES = {"load": load, "load_lights": load_lights}
