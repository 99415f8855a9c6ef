"""Many jobs on one machine."""

from __future__ import annotations

import json
import os
import signal
import threading
import time
from typing import Any, Dict, List

import pytest

import trisect


@pytest.fixture
def folder(tmp_path: Any) -> Any:
    """Two cubes, an open one, and a file that is none."""
    cube = trisect.cuboid([0, 0, 0], [1, 1, 1])
    cube.save(tmp_path / "cube.ply")
    trisect.Mesh(cube.vertices, cube.faces[1:]).save(tmp_path / "open.ply")
    (tmp_path / "broken.ply").write_text("ply\nformat ascii 1.0\n")
    return tmp_path


def jobs() -> List[Dict[str, Any]]:
    """What is done and what fails."""
    moved = {"file": "cube.ply", "translate": [0.5, 0.5, 0.5]}
    made: List[Dict[str, Any]] = [
        {"id": verb, "verb": verb, "inputs": ["cube.ply", moved], "output": f"out/{verb}.ply"}
        for verb in ("union", "difference", "intersection", "xor")
    ]
    made += [
        {"id": "expr", "verb": "combine", "inputs": ["cube.ply", moved], "output": "out/expr.stl", "options": {"expr": "a - b", "embed": True}},
        {"id": "cut", "verb": "cut", "inputs": ["cube.ply"], "options": {"plane": "z=0.25", "keep": "below"}},
        {"id": "filled", "verb": "resolve", "inputs": [{"file": "open.ply", "fill-holes": True, "rotate": [0, 0, 90]}]},
        {"id": "open", "verb": "union", "inputs": ["cube.ply", "open.ply"], "output": "out/open.ply"},
        {"id": "broken", "verb": "union", "inputs": ["broken.ply"], "output": "out/broken.ply"},
        {"id": "missing", "verb": "union", "inputs": ["missing.ply"]},
        {"id": "wrong", "verb": "merge", "inputs": ["cube.ply"]},
        {"id": "limit", "verb": "union", "inputs": ["cube.ply", moved], "options": {"memory": "1K"}},
        {"id": "key", "verb": "union", "inputs": ["cube.ply"], "outputs": "x"},
        {"id": "options", "verb": "union", "inputs": ["cube.ply"], "options": "none"},
    ]
    return made


def test_every_job_is_reported_once(folder: Any) -> None:
    lines = "".join(json.dumps(job) + "\n" for job in jobs()) + "no json\n"
    (folder / "jobs.jsonl").write_bytes(lines.encode() + b"\xff\xfe\n" + b"[" * 100_000 + b"\n")
    told: List[Any] = []
    out = folder / "reports.jsonl"
    summary = trisect.batch(folder / "jobs.jsonl", out, workers=2, progress=lambda *told_: told.append(told_))
    assert (summary.done, summary.failed, summary.skipped) == (7, 10, 0)
    reports = {report["id"]: report for report in map(json.loads, out.read_text().splitlines())}
    assert len(reports) == 17 and len(out.read_text().splitlines()) == 17
    assert all(report["seconds"]["total"] >= 0 for report in reports.values())
    kinds = {name: report["error"]["kind"] for name, report in reports.items() if report["status"] == "failed"}
    assert kinds == {
        "open": "unusable", "broken": "unreadable", "missing": "unreadable", "wrong": "usage", "limit": "limit", "key": "usage", "options": "usage",
        "15": "usage", "16": "usage", "17": "usage",
    }
    assert reports["union"]["result"]["volume"] == 1.875 and reports["cut"]["results"][0]["volume"] == 0.25
    assert reports["open"]["error"]["operand"] == 2
    assert told[-1][:3] == (17, 17, 10) and told[-1][3] is not None
    # The same bytes as one by one.
    alone = trisect.load(folder / "cube.ply") | trisect.load(folder / "cube.ply").translated([0.5] * 3)
    alone.save(folder / "alone.ply")
    assert (folder / "alone.ply").read_bytes() == (folder / "out" / "union.ply").read_bytes()


def test_inputs_are_placed_as_the_program_places_them(folder: Any) -> None:
    # Whatever the order of the keys: matrix, rotate, scale, translate.
    placed = {"file": "cube.ply", "translate": [0, 0, 5], "scale": [2, 1, 1], "rotate": 90}
    report = trisect.run_job({"verb": "convert", "inputs": [placed], "output": "placed.ply"}, folder)
    assert report["status"] == "done", report
    assert trisect.load(folder / "placed.ply").bounds.tolist() == [[-2, 0, 5], [0, 1, 6]]
    for wrong in ({"rotate": [90, 0]}, {"translate": "far"}, {"rotate": [1, 2, 3, 4]}):
        report = trisect.run_job({"verb": "convert", "inputs": [{"file": "cube.ply", **wrong}]}, folder)
        assert report["error"]["kind"] == "usage", report


def test_the_timeout_of_a_job_is_for_all_of_it(folder: Any, monkeypatch: Any) -> None:
    from trisect import _inputs

    given: List[float] = []
    load = _inputs._convert.load_with_format

    def slow(path: Any, part: Any, settings: Any) -> Any:
        given.append(settings["deadline"])
        time.sleep(0.1)
        return load(path, part, settings)

    monkeypatch.setattr(_inputs._convert, "load_with_format", slow)
    job = {"verb": "union", "inputs": ["cube.ply"] * 2, "options": {"timeout": 60}}
    assert trisect.run_job(job, folder)["status"] == "done"
    assert given[0] <= 60 and given[1] <= given[0] - 0.1
    for timeout, kind in ((0.05, "limit"), (-1, "usage"), ("soon", "usage")):
        assert trisect.run_job({**job, "options": {"timeout": timeout}}, folder)["error"]["kind"] == kind


def test_a_run_goes_on(folder: Any) -> None:
    out = folder / "reports.jsonl"
    out.write_text('{"id": "union", "status": "done"}\n{"id": "open", "status": "failed"}\n{"id": "xor", "sta')
    summary = trisect.batch(iter(jobs()), out, folder=folder, workers=1)
    assert (summary.done, summary.failed, summary.skipped) == (6, 6, 2)
    reports = [json.loads(line) for line in out.read_text().splitlines()]
    assert sorted(report["id"] for report in reports) == sorted(job["id"] for job in jobs())
    again = trisect.batch(jobs(), out, folder=folder, workers=1, retry_failed=True)
    assert (again.done, again.failed, again.skipped) == (0, 7, 7)
    assert len(again.failures) == 7 and again.failures[0]["error"]["message"]
    before = out.read_bytes()
    for line in (b"no reports\n", b"[1]\n", b"{}\n"):
        out.write_bytes(before + line)
        with pytest.raises(trisect.ArgumentError, match="no file of reports"):
            trisect.batch(jobs(), out, folder=folder, workers=1)
        assert out.read_bytes() == before + line
    for wrong in ({"workers": -1}, {"workers": 0}, {"attempts": 0}):
        with pytest.raises(trisect.ArgumentError):
            trisect.batch(jobs(), folder=folder, **wrong)  # type: ignore[arg-type]
    anew = trisect.batch(jobs()[:1], out, folder=folder, workers=1, resume=False)
    assert anew.done == 1 and len(out.read_text().splitlines()) == 1


def test_a_worker_that_is_killed_takes_nothing_with_it(folder: Any) -> None:
    many = [{"id": str(i), "verb": "union", "inputs": ["cube.ply", {"file": "cube.ply", "translate": [i / 64, 0, 0]}]} for i in range(40)]
    mine = os.getpid()
    killed: List[int] = []

    def kill() -> None:
        end = time.monotonic() + 60
        while not killed and time.monotonic() < end:
            for entry in filter(str.isdigit, os.listdir("/proc")):
                try:
                    with open(f"/proc/{entry}/stat", encoding="ascii") as file:
                        parent = int(file.read().rsplit(")", 1)[1].split()[1])
                    with open(f"/proc/{entry}/cmdline", encoding="ascii") as file:
                        is_worker = "trisect._worker" in file.read()
                except OSError:
                    continue
                if parent == mine and is_worker:
                    os.kill(int(entry), signal.SIGKILL)
                    killed.append(int(entry))
                    break
            time.sleep(0.01)

    if not os.path.isdir("/proc/self"):
        pytest.skip("needs /proc")
    killer = threading.Thread(target=kill)
    killer.start()
    summary = trisect.batch(many, folder=folder, workers=2)
    killer.join()
    assert killed and summary.done == 40 and summary.reports is not None
    assert sorted(int(report["id"]) for report in summary.reports) == list(range(40))


def test_a_job_that_kills_its_worker_is_reported(folder: Any, monkeypatch: Any) -> None:
    hook = folder / "hook"
    hook.mkdir()
    # Every worker of this test ends at the first file called so.
    (hook / "sitecustomize.py").write_text(
        "import os, sys\n"
        "sys.addaudithook(lambda event, args: os._exit(9) if event == 'trisect.never' else None)\n"
        "import builtins\n"
        "real = builtins.__import__\n"
        "def patched(name, *a, **k):\n"
        "    module = real(name, *a, **k)\n"
        "    jobs = sys.modules.get('trisect._jobs')\n"
        "    if jobs is not None and hasattr(jobs, 'run_job') and not hasattr(jobs, 'patched'):\n"
        "        jobs.patched, run = True, jobs.run_job\n"
        "        jobs.run_job = lambda job, folder: os._exit(9) if job['id'] == 'deadly' else run(job, folder)\n"
        "    return module\n"
        "builtins.__import__ = patched\n"
    )
    monkeypatch.syspath_prepend(str(hook))
    some = [{"id": name, "verb": "convert", "inputs": ["cube.ply"]} for name in ("a", "deadly", "b")]
    summary = trisect.batch(some, folder=folder, workers=1)
    assert (summary.done, summary.failed) == (2, 1)
    assert summary.failures[0]["id"] == "deadly" and summary.failures[0]["error"]["kind"] == "lost"


def test_jobs_anywhere_that_fsspec_knows(folder: Any) -> None:
    fsspec = pytest.importorskip("fsspec")
    with fsspec.open("memory://meshes/cube.ply", "wb") as file:
        file.write((folder / "cube.ply").read_bytes())
    job = {"id": "x", "verb": "union", "inputs": ["memory://meshes/cube.ply"], "output": "memory://made/x.ply"}
    report = trisect.run_job(job)
    assert report["status"] == "done", report
    assert fsspec.filesystem("memory").exists("/made/x.ply")
    # The folder may be there too.
    report = trisect.run_job({"verb": "convert", "inputs": ["cube.ply"], "output": "y.stl"}, "memory://meshes")
    assert report["status"] == "done" and fsspec.filesystem("memory").exists("/meshes/y.stl"), report
