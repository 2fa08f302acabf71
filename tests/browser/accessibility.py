#!/usr/bin/python3
"""Runs axe-core over pages in headless Chromium, light and dark, wide and
narrow, with everything that is folded opened; prints what it finds and fails
where that is serious or critical.

Usage: accessibility.py AXE.min.js PAGE.html...
"""

import pathlib
import sys

from pages import start_browser

GRAVE = ("serious", "critical")


def faults(browser, axe, page, scheme, width):
    """Violations as axe states them."""
    browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", {
        "width": width, "height": 900, "deviceScaleFactor": 1,
        "mobile": width < 600})
    browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": [
        {"name": "prefers-color-scheme", "value": scheme}]})
    browser.get(page.resolve().as_uri())
    browser.execute_script(
        "for (const fold of document.querySelectorAll('details'))"
        " fold.open = true;")
    browser.execute_script(axe)
    return browser.execute_async_script(
        "const done = arguments[0];"
        "axe.run({resultTypes: ['violations']})"
        ".then((found) => done(found.violations),"
        " (error) => done([{impact: 'critical', id: String(error),"
        " help: 'axe failed', nodes: []}]));")


def main():
    axe = pathlib.Path(sys.argv[1]).read_text(encoding="utf-8")
    browser = start_browser()
    browser.set_script_timeout(120)
    grave = 0
    for page in map(pathlib.Path, sys.argv[2:]):
        for scheme in ("light", "dark"):
            for width in (1280, 390):
                for fault in faults(browser, axe, page, scheme, width):
                    is_grave = fault["impact"] in GRAVE
                    grave += is_grave
                    places = [node["html"][:160] for node in fault["nodes"]]
                    print(f"{page} {scheme} {width}: {fault['impact']}: "
                          f"{fault['id']}: {fault['help']} "
                          f"({len(places)} places)")
                    for place in places[:3]:
                        print("    " + place)
    browser.quit()
    count = len(sys.argv) - 2
    print(f"{count} pages: {grave} serious or critical faults")
    return 1 if grave else 0


if __name__ == "__main__":
    sys.exit(main())
