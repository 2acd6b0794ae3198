"""Adaptive sampling against uniform: error, time, bias, and the load of threads."""
import math
import statistics

from .data import distinct, numbers, where
from .drawing import COLOURS, MARKERS, plt
from .efficiency import Runs, Winner, compare, mean, rmse
from .summary import Finding, Picture, Summary, Table
from .verdict import Verdict


def adaptive(run, rows):
    figure, (left, right) = plt.subplots(1, 2, figsize=(11.5, 4.2), gridspec_kw={"width_ratios": [1, 1.25]})
    runs = where(rows, kind="run")
    places = []
    for place, (scene, target) in enumerate(distinct(runs, "scene", "target")):
        own = where(runs, scene=scene, target=target)
        ratios = []
        for seed in distinct(own, "seed"):
            a, u = where(own, seed=seed, method="adaptive")[0], where(own, seed=seed, method="uniform")[0]
            if a["mse"] > 0 and u["mse"] > 0:
                ratios.append(u["mse"] * u["seconds"] / (a["mse"] * a["seconds"]))
        left.plot(ratios, [place] * len(ratios), "o", color=COLOURS[0], markerfacecolor="none", markersize=5)
        if ratios:
            left.plot([statistics.median(ratios)], [place], "|", color="black", markersize=18, markeredgewidth=2)
        places.append(f"{scene}, {target:g}")
    left.axvline(1, color="black", linewidth=0.9)
    left.set_yticks(range(len(places)), places)
    left.invert_yaxis()
    left.set_xlabel("efficiency of adaptive / uniform")
    left.set_title("Scene and RMSE asked for")

    loads = where(rows, kind="load")
    scenes = distinct(loads, "scene")
    for i, sharing in enumerate(distinct(loads, "sharing")):
        for method, fill in (("uniform", "none"), ("adaptive", COLOURS[i])):
            values = [where(loads, scene=scene, sharing=sharing, method=method)[0]["load"] for scene in scenes]
            right.plot([x + 0.12 * (i - 1.5) for x in range(len(scenes))], values, MARKERS[i], color=COLOURS[i],
                       markerfacecolor=fill, markersize=8, label=sharing if method == "adaptive" else None)
    right.axhline(1, color="black", linewidth=0.9)
    right.set_xticks(range(len(scenes)), scenes)
    right.set_ylabel("load: busiest threads / fair share")
    right.set_title("Hollow: uniform. Filled: adaptive")
    right.legend(fontsize=8)
    return figure


VERDICTS = {Winner.FIRST: Verdict.HOLDS, Winner.SECOND: Verdict.DOES_NOT_HOLD, Winner.NO_DIFFERENCE: Verdict.CANNOT_TELL}
NAMES = {Winner.FIRST: "adaptive", Winner.SECOND: "uniform", Winner.NO_DIFFERENCE: "no difference"}


def runs_of(rows):
    return Runs(numbers(rows, "seconds"), numbers(rows, "mse"))


def shift_text(rows):
    """Mean and standard error."""
    values = numbers(rows, "shift")
    n, average = len(values), mean(values)
    error = 0 if n < 2 else math.sqrt(sum((value - average) ** 2 for value in values) / (n - 1) / n)
    return f"{average:+.1e} ± {error:.0e}"


def error_text(reached, equal_paths):
    return f"{reached / equal_paths:.3f} of uniform's" if equal_paths > 0 else "uniform is too near the reference to tell"


def finding_of(target, comparison):
    return Finding(f"on half_sky adaptive sampling reaches an RMSE of {target:g} sooner",
                   f"{comparison.ratio:.2f} times as soon ({comparison.interval.low:.2f} to {comparison.interval.high:.2f})",
                   VERDICTS[comparison.winner],
                   "the interval includes 1" if comparison.winner == Winner.NO_DIFFERENCE else "")


def compared(summary, runs):
    table = Table("Adaptive against uniform with as many paths: one thread, the fast pool",
                  ["scene", "RMSE asked for", "estimated", "reached", "samples a pixel", "error at equal paths",
                   "time at equal error (uniform / adaptive)", "winner", "shift of the mean, adaptive", "uniform"])
    for scene in distinct(runs, "scene"):
        for target in distinct(where(runs, scene=scene), "target"):
            adaptive, uniform = (where(runs, scene=scene, target=target, method=m) for m in ("adaptive", "uniform"))
            comparison = compare(runs_of(adaptive), runs_of(uniform))
            reached = rmse(runs_of(adaptive))
            equal_paths = rmse(runs_of(uniform))
            table.rows.append([scene, f"{target:g}", f"{mean(numbers(adaptive, 'rmse_estimate')):.4g}", f"{reached:.4g}",
                               f"{mean(numbers(adaptive, 'samples')):.1f}", error_text(reached, equal_paths),
                               str(comparison), NAMES[comparison.winner], shift_text(adaptive), shift_text(uniform)])
            if scene == "half_sky":
                summary.findings.append(finding_of(target, comparison))
    return table


def balance(loads):
    table = Table("Load of threads: what the busiest threads of all passes trace, over fair shares",
                  ["scene", "sharing", "threads", "uniform", "adaptive"])
    for scene in distinct(loads, "scene"):
        for sharing in distinct(loads, "sharing"):
            own = where(loads, scene=scene, sharing=sharing)
            load = {row["method"]: f"{row['load']:.3f}" for row in own}
            table.rows.append([scene, sharing, f"{own[0]['threads']:g}", load["uniform"], load["adaptive"]])
    return table


def summarise(run, rows):
    summary = Summary()
    summary.tables = [compared(summary, where(rows, kind="run")), balance(where(rows, kind="load"))]
    summary.pictures.append(Picture(
        "adaptive", "Adaptive sampling against uniform",
        "Left: efficiency 1/(MSE s) of adaptive over uniform sampling, seed by seed, above 1 where adaptive wins. "
        "Right: load of threads under schedules that fix beforehand who does what, hollow for uniform, filled for "
        "adaptive passes. What to see: where noise is uneven over the image adaptive wins, and that noisy pixels "
        "lie together, so that static schedules of lines pay for it."))
    summary.notes.append(
        "Errors are against a reference of independent halves, less its noise. Time at equal error is the ratio of "
        "efficiencies 1/(MSE s), with a percentile bootstrap over seeds; the time of the estimates between passes "
        "counts. Pools take lines on the cores that there are, so that a faster core traces more, which is no waiting. "
        "A shift of the mean beyond its standard error, where uniform has none, is the bias of stopping by what was "
        "seen.")
    return summary


PICTURES = {"adaptive": adaptive}
