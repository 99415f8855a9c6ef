"""Settings that calls have in common."""

from __future__ import annotations

from typing import Any, Callable, Dict, Mapping, Optional, Sequence, Tuple, TypedDict, Union

from ._errors import ArgumentError

Progress = Callable[[str, float], Any]


class Limits(TypedDict, total=False):
    """Limits of a call.

    ``deadline``
        seconds after which it raises :class:`~trisect.DeadlineError`.
    ``memory``
        bytes that its own tables may take, or a text such as ``"4G"``; else :class:`~trisect.MemoryLimitError`.
    ``threads``
        how many threads it runs on. Results are the same bits for any number.
    ``progress``
        called with the stage's name and the fraction done of the whole (0 to 1), in the thread of the caller, a few times a
        second; or a ``tqdm`` bar, or ``True`` for one of its own. What it raises ends the call.
    """

    deadline: Optional[float]
    memory: Union[int, str, None]
    threads: Optional[int]
    progress: Any


class Settings(Limits, total=False):
    """Settings of an operation, beside its limits.

    ``rule``, ``rules``
        what is inside an operand that crosses itself: "positive" (overlapping bodies are one), "nonzero" or "even-odd"; for all
        operands, or one each.
    ``contact``
        what becomes of operands of a union that touch: "fuse" or "separate".
    ``snap``
        a distance, in units of the coordinates: vertices, edges and faces no further apart are made the same before.
    ``embed``
        what becomes of crossings that rounding makes: "never", "where-needed", "near-cut", "double" or "single" (the numbers that
        coordinates are to be); ``True`` is "double".
    ``assume_clean``
        operands are taken not to cross themselves.
    ``remove_vertices``
        whether vertices that nobody needs are left out where the operation cuts (default).
    ``cut_faces``
        what faces show that a tool has cut: "tool", "body", or the name of a group of their own.
    ``cut_uv``
        texture coordinates of cut faces: ("planar", units to a unit of length) or ("box", ...).
    """

    rule: str
    rules: Sequence[str]
    contact: str
    snap: Optional[float]
    embed: Union[bool, str]
    assume_clean: bool
    remove_vertices: bool
    cut_faces: str
    cut_uv: Tuple[str, float]


_LIMITS = frozenset(Limits.__annotations__)
_SETTINGS = frozenset(Settings.__annotations__) | _LIMITS
_UNITS = {"": 1, "K": 1 << 10, "M": 1 << 20, "G": 1 << 30, "T": 1 << 40}


def settings(given: Mapping[str, Any], *, limits_only: bool = False) -> Optional[Dict[str, Any]]:
    """What the compiled half takes; ``None`` for none."""
    if not given:
        return None
    known = _LIMITS if limits_only else _SETTINGS
    for key in given:
        if key not in known:
            raise TypeError(f"unexpected argument '{key}': known are {', '.join(sorted(known))}")
    made = {key: value for key, value in given.items() if value is not None}
    if "memory" in made:
        made["memory"] = byte_count(made["memory"])
    for key in ("deadline", "snap"):
        if key in made:
            made[key] = float(made[key])
    if "threads" in made:
        made["threads"] = _threads(made["threads"])
    if made.get("progress") is False:
        del made["progress"]
    if "progress" in made:
        made["progress"] = progress(made["progress"])
    return made or None


def _threads(given: Any) -> int:
    if isinstance(given, bool) or int(given) != given or given < 1:
        raise ArgumentError(f"threads are counted from 1, not {given!r}")
    return int(given)


def byte_count(given: Union[int, str, float]) -> int:
    """Bytes of a number, or of a text such as "500M" or "4G" (powers of 1024)."""
    if not isinstance(given, str):
        number = float(given)
        if not (0 < number < 2**63):
            raise ArgumentError(f"a ceiling on memory is a positive number of bytes, not {given!r}")
        return int(given)
    text = given.strip().upper()
    for ending in ("IB", "B"):
        if text.endswith(ending):
            text = text[: -len(ending)]
            break
    unit = text[-1:] if text[-1:] in _UNITS else ""
    try:
        return byte_count(float(text[: len(text) - len(unit)]) * _UNITS[unit])
    except ValueError:
        raise ArgumentError(f"a ceiling on memory is a number of bytes such as '500M' or '4G', not {given!r}") from None


def progress(given: Any) -> Progress:
    """A callback of what was given as ``progress``."""
    if given is True:
        from tqdm.auto import tqdm

        given = tqdm()
    if hasattr(given, "update") and hasattr(given, "total"):
        return _on_bar(given)
    if not callable(given):
        raise TypeError(f"progress is a callable, a tqdm bar or True, not {given!r}")
    call: Progress = given
    return call


def _on_bar(bar: Any) -> Progress:
    """Moves a bar of tqdm to a hundred."""
    bar.total = 100

    def report(stage: str, fraction: float) -> None:
        if hasattr(bar, "set_description"):
            bar.set_description(stage, refresh=False)
        bar.n = round(100 * fraction)
        bar.refresh()

    return report
