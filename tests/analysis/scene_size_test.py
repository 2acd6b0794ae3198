"""What the study `scene-size` says of figures that are known."""
import unittest

import support  # noqa: F401 ; before the package
from analysis.scene_size import summarise
from analysis.verdict import Verdict

COLUMNS = ("source", "d1_read_misses", "ll_read_misses", "level", "lists", "list_rays", "single_rays", "lanes")


def runs(shapes, way, capacity, rate, repeats=5, **more):
    """Of one way: recursion at 1 M paths/s, a pool by its capacity, or the automatic one."""
    return [{"case": f"{shapes}{way}", "repeat": repeat, "threads": 1, "kind": "spheres", "shapes": shapes, "depth": 50,
             "way": way, "capacity": capacity, "tree_bytes": 56 * shapes, "segments": 1000,
             "mpaths_per_s": rate * (1 + 0.01 * repeat), "ns_per_segment": 100.0, **dict.fromkeys(COLUMNS), **more}
            for repeat in range(repeats)]


def level(shapes, number, lists, rays, single_rays, lanes):
    """Of the automatic pool, with 1000 segments in all."""
    return runs(shapes, "lists, automatic", 8192, 1, 1, level=number, lists=lists, list_rays=rays, single_rays=single_rays,
                lanes=lanes)


def two_sizes(automatic_in_the_large):
    rows = []
    for shapes, automatic, records, small_pool, large_pool in ((1000, 3, 8192, 3, 2.5),
                                                               (100_000, automatic_in_the_large, 32768, 0.8, 2.1)):
        rows += runs(shapes, "recursion", None, 1) + runs(shapes, "automatic", records, automatic)
        rows += runs(shapes, "8192", 8192, small_pool) + runs(shapes, "32768", 32768, large_pool)
    return rows


class SceneSizeTest(unittest.TestCase):
    def test_names_the_best_capacity_of_each_scene_and_the_smallest_that_wins(self):
        table, = summarise({}, two_sizes(2.1)).tables
        self.assertEqual([len(row) for row in table.rows], [len(table.header)] * 2)
        self.assertEqual(table.rows, [
            ["1000 spheres", "0.06", "100", "3.00 (3.00 to 3.00)", "2.50 (2.50 to 2.50)", "3.00 (3.00 to 3.00)", "8192",
             "8192", "8192"],
            ["100000 spheres", "5.60", "100", "0.80 (0.80 to 0.80)", "2.10 (2.10 to 2.10)", "2.10 (2.10 to 2.10)", "32768",
             "32768", "32768"]])

    def test_judges_the_default_pool_where_it_leads_least(self):
        for automatic, verdicts in ((2.1, [Verdict.HOLDS, Verdict.HOLDS]), (1.5, [Verdict.DOES_NOT_HOLD, Verdict.HOLDS]),
                                    (0.7, [Verdict.DOES_NOT_HOLD, Verdict.DOES_NOT_HOLD])):
            findings = summarise({}, two_sizes(automatic)).findings
            self.assertEqual([finding.verdict for finding in findings], verdicts)
            for finding in findings:
                self.assertIn("100000 spheres", finding.ours)

    def test_judges_the_default_pool_against_packets_over_embree_where_there_are_any(self):
        for packets, verdict in ((1.0, Verdict.HOLDS), (1.8, Verdict.DOES_NOT_HOLD)):
            rows = two_sizes(2.1)
            for way, rate in (("embree-1", 0.5), ("embree-mesh-1", 0.8), ("embree-packet", 0.7), ("embree-mesh-packet", packets)):
                rows += runs(100_000, way, None, rate)
            summary = summarise({}, rows)
            self.assertEqual(summary.findings[-1].verdict, verdict)
            self.assertIn("100000 spheres", summary.findings[-1].ours)
            table = summary.tables[-1]
            self.assertEqual(len(table.rows), 1)
            self.assertEqual(table.rows[0][:3], ["100000 spheres", "1.25 (1.25 to 1.25)", "2.00 (2.00 to 2.00)"])
            self.assertEqual(len(table.rows[0]), len(table.header))

    def test_tells_cache_misses_only_where_they_were_counted(self):
        rows = two_sizes(2.1)
        self.assertEqual(len(summarise({}, rows).tables), 1)
        rows += runs(1000, "cache misses, recursion", None, 1, 1, source="cachegrind")
        tables = summarise({}, rows).tables
        self.assertEqual(len(tables), 2)
        self.assertEqual(tables[-1].rows[0], ["1000 spheres", "recursion", "", "", "cachegrind"])

    def test_tells_how_long_lists_are_and_how_full_their_registers_by_level(self):
        rows = two_sizes(2.1) + level(1000, 0, 2, 1000, 0, 1008) + level(1000, 1, 40, 800, 200, 800)
        rows += level(1000, 2, 10, 50, 50, 0)
        self.assertEqual(summarise({}, rows).tables[-1].rows, [["1000 spheres", "0", "500.0", "99 %", "1.000", "0 %"],
                                                              ["1000 spheres", "1", "20.0", "75 %", "0.800", "25 %"],
                                                              ["1000 spheres", "2", "5.0", "", "0.050", "100 %"]])


if __name__ == "__main__":
    unittest.main()
