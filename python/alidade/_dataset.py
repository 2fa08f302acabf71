"""What was measured."""

from __future__ import annotations

import os
import tempfile
from typing import Any

import numpy as np

from . import _core
from ._arm import Arm, arm_of
from ._arrays import (Array, Path, check_rotations, finite, integer, numbers,
                      path, positive, rotation_vectors, rows, text, threads_of,
                      transforms, vector)
from ._errors import InputError, wrong

# A first guess of a sigma that is to be estimated (m), as in jobs; and what
# goes with it of orientations: that of points 0.2 m apart.
_FIRST_SIGMA = 1e-4
_LEVER = 0.2


class Dataset:
    """Measurements of an arm at known joint values, in metres and radians.

        data = Dataset(joint_values, positions, sigma=2e-5)

    joint_values
        (N, n), rad or m: a row per pose.
    positions
        (N, 3): where the target was, in the instrument's frame.
    rotations
        beside positions, where orientations were measured: matrices (N, 3, 3)
        or rotation vectors (N, 3).
    poses
        instead of both: homogeneous matrices (N, 4, 4).
    sigma
        standard deviation of each coordinate (m): one number, (3,) or (N, 3);
        inf where a coordinate was not measured. None: not known; calibrations
        then estimate it from the residuals.
    sigma_rotation
        of each component of the orientation (rad), likewise; by default
        sigma / 0.2 m.

    Methods that begin with ``with_`` return another data set that has further
    measurements: of other poses or targets, distances, contacts, differences.
    Arrays of doubles are not copied where rows are contiguous: do not change
    them afterwards.
    """

    __slots__ = ("_core",)

    def __init__(self, joint_values: Any, positions: Any = None, *,
                 rotations: Any = None, poses: Any = None, sigma: Any = None,
                 sigma_rotation: Any = None, target: int = 0,
                 name: str = "arrays") -> None:
        joints = numbers(joint_values, "joint_values",
                         "an array of shape (N, n), joint values (rad, m)")
        if joints.ndim != 2 or joints.shape[1] == 0:
            raise wrong("joint_values", f"found shape {joints.shape}, expected "
                        "(N, n), a row per pose")
        joints = rows(joints, "joint_values", joints.shape[1],
                      "joint values (rad, m)")
        if len(joints) == 0:
            raise wrong("joint_values", "is empty, expected some poses")
        self._core = _core.Measurements(joints)
        self._core.name = text(name, "name")
        self._core.sigmas_are_stated = False
        if positions is None and poses is None:
            for argument, value in (("rotations", rotations), ("sigma", sigma)):
                if value is not None:
                    raise wrong(argument, "goes with positions, expected these "
                                "too")
            return
        if positions is not None and poses is not None:
            raise wrong("poses", "found beside positions, expected one of both")
        added = (self.with_positions(positions, sigma, rotations=rotations,
                                     sigma_rotation=sigma_rotation,
                                     target=target)
                 if poses is None else
                 self.with_poses(poses, sigma, sigma_rotation,
                                 target=target))
        self._core = added._core

    @classmethod
    def load(cls, file: Path, arm: Any, *, sigma: float | None = None,
             threads: int = 1) -> Dataset:
        """A data set's file, CSV or NPY (docs/files.md, "Data set"). `sigma`
        (m) is that of lengths without one; None: these are estimated."""
        guess = (_FIRST_SIGMA if sigma is None
                 else positive(sigma, "sigma", "a length (m)"))
        core = _core.Measurements.load(path(file, "file"),
                                       arm_of(arm)._core, guess,
                                       threads_of(threads))
        if sigma is None:
            core.sigmas_are_stated = not all(
                _is_guess(block["sigmas"]) for block in core.blocks())
        return cls._of(core)

    @classmethod
    def from_pandas(cls, frame: Any, arm: Any, *, sigma: float | None = None,
                    threads: int = 1) -> Dataset:
        """A frame whose columns are named as those of data set files, with
        their units: q1_deg ... or q1_rad ..., x_mm, y_mm, z_mm or x_m ...,
        target, point, plane (docs/files.md, "Data set")."""
        if not hasattr(frame, "to_csv"):
            raise wrong("frame", f"found {type(frame).__name__}, expected a "
                        "pandas DataFrame")
        with tempfile.TemporaryDirectory() as folder:
            file = os.path.join(folder, "frame.csv")
            frame.to_csv(file, index=False)
            try:
                data = cls.load(file, arm, sigma=sigma, threads=threads)
            except InputError as error:
                # The header is line 1, the first row line 2.
                row = f"row {error.line - 2}: " if error.line > 1 else ""
                key = f"frame[{error.key!r}]" if error.key else "frame"
                raise InputError(row + error.message, key=key) from None
        data._core.name = "frame"
        return data

    @classmethod
    def _of(cls, core: _core.Measurements) -> Dataset:
        data = cls.__new__(cls)
        data._core = core
        return data

    def with_positions(self, positions: Any, sigma: Any = None, *,
                       rotations: Any = None, sigma_rotation: Any = None,
                       pose: Any = None, target: int = 0) -> Dataset:
        """Positions (M, 3) of a target at poses number `pose` (M,), by default
        one at each, with orientations beside them where these were measured."""
        points = rows(positions, "positions", 3, "x, y, z in m")
        at = self._poses(pose, len(points), "positions")
        if rotations is None:
            if sigma_rotation is not None:
                raise wrong("sigma_rotation", "goes with rotations, expected "
                            "these too")
            return self._with("position", points,
                              self._sigmas(sigma, "sigma", len(points), 3),
                              sigma is not None, at, target)
        turns = _rotation_vectors(rotations, len(points))
        sigmas = self._sigmas(sigma, "sigma", len(points), 3)
        turned = (sigmas / _LEVER if sigma_rotation is None else
                  self._sigmas(sigma_rotation, "sigma_rotation", len(points),
                               3))
        if len(sigmas) != len(turned):
            sigmas, turned = np.broadcast_arrays(sigmas, turned)
        return self._with("pose", np.hstack([points, turns]),
                          np.hstack([sigmas, turned]), sigma is not None, at,
                          target)

    def with_poses(self, poses: Any, sigma: Any = None,
                   sigma_rotation: Any = None, *, pose: Any = None,
                   target: int = 0) -> Dataset:
        """The same of homogeneous matrices (M, 4, 4)."""
        matrices = transforms(poses, "poses")
        if len(matrices) != len(self) and pose is None:
            raise wrong("poses", f"found {len(matrices)}, expected {len(self)},"
                        " one for each row of joint_values")
        return self.with_positions(
            np.ascontiguousarray(matrices[:, :3, 3]), sigma,
            rotations=matrices[:, :3, :3], sigma_rotation=sigma_rotation,
            pose=pose, target=target)

    def with_distances(self, point: str, lengths: Any, sigma: Any = None, *,
                       pose: Any = None, target: int = 0,
                       position: Any = None, known: bool = False) -> Dataset:
        """Distances (M,) from a reference point: draw wires, ball bars.
        `position` of the point (m) is a guess, or known."""
        values = vector(lengths, "lengths", None, "distances (m)")
        if len(values) and values.min() <= 0:
            raise wrong("lengths", f"found {values.min()}, expected distances "
                        "above 0")
        data, number = self._with_point(point, position, known)
        at = self._poses(pose, len(values), "lengths")
        return data._with("distance", values[:, np.newaxis],
                          self._sigmas(sigma, "sigma", len(values), 1),
                          sigma is not None, at, target,
                          [number] * len(values))

    def with_point_contacts(self, point: str, sigma: Any = None, *,
                            pose: Any = None, target: int = 0,
                            position: Any = None,
                            known: bool = False) -> Dataset:
        """The target was in the same socket at poses number `pose`, by default
        at all."""
        data, number = self._with_point(point, position, known)
        at = self._poses(pose, None, "pose")
        return data._with("fixed point", np.zeros((len(at), 3)),
                          self._sigmas(sigma, "sigma", len(at), 3),
                          sigma is not None, at, target, [number] * len(at))

    def with_plane_contacts(self, plane: str, sigma: Any = None, *,
                            pose: Any = None, target: int = 0,
                            normal: Any = (0.0, 0.0, 1.0), offset: float = 0.0,
                            known: bool = False) -> Dataset:
        """The target touched a plane, normal . p = offset, at poses number
        `pose`. Normal and offset (m) are a guess, or known."""
        name = text(plane, "plane", "the plane's name")
        direction = vector(normal, "normal", 3, "a direction")
        if not np.linalg.norm(direction) > 0:
            raise wrong("normal", "is zero, expected a direction")
        distance = numbers(offset, "offset", "a length (m)")
        if distance.ndim:
            raise wrong("offset", "expected one number (m)")
        finite(distance, "offset")
        data = self._of(self._core.copy())
        names = [entry[1] for entry in data._core.references()
                 if entry[0] == "plane"]
        if name not in names:
            data._core.add_plane(name, list(direction), float(distance),
                                 bool(known))
            names.append(name)
        at = self._poses(pose, None, "pose")
        return data._with("plane", np.zeros((len(at), 1)),
                          self._sigmas(sigma, "sigma", len(at), 1),
                          sigma is not None, at, target,
                          [names.index(name)] * len(at))

    def with_differences(self, differences: Any, pose: Any, second: Any,
                         sigma: Any = None, *, target: int = 0) -> Dataset:
        """Positions at poses number `pose` less those at `second`: (M, 3)."""
        values = rows(differences, "differences", 3, "x, y, z in m")
        at = self._poses(pose, len(values), "differences")
        other = self._poses(second, len(values), "differences", "second")
        same = next((i for i, j in zip(at, other) if i == j), None)
        if same is not None:
            raise wrong("second", f"pose {same} is both first and second, "
                        "expected two different ones")
        return self._with("difference", values,
                          self._sigmas(sigma, "sigma", len(values), 3),
                          sigma is not None, at, target, seconds=other)

    def with_point_distances(self, first: str, second: str, length: float,
                             sigma: float | None = None) -> Dataset:
        """A known distance (m) of two reference points."""
        value = positive(length, "length", "a distance (m)")
        data, one = self._with_point(first, None, False)
        data, other = data._with_point(second, None, False)
        if one == other:
            raise wrong("second", "expected another point than first")
        # The number of a pose, which is not used.
        return data._with("point distance", np.array([[value]]),
                          self._sigmas(sigma, "sigma", 1, 1),
                          sigma is not None, [0], 0, [one], [other])

    def with_covariates(self, **columns: Any) -> Dataset:
        """What else was recorded of each pose, by name: temperature, station;
        (N,) each. `errors={"covariates": True}` estimates their effects."""
        if not columns:
            raise wrong("columns", "expected some, as temperature=...")
        table = np.column_stack([
            vector(value, name, len(self), "one per pose")
            for name, value in columns.items()])
        data = self._of(self._core.copy())
        data._core.set_covariates(list(columns), table)
        return data

    @property
    def name(self) -> str:
        return self._core.name

    @property
    def joint_values(self) -> Array:
        """(N, n), rad or m."""
        return self._core.joint_values()

    @property
    def positions(self) -> Array:
        """(M, 3) of all measured positions, those of poses included."""
        points = [block["measured"][:, :3] for block in self._core.blocks()
                  if block["kind"] in ("position", "pose")]
        if len(points) == 1:
            return points[0]
        return np.vstack(points) if points else np.empty((0, 3))

    @property
    def sigmas(self) -> Array:
        """Standard deviations of these (m)."""
        values = [block["sigmas"][:, :3] for block in self._core.blocks()
                  if block["kind"] in ("position", "pose")]
        return np.vstack(values) if values else np.empty((0, 3))

    @property
    def kinds(self) -> list[str]:
        """"position", "pose", "distance", "fixed point", "plane",
        "difference", "point distance": one entry per block."""
        return [block["kind"] for block in self._core.blocks()]

    @property
    def num_observations(self) -> int:
        return self._core.num_observations()

    @property
    def num_equations(self) -> int:
        """Scalar measurements."""
        return self._core.num_equations()

    @property
    def sigma_is_stated(self) -> bool:
        """Whether somebody has said how well was measured."""
        return self._core.sigmas_are_stated

    def save(self, file: Path, arm: Any) -> None:
        """Positions and poses as CSV, or where the name ends in .npy as a
        NumPy array."""
        self._core.save(arm_of(arm)._core, path(file, "file"))

    def to_pandas(self) -> Any:
        """A row per pose: q1 ..., and where a position was measured at each x,
        y, z (SI units)."""
        import pandas

        joints = self.joint_values
        frame = pandas.DataFrame(
            joints, columns=[f"q{j + 1}" for j in range(joints.shape[1])])
        points = self.positions
        if len(points) == len(frame):
            frame[["x", "y", "z"]] = points
        return frame

    def _with_point(self, point: str, position: Any,
                    known: bool) -> tuple[Dataset, int]:
        name = text(point, "point", "the point's name")
        if known and position is None:
            raise wrong("position", "found None, expected the position (m) of "
                        "a known point")
        data = self._of(self._core.copy())
        names = [entry[1] for entry in data._core.references()
                 if entry[0] == "point"]
        if name not in names:
            guess = ([0.0, 0.0, 0.0] if position is None else
                     list(vector(position, "position", 3, "x, y, z in m")))
            data._core.add_point(name, guess, bool(known))
            names.append(name)
        return data, names.index(name)

    def _with(self, kind: str, measured: Array, sigmas: Array, is_stated: bool,
              poses: list[int], target: int, references: list[int] = [],
              seconds: list[int] = []) -> Dataset:
        data = self._of(self._core.copy())
        number = integer(target, "target", 0, 63)
        data._core.add_block(kind, measured, np.ascontiguousarray(sigmas),
                             poses, [number] * len(measured) if number else [],
                             references, seconds)
        data._core.sigmas_are_stated = is_stated or self.sigma_is_stated
        return data

    def _poses(self, pose: Any, count: int | None, of: str,
               argument: str = "pose") -> list[int]:
        if pose is None:
            if count not in (None, len(self)):
                raise wrong(of, f"found {count}, expected {len(self)}, one for "
                            "each row of joint_values (or `pose`, the number "
                            "of the pose of each)")
            return list(range(len(self))) if of == "pose" else []
        values = np.asarray(pose)
        if values.dtype.kind == "b" and values.shape == (len(self),):
            values = np.flatnonzero(values)
        if values.ndim != 1 or values.dtype.kind not in "iu":
            raise wrong(argument, f"expected a list of numbers of poses, from "
                        f"0 to {len(self) - 1}")
        if count is not None and len(values) != count:
            raise wrong(argument, f"found {len(values)}, expected {count}, one "
                        "for each measurement")
        if len(values) and not (0 <= values.min()
                                and values.max() < len(self)):
            raise wrong(argument, f"found {values.min()} to {values.max()}, "
                        f"expected numbers of poses from 0 to {len(self) - 1}")
        return [int(value) for value in values]

    @staticmethod
    def _sigmas(sigma: Any, argument: str, count: int, columns: int) -> Array:
        """One row for all, or a row each."""
        if sigma is None:
            return np.full((1, columns), _FIRST_SIGMA)
        expected = (f"a standard deviation, above 0, or an array of shape "
                    f"({columns},) or ({count}, {columns})")
        values = numbers(sigma, argument, expected)
        if values.shape == (count,) and count != columns:
            values = values[:, np.newaxis] * np.ones(columns)
        if values.shape not in ((), (columns,), (count, columns)):
            raise wrong(argument,
                        f"found shape {values.shape}, expected {expected}")
        if not (values > 0).all():
            raise wrong(argument, f"found {np.min(values)}, expected {expected}"
                        " (inf: not measured)")
        return np.ascontiguousarray(np.broadcast_to(
            values, (count if values.ndim == 2 else 1, columns)))

    def __len__(self) -> int:
        """Number of poses."""
        return len(self._core.joint_values())

    def __repr__(self) -> str:
        kinds = ", ".join(sorted(set(self.kinds))) or "nothing measured"
        return (f"Dataset({self.name!r}, {len(self)} poses, "
                f"{self.num_observations} observations: {kinds})")

    def _repr_html_(self) -> str:
        frame = self.to_pandas()
        return f"<b>{self!r}</b>" + frame.head()._repr_html_()

    def __getstate__(self) -> dict[str, Any]:
        core = self._core
        return {"joint_values": np.array(core.joint_values()),
                "name": core.name, "stated": core.sigmas_are_stated,
                "references": core.references(),
                "covariates": (core.covariate_names(),
                               np.array(core.covariates())),
                "blocks": [{key: np.array(value)
                            if isinstance(value, np.ndarray) else value
                            for key, value in block.items()}
                           for block in core.blocks()]}

    def __setstate__(self, state: dict[str, Any]) -> None:
        core = _core.Measurements(state["joint_values"])
        core.name = state["name"]
        core.sigmas_are_stated = state["stated"]
        for kind, name, numbers_, offset, known in state["references"]:
            if kind == "point":
                core.add_point(name, list(numbers_), known)
            else:
                core.add_plane(name, list(numbers_), offset, known)
        if state["covariates"][0]:
            core.set_covariates(*state["covariates"])
        for block in state["blocks"]:
            core.add_block(**block)
        self._core = core


def _is_guess(sigmas: Array) -> bool:
    return bool((sigmas[:, 0] == _FIRST_SIGMA).all())


def _rotation_vectors(rotations: Any, count: int) -> Array:
    expected = (f"rotation matrices ({count}, 3, 3) or rotation vectors "
                f"({count}, 3)")
    values = numbers(rotations, "rotations", expected)
    finite(values, "rotations")
    if values.shape == (count, 3, 3):
        check_rotations(values, "rotations")
        return rotation_vectors(values)
    if values.shape != (count, 3):
        raise wrong("rotations",
                    f"found shape {values.shape}, expected {expected}")
    return values


def dataset_of(value: Any, arm: Arm, argument: str, threads: int) -> Dataset:
    """A Dataset, or the file of one."""
    if isinstance(value, Dataset):
        if value.joint_values.shape[1] != arm.num_joints:
            raise wrong(argument, f"has {value.joint_values.shape[1]} joint "
                        f"values per pose, the arm {arm.num_joints} joints, "
                        "expected as many")
        most = max((max(block["targets"], default=0)
                    for block in value._core.blocks()), default=0)
        if most >= len(arm.targets):
            raise wrong(argument, f"names target {most}, the arm has "
                        f"{len(arm.targets)}, expected numbers from 0")
        return value
    if isinstance(value, str) or hasattr(value, "__fspath__"):
        return Dataset.load(value, arm, threads=threads)
    raise wrong(argument, f"found {type(value).__name__}, expected a Dataset "
                "or the path of one")
