"""What the Python package costs over the crate, beside manifold3d and trueform; see README.md.

    cd python && maturin build --release && cargo build --release --features extension-module --example rust_call && cd ..
    pip install python/target/wheels/trisect-*.whl manifold3d trueform
    python benches/python.py python/target/release/examples/rust_call

Without the last argument what is called from Rust is left out. Times of one thread are of the process, so that they mean something on a
busy machine; the gain of two threads, and whatever uses all cores, is of the clock.
"""

from __future__ import annotations

import gc
import json
import os
import statistics
import subprocess
import sys
import threading
import time
from typing import Any, Callable, Dict, List, Tuple

import numpy as np
import trisect

Arrays = Tuple[np.ndarray, np.ndarray]


def least(call: Callable[[], Any], times: int, clock: Callable[[], float] = time.process_time) -> float:
    """The least time of several calls, in seconds."""
    taken = []
    gc.disable()
    for _ in range(times):
        start = clock()
        call()
        taken.append(clock() - start)
    gc.enable()
    return min(taken)


def arrays(solid: trisect.Solid) -> Arrays:
    """Arrays as a caller has them."""
    return solid.vertices.copy(), solid.faces.astype(np.int64)


def ours(a: Arrays, b: Arrays, **settings: Any) -> Arrays:
    """Array to array."""
    result = trisect.union(a, b, **settings)
    return result.vertices, result.faces


def of_manifold(a: Arrays, b: Arrays) -> Any:
    """The same with manifold3d."""
    import manifold3d

    made = [
        manifold3d.Manifold(manifold3d.Mesh64(vert_properties=v, tri_verts=f.astype(np.uint64)))
        for v, f in (a, b)
    ]
    mesh = (made[0] + made[1]).to_mesh64()
    return mesh.vert_properties, mesh.tri_verts


def of_trueform(a: Arrays, b: Arrays) -> Any:
    """The same with trueform."""
    import trueform

    (faces, points), _, _ = trueform.boolean_union(trueform.Mesh(a[1], a[0]), trueform.Mesh(b[1], b[0]))
    return points, faces


THEIRS = {"manifold3d": of_manifold, "trueform": of_trueform}


def row(name: str, *cells: str) -> None:
    """A row of a table."""
    print("| " + " | ".join([name, *cells]) + " |", flush=True)


def large(rust: Dict[str, float]) -> None:
    """Two balls of 327,680 triangles."""
    ball = trisect.icosphere(1.0, level=7)
    other = ball.rotated([1, 2, 3], 40).translated([0.5, 0.013, -0.007])
    a, b = arrays(ball), arrays(other)
    for name, settings in (("balls_clean", {"assume_clean": True}), ("balls", {})):
        whole = least(lambda: ours(a, b, threads=1, **settings), 9)
        said = "taken to be clean" if settings else "searched for self-crossings (default)"
        row(f"two balls of 327,680 triangles, one thread, {said}: array to array", f"{1e3 * whole:.1f} ms")
        if name in rust:
            row("the same from Rust", f"{1e3 * rust[name]:.1f} ms", f"{100 * (whole / rust[name] - 1):+.1f} %")
    gate = least(lambda: [trisect.Solid(*x, threads=1) for x in (a, b)], 9)
    row("of that, two solids from arrays", f"{1e3 * gate:.1f} ms")
    everything = [("trisect", lambda: ours(a, b)), *((name, lambda call=call: call(a, b)) for name, call in THEIRS.items())]
    for name, call in everything:
        try:
            clock, process = least(call, 9, time.perf_counter), least(call, 5)
        except ImportError:
            continue
        row(f"{name}, array to array, f64, all {os.cpu_count()} cores", f"{1e3 * clock:.1f} ms", f"{1e3 * process:.1f} ms of the process")


def small(rust: Dict[str, float]) -> None:
    """Two cubes."""
    a, b = trisect.cuboid([0, 0, 0], [1, 1, 1]), trisect.cuboid([0.5] * 3, [1.5] * 3)
    x, y = arrays(a), arrays(b)

    def many(call: Callable[[], Any]) -> float:
        def run() -> None:
            for _ in range(500):
                call()

        return least(run, 15) / 500

    core = trisect._operations._trisect
    row("two cubes: the call of the crate, from Python", f"{1e6 * many(lambda: core.combine('union', [a._core, b._core])):.1f} us")
    row("`trisect.union(a, b)`", f"{1e6 * many(lambda: trisect.union(a, b)):.1f} us")
    row("`a | b`", f"{1e6 * many(lambda: a | b):.1f} us")
    row("a solid of a cube from arrays", f"{1e6 * many(lambda: trisect.Solid(*x)):.1f} us")
    whole = many(lambda: ours(x, y))
    row("two cubes, array to array", f"{1e6 * whole:.1f} us")
    if rust:
        row("the same from Rust", f"{1e6 * rust['cubes']:.1f} us", f"{1e6 * (whole - rust['cubes']):+.1f} us")
    for name, call in THEIRS.items():
        try:
            row(f"{name}, array to array", f"{1e6 * many(lambda: call(x, y)):.1f} us")
        except ImportError:
            continue


def two_threads() -> None:
    """Two calls at once."""
    ball = trisect.icosphere(1.0, level=6)
    pairs = [(ball, ball.rotated([1, 2, i], 40).translated([0.5, 0, 0])) for i in (3, 4)]
    for a, b in pairs:
        a.self_crossings(), b.self_crossings()

    def work(pair: Any) -> None:
        for _ in range(5):
            trisect.union(*pair, threads=1)

    def together() -> None:
        threads = [threading.Thread(target=work, args=(pair,)) for pair in pairs]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()

    gains: List[float] = []
    for _ in range(12):
        alone = least(lambda: [work(pair) for pair in pairs], 1, time.perf_counter)
        gains.append(alone / least(together, 1, time.perf_counter))
    # (How much processor both had at once tells how much of two cores there was to be had.)
    start, process = time.perf_counter(), time.process_time()
    together()
    had = (time.process_time() - process) / (time.perf_counter() - start)
    row("two threads at once, gain", f"{max(gains):.2f} (median {statistics.median(gains):.2f})", f"{had:.2f} cores were free")


def main() -> None:
    """All of it."""
    rust: Dict[str, float] = {}
    if len(sys.argv) > 1:
        rust = json.loads(subprocess.run([sys.argv[1]], capture_output=True, check=True, text=True).stdout)
    print(f"trisect {trisect.__version__}, NumPy {np.__version__}, load {os.getloadavg()[0]:.1f}")
    small(rust)
    large(rust)
    two_threads()


if __name__ == "__main__":
    main()
