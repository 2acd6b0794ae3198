"""Error against time: who reaches which error first, bias floors and the Pareto front."""
import math
from statistics import median

from .data import distinct, numbers, where
from .drawing import COLOURS, MARKERS, plt, remember
from .efficiency import LEAST_SEEDS, Runs, Winner, compare, log_log_slope, pareto_front, rmse
from .summary import Finding, Picture, Summary, Table
from .verdict import judged

STYLES = ["-", "-", "--", "-.", ":"]


def points(rows):
    """(seconds, RMSE) by samples per pixel; where the correction for noise left no error there is no point."""
    found = []
    for spp in sorted(distinct(rows, "spp")):
        at = where(rows, spp=spp)
        error = rmse(Runs(numbers(at, "seconds"), numbers(at, "mse")))
        if error > 0:
            found.append((median(numbers(at, "seconds")), error))
    return found


def floor_of(bias, configuration):
    """The bias as an error, or None where it does not stand out of its noise. The engine does not change it."""
    for row in where(bias, configuration=without_engine(configuration)):
        if row["bias_squared"] > 2 * row["bias_error"]:
            return math.sqrt(row["bias_squared"])
    return None


def speed_accuracy(run, rows):
    scenes = distinct(where(rows, kind="run"), "scene")
    configurations = list(dict.fromkeys(distinct(where(rows, kind="bias"), "configuration")
                                        + sorted(distinct(where(rows, kind="run"), "configuration"))))
    columns = min(2, len(scenes))
    lines = math.ceil(len(scenes) / columns)
    figure, axes = plt.subplots(lines, columns, figsize=(6.2 * columns + 1, 4.6 * lines + 1.2), squeeze=False)
    handles = {}
    for axis, scene in zip(axes.flat, scenes):
        runs = where(rows, kind="run", scene=scene)
        bias = where(rows, kind="bias", scene=scene)
        every = []
        for i, configuration in enumerate(configurations):
            found = points(where(runs, configuration=configuration))
            if not found:
                continue
            every += found
            colour = COLOURS[i % len(COLOURS)]
            handles[configuration], = axis.plot(*zip(*found), color=colour, marker=MARKERS[i % len(MARKERS)], markersize=5,
                                                linestyle=STYLES[i // len(COLOURS) % len(STYLES)], linewidth=1.2,
                                                markerfacecolor=colour if i < len(COLOURS) else "white")
            remember(handles[configuration], [(error,) * 3 for _, error in found], name=configuration)
            floor = floor_of(bias, configuration)
            if floor is not None and floor > 0.3 * min(error for _, error in found):
                axis.axhline(floor, color=colour, linestyle=(0, (4, 3)), linewidth=0.9)
        front = pareto_front(every)
        handles["Pareto front"] = axis.scatter(*zip(*front), s=110, facecolors="none", edgecolors="black", linewidths=1.1,
                                               zorder=5)
        # The slope of chance, through the first point of the front.
        times = [min(t for t, _ in every), max(t for t, _ in every)]
        start = front[0]
        handles["slope -1/2"], = axis.plot(times, [start[1] * math.sqrt(start[0] / t) for t in times], color="#999999",
                                           linewidth=3, alpha=0.5, zorder=0)
        axis.set_xscale("log")
        axis.set_yscale("log")
        axis.set_title(scene)
        axis.set_xlabel("seconds of a render")
        axis.set_ylabel("RMSE, linear radiance")
    for axis in axes.flat[len(scenes):]:
        axis.set_visible(False)
    axes[0][-1].legend(list(handles.values()), list(handles), loc="upper left", bbox_to_anchor=(1.01, 1), fontsize=9)
    return figure


USUAL_DEPTH = 50  # what names of configurations leave out


def without_engine(configuration):
    """The bias belongs to the image, which the engine does not change: its rows are the pool's."""
    return configuration.replace("recursion", "pool")


class Scene:
    """Rows of one scene."""

    def __init__(self, rows, name):
        self.name = name
        self.bias, self.runs = (where(rows, scene=name, kind=kind) for kind in ("bias", "run"))
        self.configurations = distinct(self.runs, "configuration")
        self.spps = sorted(distinct(self.runs, "spp"))

    def at(self, configuration, spp):
        """In the order of their seeds, which is that of the rows of any one configuration."""
        rows = where(self.runs, configuration=configuration, spp=spp)
        return Runs(numbers(rows, "seconds"), numbers(rows, "mse"))

    def compare(self, first, second, spp):
        return compare(self.at(first, spp), self.at(second, spp))

    def bias_text(self, configuration):
        """The bias as an error: "3.1e-02", or "< 2e-05" where it does not stand out of its noise."""
        for row in where(self.bias, configuration=without_engine(configuration)):
            squared, error = row["bias_squared"], row["bias_error"]
            if squared == 0 and error == 0:
                return "0"  # the trusted images, bit by bit
            return f"{math.sqrt(squared):.1e}" if squared > 2 * error else f"< {math.sqrt(max(squared, 0) + 2 * error):.1e}"
        return ""


def ratio_text(c):
    is_told = math.isfinite(c.ratio) and math.isfinite(c.interval.high)
    return str(c) if is_told else "too near the reference to tell"


def slope_text(spps, errors):
    points = [point for point in zip(spps, errors) if point[1] > 0]
    return f"{log_log_slope(*zip(*points)):.2f}" if len(points) > 1 else ""


def base_of(run):
    """The fast pool in float: what the others are held against."""
    depth = run["options"]["depth"]
    return "float pool" if depth in (0, USUAL_DEPTH) else f"float pool, depth {depth}"


def questions(base):
    """What one thing changes: a claim, and who is held against whom."""
    shallow = base.split(", depth")[0] + ", depth 5"
    return [
        ("the pool reaches the error of recursion in less time (the images are the same, so the ratio is that of the times)",
         base, base.replace("pool", "recursion")),
        ("float reaches the error of double in less time", base, base.replace("float", "double")),
        ("Sobol points reach the error of independent ones in less time", base.replace("pool", "pool, Sobol"), base),
        ("Russian roulette reaches the error of whole paths in less time", base.replace("pool", "pool, roulette"), base),
        ("a depth of 5 reaches less error in the time of the whole depth", shallow, base),
        ("to follow both branches of the first hit on glass reaches an error in less time", f"{base}, split 1", base),
        ("lights sampled beside chance (mis) reach an error in less time than chance alone", f"{base}, mis", base),
        ("mis reaches an error in less time than lights sampled alone", f"{base}, mis", f"{base}, light")]


def overview(scene, base):
    most = scene.spps[-1]
    table = Table(f"{scene.name}: at {most:g} samples a pixel, held against {base}",
                  ["configuration", "RMSE", "ms", "slope of the RMSE", "bias (RMSE)", "efficiency", "verdict"])
    for configuration in scene.configurations:
        errors = [rmse(scene.at(configuration, spp)) for spp in scene.spps]
        runs, found = scene.at(configuration, most), scene.compare(configuration, base, most)
        verdict = {Winner.FIRST: "better", Winner.SECOND: "worse"}.get(
            found.winner, "too few seeds" if len(runs.mse) < LEAST_SEEDS else "no difference")
        is_base = configuration == base
        table.rows.append([configuration, f"{errors[-1]:.3e}", f"{1e3 * median(runs.seconds):.3g}",
                           slope_text(scene.spps, errors), scene.bias_text(configuration),
                           "1" if is_base else ratio_text(found), "" if is_base else verdict])
    return table


def by_samples(scene, base):
    table = Table(f"{scene.name}: efficiency by samples a pixel", ["first, over second", *(f"{n:g}" for n in scene.spps)])
    for _, first, second in questions(base):
        if {first, second} <= set(scene.configurations):
            table.rows.append([f"{first} / {second}",
                               *(ratio_text(scene.compare(first, second, spp)) for spp in scene.spps)])
    return table


def answer(claim, first, second, scenes):
    """One answer over all scenes: it holds where the first wins everywhere. None where no scene has both."""
    parts, winners, seeds, spp = [], [], 0, 0
    for scene in scenes:
        if not {first, second} <= set(scene.configurations):
            continue
        spp = scene.spps[-1]
        seeds = len(scene.at(first, spp).mse)
        found = scene.compare(first, second, spp)
        winners.append(found.winner)
        parts.append(f"{scene.name} {ratio_text(found)}"
                     + (", no difference" if found.winner == Winner.NO_DIFFERENCE else ""))
    if not parts:
        return None
    finding = Finding(f"at {spp:g} samples a pixel {claim}", "; ".join(parts))
    if seeds < LEAST_SEEDS:
        finding.why = f"fewer than {LEAST_SEEDS} seeds"
    elif set(winners) in ({Winner.FIRST}, {Winner.SECOND}):
        finding.verdict = judged(winners[0] == Winner.FIRST)
    else:
        finding.why = "no difference" if set(winners) == {Winner.NO_DIFFERENCE} else "it depends on the scene"
    return finding


def bias_finding(scenes, base):
    """That float has no bias that an image would show."""
    parts, is_small = [], True
    for scene in scenes:
        row = where(scene.bias, configuration=base)[0]
        error = rmse(scene.at(base, scene.spps[-1]))
        is_small &= math.sqrt(max(row["bias_squared"] + 2 * row["bias_error"], 0)) < 0.1 * error
        parts.append(f"{scene.name} {scene.bias_text(base)} (error {error:.1e})")
    return Finding(f"the bias of {base} is below a tenth of its error at the most samples", "; ".join(parts),
                   judged(is_small))


def summarise(run, rows):
    scenes = [Scene(rows, name) for name in distinct(rows, "scene")]
    base = base_of(run)
    answers = [answer(*question, scenes) for question in questions(base)]
    summary = Summary(findings=[*filter(None, answers), bias_finding(scenes, base)])
    summary.tables = [table(scene, base) for scene in scenes for table in (overview, by_samples)]
    summary.pictures.append(Picture(
        "speed_accuracy", "Error against time",
        "Root mean square error of linear radiance against the time of a render, both on logarithmic scales; a line "
        "for each configuration, a point for each count of samples (mean of the squared errors, median of the times, "
        "over the seeds). Grey: the slope of chance, -1/2. Dashed: the bias, an error that more samples do not mend. "
        "Ringed: the Pareto front, points that no other beats in both. What to see: a line further to the left "
        "reaches the same error sooner; a line that bends onto its dashed floor never reaches what lies below."))
    summary.notes = [
        "Errors are held against the mean of two independent halves, double, deep, with 32 times the greatest count of "
        "samples each; the noise that the reference itself has is taken off.",
        "Efficiency is 1 / (mean squared error x seconds). Ratios are of runs with the same seeds, side by side, with "
        "the 95 % interval of a bootstrap over the seeds; somebody wins only where it excludes 1 and there are at least "
        f"{LEAST_SEEDS} seeds."]
    return summary


PICTURES = {"speed_accuracy": speed_accuracy}
