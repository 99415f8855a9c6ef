"""An engine for trimesh: importing this module registers it.

>>> import trimesh
>>> import trisect.trimesh
>>> a = trimesh.creation.box()
>>> b = trimesh.creation.box(transform=trimesh.transformations.translation_matrix([0.5, 0.5, 0.5]))
>>> round(float(a.union(b, engine="trisect").volume), 12)
1.875

Keywords are those of :class:`trisect.Settings`, and ``check_volume``, which is trimesh's own and asks for nothing here: every
operand is looked at anyway, and refused with a reason if it is not closed. With :func:`set_default` no engine has to be named.
"""

from __future__ import annotations

from typing import Any, Optional, Sequence

import numpy as np
import trimesh
import trimesh.boolean

from ._operations import run
from ._surfaces import Solid

_ENGINES: Any = trimesh.boolean._engines


def engine(meshes: Sequence[Any], operation: str, check_volume: bool = True, **given: Any) -> trimesh.Trimesh:
    """What trimesh calls: one operation on its meshes.

    The result has the solid itself in ``metadata["trisect"]``, with origins and certificate.
    """
    del check_volume
    solid = run(operation, tuple(meshes) if len(meshes) != 1 else (list(meshes),), given)
    return _result(solid)


def _result(solid: Solid) -> trimesh.Trimesh:
    mesh = trimesh.Trimesh(solid.vertices.copy(), solid.faces.astype(np.int64), process=False)
    mesh.metadata["trisect"] = solid
    return mesh


def set_default(name: Optional[str] = "trisect") -> None:
    """Makes an engine the one that trimesh uses where none is named. ``None``: the one that was before."""
    if name is None:
        _ENGINES[None] = _BEFORE[0]
    else:
        _ENGINES[None] = _ENGINES[name]


# (In a list, since trimesh without another engine has an object there that raises when anything is asked of it, as tools do of all
# names of a module.)
_BEFORE = [_ENGINES.get(None, engine)]
_ENGINES["trisect"] = engine
if hasattr(trimesh.boolean, "engines_available"):
    trimesh.boolean.engines_available.add("trisect")
