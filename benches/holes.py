"""A plate with 10,000 holes in one difference, beside Manifold's and MeshLib's ways to do it.

    pip install meshlib manifold3d numpy
    python benches/holes.py [--program target/release/trisect] [--side 100] [--segments 16]

The drills are given as one mesh that holds all of them, which for disjoint drills is the best way of both others (`Manifold.compose` before one
difference; a boolean of two meshes), and for Manifold as a list for its n-ary difference, too. Processor times: of `trisect` the whole program,
which makes the drills and writes the result as STL; of the others the boolean alone, from meshes in memory.
"""

import argparse
import pathlib
import resource
import subprocess
import tempfile
import time

import manifold3d
import numpy as np


def trisect(program, side, segments):
    shift = -(side - 1) / 2
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder) / "sieve.stl"
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run(
            [program, "difference", f"box:{side + 2},{side + 2},2", f"cylinder:0.3,4,{segments}",
             f"--translate={shift},{shift},0", "--pattern", f"grid:{side}x{side}:1,1", "-o", str(out), "-q"],
            check=True)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        triangles = int.from_bytes(out.read_bytes()[80:84], "little")
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, triangles


def bodies(side, segments):
    plate = manifold3d.Manifold.cube([side + 2, side + 2, 2], True)
    drill = manifold3d.Manifold.cylinder(4, 0.3, 0.3, segments, True)
    middle = (side - 1) / 2
    drills = [drill.translate([i - middle, j - middle, 0]) for i in range(side) for j in range(side)]
    return plate, drills


def timed(make):
    start = time.process_time()
    made = make()
    return time.process_time() - start, made


def meshlib(plate, drills):
    import meshlib.mrmeshnumpy as mn
    import meshlib.mrmeshpy as mm

    def mesh(manifold):
        arrays = manifold.to_mesh()
        faces = np.ascontiguousarray(arrays.tri_verts, dtype=np.int32)
        return mn.meshFromFacesVerts(faces, np.ascontiguousarray(arrays.vert_properties[:, :3], dtype=np.float64))

    a, b = mesh(plate), mesh(manifold3d.Manifold.compose(drills))
    return timed(lambda: mm.boolean(a, b, mm.BooleanOperation.DifferenceAB))


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--program", default="target/release/trisect")
    parser.add_argument("--side", type=int, default=100)
    parser.add_argument("--segments", type=int, default=16)
    given = parser.parse_args()
    seconds, triangles = trisect(given.program, given.side, given.segments)
    print(f"trisect, file to file: {seconds:.2f} s, {triangles} triangles")
    plate, drills = bodies(given.side, given.segments)
    joined = manifold3d.Manifold.compose(drills)
    joined.num_tri()
    seconds, made = timed(lambda: (lambda m: (m, m.num_tri()))(plate - joined)[1])
    print(f"Manifold, one difference of all drills composed: {seconds:.2f} s, {made} triangles")
    seconds, made = timed(
        lambda: manifold3d.Manifold.batch_boolean([plate, *drills], manifold3d.OpType.Subtract).num_tri())
    print(f"Manifold, batch_boolean: {seconds:.2f} s, {made} triangles")
    try:
        seconds, made = meshlib(plate, drills)
    except ImportError:
        print("MeshLib: not installed")
        return
    valid = made.valid()
    count = made.mesh.topology.numValidFaces() if valid else made.errorString
    print(f"MeshLib, one boolean: {seconds:.2f} s, {count} triangles" if valid else f"MeshLib: {count}")


main()
