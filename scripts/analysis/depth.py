"""What a limit of depth cuts off, by scene; and what a segment costs by depth, by engine."""
from .data import distinct, numbers, where
from .drawing import COLOURS, MARKERS, line, plt
from .spreads import ratios, shortest, spread, text
from .summary import Finding, Picture, Summary, Table
from .verdict import Verdict, is_at_least, judged

NOISE_SPP = 100  # of column noise_rmse

STYLES = ["-", "--", "-.", ":"]


def depth_error(run, rows):
    rows = where(rows, kind="survival")
    figure, (left, right) = plt.subplots(1, 2, figsize=(10, 5), sharex=True, sharey=True)
    for i, scene in enumerate(distinct(rows, "scene")):
        found = where(rows, scene=scene)
        for axis, column in ((left, "alive"), (right, "lost_light")):
            shown = [row for row in found if row[column] is not None and row[column] > 0]
            axis.plot([row["depth"] for row in shown], [100 * row[column] for row in shown], color=COLOURS[i],
                      marker=MARKERS[i], linestyle=STYLES[i % len(STYLES)], markersize=6, label=scene)
    for axis, title in ((left, "paths that would go on"), (right, "light cut off")):
        axis.set_title(title)
        axis.set_xscale("log")
        axis.set_yscale("log")
        axis.set_xlabel("depth: most segments of a path")
        axis.xaxis.set_major_formatter(plt.FuncFormatter(lambda x, _: f"{x:g}"))
        axis.yaxis.set_major_formatter(plt.FuncFormatter(lambda y, _: f"{y:g}"))
        for depth in (5, 50, 125):
            axis.axvline(depth, color="#888888", linewidth=0.8, linestyle=":")
            axis.text(depth, 1.0, f" {depth}", transform=axis.get_xaxis_transform(), fontsize=8, va="top", color="#555555")
    left.set_ylabel("% of all")
    left.set_xlim(0.9, 300)
    left.set_ylim(2e-4, 200)
    left.set_yticks([10.0**e for e in range(-3, 3)])
    left.set_yticks([], minor=True)
    right.legend(loc="upper right", bbox_to_anchor=(1, 0.96))
    return figure


def depth_time(run, rows):
    figure, (left, right) = plt.subplots(1, 2, figsize=(10, 5))
    for axis, kind, paths in ((left, "time", "all paths"), (right, "very deep", "16 endless paths")):
        of_kind = where(rows, kind=kind)
        for i, engine in enumerate(distinct(of_kind, "engine")):
            done = where(of_kind, engine=engine, outcome="rendered")
            depths = distinct(done, "depth")
            if depths:
                line(axis, depths, [spread(numbers(where(done, depth=depth), "ns_per_segment")) for depth in depths], index=i,
                     linestyle=STYLES[i], label=engine)
            refused = distinct(where(of_kind, engine=engine, outcome="refused"), "depth")
            if refused:
                axis.plot(refused, [0.93] * len(refused), transform=axis.get_xaxis_transform(), color=COLOURS[i],
                          marker="x", markersize=10, markeredgewidth=2.5, linestyle="none")
                axis.text(refused[-1], 0.96, f"{engine}: refused", transform=axis.get_xaxis_transform(), fontsize=8.5,
                          ha="right", va="bottom", color=COLOURS[i])
        axis.set_xscale("log")
        axis.set_xlabel("depth: most segments of a path")
        axis.set_title(f"{distinct(of_kind, 'scene')[0]}: {paths}")
        axis.set_ylim(0, 1.3 * max(row["ns_per_segment"] for row in of_kind if row["ns_per_segment"] is not None))
    left.xaxis.set_major_formatter(plt.FuncFormatter(lambda x, _: f"{x:g}"))
    left.set_ylabel("nanoseconds for a segment")
    left.legend(loc="upper center", ncol=2, handlelength=3)
    return figure


def percent(share):
    return "0" if share == 0 else f"{100 * share:.1e} %" if share < 1e-4 else f"{100 * share:.3g} %"


def missing_at_five(survival):
    """"At depth 5 a fifth is missing": in figures, for the caption."""
    parts = [f"{row['scene']} {percent(row['lost_light'])}" for row in where(survival, depth=5)]
    return f"Light missing at depth 5: {', '.join(parts)}. " if parts else ""


def furnace_finding(rows):
    """Every path would bring exactly 1, and at the reference all have come home but those still alive there."""
    last = rows[-1]["alive"]
    worst = max(abs((row["alive"] - last) / (1 - last) - row["lost_light"]) for row in rows)
    first = rows[0]
    return Finding("a white furnace loses exactly the share of paths that the limit cuts",
                   f"at depth {first['depth']}: {percent(first['alive'])} of the paths, {percent(first['lost_light'])} "
                   f"of the light; largest difference at any depth {worst:.1e}", judged(worst < 1e-9))


def enough_finding(rows, scene):
    noise = rows[0]["noise_rmse"]
    enough = len(rows)
    while enough > 0 and rows[enough - 1]["lost_rmse"] < noise:
        enough -= 1
    deepest = rows[max(len(rows) - 2, 0)]  # the last is the reference itself
    if enough == len(rows):
        ours = f"above it at every depth; noise RMSE {noise:.2e}"
    else:
        at = rows[enough]
        ours = (f"below it from depth {at['depth']} on (RMSE {at['lost_rmse']:.2e}, {percent(at['lost_light'])} "
                f"of the light; noise {noise:.2e})")
    return Finding(f"{scene}: the light cut off at a depth of {deepest['depth']} is below the noise of {NOISE_SPP} samples",
                   ours, judged(deepest["lost_rmse"] < noise))


def add_survival(summary, rows, scene, main):
    table = Table(f"{scene}: cut off by the depth (noise of {NOISE_SPP} spp: RMSE {rows[0]['noise_rmse']:.2e})",
                  ["depth", "paths that would go on", "light cut off", "RMSE of that", "RMSE, image to image"])
    for row in rows:
        table.rows.append([str(row["depth"]), percent(row["alive"]), percent(row["lost_light"]),
                           f"{row['lost_rmse']:.2e}", f"{row['paired_rmse']:.2e}"])
    summary.tables.append(table)
    if scene == "furnace":
        summary.findings.append(furnace_finding(rows))
    if scene == main:
        summary.findings.append(enough_finding(rows, scene))


def times(rows, title):
    engines = distinct(rows, "engine")
    table = Table(title, ["depth", "segments a path", *engines])
    for depth in distinct(rows, "depth"):
        at = where(rows, depth=depth)
        segments = numbers(at, "segments")
        cells = [str(depth), f"{segments[0] / numbers(at, 'paths')[0]:.2f}" if segments else ""]
        for engine in engines:
            ns = numbers(where(at, engine=engine), "ns_per_segment")
            cells.append(text(spread(ns), 1) if ns else "refused")
        table.rows.append(cells)
    return table


def speed_finding(rows):
    """Is the pool ahead of recursion at every depth?"""
    gains = {}
    for depth in distinct(rows, "depth"):
        recursive, pool = (numbers(where(rows, depth=depth, engine=e), "seconds") for e in ("recursive", "pool"))
        if ratios(recursive, pool):
            gains[depth] = spread(ratios(recursive, pool))
    claim = "the fused pool is faster than recursion at every depth"
    if not gains:
        return Finding(claim, why="recursion was refused")
    ours = "depth " + "; ".join(f"{depth}: {text(gain)}" for depth, gain in gains.items())
    verdicts = [is_at_least(gain, 1) for gain in gains.values()]
    if all(verdict == Verdict.HOLDS for verdict in verdicts):
        return Finding(claim, ours, Verdict.HOLDS)
    if Verdict.DOES_NOT_HOLD in verdicts:
        return Finding(claim, ours, Verdict.DOES_NOT_HOLD)
    return Finding(claim, ours, why="too few runs, or their spread includes 1")


def add_stack(summary, rows):
    refused = where(rows, outcome="refused")
    recursed = numbers(where(rows, engine="recursive", outcome="rendered"), "depth")
    ours = f"it rendered depth {max(recursed)}" if recursed else "it rendered none of the depths"
    claim = "recursion refuses what its stack cannot hold; the others go on"
    if not refused:
        summary.findings.append(Finding(claim, ours, why="the stack here holds every depth that was tried"))
        return
    ours += f" and refused depth {min(numbers(refused, 'depth'))}"
    summary.notes.append(f"What recursion says: \"{refused[0]['refusal']}\"")
    summary.findings.append(Finding(claim, ours, judged(all(row["engine"] == "recursive" for row in refused))))


def add_limits(summary, rows):
    """What very deep paths take of memory, which follows from the capacity of pools, of the stack, and of time."""
    deepest = max(numbers(rows, "depth"))
    pools = {engine: spread(numbers(where(rows, engine=engine), "pool_bytes")) for engine in ("shared pool", "pool")}
    taken = "; ".join(f"{engine}: {pool.low * 1e-6:.2f} to {pool.high * 1e-6:.2f} MB" for engine, pool in pools.items())
    summary.notes.append(f"Memory that pools asked for, up to depth {shortest(deepest)}: {taken}.")
    add_stack(summary, rows)

    ns = {engine: numbers(where(rows, depth=deepest, engine=engine), "ns_per_segment")
          for engine in ("iterative", "pool", "shared pool")}
    cost, shared = (spread(ratios(ns[engine], ns["iterative"])) for engine in ("pool", "shared pool"))
    is_open = cost.low <= 1 <= cost.high
    summary.findings.append(Finding(
        "a segment of a few endless paths costs the fused pool less than the loop",
        f"{text(cost)} times the loop's at depth {shortest(deepest)}; the shared pool's {text(shared)}",
        Verdict.CANNOT_TELL if is_open else judged(cost.high < 1), "the spread of the runs includes 1" if is_open else ""))


def summarise(run, rows):
    summary = Summary()
    survival, timed, deep = (where(rows, kind=kind) for kind in ("survival", "time", "very deep"))
    for scene in distinct(survival, "scene"):
        add_survival(summary, where(survival, scene=scene), scene, run["options"]["scene"])
    summary.tables.append(times(timed, "Nanoseconds of a thread for a segment"))
    summary.findings.append(speed_finding(timed))
    summary.tables.append(times(deep, "The same of very deep paths between two mirrors"))
    add_limits(summary, deep)
    summary.pictures = [
        Picture("depth_error", "What a limit of depth cuts off",
                "Left: the part of the paths that a limit cuts. Right: the part of the light that is missing for it, exact "
                "for the paths rendered, since both images are made of the same. Dotted: the paper's depths. What to see: "
                f"how deep is enough is up to the scene. {missing_at_five(survival)}A white furnace loses exactly its paths."),
        Picture("depth_time", "Cost of a segment by depth",
                "Thread time, median with the lowest and highest run. Left: the scene of the paper, from camera rays only "
                "to the end of all paths. Right: only 16 paths, between two mirrors, followed without end. What to see: "
                "on the left, how little the limit changes the cost of a segment, and which engine is the cheapest. On "
                "the right, what barriers cost a shared pool of 16 paths; a cross is a depth that recursion refuses, "
                "since its stack cannot hold it.")]
    return summary


PICTURES = {"depth_error": depth_error, "depth_time": depth_time}
