"""Arguments as arrays of the shapes that the library takes, or an InputError
that names the argument."""

from __future__ import annotations

import operator
import os
from typing import Any, Sequence, Union

import numpy as np
import numpy.typing as npt

from ._errors import wrong

Array = npt.NDArray[np.float64]
Path = Union[str, "os.PathLike[str]"]


def _describe(value: Any) -> str:
    if isinstance(value, np.ndarray):
        return f"an array of shape {value.shape} and type {value.dtype}"
    if isinstance(value, (list, tuple)):
        return f"a {type(value).__name__} of {len(value)}"
    if value is None:
        return "None"
    return f"{type(value).__name__} {value!r:.60}"


def numbers(value: Any, argument: str, expected: str) -> Array:
    """Any array of finite doubles; contiguous along its last axis."""
    if hasattr(value, "to_numpy"):  # pandas
        for name in map(str, getattr(value, "columns", ())):
            if name.endswith(("_deg", "_mm", "(deg)", "(mm)", "[deg]", "[mm]")):
                raise wrong(argument, f"the frame has a column {name!r}, "
                            f"expected {expected}: multiply by alidade.deg and "
                            "alidade.mm, or use Dataset.from_pandas")
        value = value.to_numpy()
    masked = int(np.sum(value.mask)) if isinstance(
        value, np.ma.MaskedArray) else 0
    if masked:
        raise wrong(argument, f"{masked} numbers are masked, expected "
                    f"{expected}: leave out what was not measured")
    try:
        array = np.asarray(value)
    except (TypeError, ValueError):
        array = np.asarray(None)
    if array.dtype.kind not in "fiu":
        what = _describe(value)
        if array.dtype.kind == "c":
            what = "complex numbers"
        elif array.dtype.kind == "b":
            what = "truth values"
        raise wrong(argument, f"found {what}, expected {expected}")
    array = array.astype(np.float64, copy=False)
    if array.ndim and (array.strides[-1] != 8 or
                       any(stride < 0 or stride % 8
                           for stride in array.strides)):
        array = np.ascontiguousarray(array)
    return array


def finite(array: Array, argument: str) -> Array:
    """`array`, unless it holds NaN or an infinity."""
    # One pass and no array of truth values; a sum of finite numbers may
    # overflow, so that this is looked at again.
    with np.errstate(over="ignore", invalid="ignore"):
        total = np.add.reduce(array, axis=None)
    if not np.isfinite(total):
        bad = np.argwhere(~np.isfinite(array))
        if len(bad):
            place = ", ".join(str(i) for i in bad[0])
            raise wrong(argument, f"{array[tuple(bad[0])]} at [{place}], "
                        f"expected finite numbers ({len(bad)} are not): leave "
                        "out what was not measured")
    return array


def rows(value: Any, argument: str, columns: int, what: str,
         count: int | None = None, are_finite: bool = True) -> Array:
    """N x columns; one row may be given as a vector."""
    expected = f"an array of shape ({count or 'N'}, {columns}), {what}"
    array = numbers(value, argument, expected)
    if array.ndim == 1 and array.shape[0] == columns and count in (None, 1):
        array = array[np.newaxis]
    if array.ndim != 2 or array.shape[1] != columns or (
            count is not None and array.shape[0] != count):
        hint = ""
        if array.ndim == 2 and array.shape[0] == columns and count in (
                None, array.shape[1]):
            hint = ": it is transposed"
        raise wrong(argument, f"found shape {array.shape}, expected "
                    f"{expected}{hint}")
    # Rows that overlap are no matrix.
    if array.shape[0] > 1 and array.strides[0] < 8 * columns:
        array = np.ascontiguousarray(array)
    return finite(array, argument) if are_finite else array


def vector(value: Any, argument: str, count: int | None, what: str) -> Array:
    expected = f"{count if count is not None else 'a list of'} numbers, {what}"
    array = numbers(value, argument, expected)
    if array.ndim != 1 or (count is not None and array.shape[0] != count):
        raise wrong(argument,
                    f"found shape {array.shape}, expected {expected}")
    return finite(np.ascontiguousarray(array), argument)


def transforms(value: Any, argument: str, tolerance: float = 1e-6) -> Array:
    """N x 4 x 4, each a rotation, to within `tolerance`, and a translation."""
    expected = "an array of shape (N, 4, 4), homogeneous matrices"
    array = numbers(value, argument, expected)
    if array.ndim == 2 and array.shape == (4, 4):
        array = array[np.newaxis]
    if array.ndim != 3 or array.shape[1:] != (4, 4):
        raise wrong(argument,
                    f"found shape {array.shape}, expected {expected}")
    finite(array, argument)
    last = np.abs(array[:, 3] - (0.0, 0.0, 0.0, 1.0)).max(initial=0.0)
    if last > 1e-9:
        raise wrong(argument, "last rows are not 0 0 0 1, expected homogeneous "
                    "matrices (transposed?)")
    check_rotations(array[:, :3, :3], argument, tolerance)
    return np.ascontiguousarray(array)


def check_rotations(array: Array, argument: str, tolerance: float) -> None:
    product = array @ array.transpose(0, 2, 1) - np.eye(3)
    error = np.abs(product).max(initial=0.0)
    if error > tolerance:
        raise wrong(argument, f"rotations are off by {error:.2g} from "
                    "orthonormal ones, expected rotation matrices")
    if array.size and np.linalg.det(array).min() < 0.0:
        raise wrong(argument, "a rotation matrix has the determinant -1, "
                    "expected right-handed frames")


def text(value: Any, argument: str, what: str = "a text") -> str:
    if not isinstance(value, str) or not value:
        raise wrong(argument, f"found {_describe(value)}, expected {what}")
    return value


def path(value: Any, argument: str) -> str:
    try:
        name = os.fspath(value)
    except TypeError:
        name = None
    if isinstance(name, bytes):
        name = os.fsdecode(name)
    if not name or "\0" in name:
        raise wrong(argument, f"found {_describe(value)}, expected a path")
    return str(name)


def integer(value: Any, argument: str, least: int, most: int = 2**31 - 1) -> int:
    expected = f"an integer from {least} to {most}"
    if most == 2**31 - 1:
        expected = f"an integer, {least} or more"
    try:
        number = None if isinstance(value, (bool, np.bool_)) else (
            operator.index(value))
    except TypeError:
        number = None
    if number is None or not least <= number <= most:
        raise wrong(argument, f"found {_describe(value)}, expected {expected}")
    return number


def positive(value: Any, argument: str, what: str) -> float:
    array = numbers(value, argument, what)
    if array.ndim or not np.isfinite(array) or array <= 0:
        raise wrong(argument, f"found {_describe(value)}, expected {what}, "
                    "above 0")
    return float(array)


def threads_of(value: Any) -> int:
    """0 means all processors."""
    number = integer(value, "threads", 0, 4096)
    return number or os.cpu_count() or 1


def one_of(value: Any, argument: str, choices: Sequence[str]) -> str:
    if not isinstance(value, str) or value not in choices:
        raise wrong(argument, f"found {_describe(value)}, expected one of "
                    f"{', '.join(choices)}")
    return value


def callable_or_none(value: Any, argument: str) -> Any:
    if value is not None and not callable(value):
        raise wrong(argument, f"found {_describe(value)}, expected a function")
    return value


def same_count(array: Array, argument: str, count: int, of: str) -> Array:
    if len(array) != count:
        raise wrong(argument, f"found {len(array)} rows, expected {count}, as "
                    f"many as {of}")
    return array


def seed_of(value: Any) -> int:
    return integer(value, "seed", 0, 2**64 - 1)
