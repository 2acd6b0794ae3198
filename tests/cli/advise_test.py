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
        self.assertEqual(advice["needs"], ["flat", "metal"])
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


if __name__ == "__main__":
    main()
