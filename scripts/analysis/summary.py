"""What a study says of its rows. Every study's summarise() returns a Summary; page.py makes a page of it."""
from dataclasses import asdict, dataclass, field

from .verdict import Verdict


@dataclass
class Finding:
    """What the paper, or the project, claims, and what was found."""
    claim: str
    ours: str = ""
    verdict: Verdict = Verdict.CANNOT_TELL
    why: str = ""  # always, where it cannot be told
    source: str = ""  # "Figure 5", "Table 1" of the paper; empty for a question of ours
    paper: str = ""  # its figures


@dataclass
class Picture:
    """Drawn by PICTURES[name] of the study's module, as <name>.svg and <name>.png."""
    name: str
    title: str
    caption: str  # what to see


@dataclass
class Table:
    title: str
    header: list
    rows: list = field(default_factory=list)


def rungs_table(run):
    """What the names of the ladder's pools mean, as a list to add to; an older run did not say so."""
    rungs = run.get("facts", {}).get("rungs", [])
    return [Table("The pools, and what each changes in the one before it", ["pool", "what is new"],
                  [[rung["name"], rung["step"]] for rung in rungs])] if rungs else []


@dataclass
class Summary:
    findings: list = field(default_factory=list)
    pictures: list = field(default_factory=list)
    tables: list = field(default_factory=list)
    notes: list = field(default_factory=list)

    def as_json(self):
        return asdict(self)
