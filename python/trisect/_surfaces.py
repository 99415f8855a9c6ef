"""``Solid``, a closed surface, and ``Mesh``, one without promises."""

from __future__ import annotations

import base64
import json
import os
import warnings
from typing import Any, Dict, Iterator, List, Mapping, NamedTuple, Optional, Sequence, Tuple, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _arrays, _convert, _trisect
from ._errors import ArgumentError, TrisectWarning
from ._records import Certificate, Cleaning, Diagnosis, Extraction, Mending, SelfCrossings
from ._settings import Limits, Settings, settings

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing_extensions import Unpack

SolidLike = Any
"""A :class:`Solid`, or what one can be made of: a ``trimesh.Trimesh`` or ``Scene``, a ``pyvista.PolyData``, a mesh of ``open3d``, a
``manifold3d.Manifold``, a path to a mesh file, a pair of arrays (vertices, faces), or anything with ``vertices`` and ``faces``."""

NO_VALUE = 0xFFFFFFFF
"""In :attr:`Attribute.corners`: the corner has no value."""

# Holes of any size: more edges than a mesh can have.
_ANY_HOLE = (1 << 32) - 1


class Attribute(NamedTuple):
    """Values at the corners of faces: texture coordinates, normals, colours, whatever is interpolated along a surface."""

    values: NDArray[np.float64]
    """The table, of shape (k, c): c numbers to a value."""
    corners: NDArray[np.uint32]
    """For every face the rows that its three corners have, of shape (m, 3); ``NO_VALUE`` for none."""

    def at_corners(self) -> NDArray[np.float64]:
        """The values at every corner, of shape (m, 3, c); NaN where there is none."""
        padded = np.vstack([self.values, np.full((1, self.values.shape[1]), np.nan)])
        return padded[np.minimum(self.corners, len(self.values))]


class Groups(NamedTuple):
    """Named sets of faces."""

    names: List[str]
    """Their names."""
    of_face: NDArray[np.uint32]
    """For every face the number of its group, of shape (m,); empty if there are no groups."""


class Origins(NamedTuple):
    """Where the faces of a result come from: three arrays of shape (m,)."""

    operand: NDArray[np.uint32]
    """The place of the operand in the call, from 0."""
    face: NDArray[np.uint32]
    """The face of that operand; where faces of one plane were merged, one of them."""
    reversed: NDArray[np.bool_]
    """Whether it faces the other way: what a tool has cut."""


class _Surface:
    """What meshes and solids have in common."""

    __slots__ = ("_core", "_vertices", "_faces", "__weakref__")
    _core: Any
    _vertices: Optional[NDArray[np.float64]]
    _faces: Optional[NDArray[np.uint32]]

    @classmethod
    def _wrap(cls, core: Any) -> Any:
        surface = cls.__new__(cls)
        surface._core = core
        surface._vertices = surface._faces = None
        return surface

    @property
    def vertices(self) -> NDArray[np.float64]:
        """Coordinates, of shape (n, 3): a read-only view of the surface's own memory."""
        if self._vertices is None:
            self._vertices = np.asarray(self._core.view("vertices"))
        return self._vertices

    @property
    def faces(self) -> NDArray[np.uint32]:
        """Triangles as vertex indices, counter-clockwise seen from outside, of shape (m, 3): a read-only view."""
        if self._faces is None:
            self._faces = np.asarray(self._core.view("faces"))
        return self._faces

    @property
    def attributes(self) -> Dict[str, Attribute]:
        """Values at corners by name, as glTF calls them (``NORMAL``, ``TEXCOORD_0``, ``COLOR_0``) or with an underscore."""
        view = self._core.view
        return {
            name: Attribute(np.asarray(view("values", i)), np.asarray(view("corners", i)))
            for i, name in enumerate(self._core.attributes())
        }

    @property
    def groups(self) -> Groups:
        """Named sets of faces."""
        names = [group["name"] for group in json.loads(self._core.groups())]
        return Groups(names, np.asarray(self._core.view("groups")).reshape(-1))

    @property
    def area(self) -> float:
        """The area of the surface, in squared units of the coordinates."""
        return float(self._core.area())

    def _warn(self, warned: Sequence[str], what: Any) -> None:
        for text in warned:
            warnings.warn(f"{what}: {text}", TrisectWarning, stacklevel=3)

    @staticmethod
    def _write_options(ascii: bool, single: bool, manifold: bool, separate: bool) -> Optional[Dict[str, bool]]:
        given = {"ascii": ascii, "single": single, "manifold": manifold, "separate": separate}
        return {key: True for key, wanted in given.items() if wanted} or None

    def __copy__(self) -> Any:
        return self

    def __deepcopy__(self, memo: Any) -> Any:
        return self

    def _surface(self) -> _trisect.Surface:
        raise NotImplementedError

    @staticmethod
    def _table(name: str, values: ArrayLike, corners: Optional[ArrayLike], surface: _trisect.Surface) -> _trisect.Surface:
        """A surface with an attribute more."""
        table = np.asarray(values, dtype=np.float64)
        count = surface.counts()[1]
        if corners is not None:
            rows = np.asarray(corners)
            if rows.shape != (count, 3) or rows.dtype.kind not in "iu":
                raise ArgumentError(f"corners must be integers of shape ({count}, 3), not {rows.dtype} of {rows.shape}")
            if rows.size and not 0 <= rows.min() <= rows.max() <= NO_VALUE:
                raise ArgumentError(f"corners must be rows of the table, or {NO_VALUE} for none, not {rows.min()} to {rows.max()}")
        elif table.ndim == 3 and table.shape[:2] == (count, 3):
            table = table.reshape(3 * count, table.shape[2])
            rows = np.arange(3 * count).reshape(-1, 3)
        elif table.ndim == 2 and table.shape[0] == surface.counts()[0]:
            rows = np.asarray(surface.view("faces"))
        else:
            raise ArgumentError(
                f"values must be of shape (n, c), one row for each of the {surface.counts()[0]} vertices, or ({count}, 3, c), "
                f"not {table.shape}; or tell by corners which row each corner has"
            )
        if table.ndim != 2:
            raise ArgumentError(f"values must be of shape (k, c), not {table.shape}")
        table, rows = np.require(table, np.float64, ["C", "A"]), np.require(rows, np.uint32, ["C", "A"])
        return surface.with_attribute(name, table, rows)


class Mesh(_Surface):
    """A triangle mesh without promises: it may be open, turned, or damaged. Immutable.

    >>> import trisect
    >>> square = trisect.Mesh([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], [[0, 1, 2, 3]])
    >>> square.faces.tolist(), square.area, len(square.open_edges())
    ([[0, 1, 2], [0, 2, 3]], 1.0, 4)

    Parameters
    ----------
    vertices : array-like of shape (n, 3), or any mesh
        Coordinates; ``float32`` and ``float64`` are read as they are. Or a mesh of another package, or a path.
    faces : array-like of integers of shape (m, 3), or rows of three corners or more
        Triangles, quads or polygons as vertex indices, counter-clockwise seen from outside. Polygons are triangulated.
    """

    __slots__ = ()

    def __init__(self, vertices: Any, faces: Any = None) -> None:
        self._vertices = self._faces = None
        self._core = _surface_of(vertices, faces)

    @classmethod
    def load(cls, path: Union[str, "os.PathLike[str]"], part: Optional[str] = None, **limits: "Unpack[Limits]") -> Mesh:
        """Reads a mesh file: OBJ, glTF (also compressed by Draco), STL, PLY, OFF or 3MF, by content and name.

        ``part`` is the name of a part of the file, or a pattern (``"wheel/*"``); so is what follows ``#`` in a path. What the
        reader has to say is a :class:`~trisect.TrisectWarning`.
        """
        core, warned = _convert.load(path, part, settings(limits, limits_only=True))
        mesh: Mesh = cls._wrap(core)
        mesh._warn(warned, os.fspath(path))
        return mesh

    def save(
        self,
        path: Union[str, "os.PathLike[str]"],
        *,
        ascii: bool = False,
        single: bool = False,
        manifold: bool = False,
        separate: bool = False,
    ) -> None:
        """Writes a mesh file; see :meth:`Solid.save`."""
        options = self._write_options(ascii, single, manifold, separate)
        self._warn(_trisect.save_mesh(self._core, os.fspath(path), options), os.fspath(path))

    def diagnosis(self, **limits: "Unpack[Limits]") -> Diagnosis:
        """All that is wrong with it as a surface."""
        found, text = self._core.diagnosis(settings(limits, limits_only=True))
        return Diagnosis.of({**json.loads(found), "text": text})

    def open_edges(self) -> NDArray[np.int64]:
        """The edges that have a face on one side only, as vertices in the direction of their face: shape (k, 2). Vertices with
        equal coordinates count as one."""
        _, same = np.unique(self.vertices + 0.0, axis=0, return_inverse=True)
        corners = self.faces.astype(np.int64)
        edges = np.concatenate([corners[:, [k, (k + 1) % 3]] for k in range(3)])
        ends = np.asarray(same).reshape(-1)[edges]
        low, high = ends.min(axis=1), ends.max(axis=1)
        number = low * np.int64(len(self.vertices) + 1) + high
        _, which = np.unique(number, return_inverse=True)
        which = np.asarray(which).reshape(-1)
        balance = np.bincount(which, weights=np.where(ends[:, 0] == low, 1, -1))
        open_ones = (balance[which] != 0) & (low != high)
        found: NDArray[np.int64] = edges[open_ones]
        return found

    def with_attribute(self, name: str, values: ArrayLike, corners: Optional[ArrayLike] = None) -> Mesh:
        """The same with an attribute; see :meth:`Solid.with_attribute`."""
        mesh: Mesh = Mesh._wrap(self._table(name, values, corners, self._core))
        return mesh

    def _surface(self) -> _trisect.Surface:
        core: _trisect.Surface = self._core
        return core

    def __reduce__(self) -> Any:
        return (_mesh_of_parts, (self.vertices, self.faces, self._core.parts()))

    def __repr__(self) -> str:
        vertices, faces = self._core.counts()
        return f"<trisect.Mesh: {vertices} vertices, {faces} faces>"


class Solid(_Surface):
    """A closed triangle mesh: what booleans take and give. Immutable.

    >>> import numpy as np
    >>> import trisect
    >>> corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], dtype=float)
    >>> solid = trisect.Solid(corners, [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
    >>> round(solid.volume, 12), solid.bounds.tolist()
    (0.166666666667, [[0.0, 0.0, 0.0], [1.0, 1.0, 1.0]])
    >>> solid | solid.translated([2, 0, 0])
    <trisect.Solid: 8 vertices, 8 faces, volume 0.333333>

    The arguments are those of :class:`Mesh`. What is mended is certain (seams a rounding apart, vertices in the middle of edges,
    copies, fins); :attr:`mending` tells. More is done only when asked for:

    Parameters
    ----------
    weld : float or "auto"
        Vertices of open edges no further apart than this, in units of the coordinates, are made one; "auto": the least distance
        that closes the surface, up to a thousandth of its size.
    orient : bool
        Faces are turned to bound what the surface encloses.
    closed_parts : bool
        Parts that are not closed are left out, if others are closed.
    fill_holes : bool or int
        Holes (of up to so many edges) are filled with the smallest surface.
    refine_holes : bool
        What fills holes gets vertices of its own and is bent on like the surface around; fills all of them if ``fill_holes`` is not given.
    single_shells : bool
        Further copies of a shell are left out.
    as_is : bool
        The mesh must be closed as it is: nothing is mended.

    Raises
    ------
    NotClosedError, InsideOutError, IndexOutOfRangeError, NotFiniteError, ArgumentError
    """

    __slots__ = ()

    def __init__(
        self,
        vertices: Any,
        faces: Any = None,
        *,
        weld: Union[float, str, None] = None,
        orient: bool = False,
        closed_parts: bool = False,
        fill_holes: Union[bool, int] = False,
        refine_holes: bool = False,
        single_shells: bool = False,
        as_is: bool = False,
        **limits: "Unpack[Limits]",
    ) -> None:
        self._vertices = self._faces = None
        options = _gate_options(weld, orient, closed_parts, fill_holes, single_shells, as_is, refine_holes)
        given = settings(limits, limits_only=True)
        if isinstance(vertices, Solid) and faces is None:
            self._core = vertices._core if options is None else _passed(vertices._surface(), options, given)
        elif faces is not None:
            corners, sizes = _arrays.faces(faces)
            self._core = _trisect.Core.of_arrays(_arrays.points(vertices), corners, sizes, options, given)
        else:
            self._core = _passed(_surface_of(vertices, None), options, given)

    @classmethod
    def load(
        cls,
        path: Union[str, "os.PathLike[str]"],
        part: Optional[str] = None,
        *,
        weld: Union[float, str, None] = None,
        orient: bool = False,
        closed_parts: bool = False,
        fill_holes: Union[bool, int] = False,
        refine_holes: bool = False,
        single_shells: bool = False,
        as_is: bool = False,
        **limits: "Unpack[Limits]",
    ) -> Solid:
        """Reads a mesh file and makes a solid of it; see :class:`Solid` for the arguments, and :meth:`Mesh.load` for the formats."""
        options = _gate_options(weld, orient, closed_parts, fill_holes, single_shells, as_is, refine_holes)
        given = settings(limits, limits_only=True)
        surface, warned = _convert.load(path, part, given)
        solid: Solid = cls._wrap(_passed(surface, options, given))
        solid._warn(warned, os.fspath(path))
        return solid

    @classmethod
    def empty(cls) -> Solid:
        """The solid without faces."""
        return cls(np.zeros((0, 3)), np.zeros((0, 3), dtype=np.int64))

    def save(
        self,
        path: Union[str, "os.PathLike[str]"],
        *,
        ascii: bool = False,
        single: bool = False,
        manifold: bool = False,
        separate: bool = False,
    ) -> None:
        """Writes a mesh file in the format of the name: ``.obj``, ``.glb``, ``.gltf``, ``.stl``, ``.ply``, ``.off``,
        ``.3mf``.

        The file appears whole or not at all. What the format cannot keep is a :class:`~trisect.TrisectWarning`: binary STL and glTF
        have single precision. ``ascii`` is for STL and PLY, ``single`` for the precision of the others, ``manifold`` and
        ``separate`` are for glTF.
        """
        options = self._write_options(ascii, single, manifold, separate)
        self._warn(_trisect.save_solid(self._core, os.fspath(path), options), os.fspath(path))

    # Measures

    @property
    def volume(self) -> float:
        """The enclosed volume, in cubed units of the coordinates."""
        return float(self._core.volume())

    @property
    def bounds(self) -> NDArray[np.float64]:
        """Low and high corner of the smallest box, of shape (2, 3); NaN if the solid is empty."""
        bounds = self._core.bounds()
        return np.full((2, 3), np.nan) if bounds is None else np.array(bounds)

    @property
    def centroid(self) -> NDArray[np.float64]:
        """The centre of mass, of shape (3,); NaN if there is none."""
        centroid = self._core.centroid()
        return np.full(3, np.nan) if centroid is None else np.array(centroid)

    @property
    def is_empty(self) -> bool:
        """Whether there are no faces. So does ``bool(solid)`` tell, the other way round: ``if a & b:``."""
        return bool(self._core.counts()[1] == 0)

    @property
    def is_manifold(self) -> bool:
        """Whether every edge has two faces, and every vertex one fan of them."""
        return bool(self._core.topology()[0])

    @property
    def components(self) -> int:
        """Pieces of the surface, connected by edges."""
        return int(self._core.topology()[1])

    @property
    def euler_characteristic(self) -> int:
        """Vertices minus edges plus faces."""
        return int(self._core.topology()[2])

    @property
    def genus(self) -> Optional[int]:
        """The number of handles; ``None`` if some edge has more than two faces."""
        genus = self._core.topology()[3]
        return None if genus is None else int(genus)

    # What is known of it

    @property
    def is_result(self) -> bool:
        """Whether it is the result of an operation, with ``origins``, ``curves`` and a ``certificate``."""
        return bool(self._core.is_result())

    @property
    def certificate(self) -> Certificate:
        """What a result is, and what making it met. Computed when asked for."""
        return Certificate.of(json.loads(self._core.certificate()))

    @property
    def origins(self) -> Origins:
        """Where the faces of a result come from."""
        return Origins(*self._core.origins())

    @property
    def curves(self) -> List[NDArray[np.uint32]]:
        """Where surfaces of different operands meet in a result: chains of vertices; a closed one ends with its first."""
        curves: List[NDArray[np.uint32]] = self._core.curves()
        return curves

    @property
    def sources(self) -> NDArray[np.uint32]:
        """For every face the one it was (or is a piece of) in the triangles the solid was made of, of shape (m,)."""
        sources: NDArray[np.uint32] = self._core.sources()
        return sources

    @property
    def mending(self) -> Mending:
        """What was mended when the solid was made; false if nothing was."""
        _, mending, text = self._core.mending()
        data = json.loads(mending)
        return Mending.of({**data, "text": text if _anything(data) else ""})

    @property
    def cleaning(self) -> Cleaning:
        """What was left out or joined when the solid was made; false if nothing was."""
        return Cleaning.of(json.loads(self._core.mending()[0]))

    @property
    def extraction(self) -> Optional[Extraction]:
        """How well the surface follows the field it was extracted from (``Field.solid``, a model that is a field); ``None`` if from none."""
        report = self._core.extraction()
        return None if report is None else Extraction.of(json.loads(report))

    def self_crossings(self, **limits: "Unpack[Limits]") -> SelfCrossings:
        """Where the surface crosses itself; false if nowhere. Remembered."""
        found = self._core.self_crossings(settings(limits, limits_only=True))
        return SelfCrossings.of(json.loads(found))

    # Changed copies

    def translated(self, offset: Sequence[float]) -> Solid:
        """Moved by an offset, in units of the coordinates."""
        return self._of(self._core.translated(_three(offset, "an offset")))

    def scaled(self, factors: Union[float, Sequence[float]]) -> Solid:
        """Scaled about the origin, by one factor or by one for each axis."""
        three = [factors] * 3 if np.isscalar(factors) else factors
        return self._of(self._core.scaled(_three(three, "factors")))

    def rotated(self, axis: Union[str, Sequence[float]], degrees: float) -> Solid:
        """Turned about an axis through the origin ("x", "y", "z" or a vector), counter-clockwise; by quarter turns exactly."""
        if isinstance(axis, str):
            if axis not in ("x", "y", "z"):
                raise ArgumentError(f"an axis is 'x', 'y', 'z' or a vector, not {axis!r}")
            axis = [float(axis == name) for name in "xyz"]
        return self._of(self._core.rotated(_three(axis, "an axis"), float(degrees)))

    def transformed(self, matrix: ArrayLike) -> Solid:
        """Moved by a matrix of shape (3, 4) or (4, 4). Mirrored, it still faces outwards."""
        numbers = np.asarray(matrix, dtype=np.float64)
        if numbers.shape not in ((3, 4), (4, 4)):
            raise ArgumentError(f"a matrix has the shape (3, 4) or (4, 4), not {numbers.shape}")
        return self._of(self._core.transformed(numbers.reshape(-1).tolist()))

    def with_attribute(self, name: str, values: ArrayLike, corners: Optional[ArrayLike] = None) -> Solid:
        """The same with an attribute, which operations carry along.

        Parameters
        ----------
        name : str
            A name of glTF, or one with an underscore (``"_TEMPERATURE"``).
        values : array-like
            Of shape (n, c), a row for each vertex; (m, 3, c), a row for each corner; or (k, c), any table, with ``corners``.
        corners : array-like of integers of shape (m, 3)
            The row of the table that each corner has.
        """
        return self._of(_passed(self._table(name, values, corners, self._surface()), {"as_is": True}, None))

    def with_groups(self, names: Sequence[str], of_face: ArrayLike) -> Solid:
        """The same with named sets of faces: ``of_face`` has the number of a name for every face."""
        numbers = np.asarray(of_face)
        listed, count = list(names), self._core.counts()[1]
        fits = numbers.dtype.kind in "iu" and numbers.shape == (count,)
        if not fits or (numbers < 0).any() or (numbers >= len(listed)).any():
            raise ArgumentError(f"of_face must have the number of a group for each of {count} faces")
        surface = self._surface().with_groups(listed, numbers.tolist())
        return self._of(_passed(surface, {"as_is": True}, None))

    def bodies(self) -> List[Solid]:
        """The bodies it consists of, each with its cavities."""
        return [self._of(core) for core in self._core.bodies()]

    def mesh(self) -> Mesh:
        """A copy as a mesh without promises."""
        mesh: Mesh = Mesh._wrap(self._core.surface())
        return mesh

    # Operators

    def __or__(self, other: SolidLike) -> Solid:
        return self._combined("union", other, False)

    def __ror__(self, other: SolidLike) -> Solid:
        return self._combined("union", other, True)

    def __and__(self, other: SolidLike) -> Solid:
        return self._combined("intersection", other, False)

    def __rand__(self, other: SolidLike) -> Solid:
        return self._combined("intersection", other, True)

    def __sub__(self, other: SolidLike) -> Solid:
        return self._combined("difference", other, False)

    def __rsub__(self, other: SolidLike) -> Solid:
        return self._combined("difference", other, True)

    def __xor__(self, other: SolidLike) -> Solid:
        return self._combined("xor", other, False)

    def __rxor__(self, other: SolidLike) -> Solid:
        return self._combined("xor", other, True)

    def _combined(self, operation: str, other: SolidLike, turned: bool) -> Solid:
        core = core_of(other)
        if core is None:
            return NotImplemented  # type: ignore[no-any-return]
        operands = [core, self._core] if turned else [self._core, core]
        return self._of(_trisect.combine(operation, operands))

    @staticmethod
    def _of(core: Any) -> Solid:
        solid: Solid = Solid._wrap(core)
        return solid

    def union(self, *others: SolidLike, **given: "Unpack[Settings]") -> Solid:
        """What is in this or in any of the others; see :func:`trisect.union`."""
        return _run("union", (self, *others), given)

    def intersection(self, *others: SolidLike, **given: "Unpack[Settings]") -> Solid:
        """What is in this and in all of the others; see :func:`trisect.intersection`."""
        return _run("intersection", (self, *others), given)

    def difference(self, *others: SolidLike, **given: "Unpack[Settings]") -> Solid:
        """What is in this and in none of the others; see :func:`trisect.difference`."""
        return _run("difference", (self, *others), given)

    # Other packages

    def to_trimesh(self) -> Any:
        """A ``trimesh.Trimesh`` with copies of the arrays, unprocessed."""
        import trimesh

        return trimesh.Trimesh(self.vertices.copy(), self.faces.astype(np.int64), process=False)

    def to_pyvista(self) -> Any:
        """A ``pyvista.PolyData`` with copies of the arrays."""
        import pyvista

        count = self._core.counts()[1]
        padded = np.full((count, 4), 3, dtype=np.int64)
        padded[:, 1:] = self.faces
        return pyvista.PolyData(self.vertices.copy(), padded.reshape(-1))

    def to_open3d(self) -> Any:
        """An ``open3d.geometry.TriangleMesh``."""
        import open3d

        vertices = open3d.utility.Vector3dVector(self.vertices)
        return open3d.geometry.TriangleMesh(vertices, open3d.utility.Vector3iVector(self.faces.astype(np.int32)))

    # What Python asks for

    def _surface(self) -> _trisect.Surface:
        surface: _trisect.Surface = self._core.surface()
        return surface

    def __bool__(self) -> bool:
        return not self.is_empty

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Solid):
            return NotImplemented
        return bool(self._core.equals(other._core))

    def __hash__(self) -> int:
        return hash(self._core.hash())

    def __reduce__(self) -> Any:
        # That it need not be looked through is said of these bits, and believed of no others.
        proof = self._core.hash() if self._core.is_proven_clean() else None
        return (_solid_of_parts, (self.vertices, self.faces, self._core.parts(), proof))

    def __repr__(self) -> str:
        vertices, faces = self._core.counts()
        return f"<trisect.Solid: {vertices} vertices, {faces} faces, volume {self.volume:.6g}>"

    def picture(
        self,
        width: int = 640,
        height: int = 480,
        direction: Sequence[float] = (1.0, -1.2, 0.8),
        by_operand: bool = False,
    ) -> bytes:
        """A shaded picture as the bytes of a PNG file.

        ``direction`` is from the solid towards the eye; ``by_operand`` shows the faces of a result in a colour for each operand,
        in place of their materials.
        """
        colours = by_operand and self.is_result
        png: bytes = _trisect.picture(self._core, int(width), int(height), _three(direction, "a direction"), colours)
        return png

    def _repr_png_(self) -> bytes:
        return self.picture(by_operand=not self.attributes and not self.groups.names)

    def _repr_html_(self) -> str:
        vertices, faces = self._core.counts()
        bounds = "empty"
        if faces:
            bounds = " x ".join(f"{size:.6g}" for size in self.bounds[1] - self.bounds[0])
        rows = {"vertices": vertices, "faces": faces, "volume": f"{self.volume:.9g}", "size": bounds}
        cells = "".join(f"<tr><th>{key}</th><td>{value}</td></tr>" for key, value in rows.items())
        image = base64.b64encode(self._repr_png_()).decode()
        return f'<img alt="trisect.Solid" width="480" src="data:image/png;base64,{image}"><table>{cells}</table>'


def _anything(mending: Mapping[str, Any]) -> bool:
    counts: Iterator[Any] = (value["count"] if isinstance(value, dict) else value for value in mending.values())
    return any(counts)


def _three(given: Any, what: str) -> List[float]:
    numbers = np.asarray(given, dtype=np.float64)
    if numbers.shape != (3,):
        raise ArgumentError(f"{what} has three numbers, not the shape {numbers.shape}")
    listed: List[float] = numbers.tolist()
    return listed


def _gate_options(
    weld: Union[float, str, None],
    orient: bool,
    closed_parts: bool,
    fill_holes: Union[bool, int],
    single_shells: bool,
    as_is: bool,
    refine_holes: bool = False,
) -> Optional[Dict[str, Any]]:
    fill_holes = fill_holes or refine_holes
    if weld is None and not (orient or closed_parts or fill_holes or single_shells or as_is):
        return None
    if isinstance(weld, str) and weld != "auto":
        raise ArgumentError(f"weld is a distance or 'auto', not {weld!r}")
    options: Dict[str, Any] = {"orient": orient, "closed_parts": closed_parts, "single_shells": single_shells, "as_is": as_is}
    if weld is not None:
        options["weld"] = weld
    if refine_holes:
        options["refine_holes"] = True
    if fill_holes:
        options["fill_holes"] = _ANY_HOLE if fill_holes is True else int(fill_holes)
    return {key: bool(value) if isinstance(value, np.bool_) else value for key, value in options.items()}


def _passed(surface: _trisect.Surface, options: Optional[Dict[str, Any]], given: Any) -> _trisect.Core:
    return _trisect.Core.of_mesh(surface, options, given)


def _surface_of(source: Any, faces: Any) -> _trisect.Surface:
    if faces is not None:
        return _convert.of_arrays(source, faces)
    if isinstance(source, _Surface):
        return source._surface()
    found = _convert.surface_of(source)
    if found is None:
        raise TypeError(
            f"a {type(source).__name__} is no mesh: give vertices and faces, a path, or a mesh of trimesh, pyvista, open3d or "
            "manifold3d"
        )
    return found


def core_of(source: SolidLike, limits: Optional[Dict[str, Any]] = None) -> Optional[_trisect.Core]:
    """What stands behind a solid, made under limits of anything that one can be made of; ``None`` for anything else."""
    if isinstance(source, Solid):
        core: _trisect.Core = source._core
        return core
    if isinstance(source, _Surface):
        return _passed(source._surface(), None, limits)
    if isinstance(source, tuple) and len(source) == 2:
        # Read once: a mesh between would be a copy more.
        corners, sizes = _arrays.faces(source[1])
        return _trisect.Core.of_arrays(_arrays.points(source[0]), corners, sizes, None, limits)
    surface = _convert.surface_of(source)
    return None if surface is None else _passed(surface, None, limits)


def _run(operation: str, operands: Tuple[SolidLike, ...], given: Mapping[str, Any]) -> Solid:
    from ._operations import run

    return run(operation, operands, given)


def _solid_of_parts(vertices: Any, faces: Any, parts: Any, proof: Optional[int] = None) -> Solid:
    """Unpickles a solid; ``proof`` is the hash of one that need not be looked through."""
    surface = _trisect.Surface.of_parts(vertices, faces, parts)
    if proof is not None:
        core = _passed(surface, {"as_is": True, "proven_clean": True}, None)
        if core.hash() == proof:
            return Solid._of(core)
    return Solid._of(_passed(surface, {"as_is": True}, None))


def _mesh_of_parts(vertices: Any, faces: Any, parts: Any) -> Mesh:
    """Unpickles a mesh."""
    mesh: Mesh = Mesh._wrap(_trisect.Surface.of_parts(vertices, faces, parts))
    return mesh
