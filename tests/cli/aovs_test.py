"""Channels beside the picture (--aovs) and half-precision floats (--half), read without OpenEXR."""
import array
import math
import struct
import unittest
import zlib

from command import CommandTest, main


def unpacked(block):
    """A ZIP block of OpenEXR: bytes are kept as differences, those at even places before those at odd ones."""
    values = bytearray(zlib.decompress(block))
    for i in range(1, len(values)):
        values[i] = (values[i - 1] + values[i] - 128) % 256
    half = (len(values) + 1) // 2
    out = bytearray(len(values))
    out[0::2], out[1::2] = values[:half], values[half:]
    return bytes(out)


def read_exr(data):
    """Width, height and for each channel its type ("e" or "f") and values, of a file of scan lines in ZIP blocks."""
    assert struct.unpack_from("<II", data) == (20000630, 2)
    place = 8

    def name():
        nonlocal place
        end = data.index(b"\0", place)
        text, place = data[place:end].decode(), end + 1
        return text

    attributes = {}
    while key := name():
        name()
        (size,) = struct.unpack_from("<i", data, place)
        attributes[key] = (place + 4, data[place + 4:place + 4 + size])
        place += 4 + size
    assert attributes["compression"][1] == b"\3"
    x_min, y_min, x_max, y_max = struct.unpack("<4i", attributes["dataWindow"][1])
    width, height = x_max - x_min + 1, y_max - y_min + 1
    table = place
    place = attributes["channels"][0]
    kinds = []
    while channel := name():
        kinds.append((channel, {1: "e", 2: "f"}[struct.unpack_from("<i", data, place)[0]]))
        place += 16
    line_bytes = sum(width * struct.calcsize(kind) for _, kind in kinds)
    channels = {channel: (kind, []) for channel, kind in kinds}
    for block in range((height + 15) // 16):
        (at,) = struct.unpack_from("<Q", data, table + 8 * block)
        row, size = struct.unpack_from("<ii", data, at)
        rows = min(16, y_max - row + 1)
        content = data[at + 8:at + 8 + size]
        content = content if size == rows * line_bytes else unpacked(content)
        at = 0
        for _ in range(rows):
            for channel, kind in kinds:
                channels[channel][1].extend(struct.unpack_from(f"<{width}{kind}", content, at))
                at += width * struct.calcsize(kind)
    return width, height, channels


FIRST_HITS = ["A", "N.X", "N.Y", "N.Z", "Z", "albedo.B", "albedo.G", "albedo.R"]
OTHERS = ["samples", "variance.B", "variance.G", "variance.R"]


class Aovs(CommandTest):
    def read(self, name):
        return read_exr((self.folder / name).read_bytes())

    def test_are_channels_beside_the_same_picture(self):
        plain = self.stats("--spp", 6, "-o", "plain.pfm")
        wide, high, values = self.pixels("plain.pfm")
        for engine in ("recursive", "wavefront"):
            stats = self.stats("--spp", 6, "--engine", engine, "--aovs", "-o", "out.exr")
            self.assertEqual(stats["hash"], plain["hash"])
            self.assertGreater(stats["seconds"]["aovs"], 0)
            width, height, channels = self.read("out.exr")
            self.assertEqual((width, height), (wide, high))
            self.assertEqual(sorted(channels), sorted(["R", "G", "B", *FIRST_HITS, *OTHERS]))
            for k, channel in enumerate("RGB"):
                for y in range(height):  # a PFM file begins at the bottom
                    row = values[3 * width * (height - 1 - y) + k:3 * width * (height - y):3]
                    self.assertEqual(array.array("f", channels[channel][1][width * y:width * (y + 1)]), row)
            self.assertEqual(set(channels["samples"][1]), {6})
            self.assertEqual({kind for kind, _ in channels.values()}, {"f"})
            # The ball's middle: a grey surface toward the camera, which is about 4 away.
            middle = width * (height // 2) + width // 2
            for channel, value in {"A": 1, "albedo.R": 0.7, "albedo.B": 0.7, "Z": 4.1}.items():
                self.assertAlmostEqual(channels[channel][1][middle], value, delta=0.15, msg=channel)
            self.assertGreater(channels["N.Z"][1][middle], 0.9)
            self.assertGreater(max(channels["variance.G"][1]), 0)
            self.assertEqual(channels["Z"][1][0], math.inf)
            self.assertEqual((channels["A"][1][0], channels["albedo.G"][1][0], channels["variance.R"][1][0]), (0, 0, 0))

    def test_of_an_adaptive_image_tell_where_samples_went(self):
        asked = ("half_sky", "--width", 40, "--spp", 4096, "--target-error", 0.02)
        stats = self.stats(*asked, "--aovs", "-o", "out.exr")
        self.assertEqual(self.stats(*asked)["hash"], stats["hash"])
        samples = self.read("out.exr")[2]["samples"][1]
        counts = stats["adaptive"]["samples_per_pixel"]
        self.assertLess(min(samples), max(samples))
        self.assertEqual((min(samples), max(samples)), (counts["least"], counts["most"]))
        self.assertAlmostEqual(sum(samples) / len(samples), counts["mean"], places=3)

    def test_of_a_part_are_those_of_the_whole(self):
        self.run_well("render", "scene.json", "--spp", 4, "--aovs", "-o", "whole.exr", "--quiet")
        self.run_well("render", "scene.json", "--spp", 4, "--aovs", "--crop", "2,1,7,4", "-o", "part.exr", "--quiet")
        whole, part = self.read("whole.exr")[2], self.read("part.exr")[2]
        for channel, (_, values) in part.items():
            self.assertEqual(values, [whole[channel][1][8 * y + x] for y in range(1, 4) for x in range(2, 7)], channel)

    def test_are_of_the_samples_that_are_asked_for(self):
        def albedo(*more):
            self.run_well("render", "paper", "--width", 24, *more, "--aovs", "-o", "out.exr", "--quiet")
            return self.read("out.exr")[2]["albedo.R"][1]

        whole, parts = albedo("--spp", 6), [albedo("--spp", 6, "--samples", part) for part in ("0:2", "2:6")]
        for i, value in enumerate(whole):
            self.assertAlmostEqual(value, (2 * parts[0][i] + 4 * parts[1][i]) / 6, places=6)
        for more in (("--seed", 1), ("--sampler", "sobol")):
            self.assertNotEqual(albedo("--spp", 6, *more), whole)
        self.assertLess(sum(abs(a - b) for a, b in zip(albedo("--spp", 6, "--precision", "double"), whole)), 0.1 * sum(whole))

    def test_of_a_pixel_stand_beside_its_paths(self):
        self.run_well("render", "scene.json", "--spp", 4, "--aovs", "-o", "whole.exr", "--quiet")
        shown = self.run_well("render", "scene.json", "--spp", 4, "--pixel", "3,3", "--aovs", "-o", "pixel.exr").stdout
        self.assertRegex(shown, r"\nchannels beside the picture: \d+\.\d+ s more\n")
        distances = [float(line.split()[-1]) for line in shown.splitlines() if line.startswith("   1 sphere 0")]
        whole, pixel = self.read("whole.exr")[2], self.read("pixel.exr")[2]
        self.assertAlmostEqual(pixel["Z"][1][0], sum(distances) / 4, delta=1e-5)
        for channel, (_, values) in pixel.items():
            self.assertEqual(values, [whole[channel][1][8 * 3 + 3]], channel)

    def test_come_from_a_pipe_too_and_their_picture_is_read(self):
        piped = self.run_well("render", "scene.json", "--spp", 4, "--aovs", "-o", "exr:-", text=False, errors=None)
        self.assertEqual(read_exr(piped.stdout)[2]["samples"][1], 48 * [4])
        (self.folder / "piped.exr").write_bytes(piped.stdout)
        self.run_well("render", "scene.json", "--spp", 4, "-o", "plain.exr", "--quiet")
        said = self.run_command("diff", "piped.exr", "plain.exr").stdout
        self.assertIn("albedo.R", said)  # what is not compared is named

    def test_are_refused_where_there_is_no_room(self):
        for flag in ("--aovs", "--half"):
            self.assert_refused("render", "scene.json", flag, named=[flag, ".exr", "--output"])
            for name in ("out.png", "out.pfm", "png:-"):
                self.assert_refused("render", "scene.json", flag, "-o", name, named=[flag, ".exr"])
        self.assert_refused("render", "scene.json", "--aovs", "-o", "out.exr", "--checkpoint", "sums", named=["--aovs", "--checkpoint"])
        self.assert_refused("render", "scene.json", "--aovs", "-o", "out.exr", "--accumulator", "atomic-float",
                            named=["--accumulator", "--aovs"])
        self.assert_refused("render", "scene.json", "--aovs", "-o", "out.exr", "--width", 65000, "--height", 65000, named=" GB")


class Half(CommandTest):
    def test_keeps_eleven_bits_of_colours(self):
        for more in ((), ("--aovs",)):
            self.run_well("render", "scene.json", "--spp", 5, *more, "-o", "whole.exr", "--quiet")
            self.run_well("render", "scene.json", "--spp", 5, *more, "--half", "-o", "half.exr", "--quiet")
            whole = read_exr((self.folder / "whole.exr").read_bytes())[2]
            half = read_exr((self.folder / "half.exr").read_bytes())[2]
            self.assertEqual(sorted(whole), sorted(half))
            for channel, (kind, values) in half.items():
                self.assertEqual(kind, "f" if channel in ("Z", *OTHERS) else "e", channel)
                rounded = [struct.unpack("<e", struct.pack("<e", v))[0] if kind == "e" else v for v in whole[channel][1]]
                self.assertEqual(values, rounded, channel)
        self.assertEqual(self.stats("--spp", 5)["hash"], self.stats("--spp", 5, "--half", "-o", "half.exr")["hash"])

    def test_says_what_it_cannot_hold(self):
        from command import SCENE, changed
        self.write("bright.json", changed(SCENE, "/background", [1e5, 1, 65504]))
        result = self.run_command("render", "bright.json", "--spp", 2, "--half", "-o", "half.exr", "--quiet")
        self.assertEqual(result.returncode, 0)
        self.assertRegex(result.stderr, r"\Araypool: half.exr: \d+ values of 65520 or more, [^\n]*\n\Z")
        colours = read_exr((self.folder / "half.exr").read_bytes())[2]
        self.assertEqual((colours["R"][1][0], colours["G"][1][0], colours["B"][1][0]), (math.inf, 1, 65504))


if __name__ == "__main__":
    main()
