"""Statistics of error against time: how efficient a configuration is, and whether another one is more so."""
import math
from enum import Enum
from functools import lru_cache
from typing import NamedTuple

import numpy

LEAST_SEEDS = 5  # fewer decide nothing
RESAMPLES = 2000


def mean(values):
    return sum(values) / len(values)


class Interval(NamedTuple):
    low: float
    high: float

    def excludes(self, value):
        return value < self.low or value > self.high


def mersenne_twister(seed, count):
    """The first numbers of C++'s std::mt19937_64, which numpy does not have: intervals are then the same everywhere, and
    the same as those of every page that was written before."""
    size, middle, mask = 312, 156, 2**64 - 1
    state = [seed]
    for i in range(1, size):
        state.append((6364136223846793005 * (state[-1] ^ state[-1] >> 62) + i) & mask)
    words = []
    while len(words) < count:
        for i in range(size):
            x = (state[i] & ~0x7FFFFFFF) | (state[(i + 1) % size] & 0x7FFFFFFF)
            state[i] = state[(i + middle) % size] ^ x >> 1 ^ (0xB5026F5AA96619E9 if x & 1 else 0)
        for x in state:
            x ^= x >> 29 & 0x5555555555555555
            x ^= x << 17 & 0x71D67FFFEDA60000
            x ^= x << 37 & 0xFFF7EEE000000000
            words.append(x ^ x >> 43)
    return words[:count]


@lru_cache
def resamples(count, seed):
    """A row of indices from 0 to count - 1 for each resample, drawn with replacement."""
    words = mersenne_twister(seed, RESAMPLES * count)
    return numpy.array([word % count for word in words]).reshape(RESAMPLES, count)


def bootstrap(count, statistic, seed, confidence=0.95):
    """Percentile bootstrap of what statistic(indices) says of each row of indices: the interval holds `confidence` of the
    outcomes. Figures that were measured side by side are resampled together by taking the same indices of each. The same
    seed gives the same interval."""
    outcomes = numpy.sort(statistic(resamples(count, seed)))
    low = math.floor(0.5 * (1 - confidence) * (RESAMPLES - 1))
    return Interval(float(outcomes[low]), float(outcomes[RESAMPLES - 1 - low]))


class Runs(NamedTuple):
    """What one configuration took and missed, seed by seed."""
    seconds: list
    mse: list


def efficiency(runs, indices):
    """1 / (MSE s) of those runs, for each row of indices: mean error, since it is an expectation; median time, since
    machines have outliers. An error of zero or below, which only the correction for noise can make, counts as infinitely
    efficient."""
    seconds = numpy.median(numpy.array(runs.seconds)[indices], axis=-1)
    parts = (numpy.array(runs.mse) / indices.shape[-1])[indices]
    mse = sum(parts[..., i] for i in range(parts.shape[-1]))
    return numpy.divide(1, mse * seconds, out=numpy.full_like(mse, math.inf), where=mse > 0)


class Winner(Enum):
    FIRST = 1
    SECOND = 2
    NO_DIFFERENCE = 3


class Comparison(NamedTuple):
    ratio: float  # efficiency of the first over that of the second
    interval: Interval
    winner: Winner  # where the interval excludes 1, and there are LEAST_SEEDS

    def __str__(self):
        return f"{self.ratio:.2f} ({self.interval.low:.2f} to {self.interval.high:.2f})"


def compare(a, b, seed=1):
    """Run i of both had the same seed and stood side by side."""
    count = min(len(a.mse), len(b.mse))

    def ratio(indices):
        first, second = efficiency(a, indices), efficiency(b, indices)
        with numpy.errstate(invalid="ignore"):
            return numpy.where(first == second, 1.0, first / second)  # two infinities do not differ

    interval = bootstrap(count, ratio, seed)
    winner = Winner.NO_DIFFERENCE
    if count >= LEAST_SEEDS and interval.excludes(1):
        winner = Winner.FIRST if interval.low > 1 else Winner.SECOND
    return Comparison(float(ratio(numpy.arange(count))), interval, winner)


def rmse(runs):
    """Of mean squared errors; zero where the correction for noise left nothing."""
    return math.sqrt(max(mean(runs.mse), 0))


def pareto_front(points):
    """Those of (seconds, error) that no other beats in both, by rising time. Of equal points the first stands."""
    front, least = [], math.inf
    for seconds, error in sorted(points):
        if error < least:
            least = error
            front.append((seconds, error))
    return front


def log_log_slope(x, y):
    """Of the least-squares line through (log x, log y); all values above zero, at least two different x."""
    n = len(x)
    mean_x = sum(math.log(value) / n for value in x)
    mean_y = sum(math.log(value) / n for value in y)
    xy = sum((math.log(a) - mean_x) * (math.log(b) - mean_y) for a, b in zip(x, y))
    return xy / sum((math.log(a) - mean_x) ** 2 for a in x)
