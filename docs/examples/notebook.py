"""raypool in a notebook: editors that know cells (# %%) run it cell by cell, Python as a whole.

Pictures go to files in the working folder; a notebook shows them, too. What it takes beside raypool: matplotlib, pandas.
"""

# %% Which thread did how much? Recursion, with an equal number of lines for each.
import matplotlib.pyplot as plt
import raypool

image, report = raypool.render("paper", engine="recursive", schedule="static", grain="line", threads=8, width=200, spp=4)
segments = [thread["segments"] / 1e3 for thread in report["threads"]]
figure, axes = plt.subplots(figsize=(5, 3), layout="constrained")
axes.bar(range(len(segments)), segments)
axes.axhline(sum(segments) / len(segments), color="black", linewidth=1)
axes.set(xlabel="thread", ylabel="thousand segments", title="lines in equal shares: max / mean "
         f"{max(segments) * len(segments) / sum(segments):.2f}")
figure.savefig("load.png")

# %% A sweep: samples by sampler by engine, a row each. The image's hash depends on the first two alone.
import itertools

import pandas as pd

scene = raypool.load("cornell")
rows = []
for spp, sampler, engine in itertools.product((4, 16, 64), ("independent", "sobol"), ("recursive", "wavefront")):
    _, report = raypool.render(scene, spp=spp, sampler=sampler, engine=engine, width=64)
    rows.append({"spp": spp, "sampler": sampler, "engine": engine, "hash": report["hash"],
                 "mpaths_per_s": report["mpaths_per_s"], "seconds": report["seconds"]["render"]})
sweep = pd.DataFrame(rows)
assert (sweep.groupby(["spp", "sampler"])["hash"].nunique() == 1).all()
print(sweep.pivot_table(index=["sampler", "spp"], columns="engine", values="mpaths_per_s").round(2))
axes = sweep.groupby(["spp", "engine"])["mpaths_per_s"].mean().unstack().plot(marker="o", logx=True, figsize=(5, 3))
axes.set(xlabel="samples per pixel", ylabel="million paths a second")
axes.figure.savefig("sweep.png", bbox_inches="tight")

# %% The image. It is linear, so that a mean of two is the image of all their samples; a screen wants sRGB.
import numpy as np


def srgb(linear):
    """Linear radiance as a screen shows it; what is brighter than 1 is white."""
    clipped = np.clip(linear, 0, 1)
    return np.where(clipped <= 0.0031308, 12.92 * clipped, 1.055 * clipped ** (1 / 2.4) - 0.055)


image, report = raypool.render("paper", width=320, spp=16,
                               progress=lambda done, total: print(f"\r{done / total:4.0%}", end="", flush=True))
print(f"\n{report['mpaths_per_s']:.2f} million paths a second, hash {report['hash']}")
figure, axes = plt.subplots(figsize=(6.4, 3.6), layout="constrained")
axes.imshow(srgb(image))
axes.set_axis_off()
figure.savefig("image.png")

# %% Engines side by side, in interleaved runs. It raises where an image is another.
engines = pd.DataFrame(raypool.compare(scene, ["recursive", "iterative", "wavefront"], repeats=3, width=64, spp=8))
print(engines[["name", "ratio_median", "segments", "hash"]].to_string(index=False))
