"""The wall of hollowed models, measured from both sides.

    pip install meshlib numpy
    python benches/walls.py [--program target/release/trisect] MESH WALL [DRAIN]...

WALL is a part of the diagonal of MESH (an OFF, OBJ, PLY or STL file); a DRAIN is a number of a vertex of it: a hole goes in there, of half the
wall in radius. Prints, of vertices and middles of triangles, distances as parts of the wall: of the cavity from the model, where every one
should be 1 within the tolerance; and of the model from the cavity, which are at least that, and more where the body is too thin to be hollow.
What is within a radius of a drain's axis is left out. Distances are MeshLib's. For anything that a distance cannot tell, `closed` says whether
every directed edge of the hollow model has one other way round.
"""

import argparse
import json
import math
import pathlib
import subprocess
import tempfile
import time

import meshlib.mrmeshnumpy as mn
import meshlib.mrmeshpy as mm
import numpy as np

# Points measured of each side, at most: a projection takes some microseconds, and its call from Python ten times that.
MOST = 40_000
# Of the radius of a drain: what is nearer to its axis is of the hole.
BESIDE = 1.05


def arrays(path):
    mesh = mm.loadMesh(str(path))
    return mesh, mn.getNumpyVerts(mesh).astype(float), mn.getNumpyFaces(mesh.topology)


def places(vertices, faces):
    return np.concatenate([vertices[np.unique(faces)], vertices[faces].mean(axis=1)])


def some(points):
    return points if len(points) <= MOST else points[np.random.default_rng(1).choice(len(points), MOST, replace=False)]


def distances(mesh, points):
    found = (mm.findProjection(mm.Vector3f(*map(float, point)), mesh) for point in points)
    return np.array([math.sqrt(one.distSq) for one in found])


def outward(vertices, faces, number):
    around = faces[(faces == number).any(axis=1)]
    a, b, c = (vertices[around[:, k]] for k in range(3))
    normal = np.cross(b - a, c - a).sum(axis=0)
    return normal / np.linalg.norm(normal)


def is_closed(faces):
    edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]).astype(np.int64)
    forth = np.sort(edges[:, 0] << 32 | edges[:, 1])
    back = np.sort(edges[:, 1] << 32 | edges[:, 0])
    return bool((forth == back).all() and (forth[1:] != forth[:-1]).all())


def row(name, part, values):
    low, high = np.percentile(values, [5, 95])
    print(f"| {name} | {part} | {len(values):,} | {values.min():.4f} | {low:.4f} | {np.median(values):.4f} | {high:.4f} | {values.max():.4f} |")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default="target/release/trisect")
    parser.add_argument("mesh")
    parser.add_argument("wall", type=float)
    parser.add_argument("drains", nargs="*", type=int)
    given = parser.parse_args()
    model, vertices, faces = arrays(given.mesh)
    wall = given.wall * float(np.linalg.norm(np.ptp(vertices, axis=0)))
    radius = wall / 2
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder) / "hollow.ply"
        command = [given.program, "hollow", given.mesh, f"--wall={wall!r}", "-o", str(out), "--json"]
        command += [f"--drain={','.join(map(repr, map(float, vertices[number])))}:{radius!r}" for number in given.drains]
        start = time.perf_counter()
        report = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
        seconds = time.perf_counter() - start
        _, made, triangles = arrays(out)
    tolerance = report["tolerance"] / wall
    # 1. What is beside the drains, and of that what is of the model and of the cavity.
    beside = np.ones(len(made), bool)
    for number in given.drains:
        to = made - vertices[number]
        axis = outward(vertices, faces, number)
        off = np.linalg.norm(to - np.outer(to @ axis, axis), axis=1)
        beside &= (off > BESIDE * radius) | (np.linalg.norm(to, axis=1) > 4 * wall)
    deep = distances(model, made) > wall / 2
    inner = triangles[(deep & beside)[triangles].all(axis=1)]
    outer = triangles[(~deep & beside)[triangles].all(axis=1)]
    cavity = mn.meshFromFacesVerts(inner.astype(np.int32), made)
    # 2. How far each is from the other.
    name = f"{pathlib.Path(given.mesh).name}, {len(given.drains)} drains"
    print(f"{name}: {len(triangles):,} triangles, closed {is_closed(triangles)}, {seconds:.1f} s, tolerance {tolerance:.4f} of the wall,")
    print(f"deviation {report['deviation'] / wall:.4f}, normals {report['normal_deviation']:.2f} degrees")
    print("| model | from | points | least | 5 of 100 | half | 95 of 100 | most |\n|---|---|---|---|---|---|---|---|")
    row(name, "the cavity", distances(model, some(places(made, inner))) / wall)
    row(name, "the model", distances(cavity, some(places(made, outer))) / wall)


if __name__ == "__main__":
    main()
