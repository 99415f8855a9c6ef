"""Arrays as users have them, and what is wrong with some."""

from __future__ import annotations

import gc
from typing import Any

import numpy as np
import pytest

import trisect

TRIANGLES = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
TETRAHEDRON = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], dtype=float)


@pytest.mark.parametrize("floats", [np.float32, np.float64, np.float16, np.int64, ">f8", np.longdouble])
@pytest.mark.parametrize("integers", [np.int32, np.int64, np.uint32, np.uint64, np.int8, ">i4"])
@pytest.mark.parametrize("order", ["C", "F"])
def test_kinds_of_numbers_and_orders(floats: Any, integers: Any, order: Any) -> None:
    vertices = np.asarray(TETRAHEDRON, dtype=floats, order=order)
    faces = np.asarray(TRIANGLES, dtype=integers, order=order)
    solid = trisect.Solid(vertices, faces)
    assert (solid.vertices == TETRAHEDRON).all()
    assert (solid.faces == TRIANGLES).all()


def test_views_lists_and_read_only_arrays() -> None:
    wide = np.zeros((8, 6))
    wide[::2, ::2] = TETRAHEDRON
    vertices = wide[::2, ::2]
    assert not vertices.flags.c_contiguous
    faces = np.ascontiguousarray(TRIANGLES[::-1])[::-1]
    vertices.flags.writeable = faces.flags.writeable = False
    for given in [(vertices, faces), (TETRAHEDRON.tolist(), TRIANGLES.tolist()), (tuple(map(tuple, TETRAHEDRON)), iter(TRIANGLES))]:
        assert trisect.Solid(*given).volume == pytest.approx(1 / 6, rel=1e-15)


def test_fields_of_packed_records_are_read_right() -> None:
    for number in (np.float32, np.float64):
        packed = np.zeros(4, dtype=[("point", number, 3), ("mark", np.int8)])
        packed["point"] = TETRAHEDRON
        corners = np.zeros(4, dtype=[("mark", np.int8), ("face", np.int64, 3)])
        corners["face"] = TRIANGLES
        assert not packed["point"].flags.aligned and not corners["face"].flags.aligned
        solid = trisect.Solid(packed["point"], corners["face"])
        assert (solid.vertices == TETRAHEDRON).all() and (solid.faces == TRIANGLES).all()
        # In one piece, but beginning in the middle of a word.
        buffer = b"x" + TETRAHEDRON.astype(number).tobytes()
        askew = np.frombuffer(buffer, dtype=number, offset=1).reshape(4, 3)
        assert (trisect.Solid(askew, TRIANGLES).vertices == TETRAHEDRON).all()
        heat = solid.with_attribute("_HEAT", askew).attributes["_HEAT"]
        assert (heat.values == TETRAHEDRON).all() and (heat.corners == TRIANGLES).all()


def test_quads_and_ragged_polygons(cube: Any) -> None:
    corners, squares = cube
    assert trisect.Solid(corners, squares).volume == 1.0
    ragged = [list(square) for square in squares[1:]] + [[0, 2, 3], [0, 3, 1]]
    solid = trisect.Solid(corners, ragged)
    assert solid.volume == 1.0 and len(solid.faces) == 12
    house = trisect.Mesh([[0, 0, 0], [2, 0, 0], [2, 1, 0], [1, 2, 0], [0, 1, 0]], [[0, 1, 2, 3, 4]])
    assert len(house.faces) == 3 and house.area == 3.0


def test_the_arrays_of_a_solid_are_its_own_memory_and_cannot_be_written_to() -> None:
    solid = trisect.icosphere(1.0, level=3)
    vertices, faces = solid.vertices, solid.faces
    assert vertices is solid.vertices
    assert vertices.dtype == np.float64 and faces.dtype == np.uint32 and vertices.flags.c_contiguous
    again = np.asarray(solid._core.view("vertices"))
    assert again.__array_interface__["data"][0] == vertices.__array_interface__["data"][0]
    for array in (vertices, faces):
        with pytest.raises(ValueError):
            array[0, 0] = 1
        with pytest.raises(ValueError):
            array.flags.writeable = True
    copy = vertices.copy()
    del solid
    gc.collect()
    assert (vertices == copy).all()


def test_arrays_given_are_not_kept(cube: Any) -> None:
    corners, squares = cube
    solid = trisect.Solid(corners, squares)
    corners[:] = 7
    squares[:] = 0
    assert solid.volume == 1.0


def test_empty_arrays() -> None:
    for faces in ([], np.zeros((0, 3), dtype=int)):
        empty = trisect.Solid(np.zeros((0, 3)), faces)
        assert empty.is_empty and not empty and empty.volume == 0.0 and empty.faces.shape == (0, 3)
    assert np.isnan(trisect.Solid.empty().bounds).all()
    assert (trisect.Solid.empty() | trisect.cuboid([0, 0, 0], [1, 1, 1])).volume == 1.0


@pytest.mark.parametrize(
    "vertices, faces, error, words",
    [
        (np.zeros((4, 2)), TRIANGLES, trisect.ArgumentError, "shape"),
        (np.zeros(12), TRIANGLES, trisect.ArgumentError, "shape"),
        (np.zeros((2, 2, 3)), TRIANGLES, trisect.ArgumentError, "shape"),
        ("no numbers", TRIANGLES, trisect.ArgumentError, "numbers"),
        (np.zeros((4, 3), dtype=complex), TRIANGLES, trisect.ArgumentError, "real"),
        (np.array([[0, 0, 0], [1, None, 0]], dtype=object), TRIANGLES, trisect.ArgumentError, "numbers"),
        ([[0, 0, 0], [1, 2]], TRIANGLES, trisect.ArgumentError, "numbers"),
        (TETRAHEDRON, TRIANGLES.astype(float), trisect.ArgumentError, "integers"),
        (TETRAHEDRON, TRIANGLES == 0, trisect.ArgumentError, "integers"),
        (TETRAHEDRON, TRIANGLES.reshape(-1), trisect.ArgumentError, "shape"),
        (TETRAHEDRON, TRIANGLES[:, :2], trisect.ArgumentError, "three corners"),
        (TETRAHEDRON, TRIANGLES - 1, trisect.IndexOutOfRangeError, "face 0 names vertex -1"),
        (TETRAHEDRON, TRIANGLES + 1, trisect.IndexOutOfRangeError, "face 1 names vertex 4"),
        (TETRAHEDRON, TRIANGLES + 2**32, trisect.IndexOutOfRangeError, "vertex 4294967296"),
        (TETRAHEDRON, (TRIANGLES + 2**32).T.copy().T, trisect.IndexOutOfRangeError, "vertex 4294967296"),
        (TETRAHEDRON, TRIANGLES.astype(np.uint64) + np.uint64(2**63), trisect.IndexOutOfRangeError, "names vertex"),
        (TETRAHEDRON, [[0, 2, 1], [0, 1, 3, 9]], trisect.IndexOutOfRangeError, "face 1 names vertex 9"),
        (TETRAHEDRON * np.nan, TRIANGLES, trisect.NotFiniteError, "not finite"),
        (TETRAHEDRON * np.inf, TRIANGLES, trisect.NotFiniteError, "not finite"),
        (TETRAHEDRON, TRIANGLES[:, ::-1], trisect.InsideOutError, "inside out"),
        (TETRAHEDRON, TRIANGLES[1:], trisect.NotClosedError, "open edges"),
    ],
)
def test_bad_input_is_told(vertices: Any, faces: Any, error: Any, words: str) -> None:
    with pytest.raises(error) as raised:
        trisect.Solid(vertices, faces)
    assert isinstance(raised.value, (trisect.Error, ValueError))
    assert words in str(raised.value)


def test_not_a_mesh_at_all() -> None:
    for thing in (None, 7, object(), np.zeros((4, 3))):
        with pytest.raises(TypeError):
            trisect.Solid(thing)
    with pytest.raises(TypeError):
        trisect.cuboid([0, 0, 0], [1, 1, 1]) | 7  # type: ignore[operator]


def test_exceptions_carry_the_data() -> None:
    with pytest.raises(IndexError) as index:
        trisect.Solid(TETRAHEDRON, TRIANGLES + 1)
    assert (index.value.face, index.value.index) == (1, 4)  # type: ignore[attr-defined]
    with pytest.raises(trisect.NotFiniteError) as not_finite:
        spoiled = TETRAHEDRON.copy()
        spoiled[2, 1] = np.nan
        trisect.Solid(spoiled, TRIANGLES)
    assert not_finite.value.vertex == 2
    with pytest.raises(trisect.InsideOutError) as turned:
        trisect.Solid(TETRAHEDRON, TRIANGLES[:, ::-1])
    assert turned.value.volume == pytest.approx(-1 / 6)
    with pytest.raises(trisect.NotClosedError) as not_closed:
        trisect.Solid(TETRAHEDRON, TRIANGLES[1:])
    assert not_closed.value.diagnosis.open_edges.count == 3
    assert {tuple(sorted(edge)) for edge in not_closed.value.open_edges.tolist()} == {(0, 1), (1, 2), (0, 2)}
    with pytest.raises(trisect.NotClosedError) as second:
        trisect.union((TETRAHEDRON, TRIANGLES), (TETRAHEDRON, TRIANGLES[1:]))
    assert second.value.operand == 1 and "operand 2" in str(second.value)
