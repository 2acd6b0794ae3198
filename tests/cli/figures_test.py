"""What `render` writes beside the picture: statistics, the trace of its threads, and what each pixel cost."""

import json
import struct

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
            "seconds": {"read": float, "compile": float, "render": float, "aovs": float, "write": float, "total": float},
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
        self.assertLessEqual(sum(stats["seconds"][phase] for phase in ("read", "compile", "render", "aovs", "write")),
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


if __name__ == "__main__":
    main()
