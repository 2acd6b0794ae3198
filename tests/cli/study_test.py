"""`raypool study`: every study runs on tiny inputs, leaves data, summary and pictures, and survives Ctrl-C."""

import csv
import json
import os
import shutil
import signal
import subprocess
import time

from command import SCENE, CommandTest, changed, main

TINY = ["--quick", "--width", "32", "--spp", "2", "--repeats", "1"]


def rows_of(folder):
    with open(folder / "data.csv", newline="") as file:
        return list(csv.DictReader(file))


class StudyTest(CommandTest):
    always = {"OMP_WAIT_POLICY": "passive"}  # other tests run beside, which threads that spin would starve

    def names(self):
        listing = self.run_well("study").stdout
        return [line.split()[0] for line in listing.splitlines()]

    def check_folder(self, folder):
        run = json.loads((folder / "run.json").read_text())
        self.assertGreater(len(rows_of(folder)), 0)
        for part in ("commit", "compiler", "flags", "cpu"):
            self.assertIn(part, run["environment"])
        summary = (folder / "summary.md").read_text()
        self.assertNotRegex(summary, r"(?i)\b(nan|inf)\b")
        self.assertGreater(len(run["pictures"]), 0)
        page = (folder / "index.html").read_text()
        self.assertEqual(page.count("<svg"), len(run["pictures"]))  # none that could not be drawn for it
        for picture in run["pictures"]:
            self.assertIn(f"{picture['name']}.png", summary)
            self.assertGreater(len(picture["caption"]), 40)
            self.assertTrue((folder / f"{picture['name']}.svg").read_text().startswith("<?xml"))
            self.assertTrue((folder / f"{picture['name']}.png").read_bytes().startswith(b"\x89PNG"))
        return run

    def check_verdicts(self, rows):
        """Ours holds its tolerance wherever it is asked to, and each naive method breaks somewhere."""
        broken = {}
        for row in rows:
            if row["kind"] != "curve":
                continue
            is_broken = float(row["error"]) > float(row["tolerance"])
            key = (row["id"], row["method"], row["method_kind"])
            broken[key] = broken.get(key, False) or (is_broken and (row["is_asked"] == "1" or row["method_kind"] != "ours"))
        self.assertGreater(len(broken), 100)
        self.assertEqual([key for key, is_broken in broken.items() if is_broken and key[2] == "ours"], [])
        self.assertEqual([key for key, is_broken in broken.items() if not is_broken and key[2] == "naive"], [])

    def test_every_study_leaves_data_summary_and_pictures(self):
        names = self.names()
        self.assertIn("schedules", names)
        for name in names:
            with self.subTest(name):
                threads = () if name in ("ranks", "traversal") else ("--threads", "2")
                self.run_well("study", name, *TINY, *threads, "--quiet", timeout=300)
                if name == "reproduce":
                    page = (self.folder / "out/reproduce/summary.md").read_text()
                    for item in ("Table 1", "Table 2", "Figure 5", "Figure 11", "CPU against GPU"):
                        self.assertIn(item, page)
                    joined = (self.folder / "out/reproduce/site/index.html").read_text()
                    self.assertEqual(joined.count('<tr><td><a href="'), 9)
                    self.assertRegex(page, r"\*\*(holds|does not hold|cannot be told here)")
                    beyond = (self.folder / "out/reproduce/beyond.md").read_text()
                    for study in ("scene-size", "traversal", "light", "gpu"):
                        self.assertIn(f"[{study}]({study}/summary.md)", beyond)
                        self.assertIn(f"## {study}", beyond)
                else:
                    self.check_folder(self.folder / "out" / name)
                if name == "stability":
                    for image in ("acne_naive", "acne_ours", "acne_difference"):
                        self.assertTrue((self.folder / "out/stability" / f"{image}.png").exists(), image)
                    self.check_verdicts(rows_of(self.folder / "out/stability"))

    def test_a_scene_that_has_changed_is_another_run(self):
        study = ("study", "gpu", *TINY, "--threads", "1", "--scene", "scene.json", "--only", "occupancy")
        self.run_well(*study)
        self.run_well(*study, "--status", "status.json")
        status = json.loads((self.folder / "status.json").read_text())
        self.assertEqual((status["what"], status["state"], status["unit"], status["done"]), ("gpu", "done", "runs", 3))
        self.write("scene.json", changed(SCENE, "/shapes/0/radius", 0.5))
        self.assert_refused(*study, named=["out/gpu", "differs in options: scene_hash)", "--fresh"])
        self.run_well(*study, "--fresh")

    def test_signal_loses_no_finished_row_and_repeats_none(self):
        for number, status in ((signal.SIGINT, 130), (signal.SIGTERM, 143), (signal.SIGUSR1, 138)):
            with self.subTest(number):
                self.check_goes_on_after(number, status)
                shutil.rmtree(self.folder / "out")

    def check_goes_on_after(self, number, status):
        arguments = ["study", "schedules", "--quick", "--width", "64", "--spp", "16", "--repeats", "5"]
        environment = {key: value for key, value in os.environ.items() if not key.startswith("OMP_")} | self.always
        process = subprocess.Popen([self.command, *arguments], cwd=self.folder, env=environment, text=True,
                                   stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        data = self.folder / "out/schedules/data.csv"
        while process.poll() is None and not (data.exists() and len(rows_of(data.parent)) >= 3):
            time.sleep(0.01)
        self.assert_one_line(self.run_command(*arguments, "--quiet"), 2, "out/schedules", "another raypool")
        process.send_signal(number)
        _, said = process.communicate(timeout=60)
        self.assertEqual(process.returncode, status, said)
        self.assertIn("goes on from there", said)
        before = rows_of(data.parent)
        self.assertGreaterEqual(len(before), 3)

        self.run_well(*arguments, "--quiet")
        after = rows_of(data.parent)
        self.assertEqual(after[:len(before)], before)
        keys = [(row["case"], row["repeat"]) for row in after]
        self.assertEqual(len(keys), len(set(keys)))
        plan = json.loads((data.parent / "run.json").read_text())["plan"]
        self.assertEqual(len(keys), sum(case["repeats"] for case in plan))

    def test_only_some_cases(self):
        only = ["study", "scene-size", *TINY, "--threads", 1]
        self.run_well(*only, "--only", "^100 (quads|field), .*: (recursion|automatic), ", "--quiet")
        run = self.check_folder(self.folder / "out/scene-size")
        cases = [f"100 {kind}, depth 50: {way}, 1 threads" for kind in ("quads", "field") for way in ("recursion", "automatic")]
        self.assertEqual(sorted(row["case"] for row in rows_of(self.folder / "out/scene-size")), sorted(cases))
        self.assertEqual(len(run["plan"]), 4)
        self.assert_refused(*only, "--only", "200 cubes", named=["--only", "scene-size", "200 cubes"])
        self.assert_refused(*only, "--only", "(", named=["--only", "'('", "regular expression"])

    def test_another_run_in_the_folder_is_refused(self):
        self.run_well("study", "schedules", *TINY, "--quiet")
        self.assert_refused("study", "schedules", *TINY, "--seed", "1", named=["out/schedules", "differs in options: seed)", "--fresh"])

    def test_scene_with_a_name_that_is_no_utf8_can_be_gone_on_with(self):
        scene = os.fsdecode(b"bad\xff\x1b.json")
        (self.folder / scene).write_bytes((self.folder / "scene.json").read_bytes())
        for _ in range(2):
            self.run_well("study", "schedules", *TINY, "--threads", 1, "--scene", scene, "--out", scene[:-5], "--quiet")
            self.check_folder(self.folder / scene[:-5])

    def test_a_complete_run_is_analysed_anew_and_says_the_same(self):
        self.run_well("study", "schedules", *TINY, "--quiet")
        before = self.listing()
        (self.folder / "out/schedules/summary.md").unlink()
        (self.folder / "out/schedules/schedules.png").unlink()
        said = self.run_well("study", "schedules", *TINY).stdout
        self.assertEqual(said, "out/schedules/summary.md\n")
        self.assertEqual(self.listing(), before)

    def test_without_a_package_of_the_analysis_the_data_are_kept_to_go_on_with(self):
        (self.folder / "hidden").mkdir()
        self.write("hidden/matplotlib.py", "raise ModuleNotFoundError('hidden by a test')")
        hidden = {"PYTHONPATH": str(self.folder / "hidden")}
        refused = self.run_command("study", "schedules", *TINY, "--quiet", environment=hidden)
        self.assert_one_line(refused, 1, "out/schedules: the data are complete", "python3-matplotlib")
        rows = rows_of(self.folder / "out/schedules")
        self.assertFalse((self.folder / "out/schedules/summary.md").exists())
        self.run_well("study", "schedules", *TINY, "--quiet")
        self.assertEqual(rows_of(self.folder / "out/schedules"), rows)
        self.check_folder(self.folder / "out/schedules")

    def test_without_the_package_of_pages_all_but_the_page_is_there(self):
        (self.folder / "hidden").mkdir()
        self.write("hidden/jinja2.py", "raise ModuleNotFoundError('hidden by a test')")
        hidden = {"PYTHONPATH": str(self.folder / "hidden")}
        done = self.run_command("study", "schedules", *TINY, "--quiet", environment=hidden)
        self.assertEqual((done.returncode, done.stderr),
                         (0, "raypool: no index.html, which needs the package python3-jinja2\n"))
        self.assertTrue((self.folder / "out/schedules/summary.md").exists())
        self.assertFalse((self.folder / "out/schedules/index.html").exists())
        refused = self.run_command("report", "out", environment=hidden)
        self.assert_one_line(refused, 1, "python3-jinja2")

    def test_runs_are_joined_in_pages(self):
        for out, seed in (("out/one", 0), ("out/two", 1)):
            self.run_well("study", "schedules", *TINY, "--threads", 1, "--seed", seed, "--out", out, "--quiet")
        said = self.run_well("report", "out/one", "out/two", "-o", "site").stdout
        self.assertEqual(said, "site/index.html\n")
        self.assertEqual(len(list((self.folder / "site").glob("schedules-*.html"))), 3)  # two runs, and both side by side
        self.assert_refused("report", "absent", named=["absent", "no study in it"])
        self.assert_refused("report", named="folders")
        self.assert_refused("report", "out/one", "-o", "out/one", named=["out/one", "an index.html of its own"])

    def test_figures_that_no_run_leaves_are_refused_by_their_line(self):
        self.run_well("study", "schedules", *TINY, "--quiet")
        data = self.folder / "out/schedules/data.csv"
        head, first, *rest = data.read_text().splitlines(keepends=True)
        names = head.strip().split(",")
        place = names.index("mpaths_per_s")
        for word in ("nan", "inf", "-3"):
            cells = next(csv.reader([first]))
            cells[place] = word
            data.write_text("".join([head, ",".join(f'"{cell}"' for cell in cells) + "\n", *rest]))
            self.assert_refused("study", "schedules", *TINY, "--quiet", named=["data.csv: line 2", "mpaths_per_s"])
        data.write_text("".join([head, first, first, *rest]))
        self.assert_refused("study", "schedules", *TINY, "--quiet", named=["data.csv: line 3", "there already"])

    def test_bad_input_is_refused(self):
        self.assert_refused("study", "nothing", named=["nothing", "schedules"])
        self.assert_refused("study", "schedules", "--scene", "absent.json", named="absent.json")
        self.assert_refused("study", "schedules", "--width", "0", named="--width")


if __name__ == "__main__":
    main()
