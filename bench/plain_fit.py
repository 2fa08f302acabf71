#!/usr/bin/python3
"""The plain least-squares fit that Alidade is compared against.

The geometry of an arm is fitted to the training rows of every set and split;
the errors of all points at the validation rows are written, one CSV line each.
Parameters: base frame (6), target (3 per reflector, 6 for a pose), a, alpha,
d and theta offset of every joint, and one more rotation beta between
consecutive joint axes that are nearly parallel.  Balls in sockets and cable
lengths have no base frame but the positions of the sockets or of the anchor.
"before" is the nominal arm with everything but its geometry fitted.  There is
no robust loss and no removal of outliers or of weak parameters.

Residuals are in metres over 0.1 mm; a rotation of 1 rad counts as 0.2 m.
The standard deviations of single rows of the UR10 (0.01 mm) tell how well the
instrument repeats, not how well the model fits, and are not used.  Sockets of
one plate are 50 mm apart to 0.02 mm.  A prior of 0.1 rad and 0.1 m on the
geometry keeps redundant parameters where they are.

The data are not part of the project: the environment variable ALIDADE_DATA
names their folder.  Needs the packages python3-numpy and python3-scipy;
fastest with OMP_NUM_THREADS=1.
"""

from __future__ import annotations

import argparse
import csv
import itertools
import json
import os
import re
import sys
import time
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Iterator, NamedTuple

import numpy as np
from scipy.optimize import least_squares
from scipy.spatial.transform import Rotation

Array = np.ndarray
Table = list[dict[str, str]]

SEEDS = range(1, 11)
SIGMA = 1e-4  # m, of every measured coordinate or length
ROTATION_ARM = 0.2  # m, weight of 1 rad beside positions
PRIOR = 0.1  # rad or m, on the deviation of a geometric parameter
SOCKET_DISTANCE = 0.05  # m, between the two sockets of a plate
SOCKET_SIGMA = 2e-5  # m, of that distance
NEARLY_PARALLEL = np.radians(5.0)
RANK_TOLERANCE = 1e-9
SOLVER = {"method": "lm", "ftol": 1e-10, "xtol": 1e-10, "gtol": 1e-10}
ANCHOR_GRID = (-0.8, 0.0, 0.8)  # m, per axis: starts for the anchor
UNITS = {"deg": np.pi / 180.0, "rad": 1.0, "m": 1.0, "mm": 1e-3}
JOINT_COLUMN = re.compile(r"q\d+(_cmd|_prismatic)?_(deg|rad|m)")
HEADER = (
    "set,seed,n_train,n_validation,before_mean_mm,before_median_mm,"
    "after_mean_mm,after_rms_mm,after_median_mm,after_max_mm,"
    "after_rotation_mean_deg,rank,seconds"
).split(",")


class Source(NamedTuple):
    """Where a set is and what was measured."""

    path: str
    kind: str  # "position", "pose", "socket" or "distance"
    points: tuple[str, ...] = ("",)  # prefixes of the position columns
    euler: str = ""  # sequence of the Euler angles, as scipy names it


IRB120 = "irb120_faro_ets/data.csv"
MUKCA = "ball_socket_mukca/panda"
WIRE = "irb120_drawwire_robotcali/robotcali_120.csv"
ROKAE = "rokae_lasertracker_dongjy/data.csv"
SOURCES = {
    "ur10_A": Source("ur10_tmac_ipa/series_A.csv", "pose", euler="XYZ"),
    "ur10_B": Source("ur10_tmac_ipa/series_B.csv", "pose", euler="XYZ"),
    "irb120": Source(IRB120, "position", ("smr1_", "smr2_", "smr3_")),
    "irb120_smr1": Source(IRB120, "position", ("smr1_",)),
    "panda_left": Source("panda_keti/panda_left.csv", "position"),
    "panda_right": Source("panda_keti/panda_right.csv", "position"),
    "panda_top": Source("panda_keti/panda_top.csv", "position"),
    "rokae": Source(ROKAE, "pose", euler="xyz"),
    "rokae_position": Source(ROKAE, "position"),
    "column": Source("jaibot_p6r_hilti/flat.csv", "position"),
    "socket_panda_1": Source(f"{MUKCA}_1.csv", "socket"),
    "socket_panda_2": Source(f"{MUKCA}_2.csv", "socket"),
    "socket_panda_6": Source(f"{MUKCA}_6.csv", "socket"),
    "drawwire": Source(WIRE, "distance"),
}


@dataclass
class Data:
    """Rows of measurements in metres and radians; unmeasured parts empty."""

    joints: Array  # (n, joints)
    points: Array  # (n, points, 3)
    rotations: Array  # (n, 3, 3)
    lengths: Array  # (n,)
    sockets: Array  # (n,), numbers of the sockets

    def rows(self, index: Array) -> Data:
        """The rows of the index (or mask)."""
        return Data(*(v[index] if len(v) else v for v in vars(self).values()))


def columns(table: Table, names: list[str]) -> Array:
    """The named columns; units are told by the ends of the names."""
    scale = np.array([UNITS[name.rsplit("_", 1)[1]] for name in names])
    return np.array([[float(row[n]) for n in names] for row in table]) * scale


def load_data(root: Path, source: Source) -> Data:
    """Reads the measurements of a set."""
    with open(root / source.path, newline="", encoding="utf-8") as file:
        table = list(csv.DictReader(file))
    names = list(filter(JOINT_COLUMN.fullmatch, table[0]))
    empty = np.empty(0)
    data = Data(columns(table, names), empty, empty, empty, empty)
    if source.kind == "distance":
        data.lengths = columns(table, ["cable_length_mm"])[:, 0]
    elif source.kind == "socket":
        names = [row["tool_position"] for row in table]
        plates = np.unique(names, return_inverse=True)[1]
        data.sockets = 2 * plates + [int(row["socket"]) for row in table]
    else:
        wanted = [re.compile(f"{p}[xyz]_mm?") for p in source.points]
        triples = [list(filter(w.fullmatch, table[0])) for w in wanted]
        points = [columns(table, triple) for triple in triples]
        data.points = np.stack(points, axis=1)
    if source.kind == "pose":
        angles = columns(table, ["rx_deg", "ry_deg", "rz_deg"])
        data.rotations = Rotation.from_euler(source.euler, angles).as_matrix()
    return data


class Step(NamedTuple):
    """A rotation about or a translation along one of the moving axes."""

    turns: bool
    axis: int
    value: float = 0.0
    joint: int = -1
    sign: float = 1.0


Steps = list[Step]
FRAME = [Step(turns, axis) for turns in (False, True) for axis in range(3)]


def joint_steps(row: dict, number: int, modified: bool, beta: bool) -> Steps:
    """The transform of one joint from its row of the nominal table."""
    turns = row["type"] == "R"
    moved = {"joint": number, "sign": row["sign"]}
    offset = np.radians(row["theta_offset_deg"])
    theta = Step(True, 2, offset, **(moved if turns else {}))
    d = Step(False, 2, row["d_mm"] * 1e-3, **({} if turns else moved))
    a = Step(False, 0, row["a_mm"] * 1e-3)
    alpha = Step(True, 0, np.radians(row["alpha_deg"]))
    bend = [Step(True, 1)] if beta else []
    if modified:
        return [alpha, a, *bend, theta, d]
    return [theta, d, a, alpha, *bend]


def arm_steps(root: Path, source: Source) -> Steps:
    """The nominal arm, from model.json beside the data."""
    path = (root / source.path).with_name("model.json")
    model = json.loads(path.read_text("utf-8"))
    model = model.get("panda_*", model)
    modified = model["convention"].startswith("modified")
    table = model["rows"]
    # The twist before the first or after the last joint is not between two.
    outer = 0 if modified else len(table) - 1
    steps = []
    for number, row in enumerate(table):
        twist = abs(np.sin(np.radians(row["alpha_deg"])))
        beta = number != outer and twist < np.sin(NEARLY_PARALLEL)
        steps += joint_steps(row, number, modified, beta)
    return steps


class Walk(NamedTuple):
    """The end of the chain, and the axis of every step, at every row."""

    rotation: Array  # (n, 3, 3)
    position: Array  # (n, 3)
    axes: Array  # (steps, n, 3)
    origins: Array  # (steps, n, 3)


def turned(rotation: Array, axis: int, angle: Array) -> Array:
    """Rotations (n, 3, 3), turned about one of their own axes."""
    i, j = (axis + 1) % 3, (axis + 2) % 3
    cosine, sine = np.cos(angle)[:, None], np.sin(angle)[:, None]
    result = rotation.copy()
    result[:, :, i] = rotation[:, :, i] * cosine + rotation[:, :, j] * sine
    result[:, :, j] = rotation[:, :, j] * cosine - rotation[:, :, i] * sine
    return result


def walk(steps: Steps, change: Array, joints: Array) -> Walk:
    """Forward kinematics with a change of the nominal value of every step."""
    count = len(joints)
    rotation = np.tile(np.eye(3), (count, 1, 1))
    position = np.zeros((count, 3))
    axes = np.empty((len(steps), count, 3))
    origins = np.empty((len(steps), count, 3))
    for k, step in enumerate(steps):
        value = np.full(count, step.value + change[k])
        if step.joint >= 0:
            value += step.sign * joints[:, step.joint]
        axes[k] = rotation[:, :, step.axis]
        origins[k] = position
        if step.turns:
            rotation = turned(rotation, step.axis, value)
        else:
            position = position + axes[k] * value[:, None]
    return Walk(rotation, position, axes, origins)


def nearest_rotation(matrix: Array) -> Array:
    """The rotation nearest to a 3 x 3 matrix."""
    u, _, v = np.linalg.svd(matrix)
    return u @ np.diag([1.0, 1.0, np.linalg.det(u @ v)]) @ v


def base_start(arm: Steps, data: Data) -> tuple[Array, Array, Array]:
    """Inverse base frame X, c and points t on the tool at nominal geometry.

    X m - c = p + R t is linear in all three.  X is made a rotation, and c and
    t follow once more.
    """
    end = walk(arm, np.zeros(len(arm)), data.joints)
    points = data.points.shape[1]
    measured = data.points.reshape(-1, 3)
    turn = np.kron(np.eye(3), measured[:, None]).reshape(-1, 9)
    shift = np.tile(-np.eye(3), (len(measured), 1))
    tool = np.kron(np.eye(points), -end.rotation[:, None])
    rest = np.hstack([shift, tool.reshape(-1, 3 * points)])
    goal = np.repeat(end.position, points, axis=0).ravel()
    first = np.linalg.lstsq(np.hstack([turn, rest]), goal, rcond=None)[0]
    inverse = nearest_rotation(first[:9].reshape(3, 3))
    goal = goal - (measured @ inverse.T).ravel()
    second = np.linalg.lstsq(rest, goal, rcond=None)[0]
    return inverse, second[:3], second[3:]


def aligned(arm: Steps, data: Data, train: Array) -> tuple[Data, Array]:
    """Data in frames near base and tool, by the training rows; points."""
    part = data.rows(train)
    inverse, shift, points = base_start(arm, part)
    moved = replace(data, points=data.points @ inverse.T - shift)
    if len(data.rotations):
        end = walk(arm, np.zeros(len(arm)), part.joints)
        measured = inverse @ part.rotations
        mean = np.einsum("nji,njk->ik", end.rotation, measured)
        tool = nearest_rotation(mean)
        moved.rotations = inverse @ data.rotations @ tool.T
    return moved, points


def socket_start(arm: Steps, data: Data, count: int) -> Array:
    """The ball on the tool and the sockets at the nominal geometry."""
    end = walk(arm, np.zeros(len(arm)), data.joints)
    member = np.eye(count)[data.sockets]
    if not member.any(axis=0).all():
        raise ValueError("a socket has no training rows")
    places = np.kron(member, -np.eye(3))
    matrix = np.hstack([end.rotation.reshape(-1, 3), places])
    return np.linalg.lstsq(matrix, -end.position.ravel(), rcond=None)[0]


class Model:
    """Residuals of a set as a function of all parameters.

    The parameters are the changes of the steps (base, arm, orientation of the
    tool), the points on the tool, and the sockets or the anchor.
    """

    def __init__(self, source: Source, arm: Steps, data: Data) -> None:
        base = FRAME if source.kind in ("position", "pose") else []
        tool = FRAME[3:] if source.kind == "pose" else []
        self.kind = source.kind
        self.steps = base + arm + tool
        self.turns = np.array([step.turns for step in self.steps])
        self.geometry = np.arange(len(base), len(base) + len(arm))
        places = {"socket": data.sockets.max(initial=-1) + 1, "distance": 1}
        first = len(self.steps)
        last = first + 3 * len(source.points)
        self.points = np.arange(first, last)
        self.places = last + np.arange(3 * places.get(source.kind, 0))
        self.plates = self.places[: None if source.kind == "socket" else 0]
        self.size = last + len(self.places)
        self.frames = np.setdiff1d(np.arange(self.size), self.geometry)

    def tips(self, x: Array, data: Data) -> tuple[Walk, Array]:
        """The chain and the points on the tool (n, points, 3)."""
        end = walk(self.steps, x, data.joints)
        points = x[self.points].reshape(-1, 3)
        offsets = np.einsum("nij,kj->nki", end.rotation, points)
        return end, end.position[:, None] + offsets

    def targets(self, x: Array, data: Data) -> Array:
        """Where the points should be (n, points, 3)."""
        places = x[self.places].reshape(-1, 1, 3)
        if self.kind == "distance":
            return places
        return places[data.sockets] if self.kind == "socket" else data.points

    def gaps(self, x: Array, data: Data) -> tuple[Array, Array]:
        """Errors of position (n, points, 3 or 1) in m and rotation in rad."""
        end, tips = self.tips(x, data)
        gap = tips - self.targets(x, data)
        if self.kind == "distance":
            length = np.linalg.norm(gap, axis=2, keepdims=True)
            gap = length - data.lengths[:, None, None]
        if self.kind != "pose":
            return gap, np.empty(0)
        error = end.rotation @ np.swapaxes(data.rotations, 1, 2)
        return gap, Rotation.from_matrix(error).as_rotvec()

    def pairs(self, x: Array) -> Array:
        """Vectors between the two sockets of every plate."""
        plates = x[self.plates].reshape(-1, 2, 3)
        return plates[:, 0] - plates[:, 1]

    def residuals(self, x: Array, data: Data) -> Array:
        """All residuals, without units; the prior is last."""
        gap, rotation = self.gaps(x, data)
        distance = np.linalg.norm(self.pairs(x), axis=1) - SOCKET_DISTANCE
        rotation = rotation.ravel() * (ROTATION_ARM / SIGMA)
        known = [distance / SOCKET_SIGMA, x[self.geometry] / PRIOR]
        return np.concatenate([gap.ravel() / SIGMA, rotation, *known])

    def tip_jacobian(self, end: Walk, tips: Array) -> Array:
        """Derivatives of the points on the tool (n, points, 3, size)."""
        count, points = tips.shape[:2]
        jacobian = np.zeros((count, points, 3, self.size))
        for k, turns in enumerate(self.turns):
            axis = end.axes[k][:, None]
            lever = tips - end.origins[k][:, None]
            jacobian[:, :, :, k] = np.cross(axis, lever) if turns else axis
        for k, first in enumerate(self.points[::3]):
            jacobian[:, k, :, first : first + 3] = end.rotation
        return jacobian

    def gap_jacobian(self, x: Array, data: Data) -> Array:
        """Derivatives of all gaps, one row each, with their weights."""
        end, tips = self.tips(x, data)
        jacobian = self.tip_jacobian(end, tips)
        for k, number in enumerate(self.places[::3]):
            rows = data.sockets == k if self.kind == "socket" else slice(None)
            jacobian[rows, 0, :, number : number + 3] = -np.eye(3)
        if self.kind == "distance":
            gap = tips - self.targets(x, data)
            unit = gap / np.linalg.norm(gap, axis=2, keepdims=True)
            jacobian = np.einsum("nki,nkij->nkj", unit, jacobian)
        jacobian = jacobian.reshape(-1, self.size) / SIGMA
        if self.kind != "pose":
            return jacobian
        # To first order a rotation vector changes as the rotation turns.
        rotation = np.zeros((len(data.joints), 3, self.size))
        moved = np.flatnonzero(self.turns)
        rotation[:, :, moved] = np.moveaxis(end.axes[moved], 0, 2)
        rotation = rotation.reshape(-1, self.size) * (ROTATION_ARM / SIGMA)
        return np.concatenate([jacobian, rotation])

    def jacobian(self, x: Array, data: Data) -> Array:
        """Derivatives of all residuals."""
        pairs = self.pairs(x)
        socket = np.zeros((len(pairs), self.size))
        for k, pair in enumerate(pairs):
            unit = pair / np.linalg.norm(pair) / SOCKET_SIGMA
            socket[k, self.plates[6 * k : 6 * k + 6]] = np.append(unit, -unit)
        prior = np.eye(self.size)[self.geometry] / PRIOR
        return np.concatenate([self.gap_jacobian(x, data), socket, prior])

    def rank(self, x: Array, data: Data) -> int:
        """Number of parameters that the measurements alone can tell.

        Two rotations of arm and sockets as a whole are counted as well: the
        components of residuals that are not zero change with them.
        """
        jacobian = self.jacobian(x, data)[: -len(self.geometry)]
        norms = np.linalg.norm(jacobian, axis=0)
        norms[norms == 0.0] = 1.0
        values = np.linalg.svd(jacobian / norms, compute_uv=False)
        return int(np.sum(values > RANK_TOLERANCE * values[0]))

    def fit(self, x: Array, free: Array, data: Data) -> tuple[Array, float]:
        """The parameters with those of `free` fitted, and the cost."""

        def whole(part: Array) -> Array:
            return x + (part - x[free]) @ np.eye(self.size)[free]

        result = least_squares(
            lambda part: self.residuals(whole(part), data),
            x[free],
            lambda part: self.jacobian(whole(part), data)[:, free],
            **SOLVER,
        )
        return whole(result.x), result.cost


def starts(
    model: Model, arm: Steps, data: Data, train: Array
) -> tuple[Data, list[Array]]:
    """The data in the frame used for fitting, and where to start from."""
    if model.kind == "distance":
        anchors = itertools.product(ANCHOR_GRID, repeat=3)
        rest = [np.append(np.zeros(3), anchor) for anchor in anchors]
    elif model.kind == "socket":
        rest = [socket_start(arm, data.rows(train), len(model.places) // 3)]
    else:
        data, points = aligned(arm, data, train)
        rest = [points]
    return data, [np.append(np.zeros(len(model.steps)), r) for r in rest]


def errors(model: Model, x: Array, data: Data) -> tuple[Array, Array]:
    """Errors of position in mm, and of rotation in degrees."""
    gap, rotation = model.gaps(x, data)
    angles = np.linalg.norm(rotation.reshape(-1, 3), axis=1)
    return np.linalg.norm(gap, axis=2).ravel() * 1e3, np.degrees(angles)


def run_split(
    source: Source, arm: Steps, data: Data, validation: Array
) -> list[str]:
    """Fits one split; the columns of HEADER after set and seed."""
    begin = time.perf_counter()
    train = np.setdiff1d(np.arange(len(data.joints)), validation)
    model = Model(source, arm, data)
    data, guesses = starts(model, arm, data, train)
    known, unseen = data.rows(train), data.rows(validation)
    fits = [model.fit(x, model.frames, known) for x in guesses]
    nominal, _ = min(fits, key=lambda fit: fit[1])
    fitted, _ = model.fit(nominal, np.arange(model.size), known)
    seconds = time.perf_counter() - begin
    before, _ = errors(model, nominal, unseen)
    after, turns = errors(model, fitted, unseen)
    values = [before.mean(), np.median(before), after.mean()]
    values += [np.sqrt(np.mean(after**2)), np.median(after), after.max()]
    texts = [f"{value:.5f}" for value in values]
    texts.append(f"{turns.mean():.5f}" if len(turns) else "")
    texts += [str(model.rank(fitted, known)), f"{seconds:.2f}"]
    return [str(len(train)), str(len(validation)), *texts]


def arguments() -> argparse.Namespace:
    """The command line."""
    style = argparse.RawDescriptionHelpFormatter
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=style)
    splits = "folder of SET_SEED.txt: validation rows of the data, from 0"
    parser.add_argument("--splits", type=Path, required=True, help=splits)
    parser.add_argument("--out", type=Path, required=True, help="CSV file")
    sets = "names with commas between (default: %(default)s)"
    parser.add_argument("--sets", default=",".join(SOURCES), help=sets)
    options = parser.parse_args()
    options.sets = options.sets.split(",")
    unknown = set(options.sets) - set(SOURCES)
    if unknown:
        parser.error("no such set: " + ", ".join(sorted(unknown)))
    return options


def run_set(root: Path, splits: Path, name: str) -> Iterator[list[str]]:
    """The line of every split of a set that is there."""
    source = SOURCES[name]
    arm, data = arm_steps(root, source), load_data(root, source)
    for seed in SEEDS:
        split = splits / f"{name}_{seed}.txt"
        if not split.exists():
            print(f"{split} is not there: skipped", file=sys.stderr)
            continue
        validation = np.loadtxt(split, dtype=int, ndmin=1)
        yield [name, str(seed), *run_split(source, arm, data, validation)]


def main() -> None:
    """Runs every split of the sets asked for."""
    options = arguments()
    if "ALIDADE_DATA" not in os.environ:
        sys.exit("plain_fit: set ALIDADE_DATA to the folder of the data")
    root = Path(os.environ["ALIDADE_DATA"])
    with open(options.out, "w", buffering=1, encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(HEADER)
        for name in options.sets:
            for line in run_set(root, options.splits, name):
                writer.writerow(line)
                print(*line, flush=True)


if __name__ == "__main__":
    main()
