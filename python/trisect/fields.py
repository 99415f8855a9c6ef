"""Signed distances, winding numbers, formulas and models as functions of space, and such functions as solids.

Fields are **positive inside**, negative outside, 0 on the surface.

>>> import trisect
>>> ball = trisect.icosphere(1.0, level=4)
>>> distance = trisect.fields.SignedDistance(ball)
>>> distance([[0, 0, 2], [0, 0, 0.5]]).round(2).tolist()
[-1.0, 0.5]
"""

from __future__ import annotations

import os
from typing import Any, Mapping, NamedTuple, Optional, Sequence, Tuple, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _arrays, _trisect
from ._operations import _core, model_text
from ._settings import Limits, settings
from ._surfaces import Solid, SolidLike, _three

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing_extensions import Unpack


class Measured(NamedTuple):
    """What is nearest to some points."""

    distance: NDArray[np.float64]
    """Signed distances, of shape (n,), in units of the coordinates; positive inside."""
    gradient: NDArray[np.float64]
    """Unit vectors in which the distance grows, of shape (n, 3)."""
    closest: NDArray[np.float64]
    """The nearest points of the surface, of shape (n, 3)."""
    face: NDArray[np.int64]
    """The faces that they are in, of shape (n,); -1 for none."""


class Grid(NamedTuple):
    """Values at the points ``origin + spacing * (i, j, k)``."""

    values: NDArray[np.float32]
    """Of shape (nx, ny, nz)."""
    origin: NDArray[np.float64]
    """The first point, of shape (3,)."""
    spacing: float
    """The distance of neighbouring points, in units of the coordinates."""


def _points(given: ArrayLike) -> NDArray[Any]:
    array = np.asarray(given)
    return _arrays.points(array.reshape(1, 3) if array.shape == (3,) else array, "points")


class SignedDistance:
    """The signed distance of a solid: exact nearest points, with a sign that is right for every closed surface.

    Made once (some tenths of a microsecond a triangle) and asked any number of times, from any number of threads.
    """

    __slots__ = ("_core", "_bounds")

    def __init__(self, solid: SolidLike, **limits: "Unpack[Limits]") -> None:
        core = _core(solid, 0, 1)
        self._core = _trisect.Distance.of_solid(core, settings(limits, limits_only=True))
        self._bounds = Solid._of(core).bounds

    def __call__(self, points: ArrayLike, **limits: "Unpack[Limits]") -> NDArray[np.float64]:
        """Distances at points of shape (n, 3), of shape (n,)."""
        return self._core.at(_points(points), settings(limits, limits_only=True))

    def measure(self, points: ArrayLike, **limits: "Unpack[Limits]") -> Measured:
        """Distances, gradients, nearest points and their faces."""
        return Measured(*self._core.measure(_points(points), settings(limits, limits_only=True)))

    def grid(
        self,
        spacing: float,
        bounds: Optional[ArrayLike] = None,
        band: Optional[float] = None,
        **limits: "Unpack[Limits]",
    ) -> Grid:
        """Distances on a grid.

        Parameters
        ----------
        spacing : float
            The distance of neighbouring points.
        bounds : array-like of shape (2, 3)
            Low and high corner; by default those of the solid, three cells wider.
        band : float
            How far from the surface distances are exact; beyond they are the band's.
        """
        box = np.asarray(bounds if bounds is not None else self._bounds + [[-3 * spacing], [3 * spacing]], dtype=float)
        low, high = _box(box)
        values = self._core.grid(low, high, float(spacing), band, settings(limits, limits_only=True))
        return Grid(values, np.array(low), float(spacing))


def _box(bounds: ArrayLike) -> Tuple[Sequence[float], Sequence[float]]:
    low, high = np.asarray(bounds, dtype=float).reshape(2, -1)
    return _three(low, "a corner"), _three(high, "a corner")


def signed_distance(solid: SolidLike, points: ArrayLike, **limits: "Unpack[Limits]") -> NDArray[np.float64]:
    """Signed distances of a solid at points of shape (n, 3); for several calls make a :class:`SignedDistance`.

    >>> import trisect
    >>> trisect.fields.signed_distance(trisect.cuboid([0, 0, 0], [2, 2, 2]), [[1, 1, 1], [1, 1, 5]]).tolist()
    [1.0, -3.0]
    """
    return SignedDistance(solid, **limits)(points, **limits)


def winding_number(solid: SolidLike, points: ArrayLike, **limits: "Unpack[Limits]") -> NDArray[np.int32]:
    """How often the surface winds around points of shape (n, 3), exactly: 0 outside, 1 inside of a simple one.

    >>> import trisect
    >>> trisect.fields.winding_number(trisect.cuboid([0, 0, 0], [2, 2, 2]), [[1, 1, 1], [1, 1, 5]]).tolist()
    [1, 0]
    """
    distance = _trisect.Distance.of_solid(_core(solid, 0, 1), settings(limits, limits_only=True))
    return distance.winding(_points(points), settings(limits, limits_only=True))


class Field:
    """A function of space, positive inside: a formula, or a model.

    >>> import trisect
    >>> gyroid = trisect.fields.Field("t - abs(sin(x)*cos(y) + sin(y)*cos(z) + sin(z)*cos(x))", t=0.3)
    >>> gyroid([[0, 0, 0]]).tolist()
    [0.3]
    >>> piece = gyroid.solid([[-3, -3, -3], [3, 3, 3]], tolerance=0.05, clip=True)
    >>> piece.is_manifold
    True

    Parameters
    ----------
    formula : str
        A formula in x, y and z.
    names : numbers or fields
        What the formula calls by name: parameters, and other fields as functions (``f(x, y, z)``).
    """

    __slots__ = ("_core",)
    _core: _trisect.Field

    def __init__(self, formula: str, **names: Union[float, "Field"]) -> None:
        numbers = [(name, float(value)) for name, value in names.items() if not isinstance(value, Field)]
        fields = [(name, value._core) for name, value in names.items() if isinstance(value, Field)]
        self._core = _trisect.Field.of_formula(formula, numbers, fields)

    @classmethod
    def of_model(
        cls,
        model: Union[str, "os.PathLike[str]", Mapping[str, Any]],
        *,
        folder: Union[str, "os.PathLike[str]", None] = None,
        **limits: "Unpack[Limits]",
    ) -> Field:
        """The field of a model; see :func:`trisect.evaluate_model`."""
        field = cls.__new__(cls)
        field._core = _trisect.Field.of_model(*model_text(model, folder), settings(limits, limits_only=True))
        return field

    def __call__(self, points: ArrayLike, **limits: "Unpack[Limits]") -> NDArray[np.float64]:
        """Values at points of shape (n, 3), of shape (n,)."""
        return self._core.at(_points(points), settings(limits, limits_only=True))

    def grid(self, bounds: ArrayLike, spacing: float, **limits: "Unpack[Limits]") -> Grid:
        """Values on a grid over a box (low and high corner, of shape (2, 3))."""
        low, high = _box(bounds)
        values = self._core.grid(low, high, float(spacing), settings(limits, limits_only=True))
        return Grid(values, np.array(low), float(spacing))

    def solid(
        self,
        bounds: ArrayLike,
        tolerance: float,
        *,
        clip: bool = False,
        resolution: Optional[float] = None,
        **limits: "Unpack[Limits]",
    ) -> Solid:
        """The solid where the field is positive, as a closed mesh; its :attr:`~trisect.Solid.extraction` tells how good it is.

        >>> import trisect
        >>> ball = trisect.fields.Field("sphere(x, y, z, 1)").solid([[-2] * 3, [2] * 3], tolerance=0.01)
        >>> ball.extraction.deviation <= 0.01, ball.extraction.normal_deviation < 5
        (True, True)

        Parameters
        ----------
        bounds : array-like of shape (2, 3)
            A box that contains it.
        tolerance : float
            How far the mesh may be from the surface, in units of the coordinates.
        clip : bool
            Whether it is cut off at the box; else it must end inside.
        resolution : float
            Parts at least this thick are found for certain.
        """
        low, high = _box(bounds)
        given = settings(limits, limits_only=True)
        return Solid._of(_trisect.extract(self._core, low, high, float(tolerance), bool(clip), resolution, given))
