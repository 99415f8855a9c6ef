"""An accessor for PyVista: importing this module gives every ``PolyData`` a ``trisect``.

>>> import pyvista
>>> import trisect.pyvista
>>> a, b = pyvista.Cube(), pyvista.Cube(center=(0.5, 0.5, 0.5))
>>> round(a.trisect.union(b).volume, 6)
1.875

Results are ``PolyData`` of triangles, with where each comes from in ``cell_data``: ``operand``, ``face`` and ``reversed``.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, List

import pyvista

from ._operations import Check, check, cut, resolve, run, sections
from ._surfaces import Solid

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from ._operations import PlaneLike
    from ._settings import Limits, Settings


class Accessor:
    """Booleans of a ``PolyData``. Keywords are those of :class:`trisect.Settings`."""

    def __init__(self, mesh: Any) -> None:
        self._mesh = mesh

    @property
    def solid(self) -> Solid:
        """The mesh as a :class:`trisect.Solid`, made anew each time, since PyVista's meshes change."""
        return Solid(self._mesh)

    def _run(self, operation: str, others: Any, given: Any) -> Any:
        return poly_data(run(operation, (self._mesh, *others), given))

    def union(self, *others: Any, **given: "Unpack[Settings]") -> Any:
        """What is in this or in any of the others."""
        return self._run("union", others, given)

    def intersection(self, *others: Any, **given: "Unpack[Settings]") -> Any:
        """What is in this and in all of the others."""
        return self._run("intersection", others, given)

    def difference(self, *others: Any, **given: "Unpack[Settings]") -> Any:
        """What is in this and in none of the others."""
        return self._run("difference", others, given)

    def xor(self, *others: Any, **given: "Unpack[Settings]") -> Any:
        """What is in an odd number of this and the others."""
        return self._run("xor", others, given)

    def resolve(self, **given: "Unpack[Settings]") -> Any:
        """The same without crossings; see :func:`trisect.resolve`."""
        return poly_data(resolve(self._mesh, **given))

    def cut(self, plane: "PlaneLike", **given: "Unpack[Settings]") -> Any:
        """What is above a plane and what is below it, both closed; see :func:`trisect.cut`."""
        return tuple(poly_data(half) for half in cut(self._mesh, plane, **given))

    def section(self, plane: "PlaneLike", **given: "Unpack[Settings]") -> Any:
        """Where a plane meets the solid: a ``PolyData`` of closed lines."""
        [section] = sections(self._mesh, [plane], **given)
        loops: List[Any] = [
            pyvista.lines_from_points(ring, close=True) for shape in section.rings for ring in shape
        ]
        return pyvista.merge(loops) if loops else pyvista.PolyData()

    def check(self, **limits: "Unpack[Limits]") -> Check:
        """Whether it can be an operand, and if not, why; see :func:`trisect.check`."""
        return check(self._mesh, **limits)


def poly_data(solid: Solid) -> Any:
    """A ``PolyData`` of a solid; of a result with where its faces come from."""
    mesh = solid.to_pyvista()
    if solid.is_result:
        origins = solid.origins
        mesh.cell_data["operand"] = origins.operand
        mesh.cell_data["face"] = origins.face
        mesh.cell_data["reversed"] = origins.reversed
    return mesh


if "trisect" not in getattr(pyvista.PolyData, "__dict__", {}):
    pyvista.register_dataset_accessor("trisect", pyvista.PolyData)(Accessor)
