"""A study of two lines and some rows, as `raypool study` leaves one, for the tests of pages. Its names are hostile."""
import json
import sys
import types

from analysis.drawing import line, plt
from analysis.spreads import spread
from analysis.summary import Finding, Picture, Summary, Table
from analysis.verdict import Verdict

HOSTILE = "</script><img src=x onerror=\"document.title='broken'\">'&amp;"
XS = [1, 2, 4]


def picture(run, rows):
    figure, axis = plt.subplots(figsize=(6, 4))
    for index, name in enumerate(("pool", HOSTILE)):
        line(axis, XS, [spread([x + index, x + index + 0.5, x + index + 1]) for x in XS], index=index, label=name)
    axis.set_xlabel("threads")
    axis.set_ylabel("times as fast")
    axis.legend()
    return figure


def install():
    """As the module of the study `fake`."""
    module = types.ModuleType("analysis.fake")
    module.PICTURES = {"speed": picture}
    sys.modules["analysis.fake"] = module


def row(case, repeat, seconds, hash_="aa", thread=0):
    return {"case": case, "repeat": repeat, "thread": thread, "way": HOSTILE, "seconds": seconds, "mpaths_per_s": 1 / seconds,
            "hash": hash_}


def rows(factor=1.0, count=150):
    """Five of each case; one case in four is on the right."""
    return [row(f"case {i}, {'left' if i % 4 else 'right'}", repeat, factor * (i + 1) * (1 + 0.01 * repeat))
            for repeat in range(5) for i in range(count // 5)]


def run(commit="aaaa", finished="2026-01-01T00:00:00Z"):
    said = Summary([Finding("a pool is faster", "2 (1 to 3)", Verdict.HOLDS), Finding(HOSTILE, "no", Verdict.DOES_NOT_HOLD)],
                   [Picture("speed", "How fast", "What to see.")],
                   [Table("Sizes", ["way", "size"],
                          [["b", "10.5 (10 to 11)"], ["a", "9 KiB"], ["c", ""], [HOSTILE, "9.25 (9 to 10)"]])],
                   [HOSTILE])
    return {
        "study": "fake", "question": "Does it work?", "started": [finished], "finished": finished, "stolen": 0.0123,
        "columns": [{"name": "seconds", "what": "of the wall clock"}], "facts": {}, "plan": [],
        "environment": {"cpu": "a processor", "cores": 2, "compiler": "gcc 12", "commit": commit, "flags": "-O3",
                        "openmp": {"OMP_WAIT_POLICY": "passive"}},
        "options": {"quick": False, "scene": HOSTILE, "width": 0, "spp": 0, "depth": 0, "threads": 0, "repeats": 0, "seed": 0},
        **said.as_json()}


def write(folder, run_, rows_):
    folder.mkdir(parents=True)
    (folder / "run.json").write_text(json.dumps(run_))
    cells = [list(rows_[0]), *(list(map(str, r.values())) for r in rows_)]
    (folder / "data.csv").write_text("".join(",".join('"' + c.replace('"', '""') + '"' for c in line_) + "\n" for line_ in cells))
