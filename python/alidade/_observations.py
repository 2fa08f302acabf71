"""Arguments of measurements as the library takes them: orientations in all
forms, standard deviations and covariances, names, what covariates move."""

from __future__ import annotations

from typing import Any, Mapping, Sequence

import numpy as np

from . import _core
from ._arrays import Array, finite, integer, numbers, one_of, text
from ._errors import InputError, wrong

# A first guess of a sigma that is to be estimated (m), as in jobs; and what
# goes with it of orientations: that of points 0.2 m apart.
FIRST_SIGMA = 1e-4
LEVER = 0.2

#: name, moves_base, moves_target, joints, what it is
Use = tuple[str, bool, bool, list[int], str]

_ARGUMENTS = {"positions": "positions", "orientations": "rotations",
              "convention": "convention", "sigmas": "sigma",
              "rotation_sigmas": "sigma_rotation", "angle_sigmas": "sigma_angles",
              "covariances": "covariance", "is_inverse": "inverse"}


def sigmas_of(sigma: Any, argument: str, count: int, columns: int) -> Array:
    """One row for all, or a row each."""
    if sigma is None:
        return np.full((1, columns), FIRST_SIGMA)
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


def _covariances_of(covariance: Any, count: int, has_rotations: bool) -> Array:
    sizes = (3, 6) if has_rotations else (3,)
    expected = "covariances (m^2) of shape " + " or ".join(
        f"({size}, {size}) or ({count}, {size}, {size})" for size in sizes)
    values = numbers(covariance, "covariance", expected)
    if values.ndim == 2:
        values = values[np.newaxis]
    if values.ndim != 3 or len(values) not in (1, count) or (
            values.shape[1:] not in [(size, size) for size in sizes]):
        raise wrong("covariance",
                    f"found shape {values.shape}, expected {expected}")
    return np.ascontiguousarray(values.reshape(len(values), -1))


def _rotations_of(rotations: Any, convention: Any,
                  count: int) -> tuple[Array, str]:
    """A row of numbers each, and what they are."""
    if hasattr(rotations, "as_matrix"):  # SciPy's Rotation
        rotations = np.reshape(rotations.as_matrix(), (-1, 3, 3))
    expected = (f"rotation matrices ({count}, 3, 3), rotation vectors "
                f"({count}, 3) or, with a `convention`, angles ({count}, 3) "
                f"or quaternions ({count}, 4)")
    values = numbers(rotations, "rotations", expected)
    finite(values, "rotations")
    widths = {"matrix": (3, 3), "quaternion": (4,)}
    if convention is None:
        if values.shape == (count, 4):
            raise wrong("convention", "found None beside four numbers each, "
                        "expected \"quaternion\": w, x, y, z (SciPy has x, y, "
                        "z, w: hand over its Rotation itself)")
        convention = "matrix" if values.ndim == 3 else "rotation_vector"
    name = text(convention, "convention", "the name of a convention")
    if values.shape != (count, *widths.get(name, (3,))):
        raise wrong("rotations", f"found shape {values.shape}, expected "
                    f"{expected}")
    return np.ascontiguousarray(values.reshape(count, -1)), name


def observe(points: Array, sigma: Any, rotations: Any, convention: Any,
            sigma_rotation: Any, sigma_angles: Any, covariance: Any,
            inverse: bool) -> dict[str, Any]:
    """A block of positions or poses."""
    count = len(points)
    noise: dict[str, Array] = {}
    if rotations is None:
        for argument, value in (("sigma_rotation", sigma_rotation),
                                ("sigma_angles", sigma_angles),
                                ("convention", convention),
                                ("inverse", inverse or None)):
            if value is not None:
                raise wrong(argument, "goes with rotations, expected these "
                            "too")
    if covariance is None:
        noise["sigmas"] = sigmas_of(sigma, "sigma", count, 3)
    elif sigma is not None:
        raise wrong("covariance", "found beside sigma, expected one of both")
    else:
        noise["covariances"] = _covariances_of(covariance, count,
                                               rotations is not None)
    if rotations is None and covariance is None:
        return {"kind": "position", "measured": points,
                "sigmas": noise["sigmas"], "whiteners": []}
    turns: Array = np.empty((count, 0))
    name = "rotation_vector"
    if rotations is not None:
        turns, name = _rotations_of(rotations, convention, count)
        is_whole = covariance is not None and (
            noise["covariances"].shape[1] == 36)
        if sigma_angles is not None:
            if sigma_rotation is not None:
                raise wrong("sigma_angles", "found beside sigma_rotation, "
                            "expected one of both")
            noise["angle_sigmas"] = sigmas_of(sigma_angles, "sigma_angles",
                                              count, 3)
        elif sigma_rotation is not None:
            if is_whole:
                raise wrong("sigma_rotation", "found beside a covariance of "
                            "positions and turns, expected one of both")
            noise["rotation_sigmas"] = sigmas_of(sigma_rotation, "sigma_rotation",
                                             count, 3)
        elif not is_whole:
            if "sigmas" not in noise:
                raise wrong("sigma_rotation", "found None beside a covariance "
                            "of positions, expected it (rad)")
            noise["rotation_sigmas"] = np.asarray(
                noise["sigmas"] / LEVER, dtype=np.float64)
    try:
        return _core.observe(points, turns, name, noise, inverse)
    except InputError as error:
        raise InputError(error.message.replace("rotation_sigmas", "sigma_rotation"),
                         key=_ARGUMENTS.get(error.key, error.key)) from None


def names_of(value: Any, argument: str, count: int, what: str) -> list[str]:
    """One name for all measurements, or one each."""
    if isinstance(value, str):
        return [text(value, argument, what)] * count
    names = list(value) if hasattr(value, "__iter__") else [value]
    if len(names) != count:
        raise wrong(argument, f"found {len(names)} names, expected {what} or "
                    f"{count}, one for each measurement")
    return [text(name, argument, what) for name in names]


def target_numbers(core: _core.Measurements, target: Any,
                   count: int) -> list[int]:
    """One target for all measurements, or one each. Names get numbers beyond
    those of arms."""
    known = core.target_names

    def number_of(value: Any) -> int:
        if not isinstance(value, str):
            return integer(value, "target", 0, _core.NAMED_TARGETS - 1)
        name = text(value, "target", "a target's name or number")
        if name not in known:
            known.append(name)
        return _core.NAMED_TARGETS + known.index(name)

    if isinstance(target, (list, tuple, np.ndarray)) or hasattr(
            target, "to_numpy"):
        if len(target) != count:
            raise wrong("target", f"found {len(target)}, expected one or "
                        f"{count}, one for each measurement")
        found = [number_of(value) for value in target]
        is_first = not any(found)
    else:
        number = number_of(target)
        is_first = number == 0
        found = [] if is_first else [number] * count
    core.target_names = known
    return [] if is_first else found


def uses_of(effects: Any, columns: Sequence[str], joints: int) -> list[Use]:
    """What covariates move, as job files say it."""
    if not isinstance(effects, Mapping):
        raise wrong("effects", "expected a dict from covariates to what they "
                    "move: \"base\", \"target\", \"joints\", \"joint 2\" or a "
                    "list of some")
    places = ["base", "target", "joints",
              *(f"joint {j + 1}" for j in range(joints))]
    uses: list[Use] = []
    for name, value in effects.items():
        one_of(name, "effects", list(columns))
        moved = [value] if isinstance(value, str) else list(value)
        for place in moved:
            one_of(place, f"effects[{name!r}]", places)
        turned = [j for j in range(joints)
                  if "joints" in moved or f"joint {j + 1}" in moved]
        uses.append((name, "base" in moved, "target" in moved, turned, ""))
    return uses


_STATION = "station "


def station_names(core: _core.Measurements) -> list[str]:
    """Of each pose."""
    values = core.covariates()
    names = [core.first_station] * len(core.joint_values())
    for k, column in enumerate(core.covariate_names()):
        if column.startswith(_STATION):
            for i in np.flatnonzero(values[:, k]):
                names[i] = column[len(_STATION):]
    return names


def without_stations(core: _core.Measurements) -> _core.Measurements:
    kept = [k for k, name in enumerate(core.covariate_names())
            if not name.startswith(_STATION)]
    copy = core.copy()
    copy.set_covariates([core.covariate_names()[k] for k in kept],
                        np.ascontiguousarray(core.covariates()[:, kept]))
    copy.set_uses([use for use in core.uses() if use[4] != "station"])
    copy.first_station = ""
    return copy


def copy_references(references: Any, core: _core.Measurements) -> None:
    for kind, name, numbers_, offset, known in references:
        if kind == "point":
            core.add_point(name, list(numbers_), known)
        else:
            core.add_plane(name, list(numbers_), offset, known)


def add_part(block: Any, place: Any, core: _core.Measurements) -> None:
    """What is measured at the poses whose `place` is not -1."""
    size = len(block["measured"])
    if block["kind"] == "point distance":
        core.add_block(**block)
        return
    poses = place[np.array(block["poses"] or range(size), dtype=int)]
    is_kept = poses >= 0
    seconds: Any = np.array(block["seconds"], dtype=int)
    if block["kind"] == "difference":
        seconds = place[seconds]
        is_kept &= seconds >= 0
    kept = np.flatnonzero(is_kept)
    # In the order that the poses have now.
    kept = kept[np.argsort(poses[kept], kind="stable")]
    if len(kept) == 0:
        return
    core.add_block(
        block["kind"], np.ascontiguousarray(block["measured"][kept]),
        np.ascontiguousarray(block["sigmas"][kept]), poses[kept].tolist(),
        [block["targets"][k] for k in kept] if block["targets"] else [],
        [block["references"][k] for k in kept] if block["references"] else [],
        seconds[kept].tolist() if len(seconds) else [],
        [block["whiteners"][k] for k in kept] if block["whiteners"] else [])


def add_after(block: Any, first: int, names: dict[str, list[str]],
               other: _core.Measurements, core: _core.Measurements) -> None:
    """A block of measurements whose poses begin at `first` now."""
    kind = block["kind"]
    sort = "plane" if kind == "plane" else "point"
    place = [names[sort].index(entry[1]) for entry in other.references()
             if entry[0] == sort]
    known = core.target_names
    block["targets"] = [
        number if number < _core.NAMED_TARGETS else _core.NAMED_TARGETS
        + known.index(other.target_names[number - _core.NAMED_TARGETS])
        for number in block["targets"]]
    block["references"] = [place[number] for number in block["references"]]
    if kind == "point distance":
        block["seconds"] = [place[number] for number in block["seconds"]]
    else:
        block["poses"] = [first + pose for pose in block["poses"] or range(
            len(block["measured"]))]
        block["seconds"] = [first + pose for pose in block["seconds"]]
    core.add_block(**block)
