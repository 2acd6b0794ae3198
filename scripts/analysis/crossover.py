"""Where a pool begins to beat recursion, from its ratio at each capacity that was measured."""
from typing import NamedTuple

from .spreads import Spread


class AtCapacity(NamedTuple):
    capacity: int
    ratio: Spread  # rate over that of recursion


class Crossover(NamedTuple):
    start: int | None  # the smallest capacity that beats recursion; None: none does
    lost_beyond: list  # larger ones that do not

    def __str__(self):
        """'never', '256', '256, but not 16384, 65536'"""
        if self.start is None:
            return "never"
        lost = ", ".join(map(str, self.lost_beyond))
        return f"{self.start}, but not {lost}" if lost else str(self.start)


def crossover(measured):
    """To beat recursion is to be faster than it in every run. Capacities must ascend."""
    wins = [at.capacity for at in measured if at.ratio.low > 1]
    if not wins:
        return Crossover(None, [])
    return Crossover(wins[0], [at.capacity for at in measured if at.capacity > wins[0] and at.capacity not in wins])


def best(measured):
    """The capacity with the highest median; of equal ones the first."""
    return max(measured, key=lambda at: at.ratio.median)
