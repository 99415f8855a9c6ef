#!/usr/bin/env python3
"""Random booleans of trisect against manifold3d; the oracle of the tests judges every result.

    python3 benches/proof/compare.py live --cases 1000 [--first SEED] [--points 48] [--report FILE] [--seeds N N ...] [--jobs 2]
    python3 benches/proof/compare.py record --cases 3000 --to fixtures/manifold3d.txt

Needs manifold3d and numpy (pip install manifold3d numpy) and the driver (cargo build --release in benches/proof).
"live" compares volume, area, Euler characteristic, components and emptiness. Where they differ both results go to the
arbiter: the oracle's verdict at points round both, the topology with contacts parted, volumes shell by shell. That names the
class of the difference (see docs/proof.md), which is printed with its seeds. It ends with 1 if a result of trisect is wrong
or a difference is not explained. "record" writes what manifold3d finds, for the plain tests; "-" for a quantity that the
arbiter explains otherwise.
"""
import argparse, collections, functools, itertools, json, math, multiprocessing, operator, os, resource, struct, subprocess, sys, time
from fractions import Fraction

import manifold3d
import numpy

# Boxes of 1e300 overflow: their volumes are infinite, and nothing is asked of them.
numpy.seterr(over="ignore", invalid="ignore")
# Drivers run side by side.
os.environ.setdefault("RAYON_NUM_THREADS", "1")

HERE = os.path.dirname(os.path.abspath(__file__))
DRIVER = os.path.join(os.environ.get("CARGO_TARGET_DIR", os.path.join(HERE, "target")), "release", "trisect-proof")
FAMILIES = ["grid", "generic", "near", "far", "models", "apart", "needle", "flat", "single", "far12", "chain", "files",
            "bodies", "several", "mixed"]
# Seeds from here on are those of the families from "apart" on.
HARD_FROM = 1 << 32
# From here on those of several bodies and operands.
MANY_FROM = 1 << 33
OPERATIONS = ["union", "intersection", "difference", "xor", "expression"]
FAULTS = ["panic", "open", "not manifold", "zero area", "identity", "certificate", "operand crosses itself", "result crosses itself",
          "contact", "inherited"]
# Relative to the volume or area of the box round the operands.
EQUAL = 1e-9
# Faces are nearly in one plane within this part of the size of coordinates.
NEARLY = 1e-14
# Bytes that the driver may take.
MEMORY = 3 << 30
# Points at which a difference is judged; more where that explains nothing.
ARBITER_POINTS = [200, 4000, 40000]


SIGNS = {"union": "+", "intersection": "&", "difference": "-", "xor": "^"}


def number(read):
    return struct.unpack("<I", read(4))[0]


def read_mesh(read):
    vertices, triangles = number(read), number(read)
    positions = numpy.frombuffer(read(24 * vertices), "<f8").reshape(-1, 3)
    return positions, numpy.frombuffer(read(12 * triangles), "<u4").reshape(-1, 3)


class Case:
    """One record of the driver (see src/record.rs)."""

    def __init__(self, read):
        self.seed, family, operation, faults = struct.unpack("<QBBH", read(12))
        self.family, self.operation = FAMILIES[family], OPERATIONS[operation]
        self.faults = [name for bit, name in enumerate(FAULTS) if faults >> bit & 1]
        # Operands are lists of bodies.
        if self.seed < MANY_FROM:
            self.operands = [[read_mesh(read)] for _ in range(2)]
            self.tree = [SIGNS[self.operation], 0, 1]
        else:
            self.operands = [[read_mesh(read) for _ in range(number(read))] for _ in range(number(read))]
            self.tree = json.loads(read(number(read)))
            # One operation on all of the operands has its name.
            if self.tree[1:] == list(range(len(self.operands))):
                self.operation = {sign: name for name, sign in SIGNS.items()}[self.tree[0]]
        self.meshes = [body for bodies in self.operands for body in bodies]
        (self.volume, self.area, self.euler, self.components, self.triangles, self.judged, self.mistakes,
         self.identity_error, self.farthest_rounded) = struct.unpack("<ddqIIIIdd", read(8 * 3 + 16 + 16))
        extent = numpy.concatenate([positions for positions, _ in self.meshes])
        size = extent.max(axis=0) - extent.min(axis=0)
        self.box_volume = float(size.prod())
        self.box_area = float(2 * (size[0] * size[1] + size[1] * size[2] + size[2] * size[0]))


class Peer:
    """What manifold3d makes of a case."""

    def __init__(self, case):
        bodies = [[manifold3d.Manifold(manifold3d.Mesh64(numpy.array(p), numpy.array(t, numpy.uint64))) for p, t in bodies]
                  for bodies in case.operands]
        self.refused = any(m.status() != manifold3d.Error.NoError for some in bodies for m in some)
        if self.refused:
            return
        # What an operand of several bodies means, told apart: their union.
        operands = [some[0] if len(some) == 1 else manifold3d.Manifold.batch_boolean(some, manifold3d.OpType.Add) for some in bodies]
        self.result = evaluated(case.tree, operands)
        self.volume, self.area = self.result.volume(), self.result.surface_area()
        self.triangles, self.vertices = self.result.num_tri(), self.result.num_vert()
        self.euler = self.vertices - self.triangles // 2
        self.components = len(self.result.decompose()) if self.triangles else 0
        self.tolerance = max(m.get_tolerance() for m in [*operands, self.result])

    def mesh(self):
        mesh = self.result.to_mesh64()
        return numpy.array(mesh.vert_properties[:, :3], "<f8"), numpy.array(mesh.tri_verts, "<u4")


def evaluated(tree, operands):
    """An expression (see judge/many.rs) by manifold3d."""
    if isinstance(tree, int):
        return operands[tree]
    sign, *sets = tree
    if sign == "#":
        count, *sets = sets
        sets = [evaluated(part, operands) for part in sets]
        some = [functools.reduce(operator.xor, chosen) for chosen in itertools.combinations(sets, max(count, 1))]
        return functools.reduce(operator.add, some)
    sets = [evaluated(part, operands) for part in sets]
    if sign == "^":
        return functools.reduce(lambda a, b: (a - b) + (b - a), sets)
    return functools.reduce({"+": operator.add, "&": operator.xor, "-": operator.sub}[sign], sets)


class Arbiter:
    """The driver's judge of both results (see src/arbiter.rs)."""

    def __init__(self):
        self.process = subprocess.Popen([DRIVER, "judge"], stdin=subprocess.PIPE, stdout=subprocess.PIPE, preexec_fn=limited)

    def ask(self, case, peer, points):
        positions, corners = peer.mesh()
        self.process.stdin.write(struct.pack("<QIII", case.seed, points, len(positions), len(corners)) + positions.tobytes() + corners.tobytes())
        self.process.stdin.flush()
        answer = json.loads(self.process.stdout.readline())
        answer["ours"]["at_origin"] = answer["at_origin"]
        return answer["ours"], answer["theirs"]

    def close(self):
        self.process.stdin.close()
        self.process.wait()


def limited():
    """A case may not take more than so much memory: what asks for more is a crash, not the end of the machine."""
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))


def stream(first, count, points):
    """The cases of so many seeds, as the driver emits them; for a seed at which it crashes, the seed alone."""
    seed, end = first, first + count
    while seed < end:
        driver = subprocess.Popen([DRIVER, "emit", str(seed), str(end - seed), str(points)], stdout=subprocess.PIPE,
                                  stderr=subprocess.DEVNULL, bufsize=1 << 20, preexec_fn=limited)

        def read(count):
            data = driver.stdout.read(count)
            if len(data) < count:
                raise EOFError
            return data

        try:
            while seed < end:
                case = Case(read)
                seed = case.seed + 1
                yield case
        except EOFError:
            yield seed
            seed += 1
        driver.wait()


def differences(case, peer):
    """Names of what differs."""
    found = []
    if abs(case.volume - peer.volume) > EQUAL * case.box_volume:
        found.append("volume")
    if abs(case.area - peer.area) > EQUAL * case.box_area:
        found.append("area")
    if (case.triangles == 0) != (peer.triangles == 0):
        found.append("emptiness")
    if case.components != peer.components:
        found.append("components")
    if case.euler != peer.euler:
        found.append("euler")
    return found


OURS = "TRISECT WRONG: "
UNEXPLAINED = "UNEXPLAINED: "


def nearly_flush(case):
    """Whether a face of one body and one of another whose boxes meet lie in one plane but for rounding: corners of operands that are results themselves
    are rounded."""
    return any(nearly_flush_pair(*pair) for pair in itertools.combinations(case.meshes, 2))


def nearly_flush_pair(one, other):
    (a, of_a), (b, of_b) = one, other
    corners = a[of_a]
    size = max(numpy.abs(a).max(), numpy.abs(b).max())
    normals = numpy.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    lengths = numpy.linalg.norm(normals, axis=1)
    for t in numpy.flatnonzero(lengths > 0):
        height = numpy.abs((b - corners[t, 0]) @ (normals[t] / lengths[t]))
        for other in of_b[(height[of_b] <= NEARLY * size).all(axis=1)]:
            overlap = (b[other].min(axis=0) <= corners[t].max(axis=0) + NEARLY * size) & (b[other].max(axis=0) >= corners[t].min(axis=0) - NEARLY * size)
            if overlap.all() and any(determinant(*corners[t], point) for point in b[other]):
                return True
    return False


def determinant(p, q, r, s):
    """Six times the volume of a tetrahedron, exactly."""
    u, v, w = ([Fraction(float(x)) - Fraction(float(y)) for x, y in zip(end, p)] for end in (q, r, s))
    return (u[0] * (v[1] * w[2] - v[2] * w[1]) + u[1] * (v[2] * w[0] - v[0] * w[2]) + u[2] * (v[0] * w[1] - v[1] * w[0]))


def explained(case, peer, differing, arbiter):
    """The class of a difference, and what the arbiter found of manifold3d's result. docs/proof.md tells the classes apart."""
    if case.family == "apart":
        # Judged exactly, with the case. (The arbiter computes at the scale of the larger operand.)
        if case.mistakes or "identity" in case.faults:
            return OURS + "the judge disagrees", None
        name = apart_class(case, peer)
        if name:
            return name, None
    for points in ARBITER_POINTS:
        ours, theirs = arbiter.ask(case, peer, points)
        name = classified(case, peer, differing, ours, theirs)
        if not name.startswith(UNEXPLAINED):
            break
    return name, theirs


def beyond_rounding(case, peer, differing, ours, theirs):
    """What differs by more than the roundings of new vertices can make of volume and area, which is much far from the origin: no vertex of
    either result is further from its place than the diagonal of a cube of half a unit in the last place. The volume then changes by no more
    than that times the area, and the area by half of it times the sides of all triangles (those of manifold3d's twice, for both)."""
    largest = max(float(numpy.abs(positions).max()) for positions, _ in case.meshes)
    moved = math.sqrt(3) / 2 * math.ulp(largest)
    positions, corners = peer.mesh()
    sides = sum(float(numpy.linalg.norm(positions[corners[:, k]] - positions[corners[:, k - 1]], axis=1).sum()) for k in range(3))
    slack = {"volume": moved * (ours["area"] + theirs["area"]), "area": moved * sides}
    found = {"volume": abs(case.volume - peer.volume), "area": abs(case.area - peer.area)}
    return [name for name in differing if not found.get(name, math.inf) <= slack.get(name, 0.0)]


def apart_class(case, peer):
    """Why manifold3d differs where sizes are far apart; nothing where they are so near that the arbiter can tell."""
    sizes = [float((positions.max(axis=0) - positions.min(axis=0)).max()) for positions, _ in case.meshes]
    largest = max(float(numpy.abs(positions).max()) for positions, _ in case.meshes)
    # Python raises where a power overflows; a product becomes infinite.
    if not math.isfinite(largest * largest * largest):
        return "sizes apart: products of manifold3d overflow"
    if min(sizes) <= 1e3 * peer.tolerance or min(sizes) < 1e-9 * max(sizes):
        return "sizes apart: one operand is within manifold3d's tolerance of the other"
    return None


def classified(case, peer, differing, ours, theirs):
    if ours["mistakes"]:
        return OURS + "the oracle disagrees"
    if theirs["mistakes"]:
        if theirs["farthest"] <= 4 * peer.tolerance:
            return "manifold3d off by no more than its tolerance"
        return "manifold3d wrong by more than its tolerance"
    differing = beyond_rounding(case, peer, differing, ours, theirs)
    if not differing:
        return "same solid; volume and area differ by the rounding of new vertices"
    if "volume" in differing:
        return UNEXPLAINED + "volume"
    if peer.triangles == 0 and case.area <= peer.tolerance ** 2:
        # What contains no ball as large as its tolerance (12 times its square has the surface of one), manifold3d drops.
        return "same solid; all of it within manifold3d's tolerance"
    # The same solid. What has no volume is no part of it.
    empty_shells = [v for v in theirs["bodies"] if abs(v) <= EQUAL * case.box_volume]
    if case.family in ("near", "single") or nearly_flush(case):
        # Gaps and films of rounding's width (in "single" of single precision's) are parts of the exact result; manifold3d closes what is
        # within its tolerance.
        return "same solid; contacts off by rounding"
    if empty_shells and not [v for v in ours["bodies"] if abs(v) <= EQUAL * case.box_volume]:
        return "manifold3d keeps shells without volume"
    if theirs["area"] > ours["area"] + EQUAL * case.box_area:
        return "manifold3d keeps walls without thickness"
    if "area" in differing:
        if ours["walls"] == 0 and theirs["area"] < ours["area"]:
            # What is thinner than its tolerance manifold3d closes. No two triangles of ours lie on each other: the film has a thickness.
            return "same solid; films thinner than manifold3d's tolerance"
        return UNEXPLAINED + "area"
    if ours["at_origin"] and ours["parted"] != [ours["components"], ours["euler"]]:
        # At the origin the result has the same vertices, not rounded, is connected alike, and its contacts are parted.
        return "same solid; needles turned by rounding far from the origin"
    if ours["parted"] is None:
        return OURS + "walls without thickness"
    if ours["parted"] != [ours["components"], ours["euler"]]:
        if ours["mispaired"] == 0 and ours["own"]:
            return "same solid; an operand touches itself in an edge, and stays connected as it is"
        if ours["mispaired"] == 0 and ours["pinched"]:
            return "same solid; an edge touches a face from inside, which one parts and the other does not"
        if ours["mispaired"] == 0:
            # Every edge between faces of a width joins those that bound one wedge of material: what is joined beyond that is joined
            # through faces as thin as rounding, between points that are not exactly one.
            return "same solid; joined through parts thinner than rounding"
        return OURS + "connected where material touches"
    if ours["parted"] == theirs["parted"]:
        return "same solid; manifold3d connected where material touches"
    if theirs["parted"] is None:
        return "same solid; manifold3d's surface lies on itself"
    if ours["pinched"] or theirs["pinched"]:
        return "same solid; an edge touches a face from inside, which one parts and the other does not"
    if ours["coarse"] == theirs["coarse"]:
        # Connected alike where vertices a rounding apart are taken for one.
        return "same solid; details as small as rounding"
    return UNEXPLAINED + ", ".join(differing)


class Tally:
    """What a live run has seen so far."""

    def __init__(self, first):
        self.first, self.begun, self.done, self.agreed, self.judged, self.farthest = first, time.time(), 0, 0, 0, 0.0
        self.classes, self.totals = collections.defaultdict(list), collections.Counter()

    def take(self, other):
        """Adds what another tally has seen."""
        self.done, self.agreed, self.judged = self.done + other.done, self.agreed + other.agreed, self.judged + other.judged
        self.farthest = max(self.farthest, other.farthest)
        self.totals.update(other.totals)
        for name, seeds in other.classes.items():
            self.classes[name] += seeds

    def add(self, case, arbiter):
        self.done += 1
        if isinstance(case, int):
            self.classes[OURS + "crash", "?"].append(str(case))
            return
        self.judged += case.judged
        self.farthest = max(self.farthest, case.farthest_rounded)
        self.totals[case.family, case.operation] += 1
        names = {OURS + fault for fault in case.faults if fault != "inherited"}
        if "contact" in case.faults and nearly_flush(case):
            # Films of rounding's width lie on one another for the judge, which then cannot tell.
            names.remove(OURS + "contact")
            names.add("contacts off by rounding, which the judge cannot part")
        if "inherited" in case.faults:
            names.add("crosses itself only as an operand in single precision does")
        if case.mistakes:
            names.add(OURS + "the oracle disagrees")
        if "panic" not in case.faults:
            peer = Peer(case)
            differing = ["refused"] if peer.refused else differences(case, peer)
            if peer.refused:
                names.add("manifold3d refuses an operand")
            elif differing:
                names.add(explained(case, peer, differing, arbiter)[0])
            self.agreed += not differing
        for name in names:
            self.classes[name, case.family].append(f"{case.seed}:{case.operation[0]}")

    def failed(self):
        return any(name.startswith((OURS, UNEXPLAINED)) for name, _ in self.classes)

    def text(self, show):
        lines = [f"{self.done} cases from seed {self.first}: {self.agreed} agree in everything; {self.judged} points judged by the "
                 f"oracle, the farthest that differs {self.farthest:.2f} ulps from a surface; {time.time() - self.begun:.0f} s; "
                 f"manifold3d {version()}"]
        for family in FAMILIES:
            counts = [f"{operation} {self.totals[family, operation]}" for operation in OPERATIONS if self.totals[family, operation]]
            if counts:
                lines.append(f"  {family}: {', '.join(counts)}")
        for (name, family), seeds in sorted(self.classes.items()):
            more = " ..." if len(seeds) > show else ""
            seeds = sorted(seeds, key=lambda seed: int(seed.split(':')[0]))
            lines.append(f"{name} | {family}: {len(seeds)} [{' '.join(seeds[:show])}{more}]")
        return "\n".join(lines) + "\n"


# Cases that one process takes at a time.
BATCH = 500


def tally_of(batch):
    """What is seen in so many cases from a seed on."""
    first, count, points = batch
    tally, arbiter = Tally(first), Arbiter()
    for case in stream(first, count, points):
        try:
            tally.add(case, arbiter)
        except (ArithmeticError, OSError, ValueError) as error:
            # A finding, too: the others go on.
            tally.classes[UNEXPLAINED + f"the comparison fails: {error!r}", "?"].append(str(getattr(case, "seed", case)))
            arbiter = Arbiter()
    arbiter.close()
    return tally


def live(arguments):
    tally = Tally(arguments.first)

    def report():
        if arguments.report:
            with open(arguments.report, "w") as file:
                file.write(tally.text(1000))

    end = arguments.first + arguments.cases
    batches = [(first, min(BATCH, end - first), arguments.points) for first in range(arguments.first, end, BATCH)]
    if arguments.seeds:
        batches = [(seed, 1, arguments.points) for seed in arguments.seeds]
    with multiprocessing.Pool(arguments.jobs) as pool:
        for part in pool.imap_unordered(tally_of, batches):
            tally.take(part)
            if len(batches) > 1 and part.done > 1:
                print(f"{tally.done} cases, {time.time() - tally.begun:.0f} s", file=sys.stderr, flush=True)
            report()
    print(tally.text(arguments.show), end="")
    if tally.failed():
        sys.exit(1)


def version():
    from importlib.metadata import PackageNotFoundError, version
    try:
        return version("manifold3d")
    except PackageNotFoundError:
        return "of unknown version"


def record(arguments):
    """One line for each case, without what manifold3d has wrong, or connects where material touches, or rounding decides."""
    arbiter, left_out = Arbiter(), collections.Counter()
    with open(arguments.to, "w") as file:
        file.write(f"# manifold3d {version()}: seed, volumes of A and B, volume, area, Euler characteristic and components of the result\n")
        for case in stream(arguments.first, arguments.cases, 0):
            if isinstance(case, int):
                sys.exit(f"the driver crashes at seed {case}")
            peer = Peer(case)
            if peer.refused:
                continue
            values = {"volume": f"{peer.volume:.10g}", "area": f"{peer.area:.10g}", "euler": str(peer.euler), "components": str(peer.components)}
            left = set()
            if case.family == "near":
                # Films and gaps of rounding's width.
                left = {"area", "euler", "components"}
            elif peer.triangles:
                _, theirs = arbiter.ask(case, peer, 40)
                if theirs["parted"] != [theirs["components"], theirs["euler"]]:
                    left = {"euler", "components"}
            differing = [quantity for quantity in differences(case, peer) if quantity in values]
            if differing and not left.issuperset(differing):
                name, _ = explained(case, peer, differing, arbiter)
                # What is not explained stays, and fails.
                if not name.startswith((OURS, UNEXPLAINED)):
                    left.update(differing)
                    left_out[name] += 1
            for quantity in left:
                values[quantity] = "-"
            operands = " ".join(f"{volume(*mesh):.6g}" for mesh in case.meshes)
            file.write(f"{case.seed} {operands} {values['volume']} {values['area']} {values['euler']} {values['components']}\n")
    for name, count in sorted(left_out.items()):
        print(f"{count} with a quantity left out: {name}")


def volume(positions, corners):
    a, b, c = (positions[corners[:, k]] - positions[0] for k in range(3))
    return float((a * numpy.cross(b, c)).sum() / 6)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    verbs = parser.add_subparsers(required=True)
    for verb, run in (("live", live), ("record", record)):
        sub = verbs.add_parser(verb)
        sub.set_defaults(run=run)
        sub.add_argument("--first", type=int, default=0)
        sub.add_argument("--cases", type=int, default=1000)
        sub.add_argument("--hard", action="store_true", help="the families from apart to files: --first counts from the first of their seeds")
        sub.add_argument("--many", action="store_true", help="the same for those of several bodies and operands")
        if verb == "live":
            sub.add_argument("--points", type=int, default=48)
            sub.add_argument("--show", type=int, default=12)
            sub.add_argument("--report", help="a file for the text, with all seeds; brought up to date as the run goes on")
            sub.add_argument("--seeds", type=int, nargs="*", help="these cases only")
            sub.add_argument("--jobs", type=int, default=os.cpu_count(), help="processes side by side")
        else:
            sub.add_argument("--to", required=True)
    arguments = parser.parse_args()
    if arguments.hard:
        arguments.first += HARD_FROM
    if arguments.many:
        arguments.first += MANY_FROM
    arguments.run(arguments)
