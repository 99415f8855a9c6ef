"""Solids as Python objects."""

from __future__ import annotations

import copy
import pickle
import threading
from typing import Any

import numpy as np
import pytest

import trisect


def test_equality_hash_and_pickles(pair: Any) -> None:
    a, b = pair
    cut = a - b
    again = trisect.Solid(a.vertices, a.faces) - trisect.Solid(b.vertices, b.faces)
    assert cut == again and hash(cut) == hash(again) and cut != a and cut != 7
    assert len({cut, again, a}) == 2
    for protocol in range(2, pickle.HIGHEST_PROTOCOL + 1):
        restored = pickle.loads(pickle.dumps(cut, protocol))
        assert restored == cut and hash(restored) == hash(cut)
        assert (restored.vertices == cut.vertices).all() and restored.volume == cut.volume
    assert copy.copy(cut) is cut and copy.deepcopy(cut) is cut
    mesh = cut.mesh()
    assert (pickle.loads(pickle.dumps(mesh)).faces == mesh.faces).all()


def test_pickles_keep_what_is_proven(pair: Any) -> None:
    a, b = pair
    assert not a._core.is_proven_clean() and not pickle.loads(pickle.dumps(a))._core.is_proven_clean()
    cut = a - b
    assert cut._core.is_proven_clean() and a._core.is_proven_clean()
    again = pickle.loads(pickle.dumps(cut))
    assert again == cut and again._core.is_proven_clean() and not again.is_result
    # Of other bits it is not believed.
    make, (vertices, faces, parts, proof) = cut.__reduce__()
    assert make(vertices, faces, parts, proof)._core.is_proven_clean()
    moved = vertices.copy()
    moved[0] += 0.125
    assert not make(moved, faces, parts, proof)._core.is_proven_clean()
    both = trisect.Solid(np.vstack([a.vertices, b.vertices]), np.vstack([a.faces, b.faces + 8]))
    assert both.self_crossings() and not pickle.loads(pickle.dumps(both))._core.is_proven_clean()
    assert (pickle.loads(pickle.dumps(both)) | a).volume == (a | b).volume


def test_pickles_keep_attributes_and_groups(pair: Any) -> None:
    a, _ = pair
    rich = a.with_attribute("_HEAT", a.vertices[:, :1]).with_groups(["low", "high"], np.arange(12) % 2)
    restored = pickle.loads(pickle.dumps(rich))
    assert restored == rich and restored != a
    assert restored.groups.names == ["low", "high"] and restored.groups.of_face.tolist() == [0, 1] * 6
    assert (restored.attributes["_HEAT"].at_corners() == rich.attributes["_HEAT"].at_corners()).all()


def test_exceptions_pickle() -> None:
    with pytest.raises(trisect.NotClosedError) as raised:
        trisect.Solid([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    restored = pickle.loads(pickle.dumps(raised.value))
    assert str(restored) == str(raised.value) and restored.diagnosis == raised.value.diagnosis


def test_measures(pair: Any) -> None:
    a, b = pair
    united = a | b
    assert united.volume == 1.875 and united.area == 10.5
    assert united.bounds.tolist() == [[0, 0, 0], [1.5, 1.5, 1.5]]
    assert united.centroid == pytest.approx([0.75] * 3)
    assert united.is_manifold and united.components == 1 and united.genus == 0 and united.euler_characteristic == 2
    assert trisect.torus(2, 0.5).genus == 1


def test_changed_copies(pair: Any) -> None:
    a, _ = pair
    assert a.translated([1, 2, 3]).bounds.tolist() == [[1, 2, 3], [2, 3, 4]]
    assert a.scaled(2).volume == 8 and a.scaled([1, 2, 3]).volume == 6
    assert a.rotated("z", 90).bounds.tolist() == [[-1, 0, 0], [0, 1, 1]]
    mirror = np.diag([-1.0, 1, 1, 1])
    assert a.transformed(mirror).volume == 1 and a.transformed(mirror[:3]).bounds[0, 0] == -1
    for wrong in (lambda: a.translated([1, 2]), lambda: a.transformed(np.eye(3)), lambda: a.rotated("w", 1)):
        with pytest.raises(trisect.ArgumentError):
            wrong()
    with pytest.raises(trisect.Error):
        a.scaled([1, 0, 1])


def test_attributes_are_carried(pair: Any) -> None:
    a, b = pair
    a, b = (solid.with_attribute("TEXCOORD_0", solid.vertices[:, :2]) for solid in (a, b))
    cut = a - b
    uv = cut.attributes["TEXCOORD_0"].at_corners()
    assert uv.shape == (len(cut.faces), 3, 2)
    assert uv == pytest.approx(cut.vertices[cut.faces][:, :, :2], abs=1e-15)
    by_corner = a.with_attribute("_ID", np.arange(36.0).reshape(12, 3, 1))
    assert by_corner.attributes["_ID"].at_corners()[3, 2, 0] == 11
    with pytest.raises(ValueError):
        a.attributes["TEXCOORD_0"].values[0] = 1
    for name, values in [("_X", np.zeros((5, 2))), ("_X", np.zeros(8)), ("no name", np.zeros((8, 2))), ("_X", np.full((8, 1), np.nan))]:
        with pytest.raises(ValueError):
            a.with_attribute(name, values)
    with pytest.raises(ValueError):
        a.with_attribute("_X", np.zeros((1, 1)), corners=np.full((12, 3), 5))
    for row in (-1, 2**32):
        with pytest.raises(trisect.ArgumentError, match="rows of the table"):
            a.with_attribute("_X", np.zeros((1, 1)), corners=np.full((12, 3), row))
    for numbers in ([1] * 12, [2**40] * 12, [-1] * 12, [0] * 11):
        with pytest.raises(trisect.ArgumentError):
            a.with_groups(["one"], numbers)


def test_origins_curves_and_certificate(pair: Any) -> None:
    a, b = pair
    cut = a - b
    origins = cut.origins
    assert origins.operand.shape == (24,) and set(origins.operand) == {0, 1}
    assert (origins.reversed == (origins.operand == 1)).all()
    faces = [a.faces, b.faces]
    assert all(face < len(faces[operand]) for operand, face in zip(origins.operand, origins.face))
    [curve] = cut.curves
    assert curve[0] == curve[-1] and len(curve) == 7
    certificate = cut.certificate
    assert certificate.closed and certificate.manifold and certificate.volume == cut.volume
    assert certificate.operands[0].kind == "clean"
    assert certificate.as_dict()["triangles"] == 24
    assert cut.is_result and not a.is_result
    with pytest.raises(trisect.ArgumentError):
        _ = a.certificate


def test_mending_is_told(cube: Any) -> None:
    corners, squares = cube
    apart = corners[squares].reshape(-1, 3)
    solid = trisect.Solid(apart, np.arange(24).reshape(6, 4))
    assert len(solid.vertices) == 8 and solid.cleaning.welded_vertices == 16 and solid.cleaning
    assert not solid.mending
    cracked = apart.copy()
    cracked[0] += 0.0005
    with pytest.raises(trisect.NotClosedError):
        trisect.Solid(cracked, np.arange(24).reshape(6, 4))
    welded = trisect.Solid(cracked, np.arange(24).reshape(6, 4), weld="auto")
    assert welded.mending and welded.mending.seams.count > 0 and "seam" in welded.mending.text
    lid_off = trisect.Solid(corners, squares[1:], fill_holes=True)
    assert lid_off.volume == 1.0 and lid_off.mending.filled.count == 1
    assert lid_off.sources.max() < 12
    with pytest.raises(trisect.ArgumentError):
        trisect.Solid(corners, squares, weld="a lot")
    with pytest.raises(trisect.NotClosedError):
        trisect.Solid(cracked, np.arange(24).reshape(6, 4), as_is=True)


def test_open_edges_of_a_mesh(cube: Any) -> None:
    corners, squares = cube
    edges = trisect.Mesh(corners, squares[1:]).open_edges()
    assert {tuple(sorted(edge)) for edge in edges.tolist()} == {(0, 2), (2, 3), (1, 3), (0, 1)}
    assert trisect.Mesh(corners, squares).open_edges().shape == (0, 2)


def test_pictures(pair: Any) -> None:
    a, b = pair
    cut = a - b
    png = cut.picture(64, 48, by_operand=True)
    assert png.startswith(b"\x89PNG") and png != cut.picture(64, 48)
    assert "data:image/png" in cut._repr_html_() and "0.875" in cut._repr_html_()
    for size in ((0, 48), (64, 5000), (2**31, 2**31)):
        with pytest.raises(trisect.ArgumentError):
            cut.picture(*size)
    assert "volume 0.875" in repr(cut) and "empty" in trisect.Solid.empty()._repr_html_()


def test_one_solid_in_many_threads(balls: Any) -> None:
    a, b = balls
    expected = a - b
    results = []
    threads = [threading.Thread(target=lambda: results.append(a - b)) for _ in range(3)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(results) == 3 and all(result == expected for result in results)
