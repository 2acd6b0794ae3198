"""Checkpoints, parts and what happens to them: a render ends in the same bits, or says why it does not.

RAYPOOL_KILLS=50 kills a render so many times (a few, where it is not set).
"""

import collections
import ctypes
import ctypes.util
import json
import os
import random
import signal
import time

from checkpoint_case import RENDER, SMALL, CheckpointCase, render, small
from command import main

STOPS = ("SIGINT", "SIGTERM", "SIGHUP", "SIGUSR1", "SIGUSR2", "SIGXCPU")


def xxhash(content):
    """The 16 hexadecimal digits of XXH3."""
    library = ctypes.CDLL(ctypes.util.find_library("xxhash"))
    library.XXH3_64bits.restype = ctypes.c_uint64
    library.XXH3_64bits.argtypes = (ctypes.c_char_p, ctypes.c_size_t)
    return f"{library.XXH3_64bits(content, len(content)):016x}".encode()


class CheckpointTest(CheckpointCase):
    def test_signal_leaves_a_checkpoint_and_a_picture_and_says_how_to_go_on(self):
        expected = self.whole()
        for number, status in ((signal.SIGINT, 130), (signal.SIGTERM, 143)):
            (self.folder / "c.sums").unlink(missing_ok=True)
            process = self.start(*RENDER, "--checkpoint", "c.sums", "-o", "part.pfm")
            self.wait_for("c.sums", process)
            process.send_signal(number)
            _, error = process.communicate(timeout=60)
            self.assertEqual(process.returncode, status)
            self.assertIn("--resume", error)
            self.assertTrue((self.folder / "part.pfm").exists())
            for engine in ("wavefront", "iterative"):
                result = self.run_well(*render(threads=3, engine=engine), "--checkpoint", "c.sums", "--resume")
                self.assertEqual(self.hash_of(result), expected)

    def test_every_signal_of_a_terminal_or_a_batch_system_ends_with_the_checkpoint(self):
        for name in STOPS:
            with self.subTest(name):
                number = getattr(signal, name)
                (self.folder / "c.sums").unlink(missing_ok=True)
                process = self.start(*render(spp=100000), "--checkpoint", "c.sums", "-o", "part.pfm")
                self.wait_for("c.sums", process)
                process.send_signal(number)
                process.send_signal(number)  # as `timeout` does, which signals the process and its group
                _, error = process.communicate(timeout=60)
                self.assertEqual(process.returncode, 128 + number, error)
                self.assertEqual((error.count("raypool: "), error.count("--resume")), (1, 1), error)
                (self.folder / "part.pfm").unlink()
                self.assertEqual(set(self.listing()), {"c.sums", "scene.json"})

    def test_signal_that_was_ignored_stays_ignored(self):
        """As nohup asks for SIGHUP, and a shell for a background job's SIGINT."""
        def ignore():
            for name in STOPS:
                signal.signal(getattr(signal, name), signal.SIG_IGN)

        process = self.start(*RENDER, "--checkpoint", "c.sums", preexec_fn=ignore)
        self.wait_for("c.sums", process)
        for name in STOPS:
            process.send_signal(getattr(signal, name))
        said, _ = process.communicate(timeout=60)
        self.assertEqual(process.returncode, 0)
        self.assertEqual(said.split("hash ")[1].split()[0], self.whole())

    def test_second_signal_ends_at_once_with_the_last_checkpoint_whole(self):
        process = self.start(*render(spp=100000), "--checkpoint", "c.sums")
        self.wait_for("c.sums", process)
        process.send_signal(signal.SIGINT)
        time.sleep(0.3)
        process.send_signal(signal.SIGTERM)
        process.communicate(timeout=60)
        self.assertIn(process.returncode, (-signal.SIGTERM, 130))
        self.run_command("merge", "c.sums", "--checkpoint", "copy.sums")
        self.assertTrue((self.folder / "copy.sums").exists())

    def test_kill_at_any_moment_loses_nothing_that_was_kept(self):
        expected = self.whole()
        chance = random.Random(1)
        kills = int(os.environ.get("RAYPOOL_KILLS", "4"))
        lost = wrong = 0
        for _ in range(kills):
            (self.folder / "c.sums").unlink(missing_ok=True)
            for _ in range(3):
                more = ("--resume",) if (self.folder / "c.sums").exists() else ()
                process = self.start(*RENDER, "--checkpoint", "c.sums", *more)
                time.sleep(chance.uniform(0, 0.25))
                process.kill()
                process.communicate(timeout=60)
            more = ("--resume",) if (self.folder / "c.sums").exists() else ()
            result = self.run_command(*RENDER, "--checkpoint", "c.sums", *more)
            lost += result.returncode != 0
            wrong += result.returncode == 0 and self.hash_of(result) != expected
        self.note("kill -9, three times a render", kills, lost, wrong)

    def test_adaptive_render_goes_on_where_it_was(self):
        adaptive = ("render", "half_sky", "--width", "100", "--target-error", "0.002", "--spp", "20000")
        expected = self.hash_of(self.run_well(*adaptive))
        process = self.start(*adaptive, "--checkpoint", "a.sums")
        self.wait_for("a.sums", process)
        process.kill()
        process.communicate()
        result = self.run_well(*adaptive, "--checkpoint", "a.sums", "--resume", "--engine", "wavefront")
        self.assertEqual(self.hash_of(result), expected)
        self.assert_refused("merge", "a.sums", named=["a.sums", "adaptive"])

    def test_finished_render_is_extended_to_the_bits_of_a_longer_one(self):
        expected = self.hash_of(self.run_well(*small(sampler="sobol"), "-o", "whole.pfm"))
        for engines in (("recursive", "wavefront"), ("wavefront", "iterative"), ("iterative", "recursive")):
            (self.folder / "c.sums").unlink(missing_ok=True)
            self.run_well(*small(sampler="sobol", engine=engines[0], spp=64), "--checkpoint", "c.sums")
            result = self.run_well(*small(sampler="sobol", engine=engines[1]), "--checkpoint", "c.sums", "--resume", "-o", "more.pfm")
            self.assertEqual(self.hash_of(result), expected)
            self.assertEqual((self.folder / "more.pfm").read_bytes(), (self.folder / "whole.pfm").read_bytes())

    def test_parts_planned_with_different_spp_add_up_and_can_be_extended(self):
        expected = self.hash_of(self.run_well(*SMALL))
        self.run_well(*small(spp=20), "--samples", "0:20", "--checkpoint", "a.sums")
        self.run_well(*small(spp=100), "--samples", "20:40", "--checkpoint", "b.sums")
        self.run_well(*SMALL, "--samples", "20:170", "--checkpoint", "b.sums", "--resume")
        self.run_well(*SMALL, "--samples", "170:300", "--checkpoint", "c.sums")
        for parts in (("a.sums", "b.sums", "c.sums"), ("c.sums", "a.sums", "b.sums")):
            self.assertEqual(self.hash_of(self.run_well("merge", *parts)), expected)
        result = self.run_command("merge", "b.sums", "a.sums", "--checkpoint", "ab.sums")
        self.assertIn("170 to 300 are missing", result.stderr)
        self.assertEqual(self.hash_of(self.run_well(*SMALL, "--checkpoint", "ab.sums", "--resume")), expected)

    def test_parts_of_a_render_with_light_sampling_are_the_whole(self):
        lamp = ("render", "small_lamp", "--width", 32, "--spp", 12, "--light-sampling", "mis")
        expected = self.hash_of(self.run_well(*lamp))
        self.run_well(*lamp, "--samples", "0:5", "--checkpoint", "a.sums", "--engine", "recursive")
        self.run_well(*lamp, "--samples", "5:12", "--checkpoint", "b.sums", "--engine", "wavefront")
        self.assertEqual(self.hash_of(self.run_well("merge", "b.sums", "a.sums")), expected)
        self.assert_refused(*lamp[:-1], "none", "--checkpoint", "a.sums", "--resume", named=["a.sums", "light_sampling"])
        self.assertEqual(self.hash_of(self.run_well(*lamp, "--checkpoint", "a.sums", "--resume")), expected)

    def test_samples_that_cannot_be_extended_exactly_are_refused(self):
        self.run_well(*small(spp=64), "--checkpoint", "c.sums")
        resume = ("--checkpoint", "c.sums", "--resume")
        self.assert_refused(*small(spp=63), *resume, named=["c.sums", "0 to 64", "--spp"])
        self.assert_refused(*small(spp=16385), *resume, named=["c.sums", "16384", "32768", "--spp 16385"])
        tiny = ("render", "scene.json", "--width", 2)
        self.run_command(*tiny, "--spp", 20000, "--samples", "0:1", "--checkpoint", "d.sums")
        self.run_well(*tiny, "--spp", 32768, "--samples", "0:2", "--checkpoint", "d.sums", "--resume")
        self.assert_refused(*tiny, "--spp", 10, "--checkpoint", "d.sums", "--resume", named=["d.sums", "32768"])

    def test_adaptive_render_is_not_extended(self):
        """Which samples it takes depends on what it may take in all, and on its target."""
        adaptive = {"width": 40, "threads": 2, "spp": 20, "target-error": 0.005}
        self.run_command(*render(**adaptive), "--checkpoint", "a.sums")
        for option, value in (("spp", 40), ("target-error", 0.001)):
            self.assert_refused(*render(**{**adaptive, option: value}), "--checkpoint", "a.sums", "--resume",
                                named=["a.sums", option.replace("-", "_"), str(value)])

    def test_second_render_with_the_same_checkpoint_is_refused_until_the_first_has_gone(self):
        (self.folder / "scratch").mkdir()
        (self.folder / "link.sums").symlink_to("scratch/c.sums")
        process = self.start(*render(spp=100000), "--checkpoint", "link.sums")
        deadline = time.monotonic() + 60
        while not list((self.folder / "scratch").glob(".raypool-*.lock")):
            self.assertLess(time.monotonic(), deadline)
            time.sleep(0.01)
        for more in ((), ("--resume",)):  # before there is a checkpoint, and later
            result = self.run_command(*render(spp=100000), "--checkpoint", "scratch/c.sums", *more)
            self.assert_one_line(result, 2, "c.sums")
            self.wait_for("scratch/c.sums", process)
        self.assert_one_line(result, 2, "c.sums", "another raypool")
        self.assert_one_line(self.run_command("merge", "link.sums", "--checkpoint", "scratch/c.sums"), 2, "c.sums")
        process.kill()
        process.communicate()
        self.assertTrue((self.folder / "link.sums").is_symlink())
        process = self.start(*render(spp=100000), "--checkpoint", "link.sums", "--resume")
        time.sleep(0.1)
        process.terminate()
        self.assertIn("goes on from there", process.communicate(timeout=60)[1])

    def test_plain_tasks_of_a_launcher_are_refused_unless_each_has_its_own_samples(self):
        slurm = {"SLURM_STEP_NUM_TASKS": "4", "SLURM_NTASKS": "4", "SLURM_PROCID": "1"}
        self.assert_refused("render", "scene.json", "-o", "a.png", named=["4 tasks", "--samples", "mpi"], environment=slurm)
        self.run_well("render", "scene.json", "--samples", "0:1", environment=slurm)
        self.run_well("info", "scene.json", environment=slurm)
        for command in (("compare", "scene.json"), ("advise", "scene.json", "--target-error", 1), ("study", "load")):
            self.assert_refused(*command, named=["4 tasks", command[0]], environment=slurm)
        self.run_well("render", "scene.json", environment={**slurm, "SLURM_STEP_NUM_TASKS": "1"})
        self.run_well("render", "scene.json", environment={"SLURM_NTASKS": "4"})  # a batch script runs once

    def test_parts_in_any_order_are_the_whole(self):
        expected = self.whole()
        parts = ["0:100", "100:101", "101:260", "260:300"]
        for part, engine in zip(parts, ("recursive", "wavefront", "iterative", "wavefront")):
            self.run_well(*RENDER, "--samples", part, "--engine", engine, "--checkpoint", f"{part}.sums")
        for order in (parts, parts[::-1], [parts[2], parts[0], parts[3], parts[1]]):
            result = self.run_well("merge", *(f"{part}.sums" for part in order), "-o", "merged.pfm")
            self.assertEqual(self.hash_of(result), expected)
        self.run_well(*RENDER, "-o", "whole.pfm")
        self.assertEqual((self.folder / "merged.pfm").read_bytes(), (self.folder / "whole.pfm").read_bytes())

        result = self.run_command("merge", "0:100.sums", "260:300.sums")
        self.assertEqual(result.returncode, 1)
        self.assertIn("100 to 260 are missing", result.stderr)
        self.assert_refused("merge", "0:100.sums", "0:100.sums", named=["0:100.sums", "there already"])
        self.assert_refused("merge", "0:100.sums", "--checkpoint", "260:300.sums", named=["260:300.sums", "there already"])
        self.run_well(*RENDER, "--seed", 1, "--samples", "100:300", "--checkpoint", "other.sums")
        self.assert_refused("merge", "0:100.sums", "other.sums", named=["other.sums", "seed"])

    def test_complete_checkpoint_is_the_image_and_says_that_nothing_was_missing(self):
        first = self.run_well(*RENDER, "--checkpoint", "c.sums", "-o", "a.pfm")
        again = self.run_well(*RENDER, "--checkpoint", "c.sums", "--resume", "-o", "b.pfm", "--stats", "s.json")
        self.assertEqual(self.hash_of(again), self.hash_of(first))
        self.assertIn("no sample was missing", again.stdout)
        self.assertNotIn("nan", again.stdout)
        self.assertEqual((self.folder / "a.pfm").read_bytes(), (self.folder / "b.pfm").read_bytes())
        stats = json.loads((self.folder / "s.json").read_text())
        self.assertEqual((stats["paths"], stats["samples_done"]), (0, 300))

    def test_file_that_lies_about_its_sums_is_refused(self):
        """Its checksum is right, its key too; its sums are another image's."""
        self.run_well(*render(width=60), "--samples", "0:1", "--checkpoint", "small.sums")
        self.run_well(*RENDER, "--samples", "1:2", "--checkpoint", "good.sums")
        small = (self.folder / "small.sums").read_bytes()
        header = json.loads(small.split(b"\n", 1)[0])
        header["key"] = json.loads((self.folder / "good.sums").read_bytes().split(b"\n", 1)[0])["key"]
        forged = json.dumps(header).encode() + b"\n" + small.split(b"\n", 1)[1][:-16]
        checksum = xxhash(forged)
        (self.folder / "forged.sums").write_bytes(forged + checksum)
        self.assert_refused("merge", "good.sums", "forged.sums", named=["forged.sums", "its sums"])
        self.assert_refused(*RENDER, "--checkpoint", "forged.sums", "--resume", named=["forged.sums", "its sums"])

    def test_what_never_ends_is_not_read(self):
        for path in ("/dev/zero", "."):
            self.assert_refused("merge", path, named=path, timeout=20)

    def test_trace_of_a_render_in_pieces_has_all_of_them(self):
        for options, passes in (((*RENDER, "--checkpoint", "c.sums"), 3), (render(**{"target-error": 0.02}), 2)):
            self.run_well(*options, "--engine", "recursive", "--grain", "line", "--trace", "t.json")
            events = json.loads((self.folder / "t.json").read_text())["traceEvents"]
            lines = collections.Counter(event["args"]["y"] for event in events if event.get("name") == "line")
            self.assertGreaterEqual(max(lines.values()), passes)  # of an adaptive render: a line that got more samples

    def test_what_makes_no_sense_is_refused(self):
        self.run_well(*RENDER, "--samples", "0:1", "--checkpoint", "c.sums")
        self.assert_refused(*RENDER, "--checkpoint", "c.sums", named=["c.sums", "--resume"])
        self.assert_refused(*RENDER, "--resume", named="--checkpoint")
        self.assert_refused(*RENDER, "--samples", "5:9", "--checkpoint", "c.sums", "--resume",
                            named=["c.sums", "0 to 1", "--samples"])
        for setting, value in (("seed", 5), ("depth", 7), ("width", 121), ("split-depth", 1),
                               ("precision", "double"), ("sampler", "sobol"), ("target-error", 0.1)):
            self.assert_refused(*render(**{setting: value}), "--checkpoint", "c.sums", "--resume",
                                named=["c.sums", setting.replace("-", "_")])
        self.assert_refused("render", "cornell", *RENDER[2:], "--checkpoint", "c.sums", "--resume", named="scene")
        (self.folder / "bad.sums").write_text("{}\n")
        self.assert_refused("merge", "bad.sums", named="bad.sums")
        self.assert_refused(*RENDER, "--checkpoint", "absent/c.sums", named="absent")


if __name__ == "__main__":
    main()
