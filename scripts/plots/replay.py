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
    figure, axis = plt.subplots(figsize=(9.5, 5.6))
    for place, way in enumerate(ways):
        replayed = {row["threads"]: row["efficiency_costs"] for row in where(rows, kind="replayed", way=way)}
        predicted = 100 * replayed[most] / replayed[1]
        runs = {n: {row["repeat"]: row for row in where(real, way=way, threads=n)} for n in (1, most)}
        measured = []
        for repeat, one in runs[1].items():
            more = runs[most][repeat]
            machine = one["loop_seconds"] / more["loop_seconds"]
            measured.append(100 * one["seconds"] / more["seconds"] / most / machine)
        balance = [100 * row["processor_balance"] for row in runs[most].values()]
        axis.barh(place, 6, left=predicted - 3, height=0.8, color="#D9D9D9", label="within 3 points" if place == 0 else None)
        axis.plot(predicted, place, marker="D", color=COLOURS[0], linestyle="none", markersize=7,
                  label="replayed" if place == 0 else None)
        for values, shift, colour, marker, name in ((measured, -0.22, COLOURS[3], "o", "by the clock"),
                                                    (balance, 0.22, "black", "s", "by processor time")):
            middle = median(values)
            axis.errorbar(middle, place + shift, xerr=[[middle - min(values)], [max(values) - middle]], color=colour,
                          marker=marker, markerfacecolor="white", markersize=6, capsize=2.5, elinewidth=1, linestyle="none",
                          label=name if place == 0 else None)
    axis.set_yticks(range(len(ways)), ways)
    axis.invert_yaxis()
    axis.grid(axis="y", visible=False)
    axis.set_xlabel(f"efficiency with {most:.0f} threads, %")
    axis.legend(loc="upper left", bbox_to_anchor=(1, 1))
    return figure


PICTURES = {"replay": replay, "reality": reality}
