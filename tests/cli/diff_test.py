"""What `diff` says of two images, and of what it does not compare."""

import re
import struct

from command import CommandTest, main


def exr(channels, data, display, extra=b""):
    """An uncompressed EXR file of float channels, each of which has one value everywhere; windows are x, y, x, y."""
    def attribute(name, kind, value):
        return name + b"\0" + kind + b"\0" + struct.pack("<i", len(value)) + value

    names = sorted(channels)
    header = b"\x76\x2f\x31\x01" + struct.pack("<i", 2)
    header += attribute(b"channels", b"chlist", b"".join(
        n.encode() + b"\0" + struct.pack("<iiii", 2, 0, 1, 1) for n in names) + b"\0")
    header += attribute(b"compression", b"compression", b"\0")
    header += attribute(b"dataWindow", b"box2i", struct.pack("<4i", *data))
    header += attribute(b"displayWindow", b"box2i", struct.pack("<4i", *display))
    header += attribute(b"lineOrder", b"lineOrder", b"\0")
    header += attribute(b"pixelAspectRatio", b"float", struct.pack("<f", 1))
    header += attribute(b"screenWindowCenter", b"v2f", struct.pack("<ff", 0, 0))
    header += attribute(b"screenWindowWidth", b"float", struct.pack("<f", 1)) + extra + b"\0"
    width, rows = data[2] - data[0] + 1, range(data[1], data[3] + 1)
    line = b"".join(struct.pack("<f", channels[n]) * width for n in names)
    chunks = [struct.pack("<ii", y, len(line)) + line for y in rows]
    first = len(header) + 8 * len(chunks)
    return header + b"".join(struct.pack("<q", first + i * len(c)) for i, c in enumerate(chunks)) + b"".join(chunks)


class Diff(CommandTest):
    def test_ends_with_zero_for_the_same_bits_and_with_one_for_others(self):
        for kind in ("exr", "pfm", "png"):
            for name, seed in (("a", 0), ("again", 0), ("b", 1)):
                self.run_well("render", "scene.json", "--spp", 1, "--seed", seed, "-o", f"{name}.{kind}")
            same = self.run_well("diff", f"a.{kind}", f"again.{kind}")
            self.assertRegex(same.stdout, r"pixels that differ 0 of 48\nMSE +0\nRMSE +0\n")
            other = self.run_command("diff", f"a.{kind}", f"b.{kind}", "-o", "where.png")
            self.assertEqual((other.returncode, other.stderr), (1, ""))
            self.assertRegex(other.stdout, r"pixels that differ [1-9]\d* of 48\n")
            self.assertRegex(other.stdout, r"\ntile bias +t = -?\d+\.\d\d over 48 pixels in columns 0 to 7, lines 0 to 5, ")
            self.assertTrue(other.stdout.endswith("\nwhere.png\n"))
        self.run_well("diff", "a.exr", "a.pfm")

    def test_tolerance_on_a_named_measure_decides_the_exit_status(self):
        for name, seed in (("a", 0), ("b", 1)):
            self.run_well("render", "scene.json", "--spp", 4, "--seed", seed, "-o", f"{name}.exr")
        text = self.run_command("diff", "a.exr", "b.exr").stdout
        rmse = float(re.search(r"\nRMSE +(\S+)\n", text)[1])
        self.run_well("diff", "a.exr", "b.exr", "--tolerance", f"rmse={1.001 * rmse}")
        self.run_well("diff", "a.exr", "b.exr", "--tolerance", f"rmse={1.001 * rmse}", "--tolerance", "pixels=48")
        for tolerances in ([f"rmse={0.999 * rmse}"], [f"rmse={1.001 * rmse}", "ulp=1"]):
            beyond = self.run_command("diff", "a.exr", "b.exr", *[w for t in tolerances for w in ("--tolerance", t)])
            self.assertEqual(beyond.returncode, 1)
            self.assertIn(f"beyond tolerance   {tolerances[-1].split('=')[0]} is ", beyond.stdout)
        for wrong in ("rmse", "rmse=", "rmse=-1", "rmse=nan", "rmse=inf", "rsme=1", "psnr=40", "rmse=1x"):
            self.assert_refused("diff", "a.exr", "b.exr", "--tolerance", wrong, named=["--tolerance", wrong])

    def test_says_of_how_many_samples_it_can_judge(self):
        for name, spp, seed in (("few", 2, 0), ("many", 64, 1), ("also_many", 64, 2)):
            self.run_well("render", "cornell", "--width", 32, "--spp", spp, "--seed", seed, "-o", f"{name}.exr", "--quiet")
            self.run_well("render", "cornell", "--width", 32, "--spp", spp, "--seed", seed, "-o", f"{name}.pfm", "--quiet")
        equal = self.run_command("diff", "many.exr", "also_many.exr").stdout
        self.assertRegex(equal, r"of images: (what noise makes|a bias)\n")
        unequal = self.run_command("diff", "few.exr", "many.exr").stdout
        self.assertRegex(unequal, r"of images: (what noise makes|no verdict: of 2 and 64 samples a pixel, the fewer .*)\n")
        self.run_well("render", "cornell", "--width", 32, "--spp", 64, "--depth", 2, "-o", "dark.exr", "--quiet")
        self.assertIn(": a bias\n", self.run_command("diff", "dark.exr", "many.exr").stdout)
        unknown = self.run_command("diff", "dark.exr", "many.pfm").stdout
        self.assertIn(": a bias if both have as many samples a pixel, which these files do not say\n", unknown)

    def test_says_none_where_there_is_nothing_to_estimate_from(self):
        nan = struct.pack("<f", float("nan"))
        self.write("nan.pfm", b"PF\n2 2\n-1\n" + nan * 12)
        self.write("one.pfm", b"PF\n1 1\n-1\n" + struct.pack("<3f", 1, 2, 3))
        self.write("other.pfm", b"PF\n1 1\n-1\n" + struct.pack("<3f", 3, 2, 2))
        for a, b in (("nan.pfm", "nan.pfm"), ("one.pfm", "other.pfm")):
            self.assertIn("\ntile bias          none: ", self.run_command("diff", a, b).stdout)

    def test_names_what_it_does_not_compare_and_then_does_not_end_with_zero(self):
        from zlib import compress, crc32

        def chunk(name, data):
            return struct.pack(">I", len(data)) + name + data + struct.pack(">I", crc32(name + data))

        for name, alpha in (("a", 255), ("b", 3)):
            self.write(f"{name}.png", b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", 1, 1, 8, 6, 0, 0, 0)) +
                       chunk(b"IDAT", compress(bytes([0, 9, 9, 9, alpha]))) + chunk(b"IEND", b""))
        alike = self.run_command("diff", "a.png", "b.png")
        self.assertEqual(alike.returncode, 1)
        self.assertIn("pixels that differ 0 of 1\n", alike.stdout)
        self.assertIn("not compared       alpha of A\nnot compared       alpha of B\n", alike.stdout)

    def test_names_channels_and_primaries_of_exr_that_it_does_not_compare(self):
        grey, window = {"R": 0.5, "G": 0.5, "B": 0.5}, (0, 0, 3, 2)
        wide = b"chromaticities\0chromaticities\0" + struct.pack("<i8f", 32, 0.7, 0.3, 0.2, 0.7, 0.1, 0.05, 0.31, 0.33)
        self.write("plain.exr", exr(grey, window, window))
        self.write("alpha.exr", exr(grey | {"A": 0.5}, window, window))
        self.write("depth.exr", exr(grey | {"Z": 9, "N.x": 1}, window, window))
        self.write("wide.exr", exr(grey, window, window, wide))
        for name, lines in (("alpha", ["channel A of B"]), ("depth", ["channel N.x of B", "channel Z of B"]),
                            ("wide", ["primaries: those of A are sRGB, of B red 0.7 0.3, .*"])):
            run = self.run_command("diff", "plain.exr", f"{name}.exr", "--tolerance", "rmse=1")
            self.assertEqual((run.returncode, run.stderr), (1, ""))
            self.assertIn("pixels that differ 0 of 12\n", run.stdout)
            for line in lines:
                self.assertRegex(run.stdout, f"\nnot compared       {line}\n")
        self.run_well("diff", "wide.exr", "wide.exr")

    def test_places_data_windows_on_the_display_window(self):
        half, display = {"R": 0.5, "G": 0.5, "B": 0.5}, (0, 0, 3, 2)
        self.write("whole.exr", exr(half, display, display))
        self.write("part.exr", exr(half, (1, 1, 2, 5), display))
        part = self.run_command("diff", "whole.exr", "part.exr")
        self.assertEqual((part.returncode, part.stderr), (1, ""))
        self.assertIn("pixels that differ 8 of 12\n", part.stdout)  # all but two columns of two lines are black
        self.assertIn("not compared       pixels of B outside of its display window\n", part.stdout)
        self.write("inside.exr", exr(half, (1, 1, 2, 2), display))
        inside = self.run_well("diff", "inside.exr", "inside.exr")
        self.assertNotIn("not compared", inside.stdout)
        self.write("shown.exr", exr(half, (0, 0, 1, 1), (0, 0, 1, 1)))
        self.assert_refused("diff", "whole.exr", "shown.exr", named=["4 x 3", "2 x 2"])
        self.write("claim.exr", exr(half, display, (0, 0, 10**9, 10**9)))
        self.assert_refused("diff", "claim.exr", "claim.exr", named=["claim.exr", "display window"])

    def test_ends_with_two_for_what_cannot_be_compared(self):
        self.run_well("render", "scene.json", "--spp", 1, "-o", "a.pfm")
        self.run_well("render", "scene.json", "--spp", 1, "--width", 4, "-o", "small.pfm")
        self.write("broken.pfm", (self.folder / "a.pfm").read_bytes()[:-1])
        self.write("broken.exr", "no image")
        self.assert_refused("diff", "a.pfm", "absent.pfm", named="absent.pfm")
        self.assert_refused("diff", "broken.pfm", "a.pfm", named="broken.pfm")
        self.assert_refused("diff", "a.pfm", "broken.exr", named="broken.exr")
        self.assert_refused("diff", "a.pfm", "scene.json", named="scene.json")
        self.assert_refused("diff", "a.pfm", "small.pfm", "-o", "where.png", named=["8 x 6", "4 x 3"])
        self.assert_refused("diff", "a.pfm", "a.pfm", "-o", "absent/where.png", named="absent/where.png")


if __name__ == "__main__":
    main()
