"""What each feature costs where it is compiled in and not used: time in percent for both engines, bytes of a record."""
from statistics import median

from .data import distinct, numbers, where
from .drawing import COLOURS, MARKERS, plt, remember
from .spreads import ratios, shortest, spread, text
from .summary import Finding, Picture, Summary, Table
from .verdict import judged

LEAST_RUNS = 3  # that have a spread worth the name


def percent(rows, engine, scene, compiled, base):
    """Median, lowest and highest of the time over that of `base`, run by run, as percent more."""
    times, bases = (numbers(where(rows, engine=engine, scene=scene, compiled=name), "seconds") for name in (compiled, base))
    return spread([100 * (ratio - 1) for ratio in ratios(times, bases)])


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
        drawn = axis.errorbar([s[0] for s in spreads], places,
                              xerr=[[s[0] - s[1] for s in spreads], [s[2] - s[0] for s in spreads]], fmt=MARKERS[i],
                              color=COLOURS[(0, 3)[i]], markerfacecolor=("white", COLOURS[3])[i], capsize=3, markersize=7,
                              label=engine, zorder=3)
        remember(drawn[0], spreads, "x", engine)
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


def time_ratio(rows, engine, scene, compiled):
    """Over what the scene takes without any feature that it does not use, run by run."""
    base = "nothing" if scene == "plain" else "its own"
    times = (numbers(where(rows, engine=engine, scene=scene, compiled=name), "seconds") for name in (compiled, base))
    return spread(ratios(*times))


def table_of(rows, scene, engines):
    table = Table(f"Scene {scene}: time by what the kernels were compiled for",
                  ["compiled for", "bytes of a record", "in double precision"])
    for engine in engines:
        table.header += [f"{engine}, M paths/s", f"{engine}, time over the first row's"]
    for compiled in distinct(where(rows, scene=scene), "compiled"):
        record = where(rows, engine=engines[-1], scene=scene, compiled=compiled)[0]
        cells = [compiled, shortest(record["record_bytes"]), shortest(record["record_bytes_double"])]
        for engine in engines:
            rates = numbers(where(rows, engine=engine, scene=scene, compiled=compiled), "mpaths_per_s")
            cells += [f"{median(rates):.2f}", text(time_ratio(rows, engine, scene, compiled))]
        table.rows.append(cells)
    return table


def cost_finding(rows, claim, scene, compiled):
    """Slower is what every run is, and by more than the place of the code makes of the time."""
    ours, is_any_slower, is_all_within = [], False, True
    for engine in distinct(rows, "engine"):
        time, control = time_ratio(rows, engine, scene, compiled), time_ratio(rows, engine, "plain", "control")
        is_slower = time.low > 1 and time.median > control.high
        is_any_slower |= is_slower
        is_all_within &= time.median <= control.high
        ours.append(f"{engine}: {'slower' if is_slower else 'no difference'}, {text(time)}")
    finding = Finding(claim, "; ".join(ours))
    if time.runs < LEAST_RUNS:
        finding.why = "fewer than three runs have no spread"
    elif is_any_slower or is_all_within:
        finding.verdict = judged(is_any_slower)
    else:
        finding.why = "slower than the control, not in every run"
    return finding


def summarise(run, rows):
    engines, scenes = distinct(rows, "engine"), distinct(rows, "scene")
    summary = Summary(tables=[table_of(rows, scene, engines) for scene in scenes])
    for compiled in distinct(where(rows, scene="plain"), "compiled"):
        if compiled not in ("nothing", "control", "everything"):
            claim = f"`{compiled}` costs time where it is compiled in and not used"
            summary.findings.append(cost_finding(rows, claim, "plain", compiled))
    summary.findings.append(cost_finding(rows, "all features together cost time where none is used", "plain", "everything"))
    summary.findings.append(
        cost_finding(rows, f"what `{scenes[-1]}` does not use costs it time", scenes[-1], "everything"))
    sizes = numbers(where(rows, engine=engines[-1]), "record_bytes")
    summary.findings.append(Finding("a record of single precision holds at most 64 bytes",
                                    f"{min(sizes)} to {max(sizes)} bytes, in single precision", judged(max(sizes) <= 64)))
    summary.pictures.append(Picture(
        "features", "What an unused feature costs",
        "The plain scene uses no feature. Each mark is the time with one feature compiled in over the time with "
        "none: the median of runs side by side, with their lowest and highest. Grey: the range of the control, "
        "which is the same code at another address. What to see: marks right of the grey band are what leaving "
        "the feature out gains; the bytes of a record change with motion only."))
    summary.notes.append(
        "A feature is said to be slower where every run was slower than its neighbour without it, and the median is "
        "beyond every run of the control; `fuzz` comes with the metal that it belongs to. All rows of a scene have "
        "one hash.")
    return summary


PICTURES = {"features": features}
