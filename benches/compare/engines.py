"""The engines, each behind the same four steps:

- `arrays(mesh)`: the mesh in the number types the engine likes best (never timed);
- `solid(mesh)`: the engine's own object from such arrays, validated as the engine does by itself;
- `pair(operation, a, b)`, `many(operation, solids)`: the operation, its result computed in full;
- `result(object)`: (positions, triangles) as arrays.

Engines are used as their manuals show, with default settings.
"""
import importlib.metadata

import numpy as np


def pairwise(solids, combine):
    """Neighbours first, as a balanced tree."""
    while len(solids) > 1:
        merged = [combine(a, b) for a, b in zip(solids[0::2], solids[1::2])]
        solids = merged + solids[2 * len(merged):]
    return solids[0]


class Engine:
    name = None
    package = None
    ways = ("pair", "many", "chain", "reuse")

    def version(self):
        return importlib.metadata.version(self.package)

    def arrays(self, mesh):
        return mesh

    def many(self, operation, solids):
        """The union of all; of a difference the tools are united first."""
        unite = lambda a, b: self.pair("union", a, b)
        if operation == "union":
            return pairwise(list(solids), unite)
        return self.pair(operation, solids[0], pairwise(list(solids[1:]), unite))


class Trisect(Engine):
    name = "trisect"

    def __init__(self):
        import trisect_engine

        self.engine = trisect_engine.Trisect()

    def version(self):
        return self.engine.version()

    def solid(self, mesh):
        return self.engine.conv(*mesh)

    def pair(self, operation, a, b):
        return self.engine.pair(a, b, operation)

    def many(self, operation, solids):
        return self.engine.nary(solids, operation)

    def result(self, solid):
        return self.engine.out(solid)


class Manifold(Engine):
    """Double precision through Mesh64. Lazy: the count of triangles is asked for, which computes the result."""

    name = "manifold"
    package = "manifold3d"

    def __init__(self):
        import manifold3d

        self.library = manifold3d
        kinds = manifold3d.OpType
        self.kinds = {"union": kinds.Add, "intersection": kinds.Intersect, "difference": kinds.Subtract}

    def arrays(self, mesh):
        return mesh[0], mesh[1].astype(np.uint64)

    def solid(self, mesh):
        return self.forced(self.library.Manifold(self.library.Mesh64(*mesh)))

    def forced(self, solid):
        solid.num_tri()
        status = solid.status()
        if status != self.library.Error.NoError:
            raise RuntimeError("status %s" % status)
        return solid

    def pair(self, operation, a, b):
        return self.many(operation, [a, b])

    def many(self, operation, solids):
        return self.forced(self.library.Manifold.batch_boolean(solids, self.kinds[operation]))

    def result(self, solid):
        mesh = solid.to_mesh64()
        positions, triangles = np.asarray(mesh.vert_properties)[:, :3], np.asarray(mesh.tri_verts)
        merged = np.asarray(mesh.merge_from_vert)
        if len(merged):
            number = np.arange(len(positions))
            number[merged] = np.asarray(mesh.merge_to_vert)
            triangles = number[triangles.astype(np.int64)]
        return positions, triangles


class Trueform(Engine):
    """Many operands by one CsgGraph expression. Its operations always return arrays."""

    name = "trueform"
    package = "trueform"
    real = np.float64

    def __init__(self):
        import trueform

        self.library = trueform
        self.functions = {
            "union": trueform.boolean_union,
            "intersection": trueform.boolean_intersection,
            "difference": trueform.boolean_difference,
        }

    def arrays(self, mesh):
        return mesh[0].astype(self.real), mesh[1]

    def solid(self, mesh):
        # A result of its own may come back as an operand.
        positions, triangles = mesh
        return self.library.Mesh(np.ascontiguousarray(triangles, np.int32), np.ascontiguousarray(positions, self.real))

    def pair(self, operation, a, b):
        triangles, positions = self.functions[operation](self.operand(a), self.operand(b))[0]
        return positions, triangles

    def operand(self, solid):
        return self.solid(solid) if isinstance(solid, tuple) else solid

    def many(self, operation, solids):
        leaves = [self.library.op(i) for i in range(len(solids))]
        if operation == "union":
            expression = pairwise(leaves, lambda a, b: a | b)
        else:
            expression = leaves[0] - pairwise(leaves[1:], lambda a, b: a | b)
        triangles, positions = self.library.CsgGraph(list(solids)).mesh(expression)
        return positions, triangles

    def result(self, solid):
        return solid


class Trueform32(Trueform):
    name = "trueform_f32"
    real = np.float32


class TrueformPairs(Trueform):
    """Many operands two by two."""

    name = "trueform_pairs"
    ways = ("many",)
    many = Engine.many


class MeshLib(Engine):
    """Single precision. A union of many by uniteManyMeshes, a difference tool by tool."""

    name = "meshlib"
    package = "meshlib"

    def __init__(self):
        import meshlib.mrmeshnumpy
        import meshlib.mrmeshpy

        self.library, self.conversion = meshlib.mrmeshpy, meshlib.mrmeshnumpy
        kinds = self.library.BooleanOperation
        self.kinds = {
            "union": kinds.Union, "intersection": kinds.Intersection, "difference": kinds.DifferenceAB,
        }

    def solid(self, mesh):
        return self.conversion.meshFromFacesVerts(mesh[1], mesh[0])

    def pair(self, operation, a, b):
        outcome = self.library.boolean(a, b, self.kinds[operation])
        if not outcome.valid():
            raise RuntimeError(str(outcome.errorString))
        return outcome.mesh

    def many(self, operation, solids):
        if operation == "difference":
            body = solids[0]
            for tool in solids[1:]:
                body = self.pair("difference", body, tool)
            return body
        operands = self.library.std_vector_Mesh_const_ptr()
        for solid in solids:
            operands.append(solid)
        return self.library.uniteManyMeshes(operands)

    def result(self, solid):
        solid.pack()
        return self.conversion.getNumpyVerts(solid), self.conversion.getNumpyFaces(solid.topology)


class MeshLibPairs(MeshLib):
    """Many operands two by two; of a difference the tools are united first."""

    name = "meshlib_pairs"
    ways = ("many",)
    many = Engine.many


ENGINES = {
    engine.name: engine
    for engine in (Trisect, Manifold, Trueform, Trueform32, TrueformPairs, MeshLib, MeshLibPairs)
}
