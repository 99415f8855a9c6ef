//! Plane sections of space.

use crate::Error;

/// A rectangle in space to be pictured: a corner and the two sides from it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Section {
    /// The lower left corner.
    pub corner: [f64; 3],
    /// From the lower left to the lower right corner.
    pub right: [f64; 3],
    /// From the lower left to the upper left corner.
    pub up: [f64; 3],
}

impl Section {
    /// The section of the box `low..high` by the plane at `position` along `axis` (0, 1, 2 for x, y, z). The picture
    /// shows x to the right, or y where the section is across x; z up, or y where it is across z.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] if there is no such axis or the box is empty or not finite.
    pub fn across(axis: usize, position: f64, low: [f64; 3], high: [f64; 3]) -> Result<Self, Error> {
        if axis > 2 {
            return Err(Error::InvalidArgument(format!(
                "there is no axis {axis}; 0, 1 and 2 are x, y and z"
            )));
        }
        let (u, v) = [(1, 2), (0, 2), (0, 1)][axis];
        let proper = |k: usize| low[k] < high[k] && low[k].is_finite() && high[k].is_finite();
        if !(proper(u) && proper(v) && position.is_finite()) {
            let what = format!("the box from {low:?} to {high:?} is empty or not finite");
            return Err(Error::InvalidArgument(what));
        }
        let mut corner = low;
        corner[axis] = position;
        let side = |k: usize| {
            let mut side = [0.0; 3];
            side[k] = high[k] - low[k];
            side
        };
        Ok(Self { corner, right: side(u), up: side(v) })
    }
}
