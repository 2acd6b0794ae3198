"""`raypool report`: pages that join runs of studies: a list of all, a page for each, and two runs of one study side by side."""
import itertools
import os
import re
import sys
import textwrap
from dataclasses import dataclass
from pathlib import Path

from markupsafe import Markup

from . import data, page, report
from .comparison import compare
from .drawing import COLOURS, MARKERS, plt, remember
from .points import inline_svg
from .report import cell, sheet
from .spreads import text
from .verdict import LEAST_RUNS, Verdict

MOST_CHANGES = 1000
MOST_DRAWN = 30


class NoStudy(Exception):
    """In one line, for the user."""


@dataclass
class Run:
    folder: Path
    run: dict
    rows: list
    name: str = ""  # of its page, without the ending

    @property
    def machine(self):
        environment = self.run["environment"]
        return f"{environment['cpu']}, {environment['cores']} cores"

    @property
    def commit(self):
        return self.run["environment"]["commit"]

    @property
    def label(self):
        """With the minute and the folder: two runs may be of one machine, commit and day."""
        return f"{self.place}: {self.machine}, {self.commit}, {self.run['finished'][:16].replace('T', ' ')} UTC"

    @property
    def place(self):
        """The folder's name as text, whatever its bytes."""
        return os.fsencode(self.folder).decode(errors="replace")


def shown(path):
    return page.shell_word(str(path))


def read_run(folder):
    """None where a study has not ended."""
    try:
        run, rows = data.read(folder)
        return Run(folder, run, rows) if run["environment"] and run["study"] and "findings" in run else None
    except (OSError, ValueError, KeyError, TypeError, StopIteration) as error:
        raise NoStudy(f"{shown(folder)}: not the folder of a study ({type(error).__name__}: "
                      f"{' '.join(str(error).split())})") from None


def runs_in(folders):
    """Of folders of studies, and of folders that hold such; each once, by study and then by date."""
    found = {}
    for folder in map(Path, folders):
        inside = sorted(path.parent for path in folder.rglob("run.json"))
        if not inside:
            raise NoStudy(f"{shown(folder)}: no study in it (a run.json beside a data.csv)")
        for study in inside:
            found.setdefault(study.resolve(), study)
    runs = [(folder, read_run(folder)) for folder in found.values()]
    for folder, run in runs:
        if not run:
            print(f"raypool: {shown(folder)}: left out, since the study has not ended", file=sys.stderr)
    done = [run for _, run in runs if run]
    if not done:
        raise NoStudy("no study has ended")
    return sorted(done, key=lambda run: (run.run["study"], run.run["finished"], str(run.folder)))


def name_pages(runs):
    """By study and commit, with a number where that is not enough."""
    taken = {"index"}
    for run in runs:
        base = re.sub(r"[^A-Za-z0-9.-]+", "-", f"{run.run['study']}-{run.run['finished'][:10]}-{run.commit}").strip("-.")
        names = itertools.chain([base], (f"{base}-{i}" for i in itertools.count(2)))
        run.name = next(name for name in names if name not in taken)
        taken.add(run.name)


def pairs(runs):
    """The older run first."""
    return [pair for pair in itertools.combinations(runs, 2) if pair[0].run["study"] == pair[1].run["study"]]


def pair_name(old, new):
    return f"{old.name}-to-{new.name}"


def verdict_counts(run):
    told = [finding["verdict"] for finding in run.run["findings"]]
    return [str(told.count(verdict)) for verdict in Verdict]


def runs_sheet(runs):
    header = ["study", "folder", "machine", "commit", "finished", *map(str, Verdict), "rows"]
    return sheet("Runs", header, [
        [cell(run.run["study"], link=f"{run.name}.html"), cell(run.place), run.machine, cell(run.commit),
         run.run["finished"], *verdict_counts(run), str(len(run.rows))] for run in runs])


def pairs_sheet(compared):
    header = ["study", "older", "newer", "measured", "faster", "slower", "hashes agree", "hashes differ"]
    rows = []
    for old, new, found in compared:
        faster = sum(change.is_better for change in found.beyond)
        rows.append([cell(old.run["study"], link=f"{pair_name(old, new)}.html"), old.label, new.label, str(len(found.changes)),
                     str(faster), str(len(found.beyond) - faster), str(found.same_hashes), str(len(found.other_hashes))])
    return sheet("Side by side", header, rows)


def changes_sheet(changes):
    header = ["case", "measured", "older", "newer", "newer / older", "change"]
    rows = [[change.case, change.column, figures(change.old), figures(change.new),
             cell(text(change.ratio, 3), number=change.ratio.median),
             cell("", verdict=change.verdict) if change.is_beyond_noise else change.verdict]
            for change in changes[:MOST_CHANGES]]
    return sheet("Changes", header, rows)


def picture(changes):
    """The largest changes beyond the noise, one for each case; nothing where there is none."""
    first = {}
    for change in changes:
        if change.is_beyond_noise:
            first.setdefault(change.case, change)
    largest = list(first.values())[:MOST_DRAWN]
    if not largest:
        return ""
    figure, axis = plt.subplots(figsize=(11, 1.2 + 0.3 * len(largest)))
    for index, (is_better, name) in enumerate(((True, "faster"), (False, "slower"))):
        of_kind = [(place, change.speed) for place, change in enumerate(largest) if change.is_better == is_better]
        if of_kind:
            places, speeds = zip(*of_kind)
            drawn = axis.errorbar([s.median for s in speeds], places, fmt=MARKERS[index], color=COLOURS[2 + index], label=name,
                                  xerr=[[s.median - s.low for s in speeds], [s.high - s.median for s in speeds]], capsize=3)
            remember(drawn[0], speeds, "x", name)
    axis.axvline(1, color="black", linewidth=1)
    axis.set_xscale("log", base=2)
    axis.xaxis.set_major_formatter(plt.FuncFormatter(lambda value, _: f"{value:.4g}"))
    axis.set_yticks(range(len(largest)), [textwrap.shorten(change.case, 70).replace("$", r"\$") for change in largest])
    axis.invert_yaxis()
    axis.grid(axis="y", visible=False)
    axis.set_xlabel("times as fast as the older run")
    axis.legend(loc="upper left", bbox_to_anchor=(1, 1))
    return Markup(inline_svg(figure, "changes", "The largest changes"))


def figures(s):
    return f"{s.median:.4g} ({s.low:.4g} to {s.high:.4g}), n\u00a0{s.runs}"


def by_claim(run):
    """What was found of each claim; a claim may be there for one thread and again for two."""
    found = {}
    for finding in run.run["findings"]:
        found.setdefault(finding["claim"], []).append(finding)
    return {(claim, i): finding for claim, of_claim in found.items() for i, finding in enumerate(of_claim)}


def findings_sheet(old, new):
    before, after = by_claim(old), by_claim(new)
    rows = []
    for key in dict.fromkeys([*before, *after]):
        told = [side.get(key, {"verdict": "", "ours": ""}) for side in (before, after)]
        rows.append([key[0], *(cell(of["ours"], verdict=of["verdict"]) for of in told),
                     "differs" if told[0]["verdict"] != told[1]["verdict"] else "same"])
    return sheet("Findings", ["claim", "older", "newer", "verdict"], rows)


def origins_sheet(old, new):
    sides = [dict(report.provenance(side.run)) for side in (old, new)]
    rows = [[name, *(side.get(name, "") for side in sides), "same" if sides[0].get(name) == sides[1].get(name) else "differs"]
            for name in dict.fromkeys([*sides[0], *sides[1]])]
    return sheet("Provenance", ["what", "older", "newer", "same"], rows)


def other_options(old, new):
    """The options that make other renders."""
    options = [dict(report.flattened("", side.run["options"])) for side in (old, new)]
    return [name for name in dict.fromkeys([*options[0], *options[1]]) if options[0].get(name) != options[1].get(name)]


def comparison_page(old, new, found):
    beyond = found.beyond
    better = sum(change.is_better for change in beyond)
    return report.filled(
        "comparison.html", home="index.html", old=old, new=new, found=found, better=better, worse=len(beyond) - better,
        least_runs=LEAST_RUNS, open_count=sum(not change.can_be_told for change in found.changes),
        other_options=other_options(old, new), changes=changes_sheet(found.changes), picture=picture(found.changes),
        left_out=max(0, len(found.changes) - MOST_CHANGES), findings=findings_sheet(old, new),
        provenance=origins_sheet(old, new),
        commands=list(dict.fromkeys(page.command_line(side.run) for side in (old, new))))


def write(folders, site):
    """The pages, in the folder `site`."""
    site = Path(site)
    if (site / "run.json").exists():
        raise NoStudy(f"{shown(site)}: the folder of a study, which has an index.html of its own; name another with -o")
    runs = runs_in(folders)
    name_pages(runs)
    compared = [(old, new, compare(old.rows, new.rows)) for old, new in pairs(runs)]
    site.mkdir(parents=True, exist_ok=True)
    for run in runs:
        data.write_text(site / f"{run.name}.html", report.study_page(run.folder, run.run, run.rows, home="index.html"))
    for old, new, found in compared:
        data.write_text(site / f"{pair_name(old, new)}.html", comparison_page(old, new, found))
    data.write_text(site / "index.html", report.filled(
        "index.html", runs=runs_sheet(runs), pairs=pairs_sheet(compared) if compared else None))
