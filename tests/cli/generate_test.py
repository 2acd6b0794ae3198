"""scenes/generate: as many shapes as asked for, the same file for the same seed, and scenes that engines agree on."""

import json

from command import main
from generator_case import GeneratorTest

KINDS = ("spheres", "quads", "cluster")


class GenerateTest(GeneratorTest):
    script = "generate"

    def test_scenes_have_the_shapes_asked_for_and_one_image(self):
        for kind in KINDS:
            for count in (1, 9, 1000):
                with self.subTest(kind=kind, count=count):
                    self.generate_well(count, kind, "-o", "made.json")
                    scene = json.loads((self.folder / "made.json").read_text())
                    self.assertEqual(len(scene["shapes"]), count)
                    self.assertIn(f"{count} shapes", scene["description"])
                    runs = [self.stats("made.json", "--width", 16, "--spp", 2, "--engine", engine, "-o", f"{engine}.png")
                            for engine in ("recursive", "wavefront")]
                    self.assertEqual(runs[0]["hash"], runs[1]["hash"])
                    self.assertTrue((self.folder / "wavefront.png").read_bytes().startswith(b"\x89PNG"))

    def test_paths_are_as_long_in_large_scenes_as_in_small_ones(self):
        for kind in KINDS:
            lengths = []
            for count in (300, 10_000):
                self.generate_well(count, kind, "-o", "made.json")
                lengths.append(self.stats("made.json", "--width", 40, "--spp", 4)["segments_per_path"])
            self.assertGreater(min(lengths), 1.5, kind)
            self.assertLess(max(lengths) / min(lengths), 1.3, kind)

    def test_the_seed_fixes_the_file(self):
        for kind in KINDS:
            self.generate_well(50, kind, "-o", "a.json")
            self.generate_well(50, kind, "-o", "b.json", "--seed", 0)
            self.generate_well(50, kind, "-o", "c.json", "--seed", 1)
            a, b, c = ((self.folder / name).read_bytes() for name in ("a.json", "b.json", "c.json"))
            self.assertEqual(a, b)
            self.assertNotEqual(a, c)

    def test_what_makes_no_sense_is_refused(self):
        self.assert_each_refused((0, "spheres", "-o", "x.json"), (10_000_001, "spheres", "-o", "x.json"),
                                 ("many", "quads", "-o", "x.json"),
                                 (10, "cubes", "-o", "x.json"), (10, "quads"), (10, "quads", "-o", "absent/x.json"))

    def test_more_threads_build_the_same_trees(self):
        self.generate_well(20_000, "quads", "-o", "made.json")
        told = {self.run_well("info", "made.json", environment={"OMP_NUM_THREADS": str(n)}).stdout for n in (1, 2, 5)}
        self.assertEqual(len(told), 1)
        self.assertIn("pool of a thread: ", told.pop())
        hashes = {self.stats("made.json", "--width", 16, "--spp", 1, "--threads", n)["hash"] for n in (1, 3)}
        self.assertEqual(len(hashes), 1)


if __name__ == "__main__":
    main()
