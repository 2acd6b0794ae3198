"""The pages of studies: what they hold, that they need nothing beside them, and when a change is beyond the noise."""
import base64
import contextlib
import hashlib
import html
import io
import json
import os
import re
import tempfile
import unittest
from html.parser import HTMLParser
from pathlib import Path

import support  # noqa: F401 ; before the package
import fake_study
from analysis import command, comparison, joined, points, report
from fake_study import HOSTILE, row

fake_study.install()
EMPTY = {"meta", "link", "br", "img", "input", "path", "use", "circle", "rect"}


class Outline(HTMLParser):
    """The elements of a page, and what they leave open."""

    def __init__(self, text):
        super().__init__()
        self.elements, self.open = [], []
        self.feed(text)
        self.close()

    def handle_starttag(self, tag, attributes):
        self.elements.append((tag, dict(attributes)))
        if tag not in EMPTY:
            self.open.append(tag)

    def handle_startendtag(self, tag, attributes):
        self.elements.append((tag, dict(attributes)))

    def handle_endtag(self, tag):
        if tag not in EMPTY:
            assert self.open and self.open.pop() == tag, f"</{tag}> closes nothing"

    def all(self, tag, **wanted):
        return [a for t, a in self.elements if t == tag and all(a.get(key.strip("_")) == value for key, value in wanted.items())]


def study_page(**changes):
    return report.study_page("nowhere", {**fake_study.run(), **changes}, fake_study.rows())


class PageTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.text = study_page()
        cls.outline = Outline(cls.text)

    def test_is_whole(self):
        self.assertEqual(self.outline.open, [])
        self.assertEqual(len(self.outline.all("h1")), 1)
        ids = [a["id"] for _, a in self.outline.elements if "id" in a]
        self.assertEqual(len(ids), len(set(ids)))
        for link in self.outline.all("a"):
            self.assertIn(link["href"].removeprefix("#"), ids)

    def test_needs_nothing_beside_it(self):
        self.assertNotRegex(self.text.replace("http-equiv", ""), r"https?:|//[a-z]+\.")
        for tag, attributes in self.outline.elements:
            self.assertNotIn(tag, ("link", "iframe", "object", "embed", "base"))
            for name in ("src", "srcset", "data", "href", "xlink:href"):
                self.assertRegex(attributes.get(name) or "#", "^(#|data:image/png)", tag)
        self.assertNotRegex(self.text, r"@import|url\((?!#)")
        policy, = (a["content"] for a in self.outline.all("meta") if a.get("http-equiv") == "Content-Security-Policy")
        self.assertTrue(policy.startswith("default-src 'none'; "))

    def test_lets_no_text_of_the_data_become_part_of_it(self):
        self.assertEqual(self.outline.all("img"), [])
        self.assertEqual(len(self.outline.all("script")), 2)  # the rows, and what shows them
        self.assertNotIn(HOSTILE, self.text)
        self.assertIn(html.escape(HOSTILE, quote=False)[:20], self.text)
        rows = json.loads(re.search(r'<script type="application/json">(.*?)</script>', self.text, re.DOTALL)[1])
        self.assertEqual(len(rows), 150)

    def test_a_script_of_another_is_refused_by_its_hash(self):
        script = re.search(r"<script>(.*?)</script>", self.text, re.DOTALL)[1]
        digest = base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()
        self.assertIn(f"script-src 'sha256-{digest}'", self.text.replace("&#39;", "'"))

    def test_tells_of_each_point_its_series_place_value_spread_and_runs(self):
        told = [a["aria-label"].split("\n") for a in self.outline.all("circle", class_="point")]
        self.assertEqual(len(told), 6)
        self.assertEqual(told[1], ["pool", "threads: 2", "times as fast: 2.5 (2 to 3), n\u00a03"])
        self.assertEqual(told[4][0], HOSTILE)

    def test_has_every_table_with_heads_that_sort(self):
        heads = self.outline.all("th")
        self.assertTrue(heads)
        for head in heads:
            self.assertEqual((head["scope"], head["aria-sort"]), ("col", "none"))
        self.assertEqual(len(self.outline.all("input", type="search")), 3)  # findings, one table, rows

    def test_says_where_the_figures_come_from(self):
        for part in ("aaaa", "gcc 12", "-O3", "OMP_WAIT_POLICY", "a processor",
                     "1.2 % of the processor time", "raypool study fake"):
            self.assertIn(part, self.text)

    def test_rows_beyond_the_limit_are_left_out_and_counted(self):
        rows = [row(f"case {i}", 0, 1) for i in range(report.MOST_ROWS + 7)]
        text = report.study_page("nowhere", fake_study.run(), rows)
        self.assertIn(f"The first {report.MOST_ROWS} of {report.MOST_ROWS + 7} rows.", text)

    def test_a_picture_that_cannot_be_drawn_any_more_is_as_it_was(self):
        with tempfile.TemporaryDirectory() as folder:
            (Path(folder) / "speed.png").write_bytes(b"\x89PNG")
            text = report.study_page(folder, {**fake_study.run(), "study": "gone"}, fake_study.rows())
        self.assertIn("data:image/png;base64,iVBORw==", text)
        self.assertIn("as it was drawn then", text)

    def test_of_no_rows_and_no_findings_is_a_page_too(self):
        empty = {**fake_study.run(), "findings": [], "pictures": [], "tables": [], "notes": []}
        self.assertEqual(Outline(report.study_page("nowhere", empty, [])).open, [])


class CellTest(unittest.TestCase):
    def test_is_sorted_by_the_number_it_begins_with(self):
        for text, number in (("0.123 (0.100 to 0.140)", 0.123), ("12 %", 12), ("1e-05", 1e-5), ("-3.5", -3.5),
                             ("< 6.5e-05", 6.5e-5),
                             ("1.5 MiB", 1.5 * 2**20), ("338 KiB", 338 * 2**10), ("100 spheres", 100), ("1000 meshes", 1000),
                             ("never", None), ("", None), ("2026-11-30T01:58:09Z", 2026), ("lines, static", None)):
            self.assertEqual(report.number_of(text), number, text)

    def test_of_a_column_of_words_is_none_though_it_begins_with_a_number(self):
        made = report.sheet("", ["way"], [["3 pools"], ["recursion"], ["lines"]])
        self.assertEqual([cells[0].number for cells in made.rows], [None, None, None])
        made = report.sheet("", ["ratio"], [["2.5 (2 to 3)"], ["never"], ["10 (9 to 11)"], [""]])
        self.assertEqual([cells[0].number for cells in made.rows], [2.5, None, 10, None])


class PointTest(unittest.TestCase):
    def test_outside_the_axes_has_no_shape(self):
        figure, axis = points.plt.subplots()
        axis.plot([1, 2, 3], [1, 2, 300], marker="o")
        axis.set_ylim(0, 10)
        self.assertEqual(points.inline_svg(figure, "a", "A").count('class="point"'), 2)

    def test_lies_where_its_marker_lies(self):
        figure, axis = points.plt.subplots()
        axis.plot([1, 2, 3], [1, 5, 2], marker="o", label="a")
        text = points.inline_svg(figure, "a", "A")
        markers = re.findall(r'<use href="#a-m[^"]*" x="([\d.]+)" y="([\d.]+)" style="fill: (?:#1f77b4|var\(--blue\))', text)
        shapes = re.findall(r'<circle [^>]* cx="([\d.]+)" cy="([\d.]+)"', text)
        self.assertEqual(len(shapes), 3)
        for marker, shape in zip(markers[-3:], shapes):
            for of_marker, of_shape in zip(marker, shape):
                self.assertAlmostEqual(float(of_marker), float(of_shape), delta=0.1)

    def test_of_bars_and_whiskers_tells_their_spread(self):
        figure, axis = points.plt.subplots()
        axis.errorbar([2], [5], xerr=[[1], [3]], fmt="o", label="measured")
        self.assertIn("measured\n2 (1 to 5)\n5", points.inline_svg(figure, "a", "A"))


class ChangeTest(unittest.TestCase):
    def change(self, old, new, column="seconds"):
        rows = [[{**row("a", i, 1), column: value} for i, value in enumerate(values)] for values in (old, new)]
        return next(c for c in comparison.compare(*rows).changes if c.column == column)

    def test_is_beyond_the_noise_only_where_ranges_do_not_overlap(self):
        old = [10, 11, 12, 13, 14]
        self.assertTrue(self.change(old, [5, 6, 7, 8, 9.9]).is_beyond_noise)
        self.assertFalse(self.change(old, [5, 6, 7, 8, 10]).is_beyond_noise)  # they touch
        self.assertFalse(self.change(old, [15, 16, 17, 18, 13.5]).is_beyond_noise)
        self.assertFalse(self.change(old, [15, 16, 17, 18, 14]).is_beyond_noise)
        self.assertTrue(self.change(old, [15, 16, 17, 18, 14.5]).is_beyond_noise)

    def test_of_too_few_runs_cannot_be_told(self):
        found = self.change([10, 10, 10, 10], [1, 1, 1, 1, 1])
        self.assertFalse(found.is_beyond_noise)
        self.assertEqual(found.verdict, "too few runs")

    def test_of_a_time_and_of_a_rate_has_opposite_signs(self):
        less, more = [1] * 5, [2] * 5
        self.assertEqual(self.change(more, less).verdict, "faster")
        self.assertEqual(self.change(less, more).verdict, "slower")
        self.assertEqual(self.change(less, more, "mpaths_per_s").verdict, "faster")
        self.assertEqual(self.change(more, less).speed.median, 2)

    def test_has_the_ratio_of_the_medians_and_what_the_ranges_allow(self):
        ratio = self.change([10, 11, 12, 13, 14], [20, 21, 24, 27, 28]).ratio
        self.assertEqual((ratio.median, ratio.low, ratio.high, ratio.runs), (2, 20 / 14, 28 / 10, 5))

    def test_by_chance_is_of_all_orders_those_that_lie_apart(self):
        self.assertAlmostEqual(self.change([1] * 5, [2] * 5).by_chance, 2 / 252)


class ComparisonTest(unittest.TestCase):
    def test_goes_by_case_with_the_largest_change_first(self):
        found = comparison.compare(fake_study.rows(), fake_study.rows(3) + [row("new", 0, 1)])
        self.assertEqual(len(found.changes), 60)
        self.assertTrue(all(change.is_beyond_noise for change in found.changes))
        self.assertEqual((found.only_old, found.only_new, found.same_hashes), ([], ["new"], 30))

    def test_tells_hashes_that_differ(self):
        found = comparison.compare([row("a", 0, 1), row("b", 0, 1)], [row("a", 0, 1, "bb"), row("b", 0, 1)])
        self.assertEqual((found.same_hashes, found.other_hashes), (1, ["a"]))

    def test_tells_rows_of_one_case_apart_by_what_they_were_run_with(self):
        rows = [row("a", repeat, 1 + thread, thread=thread) for repeat in range(5) for thread in range(2)]
        found = comparison.compare(rows, rows)
        self.assertEqual({change.case for change in found.changes}, {"a, thread 0", "a, thread 1"})
        self.assertEqual([change.old.runs for change in found.changes], [5] * 4)

    def test_leaves_out_rows_that_nothing_tells_apart(self):
        rows = [row("a", 0, 1), row("a", 0, 2)]
        found = comparison.compare(rows, rows)
        self.assertEqual((found.changes, found.ambiguous), ([], ["a"]))

    def test_leaves_out_what_has_no_ratio(self):
        rows = [{**row("a", 0, 1), "seconds": 0.0, "mpaths_per_s": None}]
        self.assertEqual(comparison.compare(rows, rows).changes, [])
        self.assertEqual(comparison.compare([], rows).changes, [])


class JoinedTest(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.folder = Path(scratch.name)

    def report(self, *folders, site="site"):
        said = io.StringIO()
        with contextlib.redirect_stderr(said):
            status = command.report_of([str(self.folder / folder) for folder in folders], str(self.folder / site))
        return status, said.getvalue()

    def test_tells_two_runs_of_one_machine_commit_and_day_apart_by_folder_whatever_its_name(self):
        for name in ("before", os.fsdecode(b"after\xff")):
            fake_study.write(self.folder / name, fake_study.run("aaaa"), fake_study.rows())
        self.assertEqual(self.report("before", os.fsdecode(b"after\xff")), (0, ""))
        beside, = (self.folder / "site").glob("*-to-*.html")
        for page in (self.folder / "site/index.html", beside):
            for name in ("before", "after\ufffd"):
                self.assertRegex(page.read_text(), f"{self.folder}/{name}: a processor, [^<]* 00:00 UTC", page)

    def test_lists_runs_and_holds_two_of_a_study_side_by_side(self):
        fake_study.write(self.folder / "old/fake", fake_study.run("aaaa"), fake_study.rows())
        fake_study.write(self.folder / "new", fake_study.run("bbbb", "2026-02-01T00:00:00Z"), fake_study.rows(2))
        self.assertEqual(self.report("new", "old", "old/fake"), (0, ""))
        pages = {path.name: path.read_text() for path in (self.folder / "site").iterdir()}
        runs = ["fake-2026-01-01-aaaa", "fake-2026-02-01-bbbb"]
        self.assertEqual(set(pages), {"index.html", *(f"{name}.html" for name in runs), f"{runs[0]}-to-{runs[1]}.html"})
        for text in pages.values():
            outline = Outline(text)
            self.assertEqual(outline.open, [])
            self.assertNotIn(HOSTILE, text)
            for link in outline.all("a"):
                self.assertTrue(link["href"].startswith("#") or link["href"] in pages, link)
        beside = pages[f"{runs[0]}-to-{runs[1]}.html"]
        self.assertIn("<strong>0 are faster</strong> and <strong>60 slower</strong>", beside)
        self.assertIn("ranges, lowest to highest run, do not overlap", beside)
        self.assertIn("30 cases have the same hash in both, 0 have another", beside)
        self.assertNotIn("Their options differ", beside)

    def test_warns_where_two_runs_had_other_options(self):
        run = fake_study.run("bbbb", "2026-02-01T00:00:00Z")
        run["options"] = {**run["options"], "width": 64}
        fake_study.write(self.folder / "a", fake_study.run(), fake_study.rows())
        fake_study.write(self.folder / "b", run, fake_study.rows())
        self.assertEqual(self.report("a", "b")[0], 0)
        beside, = (self.folder / "site").glob("*-to-*.html")
        self.assertIn("Their options differ (width)", beside.read_text())

    def test_says_in_one_line_what_is_wrong(self):
        (self.folder / "empty").mkdir()
        fake_study.write(self.folder / "broken", fake_study.run(), fake_study.rows())
        (self.folder / "broken/run.json").write_text("{")
        fake_study.write(self.folder / "running", {**fake_study.run(), "findings": 0}, fake_study.rows())
        unfinished = fake_study.run()
        del unfinished["findings"]
        (self.folder / "running/run.json").write_text(json.dumps(unfinished))
        fake_study.write(self.folder / "good", fake_study.run(), fake_study.rows())
        for folders, site, told in ((["empty"], "site", "no study in it"), (["absent"], "site", "no study in it"),
                                    (["broken"], "site", "not the folder of a study"), (["running"], "site", "has not ended"),
                                    (["good"], "good", "the folder of a study, which has an index.html of its own")):
            status, said = self.report(*folders, site=site)
            self.assertEqual(status, 2, said)
            self.assertIn(told, said)
            self.assertFalse((self.folder / "site").exists())
        status, said = self.report("running", "good")
        self.assertEqual((status, said.count("\n")), (0, 1))
        self.assertIn("left out", said)


if __name__ == "__main__":
    unittest.main()
