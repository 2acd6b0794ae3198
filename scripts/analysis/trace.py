"""Draws the spans of a trace, a lane for each thread, for a page or a slide.

The trace is what `raypool render --trace` wrote. Rounds are outlined, stages and waiting are filled.
"""
import json

from .drawing import COLOURS, HATCHES, plt, write

STAGES = ["generate", "intersect", "shade", "accumulate", "append", "sort", "wait"]
STAGE_COLOURS = [*COLOURS[:6], "#BBBBBB"]


def draw(trace, picture):
    with open(trace, encoding="utf-8") as file:
        events = json.load(file)["traceEvents"]
    spans = [e for e in events if e["ph"] == "X"]
    counters = [e for e in events if e["ph"] == "C"]
    threads = sorted({e["tid"] for e in spans})

    figure, (records, lanes) = plt.subplots(2, 1, figsize=(11, 4.2), sharex=True, height_ratios=[1, len(threads)])
    for counter in counters[:1]:
        same = [e for e in counters if e["name"] == counter["name"]]
        key = next(iter(counter["args"]))
        records.step([e["ts"] / 1000 for e in same], [e["args"][key] / 1000 for e in same], where="post", color="black")
        records.set_ylabel("thousand\nrecords")
    for stage, colour, hatch in zip(STAGES, STAGE_COLOURS, [*HATCHES[:6], ""]):
        of_stage = [e for e in spans if e["name"] == stage]
        for i, thread in enumerate(threads):
            bars = [(e["ts"] / 1000, e["dur"] / 1000) for e in of_stage if e["tid"] == thread]
            lanes.broken_barh(bars, (i - 0.35, 0.7), facecolor=colour, edgecolor="none", hatch=hatch,
                              label=stage if i == 0 and bars else None)
    for i, thread in enumerate(threads):
        rounds = [(e["ts"] / 1000, e["dur"] / 1000) for e in spans if e["tid"] == thread and e["name"].startswith("round")]
        lanes.broken_barh(rounds, (i - 0.42, 0.84), facecolor="none", edgecolor="black", linewidth=0.8)
    lanes.set_yticks(range(len(threads)), [f"thread {t}" for t in threads])
    lanes.set_xlabel("milliseconds since the start of the render")
    lanes.legend(loc="upper left", bbox_to_anchor=(1, 1))
    figure.tight_layout()
    write(figure, picture, {"Software": None})
