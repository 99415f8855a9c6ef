"""Cuts and sections beside trimesh, Manifold and MeshLib, on one thread where that can be chosen.

    pip install trimesh manifold3d meshlib numpy scipy shapely networkx mapbox_earcut
    cargo build --release --example cut_times
    python benches/cuts.py target/release/examples/cut_times MODEL...

Prints a table row for each model: milliseconds of the fastest of some runs, and what is wrong with a result if anything is.
"""

import json
import subprocess
import sys
import time

import manifold3d
import numpy
import trimesh


def fastest(runs, work):
    best, result = float("inf"), None
    for _ in range(runs):
        start = time.perf_counter()
        result = work()
        best = min(best, (time.perf_counter() - start) * 1e3)
        if best > 5e3:
            break
    return best, result


def off(parts, whole, box):
    return abs(sum(parts) - whole) / box


def main(program, paths):
    for path in paths:
        lines = subprocess.run([program, path], capture_output=True, text=True, check=True).stdout.splitlines()
        own = [json.loads(line) for line in lines]
        mesh = trimesh.load(path, force="mesh", process=True)
        low, high = mesh.bounds
        centre, box = (low + high) / 2, float(numpy.prod(high - low))
        solid = manifold3d.Manifold(
            manifold3d.Mesh64(
                vert_properties=numpy.asarray(mesh.vertices, dtype=numpy.float64),
                tri_verts=numpy.asarray(mesh.faces, dtype=numpy.uint64),
            )
        )
        usable = solid.status() == manifold3d.Error.NoError
        for name, normal in [("z", [0.0, 0.0, 1.0]), ("oblique", [1.0, 2.0, 3.0])]:
            normal = numpy.array(normal)
            row = {"model": path.split("/")[-1], "triangles": len(mesh.faces), "plane": name}
            row["trisect"] = next(line["ms"] for line in own if line.get("plane") == name)
            row["trisect off"] = next(line["off"] for line in own if line.get("plane") == name)
            if usable:
                offset = float(normal @ centre) / float(numpy.linalg.norm(normal))

                def by_manifold():
                    above, below = solid.split_by_plane(tuple(normal), offset)
                    return above.volume(), below.volume()

                row["manifold"], parts = fastest(5, by_manifold)
                row["manifold off"] = off(parts, solid.volume(), box)
                row["manifold trim"], _ = fastest(5, lambda: solid.trim_by_plane(tuple(normal), offset).volume())

            def by_trimesh():
                return [
                    trimesh.intersections.slice_mesh_plane(mesh, sign * normal, centre, cap=True) for sign in (1, -1)
                ]

            try:
                row["trimesh"], halves = fastest(3, by_trimesh)
                row["trimesh off"] = off([half.volume for half in halves], mesh.volume, box)
                row["trimesh closed"] = all(half.is_watertight for half in halves)
            except Exception as error:  # noqa: BLE001
                row["trimesh"] = f"refused: {str(error)[:60]}"
            print(json.dumps(row), flush=True)
        heights = (numpy.arange(1000) + 0.5) / 1000 * (high[2] - low[2])
        row = {"model": path.split("/")[-1], "layers": 1000}
        line = next(line for line in own if "layers" in line)
        row["trisect"], row["integral off"] = line["ms"], abs(line["integral"] - line["volume"]) / box

        def planes():
            return mesh.section_multiplane(low, [0, 0, 1], heights)

        row["trimesh"], sections = fastest(1, planes)
        start = time.perf_counter()
        areas = [0.0 if section is None else section.area for section in sections]
        row["trimesh polygons"] = (time.perf_counter() - start) * 1e3
        row["trimesh integral off"] = abs(sum(areas) * (high[2] - low[2]) / 1000 - mesh.volume) / box
        if usable:
            # A section one by one is all that it has.
            row["manifold"], _ = fastest(1, lambda: sum(solid.slice(float(low[2] + h)).area() for h in heights))
        try:
            from meshlib import mrmeshpy

            loaded = mrmeshpy.loadMesh(path)
            levels = [float(low[2] + h) for h in heights]
            up = mrmeshpy.Vector3f(0, 0, 1)
            row["meshlib"], _ = fastest(
                3, lambda: [mrmeshpy.extractPlaneSections(loaded, mrmeshpy.Plane3f(up, level)) for level in levels]
            )
            # The other one looks in a hierarchy of boxes, which it makes at its first call.
            row["meshlib, XY"], _ = fastest(
                3, lambda: [mrmeshpy.extractXYPlaneSections(loaded, level) for level in levels]
            )
        except Exception as error:  # noqa: BLE001
            row["meshlib"] = f"refused: {str(error)[:60]}"
        print(json.dumps(row), flush=True)


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2:])
