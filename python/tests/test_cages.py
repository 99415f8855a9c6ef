"""Cages: made, read and written, refined, combined."""

from __future__ import annotations

import pickle
from typing import Any

import numpy as np
import pytest

import trisect

CORNERS = [[x, y, z] for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)]
SQUARES = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]


@pytest.fixture
def cube() -> trisect.Cage:
    """A cube of squares, one edge of which is sharp for ever and one for two subdivisions and a half."""
    return trisect.Cage(CORNERS, SQUARES, creases=[(1, 0), (0, 2, 2.5)], corners=[7, (6, 3.0)])


@pytest.fixture
def ball() -> trisect.Cage:
    """A ball of triangles."""
    made = trisect.icosphere(1.0, level=2)
    return trisect.Cage(made.vertices, made.faces)


def test_what_it_was_made_of(cube: trisect.Cage, ball: trisect.Cage) -> None:
    assert cube.scheme == "catmull-clark" and cube.rules is None and cube.is_closed and cube.report is None
    assert cube.vertices.tolist() == CORNERS and cube.faces.tolist() == SQUARES
    assert cube.creases == [(0, 1, np.inf), (0, 2, 2.5)] and cube.corners == [(6, 3.0), (7, np.inf)] and cube.sectors == []
    assert ball.scheme == ball.rules == "loop" and ball.faces.shape == (320, 3)
    mixed = trisect.Cage([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0.5, 0.5, 1]], [[3, 2, 1, 0], [0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]])
    assert isinstance(mixed.faces, list) and len(mixed.faces[0]) == 4 and mixed.mesh().faces.shape == (6, 3)
    with pytest.warns(trisect.TrisectWarning):
        assert trisect.Cage(CORNERS, SQUARES, scheme="loop").faces.shape == (12, 3)
    assert trisect.Cage(ball.vertices, ball.faces, rules="opensubdiv").rules == "opensubdiv"
    assert trisect.Cage(CORNERS, SQUARES, creases=[(0, 1)]) == trisect.Cage(CORNERS, SQUARES, creases=[(1, 0, 10)])


def test_the_limit_surface(cube: trisect.Cage, ball: trisect.Cage) -> None:
    coarse, fine = ball.solid(0.01), ball.solid(0.001)
    assert len(fine.faces) > len(coarse.faces) and abs(fine.volume - coarse.volume) < 0.1
    # Refined, it is the same surface.
    assert ball.refine().solid(0.001).volume == pytest.approx(fine.volume, rel=1e-3)
    assert len(ball.refine(2).faces) == 16 * 320 and ball.refine(0) == ball
    assert len(ball.limit_mesh(refine=1).faces) == 4 * 320
    sharp = trisect.Cage(CORNERS, SQUARES).with_creases(30)
    assert len(sharp.creases) == 12 and sharp.solid(0.01).volume == pytest.approx(8.0, rel=1e-12)
    # As an operand of exact booleans, and of nothing else than a solid.
    assert (trisect.cuboid([-2, -2, -2], [2, 2, 2]) - cube.solid(0.01)).is_manifold
    with pytest.raises(trisect.NotClosedError):
        trisect.Cage(CORNERS, SQUARES[1:]).solid(0.01)
    moved = cube.scaled(2).rotated("z", 90).translated([5, 0, 0])
    assert moved.solid(0.02).volume == pytest.approx(8 * cube.solid(0.01).volume, rel=1e-2) and moved.vertices[:, 0].min() == 3
    mirrored = cube.transformed(np.diag([-1.0, 1, 1, 1]))
    assert mirrored.solid(0.01).volume == pytest.approx(cube.solid(0.01).volume, rel=1e-4)


@pytest.mark.parametrize("kind", ["obj", "json", "glb"])
def test_files_and_pickles_keep_all(cube: trisect.Cage, tmp_path: Any, kind: str) -> None:
    path = tmp_path / f"cage.{kind}"
    cube.save(path)
    assert trisect.Cage.load(path) == cube and hash(trisect.Cage.load(path)) == hash(cube)
    assert pickle.loads(pickle.dumps(cube)) == cube
    assert list(tmp_path.iterdir()) == [path]
    with pytest.raises(trisect.ArgumentError):
        cube.save(tmp_path / "cage.stl")
    with pytest.raises(FileNotFoundError):
        trisect.Cage.load(tmp_path / "none.obj")


def test_booleans_give_cages(ball: trisect.Cage) -> None:
    other = ball.translated([0.9, 0.1, 0.2])
    both = trisect.combine_cages("union", ball, other, tolerance=0.02)
    assert both.report.reached and both.report.errors.largest <= 0.02 and both.cage.report == both.report
    assert both.cage.is_closed and both.cage.creases
    exact, near = both.exact.volume, both.cage.solid(0.002).volume
    assert near == pytest.approx(exact, rel=0.02)
    # Points that nothing was done to are the operands', bit for bit.
    kept = ~both.origins.moved
    assert kept.any() and len(kept) == len(both.cage.vertices)
    sources = np.stack([ball.vertices, other.vertices])
    assert (both.cage.vertices[kept] == sources[both.origins.operand[kept], both.origins.vertex[kept]]).all()
    assert (both.origins.operand[both.origins.vertex < 0] == -1).all()
    lens, bite = ball & other, ball - other
    assert lens.report is not None and bite.report is not None
    assert lens.solid(0.002).volume + bite.solid(0.002).volume == pytest.approx(ball.solid(0.002).volume, rel=0.01)
    assert pickle.loads(pickle.dumps(lens)).report == lens.report


def test_any_number_at_once(ball: trisect.Cage) -> None:
    three = [ball.translated([0.7 * i, 0.1 * i, 0.05 * i]) for i in range(3)]
    made = trisect.combine_cages("union", three, tolerance=0.05)
    assert made.report.errors.largest < 0.05 and sorted(set(made.origins.operand.tolist())) == [-1, 0, 1, 2]
    with pytest.raises(TypeError, match="operand 2"):
        trisect.combine_cages("union", ball, 7)


def test_polygons_are_fitted_and_that_is_told() -> None:
    cube = trisect.Cage(CORNERS, SQUARES)
    with pytest.warns(trisect.TrisectWarning, match="fitted to the Catmull-Clark surface"):
        made = trisect.combine_cages("difference", cube, cube.translated([0.6, 0.1, 0.2]), tolerance=0.05)
    assert made.cage.scheme == "loop" and made.exact.volume > 0


def test_what_is_refused(ball: trisect.Cage) -> None:
    for wrong in (
        lambda: trisect.Cage(CORNERS, [[0, 1, 99]]),
        lambda: trisect.Cage(CORNERS, [[0, -1, 2]]),
        lambda: trisect.Cage(np.full((8, 3), np.nan), SQUARES),
        lambda: trisect.Cage(CORNERS, SQUARES, rules="round"),
        lambda: trisect.Cage(CORNERS, SQUARES, scheme="doo-sabin"),
        lambda: trisect.Cage(CORNERS, SQUARES, creases=[(0, 7)]),
        lambda: ball.limit_mesh(0.0),
        lambda: ball.refine(-1),
        lambda: ball.rotated("w", 1),
        lambda: trisect.combine_cages("xor", ball, ball),
        lambda: trisect.combine_cages("union", ball, ball, tolerance=-1),
        lambda: trisect.combine_cages("union", ball, trisect.Cage(ball.vertices, ball.faces[1:])),
    ):
        with pytest.raises(trisect.Error) as caught:
            wrong()
        assert str(caught.value)
    with pytest.raises(trisect.LimitError):
        trisect.combine_cages("union", ball, ball.translated([0.9, 0.1, 0.2]), deadline=0.0)
    with pytest.raises(TypeError):
        ball | 7
