"""The few statistics that every table uses. Medians, since a shared machine makes outliers, never means."""
import math
from statistics import median
from typing import NamedTuple


class Spread(NamedTuple):
    median: float
    low: float
    high: float
    runs: int = 1


def spread(values):
    """Of at least one value."""
    return Spread(median(values), min(values), max(values), len(values))


def text(s, digits=2):
    """'1.52 (1.40 to 1.61)'"""
    return f"{s.median:.{digits}f} ({s.low:.{digits}f} to {s.high:.{digits}f})"


def shortest(number):
    """As few digits as give the same number: '64', '0.1', '1e+16'."""
    return repr(float(number)).removesuffix(".0")


def threads_text(threads):
    return f"{threads} thread{'' if threads == 1 else 's'}"


def ratios(a, b):
    """Element by element: of measurements that were taken side by side."""
    return [x / y for x, y in zip(a, b)]


def max_over_mean(load):
    """1 is perfect balance, the number of threads is one thread doing it all."""
    return 1 if sum(load) == 0 else max(load) * len(load) / sum(load)


def coefficient_of_variation(load):
    """Standard deviation over mean."""
    mean = sum(load) / len(load)
    return 0 if mean == 0 else math.sqrt(sum((value - mean) ** 2 for value in load) / len(load)) / mean
