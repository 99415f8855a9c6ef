//! The general arrangement: any number of closed surfaces that may cross and touch themselves and each other, and any
//! expressions of them, evaluated at once from the original operands and rounded once.
//!
//! 1. `surfaces`, `edges`: all operands under one numbering, in general position;
//! 2. `pairs`, `cross`, `crossings`: which faces cross, and where their edges do; `locality`: the patches in which none does;
//! 3. `triples`: points in which three faces meet;
//! 4. `lines`: where all points are, in order along edges and segments;
//! 5. `labels`, `seeds`, `walk`, `segment_labels`: winding numbers of all operands beside every piece;
//! 6. `sheets`: faces that touch in one plane, and points that have become one;
//! 7. `shape`: what of each face a result keeps, as a chain of edges that closes whatever rounding does;
//! 8. `evaluate`: all steps, with the cutting, tidying and assembly of the results.
//!
//! **Why it is closed.** F says of each label whether it is inside the result. In face f of step m, a region with the outer
//! label w counts c(w) = F(w + m) - F(w). Along a segment of f and g, the sum over f is F(w + m_f + m_g) - F(w + m_g) -
//! F(w + m_f) + F(w), and the sum over g is its negative; round an edge the steps of all faces telescope. Nothing about
//! positions or about F is used.
//!
//! **Why it is regularised.** For a vanishing perturbation the winding numbers converge almost everywhere, and so does the
//! boundary of F, as a current, plane by plane: the sum of all pieces of one plane is the boundary there, without walls or
//! double faces. So the pieces of faces that touch in a plane are added up (`cut::plane_sums`).

pub(crate) mod arrangement;
mod cell_neighbours;
pub(crate) mod cells;
pub(crate) mod cross;
pub(crate) mod crossings;
pub(crate) mod edges;
pub(crate) mod embed;
pub(crate) mod evaluate;
pub(crate) mod face_view;
pub(crate) mod labels;
pub(crate) mod lines;
pub(crate) mod locality;
pub(crate) mod pairs;
pub(crate) mod seeds;
pub(crate) mod segment_labels;
pub(crate) mod shape;
pub(crate) mod sheets;
pub(crate) mod strips;
pub(crate) mod surfaces;
pub(crate) mod triples;
pub(crate) mod walk;
