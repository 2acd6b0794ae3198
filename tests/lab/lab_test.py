"""What the solutions of docs/lab/ claim: each figure is run, and looked up in the page that claims it. No time is."""

import csv
import math
import os
import pathlib
import re
import subprocess
import sys

SOURCE = pathlib.Path(__file__).resolve().parents[2]
LAB = SOURCE / "docs" / "lab"
PASSIVE = {"OMP_WAIT_POLICY": "passive"}
sys.path.insert(0, str(SOURCE / "tests" / "cli"))

from command import CommandTest, main  # noqa: E402: after the choice of where it lies

PAPER = ("paper", "--width", 100, "--spp", 4)
HASH = "4f61c17f743ad3bf"
PATHS, SEGMENTS, LINES = 22400, 57842, 56
WAYS = ("lines, static (default)", "lines, static,1", "pixels, static,1 (collapse)")  # of `study load`


def max_over_mean(values):
    return max(values) * len(values) / sum(values)


def tests(thread):
    return thread["box_tests"] + thread["primitive_tests"]


class LabTest(CommandTest):
    page = ""

    def run_command(self, *arguments, **keywords):
        """Threads are more than cores here: waiting ones must sleep, not spin."""
        return super().run_command(*arguments, **{"environment": PASSIVE, **keywords})

    def assert_page_says(self, *words):
        text = " ".join((LAB / self.page).read_text().split())
        for each in words:
            self.assertIn(each, text, self.page)

    def threads(self, *arguments):
        """What each thread of a render by recursion did; its image is the one that all pages speak of."""
        stats = self.stats(*PAPER, "--engine", "recursive", *arguments)
        self.assertEqual((stats["hash"], stats["paths"], stats["segments"]), (HASH, PATHS, SEGMENTS), arguments)
        return stats["threads"]

    def paths(self, *arguments):
        return [thread["paths"] for thread in self.threads(*arguments)]

    def diff(self, a, b):
        """Pixels that differ, and the figures by name."""
        text = self.run_command("diff", a, b).stdout
        pixels = re.search(r"pixels that differ (\d+) of (\d+)\n", text)
        figures = {name: float(re.search(rf"^{name} +(\S+)$", text, re.MULTILINE)[1])
                   for name in ("RMSE", "largest difference", "largest ULP")}
        return int(pixels[1]), int(pixels[2]), figures

    def show(self, *names, program="show.py"):
        result = subprocess.run([sys.executable, LAB / program, *names], cwd=self.folder, text=True, capture_output=True,
                                check=True, timeout=60)
        return result.stdout

    def compile(self, name):
        """A program of the lab, as its page compiles it, and without a warning."""
        command = f"g++ -O2 -fopenmp docs/lab/{name}.cpp -o out/{name}"
        self.assert_page_says(command)
        words = command.replace("docs/lab/", f"{LAB}/").replace("out/", f"{self.folder}/").split()
        subprocess.run([*words, "-Wall", "-Wextra", "-Werror"], check=True, timeout=120)
        return lambda *arguments: subprocess.run([self.folder / name, *map(str, arguments)], text=True, check=True,
                                                 capture_output=True, timeout=60, env={**os.environ, **PASSIVE}).stdout


class Schedule(LabTest):
    page = "1-schedule.md"

    def test_deals_out_as_many_paths_and_other_work(self):
        block = self.threads("--threads", 4, "--schedule", "static", "--count-work")
        turns = self.threads("--threads", 4, "--schedule", "static,1", "--count-work")
        for threads in (block, turns):
            self.assertEqual([thread["paths"] for thread in threads], 4 * [5600])
        for threads, segments, work in ((block, "1.207", 1.35), (turns, "1.016", 1.02)):
            self.assertEqual(f"{max_over_mean([thread['segments'] for thread in threads]):.3f}", segments)
            self.assertAlmostEqual(max_over_mean([tests(thread) for thread in threads]), work, delta=0.03)
            self.assert_page_says(segments, f"about {work}")
        self.assertEqual(sum(map(tests, block)), sum(map(tests, turns)))
        self.assert_page_says(HASH, "57,842 segments", "Each thread has 5,600 paths")
        self.assertRegex(self.show("stats.json"), rf"hash {HASH}, 22400 paths, 57842 segments\n(.*\n)+max/mean +1\.000 +1\.016 ")

    def test_gives_chunks_in_turn(self):
        for chunk, paths in ((5, [6000, 6000, 6000, 4400]), (18, [7200, 7200, 7200, 800]), (19, [7600, 7600, 7200, 0])):
            self.assertEqual(self.paths("--threads", 4, "--schedule", f"static,{chunk}"), paths)
            self.assert_page_says(", ".join(map(str, paths[:3])) + f" and {paths[3]}")

    def test_leaves_open_who_does_what_if_it_is_dynamic(self):
        self.assertEqual(sum(self.paths("--threads", 8, "--schedule", "dynamic")), PATHS)


class Load(LabTest):
    page = "2-load.md"

    def loads(self, *arguments):
        """(rays, tests) by the way of sharing out: max/mean of eight threads."""
        self.run_well("study", "load", "--quick", *arguments, "--threads", 8, "--out", "load", "--quiet", timeout=300)
        with open(self.folder / "load" / "data.csv", newline="") as file:
            rows = [row for row in csv.DictReader(file) if row["repeat"] == "0"]
        self.assertTrue((self.folder / "load" / "load.png").exists())
        own = {way: [row for row in rows if row["way"] == way] for way in {row["way"] for row in rows}}
        return {way: [max_over_mean([float(row[unit]) for row in of]) for unit in ("segments", "tests")]
                for way, of in own.items()}

    def test_falls_with_the_size_of_the_pieces_and_is_not_that_of_rays(self):
        loads = self.loads("--scene", *PAPER)
        block, line, pixel = (loads[way][1] for way in WAYS)
        for load, said in ((block, 1.37), (line, 1.10), (pixel, 1.01)):
            self.assertAlmostEqual(load, said, delta=0.03)
            self.assert_page_says(f"about {said:.2f}")
        self.assertGreater(block, line)
        self.assertGreater(line, pixel)
        rays, work = loads["one of all paths, equal shares"]
        self.assertLess(rays, 1.01)
        self.assertAlmostEqual(work, 1.16, delta=0.04)
        self.assert_page_says("its tests are about 1.16", f"8 / 1.37 = {8 / 1.37:.1f}")

    def test_has_equal_work_for_equal_rays_in_the_scene_of_the_first_ten_minutes(self):
        text = (SOURCE / "docs" / "first-ten-minutes.md").read_text()
        self.write("mine.json", re.search(r"^```json out/mine.json\n(.*?)^```", text, re.DOTALL | re.MULTILINE)[1])
        stats = self.stats("mine.json", "--spp", 16)
        self.assertIn(f"`{stats['hash']}` for the scene above", text)
        loads = self.loads("--scene", "mine.json")
        rays, work = loads["one of all paths, equal shares"]
        self.assertAlmostEqual(rays, work, places=9)
        block, line, pixel = (f"{loads[way][1]:.3f}" for way in WAYS)
        self.assertIn(f"max/mean {block}, lines in turn {line}, pixels in turn {pixel}", " ".join(text.split()))

    def test_is_bound_by_the_number_of_pieces(self):
        lines = self.paths("--threads", 64, "--schedule", "static,1")
        self.assertEqual((lines.count(0), max_over_mean(lines)), (8, 64 / LINES))
        pixels = self.paths("--threads", 64, "--schedule", "static,1", "--grain", "pixel")
        self.assertEqual((max(pixels), min(pixels)), (4 * 88, 4 * 87))
        self.assert_page_says(f"64/56 = {64 / 56:.3f}", f"88 / 87.5 = {88 / 87.5:.3f}")

    def test_is_what_the_cost_image_adds_up_to(self):
        self.run_well("render", *PAPER, "--cost-image", "tests.pfm", "--quiet")
        self.assertEqual(sum(self.pixels("tests.pfm")[2][::3]), sum(map(tests, self.threads("--threads", 4, "--count-work"))))


class Race(LabTest):
    page = "3-race.md"

    def lost(self, race, *arguments):
        mode, total, right, lost = re.fullmatch(r"(\w+): sum (\d+) of (\d+), lost (\d+)\n", race(*arguments)).groups()
        self.assertEqual((mode, int(total) + int(lost)), (arguments[0], int(right)))
        return int(lost)

    def test_loses_additions_and_its_remedies_lose_none(self):
        race = self.compile("race")
        self.assertTrue(any(self.lost(race, "racy", 2) > 0 for _ in range(50)), "no race in 50 runs")
        self.assertEqual(self.lost(race, "racy", 1), 0)
        for threads in (1, 2, 3, 4):
            self.assertEqual(self.lost(race, "halves", threads), 1000 * (threads - 1))
            for mode in ("atomic", "private", "owned"):
                self.assertEqual(self.lost(race, mode, threads), 0, (mode, threads))
        self.assert_page_says("1000 of 2000", "1000 of 4000, lost 3000")

    def test_leaves_no_trace_in_sums_of_integers_and_an_order_in_those_of_floats(self):
        def render(accumulator, *more):
            stats = self.stats("paper", "--width", 100, "--spp", 16, "--accumulator", accumulator, *more, "-o", f"{accumulator}.exr")
            return stats["hash"]

        exact = {render(each, "--threads", threads) for threads in (1, 4)
                 for each in ("owned", "atomic", "private", "owned-planar", "atomic-planar")}
        self.assertEqual(len(exact), 1)
        shared = render("atomic-float", "--threads", 1, "--pool-scope", "shared")
        floats = render("atomic-float", "--threads", 1)
        self.assertEqual(len({*exact, shared, floats}), 3)
        self.assertLess(self.diff("atomic-float.exr", "owned.exr")[2]["RMSE"], 1e-6)
        self.assertNotIn(render("atomic-double", "--threads", 4), exact)
        self.assertEqual(self.diff("atomic-double.exr", "owned.exr")[0], 0)

    def test_is_refused_where_no_thread_owns_a_pixel(self):
        self.assert_refused("render", "paper", "--pool-scope", "shared", "--accumulator", "owned", named="--accumulator")
        self.assert_page_says("raypool render paper --pool-scope shared --accumulator owned")


class PoolCapacity(LabTest):
    page = "4-pool.md"

    def rounds(self, records, refill="drain", threads=2):
        stats = self.stats(*PAPER, "--threads", threads, "--pool-scope", "shared", "--refill", refill, "--camera", "staged",
                           "--pool-rays", records, "--count-work")
        self.assertEqual((stats["hash"], stats["segments"], stats["pool_rays"]), (HASH, SEGMENTS, records))
        self.assertEqual(sum(each["records_in"] for each in stats["rounds"]), SEGMENTS)
        return stats["rounds"], stats["pool_bytes"]

    def test_sets_the_rounds_of_a_pool_that_drains(self):
        found = {}
        for records, said in ((1000, 485), (22400, 51), (100000, 51)):
            rounds, found[records] = self.rounds(records)
            fillings = math.ceil(PATHS / records)
            self.assertEqual((len(rounds), sum(each["records_in"] == 0 for each in rounds)), (said, fillings))
            self.assertEqual(len(rounds), len(self.rounds(records, threads=1)[0]))
        self.assertGreater(found[22400], 10 * found[1000])
        self.rounds(1000)
        self.assertIn("485 rounds, 119.3 records in each of them, 11.9 % of a pool of 1000\n", self.show("stats.json"))
        self.assert_page_says("485 rounds with 1000 records, 51 with 22,400", "119.3 records", "11.9 %", "5.1 %", "23 + 462 = 485")

    def test_is_used_by_a_pool_that_regenerates(self):
        rounds = len(self.rounds(1000, "regenerate")[0])
        self.assertGreaterEqual(rounds, SEGMENTS / 1000)
        self.assertAlmostEqual(rounds, 90, delta=10)
        self.assert_page_says("about 90", "58 rounds at least")

    def test_is_bytes_over_the_size_of_a_record(self):
        for precision, size, said in (("float", 56, 9362), ("double", 96, 5461)):
            stats = self.stats(*PAPER, "--pool-rays", "512KB", "--precision", precision)
            self.assertEqual((stats["record_bytes"], stats["pool_rays"]), (size, said))
            self.assertEqual(said, 512 * 1024 // size)
            self.assert_page_says(f"524,288 / {size} = {said}")

    def test_is_refused_where_it_means_nothing(self):
        self.assert_refused("render", "paper", "--pool-rays", 0, named="--pool-rays")
        self.assert_refused("render", "paper", "--pool-rays", 100, "--engine", "recursive", named="--pool-rays")
        self.assert_refused("render", "paper", "--pool-rays", 2147483647, "--threads", 4096, named="memory")


class FalseSharing(LabTest):
    page = "5-false-sharing.md"

    def test_is_a_matter_of_where_counters_lie(self):
        count = self.compile("false_sharing")
        for mode, threads, lines in (("packed", 2, 1), ("padded", 2, 2), ("local", 2, 1), ("packed", 8, 1), ("packed", 16, 2),
                                     ("padded", 8, 8)):
            self.assertRegex(count(mode, threads), rf"^{mode}: {threads} counters of \d+ bytes on {lines} cache lines, sum 200000000, ")
        self.assertIn("9 counters of 8 bytes on 2 cache lines", count("packed", 9))
        self.assert_page_says("sum 200000000", "8 counters are on 1 cache line, 9 on 2")

    def test_in_the_framebuffer_depends_on_the_grain(self):
        def shared(owner):
            """Cache lines that have pixels of two threads: a pixel is 24 bytes, the first at a cache line."""
            lines = {}
            for pixel in range(100 * LINES):
                for line in range(24 * pixel // 64, (24 * pixel + 23) // 64 + 1):
                    lines.setdefault(line, set()).add(owner(pixel))
            return sum(len(owners) > 1 for owners in lines.values()), len(lines)

        self.assertEqual(shared(lambda pixel: pixel % 2), (2100, 2100))
        self.assertEqual(shared(lambda pixel: pixel // 100 % 2), (28, 2100))
        self.assert_page_says("28 of 2,100", "every one of the 2,100")

    def test_is_kept_from_what_threads_count(self):
        self.assertIn("struct alignas(64) ThreadReport", (SOURCE / "core" / "runtime" / "report.h").read_text())
        self.assertIn("add_integers", (SOURCE / "wavefront" / "integer_accumulators.h").read_text())


class Precision(LabTest):
    page = "6-precision.md"

    def both(self, scene, kind):
        stats = [self.stats(scene, "--width", 100, "--spp", 4, "--precision", precision, "-o", f"{scene}-{precision}.{kind}")
                 for precision in ("float", "double")]
        return *stats, self.diff(f"{scene}-float.{kind}", f"{scene}-double.{kind}")

    def test_does_not_show_where_all_is_one(self):
        single, double, (pixels, of, figures) = self.both("furnace", "exr")
        self.assertEqual((single["hash"], pixels, of, figures["RMSE"]), (double["hash"], 0, 5600, 0))

    def test_is_rounding_in_one_scene_and_other_paths_in_another(self):
        single, double, (pixels, of, figures) = self.both("one_sphere", "exr")
        self.assertNotEqual(single["hash"], double["hash"])
        self.assertEqual((pixels, of, figures["largest ULP"]), (2184, 7500, 4))
        self.assertLess(figures["largest difference"], 1e-6)
        single, double, (pixels, of, figures) = self.both("paper", "pfm")
        self.assertEqual((single["hash"], single["segments"], double["segments"]), (HASH, SEGMENTS, 57824))
        self.assertEqual((pixels, of), (4674, 5600))
        self.assertAlmostEqual(figures["largest difference"], 0.2, delta=0.005)
        self.assert_page_says("2184 of 7500", "4674 of 5600", "57,824", "58 of them by more than 1e-4", "99 %")
        far = self.show("paper-float.pfm", "paper-double.pfm", "1e-4", program="far_pixels.py")
        self.assertRegex(far, r"\A5600 pixels, 4674 differ, 58 of them by more than 0.0001\nthe 20 worst have 99\.\d %")

        self.run_well("render", *PAPER, "--seed", 1, "-o", "seed.pfm", "--quiet")
        noise = self.diff("seed.pfm", "paper-float.pfm")[2]["RMSE"]
        self.assertEqual((f"{noise:.3f}", f"{figures['RMSE']:.4f}", round(noise / figures["RMSE"])), ("0.133", "0.0023", 57))
        self.assert_page_says("0.133", "0.0023", "57 times")

    def test_fixes_the_image_whatever_the_engine_and_the_threads(self):
        hashes = {self.stats(*PAPER, "--precision", "double", "--engine", engine, "--threads", threads)["hash"]
                  for engine in ("recursive", "wavefront") for threads in (1, 4)}
        self.assertEqual(len(hashes), 1)
        self.assertNotIn(HASH, hashes)

    def test_is_refused_where_there_is_none_such(self):
        self.assert_refused("render", "paper", "--precision", "half", named="--precision")
        self.assert_refused("render", "paper", "--precision", "double", "--engine", "gpu", named="--precision")


if __name__ == "__main__":
    main()
