"""`solidify` beside manifold-rust's robust engine and fTetWild on soups of known solids.

    pip install trimesh numpy pytetwild
    cargo build --release && cargo build --release --manifest-path benches/compare/peers/Cargo.toml
    python benches/compare/soups.py target/release/trisect benches/compare/peers/target/release/trisect-peers [COUNT]

Each kind of fault by itself, then all of them. A row of the table for each kind: of how many soups there is a closed result, how far its volume is
off in the mean and at most, and the mean time.
"""

import json
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy
import trimesh

SEED = 190


def known(number):
    if number % 3 == 0:
        return trimesh.creation.icosphere(subdivisions=3, radius=1.0)
    if number % 3 == 1:
        return trimesh.creation.torus(1.0, 0.4, major_sections=32, minor_sections=16)
    return trimesh.creation.cylinder(radius=0.5, height=2.0, sections=48).subdivide().subdivide()


def missing(points, faces, rng):
    return points, faces[rng.random(len(faces)) >= rng.uniform(0.02, 0.2)]


def turned(points, faces, rng):
    is_turned = rng.random(len(faces)) < rng.uniform(0.02, 0.2)
    return points, numpy.where(is_turned[:, None], faces[:, [0, 2, 1]], faces)


def doubled(points, faces, rng):
    return points, numpy.vstack([faces, faces[rng.random(len(faces)) < rng.uniform(0.02, 0.2)]])


def jittered(points, faces, rng):
    off = 10 ** rng.uniform(-6, -2.5)
    apart = points[faces].reshape(-1, 3)
    return apart + rng.uniform(-off, off, apart.shape), numpy.arange(len(apart)).reshape(-1, 3)


def walls(points, faces, rng):
    """Walls with two sides inside and across: closed, and around nothing."""
    base = len(points)
    square = rng.normal(size=3) * 0.2 + numpy.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]]) * 1.5
    sides = numpy.array([[0, 1, 2], [0, 2, 3], [0, 2, 1], [0, 3, 2]]) + base
    return numpy.vstack([points, square]), numpy.vstack([faces, sides])


def everything(points, faces, rng):
    for fault in (missing, turned, doubled, jittered):
        points, faces = fault(points, faces, rng)
    return points, faces


def write(path, points, faces):
    with open(path, "w") as file:
        print("OFF", len(points), len(faces), 0, file=file)
        file.writelines("{!r} {!r} {!r}\n".format(*map(float, point)) for point in points)
        file.writelines("3 {} {} {}\n".format(*face) for face in faces)


def by_trisect(program, path, _):
    out = path.with_suffix(".made.off")
    start = time.perf_counter()
    command = [program, "solidify", str(path), "-o", str(out), "--json", "--quiet"]
    done = subprocess.run(command, capture_output=True, text=True)
    seconds = time.perf_counter() - start
    if done.returncode != 0:
        return None, seconds
    return json.loads(done.stdout)["result"]["volume"], seconds


def by_manifold_rust(program, path, _):
    try:
        done = subprocess.run([program, "soups", str(path)], capture_output=True, text=True, timeout=60)
    except subprocess.TimeoutExpired:
        return None, 60.0
    if done.returncode != 0:
        return None, 0.0
    told = json.loads(done.stdout)
    return (told["volume"] if told["status"] == "NoError" else None), told["ms"] / 1e3


def by_ftetwild(_, path, soup):
    import pytetwild

    start = time.perf_counter()
    try:
        points, cells = pytetwild.tetrahedralize(*soup, edge_length_fac=0.1, num_threads=2, quiet=True)[:2]
    except RuntimeError:
        return None, time.perf_counter() - start
    a, b, c, d = (points[cells[:, k]] for k in range(4))
    volumes = numpy.einsum("ij,ij->i", numpy.cross(b - a, c - a), d - a) / 6
    return float(numpy.abs(volumes).sum()), time.perf_counter() - start


def main(own, peer, count):
    engines = {"trisect": (own, by_trisect), "manifold-rust": (peer, by_manifold_rust)}
    try:
        import pytetwild  # noqa: F401

        engines["fTetWild"] = (None, by_ftetwild)
    except ImportError:
        print("(no pytetwild)")
    names = " | ".join(f"{name}: results; off, mean and most; s" for name in engines)
    print(f"| soups | {names} |")
    with tempfile.TemporaryDirectory() as folder:
        for fault in (walls, doubled, turned, missing, jittered, everything):
            found = {name: [] for name in engines}
            for number in range(count):
                rng = numpy.random.default_rng([SEED, number])
                solid = known(number)
                points, faces = fault(numpy.asarray(solid.vertices), numpy.asarray(solid.faces), rng)
                path = Path(folder) / f"{fault.__name__}-{number}.off"
                write(path, points, faces)
                for name, (program, run) in engines.items():
                    volume, seconds = run(program, path, (points, faces))
                    found[name].append((None if volume is None else abs(volume / solid.volume - 1), seconds))
            cells = []
            for results in found.values():
                offs = [off for off, _ in results if off is not None]
                tell = f"{len(offs)} of {count}"
                if offs:
                    seconds = numpy.mean([seconds for off, seconds in results if off is not None])
                    tell += f"; {numpy.mean(offs):.1e}, {max(offs):.1e}; {seconds:.2f}"
                cells.append(tell)
            print(f"| {fault.__name__} | {' | '.join(cells)} |", flush=True)


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2], int(sys.argv[3]) if len(sys.argv) > 3 else 12)
