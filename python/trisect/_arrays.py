"""Arrays as users have them, as arrays that the compiled half reads."""

from __future__ import annotations

from typing import Any, Optional, Sequence, Tuple

import numpy as np
from numpy.typing import NDArray

from ._errors import ArgumentError

_FLOATS = (np.dtype(np.float64), np.dtype(np.float32))
_INTEGERS = (np.dtype(np.int64), np.dtype(np.int32), np.dtype(np.uint32))


def points(given: Any, what: str = "vertices") -> NDArray[Any]:
    """Coordinates: an array of shape (n, 3) of ``float32`` or ``float64``, which is ``given`` itself where it is one."""
    array = given if type(given) is np.ndarray else _array(given, what)
    if array.dtype not in _FLOATS:
        if array.dtype.kind not in "fiu" and array.size:
            raise ArgumentError(f"{what} must be real numbers, not {array.dtype}")
        array = array.astype(np.float64)
    if array.ndim != 2 or array.shape[1] != 3:
        if array.size == 0:
            return np.zeros((0, 3))
        raise ArgumentError(f"{what} must be an array of shape (n, 3), not {array.shape}")
    return _aligned(array)


def _aligned(array: NDArray[Any]) -> NDArray[Any]:
    """The array, or a copy where its numbers lie askew, as the fields of packed records do: the compiled half cannot read those."""
    return array if array.flags.aligned else array.copy()


def _array(given: Any, what: str) -> NDArray[Any]:
    try:
        array = np.asarray(given)
    except ValueError as error:
        raise ArgumentError(f"{what} must be an array of numbers: {error}") from None
    if array.dtype == object:
        raise ArgumentError(f"{what} must be an array of numbers: rows of different lengths, or no numbers")
    return array


def faces(given: Any) -> Tuple[NDArray[Any], Optional[Sequence[int]]]:
    """Faces: an array of integers of shape (m, k); or, for polygons of different sizes, all corners one after the other, and how
    many each has."""
    if type(given) is np.ndarray and given.dtype != object:
        array = given
    else:
        rows = list(given)
        sizes = [len(row) for row in rows] if all(hasattr(row, "__len__") for row in rows) else []
        if len(set(sizes)) > 1:
            corners = np.concatenate([_integers(np.asarray(row)) for row in rows])
            return np.ascontiguousarray(corners, dtype=np.int64), sizes
        array = _array(rows, "faces")
    if array.size == 0:
        return np.zeros((0, 3), dtype=np.int64), None
    if array.ndim != 2:
        hint = "; of PyVista's faces, pass the PolyData itself" if array.ndim == 1 else ""
        raise ArgumentError(f"faces must be an array of shape (m, 3), or rows of corners, not {array.shape}{hint}")
    if array.shape[1] < 3:
        raise ArgumentError(f"faces must have three corners or more, not {array.shape[1]}")
    return _integers(array), None


def _integers(array: NDArray[Any]) -> NDArray[Any]:
    if array.dtype in _INTEGERS:
        return _aligned(array)
    if array.dtype.kind not in "iu":
        raise ArgumentError(f"faces must be integers, not {array.dtype}; use faces.astype(int) if they are whole numbers")
    return array.astype(np.int64)


def padded(flat: NDArray[Any]) -> Tuple[NDArray[Any], Optional[Sequence[int]]]:
    """Faces of VTK: a flat array with the number of corners before each face."""
    flat = np.asarray(flat, dtype=np.int64)
    if flat.size == 0:
        return np.zeros((0, 3), dtype=np.int64), None
    first = int(flat[0])
    if flat.size % (first + 1) == 0 and (flat[:: first + 1] == first).all():
        return flat.reshape(-1, first + 1)[:, 1:], None
    starts, at = [], 0
    while at < flat.size:
        starts.append(at)
        at += int(flat[at]) + 1
    sizes = flat[starts]
    corners = np.delete(flat, starts)
    return corners, [int(size) for size in sizes]
