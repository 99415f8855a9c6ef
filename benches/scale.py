"""Ten thousand jobs on one machine and through Ray, and unions tile by tile; see README.md and docs/scale.md.

    python benches/scale.py jobs FOLDER COUNT         # makes FOLDER/jobs.jsonl of the meshes in fixtures/
    python benches/scale.py batch FOLDER              # runs them with worker processes, one of which is killed
    python benches/scale.py ray FOLDER                # runs them through Ray, one worker of which is killed
    python benches/scale.py program FOLDER PROGRAM    # runs them with the program's `batch`, a process of which is killed
    python benches/scale.py same FOLDER               # compares the files of all that were run, byte by byte
    python benches/scale.py infill COUNT [TILES]      # a lattice of so many balls, tile by tile and at once
    python benches/scale.py pair COUNT [SLABS]        # two rings of so many triangles together, slab by slab and at once
    python benches/scale.py memory                    # workers without enough memory
"""

from __future__ import annotations

import filecmp
import json
import os
import pathlib
import random
import resource
import signal
import subprocess
import sys
import threading
import time
from typing import Any, Callable, Dict, List

import trisect

FIXTURES = pathlib.Path(__file__).parents[1] / "fixtures"


# Every 25th job each: verb, inputs, options, and how what is written ends.
_EXTRA = {
    3: ("section", 1, {"heights": "-1:0.25:1"}, "svg"),
    5: ("split", 1, {}, "ply"),
    8: ("trim", 2, {"inside": True}, "obj"),
    12: ("check", 2, {}, ""),
    15: ("cut", 1, {"plane": ["x=0.125", "z=0"]}, "ply"),
    18: ("convert", 1, {}, "stl"),
    22: ("combine", 2, {"all": True}, "ply"),
}


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
                # (Verbs with several outputs, drawings, or none, every few.)
            extra = _EXTRA.get(number % 25)
            if extra is not None:
                verb, inputs, options, kind = extra
                places = [str(first), {"file": str(second), "translate": move}][:inputs]
                output = {"output": f"OUT/{number}.{kind}"} if kind else {}
                job = {"id": f"j{number}", "verb": verb, "inputs": places, **output, "options": {"timeout": 60, **options}}
                file.write(json.dumps(job) + "\n")
                continue
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
    """Processes that we have started, or that those have, whose command line has a mark."""
    found = []
    for entry in filter(str.isdigit, os.listdir("/proc")):
        try:
            with open(f"/proc/{entry}/cmdline", encoding="utf-8", errors="replace") as file:
                if mark in file.read():
                    found.append(int(entry))
        except OSError:
            continue
    return [process for process in found if process != os.getpid() and is_ours(process)]


def is_ours(process: int) -> bool:
    """Whether a process descends from this one."""
    while process > 1 and process != os.getpid():
        process = parent(process)
    return process == os.getpid()


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
            # (A worker of Ray is called so only while it has a task.)
            memory.extend(sorted(filter(None, map(resident, processes(mark))))[-1:])
        if done == total // 2:
            victims = processes(mark)
            if victims:
                os.kill(victims[0], signal.SIGKILL)
                killed.append(victims[0])

    start = time.perf_counter()
    summary = batch(of_kind(folder, kind), out, folder=folder, progress=on_progress)
    seconds = time.perf_counter() - start
    assert summary.done + summary.failed == total
    tell(kind, total, out, seconds, len(killed), memory)


def program(folder: pathlib.Path, path: str) -> None:
    """The same jobs with the program, in a folder where their outputs go; a process of a job is killed."""
    out, jobs = folder / "program.jsonl", folder / "program-jobs.jsonl"
    out.unlink(missing_ok=True)
    with open(jobs, "w", encoding="utf-8") as file:
        for job in of_kind(folder, "program"):
            file.write(json.dumps(job) + "\n")
    start = time.perf_counter()
    process = subprocess.Popen([path, "batch", str(jobs), "-o", str(out), "--quiet"])
    total = sum(1 for _ in of_kind(folder, "program"))
    memory, killed = [], []
    while process.poll() is None:
        memory.extend(filter(None, [resident(process.pid)]))
        if not killed and out.exists() and sum(1 for _ in open(out, "rb")) >= total // 2:
            victims = [entry for entry in processes(os.path.basename(path)) if parent(entry) == process.pid]
            for victim in victims[:1]:
                os.kill(victim, signal.SIGKILL)
                killed.append(victim)
        time.sleep(0.02 if not killed else 0.5)
    tell("program", total, out, time.perf_counter() - start, len(killed), memory)


def parent(process: int) -> int:
    """The process that started a process."""
    try:
        with open(f"/proc/{process}/stat", encoding="ascii") as file:
            return int(file.read().rsplit(")", 1)[1].split()[1])
    except OSError:
        return 0


def tell(kind: str, total: int, out: pathlib.Path, seconds: float, killed: int, memory: List[float]) -> None:
    """Counts the reports."""
    reports = [json.loads(line) for line in out.read_text(encoding="utf-8").splitlines()]
    kinds: Dict[str, int] = {}
    for report in reports:
        if report["status"] != "done":
            name = report.get("error", {}).get("kind", "unusable files")
            kinds[name] = kinds.get(name, 0) + 1
    spent = resource.getrusage(resource.RUSAGE_SELF).ru_utime + resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    ids = [report["id"] for report in reports]
    print(
        f"{kind}: {total} jobs, {len(ids) - sum(kinds.values())} done, failed {kinds}, {len(ids)} reports of {len(set(ids))} jobs, "
        f"{killed} worker killed, {seconds:.1f} s by the clock, {spent:.1f} s of processors (of processes that ended), load "
        f"{os.getloadavg()[0]:.1f}; largest worker {memory[0]:.0f} MB at first, {max(memory):.0f} MB at most, {memory[-1]:.0f} MB at the end"
    )


def same(folder: pathlib.Path) -> None:
    """Compares outputs byte by byte, and what became of each job."""
    kinds = [kind for kind in ("batch", "ray", "program") if (folder / f"{kind}.jsonl").exists()]
    one, *others = kinds
    names = sorted(path.name for path in (folder / one).iterdir())
    ends = {kind: _ends(folder / f"{kind}.jsonl") for kind in kinds}
    for other in others:
        theirs = sorted(path.name for path in (folder / other).iterdir())
        equal, different, missing = filecmp.cmpfiles(folder / one, folder / other, names, shallow=False)
        more = sorted(set(theirs) - set(names))
        apart = [name for name, end in ends[one].items() if ends[other].get(name) != end]
        print(
            f"{one} and {other}: {len(names)} and {len(theirs)} files, {len(equal)} the same, {len(different)} different {different[:8]}, "
            f"{len(missing)} missing {missing[:8]}, {len(more)} more {more[:8]}; {len(apart)} jobs ended otherwise {apart[:8]}"
        )


def _ends(path: pathlib.Path) -> Dict[str, Any]:
    """How each job ended: the kind of its error, if it failed."""
    with open(path, encoding="utf-8") as file:
        reports = [json.loads(line) for line in file]
    return {report["id"]: (report["status"], report.get("error", {}).get("kind")) for report in reports}


def infill(count: int, tiles: int) -> None:
    """A lattice of balls that overlap their neighbours."""
    from trisect import ray as many

    ball = trisect.icosphere(0.56, level=1)
    side = max(1, round(count ** (1 / 3)))
    places = [(i // (side * side), i // side % side, i % side) for i in range(count)]
    # Turned, so that nothing is aligned.
    turned = [ball.rotated([1, 2, 3], 7 * i) for i in range(16)]
    parts = [turned[sum(place) % 16].translated(place) for place in places]
    _started(many)
    with Memory() as memory:
        tiled = many.union(parts, tiles=(tiles,) * 3 if tiles else None)
    print(f"memory of all processes at most {memory.most / 1e9:.1f} GB", flush=True)
    _alone(f"infill of {len(parts)} balls, {sum(len(part.faces) for part in parts)} triangles", tiled, lambda: trisect.union(parts, threads=1))


def pair(count: int, slabs: int) -> None:
    """Two rings."""
    from trisect import ray as many

    # Twice as many parts around as across: 2 * around * across triangles each.
    across = max(8, round((count / 8) ** 0.5))
    a = trisect.torus(1.0, 0.4, around=2 * across, across=across)
    b = a.rotated([1, 2, 3], 40).translated([0.5, 0.013, -0.007])
    print(f"{len(a.faces) + len(b.faces)} triangles", flush=True)
    _started(many)
    # (Not the solids that are united in one process afterwards, which would remember what was found out here.)
    one, two = (trisect.Solid(solid.vertices, solid.faces) for solid in (a, b))
    with Memory() as memory:
        tiled = many.combine_large("union", one, two, slabs=slabs)
    del one, two
    print(f"memory of all processes at most {memory.most / 1e9:.1f} GB", flush=True)
    _alone(f"two rings of {len(a.faces)} triangles", tiled, lambda: trisect.union(a, b, threads=1))


class Memory:
    """The most memory that this process and Ray's together had meanwhile (shared pages once, from /proc/meminfo)."""

    def __enter__(self) -> "Memory":
        self.most, self._over, before = 0.0, threading.Event(), self._available()

        def look() -> None:
            while not self._over.wait(0.2):
                self.most = max(self.most, before - self._available() + resident(os.getpid()) * 1e6)

        self._thread = threading.Thread(target=look, daemon=True)
        self._thread.start()
        return self

    def __exit__(self, *error: Any) -> None:
        self._over.set()
        self._thread.join()

    @staticmethod
    def _available() -> float:
        with open("/proc/meminfo", encoding="ascii") as file:
            return float(next(line.split()[1] for line in file if line.startswith("MemAvailable"))) * 1024


def memory() -> None:
    """A worker out of memory: what becomes of its job."""
    import tempfile

    with tempfile.TemporaryDirectory() as place:
        trisect.icosphere(1.0, level=8).save(f"{place}/ball.ply")
        job = {"id": "large", "verb": "union", "inputs": ["ball.ply", {"file": "ball.ply", "translate": [0.1, 0, 0]}]}
        # 1. A ceiling of ours; 2. one of the system's for what workers may have, so that they are refused memory and end.
        over = threading.Event()

        def hold() -> None:
            while not over.wait(0.005):
                for worker in processes("trisect._worker"):
                    try:
                        resource.prlimit(worker, resource.RLIMIT_AS, (_LITTLE, _LITTLE))
                    except OSError:
                        continue

        for name, options in (("option memory", {"memory": "100M"}), (f"workers of {_LITTLE / 1e6:.0f} MB", {})):
            if not options:
                threading.Thread(target=hold, daemon=True).start()
            start = time.perf_counter()
            [report] = trisect.batch([{**job, "options": options}], folder=place, workers=1).reports or []
            print(f"{name}: {report['status']} {report.get('error')} in {time.perf_counter() - start:.1f} s", flush=True)
        over.set()


# Enough for Python and the package, and for reading one of two balls of 1.3 M triangles.
_LITTLE = 350_000_000


def _started(module: Any) -> None:
    import ray

    if not ray.is_initialized():
        ray.init(num_cpus=2, include_dashboard=False, log_to_driver=False, object_store_memory=4_000_000_000)
    # So that starting workers is not measured.
    ray.get([ray.remote(num_cpus=1)(lambda: trisect.icosphere(1.0, level=2).volume).remote() for _ in range(4)])
    module.union([trisect.cuboid([0, 0, 0], [1, 1, 1])] * 4, tiles=(1, 1, 1))


def _alone(name: str, tiled: Any, union: Callable[[], trisect.Solid]) -> None:
    """The same in one process on one thread, and how both compare."""
    start, process = time.perf_counter(), time.process_time()
    alone = union()
    seconds, process = time.perf_counter() - start, time.process_time() - process
    relative = abs(tiled.solid.volume - alone.volume) / alone.volume
    closed = trisect.Solid(tiled.solid.mesh(), as_is=True).volume == tiled.solid.volume
    print(
        f"{name}: {tiled.tiles} tiles and {tiled.merges} merges in {tiled.seconds:.2f} s with two workers, in one process on one thread "
        f"{seconds:.2f} s ({process:.2f} s of the processor): {seconds / tiled.seconds:.2f} times as fast; {tiled.moved / 1e6:.1f} MB moved; "
        f"volumes differ by {relative:.1e} relative; closed: {closed}; components {tiled.solid.components} and "
        f"{alone.components}, genus {tiled.solid.genus} and {alone.genus}, {len(tiled.solid.faces)} and {len(alone.faces)} triangles; "
        f"tasks took {tiled.processor:.2f} s of processors, {tiled.path:.2f} s of that one after the other; steps {tiled.steps}; load {os.getloadavg()[0]:.1f}"
    )


def main() -> None:
    """Does what the command line says."""
    what = sys.argv[1]
    if what == "infill":
        infill(int(sys.argv[2]), int(sys.argv[3]) if len(sys.argv) > 3 else 0)
    elif what == "pair":
        pair(int(sys.argv[2]), int(sys.argv[3]) if len(sys.argv) > 3 else 4)
    elif what == "memory":
        memory()
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
            # (Not Ray's own processes, without which it is none.)
            run(folder, "ray", many.batch, "ray::run_on_one_thread")
        elif what == "program":
            program(folder, sys.argv[3])
        elif what == "same":
            same(folder)


if __name__ == "__main__":
    main()
