"""What the Python package costs over the crate, and beside manifold3d; see README.md.

    pip install python/target/wheels/trisect-*.whl manifold3d
    python benches/python.py

Times are of the process (``time.process_time``), so that they mean something on a busy machine; the gain of two threads is one of the
clock.
"""

from __future__ import annotations

import gc
import statistics
import threading
import time
from typing import Any, Callable, List, Tuple

import numpy as np
import trisect


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


def arrays(solid: trisect.Solid) -> Tuple[np.ndarray, np.ndarray]:
    """Arrays as a caller has them."""
    return solid.vertices.copy(), solid.faces.astype(np.int64)


def ours(a: Any, b: Any, **settings: Any) -> Tuple[np.ndarray, np.ndarray]:
    """Array to array."""
    result = trisect.union((a[0], a[1]), (b[0], b[1]), **settings)
    return result.vertices, result.faces


def theirs(a: Any, b: Any) -> Any:
    """The same with manifold3d."""
    import manifold3d

    made = [
        manifold3d.Manifold(manifold3d.Mesh64(vert_properties=v, tri_verts=f.astype(np.uint64)))
        for v, f in (a, b)
    ]
    mesh = (made[0] + made[1]).to_mesh64()
    return mesh.vert_properties, mesh.tri_verts


def row(name: str, *cells: str) -> None:
    """A row of a table."""
    print("| " + " | ".join([name, *cells]) + " |", flush=True)


def large() -> None:
    """Two balls of 327,680 triangles."""
    ball = trisect.icosphere(1.0, level=7)
    other = ball.rotated([1, 2, 3], 40).translated([0.5, 0.013, -0.007])
    a, b = arrays(ball), arrays(other)
    settings = {"threads": 1, "assume_clean": True}
    solids = [trisect.Solid(*a), trisect.Solid(*b)]
    engine = least(lambda: trisect.union(*solids, **settings), 7)
    gate = least(lambda: [trisect.Solid(*x, threads=1) for x in (a, b)], 7)
    copies = least(lambda: [(x[0].copy(), x[1].astype(np.uint32)) for x in (a, b)], 7)
    whole = least(lambda: ours(a, b, **settings), 7)
    row("union of solids (the call of the crate)", f"{1e3 * engine:.1f} ms")
    row("two solids from arrays (the gate of the crate, and reading the arrays)", f"{1e3 * gate:.1f} ms")
    row("of that, reading the arrays: copies as NumPy makes them", f"{1e3 * copies:.1f} ms")
    row("array to array", f"{1e3 * whole:.1f} ms")
    checked = least(lambda: ours(a, b, threads=1), 3)
    row("array to array, with the search for self-crossings (default)", f"{1e3 * checked:.1f} ms")
    try:
        row("manifold3d, array to array, f64", f"{1e3 * least(lambda: theirs(a, b), 5):.1f} ms (of the process)")
    except ImportError:
        pass


def small() -> None:
    """Two cubes."""
    a, b = trisect.cuboid([0, 0, 0], [1, 1, 1]), trisect.cuboid([0.5] * 3, [1.5] * 3)
    x, y = arrays(a), arrays(b)

    def many(call: Callable[[], Any]) -> float:
        def run() -> None:
            for _ in range(500):
                call()

        return least(run, 9) / 500

    core = trisect._operations._trisect
    bare = many(lambda: core.combine("union", [a._core, b._core]))
    row("cubes: the call of the crate", f"{1e6 * bare:.1f} us")
    row("cubes: `trisect.union(a, b)`", f"{1e6 * many(lambda: trisect.union(a, b)):.1f} us")
    row("cubes: `a | b`", f"{1e6 * many(lambda: a | b):.1f} us")
    row("cubes: a solid from arrays", f"{1e6 * many(lambda: trisect.Solid(*x)):.1f} us")
    row("cubes: array to array", f"{1e6 * many(lambda: ours(x, y)):.1f} us")
    try:
        row("cubes: manifold3d, array to array", f"{1e6 * many(lambda: theirs(x, y)):.1f} us")
    except ImportError:
        pass


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
    for _ in range(5):
        alone = least(lambda: [work(pair) for pair in pairs], 1, time.perf_counter)
        gains.append(alone / least(together, 1, time.perf_counter))
    row("two threads at once, gain", f"{max(gains):.2f} (median {statistics.median(gains):.2f})")


if __name__ == "__main__":
    print(f"trisect {trisect.__version__}, NumPy {np.__version__}")
    small()
    large()
    two_threads()
