"""Efficiency of every schedule, replayed for many threads; and the replay held against real runs."""
from statistics import median

from common import COLOURS, MARKERS, distinct, plt, where


def replay(run, rows):
    rows = where(rows, kind="replayed")
    groups = distinct(rows, "group")
    figure, axes = plt.subplots(2, 2, figsize=(14, 8), sharex=True, sharey=True)
    for axis, group in zip(axes.flat, groups):
        own = where(rows, group=group)
        for i, way in enumerate(distinct(own, "way")):
            points = sorted(where(own, way=way), key=lambda row: row["threads"])
            threads = [row["threads"] for row in points]
            colour = COLOURS[i % len(COLOURS)]
            axis.plot(threads, [100 * row["efficiency_time"] for row in points], color=colour,
                      marker=MARKERS[i % len(MARKERS)], markersize=4.5, label=way)
            axis.plot(threads, [100 * row["efficiency_costs"] for row in points], color=colour, linestyle="--", linewidth=0.9)
        threads = sorted(distinct(own, "threads"))
        axis.plot(threads, [100 * max(row["efficiency_bound"] for row in where(own, threads=n)) for n in threads],
                  color="black", linestyle=":", linewidth=1.2, label="perfect balance")
        axis.set_title(group)
        axis.set_xscale("log", base=2)
        ticks = [t for t in sorted(distinct(own, "threads")) if t == 1 or t ** 0.5 == int(t ** 0.5) or t < 4]
        axis.set_xticks(ticks, [f"{t:.0f}" for t in ticks])
        axis.minorticks_off()
        axis.set_ylim(0, 103)
        axis.legend(loc="upper left", bbox_to_anchor=(1, 1), fontsize=8.5)
    for axis in axes[:, 0]:
        axis.set_ylabel("efficiency, %")
    for axis in axes[1]:
        axis.set_xlabel("threads")
    return figure


def reality(run, rows):
    real = where(rows, kind="real")
    most = max(distinct(real, "threads"))
    ways = distinct(real, "way")
    figure, axes = plt.subplots(1, 2, figsize=(12, 5.2), sharey=True)
    for place, way in enumerate(ways):
        replayed = {row["threads"]: row["efficiency_costs"] for row in where(rows, kind="replayed", way=way)}
        one = {row["repeat"]: row["seconds"] for row in where(real, way=way, threads=1)}
        shared = where(real, way=way, threads=most)
        clock = [100 * one[row["repeat"]] / row["seconds"] / most for row in shared]
        balance = [100 * row["processor_balance"] for row in shared]
        axes[0].plot(100 * replayed[most] / replayed[1], place, marker="d", color="#888888", linestyle="none", markersize=5,
                     label="replayed, equal speeds")
        for axis, measured, column in ((axes[0], clock, "predicted"), (axes[1], balance, "predicted_balance")):
            predicted = 100 * median(row[column] for row in shared)
            middle = median(measured)
            axis.barh(place, 6, left=predicted - 3, height=0.75, color="#D9D9D9", label="within 3 points")
            axis.plot(predicted, place - 0.15, marker="D", color=COLOURS[0], linestyle="none", markersize=6.5,
                      label="replayed, their speeds")
            axis.errorbar(middle, place + 0.18, xerr=[[middle - min(measured)], [max(measured) - middle]], color=COLOURS[3],
                          marker="o", markerfacecolor="white", markersize=6.5, capsize=2.5, elinewidth=1, linestyle="none",
                          label="measured")
    for axis, what in zip(axes, ("speedup / threads, by the clock, %", "mean / largest processor time, %")):
        axis.set_xlabel(f"{what}, {most:.0f} threads")
        axis.grid(axis="y", visible=False)
    axes[0].set_yticks(range(len(ways)), ways)
    axes[0].invert_yaxis()
    handles = dict(zip(*reversed(axes[0].get_legend_handles_labels())))
    axes[1].legend(handles.values(), handles.keys(), loc="upper left", bbox_to_anchor=(1, 1), fontsize=9)
    return figure


PICTURES = {"replay": replay, "reality": reality}
