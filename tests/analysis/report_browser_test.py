"""The pages of studies in Chromium: opened from the disk, pointed at, clicked, typed into; nothing may be said on the console.

Usage: report_browser_test.py SOURCE_FOLDER [SCREENSHOTS]. Where there is no Chromium it says so and exits with 77.
"""
import shutil
import sys
import tempfile
import time
import unittest
from pathlib import Path

import support  # noqa: F401 ; before the package
import fake_study
from analysis import joined

BROWSER = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
DRIVER = shutil.which("chromedriver")
try:
    from selenium import webdriver
    from selenium.webdriver.chrome.service import Service
    from selenium.webdriver.common.action_chains import ActionChains
    from selenium.webdriver.common.by import By
    from selenium.webdriver.common.keys import Keys
except ModuleNotFoundError:
    DRIVER = None
if not BROWSER or not DRIVER:
    print("skipped: it needs the packages chromium, chromium-driver and python3-selenium")
    sys.exit(77)

SCREENSHOTS = Path(sys.argv.pop(1)) if len(sys.argv) > 1 and not sys.argv[1].startswith("-") else None
RUNS = ("fake-2026-01-01-aaaa", "fake-2026-02-01-bbbb")


class BrowserTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        fake_study.install()
        scratch = tempfile.TemporaryDirectory()
        cls.addClassCleanup(scratch.cleanup)
        cls.folder = Path(scratch.name)
        fake_study.write(cls.folder / "a", fake_study.run("aaaa"), fake_study.rows(count=1000))
        fake_study.write(cls.folder / "b", fake_study.run("bbbb", "2026-02-01T00:00:00Z"), fake_study.rows(2, count=1000))
        joined.write([cls.folder / "a", cls.folder / "b"], cls.folder / "site")

        options = webdriver.ChromeOptions()
        options.binary_location = BROWSER
        for argument in ("headless=new", "no-sandbox", "disable-gpu", "disable-dev-shm-usage", "window-size=1280,1000",
                         f"user-data-dir={cls.folder / 'profile'}"):
            options.add_argument(f"--{argument}")
        options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
        cls.browser = webdriver.Chrome(options=options, service=Service(DRIVER))
        cls.addClassCleanup(cls.browser.quit)

    def open(self, name=RUNS[0]):
        self.browser.get((self.folder / "site" / f"{name}.html").as_uri())
        self.addCleanup(lambda: self.assertEqual(self.browser.get_log("browser"), []))

    def find(self, selector):
        return self.browser.find_element(By.CSS_SELECTOR, selector)

    def all(self, selector):
        return self.browser.find_elements(By.CSS_SELECTOR, selector)

    def tip(self):
        return self.find("#tip").text

    def point_at(self, element):
        """Until the page answers: it may still be scrolling, and then takes a move for one elsewhere."""
        for offset in (0, 1) * 20:
            ActionChains(self.browser).move_to_element_with_offset(element, offset, 0).perform()
            if self.tip():
                return
            time.sleep(0.1)

    def first_cells(self, section):
        return [row.find_element(By.TAG_NAME, "td").text for row in self.all(f"{section} tbody tr")]

    def screenshot(self, name):
        """Of the whole page. Something must be on it: more than one colour takes more than a few bytes."""
        height = self.browser.execute_script("return document.documentElement.scrollHeight")
        width = self.browser.execute_script("return innerWidth")
        self.browser.set_window_size(width, height)
        path = (SCREENSHOTS or self.folder) / f"{name}.png"
        path.parent.mkdir(parents=True, exist_ok=True)
        self.assertTrue(self.browser.save_screenshot(str(path)))
        self.browser.set_window_size(1280, 1000)
        self.assertGreater(path.stat().st_size, 20_000)

    def test_a_point_answers_to_the_mouse(self):
        self.open()
        self.assertEqual(self.tip(), "")
        point = self.all("circle.point")[1]
        self.browser.execute_script("arguments[0].scrollIntoView({block: 'center'})", point)
        self.point_at(point)
        self.assertEqual(self.tip().split("\n"), ["pool", "threads: 2", "times as fast: 2.5 (2 to 3), n 3"])
        ActionChains(self.browser).move_to_element_with_offset(point, 12, 0).perform()  # the nearest one, too
        self.assertIn("threads: 2", self.tip())
        ActionChains(self.browser).move_to_element(self.find("figcaption")).perform()
        self.assertEqual(self.tip(), "")

    def test_a_point_answers_to_the_keyboard(self):
        self.open()
        self.assertEqual(len(self.all(".point[tabindex='0']")), 1)
        self.browser.execute_script("arguments[0].focus()", self.all(".point")[0])
        self.assertIn("threads: 1", self.tip())
        ActionChains(self.browser).send_keys(Keys.ARROW_RIGHT).perform()
        self.assertIn("threads: 2", self.tip())
        ActionChains(self.browser).send_keys(Keys.END).perform()
        self.assertIn(fake_study.HOSTILE, self.tip())
        ActionChains(self.browser).send_keys(Keys.ESCAPE).perform()
        self.assertEqual(self.tip(), "")

    def test_a_table_is_sorted_by_numbers_both_ways_and_by_words(self):
        self.open()
        by_way, by_size = self.all("#tables th button")
        by_size.click()
        self.assertEqual(self.first_cells("#tables"), [fake_study.HOSTILE, "b", "a", "c"])  # 9.25, 10.5, 9 KiB, nothing
        heads = [head.get_attribute("aria-sort") for head in self.all("#tables th")]
        self.assertEqual(heads, ["none", "ascending"])
        by_size.send_keys(Keys.ENTER)  # as a click
        self.assertEqual(self.first_cells("#tables"), ["a", "b", fake_study.HOSTILE, "c"])
        by_way.click()
        self.assertEqual(self.first_cells("#tables")[1:], ["a", "b", "c"])

    def test_rows_are_sorted_filtered_and_shown_a_part_at_a_time(self):
        self.open()
        self.assertEqual(len(self.all("#rows tbody tr")), 100)
        self.find("#rows .more").click()
        self.assertEqual(len(self.all("#rows tbody tr")), 600)
        self.all("#rows th button")[2].click()
        self.all("#rows th button")[2].click()
        self.assertEqual(self.first_cells("#rows")[0], "case 199, left")
        self.find("#rows input").send_keys("RIGHT case")
        self.assertEqual(self.first_cells("#rows")[0], "case 196, right")
        self.assertEqual(self.find("#rows output").text, "250 of 1000 rows, 100 shown")
        self.find("#rows .more").click()
        self.assertEqual(len(self.all("#rows tbody tr")), 250)
        self.assertFalse(self.find("#rows .more").is_displayed())

    def test_is_dark_or_light_as_the_button_says_and_stays_so(self):
        def paper():
            return self.browser.execute_script("return getComputedStyle(document.body).backgroundColor")
        self.open()
        before = paper()
        self.find("#theme").click()
        after = paper()
        self.assertEqual({before, after}, {"rgb(255, 255, 255)", "rgb(22, 25, 29)"})
        self.browser.refresh()
        self.assertEqual(paper(), after)
        self.find("#theme").click()
        self.assertEqual(paper(), before)

    def test_the_command_is_copied_or_at_least_selected(self):
        self.open()
        self.find(".copy").click()
        deadline = time.monotonic() + 10  # the clipboard answers when it likes
        while self.find(".copy").text == "Copy" and time.monotonic() < deadline:
            time.sleep(0.05)
        self.assertRegex(self.find(".copy").text, "Copied|Selected")

    def test_hostile_text_did_nothing(self):
        for name in (*RUNS, f"{RUNS[0]}-to-{RUNS[1]}", "index"):
            self.open(name)
            self.assertNotEqual(self.browser.title, "broken")
            self.assertEqual(self.all("img"), [])

    def test_links_lead_from_the_list_to_the_comparison_and_back(self):
        self.open("index")
        self.assertEqual(len(self.all("#runs tbody tr")), 2)
        self.find("#pairs tbody a").click()
        self.assertIn("side by side", self.find("h1").text)
        self.assertIn("faster", self.find("#changes").text)
        self.assertTrue(self.all("#changes circle.point"))
        self.find("nav a").click()
        self.assertIn("Runs", self.find("h1").text)

    def test_is_to_be_seen_wide_and_narrow_dark_and_light(self):
        for name, file in (("study", RUNS[0]), ("comparison", f"{RUNS[0]}-to-{RUNS[1]}"), ("list", "index")):
            for width in (1280, 390):
                self.browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride",
                                             {"width": width, "height": 1000, "deviceScaleFactor": 1, "mobile": width < 600})
                self.open(file)
                wide = self.browser.execute_script("return document.documentElement.scrollWidth - innerWidth")
                self.assertLessEqual(wide, 0, f"{name} is wider than {width}")
                self.browser.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})
        self.open()
        self.screenshot("light")
        self.find("#theme").click()
        self.screenshot("dark")
        self.find("#theme").click()


if __name__ == "__main__":
    unittest.main()
