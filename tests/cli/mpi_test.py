"""Several ranks make the image of one process, and lose nothing that a checkpoint holds."""

import itertools
import json
import os
import re
import signal
import subprocess
import time

from command import CommandTest, main

SETTINGS = {  # as any user, on fewer cores than ranks
    "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
    "OMPI_MCA_rmaps_base_oversubscribe": "1", "OMPI_MCA_mpi_yield_when_idle": "1",
    "OMPI_MCA_hwloc_base_binding_policy": "none", "OMP_WAIT_POLICY": "passive",
}
PAPER = ("render", "paper", "--width", 160, "--spp", 60)
LONG = ("render", "paper", "--width", 160, "--spp", 400)
ENDLESS = ("render", "paper", "--width", 160, "--spp", 40000)


class MpiTest(CommandTest):
    def ranks(self, count, *arguments, environment=None, **keywords):
        return subprocess.run(
            ["mpirun", "-n", str(count), self.command, *map(str, arguments)], cwd=self.folder, text=True, timeout=60,
            env={**os.environ, **SETTINGS, **(environment or {})}, capture_output=True, stdin=subprocess.DEVNULL,
            check=False, **keywords)

    def hash_of(self, result):
        self.assertEqual((result.returncode, result.stdout.count("hash ")), (0, 1), result.stderr)
        return result.stdout.split("hash ")[1].split()[0]

    def alone(self, *arguments):
        return self.hash_of(self.run_well(*arguments))

    def start(self, count, *arguments):
        """mpirun, with a checkpoint c.sums after every piece, and the processes of the ranks once it is there."""
        process = subprocess.Popen(
            ["mpirun", "-n", str(count), self.command, *map(str, arguments), "--checkpoint", "c.sums", "--every", "0"],
            cwd=self.folder, env={**os.environ, **SETTINGS}, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.addCleanup(process.terminate)
        while not (self.folder / "c.sums").exists():
            self.assertIsNone(process.poll(), "ended before its first checkpoint")
            time.sleep(0.01)
        children = f"/proc/{process.pid}/task/{process.pid}/children"
        with open(children) as file:
            ranks = [int(child) for child in file.read().split()]
        self.assertEqual(len(ranks), count)
        return process, sorted(ranks)

    def test_any_ranks_threads_and_engine_make_one_hash(self):
        expected = self.alone(*PAPER)
        for count, threads, engine in itertools.product((1, 2, 3, 5), (1, 2), ("recursive", "wavefront")):
            result = self.ranks(count, *PAPER, "--threads", threads, "--engine", engine)
            self.assertEqual(self.hash_of(result), expected, result.args)

    def test_adaptive_render_makes_one_hash(self):
        adaptive = ("render", "half_sky", "--width", 100, "--target-error", 0.003, "--spp", 5000, "--threads", 1)
        expected = self.alone(*adaptive)
        for count in (2, 3):
            self.assertEqual(self.hash_of(self.ranks(count, *adaptive)), expected)
        process, ranks = self.start(2, *adaptive)
        os.kill(ranks[1], signal.SIGKILL)
        process.communicate(timeout=60)
        result = self.ranks(3, *adaptive, "--checkpoint", "c.sums", "--resume")
        self.assertEqual(self.hash_of(result), expected)

    def test_target_error_that_is_missed_is_said_once_after_all_is_written(self):
        result = self.ranks(2, "render", "scene.json", "--target-error", 1e-6, "--spp", 20, "--threads", 1, "-o", "a.pfm")
        self.assertEqual((result.returncode, result.stderr.count("raypool: ")), (1, 1), result.stderr)
        self.assertIn("raypool: --target-error 1e-06 is not reached", result.stderr)
        self.assertTrue(result.stdout.endswith("\na.pfm\n"))

    def test_parts_of_different_ranks_add_up(self):
        expected = self.alone(*PAPER)
        parts = {"0:25": 3, "25:26": 2, "26:60": 1}
        for part, count in parts.items():
            self.hash_of(self.ranks(count, *PAPER, "--threads", 1, "--samples", part, "--checkpoint", f"{part}.sums"))
        for order in itertools.permutations(parts):
            self.assertEqual(self.alone("merge", *(f"{part}.sums" for part in order)), expected)

    def test_rank_that_dies_ends_the_job_and_the_checkpoint_goes_on_with_other_ranks(self):
        expected = self.alone(*LONG)
        for victim in (0, 2):
            (self.folder / "c.sums").unlink(missing_ok=True)
            process, ranks = self.start(3, *LONG, "--threads", 1)
            os.kill(ranks[victim], signal.SIGKILL)
            _, error = process.communicate(timeout=60)
            self.assertNotEqual(process.returncode, 0)
            self.assertRegex(error, f"process rank {victim} .* signal 9")
            if victim != 0:
                self.assertRegex(error, r"c\.sums holds at least \d+ samples a pixel: the same command with --resume")
            kept = (self.folder / "c.sums").read_bytes()
            self.assertEqual(self.alone(*LONG, "--checkpoint", "c.sums", "--resume"), expected)
            (self.folder / "c.sums").write_bytes(kept)
            resumed = self.ranks(2, *LONG, "--threads", 1, "--checkpoint", "c.sums", "--resume", "--stats", "s.json")
            self.assertEqual(self.hash_of(resumed), expected)
            stats = json.loads((self.folder / "s.json").read_text())
            self.assertEqual(stats["samples_done"], 400)
            self.assertLess(stats["paths"], 400 * 160 * 90)

    def test_signal_to_one_rank_stops_all_with_a_checkpoint(self):
        process, ranks = self.start(2, *LONG, "--threads", 1, "-o", "part.pfm")
        os.kill(ranks[1], signal.SIGINT)
        _, error = process.communicate(timeout=60)
        self.assertEqual(process.returncode, 130)
        self.assertIn("stopped; c.sums holds", error)
        self.assertTrue((self.folder / "part.pfm").exists())
        self.assertEqual(self.alone(*LONG, "--checkpoint", "c.sums", "--resume"), self.alone(*LONG))

    def test_signal_to_mpirun_is_answered_once_and_truly(self):
        """On SIGTERM mpirun ends the ranks, and exits 1 whatever they do; it hands SIGUSR1 on, and exits as they do."""
        for number, status in ((signal.SIGTERM, 1), (signal.SIGUSR1, 138)):
            (self.folder / "c.sums").unlink(missing_ok=True)
            process, _ = self.start(2, *ENDLESS, "--threads", 1)
            process.send_signal(number)
            _, error = process.communicate(timeout=60)
            self.assertEqual(process.returncode, status, error)
            said = [line for line in error.splitlines() if line.startswith("raypool: ")]
            self.assertEqual(len(said), 1, error)
            least = int(re.search(r"c\.sums holds (?:at least )?(\d+) samples a pixel: the same command", said[0])[1])
            ranges = json.loads((self.folder / "c.sums").read_bytes().split(b"\n", 1)[0])["ranges"]
            self.assertGreaterEqual(ranges[0][1], least)

    def test_ranks_that_mpi_does_not_join_are_refused(self):
        """As under srun --mpi=pmi2 with an MPI that does not speak it: each would be one rank of one."""
        result = self.run_command("render", "scene.json", environment={**SETTINGS, "PMI_RANK": "0", "PMI_SIZE": "3"})
        self.assert_one_line(result, 2, "3 ranks")

    def test_second_job_with_the_same_checkpoint_is_refused(self):
        process, _ = self.start(2, *ENDLESS, "--threads", 1)
        result = self.ranks(2, *ENDLESS, "--threads", 1, "--checkpoint", "c.sums", "--resume")
        self.assertEqual((result.returncode, result.stderr.count("raypool: ")), (2, 1), result.stderr)
        self.assertIn("c.sums: another raypool is at work on it", result.stderr)
        process.send_signal(signal.SIGTERM)
        process.communicate(timeout=60)

    def test_checkpoint_is_extended_by_ranks_to_the_bits_of_a_longer_render(self):
        expected = self.alone(*PAPER)
        self.hash_of(self.ranks(2, *PAPER[:4], "--spp", 20, "--threads", 1, "--checkpoint", "c.sums"))
        resumed = self.ranks(3, *PAPER, "--threads", 1, "--checkpoint", "c.sums", "--resume")
        self.assertEqual(self.hash_of(resumed), expected)

    def test_slow_rank_gets_less_work(self):
        result = self.ranks(2, *LONG, "--threads", 1, "--stats", "s.json", "-o", "a.pfm",
                            environment={"RAYPOOL_SLOW_RANK": "1:8"})
        self.assertEqual(self.hash_of(result), self.alone(*LONG, "-o", "b.pfm"))
        self.assertEqual((self.folder / "a.pfm").read_bytes(), (self.folder / "b.pfm").read_bytes())
        stats = json.loads((self.folder / "s.json").read_text())
        fast, slow = stats["ranks"]
        self.assertLess(slow["paths"], fast["paths"] / 2)
        self.assertEqual(fast["paths"] + slow["paths"], 400 * 160 * 90)
        self.assertEqual(stats["paths"], 400 * 160 * 90)
        self.assertEqual([len(stats["threads"]), fast["threads"], slow["threads"]], [2, 1, 1])
        self.assertEqual(sum(thread["segments"] for thread in stats["threads"]), stats["segments"])

    def test_error_is_said_once_and_ends_all(self):
        cases = [
            (("render", "absent.json"), 2, "absent.json"),
            (("render", "paper", "--spp", 0), 2, "--spp"),
            (("render", "paper", "--trace", "t.json"), 2, "--trace"),
            (("render", "paper", "--aovs", "-o", "a.exr"), 2, "--aovs"),
            (("render", "paper", "--engine", "recursive", "--depth", 1000000), 2, "--depth"),
            (("render", "paper", "--spp", 1, "-o", "absent/a.png"), 2, "absent/a.png"),
            (("render", "scene.json", "--spp", 1, "--checkpoint", "/dev/full"), 2, "/dev/full"),
            (("merge", "a.sums"), 2, "render"),
            (("render", "scene.json", "--checkpoint", "scene.json", "--resume"), 2, "scene.json"),
        ]
        for arguments, status, named in cases:
            result = self.ranks(3, *arguments)
            self.assertEqual((result.returncode, result.stdout), (status, ""), result.stderr)
            self.assertEqual(result.stderr.count("raypool: "), 1, result.stderr)
            self.assertIn(named, result.stderr.split("raypool: ")[1].split("\n")[0])
        result = self.ranks(2, *LONG, environment={"RAYPOOL_SLOW_RANK": "fast"})
        self.assertEqual((result.returncode, result.stderr.count("raypool: ")), (2, 1))

    def ranks_of(self, *ranks, **keywords):
        """One rank for each list of arguments."""
        command = ["mpirun"]
        for arguments in ranks:
            command += [*([":"] if len(command) > 1 else []), "-n", "1", self.command, *map(str, arguments)]
        return subprocess.run(command, cwd=self.folder, text=True, timeout=60, env={**os.environ, **SETTINGS},
                              capture_output=True, stdin=subprocess.DEVNULL, check=False, **keywords)

    def assert_ranks_refused(self, *ranks, named):
        """One line from rank 0, exit 2, nothing written; and no rank that waits for another until the time is up."""
        before = self.listing()
        result = self.ranks_of(*ranks)
        self.assertEqual((result.returncode, result.stdout), (2, ""), f"{ranks}: {result.stderr}")
        self.assertEqual(result.stderr.count("raypool: "), 1, result.stderr)
        self.assertTrue(result.stderr.split("raypool: ")[1].startswith(named), result.stderr)
        self.assertEqual(self.listing(), before, ranks)

    def test_ranks_that_would_not_render_the_same_are_refused(self):
        def render(*more, width=100, spp=64):
            return ("render", "paper", "--width", width, "--spp", spp, "--threads", 1, *more)

        same, help_of_it = render(), ("render", "--help")
        kept, adaptive = render("--checkpoint", "c.sums"), render("--target-error", 0.1)
        inexact = render("--engine", "wavefront", "--accumulator", "atomic-float")
        cases = [  # the rest of what fixes the image comes from the list that checkpoints compare (checkpoint_test.py)
            (same, render("--seed", 5), "seed 5, not 0"),
            (same, render(width=101), "width 101, not 100"),
            (same, render(spp=65), "spp 65, not 64"),
            (same, render("--precision", "double"), "precision double, not float"),
            (same, render("--samples", "0:32"), "samples 0:32, not 0:64"),
            (same, adaptive, "target_error 0.1, not 0"),
            (adaptive, same, "target_error 0, not 0.1"),
            (same, kept, "checkpoint a file, not none"),
            (kept, same, "checkpoint none, not a file"),
            (kept, (*kept, "--resume"), "resume on, not off"),
            (same, render("-o", "a.png"), "output a file, not none"),
            (same, render("--count-work"), "count_work on, not off"),
            (same, inexact, "accumulator atomic-float, not exact"),
            (same, help_of_it, "command help, not render"),
            (help_of_it, same, "command render, not help"),
        ]
        for first, second, named in cases:
            self.assert_ranks_refused(first, second, named=f"rank 1 of 2 differs from rank 0: {named}")

    def test_another_scene_of_the_same_name_is_refused(self):
        script = 'if [ "$OMPI_COMM_WORLD_RANK" = 1 ]; then cd elsewhere; fi; exec "$@"'
        (self.folder / "elsewhere").mkdir()
        scene = (self.folder / "scene.json").read_text()
        (self.folder / "elsewhere/scene.json").write_text(scene.replace("1.5", "1.6"))
        command = ["mpirun", "-n", "3", "sh", "-c", script, "sh", self.command, "render", "scene.json", "--spp", "4",
                   "--checkpoint", "c.sums"]
        result = subprocess.run(command, cwd=self.folder, env={**os.environ, **SETTINGS}, capture_output=True,
                                text=True, timeout=60, check=False)
        self.assertEqual((result.returncode, result.stdout), (2, ""), result.stderr)
        self.assertRegex(result.stderr, "raypool: rank 1 of 3 differs from rank 0: scene [0-9a-f]+, not [0-9a-f]+\n")
        self.assertFalse((self.folder / "c.sums").exists())

    def test_what_shows_in_no_image_may_differ_between_ranks(self):
        expected = self.alone(*PAPER)
        result = self.ranks_of((*PAPER, "--threads", 1, "--checkpoint", "c.sums", "--every", 0),
                               (*PAPER, "--threads", 2, "--engine", "wavefront", "--checkpoint", "d.sums", "--quiet"))
        self.assertEqual(self.hash_of(result), expected)
        self.assertFalse((self.folder / "d.sums").exists())

    def test_ranks_that_fail_before_they_begin_end_all_with_one_line(self):
        same = ("render", "scene.json", "--spp", 4, "--threads", 1, "-o", "a.pfm")
        for other, named in [
            (("render", "absent.json", *same[2:]), "rank 1 of 3: absent.json: no such file"),
            ((*same, "--odd"), "rank 1 of 3: The following argument was not expected: --odd"),
            (("info", "scene.json"), "rank 1 of 3: several ranks can only run the command render"),
            ((*same, "--samples", "0:9"), "rank 1 of 3: --samples: must be A:B with 0 <= A < B <= spp (4), got 0:9"),
        ]:
            self.assert_ranks_refused(same, other, (*same, "--seed", "x"), named=named)
        self.assert_ranks_refused((*same, "--spp", 0), ("render", "absent.json"), same,
                                  named="--spp: Value 0 not in range")

    def test_error_of_one_rank_names_it_and_ends_all(self):
        script = 'if [ "$OMPI_COMM_WORLD_RANK" = 1 ]; then ulimit -s 256; fi; exec "$@"'
        command = ["mpirun", "-n", "2", "sh", "-c", script, "sh", self.command, "render", "paper", "--spp", "100",
                   "--engine", "recursive", "--depth", "5000", "--threads", "1"]
        result = subprocess.run(command, cwd=self.folder, env={**os.environ, **SETTINGS}, capture_output=True,
                                text=True, timeout=60, check=False)
        self.assertEqual(result.returncode, 2, result.stderr)
        self.assertRegex(result.stderr, "raypool: rank 1 of 2: --depth")


if __name__ == "__main__":
    main()
