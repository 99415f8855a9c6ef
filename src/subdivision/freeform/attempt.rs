//! One attempt at a cage.

use super::assemble::Draft;
use super::measure::{Errors, Region};

/// What one size of faces gave.
pub(super) struct Attempt {
    pub(super) draft: Draft,
    pub(super) errors: Errors,
    /// The largest distance over each face.
    pub(super) of_face: Vec<f64>,
    pub(super) region: Region,
    pub(super) refined: u32,
    pub(super) left_over: usize,
}
