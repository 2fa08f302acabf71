#!/usr/bin/python3
"""Looks at the page of one result in headless Chromium, of an arm before a
tracker (configs/jobs/kr6_tracker.yaml): what it says first and in which order,
that terminal, files and page agree, paper, phone, and what screen readers need.

Usage: result_page_test.py ALIDADE RV2AJ_STUDY SOURCE_DIR WORK_DIR
"""

import re

from made_results import add_uncertainty
from pages import PageTest, calibrate, copy_result, load, main, page_count, \
    run_alidade

# Of a result without sections of its own client.
SECTIONS = ["Accuracy", "Outliers", "Workspace", "Residuals",
            "Accuracy by stage", "Errors that are not rigid geometry",
            "Parameters", "Identifiability", "Uncertainty budget and ISO 9283",
            "Convergence", "Provenance"]


def typeset(text):
    """A sentence of a result as the page prints it, as far as these go."""
    return re.sub(r"(^|[ (\[])-(?=\d)", "\\1\u2212", text).replace("`", "")


class ResultPage(PageTest):
    @classmethod
    def make_results(cls):
        cls.arm = cls.work / "kr6"
        cls.terminal = calibrate("kr6_tracker", cls.arm)
        cls.study = cls.work / "study"
        calibrate("rv2aj_study", cls.study)
        cls.hostile = copy_result(cls.study, cls.work / "hostile",
                                  add_uncertainty)
        run_alidade("report", cls.hostile)

    def test_prints_on_eight_pages_of_a4(self):
        self.open(self.arm / "report.html", scheme="dark")
        pages = page_count(self.printed())
        self.assertGreaterEqual(pages, 5)
        self.assertLessEqual(pages, 8)

    def test_paper_has_no_controls_and_opens_what_is_folded(self):
        self.open(self.arm / "report.html")
        self.cdp("Emulation.setEmulatedMedia", media="print")
        self.js("dispatchEvent(new Event('beforeprint'))")
        self.assertTrue(self.js("document.getElementById('held-parameters')"
                                ".checkVisibility()"))
        shown = self.js("""[...document.querySelectorAll(arguments[0])].filter(
            (e) => e.checkVisibility() && !e.matches('[type=radio]')).length""",
            "nav, button.tool, .controls, .skip, .choice > label, input")
        self.assertEqual(0, shown)
        # Headers with boxes of their own are not repeated on the next page.
        self.assertEqual({"contents"}, set(self.js(
            "[...document.querySelectorAll('thead button')].map((button) =>"
            " getComputedStyle(button).display)")))
        self.js("dispatchEvent(new Event('afterprint'))")
        self.assertEqual(0, self.js(
            "document.querySelectorAll('details[open]').length"))
        self.cdp("Emulation.setEmulatedMedia", media="")

    def test_first_screen_answers_and_sections_follow_in_order(self):
        result = load(self.arm / "result.json")
        self.open(self.arm / "report.html")
        self.assertEqual(SECTIONS, self.js(
            "[...document.querySelectorAll('main > section[aria-labelledby]"
            " > h2')].map((h) => h.textContent)"))
        self.assertEqual(SECTIONS, self.js(
            "[...document.querySelectorAll('nav a')].map((a) =>"
            " a.textContent)"))
        self.assertEqual(
            ["May I use this arm?", "How accurate is it?", "Where is it worst?",
             "What should I measure next?"],
            self.js("[...document.querySelectorAll('#answers dt')].map((dt) =>"
                    " dt.textContent)"))
        answers = self.text("#answers")
        findings = result["verdict"]["findings"]
        for key in ("accuracy", "worst_place", "next_measurement"):
            found = [f for f in findings if f["key"] == key]
            self.assertTrue(found, key)
            for finding in found:
                self.assertIn(typeset(finding["sentence"]), answers)
                self.assertIn(typeset(finding["next"]), answers)
        self.assertIn("2 of 31 validation observations (datasets/kr6/disturbed.csv:", answers)
        self.assertTrue(result["verdict"]["title"].startswith("Accepted"))
        self.assertIn(result["verdict"]["title"], self.text(".decision"))

    def test_terminal_files_and_page_say_the_same(self):
        result = load(self.arm / "result.json")
        self.open(self.arm / "report.html")
        terminal = " ".join(self.terminal.split())
        report = " ".join((self.arm / "report.txt").read_text(
            encoding="utf-8").split())
        for text in (terminal, report):
            self.assertIn(result["verdict"]["sentence"], text)
            for key in ("accuracy", "worst_place", "next_measurement"):
                for finding in result["verdict"]["findings"]:
                    if finding["key"] == key:
                        self.assertIn(finding["sentence"], text)
            for row in self.table("accuracy"):
                self.assertIn(" ".join(cell[0] for cell in row), text)
        run_ = result["runs"][0]
        count = run_["accepted_steps"] + run_["rejected_steps"]
        self.assertEqual(count, run_["history"][-1]["iteration"])
        said = f"after {count} iterations"
        self.assertIn(said, self.text("#solver > p"))
        self.assertIn(said, self.text("#convergence figcaption"))
        rows = {row[0][0]: row[1][0] for row in self.table("solvers")}
        self.assertEqual(str(count), rows["iterations"])
        self.assertIn(f"iterations {count}", report)

    def test_parameters_stand_by_joint_and_others_are_folded(self):
        result = load(self.arm / "result.json")
        self.open(self.arm / "report.html")
        groups = self.js("""[...document.querySelectorAll(
            '#parameters-table tbody')].map((body) => [...body.rows].map(
            (row) => row.cells[0].textContent))""")
        self.assertEqual([f"joint {k}" for k in range(2, 7)] + ["base", "tool"],
                         [group[0] for group in groups])
        for title, *names in groups:
            self.assertTrue(names)
            for name in names:
                self.assertTrue(name.endswith(title[-1]) or
                                name.startswith(title + "_"), (title, name))
        fixed = [p for p in result["parameters"] if p["state"] != "free"]
        self.assertEqual({p["name"] for p in fixed},
                         {row[0][0] for row in self.table("held-parameters")})
        self.assertFalse(self.js("document.getElementById('held-parameters')"
                                 ".checkVisibility()"))
        self.assertIn(f"{len(fixed)} parameters are not estimated",
                      self.text("#parameters summary"))
        self.js("document.querySelector('#parameters summary').click()")
        self.assertTrue(self.js("document.getElementById('held-parameters')"
                                ".checkVisibility()"))

    def test_signs_are_typeset_and_no_column_is_empty(self):
        for directory in (self.arm, self.study, self.hostile):
            self.open(directory / "report.html")
            texts = self.js("""[...document.querySelectorAll(
                'main *:not(code):not(script)')].flatMap((e) =>
                [...e.childNodes].filter((n) => n.nodeType === 3 &&
                !e.closest('code')).map((n) => n.data))""")
            self.assertGreater(len(texts), 100)
            for text in texts:
                self.assertNotRegex(text, r"(^|[ (\[])-\d| \* |\d - ")
            empty = self.js("""[...document.querySelectorAll('main table')]
                .flatMap((table) => [...table.querySelectorAll('thead th')].map(
                (th, k) => [table.id, th.textContent,
                [...table.querySelectorAll('tbody tr:not(.group)')].every(
                (row) => ['', '-', '–'].includes(row.cells[k].textContent))]))
                .filter(([id, title, none]) => none)""")
            self.assertEqual([], empty)

    def test_nothing_is_cut_on_a_phone(self):
        for directory in (self.arm, self.study, self.hostile):
            for scheme in ("light", "dark"):
                self.open(directory / "report.html", width=390, scheme=scheme)
                self.assertLessEqual(
                    self.js("document.documentElement.scrollWidth"), 390)
                cut = self.js("""[...document.querySelectorAll(
                    'h1, h2, h3, p, li, dt, dd, figcaption, summary, label')]
                    .filter((e) => e.checkVisibility() &&
                    (e.scrollWidth > e.clientWidth + 1 && e.clientWidth > 0 ||
                    e.getBoundingClientRect().right > 391) &&
                    !e.closest('.scroll')).map((e) => e.textContent)""")
                self.assertEqual([], cut)
        # Tables scroll in their boxes, and say so.
        cues = self.js("""[...document.querySelectorAll('.scroll')].filter(
            (e) => e.checkVisibility() && e.scrollWidth > e.clientWidth + 1)
            .map((e) => e.parentElement.classList.contains('wider') &&
            getComputedStyle(e, '::before').content)""")
        self.assertGreater(len(cues), 2)
        self.assertEqual({'"more to the right: scroll"'}, set(cues))

    def test_headings_landmarks_and_names_for_screen_readers(self):
        for directory in (self.arm, self.study):
            self.open(directory / "report.html")
            levels = self.js("[...document.querySelectorAll('h1, h2, h3, h4')]"
                             ".map((h) => Number(h.tagName[1]))")
            self.assertEqual(1, levels[0])
            self.assertEqual(1, levels.count(1))
            for before, after in zip(levels, levels[1:]):
                self.assertLessEqual(after, before + 1)
            for landmark in ("main", "nav[aria-label]", "header", "footer"):
                self.assertEqual(1, self.js(
                    "document.querySelectorAll(arguments[0]).length", landmark))
            unnamed = self.js("""[...document.querySelectorAll('main section')]
                .filter((e) => !e.ariaLabel && !document.getElementById(
                e.getAttribute('aria-labelledby'))).length""")
            self.assertEqual(0, unnamed)
            # The visible words are in the name, for those who speak to it.
            self.assertEqual([], self.js("""[...document.querySelectorAll(
                'button[aria-label]')].filter((b) => /\\w/.test(b.textContent) &&
                !b.ariaLabel.includes(b.textContent)).map(
                (b) => b.ariaLabel)"""))


if __name__ == "__main__":
    main()
