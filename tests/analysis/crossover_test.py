"""Where a pool begins to beat recursion, and what a spread decides."""
import unittest

import support  # noqa: F401 ; before the package
from analysis.crossover import AtCapacity, best, crossover
from analysis.spreads import Spread
from analysis.verdict import Verdict, is_at_least, why_open


def found(*measured):
    return crossover([AtCapacity(capacity, Spread(*ratio)) for capacity, ratio in measured])


class CrossoverTest(unittest.TestCase):
    def test_is_the_smallest_capacity_that_wins_in_every_run(self):
        got = found((64, (0.8, 0.7, 0.9)), (256, (1.2, 0.9, 1.5)), (1024, (1.3, 1.1, 1.4)))
        self.assertEqual(got, (1024, []), "at 256 one run lost")
        self.assertEqual(str(got), "1024")

    def test_is_never_where_no_capacity_wins(self):
        self.assertEqual(str(found((64, (0.8, 0.7, 0.9)), (256, (1.0, 1.0, 1.0)))), "never", "a draw is no win")
        self.assertEqual(str(found()), "never")

    def test_names_the_larger_capacities_that_lose_again(self):
        got = found((64, (1.2, 1.1, 1.3)), (256, (0.9, 0.8, 1.1)), (1024, (2, 2, 2)), (4096, (0.5, 0.4, 0.6)))
        self.assertEqual(got, (64, [256, 4096]))
        self.assertEqual(str(got), "64, but not 256, 4096")

    def test_the_best_capacity_is_the_first_of_the_highest_medians(self):
        measured = [AtCapacity(64, Spread(1, 1, 9)), AtCapacity(256, Spread(2, 1, 3)), AtCapacity(1024, Spread(2, 2, 2))]
        self.assertEqual(best(measured).capacity, 256)


class RatioVerdictTest(unittest.TestCase):
    def test_is_open_where_runs_are_few_or_on_both_sides(self):
        self.assertEqual(is_at_least(Spread(4.2, 4.0, 4.4, 5), 4), Verdict.HOLDS)
        self.assertEqual(is_at_least(Spread(3.8, 3.6, 3.9, 5), 4), Verdict.DOES_NOT_HOLD)
        self.assertEqual(is_at_least(Spread(3.8, 3.6, 4.0, 5), 4), Verdict.CANNOT_TELL)
        self.assertEqual(is_at_least(Spread(4.1, 3.9, 4.2, 5), 4), Verdict.CANNOT_TELL)
        self.assertEqual(is_at_least(Spread(4.2, 4.0, 4.4, 4), 4), Verdict.CANNOT_TELL)
        self.assertEqual(why_open(Spread(4.1, 3.9, 4.2, 5), 4), "the spread of the runs includes 4")
        self.assertEqual(why_open(Spread(4.2, 4.0, 4.4, 5), 4), "")
        self.assertEqual(why_open(Spread(4.2, 4.0, 4.4, 4), 4), "fewer than 5 runs")


if __name__ == "__main__":
    unittest.main()
