"""Light sampling against chance: the cost of a path, the noise of a sample, and the time to equal error."""
import math
from statistics import median

from .data import distinct, numbers, where
from .drawing import COLOURS, MARKERS, plt, remember
from .efficiency import LEAST_SEEDS, Runs, Winner, compare, mean
from .spreads import Spread
from .summary import Finding, Picture, Summary, Table
from .verdict import judged

SAMPLED = ("light", "mis")
ASKED = {"cornell": 1, "small_lamp": 10, "many_lights": 10}  # times as soon as by chance, at least


def runs_of(rows, error):
    """Of one way: seconds, and the errors over all pixels or over those off the lamps."""
    return Runs(numbers(rows, "seconds"), numbers(rows, error))


class Subject:
    """The runs of one scene, seed by seed."""

    def __init__(self, rows, group, name):
        self.group, self.name = group, str(name)
        self.rows = {way: where(rows, group=group, subject=name, light_sampling=way) for way in ("none", *SAMPLED)}
        self.samples_lights = any(row["shadow_rays"] for row in self.rows["mis"])

    def cost(self, way):
        """Nanoseconds of a path."""
        return median(1e9 * row["seconds"] / row["paths"] for row in self.rows[way])

    def error_of_a_sample(self, way):
        return mean([row["mse"] * row["spp"] for row in self.rows[way]])

    def gain(self, way, error="mse"):
        """Times as soon as by chance, or None where nothing can be told."""
        ours, chance = runs_of(self.rows[way], error), runs_of(self.rows["none"], error)
        if not ours.mse:
            return None
        found = compare(ours, chance)
        return found if math.isfinite(found.ratio) and math.isfinite(found.interval.high) else None


def subjects_of(rows):
    return [Subject(rows, *key) for key in distinct(rows, "group", "subject")]


def text(value):
    return "" if value is None else str(value)


def table_of(group, subjects):
    table = Table(f"By {group}: light sampling against chance",
                  [group, "lights found by", "ns a path", "over chance", "squared error of a sample",
                   "error in the time of chance", "times as soon", "off the lamps", "winner"])
    for subject in subjects:
        for way in subject.rows:
            cells = [subject.name, way, f"{subject.cost(way):.0f}", f"{subject.cost(way) / subject.cost('none'):.2f}",
                     f"{subject.error_of_a_sample(way):.3g}"]
            found = subject.gain(way)
            if way == "none" or not subject.samples_lights:
                table.rows.append([*cells, "", "", "", "" if subject.samples_lights else "the same image"])
                continue
            told = {None: "", Winner.FIRST: way, Winner.SECOND: "chance", Winner.NO_DIFFERENCE: "no difference"}
            table.rows.append([*cells, f"{1 / math.sqrt(found.ratio):.3g}" if found else "", text(found),
                               text(subject.gain(way, "mse_off_lamps")), told[found and found.winner]])
    return table


def finding_of(subject, asked):
    found = subject.gain("mis")
    claim = "sooner than" if asked == 1 else f"at least {asked} times as soon as"
    finding = Finding(f"on {subject.name} mis reaches an error {claim} chance", text(found))
    if not found or len(subject.rows["mis"]) < LEAST_SEEDS:
        finding.why = f"fewer than {LEAST_SEEDS} seeds" if found else "errors are too near the reference"
    elif found.interval.excludes(asked):
        finding.verdict = judged(found.ratio > asked)
    else:
        finding.why = f"the interval includes {asked}"
    return finding


def without_lights(subject):
    gains = [subject.gain(way) for way in SAMPLED]
    finding = Finding(f"on {subject.name}, which has no lights, light sampling changes no bit and takes no time",
                      "the same hashes; times as soon: " + ", ".join(text(found) for found in gains))
    if None in gains:
        finding.why = "errors are too near the reference"
    else:
        finding.verdict = judged(all(found.winner != Winner.SECOND for found in gains))
    return finding


def light(run, rows):
    subjects = [s for s in subjects_of(where(rows, kind="run")) if s.samples_lights]
    figure, axis = plt.subplots(figsize=(9.5, 1.6 + 0.42 * max(len(subjects), 3)))
    for place, subject in enumerate(subjects):
        for i, way in enumerate(SAMPLED):
            for shift, error, fill in ((-0.09, "mse", COLOURS[i]), (0.09, "mse_off_lamps", "white")):
                found = subject.gain(way, error)
                if found:
                    y = place + 0.36 * (i - 0.5) + shift
                    axis.plot(found.interval, [y, y], color=COLOURS[i], linewidth=1.2)
                    point, = axis.plot([found.ratio], [y], MARKERS[i], color=COLOURS[i], markerfacecolor=fill, markersize=6,
                                       label=f"{way}, {'all pixels' if error == 'mse' else 'off the lamps'}")
                    remember(point, [Spread(found.ratio, *found.interval, len(subject.rows[way]))], "x")
    axis.axvline(1, color="black", linewidth=0.9)
    axis.set_xscale("log")
    axis.set_yticks(range(len(subjects)), [f"{s.group}: {s.name}" if s.group != "scene" else s.name for s in subjects])
    axis.invert_yaxis()
    axis.set_xlabel("times as soon as chance at equal error")
    handles = dict(zip(*reversed(axis.get_legend_handles_labels())))
    if handles:
        axis.legend(handles.values(), handles, loc="upper left", bbox_to_anchor=(1.01, 1), fontsize=9)
    return figure


def summarise(run, rows):
    subjects = subjects_of(where(rows, kind="run"))
    summary = Summary()
    for subject in subjects:
        if subject.group == "scene" and subject.name in ASKED:
            summary.findings.append(finding_of(subject, ASKED[subject.name]))
        elif not subject.samples_lights:
            summary.findings.append(without_lights(subject))
    summary.tables = [table_of(group, [s for s in subjects if s.group == group])
                      for group in dict.fromkeys(s.group for s in subjects)]
    summary.pictures.append(Picture(
        "light", "How much sooner an image has an error",
        "Time to an error by chance over that with light sampling, with the 95 % interval of a bootstrap over the seeds, "
        "on a logarithmic scale; right of the line light sampling wins. Filled: all pixels. Hollow: those none of whose "
        "camera rays meets a lamp. What to see: small lamps gain most and large ones little; what mirrors and glass "
        "throw is found by chance alone; and the edge of a bright lamp hides the gain of the rest of an image."))
    summary.notes = [
        "Same seeds, one after the other. An error is held against the mean of two independent halves, made with mis, "
        "with 16 times the samples each; the noise that they have themselves is taken off.",
        "Times as soon: the ratio of the efficiencies 1 / (squared error x seconds), which no count of samples changes. "
        "Error in the time of chance: over the error that chance has then, the root of that ratio turned over.",
        "In the room one wall is open, the lamp hangs in the ceiling, shines downward and has the same power at every "
        "size. Where the floor is of metal light is sampled at the walls and the ball alone."]
    return summary


PICTURES = {"light": light}
