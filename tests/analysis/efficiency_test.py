"""Statistics of error against time, on data whose truth is known."""
import math
import random
import unittest

import support  # noqa: F401 ; before the package
import numpy
from analysis import spreads
from analysis.efficiency import (Runs, Winner, bootstrap, compare, efficiency, log_log_slope, mersenne_twister,
                                 pareto_front)


def mean_of(values):
    return lambda indices: numpy.array(values)[indices].mean(axis=-1)


class MersenneTwisterTest(unittest.TestCase):
    def test_is_that_of_the_standard(self):
        self.assertEqual(mersenne_twister(5489, 10000)[-1], 9981545732273789042)  # [rand.predef]
        self.assertEqual(mersenne_twister(1, 3), mersenne_twister(1, 400)[:3])


class BootstrapTest(unittest.TestCase):
    def test_holds_the_truth_about_as_often_as_it_says(self):
        trials, held = 200, 0
        for trial in range(trials):
            chance = random.Random(trial)
            values = [chance.gauss(3, 1) for _ in range(20)]
            held += not bootstrap(len(values), mean_of(values), 1).excludes(3)
        self.assertGreaterEqual(held, 0.88 * trials)
        self.assertLessEqual(held, 0.98 * trials)

    def test_is_repeatable_and_of_one_value_is_that_value(self):
        mean = mean_of([1, 5, 2, 8, 3])
        self.assertEqual(bootstrap(5, mean, 7), bootstrap(5, mean, 7))
        self.assertNotEqual(bootstrap(5, mean, 7), bootstrap(5, mean, 8))
        self.assertLess(bootstrap(5, mean, 7).low, bootstrap(5, mean, 7).high)
        self.assertEqual(bootstrap(1, mean, 7), (1, 1))


NOISY = Runs([1, 1.1, 0.9, 1, 1, 1], [4, 5, 3, 4.5, 3.5, 4])
COMPARISONS = [
    ("the same image in half the time", NOISY, Runs([2, 2.2, 1.8, 2, 2, 2], NOISY.mse), 2, Winner.FIRST),
    ("twice the error, the same time", Runs([1] * 6, [8, 8.2, 7.8, 8, 8, 8]), Runs([1] * 6, [4, 4.1, 3.9, 4, 4, 4]), 0.5,
     Winner.SECOND),
    ("against itself", NOISY, NOISY, 1, Winner.NO_DIFFERENCE),
    ("less than the spread", NOISY, Runs([1] * 6, [3, 5, 4.5, 3.5, 4, 4.1]), 4.016666666666667 / 4, Winner.NO_DIFFERENCE),
    ("too few seeds", Runs([1] * 4, [1] * 4), Runs([2] * 4, [1] * 4), 2, Winner.NO_DIFFERENCE),
    ("an outlier of the machine", Runs([1, 1, 1, 1, 1, 90, 1, 1, 1, 1], [4] * 10), Runs([2] * 10, [4] * 10), 2,
     Winner.FIRST),
]


class CompareTest(unittest.TestCase):
    def test_says_who_wins_only_where_the_interval_excludes_one(self):
        for what, a, b, ratio, winner in COMPARISONS:
            with self.subTest(what):
                found = compare(a, b)
                self.assertAlmostEqual(found.ratio, ratio, 9)
                self.assertEqual(found.winner, winner)
                self.assertLessEqual(found.interval.low, found.ratio)
                self.assertGreaterEqual(found.interval.high, found.ratio)

    def test_two_that_reach_the_reference_do_not_differ(self):
        perfect = Runs([1] * 5, [-1] * 5)
        self.assertEqual(compare(perfect, perfect).ratio, 1)
        self.assertEqual(compare(perfect, Runs([1] * 5, [1] * 5)).ratio, math.inf)


class EfficiencyTest(unittest.TestCase):
    def test_is_infinite_where_the_correction_leaves_no_error(self):
        both = numpy.arange(2)
        self.assertEqual(efficiency(Runs([1, 1], [-1, 0.5]), both), math.inf)
        self.assertAlmostEqual(float(efficiency(Runs([2, 4], [0.25, 0.75]), both)), 1 / (0.5 * 3), 15)


class ParetoFrontTest(unittest.TestCase):
    def test_holds_what_no_other_point_beats(self):
        for points, front in (([], []), ([(1, 1)], [(1, 1)]), ([(1, 3), (2, 2), (3, 1)], [(1, 3), (2, 2), (3, 1)]),
                              ([(3, 1), (2, 2), (1, 3)], [(1, 3), (2, 2), (3, 1)]),
                              ([(1, 3), (2, 4), (3, 1)], [(1, 3), (3, 1)]), ([(2, 2), (2, 1), (2, 2)], [(2, 1)]),
                              ([(1, 1), (1, 1)], [(1, 1)]), ([(1, 2), (2, 2)], [(1, 2)])):
            self.assertEqual(pareto_front(points), front)


class LogLogSlopeTest(unittest.TestCase):
    def test_is_the_exponent(self):
        x = [1, 4, 16, 64]
        self.assertAlmostEqual(log_log_slope(x, [3 * value**-0.75 for value in x]), -0.75, 12)


class SpreadTest(unittest.TestCase):
    def test_is_the_median_with_the_lowest_and_the_highest(self):
        self.assertEqual(spreads.spread([3, 1, 2]), (2, 1, 3, 3))
        self.assertEqual(spreads.spread([4, 1, 2, 3]), (2.5, 1, 4, 4))
        self.assertEqual(spreads.text(spreads.spread([1.4, 1.52, 1.61])), "1.52 (1.40 to 1.61)")

    def test_load_is_measured_against_perfect_balance(self):
        self.assertEqual(spreads.max_over_mean([2, 2]), 1)
        self.assertEqual(spreads.max_over_mean([4, 0]), 2)
        self.assertEqual(spreads.max_over_mean([0, 0]), 1)
        self.assertEqual(spreads.coefficient_of_variation([1, 3]), 0.5)
        self.assertEqual(spreads.coefficient_of_variation([0, 0]), 0)

    def test_numbers_are_as_short_as_they_can_be(self):
        self.assertEqual([spreads.shortest(x) for x in (64, 64.0, 0.1, 1e16, 1e-5)], ["64", "64", "0.1", "1e+16", "1e-05"])


if __name__ == "__main__":
    unittest.main()
