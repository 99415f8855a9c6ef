"""Closed triangle meshes made by formula, for the comparison of engines.

A mesh is a pair (positions, triangles): float64 of shape (n, 3) and int32 of shape (m, 3), both contiguous, triangles
counter-clockwise seen from outside. Everything is deterministic.
"""
import numpy as np


def mesh(positions, triangles):
    return np.ascontiguousarray(positions, np.float64), np.ascontiguousarray(triangles, np.int32)


def rotation(angle, axis):
    """The matrix that turns by `angle` radians about `axis` (Rodrigues)."""
    x, y, z = np.asarray(axis, float) / np.linalg.norm(axis)
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross


def placed(shape, turn=None, scale=1.0, at=(0.0, 0.0, 0.0)):
    """The mesh scaled, then turned by the matrix `turn`, then moved by `at`."""
    positions = shape[0] * scale
    if turn is not None:
        positions = positions @ turn.T
    return mesh(positions + np.asarray(at, float), shape[1])


def together(shapes):
    """Several meshes as one with several bodies."""
    starts = np.cumsum([0] + [len(positions) for positions, _ in shapes])
    return mesh(
        np.concatenate([positions for positions, _ in shapes]),
        np.concatenate([triangles + start for (_, triangles), start in zip(shapes, starts)]),
    )


def volume(shape):
    positions, triangles = shape
    if len(triangles) == 0:
        return 0.0
    a, b, c = (positions[triangles[:, k]] - positions[triangles].mean(axis=(0, 1)) for k in range(3))
    return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6)


def icosphere(level):
    """The unit icosphere: 20 * 4**level triangles."""
    golden = (1 + 5**0.5) / 2
    positions = []
    for sign in (-1, 1):
        for other in (-golden, golden):
            positions += [(0, sign, other), (sign, other, 0), (other, 0, sign)]
    positions = np.array(positions) / np.hypot(1, golden)
    # The faces of an icosahedron are the triples of corners that are mutual neighbours.
    near = np.linalg.norm(positions[:, None] - positions, axis=2) < 1.1
    triangles = []
    for a in range(12):
        for b in range(a + 1, 12):
            for c in range(b + 1, 12):
                if near[a, b] and near[b, c] and near[a, c]:
                    outward = np.linalg.det(positions[[a, b, c]]) > 0
                    triangles.append((a, b, c) if outward else (a, c, b))
    triangles = np.array(triangles, np.int64)
    for _ in range(level):
        positions, triangles = quadrisected(positions, triangles)
        positions /= np.linalg.norm(positions, axis=1)[:, None]
    return mesh(positions, triangles)


def quadrisected(positions, triangles):
    """Every triangle cut into four at the middles of its edges."""
    count = len(positions)
    sides = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    sides.sort(axis=1)
    edges, edge_of = np.unique(sides[:, 0] * count + sides[:, 1], return_inverse=True)
    middles = 0.5 * (positions[edges // count] + positions[edges % count])
    ab, bc, ca = count + edge_of.reshape(3, -1)
    a, b, c = triangles.T
    parts = [(a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca)]
    return np.concatenate([positions, middles]), np.concatenate([np.stack(part, axis=1) for part in parts])


def bumpy_sphere(level, phases, height=0.02, frequency=40.0):
    """An icosphere whose radius waves in all three coordinates."""
    positions, triangles = icosphere(level)
    waves = np.sin(frequency * positions + np.asarray(phases)).prod(axis=1)
    return mesh(positions * (1 + height * waves)[:, None], triangles)


def box(low, high):
    corners = np.array([[(low, high)[k >> axis & 1][axis] for axis in range(3)] for k in range(8)], float)
    faces = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    return mesh(corners, [t for a, b, c, d in faces for t in ((a, b, c), (a, c, d))])


def ring(count):
    angles = 2 * np.pi * np.arange(count) / count
    return np.stack([np.cos(angles), np.sin(angles)], axis=1)


def cylinder(radius, low, high, sides):
    """Along z from `low` to `high`; the caps are fans round their middles: 4 * sides triangles."""
    circle = radius * ring(sides)
    flat = [np.column_stack([circle, np.full(sides, z)]) for z in (low, high)]
    positions = np.concatenate(flat + [[(0, 0, low), (0, 0, high)]])
    i = np.arange(sides)
    j = (i + 1) % sides
    bottom, top = np.full(sides, 2 * sides), np.full(sides, 2 * sides + 1)
    faces = [(i, j, sides + i), (j, sides + j, sides + i), (j, i, bottom), (sides + i, sides + j, top)]
    return mesh(positions, np.concatenate([np.stack(face, axis=1) for face in faces]))


def double_cone(sides, height=1.0):
    """Two fans of `sides` triangles each, over a common circle of radius 1."""
    positions = np.concatenate([np.column_stack([ring(sides), np.zeros(sides)]), [(0, 0, height), (0, 0, -height)]])
    i = np.arange(sides)
    j = (i + 1) % sides
    upper = np.stack([i, j, np.full(sides, sides)], axis=1)
    lower = np.stack([j, i, np.full(sides, sides + 1)], axis=1)
    return mesh(positions, np.concatenate([upper, lower]))


def urchin(level, seed, shortest=1.5, longest=4.0):
    """An icosphere with a needle on every triangle: 3 * 20 * 4**level triangles, of which no two cross."""
    positions, triangles = icosphere(level)
    middles = positions[triangles].mean(axis=1)
    lengths = np.random.default_rng(seed).uniform(shortest, longest, len(triangles))
    tips = middles / np.linalg.norm(middles, axis=1)[:, None] * lengths[:, None]
    tip = len(positions) + np.arange(len(triangles))
    a, b, c = triangles.T
    faces = [np.stack(face, axis=1) for face in ((a, b, tip), (b, c, tip), (c, a, tip))]
    return mesh(np.concatenate([positions, tips]), np.concatenate(faces))


def knotted_tube(steps=2000, around=50, tube=0.35):
    """A tube round the torus knot (2, 3) with radii 2 and 0.9: 2 * steps * around triangles."""
    t = 2 * np.pi * np.arange(steps) / steps
    reach, turn2, turn3 = 2 + 0.9 * np.cos(3 * t), 2 * t, 3 * t
    centre = np.stack([reach * np.cos(turn2), reach * np.sin(turn2), 0.9 * np.sin(turn3)], axis=1)
    reach1, reach2 = -2.7 * np.sin(turn3), -8.1 * np.cos(turn3)
    cos, sin = np.cos(turn2), np.sin(turn2)
    tangent = np.stack([reach1 * cos - 2 * reach * sin, reach1 * sin + 2 * reach * cos, 2.7 * np.cos(turn3)], axis=1)
    bend = np.stack([
        reach2 * cos - 4 * reach1 * sin - 4 * reach * cos,
        reach2 * sin + 4 * reach1 * cos - 4 * reach * sin,
        -8.1 * np.sin(turn3),
    ], axis=1)
    tangent /= np.linalg.norm(tangent, axis=1)[:, None]
    normal = bend - np.einsum("ij,ij->i", bend, tangent)[:, None] * tangent
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    binormal = np.cross(tangent, normal)
    circle = tube * ring(around)
    positions = centre[:, None] + circle[:, 0, None] * normal[:, None] + circle[:, 1, None] * binormal[:, None]
    i, j = np.arange(steps)[:, None], np.arange(around)[None]
    i1, j1 = (i + 1) % steps, (j + 1) % around
    a, b, c, d = (x.ravel() for x in (i * around + j, i1 * around + j, i1 * around + j1, i * around + j1))
    triangles = np.concatenate([np.stack([a, c, b], axis=1), np.stack([a, d, c], axis=1)])
    return mesh(positions.reshape(-1, 3), triangles)


def menger(depth):
    """A cube of side 3**depth and, for each axis, the square bars that bore a Menger sponge out of it."""
    side = 3**depth
    bars = [[], [], []]
    for level in range(depth):
        width = side // 3 ** (level + 1)
        for u in range(3**level):
            for v in range(3**level):
                if inside_a_wider_hole(u, v):
                    continue
                start = np.array([3 * u + 1, 3 * v + 1]) * width
                for axis in range(3):
                    low, high = np.insert(start, axis, -1), np.insert(start + width, axis, side + 1)
                    bars[axis].append(box(low, high))
    return [box((0, 0, 0), (side, side, side))] + [together(of_axis) for of_axis in bars]


def inside_a_wider_hole(u, v):
    """Whether cell (u, v) of a level of the sponge lies in a hole of a coarser one: both have the digit 1 in base 3."""
    while u or v:
        if u % 3 == 1 and v % 3 == 1:
            return True
        u, v = u // 3, v // 3
    return False
