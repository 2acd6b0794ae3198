"""What each feature costs where it is compiled in and not used: time in percent for both engines, bytes of a record."""
import statistics

from common import COLOURS, MARKERS, distinct, plt, where


def percent(rows, engine, scene, compiled, base):
    """Median, lowest and highest of the time over that of `base`, run by run, as percent more."""
    times, bases = ([row["seconds"] for row in where(rows, engine=engine, scene=scene, compiled=name)]
                    for name in (compiled, base))
    more = [100 * (time / other - 1) for time, other in zip(times, bases)]
    return statistics.median(more), min(more), max(more)


def features(run, rows):
    engines = distinct(rows, "engine")
    scene = distinct(rows, "scene")[-1]
    features = [f for f in distinct(where(rows, scene="plain"), "compiled") if f not in ("nothing", "control")]
    lines = [(feature, "plain", feature, "nothing") for feature in features]
    lines[-1] = ("all nine", "plain", "everything", "nothing")
    lines.append((f"{scene}: all nine\ninstead of its own", scene, "everything", "its own"))

    figure, axis = plt.subplots(figsize=(10, 5.6))
    controls = [percent(rows, engine, "plain", "control", "nothing") for engine in engines]
    axis.axvspan(min(c[1] for c in controls), max(c[2] for c in controls), color="#DDDDDD", zorder=0,
                 label="the control: no feature, code at another address")
    for i, engine in enumerate(engines):
        spreads = [percent(rows, engine, *line[1:]) for line in lines]
        places = [place + (i - 0.5) * 0.32 for place in range(len(lines))]
        axis.errorbar([s[0] for s in spreads], places,
                      xerr=[[s[0] - s[1] for s in spreads], [s[2] - s[0] for s in spreads]], fmt=MARKERS[i],
                      color=COLOURS[(0, 3)[i]], markerfacecolor=("white", COLOURS[3])[i], capsize=3, markersize=7,
                      label=engine, zorder=3)
    axis.axvline(0, color="black", linewidth=1)
    for place in (len(features) - 1.5, len(features) - 0.5):
        axis.axhline(place, color="#888888", linewidth=0.8, linestyle=":")

    for place, line in enumerate(lines):
        size = where(rows, engine=engines[-1], scene=line[1], compiled=line[2])[0]["record_bytes"]
        base = where(rows, engine=engines[-1], scene=line[1], compiled=line[3])[0]["record_bytes"]
        axis.text(1.01, place, f"{base:.0f} → {size:.0f} bytes" if size != base else f"{size:.0f} bytes", va="center",
                  transform=axis.get_yaxis_transform(), fontweight="bold" if size != base else "normal")
    axis.set_yticks(range(len(lines)), [line[0] for line in lines])
    axis.invert_yaxis()
    axis.grid(axis="y", visible=False)
    axis.set_xlabel("more time than without it, %")
    axis.set_title("a record in the pool:", loc="right", x=1.13, fontsize=9)
    axis.legend(loc="upper center", bbox_to_anchor=(0.5, 1.11), ncol=3)
    return figure


PICTURES = {"features": features}
