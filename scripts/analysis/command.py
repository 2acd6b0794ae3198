"""The commands of the analysis. `raypool study` calls the first two."""
import argparse
import importlib

from . import data, drawing, page, reproduction, trace


def study(folder):
    """Findings into run.json, the page and the pictures, from run.json and data.csv."""
    run, rows = data.read(folder)
    module = importlib.import_module("." + run["study"].replace("-", "_"), __package__)
    run.update(module.summarise(run, rows).as_json())
    for picture in run["pictures"]:
        drawing.save(module.PICTURES[picture["name"]]({**run, "folder": folder}, rows), folder, run, picture)
    data.write_text(f"{folder}/summary.md", page.summary_page(run))
    data.write_json(f"{folder}/run.json", run)


def main():
    parser = argparse.ArgumentParser(prog="analysis", description=__doc__)
    commands = parser.add_subparsers(required=True, dest="command")
    of_study = commands.add_parser("study", help="summarise and draw the run in FOLDER")
    of_study.add_argument("folder")
    of_paper = commands.add_parser("reproduce", help="pages over the summarised runs of studies, folders in FOLDER")
    of_paper.add_argument("folder")
    of_paper.add_argument("studies", nargs="+", help="which repeat the paper")
    of_paper.add_argument("--beyond", nargs="+", required=True, help="which ask what the paper did not")
    of_trace = commands.add_parser("trace", help="draw what `raypool render --trace` wrote, a lane for each thread")
    of_trace.add_argument("trace")
    of_trace.add_argument("picture")
    asked = parser.parse_args()
    if asked.command == "study":
        study(asked.folder)
    elif asked.command == "reproduce":
        reproduction.write(asked.folder, asked.studies, asked.beyond)
    else:
        trace.draw(asked.trace, asked.picture)
