"""Many jobs on one machine: worker processes, reports as JSON Lines, a stop and a start again.

Workers are processes of their own (``python -m trisect._worker``), so that one that dies takes one job with it, and memory that a
job took is the system's again. Jobs are read one by one as workers become free, and reports written as they come: memory does not
grow with their number. On many machines see :mod:`trisect.ray`.
"""

from __future__ import annotations

import json
import os
import queue
import subprocess
import sys
import threading
import time
from dataclasses import dataclass, field
from typing import IO, Any, Callable, Dict, Iterable, Iterator, List, Optional, Set, Sized, Tuple, Union

from ._errors import ArgumentError
from ._jobs import Job, Report, run_job

__all__ = ["Summary", "batch", "run_job"]

PathLike = Union[str, "os.PathLike[str]"]

# Failures kept in a summary; all of them are in the reports.
_KEPT = 100
# A worker is replaced after so many jobs, so that no leak of anybody's grows for days; starting one takes some tenths of a second.
_JOBS_A_WORKER = 2_000


@dataclass
class Summary:
    """How a batch ended."""

    done: int = 0
    """Jobs done in this run."""
    failed: int = 0
    """Jobs that failed in this run."""
    skipped: int = 0
    """Jobs of which a report was there before."""
    seconds: float = 0.0
    """How long the run took."""
    failures: List[Report] = field(default_factory=list)
    """The reports of the first failures (at most a hundred)."""
    reports: Optional[List[Report]] = None
    """All reports, in the order in which jobs ended; only where they are not written to a file."""

    def add(self, report: Report) -> None:
        """Counts a report."""
        if report["status"] == "done":
            self.done += 1
        else:
            self.failed += 1
            if len(self.failures) < _KEPT:
                self.failures.append(report)
        if self.reports is not None:
            self.reports.append(report)


def batch(
    jobs: Union[PathLike, Iterable[Job]],
    out: Optional[PathLike] = None,
    *,
    workers: Optional[int] = None,
    folder: Optional[PathLike] = None,
    resume: bool = True,
    retry_failed: bool = False,
    attempts: int = 2,
    progress: Any = None,
) -> Summary:
    """Runs jobs in worker processes, and reports each once.

    >>> import trisect
    >>> trisect.batch([{"verb": "union", "inputs": ["no-such-file.stl"], "output": "x.ply"}], workers=1).failed
    1

    Parameters
    ----------
    jobs : path or iterable of dict
        A file of JSON Lines, or the jobs themselves, each with ``verb``, ``inputs``, ``output`` and perhaps ``options`` and ``id``.
        A job without an ``id`` is called by its number, counted from 1. An iterable is taken from only as workers become free.
    out : path
        The file of reports, one line of JSON for each job in the order in which they end. Jobs that it has a report of are not
        run again (``resume``), or only those that failed are (``retry_failed``; the later report counts).
    workers : int
        Worker processes; by default one for each core, each on one thread unless the job says otherwise.
    folder : path
        Where relative paths in jobs start, or an address that ``fsspec`` knows; by default the folder of the jobs' file, or the
        current one.
    attempts : int
        How often a job is tried whose worker dies.
    progress : callable, tqdm bar or True
        Called after every job with the jobs that ended, how many there are (``None`` if that is not known), how many failed, and
        the seconds that are probably left (``None`` if not known).
    """
    if attempts < 1:
        raise ArgumentError("a job is tried once at least")
    if workers is not None and workers < 1:
        raise ArgumentError(f"workers are counted from 1, not {workers!r}")
    start = time.perf_counter()
    total, numbered = numbered_jobs(jobs)
    base = os.fspath(folder) if folder is not None else _folder_of(jobs)
    reported = Reports(out, resume, retry_failed)
    summary = Summary(reports=[] if out is None else None)
    tell = _progress(progress, total, start)
    waiting = _waiting(numbered, reported, summary)
    pool = _Pool(waiting, base, workers if workers is not None else os.cpu_count() or 1, attempts)
    try:
        for report in pool.reports():
            reported.write(report)
            summary.add(report)
            tell(summary)
    finally:
        pool.close()
        reported.close()
    summary.seconds = time.perf_counter() - start
    return summary


def _folder_of(jobs: Any) -> str:
    return os.path.dirname(os.path.abspath(os.fspath(jobs))) if isinstance(jobs, (str, os.PathLike)) else "."


def numbered_jobs(jobs: Union[PathLike, Iterable[Job]]) -> Tuple[Optional[int], Iterator[Job]]:
    """How many jobs there are, if that is known; and they, each with an ``id``."""
    if isinstance(jobs, (str, os.PathLike)):
        path = os.fspath(jobs)
        with open(path, "rb") as file:
            total = sum(1 for line in file if line.strip())
        return total, _read(path)
    known = len(jobs) if isinstance(jobs, Sized) else None
    return known, _named(jobs)


def _read(path: str) -> Iterator[Job]:
    """The jobs of a file; a line that is none is a job that fails, with what is wrong."""
    number = 0
    with open(path, "rb") as file:
        for line in file:
            if not line.strip():
                continue
            number += 1
            try:
                job = json.loads(line)
                if not isinstance(job, dict):
                    raise ValueError("no object")
            except (ValueError, RecursionError) as error:
                job = {"id": None, "verb": None, "broken": f"line {number} of {path} is no job: {error}"}
            yield _with_id(job, number)


def _named(jobs: Iterable[Job]) -> Iterator[Job]:
    for number, job in enumerate(jobs, 1):
        yield _with_id(dict(job), number)


def _with_id(job: Dict[str, Any], number: int) -> Job:
    if job.get("id") is None:
        job["id"] = str(number)
    job["id"] = str(job["id"])
    return job


def _waiting(jobs: Iterator[Job], reported: "Reports", summary: Summary) -> Iterator[Job]:
    """The jobs that have no report yet."""
    for job in jobs:
        if reported.has(job["id"]):
            summary.skipped += 1
        else:
            yield job


class Reports:
    """The file of reports: which jobs it has, and room for more. A line that was cut off when a run was stopped is taken away."""

    def __init__(self, path: Optional[PathLike], resume: bool, retry_failed: bool) -> None:
        self._there: Set[str] = set()
        self._file: Optional[IO[bytes]] = None
        if path is None:
            return
        where = os.fspath(path)
        os.makedirs(os.path.dirname(where) or ".", exist_ok=True)
        if resume and os.path.exists(where):
            whole = self._read(where, retry_failed)
            self._file = open(where, "r+b")
            self._file.truncate(whole)
            self._file.seek(whole)
        else:
            self._file = open(where, "wb")

    def _read(self, path: str, retry_failed: bool) -> int:
        """Where the whole lines end."""
        whole = 0
        with open(path, "rb") as file:
            for line in file:
                if not line.endswith(b"\n"):
                    break
                whole += len(line)
                try:
                    report = json.loads(line)
                    name, is_done = report["id"], report["status"] == "done"
                except (ValueError, TypeError, KeyError) as error:
                    raise ArgumentError(f"{path} is no file of reports: {error!r}") from None
                if retry_failed and not is_done:
                    self._there.discard(name)
                else:
                    self._there.add(name)
        return whole

    def has(self, name: str) -> bool:
        """Whether there is a report of a job."""
        return name in self._there

    def write(self, report: Report) -> None:
        """Adds a report, whole."""
        if self._file is not None:
            self._file.write(json.dumps(report).encode() + b"\n")
            self._file.flush()

    def close(self) -> None:
        """Ends the file."""
        if self._file is not None:
            self._file.close()


def _progress(given: Any, total: Optional[int], start: float) -> Callable[[Summary], None]:
    if given is None or given is False:
        return lambda summary: None
    if given is True:
        from tqdm.auto import tqdm

        given = tqdm(total=total, unit="job")
    if hasattr(given, "update") and hasattr(given, "total"):
        bar = given

        def on_bar(summary: Summary) -> None:
            bar.total = total
            bar.n = summary.done + summary.failed + summary.skipped
            bar.set_postfix(failed=summary.failed, refresh=False)
            bar.refresh()

        return on_bar

    def call(summary: Summary) -> None:
        ended = summary.done + summary.failed
        left = None
        if total is not None and ended:
            left = (time.perf_counter() - start) / ended * (total - ended - summary.skipped)
        given(ended + summary.skipped, total, summary.failed, left)

    return call


class _Pool:
    """Worker processes, each with a thread that hands it one job after the other."""

    def __init__(self, jobs: Iterator[Job], folder: str, workers: int, attempts: int) -> None:
        self._jobs, self._folder, self._attempts = jobs, folder, attempts
        self._taking = threading.Lock()
        self._stopped = False
        self._ended: "queue.Queue[Optional[Union[Report, BaseException]]]" = queue.Queue(maxsize=4 * workers)
        self._processes: Dict[int, "subprocess.Popen[bytes]"] = {}
        self._threads = [threading.Thread(target=self._serve, args=(i,), daemon=True) for i in range(workers)]

    def reports(self) -> Iterator[Report]:
        """Reports as jobs end."""
        for thread in self._threads:
            thread.start()
        running = len(self._threads)
        while running:
            ended = self._ended.get()
            if ended is None:
                running -= 1
            elif isinstance(ended, BaseException):
                raise ended
            else:
                yield ended

    def close(self) -> None:
        """Ends all workers, whatever they do."""
        self._stopped = True
        for process in list(self._processes.values()):
            process.kill()

    def _next(self) -> Optional[Job]:
        with self._taking:
            return None if self._stopped else next(self._jobs, None)

    def _serve(self, place: int) -> None:
        try:
            served = 0
            while True:
                job = self._next()
                if job is None:
                    break
                if served == _JOBS_A_WORKER:
                    self._end(place)
                    served = 0
                served += 1
                self._put(self._run(place, job))
        except BaseException as error:
            self._put(error)
        finally:
            self._end(place)
            self._put(None)

    def _put(self, ended: Any) -> None:
        while not self._stopped:
            try:
                return self._ended.put(ended, timeout=0.5)
            except queue.Full:
                continue

    def _run(self, place: int, job: Job) -> Report:
        start = time.perf_counter()
        if "broken" in job:
            return failure(job, "usage", str(job["broken"]), start)
        try:
            line = json.dumps(job).encode() + b"\n"
        except (TypeError, ValueError) as error:
            return failure(job, "usage", f"the job is no JSON: {error}", start)
        code: Any = None
        for _ in range(self._attempts):
            process = self._process(place)
            try:
                assert process.stdin is not None and process.stdout is not None
                process.stdin.write(line)
                process.stdin.flush()
                answer = process.stdout.readline()
            except OSError:
                answer = b""
            if answer.endswith(b"\n"):
                report: Report = json.loads(answer)
                return report
            code = process.wait()
            self._end(place)
            if self._stopped:
                break
        return failure(job, "lost", lost(code, self._attempts), start)

    def _process(self, place: int) -> "subprocess.Popen[bytes]":
        process = self._processes.get(place)
        if process is None or process.poll() is not None:
            environment = dict(os.environ, PYTHONPATH=os.pathsep.join(path for path in sys.path if path))
            process = subprocess.Popen(
                [sys.executable, "-m", "trisect._worker", self._folder],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                env=environment,
                # Ctrl-C is for us: we end the workers.
                start_new_session=True,
            )
            self._processes[place] = process
        return process

    def _end(self, place: int) -> None:
        process = self._processes.pop(place, None)
        if process is None:
            return
        for pipe in (process.stdin, process.stdout):
            if pipe is not None:
                try:
                    pipe.close()
                except OSError:
                    pass
        try:
            process.wait(timeout=5)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()


def failure(job: Job, kind: str, message: str, start: float) -> Report:
    """The report of a job that did not come to run."""
    seconds = {"total": round(time.perf_counter() - start, 6)}
    return {"id": job["id"], "status": "failed", "error": {"kind": kind, "message": message}, "seconds": seconds}


def lost(code: Optional[int], attempts: int) -> str:
    """What is said of a worker that died."""
    how = f"signal {-code}" if code is not None and code < 0 else f"exit code {code}"
    return (
        f"the worker ended while it ran this job ({how}), {attempts} times over; signals 6 and 9 are usually memory: set the option "
        "memory, or use fewer workers"
    )
