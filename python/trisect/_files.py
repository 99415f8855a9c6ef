"""Files of jobs: local ones, and those that ``fsspec`` knows."""

from __future__ import annotations

import contextlib
import os
import tempfile
from typing import Any, Iterator


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


def with_end(path: str, end: str) -> str:
    """The path with an end of its file's name, before what tells the format."""
    if not end:
        return path
    base = len(path) - len(os.path.basename(path))
    stem, kind = os.path.splitext(path[base:])
    return f"{path[:base]}{stem}{end}{kind}"


def ending(path: str) -> str:
    """What tells the format of a file, in small letters."""
    return os.path.splitext(path)[1].lower().lstrip(".")


def write_text(path: str, text: str) -> None:
    """Writes a local file whole or not at all."""
    handle, beside = tempfile.mkstemp(dir=os.path.dirname(path) or ".", prefix=".trisect-")
    try:
        with os.fdopen(handle, "w", encoding="utf-8", newline="") as file:
            file.write(text)
        # (As any new file has it; a temporary one is nobody else's.)
        mask = os.umask(0)
        os.umask(mask)
        os.chmod(beside, 0o666 & ~mask)
        os.replace(beside, path)
    except BaseException:
        with contextlib.suppress(OSError):
            os.unlink(beside)
        raise
