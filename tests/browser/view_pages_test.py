#!/usr/bin/python3
"""Looks at the view of the arm, at plans and at pages of many runs in a real
browser, as report_pages_test.py does at results.

Usage: view_pages_test.py ALIDADE RV2AJ_STUDY SOURCE_DIR WORK_DIR
"""

import csv
import io
import json
import math
import re
import statistics

import pages
from made_results import MAP_ROWS, add_uncertainty

# Few candidates, for the sake of time, and thick links, so that some overlap.
PLAN = """format: alidade-plan-1
title: Poses to look at
units: {{length: mm, angle: deg}}
arm: {robots}/rv2aj_flange.yaml
measurement: {{kind: position, sigma: 0.02}}
identifiability: {{policy: keep}}
poses: {{count: 12}}
candidates: {{count: 300}}
link_radius: 60
seed: 3
"""

MADE_UP = """format: alidade-job-1
title: Made up
units: {{length: mm, angle: deg}}
arm: {robots}/rv2aj_wrist.yaml
measurement: {{sigma: 0.02}}
data:
  simulate:
    deviations: {robots}/rv2aj_deviations.yaml
    poses: {{file: {robots}/../../datasets/rv2aj/wrist_56.csv}}
    noise: {{sigma: 0.02}}
    seed: 1
"""
TRIALS = MADE_UP + "montecarlo: {{trials: 200, seed: 1}}\n"
SEEDS = MADE_UP + "matrix: {{data.simulate.seed: {{range: 40}}}}\n"


class Views(pages.PageTest):
    @classmethod
    def make_results(cls):
        work = cls.work

        def write(name, text):
            path = work / name
            path.write_text(
                text.format(robots=pages.ENVIRONMENT.source / "configs/robots"),
                encoding="utf-8")
            return path
        cls.study = work / "study"
        pages.calibrate("rv2aj_study", cls.study)
        cls.mapped = pages.copy_result(cls.study, work / "mapped",
                                       add_uncertainty)
        (cls.mapped / "predicted_map.csv").write_text("\n".join(MAP_ROWS) + "\n",
                                                      encoding="utf-8")
        pages.run_alidade("report", cls.mapped)
        cls.plan = work / "plan"
        pages.run_alidade("plan", write("plan.yaml", PLAN), f"--out={cls.plan}")
        cls.trials = work / "trials"
        pages.run_alidade("montecarlo", write("trials.yaml", TRIALS),
                          f"--out={cls.trials}")
        cls.runs = work / "runs"
        pages.run_alidade("batch", write("seeds.yaml", SEEDS),
                          f"--out={cls.runs}", "--outputs=minimal")

    def layers(self):
        """What each part of the arm's view draws, by its name."""
        return self.js("""Object.fromEntries([...document.querySelectorAll(
            '#arm [data-layer]')].map((path) =>
            [path.dataset.layer, path.getAttribute('d')]))""")

    def assert_same_path(self, expected, path):
        # Tenths of a pixel, rounded from numbers of six digits.
        numbers = [[float(n) for n in re.findall(r"-?[0-9.]+", d)]
                   for d in (expected, path)]
        self.assertEqual(len(numbers[0]), len(numbers[1]))
        for a, b in zip(*numbers):
            self.assertAlmostEqual(a, b, delta=0.21)

    def test_view_stands_still_without_scripts(self):
        self.open(self.study / "report.html", scripts=False)
        still = self.layers()
        self.assertIn("The arm stands at pose", self.text("#arm figcaption"))
        self.open(self.study / "report.html")
        # The script draws the same figure, corner by corner.
        self.js("document.querySelector('#arm [aria-label=\"reset the view\"]')"
                ".click()")
        self.assertEqual(still.keys(), self.layers().keys())
        for name, path in self.layers().items():
            self.assert_same_path(still[name], path)

    def test_view_of_the_arm_zooms_moves_and_hides(self):
        self.open(self.study / "report.html")
        def corners():
            path = self.layers()["arm"]
            return [tuple(map(float, c.split(",")))
                    for c in re.split("[ML]", path)[1:]]
        def length(points):
            return sum(math.dist(a, b) for a, b in zip(points, points[1:]))
        def press(key, shift="false"):
            self.js(f"""document.querySelector('#arm svg').dispatchEvent(
                new KeyboardEvent('keydown', {{key: '{key}', bubbles: true,
                shiftKey: {shift}}}))""")
        first = corners()
        self.js("document.querySelector('#arm [aria-label=\"zoom in\"]').click()")
        self.assert_near(1.25 * length(first), length(corners()), 0.01)
        press("-")
        self.assert_near(length(first), length(corners()), 0.01)
        press("ArrowRight", "true")
        for a, b in zip(first, corners()):
            self.assertAlmostEqual(a[0] + 20, b[0], delta=0.11)
            self.assertAlmostEqual(a[1], b[1], delta=0.11)
        press("0")
        self.assertEqual(first, corners())
        # The wheel, about the place of the pointer, after a click.
        wheel = """document.querySelector('#arm svg').dispatchEvent(
            new WheelEvent('wheel', {deltaY: -200, clientX: arguments[0],
            clientY: arguments[1], cancelable: true, bubbles: true}))"""
        x, y, scale = self.js("""(() => { const svg = document.querySelector(
            '#arm svg'); const box = svg.getBoundingClientRect(); const k =
            box.width / svg.viewBox.baseVal.width; return [box.left + k *
            arguments[0], box.top + k * arguments[1], k]; })()""".replace(
                "arguments[0]", str(first[-1][0])).replace(
                "arguments[1]", str(first[-1][1])))
        self.js(wheel, x, y)
        self.assertEqual(first, corners())  # the page's own
        self.js("document.querySelector('#arm svg').focus()")
        self.js(wheel, x, y)
        self.assert_near(math.exp(0.5) * length(first), length(corners()), 0.01)
        # Browsers give whole pixels, which the zoom enlarges.
        self.assertAlmostEqual(first[-1][0], corners()[-1][0], delta=1.0)
        self.assertAlmostEqual(first[-1][1], corners()[-1][1], delta=1.0)
        press("0")
        # Two fingers: twice as far apart is twice as large.
        pinch = """(() => { const svg = document.querySelector('#arm svg');
            svg.setPointerCapture = () => 0;
            const box = svg.getBoundingClientRect();
            const at = (type, id, dx) => svg.dispatchEvent(new PointerEvent(type,
              {pointerId: id, clientX: box.left + box.width / 2 + dx,
               clientY: box.top + box.height / 2, pointerType: 'touch',
               buttons: 1, bubbles: true}));
            at('pointerdown', 1, -40); at('pointerdown', 2, 40);
            at('pointermove', 1, -80); at('pointermove', 2, 80);
            at('pointerup', 1, -80); at('pointerup', 2, 80); })()"""
        self.js(pinch)
        self.assert_near(2.0 * length(first), length(corners()), 0.01)
        press("0")
        # Before and after have factors and shades of their own.
        for state in ("before", "after"):
            self.assertRegex(self.text(f"#arm [data-part={state}] text"),
                             f"error {state}, 0 to .* mm, drawn .* times")
            shades = [path for name, path in self.layers().items()
                      if name.startswith(state)]
            self.assertEqual(5, len(shades))
            self.assertEqual(56, "".join(shades).count("M"))
        self.js("""[...document.querySelectorAll('#arm .controls button')].find(
            (b) => b.textContent === 'errors before').click()""")
        self.assertEqual("none", self.js("document.querySelector("
                         "'#arm [data-part=before]').getAttribute('display')"))
        self.assertEqual([], self.browser.get_log("browser"))

    def test_predicted_accuracy_is_a_cloud(self):
        self.open(self.mapped / "report.html")
        part = "document.querySelector('#arm [data-part=cloud]')"
        self.assertEqual("none", self.js(part + ".getAttribute('display')"))
        self.js("""[...document.querySelectorAll('#arm .controls button')].find(
            (b) => b.textContent === 'predicted accuracy').click()""")
        self.assertIsNone(self.js(part + ".getAttribute('display')"))
        data = json.loads(self.js(
            "document.getElementById('arm-data').textContent"))
        rows = list(csv.DictReader(io.StringIO("\n".join(MAP_ROWS))))
        stds = [float(row["position_std_mm"]) for row in rows]
        self.assertEqual(len(stds), len(data["cloud"]))
        for std, point in zip(stds, data["cloud"]):
            self.assert_near(std, point[3], 1e-3)
        points = "".join(path for name, path in self.layers().items()
                         if name.startswith("cloud-"))
        self.assertEqual(len(stds), points.count("M"))

    def test_plan_page_says_what_the_plan_promises(self):
        plan = pages.load(self.plan / "plan.json")
        for scripts in (False, True):
            self.open(self.plan / "plan.html", scripts=scripts)
            self.assertIn(f"{len(plan['poses'])} poses promise positions",
                          self.text(".verdict"))
            rows = {row[0][0]: row for row in self.table("plan-evaluations")}
            for evaluation in plan["evaluations"]:
                row = rows[evaluation["name"]]
                self.assert_near(1e3 * evaluation["region"]["worst"], row[3][1],
                                 1e-9)
            self.assertEqual(2, self.js(
                "document.querySelectorAll('#arm .link').length"))
        poses = self.table("plan-poses")
        self.assertEqual(len(plan["poses"]), len(poses))
        for row, pose in zip(poses, plan["poses"]):
            for cell, joint in zip(row[1:], pose["joints"]):
                self.assertAlmostEqual(math.degrees(joint), cell[1], delta=1e-9)
            self.assert_near(1e3 * pose["std"], row[-1][1], 1e-9)
        # Every pose is in the view and once in the histogram of each joint.
        cloud = "".join(path for name, path in self.layers().items()
                        if name.startswith("cloud-"))
        self.assertEqual(len(poses), cloud.count("M"))
        self.open(self.plan / "plan.html", scripts=False)
        for joint in range(1, 6):
            counts = self.js("""[...document.querySelectorAll(
                '#coverage .tips title')].map((t) => t.textContent).filter((t) =>
                t.startsWith(arguments[0]))""", f"joint {joint},")
            self.assertEqual(len(poses), sum(
                int(re.search(r"([0-9]+) pose", text)[1]) for text in counts))
        self.open(self.plan / "plan.html")
        # Hue: planned or random; dashes: rms.
        for look in (".s1", ".s2"):
            for dash, more in ((":not(.dashed)", "none"), (".dashed", "7px, 4px")):
                self.assertEqual(more, self.js(
                    "getComputedStyle(document.querySelector('#curve .line"
                    f"{look}{dash}')).strokeDasharray"))
        overlaps = self.table("link-overlaps")
        self.assertEqual([[o["pose"], o["first"], o["second"]]
                          for o in plan["links"]["overlaps"]],
                         [[row[0][1], row[1][0], row[2][0]] for row in overlaps])
        self.assertGreater(len(overlaps), 0)
        self.assertIn("a rough model of the arm, not a check",
                      self.text("#warnings"))
        self.open(self.plan / "plan.html", width=390, scheme="dark")
        self.assertLessEqual(self.js("document.documentElement.scrollWidth"), 390)

    def test_trials_are_distributions(self):
        page = self.trials / "montecarlo.html"
        rows = list(csv.DictReader(io.StringIO(
            (self.trials / "trials.csv").read_text(encoding="utf-8"))))
        self.open(page, scripts=False)
        counts = self.js("""[...document.querySelectorAll(
            '#error-histogram .tips title')].map((t) => t.textContent)""")
        self.assertEqual(len(rows), sum(
            int(re.search(r"([0-9]+) trial", text)[1]) for text in counts))
        median = statistics.median(float(row["workspace_rms_mm"])
                                   for row in rows)
        said = re.search(r"([0-9.]+) mm in the median trial",
                         self.text("#error-histogram figcaption"))
        self.assert_near(median, float(said[1]), 0.006)
        self.assertLess(page.stat().st_size, 5e5)
        self.open(page, width=390, scheme="dark")
        self.assertLessEqual(self.js("document.documentElement.scrollWidth"), 390)
        self.assertGreater(self.marks("#pair-1 .mark, #pair-1 .dots"), 50)

    def test_many_results_are_runs(self):
        self.open(self.runs / "comparison.html")
        self.assertEqual("Runs on the same data", self.text("h1"))
        self.assertRegex(self.text(".verdict"),
                         "40 runs: after calibration the mean error at "
                         "training poses is .* in the median run")
        self.assertEqual(20, len(self.table("methods")))
        self.assertNotIn("ways", self.text("main"))
        for part in ("error-histogram", "error-distribution", "pair-1"):
            self.assertGreater(self.marks(f"#{part} path"), 1)


if __name__ == "__main__":
    pages.main()
