"""`raypool study reproduce`: a page that holds the paper's figures against ours, and one of what the paper did not ask.

The paper: He, Song, Zong, "Parallel Ray Tracing with OpenMP". What the studies found (a finding's source names the table
or figure) is put side by side, in the paper's order.
"""
import json
from pathlib import Path

from . import data, page

ITEMS = [
    ("Table 1, Figure 7", "speedup of the basic version up to 64 threads"),
    ("Table 2, Figure 12", "efficiency of static,1 by image width"),
    ("Figure 5", "work of each thread by schedule"),
    ("Figure 8", "the operation pool against plain recursion"),
    ("Figure 9", "time of static,1 against the default schedule"),
    ("Figure 10", "time of single pixels against lines"),
    ("Figure 11", "interleaved framebuffer against three planes"),
    ("CPU against GPU", "time by image width"),
]


def item_rows(runs, source, what):
    rows = [[f"{source}: {what}", f["claim"], f["paper"], f["ours"], page.verdict_text(f),
             f"[{run['study']}]({run['study']}/summary.md)"]
            for run in runs for f in run["findings"] if f["source"] == source]
    if not rows:
        raise ValueError(f"{source}: no study has a finding for it")
    return rows


def reproduction_page(runs):
    text = ("# The paper's experiments, repeated\n\nHe, Song and Zong, \"Parallel Ray Tracing with OpenMP\": "
            "what the paper reports, what this machine shows, and whether the claim holds here.\n\n")
    text += page.markdown(["of the paper", "claim", "the paper's figures", "ours", "verdict", "from"],
                          [row for item in ITEMS for row in item_rows(runs, *item)]) + "\n"
    return text + pictures(runs) + page.machine_line(runs[0]["environment"]) + ".\n"


def beyond_page(runs):
    text = ("# Beyond the paper\n\nWhat the paper did not ask: scenes of any size, meshes of triangles, lights that are "
            "sampled, and a GPU beside a pool. What a pool gains there, over recursion and over a traversal that is not ours.\n\n")
    text += page.markdown(["claim", "ours", "verdict", "from"],
                          [[f["claim"], f["ours"], page.verdict_text(f), f"[{run['study']}]({run['study']}/summary.md)"]
                           for run in runs for f in run["findings"]]) + "\n"
    return text + pictures(runs) + page.machine_line(runs[0]["environment"]) + ".\n"


def pictures(runs):
    text = ""
    for run in runs:
        text += f"## {run['study']}\n\n{run['question']}\n\n"
        for picture in run["pictures"]:
            text += f"![{picture['title']}]({run['study']}/{picture['name']}.png)\n\n"
    return text


def write(folder, of_paper, beyond):
    """summary.md and beyond.md in `folder`, from the summarised runs of studies in its subfolders, in their order."""
    for name, studies, make_page in (("summary.md", of_paper, reproduction_page), ("beyond.md", beyond, beyond_page)):
        runs = [json.loads((Path(folder) / study / "run.json").read_text(encoding="utf-8")) for study in studies]
        data.write_text(Path(folder) / name, make_page(runs))
