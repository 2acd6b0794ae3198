"""What the study `gpu` says of figures that are known."""
import unittest

import support  # noqa: F401 ; before the package
from analysis.gpu import summarise
from analysis.verdict import Verdict


def runs(engine, threads, seconds, device=None, width=1600, repeats=5):
    return [{"kind": "render", "case": engine, "repeat": repeat, "engine": engine, "threads": threads, "width": width, "seconds": seconds,
             "mpaths_per_s": 1 / seconds, "hash": "00ff", "device": device, "segments": 100,
             "kernel_seconds": seconds / 2 if device else None} for repeat in range(repeats)]


def rounds(form, room, *counts):
    return [{"kind": "occupancy", "engine": form, "width": 48, "room": room, "round": i, "live": live, "lanes": lanes}
            for i, (live, lanes) in enumerate(counts, 1)]


OCCUPANCY = (rounds("gpu mega", None, (64, 64), (4, 64), (1, 32)) + rounds("gpu mega-regenerate", 32, (32, 32), (32, 32), (31, 32))
             + rounds("gpu wave", 64, (64, 64), (62, 64)))
CPU = OCCUPANCY + runs("recursive", 1, 100.0) + runs("pool", 1, 30.0) + runs("recursive", 16, 8.0) + runs("pool", 16, 2.0)


class GpuTest(unittest.TestCase):
    def test_says_so_where_there_is_no_gpu(self):
        summary = summarise({}, CPU)
        for finding in summary.findings[:2]:
            self.assertEqual(finding.verdict, Verdict.CANNOT_TELL)
            self.assertIn("no rows of a GPU", finding.why)
        self.assertEqual([row[3] for row in summary.tables[0].rows], [""] * 4)

    def test_holds_the_fastest_form_against_sixteen_threads(self):
        for seconds, verdicts in ((0.1, (Verdict.HOLDS, Verdict.HOLDS)), (1.0, (Verdict.HOLDS, Verdict.DOES_NOT_HOLD)),
                                  (5.0, (Verdict.DOES_NOT_HOLD, Verdict.DOES_NOT_HOLD))):
            rows = CPU + runs("gpu mega", 1, 9.0, "a chip") + runs("gpu wave", 1, seconds, "a chip")
            summary = summarise({}, rows)
            self.assertEqual(tuple(finding.verdict for finding in summary.findings[:2]), verdicts)
            self.assertIn("by gpu wave over recursive, 16 threads, 1600 wide", summary.findings[0].ours)
            self.assertIn("over pool, 16 threads", summary.findings[1].ours)
        self.assertEqual(summary.tables[0].rows[-1][:4], ["1600", "gpu wave", "5.000 (5.000 to 5.000)", "2.500 (2.500 to 2.500)"])

    def test_a_thread_a_path_does_not_keep_threads_busy(self):
        finding = summarise({}, CPU + runs("gpu mega", 1, 0.01, "a chip")).findings[1]
        self.assertEqual(finding.verdict, Verdict.CANNOT_TELL)

    def test_says_how_full_each_form_keeps_its_lanes(self):
        summary = summarise({}, CPU)
        self.assertEqual(summary.tables[1].rows, [["gpu mega", "one a path", "3", "0.431"],
                                                  ["gpu mega-regenerate", "32", "3", "0.990"], ["gpu wave", "64", "2", "0.984"]])
        self.assertEqual(summary.findings[2].verdict, Verdict.HOLDS)
        full = OCCUPANCY[3:] + rounds("gpu mega", None, (64, 64), (60, 64)) + CPU[len(OCCUPANCY):]
        self.assertEqual(summarise({}, full).findings[2].verdict, Verdict.DOES_NOT_HOLD)

    def test_says_what_it_can_of_a_part(self):
        self.assertEqual(summarise({}, OCCUPANCY).findings[0].verdict, Verdict.HOLDS)
        for part in (OCCUPANCY[:3], OCCUPANCY[3:], runs("recursive", 1, 100.0)):
            for finding in summarise({}, part).findings:
                self.assertEqual(finding.verdict, Verdict.CANNOT_TELL)


if __name__ == "__main__":
    unittest.main()
