"""What `render`, `info` and `diff` write and print, and the smallest and oddest renders that must work."""

import json
import os
import pty
import re
import struct
import subprocess

from command import SCENE, CommandTest, changed, main


def exr_attributes(data):
    """The attributes of type string in the header of an EXR file."""
    assert data[:4] == b"\x76\x2f\x31\x01"
    attributes, at = {}, 8
    while data[at] != 0:
        name, kind, rest = data[at:].split(b"\0", 2)
        size = struct.unpack("<i", rest[:4])[0]
        if kind == b"string":
            attributes[name.decode()] = rest[4:4 + size].decode()
        at += len(name) + len(kind) + 2 + 4 + size
    return attributes


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
        self.assertEqual(sums["step"], 2.0**-27)  # a radiance of 1e6 (2^21 is twice that) and 2^14 samples, in 62 bits
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

    def test_says_what_the_depth_cuts_off_at_most(self):
        stats = self.stats("--spp", 1, "--depth", 3)
        summary = self.run_well("render", "scene.json", "--spp", 1, "--depth", 3).stdout
        self.assertGreater(stats["truncation_bound"], 0)
        self.assertIn(f"depth 3 cuts off a radiance of at most {stats['truncation_bound']:.3g} a pixel\n", summary)

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


class Stats(CommandTest):
    def assert_kinds(self, kinds, values, place=""):
        """Every key is there and of its kind; a kind is a type, a dict of kinds, or a list of one kind."""
        for key, kind in kinds.items():
            self.assertIn(key, values, place)
            value, where = values[key], f"{place}/{key}"
            if isinstance(kind, dict):
                self.assert_kinds(kind, value, where)
            elif isinstance(kind, list):
                self.assertTrue(value, where)
                for item in value:
                    self.assert_kinds({"item": kind[0]}, {"item": item}, where)
            else:
                self.assertIs(type(value), kind, where)

    def test_hold_every_figure(self):
        stats = self.stats("--spp", 4, "--threads", 2, "--grain", "pixel", "--count-work", "-o", "out.png")
        self.assert_kinds({
            "hash": str, "paths": int, "segments": int, "segments_per_path": float, "mpaths_per_s": float,
            "seconds": {"read": float, "compile": float, "render": float, "write": float, "total": float},
            "sample_statistics": {"non_finite": int, "clamped": int, "clamped_energy": float},
            "features": [str],
            "settings": {"scene": str, "width": int, "height": int, "spp": int, "samples": [int], "depth": int,
                         "seed": int, "precision": str, "engine": str, "threads": int, "schedule": str, "grain": str,
                         "count_work": bool},
            "environment": {"version": str, "commit": str, "compiler": str, "flags": str, "build": str, "cpu": str,
                            "cores": int, "os": str, "openmp": {}},
            "threads": [{"paths": int, "segments": int, "box_tests": int, "primitive_tests": int, "busy_s": float,
                         "wait_s": float}],
        }, stats)
        self.assertRegex(stats["hash"], r"\A[0-9a-f]{16}\Z")
        self.assertEqual(stats["paths"], 4 * 8 * 6)
        self.assertEqual(len(stats["threads"]), 2)
        for figure in ("paths", "segments"):
            self.assertEqual(sum(thread[figure] for thread in stats["threads"]), stats[figure])
        self.assertGreaterEqual(sum(thread["primitive_tests"] for thread in stats["threads"]), stats["segments"])
        for thread in stats["threads"]:
            self.assertGreaterEqual(min(thread["busy_s"], thread["wait_s"]), 0)
            self.assertLessEqual(thread["busy_s"] + thread["wait_s"], 1.01 * stats["seconds"]["render"] + 1e-3)
        self.assertLessEqual(sum(stats["seconds"][phase] for phase in ("read", "compile", "render", "write")),
                             stats["seconds"]["total"])
        self.assertIn("-ffp-contract=off", stats["environment"]["flags"])
        self.assertNotIn("-ffast-math", stats["environment"]["flags"])

    def test_hold_no_count_that_was_not_made(self):
        for thread in self.stats("--spp", 1)["threads"]:
            self.assertEqual((thread["box_tests"], thread["primitive_tests"]), (None, None))

    def test_name_the_features_of_the_scene(self):
        self.assertEqual(self.stats("--spp", 1)["features"], ["planar", "metal"])
        self.write("scene.json", changed(SCENE, "/shapes/0/material", "glass"))
        self.assertEqual(self.stats("--spp", 1)["features"], ["planar", "metal", "dielectric"])

    def test_show_that_openmps_variables_are_obeyed(self):
        environment = {"OMP_NUM_THREADS": "3", "OMP_SCHEDULE": "guided,5"}
        stats = self.stats("--spp", 1, environment=environment)
        self.assertEqual(stats["settings"]["threads"], 3)
        self.assertEqual(len(stats["threads"]), 3)
        self.assertEqual(stats["settings"]["schedule"], "guided,5")
        self.assertEqual(stats["environment"]["openmp"], environment)

        stats = self.stats("--spp", 1, "--threads", 2, "--schedule", "static,4", environment=environment)
        self.assertEqual((stats["settings"]["threads"], stats["settings"]["schedule"]), (2, "static,4"))
        for said, understood in (("static", "static"), ("dynamic,2", "dynamic,2")):
            self.assertEqual(self.stats("--spp", 1, environment={"OMP_SCHEDULE": said})["settings"]["schedule"],
                             understood)
        settings = self.stats("--spp", 1)["settings"]
        self.assertEqual((settings["engine"], settings["schedule"]), ("wavefront", "balanced"))

    def test_are_in_the_header_of_an_exr_file(self):
        stats = self.stats("--spp", 2, "--seed", 2**64 - 1, "--grain", "tile:4", "-o", "out.exr")
        attributes = exr_attributes((self.folder / "out.exr").read_bytes())
        self.assertEqual(attributes["raypool.hash"], stats["hash"])
        for key, value in stats["settings"].items():
            text = value if isinstance(value, str) else json.dumps(value, separators=(",", ":"))
            self.assertEqual(attributes["raypool." + key], text)


class Trace(CommandTest):
    SHARED = ("--engine", "wavefront", "--pool-scope", "shared", "--refill", "drain", "--pool-rays", 40, "--pool-batch", 16)

    def trace(self, *arguments):
        """Stats and trace of a render whose hash is that of a render without a trace."""
        stats = self.stats("--spp", 3, "--threads", 2, "--trace", "trace.json", *arguments)
        self.assertEqual(stats["hash"], self.stats("--spp", 3)["hash"])
        return stats, json.loads((self.folder / "trace.json").read_text())

    def assert_schema(self, trace):
        """As the Trace Event Format has it: what Perfetto and chrome://tracing read."""
        self.assertEqual(set(trace), {"displayTimeUnit", "otherData", "traceEvents"})
        for event in trace["traceEvents"]:
            self.assertIn(event["ph"], ("M", "X", "C"))
            self.assertIs(type(event["name"]), str)
            self.assertIn(type(event["ts"]), (int, float))
            self.assertEqual((type(event["pid"]), type(event["tid"])), (int, int))
            self.assertEqual("dur" in event, event["ph"] == "X")
            if event["ph"] != "M":
                self.assertTrue(all(type(value) is int for value in event["args"].values()))
        names = {(e["name"], e["tid"]): e["args"]["name"] for e in trace["traceEvents"] if e["ph"] == "M"}
        self.assertEqual(names, {("process_name", 0): "raypool", ("thread_name", 0): "thread 0",
                                 ("thread_name", 1): "thread 1"})

    def spans(self, trace, thread):
        """(name, begin, end) in nanoseconds, which nest."""
        spans = [(e["name"], round(e["ts"] * 1000), round((e["ts"] + e["dur"]) * 1000))
                 for e in trace["traceEvents"] if e["ph"] == "X" and e["tid"] == thread]
        around = []
        for name, begin, end in sorted(spans, key=lambda span: (span[1], -span[2])):
            while around and around[-1] <= begin:
                around.pop()
            self.assertLessEqual(end, around[-1] if around else end, name)
            around.append(end)
        return spans

    def test_of_a_shared_pool_shows_rounds_stages_waiting_and_occupancy(self):
        stats, trace = self.trace(*self.SHARED)
        self.assert_schema(trace)
        rounds = len(stats["rounds"])
        for thread in (0, 1):
            spans = self.spans(trace, thread)
            names = [name for name, _, _ in spans]
            self.assertEqual(names.count("round"), rounds)
            self.assertEqual(names.count("wait"), 3 * rounds + 2)
            waited = sum(end - begin for name, begin, end in spans if name == "wait") * 1e-9
            self.assertAlmostEqual(waited, stats["threads"][thread]["wait_s"], delta=1e-9 * len(spans) + 1e-6)
        names = {e["name"] for e in trace["traceEvents"]}
        self.assertLessEqual({"generate", "intersect", "shade", "accumulate", "append"}, names)
        occupancy = [e["args"]["records"] for e in trace["traceEvents"] if e["ph"] == "C"]
        self.assertEqual(len(occupancy), rounds)
        self.assertEqual((max(occupancy) <= 40, max(occupancy) > 16, occupancy[-1]), (True, True, 0))
        self.assertEqual(trace["otherData"]["events_dropped"], 0)
        self.assertEqual(trace["otherData"]["raypool.hash"], stats["hash"])

    def test_of_other_engines_shows_their_items(self):
        for engine, items in ((("--engine", "recursive"), "item"), (("--engine", "iterative", "--grain", "line"), "line"),
                              ((), "round")):
            _, trace = self.trace(*engine)
            self.assert_schema(trace)
            self.assertIn(items, {name for thread in (0, 1) for name, _, _ in self.spans(trace, thread)})

    def test_says_how_much_it_holds_and_what_it_left_out(self):
        result = self.run_well("render", "scene.json", "--spp", 1, "--trace", "trace.json")
        self.assertRegex(result.stdout, r"\ntrace\.json: \d+ events\n\Z")
        self.write("scene.json", changed(SCENE, "/image", {"width": 400, "height": 300}))
        result = self.run_well("render", "scene.json", "--spp", 1, "--threads", 1, "--engine", "recursive", "--grain",
                               "tile:1", "--trace", "trace.json")
        left_out = 400 * 300 + 2 - 100_000
        self.assertIn(f"\ntrace.json: 100000 events, and {left_out} that are left out", result.stdout)
        trace = json.loads((self.folder / "trace.json").read_text())
        self.assertEqual(trace["otherData"]["events_dropped"], left_out)


class CostImage(CommandTest):
    def costs(self, *arguments):
        stats = self.stats("--spp", 3, "--cost-image", "cost.pfm", *arguments)
        self.assertEqual(stats["hash"], self.stats("--spp", 3)["hash"])
        self.assertIn(stats["settings"]["engine"], ("recursive", "iterative"))
        _, _, values = self.pixels("cost.pfm")
        self.assertEqual(values[0::3], values[1::3])
        self.assertEqual(values[0::3], values[2::3])
        return stats, values[0::3]

    def test_adds_up_to_the_totals(self):
        stats, tests = self.costs("--threads", 3, "--grain", "tile:2")
        total = sum(thread["box_tests"] + thread["primitive_tests"] for thread in stats["threads"])
        self.assertEqual(sum(tests), total)
        stats, segments = self.costs("--cost", "segments", "--engine", "iterative")
        self.assertEqual(sum(segments), stats["segments"])
        _, nanoseconds = self.costs("--cost", "ns")
        self.assertGreater(min(nanoseconds), 0)

    def test_is_values_in_either_format_with_the_kind_of_cost(self):
        for cost in ("segments", "tests", "ns"):
            result = self.run_well("render", "scene.json", "--spp", 1, "--cost", cost, "--cost-image", "cost.pfm")
            self.assertTrue(result.stdout.endswith("\ncost.pfm\n"))
        self.costs("--cost", "segments")
        self.run_well("render", "scene.json", "--spp", 3, "--cost", "segments", "--cost-image", "cost.exr")
        self.run_well("diff", "cost.exr", "cost.pfm")
        self.assertEqual(exr_attributes((self.folder / "cost.exr").read_bytes())["raypool.cost"], "segments")


class PoolRays(CommandTest):
    def test_may_be_bytes_of_whole_records(self):
        # 52 and 88 bytes a record; quads and planes run on code for every feature, whose records have a time too.
        for text, precision, rays in (("100", "float", 100), ("1KB", "float", 1024 // 56), ("2MB", "float", 2**21 // 56),
                                      ("512KB", "double", 2**19 // 96)):
            stats = self.stats("--spp", 1, "--engine", "wavefront", "--pool-rays", text, "--precision", precision)
            self.assertEqual(stats["settings"]["pool"]["rays"], rays)
        self.write("scene.json", changed(changed(SCENE, "/shapes/2"), "/shapes/1"))
        stats = self.stats("--spp", 1, "--engine", "wavefront", "--pool-rays", "1KB")
        self.assertEqual((stats["settings"]["pool"]["rays"], stats["record_bytes"]), (1024 // 52, 52))


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


class Info(CommandTest):
    def test_prints_needs_bytes_and_trees(self):
        text = self.run_well("info").stdout
        self.assertIn("features: motion, defocus, metal, fuzz, dielectric, checker\n", text)
        self.assertRegex(text, r"\bray record: \d+ bytes in float, \d+ in double\n")
        self.assertRegex(text, r"\bsphere tree: \d+ nodes \d+ wide, \d+ levels, \d+ leaves holding \d+ ")
        self.assertRegex(self.run_well("info", "scene.json").stdout, r"1 spheres, 1 quads, 1 planes")

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
