#!/usr/bin/env python3
"""What else one may do with the boolean of two free forms: its exact triangles remeshed to quads by QuadriFlow, and those as a
Catmull-Clark cage; and decimated to triangles.

    cargo run --release --example free_form_cases -- FOLDER     # cages and exact results
    python3 benches/free_forms.py FOLDER OUT                    # needs bpy (Blender as a module) and fast-simplification
    cargo run --release --example free_form_cases -- apart FOLDER/NAME-exact.ply OUT/NAME-quads.ply

Both get as many control points as the cage of `freeform` has. OUT gets their surfaces, to be measured by the last command; printed are
the control points and the seconds that the remeshing took.
"""
import pathlib, sys, time

import bpy
import bmesh  # comes with bpy
import fast_simplification
import numpy

# Subdivisions of the cage of quads: more change the surface by less than its distance from the exact one.
LEVELS = 4


def arrays(mesh):
    positions = numpy.empty(3 * len(mesh.vertices), numpy.float32)
    mesh.vertices.foreach_get("co", positions)
    mesh.calc_loop_triangles()
    corners = numpy.empty(3 * len(mesh.loop_triangles), numpy.int32)
    mesh.loop_triangles.foreach_get("vertices", corners)
    return positions.reshape(-1, 3), corners.reshape(-1, 3)


def save(path, positions, triangles):
    with open(path, "wb") as file:
        file.write(f"ply\nformat binary_little_endian 1.0\nelement vertex {len(positions)}\nproperty float x\nproperty float y\nproperty float z\n"
                   f"element face {len(triangles)}\nproperty list uchar int vertex_indices\nend_header\n".encode())
        file.write(numpy.asarray(positions, "<f4").tobytes())
        rows = numpy.empty(len(triangles), numpy.dtype([("n", "u1"), ("v", "<i4", 3)]))
        rows["n"], rows["v"] = 3, triangles
        file.write(rows.tobytes())


def without_slivers(mesh):
    """Blender's own clean-up: in single precision slivers are no triangles any more, and QuadriFlow refuses them."""
    work = bmesh.new()
    work.from_mesh(mesh)
    size = max(vertex.co.length for vertex in work.verts)
    for reach in (1e-6, 1e-5, 1e-4):
        bmesh.ops.dissolve_degenerate(work, dist=reach * size, edges=work.edges)
    bmesh.ops.triangulate(work, faces=work.faces)
    work.to_mesh(mesh)
    work.free()


def control_points(path):
    return sum(line.startswith("v ") for line in open(path))


def main():
    folder, out = map(pathlib.Path, sys.argv[1:])
    out.mkdir(parents=True, exist_ok=True)
    for exact in sorted(folder.glob("*-exact.ply")):
        name = exact.name.removesuffix("-exact.ply")
        points = control_points(folder / f"{name}.obj")
        if not points:
            continue
        bpy.ops.wm.read_factory_settings(use_empty=True)
        bpy.ops.wm.ply_import(filepath=str(exact))
        shape = bpy.context.object
        save(out / f"{name}-decimated.ply", *decimated(*arrays(shape.data), points))
        without_slivers(shape.data)
        start = time.perf_counter()
        made = bpy.ops.object.quadriflow_remesh(mode="FACES", target_faces=points, use_preserve_sharp=True, seed=0)
        seconds = time.perf_counter() - start
        count = len(shape.data.vertices)
        if made != {"FINISHED"} or len(shape.data.polygons) == 0:
            print(f"{name}: QuadriFlow makes nothing of it")
            continue
        modifier = shape.modifiers.new("smooth", "SUBSURF")
        modifier.levels = LEVELS
        fine = shape.evaluated_get(bpy.context.evaluated_depsgraph_get()).to_mesh()
        save(out / f"{name}-quads.ply", *arrays(fine))
        print(f"{name}: {points} control points asked for, {count} made; {seconds:.1f} s", flush=True)


def decimated(positions, triangles, points):
    # A closed triangle mesh has about twice as many faces as vertices.
    share = 1.0 - min(1.0, 2.0 * points / len(triangles))
    return fast_simplification.simplify(positions, triangles, share)


main()
