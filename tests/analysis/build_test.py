"""What the study `build` says of figures that are known."""
import unittest

import support  # noqa: F401 ; before the package
from analysis.build import summarise
from analysis.verdict import Verdict


def runs(builder, seconds, rate=2.0, visits=10.0, repeats=5):
    """Of a mesh of 1000 triangles, by one thread."""
    walked_by_us = not builder.startswith("embree") or builder == "embree-sah"
    return [{"case": builder, "repeat": repeat, "kind": "field", "triangles": 1000, "builder": builder, "threads": 1,
             "seconds": seconds, "binary_seconds": seconds / 2 if walked_by_us else None,
             "mtriangles_per_s": 1e-3 / seconds, "tree_bytes": 56_000, "peak_bytes": 200_000 if walked_by_us else None,
             "node_visits": visits if walked_by_us else None, "leaf_visits": 2 * visits if walked_by_us else None,
             "leaf_fill": 0.75 if walked_by_us else None, "depth": 4 if walked_by_us else None,
             **{f"{rays}_mrays_per_s": rate * (1 + 0.01 * repeat)
                for rays in ("camera", "first_bounce", "fourth_bounce", "shadow")}} for repeat in range(repeats)]


def all_rows(sah_rate=2.0, sah_visits=10.0, robust_seconds=0.01):
    return (runs("ours", 0.004) + runs("embree-sah", 0.005, sah_rate, sah_visits) + runs("embree-robust", robust_seconds))


class BuildTest(unittest.TestCase):
    def test_has_a_row_for_each_builder_with_figures_a_triangle(self):
        table, = summarise({}, all_rows()).tables
        self.assertEqual([len(row) for row in table.rows], [len(table.header)] * 3)
        self.assertEqual(table.rows[0], ["1000 field", "1", "ours", "0.0040 (0.0040 to 0.0040)", "0.0020", "0.25", "56.0", "200",
                                         "10.00", "20.00", "0.75", "4", "2.04", "2.04", "2.04", "2.04"])
        self.assertEqual(table.rows[2][4:12], ["", "0.10", "56.0", "", "", "", "", ""])

    def test_judges_what_rays_pay_by_their_rates_and_by_visits(self):
        for rate, visits, verdict in ((2.0, 10.0, Verdict.HOLDS), (2.2, 10.0, Verdict.DOES_NOT_HOLD),
                                      (2.0, 9.0, Verdict.DOES_NOT_HOLD), (2.05, 9.9, Verdict.HOLDS)):
            finding = summarise({}, all_rows(rate, visits)).findings[0]
            self.assertEqual(finding.verdict, verdict, (rate, visits))
            self.assertIn("rays of 1000 field", finding.ours)

    def test_judges_time_against_a_robust_scene_of_embrees(self):
        for seconds, verdict in ((0.01, Verdict.HOLDS), (0.003, Verdict.DOES_NOT_HOLD)):
            finding = summarise({}, all_rows(robust_seconds=seconds)).findings[1]
            self.assertEqual(finding.verdict, verdict)
        self.assertIn("by 1 thread", finding.claim)

    def test_says_so_where_there_is_no_embree(self):
        for finding in summarise({}, runs("ours", 0.004)).findings:
            self.assertEqual(finding.verdict, Verdict.CANNOT_TELL)
            self.assertIn("no Embree", finding.why)


if __name__ == "__main__":
    unittest.main()
