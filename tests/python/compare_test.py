"""raypool.compare(): rows of engines that make one image, and an exception where they do not."""

import pickle
import unittest

import raypool
from raypool import _compare


class Compare(unittest.TestCase):
    def test_has_a_row_for_each_engine(self):
        rows = raypool.compare("cornell", repeats=3, width=24, spp=4, threads=2)
        self.assertEqual([row["engine"] for row in rows], list(raypool.engines()))
        alone = raypool.render("cornell", width=24, spp=4)[1]
        for row in rows:
            self.assertEqual((row["hash"], row["segments"]), (alone["hash"], alone["segments"]))
            self.assertEqual({len(row[list_]) for list_ in ("seconds", "mpaths_per_s", "ratio")}, {3})
            for own, first, ratio in zip(row["seconds"], rows[0]["seconds"], row["ratio"]):
                self.assertAlmostEqual(ratio, first / own)
            self.assertEqual(row["ratio_median"], sorted(row["ratio"])[1])
        self.assertEqual(rows[0]["ratio"], [1, 1, 1])

    def test_takes_engines_with_options_of_their_own(self):
        rows = raypool.compare("cornell", ["recursive", {"engine": "wavefront", "pool_rays": 64},
                                           {"name": "shared", "engine": "wavefront", "pool_scope": "shared"}],
                               repeats=1, width=16, height=16, spp=2)
        self.assertEqual([row["name"] for row in rows], ["recursive", "wavefront, pool_rays=64", "shared"])
        self.assertEqual([row["engine"] for row in rows], ["recursive", "wavefront", "wavefront"])

    def test_raises_where_images_differ(self):
        engines = ["recursive", {"name": "rounded", "engine": "wavefront", "accumulator": "atomic-float"}]
        with self.assertRaises(raypool.ImagesDiffer) as caught:
            raypool.compare("cornell", engines, repeats=1, width=16, spp=4)
        hashes = caught.exception.hashes
        self.assertEqual(list(hashes), ["recursive", "rounded"])
        self.assertEqual(hashes["recursive"] & hashes["rounded"], set())
        self.assertEqual(pickle.loads(pickle.dumps(caught.exception)).hashes, hashes)

    def test_interleaves_its_runs(self):
        for count in (1, 2, 3, 6):
            orders = [_compare._order(turn, count) for turn in range(4)]
            for order in orders:
                self.assertEqual(sorted(order), list(range(count)))
            self.assertGreaterEqual(len({tuple(order) for order in orders}), min(count, 2))

    def test_refuses_what_makes_no_sense(self):
        for options in ({"repeats": 0}, {"engines": []}, {"engines": ["fast"]}, {"spp": 0}):
            with self.assertRaises(raypool.InputError):
                raypool.compare("one_sphere", **options)
        for options in ({"output": "a.png"}, {"progress": print}, {"engines": [{"engine": "recursive", "rays": 1}]}):
            with self.assertRaisesRegex(TypeError, "unexpected option"):
                raypool.compare("one_sphere", **options)


if __name__ == "__main__":
    unittest.main()
