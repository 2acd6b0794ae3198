"""More memory and more threads than there are: one line that says what was asked for and what there is, exit status 2, and
nothing that was there is lost. And fewer threads than OpenMP was asked for by other means."""

import resource
import unittest

from command import CommandTest, main

WAVEFRONT = ("--engine", "wavefront")


def needs_plain_memory(test):
    """Skips the test for a command with a sanitizer, which takes terabytes of addresses for itself."""
    def run(self):
        with open(self.command, "rb") as binary:
            if b"__asan_init" in (content := binary.read()) or b"__tsan_init" in content:
                raise unittest.SkipTest("a sanitizer takes the address space")
        test(self)

    return run


class Memory(CommandTest):
    POOLS = (
        (*WAVEFRONT, "--pool-rays", "2000000000", "--threads", 16),
        (*WAVEFRONT, "--pool-rays", "2000000000", "--threads", 16, "--pool-scope", "shared"),
        (*WAVEFRONT, "--pool-rays", "2000000000", "--threads", 16, "--pool-scope", "shared", "--append", "prefix-sum"),
    )

    def test_of_pools_that_there_is_not_is_refused_and_no_file_is_lost(self):
        self.run_well("render", "scene.json", "--spp", 2, "-o", "out.pfm", "--stats", "stats.json", "--quiet")
        for pool in self.POOLS:
            self.assert_refused("render", "scene.json", "--spp", 2, "-o", "out.pfm", "--stats", "stats.json", *pool,
                                named=["--pool-rays", " GB"])

    def test_of_pools_that_there_is_not_leaves_a_checkpoint_as_it_was(self):
        render = ("render", "scene.json", "--spp", 4, "--checkpoint", "kept.sums")
        self.run_well(*render, "--samples", "0:2", "--quiet")
        for pool in self.POOLS:
            self.assert_refused(*render, "--resume", *pool, named="--pool-rays")
        resumed = self.run_well(*render, "--resume")
        whole = self.run_well("render", "scene.json", "--spp", 4)
        self.assertEqual(resumed.stdout.split()[-1], whole.stdout.split()[-1])

    def test_of_threads_accumulators_is_refused(self):
        self.assert_refused("render", "paper", "--width", 8000, "--spp", 1, *WAVEFRONT, "--accumulator", "private",
                            "--threads", 256, named=["--accumulator", " GB"])

    @needs_plain_memory
    def test_that_a_limit_does_not_leave_is_refused(self):
        def limit():
            resource.setrlimit(resource.RLIMIT_AS, (2 << 30, 2 << 30))

        for arguments, named in (((*WAVEFRONT, "--pool-rays", "1GB", "--threads", 2), "--pool-rays"),
                                 (("--width", 20000), "--width"),
                                 (("--width", 9000, "--cost-image", "cost.pfm"), "--width")):
            self.assert_refused("render", "paper", "--spp", 1, *arguments, named=[named, " GB"], preexec_fn=limit)


class Threads(CommandTest):
    def test_beyond_those_that_openmp_gives_are_refused_by_every_command_that_takes_them(self):
        for command in (("render", "scene.json"), ("compare", "scene.json", "--check"),
                        ("advise", "scene.json", "--target-error", 0.1)):
            self.assert_refused(*command, "--threads", 3, environment={"OMP_THREAD_LIMIT": "2"},
                                named=["--threads", "OMP_THREAD_LIMIT"])
            self.assert_refused(*command, environment={"OMP_THREAD_LIMIT": "2", "OMP_NUM_THREADS": "3"},
                                named=["OMP_NUM_THREADS", "OMP_THREAD_LIMIT"])

    @needs_plain_memory
    def test_that_the_system_does_not_create_are_refused_with_what_would_help(self):
        def limit():
            resource.setrlimit(resource.RLIMIT_AS, (4 << 30, 4 << 30))

        for command in (("render", "scene.json"), ("compare", "scene.json", "--check")):
            self.assert_refused(*command, "--threads", 4, environment={"OMP_STACKSIZE": "2G"}, preexec_fn=limit,
                                named=["--threads", "OMP_STACKSIZE", "ulimit"])

    def test_are_all_there_where_openmp_might_give_fewer(self):
        for variables in ({"OMP_DYNAMIC": "true"}, {"OMP_MAX_ACTIVE_LEVELS": "1"}, {"OMP_NESTED": "true"}):
            for engine in ("recursive", "iterative", "wavefront"):
                stats = self.stats("--spp", 2, "--engine", engine, "--threads", 6, environment=variables)
                self.assertEqual(len(stats["threads"]), 6)
                render_s = stats["seconds"]["render"] - stats["seconds"]["setup"]
                for thread in stats["threads"]:
                    self.assertGreater(thread["busy_s"], 0)
                    self.assertAlmostEqual(thread["busy_s"] + thread["wait_s"], render_s, delta=1e-6 * 10)


if __name__ == "__main__":
    main()
