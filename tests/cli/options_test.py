"""Options that would do nothing are refused; what is recorded had an effect; a target that was missed is told."""

import json

from command import SCENE, CommandTest, changed, main

POOL = ("--engine", "wavefront")
SHARED = (*POOL, "--pool-scope", "shared")
POOL_OPTIONS = {"--pool-scope": "shared", "--refill": "drain", "--stage-width": "scalar", "--intersect": "single",
                "--camera": "staged", "--sort": "material", "--append": "atomic", "--accumulator": "private",
                "--pool-rays": "100", "--pool-batch": "100"}


class Command(CommandTest):
    def test_that_there_is_not_is_named_whatever_else_is_asked(self):
        for more in ((), ("--help",), ("--spp", 4)):
            self.assert_refused("rendr", *more, named="there is no command rendr (see --help)")
        self.assertIn("render ", self.run_well("--help").stdout)


class OptionThatDoesNothing(CommandTest):
    def assert_idle(self, *arguments, named):
        self.assert_refused(*arguments, named=[*named, "does nothing"])

    def test_of_a_pool_is_refused_by_engines_without_one(self):
        for option, value in POOL_OPTIONS.items():
            for engine in (("--cost-image", "cost.pfm"), ("--engine", "recursive"), ("--engine", "iterative")):
                self.assert_idle("render", "scene.json", *engine, option, value, named=[option, "--engine wavefront"])

    def test_of_a_gpu_is_refused_by_engines_of_the_processor(self):
        for engine in ((), POOL, ("--engine", "recursive")):
            self.assert_idle("render", "scene.json", *engine, "--gpu-form", "wave", named=["--gpu-form", "--engine gpu"])

    def test_of_a_shared_pool_is_refused_by_the_pools_of_threads(self):
        for option in ("--append", "--pool-batch"):
            for scope in ((), ("--pool-scope", "thread")):
                self.assert_idle("render", "scene.json", *POOL, *scope, option, POOL_OPTIONS[option],
                                 named=[option, "--pool-scope shared"])

    def test_of_the_loop_over_the_image_is_refused_by_a_shared_pool(self):
        for option, value in (("--schedule", "dynamic"), ("--schedule", "static,64"), ("--grain", "line")):
            self.assert_idle("render", "scene.json", *SHARED, option, value, named=[option, "--pool-scope shared"])

    def test_of_a_grain_is_refused_by_the_balanced_schedule(self):
        for command in (("render",), ("compare", "--check")):
            self.assert_idle(*command, "scene.json", "--schedule", "balanced", "--grain", "line",
                             named=["--grain", "--schedule balanced"])

    def test_of_registers_is_refused_by_scalar_stages(self):
        self.assert_idle("render", "scene.json", *POOL, "--stage-width", "scalar", "--intersect", "stream",
                         named=["--intersect", "--stage-width scalar"])

    def test_of_a_file_is_refused_without_the_file(self):
        for option, value, file in (("--every", "5", "--checkpoint"), ("--resume", None, "--checkpoint"),
                                    ("--cost", "ns", "--cost-image")):
            self.assert_idle("render", "scene.json", option, *([] if value is None else [value]), named=[option, file])

    def test_beside_another_one_is_refused(self):
        self.assert_idle("render", "scene.json", "--target-error", 1, "--samples", "0:5",
                         named=["--samples", "--target-error"])
        self.assert_idle("compare", "scene.json", "--check", "--repeats", 3, named=["--repeats", "--check"])
        self.assert_idle("advise", "scene.json", "--target-error", 1, "--target-time", 1,
                         named=["--target-error", "--target-time"])

    def test_of_a_study_is_refused_without_the_study_or_by_one_that_does_not_have_it(self):
        for option, value in (("--quick", None), ("--out", "folder"), ("--fresh", None), ("--scene", "cornell"),
                              ("--width", 16), ("--spp", 1), ("--depth", 3), ("--threads", 1), ("--repeats", 1),
                              ("--seed", 1), ("--quiet", None), ("--only", "x")):
            self.assert_idle("study", option, *([] if value is None else [value]), named=[option, "name"])
        for study, option, value in (("stability", "--scene", "cornell"), ("scene-size", "--scene", "cornell"),
                                     ("traversal", "--scene", "cornell"), ("traversal", "--depth", 3),
                                     ("traversal", "--threads", 2), ("build", "--scene", "cornell"), ("build", "--depth", 3),
                                     ("adaptive", "--depth", 3), ("ranks", "--threads", 2)):
            self.assert_idle("study", study, option, value, named=[option, study])

    def test_is_taken_where_it_does_something(self):
        for option, value in POOL_OPTIONS.items():
            self.run_well("render", "scene.json", "--spp", 1, *(POOL if option == "--pool-scope" else SHARED), option, value)
        for scope in ((), POOL, (*POOL, "--pool-scope", "thread")):
            self.run_well("render", "scene.json", "--spp", 1, *scope, "--schedule", "static,2", "--grain", "pixel")
        self.run_well("render", "scene.json", "--spp", 1, "--checkpoint", "c.sums", "--every", 5)
        self.run_well("render", "scene.json", "--spp", 1, "--checkpoint", "c.sums", "--resume")
        self.run_well("render", "scene.json", "--spp", 1, "--cost-image", "cost.pfm", "--cost", "ns")
        self.run_well("compare", "scene.json", "--spp", 1, "--check", "--schedule", "static,64", "--threads", 2)

    def test_with_an_empty_text_is_refused(self):
        for option in ("--schedule", "--grain", "--samples", "--seed"):
            self.assert_refused("render", "scene.json", f"{option}=", named=option)
        for option in ("--schedule", "--grain", "--seed", "--json"):
            self.assert_refused("compare", "scene.json", "--check", f"{option}=", named=option)

    def test_is_refused_by_compare_as_by_render(self):
        for option, value in (("--seed", "-1"), ("--seed", "0x1"), ("--seed", 2**64), ("--schedule", "auto")):
            for command in (("render",), ("compare", "--check")):
                self.assert_refused(*command, "scene.json", option, value, named=option)


class Schedule(CommandTest):
    def test_in_the_environment_is_refused_where_the_option_is(self):
        for text in ("dynamic,-1", "static,0", "guided,-3", "auto", "AUTO", "monotonic:dynamic,6",
                     "nonmonotonic:dynamic", "dynamic,2147483648", ""):
            with self.subTest(text=text):
                result = self.run_command("render", "scene.json", "--spp", 1, environment={"OMP_SCHEDULE": text})
                self.assert_one_line(result, 2, "raypool: OMP_SCHEDULE: must be static, dynamic or guided")

    def test_in_the_environment_is_read_as_openmp_spells_it(self):
        for text, understood in (("static", "static"), ("DYNAMIC , 2", "dynamic,2"), (" Guided,5 ", "guided,5")):
            stats = self.stats("--spp", 1, environment={"OMP_SCHEDULE": text})
            self.assertEqual(stats["settings"]["schedule"], understood)
            self.assertEqual(stats["environment"]["openmp"]["OMP_SCHEDULE"], text)

    def test_stands_on_record_among_all_variables_of_openmp(self):
        environment = {"OMP_NUM_THREADS": "2,3", "OMP_PLACES": "{0},{1}", "OMP_DYNAMIC": "false", "OMP_SCHEDULE": "static, 2"}
        stats = self.stats("--spp", 1, environment=environment)
        self.assertEqual(stats["environment"]["openmp"], environment)
        self.assertEqual((stats["settings"]["threads"], stats["settings"]["schedule"]), (2, "static,2"))

    def test_is_asked_of_the_environment_only_where_it_matters(self):
        self.stats("--spp", 1, "--schedule", "static,2", environment={"OMP_SCHEDULE": "dynamic,-1"})
        self.stats("--spp", 1, *SHARED, environment={"OMP_SCHEDULE": "dynamic,-1"})

    def test_of_lines_gives_no_thread_all_of_a_shared_pool(self):
        self.write("scene.json", changed(SCENE, "/image", {"width": 160, "height": 120}))
        environment = {"OMP_SCHEDULE": "static,100000", "OMP_WAIT_POLICY": "passive"}
        stats = self.stats("--spp", 16, "--threads", 2, *SHARED, "--pool-batch", 64, environment=environment)
        for thread in stats["threads"]:
            self.assertGreater(thread["segments"], 0)

    def test_and_grain_are_recorded_of_a_loop_over_the_image_only(self):
        for pool in (("--engine", "recursive"), ("--engine", "iterative"), POOL):
            settings = self.stats("--spp", 1, *pool, "--grain", "pixel", "--schedule", "static")["settings"]
            self.assertEqual((settings["grain"], settings["schedule"]), ("pixel", "static"))
            self.assertFalse({"append", "batch", "batch_schedule"} & settings.get("pool", {}).keys())
            settings = self.stats("--spp", 1, *pool)["settings"]
            self.assertEqual((settings["schedule"], "grain" in settings), ("balanced", False))
        settings = self.stats("--spp", 1, *SHARED)["settings"]
        self.assertFalse({"grain", "schedule"} & settings.keys())
        self.assertEqual(settings["pool"]["batch_schedule"], "dynamic")
        said = self.run_well("render", "scene.json", "--spp", 1, *SHARED).stdout
        self.assertNotIn("grain", said)
        self.assertNotIn("schedule", said)

    def test_is_recorded_with_the_pool_that_was(self):
        pool = self.stats("--spp", 1, *SHARED, "--stage-width", "scalar", "--pool-rays", 100, "--pool-batch",
                          1000)["settings"]["pool"]
        self.assertEqual((pool["intersect"], pool["batch"]), ("single", 100))

    def test_of_a_shared_pool_gives_each_thread_several_batches(self):
        for threads, rays, batch in ((1, 65536, 4096), (2, 65536, 4096), (8, 131072, 2048), (16, 262144, 2048)):
            pool = self.stats("--spp", 1, *SHARED, "--threads", threads)["settings"]["pool"]
            self.assertEqual((pool["rays"], pool["batch"]), (rays, batch))
        pool = self.stats("--spp", 1, *SHARED, "--threads", 4, "--pool-rays", 10_000)["settings"]["pool"]
        self.assertEqual((pool["rays"], pool["batch"]), (10_000, 312))


class TargetError(CommandTest):
    def test_that_is_missed_ends_with_one_and_a_line(self):
        for engine in ("recursive", "wavefront"):
            result = self.run_command("render", "scene.json", "--target-error", 1e-6, "--spp", 20, "--quiet", "--stats",
                                      "s.json", "-o", "out.pfm", "--engine", engine)
            self.assert_one_line(result, 1, "--target-error 1e-06", "not reached", "--spp 20")
            adaptive = json.loads((self.folder / "s.json").read_text())["adaptive"]
            self.assertIs(adaptive["reached"], False)
            self.assertIn(f"{adaptive['rmse_estimate']:.4g}", result.stderr)
            self.pixels("out.pfm")

    def test_that_is_reached_ends_with_nought(self):
        self.run_well("render", "scene.json", "--target-error", 0.5, "--spp", 5000, "--stats", "s.json")
        self.assertIs(json.loads((self.folder / "s.json").read_text())["adaptive"]["reached"], True)


class Simd(CommandTest):
    def test_is_recorded_as_it_was_compiled(self):
        simd = self.stats("--spp", 1)["environment"]["simd"]
        self.assertTrue({"sse2", "asimd"} & set(simd["instruction_sets"]), simd)
        for kind in ("stage_lanes", "tree_width"):
            for precision in ("float", "double"):
                self.assertGreaterEqual(simd[kind][precision], 2)
        lanes = simd["stage_lanes"]
        self.assertEqual(lanes["float"], 2 * lanes["double"])
        if "avx512f" in simd["instruction_sets"]:
            self.assertEqual(lanes["float"], 16)
        said = self.run_well("info", "scene.json").stdout
        self.assertIn(f"that code may use: {', '.join(simd['instruction_sets'])}; stages of {lanes['float']} rays in float",
                      said)


if __name__ == "__main__":
    main()
