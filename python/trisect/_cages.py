"""``Cage``, the control mesh of a subdivision surface, and booleans of cages that give cages."""

from __future__ import annotations

import json
import math
import os
import warnings
from dataclasses import dataclass, field
from typing import Any, Dict, List, NamedTuple, Optional, Sequence, Tuple, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _arrays, _trisect
from ._errors import ArgumentError, TrisectWarning
from ._files import ending, write_text
from ._records import Record
from ._settings import Limits, settings
from ._surfaces import Mesh, Solid, _three

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing_extensions import Unpack


class PointOrigins(NamedTuple):
    """Where the control points of a result come from: three arrays of shape (n,)."""

    operand: NDArray[np.int64]
    """The place of the operand in the call, from 0; -1 for new points."""
    vertex: NDArray[np.int64]
    """Its control point there; -1 for new ones."""
    moved: NDArray[np.bool_]
    """Whether it is not where it was, bit for bit."""


@dataclass(frozen=True)
class CageErrors(Record):
    """Distances between the surface of a resulting cage and the exact boolean, in units of the coordinates: from it (``forward``)
    and to it (``backward``), the root of the mean square, along the ``curve``, in the ``band`` of new faces and ``outside`` of it.
    They may be too small by ``allowance``. ``volume`` is that of the cage's solid less the exact one's."""

    forward: float = 0.0
    backward: float = 0.0
    mean: float = 0.0
    curve: float = 0.0
    band: float = 0.0
    outside: float = 0.0
    allowance: float = 0.0
    volume: float = 0.0

    @property
    def largest(self) -> float:
        """The larger of both directions."""
        return max(self.forward, self.backward)


@dataclass(frozen=True)
class CageReport(Record):
    """What was asked for and what came of it: whether the distance ``asked`` for was ``reached``, the ``errors``, and how many control
    points were ``added``, moved (``fitted``) and left as they were (``unchanged``)."""

    asked: float = 0.0
    reached: bool = False
    errors: CageErrors = field(default_factory=CageErrors, metadata={"of": CageErrors.of})
    vertices: int = 0
    faces: int = 0
    added: int = 0
    fitted: int = 0
    unchanged: int = 0
    chains: int = 0
    features: int = 0
    junctions: int = 0
    crossing_degrees: float = 90.0
    largest_valence: int = 0
    refined: int = 0
    levels: int = 0
    details: int = 0
    exact_triangles: int = 0
    seconds: Dict[str, float] = field(default_factory=dict)
    warnings: List[str] = field(default_factory=list)


class Cage:
    """A control mesh: the surface it stands for is what its faces become when they are split and smoothed without end. Immutable.

    >>> import trisect
    >>> corners = [[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)]
    >>> squares = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]
    >>> cage = trisect.Cage(corners, squares, creases=[(0, 1), (1, 3, 2.5)])
    >>> cage
    <trisect.Cage: 8 control points, 6 faces, catmull-clark>
    >>> cage.refine().faces.shape, 0.3 < cage.solid(0.01).volume < 0.5
    ((24, 4), True)

    Operators are booleans whose result is a cage again: ``a | b``, ``a & b``, ``a - b``; its :attr:`report` says how far it is from the
    exact one. See :func:`combine_cages`.

    Parameters
    ----------
    vertices : array-like of shape (n, 3)
        Control points.
    faces : array-like of integers of shape (m, 3), or rows of three corners or more
        Control faces, counter-clockwise seen from outside.
    creases : rows (a, b) or (a, b, sharpness)
        Edges that stay sharp: for so many subdivisions, for ever from 10 on and by default.
    corners : vertices, or rows (vertex, sharpness)
        Vertices that stay where they are.
    sectors : rows (vertex, first, angle, flatness)
        How the faces between two creases at a corner open, counter-clockwise from the crease to ``first``; angles in radians.
    rules : str
        Weights of Loop's scheme: "loop" (smooth beside creases), "opensubdiv" or "biermann".
    scheme : str
        "loop" (triangles) or "catmull-clark" (polygons); by default the latter if a face has more than three corners.
    """

    __slots__ = ("_core", "_report", "__weakref__")
    _core: _trisect.Cage
    _report: Optional[CageReport]

    def __init__(
        self,
        vertices: ArrayLike,
        faces: Any,
        *,
        creases: Sequence[Sequence[float]] = (),
        corners: Sequence[Any] = (),
        sectors: Sequence[Sequence[float]] = (),
        rules: str = "loop",
        scheme: Optional[str] = None,
    ) -> None:
        tagged = (
            [(_index(row[0]), _index(row[1]), _sharpness(row, 2)) for row in creases],
            [(_index(row), math.inf) if np.isscalar(row) else (_index(row[0]), _sharpness(row, 1)) for row in corners],
            [(_index(row[0]), _index(row[1]), float(row[2]), float(row[3])) for row in sectors],
        )
        points = _arrays.points(vertices)
        core, warned = _trisect.Cage.of_arrays(points, _rows(faces, len(points)), tagged, rules, scheme)
        self._core, self._report = core, None
        _warn(warned, "a cage")

    @classmethod
    def _of(cls, core: _trisect.Cage, report: Optional[CageReport] = None) -> Cage:
        cage = cls.__new__(cls)
        cage._core, cage._report = core, report
        return cage

    @classmethod
    def load(cls, path: Union[str, "os.PathLike[str]"], *, rules: str = "loop", scheme: Optional[str] = None) -> Cage:
        """Reads a cage: ``.obj`` with the tag lines of OpenSubdiv, ``.json``, or the cage that a ``.glb`` has beside its mesh.

        ``rules`` and ``scheme`` are for OBJ; other files say them.
        """
        name = os.fspath(path)
        with open(name, "rb") as file:
            core, warned = _trisect.Cage.of_bytes(ending(name), file.read(), rules, scheme)
        _warn(warned, name)
        return cls._of(core)

    def save(self, path: Union[str, "os.PathLike[str]"], *, tolerance: Optional[float] = None) -> None:
        """Writes the cage as ``.obj`` or ``.json``; or as ``.glb`` or ``.gltf``, which shows its limit surface to other programs and has
        the cage beside it. Reading any of them gives the same bits. ``tolerance`` is of the surface, a thousandth of the diagonal by default.
        """
        name = os.fspath(path)
        if ending(name) in ("glb", "gltf"):
            _warn(self._core.save_beside(self.limit_mesh(tolerance)._core, name), name)
        else:
            write_text(name, self._core.text(ending(name)))

    @property
    def vertices(self) -> NDArray[np.float64]:
        """Control points, of shape (n, 3)."""
        return self._core.vertices()

    @property
    def faces(self) -> Any:
        """Control faces: an array of shape (m, k) where all have k corners, else a list of lists."""
        faces = self._core.faces()
        return np.array(faces, dtype=np.int64) if len({len(face) for face in faces}) == 1 else faces

    @property
    def creases(self) -> List[Tuple[int, int, float]]:
        """Sharp edges: both ends, the lower first, and the sharpness."""
        return self._core.tags()[0]

    @property
    def corners(self) -> List[Tuple[int, float]]:
        """Sharp vertices, and their sharpness."""
        return self._core.tags()[1]

    @property
    def sectors(self) -> List[Tuple[int, int, float, float]]:
        """Sectors at corners: vertex, first neighbour, angle, flatness."""
        return self._core.tags()[2]

    @property
    def scheme(self) -> str:
        """ "loop" or "catmull-clark"."""
        return self._core.scheme()[0]

    @property
    def rules(self) -> Optional[str]:
        """Weights of Loop's scheme; ``None`` under the other."""
        return self._core.scheme()[1]

    @property
    def is_closed(self) -> bool:
        """Whether it has no border; only such cages bound solids."""
        return self._core.counts()[2]

    @property
    def levels(self) -> int:
        """Levels of details, which booleans add when asked to (``details``); OBJ cannot hold them."""
        return self._core.levels()

    @property
    def report(self) -> Optional[CageReport]:
        """How near the result of a boolean is to the exact one; ``None`` of a cage that is no result."""
        return self._report

    def refine(self, times: int = 1, **limits: "Unpack[Limits]") -> Cage:
        """After so many subdivisions: more control points, the same surface. Of a cage with details until it has none, at least."""
        return self._of(self._core.refined(_index(times), settings(limits, limits_only=True)))

    def limit_mesh(
        self, tolerance: Optional[float] = None, *, refine: Optional[int] = None, **limits: "Unpack[Limits]"
    ) -> Mesh:
        """The limit surface as triangles, vertices on it.

        Parameters
        ----------
        tolerance : float
            How far triangles may be from it, in units of the coordinates; a thousandth of the cage's diagonal by default.
        refine : int
            In its place: every face is split so many times.
        """
        steps = None if refine is None else _index(refine)
        within = self._diagonal() / 1000 if tolerance is None else float(tolerance)
        mesh: Mesh = Mesh._wrap(self._core.limit_mesh(within, steps, settings(limits, limits_only=True)))
        return mesh

    def solid(
        self, tolerance: Optional[float] = None, *, refine: Optional[int] = None, **limits: "Unpack[Limits]"
    ) -> Solid:
        """The same as an operand of exact booleans. The cage must have no border."""
        return Solid(self.limit_mesh(tolerance, refine=refine, **limits), **limits)

    def mesh(self) -> Mesh:
        """The cage itself as a mesh, its polygons triangulated."""
        mesh: Mesh = Mesh._wrap(self._core.mesh())
        return mesh

    def with_creases(self, degrees: float) -> Cage:
        """With creases at all edges where faces meet at more than so many degrees."""
        return self._of(self._core.creased(float(degrees)))

    def translated(self, offset: Sequence[float]) -> Cage:
        """Moved by an offset, in units of the coordinates."""
        return self._of(self._core.moved("translate", _three(offset, "an offset")))

    def scaled(self, factors: Union[float, Sequence[float]]) -> Cage:
        """Scaled about the origin, by one factor or by one for each axis."""
        three = [factors] * 3 if np.isscalar(factors) else factors
        return self._of(self._core.moved("scale", _three(three, "factors")))

    def rotated(self, axis: str, degrees: float) -> Cage:
        """Turned about an axis through the origin ("x", "y" or "z"), counter-clockwise."""
        if axis not in ("x", "y", "z"):
            raise ArgumentError(f"an axis is 'x', 'y' or 'z', not {axis!r}")
        return self._of(self._core.moved("rotate", [float(degrees) * (axis == name) for name in "xyz"]))

    def transformed(self, matrix: ArrayLike) -> Cage:
        """Moved by a matrix of shape (3, 4) or (4, 4)."""
        numbers = np.asarray(matrix, dtype=np.float64)
        if numbers.shape not in ((3, 4), (4, 4)):
            raise ArgumentError(f"a matrix has the shape (3, 4) or (4, 4), not {numbers.shape}")
        return self._of(self._core.moved("matrix", numbers.reshape(-1).tolist()))

    def _diagonal(self) -> float:
        points = self.vertices
        length = float(np.linalg.norm(points.max(axis=0) - points.min(axis=0))) if len(points) else 0.0
        return length if length > 0 else 1.0

    def __or__(self, other: Any) -> Cage:
        return self._combined("union", other)

    def __and__(self, other: Any) -> Cage:
        return self._combined("intersection", other)

    def __sub__(self, other: Any) -> Cage:
        return self._combined("difference", other)

    def _combined(self, operation: str, other: Any) -> Cage:
        return combine_cages(operation, self, other).cage if isinstance(other, Cage) else NotImplemented

    def __eq__(self, other: object) -> bool:
        return self._core.json() == other._core.json() if isinstance(other, Cage) else NotImplemented

    def __hash__(self) -> int:
        return hash(self._core.json())

    def __copy__(self) -> Cage:
        return self

    def __deepcopy__(self, memo: Any) -> Cage:
        return self

    def __reduce__(self) -> Any:
        return (_cage_of_json, (self._core.json(), self._report))

    def __repr__(self) -> str:
        points, faces, _ = self._core.counts()
        return f"<trisect.Cage: {points} control points, {faces} faces, {self.scheme}>"


@dataclass(frozen=True)
class CombinedCages:
    """The result of a boolean of cages."""

    cage: Cage
    """The cage. Away from the intersection curve its control points are the operands', bit for bit; the curve is a crease of it."""
    exact: Solid
    """The exact boolean of the limit surfaces as triangles, which the cage's surface is near to."""
    report: CageReport
    """How near, and what was done."""
    origins: PointOrigins
    """Where control points come from."""


def combine_cages(
    operation: str,
    *cages: Any,
    tolerance: Optional[float] = None,
    refine: int = 0,
    attempts: Optional[int] = None,
    rings: int = 2,
    details: int = 0,
    allow_tangent: bool = False,
    **limits: "Unpack[Limits]",
) -> CombinedCages:
    """A boolean of cages ("union", "intersection" or "difference"; any number of them, or one list) whose result is a cage.

    >>> import trisect
    >>> ball = trisect.icosphere(1.0, level=1)
    >>> a = trisect.Cage(ball.vertices, ball.faces)
    >>> both = trisect.combine_cages("union", a, a.translated([0.9, 0.1, 0.2]), tolerance=0.05)
    >>> both.report.reached, both.report.errors.largest < 0.05, both.exact.is_manifold
    (True, True, True)

    Cages of polygons are fitted by cages of triangles first, within half of the tolerance, which is a :class:`TrisectWarning`; so is
    what is worth knowing of the result.

    Parameters
    ----------
    tolerance : float
        How far the cage's surface may be from the exact result, in units of the coordinates; a thousandth of the diagonal by default.
    refine : int
        Faces beside the curve are halved so many times at first.
    attempts : int
        And so many times more at most while the tolerance is not reached: 2 by default, 0 with ``details``.
    rings : int
        How many rings of control points around what changed may move.
    details : int
        Levels of details that are added at most, up to 4: displacements of subdivided vertices.
    allow_tangent : bool
        Whether surfaces that nearly touch along their curve are taken.

    Raises
    ------
    GeometryError, MeshError, ArgumentError
    """
    given: Dict[str, Any] = {"refine": _index(refine), "rings": _index(rings), "details": _index(details)}
    given["allow_tangent"] = bool(allow_tangent)
    if tolerance is not None:
        given["tolerance"] = float(tolerance)
    if attempts is not None:
        given["attempts"] = _index(attempts)
    listed = list(cages[0]) if len(cages) == 1 and not isinstance(cages[0], Cage) else list(cages)
    for number, cage in enumerate(listed, 1):
        if not isinstance(cage, Cage):
            raise TypeError(f"operand {number} is a {type(cage).__name__}, and no cage")
    cores = [cage._core for cage in listed]
    made = _trisect.combine_cages(operation, cores, given, settings(limits, limits_only=True))
    core, exact, text, origins, distances = made
    report = CageReport.of(json.loads(text))
    for number, (cage, distance) in enumerate(zip(listed, distances), 1):
        if cage.scheme != "loop":
            said = f"its polygons became triangles, fitted to the Catmull-Clark surface within {distance:.3g}"
            _warn([said], f"operand {number}")
    _warn(report.warnings, "the result")
    return CombinedCages(Cage._of(core, report), Solid._of(exact), report, PointOrigins(*origins))


def _cage_of_json(text: str, report: Optional[CageReport]) -> Cage:
    """Unpickles a cage."""
    return Cage._of(_trisect.Cage.of_bytes("json", text.encode())[0], report)


def _warn(warned: Sequence[str], what: str) -> None:
    for text in warned:
        warnings.warn(f"{what}: {text}", TrisectWarning, stacklevel=3)


def _rows(faces: Any, count: int) -> List[List[int]]:
    """Faces as lists of vertices that are there."""
    rows = [[_index(corner) for corner in face] for face in (faces.tolist() if isinstance(faces, np.ndarray) else faces)]
    for number, row in enumerate(rows):
        for corner in row:
            if corner >= count:
                raise ArgumentError(f"face {number} names vertex {corner}, but vertices are counted from 0 to {count} (exclusive)")
    return rows


def _sharpness(row: Sequence[float], place: int) -> float:
    return float(row[place]) if len(row) > place else math.inf


def _index(given: Any) -> int:
    number = int(given)
    if number != given or not 0 <= number < 1 << 32:
        raise ArgumentError(f"numbers of vertices, and how often something is done, are whole and from 0 on, not {given!r}")
    return number
