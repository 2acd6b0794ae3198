"""index.html: a study as one page to look into, from the JSON of its run and its rows. It needs nothing beside it.

The forms are in pages/. Jinja escapes all that comes from data; what it is told not to escape is made here and in points.py.
"""
import base64
import hashlib
import importlib
import math
import re
from pathlib import Path
from types import SimpleNamespace

import jinja2
from markupsafe import Markup

from . import data, page, points

PAGES = Path(__file__).resolve().parent / "pages"
MOST_ROWS = 2000
UNITS = {"KiB": 2**10, "MiB": 2**20, "GiB": 2**30, "K": 2**10, "M": 2**20}
NUMBER = re.compile(r"[<>~]? ?([-+]?(?:\d+\.?\d*|\.\d+)(?:e[-+]?\d+)?)(?![\d.])(?: ?(KiB|MiB|GiB|K\b|M\b))?", re.IGNORECASE)


def number_of(text):
    """What a cell is sorted by: '0.12 (0.10 to 0.14)' by 0.12, '1.5 MiB' by bytes; None where it begins with no number."""
    found = NUMBER.match(text)
    return float(found[1]) * UNITS.get(found[2], 1) if found else None


def cell(text, link="", verdict="", number=None):
    return SimpleNamespace(text=text, link=link, verdict=verdict, number=number)


def sheet(title, header, rows):
    """A table of texts, or of cells; a column is sorted as numbers where most of its cells begin with one."""
    rows = [[value if isinstance(value, SimpleNamespace) else cell(value) for value in row] for row in rows]
    for column in zip(*rows):
        numbers = [number_of(value.text) for value in column]
        filled = sum(value.text != "" for value in column)
        if 2 * sum(number is not None for number in numbers) > filled:
            for value, number in zip(column, numbers):
                value.number = number if value.number is None else value.number
    return SimpleNamespace(title=title, header=[SimpleNamespace(name=name, what="") for name in header], rows=rows)


def findings_sheet(run):
    """Without the columns that no finding fills."""
    header = ["verdict", "claim", "ours", "its figures", "paper"]
    rows = [[cell(f["why"], verdict=f["verdict"]), f["claim"], f["ours"], f["paper"], f["source"]] for f in run["findings"]]
    used = [i for i in range(len(header)) if i < 3 or any(row[i] for row in rows)]
    return sheet("Findings", [header[i] for i in used], [[row[i] for i in used] for row in rows])


def drawn(folder, run, rows):
    """The pictures as SVG, or as they were drawn once where the rows are older than what draws them."""
    for picture in run["pictures"]:
        found = {**picture, "svg": "", "png": ""}
        try:
            module = importlib.import_module("." + run["study"].replace("-", "_"), __package__)
            figure = module.PICTURES[picture["name"]]({**run, "folder": folder}, rows)
            found["svg"] = Markup(points.inline_svg(figure, picture["name"], picture["title"]))
        except Exception:  # whatever rows of an older study lack; those of today are drawn, or the study itself fails
            points.plt.close("all")
            png = Path(folder) / Path(picture["name"] + ".png").name
            if png.is_file():
                found["png"] = "data:image/png;base64," + base64.b64encode(png.read_bytes()).decode()
        yield SimpleNamespace(**found)


def shortened(value):
    """Numbers with 6 digits; JSON has none that are not finite."""
    if isinstance(value, float):
        return float(f"{value:.6g}") if math.isfinite(value) else str(value)
    return value


def rows_sheet(run, rows):
    """The columns that tell rows apart, for the script to show; what is the same in all is said once."""
    what = {column["name"]: column.get("what", "") for column in run["columns"]}
    names = list(rows[0]) if rows else []
    of_one_value = [name for name in names if len(rows) > 1 and name != "case" and all(r[name] == rows[0][name] for r in rows)]
    varied = [name for name in names if name not in of_one_value]
    return SimpleNamespace(
        header=[SimpleNamespace(name=name, what=what.get(name, "")) for name in varied],
        cells=[[shortened(row[name]) for name in varied] for row in rows[:MOST_ROWS]],
        left_out=max(0, len(rows) - MOST_ROWS),
        constant=", ".join(f"{name} {shortened(rows[0][name])}" for name in of_one_value if rows[0][name] is not None))


def flattened(name, value):
    """(name, text) of all that a part of run.json holds."""
    if isinstance(value, dict):
        return [entry for key, inner in value.items() for entry in flattened(f"{name} {key}".strip(), inner)]
    if isinstance(value, list):
        return [(name, ", ".join(map(str, value)))]
    return [(name, str(value).strip())]


def provenance(run):
    entries = [*flattened("", run["environment"]), *flattened("started", run.get("started", [])), ("finished", run["finished"]),
               ("taken by others", f"{100 * run['stolen']:.1f} % of the processor time"),
               *flattened("", run["options"]), *flattened("fact", {name: fact for name, fact in run.get("facts", {}).items() if name != "rungs"})]
    return [(name, text) for name, text in entries if text]


def filled(form, **values):
    """A page of a form in pages/. Its only script is the one whose hash the page names: data cannot bring another."""
    forms = jinja2.Environment(loader=jinja2.FileSystemLoader(PAGES), autoescape=True, trim_blocks=True, lstrip_blocks=True,
                               undefined=jinja2.StrictUndefined)
    forms.policies["json.dumps_kwargs"] = {"separators": (",", ":"), "ensure_ascii": False}
    script = (PAGES / "page.js").read_text(encoding="utf-8")
    digest = base64.b64encode(hashlib.sha256(("\n" + script).encode()).digest()).decode()
    return forms.get_template(form).render(style=Markup((PAGES / "page.css").read_text(encoding="utf-8")),
                                           script=Markup(script), script_hash=f"sha256-{digest}", **values)


def study_page(folder, run, rows, home=""):
    return filled("study.html", run=run, machine=page.machine_line(run["environment"]), command=page.command_line(run),
                  findings=findings_sheet(run), pictures=list(drawn(folder, run, rows)),
                  tables=[sheet(table["title"], table["header"], table["rows"]) for table in run["tables"]],
                  rows=rows_sheet(run, rows), provenance=provenance(run), home=home)


def write(folder):
    """index.html of a summarised run."""
    run, rows = data.read(folder)
    data.write_text(Path(folder) / "index.html", study_page(folder, run, rows))
