"""The cases of the comparison: which meshes, which operations, how long an engine may take.

`case(name)` makes one; `stored(name, folder)` keeps its meshes in a file, so that every process loads the very same arrays
and none has the memory behind it that making them takes.
"""
import dataclasses
import hashlib
import os
import pathlib

import numpy as np

import shapes
from shapes import placed, rotation

FIRST_TURN = rotation(np.sqrt(3), [3, -1, 2])
SECOND_TURN = rotation(np.sqrt(2), [1, 2, 3])
# No axis, plane or vertex of the one comes to lie on one of the other.
GENERAL_OFFSET = np.array([0.0, 0.013, -0.007])

SPHERE_LEVELS = {"1k": 3, "20k": 5, "80k": 6, "330k": 7, "1.3M": 8}
MODELS = {
    "armadillo": "armadillo.off",
    "nefertiti": "nefertiti-70k.obj",
    "blade": "turbineblade-199k.ply",
    "bunny": "bunny00-loop-302k.ply",
}
ALL_OPERATIONS = ("union", "intersection", "difference")


@dataclasses.dataclass
class Case:
    """`way` tells how the meshes are combined:

    - pair: the first with the second;
    - many: all at once (a difference: the first minus all the others);
    - chain: the first minus the second, the result minus the third, and so on, each result made before the next step;
    - reuse: the first minus the second, the first minus the third, and so on: the first is made ready once, untimed.
    """

    meshes: list
    way: str
    operations: tuple
    exact: dict = dataclasses.field(default_factory=dict)  # volume by operation, where a formula gives it
    limit: float = 60.0  # seconds one run may take


def spheres(size):
    sphere = shapes.icosphere(SPHERE_LEVELS[size])
    second = placed(sphere, SECOND_TURN, at=GENERAL_OFFSET + [0.5, 0, 0])
    return Case([placed(sphere, FIRST_TURN), second], "pair", ALL_OPERATIONS)


def big_minus_small():
    body = placed(shapes.icosphere(8), FIRST_TURN)
    tool = placed(shapes.icosphere(4), SECOND_TURN, scale=0.05, at=GENERAL_OFFSET + [1.0, 0, 0])
    return Case([body, tool], "pair", ("difference",))


def bumpy_spheres():
    first = shapes.bumpy_sphere(7, (0.1, 0.7, 1.9))
    second = placed(shapes.bumpy_sphere(7, (1.3, 2.1, 0.4)), rotation(0.3 * np.sqrt(2), [1, 2, 3]))
    return Case([first, second], "pair", ("union",))


def menger(depth):
    return Case(shapes.menger(depth), "many", ("difference",), {"difference": 20.0**depth}, limit=120.0)


def touching_cubes():
    cells = np.indices((10, 10, 10)).reshape(3, -1).T
    return Case([shapes.box(cell, cell + 1) for cell in cells], "many", ("union",), {"union": 1000.0})


def random_turn(random):
    axis = random.normal(size=3)
    return rotation(random.uniform(0, 2 * np.pi), axis)


def overlapping_spheres():
    random = np.random.default_rng(12345)
    sphere = shapes.icosphere(3)
    meshes = []
    for _ in range(200):
        turn = random_turn(random)
        meshes.append(placed(sphere, turn, at=random.uniform(-3, 3, 3)))
    return Case(meshes, "many", ("union",))


def knot_minus_cylinders(long):
    """Short ones sit on the knot's surface; long ones run through the whole scene: needles whose boxes overlap everything."""
    knot = placed(shapes.knotted_tube(), SECOND_TURN)
    random = np.random.default_rng(777)
    meshes = [knot]
    reach = 6.0 if long else 0.75
    for _ in range(50):
        turn = random_turn(random)
        at = random.uniform(-2, 2, 3)
        if not long:
            at = knot[0][random.integers(len(knot[0]))]
        meshes.append(placed(shapes.cylinder(0.1, -reach, reach, 128), turn, at=at))
    return Case(meshes, "many", ("difference",), limit=300.0 if long else 60.0)


def cube_and_cylinder():
    sides, radius = 32, 0.3
    bore = 0.5 * sides * radius**2 * np.sin(2 * np.pi / sides)
    exact = {"union": 1 + bore, "intersection": bore, "difference": 1 - bore}
    meshes = [shapes.box((-0.5, -0.5, -0.5), (0.5, 0.5, 0.5)), shapes.cylinder(radius, -1, 1, sides)]
    return Case(meshes, "pair", ALL_OPERATIONS, exact)


def body_and_tools(count, way):
    """A sphere of 1.3 million triangles, and small spheres all over its surface."""
    random = np.random.default_rng(99)
    tool = shapes.icosphere(3)
    meshes = [placed(shapes.icosphere(8), FIRST_TURN)]
    for _ in range(count):
        at = random.normal(size=3)
        turn = random_turn(random)
        meshes.append(placed(tool, turn, scale=0.05, at=at / np.linalg.norm(at)))
    return Case(meshes, way, ("difference",), limit=4.0 * count)


def model_and_turned_copy(name, folder):
    if folder is None:
        raise ValueError("case j_%s needs --models FOLDER" % name)
    wanted = MODELS.get(name, name + ".*")
    found = sorted(pathlib.Path(folder).rglob(wanted))
    if not found:
        raise FileNotFoundError("no %s in %s" % (wanted, folder))
    model = loaded(found[0])
    low, high = model[0].min(axis=0), model[0].max(axis=0)
    centred = placed(model, at=-0.5 * (low + high))
    return Case([centred, placed(centred, rotation(0.7, [1, 2, 3]))], "pair", ("union", "difference"))


def loaded(path):
    """A mesh from a file, vertices in exactly the same place made one."""
    import trimesh

    model = trimesh.load(path, process=False, force="mesh")
    positions, number = np.unique(np.asarray(model.vertices, float), axis=0, return_inverse=True)
    triangles = number.reshape(-1)[np.asarray(model.faces)]
    distinct = (triangles != np.roll(triangles, 1, axis=1)).all(axis=1)
    return shapes.mesh(positions, triangles[distinct])


def needles():
    """Two crossed rods with sides of 4000 needles each, askew, so that the box of every needle is that of the rod."""
    rod = shapes.cylinder(1.0, -50, 50, 2000)
    first = placed(rod, rotation(0.9, [1, -1, 0.2]))
    second = placed(rod, rotation(0.9, [1, 1, 0.3]), at=(0.3, 0.1, -0.2))
    return Case([first, second], "pair", ("union", "difference"), limit=120.0)


def fans():
    """Two double cones: 5000 triangles round each of the four tips."""
    cone = shapes.double_cone(5000)
    first = placed(cone, FIRST_TURN)
    second = placed(cone, SECOND_TURN @ FIRST_TURN, at=(0.31, 0.17, 0.05))
    return Case([first, second], "pair", ("union", "difference"), limit=120.0)


def urchins():
    """Two spheres with a needle on every triangle: very many short curves."""
    first = placed(shapes.urchin(4, 1), FIRST_TURN)
    second = placed(shapes.urchin(4, 2), SECOND_TURN, at=GENERAL_OFFSET + [2.5, 0, 0])
    return Case([first, second], "pair", ("union", "difference"), limit=120.0)


def case(name, models=None):
    kind, _, rest = name.partition("_")
    if kind == "a":
        return spheres(rest)
    if kind == "j":
        return model_and_turned_copy(rest, models)
    if kind == "d" and rest.startswith("menger"):
        return menger(int(rest.removeprefix("menger")))
    for way in ("chain", "reuse"):
        if kind == "i" and rest.startswith(way):
            return body_and_tools(int(rest.removeprefix(way)), way)
    return {
        "b_local": big_minus_small,
        "c_bumpy": bumpy_spheres,
        "e_cubes": touching_cubes,
        "f_spheres": overlapping_spheres,
        "g_knot": lambda: knot_minus_cylinders(False),
        "g_long": lambda: knot_minus_cylinders(True),
        "h_tiny": cube_and_cylinder,
        "k_needles": needles,
        "k_fans": fans,
        "k_urchins": urchins,
    }[name]()


NAMES = [
    "a_1k", "a_20k", "a_80k", "a_330k", "a_1.3M", "b_local", "c_bumpy", "d_menger3", "d_menger4", "e_cubes", "f_spheres",
    "g_knot", "g_long", "h_tiny", "i_chain100", "i_reuse100", "j_armadillo", "j_nefertiti", "j_blade", "j_bunny",
    "k_needles", "k_fans", "k_urchins",
]


def stored(name, folder, models=None):
    """The path of a file with the case, made if need be."""
    here = pathlib.Path(__file__).parent
    sources = b"".join((here / file).read_bytes() for file in ("cases.py", "shapes.py"))
    version = hashlib.sha256(sources).hexdigest()[:12]
    path = pathlib.Path(folder) / ("%s-%s.npz" % (name, version))
    if path.exists():
        return path
    made = case(name, models)
    arrays = {"way": made.way, "limit": made.limit, "operations": made.operations, "count": len(made.meshes)}
    arrays["exact"] = [made.exact.get(operation, np.nan) for operation in made.operations]
    # One array for all meshes: thousands of small ones load slowly.
    arrays["positions"] = np.concatenate([positions for positions, _ in made.meshes])
    arrays["triangles"] = np.concatenate([triangles for _, triangles in made.meshes])
    arrays["sizes"] = np.array([[len(positions), len(triangles)] for positions, triangles in made.meshes])
    path.parent.mkdir(parents=True, exist_ok=True)
    partial = path.with_suffix(".%d.npz" % os.getpid())
    np.savez(partial, **arrays)
    partial.rename(path)
    return path


def exported(path, target):
    """The case as a plain file for `src/bin/trace.rs`: a count, the sizes, then positions and triangles of each mesh."""
    case = restored(path)
    with open(target, "wb") as file:
        sizes = [(len(positions), len(triangles)) for positions, triangles in case.meshes]
        file.write(np.array([len(sizes)], "<u8").tobytes() + np.array(sizes, "<u8").tobytes())
        for positions, triangles in case.meshes:
            file.write(positions.astype("<f8").tobytes() + triangles.astype("<u4").tobytes())


def restored(path):
    with np.load(path) as file:
        positions, triangles = file["positions"], file["triangles"]
        ends = np.cumsum(file["sizes"], axis=0)
        starts = ends - file["sizes"]
        meshes = [
            (positions[v0:v1], triangles[t0:t1]) for (v0, t0), (v1, t1) in zip(starts.tolist(), ends.tolist())
        ]
        operations = tuple(str(operation) for operation in file["operations"])
        exact = {op: float(value) for op, value in zip(operations, file["exact"]) if not np.isnan(value)}
        return Case(meshes, str(file["way"]), operations, exact, float(file["limit"]))
