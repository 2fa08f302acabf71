"""The arm: geometry, forward and inverse kinematics, export."""

from __future__ import annotations

import html
import os
from typing import Any, Mapping

import numpy as np

from . import _core
from ._arrays import (Array, Path, finite, integer, numbers, one_of, path,
                      positive, rows, seed_of, text, threads_of, transforms,
                      vector)
from ._errors import InputError, wrong
from ._options import flow
from ._record import Record, record

_CONVENTIONS = {
    "standard": ("theta", "d", "a", "alpha"),
    "craig": ("alpha", "a", "theta", "d"),
    "khalil": ("beta", "alpha", "d", "theta", "r"),
}


class Arm:
    """An open chain of joints, in metres and radians.

    A target's pose in the instrument's frame is ``base @ T1(q1) @ ... @
    Tn(qn) @ tool``. Arms do not change: methods that begin with ``with_``
    return another one.

    Made by `Arm.load` (arm files, `arm.yaml` of results, kinematics of
    Universal Robots' ROS driver), `Arm.from_dh` and `Arm.from_urdf`.
    """

    __slots__ = ("_core",)

    def __init__(self, core: _core.Arm) -> None:
        if not isinstance(core, _core.Arm):
            raise wrong("Arm", "is made by Arm.load, Arm.from_dh or "
                        "Arm.from_urdf, expected one of these")
        self._core = core

    @classmethod
    def load(cls, file: Path) -> Arm:
        """An arm file (docs/files.md), or one of the arms that come with
        Alidade, by its name: "robots/ur10e" (docs/robots.md)."""
        return cls(_core.Arm.load(path(file, "file")))

    @classmethod
    def parse(cls, yaml: str) -> Arm:
        """The text of an arm file."""
        return cls(_core.Arm.parse(text(yaml, "yaml"), "arm"))

    @classmethod
    def from_dh(cls, *, convention: str = "standard",
                alpha: Any = None, a: Any = None, d: Any = None,
                theta: Any = None, r: Any = None, beta: Any = None,
                prismatic: Any = None, limits: Any = None, base: Any = None,
                tool: Any = None, name: str = "arm") -> Arm:
        """From Denavit-Hartenberg parameters, one number per joint each (rad,
        m); those left out are zero.

        convention
            ``standard``: Rz(theta) Tz(d) Tx(a) Rx(alpha);
            ``craig``: Rx(alpha) Tx(a) Rz(theta) Tz(d), a and alpha of the link
            before the joint in the joint's own row;
            ``khalil``: Ry(beta) Rx(alpha) Tx(d) Rz(theta) Tz(r), the library's
            own.
        prismatic
            one truth value per joint; all turn by default.
        limits
            (n, 2), of the joint values; inf leaves an end open.
        base, tool
            4 x 4 matrices: the arm's base in the instrument's frame, and the
            target in the last joint's.
        """
        one_of(convention, "convention", list(_CONVENTIONS))
        given = {key: value for key, value in dict(
            alpha=alpha, a=a, d=d, theta=theta, r=r, beta=beta).items()
            if value is not None}
        for key in given:
            if key not in _CONVENTIONS[convention]:
                raise wrong(key, f"is no parameter of the {convention} "
                            "convention, expected some of "
                            + ", ".join(_CONVENTIONS[convention]))
        if not given:
            raise wrong("alpha", "no parameters are given, expected some of "
                        + ", ".join(_CONVENTIONS[convention]))
        columns: dict[str, Array] = {}
        for key, value in given.items():
            known = next(iter(columns.values()), None)
            columns[key] = vector(value, key,
                                  None if known is None else len(known),
                                  "one per joint")
        count = len(next(iter(columns.values())))
        slides = [False] * count
        if prismatic is not None:
            values = np.asarray(prismatic)
            if values.shape != (count,) or values.dtype.kind not in "bi":
                raise wrong("prismatic", f"expected {count} truth values, one "
                            "per joint")
            slides = [bool(value) for value in values]
        joints: list[dict[str, Any]] = []
        for j in range(count):
            joint: dict[str, Any] = {
                "type": "prismatic" if slides[j] else "revolute"}
            for key in _CONVENTIONS[convention]:
                joint[key] = float(columns[key][j]) if key in columns else 0.0
            joints.append(joint)
        if limits is not None:
            table = rows(limits, "limits", 2, "lower and upper, a row per "
                         "joint", count, are_finite=False)
            for joint, row in zip(joints, table):
                joint["limits"] = row
        return cls._from_entries(
            {"name": text(name, "name"), "convention": convention,
             "joints": joints}, base, tool)

    @classmethod
    def from_urdf(cls, file: Path, base_link: str, tip_link: str, *,
                  base: Any = None, tool: Any = None,
                  name: str = "arm") -> Arm:
        """The chain from a link of a URDF to another one."""
        entry = {"file": _absolute(path(file, "file")),
                 "base_link": text(base_link, "base_link"),
                 "tip_link": text(tip_link, "tip_link")}
        return cls._from_entries({"name": text(name, "name"), "urdf": entry},
                                 base, tool)

    @classmethod
    def _from_entries(cls, entries: Mapping[str, Any], base: Any,
                      tool: Any) -> Arm:
        whole = {"format": "alidade-arm-1",
                 "units": {"length": "m", "angle": "rad"}, **entries}
        try:
            arm = cls(_core.Arm.parse(flow(whole, "arm"), "arm"))
        except InputError as error:
            if error.file != "arm":
                raise
            raise InputError(error.message, key=error.key) from None
        if base is not None:
            arm = arm.with_base(base)
        if tool is not None:
            arm = arm.with_tool(tool)
        return arm

    @property
    def name(self) -> str:
        return self._core.name

    @property
    def num_joints(self) -> int:
        return self._core.num_joints()

    @property
    def joint_types(self) -> list[str]:
        """"revolute" or "prismatic", from the base."""
        return ["revolute" if turns else "prismatic"
                for turns in self._core.are_revolute()]

    @property
    def geometry(self) -> Record:
        """beta, alpha, d, theta, r: an array each, in Khalil's convention."""
        table = self._core.geometry()
        return Record((name, table[:, k].copy()) for k, name in
                      enumerate(_CONVENTIONS["khalil"]))

    @property
    def limits(self) -> Array:
        """(n, 2), infinite where there are none."""
        return self._core.limits()

    @property
    def reach(self) -> float:
        """An upper bound of the distance from base to target (m)."""
        return self._core.reach()

    @property
    def has_error_terms(self) -> bool:
        """Whether it has errors that are not rigid geometry."""
        return self._core.has_errors()

    @property
    def base(self) -> Array:
        """4 x 4: the arm's base in the instrument's frame."""
        return self._core.base()

    @property
    def tool(self) -> Array:
        """4 x 4: the first target in the last joint's frame."""
        return np.asarray(self._core.target_frames()[0])

    @property
    def targets(self) -> dict[str, Array]:
        """4 x 4 by name; the name of an only target may be empty."""
        return dict(zip(self._core.target_names(),
                        self._core.target_frames()))

    @property
    def parameters(self) -> dict[str, float]:
        """Values by name: "d3", "base_x" ... (m, rad); rotations of base and
        tool are rotation vectors relative to where they are, so zero."""
        return {name: value for name, _, value in self._core.parameters()}

    @property
    def parameter_units(self) -> dict[str, str]:
        return {name: unit for name, unit, _ in self._core.parameters()}

    def with_parameters(self, changes: Mapping[str, float]) -> Arm:
        """With other values (m, rad) of some parameters."""
        values = self.parameters
        if not isinstance(changes, Mapping):
            raise wrong("changes", "expected a dict from names of parameters "
                        "to values")
        for key, value in changes.items():
            if key not in values:
                raise wrong("changes", f"no parameter {key!r}, expected some "
                            f"of {', '.join(values)}")
            number = numbers(value, f"changes[{key!r}]", "a number")
            if number.ndim:
                raise wrong(f"changes[{key!r}]", "expected one number")
            values[key] = float(finite(number, f"changes[{key!r}]"))
        return Arm(self._core.with_values(np.array(list(values.values()))))

    def with_deviations(self, deviations: Path | Mapping[str, float]) -> Arm:
        """With deviations added: a dict by parameter (m, rad) or a file of the
        format alidade-deviations-1."""
        if isinstance(deviations, Mapping):
            values = self.parameters
            return self.with_parameters(
                {key: values.get(key, 0.0) + value
                 for key, value in deviations.items()})
        return Arm(self._core.with_deviations(path(deviations, "deviations")))

    def with_base(self, base: Any) -> Arm:
        return Arm(self._core.with_frames(transforms(base, "base")[0],
                                          self._core.target_frames()))

    def with_tool(self, tool: Any, target: int = 0) -> Arm:
        frames = self._core.target_frames()
        frames[self._target(target)] = transforms(tool, "tool")[0]
        return Arm(self._core.with_frames(self._core.base(), frames))

    def fk(self, joint_values: Any, *, target: int = 0,
           threads: int = 1) -> Array:
        """Poses of a target in the instrument's frame: (N, 4, 4) of joint
        values (N, n) in rad and m, (4, 4) of n values."""
        joints, is_one = self._joints(joint_values)
        poses = self._core.transforms(joints, self._target(target),
                                      threads_of(threads))
        return np.asarray(poses[0]) if is_one else poses

    def positions(self, joint_values: Any, *, target: int = 0,
                  threads: int = 1) -> Array:
        """The same, positions alone: (N, 3) or (3,), in m."""
        joints, is_one = self._joints(joint_values)
        points = self._core.positions(joints, self._target(target),
                                      threads_of(threads))
        return np.asarray(points[0]) if is_one else points

    def jacobian(self, joint_values: Any, *, target: int = 0,
                 threads: int = 1) -> Array:
        """Geometric Jacobians (N, 6, n) or (6, n): rows 0 to 2 what joints move
        the target by (m), 3 to 5 what they turn it by (rad), in the
        instrument's axes."""
        return self._jacobian(joint_values, False, target, threads)

    def parameter_jacobian(self, joint_values: Any, *, target: int = 0,
                           threads: int = 1) -> Array:
        """The same by all `parameters`: identification Jacobians (N, 6, p)."""
        return self._jacobian(joint_values, True, target, threads)

    def _jacobian(self, joint_values: Any, of_parameters: bool, target: int,
                  threads: int) -> Array:
        joints, is_one = self._joints(joint_values)
        columns = self._core.jacobians(joints, of_parameters,
                                       self._target(target),
                                       threads_of(threads))
        jacobians = columns.transpose(0, 2, 1)
        return np.asarray(jacobians[0]) if is_one else jacobians

    def ik(self, poses: Any, start: Any = None, *, task: str = "auto",
           target: int = 0, trials: int = 200, seed: int = 1,
           max_joint_change: float = 0.5, threads: int = 1) -> Record:
        """Joint values that bring a target to poses (N, 4, 4).

        start
            (N, n): each pose is solved from its own start, in the posture that
            that has, and no joint moves by more than `max_joint_change` (rad).
            (n,) or None (the middle of the limits): each pose is solved from
            the answer before it, and where that fails from up to `trials`
            postures drawn from `seed`.
        task
            ``auto``, ``pose``, ``axis`` (position, then the direction of the
            target's z axis) or ``position``.

        Returns joint_values (N, n), status ("reached", "out of reach", "joint
        limit", "branch change"), position_error (m), rotation_error (rad),
        iterations.
        """
        targets = transforms(poses, "poses")
        starts = None
        if start is not None:
            starts = rows(start, "start", self.num_joints,
                          "joint values (rad, m)")
            if len(starts) not in (1, len(targets)):
                raise wrong("start", f"found {len(starts)} rows, expected 1 or "
                            f"{len(targets)}, one per pose")
        options = dict(
            task=one_of(task, "task", ["auto", "pose", "axis", "position"]),
            target=self._target(target), trials=integer(trials, "trials", 0),
            seed=seed_of(seed), threads=threads_of(threads),
            max_joint_change=positive(max_joint_change, "max_joint_change",
                                      "an angle (rad)"))
        return record(self._core.inverse_kinematics(targets, starts, options))

    def draw(self, count: int, *, seed: int = 1) -> Array:
        """`count` configurations (count, n) drawn uniformly within limits."""
        return self._core.draw(integer(count, "count", 1), seed_of(seed))

    @property
    def has_motor_map(self) -> bool:
        """Whether joint values are other than the controller's: an arm file
        states `sign`, `offset` or `motors`. Joint values are those of the chain
        everywhere in this package; files have the controller's."""
        return self._core.has_motor_map()

    def joints_from_motors(self, motors: Any) -> Array:
        """Joint values (N, n) of the controller's (N, m); or (n,) of (m,)."""
        values = rows(motors, "motors", self._core.num_motors(),
                      "the controller's values (rad, m) of each pose")
        found = self._core.joints_from_motors(values)
        return np.asarray(found[0]) if np.ndim(motors) == 1 else found

    def motors_from_joints(self, joint_values: Any) -> Array:
        """The inverse."""
        joints, is_one = self._joints(joint_values)
        if self._core.num_motors() != self.num_joints:
            raise wrong("joint_values", "the arm has fewer motors than joints, "
                        "expected one that has as many")
        found = self._core.motors_from_joints(joints)
        return np.asarray(found[0]) if is_one else found

    def export(self, format: str, *, table: str = "csv",
               nominal: Arm | None = None,
               nominal_file: Path = "") -> Record:
        """The arm in another format: "dh", "mdh", "offsets", "ur", "urdf" or
        "json" (docs/robot.md), with base and tool of `nominal`. `nominal_file`:
        the arm file that names the URDF, for "urdf".

        Returns text, lost (what the format cannot say, a sentence each), and
        mean, p95, max: what that moves the target by over the workspace (m).
        """
        file = path(nominal_file, "nominal_file") if nominal_file else ""
        if nominal is None:
            nominal = Arm.load(file) if file else self
        if not isinstance(nominal, Arm):
            raise wrong("nominal", "expected an Arm")
        return record(_core.export_arm(nominal._core, self._core,
                                       text(format, "format"),
                                       text(table, "table"), file))

    def to_yaml(self) -> str:
        """The text of an arm file that `parse` reads back."""
        return self._core.format()

    def save(self, file: Path) -> None:
        """As an arm file."""
        with open(path(file, "file"), "w", encoding="utf-8") as stream:
            stream.write(self.to_yaml())

    def to_pandas(self) -> Any:
        """A row per joint: type, geometry, limits."""
        import pandas

        frame = pandas.DataFrame(dict(self.geometry))
        frame.insert(0, "type", self.joint_types)
        frame["lower"], frame["upper"] = self.limits.T
        frame.index = pandas.RangeIndex(1, self.num_joints + 1, name="joint")
        return frame

    def _joints(self, joint_values: Any) -> tuple[Array, bool]:
        joints = rows(joint_values, "joint_values", self.num_joints,
                      "joint values (rad, m) of each pose")
        return joints, np.ndim(joint_values) == 1

    def _target(self, target: int) -> int:
        return integer(target, "target", 0,
                       len(self._core.target_names()) - 1)

    def __reduce__(self) -> Any:
        return _restore_arm, (self.to_yaml(), self._core.base(),
                              self._core.target_frames())

    def __eq__(self, other: Any) -> bool:
        return isinstance(other, Arm) and (
            self.to_yaml() == other.to_yaml()
            and np.array_equal(self._core.base(), other._core.base())
            and np.array_equal(self._core.target_frames(),
                               other._core.target_frames()))

    def __hash__(self) -> int:
        return hash(self.to_yaml())

    def __repr__(self) -> str:
        return f"Arm({self.name!r}, {self.num_joints} joints)"

    def _repr_html_(self) -> str:
        table = self.to_pandas()._repr_html_()
        return f"<b>{html.escape(self.name)}</b>{table}"


def _absolute(name: str) -> str:
    return os.path.abspath(name)


def _restore_arm(yaml: str, base: Array, targets: Array) -> Arm:
    return Arm(_core.Arm.parse(yaml, "arm").with_frames(base, targets))


def arm_of(value: Any, argument: str = "arm") -> Arm:
    """An Arm, or the file of one."""
    if isinstance(value, Arm):
        return value
    if isinstance(value, str) or hasattr(value, "__fspath__"):
        return Arm.load(value)
    raise wrong(argument, f"found {type(value).__name__}, expected an Arm or "
                "the path of an arm file")

