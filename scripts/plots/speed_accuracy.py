"""Error against time: a panel for each scene, a line for each configuration, bias floors and the Pareto front."""
import math
import statistics

from common import COLOURS, MARKERS, distinct, plt, where

STYLES = ["-", "-", "--", "-.", ":"]


def points(rows):
    """(seconds, RMSE) by samples per pixel; where the correction for noise left no error there is no point."""
    found = []
    for spp in sorted(distinct(rows, "spp")):
        at = where(rows, spp=spp)
        mse = statistics.fmean(row["mse"] for row in at)
        if mse > 0:
            found.append((statistics.median(row["seconds"] for row in at), math.sqrt(mse)))
    return found


def front_of(all_points):
    """Points that no other beats in both, by rising time."""
    front, least = [], math.inf
    for seconds, error in sorted(all_points):
        if error < least:
            least = error
            front.append((seconds, error))
    return front


def floor_of(bias, configuration):
    """The bias as an error, or None where it does not stand out of its noise. The engine does not change it."""
    for row in where(bias, configuration=configuration.replace("recursion", "pool")):
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
            floor = floor_of(bias, configuration)
            if floor is not None and floor > 0.3 * min(error for _, error in found):
                axis.axhline(floor, color=colour, linestyle=(0, (4, 3)), linewidth=0.9)
        front = front_of(every)
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


PICTURES = {"speed_accuracy": speed_accuracy}
