"""One job: what is read, what is done, what is written, and the report of it. The same on one machine and on many.

A job is an object as a line of a jobs file has it; ``docs/scale.md`` describes it.
"""

from __future__ import annotations

import os
import time
import traceback
import warnings
from typing import Any, Callable, Dict, Mapping, Optional, Tuple, Union

from ._errors import ArgumentError, Error, FileError, FormatError, LimitError
from ._files import ending, local_output
from ._inputs import MENDING, Inputs
from ._verbs import VERBS, Verb, write

Job = Mapping[str, Any]
Report = Dict[str, Any]

_KEYS = ("id", "verb", "inputs", "output", "options")
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
_LIMITS = ("timeout", "memory", "threads")


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
    name = job.get("verb")
    verb = VERBS.get(str(name))
    if verb is None:
        raise ArgumentError(f"unknown verb {name!r}: known are {', '.join(VERBS)}")
    output = job.get("output")
    if output is not None and not isinstance(output, str):
        raise ArgumentError(f"the output of a job is a path, not {output!r}")
    own, mending, given = _options(job, str(name), verb)
    limited = _limited(given)
    made = verb.act(Inputs(job.get("inputs"), mending, folder, limited), own, limited)
    report: Report = {"verb": name, "status": "done", **made.report}
    if report.get("usable") is False:
        # As the program has it: the files that cannot be used say why.
        report["status"] = "failed"
    if output is not None:
        if not made.files and made.drawing is None:
            raise ArgumentError(f"{name} writes no file: leave the output out")
        report["outputs"] = write(made, output, lambda file: local_output(file, folder))
    return report


def _options(job: Job, name: str, verb: Verb) -> Tuple[Dict[str, Any], Dict[str, Any], Dict[str, Any]]:
    """The options of a job: those of its verb, those for all inputs, and settings."""
    said = job.get("options")
    if said is not None and not isinstance(said, Mapping):
        raise ArgumentError("the options of a job are an object")
    own: Dict[str, Any] = {}
    mending: Dict[str, Any] = {}
    given: Dict[str, Any] = {}
    for key, value in (said or {}).items():
        if value is None or value is False:
            # As on a command line that does not have it.
            continue
        if key in verb.own:
            own[key] = value
        elif key in MENDING:
            mending[key] = value
        elif key in _LIMITS or key in verb.settings:
            given[_SETTINGS[key]] = value
        else:
            known = ", ".join([*_LIMITS, *verb.settings, *MENDING, *verb.own])
            raise ArgumentError(f"unknown option {key!r} of {name}: known are {known}")
    if given.get("cut_faces") == "keep":
        given["cut_faces"] = "tool"
    if "embed" in verb.settings:
        # What the program does by itself.
        given.setdefault("embed", "near-cut")
    if given.get("embed") is True and ending(str(job.get("output"))) in ("stl", "glb", "gltf"):
        # What the file can hold, as the program does.
        given["embed"] = "single"
    return own, mending, given


def _limited(given: Dict[str, Any]) -> Callable[[], Dict[str, Any]]:
    """The settings of each call of a job: its deadline is what is left of the job's."""
    deadline = given.get("deadline")
    # (What is no number of seconds is refused where it is read.)
    if deadline is None or not float(deadline) >= 0:
        return lambda: dict(given)
    end = time.monotonic() + float(deadline)
    return lambda: {**given, "deadline": max(0.0, end - time.monotonic())}
