#!/usr/bin/python3
"""What scipy takes for the solves of bench/solve_comparison.cc.

Reads the problems that `solve_comparison write DIR N` left in DIR and solves
them with scipy.optimize.least_squares (trf), residuals and the geometric
Jacobian vectorised over the poses.  Its steps end where they lower the cost by
less than 1e-12 of itself: with the 1e-15 of the other ways it goes on for
thousands of evaluations among its rounding errors.  Prints the same lines:
arm,N,method,threads,seconds,iterations,cost.

Needs the packages python3-numpy and python3-scipy; OMP_NUM_THREADS=1 keeps it
to one core.
"""

from __future__ import annotations

import statistics
import sys
import time
from pathlib import Path

import numpy as np
from scipy.optimize import least_squares

Array = np.ndarray

SIGMA = 2e-5  # m
KINDS = 5  # beta, alpha, d, theta, r: one of each per joint


def turn(frame: Array, angle: Array, first: int, second: int) -> None:
    """Turns two axes of all frames in their plane, in place."""
    cosine, sine = np.cos(angle), np.sin(angle)
    if np.ndim(angle):
        cosine, sine = cosine[:, None], sine[:, None]
    a, b = frame[:, :, first].copy(), frame[:, :, second]
    frame[:, :, first] = cosine * a + sine * b
    frame[:, :, second] = cosine * b - sine * a


class Problem:
    """An arm of revolute joints and its measured positions."""

    def __init__(self, directory: Path, name: str) -> None:
        def load(what: str) -> Array:
            return np.fromfile(directory / f"{name}_{what}")

        self.nominal = load("nominal")
        self.num_joints = len(self.nominal) // KINDS
        self.columns = load("columns").astype(int)
        self.joints = load("joints").reshape(-1, self.num_joints)
        self.points = load("points").reshape(-1, 3)

    def evaluate(self, free: Array, with_jacobian: bool) -> tuple[Array, Array]:
        """Positions, and their derivatives by the free parameters."""
        values = self.nominal.copy()
        values[self.columns] = free
        beta, alpha, d, theta, r = values.reshape(KINDS, self.num_joints)
        count = len(self.joints)
        frame = np.tile(np.eye(3), (count, 1, 1))
        origin = np.zeros((count, 3))
        axes: list[tuple[Array, Array | None]] = [None] * len(values)
        for j in range(self.num_joints):
            at = [k * self.num_joints + j for k in range(KINDS)]
            before = origin.copy()
            axes[at[0]] = (frame[:, :, 1].copy(), before)
            turn(frame, beta[j], 2, 0)
            axes[at[1]] = (frame[:, :, 0].copy(), before)
            axes[at[2]] = (frame[:, :, 0].copy(), None)
            turn(frame, alpha[j], 1, 2)
            origin = origin + d[j] * frame[:, :, 0]
            axes[at[3]] = (frame[:, :, 2].copy(), origin)
            axes[at[4]] = (frame[:, :, 2].copy(), None)
            turn(frame, theta[j] + self.joints[:, j], 0, 1)
            origin = origin + r[j] * frame[:, :, 2]
        if not with_jacobian:
            return origin, np.empty(0)
        jacobian = np.empty((count, 3, len(free)))
        for k, column in enumerate(self.columns):
            axis, point = axes[column]
            turned = axis if point is None else np.cross(axis, origin - point)
            jacobian[:, :, k] = turned
        return origin, jacobian

    def residuals(self, free: Array) -> Array:
        position, _ = self.evaluate(free, False)
        return ((position - self.points) / SIGMA).ravel()

    def jacobian(self, free: Array) -> Array:
        _, jacobian = self.evaluate(free, True)
        return jacobian.reshape(-1, len(free)) / SIGMA


def run(problem: Problem, name: str) -> None:
    """Times a few solves and prints the median."""
    seconds = []
    while len(seconds) < 3 or (sum(seconds) < 1.0 and len(seconds) < 51):
        start = time.perf_counter()
        result = least_squares(
            problem.residuals,
            problem.nominal[problem.columns],
            problem.jacobian,
            method="trf",
            x_scale="jac",
            ftol=1e-12,
            xtol=None,
            gtol=None,
        )
        seconds.append(time.perf_counter() - start)
    print(
        f"{name},{len(problem.joints)},scipy,1,"
        f"{statistics.median(seconds):.6g},{result.nfev - 1},"
        f"{2.0 * result.cost:.12g}",
        flush=True,
    )


def main() -> int:
    if len(sys.argv) != 2:
        print("usage: scipy_speed.py DIR", file=sys.stderr)
        return 2
    for name in ("wrist", "flange"):
        run(Problem(Path(sys.argv[1]), name), name)
    return 0


if __name__ == "__main__":
    sys.exit(main())
