//! Distances as leaves of expressions.

use std::cell::Cell;

use glam::DVec3;
use smallvec::SmallVec;

use super::expression::Leaf;
use super::interval::Interval;
use super::{ContourDistance, SignedDistance};
use crate::spatial::{Closest, Feature};

/// Bounds of a function that changes by at most 1 per unit of length, over a box, from its value at the centre.
fn lipschitz(value: f64, low: [f64; 3], high: [f64; 3], axes: usize) -> Interval {
    let half = (0..axes).map(|axis| (high[axis] * 0.5 - low[axis] * 0.5).powi(2)).sum::<f64>().sqrt();
    let slack = 1e-12 * (half + value.abs());
    Interval::new(value - half - slack, value + half + slack)
}

fn centre(low: [f64; 3], high: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|axis| low[axis] * 0.5 + high[axis] * 0.5)
}

/// More faces than this near a box, and its gradient is taken to point anywhere.
const FEW: usize = 64;

/// Bounds of all directions between the given ones: of every unit vector that is a sum of them with positive factors, as
/// the gradient of a distance is next to an edge or a vertex. A cone around their mean that holds all of them holds
/// those sums. Nothing if a direction is unknown (zero) or the cone is no smaller than a half-space.
fn directions_between(directions: &[DVec3]) -> Option<[Interval; 3]> {
    let axis = directions.iter().sum::<DVec3>().try_normalize()?;
    let least = directions.iter().map(|direction| direction.dot(axis)).fold(1.0, f64::min);
    let cosine = least - 1e-12;
    if !(cosine > 0.0) {
        return None;
    }
    let sine = (1.0 - cosine * cosine).sqrt();
    let highest = |along: f64| {
        if along >= cosine { 1.0 } else { along * cosine + (1.0 - along * along).max(0.0).sqrt() * sine }
    };
    Some(std::array::from_fn(|k| {
        let (low, high) = (-highest(-axis[k]), highest(axis[k]));
        Interval::new((low - 1e-12).max(-1.0), (high + 1e-12).min(1.0))
    }))
}

/// A nearest point with the number of its mesh and its query.
type Answer = (u64, [f64; 3], Closest);

thread_local! {
    /// The last nearest points found on this thread. Neighbouring queries start from them, and several questions about
    /// one point are answered once.
    static LAST: Cell<[Option<Answer>; 4]> = const { Cell::new([None; 4]) };
}

impl SignedDistance {
    /// The nearest point, found with the help of what was found last on this thread.
    fn nearest(&self, point: [f64; 3]) -> Option<Closest> {
        let mut known = LAST.get();
        let number = self.number();
        let slot = known.iter().position(|entry| entry.is_some_and(|entry| entry.0 == number));
        let last = slot.and_then(|slot| known[slot]);
        if let Some((_, at, closest)) = last
            && at.map(f64::to_bits) == point.map(f64::to_bits)
        {
            return Some(closest);
        }
        let closest = self.tree().closest_from(point, last.map(|last| last.2.triangle))?;
        known[slot.unwrap_or(number as usize % known.len())] = Some((number, point, closest));
        LAST.set(known);
        Some(closest)
    }
}

impl Leaf for SignedDistance {
    fn value(&self, point: [f64; 3]) -> f64 {
        self.nearest(point).map_or_else(|| self.at(point), |closest| self.sign(point, &closest))
    }

    fn gradient(&self, point: [f64; 3]) -> (f64, [f64; 3]) {
        self.nearest(point).map_or_else(
            || (self.at(point), [0.0; 3]),
            |closest| {
                let found = self.measured(point, closest);
                (found.distance, found.gradient)
            },
        )
    }

    fn bounds(&self, low: [f64; 3], high: [f64; 3]) -> Interval {
        let centre = centre(low, high);
        if centre.iter().all(|x| x.is_finite()) {
            lipschitz(Leaf::value(self, centre), low, high, 3)
        } else {
            self.outside_bounds(low, high)
        }
    }

    fn gradient_bounds(&self, low: [f64; 3], high: [f64; 3]) -> [Interval; 3] {
        let anything = [Interval::new(-1.0, 1.0); 3];
        if !self.follows_normals() {
            return anything;
        }
        let middle = DVec3::from_array(centre(low, high));
        let Some(found) = self.nearest(middle.to_array()) else { return anything };
        let half = (DVec3::from_array(high) - middle).length();
        // Nearest points of the whole box lie within this ball: the distance grows by at most half, the query moves
        // by at most half.
        let radius = (found.squared_distance.sqrt() + 2.0 * half) * (1.0 + 1e-9);
        let mut inward: SmallVec<[DVec3; FEW]> = SmallVec::new();
        let mut known = true;
        self.tree().triangles_near(middle, radius, |triangle| {
            let normal = -DVec3::from_array(self.normal(triangle, Feature::Face));
            known &= inward.len() < FEW && normal != DVec3::ZERO;
            inward.push(normal);
            known
        });
        if known { directions_between(&inward).unwrap_or(anything) } else { anything }
    }
}

impl SignedDistance {
    /// Bounds over an unbounded box: outside and at least as far as the box is from the mesh's own.
    fn outside_bounds(&self, low: [f64; 3], high: [f64; 3]) -> Interval {
        let Some([least, most]) = self.tree().bounds() else {
            return Interval { low: f64::NEG_INFINITY, high: f64::NEG_INFINITY };
        };
        let gap =
            (0..3).map(|axis| (low[axis] - most[axis]).max(least[axis] - high[axis])).fold(0.0, f64::max);
        if gap > 0.0 { Interval { low: f64::NEG_INFINITY, high: -gap } } else { Interval::ENTIRE }
    }
}

impl Leaf for ContourDistance {
    fn value(&self, point: [f64; 3]) -> f64 {
        self.at([point[0], point[1]])
    }

    fn gradient(&self, point: [f64; 3]) -> (f64, [f64; 3]) {
        let (value, [dx, dy]) = self.gradient([point[0], point[1]]);
        (value, [dx, dy, 0.0])
    }

    fn bounds(&self, low: [f64; 3], high: [f64; 3]) -> Interval {
        let centre = centre(low, high);
        if centre[..2].iter().all(|x| x.is_finite()) {
            return lipschitz(self.at([centre[0], centre[1]]), low, high, 2);
        }
        let Some([least, most]) = self.bounds() else {
            return Interval { low: f64::NEG_INFINITY, high: f64::NEG_INFINITY };
        };
        let gap =
            (0..2).map(|axis| (low[axis] - most[axis]).max(least[axis] - high[axis])).fold(0.0, f64::max);
        if gap > 0.0 { Interval { low: f64::NEG_INFINITY, high: -gap } } else { Interval::ENTIRE }
    }

    fn gradient_bounds(&self, low: [f64; 3], high: [f64; 3]) -> [Interval; 3] {
        let anything = [Interval::new(-1.0, 1.0), Interval::new(-1.0, 1.0), Interval::new(0.0, 0.0)];
        let middle = centre(low, high);
        let half = (0..2).map(|axis| (high[axis] - middle[axis]).powi(2)).sum::<f64>().sqrt();
        let radius = (self.at([middle[0], middle[1]]).abs() + 2.0 * half) * (1.0 + 1e-9);
        let mut inward: SmallVec<[DVec3; FEW]> = SmallVec::new();
        let mut known = true;
        self.edges_near([middle[0], middle[1]], radius, |[x, y]| {
            known &= inward.len() < FEW && [x, y] != [0.0; 2];
            inward.push(DVec3::new(-x, -y, 0.0));
            known
        });
        match directions_between(&inward) {
            Some([x, y, _]) if known => [x, y, Interval::new(0.0, 0.0)],
            _ => anything,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_next_to_an_edge_are_bounded() {
        use rand::{RngExt, SeedableRng};
        let mut random = rand::rngs::ChaCha8Rng::seed_from_u64(17);
        for _ in 0..2000 {
            let mut direction = || {
                let mut x = || 2.0 * random.random::<f64>() - 1.0;
                (DVec3::new(x(), x(), x()) + DVec3::Z).normalize()
            };
            let all = [direction(), direction(), direction()];
            let Some(bounds) = directions_between(&all) else { continue };
            for _ in 0..20 {
                let between = all.iter().map(|d| *d * random.random::<f64>()).sum::<DVec3>().normalize();
                assert!((0..3).all(|k| bounds[k].contains(between[k])), "{all:?} {between} {bounds:?}");
            }
        }
        // The sharp edge of a blade: the gradient beside it lies in neither face's direction, nor in the box of both.
        assert!(directions_between(&[DVec3::Z, -DVec3::Z]).is_none());
        let exact = directions_between(&[DVec3::Z, DVec3::Z]).expect("one direction");
        assert!(exact[2].low > 1.0 - 1e-11 && exact[0].high < 1e-5);
        assert!(directions_between(&[]).is_none());
    }
}
