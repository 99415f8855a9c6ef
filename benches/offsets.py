"""Offsets beside MeshLib's and Manifold's Minkowski sum, on the same bodies, in one run.

    pip install meshlib manifold3d numpy
    python benches/offsets.py [--program target/release/trisect] [MESH DISTANCE]...

For every body: seconds (of `trisect`: the whole program, with reading and writing), triangles, the largest and mean error of the
distance of vertices and middles of triangles from the body, over the distance, and for convex bodies what the volume is off Steiner's
formula V + A d + M d^2 + 4/3 pi d^3, relative. MeshLib has voxels of the tolerance that `trisect offset` takes unasked, and of half of it;
Manifold's tool is a sphere of 32 and of 64 segments. Distances are measured by MeshLib, for all alike. MESH is an OFF, OBJ, PLY or STL
file, DISTANCE a part of its diagonal.
"""

import argparse
import math
import pathlib
import subprocess
import tempfile
import time

import manifold3d
import meshlib.mrmeshnumpy as mn
import meshlib.mrmeshpy as mm
import numpy as np


def box(a, b, c):
    """A box of these sides, and its M: half the sum over edges of length times outer angle."""
    manifold = manifold3d.Manifold.cube([a, b, c], True)
    return manifold, 0.5 * 4 * (a + b + c) * math.pi / 2


def octahedron(r):
    """An octahedron with corners r from the middle."""
    points = np.array([[r, 0, 0], [-r, 0, 0], [0, r, 0], [0, -r, 0], [0, 0, r], [0, 0, -r]], float)
    angle = math.pi - math.acos(-1 / 3)
    return manifold3d.Manifold.hull_points(points), 0.5 * 12 * r * math.sqrt(2) * angle


def arrays(manifold):
    mesh = manifold.to_mesh()
    return np.asarray(mesh.vert_properties[:, :3], float), np.asarray(mesh.tri_verts)


def volume(vertices, faces):
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    return float(np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6)


def errors(body, vertices, faces, distance):
    """Largest and mean error of the distance, over the distance."""
    places = np.concatenate([vertices, vertices[faces].mean(axis=1)])
    if len(places) > 40_000:
        places = places[np.random.default_rng(1).choice(len(places), 40_000, replace=False)]
    off = []
    for place in places:
        found = mm.findProjection(mm.Vector3f(*map(float, place)), body)
        off.append(abs(math.sqrt(found.distSq) - abs(distance)))
    return max(off) / abs(distance), sum(off) / len(off) / abs(distance)


def of_trisect(program, path, distance):
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder) / "out.ply"
        start = time.perf_counter()
        command = [program, "offset", f"--distance={distance}", str(path), "-o", str(out), "-q"]
        subprocess.run(command, check=True)
        seconds = time.perf_counter() - start
        mesh = mm.loadMesh(str(out))
        return seconds, mn.getNumpyVerts(mesh), mn.getNumpyFaces(mesh.topology)


def of_meshlib(body, distance, voxel):
    parameters = mm.OffsetParameters()
    parameters.voxelSize = voxel
    start = time.perf_counter()
    mesh = mm.offsetMesh(mm.MeshPart(body), distance, parameters)
    seconds = time.perf_counter() - start
    return seconds, mn.getNumpyVerts(mesh), mn.getNumpyFaces(mesh.topology)


def of_manifold(manifold, distance, segments):
    start = time.perf_counter()
    tool = manifold3d.Manifold.sphere(abs(distance), segments)
    grown = manifold.minkowski_sum(tool) if distance > 0 else manifold.minkowski_difference(tool)
    vertices, faces = arrays(grown)
    return time.perf_counter() - start, vertices, faces


def rows(program, name, body, path, manifold, curvature, distance):
    vertices = mn.getNumpyVerts(body)
    faces = mn.getNumpyFaces(body.topology)
    diagonal = float(np.linalg.norm(np.ptp(vertices, axis=0)))
    tolerance = max(0.05 * abs(distance), 5e-4 * diagonal)
    ways = [("trisect", lambda: of_trisect(program, path, distance))]
    for part in (1, 0.5):
        voxel = part * tolerance
        ways.append((f"MeshLib, voxels {part:g} of the tolerance", lambda voxel=voxel: of_meshlib(body, distance, voxel)))
    if manifold is not None:
        for segments in (32, 64):
            ways.append((f"Manifold, {segments} segments", lambda n=segments: of_manifold(manifold, distance, n)))
    steiner = None
    if curvature is not None and distance > 0:
        area = float(np.linalg.norm(np.cross(*(vertices[faces[:, k]] - vertices[faces[:, 0]] for k in (1, 2))), axis=1).sum() / 2)
        steiner = volume(vertices, faces) + area * distance + curvature * distance**2 + 4 / 3 * math.pi * distance**3
    for engine, way in ways:
        try:
            seconds, found, triangles = way()
        except Exception as error:  # a peer's failure is an answer
            print(f"| {name} | {engine} | fails: {str(error)[:60]} |||||", flush=True)
            continue
        most, mean = errors(body, np.asarray(found, float), np.asarray(triangles), distance)
        off = "" if steiner is None else f"{volume(np.asarray(found, float), np.asarray(triangles)) / steiner - 1:+.1e}"
        print(f"| {name} | {engine} | {seconds:.2f} | {len(triangles):,} | {most:.4f} | {mean:.4f} | {off} |", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default="target/release/trisect")
    parser.add_argument("others", nargs="*", metavar="MESH DISTANCE")
    given = parser.parse_args()
    print("| body | engine | s | triangles | largest error / distance | mean | volume against Steiner |\n|---|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as folder:
        for name, (manifold, curvature), distance in (
            ("box 2 x 3 x 4, +0.5", box(2, 3, 4), 0.5),
            ("octahedron, +0.3", octahedron(2), 0.3),
            ("box 2 x 3 x 4, -0.5", box(2, 3, 4), -0.5),
        ):
            path = pathlib.Path(folder) / "body.ply"
            body = mn.meshFromFacesVerts(arrays(manifold)[1].astype(np.int32), arrays(manifold)[0])
            mm.saveMesh(body, str(path))
            rows(given.program, name, body, path, manifold, curvature, distance)
    for path, part in zip(given.others[::2], given.others[1::2]):
        body = mm.loadMesh(path)
        distance = float(part) * float(np.linalg.norm(np.ptp(mn.getNumpyVerts(body), axis=0)))
        mesh = manifold3d.Mesh(mn.getNumpyVerts(body).astype(np.float32), mn.getNumpyFaces(body.topology).astype(np.uint32))
        manifold = manifold3d.Manifold(mesh)
        small = manifold.num_tri() <= 2000 and not manifold.is_empty()
        rows(given.program, f"{pathlib.Path(path).name}, {distance:+.3g}", body, path, manifold if small else None, None, distance)


if __name__ == "__main__":
    main()
