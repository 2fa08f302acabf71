"""Measurements that are added to a data set."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ._arrays import (Array, finite, numbers, positive, rows, text, transforms,
                      vector)
from ._errors import wrong
from ._observations import (names_of, observe, sigmas_of, target_numbers,
                            uses_of)
from ._record import Record

if TYPE_CHECKING:
    from ._core import Measurements
    from ._dataset import Dataset

# Of measured rotation matrices from orthonormal ones; the nearest rotation is
# taken, as of files.
_MEASURED = 1e-3

def _block(kind: str, measured: Array, sigma: Any) -> dict[str, Any]:
    return {"kind": kind, "measured": measured, "whiteners": [],
            "sigmas": sigmas_of(sigma, "sigma", *measured.shape)}


def _refuse_again(argument: str, what: str, name: str) -> None:
    raise wrong(argument, f"the {what} {name!r} is there already, expected "
                "this where it is first named")


class Measuring:
    """What a `Dataset` can be given besides what it has: every method returns
    another one."""

    __slots__ = ("_core",)
    _core: Measurements

    if TYPE_CHECKING:
        def __len__(self) -> int: ...

        @property
        def joint_values(self) -> Array: ...

        @property
        def points(self) -> dict[str, Record]: ...

        @property
        def planes(self) -> dict[str, Record]: ...

        @property
        def sigma_is_stated(self) -> bool: ...

        @classmethod
        def _of(cls, core: Measurements) -> Dataset: ...

    def with_positions(self, positions: Any, sigma: Any = None, *,
                       rotations: Any = None, convention: Any = None,
                       sigma_rotation: Any = None, sigma_angles: Any = None,
                       covariance: Any = None, inverse: bool = False,
                       pose: Any = None, target: Any = 0) -> Dataset:
        """Positions (M, 3) of a target at poses number `pose` (M,), by default
        one at each, with orientations beside them where these were measured;
        arguments are those of `Dataset`."""
        points = rows(positions, "positions", 3, "x, y, z in m")
        at = self._poses(pose, len(points), "positions")
        block = observe(points, sigma, rotations, convention, sigma_rotation,
                        sigma_angles, covariance, bool(inverse))
        return self._with(block, not (sigma is None and covariance is None),
                          at, target)

    def with_poses(self, poses: Any, sigma: Any = None,
                   sigma_rotation: Any = None, *, covariance: Any = None,
                   inverse: bool = False, pose: Any = None,
                   target: Any = 0) -> Dataset:
        """The same of homogeneous matrices (M, 4, 4)."""
        matrices = transforms(poses, "poses", _MEASURED)
        if len(matrices) != len(self) and pose is None:
            raise wrong("poses", f"found {len(matrices)}, expected {len(self)},"
                        " one for each row of joint_values")
        return self.with_positions(
            np.ascontiguousarray(matrices[:, :3, 3]), sigma,
            rotations=matrices[:, :3, :3], sigma_rotation=sigma_rotation,
            covariance=covariance, inverse=inverse, pose=pose, target=target)

    def with_point(self, name: str, position: Any = None, *,
                   known: bool = False) -> Dataset:
        """A reference point in the instrument's frame: its position (m) is a
        guess, or known. Measurements name it."""
        named = text(name, "name", "the point's name")
        if known and position is None:
            raise wrong("position", "found None, expected the position (m) of "
                        "a known point")
        if named in self.points:
            raise wrong("name", f"there is a point {named!r} already, expected "
                        "another name")
        guess = ([0.0, 0.0, 0.0] if position is None else
                 list(vector(position, "position", 3, "x, y, z in m")))
        data = self._copy()
        data._core.add_point(named, guess, bool(known))
        return data

    def with_plane(self, name: str, normal: Any = (0.0, 0.0, 1.0),
                   offset: float = 0.0, *, known: bool = False) -> Dataset:
        """A reference plane, normal . p = offset (m) in the instrument's frame:
        a guess, or known. Contacts name it."""
        named = text(name, "name", "the plane's name")
        direction = vector(normal, "normal", 3, "a direction")
        if not np.linalg.norm(direction) > 0:
            raise wrong("normal", "is zero, expected a direction")
        distance = numbers(offset, "offset", "a length (m)")
        if distance.ndim:
            raise wrong("offset", "expected one number (m)")
        finite(distance, "offset")
        if named in self.planes:
            raise wrong("name", f"there is a plane {named!r} already, expected "
                        "another name")
        data = self._copy()
        data._core.add_plane(named, list(direction), float(distance),
                             bool(known))
        return data

    def with_distances(self, point: Any, lengths: Any, sigma: Any = None, *,
                       pose: Any = None, target: Any = 0,
                       position: Any = None, known: bool = False) -> Dataset:
        """Distances (M,) from a reference point, or from the point that each
        names: draw wires, ball bars. `position` of a new point (m) is a guess,
        or known (`with_point`)."""
        values = vector(lengths, "lengths", None, "distances (m)")
        if len(values) and values.min() <= 0:
            raise wrong("lengths", f"found {values.min()}, expected distances "
                        "above 0")
        at = self._poses(pose, len(values), "lengths")
        data, numbers_ = self._with_points(point, len(values), position, known)
        return data._with(
            _block("distance", values[:, np.newaxis], sigma), sigma is not None,
            at, target, numbers_)

    def with_point_contacts(self, point: Any, sigma: Any = None, *,
                            pose: Any = None, target: Any = 0,
                            position: Any = None,
                            known: bool = False) -> Dataset:
        """The target was in the same socket at poses number `pose`, by default
        at all; or in the socket that each names."""
        at = self._poses(pose, None, "pose")
        data, numbers_ = self._with_points(point, len(at), position, known)
        return data._with(_block("fixed point", np.zeros((len(at), 3)), sigma),
                          sigma is not None, at, target, numbers_)

    def with_plane_contacts(self, plane: Any, sigma: Any = None, *,
                            pose: Any = None, target: Any = 0,
                            normal: Any = None, offset: Any = None,
                            known: bool = False) -> Dataset:
        """The target touched a plane, normal . p = offset, at poses number
        `pose`, or the plane that each names. Normal and offset (m) of a new
        plane are a guess, or known (`with_plane`)."""
        at = self._poses(pose, None, "pose")
        names = names_of(plane, "plane", len(at), "the plane's name")
        data = self._copy()
        stated = {key: value for key, value in dict(
            normal=normal, offset=offset, known=known or None).items()
            if value is not None}
        for name in dict.fromkeys(names):
            if name not in data.planes:
                data = data.with_plane(name, **stated)
            elif stated:
                _refuse_again(next(iter(stated)), "plane", name)
        order = list(data.planes)
        return data._with(_block("plane", np.zeros((len(at), 1)), sigma),
                          sigma is not None, at, target,
                          [order.index(name) for name in names])

    def with_differences(self, differences: Any, pose: Any, second: Any,
                         sigma: Any = None, *, target: Any = 0) -> Dataset:
        """Positions at poses number `pose` less those at `second`: (M, 3)."""
        values = rows(differences, "differences", 3, "x, y, z in m")
        at = self._poses(pose, len(values), "differences")
        other = self._poses(second, len(values), "differences", "second")
        same = next((i for i, j in zip(at, other) if i == j), None)
        if same is not None:
            raise wrong("second", f"pose {same} is both first and second, "
                        "expected two different ones")
        return self._with(_block("difference", values, sigma),
                          sigma is not None, at, target, seconds=other)

    def with_point_distances(self, first: str, second: str, length: float,
                             sigma: float | None = None) -> Dataset:
        """A known distance (m) of two reference points."""
        value = positive(length, "length", "a distance (m)")
        data, (one,) = self._with_points(first, 1, argument="first")
        data, (other,) = data._with_points(second, 1, argument="second")
        if one == other:
            raise wrong("second", "expected another point than first")
        # The number of a pose, which is not used.
        return data._with(_block("point distance", np.array([[value]]), sigma),
                          sigma is not None, [0], 0, [one], [other])

    def with_covariates(self, columns: Any = None, /, *, effects: Any = None,
                        **more: Any) -> Dataset:
        """What else was recorded of each pose, by name: temperature=..., tilt
        ...; (N,) each, as keywords or a dict. `errors={"covariates": True}`, or
        the choice of "auto", estimates what they do. `effects`: what each may
        move, by default the base: {"temperature": ["base", "joint 2"]}; also
        "target", "joints"."""
        given = {**({} if columns is None else dict(columns)), **more}
        if not given:
            raise wrong("columns", "expected some, as temperature=...")
        uses = [] if effects is None else uses_of(
            effects, list(given), self.joint_values.shape[1])
        return self._with_columns(given, uses)

    def with_payload(self, mass: Any) -> Dataset:
        """The mass at the target (kg), one number or (N,): error terms take its
        moments."""
        values = numbers(mass, "mass", "a mass (kg), or one per pose")
        if values.ndim == 0:
            values = np.full(len(self), values)
        values = vector(values, "mass", len(self), "one per pose (kg)")
        if values.min() < 0:
            raise wrong("mass", f"found {values.min()}, expected 0 or more")
        return self._with_columns({"payload": values}, [
            ("payload", False, False, [], "payload")])

    def with_approach(self, directions: Any) -> Dataset:
        """The directions, -1 or 1, from which joints came to each pose (0:
        unknown): (N,) of all joints or (N, n). Error terms may have half a step
        of backlash by them."""
        joints = self.joint_values.shape[1]
        values = numbers(directions, "directions", "-1, 0 or 1 per pose")
        if values.shape not in ((len(self),), (len(self), joints)):
            raise wrong("directions", f"found shape {values.shape}, expected "
                        f"({len(self)},) or ({len(self)}, {joints})")
        if not np.isin(values, (-1.0, 0.0, 1.0)).all():
            raise wrong("directions", "expected -1, 0 or 1")
        if values.ndim == 1:
            return self._with_columns({"approach": values}, [
                ("approach", False, False, list(range(joints)), "approach")])
        names = [f"approach {j + 1}" for j in range(joints)]
        return self._with_columns(dict(zip(names, values.T)), [
            (name, False, False, [j], "approach")
            for j, name in enumerate(names)])

    def with_stations(self, stations: Any, *,
                      first: str | None = None) -> Dataset:
        """Where, or on which day, each pose was measured: N names. With
        `errors` other than "none" each station has a base of its own; the
        arm's base is that of `first`, by default of the first pose."""
        if self._core.first_station:
            raise wrong("stations", "are named already, expected them once")
        given = getattr(stations, "tolist", lambda: stations)()
        if isinstance(given, str):
            raise wrong("stations", "found one name, expected one for each "
                        "pose")
        names = names_of(given, "stations", len(self), "their names")
        order = list(dict.fromkeys(
            names if first is None else [text(first, "first"), *names]))
        data = self._copy()
        data._core.first_station = order[0]
        columns = {f"station {name}": np.array(names) == name
                   for name in order[1:]}
        return data._with_columns(
            {name: is_here.astype(float) for name, is_here in columns.items()},
            [(name, True, False, [], "station") for name in columns])

    def _copy(self) -> Dataset:
        return self._of(self._core.copy())

    def _with_points(self, point: Any, count: int, position: Any = None,
                     known: bool = False,
                     argument: str = "point") -> tuple[Dataset, list[int]]:
        """The numbers of the points that are named, new ones added."""
        names = names_of(point, argument, count, "the point's name")
        data = self._copy()
        for name in dict.fromkeys(names):
            if name not in data.points:
                data = data.with_point(name, position, known=known)
            elif position is not None or known:
                _refuse_again("known" if position is None else "position",
                              "point", name)
        order = list(data.points)
        return data, [order.index(name) for name in names]

    def _with_columns(self, given: Any, uses: list[Any]) -> Dataset:
        core = self._core
        if not given:
            return self._copy()
        columns = {name: core.covariates()[:, k] for k, name in
                   enumerate(core.covariate_names())}
        for name, value in given.items():
            if name in columns:
                raise wrong(name, "is recorded already, expected it once")
            columns[text(name, "columns", "a name")] = vector(
                value, str(name), len(self), "one per pose")
        data = self._copy()
        data._core.set_covariates(list(columns),
                                  np.column_stack(list(columns.values())))
        data._core.set_uses([*core.uses(), *uses])
        return data

    def _with(self, block: Any, is_stated: bool, poses: list[int],
              target: Any, references: list[int] = [],
              seconds: list[int] = []) -> Dataset:
        data = self._copy()
        measured = block["measured"]
        data._core.add_block(
            block["kind"], measured, block["sigmas"], poses,
            target_numbers(data._core, target, len(measured)), references,
            seconds, block["whiteners"])
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
