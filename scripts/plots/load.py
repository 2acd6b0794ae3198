"""Work of each thread, a small panel for each way of sharing it out, all on one scale."""
from common import COLOURS, distinct, plt, where


def load(run, rows):
    rows = where(rows, repeat=0)
    ways = distinct(rows, "group", "way")
    ways.sort(key=lambda way: way[0] != "recursion")
    columns = 5
    lines = -(-len(ways) // columns)
    figure, axes = plt.subplots(lines, columns, figsize=(13, 0.9 + 2.05 * lines), sharex=True, sharey=True, squeeze=False)
    for axis, (group, way) in zip(axes.flat, ways):
        own = sorted(where(rows, group=group, way=way), key=lambda row: row["thread"])
        tests = [row["tests"] for row in own]
        mean = sum(tests) / len(tests) or 1
        mean_rays = sum(row["segments"] for row in own) / len(own) or 1
        threads = [row["thread"] for row in own]
        axis.bar(threads, [t / mean for t in tests], width=0.85, color=COLOURS[4] if group == "recursion" else COLOURS[1],
                 edgecolor="black" if len(own) <= 32 else "none", linewidth=0.5)
        axis.plot(threads, [row["segments"] / mean_rays for row in own], marker="o", color="black", markerfacecolor="white",
                  markersize=4 if len(own) <= 32 else 1.5, linestyle="none")
        axis.axhline(1, color="black", linewidth=0.9)
        name = f"pool: {way}" if group == "pool" else way
        source = "" if own[0]["source"] == "counted" else f"  ({own[0]['source']})"
        axis.set_title(f"{name}\n$\\bf{{{max(tests) / mean:.3f}}}${source}", fontsize=8.5)
        axis.grid(axis="x", visible=False)
        axis.set_ylim(bottom=0)
    for axis in axes.flat[len(ways):]:
        axis.set_visible(False)
    for axis in axes[:, 0]:
        axis.set_ylabel("work / mean")
    for column in range(columns):
        last = max((i for i in range(lines) if i * columns + column < len(ways)), default=0)
        axes[last][column].set_xlabel("thread")
        axes[last][column].tick_params(labelbottom=True)
    return figure


PICTURES = {"load": load}
