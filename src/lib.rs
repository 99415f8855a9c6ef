//! Exact booleans of closed triangle meshes.
//!
//! ```
//! use trisect::{Solid, primitives};
//!
//! let block = Solid::try_from(primitives::cuboid([0.0; 3], [1.0; 3])?)?;
//! let corner = Solid::try_from(primitives::cuboid([0.5; 3], [1.5; 3])?)?;
//! let cut = block.difference(&corner)?;
//! assert_eq!(cut.solid().volume(), 0.875);
//! # Ok::<(), trisect::Error>(())
//! ```
//!
//! A [`Mesh`] is plain data; [`Solid::try_from`] is the gate that makes it an operand, or says what is wrong and where.
//! [`boolean`] and [`Solid::union`] and its kin combine two solids, [`BooleanOptions`] any number, with limits, progress
//! and threads. An [`Outcome`] is a solid, with the [`Origin`] of every triangle and a [`Certificate`].
//!
//! # Guaranteed
//!
//! For operands that are closed and do not cross themselves, whatever their coordinates (every finite `f64`):
//!
//! - **The result is closed**, by construction, and an operand again.
//! - **It is the exact regularised boolean, rounded once**: what is cut, in which order and what is inside are decided by
//!   signs of exact values, and every new vertex is at the nearest `f64`, coordinate by coordinate, to its exact place.
//! - **Contact has a meaning**: operands that are flush, touch or coincide resolve as regularised set operations do,
//!   without a tolerance.
//! - **What the operation does not touch stays**: vertices keep their bits, triangles their order, their group and their
//!   [attributes](mesh::Attribute); what it cuts has the attributes that its face has there.
//! - **The same input gives the same bits**, on any number of threads and without the feature `parallel`.
//! - An empty result is a success. Bad input is an [`Error`], never a panic, and there is no `unsafe` code.
//!
//! # Not guaranteed
//!
//! - That rounding introduces no crossings of the size of an ulp. They are tolerated when the result becomes an operand.
//! - That the result is a 2-manifold where bodies touch in an edge or a vertex: in 22 of 100,000 random cases some stay
//!   connected. [`Certificate::manifold`] tells.
//! - A particular triangulation of faces that are cut.
//! - Anything for operands that cross themselves but a closed result, in which regions count as often as they are
//!   enclosed. [`Solid::self_crossings`] finds out; [`Certificate::operands`] tells whether it was asked.
//!
//! # Limits and cost
//!
//! 2^31 vertices in all and 2^32/3 triangles in each operand. A boolean of n triangles, k of them near the intersection,
//! takes O(n + k log k) time for usual meshes, and a few hundred bytes of memory for each of the k; [`Control`] stops it
//! at a deadline, at a ceiling on memory, or when asked. The gate takes O(n), a few nanoseconds a triangle.
//!
//! # Features
//!
//! | Feature | Default | Adds | Crates (30 without any) |
//! |---|---|---|---|
//! | `cli` | yes | the program; brings `field`, `formats`, `model`, `render`, `serde` | 58 |
//! | `draco` | yes | Draco-compressed glTF in the module `io`; brings `formats` | 17 |
//! | `field` | yes | the module `field`: signed distances, formulas, R-functions, and their surfaces as meshes | 1 |
//! | `formats` | yes | the module `io`, `Mesh::load` and `Mesh::save`: OBJ, glTF, STL, PLY, OFF | 16 |
//! | `model` | yes | the module `model`: trees of operations in JSON; brings `field`, `formats` and `serde` | 17 |
//! | `parallel` | yes | loops on rayon's current pool | 6 |
//! | `parametric` | yes | the module `parametric`: curves, regions, patches, solids of them | 31 |
//! | `render` | with `cli` | the module `render`: pictures of meshes as PNG | 11 |
//! | `serde` | with `cli` | `Serialize` and `Deserialize` for meshes, settings and reports | 3 |
//! | `text` | yes | text in TrueType and OpenType fonts as solids, in the module `making` | 1 |
//! | `subdivision` | yes | the module `subdivision`: subdivision surfaces given by cages, and their booleans as cages | none |
//! | `threemf` | yes | 3MF files in the module `io`; brings `formats` | 32 |
//! | `viewer` | yes | results as pages for browsers, of the program; brings `cli` | 58 |
//!
//! For the engine alone: `default-features = false`, with `parallel` or not.
//!
//! # Further
//!
//! In the package, `docs/semantics.md` has the whole of what is promised, `docs/algorithm.md` the algorithm, `docs/guide.md`
//! the way from the first cut to chains; `examples/` has programs to start from. Modules: [`mesh`], [`primitives`],
//! [`making`], [`control`], [`spatial`], [`exact`].

#![warn(clippy::print_stdout, clippy::print_stderr)]
// Where a room is left out, what only that room uses of the rooms below is not used. The whole set is checked.
#![cfg_attr(
    not(all(feature = "formats", feature = "model", feature = "parametric", feature = "render")),
    allow(dead_code, unused_imports, reason = "used by rooms that this set of features leaves out")
)]

mod boolean;
pub mod control;
mod error;
pub mod exact;
#[cfg(feature = "field")]
pub mod field;
#[cfg(feature = "formats")]
pub mod io;
pub mod making;
pub mod mesh;
#[cfg(feature = "model")]
pub mod model;
mod parallel;
#[cfg(feature = "parametric")]
pub mod parametric;
mod polygon;
pub mod primitives;
#[cfg(feature = "render")]
pub mod render;
pub mod spatial;
#[cfg(feature = "subdivision")]
pub mod subdivision;

pub use boolean::{
    BooleanOptions, Cell, Certificate, Contact, CornerOrigin, CutFaces, Embed, Embedding, Expression,
    ExpressionError, Flattening, Grid, Imprinted, Leaf, NearContact, NearContacts, OperandState, Operation,
    Origin, Outcome, PlaneCut, Rule, Section, SectionSide, Sections, Snapping, Solidified, Solidify,
    SolidifyReport, TrimSide, Trimmed, UnknownName, boolean,
};
pub use control::{CancelToken, Control, Limit};
pub use error::{Error, Failure, FileAction};
pub use mesh::{
    FaceGroup, FaceGroups, Image, Material, MaterialLanguage, MaterialText, Mesh, MeshError, Solid, Texture,
    TextureUse, Wrap,
};

/// The code of the README, compiled with the tests.
#[cfg(all(doctest, feature = "formats"))]
#[doc = include_str!("../README.md")]
struct Readme;
