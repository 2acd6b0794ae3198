"""Adaptive sampling against uniform: efficiency by seed, and load of threads."""
import statistics

from common import COLOURS, MARKERS, distinct, plt, where


def adaptive(run, rows):
    figure, (left, right) = plt.subplots(1, 2, figsize=(11.5, 4.2), gridspec_kw={"width_ratios": [1, 1.25]})
    runs = where(rows, kind="run")
    places = []
    for place, (scene, target) in enumerate(distinct(runs, "scene", "target")):
        own = where(runs, scene=scene, target=target)
        ratios = []
        for seed in distinct(own, "seed"):
            a, u = where(own, seed=seed, method="adaptive")[0], where(own, seed=seed, method="uniform")[0]
            if a["mse"] > 0 and u["mse"] > 0:
                ratios.append(u["mse"] * u["seconds"] / (a["mse"] * a["seconds"]))
        left.plot(ratios, [place] * len(ratios), "o", color=COLOURS[0], markerfacecolor="none", markersize=5)
        if ratios:
            left.plot([statistics.median(ratios)], [place], "|", color="black", markersize=18, markeredgewidth=2)
        places.append(f"{scene}, {target:g}")
    left.axvline(1, color="black", linewidth=0.9)
    left.set_yticks(range(len(places)), places)
    left.invert_yaxis()
    left.set_xlabel("efficiency of adaptive / uniform")
    left.set_title("Scene and RMSE asked for")

    loads = where(rows, kind="load")
    scenes = distinct(loads, "scene")
    for i, sharing in enumerate(distinct(loads, "sharing")):
        for method, fill in (("uniform", "none"), ("adaptive", COLOURS[i])):
            values = [where(loads, scene=scene, sharing=sharing, method=method)[0]["load"] for scene in scenes]
            right.plot([x + 0.12 * (i - 1.5) for x in range(len(scenes))], values, MARKERS[i], color=COLOURS[i],
                       markerfacecolor=fill, markersize=8, label=sharing if method == "adaptive" else None)
    right.axhline(1, color="black", linewidth=0.9)
    right.set_xticks(range(len(scenes)), scenes)
    right.set_ylabel("load: busiest threads / fair share")
    right.set_title("Hollow: uniform. Filled: adaptive")
    right.legend(fontsize=8)
    return figure


PICTURES = {"adaptive": adaptive}
