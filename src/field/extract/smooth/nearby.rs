//! The field near the surface: values and gradients by the shortest tape that holds at a place, and feet of projections.

use glam::DVec3;
use rustc_hash::FxHashMap;

use super::super::lattice::{Cube, Lattice};
use super::super::octree::Leaf;
use super::super::solve::deviation;
use crate::field::expression::{Scratch, Tape};

/// In instructions: a whole tape no longer than this is run as quickly as a shorter one is found (a search takes about a fifth of a
/// microsecond, as long as the gradients of twenty instructions).
const SHORT: usize = 24;
/// Steps of Newton's method along the gradient. Three are enough from within the tolerance; more are for places with strong curvature.
const STEPS: usize = 8;
/// Roundings of the largest coordinate within which a point is on the surface.
const ROUNDINGS: f64 = 4.0;

/// The cosine of the angle within which the gradient leads the way of a facet: 15 degrees.
const ALIKE: f64 = 0.966;
/// Of the reach: how far along the normal of a facet the surface is looked for, step by step.
const PROBES: [f64; 6] = [0.05, 0.2, 0.5, 0.8, 1.0, 2.0];
/// Halvings of the last step: to about a thousandth of the reach.
const HALVINGS: usize = 10;

/// The field, to be asked near its zero set.
pub(in crate::field::extract) struct Nearby<'a> {
    whole: &'a Tape,
    /// The tapes of the cells that the surface may meet; empty if the whole tape is short.
    cells: FxHashMap<Cube, &'a Tape>,
    lattice: Lattice,
    /// Farther than this no point is moved to get it onto the surface.
    reach: f64,
}

/// What the field says at a place.
#[derive(Clone, Copy, Debug)]
pub(super) struct Look {
    /// How far the surface is, to first order: the value over the length of the gradient. Positive inside.
    pub(super) depth: f64,
    /// Unit vector against the gradient.
    pub(super) outward: DVec3,
}

/// A point of the surface, and its normal.
#[derive(Clone, Copy, Debug)]
pub(super) struct Foot {
    pub(super) place: DVec3,
    pub(super) outward: DVec3,
}

impl<'a> Nearby<'a> {
    /// The field of `whole`, whose simplified tapes are those of the leaves; `reach` in units of the coordinates.
    pub(in crate::field::extract) fn new(
        whole: &'a Tape,
        leaves: &'a [Leaf],
        lattice: Lattice,
        reach: f64,
    ) -> Self {
        let of_leaf = |leaf: &'a Leaf| leaf.tape.as_deref().map(|tape| (leaf.cube, tape));
        let cells = if whole.len() <= SHORT {
            FxHashMap::default()
        } else {
            leaves.iter().filter_map(of_leaf).collect()
        };
        Self { whole, cells, lattice, reach }
    }

    /// How far points are moved at most to get onto the surface: the tolerance.
    pub(super) fn reach(&self) -> f64 {
        self.reach
    }

    fn tape(&self, place: DVec3) -> &Tape {
        let unit = if self.cells.is_empty() { None } else { self.lattice.unit_at(place) };
        let Some(unit) = unit else { return self.whole };
        let levels = 0..=self.lattice.count.trailing_zeros();
        let holding =
            levels.map(|level| Cube { corner: unit.map(|x| x >> level << level), size: 1 << level });
        holding.filter_map(|cube| self.cells.get(&cube)).next().copied().unwrap_or(self.whole)
    }

    /// What the field says at `place`; nothing where it has no value or no direction.
    pub(super) fn look(&self, place: DVec3, scratch: &mut Scratch) -> Option<Look> {
        let (value, gradient) = self.tape(place).gradient(place.to_array(), scratch);
        let slope = gradient.length();
        (slope > 0.0 && slope.is_finite() && value.is_finite())
            .then(|| Look { depth: value / slope, outward: gradient / -slope })
    }

    /// What the field says of a facet with this middle and normal. Where the gradient at the middle leads another way, the surface is asked
    /// for along the normal: near a crease the value at the middle may be that of the other side, which need not be the nearer one.
    pub(super) fn under(&self, middle: DVec3, normal: DVec3, scratch: &mut Scratch) -> Option<Look> {
        let own = self.look(middle, scratch)?;
        if own.outward.dot(normal) >= ALIKE || normal == DVec3::ZERO {
            return Some(own);
        }
        let pierced = self.pierced(middle, normal, scratch);
        Some(
            pierced
                .filter(|look| look.outward.dot(normal) > own.outward.dot(normal))
                .filter(|look| look.depth.abs() <= own.depth.abs().max(0.1 * self.reach))
                .unwrap_or(own),
        )
    }

    /// The surface where the line through `from` along the unit vector `normal` leads out of it, if that is within twice the reach.
    fn pierced(&self, from: DVec3, normal: DVec3, scratch: &mut Scratch) -> Option<Look> {
        let mut inside = |at: f64| {
            let place = from + normal * at;
            self.tape(place).value(place.to_array(), scratch) > 0.0
        };
        let way = if inside(0.0) { 1.0 } else { -1.0 };
        let (mut near, mut far) = (0.0, 0.0);
        for part in PROBES {
            far = way * part * self.reach;
            if inside(far) != (way > 0.0) {
                break;
            }
            near = far;
        }
        if near == far {
            return None;
        }
        for _ in 0..HALVINGS {
            let middle = 0.5 * (near + far);
            if inside(middle) == (way > 0.0) { near = middle } else { far = middle }
        }
        let look = self.look(from + normal * near, scratch)?;
        Some(Look { depth: far, outward: look.outward })
    }

    /// How far the surface is from `place`, as the cells measure it.
    pub(super) fn deviation(&self, place: DVec3, scratch: &mut Scratch) -> f64 {
        deviation(self.tape(place), place, scratch)
    }

    /// The point of the surface that `place` is moved to along the gradient. Nothing if it does not get there, or is led too far.
    pub(super) fn foot(&self, place: DVec3, scratch: &mut Scratch) -> Option<Foot> {
        let mut at = place;
        let mut best: Option<(f64, Foot)> = None;
        for _ in 0..STEPS {
            let look = self.look(at, scratch)?;
            let off = look.depth.abs();
            if best.is_some_and(|(least, _)| off >= least) {
                break;
            }
            best = Some((off, Foot { place: at, outward: look.outward }));
            if off <= ROUNDINGS * f64::EPSILON * at.abs().max_element() {
                break;
            }
            at += look.outward * look.depth;
            if at.distance(place) > self.reach {
                break;
            }
        }
        best.filter(|(off, _)| *off <= 1e-6 * self.reach).map(|(_, foot)| foot)
    }
}
