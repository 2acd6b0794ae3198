"""What a limit of depth cuts off, by scene; and what a segment costs by depth, by engine."""
from common import COLOURS, MARKERS, distinct, line, plt, spread, where

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
                line(axis, depths, [spread(where(done, depth=depth), "ns_per_segment") for depth in depths], index=i,
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


PICTURES = {"depth_error": depth_error, "depth_time": depth_time}
