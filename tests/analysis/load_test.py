"""What a run of the study `load` says of its rows."""
import unittest

import support  # noqa: F401 ; before the package
from analysis import load

WAYS = {"lines, static (default)": [3, 1], "lines, static,1": [2.2, 1.8], "pixels, static,1 (collapse)": [2, 2]}
RUNGS = [{"name": "shared", "step": "a shared pool"}, {"name": "thread", "step": "a pool for each thread"}]


def rows_of(group, way, tests, **more):
    return [{"group": group, "way": way, "source": "counted", "repeat": 0, "threads": len(tests), "thread": thread,
             "segments": 100, "tests": count, **{"busy_s": None, **more}} for thread, count in enumerate(tests)]


def rows(shares, **more):
    found = [row for way, tests in WAYS.items() for row in rows_of("recursion", way, tests, **more)]
    return found + (rows_of("pool", load.SHARES, shares, **more) if shares else [])


class LoadTest(unittest.TestCase):
    def caption(self, shares):
        return load.summarise({}, rows(shares)).pictures[0].caption

    def test_the_caption_says_of_the_last_panel_what_is_there(self):
        self.assertIn("that its bars are, too", self.caption([2, 2.01]))
        self.assertIn("that its bars are not", self.caption([3, 1]))

    def test_of_one_thread_nothing_is_said_of_the_last_panel(self):
        alone = [row for row in rows([2, 2]) if row["thread"] == 0]
        caption = load.summarise({}, [{**row, "threads": 1} for row in alone]).pictures[0].caption
        self.assertNotIn("last panel", caption)
        self.assertTrue(caption.endswith("tall bars."))

    def test_names_the_size_where_rows_have_it(self):
        older, newer = (load.summarise({}, rows([2, 2], **more)).tables[0].title
                        for more in ({}, {"width": 240, "height": 135, "samples": 4}))
        self.assertEqual(older, "Load of 2 threads")
        self.assertEqual(newer, "Load of 2 threads, 240 x 135 pixels, 4 samples a pixel")

    def test_has_a_column_of_time_where_there_is_time(self):
        for busy, is_there in ((None, False), (0.5, True)):
            table = load.summarise({}, rows([2, 2], busy_s=busy) if busy else rows([2, 2])).tables[0]
            self.assertEqual("busy: max/mean" in table.header, is_there)
            self.assertEqual({len(cells) for cells in table.rows}, {len(table.header)})

    def test_says_what_pools_are_where_the_run_knows(self):
        self.assertEqual(len(load.summarise({}, rows([2, 2])).tables), 1)
        told = load.summarise({"facts": {"rungs": RUNGS}}, rows([2, 2])).tables[1]
        self.assertEqual(told.rows, [["shared", "a shared pool"], ["thread", "a pool for each thread"]])


if __name__ == "__main__":
    unittest.main()
