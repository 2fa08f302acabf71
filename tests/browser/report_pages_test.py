#!/usr/bin/python3
"""Looks at the pages of `alidade report` in a real browser (headless Chromium).

Expected values come from the result files, not from the page's own data: pages
must load without a word on the console, ask no network, hold the right numbers
and figures, read without scripts, stay text where names look like markup, fit a
phone, follow the reader's choice of light and dark, and print.

Usage: report_pages_test.py ALIDADE RV2AJ_STUDY SOURCE_DIR WORK_DIR
"""

import csv
import io
import json
import math
import shutil
import xml.etree.ElementTree

from made_results import HOSTILE, MAP_ROWS, add_uncertainty, free_parameters
from pages import (ENVIRONMENT, PageTest, calibrate, copy_result, load, main,
                   page_count, run, run_alidade, shown_number)

# The page shows four significant digits.
SHOWN = 0.0006


class Pages(PageTest):
    @classmethod
    def make_results(cls):
        cls.study = cls.work / "study"
        calibrate("rv2aj_study", cls.study)
        cls.published = cls.work / "published"
        run(ENVIRONMENT.study, "configs/jobs/rv2aj_study.yaml", f"--out={cls.published}")
        cls.hostile = copy_result(cls.study, cls.work / "hostile", add_uncertainty)
        (cls.hostile / "predicted_map.csv").write_text("\n".join(MAP_ROWS) + "\n")
        (cls.hostile / "influence.csv").write_text(
            "pose,leverage,cooks_distance,standardised_residual\n"
            "3,0.1,0.01,1\n7,0.5,0.3,2\n")
        run_alidade("report", cls.hostile)

    def test_study_shows_the_numbers_of_its_result(self):
        result = load(self.study / "result.json")
        self.open(self.study / "report.html")
        rows = {(row[0][0], row[1][0]): row for row in self.table("accuracy")}
        for name, key in (("validation poses", "validation"),
                          ("training poses", "train")):
            for state in ("before", "after"):
                expected = result["accuracy"][key][state]
                row = rows[name, state]
                for column, quantity in enumerate(
                        ("mean", "rms", "stddev", "median", "p95", "max"), 2):
                    shown, exact = row[column]
                    self.assert_near(1e3 * expected[quantity], exact, 1e-12)
                    self.assert_near(exact, shown_number(shown), SHOWN)
                self.assertEqual(expected["n"], row[8][1])
        before, after = result["verdict"]["sentence"].split("e-14")
        self.assertIn("from 3.08 mm to", before)
        self.assertEqual(before + "×10⁻¹⁴" + after, self.text(".verdict"))
        self.assertEqual(2, self.text("#acceptance").count("met"))
        self.assertLess((self.study / "report.html").stat().st_size, 1.5e6)

    def test_sections_of_a_client_come_first(self):
        study = load(self.published / "study.json")
        self.open(self.published / "report.html")
        self.assertEqual("Published study", self.text(
            "main > section:not(#summary) h2"))
        self.assertEqual("#study", self.js("document.querySelector('nav a')"
                                           ".getAttribute('href')"))
        for i in range(1, 6):
            self.assertGreater(self.marks(f"#study-{i} path"), 2)
        self.assertEqual(56, self.marks("#study-1 .stem"))
        rows = {row[0][0]: row for row in self.table("study-deviations")}
        for parameter in study["parameters"]:
            if parameter["name"] in rows:
                unit = 1 if parameter["unit"] == "rad" else 1e3
                self.assertAlmostEqual(unit * parameter["obtained"],
                                       rows[parameter["name"]][4][1], 6)
        self.assertEqual("0.100400", rows["d4"][4][0])
        nominal = self.table("study-nominal")
        self.assertEqual(["3", "0.0000", "0.0000", "250.0000", "0.0000", "0.0000"],
                         [cell[0] for cell in nominal[2]])
        published = [[cell[0] for cell in row] for row in self.table("study-rows")]
        self.assertEqual([[row["quantity"], row["published"], row["obtained"]]
                          for row in study["rows"]], published)
        self.assertLess((self.published / "report.html").stat().st_size, 1.5e6)
        self.assertEqual(3, self.js("document.scripts.length"))
        self.open(self.published / "report.html", width=400)
        self.assertLessEqual(self.js("document.documentElement.scrollWidth"), 400)

    def test_figures_show_every_pose_and_iteration(self):
        result = load(self.study / "result.json")
        self.open(self.study / "report.html")
        for state in ("-before", ""):
            self.assertEqual(56, self.marks(f"#by-pose{state} .stem"))
        for state in ("before", "after"):  # a map of squares
            self.assertGreater(self.marks(f"#validation-{state} path"), 500)
        # Each has a curve, its legend one more.
        runs = result["runs"]
        self.assertEqual(2 * len(runs), self.marks("#convergence .line"))
        self.assertEqual(
            sum(len(run["history"]) + 1 for run in runs
                if len(run["history"]) <= 40),
            self.marks("#convergence .mark"))
        self.js("""document.querySelector('#by-pose-before svg').dispatchEvent(
            new KeyboardEvent('keydown', {key: 'ArrowRight', bubbles: true}))""")
        self.assertRegex(self.text("#by-pose-before .tip"), "pose 1: 3.2[0-9] mm")

    def test_page_reads_without_scripts(self):
        result = load(self.study / "result.json")
        self.open(self.study / "report.html", scripts=False)
        self.assertEqual({p["name"] for p in result["parameters"]},
                         {row[0][0] for row in self.table("parameters-table") +
                          self.table("held-parameters")})
        self.assertEqual(0, self.js("document.querySelectorAll('button').length"))
        self.assertEqual(56, self.marks("#by-pose .stem"))
        self.assertIn("The arm stands at pose", self.text("#arm"))
        # Browsers show the titles of tips.
        self.assertIn("pose 1: ", self.js("document.querySelector("
                      "'#by-pose .tips title').textContent"))
        # One choice at a time, by radio buttons.
        self.assertIn("joint 1", self.text("#by-joint h3"))
        self.js("document.querySelector('[for=by-joint-3]').click()")
        self.assertIn("joint 3", self.text("#by-joint h3"))
        self.open(self.study / "report.html")

    def test_parameters_and_figures_have_every_value(self):
        result = load(self.study / "result.json")
        self.open(self.study / "report.html")
        rows = {row[0][0]: row for row in self.table("parameters-table")}
        self.assertEqual({p["name"] for p in free_parameters(result)},
                         set(rows))
        found = self.column("parameters-table", "identified")
        for parameter in free_parameters(result):
            unit = 180 / math.pi if parameter["unit"] == "rad" else 1e3
            self.assertAlmostEqual(unit * parameter["value"],
                                   rows[parameter["name"]][found][1], delta=1e-9)
        held = {row[0][0]: row for row in self.table("held-parameters")}
        self.assertEqual({p["name"] for p in result["parameters"]},
                         set(rows) | set(held))
        self.assertIn("fixed", held["r3"][1][0])
        self.assertEqual(
            160.1, rows["d4"][self.column("parameters-table", "published")][1])
        interval = self.column("parameters-table", "95\u00a0% interval")
        for known in result["uncertainty"]["parameters"]:
            if known["name"] == "d3":
                self.assertAlmostEqual(1e3 * known["interval"]["lower"],
                                       rows["d3"][interval][1], delta=1e-9)
        # One mark a singular value that counts, and the one of the legend.
        rank = result["identifiability"]["nominal_rank"]
        self.assertEqual(rank["rank"] + 1, self.marks("#singular-values .s1.mark"))
        self.assertEqual(len(rank["singular_values"]) - rank["rank"] + 1,
                         self.marks("#singular-values .s7.mark"))
        arms = self.js("document.querySelectorAll('#arm .link').length")
        self.assertEqual(2, arms)  # the floor and the arm

    def test_uncertainty_appears_where_it_is_there(self):
        older = copy_result(self.study, self.work / "older",
                            lambda result: result.pop("uncertainty"))
        (older / "predicted_map.csv").unlink()
        (older / "influence.csv").unlink()
        run_alidade("report", older)
        self.open(older / "report.html")
        for part in ("predicted-map", "correlated", "influence", "workspace"):
            self.assertIsNone(self.js("document.getElementById(arguments[0])",
                                      part))
        self.assertEqual(-1, self.column("parameters-table", "95\u00a0% interval"))
        self.open(self.hostile / "report.html")
        rows = self.table("parameters-table")
        self.assertIn("prior-dominated", rows[0][1][0])
        self.assertIn("estimated", rows[1][1][0])
        self.assertIn("median 0.125 mm", self.text("#workspace"))
        self.assertIn("95.0 % of 100 coordinates", self.text("#workspace"))
        self.assertGreater(self.js(
            "document.querySelectorAll('#predicted-map svg path').length"), 5)
        self.assertIn("−0.970", self.table("correlated")[0][2][0])
        self.assertIn("A warning of uncertainty.", self.text("#warnings"))
        # The bars are one path; another is the legend's.
        self.assertEqual(32, self.js(
            "Math.max(...[...document.querySelectorAll('#histogram .bar')].map("
            "bar => bar.getAttribute('d').split('z').length - 1))"))
        self.assertEqual("7", self.table("influence")[0][0][0])

    def test_noise_and_hardly_any_gain_are_said(self):
        def page(name, sigma, estimated, before, after):
            def change(result):
                result["fit"].update(sigma=sigma, estimated_sigma=estimated)
                result["warnings"] = []
                validation = result["accuracy"]["validation"]
                validation["before"]["mean"] = before
                validation["after"]["mean"] = validation["after"]["max"] = after
            run_alidade("report", copy_result(self.study, self.work / name, change))
            self.open(self.work / name / "report.html")
            return self.text("#summary")
        # Noise of 0.02 mm in three coordinates is sqrt(8 / pi) times as long.
        noise = "would show a mean error of 0.0319 mm"
        good = page("noisy", 2e-5, 0.0, 5e-3, 4e-5)
        self.assertIn(noise, good)
        self.assertNotIn("hardly", good)
        self.assertNotIn("would show", page("estimated", 2e-5, 2e-5, 5e-3, 4e-5))
        self.assertNotIn("would show", page("exact", 2e-5, 0.0, 5e-3, 1e-9))
        self.assertIn("hardly better than before",
                      page("hardly", 2e-5, 0.0, 5e-3, 4.6e-3))

    def test_markup_in_names_stays_text(self):
        self.open(self.hostile / "report.html")
        self.assertEqual(HOSTILE + " – Alidade", self.js("document.title"))
        self.assertEqual(HOSTILE, self.text("h1"))
        self.assertEqual(0, self.js("document.querySelectorAll('main script, "
                                    "main b').length"))
        # The page's data (result and arm) and script, and no more.
        self.assertEqual(3, self.js("document.scripts.length"))

    def test_tables_sort_and_copy(self):
        result = load(self.study / "result.json")
        self.open(self.study / "report.html")
        self.js("""(navigator.clipboard.writeText = async (text) =>
            { window.copied = text; })""")
        click = """document.querySelector('#parameters-table th:nth-child(3) '
            + 'button').click()"""
        self.js(click)
        changes = [row[2][1] for row in self.table("parameters-table")]
        told = [value for value in changes if value is not None
                and not math.isnan(value)]
        self.assertEqual(sorted(told), told)
        self.js(click)
        self.assertEqual("descending", self.js("document.querySelector("
                         "'#parameters-table th:nth-child(3)').ariaSort"))
        self.js("document.querySelector('#parameters .table button.tool').click()")
        rows = list(csv.DictReader(io.StringIO(self.js("window.copied"))))
        d3 = next(row for row in rows if row["name"] == "d3")
        expected = next(p for p in result["parameters"] if p["name"] == "d3")
        self.assertAlmostEqual(1e3 * expected["value"], float(d3["identified"]),
                               delta=1e-9)

    def test_keyboard_reaches_tables_figures_and_buttons(self):
        self.open(self.study / "report.html")
        before = self.js("document.querySelector('#arm svg .link:not(.ghost)')"
                         ".getAttribute('d')")
        self.js("""document.querySelector('#arm svg').dispatchEvent(
            new KeyboardEvent('keydown', {key: 'ArrowLeft', bubbles: true}))""")
        after = self.js("document.querySelector('#arm svg .link:not(.ghost)')"
                        ".getAttribute('d')")
        self.assertNotEqual(before, after)
        self.js("""document.querySelector('#convergence svg').dispatchEvent(
            new KeyboardEvent('keydown', {key: 'ArrowRight', bubbles: true}))""")
        self.assertIn("iteration 0", self.js("document.querySelector("
                      "'#convergence svg').getAttribute('aria-label')"))
        unreachable = self.js("""[...document.querySelectorAll(
            'main svg.chart, main .scroll')].filter((e) => e.tabIndex < 0).length""")
        self.assertEqual(0, unreachable)

    def test_figures_save_as_svg(self):
        self.open(self.study / "report.html")
        self.js("""(URL.createObjectURL = (blob) =>
            { window.saved = blob; return 'about:blank'; })""")
        self.js("""(HTMLAnchorElement.prototype.click = () => 0)""")
        self.js("document.querySelector('#by-pose-before button.tool').click()")
        svg = self.browser.execute_async_script(
            "window.saved.text().then(arguments[0])")
        root = xml.etree.ElementTree.fromstring(svg)
        self.assertEqual("{http://www.w3.org/2000/svg}svg", root.tag)
        self.assertIn("Position error before", root[0].text)
        self.assertIn("--c1, #0072b2", root[1].text)

    def test_phone_width_and_dark(self):
        self.open(self.hostile / "report.html", width=390, scheme="dark")
        self.assertLessEqual(self.js("document.documentElement.scrollWidth"), 390)
        self.assertEqual("rgb(20, 23, 27)",
                         self.js("getComputedStyle(document.body).backgroundColor"))
        # Letters of 13 pixels stay readable.
        sizes = self.js("""[...document.querySelectorAll('svg.chart')]
            .filter((svg) => svg.checkVisibility()).map((svg) =>
            13 * svg.getBoundingClientRect().width / svg.viewBox.baseVal.width)""")
        self.assertGreater(min(sizes), 9.0)
        self.assertLess(max(sizes), 16.0)
        self.open(self.study / "report.html")
        self.assertEqual("rgb(255, 255, 255)",
                         self.js("getComputedStyle(document.body).backgroundColor"))

    def test_prints_on_a4(self):
        self.open(self.study / "report.html", scheme="dark")
        pdf = self.printed()
        self.assertGreaterEqual(page_count(pdf), 3)
        self.assertLessEqual(page_count(pdf), 8)
        self.assertIn(b"/MediaBox [0 0 594.", pdf.replace(b"595", b"594."))

    def fleet(self):
        """Seven arms like the study's, one of which has a bent link."""
        def arm(number):
            def change(result):
                for p in result["parameters"]:
                    if p["state"] == "free":
                        wobble = 1e-5 * math.sin(5.0 * number + len(p["reason"]))
                        p["deviation"] += wobble
                        p["value"] += wobble
                    if number == 4 and p["name"] == "d3":
                        p["deviation"] += 5e-3
                        p["value"] += 5e-3
                for known in result["uncertainty"]["parameters"]:
                    known["std"] = 1e-5
                for state in result["accuracy"]["validation"].values():
                    if isinstance(state, dict):
                        state["mean"] *= 1 + 0.02 * number
                if number == 4:
                    result["accuracy"]["validation"]["before"]["mean"] = 8e-3
                result["inputs"][1]["sha256"] = f"{number:064d}"
            return change
        paths = []
        for number in range(7):
            path = self.work / "fleet" / f"arm_{number}"
            if not path.exists():
                copy_result(self.study, path, arm(number))
            paths.append(path)
        return paths

    def test_fleet_page_names_the_outlier(self):
        page = self.work / "fleet" / "comparison.html"
        paths = self.fleet()
        run_alidade("report", *paths, f"--out={page}")
        self.open(page)
        self.assertIn("arm_4 is an outlier among 7 arms: mean error before "
                      "calibration 8.00 mm, typically 3.", self.text(".verdict"))
        rows = self.table("fleet")
        self.assertEqual(7, len(rows))
        self.assertEqual("arm_4", rows[0][0][0])
        self.assertEqual([True] + [False] * 6, ["!\u00a0outlier" == row[1][0] for row in rows])
        self.assertAlmostEqual(8.0, rows[0][2][1], delta=1e-9)
        self.assertIn("d3", rows[0][9][0])
        self.assertEqual("./arm_4/report.html", self.js(
            "document.querySelector('#fleet a').getAttribute('href')"))

    def test_arm_over_time_shows_what_changed(self):
        page = self.work / "fleet" / "time.html"
        paths = self.fleet()
        run_alidade("report", paths[3], paths[4], "--read-as=time", f"--out={page}")
        self.open(page, width=400)
        self.assertLessEqual(self.js("document.documentElement.scrollWidth"), 400)
        first = self.table("changes")[0]
        self.assertEqual("d3", first[0][0])
        # 5 mm over the root of two variances of 0.01 mm, and the wobble.
        self.assert_near(5.0 / (0.01 * math.sqrt(2.0)), first[8][1], 0.01)
        self.assertIn("d3 by", self.text(".verdict"))

    def test_same_data_are_methods(self):
        page = self.work / "methods.html"
        other = copy_result(self.study, self.work / "other",
                            lambda result: result["inputs"][0].update(sha256="0"))
        run_alidade("report", self.study, other, f"--out={page}")
        self.open(page, scheme="dark")
        rows = self.table("methods")
        self.assertEqual(["Levenberg-Marquardt", "iterated pseudo-inverse"],
                         [row[1][0] for row in rows[:2]])
        self.assertEqual("Methods on the same data", self.text("h1"))
        self.js("document.querySelector('[for=read-as-1]').click()")
        self.assertEqual("A fleet of arms", self.text("h1"))
        self.assertEqual([], self.browser.get_log("browser"))


if __name__ == "__main__":
    main()
