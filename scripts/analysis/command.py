"""The commands of the analysis. `raypool study` calls study and reproduce, `raypool report` report."""
import argparse
import importlib
import sys

from . import data, drawing, page, reproduction, trace

FAILED, BAD_INPUT = 1, 2


def has_jinja():
    """Says so where it is missing: all but the pages can be had without."""
    try:
        importlib.import_module("jinja2")
        return True
    except ModuleNotFoundError:
        print("raypool: no index.html, which needs the package python3-jinja2", file=sys.stderr)
        return False


def study(folder):
    """Findings into run.json, the pages and the pictures, from run.json and data.csv."""
    run, rows = data.read(folder)
    module = importlib.import_module("." + run["study"].replace("-", "_"), __package__)
    run.update(module.summarise(run, rows).as_json())
    for picture in run["pictures"]:
        drawing.save(module.PICTURES[picture["name"]]({**run, "folder": folder}, rows), folder, run, picture)
    data.write_text(f"{folder}/summary.md", page.summary_page(run))
    data.write_json(f"{folder}/run.json", run)
    if has_jinja():
        from . import report
        report.write(folder)


def reproduce(folder, studies, beyond):
    reproduction.write(folder, studies, beyond)
    if has_jinja():
        from . import joined
        joined.write([f"{folder}/{name}" for name in [*studies, *beyond]], f"{folder}/site")


def report_of(folders, site):
    """The exit status; what is wrong with a folder is said in one line."""
    from . import joined
    try:
        joined.write(folders, site)
    except joined.NoStudy as error:
        print(f"raypool: {error}", file=sys.stderr)
        return BAD_INPUT
    except OSError as error:
        print(f"raypool: {page.shell_word(str(error.filename))}: {error.strerror}", file=sys.stderr)
        return FAILED
    return 0


def main():
    parser = argparse.ArgumentParser(prog="analysis", description=__doc__)
    commands = parser.add_subparsers(required=True, dest="command")
    of_study = commands.add_parser("study", help="summarise and draw the run in FOLDER")
    of_study.add_argument("folder")
    of_page = commands.add_parser("page", help="index.html alone, of the summarised runs in FOLDERs")
    of_page.add_argument("folders", nargs="+")
    of_paper = commands.add_parser("reproduce", help="pages over the summarised runs of studies, folders in FOLDER")
    of_paper.add_argument("folder")
    of_paper.add_argument("studies", nargs="+", help="which repeat the paper")
    of_paper.add_argument("--beyond", nargs="+", required=True, help="which ask what the paper did not")
    of_runs = commands.add_parser("report", help="pages that join the summarised runs in FOLDERs")
    of_runs.add_argument("site")
    of_runs.add_argument("folders", nargs="+")
    of_trace = commands.add_parser("trace", help="draw what `raypool render --trace` wrote, a lane for each thread")
    of_trace.add_argument("trace")
    of_trace.add_argument("picture")
    asked = parser.parse_args()
    if asked.command == "study":
        study(asked.folder)
    elif asked.command == "page":
        from . import report
        for folder in asked.folders:
            report.write(folder)
    elif asked.command == "reproduce":
        reproduce(asked.folder, asked.studies, asked.beyond)
    elif asked.command == "report":
        sys.exit(report_of(asked.folders, asked.site))
    else:
        trace.draw(asked.trace, asked.picture)
