"""The verbs of jobs: what each makes of its inputs, under the names that the program's reports have."""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from typing import Any, Callable, Dict, List, Mapping, Sequence, Tuple, Union

import numpy as np

from . import _operations, _trisect
from ._errors import ArgumentError, Error, LimitError, MeshError
from ._files import ending, with_end, write_text
from ._inputs import Inputs
from ._surfaces import Mesh, Solid, _passed

Report = Dict[str, Any]
Own = Dict[str, Any]
Settings = Callable[[], Dict[str, Any]]


@dataclass
class Made:
    """What a verb made."""

    report: Report = field(default_factory=dict)
    """What is said of it."""
    files: List[Tuple[str, Union[Solid, Mesh]]] = field(default_factory=list)
    """What is written: the end of a file's name, and what the file holds."""
    drawing: Any = None
    """Or the text of a drawing of a kind, and how it is made."""


@dataclass(frozen=True)
class Verb:
    """A verb: what it does, its own options, and the settings it takes beside limits."""

    act: Callable[[Inputs, Own, Settings], Made]
    own: Tuple[str, ...] = ()
    settings: Tuple[str, ...] = ()


def measures(surface: Union[Solid, Mesh]) -> Report:
    """The measures of a mesh, as reports have them: what only a closed surface has is ``None`` for others."""
    core = surface._core
    vertices, faces = core.counts()
    report: Report = {"vertices": vertices, "triangles": faces, "empty": faces == 0, "area": _number(core.area())}
    if isinstance(surface, Solid):
        bounds = core.bounds()
        manifold, shells, _, genus = core.topology()
        return {
            **report, "bounds": bounds, "closed": True, "manifold": manifold, "shells": shells, "genus": genus,
            "volume": _number(core.volume()),
        }  # fmt: skip
    used = surface.vertices
    box = [used.min(axis=0).tolist(), used.max(axis=0).tolist()] if vertices else None
    nothing = dict.fromkeys(("manifold", "shells", "genus", "volume"))
    return {**report, "bounds": box, "closed": False, **nothing}


def _number(value: float) -> Any:
    """A number as JSON has it."""
    return float(value) if np.isfinite(value) else None


def _result(solid: Solid) -> Report:
    """What is said of the result of an operation."""
    report = measures(solid)
    if solid.is_result:
        report["certificate"] = json.loads(solid._core.certificate())
    return report


# Operations


def _boolean(operation: str) -> Callable[[Inputs, Own, Settings], Made]:
    def act(inputs: Inputs, own: Own, given: Settings) -> Made:
        operands = inputs.solids()
        result = _operations.run(operation, (operands,), _ruled(inputs, given))
        return Made({"result": _result(result)}, [("", result)])

    return act


def _ruled(inputs: Inputs, given: Settings) -> Dict[str, Any]:
    """The settings with what is inside each operand."""
    all_of_them = given()
    rules = inputs.rules(all_of_them)
    all_of_them.pop("rule", None)
    return {**all_of_them, "rules": rules}


def _combine(inputs: Inputs, own: Own, given: Settings) -> Made:
    if own.get("all"):
        inputs.of(2, "combine with all takes two inputs")
        texts, names = ["a | b", "a & b", "a - b", "b - a"], ["union", "intersection", "difference", "reverse"]
        solids = inputs.solids()
        results = _operations.combine(texts, *solids, **_ruled(inputs, given))
        reports = [_result(result) for result in results]
        return Made({"result": reports[0], "results": reports}, [(f"-{name}", result) for name, result in zip(names, results)])
    if "expr" not in own:
        raise ArgumentError("combine needs the option expr")
    solids = inputs.solids()
    result: Solid = _operations.combine(str(own["expr"]), *solids, **_ruled(inputs, given))
    return Made({"result": _result(result)}, [("", result)])


def _resolve(inputs: Inputs, own: Own, given: Settings) -> Made:
    inputs.of(1, "resolve takes one input")
    operand = inputs.solid(0)
    result = _operations.resolve(operand, **_ruled(inputs, given))
    return Made({"result": _result(result)}, [("", result)])


def _convert(inputs: Inputs, own: Own, given: Settings) -> Made:
    inputs.of(1, "convert takes one input")
    mesh = inputs.surface(0)
    closed = ("closed", "manifold", "shells", "genus", "volume")
    # Whether it is closed is not looked into here; `check` tells.
    report = {key: value for key, value in measures(mesh).items() if key not in closed}
    return Made({"input": {"file": inputs.path(0), **report}}, [("", mesh)])


# Planes


def _cut(inputs: Inputs, own: Own, given: Settings) -> Made:
    inputs.of(1, "cut takes one input")
    planes = _planes_of(own.get("plane"))
    keep = own.get("keep", "both")
    if not planes or keep not in ("above", "below", "both"):
        raise ArgumentError("cut needs the option plane; keep is above, below or both")
    if keep == "both" and len(planes) > _MOST_PLANES:
        raise ArgumentError(f"more than {_MOST_PLANES} planes make too many pieces; keep one side")
    cap = own.get("cap")
    if cap is not None and "#" in str(cap):
        raise ArgumentError(f"the option cap is the name of a group here, without a colour, not {cap!r}")
    pieces = [inputs.solid(0)]
    for plane in planes:
        halves = [_operations.cut(piece, plane, cap=cap, **given()) for piece in pieces]
        # All that is above this plane, then all that is below it.
        sides = {"above": (0,), "below": (1,), "both": (0, 1)}[keep]
        pieces = [half[side] for side in sides for half in halves]
    if keep != "both":
        ends = [""]
    elif len(planes) == 1:
        ends = ["-above", "-below"]
    else:
        ends = ["-" + "".join("b" if piece >> k & 1 else "a" for k in range(len(planes))) for piece in range(len(pieces))]
    return Made({"results": [_result(piece) for piece in pieces]}, list(zip(ends, pieces)))


# So many planes make 4096 pieces, which nobody wants by accident; as in the program.
_MOST_PLANES = 12


def _planes_of(given: Any) -> List[Any]:
    """Planes as a job has them: a text, numbers, or a list of texts."""
    if given is None:
        return []
    if isinstance(given, (list, tuple)) and any(isinstance(one, str) for one in given):
        return [_one_plane(one) for one in given]
    return [_one_plane(given)]


def _one_plane(given: Any) -> Any:
    if isinstance(given, str) and "=" not in given:
        given = [float(word) for word in given.replace(",", " ").replace(";", " ").split()]
    if isinstance(given, (list, tuple)) and len(given) == 9:
        return [list(map(float, given[k : k + 3])) for k in (0, 3, 6)]
    return given


def _section(inputs: Inputs, own: Own, given: Settings) -> Made:
    inputs.of(1, "section takes one input")
    axis, side = str(own.get("axis", "z")).lower(), str(own.get("side", "inside"))
    if ("plane" in own) == ("heights" in own) or axis not in ("x", "y", "z"):
        raise ArgumentError("section needs one of the options plane and heights; axis is x, y or z")
    planes = _planes_of(own["plane"]) if "plane" in own else [(axis, height) for height in _heights(own["heights"])]
    found = _operations.sections(inputs.solid(0), planes, side=side, **given())
    layers, listed = [], []
    for section, name, height in zip(found, *_operations.layer_names(planes)):
        layers.append((name, height, [[ring.tolist() for ring in shape] for shape in section.shapes]))
        holes = sum(len(shape) - 1 for shape in section.shapes)
        listed.append({
            "name": name, "height": height, "area": section.area, "perimeter": section.perimeter,
            "polygons": len(section.shapes), "holes": holes,
        })  # fmt: skip
    return Made({"sections": listed}, drawing=layers)


# So many sections of one file are a mistake; as in the program.
_MOST_SECTIONS = 1e6


def _heights(given: Any) -> List[float]:
    """Heights as a job has them: FIRST:STEP:LAST, a number, or numbers."""
    if isinstance(given, str) and ":" in given:
        first, step, last = (float(word) for word in given.split(":"))
        count = np.floor((last - first) / step * (1.0 + np.finfo(float).eps)) if step > 0 else -1
        if not 0 <= count < _MOST_SECTIONS:
            raise ArgumentError("heights are FIRST:STEP:LAST with a positive step and LAST not below FIRST, such as 0:0.2:10")
        return [first + i * step for i in range(int(count) + 1)]
    words = given.replace(",", " ").split() if isinstance(given, str) else given if isinstance(given, (list, tuple)) else [given]
    if not words:
        raise ArgumentError("heights are one number at least")
    return [float(word) for word in words]


# Parts


def _split(inputs: Inputs, own: Own, given: Settings) -> Made:
    inputs.of(1, "split takes one input; the option by names the solid that it is cut by")
    by, sheets = own.get("by"), own.get("sheet")
    listed = [sheets] if isinstance(sheets, str) else list(sheets or [])
    if sum(map(bool, (by, listed, own.get("groups")))) > 1 or (own.get("explode") and not by):
        raise ArgumentError("split takes one of the options by, sheet and groups; explode belongs to by")
    for path in [by] if by else listed:
        inputs.like_first(str(path))
    solid = inputs.solid(0)
    if by:
        parts = _cells(solid, inputs.solid(1), bool(own.get("explode")), {**given(), "rules": inputs.rules(given())})
    elif listed:
        surfaces = [inputs.surface(place) for place in range(1, 1 + len(listed))]
        parts = _numbered("", _operations.split(solid, sheets=surfaces, **given()))
    elif own.get("groups"):
        parts = _by_group(solid)
    else:
        if not given().get("assume_clean") and solid.self_crossings():
            solid = _operations.resolve(solid, **_ruled(inputs, given))
        parts = _numbered("", solid.bodies())
    return Made({"results": [{**measures(part), "part": end.lstrip("-")} for end, part in parts]}, parts)


Parts = List[Tuple[str, Union[Solid, Mesh]]]


def _cells(solid: Solid, tool: Solid, explode: bool, given: Dict[str, Any]) -> Parts:
    """What is outside a tool, inside it, and of it outside."""
    given.pop("rule", None)
    cells = _operations.combine(["a - b", "a & b", "b - a"], solid, tool, **given)
    parts: Parts = []
    for cell, end in zip(cells, ("-difference", "-intersection", "-reverse")):
        if cell:
            parts += _numbered(end, cell.bodies()) if explode else [(end, cell)]
    return parts


def _numbered(name: str, bodies: Sequence[Solid]) -> Parts:
    """Bodies by size, the largest first, with numbers of as many digits as the last one has."""
    digits = len(str(len(bodies)))
    by_size = sorted(bodies, key=lambda body: -body.volume)
    return [(f"{name}-{number:0{digits}}", body) for number, body in enumerate(by_size, 1)]


def _by_group(solid: Solid) -> Parts:
    """The surface of each group, a solid where it is closed by itself."""
    names, parts = solid.groups.names, []
    for number, surface in solid._surface().by_group():
        name = names[number] if number < len(names) else ""
        kept = "".join(letter if letter.isalnum() or letter in "-_." else "_" for letter in name)
        part: Union[Solid, Mesh] = Mesh._wrap(surface)
        try:
            part = Solid._of(_passed(surface, {"as_is": True}, None))
        except MeshError:
            pass
        parts.append((f"-{number + 1}-{kept}" if kept else f"-{number + 1}", part))
    return parts


def _trim(inputs: Inputs, own: Own, given: Settings) -> Made:
    inputs.of(2, "trim takes two inputs, the surface and then the solid that it is trimmed by")
    inside, outside = bool(own.get("inside")), bool(own.get("outside"))
    if inside == outside:
        raise ArgumentError("trim needs one of the options inside and outside")
    sheet, solid = inputs.surface(0), inputs.solid(1)
    settings = given()
    settings["rule"] = inputs.rules(settings)[1]
    trimmed = _operations.trim(sheet, solid, outside=outside, **settings)
    return Made({"result": measures(trimmed)}, [("", trimmed)])


# Looking


def _check(inputs: Inputs, own: Own, given: Settings) -> Made:
    files = [_checked(inputs, place, given) for place in range(len(inputs))]
    return Made({"files": files, "usable": all(file["usable"] for file in files)})


def _checked(inputs: Inputs, place: int, given: Settings) -> Report:
    """What is said of one file; only limits end the job."""
    from ._jobs import describe

    report: Report = {"file": inputs.path(place), "usable": False}
    try:
        mesh, report["format"] = inputs.read(place)
        limits = inputs._limits()
        report["diagnosis"] = json.loads(mesh._core.diagnosis(limits)[0])
        report = {**measures(mesh), **report}
        solid = _operations.usable(mesh._core, inputs.gate(place), bool(given().get("assume_clean")), limits)
    except (LimitError, MemoryError):
        raise
    except (Error, OSError) as error:
        report["error"] = describe(error)
        if isinstance(error, MeshError):
            remedy = _operations.remedy(mesh._core, error, inputs.gate(place), inputs._limits())
            if remedy:
                report["error"]["remedy"] = " ".join(_OPTIONS[key] for key in remedy)
        return report
    cleaning, mending, _ = solid._core.mending()
    mended = json.loads(mending)
    crossings = None if given().get("assume_clean") else json.loads(solid._core.self_crossings(inputs._limits()))
    return {
        **report, **measures(solid), "usable": True, "turned": mended["turned"] > 0,
        "welded": mended["seams"]["count"] if mended["distance"] is not None else 0,
        "cleaning": json.loads(cleaning), "mending": mended, "self_crossings": crossings,
    }  # fmt: skip


_OPTIONS = {"weld": "--weld auto", "orient": "--orient", "closed_parts": "--closed-parts", "fill_holes": "--fill-holes"}

_CUTTING = ("rule", "assume-clean")
_COMBINING = (*_CUTTING, "snap", "embed", "cut-material")

VERBS: Mapping[str, Verb] = {
    "union": Verb(_boolean("union"), settings=_COMBINING),
    "intersection": Verb(_boolean("intersection"), settings=_COMBINING),
    "difference": Verb(_boolean("difference"), settings=_COMBINING),
    "xor": Verb(_boolean("xor"), settings=_COMBINING),
    "combine": Verb(_combine, ("expr", "all"), _COMBINING),
    "resolve": Verb(_resolve, settings=_COMBINING),
    "cut": Verb(_cut, ("plane", "keep", "cap"), (*_CUTTING, "cut-material")),
    "section": Verb(_section, ("plane", "heights", "axis", "side"), _CUTTING),
    "split": Verb(_split, ("by", "sheet", "groups", "explode"), _CUTTING),
    "trim": Verb(_trim, ("inside", "outside"), _CUTTING),
    "convert": Verb(_convert),
    "check": Verb(_check, settings=("assume-clean",)),
}


def write(made: Made, output: str, local: Callable[[str], Any]) -> List[Report]:
    """Writes what a verb made; ``local`` gives the local path of a file for as long as it is written."""
    if made.drawing is not None:
        if ending(output) not in ("svg", "dxf", "json"):
            raise ArgumentError(f"sections are written as *.svg, *.dxf or *.json, not as {output}")
        text = _trisect.drawing(ending(output), made.drawing)
        with local(output) as path:
            write_text(path, text)
        return [{"file": output, "format": ending(output), "bytes": len(text.encode())}]
    written = []
    for end, surface in made.files:
        file = with_end(output, end)
        with local(file) as path:
            surface.save(path)
            written.append({"file": file, "format": ending(file), "bytes": _size(path)})
    return written


def _size(path: str) -> Any:
    import os

    try:
        return os.path.getsize(path)
    except OSError:
        return None
