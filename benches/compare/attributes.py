"""Judges texture coordinates of a boolean's result, from files alone.

    python benches/compare/attributes.py RESULT OPERAND [OPERAND ...]

Knows nothing of trisect: files are read by trimesh, and every corner of the result must have the texture coordinates that some
triangle of an operand has at that place, by weights in rational arithmetic. The middle of every triangle is looked at too, so
that a triangle that lies across two cells of a texture shows. Exits with 1 above the tolerance (default 1e-6, in units of the
largest texture coordinate).

Needs numpy and trimesh. For results in GLB or other single-precision files give a --reach in the order of their rounding.
"""

import argparse
import sys
from fractions import Fraction

import numpy as np
import trimesh


def load(path):
    """Triangles of a file: corners (n, 3, 3), texture coordinates (n, 3, 2), and whether there are any (n)."""
    # (In the order of the file, trimesh would give each vertex of an OBJ one pair of coordinates.)
    scene = trimesh.load(path, process=False, maintain_order=False)
    parts = scene.dump() if isinstance(scene, trimesh.Scene) else [scene]
    corners, coordinates, known = [], [], []
    for part in parts:
        faces = np.asarray(part.faces)
        corners.append(np.asarray(part.vertices, dtype=np.float64)[faces])
        uv = getattr(part.visual, "uv", None)
        has = uv is not None and len(uv) == len(part.vertices)
        coordinates.append(np.asarray(uv, dtype=np.float64)[faces] if has else np.zeros((len(faces), 3, 2)))
        known.append(np.full(len(faces), has))
    return np.concatenate(corners), np.concatenate(coordinates), np.concatenate(known)


def foot(triangle, place):
    """The weights at the foot of a place in the plane of a triangle, exactly; None for a triangle without area."""
    a, b, c, p = ([Fraction(float(x)) for x in point] for point in (*triangle, place))
    minus = lambda x, y: [s - t for s, t in zip(x, y)]
    dot = lambda x, y: sum(s * t for s, t in zip(x, y))
    u, v, d = minus(b, a), minus(c, a), minus(p, a)
    uu, uv, vv, ud, vd = dot(u, u), dot(u, v), dot(v, v), dot(u, d), dot(v, d)
    determinant = uu * vv - uv * uv
    if determinant == 0:
        return None
    wb, wc = (vv * ud - uv * vd) / determinant, (uu * vd - uv * ud) / determinant
    return [1 - wb - wc, wb, wc]


def error_at(place, found, operands, reach):
    """How far texture coordinates are from those of the nearest triangle that holds the place; None if none does."""
    corners, coordinates, low, high = operands
    near = np.flatnonzero(np.all((low <= place + reach) & (high >= place - reach), axis=1))
    best = None
    for t in near:
        weights = foot(corners[t], place)
        if weights is None:
            continue
        # Pulled into the triangle, and no further from it than rounding moves a point.
        weights = [min(max(w, Fraction(0)), Fraction(1)) for w in weights]
        total = sum(weights)
        weights = [float(w / total) for w in weights]
        if np.linalg.norm(weights @ corners[t] - place) > reach:
            continue
        error = np.abs(weights @ coordinates[t] - found).max()
        best = error if best is None else min(best, error)
    return best


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("result")
    parser.add_argument("operands", nargs="+")
    parser.add_argument("--tolerance", type=float, default=1e-6)
    parser.add_argument("--reach", type=float, default=1e-9, help="how far points may be off, relative to the largest coordinate")
    arguments = parser.parse_args()

    corners, coordinates, known = load(arguments.result)
    loaded = [load(path) for path in arguments.operands]
    given = [np.concatenate([part[i][part[2]] for part in loaded]) for i in (0, 1)]
    operands = (*given, given[0].min(axis=1), given[0].max(axis=1))
    reach = arguments.reach * np.abs(corners).max()
    size = max(1.0, np.abs(given[1]).max())

    worst, asked, elsewhere = 0.0, 0, 0
    for triangle, uv in zip(corners[known], coordinates[known]):
        # What is not of these operands, such as the wall of a hole that a tool without texture left, is only counted.
        in_the_middle = error_at(triangle.mean(axis=0), uv.mean(axis=0), operands, reach)
        if in_the_middle is None:
            elsewhere += 1
            continue
        errors = [error_at(place, found, operands, reach) for place, found in zip(triangle, uv)]
        asked += 4
        worst = max([worst, in_the_middle / size, *(np.inf if error is None else error / size for error in errors)])
    print(
        f"{arguments.result}: {len(corners)} triangles, {int(known.sum())} with texture coordinates, "
        f"{elsewhere} not of these operands; {asked} places, largest error {worst:.2e}"
    )
    return int(worst > arguments.tolerance or asked == 0)


if __name__ == "__main__":
    sys.exit(main())
