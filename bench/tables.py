#!/usr/bin/python3
"""Writes the tables of docs/benchmarks.md from what scripts/bench measured."""

from __future__ import annotations

import csv
import json
import os
import platform
import subprocess
import sys
from collections import defaultdict
from pathlib import Path

METHODS = [
    ("autodiff", "1", "autodiff"),
    ("analytic", "1", "analytic Ceres"),
    ("pseudo-inverse", "1", "pseudo-inverse"),
    ("scipy", "1", "scipy trf"),
    ("reduced", "1", "reduced"),
    ("reduced", "2", "reduced, 2 threads"),
]


def milliseconds(seconds: float) -> str:
    """Three digits."""
    value = 1e3 * seconds
    return f"{value:.3g}" if value < 1e3 else f"{value:.0f}"


def check_costs(path: Path) -> None:
    """All ways must have ended in the same minimum."""
    costs: dict[tuple[str, str], list[float]] = defaultdict(list)
    with open(path, newline="", encoding="utf-8") as file:
        for arm, poses, _, _, _, _, cost in csv.reader(file):
            costs[arm, poses].append(float(cost))
    for key, values in costs.items():
        if max(values) - min(values) > 1e-9 * max(values):
            sys.exit(f"tables: the ways disagree about the cost of {key}: {values}")


def solve_tables(path: Path) -> str:
    """Times, and how many times faster the reduced solve is."""
    times: dict[tuple[str, int], dict[tuple[str, str], float]] = defaultdict(dict)
    with open(path, newline="", encoding="utf-8") as file:
        for arm, poses, method, threads, seconds, _, _ in csv.reader(file):
            times[arm, int(poses)][method, threads] = float(seconds)
    names = [name for _, _, name in METHODS]
    lines = [f"| measured at | N | {' | '.join(names)} |"]
    lines.append("|---|" + "---|" * (len(names) + 1))
    for (arm, poses), row in sorted(times.items()):
        cells = [
            milliseconds(row[method, threads]) if (method, threads) in row else "-"
            for method, threads, _ in METHODS
        ]
        lines.append(f"| {arm} | {poses} | {' | '.join(cells)} |")
    lines.append("")
    others = METHODS[:4] + METHODS[5:]
    header = " | ".join(name for _, _, name in others)
    lines.append(f"| measured at | N | {header} | ns per pose and iteration |")
    lines.append("|---|" + "---|" * (len(others) + 2))
    iterations: dict[tuple[str, int], int] = {}
    with open(path, newline="", encoding="utf-8") as file:
        for arm, poses, method, threads, _, count, _ in csv.reader(file):
            if (method, threads) == ("reduced", "1"):
                iterations[arm, int(poses)] = int(count)
    for key, row in sorted(times.items()):
        ours = row["reduced", "1"]
        cells = [
            f"{row[method, threads] / ours:.3g}" if (method, threads) in row else "-"
            for method, threads, _ in others
        ]
        each = 1e9 * ours / key[1] / iterations[key]
        lines.append(f"| {key[0]} | {key[1]} | {' | '.join(cells)} | {each:.0f} |")
    return "\n".join(lines)


def medians(path: Path) -> list[dict]:
    """Of Google Benchmark's repetitions."""
    with open(path, encoding="utf-8") as file:
        runs = json.load(file)["benchmarks"]
    return [run for run in runs if run["aggregate_name"] == "median"]


def rate_of(run: dict) -> str:
    """What a benchmark counts, in the unit of its table's last column."""
    if "allocations" in run:
        return f"{run['allocations']:.0f}"
    if "bytes_per_second" in run:
        return f"{run['bytes_per_second'] / 1e6:.0f}"
    if "items_per_second" in run:
        return f"{1e9 / run['items_per_second']:.3g}"
    return "-"


def kernel_table(path: Path, unit_of_rate: str, without_avx512: Path | None = None) -> str:
    """Times and rates, and rates on a machine without AVX-512."""
    runs = medians(path)
    others = medians(without_avx512) if without_avx512 else []
    last = f" {unit_of_rate} with AVX2 |" if others else ""
    lines = [f"| benchmark | CPU time | {unit_of_rate} |{last}"]
    lines.append("|---|---|---|" + ("---|" if others else ""))
    other_rates = {run["run_name"]: rate_of(run) for run in others}
    for run in runs:
        name = run["run_name"].removesuffix("/real_time")
        cells = [name, f"{run['cpu_time']:.4g} {run['time_unit']}", rate_of(run)]
        if others:
            cells.append(other_rates[run["run_name"]])
        lines.append(f"| {' | '.join(cells)} |")
    return "\n".join(lines)


def output(*command: str) -> str:
    """What a command prints first."""
    result = subprocess.run(command, check=True, capture_output=True, text=True)
    return result.stdout.splitlines()[0]


def processor() -> str:
    """The name of the processor, and its vector instructions."""
    with open("/proc/cpuinfo", encoding="utf-8") as file:
        text = file.read()
    name = next(
        (line.split(":")[1].strip() for line in text.splitlines() if "model name" in line),
        platform.machine(),
    )
    for flag, target in (("avx512f", "AVX-512"), ("avx2", "AVX2")):
        if flag in text:
            return f"{name} with {target}"
    return name


def insert(page: Path, mark: str, table: str) -> None:
    """Puts a table between its marks."""
    script = Path(__file__).resolve().parents[1] / "scripts" / "insert_table"
    subprocess.run([script, page, mark, "-"], input=table, text=True, check=True)


def main() -> int:
    work, page = Path(sys.argv[1]), Path(sys.argv[2])
    machine = (
        f"Commit {output('git', 'rev-parse', '--short', 'HEAD')}; {processor()}, "
        f"{len(os.sched_getaffinity(0))} cores; "
        f"{output('g++', '--version')}, -O3. Solves: poses of seed 1, noise of seed 2, deviations of seed 3."
    )
    check_costs(work / "solves.csv")
    tables = {
        "machine": machine,
        "solves": solve_tables(work / "solves.csv"),
        "kernels": kernel_table(
            work / "kernels.json", "ns per pose", work / "kernels_avx2.json"
        ),
        "small": kernel_table(work / "small_calibration.json", "allocations"),
        "files": kernel_table(work / "csv_speed.json", "MB/s"),
    }
    for mark, table in tables.items():
        insert(page, mark, table)
    return 0


if __name__ == "__main__":
    sys.exit(main())
