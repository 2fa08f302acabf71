#!/usr/bin/python3
"""Times two builds of Alidade side by side (scripts/compare_speed)."""

from __future__ import annotations

import argparse
import json
import os
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Callable, NamedTuple

ROOT = Path(__file__).resolve().parent.parent
TRIALS = 10000  # of the Monte Carlo study

SIMULATION = """format: alidade-simulation-1
title: {count} random poses
units: {{length: mm, angle: deg}}
arm: {root}/configs/robots/rv2aj_flange.yaml
deviations: {root}/configs/robots/rv2aj_deviations.yaml
poses: {{random: {{count: {count}}}}}
noise: {{sigma: 0.02}}
seed: 3
output: {data}
"""

JOB = """format: alidade-job-1
title: {count} poses
units: {{length: mm, angle: rad}}
arm: {root}/configs/robots/rv2aj_flange.yaml
data: {data}
measurement: {{sigma: 0.02}}
outputs: {outputs}
"""


class Run(NamedTuple):
    """What one run of a program took, in seconds."""

    wall: float
    cpu: float
    solve: float  # as result.json says; 0 where there is none


class Workload(NamedTuple):
    """Arguments of a program, and what of its run is compared."""

    name: str
    arguments: list[str]
    quantity: str  # a field of Run


def run(program: str, arguments: list[str], out: Path) -> Run:
    """One run that must succeed, into an empty directory."""
    before = os.times()
    start = time.perf_counter()
    done = subprocess.run(
        [program, *arguments, f"--out={out}"], capture_output=True, text=True
    )
    wall = time.perf_counter() - start
    after = os.times()
    if done.returncode not in (0, 1):
        sys.exit(f"compare_speed: {program} {' '.join(arguments)}\n{done.stderr}")
    cpu = (after.children_user - before.children_user) + (
        after.children_system - before.children_system
    )
    result = out / "result.json"
    solve = 0.0
    if result.exists():
        solve = json.loads(result.read_text())["solver"]["time_s"]
    return Run(wall, cpu, solve)


def simulate(program: str, work: Path, count: int) -> Path:
    """A data set of so many positions, as CSV."""
    data = work / f"{count}.csv"
    file = work / f"simulate_{count}.yaml"
    file.write_text(SIMULATION.format(count=count, root=ROOT, data=data))
    subprocess.run(
        [program, "simulate", str(file)], check=True, capture_output=True
    )
    return data


def job_of(work: Path, count: int, data: Path, outputs: str) -> str:
    """The path of a job for these data."""
    file = work / f"{count}_{outputs}_{data.suffix[1:]}.yaml"
    file.write_text(JOB.format(count=count, root=ROOT, data=data, outputs=outputs))
    return str(file)


def make_workloads(
    program: str, work: Path, wanted: Callable[[str], bool]
) -> list[Workload]:
    """All whose names are wanted; their data are made by `program`."""
    workloads = []

    def add(name: str, quantity: str, arguments: Callable[[], list[str]]) -> None:
        if wanted(name):
            workloads.append(Workload(name, arguments(), quantity))

    for count in (56, 1000, 10000, 100000, 1000000):
        add(
            f"solve, {count} positions",
            "solve",
            lambda n=count: [
                "calibrate",
                job_of(work, n, simulate(program, work, n), "minimal"),
            ],
        )

    def small_job() -> str:
        return job_of(work, 56, simulate(program, work, 56), "full")

    add("56 positions, with the page", "cpu",
        lambda: ["calibrate", small_job(), "--report"])
    batch = str(ROOT / "configs/batches/rv2aj_1000.yaml")
    add("batch of 1000 jobs", "wall", lambda: ["batch", batch])

    def montecarlo() -> list[str]:
        file = work / "montecarlo.yaml"
        file.write_text(
            f"format: alidade-job-1\nextends: {small_job()}\n"
            f"montecarlo: {{trials: {TRIALS}}}\n"
        )
        return ["montecarlo", str(file)]

    add(f"Monte Carlo, {TRIALS} calibrations", "wall", montecarlo)
    return workloads


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("old")
    parser.add_argument("new")
    parser.add_argument("--runs", type=int, default=5)
    parser.add_argument("--only", default="")
    options = parser.parse_args()
    print("| workload | | old [s] | new [s] | new / old |\n|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as folder:
        work = Path(folder)
        for load in make_workloads(
            options.old, work, lambda name: options.only in name
        ):
            times: dict[str, list[float]] = {"old": [], "new": []}
            for k in range(options.runs + 1):
                for which in times:
                    out = Path(tempfile.mkdtemp(dir=work))
                    one = run(getattr(options, which), load.arguments, out)
                    subprocess.run(["rm", "-r", str(out)], check=True)
                    if k > 0:  # the first warms the caches
                        times[which].append(getattr(one, load.quantity))
            old, new = (statistics.median(times[which]) for which in times)
            ratio = statistics.median(
                b / a for a, b in zip(times["old"], times["new"])
            )
            print(
                f"| {load.name} | {load.quantity} | {old:.4g} | {new:.4g} "
                f"| {ratio:.2f} |",
                flush=True,
            )


if __name__ == "__main__":
    main()
