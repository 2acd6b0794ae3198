"""`raypool advise`: prints a command that runs, writes what it found, and refuses what cannot be advised on."""

import json
import shlex

from command import CommandTest, main


class Advise(CommandTest):
    def test_prints_a_render_that_runs_and_writes_the_same_to_a_file(self):
        self.write("my scene.json", (self.folder / "scene.json").read_bytes())
        said = self.run_well("advise", "my scene.json", "--target-error", 0.05, "--threads", 1, "--json", "a.json").stdout
        line = said.splitlines()[-2]
        words = shlex.split(line)
        self.assertEqual(words[:3], ["raypool", "render", "my scene.json"])
        self.run_well(*words[1:], "-o", "out.pfm", "--stats", "stats.json")
        advice = json.loads((self.folder / "a.json").read_text())
        best = advice["offers"][0]
        self.assertEqual(best["command"], line)
        self.assertLessEqual(best["rmse_interval"][1], 0.05)
        self.assertLess(best["rmse_interval"][0], best["rmse"])
        settings = json.loads((self.folder / "stats.json").read_text())["settings"]
        self.assertEqual(settings["spp"], best["spp"])
        self.assertEqual(advice["features"], ["planar", "metal"])
        self.assertIn("float instead of double", [change["what"] for change in advice["changes"]])

    def test_takes_a_budget_of_time(self):
        self.run_well("advise", "scene.json", "--target-time", 0.05, "--threads", 1, "--quiet", "--json", "a.json")
        best = json.loads((self.folder / "a.json").read_text())["offers"][0]
        self.assertLessEqual(best["seconds"], 0.05)

    def test_refuses_what_makes_no_sense(self):
        self.assert_refused("advise", "scene.json", named=["--target-error", "--target-time"])
        self.assert_refused("advise", "scene.json", "--target-error", 0.1, "--target-time", 1, named="--target-error")
        self.assert_refused("advise", "scene.json", "--target-error", 0, named="--target-error")
        self.assert_refused("advise", "absent.json", "--target-error", 0.1, named="absent.json")
        self.assert_refused("advise", "scene.json", "--target-error", 0.1, "--json", "absent/a.json", named="absent")

    def test_promises_nothing_where_its_trials_found_too_little_light(self):
        quads = [([0, 0, 0], [1, 0, 0], [0, 0, 1]), ([0, 1, 0], [1, 0, 0], [0, 0, 1]), ([0, 0, 0], [0, 1, 0], [0, 0, 1]),
                 ([1, 0, 0], [0, 1, 0], [0, 0, 1]), ([0, 0, 0], [1, 0, 0], [0, 1, 0]), ([0, 0, 1], [1, 0, 0], [0, 1, 0])]
        shapes = [{"type": "quad", "corner": c, "edge_u": u, "edge_v": v, "material": "grey"} for c, u, v in quads]
        lamp = {"type": "quad", "corner": [0.5, 0.999, 0.5], "edge_u": [0.001, 0, 0], "edge_v": [0, 0, 0.001],
                "material": "lamp"}
        self.write("room.json", {
            "description": "A closed room with a tiny lamp.",
            "image": {"width": 16, "height": 16},
            "camera": {"look_from": [0.5, 0.45, 0.02], "look_at": [0.5, 0.4, 1], "vertical_fov_degrees": 75},
            "background": [0, 0, 0],
            "materials": {"grey": {"type": "diffuse", "albedo": [0.3, 0.3, 0.3]},
                          "lamp": {"type": "emissive", "radiance": [9e5, 9e5, 9e5]}},
            "shapes": [*shapes, lamp]})
        refused = self.run_command("advise", "room.json", "--target-error", 0.1, "--threads", 1)
        self.assertEqual((refused.returncode, refused.stdout), (1, ""))
        self.assertIn("cannot promise anything", refused.stderr)
        self.assertEqual(refused.stderr.count("\n"), 1)


if __name__ == "__main__":
    main()
