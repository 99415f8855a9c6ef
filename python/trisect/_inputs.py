"""The inputs of a job: read, moved and mended as the program does it, when its verb asks for them."""

from __future__ import annotations

import contextlib
import warnings
from typing import Any, Callable, Dict, Iterator, List, Mapping, Sequence, Tuple

import numpy as np

from . import _convert
from ._errors import ArgumentError, Error, TrisectWarning
from ._files import local_input
from ._settings import settings
from ._surfaces import Mesh, Solid, _gate_options, _passed, _three

# In the order in which they are done, whatever the order in the job, as the program does.
PLACING = ("matrix", "rotate", "scale", "translate")
MENDING = ("weld", "orient", "closed-parts", "fill-holes", "refine-holes", "as-is")
# Of an input alone, or as an option for all of them.
_OWN = (*PLACING, *MENDING, "rule")

Given = Mapping[str, Any]


class Inputs:
    """The inputs of one job."""

    def __init__(self, entries: Any, all_of_them: Given, folder: str, limited: Callable[[], Dict[str, Any]]) -> None:
        """``all_of_them`` is what the options say of every input, ``limited`` the settings with what is left of the deadline."""
        if not isinstance(entries, Sequence) or isinstance(entries, str) or not entries:
            raise ArgumentError("a job has a list of inputs")
        self._folder, self._limited = folder, limited
        self._entries = [self._entry(entry, all_of_them, place) for place, entry in enumerate(entries)]

    @staticmethod
    def _entry(entry: Any, all_of_them: Given, place: int) -> Tuple[str, Dict[str, Any]]:
        """The path of an input, and what becomes of it."""
        if isinstance(entry, str):
            entry = {"file": entry}
        if not isinstance(entry, Mapping) or not isinstance(entry.get("file"), str):
            raise ArgumentError(f"input {place + 1} is a path or an object with a file, not {entry!r}")
        own = {key: value for key, value in entry.items() if key != "file" and value is not None and value is not False}
        unknown = [key for key in own if key not in _OWN]
        if unknown:
            raise ArgumentError(f"input {place + 1}: unknown keys {', '.join(unknown)}; known are {', '.join(_OWN)}")
        return entry["file"], {**all_of_them, **own}

    def __len__(self) -> int:
        return len(self._entries)

    def of(self, count: int, what: str) -> None:
        """Refuses another number of inputs."""
        if len(self) != count:
            raise ArgumentError(f"{what}, not {len(self)}")

    def rules(self, settings_: Given) -> List[str]:
        """What is inside each of them."""
        return [str(own.get("rule", settings_.get("rule", "positive"))) for _, own in self._entries]

    def like_first(self, path: str) -> None:
        """One more, which is mended as the first one is and stays where it is."""
        first = self._entries[0][1]
        self._entries.append((path, {key: value for key, value in first.items() if key not in PLACING}))

    def path(self, place: int) -> str:
        """What an input is called."""
        return self._entries[place][0]

    def solids(self) -> List[Solid]:
        """All of them as operands."""
        return [self.solid(place) for place in range(len(self))]

    def solid(self, place: int) -> Solid:
        """One as an operand: closed, looked through, at its place."""
        with self._of_operand(place):
            mesh, _ = self.read(place)
            given = self._limits()
            core = _passed(mesh._core, self.gate(place), given)
            return Solid._of(core.operand(bool(self._limited().get("assume_clean")), given))

    def surface(self, place: int) -> Mesh:
        """One as a surface that may be open: at its place, its vertices joined and its faces turned where that is asked for."""
        own = self._entries[place][1]
        with self._of_operand(place):
            mesh, _ = self.read(place)
            if any(own.get(key) for key in ("closed-parts", "fill-holes", "refine-holes")):
                said = "closed-parts and fill-holes are for solids: this surface stays open"
                warnings.warn(f"{self.path(place)}: {said}", TrisectWarning, stacklevel=2)
            if "weld" not in own and not own.get("orient"):
                return mesh
            joined: Mesh = Mesh._wrap(mesh._core.joined(_welding(own.get("weld")), bool(own.get("orient"))))
            return joined

    def read(self, place: int) -> Tuple[Mesh, str]:
        """One as its file has it, at its place; and the ending of its format. Unlike the others this does not say which it is."""
        path, own = self._entries[place]
        with local_input(path, self._folder) as local:
            surface, warned, ending = _convert.load_with_format(local, None, self._limits())
        for text in warned:
            warnings.warn(f"{path}: {text}", TrisectWarning, stacklevel=2)
        for key in PLACING:
            if key in own:
                surface = surface.moved(key, _numbers(key, own[key]))
        mesh: Mesh = Mesh._wrap(surface)
        return mesh, ending

    def gate(self, place: int) -> Dict[str, Any]:
        """How one is mended."""
        own = self._entries[place][1]
        as_is = bool(own.get("as-is"))
        fill = own.get("fill-holes", False) or bool(own.get("refine-holes"))
        orient, parts = bool(own.get("orient")), bool(own.get("closed-parts"))
        options = _gate_options(_welding(own.get("weld")), orient, parts, fill, not as_is, as_is) or {}
        return {**options, "refine_holes": bool(own.get("refine-holes"))}

    def _limits(self) -> Any:
        limits = ("deadline", "memory", "threads")
        return settings({key: value for key, value in self._limited().items() if key in limits}, limits_only=True)

    @contextlib.contextmanager
    def _of_operand(self, place: int) -> Iterator[None]:
        """Has what is raised say which input it is of."""
        try:
            yield
        except Error as error:
            if error.operand is None:
                error.operand = error._data["operand"] = place
                error._message = f"operand {place + 1} ({self.path(place)}): {error._message}"
            raise


def _welding(given: Any) -> Any:
    """A distance, or "auto"."""
    if given is None or given == "auto":
        return given
    return float(given)


def _numbers(how: str, value: Any) -> List[float]:
    """The numbers of a transform; texts are read as on the command line."""
    if isinstance(value, str):
        value = [float(word) for word in value.replace(",", " ").split()]
        value = value[0] if len(value) == 1 else value
    if how == "matrix":
        return [float(x) for x in np.asarray(value, dtype=float).reshape(-1)]
    if np.isscalar(value):
        # One angle is about z, one factor for all axes.
        value = [0.0, 0.0, value] if how == "rotate" else [value] * 3 if how == "scale" else value
    return _three(value, how)
