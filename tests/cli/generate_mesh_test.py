"""scenes/generate_mesh: about as many triangles as asked for, the same files for the same seed, one image of all engines."""

import json
import re

from command import main
from generator_case import GeneratorTest

KINDS = ("blob", "terrain", "field", "room", "needles", "instances")


class GenerateMeshTest(GeneratorTest):
    script = "generate_mesh"

    def test_meshes_have_about_the_triangles_asked_for_and_one_image(self):
        for kind in KINDS:
            for count in (1000, 20_000):
                with self.subTest(kind=kind, count=count):
                    self.generate_well(count, kind, "-o", "made.json")
                    told = self.run_well("info", "made.json").stdout
                    triangles = int(re.search(r"show (\d+) triangles|meshes: 1, of (\d+) triangles", told).expand(r"\1\2"))
                    self.assertLess(abs(triangles - count), 0.25 * count)
                    self.assertIn(f"{triangles} triangles", json.loads((self.folder / "made.json").read_text())["description"])
                    runs = [self.stats("made.json", "--width", 16, "--spp", 2, "--engine", engine, "--threads", threads)
                            for engine in ("recursive", "wavefront") for threads in (1, 2)]
                    self.assertEqual(len({run["hash"] for run in runs}), 1)
                    self.assertGreater(runs[0]["segments_per_path"], 3)

    def test_the_seed_fixes_the_files(self):
        for kind in KINDS:
            made = []
            for name, seed in (("a", 0), ("b", 0), ("c", 1)):
                self.generate_well(500, kind, "-o", f"{name}.json", "--seed", seed)
                shapes = json.loads((self.folder / f"{name}.json").read_text())["shapes"]
                made.append(((self.folder / f"{name}.ply").read_bytes(), str(shapes).replace(f"{name}.ply", "")))
            self.assertEqual(made[0], made[1])
            self.assertNotEqual(made[0], made[2])

    def test_a_smooth_mesh_is_the_same_with_normals_and_another_image(self):
        for kind in KINDS:
            hashes = []
            for name, options in (("flat", ()), ("smooth", ("--smooth",))):
                self.generate_well(1000, kind, "-o", f"{name}.json", *options)
                hashes.append(self.stats(f"{name}.json", "--width", 16, "--spp", 1)["hash"])
            self.assertIn(b"property float nz\n", (self.folder / "smooth.ply").read_bytes())
            if kind != "needles":  # whose triangles share no vertex
                self.assertNotEqual(hashes[0], hashes[1], kind)

    def test_what_makes_no_sense_is_refused(self):
        self.assert_each_refused((11, "blob", "-o", "x.json"), (15_000_001, "blob", "-o", "x.json"), ("many", "blob", "-o", "x.json"),
                                 (1000, "bunny", "-o", "x.json"), (1000, "blob"), (1000, "blob", "-o", "absent/x.json"))

    def test_a_mesh_that_is_missing_or_broken_or_elsewhere_is_refused_where_it_is_named(self):
        self.generate_well(500, "field", "-o", "made.json")
        scene = json.loads((self.folder / "made.json").read_text())
        (self.folder / "short.ply").write_bytes((self.folder / "made.ply").read_bytes()[:-1])
        for file, says in (("absent.ply", "absent.ply"), ("short.ply", "short.ply"), ("../made.ply", '".."'),
                           ("made.json", "made.json")):
            scene["shapes"][-1]["file"] = file
            (self.folder / "broken.json").write_text(json.dumps(scene))
            self.assert_refused("info", "broken.json", named=["broken.json: /shapes/7/file: must ", says])


if __name__ == "__main__":
    main()
