"""Time of each way of handing out the image, by engine and thread count."""
from common import COLOURS, HATCHES, bars, distinct, plt, spread, where


def schedules(run, rows):
    engines, ways = distinct(rows, "engine"), distinct(rows, "way")
    threads = sorted(distinct(rows, "threads"))
    figure, axes = plt.subplots(1, len(engines), figsize=(10, 5.2), sharey=True, squeeze=False)
    for axis, engine in zip(axes[0], engines):
        height = 0.8 / len(threads)
        for i, count in enumerate(threads):
            places = [w + (i - (len(threads) - 1) / 2) * height for w in range(len(ways))]
            bars(axis, places, [spread(where(rows, engine=engine, threads=count, way=way), "seconds") for way in ways],
                 height=height, color=COLOURS[i], hatch=HATCHES[i], label=f"{count:.0f} thread{'s' if count > 1 else ''}")
        axis.set_yticks(range(len(ways)), ways)
        axis.set_title(engine)
        axis.set_xlabel("seconds")
        axis.grid(axis="y", visible=False)
        axis.set_xlim(left=0)
        axis.xaxis.set_major_locator(plt.MaxNLocator(5))
    axes[0][0].invert_yaxis()
    axes[0][-1].legend(loc="upper left", bbox_to_anchor=(1, 1))
    return figure


PICTURES = {"schedules": schedules}
