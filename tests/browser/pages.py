"""What tests of pages in headless Chromium share: the browser, the program, and
how pages are read."""

import base64
import json
import pathlib
import shutil
import subprocess
import sys
import time
import unittest

from selenium import webdriver
from selenium.webdriver.chrome.options import Options
from selenium.webdriver.chrome.service import Service


class Environment:
    """Where the programs and folders are that the command line names."""

    def read(self, arguments):
        self.alidade, self.study, self.source, self.work = (
            pathlib.Path(argument).resolve() for argument in arguments)


ENVIRONMENT = Environment()


def start_browser():
    options = Options()
    for flag in ("--headless=new", "--no-sandbox", "--disable-gpu"):
        options.add_argument(flag)
    options.set_capability("goog:loggingPrefs",
                           {"browser": "ALL", "performance": "ALL"})
    return webdriver.Chrome(options=options,
                            service=Service("/usr/bin/chromedriver"))


def run(*arguments):
    done = subprocess.run([*map(str, arguments)], cwd=ENVIRONMENT.source,
                          capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise RuntimeError(f"{arguments}: {done.stderr}")
    return done.stdout


def run_alidade(*arguments):
    return run(ENVIRONMENT.alidade, *arguments)


def load(path):
    return json.loads(path.read_text(encoding="utf-8"))


def shown_number(text):
    """The number that a cell such as "−6.2×10⁻¹⁴" shows."""
    digits = str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "-0123456789")
    text = text.replace("\u2212", "-").replace("\u202f", "")
    if "×10" in text:
        mantissa, exponent = text.split("×10")
        return float(mantissa) * 10.0 ** int(exponent.translate(digits))
    return float(text)


def calibrate(job, directory):
    """What the terminal shows of it."""
    return run_alidade("calibrate", f"configs/jobs/{job}.yaml", "--report",
                       f"--out={directory}")


def copy_result(source, target, change):
    """A copy of a result directory whose result.json `change` has edited."""
    shutil.copytree(source, target)
    result = load(target / "result.json")
    change(result)
    # As of an earlier version: judged when it is read.
    del result["verdict"]
    (target / "result.json").write_text(json.dumps(result), encoding="utf-8")
    return target


def page_count(pdf):
    return pdf.count(b"/Type /Page\n") + pdf.count(b"/Type /Page ")


class PageTest(unittest.TestCase):
    """A browser, and a folder of results that `make_results` fills."""

    @classmethod
    def setUpClass(cls):
        cls.work = ENVIRONMENT.work
        shutil.rmtree(cls.work, ignore_errors=True)
        cls.work.mkdir(parents=True)
        cls.make_results()
        cls.browser = start_browser()

    @classmethod
    def tearDownClass(cls):
        cls.browser.quit()

    def cdp(self, command, **parameters):
        return self.browser.execute_cdp_cmd(command, parameters)

    def js(self, script, *arguments):
        return self.browser.execute_script("return " + script, *arguments)

    def open(self, path, width=1280, scheme="light", scripts=True):
        self.cdp("Emulation.setDeviceMetricsOverride", width=width, height=900,
                 deviceScaleFactor=1, mobile=width < 600)
        self.cdp("Emulation.setEmulatedMedia", features=[
            {"name": "prefers-color-scheme", "value": scheme}])
        self.cdp("Emulation.setScriptExecutionDisabled", value=not scripts)
        self.browser.get(path.resolve().as_uri())
        # Loaded is not yet drawn, on a busy machine.
        end = time.monotonic() + 30.0
        wanted = "true" if scripts else None
        ready = "document.documentElement.dataset.ready"
        while self.js(ready) != wanted and time.monotonic() < end:
            time.sleep(0.05)
        self.assertEqual(wanted, self.js(ready))
        self.assertEqual([], self.browser.get_log("browser"))
        self.assertEqual({path.resolve().as_uri()}, self.requests())

    def printed(self):
        """The open page as a PDF."""
        pdf = base64.b64decode(self.cdp(
            "Page.printToPDF", printBackground=True,
            preferCSSPageSize=True)["data"])
        self.assertTrue(pdf.startswith(b"%PDF"))
        return pdf

    def requests(self):
        """What the page has asked for, be it served or not."""
        messages = [json.loads(entry["message"])["message"]
                    for entry in self.browser.get_log("performance")]
        urls = [m["params"]["request"]["url"] for m in messages
                if m["method"] == "Network.requestWillBeSent"]
        return {url for url in urls if not url.startswith(("data:", "chrome"))}

    def table(self, name):
        """Rows of a table as lists of [text, exact value or None]."""
        return self.js("""[...document.querySelectorAll('#' + arguments[0] +
            ' tbody tr:not(.group)')].map((row) => [...row.children].map((cell) =>
            [cell.textContent, cell.dataset.value === undefined ? null
              : Number(cell.dataset.value)]))""", name)

    def column(self, name, title):
        """Where a table has the column of a title, from 0."""
        return self.js("""[...document.querySelectorAll('#' + arguments[0] +
            ' thead th')].findIndex((h) => h.textContent === arguments[1])""",
            name, title)

    def text(self, selector):
        """Of the first such element that is shown."""
        return self.js("""[...document.querySelectorAll(arguments[0])].find(
            (element) => element.checkVisibility()).textContent""", selector)

    def marks(self, selector):
        """How many marks or lines such paths draw."""
        return self.js("""[...document.querySelectorAll(arguments[0])].map(
            (path) => path.getAttribute('d')).join()""", selector).count("M")

    def assert_near(self, expected, obtained, relative):
        self.assertLessEqual(abs(obtained - expected), relative * abs(expected),
                             f"{obtained} for {expected}")


def main():
    ENVIRONMENT.read(sys.argv[1:5])
    unittest.main(argv=sys.argv[:1])
