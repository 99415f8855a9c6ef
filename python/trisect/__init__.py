"""Exact booleans of closed triangle meshes: always closed, always right, fast.

>>> import trisect
>>> block = trisect.cuboid([0, 0, 0], [1, 1, 1])
>>> corner = trisect.cuboid([0.5, 0.5, 0.5], [1.5, 1.5, 1.5])
>>> cut = block - corner
>>> cut.volume
0.875
>>> cut.vertices.shape, cut.faces.shape
((14, 3), (24, 3))

Operands are :class:`Solid`, or anything one can be made of: a ``trimesh.Trimesh``, a ``pyvista.PolyData``, an ``open3d`` mesh,
a path to a mesh file, or a pair of arrays. Results are solids again, with ``origins``, ``curves`` and a ``certificate``.

Coordinates have whatever unit they were given in; volumes and areas are in its cube and its square. Everything is computed in
double precision, and decided exactly.
"""

from __future__ import annotations

from . import fields
from ._cages import Cage, CageErrors, CageReport, CombinedCages, PointOrigins, combine_cages
from ._errors import (
    ArgumentError,
    CancelledError,
    DeadlineError,
    Error,
    FileError,
    FormatError,
    FormulaError,
    GeometryError,
    IndexOutOfRangeError,
    InsideOutError,
    InternalError,
    LimitError,
    MemoryLimitError,
    MeshError,
    MissingFileError,
    ModelError,
    NotClosedError,
    NotFiniteError,
    TooLargeError,
    TrisectWarning,
)
from ._operations import (
    Check,
    Section,
    check,
    combine,
    cut,
    difference,
    evaluate_model,
    intersection,
    resolve,
    sections,
    split,
    trim,
    union,
    xor,
)
from ._records import (
    Certificate,
    Cleaning,
    Diagnosis,
    Embedding,
    Extraction,
    Fault,
    Flattening,
    Mending,
    NearContact,
    NearContacts,
    OperandState,
    Place,
    SelfCrossing,
    SelfCrossings,
    Snapping,
)
from ._settings import Limits, Settings
from ._shapes import cone, cuboid, cylinder, icosphere, torus
from ._surfaces import Attribute, Groups, Mesh, Origins, Solid, SolidLike
from ._trisect import __version__
from .batch import batch, run_job

load = Solid.load

__all__ = [
    "ArgumentError",
    "Attribute",
    "Cage",
    "CageErrors",
    "CageReport",
    "CancelledError",
    "Certificate",
    "Check",
    "Cleaning",
    "CombinedCages",
    "DeadlineError",
    "Diagnosis",
    "Embedding",
    "Error",
    "Extraction",
    "Fault",
    "FileError",
    "Flattening",
    "FormatError",
    "FormulaError",
    "GeometryError",
    "Groups",
    "IndexOutOfRangeError",
    "InsideOutError",
    "InternalError",
    "LimitError",
    "Limits",
    "MemoryLimitError",
    "Mending",
    "Mesh",
    "MeshError",
    "MissingFileError",
    "ModelError",
    "NearContact",
    "NearContacts",
    "NotClosedError",
    "NotFiniteError",
    "OperandState",
    "Origins",
    "Place",
    "PointOrigins",
    "Section",
    "SelfCrossing",
    "SelfCrossings",
    "Settings",
    "Snapping",
    "Solid",
    "SolidLike",
    "TooLargeError",
    "TrisectWarning",
    "__version__",
    "batch",
    "check",
    "combine",
    "combine_cages",
    "cone",
    "cuboid",
    "cut",
    "cylinder",
    "difference",
    "evaluate_model",
    "fields",
    "icosphere",
    "intersection",
    "load",
    "resolve",
    "run_job",
    "sections",
    "split",
    "torus",
    "trim",
    "union",
    "xor",
]
