#!/usr/bin/env python3
"""Runs the commands of the documentation and compares what they print.

A block ```console of a page of docs/ holds commands, `$ alidade ...`, each
followed by its output, standard output and errors together, and by
`(exit status N)` where that is not 0. All commands of a page run in one fresh
copy of configs, datasets and scripts, as from the root of the repository.
Words must be the same, numbers equal to three digits, as machines round
differently; times may be any. `...` stands for any lines. A block after
<!-- file: PATH --> shows that file as it is, one after <!-- write: PATH --> is
what the reader writes to that file before the next command.

Links and anchors of all pages must lead somewhere.

Usage: pages_test.py [--update] ALIDADE [PAGE...]
  --update  write what the commands print into the pages instead
"""

import difflib
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
DOCS = ROOT / "docs"
BLOCK = re.compile(r"^(?:<!-- (file|write): (\S+) -->\n(```\w*)|```console)\n"
                   r"(.*?)^```$", re.MULTILINE | re.DOTALL)
NUMBER = re.compile(r"[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?")
PROGRESS = re.compile(r"\[#*\.*\] \d+/\d+ jobs")
LINK = re.compile(r"!?\[[^\]]*\]\(([^)\s]+)\)")
RELATIVE = 1e-3
ROUNDING = 1e-9  # what is smaller is the rounding of exact data


class Shell:
    """Runs commands in a copy of the files that they may name."""

    def __init__(self, alidade, folder):
        self.folder = pathlib.Path(folder)
        for name in ("configs", "datasets", "docs", "scripts"):
            shutil.copytree(ROOT / name, self.folder / name)
        binaries = self.folder / "build/release/bin"
        binaries.mkdir(parents=True)
        (binaries / "alidade").symlink_to(alidade)
        self.environment = {**os.environ, "PATH": f"{binaries}:/usr/bin:/bin",
                            "HOME": str(folder), "LC_ALL": "C.UTF-8",
                            "ALIDADE_ROBOTS": f"{folder}/configs/robots"}

    def run(self, command):
        done = subprocess.run(
            ["bash", "-c", command], cwd=self.folder,
            env=self.environment, text=True, stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT, check=False)
        lines = [line.rstrip() for line in done.stdout.splitlines()
                 if not PROGRESS.match(line)]
        while lines and not lines[-1]:
            lines.pop()
        if done.returncode:
            lines.append(f"(exit status {done.returncode})")
        return lines


def commands_of(block):
    """Pairs of a command's lines and its output's."""
    pairs = []
    for line in block.splitlines():
        if line.startswith("$ "):
            pairs.append(([line], []))
        elif not pairs[-1][1] and pairs[-1][0][-1].endswith("\\"):
            pairs[-1][0].append(line)
        else:
            pairs[-1][1].append(line)
    return pairs


def words_and_numbers(line):
    line = re.sub(r"-{2,}", "--", re.sub(r"\s+", " ", line.strip()))
    line = re.sub(r"\d+(\.\d+)? (ms|s|min)\b", "TIME", line)
    numbers = NUMBER.findall(line)
    return NUMBER.sub("#", line), numbers


def is_same_number(expected, actual):
    if expected == actual:
        return True
    mantissa = expected.split("e")[0]
    unit = 10.0 ** -len(mantissa.partition(".")[2])
    if "e" in expected:
        unit *= 10.0 ** int(expected.split("e")[1])
    first, second = float(expected), float(actual)
    if max(abs(first), abs(second)) < ROUNDING:
        return True
    if "." not in mantissa and "e" not in expected:
        unit = 0.0  # counts
    return abs(first - second) <= RELATIVE * abs(first) + 1.01 * unit


def is_same_line(expected, actual):
    words, numbers = words_and_numbers(expected)
    actual_words, actual_numbers = words_and_numbers(actual)
    return (words == actual_words and len(numbers) == len(actual_numbers) and
            all(map(is_same_number, numbers, actual_numbers)))


def is_same_text(expected, actual):
    if not expected:
        return not actual
    if expected[0].strip() == "...":
        return any(is_same_text(expected[1:], actual[k:])
                   for k in range(len(actual) + 1))
    return bool(actual) and is_same_line(expected[0], actual[0]) and (
        is_same_text(expected[1:], actual[1:]))


def shortened(expected, actual):
    """What the program prints, with lines left out as in `expected`: parts
    between `...` begin where their first line has the same words."""
    if not any(line.strip() == "..." for line in expected):
        return actual
    lines, k, is_open = [], 0, False
    for line in expected:
        if line.strip() == "...":
            lines.append(line)
            is_open = True
            continue
        if is_open:
            same = [i for i in range(k, len(actual)) if words_and_numbers(
                actual[i])[0] == words_and_numbers(line)[0]]
            k = same[0] if same else len(actual) - 1
            is_open = False
        lines += actual[k:k + 1]
        k += 1
    return lines


def run_page(page, shell, update):
    """Complaints; where asked for, the page is brought up to date."""
    complaints = []

    def run_block(block):
        lines = []
        for command, expected in commands_of(block):
            text = "\n".join(command)[2:]
            actual = shell.run(text)
            same = is_same_text(expected, actual)
            if not same:
                complaints.append(f"{page}: $ {text}\n" + "\n".join(
                    difflib.unified_diff(expected, actual, "page", "program",
                                         lineterm="", n=1)))
            lines += command + (
                expected if same else shortened(expected, actual))
        return "```console\n" + "".join(f"{line}\n" for line in lines) + "```"

    def look_at(match):
        what, path, fence, content = match.groups()
        if what is None:
            return run_block(content)
        if what == "write":
            target = shell.folder / path
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_text(content, encoding="utf-8")
        elif content != (ROOT / path).read_text(encoding="utf-8"):
            complaints.append(f"{page}: not as the file {path}")
            content = (ROOT / path).read_text(encoding="utf-8")
        return f"<!-- {what}: {path} -->\n{fence}\n{content}```"

    text = page.read_text(encoding="utf-8")
    updated = BLOCK.sub(look_at, text)
    if update and updated != text:
        page.write_text(updated, encoding="utf-8")
    return complaints


def anchors_of(page):
    """As GitHub makes them of headings."""
    text = re.sub(r"^(```|    ).*?$", "", page.read_text(encoding="utf-8"),
                  flags=re.MULTILINE)
    headings = re.findall(r"^#+ (.*)$", text, re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-")
            for heading in headings}


def broken_links(page):
    text = re.sub(r"^```.*?^```$|`[^`\n]*`", "",
                  page.read_text(encoding="utf-8"),
                  flags=re.MULTILINE | re.DOTALL)
    for link in LINK.findall(text):
        if re.match(r"\w+:", link):
            continue
        path, _, anchor = link.partition("#")
        target = (page.parent / path) if path else page
        if not target.exists():
            yield f"{page}: no file for the link {link}"
        elif anchor and anchor not in anchors_of(target):
            yield f"{page}: no heading for the link {link}"


def main(arguments):
    update = "--update" in arguments
    paths = [pathlib.Path(a).resolve() for a in arguments if a[:2] != "--"]
    alidade, pages = paths[0], paths[1:] or sorted(DOCS.rglob("*.md"))
    complaints = []
    for page in [*pages, ROOT / "README.md"]:
        complaints += broken_links(page)
        text = page.read_text(encoding="utf-8")
        if BLOCK.search(text):
            with tempfile.TemporaryDirectory() as folder:
                complaints += run_page(page, Shell(alidade, folder), update)
    print("\n\n".join(complaints))
    return 1 if complaints and not update else 0


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    sys.exit(main(sys.argv[1:]))
