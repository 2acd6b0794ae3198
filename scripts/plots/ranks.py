"""Efficiency of many ranks, simulated."""
from common import COLOURS, distinct, plt, where


def ranks(run, rows):
    figure, axis = plt.subplots(figsize=(8, 4.8))
    for i, spp in enumerate(distinct(rows, "spp")):
        line = where(rows, spp=spp)
        axis.plot([row["ranks"] for row in line], [row["efficiency"] for row in line], marker="osD^"[i % 4],
                  color=COLOURS[i], label=f"{spp:,.0f} samples a pixel")
    axis.set_xscale("log")
    axis.set_ylim(0, 1.05)
    axis.set_xlabel("ranks")
    axis.set_ylabel("efficiency")
    axis.legend(loc="lower left")
    return figure


PICTURES = {"ranks": ranks}
