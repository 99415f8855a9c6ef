//! Exact booleans of closed triangle meshes.
//!
//! ```
//! use trisect::{Operation, Solid, boolean, primitives};
//!
//! let block = Solid::try_from(primitives::cuboid([0.0; 3], [1.0; 3])?)?;
//! let corner = Solid::try_from(primitives::cuboid([0.5; 3], [1.5; 3])?)?;
//! let cut = boolean(Operation::Difference, &block, &corner)?;
//! assert_eq!(cut.solid().volume(), 0.875);
//! # Ok::<(), trisect::Error>(())
//! ```

#![warn(clippy::print_stdout, clippy::print_stderr)]

mod boolean;
pub mod control;
mod error;
pub mod exact;
pub mod field;
pub mod io;
pub mod mesh;
pub mod model;
mod parallel;
#[cfg(feature = "parametric")]
pub mod parametric;
mod polygon;
pub mod primitives;
#[cfg(feature = "render")]
pub mod render;
pub mod spatial;

pub use boolean::{
    BooleanOptions, Certificate, Contact, OperandState, Operation, Origin, Outcome, UnknownName, boolean,
};
pub use control::{CancelToken, Control};
pub use error::{Error, Failure};
pub use mesh::{FaceGroup, FaceGroups, Material, Mesh, Solid};
