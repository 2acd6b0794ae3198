"""What `render` and `info` write and print, and the smallest and oddest renders that must work."""

import json
import os
import pty
import re
import subprocess

from command import SCENE, CommandTest, changed, main


class Small(CommandTest):
    """Renders that are easily forgotten."""

    def rendered(self, scene, *arguments):
        """Stats, width, height and pixels of a render to a PFM file."""
        self.write("scene.json", scene)
        stats = self.stats("-o", "out.pfm", *arguments)
        return (stats, *self.pixels("out.pfm"))

    def test_image_of_one_pixel_with_more_threads_than_pixels(self):
        scene = changed(SCENE, "/image", {"width": 1, "height": 1})
        for grain in ("pixel", "line", "tile:16"):
            stats, width, height, _ = self.rendered(scene, "--threads", 7, "--grain", grain, "--spp", 5)
            self.assertEqual((width, height, stats["paths"], len(stats["threads"])), (1, 1, 5, 7))

    def test_image_of_one_pixel_is_for_all_threads(self):
        scene = changed(SCENE, "/image", {"width": 1, "height": 1})
        hashes = set()
        for engine in ("recursive", "iterative", "wavefront"):
            for threads in (1, 2, 5):
                stats, *_ = self.rendered(scene, "--engine", engine, "--threads", threads, "--spp", 20_000)
                self.assertEqual(stats["paths"], 20_000)
                hashes.add(stats["hash"])
        self.assertEqual(len(hashes), 1)

    def test_image_keeps_its_shape_at_another_width(self):
        for width, height in ((1, 1), (4, 3), (80, 60)):
            _, *size, _ = self.rendered(SCENE, "--width", width, "--spp", 1)
            self.assertEqual(size, [width, height])

    def test_depth_of_zero_is_black_and_of_one_is_sky(self):
        stats, _, _, pixels = self.rendered(SCENE, "--depth", 0, "--spp", 1)
        self.assertEqual((stats["segments"], set(pixels)), (0, {0.0}))
        stats, _, _, pixels = self.rendered(SCENE, "--depth", 1, "--spp", 1)
        self.assertEqual(stats["segments"], stats["paths"])
        colours = {tuple(pixels[i:i + 3]) for i in range(0, len(pixels), 3)}
        self.assertEqual(colours, {(0.0, 0.0, 0.0), (0.25, 0.5, 1.0)})

    def test_target_error_stops_where_it_is_reached_or_at_the_most_samples(self):
        self.run_well("render", "half_sky", "--width", 32, "--target-error", 0.008, "--spp", 5000, "--stats", "s.json",
                      "-o", "out.pfm", "--quiet")
        stats = json.loads((self.folder / "s.json").read_text())
        adaptive = stats["adaptive"]
        self.assertLessEqual(adaptive["rmse_estimate"], 0.008)
        counts = adaptive["samples_per_pixel"]
        self.assertLess(counts["least"], counts["most"])
        self.assertEqual(stats["paths"], round(counts["mean"] * 32 * 18))
        self.run_well("render", "half_sky", "--width", 32, "--spp", 4096, "--seed", 7, "-o", "truth.pfm", "--quiet")
        error = float(self.run_command("diff", "out.pfm", "truth.pfm").stdout.split("RMSE")[1].split()[0])
        self.assertLess(error, 0.012)
        missed = self.run_command("render", "scene.json", "--target-error", 1e-6, "--spp", 20, "--stats", "s.json")
        self.assertEqual(missed.returncode, 1)
        adaptive = json.loads((self.folder / "s.json").read_text())["adaptive"]
        self.assertEqual(adaptive["samples_per_pixel"]["most"], 20)

    HIDDEN_LAMP = {
        "description": "A sky over a plane that hides a lamp.",
        "image": {"width": 16, "height": 16},
        "camera": {"look_from": [0.3, 2.1, 5.7], "look_at": [0, 0.5, 0], "vertical_fov_degrees": 50},
        "background": [0.04, 0.04, 0.04],
        "materials": {"white": {"type": "diffuse", "albedo": [0.8, 0.8, 0.8]},
                      "lamp": {"type": "emissive", "radiance": [1e6, 1e6, 1e6]}},
        "shapes": [{"type": "plane", "point": [0, 0, 0], "normal": [0, 1, 0], "material": "white"},
                   {"type": "sphere", "center": [0, 0.6, 0], "radius": 0.6, "material": "white"},
                   {"type": "sphere", "center": [0, -2, 0], "radius": 0.5, "material": "lamp"}]}

    def test_target_error_is_estimated_beside_a_hidden_lamp_and_not_called_reached(self):
        self.write("hidden.json", self.HIDDEN_LAMP)
        unknown = self.run_command("render", "hidden.json", "--target-error", 5e-4, "--spp", 4096, "--stats", "s.json")
        self.assertEqual(unknown.returncode, 1)
        self.assertIn("not known", unknown.stderr)
        adaptive = json.loads((self.folder / "s.json").read_text())["adaptive"]
        self.assertEqual(adaptive["target"], "not known")
        self.assertGreater(adaptive["rmse_estimate"], 1e-5)
        self.assertLessEqual(adaptive["rmse_estimate"], 5e-4)
        self.assertGreater(adaptive["rmse_of_unseen_light"], 1)

    def test_says_where_steps_of_sums_are_coarse_for_dim_light(self):
        self.assertNotIn("coarse", self.run_well("render", "scene.json", "--spp", 1).stdout)
        self.write("hidden.json", changed(self.HIDDEN_LAMP, "/background", [1e-6, 1e-6, 1e-6]))
        self.assertIn("the dimmest light, 1e-06, is coarse",
                      self.run_well("render", "hidden.json", "--spp", 1, "--stats", "s.json").stdout)
        sums = json.loads((self.folder / "s.json").read_text())["sums"]
        self.assertEqual(sums["dimmest_light"], 1e-6)
        # A radiance of 1e6 (2^21 is twice that), 2^14 samples, and parts of a sample that add up to 5 of it, in 62 bits.
        self.assertEqual(sums["step"], 2.0**-24)
        self.run_well("render", "hidden.json", "--spp", 1, "--light-sampling", "none", "--stats", "s.json")
        self.assertEqual(json.loads((self.folder / "s.json").read_text())["sums"]["step"], 2.0**-27)
        self.assertIn("coarse", self.run_well("info", "hidden.json").stdout)

    def test_empty_scene_is_its_background(self):
        empty = changed(changed(changed(SCENE, "/shapes", []), "/materials"), "/textures")
        for precision in ("float", "double"):
            stats, _, _, pixels = self.rendered(empty, "--spp", 3, "--precision", precision)
            self.assertEqual(set(zip(*[iter(pixels)] * 3)), {(0.25, 0.5, 1.0)})
            self.assertEqual(stats["segments_per_path"], 1)

    def test_last_samples_of_two_billion(self):
        stats, *_ = self.rendered(SCENE, "--spp", 2**31 - 1, "--samples", f"{2**31 - 3}:{2**31 - 1}")
        self.assertEqual(stats["paths"], 2 * 8 * 6)

    def test_depth_of_the_paper(self):
        self.rendered(SCENE, "--depth", 125, "--threads", 2)


class Render(CommandTest):
    def test_prints_the_hash_and_the_name_of_the_picture(self):
        result = self.run_well("render", "scene.json", "--spp", 2, "-o", "out.png")
        self.assertRegex(result.stdout, r"\bhash [0-9a-f]{16}\n")
        self.assertTrue(result.stdout.endswith("\nout.png\n"))
        self.assertEqual((self.folder / "out.png").read_bytes()[:8], b"\x89PNG\r\n\x1a\n")
        self.assertEqual(self.run_well("render", "scene.json", "--spp", 2, "--quiet").stdout, "")

    def test_sampler_and_roulette_change_the_image_and_are_recorded(self):
        hashes = set()
        for sampler in ("independent", "sobol"):
            for roulette in ((), ("--roulette",)):
                images = set()
                for engine in ("recursive", "iterative", "wavefront"):
                    stats = self.stats("--spp", 32, "--sampler", sampler, *roulette, "--engine", engine)
                    images.add(stats["hash"])
                    self.assertEqual(stats["settings"]["sampler"], sampler)
                    self.assertEqual(stats["settings"]["roulette"], bool(roulette))
                self.assertEqual(len(images), 1)
                hashes |= images
        self.assertEqual(len(hashes), 4)
        summary = self.run_well("render", "scene.json", "--spp", 1, "--sampler", "sobol", "--roulette").stdout
        self.assertIn("depth 50 and roulette, sobol, seed 0", summary)

    def test_light_sampling_changes_the_image_and_is_recorded(self):
        hashes = {}
        for mode in ("none", "light", "mis"):
            for engine in ("recursive", "iterative", "wavefront"):
                self.run_well("render", "small_lamp", "--width", 24, "--spp", 4, "--light-sampling", mode, "--engine",
                              engine, "--stats", "s.json")
                stats = json.loads((self.folder / "s.json").read_text())
                hashes.setdefault(mode, set()).add(stats["hash"])
                self.assertEqual(stats["settings"]["light_sampling"], mode)
                self.assertEqual(stats["shadow_rays"] > 0, mode != "none")
        self.assertEqual([len(of_mode) for of_mode in hashes.values()], [1, 1, 1])
        self.assertEqual(len(set.union(*hashes.values())), 3)
        summary = self.run_well("render", "small_lamp", "--width", 24, "--spp", 4, "--stats", "s.json").stdout
        self.assertIn("depth 50, light sampling mis, seed 0", summary)
        self.assertEqual({json.loads((self.folder / "s.json").read_text())["hash"]}, hashes["mis"])
        self.run_well("compare", "small_lamp", "--width", 16, "--spp", 1, "--check")

    def test_light_sampling_is_none_in_a_scene_without_lights(self):
        hashes = set()
        for mode in ("none", "light", "mis"):
            stats = self.stats("--spp", 1, "--light-sampling", mode)
            hashes.add(stats["hash"])
            self.assertEqual(stats["settings"]["light_sampling"], "none")
            self.assertEqual(stats["shadow_rays"], 0)
        self.assertEqual(len(hashes), 1)

    def test_target_error_holds_for_samples_that_come_in_parts(self):
        # What light sampling alone may find has no bound, so that nothing is proved.
        for options, target in (((), "reached"), (("--split-depth", 1), "reached"),
                                (("--light-sampling", "light"), "not known")):
            hashes = set()
            for engine in ("recursive", "wavefront"):
                self.run_command("render", "cornell", "--width", 20, "--target-error", 0.2, "--spp", 512, "--engine",
                                 engine, "--stats", "s.json", *options)
                stats = json.loads((self.folder / "s.json").read_text())
                self.assertEqual(stats["adaptive"]["target"], target)
                self.assertLessEqual(stats["adaptive"]["rmse_estimate"], 0.2)
                hashes.add(stats["hash"])
            self.assertEqual(len(hashes), 1)

    def test_says_what_the_depth_cuts_off_at_most(self):
        stats = self.stats("--spp", 1, "--depth", 3)
        summary = self.run_well("render", "scene.json", "--spp", 1, "--depth", 3).stdout
        self.assertGreater(stats["truncation_bound"], 0)
        self.assertIn(f"what depth 3 cuts off is proved to be at most a radiance of {stats['truncation_bound']:.3g} a pixel, ", summary)

    def test_needs_neither_a_scene_nor_an_output(self):
        result = self.run_well("render", "--width", 16, "--spp", 1)
        self.assertTrue(result.stdout.startswith("paper: 16 x 9"))
        self.assertEqual(list(self.listing()), ["scene.json"])

    def test_leaves_only_whole_files(self):
        self.write("out.png", "old")
        self.run_well("render", "scene.json", "--spp", 1, "-o", "out.png", "--stats", "stats.json")
        self.assertEqual(list(self.listing()), ["out.png", "scene.json", "stats.json"])

    def test_writes_to_a_pipe_what_it_writes_to_a_file(self):
        self.run_well("render", "scene.json", "--spp", 1, "--quiet", "-o", "out.pfm")
        os.symlink("/dev/stdout", self.folder / "pipe.pfm")
        with open(self.folder / "caught", "wb") as caught:
            process = subprocess.run([self.command, "render", "scene.json", "--spp", "1", "--quiet", "-o", "pipe.pfm"],
                                     cwd=self.folder, stdout=subprocess.PIPE, check=True)
            caught.write(process.stdout)
        self.assertEqual((self.folder / "caught").read_bytes(), (self.folder / "out.pfm").read_bytes())

    def test_shows_progress_on_a_terminal_only(self):
        terminal, other_end = pty.openpty()
        process = subprocess.Popen([self.command, "render", "paper", "--width", "200", "--spp", "600", "--threads", "1"],
                                   cwd=self.folder, stdout=subprocess.DEVNULL, stderr=other_end,
                                   env={**os.environ, "TERM": "xterm"})
        os.close(other_end)
        shown = b""
        try:
            while block := os.read(terminal, 4096):
                shown += block
        except OSError:  # how Linux tells that the other end is closed
            pass
        os.close(terminal)
        self.assertEqual(process.wait(), 0)
        self.assertRegex(shown.decode(), r"\r\[=* *\] +\d+ %  \d+\.\d\d M paths/s  (\d+:\d\d|-:--) left\x1b\[K")
        self.assertTrue(shown.endswith(b"\r\x1b[K"), "the bar is gone at the end")

    def test_has_one_hash_whatever_the_engine_and_the_loop(self):
        hashes = {
            self.stats("--spp", 3, "--engine", engine, "--threads", threads, "--schedule", schedule, "--grain", grain)["hash"]
            for engine in ("recursive", "iterative", "wavefront")
            for threads, schedule, grain in ((1, "static", "line"), (2, "dynamic,3", "pixel"), (7, "guided", "tile:4"),
                                             (2, "tasks", "line"), (3, "tasks,5", "pixel"))
        }
        hashes |= {self.stats("--spp", 3, *engine, "--threads", threads)["hash"]
                   for engine in ((), ("--engine", "recursive"), ("--engine", "iterative")) for threads in (1, 2, 9)}
        self.assertEqual(len(hashes), 1)
        self.assertNotIn(self.stats("--spp", 3, "--seed", 2**64 - 1)["hash"], hashes)
        self.assertNotIn(self.stats("--spp", 3, "--precision", "double")["hash"], hashes)


class PoolRays(CommandTest):
    def test_may_be_bytes_of_whole_records(self):
        info = self.run_well("info", "scene.json").stdout
        sizes = dict(zip(("float", "double"), map(int, re.search(r"ray record: (\d+) bytes in float, (\d+) in double", info).groups())))
        for text, precision, size in (("1KB", "float", 1024), ("2MB", "float", 2**21), ("512KB", "double", 2**19)):
            stats = self.stats("--spp", 1, "--engine", "wavefront", "--pool-rays", text, "--precision", precision)
            self.assertEqual(stats["record_bytes"], sizes[precision])
            self.assertEqual(stats["settings"]["pool"]["rays"], size // sizes[precision])
        stats = self.stats("--spp", 1, "--engine", "wavefront", "--pool-rays", "100")
        self.assertEqual(stats["settings"]["pool"]["rays"], 100)


class Info(CommandTest):
    def test_prints_needs_bytes_and_trees(self):
        text = self.run_well("info").stdout
        self.assertIn("features of the scene: motion, defocus, metal, fuzz, dielectric, checker\n", text)
        self.assertRegex(text, r"\bray record: \d+ bytes in float, \d+ in double\n")
        self.assertRegex(text, r"\bsphere tree: \d+ nodes \d+ wide, \d+ levels, \d+ leaves holding \d+ ")
        # Shapes that stand still get a time, too, from code for every feature; the last is that of builds with no other.
        self.assertRegex(self.run_well("info", "cornell").stdout,
                         r"ray record: 60 bytes in float, 104 in double; (56 and 96|60 and 104) without light sampling")
        self.assertRegex(self.run_well("info", "scene.json").stdout, r"1 sphere, 1 quad, 1 plane;")

    def test_info_names_shapes_that_no_ray_meets(self):
        self.assertNotIn("hidden", self.run_well("info", "scene.json").stdout)
        shapes = SCENE["shapes"] + [SCENE["shapes"][0]] * 2 + [SCENE["shapes"][2]]
        self.write("twice.json", changed(SCENE, "/shapes", shapes))
        self.assertIn("hidden in float: 3 shapes, each by one listed before: sphere 1, sphere 2, quad 1\n",
                      self.run_well("info", "twice.json").stdout)
        self.write("often.json", changed(SCENE, "/shapes", SCENE["shapes"] * 3))
        self.assertRegex(self.run_well("info", "often.json").stdout, r"hidden in float: 6 shapes, .*, \.\.\.\n")


if __name__ == "__main__":
    main()
