"""Where numerical methods break: error curves, a panel a case; verdicts, costs, and images that a naive method ruined."""
from pathlib import Path

from .data import distinct, numbers, where
from .drawing import COLOURS, MARKERS, plt, remember
from .spreads import spread, text
from .summary import Finding, Picture, Summary, Table
from .verdict import judged

LINES = {"naive": "--", "ours": "-", "other": ":"}
PALETTE = {"naive": [COLOURS[3], COLOURS[1], COLOURS[5]], "ours": [COLOURS[0], COLOURS[6], COLOURS[2]],
           "other": [COLOURS[4], COLOURS[2]]}
ROWS = {"spheres": "1", "leaving": "2", "boxes": "3", "scattering": "4", "paths": "56", "others": "78+",
        "lights": "L", "skies": "S"}


def belongs(row, rows):
    row = row["row"]
    first = {"10": "8", "11": "L" if row < "11h" else "S"}.get(row[:2], row[0])  # large images go with the checkers
    return first in rows


def order(row):
    return (99, row) if row == "+" else (int(row[:-1]), row[-1])


def panel(axis, case, rows):
    methods = distinct(rows, "method")
    values = distinct(where(rows, method=methods[0]), "value")
    errors = [row["error"] for row in rows]
    positive = [e for e in errors if e > 0]
    tolerance = rows[0]["tolerance"]
    floor = min(positive + ([tolerance] if tolerance > 0 else []) + [1e-3]) / 8
    is_log = min(values) > 0 and max(values) >= 50 * min(values)
    places = values if is_log else range(len(values))
    seen = dict.fromkeys(LINES, 0)
    for i, method in enumerate(methods):
        of_method = where(rows, method=method)
        kind = of_method[0]["method_kind"]
        colour = PALETTE[kind][seen[kind]]
        seen[kind] += 1
        curve, = axis.plot(places, [max(row["error"], floor) for row in of_method], linestyle=LINES[kind], color=colour,
                           marker=MARKERS[i], markersize=4.5, linewidth=2.2 if kind == "ours" else 1.3, label=method,
                           zorder=3 if kind == "ours" else 2, clip_on=False)
        remember(curve, [(row["error"],) * 3 for row in of_method])  # also of none at all, which lies on the floor
    if tolerance > 0:
        axis.axhline(tolerance, color="#888888", linewidth=1)
    held = sum(row["is_asked"] == 1 for row in where(rows, method=methods[0]))
    if held < len(values):
        axis.axvspan(places[held - 1], places[len(values) - 1], color="#EEEEEE", zorder=0)
    if is_log:
        axis.set_xscale("log")
        if values[0] > values[-1]:
            axis.invert_xaxis()
    else:
        axis.set_xticks(list(places), [f"{v:g}" for v in values])
    axis.set_yscale("log")
    axis.set_ylim(bottom=floor)
    axis.set_title(f"{rows[0]['row']}  {case}", fontsize=9.5, loc="left")
    axis.set_xlabel(rows[0]["parameter"], fontsize=8)
    axis.set_ylabel(rows[0]["measure"].split(", ")[0], fontsize=7.5)
    axis.tick_params(labelsize=7.5)
    axis.legend(fontsize=6.8, loc="best", handlelength=3)


def curves(name):
    def draw(run, rows):
        rows = [row for row in where(rows, kind="curve") if belongs(row, ROWS[name])]
        cases = sorted(distinct(rows, "id"), key=lambda case: order(where(rows, id=case)[0]["row"]))
        columns = 3
        lines = -(-len(cases) // columns)
        figure, axes = plt.subplots(lines, columns, figsize=(13, 3.1 * lines + 0.9), squeeze=False)
        for axis, case in zip(axes.flat, cases):
            panel(axis, case, where(rows, id=case))
        for axis in axes.flat[len(cases):]:
            axis.set_visible(False)
        return figure
    return draw


def images(name):
    def draw(run, rows):
        folder = Path(run["folder"])
        figure, axes = plt.subplots(1, 3, figsize=(13, 3.9))
        share = {row["method_kind"]: row["error"] for row in where(rows, kind="image", id=name)}
        titles = {"naive": f"naive: {100 * share['naive']:.1f} % of the pixels wrong",
                  "ours": f"ours: {100 * share['ours']:.1f} % differ from double",
                  "difference": "naive less double, absolute"}
        for axis, part in zip(axes, titles):
            axis.imshow(plt.imread(folder / f"{name}_{part}.png"), interpolation="nearest")
            axis.set_title(titles[part])
            axis.axis("off")
        return figure
    return draw


# What the pictures of failure show: title and caption by the image of a scene that one naive method ruins.
FAILURES = {
    "acne": ("Acne: a least distance of 1e-3, 20 000 units from the origin",
             "The naive method forgets hits closer than 1e-3. This far out positions are two thousandths apart, so rays that "
             "leave a surface start beneath it and meet it again: dark specks, and rings where the rounding of the ground "
             "changes. Ours knows what a ray leaves."),
    "leak": ("Leak: a least distance of 1e-3, under balls of 5e-4",
             "The naive method forgets hits closer than 1e-3, so rays that leave the floor beneath a ball pass through it: no "
             "shadow where the balls stand. Ours has no least distance."),
    "glass": ("Glass that loses its far wall: a least distance of 1e-3, balls of 4e-4",
              "The naive method never finds the way out of a ball thinner than 1e-3: rays are bent once, and the wall behind "
              "is seen upright. Ours takes the exact second root, and the ball turns the wall upside down."),
    "coincidence": ("Coincidence: a rug in a slope, and balls listed twice",
                    "The naive method knows which shape a ray leaves, and meets the other shape of the same surface at "
                    "once: half of all rays are held, so that the rug and the ball are dark, and glass is none. Ours counts "
                    "coincident surfaces once."),
    "ground": ("Ground: the quadratic of the books, on a sphere of four million units",
               "h^2 - a c of the naive method cancels, so the ground is met too early or too late, in steps: the checker is "
               "torn, and the shadows lie elsewhere. Ours factors the distance to the surface."),
    "checker": ("Checker: (int) in place of floor, around the origin",
                "The naive method rounds towards zero, so the cells on both sides of each axis are one, twice as wide. Ours "
                "takes the whole number below."),
    "lamp": ("Lamp: a shadow ray that goes all the way to it",
             "The naive method asks whether anything is closer than the sampled point. By rounding the lamp itself is, for "
             "nearly every second ray, and as much of the light is missing. Ours asks whether anything but the lamp is "
             "met before it."),
    "shade": ("Shade: a shadow ray that ends at 1 - 1e-4 of its way",
              "Two ten-thousandths before the blue lamp is a shade, which hides all of it. The naive method's shadow rays end "
              "before the shade, so that the scene has a light that is not there. Ours ends at the lamp."),
    "sun": ("Sun: a density without the sine of the angle, 16 degrees from the zenith",
            "The naive method draws the sun as often as it should, and takes the density over the image for one over "
            "the sphere: a high sun sends more than twice its light. Ours divides by the texel's solid angle."),
}
CURVES = {
    "spheres": ("Far, grazing and huge spheres", "What to see: naive curves climb by the square of the distance."),
    "leaving": ("Rays that start on a surface", "What to see: any least distance is too small here and too large there."),
    "boxes": ("Boxes and motion", "What to see: naive tests are wrong from the first value on."),
    "scattering": ("Directions and glass", "What to see: not-a-numbers where arithmetic meets its edge."),
    "paths": ("Long paths and sums", "What to see: sums in float stop growing, and depend on their order."),
    "others": ("Seeds, checkers, sizes, flat shapes", "What to see: ours holds far out, and where it ends."),
    "lights": ("Lights and the shadow rays toward them",
               "What to see: a shadow ray that stops at a part of the way lets light through, one that does not meets the "
               "lamp; and 1 - cos has nothing left of a light that is far."),
    "skies": ("Images around the scene", "What to see: one running sum knows no small texels beside a sun, a density without "
              "the sine is wrong at every height, and the arc cosine cannot tell rows at the poles."),
}
HOW = (" Dashed: naive; solid: ours; dotted: others. The grey line is the tolerance, the shaded part lies beyond what is "
       "asked of ours. An error of 0 lies on the lower edge.")


def figure_text(x):
    return "0" if x == 0 else f"{x:.2g}"


class Method:
    """Where a method breaks in its case, first and worst."""

    def __init__(self, rows):
        self.case, self.name, self.kind = (rows[0][column] for column in ("id", "method", "method_kind"))
        self.title = f"{self.case} ({self.name})"
        broken = [row for row in rows if row["error"] > row["tolerance"]]
        self.is_broken = bool(broken)
        self.is_within_asked = self.is_broken and broken[0]["is_asked"] == 1
        worst = figure_text(max(row["error"] for row in rows))
        self.text = f"holds; worst {worst}"
        if broken:
            self.text = f"breaks at {broken[0]['value']:g} with {figure_text(broken[0]['error'])}; worst {worst}"


def methods_of(curves):
    return [Method(where(curves, id=case, method=method)) for case, method in distinct(curves, "id", "method")]


def verdict_table(curves, methods, facts):
    table = Table("Where each method breaks",
                  ["row", "case", "parameter", "measure", "tolerance", "method", "verdict", "in an image"])
    shown = set()
    for method in methods:
        first, fact = where(curves, id=method.case)[0], facts["cases"][method.case]
        about = [first["row"], method.case, first["parameter"], first["measure"], figure_text(first["tolerance"])]
        verdict = method.text
        if method.kind == "ours" and method.is_broken and not method.is_within_asked and fact["limit"]:
            verdict += f" ({fact['limit']})"
        table.rows.append([*(about if method.case not in shown else [""] * len(about)),
                           f"**{method.name}**" if method.kind == "ours" else method.name, verdict,
                           fact["symptom"] if method.kind == "naive" and method.is_broken else ""])
        shown.add(method.case)
    return table


def cost_table(costs):
    table = Table("What robustness costs, nanoseconds a call (median, lowest and highest run)",
                  ["row", "case", "method", "ns"])
    for row, case, method in distinct(costs, "row", "id", "method"):
        table.rows.append([row, case, method, text(spread(numbers(where(costs, id=case, method=method), "ns")))])
    return table


def method_findings(methods):
    """All naive methods break, and ours hold where they are said to."""
    ours, naive = ([method for method in methods if method.kind == kind] for kind in ("ours", "naive"))
    held_not = ", ".join(method.title for method in ours if method.is_within_asked)
    broken_not = ", ".join(method.title for method in naive if not method.is_broken)
    cases = {method.case for method in methods}
    yield Finding("ours hold the tolerance wherever the case asks it", f"{len(ours)} methods in {len(cases)} cases",
                  judged(not held_not), held_not)
    yield Finding("every naive method breaks within its case", f"{len(naive)} methods", judged(not broken_not), broken_not)


def image_finding(rows, name):
    naive, ours = (where(rows, id=name, method_kind=kind)[0]["error"] for kind in ("naive", "ours"))
    return Finding(f"{name}: the naive method changes more of the image than single precision does",
                   f"pixels that differ from double by more than 0.02: naive {100 * naive:.1f} %, ours {100 * ours:.1f} %",
                   judged(naive > ours))


def summarise(run, rows):
    curves, costs, ruined = (where(rows, kind=kind) for kind in ("curve", "cost", "image"))
    methods = methods_of(curves)
    summary = Summary(tables=[verdict_table(curves, methods, run["facts"]), cost_table(costs)])
    summary.findings = [*method_findings(methods), *(image_finding(ruined, name) for name in distinct(ruined, "id"))]
    summary.pictures = [Picture(name, *FAILURES[name]) for name in distinct(ruined, "id")]
    summary.pictures += [Picture(name, title, what + HOW) for name, (title, what) in CURVES.items()
                         if any(belongs(row, ROWS[name]) for row in curves)]
    summary.notes = [
        "Errors come from fixed seeds and are the same in every run on one machine. Costs are timed in a register of "
        "rays (spheres, checkers), one by one (boxes, glass), or a term or number at a time, all in the first-level "
        "cache.",
        "The images of failure are made by the engines' kernels in a plain loop, with one naive method in the place of "
        "ours (bench/stability/naive_tracer.cpp); the same samples everywhere, so differences are not noise."]
    return summary


PICTURES = {**{name: curves(name) for name in ROWS},
            **{name: images(name) for name in FAILURES}}
