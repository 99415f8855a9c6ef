//! Judges of results that share nothing with the engine but the types of a mesh, and random cases to judge.
//!
//! - [`winding`]: how often a surface winds round a point, exactly, by counting crossings of a ray;
//! - [`oracle`]: whether a result winds as its operands and the operation say, at points where mistakes would show;
//! - [`surface`]: closedness, manifoldness, components, Euler characteristic, volume, area of a mesh, by definition;
//! - [`contacts`]: the topology a solid has where its surface touches itself;
//! - [`boxes`]: what of many boxes is near;
//! - [`wide`]: volumes and windings at any size of coordinates, in integers;
//! - [`origin`]: whether a result far from the origin is what it is there;
//! - [`minimise`]: a failing pair made small;
//! - [`shapes`], [`placement`], [`cases`], [`hard`]: pairs of solids and an operation from a seed; [`many`]: operands of several
//!   bodies, and expressions.

pub(crate) mod boxes;
pub(crate) mod cases;
pub(crate) mod cells;
pub(crate) mod contacts;
pub(crate) mod exact;
pub(crate) mod hard;
pub(crate) mod many;
pub(crate) mod minimise;
pub(crate) mod oracle;
pub(crate) mod origin;
pub(crate) mod placement;
pub(crate) mod samples;
pub(crate) mod shapes;
pub(crate) mod surface;
pub(crate) mod vector;
pub(crate) mod wide;
pub(crate) mod winding;
