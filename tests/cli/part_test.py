"""Parts of an image (--crop, --pixel), its size, and what comes from and goes to pipes."""
import os
import re
import subprocess
import threading
import unittest

from command import SCENE, CommandTest, changed, main

# A lamp and glass, so that paths have vertices of all kinds.
LAMP = changed(changed(SCENE, "/shapes/0/material", "glass"), "/shapes/1/material", "grey")
LAMP["textures"]["bright"] = {"type": "solid", "color": [4, 4, 4]}
LAMP["materials"]["lamp"] = {"type": "emissive", "radiance": "bright"}
LAMP["shapes"].append({"type": "quad", "corner": [-1, 3, -1], "edge_u": [2, 0, 0], "edge_v": [0, 0, 2], "material": "lamp"})


class Crop(CommandTest):
    def test_has_the_pixels_of_the_whole_by_every_engine(self):
        self.run_well("render", "scene.json", "--spp", 5, "-o", "whole.pfm", "--quiet")
        whole = self.pixels("whole.pfm")[2]
        hashes = set()
        for engine in ("recursive", "iterative", "wavefront"):
            stats = self.stats("--spp", 5, "--engine", engine, "--crop", "2,1,7,4", "-o", "part.pfm")
            hashes.add(stats["hash"])
            self.assertEqual(stats["settings"]["crop"], [2, 1, 7, 4])
            self.assertEqual(stats["paths"], 5 * 15)
            width, height, part = self.pixels("part.pfm")
            self.assertEqual((width, height), (5, 3))
            for row in range(height):  # files begin at the bottom: row 0 is row 3 of the image, and row 2 of the whole file
                first = 3 * (8 * (row + 2) + 2)
                self.assertEqual(part[15 * row:15 * (row + 1)], whole[first:first + 15])
        self.assertEqual(len(hashes), 1)

    def test_of_all_is_the_whole(self):
        self.assertEqual(self.stats("--spp", 3, "--crop", "0,0,8,6")["hash"], self.stats("--spp", 3)["hash"])

    def test_that_is_none_is_refused(self):
        for crop in ("0,0,9,6", "0,0,8,7", "3,0,3,6", "0,4,8,4", "1,2,3", "1,2,3,4,5", "a,0,1,1", "-1,0,2,2", ""):
            self.assert_refused("render", "scene.json", f"--crop={crop}", named="--crop")
        for other in (("--pixel", "1,1"), ("--checkpoint", "sums"), ("--target-error", 0.1)):
            self.assert_refused("render", "scene.json", "--crop", "0,0,1,1", *other, named="--crop")


class Pixel(CommandTest):
    def setUp(self):
        super().setUp()
        self.write("scene.json", LAMP)

    def test_shows_paths_that_bring_home_what_the_image_has(self):
        """The command itself fails where the sum of what it prints is not, to the bit, the sum of the engine."""
        self.run_well("render", "scene.json", "--spp", 40, "-o", "whole.pfm", "--quiet")
        values = self.pixels("whole.pfm")[2]
        for x, y in ((3, 3), (0, 5), (4, 0)):
            for engine in ("recursive", "wavefront"):
                shown = self.run_well("render", "scene.json", "--spp", 40, "--engine", engine, "--pixel", f"{x},{y}", "-o", "p.pfm").stdout
                self.assertEqual(len(re.findall(rf"^pixel {x},{y} sample \d+: from ", shown, re.MULTILINE)), 40)
                first = 3 * (8 * (5 - y) + x)
                self.assertEqual(self.pixels("p.pfm")[2], values[first:first + 3])
                home = re.findall(r"brings home \((\S+), (\S+), (\S+)\)", shown)
                for k in range(3):
                    mean = sum(float(radiance[k]) for radiance in home) / 40
                    self.assertAlmostEqual(mean, values[first + k], delta=1e-5 * max(1, mean))

    def test_says_what_a_path_meets(self):
        shown = self.run_well("render", "scene.json", "--spp", 100, "--pixel", "3,3").stdout
        for text in ("sphere 0, dielectric at (", "plane 0, diffuse at (", "leaves the scene along (", "background: brings home (",
                     "goes on along ("):
            self.assertTrue(text in shown, text)
        for text in ("light from quad 1, emissive: brings home (", "light from quad 1, emissive: hidden"):
            self.assertTrue(text in shown, text)

    def test_of_meshes_and_depths_and_samplers(self):
        shown = self.run_well("render", "cornell", "--width", 20, "--spp", 4, "--pixel", "10,15", "--depth", 3, "--sampler", "sobol",
                              "--roulette").stdout
        self.assertLessEqual(max(int(step) for step in re.findall(r"^  +(\d+) ", shown, re.MULTILINE)), 3)
        self.run_well("render", "cornell", "--width", 20, "--spp", 4, "--pixel", "10,15", "--depth", 0)
        self.run_well("render", "one_sphere", "--width", 1, "--height", 1, "--spp", 2, "--pixel", "0,0")

    def test_that_is_none_is_refused(self):
        for pixel in ("8,0", "0,6", "1", "1,2,3", "x,1"):
            self.assert_refused("render", "scene.json", "--pixel", pixel, named="--pixel")
        for other in (("--split-depth", 1), ("--precision", "double"), ("--quiet",)):
            self.assert_refused("render", "scene.json", "--pixel", "1,1", *other, named="--pixel")


class Size(CommandTest):
    def test_keeps_the_shape_unless_both_sides_are_given(self):
        for options, size in ((("--height", 12), (16, 12)), (("--width", 4), (4, 3)), (("--width", 5, "--height", 9), (5, 9))):
            settings = self.stats("--spp", 1, *options)["settings"]
            self.assertEqual((settings["width"], settings["height"]), size)
        self.assert_refused("render", "scene.json", "--height", 60000, named="--height")


class Pipes(CommandTest):
    def pipe(self, *arguments, **keywords):
        return subprocess.run([self.command, *map(str, arguments)], cwd=self.folder, capture_output=True, check=True, timeout=60,
                              **keywords)

    def test_carry_a_scene_in_and_an_image_out(self):
        self.run_well("render", "scene.json", "--spp", 4, "-o", "image.pfm", "--quiet")
        expected = (self.folder / "image.pfm").read_bytes()
        text = (self.folder / "scene.json").read_bytes()
        result = self.pipe("render", "-", "--spp", 4, "-o", "pfm:-", input=text)
        self.assertEqual((result.stdout, result.stderr), (expected, b""))
        self.assertTrue(self.pipe("render", "scene.json", "--spp", 1, "-o", "png:-").stdout.startswith(b"\x89PNG"))
        with (self.folder / "shell.pfm").open("wb") as file:
            subprocess.run([self.command, "render", "scene.json", "--spp", "4", "-o", "pfm:-"], cwd=self.folder, stdout=file, check=True)
        self.assertEqual((self.folder / "shell.pfm").read_bytes(), expected)

    def test_may_be_files(self):
        os.mkfifo(self.folder / "in.json")
        os.mkfifo(self.folder / "out.pfm")
        text = (self.folder / "scene.json").read_bytes()
        writer = threading.Thread(target=lambda: (self.folder / "in.json").write_bytes(text))
        found = []
        reader = threading.Thread(target=lambda: found.append((self.folder / "out.pfm").read_bytes()))
        writer.start()
        reader.start()
        self.run_well("render", "in.json", "--spp", 4, "-o", "out.pfm", "--quiet")
        writer.join(30)
        reader.join(30)
        self.run_well("render", "scene.json", "--spp", 4, "-o", "image.pfm", "--quiet")
        self.assertEqual(found, [(self.folder / "image.pfm").read_bytes()])

    def test_say_what_is_wrong_with_a_scene(self):
        result = subprocess.run([self.command, "render", "-"], input="{", capture_output=True, text=True, check=False)
        self.assert_one_line(result, 2, "stdin")


class Listings(CommandTest):
    def test_scenes_are_all_that_can_be_rendered(self):
        lines = self.run_well("scenes").stdout.splitlines()
        self.assertGreater(len(lines), 8)
        for line in lines:
            self.run_well("render", line.split()[0], "--width", 4, "--spp", 1, "--quiet")

    def test_the_manual_names_every_option(self):
        manual = self.run_well("manual").stdout.replace("\\-", "-")
        self.assertTrue(manual.startswith(".TH RAYPOOL 1 "))
        commands = re.findall(r"^  (\w+) ", self.run_well("--help").stdout.split("Subcommands:")[1], re.MULTILINE)
        for command in commands:
            self.assertIn(f".SH OPTIONS OF {command}\n", manual)
            for option in re.findall(r"^ +(?:-\w,)?(--[\w-]+)", self.run_well(command, "--help").stdout, re.MULTILINE):
                self.assertIn(option, manual)
        result = subprocess.run(["man", "--warnings", "-l", "-"], input=manual, capture_output=True, text=True, check=False,
                                env={**os.environ, "MAN_KEEP_STDERR": "1"}) if os.path.exists("/usr/bin/man") else None
        if result is not None:
            self.assertEqual((result.returncode, result.stderr), (0, ""))

    def complete(self, *words):
        """What bash offers behind these words."""
        script = self.run_well("manual", "bash").stdout + (
            f"COMP_WORDS=({' '.join(map(repr, words))})\nCOMP_CWORD={len(words) - 1}\n_raypool\nprintf '%s\\n' \"${{COMPREPLY[@]}}\"\n")
        result = subprocess.run(["bash", "-c", script], cwd=self.folder, capture_output=True, text=True, check=True)
        self.assertEqual(result.stderr, "")
        return result.stdout.split()

    def test_bash_completes_commands_options_values_and_files(self):
        self.assertEqual(self.complete("raypool", "ren"), ["render"])
        self.assertEqual(self.complete("raypool", "render", "--cro"), ["--crop"])
        self.assertEqual(sorted(self.complete("raypool", "render", "--precision", "")), ["double", "float"])
        self.assertEqual(self.complete("raypool", "render", "scene.json", "--gpu-form", "wa"), ["wave"])
        self.assertEqual(self.complete("raypool", "render", "sce"), ["scene.json"])


if __name__ == "__main__":
    main()
