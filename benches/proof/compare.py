#!/usr/bin/env python3
"""Random booleans of trisect against manifold3d; the oracle of the tests judges every result.

    python3 benches/proof/compare.py live --cases 1000 [--first 0] [--points 48] [--report FILE]
    python3 benches/proof/compare.py record --cases 3000 --to fixtures/manifold3d.txt

Needs manifold3d and numpy (pip install manifold3d numpy) and the driver (cargo build --release in benches/proof).
"live" prints every class of difference with its seeds; "record" writes what manifold3d finds, for the plain tests.
"""
import argparse, collections, os, struct, subprocess, sys, time

import manifold3d
import numpy

HERE = os.path.dirname(os.path.abspath(__file__))
DRIVER = os.path.join(os.environ.get("CARGO_TARGET_DIR", os.path.join(HERE, "target")), "release", "trisect-proof")
FAMILIES = ["grid", "generic", "near", "far", "models"]
OPERATIONS = ["union", "intersection", "difference", "xor"]
FAULTS = ["panic", "open", "not manifold", "zero area", "identity", "certificate", "operand crosses itself", "result crosses itself"]


class Case:
    """One record of the driver (see src/record.rs)."""

    def __init__(self, read):
        head = read(12)
        self.seed, family, operation, faults, _ = struct.unpack("<QBBBB", head)
        self.family, self.operation = FAMILIES[family], OPERATIONS[operation]
        self.faults = [name for bit, name in enumerate(FAULTS) if faults >> bit & 1]
        self.meshes = []
        for _ in range(2):
            vertices, triangles = struct.unpack("<II", read(8))
            positions = numpy.frombuffer(read(24 * vertices), "<f8").reshape(-1, 3)
            corners = numpy.frombuffer(read(12 * triangles), "<u4").reshape(-1, 3)
            self.meshes.append((positions, corners))
        (self.volume, self.area, self.euler, self.components, self.triangles, self.judged, self.mistakes,
         self.identity_error, self.farthest_rounded) = struct.unpack("<ddqIIIIdd", read(8 * 3 + 16 + 16))
        extent = numpy.concatenate([positions for positions, _ in self.meshes])
        size = extent.max(axis=0) - extent.min(axis=0)
        self.box_volume = float(size.prod())
        self.box_area = float(2 * (size[0] * size[1] + size[1] * size[2] + size[2] * size[0]))


class Peer:
    """What manifold3d makes of a case."""

    def __init__(self, case):
        a, b = (manifold3d.Manifold(manifold3d.Mesh64(numpy.array(p), numpy.array(t, numpy.uint64))) for p, t in case.meshes)
        self.refused = any(m.status() != manifold3d.Error.NoError for m in (a, b))
        if self.refused:
            return
        result = {"union": lambda: a + b, "intersection": lambda: a ^ b, "difference": lambda: a - b,
                  "xor": lambda: (a - b) + (b - a)}[case.operation]()
        self.volume, self.area = result.volume(), result.surface_area()
        self.triangles, self.vertices = result.num_tri(), result.num_vert()
        self.euler = self.vertices - self.triangles // 2
        self.components = len(result.decompose()) if self.triangles else 0
        self.empty = self.triangles == 0


def stream(first, count, points):
    """The cases of so many seeds, as the driver emits them."""
    driver = subprocess.Popen([DRIVER, "emit", str(first), str(count), str(points)], stdout=subprocess.PIPE, bufsize=1 << 20)

    def read(count):
        data = driver.stdout.read(count)
        if len(data) < count:
            raise EOFError
        return data

    try:
        while True:
            yield Case(read)
    except EOFError:
        if driver.wait() != 0:
            sys.exit(f"the driver ended with {driver.returncode} (a crash is a finding: see the last seed)")


def differences(case, peer):
    """Names of what differs. Topology and area of near contacts depend on rounding, those of a symmetric difference on how
    touching sheets are parted: there only volumes are compared."""
    if peer.refused:
        return ["manifold3d refuses an operand"]
    found = []
    if abs(case.volume - peer.volume) > 1e-9 * case.box_volume:
        found.append("volume")
    if case.family == "near" or case.operation == "xor":
        return found
    if abs(case.area - peer.area) > 1e-9 * case.box_area:
        found.append("area")
    if (case.triangles == 0) != peer.empty:
        found.append("emptiness")
    if case.components != peer.components:
        found.append("components")
    if case.euler != peer.euler:
        found.append("euler")
    return found


def live(arguments):
    begun, done, judged, farthest = time.time(), 0, 0, 0.0
    classes = collections.defaultdict(list)
    totals = collections.Counter()
    for case in stream(arguments.first, arguments.cases, arguments.points):
        done += 1
        judged += case.judged
        farthest = max(farthest, case.farthest_rounded)
        totals[case.family, case.operation] += 1
        names = [f"trisect: {fault}" for fault in case.faults]
        if case.mistakes:
            names.append("trisect: oracle disagrees")
        if "panic" not in case.faults:
            differing = differences(case, Peer(case))
            if differing:
                names.append("differs from manifold3d in " + ", ".join(differing))
        for name in names:
            classes[case.family, name].append((case.seed, case.operation))
        if done % 1000 == 0:
            print(f"{done} cases, {time.time() - begun:.0f} s", file=sys.stderr, flush=True)
    seconds = time.time() - begun
    lines = [f"{done} cases from seed {arguments.first}, {judged} points judged, {seconds:.0f} s, manifold3d "
             f"{getattr(manifold3d, '__version__', '?')}; farthest point within rounding {farthest:.2f} ulps"]
    for family in FAMILIES:
        counts = ", ".join(f"{operation} {totals[family, operation]}" for operation in OPERATIONS)
        lines.append(f"  {family}: {counts}")
    for (family, name), seeds in sorted(classes.items()):
        shown = " ".join(f"{seed}:{operation[0]}" for seed, operation in seeds[:arguments.show])
        lines.append(f"{family:8} {name}: {len(seeds)} [{shown}{' ...' if len(seeds) > arguments.show else ''}]")
    text = "\n".join(lines)
    print(text)
    if arguments.report:
        with open(arguments.report, "w") as file:
            file.write(text + "\n")


def record(arguments):
    with open(arguments.to, "w") as file:
        file.write("# seed triangles-of-A triangles-of-B volume area euler components, as manifold3d finds them\n")
        for case in stream(arguments.first, arguments.cases, 0):
            peer = Peer(case)
            counts = " ".join(str(len(corners)) for _, corners in case.meshes)
            if not peer.refused:
                file.write(f"{case.seed} {counts} {peer.volume:.12g} {peer.area:.12g} {peer.euler} {peer.components}\n")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    verbs = parser.add_subparsers(required=True)
    for verb, run in (("live", live), ("record", record)):
        sub = verbs.add_parser(verb)
        sub.set_defaults(run=run)
        sub.add_argument("--first", type=int, default=0)
        sub.add_argument("--cases", type=int, default=1000)
        if verb == "live":
            sub.add_argument("--points", type=int, default=48)
            sub.add_argument("--show", type=int, default=12)
            sub.add_argument("--report")
        else:
            sub.add_argument("--to", required=True)
    arguments = parser.parse_args()
    arguments.run(arguments)
