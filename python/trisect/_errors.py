"""Exceptions: a small tree, with the data of the diagnosis.

======================  ===================================================  ======================================
exception               when                                                 data
======================  ===================================================  ======================================
``ArgumentError``       an argument has no meaning                           also a ``ValueError``
``MeshError``           a mesh is not what an operation needs                also a ``ValueError``
``NotClosedError``      the surface is not closed                            ``diagnosis``, ``open_edges``
``InsideOutError``      faces point inwards                                  ``volume``
``IndexOutOfRangeError``  a face names a vertex that is not there            ``face``, ``index``; also an ``IndexError``
``NotFiniteError``      a coordinate is infinite or not a number             ``vertex``
``TooLargeError``       more than 32-bit indices can name
``FileError``           the system refuses to read or write a file           ``filename``, ``errno``; also an ``OSError``
``MissingFileError``    there is no such file                                also a ``FileNotFoundError``
``FormatError``         a file is not what its format says                   ``format``, ``place``; also a ``ValueError``
``FormulaError``        a formula that cannot be read                        ``line``, ``column``
``ModelError``          a model file says something without meaning          ``node``
``GeometryError``       a curve, patch, field or cage is at fault
``LimitError``          a limit stopped the call
``DeadlineError``       the deadline passed                                  also a ``TimeoutError``
``MemoryLimitError``    the ceiling on memory would have been passed         ``needed``, ``limit``; also a ``MemoryError``
``CancelledError``      the call was cancelled
``InternalError``       a fault of trisect
======================  ===================================================  ======================================

Where an operand of several is at fault, ``operand`` is its place among them, counted from 0.
"""

from __future__ import annotations

import errno
import json
from typing import Any, Dict, Optional, Type

import numpy as np

from ._records import Diagnosis, Fault, Vertices


class TrisectWarning(UserWarning):
    """What a file lost, or what was done to a mesh that may not be meant."""


class Error(Exception):
    """Everything that trisect raises by itself."""

    operand: Optional[int] = None
    """Place of the operand at fault, counted from 0; ``None`` if it is none's."""

    def __init__(self, message: str = "", data: Optional[Dict[str, Any]] = None) -> None:
        super().__init__(message)
        self._message = message
        self._data: Dict[str, Any] = dict(data or {})
        self.operand = self._data.get("operand")

    def __str__(self) -> str:
        return self._message

    def __reduce__(self) -> Any:
        return (type(self), (self._message, self._data))


class ArgumentError(Error, ValueError):
    """An argument has no meaning."""


class MeshError(Error, ValueError):
    """A mesh is not what an operation needs."""


class NotClosedError(MeshError):
    """The surface is not the closed boundary of a solid.

    >>> import trisect
    >>> try:
    ...     trisect.Solid([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    ... except trisect.NotClosedError as error:
    ...     print(error.diagnosis.open_edges.count, error.open_edges.tolist())
    3 [[0, 1], [0, 2], [1, 2]]
    """

    @property
    def diagnosis(self) -> Diagnosis:
        """All that is wrong with the mesh, with places."""
        return Diagnosis.of(self._data.get("diagnosis") or {})

    @property
    def open_edges(self) -> Vertices:
        """The first open edges (at most five): vertices of the mesh, an array of shape (k, 2). ``diagnosis`` has how many
        there are; :meth:`trisect.Mesh.open_edges` has all."""
        ends = [place.vertices[:2] for place in self.diagnosis.open_edges.places]
        return np.array(ends, dtype=np.int64).reshape(-1, 2)


class InsideOutError(MeshError):
    """The mesh is closed, but its faces point inwards; or some of its shells do."""

    @property
    def volume(self) -> Optional[float]:
        """The signed volume, negative; ``None`` where shells are at fault."""
        return self._data.get("volume")

    @property
    def shells(self) -> Optional[Fault]:
        """The shells at fault, if not the whole is."""
        shells = self._data.get("shells")
        return None if shells is None else Fault.of(shells)


class IndexOutOfRangeError(MeshError, IndexError):
    """A face names a vertex that is not there."""

    @property
    def face(self) -> int:
        """The face."""
        return int(self._data["face"])

    @property
    def index(self) -> int:
        """The vertex it names."""
        return int(self._data["index"])


class NotFiniteError(MeshError):
    """A coordinate is infinite or not a number."""

    @property
    def vertex(self) -> int:
        """The first such vertex."""
        return int(self._data["vertex"])


class TooLargeError(MeshError):
    """There is more of something than 32-bit indices can name."""


class FileError(Error, OSError):
    """The system refuses to open, read, create or rename a file."""

    def __init__(self, message: str = "", data: Optional[Dict[str, Any]] = None) -> None:
        super().__init__(message, data)
        self.errno = self._data.get("errno")
        self.filename = self._data.get("filename")
        self.strerror = self._data.get("strerror")


class MissingFileError(FileError, FileNotFoundError):
    """There is no such file."""


class FormatError(Error, ValueError):
    """A file is not what its format says, or a format cannot hold a mesh."""

    @property
    def format(self) -> Optional[str]:
        """The format the file was read as."""
        return self._data.get("format")

    @property
    def place(self) -> Optional[str]:
        """Where in the file: a line, a byte, a path."""
        return self._data.get("place")


class FormulaError(Error, ValueError):
    """A formula that cannot be read."""

    @property
    def line(self) -> Optional[int]:
        """The line, counted from 1."""
        return self._data.get("line")

    @property
    def column(self) -> Optional[int]:
        """The character in it, counted from 1."""
        return self._data.get("column")


class ModelError(Error, ValueError):
    """A model file says something that has no meaning."""

    @property
    def node(self) -> Optional[str]:
        """The node at fault."""
        return self._data.get("node")


class GeometryError(Error, ValueError):
    """A curve, patch, field or cage is at fault."""


class LimitError(Error):
    """A limit stopped the call."""


class DeadlineError(LimitError, TimeoutError):
    """The deadline passed."""


class MemoryLimitError(LimitError, MemoryError):
    """The ceiling on memory would have been passed."""

    @property
    def needed(self) -> int:
        """Bytes that the call would have held."""
        return int(self._data["needed"])

    @property
    def limit(self) -> int:
        """The ceiling, in bytes."""
        return int(self._data["limit"])


class CancelledError(LimitError):
    """The call was cancelled."""


class InternalError(Error, RuntimeError):
    """A fault of trisect itself."""


_KINDS: Dict[str, Type[Error]] = {
    "argument": ArgumentError,
    "cancelled": CancelledError,
    "deadline": DeadlineError,
    "file": FileError,
    "format": FormatError,
    "formula": FormulaError,
    "geometry": GeometryError,
    "index": IndexOutOfRangeError,
    "inside out": InsideOutError,
    "internal": InternalError,
    "memory": MemoryLimitError,
    "mesh": MeshError,
    "model": ModelError,
    "not closed": NotClosedError,
    "not finite": NotFiniteError,
    "too large": TooLargeError,
}


def make(kind: str, message: str, data: str) -> Error:
    """The exception of a kind; what the compiled half calls."""
    found = json.loads(data)
    if kind == "file" and found.get("errno") == errno.ENOENT:
        return MissingFileError(message, found)
    return _KINDS.get(kind, Error)(message, found)
