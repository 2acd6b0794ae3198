"""Recursion: the greatest depth that a render accepts runs, and a greater one is refused and does not crash.

Inside a closed mirror or a white ball every path reaches the depth, so every stack is used as far as it may be.
"""

import re

from command import SCENE, CommandTest, changed, main

INSIDE = {
    **SCENE,
    "image": {"width": 4, "height": 3},
    "camera": {"look_from": [0, 0.25, 0], "look_at": [1, 0, 0], "vertical_fov_degrees": 90},
    "background": [0, 0, 0],
    "materials": {"wall": {"type": "metal", "albedo": [1, 1, 1]}},
    "textures": {},
    "shapes": [{"type": "sphere", "center": [0, 0, 0], "radius": 1, "material": "wall"}],
}
RECURSIVE = ("--engine", "recursive")
FAR_TOO_DEEP = 16_000_000
CHANCE = 200  # bounces: Linux starts every process's stack at an address of its own, within a few kilobytes


class Recursion(CommandTest):
    def greatest_depth(self, *arguments, **keywords):
        """The depth that the refusal of a far greater one says would hold."""
        result = self.run_command("render", "scene.json", *RECURSIVE, "--spp", 1, "--depth", FAR_TOO_DEEP, *arguments, **keywords)
        self.assert_one_line(result, 2, "--depth", "ulimit -s", "OMP_STACKSIZE", "--engine iterative")
        return int(re.search(r"these threads hold depth (\d+)\.", result.stderr)[1])

    def assert_greatest_depth_runs(self, *arguments, least, **keywords):
        greatest = self.greatest_depth(*arguments, **keywords)
        depth = greatest - CHANCE
        self.assertGreaterEqual(depth, least)
        stats = self.stats(*RECURSIVE, "--spp", 1, "--depth", depth, *arguments, **keywords)
        self.assertEqual(stats["segments"], depth * stats["paths"])
        self.assertTrue(all(thread["segments"] > 0 for thread in stats["threads"]), "every stack was used")
        self.assert_refused("render", "scene.json", *RECURSIVE, "--spp", 1, "--depth", greatest + CHANCE, *arguments,
                            named="--depth", **keywords)

    def setUp(self):
        super().setUp()
        self.write("scene.json", INSIDE)
        # Sanitizers widen frames, and their builds have code for every feature alone.
        code = re.search(r"features of the code that runs it, .*: (.*);", self.run_well("info", "scene.json").stdout)[1]
        self.has_wide_frames = "lights" in code

    def test_runs_as_deep_as_the_main_threads_stack_holds(self):
        self.assert_greatest_depth_runs("--threads", 1, least=1000)

    def test_runs_as_deep_as_the_workers_stacks_hold(self):
        loop = ("--threads", 2, "--grain", "pixel", "--schedule", "static,1")
        for size, least in (("4M", 250),) if self.has_wide_frames else (("1M", 125), ("4M", 1000)):
            self.assert_greatest_depth_runs(*loop, least=least, environment={"OMP_STACKSIZE": size})

    def test_runs_as_deep_as_it_says_in_every_variant(self):
        white = changed(INSIDE, "/materials/wall", {"type": "diffuse", "albedo": [1, 1, 1]})
        blurred = changed(changed(white, "/shapes/0/center1", [0, 0.01, 0]), "/camera/shutter", [0, 1])
        everything = {
            **blurred,
            "materials": {**blurred["materials"], "glass": {"type": "dielectric", "ior": 1.5}},
            "shapes": [*blurred["shapes"],
                       {"type": "quad", "corner": [9, 9, 9], "edge_u": [1, 0, 0], "edge_v": [0, 1, 0],
                        "material": "glass"}],
        }
        least = 500 if self.has_wide_frames else 1000
        for scene in (white, blurred, everything):
            self.write("scene.json", scene)
            for arguments in ((), ("--precision", "double"), ("--count-work",), ("--split-depth", 2)):
                with self.subTest(arguments=arguments):
                    self.assert_greatest_depth_runs("--threads", 1, *arguments, least=least)

    def test_refuses_what_a_tiny_stack_cannot_hold(self):
        tiny = {"OMP_STACKSIZE": "64k"}
        for depth in (125, 100_000):
            self.assert_refused("render", "scene.json", *RECURSIVE, "--spp", 1, "--threads", 2, "--depth", depth, "-o", "out.png",
                                environment=tiny, named=["--depth", "OMP_STACKSIZE"])
        # One thread is the main one, whose stack is not OpenMP's; and depth 0 follows no ray.
        self.run_well("render", "scene.json", *RECURSIVE, "--spp", 1, "--threads", 1, "--depth", 125, environment=tiny)
        self.run_well("render", "scene.json", *RECURSIVE, "--spp", 1, "--threads", 2, "--depth", 0, environment=tiny)

    def test_says_what_would_hold_the_depth(self):
        result = self.run_command("render", "scene.json", *RECURSIVE, "--spp", 1, "--threads", 2, "--depth", 100_000)
        self.assert_one_line(result, 2)
        main_kilobytes = int(re.search(r"ulimit -s (\d+)", result.stderr)[1])
        worker_size = re.search(r"OMP_STACKSIZE=(\w+)", result.stderr)[1]

        def raise_limit():
            import resource
            soft, hard = resource.getrlimit(resource.RLIMIT_STACK)
            resource.setrlimit(resource.RLIMIT_STACK, (max(soft, 1024 * main_kilobytes), hard))

        stats = self.stats(*RECURSIVE, "--spp", 1, "--threads", 2, "--depth", 100_000, preexec_fn=raise_limit,
                           environment={"OMP_STACKSIZE": worker_size})
        self.assertEqual(stats["segments"], 100_000 * stats["paths"])

    def test_has_a_twin_that_needs_no_stack(self):
        stats = self.stats("--spp", 1, "--engine", "iterative", "--threads", 2, "--depth", 200_000,
                           environment={"OMP_STACKSIZE": "64k"})
        self.assertEqual(stats["segments"], 200_000 * stats["paths"])


if __name__ == "__main__":
    main()
