"""A render on up to 10,000 ranks, simulated from recorded costs: where efficiency falls, and why."""
from .data import distinct, numbers, where
from .drawing import COLOURS, plt
from .spreads import shortest
from .summary import Finding, Picture, Summary, Table
from .verdict import judged

GOOD_EFFICIENCY = 0.9


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


def falls(rows):
    table = Table("How far each render scales", ["samples a pixel", "most ranks at 0.9", "work of each there"])
    for spp in distinct(rows, "spp"):
        last_good = None
        for row in where(rows, spp=spp):
            if row["efficiency"] < GOOD_EFFICIENCY:
                break
            last_good = row
        if last_good:
            table.rows.append([str(spp), shortest(last_good["ranks"]), f"{last_good['ideal_s']:.3g} s"])
    return table


def losses(rows):
    most = max(numbers(rows, "ranks"))
    table = Table(f"What a render on {most} ranks spends, in milliseconds",
                  ["samples a pixel", "equal share", "last units", "questions", "reduction", "efficiency",
                   "with one slow rank"])
    for row in where(rows, ranks=most):
        spent = (row[part] for part in ("ideal_s", "last_units_s", "questions_s", "reduction_s"))
        table.rows.append([str(row["spp"]), *(f"{1e3 * seconds:.1f}" for seconds in spent),
                           f"{row['efficiency']:.3f}", f"{row['slow_efficiency']:.3f}"])
    return table


def scaling_finding(rows):
    large = [row["efficiency"] for row in rows if row["ideal_s"] >= 2]
    worst = min([1, *large])
    finding = Finding("where every rank has two seconds of work or more, 0.9 of its time is work", f"{worst:.3f} at least")
    if large:
        finding.verdict = judged(worst >= GOOD_EFFICIENCY)
    else:
        finding.why = "no render was large enough"
    return finding


def supposed(facts):
    return (f"Supposed: {facts['bytes_per_second'] * 1e-9:.0f} GB/s and {facts['latency_s'] * 1e6:.0f} us a message, "
            f"{facts['look_s'] * 1e6:.0f} us until a question is seen, {facts['serve_s'] * 1e6:.0f} us to answer it, a "
            f"reduction of {shortest(facts['pixel_bytes'])} bytes a pixel over a binary tree, one step after the other. "
            "Left out: reading the scene, starting the ranks, what a rank sets up once for all its units, and everything "
            "that makes equal processors unequal.")


def summarise(run, rows):
    return Summary(findings=[scaling_finding(rows)], tables=[falls(rows), losses(rows)], notes=[supposed(run["facts"])],
                   pictures=[Picture(
                       "ranks", "Efficiency against ranks",
                       "Each line is a render of so many samples a pixel, simulated: costs of paths are recorded, the "
                       "network is supposed. What to see: a line falls where an equal share of the work comes near what is "
                       "lost, which is the others' last units and the reduction for few ranks, and, for thousands, rank 0's "
                       "answers, one at a time.")])


PICTURES = {"ranks": ranks}
