"""Ten thousand jobs on one machine and through Ray, and unions tile by tile; see README.md and docs/scale.md.

    python benches/scale.py jobs FOLDER COUNT     # makes FOLDER/jobs.jsonl of the meshes in fixtures/
    python benches/scale.py batch FOLDER          # runs them with worker processes, one of which is killed
    python benches/scale.py ray FOLDER            # runs them through Ray, one worker of which is killed
    python benches/scale.py same FOLDER           # compares the files of both, byte by byte
    python benches/scale.py infill COUNT          # a lattice of balls, tile by tile and at once
    python benches/scale.py pair LEVEL            # two balls of 20 * 4**LEVEL triangles, slab by slab and at once
"""

from __future__ import annotations

import filecmp
import json
import os
import pathlib
import random
import signal
import sys
import time
from typing import Any, Callable, List

import trisect

FIXTURES = pathlib.Path(__file__).parents[1] / "fixtures"


def make_jobs(folder: pathlib.Path, count: int) -> None:
    """Jobs of real models: most are fine, some are open, some are no files."""
    folder.mkdir(parents=True, exist_ok=True)
    small = [path for path in sorted((FIXTURES / "solids").iterdir()) if path.stat().st_size < 150_000]
    odd = sorted((FIXTURES / "open").iterdir()) + sorted((FIXTURES / "formats").iterdir())
    odd = [path for path in odd if path.is_file() and path.stat().st_size < 150_000]
    drawn = random.Random(7)
    with open(folder / "jobs.jsonl", "w", encoding="utf-8") as file:
        for number in range(count):
            first, second = drawn.choice(small), drawn.choice(odd if number % 10 == 0 else small)
            verb = drawn.choice(["union", "difference", "intersection", "xor"])
            move = [drawn.randrange(-8, 9) / 16 for _ in range(3)]
            job = {
                "id": f"j{number}",
                "verb": verb,
                "inputs": [str(first), {"file": str(second), "translate": move}],
                "output": f"OUT/{number}.ply",
                "options": {"timeout": 60},
            }
            file.write(json.dumps(job) + "\n")


def of_kind(folder: pathlib.Path, kind: str) -> Any:
    """The jobs, with outputs in a folder of their own."""
    with open(folder / "jobs.jsonl", encoding="utf-8") as file:
        for line in file:
            yield json.loads(line.replace("OUT/", f"{kind}/"))


def processes(mark: str) -> List[int]:
    """Processes whose command line has a mark."""
    found = []
    for entry in filter(str.isdigit, os.listdir("/proc")):
        try:
            with open(f"/proc/{entry}/cmdline", encoding="utf-8", errors="replace") as file:
                if mark in file.read():
                    found.append(int(entry))
        except OSError:
            continue
    return [process for process in found if process != os.getpid()]


def resident(process: int) -> float:
    """Memory of a process, in MB."""
    try:
        with open(f"/proc/{process}/statm", encoding="ascii") as file:
            return int(file.read().split()[1]) * 4096 / 1e6
    except OSError:
        return 0.0


def run(folder: pathlib.Path, kind: str, batch: Callable[..., Any], mark: str) -> None:
    """Runs the jobs, kills a worker in the middle, and counts the reports."""
    out = folder / f"{kind}.jsonl"
    out.unlink(missing_ok=True)
    total = sum(1 for _ in of_kind(folder, kind))
    memory: List[float] = []
    killed: List[int] = []

    def on_progress(done: int, of: Any, failed: int, left: Any) -> None:
        if done % max(1, total // 20) == 0:
            memory.append(max((resident(process) for process in processes(mark)), default=0.0))
        if done == total // 2:
            victims = processes(mark)
            if victims:
                os.kill(victims[0], signal.SIGKILL)
                killed.append(victims[0])

    start = time.perf_counter()
    summary = batch(of_kind(folder, kind), out, folder=folder, progress=on_progress)
    seconds = time.perf_counter() - start
    ids = [json.loads(line)["id"] for line in out.read_text(encoding="utf-8").splitlines()]
    print(
        f"{kind}: {total} jobs, {summary.done} done, {summary.failed} failed, {len(ids)} reports of {len(set(ids))} jobs, "
        f"{len(killed)} worker killed, {seconds:.1f} s; a worker's memory {memory[0]:.0f} MB at first, "
        f"{max(memory):.0f} MB at most, {memory[-1]:.0f} MB at the end"
    )


def same(folder: pathlib.Path) -> None:
    """Compares outputs byte by byte."""
    one, two = folder / "batch", folder / "ray"
    names = sorted(path.name for path in one.iterdir())
    others = sorted(path.name for path in two.iterdir())
    equal, different, errors = filecmp.cmpfiles(one, two, names, shallow=False)
    print(f"same: {len(names)} and {len(others)} files, {len(equal)} the same, {len(different)} different, {len(errors)} missing")


def infill(count: int) -> None:
    """A lattice of balls that overlap their neighbours."""
    from trisect import ray as many

    side = round(count ** (1 / 3))
    ball = trisect.icosphere(0.56, level=1)
    places = [(x, y, z) for x in range(side) for y in range(side) for z in range(side)]
    # Turned, so that nothing is aligned.
    turned = [ball.rotated([1, 2, 3], 7 * i) for i in range(16)]
    parts = [turned[sum(place) % 16].translated(place) for place in places]
    _started(many)
    tiled = many.union(parts)
    start = time.perf_counter()
    alone = trisect.union(parts, threads=1)
    _compare(f"infill of {len(parts)} balls", tiled, alone, time.perf_counter() - start)


def pair(level: int) -> None:
    """Two balls."""
    from trisect import ray as many

    a = trisect.icosphere(1.0, level=level)
    b = a.rotated([1, 2, 3], 40).translated([0.5, 0.013, -0.007])
    _started(many)
    slabs = many.combine_large("union", a, b, slabs=4)
    start = time.perf_counter()
    alone = trisect.union(a, b, threads=1)
    _compare(f"two balls of {len(a.faces)} triangles", slabs, alone, time.perf_counter() - start)


def _started(module: Any) -> None:
    import ray

    if not ray.is_initialized():
        ray.init(num_cpus=2, include_dashboard=False, log_to_driver=False)
    # So that starting workers is not measured.
    module.union([trisect.cuboid([0, 0, 0], [1, 1, 1])] * 4, tiles=(1, 1, 1))


def _compare(name: str, tiled: Any, alone: trisect.Solid, seconds: float) -> None:
    relative = abs(tiled.solid.volume - alone.volume) / alone.volume
    print(
        f"{name}: {tiled.tiles} tiles and {tiled.merges} merges in {tiled.seconds:.2f} s, at once on one thread {seconds:.2f} s; "
        f"{tiled.moved / 1e6:.1f} MB moved; volumes differ by {relative:.1e} relative; components {tiled.solid.components} and "
        f"{alone.components}, genus {tiled.solid.genus} and {alone.genus}, {len(tiled.solid.faces)} and {len(alone.faces)} triangles"
    )


def main() -> None:
    """Does what the command line says."""
    what = sys.argv[1]
    if what == "infill":
        infill(int(sys.argv[2]))
    elif what == "pair":
        pair(int(sys.argv[2]))
    else:
        folder = pathlib.Path(sys.argv[2])
        if what == "jobs":
            make_jobs(folder, int(sys.argv[3]))
        elif what == "batch":
            run(folder, "batch", trisect.batch, "trisect._worker")
        elif what == "ray":
            import ray
            from trisect import ray as many

            ray.init(num_cpus=2, include_dashboard=False, log_to_driver=False)
            run(folder, "ray", many.batch, "ray::")
        elif what == "same":
            same(folder)


if __name__ == "__main__":
    main()
