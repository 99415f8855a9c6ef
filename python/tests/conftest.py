"""What tests have in common."""

from __future__ import annotations

import os
import pathlib
from typing import Any, Tuple

import numpy as np
import pytest

import trisect

FIXTURES = pathlib.Path(os.environ.get("TRISECT_FIXTURES", pathlib.Path(__file__).parents[2] / "fixtures"))


@pytest.fixture
def fixtures() -> pathlib.Path:
    """The folder of mesh files beside the crate."""
    return FIXTURES


@pytest.fixture
def pair() -> Tuple[trisect.Solid, trisect.Solid]:
    """Two cubes that overlap in a corner."""
    return trisect.cuboid([0, 0, 0], [1, 1, 1]), trisect.cuboid([0.5, 0.5, 0.5], [1.5, 1.5, 1.5])


CORNERS = np.array([[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)], dtype=float)
SQUARES = np.array([[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]])


@pytest.fixture
def cube() -> Tuple[Any, Any]:
    """Corners and squares of a cube."""
    return CORNERS.copy(), SQUARES.copy()


@pytest.fixture
def balls() -> Tuple[trisect.Solid, trisect.Solid]:
    """Two balls of 20,480 triangles that overlap: large enough to be watched."""
    ball = trisect.icosphere(1.0, level=5)
    return ball, ball.rotated([1, 2, 3], 40).translated([0.5, 0.1, 0.2])
