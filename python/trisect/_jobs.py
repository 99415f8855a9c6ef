"""One job: what is read, what is done, what is written, and the report of it. The same on one machine and on many.

A job is an object as a line of a jobs file has it; ``docs/scale.md`` describes it.
"""

from __future__ import annotations

import contextlib
import os
import tempfile
import time
import traceback
import warnings
from typing import Any, Callable, Dict, Iterator, List, Mapping, Optional, Sequence, Union

import numpy as np

from . import _operations
from ._errors import ArgumentError, Error, FileError, FormatError, LimitError
from ._surfaces import Solid, _three

Job = Mapping[str, Any]
Report = Dict[str, Any]

_KEYS = ("id", "verb", "inputs", "output", "options")
# In the order in which they are done, whatever the order in the job, as the program does.
_PLACING = ("matrix", "rotate", "scale", "translate")
_MENDING = ("weld", "orient", "closed-parts", "fill-holes", "single-shells")
_SETTINGS = {
    "timeout": "deadline",
    "memory": "memory",
    "threads": "threads",
    "rule": "rule",
    "snap": "snap",
    "embed": "embed",
    "assume-clean": "assume_clean",
    "cut-material": "cut_faces",
}


def run_job(job: Job, folder: Union[str, "os.PathLike[str]", None] = None) -> Report:
    """Runs one job and reports it; failures are reported, not raised.

    >>> import trisect
    >>> trisect.run_job({"id": "a", "verb": "union", "inputs": ["no-such-file.stl"], "output": "x.ply"})["status"]
    'failed'

    Parameters
    ----------
    job : dict
        What a line of a jobs file holds: ``verb``, ``inputs``, ``output``, ``options``, ``id``.
    folder : path
        Where relative paths start, or an address that ``fsspec`` knows; the current folder by default.
    """
    start = time.perf_counter()
    report: Report = {"id": job.get("id")}
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            report.update(_done(job, os.fspath(folder or ".")))
            report["status"] = "done"
        except Exception as error:
            report["status"] = "failed"
            report["error"] = describe(error)
    if caught:
        report["warnings"] = [str(warning.message) for warning in caught]
    report["seconds"] = {"total": round(time.perf_counter() - start, 6)}
    return report


def run_on_one_thread(job: Job, folder: Optional[str] = None) -> Report:
    """The same on one thread, unless the job says otherwise."""
    options = job.get("options")
    if options is None or isinstance(options, Mapping):
        job = {**job, "options": {"threads": 1, **(options or {})}}
    return run_job(job, folder)


def describe(error: BaseException) -> Dict[str, Any]:
    """The ``error`` of a report; ``kind`` is that of the program's exit codes."""
    described: Dict[str, Any] = {"kind": _kind(error), "class": type(error).__name__, "message": str(error)}
    if not isinstance(error, (Error, OSError)):
        described["traceback"] = "".join(traceback.format_exception(type(error), error, error.__traceback__))
    if isinstance(error, Error) and error.operand is not None:
        described["operand"] = error.operand + 1
    return described


def _kind(error: BaseException) -> str:
    if isinstance(error, (LimitError, MemoryError)):
        return "limit"
    if isinstance(error, (FileError, FormatError, OSError)):
        return "unreadable"
    if isinstance(error, (ArgumentError, TypeError)):
        return "usage"
    if isinstance(error, Error):
        return "unusable"
    # What a number is made of that is none.
    return "usage" if isinstance(error, ValueError) else "internal"


def _done(job: Job, folder: str) -> Report:
    unknown = [key for key in job if key not in _KEYS]
    if unknown:
        raise ArgumentError(f"unknown keys in the job: {', '.join(map(str, unknown))}; known are {', '.join(_KEYS)}")
    verb = job.get("verb")
    act = _VERBS.get(str(verb))
    if act is None:
        raise ArgumentError(f"unknown verb {verb!r}: known are {', '.join(_VERBS)}")
    inputs = job.get("inputs")
    if not isinstance(inputs, Sequence) or isinstance(inputs, str) or not inputs:
        raise ArgumentError("a job has a list of inputs")
    said = job.get("options")
    if said is not None and not isinstance(said, Mapping):
        raise ArgumentError("the options of a job are an object")
    options = dict(said or {})
    own = {key: options.pop(key) for key in ("expr", "plane", "keep") if key in options}
    mending = {key: options.pop(key) for key in _MENDING if key in options}
    given = {}
    for key, value in options.items():
        if key not in _SETTINGS:
            raise ArgumentError(f"unknown option {key!r}: known are {', '.join([*_SETTINGS, *_MENDING, 'expr', 'plane', 'keep'])}")
        given[_SETTINGS[key]] = value
    if given.get("cut_faces") == "keep":
        given["cut_faces"] = "tool"
    if given.get("embed") is True and str(job.get("output")).lower().endswith((".stl", ".glb", ".gltf")):
        # What the file can hold, as the program does.
        given["embed"] = "single"
    limited = _limited(given)
    operands = [_operand(entry, mending, folder, place, limited()) for place, entry in enumerate(inputs)]
    result = act(operands, own, limited())
    return _written(result, job.get("output"), folder)


def _limited(given: Dict[str, Any]) -> Callable[[], Dict[str, Any]]:
    """The settings of each call of a job: its deadline is what is left of the job's."""
    deadline = given.get("deadline")
    # (What is no number of seconds is refused where it is read.)
    if deadline is None or not float(deadline) >= 0:
        return lambda: given
    end = time.monotonic() + float(deadline)
    return lambda: {**given, "deadline": max(0.0, end - time.monotonic())}


def _operand(entry: Any, mending: Mapping[str, Any], folder: str, place: int, given: Mapping[str, Any]) -> Solid:
    """The solid of an input: a path, or an object with ``file`` and what becomes of it."""
    if isinstance(entry, str):
        entry = {"file": entry}
    if not isinstance(entry, Mapping) or "file" not in entry:
        raise ArgumentError(f"input {place + 1} is a path or an object with a file, not {entry!r}")
    options = {**mending, **{key: value for key, value in entry.items() if key != "file"}}
    unknown = [key for key in options if key not in (*_PLACING, *_MENDING)]
    if unknown:
        raise ArgumentError(f"input {place + 1}: unknown keys {', '.join(unknown)}; known are {', '.join((*_PLACING, *_MENDING))}")
    gate = {key.replace("-", "_"): options[key] for key in _MENDING if key in options}
    limits = {key: value for key, value in given.items() if key in ("deadline", "memory", "threads")}
    try:
        with local_input(str(entry["file"]), folder) as path:
            solid = Solid.load(path, **gate, **limits)
    except Error as error:
        if error.operand is None:
            error.operand = error._data["operand"] = place
            error._message = f"operand {place + 1} ({entry['file']}): {error._message}"
        raise
    for key in _PLACING:
        if key in options:
            solid = _placed(solid, key, options[key])
    return solid


def _placed(solid: Solid, how: str, value: Any) -> Solid:
    if how == "translate":
        return solid.translated(value)
    if how == "scale":
        return solid.scaled(value)
    if how == "matrix":
        return solid.transformed(np.asarray(value, dtype=float).reshape(-1, 4))
    # Angles about the axes, x first, as `--rotate` has them; one alone is about z.
    angles = [0.0, 0.0, value] if np.isscalar(value) else value
    for axis, degrees in zip("xyz", _three(angles, "rotate")):
        solid = solid.rotated(axis, degrees)
    return solid


def _boolean(operation: str) -> Callable[..., Solid]:
    def act(operands: List[Solid], own: Mapping[str, Any], given: Mapping[str, Any]) -> Solid:
        return _operations.run(operation, (operands,), given)

    return act


def _combine(operands: List[Solid], own: Mapping[str, Any], given: Any) -> Solid:
    if "expr" not in own:
        raise ArgumentError("combine needs the option expr")
    combined: Solid = _operations.combine(str(own["expr"]), *operands, **given)
    return combined


def _single(operands: List[Solid]) -> Solid:
    if len(operands) != 1:
        raise ArgumentError(f"this verb has one input, not {len(operands)}")
    return operands[0]


def _resolve(operands: List[Solid], own: Mapping[str, Any], given: Any) -> Solid:
    return _operations.resolve(_single(operands), **given)


def _convert(operands: List[Solid], own: Mapping[str, Any], given: Any) -> Solid:
    return _single(operands)


def _cut(operands: List[Solid], own: Mapping[str, Any], given: Any) -> Solid:
    if "plane" not in own or own.get("keep") not in ("above", "below"):
        raise ArgumentError("cut needs the options plane and keep (above or below)")
    above, below = _operations.cut(_single(operands), own["plane"], **given)
    return above if own["keep"] == "above" else below


_VERBS: Dict[str, Callable[..., Solid]] = {
    "union": _boolean("union"),
    "intersection": _boolean("intersection"),
    "difference": _boolean("difference"),
    "xor": _boolean("xor"),
    "combine": _combine,
    "resolve": _resolve,
    "cut": _cut,
    "convert": _convert,
}


def _written(solid: Solid, output: Any, folder: str) -> Report:
    report: Report = {}
    if output is not None:
        with local_output(str(output), folder) as path:
            solid.save(path)
        report["output"] = str(output)
    vertices, faces = solid._core.counts()
    result: Dict[str, Any] = {"vertices": vertices, "triangles": faces, "volume": solid.volume, "empty": faces == 0}
    if solid.is_result:
        certificate = solid.certificate
        result["closed"], result["manifold"] = certificate.closed, certificate.manifold
        result["shells"] = certificate.components
    report["result"] = result
    return report


def _from(folder: str, path: str) -> str:
    """A path or an address; a relative one starts at the folder, which may be an address too."""
    return path if "://" in path or os.path.isabs(path) else os.path.join(folder, path)


@contextlib.contextmanager
def local_input(path: str, folder: str) -> Iterator[str]:
    """A local copy of a file anywhere that ``fsspec`` knows; a local file is itself."""
    path = _from(folder, path)
    if "://" not in path:
        yield path
        return
    import fsspec

    address, _, part = path.partition("#")
    with tempfile.TemporaryDirectory() as beside:
        copy = os.path.join(beside, os.path.basename(address))
        with fsspec.open(address, "rb") as source, open(copy, "wb") as target:
            _copy(source, target)
        yield f"{copy}#{part}" if part else copy


@contextlib.contextmanager
def local_output(path: str, folder: str) -> Iterator[str]:
    """A local file that goes anywhere that ``fsspec`` knows when it is written; a local path is itself, with its folder."""
    path = _from(folder, path)
    if "://" not in path:
        os.makedirs(os.path.dirname(path) or ".", exist_ok=True)
        yield path
        return
    import fsspec

    with tempfile.TemporaryDirectory() as beside:
        made = os.path.join(beside, os.path.basename(path))
        yield made
        base = path[: len(path) - len(os.path.basename(path))]
        # What a format has beside its file goes along.
        for name in sorted(os.listdir(beside), key=lambda name: name == os.path.basename(path)):
            with open(os.path.join(beside, name), "rb") as source, fsspec.open(base + name, "wb") as target:
                _copy(source, target)


def _copy(source: Any, target: Any) -> None:
    # A megabyte at a time: a few round trips, little memory.
    while True:
        block = source.read(1 << 20)
        if not block:
            return
        target.write(block)
