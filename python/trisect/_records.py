"""What is known of meshes and results, as plain records. All are made of JSON that the compiled half writes."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass, field
from typing import Any, Dict, List, Mapping, Optional, Tuple, Type, TypeVar

import numpy as np
from numpy.typing import NDArray

Vertices = NDArray[np.int64]

R = TypeVar("R", bound="Record")


class Record:
    """A record that is made of a JSON object: keys that it does not have are left alone."""

    @classmethod
    def of(cls: Type[R], data: Mapping[str, Any]) -> R:
        """The record of an object."""
        known = {entry.name: entry for entry in dataclasses.fields(cls)}  # type: ignore[arg-type]
        values: Dict[str, Any] = {}
        for key, value in data.items():
            if key in known:
                inner = known[key].metadata.get("of")
                values[key] = value if inner is None or value is None else inner(value)
        return cls(**values)


def _of(inner: Any) -> Any:
    """A field that is a record itself."""
    return field(default=None, metadata={"of": inner})


@dataclass(frozen=True)
class Place(Record):
    """Where a fault is: triangles and vertices concerned, and a point (NaN where there is none)."""

    triangles: List[int] = field(default_factory=list)
    vertices: List[int] = field(default_factory=list)
    position: Tuple[float, float, float] = field(
        default=(float("nan"), float("nan"), float("nan")),
        metadata={"of": lambda xs: tuple(float("nan") if x is None else x for x in xs)},
    )


def _places(data: Any) -> List[Place]:
    return [Place.of(place) for place in data]


@dataclass(frozen=True)
class Fault(Record):
    """Faults of one kind: how many, and where the first (at most five) are."""

    count: int = 0
    places: List[Place] = field(default_factory=list, metadata={"of": _places})

    def __bool__(self) -> bool:
        return self.count > 0


def _fault() -> Any:
    return field(default_factory=Fault, metadata={"of": Fault.of})


@dataclass(frozen=True)
class Mending(Record):
    """What was done to close a surface. Each :class:`Fault` counts, with places in the mesh as it was given."""

    seams: Fault = _fault()
    widest_seam: float = 0.0
    distance: Optional[float] = None
    split_edges: Fault = _fault()
    zero_area: Fault = _fault()
    filled: Fault = _fault()
    filled_triangles: int = 0
    filled_vertices: int = 0
    filled_area: float = 0.0
    copies: Fault = _fault()
    copied_shells: Fault = _fault()
    fins: Fault = _fault()
    strays: Fault = _fault()
    walls: Fault = _fault()
    open_parts: Fault = _fault()
    open_part_count: int = 0
    open_area: float = 0.0
    turned: int = 0
    text: str = ""
    """All of it in words; empty if nothing was done."""

    def __bool__(self) -> bool:
        return bool(self.text)


@dataclass(frozen=True)
class Cleaning(Record):
    """What was left out or joined to make a solid."""

    repeated_corners: int = 0
    opposite_pairs: int = 0
    welded_vertices: int = 0
    unreferenced_vertices: int = 0

    def __bool__(self) -> bool:
        return any(dataclasses.astuple(self))


@dataclass(frozen=True)
class Extraction(Record):
    """How well a surface follows the field that it was extracted from.

    ``tolerance`` is what was asked for and ``deviation`` the largest distance found, in units of the coordinates; 95 of a hundred
    faces are within ``normal_deviation`` degrees of the field's gradient. ``cells`` counts the cubes that the surface was sought
    in, ``divided_cells`` those of the least size in which it had several pieces.
    """

    tolerance: float = 0.0
    deviation: float = 0.0
    normal_deviation: float = 0.0
    cells: int = 0
    divided_cells: int = 0


@dataclass(frozen=True)
class Diagnosis(Record):
    """All that is known of a mesh as a surface. ``str()`` of it is short and has the first places."""

    vertices: int = 0
    triangles: int = 0
    index_out_of_range: Fault = _fault()
    not_finite: Fault = _fault()
    unreferenced_vertices: Fault = _fault()
    repeated_corners: Fault = _fault()
    zero_area: Fault = _fault()
    duplicates: Fault = _fault()
    opposite_duplicates: Fault = _fault()
    open_edges: Fault = _fault()
    misoriented_edges: Fault = _fault()
    non_manifold_edges: Fault = _fault()
    unbalanced_edges: Fault = _fault()
    pinched_vertices: Fault = _fault()
    split_vertices: Fault = _fault()
    shells: int = 0
    inside_out_shells: Fault = _fault()
    closed: bool = False
    mending: Optional[Mending] = _of(Mending.of)
    closing_distance: Optional[float] = None
    area: float = 0.0
    volume: Optional[float] = None
    euler_characteristic: int = 0
    genus: Optional[int] = None
    text: str = ""

    def __str__(self) -> str:
        return self.text or repr(self)

    @property
    def faults(self) -> Dict[str, Fault]:
        """The faults that there are, by their names."""
        named = {entry.name: getattr(self, entry.name) for entry in dataclasses.fields(self)}
        return {name: value for name, value in named.items() if isinstance(value, Fault) and value}


@dataclass(frozen=True)
class SelfCrossing(Record):
    """Two triangles of one surface that cross: which, about where, and how deep (in units of the coordinates)."""

    triangles: Tuple[int, int] = field(default=(0, 0), metadata={"of": tuple})
    place: Tuple[float, float, float] = field(default=(0.0, 0.0, 0.0), metadata={"of": tuple})
    depth: float = 0.0


@dataclass(frozen=True)
class SelfCrossings(Record):
    """Where a surface crosses itself: ``count`` pairs of triangles really do, ``tolerated`` no deeper than rounding, ``touching``
    lie on each other in one plane."""

    count: int = 0
    tolerated: int = 0
    shallow: int = 0
    touching: int = 0
    tolerance: float = 0.0
    places: List[SelfCrossing] = field(
        default_factory=list, metadata={"of": lambda places: [SelfCrossing.of(place) for place in places]}
    )

    def __bool__(self) -> bool:
        return self.count > 0 or self.touching > 0


@dataclass(frozen=True)
class NearContact(Record):
    """A place where surfaces of two operands are nearly flush, how far apart they are there, and two triangles of the result."""

    place: Tuple[float, float, float] = field(default=(0.0, 0.0, 0.0), metadata={"of": tuple})
    distance: float = 0.0
    triangles: Tuple[int, int] = field(default=(0, 0), metadata={"of": tuple})


@dataclass(frozen=True)
class NearContacts(Record):
    """Where surfaces of different operands are nearly flush: how often, and the first few."""

    count: int = 0
    places: List[NearContact] = field(
        default_factory=list, metadata={"of": lambda places: [NearContact.of(place) for place in places]}
    )


@dataclass(frozen=True)
class Embedding(Record):
    """What was done about crossings that rounding makes: ``left`` triangles still cross others."""

    rounds: int = 0
    displacement: float = 0.0
    left: int = 0


@dataclass(frozen=True)
class Flattening(Record):
    """What lay in one plane but for rounding and became one face: ``vertices`` left out, by how much the surface moved at most."""

    vertices: int = 0
    displacement: float = 0.0


@dataclass(frozen=True)
class Snapping(Record):
    """What snapping moved and split before the operation."""

    distance: float = 0.0
    moved: int = 0
    collapsed: int = 0
    walls: int = 0
    vanished: int = 0
    split_edges: int = 0
    split_faces: int = 0
    farthest: float = 0.0
    rounds: int = 0
    unfinished: bool = False


@dataclass(frozen=True)
class OperandState:
    """What is known of an operand's crossings with itself: ``kind`` is "not_checked", "clean", "crossing" or "resolved", and
    ``data`` has its numbers."""

    kind: str = "not_checked"
    data: Dict[str, float] = field(default_factory=dict)

    @classmethod
    def of(cls, data: Any) -> OperandState:
        """The state of a word or of an object with one key."""
        if isinstance(data, str):
            return cls(data)
        [(kind, numbers)] = data.items()
        return cls(kind, dict(numbers))


@dataclass(frozen=True)
class Certificate(Record):
    """What a result is, and what making it met.

    ``volume`` is in cubed units of the coordinates, ``area`` in squared ones; no new vertex lies further than
    ``largest_rounding`` from its exact place. ``contacts`` counts decisions that touching operands left open.
    """

    vertices: int = 0
    triangles: int = 0
    closed: bool = False
    manifold: bool = False
    components: int = 0
    genus: Optional[int] = None
    volume: float = 0.0
    area: float = 0.0
    zero_area: int = 0
    inverted: int = 0
    largest_rounding: float = 0.0
    contacts: int = 0
    nearly_flush: NearContacts = field(default_factory=NearContacts, metadata={"of": NearContacts.of})
    clean_up_stopped: int = 0
    three_face_points: int = 0
    walls_left: int = 0
    embedding: Optional[Embedding] = _of(Embedding.of)
    flattening: Flattening = field(default_factory=Flattening, metadata={"of": Flattening.of})
    snapping: Optional[Snapping] = _of(Snapping.of)
    operands: List[OperandState] = field(
        default_factory=list, metadata={"of": lambda states: [OperandState.of(state) for state in states]}
    )

    def as_dict(self) -> Dict[str, Any]:
        """The same as plain dictionaries and lists, for JSON."""
        return dataclasses.asdict(self)
