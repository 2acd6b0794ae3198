"""Whatever is wrong with the input: one line that names the place, exit status 2, nothing written, no crash."""

import itertools
import json
import os
import signal
import struct
import zlib

from command import SCENE, CommandTest, changed, main


def png(width, height, rows=None):
    """A grey 8-bit PNG file."""
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    rows = height if rows is None else rows
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 0, 0, 0, 0)) +
            chunk(b"IDAT", zlib.compress(b"\0" * (width + 1) * rows)) + chunk(b"IEND", b""))


class BadScene(CommandTest):
    def assert_scene_refused(self, scene, *named):
        self.write("bad.json", scene)
        self.assert_refused("render", "bad.json", "-o", "out.png", "--stats", "stats.json", named=["bad.json", *named])

    def test_that_is_no_json_is_refused(self):
        for text in ("", "{", "[1, 2", "hello", "{} {}", '{"description": "a",}', '{"a": 1 "b": 2}', "{'a': 1}",
                     '{"description": "\x1b[2J\x7f" 3}', '{"description": "\ud800"}'.encode("utf-8", "surrogatepass"), b"\xff\xfe\0\0", b"\0" * 100,
                     json.dumps(SCENE) + "\0", json.dumps(SCENE) + "\0{"):
            with self.subTest(text=text):
                self.assert_scene_refused(text)

    def test_of_the_wrong_kind_is_refused(self):
        for text in ("[]", "3", "null", '"text"', "{}"):
            with self.subTest(text=text):
                self.assert_scene_refused(text)

    def test_nested_without_end_is_refused(self):
        self.assert_scene_refused("[" * 1_000_000)
        self.assert_scene_refused('{"a":' * 1_000_000)

    def test_with_an_unknown_key_is_refused(self):
        for folder in ("", "/image", "/camera", "/textures/tiles", "/materials/grey", "/materials/glass", "/shapes/0",
                       "/shapes/1", "/shapes/2"):
            with self.subTest(folder=folder):
                self.assert_scene_refused(changed(SCENE, folder + "/colour_of_magic", 1), "colour_of_magic", folder)

    def test_with_a_key_missing_is_refused(self):
        for place in ("/description", "/camera", "/camera/look_from", "/camera/look_at", "/background", "/shapes",
                      "/image/width", "/image/height", "/textures/tiles/scale", "/materials/grey/type",
                      "/materials/grey/albedo", "/materials/glass/ior", "/shapes/0/type", "/shapes/0/center",
                      "/shapes/0/radius", "/shapes/0/material", "/shapes/1/normal", "/shapes/2/edge_v"):
            with self.subTest(place=place):
                folder, key = place.rsplit("/", 1)
                self.assert_scene_refused(changed(SCENE, place), folder, key)

    def test_with_a_value_out_of_range_is_refused(self):
        for place, value in (
                ("/image/width", 0), ("/image/width", 10**9), ("/image/height", -1), ("/image/width", 1.5),
                ("/camera/vertical_fov_degrees", 0), ("/camera/vertical_fov_degrees", 180),
                ("/camera/defocus_angle_degrees", -1), ("/camera/shutter", [0.5, 0.25]), ("/camera/shutter", [0, 2]),
                ("/camera/shutter", [0]), ("/camera/up", [0, 0, 0]), ("/camera/focus_distance", 0),
                ("/background", [-1, 0, 0]), ("/background", [0, 0, 1e9]), ("/background", {"bottom": [0, 0, 0]}),
                ("/textures/tiles/scale", 0), ("/textures/tiles/even", [0, 0]), ("/textures/tiles/type", "marble"),
                ("/materials/grey/albedo", [1.7, 0, 0]), ("/materials/grey/albedo", [0, -0.1, 0]),
                ("/materials/grey/albedo", [0, 0, 0, 0]), ("/materials/grey/albedo", "no_such_texture"),
                ("/materials/grey/type", "cheese"), ("/materials/mirror/fuzz", 1.5), ("/materials/mirror/fuzz", -0.1),
                ("/materials/glass/ior", 0), ("/materials/glass/ior", -1.5), ("/materials/glass/ior", "1.5"),
                ("/shapes/0/radius", 0), ("/shapes/0/radius", -1), ("/shapes/0/radius", True),
                ("/shapes/0/center", [0, 0, "0"]), ("/shapes/0/material", "no_such_material"),
                ("/shapes/0/type", "torus"), ("/shapes/1/normal", [0, 0, 0]), ("/shapes/2/edge_v", [1, 0, 0]),
                ("/shapes/0/center", [0, 1e300, 0]), ("/shapes", {}), ("/camera", [])):
            with self.subTest(place=place, value=value):
                self.assert_scene_refused(changed(SCENE, place, value), place)

    def test_with_a_number_that_is_none_is_refused(self):
        import json
        for word in ("NaN", "-NaN", "nan", "Infinity", "-Infinity", "1e400", "-1e400", "0x10", "1.", ".5", "+1", "01"):
            for place in ("/shapes/0/radius", "/camera/vertical_fov_degrees", "/image/width"):
                with self.subTest(word=word, place=place):
                    text = json.dumps(changed(SCENE, place, 123456)).replace("123456", word)
                    self.assert_scene_refused(text)

    def test_with_an_impossible_camera_is_refused(self):
        self.assert_scene_refused(changed(SCENE, "/camera/look_at", SCENE["camera"]["look_from"]), "/camera/look_at",
                                  "look_from")
        self.assert_scene_refused(changed(SCENE, "/camera/up", [0, -1, -5]), "/camera", "parallel")
        self.assert_scene_refused(changed(SCENE, "/camera/defocus_angle_degrees", 0.5), "/camera", "focus_distance")

    def test_whose_texture_is_absent_or_broken_is_refused(self):
        whole = png(4, 4)
        self.write("text.png", "no image")
        self.write("empty.png", b"")
        self.write("half.png", whole[:len(whole) // 2])
        self.write("short.png", png(4, 4, rows=2))
        self.write("damaged.png", whole[:45] + bytes([whole[45] ^ 1]) + whole[46:])
        self.write("huge.png", png(2**31 - 1, 2**31 - 1, rows=1))
        self.write("whole.png", whole)
        (self.folder / "folder.png").mkdir()
        os.symlink("/etc/hostname", self.folder / "outside.png")
        for file in ("absent.png", "text.png", "empty.png", "half.png", "short.png", "damaged.png", "huge.png",
                     "folder.png", "outside.png", "../whole.png", "/dev/zero", ""):
            with self.subTest(file=file):
                self.assert_scene_refused(changed(SCENE, "/textures/tiles", {"type": "image", "file": file}),
                                          "/textures/tiles/file")
        good = changed(SCENE, "/textures/tiles", {"type": "image", "file": "whole.png"})
        self.write("good.json", changed(good, "/shapes/0/material", "tiled"))
        self.run_well("render", "good.json", "--spp", 1)

    def test_that_is_not_there_is_refused(self):
        for name in ("absent.json", "absent/scene.json", ".", "", "scene.json/", "pape", "a" * 5000):
            for command in ("render", "info"):
                with self.subTest(name=name[:20], command=command):
                    self.assert_refused(command, name, named=name)


class BadOption(CommandTest):
    def test_is_refused_by_its_name(self):
        for option, values in {
                "--spp": ("0", "-1", 2**31, "1e3", "3.5", "many", ""),
                "--width": ("0", "-5", 10**9, 65537, "wide"),
                "--depth": ("-1", 2**31, "deep"),
                "--seed": ("-1", 2**64, "1.5", "0x1", "", "seed"),
                "--samples": ("3", "3:3", "2:1", "0:101", "-1:3", ":", "1:", ":2", "1:2:3", "a:b", "0:1 ", 2**70),
                "--threads": ("0", "-2", 100000, 2**32, "two"),
                "--schedule": ("fair", "static,0", "static,-1", "dynamic,", "dynamic,1.5", "guided,2147483648", ",3",
                               "static,1,2", "Static", "tasks,0", "balanced,1"),
                "--grain": ("row", "tile", "tile:", "tile:0", "tile:-8", "tile:65537", "pixel:1", "tile:8x8"),
                "--target-error": ("0", "-1", "nan", "small", ""),
                "--precision": ("half", "long double"),
                "--sampler": ("halton", "Sobol", ""),
                "--engine": ("quick", ""),
                "--output": ("out", "out.gif", "out.png.txt", ".png/", ""),
                "--stats": ("",),
                "--trace": ("",),
                "--cost-image": ("out", "out.gif", "out.png.txt", ".png/", "out.png", ""),
                "--cost": ("time", ""),
                "--pool-rays": ("0", "-1", "1.5", "0KB", "-1KB", "KB", "1kb", "1 KB", "1KB ", "1B", "1KiB", "0x1KB", "1e3",
                                2**31, f"{2**31}KB", "99999999999999999999MB", "")}.items():
            for value in values:
                with self.subTest(option=option, value=value):
                    named = option if option not in ("--output", "--cost-image") or value == "" else str(value)
                    self.assert_refused("render", "scene.json", f"{option}={value}", named=named)

    def test_for_what_an_engine_cannot_know_is_refused(self):
        self.assert_refused("render", "scene.json", "--engine", "wavefront", "--cost-image", "cost.pfm",
                            named=["--cost-image", "recursive", "iterative"])
        for accumulator in ("owned", "owned-planar"):
            self.assert_refused("render", "scene.json", "--engine", "wavefront", "--pool-scope", "shared",
                                "--accumulator", accumulator, named=["--accumulator", "--pool-scope"])

    def test_that_names_one_file_for_two_things_is_refused(self):
        os.link(self.folder / "scene.json", self.folder / "other.json")
        os.symlink("scene.json", self.folder / "link.json")
        os.symlink("new.json", self.folder / "dangling.json")
        for name in ("scene.json", "./scene.json", "other.json", "link.json"):
            self.assert_refused("render", "scene.json", "--stats", name, named=["--stats", name, "the scene"])
            self.assert_refused("compare", "scene.json", "--check", "--json", name, named=["--json", name])
            self.assert_refused("advise", "scene.json", "--target-error", 1, "--json", name, named=["--json", name])
        self.assert_refused("render", "paper", "--stats", "new.json", "--trace", "dangling.json",
                            named=["--trace", "dangling.json", "--stats"])
        self.run_well("render", "scene.json", "--spp", 1, "-o", "a.png")
        self.assert_refused("diff", "a.png", "a.png", "-o", "a.png", named=["--output", "a.png"])
        self.run_well("render", "scene.json", "--spp", 1, "--checkpoint", "p.png")
        self.assert_refused("merge", "p.png", "-o", "p.png", named=["--output", "p.png", "part"])

    def test_for_what_adaptive_sampling_cannot_know_is_refused(self):
        adaptive = ("render", "scene.json", "--target-error", 0.1)
        self.assert_refused(*adaptive, "--samples", "0:5", named=["--samples", "--target-error"])
        self.assert_refused(*adaptive, "--spp", 1, named=["--spp", "--target-error"])
        self.assert_refused(*adaptive, "--engine", "wavefront", "--pool-scope", "shared", "--accumulator", "atomic-float",
                            named=["--accumulator", "--target-error"])

    def test_for_what_a_checkpoint_cannot_hold_is_refused(self):
        kept = ("render", "scene.json", "--checkpoint", "c.sums")
        for accumulator in ("atomic-float", "atomic-double"):
            self.assert_refused(*kept, "--engine", "wavefront", "--pool-scope", "shared", "--accumulator", accumulator,
                                named=["--accumulator", "--checkpoint"])
        self.assert_refused(*kept, "--every", "nan", named="--every")

    def test_that_names_one_file_twice_is_refused(self):
        (self.folder / "link").symlink_to(self.folder)
        for first, second in itertools.combinations(("--output", "--checkpoint", "--stats", "--trace", "--cost-image"), 2):
            self.assert_refused("render", "scene.json", first, "a.pfm", second, "link/a.pfm", named=[first, second])
        self.assert_refused("merge", "part.sums", "-o", "a.pfm", "--checkpoint", "./a.pfm", named=["--output", "--checkpoint"])

    def test_that_is_unknown_is_refused(self):
        self.assert_refused("render", "scene.json", "--antialias", named="--antialias")
        self.assert_refused("render", "scene.json", "second.json", named="second.json")
        self.assert_refused("render", "scene.json", "--spp", named="--spp")
        self.assert_refused("render", "scene.json", "--spp", 1, "--spp", 2, named="--spp")
        self.assert_refused("info", "scene.json", "--spp", 3, named="--spp")
        self.assert_refused("diff", "a.png", named="b")
        self.assert_refused("paint", named="paint")
        self.assert_refused(named="command")

    def test_in_the_environment_is_refused_by_its_name(self):
        self.assert_refused("render", "scene.json", environment={"OMP_NUM_THREADS": "100000"}, named="OMP_NUM_THREADS")
        self.assert_refused("render", "scene.json", "--threads", 3, environment={"OMP_THREAD_LIMIT": "2"},
                            named=["--threads", "OMP_THREAD_LIMIT"])

    def test_that_asks_for_more_memory_than_there_is_is_refused(self):
        self.write("huge.json", changed(SCENE, "/image", {"width": 65536, "height": 65536}))
        self.assert_refused("render", "huge.json", "--spp", 1, named="65536 x 65536")


class UnwritableOutput(CommandTest):
    def test_is_refused_before_anything_is_rendered(self):
        (self.folder / "folder.png").mkdir()
        os.symlink("loop.png", self.folder / "loop.png")
        for path in ("absent/out.png", "folder.png", "scene.json/out.png", "a" * 300 + ".png", "loop.png", "/proc/out.png"):
            with self.subTest(path=path):
                # A billion samples: refused at once, or the test runs out of time.
                self.assert_refused("render", "scene.json", "--spp", 10**9, "-o", path, named=path)
                self.assert_refused("render", "scene.json", "--spp", 10**9, "--stats", path, named=path)
                self.assert_refused("render", "scene.json", "--spp", 10**9, "--trace", path, named=path)
                self.assert_refused("render", "scene.json", "--spp", 10**9, "--cost-image", path, named=path)
                self.assert_refused("render", "scene.json", "--spp", 10**9, "-o", "good.png", "--stats", path,
                                    named=path)

    def test_on_a_full_device_is_refused(self):
        for name in ("full.png", "full.exr", "full.pfm"):
            os.symlink("/dev/full", self.folder / name)
            self.assert_refused("render", "scene.json", "--spp", 1, "-o", name, named=name)
        self.assert_refused("render", "scene.json", "--spp", 1, "--stats", "/dev/full", named="/dev/full")

    def test_without_rights_is_refused(self):
        if os.geteuid() == 0:
            self.skipTest("root may write anywhere")
        self.write("kept.png", "kept")
        (self.folder / "kept.png").chmod(0o444)
        self.assert_refused("render", "scene.json", "--spp", 1, "-o", "kept.png", named="kept.png")
        (self.folder / "locked").mkdir(mode=0o555)
        self.assert_refused("render", "scene.json", "--spp", 1, "-o", "locked/out.png", named="locked/out.png")

    def test_leaves_what_was_there(self):
        self.write("out.png", "old")
        self.assert_refused("render", "scene.json", "--spp", 0, "-o", "out.png", named="--spp")
        self.assert_refused("render", "absent.json", "-o", "out.png", named="absent.json")
        self.assert_refused("render", "scene.json", "--spp", 1, "-o", "out.png", "--stats", "absent/stats.json",
                            named="absent/stats.json")

    def test_of_text_is_one_line_and_status_one(self):
        for arguments in (("render", "scene.json", "--spp", "1"), ("info", "scene.json"), ("render", "--help")):
            with open("/dev/full", "w") as full:
                self.assert_one_line(self.run_command(*arguments, stdout=full), 1, "standard output")
        closed = self.run_command("render", "scene.json", "--spp", 1, stdout=None, preexec_fn=lambda: os.close(1))
        self.assert_one_line(closed, 1, "standard output")

    def test_of_a_reader_that_has_read_enough_is_as_of_any_tool(self):
        """Whether what is printed fits into a buffer, is flushed at the end, or is longer."""
        for arguments in (("render", "scene.json", "--spp", "1", "-o", "out.png"), ("info", "scene.json"), ("scenes",),
                          ("render", "--help"), ("manual",), ("manual", "bash"), ("--version",)):
            reader, writer = os.pipe()
            os.close(reader)
            with os.fdopen(writer, "wb") as closed:
                ended = self.run_command(*arguments, stdout=closed)
            self.assertEqual((ended.returncode, ended.stderr), (128 + signal.SIGPIPE, ""), arguments)
        self.assertTrue((self.folder / "out.png").exists())  # what was asked for was done


if __name__ == "__main__":
    main()
