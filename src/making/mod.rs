//! Making things: convex hulls, Minkowski sums, patterns of copies, text, offsets and shells.
//!
//! Every function gives a closed mesh, or a solid, that is an operand again.
//!
//! ```
//! use trisect::making::{Pattern, convex_hull};
//! use trisect::{Solid, primitives};
//!
//! // A plate with nine holes: the drills are one operand.
//! let plate = Solid::try_from(primitives::cuboid([0.0; 3], [4.0, 4.0, 1.0])?)?;
//! let drill = primitives::cylinder(0.25, 3.0, 32)?.translated([1.0, 1.0, -1.0]);
//! let drills = Pattern::Grid { counts: [3, 3, 1], steps: [1.0, 1.0, 0.0] }.repeat(&drill)?;
//! let drilled = plate.difference(&Solid::try_from(drills)?)?;
//! assert_eq!(drilled.solid().genus(), Some(9));
//! assert_eq!(convex_hull(&drilled.solid().mesh().positions)?.triangles.len(), 12);
//! # Ok::<(), trisect::Error>(())
//! ```

mod hull;
mod minkowski;
#[cfg(feature = "field")]
mod offset;
mod pattern;
#[cfg(feature = "text")]
mod text;

pub use hull::convex_hull;
pub use minkowski::minkowski_sum;
#[cfg(feature = "field")]
pub use offset::{Drain, Offset, OffsetOptions, hollow, offset};
pub use pattern::Pattern;
#[cfg(feature = "text")]
pub use text::{Font, Lettering, TextAlign};
