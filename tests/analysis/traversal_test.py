"""What the study `traversal` says of figures that are known."""
import unittest

import support  # noqa: F401 ; before the package
from analysis.traversal import summarise
from analysis.verdict import Verdict


def runs(rays, search, rate, others=0, far_apart=0, repeats=5):
    """Of a mesh of 1000 triangles, by one search of so many M rays/s."""
    return [{"case": f"{rays}{search}", "repeat": repeat, "kind": "field", "triangles": 1000, "tree_bytes": 1, "rays": rays,
             "search": search, "ray_count": 100, "seconds": 1.0, "mrays_per_s": rate * (1 + 0.01 * repeat),
             "others": others, "far_apart": None if rays == "shadow" else far_apart} for repeat in range(repeats)]


def all_rows(embree_rate=1.0, others=0, far_apart=0):
    rows = []
    for rays in ("camera", "shadow"):
        rows += runs(rays, "single rays", 2) + runs(rays, "Embree, single rays", embree_rate, others, far_apart)
    return rows + runs("camera", "packets", 5)


class TraversalTest(unittest.TestCase):
    def test_has_a_table_for_each_kind_of_rays(self):
        camera, shadow = summarise({}, all_rows()).tables
        self.assertEqual(camera.rows, [["1000 field", "100", "2.04", "0.50 (0.50 to 0.50)", "2.50 (2.50 to 2.50)"]])
        self.assertEqual(shadow.rows, [["1000 field", "100", "2.04", "0.50 (0.50 to 0.50)"]])

    def test_judges_single_rays_where_they_lead_embree_least(self):
        for rate, verdict in ((1.0, Verdict.HOLDS), (2.05, Verdict.HOLDS), (2.5, Verdict.DOES_NOT_HOLD)):
            self.assertEqual(summarise({}, all_rows(rate)).findings[0].verdict, verdict)

    def test_counts_each_ray_once_that_met_something_else(self):
        finding = summarise({}, all_rows(others=3)).findings[1]
        self.assertIn("of 100 rays 3 met another primitive, 0 of them at another distance", finding.ours)
        self.assertIn("of 100 shadow rays 3 differ", finding.ours)
        self.assertEqual(finding.verdict, Verdict.DOES_NOT_HOLD)
        self.assertEqual(summarise({}, all_rows()).findings[1].verdict, Verdict.HOLDS)

    def test_says_so_where_there_is_no_embree(self):
        rows = [row for row in all_rows() if not row["search"].startswith("Embree")]
        for finding in summarise({}, rows).findings:
            self.assertEqual((finding.verdict, finding.why), (Verdict.CANNOT_TELL, "this build has no Embree"))


if __name__ == "__main__":
    unittest.main()
