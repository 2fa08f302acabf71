#!/usr/bin/python3
"""Gathers what fuzzing begins with out of the repository: for each target
OUT/seeds/TARGET with inputs, and OUT/TARGET.dict with words.

Inputs are configs, data sets and the blocks of docs/; the files that jobs and
plans name become the small ones of tests/fuzz/files. Words of YAML files come
from their schemas, others from tests/fuzz/TARGET.dict.

Usage: gather.py OUT
"""

import hashlib
import json
import pathlib
import re
import shutil
import struct
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
HERE = ROOT / "tests" / "fuzz"
TARGETS_OF_FORMAT = {
    "alidade-arm": ["arm"], "alidade-deviations": ["deviations"],
    "alidade-job": ["job", "matrix"], "alidade-plan": ["plan"],
    "alidade-simulation": ["simulation"]}
SCHEMAS = {"arm": "arm", "deviations": "deviations", "job": "job",
           "matrix": "job", "plan": "plan", "simulation": "simulation"}
YAML_WORDS = [": ", "- ", "\n", "\n  ", "{", "}", "[", "]", ", ", "~", "null",
              "true", "false", ".inf", "-.inf", ".nan", "1e308", "-1e-320",
              "0", "-1", "1000000", "'", '"', "#", "&a ", "*a", "!t ", "|\n",
              "---\n", "${HOME}", "arm.yaml", "data.csv", "deviations.yaml",
              "job.yaml", "*.csv", "beta1: ", "d3: ", "tool_x: ", "base_rx: "]
MOST_BYTES = 4096
ROWS = 6


def own_files(text):
    """The paths of other files, as those of tests/fuzz/files."""
    text = re.sub(r"#.*", "", text)
    text = re.sub(r"[^\s\[\]{},:]+\.(csv|npy|txt)\b", "data.csv", text)
    text = re.sub(r"\b(truth|deviations): *[^\s\[\]{},]+\.yaml",
                  r"\1: deviations.yaml", text)
    text = re.sub(r"\b(job|extends): *[^\s\[\]{},]+\.yaml", r"\1: job.yaml",
                  text)
    text = re.sub(r"\barm: *[^\s\[\]{},]+", "arm: arm.yaml", text)
    return re.sub(r"\n\s*\n+", "\n", text)


def pieces():
    """All texts that may be seeds, with the endings of their names."""
    for folder in ["configs", "datasets"]:
        for path in sorted((ROOT / folder).rglob("*.*")):
            yield path.suffix, path.read_text(errors="replace")
    for path in sorted((ROOT / "docs").rglob("*.md")):
        for kind, block in re.findall(r"```(\w*)\n(.*?)```",
                                      path.read_text(), re.S):
            yield "." + kind, block


def head_of(table):
    lines = table.splitlines(True)
    rows = [k for k, line in enumerate(lines)
            if line.strip() and not line.startswith("#")]
    return "".join(lines[:rows[min(ROWS, len(rows) - 1)] + 1])


def npy_of(table):
    """The bytes of an array of a plain CSV's numbers, or None."""
    lines = [line.split(",") for line in table.split("\n")
             if line and line[0] != "#"]
    try:
        rows = [[float(cell) for cell in row] for row in lines[1:]]
    except ValueError:
        return None
    fields = [(name.strip(), "<f8") for name in lines[0]]
    header = str({"descr": fields, "fortran_order": False,
                  "shape": (len(rows),)})
    header += " " * (63 - (10 + len(header)) % 64) + "\n"
    return (b"\x93NUMPY\x01\x00" + struct.pack("<H", len(header)) +
            header.encode() +
            b"".join(struct.pack("<d", x) for row in rows for x in row))


def seeds():
    """Targets and inputs."""
    for ending, text in pieces():
        found = re.search(r"^format: (alidade-[a-z]+)-\d", text, re.M)
        if found:
            for target in TARGETS_OF_FORMAT.get(found[1], []):
                yield target, own_files(text).encode()
        elif ending in {".csv", ".txt"} and text.strip():
            table = head_of(text)
            yield "csv", table.encode()
            array = npy_of(table)
            if array:
                yield "npy", array
        elif ending == ".src":
            yield "program", b"1" + text.encode()
    yield "list", b"a.yaml\n# b\n\n folder/\n/c.yaml"


def words_of_schema(schema):
    """Keys and choices of a schema, wherever they stand."""
    if isinstance(schema, list):
        for item in schema:
            yield from words_of_schema(item)
    elif isinstance(schema, dict):
        for key, value in schema.items():
            if key in {"properties", "$defs"}:
                yield from (name + ": " for name in value)
            if key == "enum":
                yield from (str(choice) for choice in value)
            yield from words_of_schema(value)


def escaped(word):
    return "".join(chr(b) if 32 <= b < 127 and b not in b'"\\'
                   else f"\\x{b:02x}" for b in word.encode())


def write_words(path, words):
    path.write_text("".join(f'"{escaped(word)}"\n'
                            for word in sorted(set(words)) if word))


def main():
    if len(sys.argv) != 2:
        sys.exit(print(__doc__, file=sys.stderr) or 2)
    out = pathlib.Path(sys.argv[1])
    shutil.rmtree(out / "seeds", ignore_errors=True)
    targets = [path.name for path in (HERE / "corpus").iterdir()]
    for target in targets:
        (out / "seeds" / target).mkdir(parents=True)
    for target, text in seeds():
        text = text[:MOST_BYTES]
        name = hashlib.sha256(text).hexdigest()[:16]
        (out / "seeds" / target / name).write_bytes(text)
    for target in targets:
        path = out / f"{target}.dict"
        if target in SCHEMAS:
            schema = ROOT / "schemas" / f"{SCHEMAS[target]}.json"
            write_words(path, YAML_WORDS + list(
                words_of_schema(json.loads(schema.read_text()))))
        elif target == "result":
            texts = [file.read_text(errors="replace")
                     for file in (HERE / "corpus" / target).iterdir()]
            write_words(path, re.findall(r'"(\w+)":', "".join(texts)))
            path.write_text(path.read_text() +
                            (HERE / path.name).read_text())
        else:
            shutil.copy(HERE / path.name, path)


if __name__ == "__main__":
    main()
