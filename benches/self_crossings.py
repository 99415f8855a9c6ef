"""The search for self-crossings beside MeshLib and trueform, on one thread where that can be chosen.

    pip install meshlib trueform trimesh numpy
    cargo build --release --example check_times
    python benches/self_crossings.py target/release/examples/check_times MODEL...

Prints a row for each model: nanoseconds for each triangle, the least of some runs, and what was found. trisect tells all pairs that cross
deeper than rounding; MeshLib all that meet, in single precision; trueform whether there is any, and stops at the first.
"""

import json
import os
import subprocess
import sys
import time

os.environ["RAYON_NUM_THREADS"] = "1"
os.sched_setaffinity(0, {0})

import meshlib.mrmeshnumpy as from_numpy
import meshlib.mrmeshpy as meshlib
import numpy
import trimesh
import trueform

SECONDS = 3.0


def least(make, work):
    """Nanoseconds of `work` on a fresh object, and what it gave."""
    best, result, start = float("inf"), None, time.perf_counter()
    while time.perf_counter() - start < SECONDS or result is None:
        thing = make()
        begin = time.perf_counter()
        result = work(thing)
        best = min(best, time.perf_counter() - begin)
    return best * 1e9, result


def main(program, models):
    print("| model | triangles | trisect | MeshLib | trueform | found by each | of the fastest |")
    print("|---|---:|---:|---:|---:|---|---:|")
    for model in models:
        own = json.loads(subprocess.run([program, model], capture_output=True, text=True, check=True).stdout)
        if model.startswith("ico:"):
            mesh = trimesh.creation.icosphere(subdivisions=int(model[4:]))
        else:
            mesh = trimesh.load(model, force="mesh", process=True)
        positions = numpy.asarray(mesh.vertices, dtype=numpy.float64)
        faces = numpy.asarray(mesh.faces, dtype=numpy.int32)
        theirs = [
            least(
                lambda: from_numpy.meshFromFacesVerts(faces, positions),
                lambda mesh: len(meshlib.findSelfCollidingTriangles(meshlib.MeshPart(mesh))),
            ),
            least(lambda: trueform.Mesh(faces, positions), trueform.has_self_intersections),
        ]
        each = [nanoseconds / len(faces) for nanoseconds, _ in theirs]
        found = [own["crossings"]] + [result for _, result in theirs]
        print(
            f"| {os.path.basename(model)} | {own['triangles']:,} | {own['check']:.0f} | {each[0]:.0f} | {each[1]:.0f} "
            f"| {', '.join(map(str, found))} | {own['check'] / min(each):.2f} |",
            flush=True,
        )


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2:])
