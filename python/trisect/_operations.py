"""Operations on solids."""

from __future__ import annotations

import itertools
import json
import os
import warnings
from dataclasses import dataclass
from typing import Any, Dict, List, Mapping, Optional, Sequence, Tuple, Union

import numpy as np
from numpy.typing import NDArray

from . import _trisect
from ._errors import ArgumentError, Error, InsideOutError, MeshError, NotClosedError, TrisectWarning
from ._files import ending, write_text
from ._records import Diagnosis, SelfCrossings
from ._settings import _SETTINGS, Limits, Settings, settings
from ._surfaces import _ANY_HOLE, Mesh, Solid, SolidLike, _passed, _surface_of, _three, core_of

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing_extensions import Unpack

PlaneLike = Union[str, Tuple[str, float], Tuple[Sequence[float], float], Sequence[float], Sequence[Sequence[float]]]
"""A plane: ``"z=12.5"``, ``("z", 12.5)``, a normal and an offset ``((1, 1, 0), 3.0)`` (all x with normal . x = offset), their four
numbers, or three points. Above is where the normal points, or from where the points run counter-clockwise."""


def _core(operand: SolidLike, place: int, count: int, limits: Optional[Dict[str, Any]] = None) -> _trisect.Core:
    try:
        core = core_of(operand, limits)
    except Error as error:
        if error.operand is None:
            error.operand = error._data["operand"] = place
            if count > 1:
                error._message = f"operand {place + 1}: {error._message}"
        raise
    if core is None:
        raise TypeError(f"operand {place + 1} is a {type(operand).__name__}, and no solid can be made of that")
    return core


_OF_OPERANDS = ("deadline", "memory", "threads")


def _limits_of(given: Optional[Dict[str, Any]]) -> Optional[Dict[str, Any]]:
    """What of a call's settings is for making solids of its operands too."""
    return {key: given[key] for key in _OF_OPERANDS if key in given} or None if given else None


def cores(operands: Sequence[SolidLike], given: Optional[Dict[str, Any]] = None) -> List[_trisect.Core]:
    """What stands behind operands; a single list of operands is opened. Settings of the call hold for making solids of them."""
    listed: Sequence[Any] = operands
    if len(operands) == 1 and _is_list(operands[0]):
        listed = list(operands[0])
    limits = _limits_of(given)
    return [_core(operand, place, len(listed), limits) for place, operand in enumerate(listed)]


def _is_list(operand: Any) -> bool:
    if isinstance(operand, tuple):
        # Two arrays are a solid.
        return not (len(operand) == 2 and not any(hasattr(item, "faces") or isinstance(item, (str, os.PathLike, Solid)) for item in operand))
    return isinstance(operand, (list, set, frozenset)) or hasattr(operand, "__next__")


def run(operation: str, operands: Sequence[SolidLike], given: Mapping[str, Any]) -> Solid:
    """One operation."""
    made = settings(given)
    return Solid._of(_trisect.combine(operation, cores(operands, made), made))


def union(*operands: SolidLike, **given: "Unpack[Settings]") -> Solid:
    """What is in any of the operands; one list of them will do.

    >>> import trisect
    >>> trisect.union([trisect.cuboid([0.5 * i, 0, 0], [0.5 * i + 1, 1, 1]) for i in range(4)]).volume
    2.5

    Keywords are those of :class:`~trisect.Settings`: limits, threads, progress, what is inside, what is snapped.
    """
    return run("union", operands, given)


def intersection(*operands: SolidLike, **given: "Unpack[Settings]") -> Solid:
    """What is in all of the operands. Keywords as for :func:`union`.

    >>> import trisect
    >>> trisect.intersection(trisect.cuboid([0, 0, 0], [2, 2, 2]), trisect.cuboid([1, 1, 1], [3, 3, 3])).volume
    1.0
    """
    return run("intersection", operands, given)


def difference(*operands: SolidLike, **given: "Unpack[Settings]") -> Solid:
    """What is in the first operand and in none of the others. Keywords as for :func:`union`.

    >>> import trisect
    >>> trisect.difference(trisect.cuboid([0, 0, 0], [2, 2, 2]), trisect.cuboid([1, 1, 1], [3, 3, 3])).volume
    7.0
    """
    return run("difference", operands, given)


def xor(*operands: SolidLike, **given: "Unpack[Settings]") -> Solid:
    """What is in an odd number of the operands. Keywords as for :func:`union`.

    >>> import trisect
    >>> trisect.xor(trisect.cuboid([0, 0, 0], [2, 2, 2]), trisect.cuboid([1, 1, 1], [3, 3, 3])).volume
    14.0
    """
    return run("xor", operands, given)


def combine(expression: Union[str, Sequence[str]], *operands: SolidLike, **named: Any) -> Any:
    """Any expression of operands, evaluated from all of them at once: nothing is rounded in between.

    >>> import trisect
    >>> box = trisect.cuboid([0, 0, 0], [3, 3, 3])
    >>> pin, slot = trisect.cuboid([1, 1, 1], [2, 2, 2]), trisect.cuboid([2, 2, 2], [4, 4, 4])
    >>> trisect.combine("body - (pin | slot)", body=box, pin=pin, slot=slot).volume
    25.0
    >>> [part.volume for part in trisect.combine(["a - b", "a & b"], box, slot)]
    [26.0, 1.0]

    Operands are called by keywords, or ``a``, ``b``, ``c`` ... where they have none. ``|`` or ``+`` is a union, ``&`` an intersection,
    ``-`` a difference, ``^`` a symmetric difference, and ``atleast(2, a, b, c)`` what is in at least two of three.

    Parameters
    ----------
    expression : str or list of str
        One expression, or several: then results come in a list, and where they meet they have the same vertices.

    Other keywords are those of :class:`~trisect.Settings`; no operand can be called like one of them.
    """
    given = {key: value for key, value in named.items() if key in _SETTINGS}
    named = {key: value for key, value in named.items() if key not in _SETTINGS}
    listed = list(operands[0]) if len(operands) == 1 and _is_list(operands[0]) else list(operands)
    names = list(itertools.islice(_letters(), len(listed)))
    twice = set(names) & set(named)
    if twice:
        raise ArgumentError(f"operands without a name are called {', '.join(names)}: {', '.join(sorted(twice))} is there twice")
    names += named
    listed += named.values()
    texts = [expression] if isinstance(expression, str) else list(expression)
    wanted = settings(given)
    made = cores(listed, wanted) if listed else []
    results = [Solid._of(core) for core in _trisect.evaluate(texts, names, made, wanted)]
    return results[0] if isinstance(expression, str) else results


def _letters() -> Any:
    """a to z, and then a1, b1 and so on."""
    letters = "abcdefghijklmnopqrstuvwxyz"
    for round_ in itertools.count():
        for letter in letters:
            yield letter if round_ == 0 else f"{letter}{round_}"


def resolve(operand: SolidLike, **given: "Unpack[Settings]") -> Solid:
    """What a surface that crosses itself winds around, as one that does not. Keywords as for :func:`union`; ``rule`` says what is
    inside, ``embed=True`` frees the result of crossings that rounding makes.

    >>> import numpy as np
    >>> import trisect
    >>> a, b = trisect.cuboid([0, 0, 0], [1, 1, 1]), trisect.cuboid([0.5, 0.5, 0.5], [1.5, 1.5, 1.5])
    >>> both = trisect.Solid(np.vstack([a.vertices, b.vertices]), np.vstack([a.faces, b.faces + 8]))
    >>> both.volume, trisect.resolve(both).volume, trisect.resolve(both, rule="even-odd").volume
    (2.0, 1.875, 1.75)
    """
    wanted = settings(given)
    [core] = _trisect.evaluate(["a"], ["a"], [_core(operand, 0, 1, _limits_of(wanted))], wanted)
    return Solid._of(core)


def _plane(given: PlaneLike) -> Any:
    """Normal and offset, or three points."""
    try:
        if isinstance(given, str):
            axis, at = given.split("=")
            return _axis(axis.strip()), float(at)
        listed: List[Any] = list(given)
        if len(listed) == 3:
            return [_three(point, "a point of a plane") for point in listed]
        if len(listed) == 2 and isinstance(listed[0], str):
            return _axis(listed[0]), float(listed[1])
        if len(listed) == 2:
            listed = [*listed[0], listed[1]]
        numbers = [float(number) for number in listed]
        if len(numbers) == 4:
            return numbers[:3], numbers[3]
    except (TypeError, ValueError):
        pass
    raise ArgumentError(f"a plane is 'z=1.5', ('z', 1.5), ((nx, ny, nz), offset), four numbers or three points, not {given!r}")


def _axis(name: str) -> List[float]:
    if name not in ("x", "y", "z"):
        raise ValueError(name)
    return [float(name == axis) for axis in "xyz"]


def cut(
    solid: SolidLike, plane: PlaneLike, *, cap: Optional[str] = None, **given: "Unpack[Settings]"
) -> Tuple[Solid, Solid]:
    """What is above a plane and what is below it, both closed by the same faces.

    >>> import trisect
    >>> above, below = trisect.cut(trisect.cuboid([0, 0, 0], [2, 2, 3]), "z=1")
    >>> above.volume, below.volume
    (8.0, 4.0)

    ``plane``: see :data:`PlaneLike`. ``cap`` is the name of a group for the closing faces. In ``origins`` the plane is operand 1.
    """
    above, below = _trisect.cut(_core(solid, 0, 1), _plane(plane), cap, settings(given))
    return Solid._of(above), Solid._of(below)


@dataclass(frozen=True)
class Section:
    """Where a plane meets a solid."""

    normal: Tuple[float, float, float]
    offset: float
    """All points x of the plane have normal . x = offset."""
    area: float
    """In squared units of the coordinates."""
    perimeter: float
    """In units of the coordinates."""
    shapes: List[List[NDArray[np.float64]]]
    """Polygons: an outline, counter-clockwise seen from above, and its holes; each an array of shape (k, 2). Across z the
    coordinates are x and y, across x they are y and z, across y they are z and x."""
    rings: List[List[NDArray[np.float64]]]
    """The same in space, each of shape (k, 3)."""

    def __bool__(self) -> bool:
        return bool(self.shapes)


def sections(
    solid: SolidLike,
    planes: Union[PlaneLike, Sequence[PlaneLike], None] = None,
    *,
    heights: Optional[Any] = None,
    side: str = "inside",
    drawing: Optional[Union[str, "os.PathLike[str]"]] = None,
    **given: "Unpack[Settings]",
) -> List[Section]:
    """Polygons where planes meet a solid, all in one pass.

    >>> import trisect
    >>> [layer.area for layer in trisect.sections(trisect.cuboid([0, 0, 0], [2, 2, 3]), heights=[0.5, 1.5, 4])]
    [4.0, 4.0, 0.0]

    Parameters
    ----------
    planes : plane or list of planes
        See :data:`PlaneLike`.
    heights : array-like of shape (k,)
        In their place: planes across z.
    side : str
        What counts where faces lie in the plane: "inside" (has the solid on both sides), "above" or "below".
    drawing : path
        A file to draw them into, a layer each: ``.svg``, ``.dxf`` or ``.json``.
    """
    if heights is not None:
        listed = [([0.0, 0.0, 1.0], float(height)) for height in np.asarray(heights, dtype=float).reshape(-1)]
    elif planes is None:
        raise ArgumentError("sections need planes or heights")
    else:
        listed = [_plane(plane) for plane in _planes(planes)]
    found = _trisect.sections(_core(solid, 0, 1), listed, side, settings(given))
    made = []
    for plane, (area, perimeter, shapes, rings) in zip(listed, found):
        normal, offset, _ = _trisect.level(plane)
        # (Areas of nothing are not to be negative zeros.)
        made.append(Section((normal[0], normal[1], normal[2]), offset, area + 0.0, perimeter, shapes, rings))
    if drawing is not None:
        _draw(made, listed, os.fspath(drawing))
    return made


def _planes(given: Any) -> Sequence[PlaneLike]:
    if isinstance(given, str):
        return [given]
    listed = list(given)
    try:
        _plane(listed)
    except ArgumentError:
        return listed
    # Two planes across axes look like none: this is one.
    return [listed]


def layer_names(planes: Sequence[PlaneLike]) -> Tuple[List[str], List[float]]:
    """What sections at planes are called in drawings, and their heights there: of planes across an axis their own."""
    levels = [_trisect.level(_plane(plane))[2] for plane in planes]
    names = [f"plane {number}" if level is None else level[0] for number, level in enumerate(levels, 1)]
    return names, [0.0 if level is None else level[1] for level in levels]


def _draw(made: Sequence[Section], planes: Sequence[Any], path: str) -> None:
    layers = []
    for section, name, height in zip(made, *layer_names(planes)):
        layers.append((name, height, [[ring.tolist() for ring in shape] for shape in section.shapes]))
    write_text(path, _trisect.drawing(ending(path), layers))


def split(
    solid: SolidLike, by: Optional[SolidLike] = None, *, sheets: Optional[Sequence[Any]] = None, **given: "Unpack[Settings]"
) -> List[Solid]:
    """The bodies of a solid; or the cells that another one makes of it: what is inside it and what is outside, body by body; or
    the cells between ``sheets``, surfaces that need not be closed but have to pass through it.

    >>> import trisect
    >>> block, wall = trisect.cuboid([0, 0, 0], [5, 1, 1]), trisect.cuboid([2, -1, -1], [3, 2, 2])
    >>> sorted(cell.volume for cell in trisect.split(block, by=wall))
    [1.0, 2.0, 2.0]
    >>> sheet = trisect.Mesh([[1, -1, -1], [1, 2, -1], [1, 2, 2], [1, -1, 2]], [[0, 1, 2, 3]])
    >>> sorted(cell.volume for cell in trisect.split(block, sheets=[sheet]))
    [1.0, 4.0]
    """
    if by is not None and sheets is not None:
        raise ArgumentError("a solid is split by another or by sheets, not by both")
    if sheets is not None:
        surfaces = [_surface_of(sheet, None) for sheet in sheets]
        return [Solid._of(core) for core in _trisect.part(_core(solid, 0, 1), surfaces, settings(given))]
    if by is None:
        return Solid._of(_core(solid, 0, 1)).bodies()
    cells = combine(["a - b", "a & b"], solid, by, **given)
    return [body for cell in cells for body in cell.bodies()]


def trim(surface: Any, by: SolidLike, *, outside: bool = False, **given: "Unpack[Settings]") -> Mesh:
    """What of a surface lies inside a solid, or outside it. The surface need not be closed: a terrain, a scanned skin.

    >>> import trisect
    >>> sheet = trisect.Mesh([[-2, -2, 0], [2, -2, 0], [2, 2, 0], [-2, 2, 0]], [[0, 1, 2, 3]])
    >>> post = trisect.cuboid([-1, -1, -1], [1, 1, 1])
    >>> trisect.trim(sheet, post).area, trisect.trim(sheet, post, outside=True).area
    (4.0, 12.0)
    """
    core = _trisect.trim(_surface_of(surface, None), _core(by, 1, 2), not outside, settings(given))
    mesh: Mesh = Mesh._wrap(core)
    return mesh


@dataclass(frozen=True)
class Check:
    """Whether a mesh can be an operand, and if not, why."""

    usable: bool
    """Whether it can be, as it is."""
    diagnosis: Diagnosis
    """All that is wrong with it."""
    solid: Optional[Solid]
    """The solid that it is, or that the remedy makes of it."""
    self_crossings: Optional[SelfCrossings]
    """Where it crosses itself, which is no obstacle; ``None`` if there is no solid."""
    error: Optional[MeshError]
    """Why it is refused."""
    remedy: Optional[Dict[str, Any]]
    """Arguments of :class:`Solid` that have been tried and would do."""

    def __bool__(self) -> bool:
        return self.usable


# What is tried, the least first, in the order of the program.
_REMEDIES: Tuple[Dict[str, Any], ...] = (
    {"weld": "auto"},
    {"orient": True},
    {"closed_parts": True},
    {"weld": "auto", "orient": True},
    {"weld": "auto", "closed_parts": True},
    {"closed_parts": True, "orient": True},
    {"weld": "auto", "closed_parts": True, "orient": True},
    {"fill_holes": True},
    {"fill_holes": True, "orient": True},
)


def usable(surface: _trisect.Surface, gate: Mapping[str, Any], assume_clean: bool, given: Any) -> Solid:
    """A surface as an operand, as the program takes one."""
    return Solid._of(_passed(surface, dict(gate), given).operand(assume_clean, given))


def remedy(surface: _trisect.Surface, error: MeshError, gate: Mapping[str, Any], given: Any) -> Optional[Dict[str, Any]]:
    """The first of few sets of options that makes a mesh usable that was refused: what crosses itself afterwards is usable as well,
    but the second choice."""
    inwards = isinstance(error, InsideOutError)
    if not inwards and not isinstance(error, NotClosedError):
        return None
    crossing: Optional[Dict[str, Any]] = None
    for options in _REMEDIES:
        if any(gate.get(key) for key in options) or (inwards and options != {"orient": True}):
            continue
        asked = {**gate, **options, "as_is": False}
        if asked.get("fill_holes") is True:
            asked["fill_holes"] = _ANY_HOLE
        try:
            solid = usable(surface, asked, False, given)
        except MeshError:
            continue
        if solid and not json.loads(solid._core.self_crossings(given))["count"]:
            return options
        crossing = crossing or (options if solid else None)
    return crossing


def check(source: Any, **limits: "Unpack[Limits]") -> Check:
    """Whether a mesh can be an operand; if not, why, where, and what would do.

    >>> import trisect
    >>> tetrahedron = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
    >>> found = trisect.check((tetrahedron, [[0, 2, 1], [0, 1, 3], [1, 2, 3]]))
    >>> found.usable, found.diagnosis.open_edges.count, found.remedy
    (False, 3, {'fill_holes': True})
    """
    given = settings(limits, limits_only=True)
    surface = _surface_of(source, None)
    text, words = surface.diagnosis(given)
    diagnosis = Diagnosis.of({**json.loads(text), "text": words})
    try:
        solid = Solid._of(_passed(surface, None, given))
        return Check(True, diagnosis, solid, solid.self_crossings(**limits), None, None)
    except MeshError as error:
        found = remedy(surface, error, {}, given)
        if found is None:
            return Check(False, diagnosis, None, None, error, None)
        options = {**found, "fill_holes": _ANY_HOLE} if "fill_holes" in found else found
        solid = Solid._of(_passed(surface, options, given))
        return Check(False, diagnosis, solid, solid.self_crossings(**limits), error, found)


def evaluate_model(
    model: Union[str, "os.PathLike[str]", Mapping[str, Any]],
    *,
    folder: Union[str, "os.PathLike[str]", None] = None,
    tolerance: Optional[float] = None,
    **limits: "Unpack[Limits]",
) -> Any:
    """A solid from a model: a tree of operations over meshes, primitives, formulas and contours; or, where the last operation is a
    ``trim``, a :class:`~trisect.Mesh`, which may be open.

    >>> import trisect
    >>> trisect.evaluate_model({"kind": "difference", "operands": [
    ...     {"kind": "box", "size": [2, 2, 2]}, {"kind": "box", "size": [1, 1, 4]}]}).volume
    6.0

    Parameters
    ----------
    model : path or dict
        A model file (JSON), or what one would hold.
    folder : path
        Where relative file names start; the model file's own by default, or the current one.
    tolerance : float
        How far from curved surfaces meshes may be, in units of the coordinates.
    """
    text, base = model_text(model, folder)
    core, warned = _trisect.model(text, base, tolerance, settings(limits, limits_only=True))
    for line in warned:
        warnings.warn(line, TrisectWarning, stacklevel=2)
    return Mesh._wrap(core) if isinstance(core, _trisect.Surface) else Solid._of(core)


def model_text(model: Any, folder: Any) -> Tuple[str, str]:
    """The text of a model and the folder of its files."""
    if isinstance(model, Mapping):
        return json.dumps(model), os.fspath(folder if folder is not None else ".")
    path = os.fspath(model)
    with open(path, encoding="utf-8") as file:
        return file.read(), os.fspath(folder) if folder is not None else os.path.dirname(path) or "."
