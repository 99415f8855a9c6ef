"""What engines answer to the seven small cases of docs/evidence.md, as rows of a table in Markdown.

    pip install -r benches/compare/requirements.txt
    python benches/seven_cases.py target/release/trisect

trisect is run as its users run it, by files; the others through their Python bindings, with default settings, on arrays in double
precision where they take them. What counts is what a caller gets without asking further.
"""
import importlib.metadata
import json
import pathlib
import subprocess
import sys
import tempfile

import numpy as np

FAR = np.array([500_000.0, 4_649_776.0, 120.0])
FACES = np.array([
    [0, 2, 1], [0, 3, 2], [4, 5, 6], [4, 6, 7], [0, 1, 5], [0, 5, 4],
    [1, 2, 6], [1, 6, 5], [2, 3, 7], [2, 7, 6], [3, 0, 4], [3, 4, 7],
])
CORNERS = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]], dtype=float)


def cube(low=(0, 0, 0), side=1.0):
    return CORNERS * side + np.array(low, dtype=float), FACES


def joined(*meshes):
    positions, faces, first = [], [], 0
    for points, triangles in meshes:
        positions.append(points)
        faces.append(triangles + first)
        first += len(points)
    return np.vstack(positions), np.vstack(faces)


def volume(mesh):
    points, faces = mesh
    if len(faces) == 0:
        return 0.0
    a, b, c = (points[faces[:, k]] - points.mean(axis=0) for k in range(3))
    return float(np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6)


def components(mesh):
    points, faces = mesh
    _, index = np.unique(np.round(points, 9), axis=0, return_inverse=True)
    parent = list(range(int(index.max()) + 1)) if len(faces) else []

    def root(k):
        while parent[k] != k:
            k = parent[k]
        return k

    for face in index.reshape(-1)[faces]:
        for other in face[1:]:
            parent[root(int(other))] = root(int(face[0]))
    return len({root(int(k)) for k in index.reshape(-1)[faces].reshape(-1)})


NOT_A_NUMBER = cube()[0].copy()
NOT_A_NUMBER[3, 1] = np.nan
CASES = [
    ("unit cube less the same moved by 0.3", "0.657", "difference", cube(), cube((0.3, 0.3, 0.3))),
    ("the same at (500000, 4649776, 120)", "0.657", "difference", cube(FAR), cube(FAR + 0.3)),
    ("cube of side 3 less an operand that overlaps itself", "25.125", "difference", cube(side=3.0),
     joined(cube((1, 1, 1)), cube((1.5, 1.5, 1.5)))),
    ("cube less an open cube", "refused", "difference", cube(side=3.0), (cube((1, 1, 1))[0], FACES[:10])),
    ("cube less itself", "empty", "difference", cube(), cube()),
    ("union of two boxes with a common face", "2, one body", "union", cube(), cube((1, 0, 0))),
    ("a coordinate that is not a number", "refused", "difference", cube(side=3.0), (NOT_A_NUMBER + 1.0, FACES)),
    ("an operand whose faces point inwards", "refused", "difference", cube(side=3.0), (cube((1, 1, 1))[0], FACES[:, ::-1])),
]


class Refused(Exception):
    pass


def trisect(program):
    def run(operation, a, b):
        with tempfile.TemporaryDirectory() as folder:
            names = []
            for name, (points, faces) in zip("ab", (a, b)):
                path = pathlib.Path(folder, name + ".off")
                lines = ["OFF", "%d %d 0" % (len(points), len(faces))]
                lines += [" ".join(map(repr, map(float, p))) for p in points] + ["3 %d %d %d" % tuple(f) for f in faces]
                path.write_text("\n".join(lines) + "\n")
                names.append(str(path))
            out = str(pathlib.Path(folder, "c.off"))
            ran = subprocess.run([program, operation, *names, "-o", out, "--json"], capture_output=True, text=True)
            if ran.returncode:
                raise Refused(json.loads(ran.stdout)["error"]["message"])
            words = iter(pathlib.Path(out).read_text().split())
            assert next(words) == "OFF"
            vertices, triangles, _ = (int(next(words)) for _ in range(3))
            points = np.array([[float(next(words)) for _ in range(3)] for _ in range(vertices)]).reshape(-1, 3)
            faces = np.array([[int(next(words)) for _ in range(4)][1:] for _ in range(triangles)], dtype=int).reshape(-1, 3)
            return points, faces

    version = subprocess.run([program, "--version"], capture_output=True, text=True).stdout.split()[1]
    return "trisect " + version, run


def manifold():
    import manifold3d

    def run(operation, a, b):
        solids = []
        for points, faces in (a, b):
            solid = manifold3d.Manifold(manifold3d.Mesh64(points, faces.astype(np.uint64)))
            if solid.status() != manifold3d.Error.NoError:
                raise Refused(solid.status())
            solids.append(solid)
        mesh = (solids[0] + solids[1] if operation == "union" else solids[0] - solids[1]).to_mesh64()
        return np.asarray(mesh.vert_properties)[:, :3], np.asarray(mesh.tri_verts).astype(int)

    return "manifold3d " + importlib.metadata.version("manifold3d"), run


def over_trimesh():
    import trimesh

    def run(operation, a, b):
        meshes = [trimesh.Trimesh(points, faces, process=False) for points, faces in (a, b)]
        mesh = getattr(trimesh.boolean, operation)(meshes)
        return np.asarray(mesh.vertices), np.asarray(mesh.faces)

    return "trimesh " + importlib.metadata.version("trimesh"), run


def meshlib():
    import meshlib.mrmeshnumpy as arrays
    import meshlib.mrmeshpy as library

    def run(operation, a, b):
        meshes = [arrays.meshFromFacesVerts(faces.astype(np.int32), points) for points, faces in (a, b)]
        kinds = library.BooleanOperation
        found = library.boolean(meshes[0], meshes[1], kinds.Union if operation == "union" else kinds.DifferenceAB)
        if not found.valid():
            raise Refused(found.errorString)
        return arrays.getNumpyVerts(found.mesh), arrays.getNumpyFaces(found.mesh.topology)

    return "MeshLib " + importlib.metadata.version("meshlib"), run


def answer(run, operation, a, b):
    try:
        mesh = run(operation, a, b)
    except Exception as error:  # whatever an engine refuses with
        return "refused", str(error)
    found = volume(mesh)
    if len(mesh[1]) == 0:
        return "empty", ""
    shown = "%.6g" % found
    return (shown + (", one body" if components(mesh) == 1 else ", %d bodies" % components(mesh)) if operation == "union" else shown), ""


def main():
    engines = [trisect(sys.argv[1])]
    for engine in (manifold, over_trimesh, meshlib):
        try:
            engines.append(engine())
        except ImportError as error:
            print("left out: %s" % error, file=sys.stderr)
    print("| Case | Truth | " + " | ".join(name for name, _ in engines) + " |")
    print("|---|---|" + "---|" * len(engines))
    for name, truth, operation, a, b in CASES:
        answers = []
        for engine, run in engines:
            found, why = answer(run, operation, a, b)
            answers.append(found if found == truth else "**%s**" % found)
            if why:
                print("%s: %s: %s" % (engine, name, why[:150]), file=sys.stderr)
        print("| %s | %s | %s |" % (name, truth, " | ".join(answers)))


if __name__ == "__main__":
    main()
