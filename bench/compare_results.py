#!/usr/bin/python3
"""Compares the numbers in the results of two builds of Alidade.

JSON is compared by key, CSV by cell, arm.yaml by value, simulated data by byte,
and what `identify` prints by number; other texts, pages and figures are not.

A number may differ by 1e-9 of itself or 1e-6 of the standard deviation of its
parameter, whichever is larger. What follows from parameters may move with them:
errors by 1e-6 of the standard deviation of a measurement, whitened quantities by
1e-6, standard deviations and singular values by 1e-6 of themselves. Lengths and
angles below 1e-12 m and rad do not count, nor times, a solver's steps, and
statistics of residuals that are rounding errors (data without noise).

Usage: bench/compare_results.py DIR NAME...
    compares DIR/old/NAME with DIR/new/NAME, which scripts/compare_results has
    made; lists the worst differences of each file, and all in DIR/differences.csv
"""

from __future__ import annotations

import csv
import json
import math
import re
import sys
from collections import Counter
from pathlib import Path
from typing import Any, NamedTuple

RELATIVE = 1e-9
STATISTICAL = 1e-6
FLOOR = 1e-12  # m or rad
NO_GAP = 1e9  # larger ratios are to singular values that are rounding errors
SHOWN = 10  # differences of a file
NUMBER = (int, float)
MISSING = Path("missing")  # prints well, and equals no value

# What the new program no longer writes: "NAME/FILE", or paths of values as they
# are printed here, without what is in brackets.
REMOVED = re.compile(r"(?!)")
# Keys, columns and files that it calls otherwise, and words. How a solver noticed
# that it was done is a matter of its steps.
RENAMED = {
    "heldout.csv": "validation.csv",
    "stands_for": "identified_combination",
    "length_freedom": "length_degrees_of_freedom",
    "rotation_freedom": "rotation_degrees_of_freedom",
} | {
    key: key.replace("heldout", "validation")
    for key in (
        "heldout heldout_rotation heldout_rms_before heldout_rms_after"
        " heldout_max_before heldout_max_after"
    ).split()
}
WORDS = {
    "rounding_floor": "converged",
    "precision_limit": "converged",
    "frozen": "fixed",
    "heldout_rms": "validation_rms",
    "heldout_max": "validation_max",
    "alidade-result-1": "alidade-result-2",
    "alidade-plan-result-1": "alidade-plan-result-2",
    "alidade-batch-1": "alidade-batch-2",
}

# What is to be other than before, "FILE:PATH" without entries of lists, and why.
CHANGED = {
    r"predicted_map\.csv:.*(std|axis\d)"
    r"|result\.json:uncertainty/(workspace/(position|rotation)_std|heldout)/.*": (
        "predictions contain what the model lacks, outliers are left out"
    ),
    r"result\.json:identifiability/.*(_rank|observability|relations).*": (
        "ranks perturb base and tool too, rotations of the base count by the reach"
    ),
}

IDENTITIES = "name parameter first second observation quantity path frozen".split()
UNITS = {"_mm": 1e-3, "_deg": math.pi / 180}
SKIPPED = re.compile(
    r"version|command|message|sha256|times|\w+_s|iterations|\w+ed_steps"
    r"|evaluation|trust_region_\w+|first_step_rank|rounding_floor|threads_\w+"
)
ROUNDING = re.compile(r"normality|whiteness|\w+_histogram|chi_square_p_value")
WHITENED = re.compile(
    r"(\w+_)?(chi_square|cost|p_value|statistic|correlation|nonlinearity|rms_z|weight"
    r"|prior_share|leverage|cooks_distance|standardised(_residual)?)"
    r"|degrees_of_freedom|outlier_limit"
)
DERIVED = re.compile(
    r"o[1-5]|condition|gap|singular_values|(\w+_)?(std|sigma)|axis\d|coefficient"
    r"|workspace_rms|data_rms"
)
ERROR = re.compile(
    r"(\w+_)?(mean|rms|stddev|median|p95|min|max|error|obtained|rotation|d[xyz])(_\w+)?"
)
GEOMETRY = re.compile(
    r"values?|nominal|position|coefficient|lower|upper|amount|singular_values"
    r"|(\w+_)?(deviation|norm)|[xyz]|q\d+"
)


class Difference(NamedTuple):
    """Of one value, or of what is there."""

    file: str
    path: str
    old: Any
    new: Any
    allowed: float

    def excess(self) -> float:
        """By how much it is too large."""
        if self.allowed and isinstance(self.old, NUMBER):
            return abs(self.old - self.new) / self.allowed
        return math.inf


def without_entries(path: str) -> str:
    """A path without the names and numbers of entries of lists."""
    return re.sub(r"\[.*?\]", "[]", path)


def identity(entry: Any) -> str:
    """What an entry of a list is called, or nothing."""
    entry = entry if isinstance(entry, dict) else {}
    return ", ".join(str(entry[key]) for key in IDENTITIES if key in entry)


def read_yaml(path: Path) -> dict[str, Any]:
    """Values of an arm by the names that parameters have."""
    values: dict[str, Any] = {}
    section, index = "", 0
    for line in path.read_text().splitlines():
        if not (entry := re.match(r"( *)(- )?(\w+): *(.*?)(?:\s+#.*)?$", line)):
            continue
        indent, item, key, value = entry.groups()
        section, index = (section, index + bool(item)) if indent else (key, 0)
        if indent and section == "joints":
            key = f"{key}{index}"
        elif indent:
            block = "tool" if section == "targets" else section
            key = f"{block}{index if index > 1 else ''}_{key}"
        try:
            values[key] = json.loads(value)
        except json.JSONDecodeError:
            values[key] = value
    return values


def in_si(cell: str, unit: float) -> Any:
    """A number, or else the text."""
    try:
        number = float(cell) * unit
    except ValueError:
        return cell
    return number if math.isfinite(number) else cell


def read_csv(path: Path) -> list[dict[str, Any]]:
    """Rows in SI units; of solvers' iterations those of the pseudo-inverse."""
    with open(path, newline="") as file:
        rows = list(csv.reader(x for x in file if not x.startswith("#")))
    units = [next((u for u in UNITS if x.endswith(u)), "") for x in rows[0]]
    names = [x.removesuffix(u) for x, u in zip(rows[0], units)]
    table = []
    for row in rows[1:]:
        if path.name == "iterations.csv" and row[0] != "pseudo_inverse":
            continue
        cells = [in_si(cell, UNITS.get(x, 1.0)) for cell, x in zip(row, units)]
        table.append(dict(zip(names, cells)))
    return table


def read_json(path: Path) -> Any:
    """With what studies/rv2aj writes beside a result, as result.json once had."""
    value = json.loads(path.read_text())
    study = path.with_name("study.json")
    if path.name == "result.json" and study.exists():
        value["study"] = json.loads(study.read_text())
    return value


NUMBERS = re.compile(r"(?<![\w.+])-?\d+(?:\.\d+)?(?:e[-+]\d+)?(?!\w|\.\d)")
READERS = {
    "identify.txt": lambda path: list(map(float, NUMBERS.findall(path.read_text()))),
    ".json": read_json,
    ".csv": read_csv,
    ".yaml": read_yaml,
}


class Comparison:
    """Collects how the results of two programs differ."""

    def __init__(self) -> None:
        self.differences: list[Difference] = []
        self.notes: Counter[str] = Counter()
        self.files = self.numbers = 0

    def folders(self, old: Path, new: Path, name: str) -> None:
        """Compares all files of one configuration."""
        for path in sorted(old.rglob("*")):
            read = READERS.get(path.name) or READERS.get(path.suffix)
            self.file = f"{name}/{path.relative_to(old)}"
            other = new / path.relative_to(old)
            other = other.with_name(RENAMED.get(path.name, path.name))
            if not read or REMOVED.fullmatch(self.file):
                continue
            self.files += 1
            if not other.exists():
                self.differ("", "file", MISSING)
            elif path.read_bytes() != other.read_bytes():
                if path.name == "simulated.csv":
                    self.differ("", "bytes", "other bytes")
                self.take_scales(old, path)
                self.values("", read(path), read(other), 0.0)

    def take_scales(self, folder: Path, path: Path) -> None:
        """Standard deviations of what `calibrate` has estimated, if it has."""
        self.stds: dict[str, float] = {}
        self.sigma = self.rotation_sigma = 0.0
        self.exact = False
        places = [path.parent, folder / "calibrate", *folder.glob("batch/*/*")]
        found = [x / "result.json" for x in places if (x / "result.json").exists()]
        if not found:
            return
        result = json.loads(found[0].read_text())
        for x in result["parameters"]:
            for key in (x["name"], x["name"].rsplit("_", 1)[0]):  # base_x and base
                self.stds[key] = max(x["std"] or 0.0, self.stds.get(key, 0.0))
        self.order = [x["name"] for x in result["parameters"]]
        self.free = [x["name"] for x in result["uncertainty"]["parameters"]]
        self.sigma = result["fit"]["sigma"]
        self.rotation_sigma = result["fit"]["estimated_rotation_sigma"] or self.sigma
        self.exact = result["accuracy"]["train"]["after"]["max"] < FLOOR

    def differ(self, path: str, old: Any, new: Any, allowed: float = 0.0) -> None:
        """Notes a difference that counts."""
        place = f"{Path(self.file).name}:{without_entries(path)}"
        for pattern, reason in CHANGED.items():
            if re.fullmatch(pattern, place):
                self.notes[f"on purpose: {reason}"] += 1
                return
        self.differences.append(Difference(self.file, path, old, new, allowed))

    def values(self, path: str, old: Any, new: Any, std: float) -> None:
        """Compares what there is, std being that of the parameter, or 0."""
        if isinstance(old, dict) and isinstance(new, dict):
            self.objects(path, old, new, std)
        elif isinstance(old, list) and isinstance(new, list):
            self.lists(path, old, new, std)
        elif isinstance(old, NUMBER) and isinstance(new, NUMBER):
            self.numbers += 1
            allowed = self.allowed(path, abs(old), abs(new), std)
            if old != new and not abs(old - new) <= allowed:
                self.differ(path, old, new, allowed)
        elif isinstance(old, str) and isinstance(new, str):
            if " " in old and old != new:
                self.notes[f"other text: {without_entries(path)}"] += 1
            elif WORDS.get(old, old) != WORDS.get(new, new):
                self.differ(path, old, new)
        elif old != new:
            self.differ(path, old, new)

    def objects(self, path: str, old: dict, new: dict, std: float) -> None:
        """Compares by key."""
        for key in ("name", "parameter", "block"):
            std = self.stds.get(old.get(key), std)
        std = old["position_std"] if "axis1" in old else std
        for key, value in old.items():
            step = f"{path}/{key}".lstrip("/")
            steps = key == "history" and old["name"] != "pseudo_inverse"
            rounding = self.exact and ROUNDING.fullmatch(key)
            removed = REMOVED.fullmatch(without_entries(step))
            if not (SKIPPED.fullmatch(key) or steps or rounding or removed):
                later = new.get(RENAMED.get(key, key), MISSING)
                self.values(step, value, later, self.stds.get(key, std))
        for key in new.keys() - {RENAMED.get(key, key) for key in old}:
            self.notes[f"only new: {without_entries(f'{path}/{key}')}"] += 1

    def lists(self, path: str, old: list, new: list, std: float) -> None:
        """Compares entries by what they are called, where all have names."""
        named = [{identity(x): x for x in entries} for entries in (old, new)]
        if [len(x) for x in named] == [len(old), len(new)] and "" not in named[0]:
            for name in sorted(named[0].keys() | named[1].keys()):
                a, b = (x.get(name, MISSING) for x in named)
                self.values(f"{path}[{name}]", a, b, std)
            return
        if len(old) != len(new):
            self.differ(path, f"{len(old)} entries", f"{len(new)} entries")
        row = re.search(r"/covariance\[(\d+)\]$", path)
        for i, (a, b) in enumerate(zip(old, new)):
            scale = std
            if path.startswith("runs[") and path.endswith("]/values"):
                scale = self.stds[self.order[i]]
            elif row:
                scale = self.stds[self.free[int(row[1])]] * self.stds[self.free[i]]
            self.values(f"{path}[{i}]", a, b, scale)

    def allowed(self, path: str, old: float, new: float, std: float) -> float:
        """The largest difference that does not count."""
        key = re.sub(r"\[.*?\]", "", path.rsplit("/", 1)[-1])
        allowed = max(RELATIVE * old, STATISTICAL * std)
        if min(old, new) > NO_GAP:
            return math.inf
        if WHITENED.fullmatch(key):
            return max(allowed, STATISTICAL * max(1.0, old))
        if DERIVED.fullmatch(key) or "_std/" in path:
            allowed = max(allowed, STATISTICAL * old)
        if ERROR.fullmatch(key):
            sigma = self.rotation_sigma if "rotation" in path else self.sigma
            allowed = max(allowed, FLOOR, STATISTICAL * sigma)
        if GEOMETRY.fullmatch(key) or key in self.stds:
            allowed = max(allowed, FLOOR)
        return allowed

    def report(self, table: Path) -> None:
        """Prints the worst of each file, and writes all to a table."""
        with open(table, "w", newline="") as file:
            csv.writer(file).writerows([Difference._fields, *self.differences])
        for note, count in sorted(self.notes.items()):
            print(f"{note} ({count})")
        for name, count in Counter(x.file for x in self.differences).items():
            print(f"{name}: {count} differences")
            differences = [x for x in self.differences if x.file == name]
            for x in sorted(differences, key=Difference.excess, reverse=True)[:SHOWN]:
                change = " -> ".join(str(y)[:60] for y in (x.old, x.new))
                print(f"  {x.path}: {change} (allowed: {x.allowed:.2g})")
        counts = f"{self.files} files, {self.numbers} numbers not of the same bytes"
        print(f"{counts}: {len(self.differences)} differences")


def main(folder: str, *names: str) -> int:
    """Compares the configurations named."""
    work = Path(folder)
    comparison = Comparison()
    for name in names:
        comparison.folders(work / "old" / name, work / "new" / name, name)
    comparison.report(work / "differences.csv")
    return 1 if comparison.differences else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
