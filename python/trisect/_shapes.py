"""Basic shapes, for trying things; model files have more of them."""

from __future__ import annotations

import operator
from typing import Sequence

from . import _trisect
from ._surfaces import Solid, _three


def _shape(kind: str, lengths: Sequence[float], counts: Sequence[int] = ()) -> Solid:
    whole = [operator.index(count) for count in counts]
    return Solid._of(_trisect.shape(kind, [float(length) for length in lengths], whole))


def cuboid(low: Sequence[float], high: Sequence[float]) -> Solid:
    """A box by its low and its high corner.

    >>> import trisect
    >>> trisect.cuboid([0, 0, 0], [1, 2, 3]).volume
    6.0
    """
    return _shape("cuboid", [*_three(low, "a corner"), *_three(high, "a corner")])


def icosphere(radius: float = 1.0, level: int = 3) -> Solid:
    """A ball about the origin, of 20 * 4**level triangles, its vertices on the sphere.

    >>> import trisect
    >>> len(trisect.icosphere(2.0, level=2).faces)
    320
    """
    return _shape("icosphere", [radius], [level])


def cylinder(radius: float, height: float, segments: int = 64) -> Solid:
    """A prism of so many sides about the z axis, its vertices on the cylinder, from z = 0 to the height.

    >>> import trisect
    >>> trisect.cylinder(1.0, 3.0, segments=4).bounds[:, 2].tolist()
    [0.0, 3.0]
    """
    return _shape("cylinder", [radius, height], [segments])


def cone(radius: float, height: float, segments: int = 64) -> Solid:
    """A pyramid of so many sides about the z axis, from z = 0 to its tip."""
    return _shape("cone", [radius, height], [segments])


def torus(radius: float, tube: float, around: int = 64, across: int = 32) -> Solid:
    """A ring about the z axis: a tube of a radius whose middle is at a radius from the axis."""
    return _shape("torus", [radius, tube], [around, across])
