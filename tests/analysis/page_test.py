"""What is read from a study's folder, and the pages that are written of it."""
import json
import tempfile
import unittest
from pathlib import Path

import support  # noqa: F401 ; before the package
from analysis import data, page, reproduction
from analysis.summary import Finding, Picture, Summary, Table
from analysis.verdict import Verdict

RUN = {
    "study": "fake", "question": "Does it work?", "finished": "2026-01-01T00:00:00Z", "stolen": 0.0123,
    "environment": {"cpu": "a processor", "cores": 2, "compiler": "gcc 12", "commit": "another",
                    "simd": {"instruction_sets": ["sse2", "avx2"]}},
    "options": {"quick": False, "scene": "paper", "width": 0, "spp": 0, "depth": 0, "threads": 0, "repeats": 0, "seed": 0}}


def summary():
    return Summary([Finding("a claim", "ours", Verdict.HOLDS, source="Figure 5", paper="a figure")],
                   [Picture("name", "A title", "What to see.")], [Table("A table", ["a", "b"], [["1", "2"]])], ["8 rows"])


class RowsTest(unittest.TestCase):
    def read(self, text):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "data.csv"
            path.write_bytes(text)
            return data.read_rows(path)

    def test_have_the_types_of_their_columns(self):
        rows = self.read(b"case,count,seconds,way,hash\na,1,0.5,recursion,12\nb,,2,8192,1e10\n")
        self.assertEqual(rows, [{"case": "a", "count": 1, "seconds": 0.5, "way": "recursion", "hash": "12"},
                                {"case": "b", "count": None, "seconds": 2.0, "way": "8192", "hash": "1e10"}])
        self.assertIsInstance(rows[0]["count"], int)
        self.assertIsInstance(rows[1]["seconds"], float)

    def test_may_hold_quotes_lines_and_bytes_that_are_no_text(self):
        rows = self.read(b'case,way\n"says ""no""\nand goes on","lines, static"\n\xff,b\n')
        self.assertEqual(rows[0], {"case": 'says "no"\nand goes on', "way": "lines, static"})
        self.assertEqual(rows[1], {"case": "\ufffd", "way": "b"})

    def test_are_selected_by_their_values(self):
        rows = self.read(b"name,count,seconds\na,1,0.5\nb,1,0.25\na,2,\n")
        self.assertEqual(len(data.where(rows, name="a")), 2)
        self.assertEqual(data.numbers(data.where(rows, count=1), "seconds"), [0.5, 0.25])
        self.assertEqual(len(data.numbers(rows, "seconds")), 2)
        self.assertEqual(data.distinct(rows, "name"), ["a", "b"])
        self.assertEqual(data.distinct(rows, "name", "count"), [("a", 1), ("b", 1), ("a", 2)])


class FilesTest(unittest.TestCase):
    def test_are_there_whole_or_not_at_all(self):
        def fail(beside):
            beside.write_text("half")
            raise OSError("no space")
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "summary.md"
            data.write_text(path, "before")
            with self.assertRaises(OSError):
                data.write(path, fail)
            self.assertEqual(path.read_text(), "before")
            self.assertEqual([entry.name for entry in Path(folder).iterdir()], ["summary.md"])


class PageTest(unittest.TestCase):
    def test_says_what_was_found_and_where_the_figures_come_from(self):
        text = page.summary_page({**RUN, **summary().as_json()})
        self.assertEqual(text, """# fake

Does it work?

![A title](name.png)

What to see.

| paper | claim | its figures | ours | verdict |
|---|---|---|---|---|
| Figure 5 | a claim | a figure | ours | **holds** |

## A table

| a | b |
|---|---|
| 1 | 2 |

- 8 rows

a processor, 2 cores, gcc 12 and code for avx2, commit another. Finished 2026-01-01T00:00:00Z; the host took 1.2 % of the processor time for others.
Flags and OpenMP variables are in run.json, every row in data.csv. To repeat: `raypool study fake`
""")

    def test_a_verdict_that_is_open_says_why(self):
        finding = Summary([Finding("a claim", why="fewer than 5 runs")]).as_json()["findings"][0]
        self.assertEqual(page.verdict_text(finding), "**cannot be told here**: fewer than 5 runs")
        self.assertEqual(json.loads(json.dumps(finding))["verdict"], "cannot be told here")

    def test_a_run_may_be_older_than_the_record_of_its_code(self):
        old = {key: value for key, value in RUN["environment"].items() if key != "simd"}
        self.assertEqual(page.machine_line(old), "a processor, 2 cores, gcc 12, commit another")

    def test_the_command_to_repeat_it_is_one_that_a_shell_reads(self):
        def command(**options):
            return page.command_line({**RUN, "options": {**RUN["options"], **options}})
        self.assertEqual(command(only="^100 (a|b)$"), "raypool study fake --only '^100 (a|b)$'")
        self.assertEqual(command(quick=True, width=32, seed=1), "raypool study fake --quick --width 32 --seed 1")
        self.assertEqual(command(scene_given=True), "raypool study fake --scene paper")
        for scene, word in (("a/b-1.json", "a/b-1.json"), ("", "''"), ("my scene", "'my scene'"), ("it's", "'it'\\''s'"),
                            ("\u00e9", "'\u00e9'"), ("a\x1b b", "$'a\\x1b\\x20b'")):
            self.assertEqual(command(scene=scene, scene_given=True), f"raypool study fake --scene {word}")


class ReproductionTest(unittest.TestCase):
    def run_of(self, study, *sources):
        found = Summary([Finding("a claim", source=source) for source in sources], [Picture("p", "A title", "")])
        return {**RUN, "study": study, **found.as_json()}

    def test_has_every_table_and_figure_of_the_paper(self):
        sources = [source for source, _ in reproduction.ITEMS]
        text = reproduction.reproduction_page([self.run_of("load", *sources[4:]), self.run_of("pool", *sources[:4])])
        places = [text.index(f"| {source}: ") for source in sources]
        self.assertEqual(places, sorted(places))
        self.assertIn("[pool](pool/summary.md)", text)
        self.assertIn("![A title](load/p.png)", text)
        self.assertTrue(text.endswith("commit another.\n"))

    def test_misses_none_in_silence(self):
        with self.assertRaisesRegex(ValueError, "Table 2"):
            reproduction.reproduction_page([self.run_of("load", "Table 1, Figure 7")])


if __name__ == "__main__":
    unittest.main()
