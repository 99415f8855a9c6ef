"""Meshes of other packages. None of them is imported here: they are known by what they have."""

from __future__ import annotations

import os
import warnings
from typing import Any, Optional, Tuple

import numpy as np

from . import _arrays, _trisect
from ._errors import ArgumentError, TrisectWarning


def surface_of(source: Any) -> Optional[_trisect.Surface]:
    """A mesh of anything that is one; ``None`` for what is none."""
    if isinstance(source, (str, os.PathLike)):
        surface, warned = load(source)
        for text in warned:
            warnings.warn(f"{os.fspath(source)}: {text}", TrisectWarning, stacklevel=4)
        return surface
    if isinstance(source, tuple):
        return of_arrays(*source) if len(source) == 2 else None
    for reader in (_trimesh, _scene, _pyvista, _open3d, _open3d_tensor, _manifold3d, _meshio):
        found = reader(source)
        if found is not None:
            return found
    if hasattr(source, "vertices") and hasattr(source, "faces"):
        return of_arrays(source.vertices, source.faces)
    return None


def of_arrays(vertices: Any, faces: Any) -> _trisect.Surface:
    """A mesh of two array-likes."""
    corners, sizes = _arrays.faces(faces)
    return _trisect.Surface.of_arrays(_arrays.points(vertices), corners, sizes)


def load(path: Any, part: Optional[str] = None, settings: Any = None) -> Tuple[_trisect.Surface, Any]:
    """A mesh file, and what its reader had to say. ``scene.glb#base`` is the part of that name."""
    surface, warned, _ = load_with_format(path, part, settings)
    return surface, warned


def load_with_format(path: Any, part: Optional[str], settings: Any) -> Tuple[_trisect.Surface, Any, str]:
    """The same, and the ending that its format has."""
    path = os.fspath(path)
    if part is None and "#" in path and not os.path.exists(path):
        path, part = path.rsplit("#", 1)
    return _trisect.load(path, part, settings)


def is_of(source: Any, package: str) -> bool:
    """Whether the class of a value, or one that it is derived from, is a package's."""
    return any(cls.__module__.split(".")[0] == package for cls in type(source).__mro__)


def _trimesh(source: Any) -> Optional[_trisect.Surface]:
    if not (is_of(source, "trimesh") and hasattr(source, "faces")):
        return None
    surface = of_arrays(np.asarray(source.vertices), np.asarray(source.faces))
    uv = getattr(getattr(source, "visual", None), "uv", None)
    if uv is not None and len(uv) == len(source.vertices):
        values = np.array(np.asarray(uv)[:, :2], dtype=np.float64, order="C")
        # There they count from the lower edge of a picture, here, as in glTF, from the upper one.
        values[:, 1] = 1.0 - values[:, 1]
        if np.isfinite(values).all():
            surface = surface.with_attribute("TEXCOORD_0", values, np.asarray(surface.view("faces")))
        else:
            warnings.warn("texture coordinates that are not finite are left out", TrisectWarning, stacklevel=4)
    return surface


def _scene(source: Any) -> Optional[_trisect.Surface]:
    """A scene of trimesh: all that it shows."""
    if not (is_of(source, "trimesh") and hasattr(source, "to_mesh")):
        return None
    return _trimesh(source.to_mesh())


def _pyvista(source: Any) -> Optional[_trisect.Surface]:
    if not (is_of(source, "pyvista") and hasattr(source, "points")):
        return None
    if not hasattr(source, "n_strips"):
        source = source.extract_surface()
    if getattr(source, "n_strips", 0):
        source = source.triangulate()
    corners, sizes = _arrays.padded(source.faces)
    return _trisect.Surface.of_arrays(_arrays.points(np.asarray(source.points)), corners, sizes)


def _open3d(source: Any) -> Optional[_trisect.Surface]:
    if not (is_of(source, "open3d") and hasattr(source, "triangles") and hasattr(source, "vertices")):
        return None
    return of_arrays(np.asarray(source.vertices), np.asarray(source.triangles))


def _open3d_tensor(source: Any) -> Optional[_trisect.Surface]:
    if not (is_of(source, "open3d") and hasattr(source, "triangle") and hasattr(source, "vertex")):
        return None
    return of_arrays(source.vertex.positions.numpy(), source.triangle.indices.numpy())


def _manifold3d(source: Any) -> Optional[_trisect.Surface]:
    if is_of(source, "manifold3d") and hasattr(source, "to_mesh"):
        source = source.to_mesh64() if hasattr(source, "to_mesh64") else source.to_mesh()
    if not (hasattr(source, "vert_properties") and hasattr(source, "tri_verts")):
        return None
    return of_arrays(np.asarray(source.vert_properties)[:, :3], np.asarray(source.tri_verts))


def _meshio(source: Any) -> Optional[_trisect.Surface]:
    if not (hasattr(source, "points") and hasattr(source, "cells_dict")):
        return None
    cells = source.cells_dict
    rows = [row for kind in ("triangle", "quad", "polygon") for row in cells.get(kind, ())]
    if cells and not rows:
        raise ArgumentError(f"there are neither triangles, quads nor polygons, only {', '.join(cells)}: extract the surface first")
    return of_arrays(source.points, rows)
