"""What was measured."""

from __future__ import annotations

import html
import os
import re
import tempfile
from typing import Any

import numpy as np

from . import _core
from ._arm import Arm, arm_of
from ._arrays import Array, Path, numbers, path, positive, rows, text, threads_of
from ._errors import InputError, wrong
from ._measuring import Measuring
from ._observations import (add_after, add_part, copy_references,
                            station_names, without_stations)
from ._options import flow, nested, with_options
from ._record import Record


class Dataset(Measuring):
    """Measurements of an arm at known joint values, in metres and radians.

        data = Dataset(joint_values, positions, sigma=2e-5)

    joint_values
        (N, n), rad or m: a row per pose.
    positions
        (N, 3): where the target was, in the instrument's frame.
    rotations
        beside positions, where orientations were measured: matrices (N, 3, 3),
        rotation vectors (N, 3), SciPy's Rotation, or numbers that `convention`
        names.
    convention
        of rotations: "quaternion" (w, x, y, z) or Euler angles,
        "intrinsic_zyx" and the 23 others of job files.
    poses
        instead of both: homogeneous matrices (N, 4, 4).
    sigma
        standard deviation of each coordinate (m): one number, (3,) or (N, 3);
        inf where a coordinate was not measured. None: not known; calibrations
        then estimate it from the residuals.
    sigma_rotation
        of small turns about the instrument's axes (rad), likewise; by default
        sigma / 0.2 m. `sigma_angles`, in its place: of the Euler angles.
    covariance
        in place of sigma: (3, 3) or (N, 3, 3) of positions (m^2), or (6, 6) or
        (N, 6, 6) of positions and small turns.
    inverse
        poses are those of a fixed target in the frame of a camera on the arm.
    target
        which target was measured: the number (from 0) or name of the arm's, or
        one for each row.

    Methods that begin with ``with_`` return another data set that has further
    measurements: of other poses or targets, distances, contacts, differences.
    Arrays of doubles are not copied where rows are contiguous: do not change
    them afterwards.
    """

    __slots__ = ()

    def __init__(self, joint_values: Any, positions: Any = None, *,
                 rotations: Any = None, convention: Any = None,
                 poses: Any = None, sigma: Any = None,
                 sigma_rotation: Any = None, sigma_angles: Any = None,
                 covariance: Any = None, inverse: bool = False,
                 target: Any = 0, name: str = "arrays") -> None:
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
        stated = dict(sigma_rotation=sigma_rotation, covariance=covariance,
                      inverse=inverse, target=target)
        if positions is None and poses is None:
            for argument, value in dict(
                    rotations=rotations, convention=convention, sigma=sigma,
                    sigma_rotation=sigma_rotation, sigma_angles=sigma_angles,
                    covariance=covariance, inverse=inverse or None).items():
                if value is not None:
                    raise wrong(argument, "goes with positions, expected these "
                                "too")
            return
        if positions is not None:
            if poses is not None:
                raise wrong("poses", "found beside positions, expected one of "
                            "both")
            added = self.with_positions(
                positions, sigma, rotations=rotations, convention=convention,
                sigma_angles=sigma_angles, **stated)
        else:
            for argument, value in dict(
                    rotations=rotations, convention=convention,
                    sigma_angles=sigma_angles).items():
                if value is not None:
                    raise wrong(argument, "found beside poses, expected it "
                                "with positions alone")
            added = self.with_poses(poses, sigma, **stated)
        self._core = added._core

    @classmethod
    def load(cls, file: Any, arm: Any, *, sigma: float | None = None,
             sigma_rotation: float | None = None, references: Any = None,
             threads: int = 1, **keys: Any) -> Dataset:
        """A data set's file, CSV or NPY (docs/files.md, "Data set"), or a list
        of several.

        sigma
            standard deviation (m) of lengths where the file states none; None:
            these are estimated.
        sigma_rotation
            likewise of orientations (rad); by default sigma / 0.2 m.
        references
            what is known of points and planes: {"points": [{"name": "post",
            "position": [1.2, 0, 0.3], "known": True}], "planes": ...,
            "distances": ...}, as in job files.

        Every further keyword is a key of a job's `data`, or of its `columns`:

        {options}

        One data set of several files with keys of their own: a list of dicts,
        [{"file": "tracker.csv", "target": "probe"}, "sockets.csv"].
        """
        nominal = arm_of(arm)
        entries = file if isinstance(file, (list, tuple)) else [file]
        if not entries:
            raise wrong("file", "the list is empty, expected files")
        named = []
        for k, entry in enumerate(entries):
            place = "file" if len(entries) == 1 else f"file[{k}]"
            own = dict(entry) if isinstance(entry, dict) else {"file": entry}
            name = path(own.pop("file", None), place)
            named.append({"file": name, **nested("data", {**keys, **own})})
        measurement: dict[str, Any] = {"sigma": "estimate"}
        if sigma is not None:
            measurement["sigma"] = positive(sigma, "sigma", "a length (m)")
        if sigma_rotation is not None:
            measurement["sigma_rotation"] = positive(
                sigma_rotation, "sigma_rotation", "an angle (rad)")
        whole: dict[str, Any] = {"units": {"length": "m", "angle": "rad"},
                                 "measurement": measurement, "data": named}
        if references is not None:
            whole["references"] = references
        try:
            core = _core.Measurements.load(flow(whole, "data"), nominal._core,
                                           threads_of(threads))
        except InputError as error:
            if error.file != "options":
                raise
            key = re.sub(r"^data(\[\d+\])?\.?", "", error.key) or "file"
            raise InputError(error.message, key=key) from None
        return cls._of(core)

    @classmethod
    def from_pandas(cls, frame: Any, arm: Any, **keywords: Any) -> Dataset:
        """A frame whose columns are named as those of data set files, with
        their units: q1_deg ... or q1_rad ..., x_mm, y_mm, z_mm or x_m ...,
        target, point, plane (docs/files.md, "Data set"); or as `columns` says.
        Keywords are those of `load`."""
        if not hasattr(frame, "to_csv"):
            raise wrong("frame", f"found {type(frame).__name__}, expected a "
                        "pandas DataFrame")
        with tempfile.TemporaryDirectory() as folder:
            file = os.path.join(folder, "frame.csv")
            frame.to_csv(file, index=False)
            try:
                data = cls.load(file, arm, **keywords)
            except InputError as error:
                if error.file != file:
                    raise
                # The header is line 1, the first row line 2.
                row = f"row {error.line - 2}: " if error.line > 1 else ""
                key = f"frame[{error.key!r}]" if error.key else "frame"
                raise InputError(row + error.message, key=key) from None
        data._core.name = "frame"
        return data

    def __add__(self, other: Any) -> Dataset:
        """Both as one data set, the poses of `other` after one's own. Points and
        planes of one name are the same."""
        if not isinstance(other, Dataset):
            return NotImplemented
        one, more = self._core, other._core
        if one.first_station or more.first_station:
            _require_stations(one, more, "other")
            both = (self._of(without_stations(one))
                    + self._of(without_stations(more)))
            return both.with_stations(station_names(one) + station_names(more),
                                      first=one.first_station)
        if other.joint_values.shape[1] != self.joint_values.shape[1]:
            raise wrong("other", f"has {other.joint_values.shape[1]} joint "
                        "values per pose, expected "
                        f"{self.joint_values.shape[1]}")
        if (one.covariate_names() != more.covariate_names()
                or one.uses() != more.uses()):
            raise wrong("other", "has other covariates, expected the same in "
                        "both")
        core = _core.Measurements(np.vstack([self.joint_values,
                                             other.joint_values]))
        core.name = one.name
        core.sigmas_are_stated = one.sigmas_are_stated or more.sigmas_are_stated
        if one.sets or more.sets:
            core.sets = [*(one.sets or [""] * len(self)),
                         *(more.sets or [""] * len(other))]
        core.rejected = [*one.rejected, *more.rejected]
        if one.covariate_names():
            core.set_covariates(one.covariate_names(), np.vstack(
                [one.covariates(), more.covariates()]))
        core.set_uses(one.uses())
        names = {kind: [entry[1] for entry in one.references()
                        if entry[0] == kind] for kind in ("point", "plane")}
        added = [entry for entry in more.references()
                 if entry[1] not in names[entry[0]]]
        copy_references([*one.references(), *added], core)
        for entry in added:
            names[entry[0]].append(entry[1])
        core.target_names = list(dict.fromkeys(
            [*one.target_names, *more.target_names]))
        for block in one.blocks():
            add_after(block, 0, names, one, core)
        for block in more.blocks():
            add_after(block, len(self), names, more, core)
        return self._of(core)

    def _with_references_of(self, held: Dataset) -> tuple[Dataset, Dataset]:
        """This one and validation data, with the same numbers of points and
        planes."""
        one, more = self._core, held._core
        if one.first_station or more.first_station:
            _require_stations(one, more, "validation")
            names_ = station_names(more)
            for name in names_:
                if name not in station_names(one):
                    raise wrong("validation", f"was measured at {name!r}, "
                                "where no pose of the fit was: its base is "
                                "not known, expected the same stations")
            more = self._of(without_stations(more)).with_stations(
                names_, first=one.first_station)._core
        names = {kind: [entry[1] for entry in one.references()
                        if entry[0] == kind] for kind in ("point", "plane")}
        added = [entry for entry in more.references()
                 if entry[1] not in names[entry[0]]]
        for kind, name, _, _, known in added:
            if not known:
                raise wrong("validation", f"measures against the {kind} "
                            f"{name!r}, which no pose of the fit does, "
                            "expected it to be known")
            names[kind].append(name)
        fit = self._copy()
        copy_references(added, fit._core)
        core = _core.Measurements(held.joint_values)
        for name in _MEMBERS:
            setattr(core, name, getattr(more, name))
        copy_references(fit._core.references(), core)
        if more.covariate_names():
            core.set_covariates(more.covariate_names(), more.covariates())
        core.set_uses(more.uses())
        core.set_origin(more.origin())
        for block in more.blocks():
            add_after(block, 0, names, more, core)
        return fit, self._of(core)

    @classmethod
    def _of(cls, core: _core.Measurements) -> Dataset:
        data = cls.__new__(cls)
        data._core = core
        return data

    def __getitem__(self, poses: Any) -> Dataset:
        """The measurements of some poses: a slice, numbers, or truth values.
        Differences stay where both of their poses do."""
        numbers_ = np.arange(len(self))
        if isinstance(poses, slice):
            kept = numbers_[poses]
        else:
            kept = np.array(self._poses(poses, None, "pose"), dtype=int)
        if len(kept) == 0 or len(set(kept)) < len(kept):
            raise wrong("pose", "expected some poses, each once")
        place = np.full(len(self), -1)
        place[kept] = np.arange(len(kept))
        old = self._core
        core = _core.Measurements(np.ascontiguousarray(self.joint_values[kept]))
        core.name, core.target_names = old.name, old.target_names
        core.first_station = old.first_station
        core.sigmas_are_stated = old.sigmas_are_stated
        core.sets = [old.sets[k] for k in kept] if old.sets else []
        copy_references(old.references(), core)
        if old.covariate_names():
            core.set_covariates(old.covariate_names(),
                                np.ascontiguousarray(old.covariates()[kept]))
        core.set_uses(old.uses())
        for block in old.blocks():
            add_part(block, place, core)
        return self._of(core)

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
            return np.asarray(points[0])
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

    @property
    def points(self) -> dict[str, Record]:
        """Reference points by name: position (m), known."""
        return {name: Record(position=np.array(numbers_), known=known)
                for kind, name, numbers_, _, known in self._core.references()
                if kind == "point"}

    @property
    def planes(self) -> dict[str, Record]:
        """Reference planes by name: normal, offset (m), known."""
        return {name: Record(normal=np.array(numbers_), offset=offset,
                             known=known)
                for kind, name, numbers_, offset, known
                in self._core.references() if kind == "plane"}

    @property
    def covariates(self) -> dict[str, Array]:
        """What else was recorded of each pose, by name."""
        values = self._core.covariates()
        return {name: values[:, k] for k, name in
                enumerate(self._core.covariate_names())}

    @property
    def sets(self) -> Any:
        """The texts of a file's column `set`, one per pose: `data[data.sets ==
        "a"]`. Empty without one."""
        return np.array(self._core.sets, dtype=str)

    @property
    def rejected(self) -> list[Record]:
        """Rows of files that hold no measurement: file, line, reason."""
        return [Record(file=file, line=line, reason=reason)
                for file, line, reason in self._core.rejected]

    def save(self, file: Path, arm: Any) -> None:
        """Positions and poses as CSV, or where the name ends in .npy as a
        NumPy array."""
        nominal = arm_of(arm)
        self._named(nominal, "target").save(nominal._core, path(file, "file"))

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

    def _named(self, arm: Arm, argument: str) -> _core.Measurements:
        """With targets by the arm's numbers."""
        names = list(arm.targets)
        for name in self._core.target_names:
            if name not in names:
                known = ", ".join(filter(None, names)) or "no names"
                raise wrong(argument, f"measures target {name!r}, the arm "
                            f"{arm.name!r} has {known}, expected one of these "
                            "or a number from 0")
        return self._core.name_targets(
            [names.index(name) for name in self._core.target_names])

    def __len__(self) -> int:
        """Number of poses."""
        return len(self._core.joint_values())

    def __repr__(self) -> str:
        kinds = ", ".join(sorted(set(self.kinds))) or "nothing measured"
        return (f"Dataset({self.name!r}, {len(self)} poses, "
                f"{self.num_observations} observations: {kinds})")

    def _repr_html_(self) -> str:
        frame = self.to_pandas()
        return f"<b>{html.escape(repr(self))}</b>{frame.head()._repr_html_()}"

    def __getstate__(self) -> dict[str, Any]:
        core = self._core
        return {"joint_values": np.array(core.joint_values()),
                "members": {name: getattr(core, name) for name in _MEMBERS},
                "references": core.references(),
                "covariates": (core.covariate_names(),
                               np.array(core.covariates())),
                "uses": core.uses(), "origin": core.origin(),
                "blocks": [{key: np.array(value)
                            if isinstance(value, np.ndarray) else value
                            for key, value in block.items()}
                           for block in core.blocks()]}

    def __setstate__(self, state: dict[str, Any]) -> None:
        core = _core.Measurements(state["joint_values"])
        for name, value in state["members"].items():
            setattr(core, name, value)
        copy_references(state["references"], core)
        if state["covariates"][0]:
            core.set_covariates(*state["covariates"])
        core.set_uses(state["uses"])
        core.set_origin(state["origin"])
        for block in state["blocks"]:
            core.add_block(**block)
        self._core = core


getattr(Dataset.load, "__func__").__doc__ = with_options(Dataset.load.__doc__,
                                                         "data")

_MEMBERS = ("name", "sigmas_are_stated", "sets", "first_station",
            "target_names", "rejected")


def _require_stations(one: _core.Measurements, more: _core.Measurements,
                      argument: str) -> None:
    if not (one.first_station and more.first_station):
        raise wrong(argument, "stations are named of one data set and not of "
                    "the other, expected with_stations of both")


def dataset_of(value: Any, arm: Arm, argument: str, threads: int) -> Dataset:
    """A Dataset for the arm, or the file of one."""
    if isinstance(value, Dataset):
        if value.joint_values.shape[1] != arm.num_joints:
            raise wrong(argument, f"has {value.joint_values.shape[1]} joint "
                        f"values per pose, the arm {arm.num_joints} joints, "
                        "expected as many")
        named = Dataset._of(value._named(arm, argument))
        most = max((max(block["targets"], default=0)
                    for block in named._core.blocks()), default=0)
        if most >= len(arm.targets):
            raise wrong(argument, f"names target {most}, the arm has "
                        f"{len(arm.targets)}, expected numbers from 0")
        return named
    if isinstance(value, str) or hasattr(value, "__fspath__"):
        return Dataset.load(value, arm, threads=threads)
    raise wrong(argument, f"found {type(value).__name__}, expected a Dataset "
                "or the path of one")
