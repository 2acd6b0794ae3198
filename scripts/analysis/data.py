"""A study's folder: run.json, and the rows of data.csv as dictionaries, to read and to select from."""
import csv
import json
from collections import defaultdict
from pathlib import Path

TEXT_COLUMNS = {"case", "hash"}  # whatever their cells look like


def _column(name, cells):
    """Numbers where all cells are, else texts; None for what does not exist."""
    for kind in (int, float) if name not in TEXT_COLUMNS else ():
        try:
            return [kind(cell) if cell else None for cell in cells]
        except ValueError:
            pass
    return [cell or None for cell in cells]


def read_rows(path):
    with open(path, newline="", encoding="utf-8", errors="replace") as file:
        lines = csv.reader(file)
        names = next(lines)
        columns = [_column(name, cells) for name, cells in zip(names, zip(*lines))]
    return [dict(zip(names, cells)) for cells in zip(*columns)]


def read(folder):
    """run.json and the rows of data.csv."""
    folder = Path(folder)
    return json.loads((folder / "run.json").read_text(encoding="utf-8")), read_rows(folder / "data.csv")


def write(path, fill):
    """A file that is there whole or not at all: fill(path) writes one beside it, which takes its place."""
    path = Path(path).resolve()
    beside = path.with_name(f".{path.name}.tmp")
    try:
        fill(beside)
        beside.replace(path)
    finally:
        beside.unlink(missing_ok=True)


def write_text(path, text):
    write(path, lambda beside: beside.write_text(text, encoding="utf-8"))


def write_json(path, value):
    write_text(path, json.dumps(value, indent=2, sort_keys=True, ensure_ascii=False) + "\n")


def where(rows, **wanted):
    return [row for row in rows if all(row[key] == value for key, value in wanted.items())]


def distinct(rows, *columns):
    """The different values (tuples, of more than one column), in the order of their first rows."""
    found = [tuple(row[c] for c in columns) for row in rows]
    return list(dict.fromkeys(f[0] if len(columns) == 1 else f for f in found))


def numbers(rows, column):
    """The values of a column, without those that do not exist."""
    return [row[column] for row in rows if row[column] is not None]


def grouped(rows, *columns):
    """Rows by the values of columns, in order."""
    groups = defaultdict(list)
    for row in rows:
        groups[tuple(row[c] for c in columns)].append(row)
    return groups
