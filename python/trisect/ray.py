"""Many machines: jobs as tasks of Ray, and one union too large for one machine.

Needs ``trisect[ray]``. Start or join a cluster with ``ray.init`` before; without, one of this machine's processes is started.
Every machine needs trisect installed. ``docs/scale.md`` says when to use what, and what it costs.
"""

from __future__ import annotations

import os
import time
from dataclasses import dataclass, field
from typing import Any, Callable, Dict, Iterable, Iterator, List, Optional, Sequence, Tuple, Union

import numpy as np
import ray
import ray.exceptions

from . import _operations
from ._errors import ArgumentError
from ._jobs import Job, Report, run_on_one_thread
from ._surfaces import Solid, SolidLike, _solid_of_parts
from .batch import Reports, Summary, _folder_of, _progress, _waiting, failure, numbered_jobs

PathLike = Union[str, "os.PathLike[str]"]

# Tasks handed to Ray for each processor before one has to end: enough that none waits for the driver, few enough that jobs are
# read as they are needed.
_AHEAD = 4


def _started() -> None:
    if not ray.is_initialized():
        ray.init(log_to_driver=False)


def batch(
    jobs: Union[PathLike, Iterable[Job]],
    out: Optional[PathLike] = None,
    *,
    folder: Optional[PathLike] = None,
    resume: bool = True,
    retry_failed: bool = False,
    attempts: int = 4,
    in_flight: Optional[int] = None,
    task: Optional[Dict[str, Any]] = None,
    progress: Any = None,
) -> Summary:
    """Runs jobs as tasks of Ray, and reports each once; the same jobs, reports and files as :func:`trisect.batch`.

    A task whose worker or machine is lost runs again, ``attempts`` times in all. Paths in jobs must mean the same on all
    machines: a shared folder, or anything that ``fsspec`` knows (``s3://bucket/a.ply``).

    Parameters
    ----------
    in_flight : int
        How many jobs Ray has at a time; by default four for each processor of the cluster. More are not read from ``jobs``.
    task : dict
        Options of the tasks, as ``ray.remote`` takes them, such as ``{"memory": 4e9}``.
    """
    if attempts < 1:
        raise ArgumentError("a job is tried once at least")
    if in_flight is not None and in_flight < 1:
        raise ArgumentError(f"jobs in flight are counted from 1, not {in_flight!r}")
    _started()
    start = time.perf_counter()
    total, numbered = numbered_jobs(jobs)
    base = os.fspath(folder) if folder is not None else _folder_of(jobs)
    if "://" not in base:
        base = os.path.abspath(base)
    reported = Reports(out, resume, retry_failed)
    summary = Summary(reports=[] if out is None else None)
    tell = _progress(progress, total, start)
    options: Dict[str, Any] = {"num_cpus": 1, "max_retries": attempts - 1, **(task or {})}
    # (A task has one processor, as Ray counts.)
    remote: Any = ray.remote(**options)(run_on_one_thread)
    cluster: Any = ray
    most = in_flight if in_flight is not None else _AHEAD * max(1, int(cluster.cluster_resources().get("CPU", 1)))
    try:
        for report in _reports(remote, _waiting(numbered, reported, summary), base, most):
            reported.write(report)
            summary.add(report)
            tell(summary)
    finally:
        reported.close()
    summary.seconds = time.perf_counter() - start
    return summary


def _reports(remote: Any, jobs: Iterator[Job], folder: str, most: int) -> Iterator[Report]:
    """Reports as tasks end, with no more than so many tasks at a time."""
    running: Dict[Any, Tuple[Job, float]] = {}
    more = True
    while more or running:
        while more and len(running) < most:
            job = next(jobs, None)
            if job is None:
                more = False
            elif "broken" in job:
                yield failure(job, "usage", str(job["broken"]), time.perf_counter())
            else:
                running[remote.remote(job, folder)] = (job, time.perf_counter())
        if not running:
            continue
        [done], _ = ray.wait(list(running), num_returns=1)
        job, start = running.pop(done)
        try:
            yield ray.get(done)
        except ray.exceptions.RayError as error:
            yield failure(job, "lost", f"the task was lost: {str(error).splitlines()[0]}", start)


# Union of many parts


@dataclass
class Tiled:
    """What a tiled operation did."""

    solid: Solid
    """The result. It has no origins: parts were united in tasks of their own."""
    tiles: int
    """Tasks at the leaves."""
    merges: int
    """Tasks that merged two results."""
    moved: int
    """Bytes of vertices and faces that tasks were given."""
    seconds: float
    """How long it took."""
    processor: float = 0.0
    """Seconds of processors that its tasks took."""
    path: float = 0.0
    """Those of them that had to be one after the other: with any number of workers the tasks take as long."""
    steps: Dict[str, float] = field(default_factory=dict)
    """Seconds of it: until the tasks were given out (here), until they were done, and until the result was here."""


@dataclass
class _Made:
    """What a task made, and what it took, all tasks before it included."""

    solid: Solid
    moved: int
    processor: float
    path: float


def _made(start: float, before: Sequence[_Made], given: Sequence[Solid], solid: Solid) -> _Made:
    """A task's result: it began at a time of the process, after others, and was given solids."""
    moved = sum(solid.vertices.nbytes + solid.faces.nbytes for solid in given)
    spent = time.process_time() - start
    moved += sum(made.moved for made in before)
    path = spent + max((made.path for made in before), default=0.0)
    return _Made(solid, moved, spent + sum(made.processor for made in before), path)


@dataclass
class _Piece:
    """A part of a result."""

    reference: Any
    """Where the object store has what was made."""
    place: Tuple[int, ...]
    """Its place among the tiles."""


class _Pack:
    """Solids on their way, all arrays of those that have nothing but vertices and faces in two. (Of a hundred thousand small solids
    most of the time would go into pickling each by itself.)"""

    def __init__(self, solids: Sequence[Solid]) -> None:
        plain = [solid for solid in solids if solid._core.is_plain()]
        self._others = [solid for solid in solids if not solid._core.is_plain()]
        self._vertices = np.concatenate([solid.vertices for solid in plain]) if plain else np.zeros((0, 3))
        self._faces = np.concatenate([solid.faces for solid in plain]) if plain else np.zeros((0, 3), dtype=np.uint32)
        self._counts = np.array([solid._core.counts() for solid in plain], dtype=np.int64).reshape(-1, 2)
        self._proofs = [solid._core.hash() if solid._core.is_proven_clean() else None for solid in plain]

    def solids(self) -> List[Solid]:
        """They again."""
        solids, vertex, face = list(self._others), 0, 0
        for (vertices, faces), proof in zip(self._counts.tolist(), self._proofs):
            arrays = self._vertices[vertex : vertex + vertices], self._faces[face : face + faces]
            solids.append(_solid_of_parts(*arrays, _NOTHING_ELSE, proof))
            vertex, face = vertex + vertices, face + faces
        return solids


# Neither attributes nor groups nor polygons, as `Core.parts` has them.
_NOTHING_ELSE = Solid.empty()._core.parts()


def _unite(settings: Dict[str, Any], pack: _Pack) -> _Made:
    """Parts united."""
    start = time.process_time()
    solids = pack.solids()
    return _made(start, (), solids, _operations.union(solids, **settings))


def _merge(settings: Dict[str, Any], *pieces: _Made) -> _Made:
    """Results united."""
    start = time.process_time()
    solids = [made.solid for made in pieces]
    return _made(start, pieces, solids, _operations.union(solids, **settings))


def union(
    parts: Sequence[SolidLike],
    *,
    tiles: Optional[Sequence[int]] = None,
    threads: int = 1,
    task: Optional[Dict[str, Any]] = None,
    **settings: Any,
) -> Tiled:
    """What is in any of many parts, united tile by tile.

    Space is cut into a grid of ``tiles``; the parts whose middle is in a tile are united by a task, and neighbouring results are
    merged in a tree, along one axis after the other. The result is closed, and has the volume of the union on one machine but for the
    rounding of vertices in between.

    Parameters
    ----------
    parts : sequence of solids, or of anything one can be made of
        All are made solids of here; those go through Ray's object store once.
    tiles : three int
        How many along x, y and z; by default so many that each has some 1,500 parts; more where there are more workers than tiles.
    threads : int
        Of each task; also what it asks Ray for.
    """
    _started()
    start = time.perf_counter()
    solids = [part if isinstance(part, Solid) else Solid(part) for part in parts]
    if not solids:
        raise ArgumentError("a union needs at least one part")
    grid = tuple(tiles) if tiles is not None else _grid(len(solids))
    if len(grid) != 3 or min(grid) < 1:
        raise ArgumentError(f"tiles are three numbers, not {tiles!r}")
    given = {**settings, "threads": threads}
    options: Dict[str, Any] = {"num_cpus": threads, **(task or {})}
    unite: Any = ray.remote(**options)(_unite)
    leaves = [
        _Piece(unite.remote(given, ray.put(_Pack(members))), place) for place, members in sorted(_by_tile(solids, grid).items())
    ]
    return _finish(leaves, _merge, given, options, start)


def _finish(leaves: List[_Piece], how: Callable[..., Any], given: Any, options: Any, start: float) -> Tiled:
    merge: Any = ray.remote(**options)(how)
    row, merges, given_out = leaves, 0, time.perf_counter()
    while len(row) > 1:
        row, count = _halved(row, merge, given)
        merges += count
    ray.wait([row[0].reference])
    done = time.perf_counter()
    made: _Made = ray.get(row[0].reference)
    here = time.perf_counter()
    steps = {"given out": given_out - start, "done": done - given_out, "here": here - done}
    return Tiled(made.solid, len(leaves), merges, made.moved, here - start, made.processor, made.path, steps)


def _halved(row: List[_Piece], merge: Any, given: Any) -> Tuple[List[_Piece], int]:
    """Neighbours merged in pairs along the axis with the most places."""
    count = [len({piece.place[axis] for piece in row}) for axis in range(3)]
    axis = int(np.argmax(count))
    cells: Dict[Tuple[int, ...], List[_Piece]] = {}
    for piece in row:
        place = tuple(number // 2 if k == axis else number for k, number in enumerate(piece.place))
        cells.setdefault(place, []).append(piece)
    merged, made = [], 0
    for place, pieces in cells.items():
        if len(pieces) == 1:
            merged.append(_Piece(pieces[0].reference, place))
        else:
            merged.append(_Piece(merge.remote(given, *[piece.reference for piece in pieces]), place))
            made += 1
    return merged, made


# Parts a task takes. Of 10,000 balls of 80 triangles on two workers 8 tiles took 2.7 s, 27 2.8 s, 64 3.3 s and 216 4.3 s (the last 2.3 times the bytes of
# the first); of fewer tiles there are not enough for many workers.
_PARTS_A_TILE = 1500


# And no fewer than these where there are more workers than tiles of that size. (A task costs some milliseconds.)
_LEAST_A_TILE = 50


def _grid(count: int) -> Tuple[int, int, int]:
    """Tiles along each axis: of the usual size, or twice as many as there are workers, if there are parts for that."""
    cluster: Any = ray
    workers = int(cluster.cluster_resources().get("CPU", 1))
    tiles = max(count / _PARTS_A_TILE, min(2 * workers, count / _LEAST_A_TILE))
    side = max(1, round(tiles ** (1 / 3)))
    return (side, side, side)


def _by_tile(solids: Sequence[Solid], grid: Tuple[int, ...]) -> Dict[Tuple[int, ...], List[Solid]]:
    """The solids whose middle is in each tile."""
    nowhere = [[np.nan] * 3] * 2
    middles = np.array([solid._core.bounds() or nowhere for solid in solids]).mean(axis=1)
    full = ~np.isnan(middles).any(axis=1)
    low = middles[full].min(axis=0) if full.any() else np.zeros(3)
    size = (middles[full].max(axis=0) - low) if full.any() else np.zeros(3)
    cell = np.where(size > 0, size / np.array(grid), 1.0)
    places = np.minimum(np.nan_to_num((middles - low) / cell), np.array(grid) - 1).astype(int)
    members: Dict[Tuple[int, ...], List[Solid]] = {}
    for solid, place in zip(solids, places.tolist()):
        members.setdefault(tuple(place), []).append(solid)
    return members


# Two large operands


def _slab(operation: str, settings: Dict[str, Any], a: Solid, b: Solid) -> _Made:
    """The operation on two slabs."""
    start = time.process_time()
    return _made(start, (), (a, b), _operations.run(operation, (a, b), settings))


def combine_large(
    operation: str,
    a: SolidLike,
    b: SolidLike,
    *,
    slabs: int = 4,
    threads: int = 1,
    task: Optional[Dict[str, Any]] = None,
    **settings: Any,
) -> Tiled:
    """One operation ("union", "intersection" or "difference") on two large operands.

    Both are cut by the same planes across the longest side of their common box, at coordinates that ``f32`` holds; each slab is a task,
    and neighbours are merged in a tree. Halves of a cut have the same vertices along it, bit for bit, so slabs fit together
    again and the walls between them vanish.
    """
    _started()
    start = time.perf_counter()
    if operation not in ("union", "intersection", "difference") or slabs < 1:
        raise ArgumentError(f"no {operation!r} in {slabs} slabs: it is a union, intersection or difference in one or more")
    operands = [part if isinstance(part, Solid) else Solid(part) for part in (a, b)]
    given = {**settings, "threads": threads}
    options: Dict[str, Any] = {"num_cpus": threads, **(task or {})}
    work: Any = ray.remote(**options)(_slab)
    axis, marks = _planes(operands, slabs)
    # They are looked through here, before they are cut, on all threads: slabs of what is clean are known to be, and looking through
    # those takes twice as long, since the walls' long triangles have many neighbours. What crosses itself is resolved here.
    rules = settings.get("rules") or [settings.get("rule", "positive")] * 2
    clean = {"assume_clean": bool(settings.get("assume_clean"))}
    if not clean["assume_clean"]:
        limits = {key: settings[key] for key in ("deadline", "memory") if key in settings}
        for operand in operands:
            operand.self_crossings(**limits)
    cut = [_slabs(operand, axis, marks, {**clean, "rule": rule}) for operand, rule in zip(operands, rules)]
    leaves = [
        _Piece(work.remote(operation, given, first, second), (place, 0, 0))
        for place, (first, second) in enumerate(zip(*cut))
    ]
    return _finish(leaves, _merge, given, options, start)


def _planes(operands: Sequence[Solid], slabs: int) -> Tuple[int, List[float]]:
    """The axis, and where it is cut: so that slabs have about as many vertices."""
    boxes = np.array([operand.bounds for operand in operands if operand])
    if not len(boxes):
        return 0, []
    axis = int(np.argmax(boxes[:, 1].max(axis=0) - boxes[:, 0].min(axis=0)))
    places = np.concatenate([operand.vertices[:, axis] for operand in operands])
    marks = np.quantile(places, np.arange(1, slabs) / slabs)
    # Short numbers, so that few vertices lie nearly on a plane.
    return axis, sorted({float(np.float32(mark)) for mark in marks})


def _slabs(solid: Solid, axis: int, marks: Sequence[float], given: Dict[str, Any]) -> List[Solid]:
    """The solid between planes, in their order: halved, and the halves again."""
    if not marks:
        return [solid]
    middle = len(marks) // 2
    above, below = _operations.cut(solid, ("xyz"[axis], marks[middle]), **given)
    return [*_slabs(below, axis, marks[:middle], given), *_slabs(above, axis, marks[middle + 1 :], given)]
