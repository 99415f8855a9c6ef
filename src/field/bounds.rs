//! Where a field can be positive: a box around the solid, found by interval arithmetic.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use super::Expression;
use super::expression::Scratch;
use crate::{Control, Error};

/// Half the side of the cube searched, in units of length: 2^20, so that halvings are exact.
const REGION: f64 = 1_048_576.0;
/// Boxes looked at per direction and round of the search.
const MOST: usize = 20_000;

/// A part of the region, ordered by how far it reaches in the direction asked for; among equals smaller ones first.
#[derive(Clone, Copy, PartialEq)]
struct SearchBox {
    reach: f64,
    low: [f64; 3],
    high: [f64; 3],
}

impl SearchBox {
    fn size(&self) -> f64 {
        (0..3).map(|axis| self.high[axis] - self.low[axis]).fold(0.0, f64::max)
    }
}

impl Eq for SearchBox {}
impl PartialOrd for SearchBox {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}
impl Ord for SearchBox {
    fn cmp(&self, other: &Self) -> Ordering {
        self.reach
            .total_cmp(&other.reach)
            .then(other.size().total_cmp(&self.size()))
            .then_with(|| self.low.partial_cmp(&other.low).unwrap_or(Ordering::Equal))
    }
}

impl Expression {
    /// A box that certainly contains where the field is positive, at most a few percent too large where interval
    /// bounds are close; nothing if it is positive nowhere. With `plane`, only the plane z = `plane` is searched, and the box is
    /// flat.
    ///
    /// # Errors
    /// [`Error::Field`] if the field may be positive a million units from the origin; the limits of `control`.
    pub fn positive_bounds(
        &self,
        plane: Option<f64>,
        control: &Control,
    ) -> Result<Option<[[f64; 3]; 2]>, Error> {
        let field = self.sign_form();
        let (mut low, mut high) = ([-REGION; 3], [REGION; 3]);
        if let Some(height) = plane {
            (low[2], high[2]) = (height, height);
        }
        for round in 0..4 {
            let whole = SearchBox { reach: 0.0, low, high };
            let accuracy = if round == 0 { 0.25 } else { whole.size() / 100.0 };
            let axes = if plane.is_some() { 2 } else { 3 };
            for axis in 0..axes {
                for side in [-1.0, 1.0] {
                    match field.reach(whole, axis, side, accuracy, control)? {
                        None => return Ok(None),
                        Some(reach) if side < 0.0 => low[axis] = (-reach).max(low[axis]),
                        Some(reach) => high[axis] = reach.min(high[axis]),
                    }
                }
            }
            let unbounded = (0..axes).find(|&axis| low[axis] <= -REGION || high[axis] >= REGION);
            if let Some(axis) = unbounded {
                let name = ["x", "y", "z"][axis];
                return Err(Error::Field(format!(
                    "cannot tell where the solid ends along {name}: it may be unbounded; give it bounds, or cut it \
                     off with another shape"
                )));
            }
        }
        // A little room, so that surfaces are inside.
        let room = (0..3).map(|axis| high[axis] - low[axis]).fold(0.0, f64::max) * 0.01;
        for axis in 0..if plane.is_some() { 2 } else { 3 } {
            low[axis] -= room;
            high[axis] += room;
        }
        Ok(Some([low, high]))
    }

    /// How far the field may be positive in a direction, never too small.
    fn reach(
        &self,
        whole: SearchBox,
        axis: usize,
        side: f64,
        accuracy: f64,
        control: &Control,
    ) -> Result<Option<f64>, Error> {
        let mut scratch = Scratch::default();
        let reach = |part: &SearchBox| if side > 0.0 { part.high[axis] } else { -part.low[axis] };
        let mut parts = BinaryHeap::from([SearchBox { reach: reach(&whole), ..whole }]);
        for count in 0.. {
            let Some(part) = parts.pop() else { return Ok(None) };
            if count % 1000 == 0 {
                control.check()?;
            }
            if !(self.tape().bounds(part.low, part.high, &mut scratch).high > 0.0) {
                continue;
            }
            let size = part.size();
            if size <= accuracy.max(1e-9 * part.reach.abs()) || count > MOST {
                return Ok(Some(part.reach));
            }
            let long = (0..3).filter(|&k| part.high[k] - part.low[k] > 0.5 * size).collect::<Vec<_>>();
            for number in 0..1usize << long.len() {
                let mut child = part;
                for (bit, &k) in long.iter().enumerate() {
                    let middle = part.low[k] * 0.5 + part.high[k] * 0.5;
                    if number >> bit & 1 == 0 { child.high[k] = middle } else { child.low[k] = middle }
                }
                child.reach = reach(&child);
                parts.push(child);
            }
        }
        Ok(None)
    }
}
