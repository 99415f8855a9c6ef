//! What the corners of a result say: texture coordinates, normals, colours and numbers of one's own, carried through booleans.
//!
//! The judge knows nothing of barycentric weights, of how a result was made, or of the library's tolerances. Every triangle of an
//! operand gets a number and an affine map of space of its own, and its corners the values that the map has there. Then every
//! triangle of a result must have one such number at its three corners, and at each corner what that map has at its place: wherever
//! it was cut, whatever was merged, however often.

#[path = "../common/mod.rs"]
mod common;

mod chains;
mod corners;
mod cut_faces;
mod kinds;
mod maps;
mod merged;
