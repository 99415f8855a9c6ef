"""The engine for trimesh and the accessor for PyVista, on those packages' own examples."""

from __future__ import annotations

import numpy as np
import pytest

import trisect


def test_trimesh_uses_the_engine() -> None:
    trimesh = pytest.importorskip("trimesh")
    import trisect.trimesh as ours

    ball = trimesh.creation.icosphere(subdivisions=3)
    box = trimesh.creation.box(extents=[1.5] * 3)
    union = ball.union(box, engine="trisect")
    common = ball.intersection(box, engine="trisect")
    rest = trimesh.boolean.difference([ball, box], engine="trisect")
    assert union.is_watertight and common.is_watertight and rest.is_watertight
    assert union.volume + common.volume == pytest.approx(ball.volume + box.volume, rel=1e-12)
    assert rest.volume == pytest.approx(ball.volume - common.volume, rel=1e-12)
    assert isinstance(union.metadata["trisect"], trisect.Solid)
    # Three at once, and settings.
    assert trimesh.boolean.union([ball, box, box], engine="trisect", threads=1).volume == pytest.approx(union.volume)
    # Not closed: refused with a reason, whatever trimesh is told to check.
    lid_off = trimesh.Trimesh(box.vertices, box.faces[2:])
    with pytest.raises(trisect.NotClosedError, match="operand 2"):
        trimesh.boolean.difference([ball, lid_off], engine="trisect", check_volume=False)
    ours.set_default()
    try:
        assert "trisect" in ball.difference(box).metadata
    finally:
        ours.set_default(None)


def test_pyvista_has_an_accessor() -> None:
    pyvista = pytest.importorskip("pyvista")
    import trisect.pyvista  # noqa: F401

    # The example of PyVista's own boolean_union and kin.
    one, two = pyvista.Sphere(center=(0, 0, 0)), pyvista.Sphere(center=(0.5, 0, 0))
    union, common, rest = one.trisect.union(two), one.trisect.intersection(two), one.trisect.difference(two)
    assert union.is_manifold and common.is_manifold and rest.is_manifold
    # (VTK's volumes are in single precision.)
    assert union.volume + common.volume == pytest.approx(one.volume + two.volume, rel=1e-6)
    assert rest.volume == pytest.approx(one.volume - common.volume, rel=1e-6)
    assert one.trisect.xor(two).volume == pytest.approx(union.volume - common.volume, rel=1e-6)
    assert set(union.cell_data) == {"operand", "face", "reversed"}
    assert set(np.unique(union.cell_data["operand"])) == {0, 1}
    above, below = one.trisect.cut("z=0.1")
    assert above.volume + below.volume == pytest.approx(one.volume, rel=1e-6)
    assert one.trisect.section("z=0.1").n_cells > 0 and one.trisect.section("z=9").n_points == 0
    assert one.trisect.check() and one.trisect.resolve().volume == pytest.approx(one.volume, rel=1e-6)
    assert one.trisect.solid.volume == pytest.approx(one.volume, rel=1e-6)


def test_modules_are_not_imported_unasked() -> None:
    import subprocess
    import sys

    code = "import sys, trisect; print([m for m in ('trimesh', 'pyvista', 'ray', 'fsspec', 'tqdm') if m in sys.modules])"
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout == "[]\n"

