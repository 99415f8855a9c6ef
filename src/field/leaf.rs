//! Distances as leaves of expressions.

use glam::DVec3;

use super::expression::Leaf;
use super::interval::Interval;
use super::{ContourDistance, SignedDistance};

/// Bounds of a function that changes by at most 1 per unit of length, over a box, from its value at the centre.
fn lipschitz(value: f64, low: [f64; 3], high: [f64; 3], axes: usize) -> Interval {
    let half = (0..axes).map(|axis| (high[axis] * 0.5 - low[axis] * 0.5).powi(2)).sum::<f64>().sqrt();
    let slack = 1e-12 * (half + value.abs());
    Interval::new(value - half - slack, value + half + slack)
}

fn centre(low: [f64; 3], high: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|axis| low[axis] * 0.5 + high[axis] * 0.5)
}

/// More triangles than this near a box, and its gradient is taken to point anywhere.
const FEW: usize = 64;

impl Leaf for SignedDistance {
    fn value(&self, point: [f64; 3]) -> f64 {
        self.at(point)
    }

    fn gradient(&self, point: [f64; 3]) -> (f64, [f64; 3]) {
        self.measure(point)
            .map_or_else(|| (self.at(point), [0.0; 3]), |found| (found.distance, found.gradient))
    }

    fn bounds(&self, low: [f64; 3], high: [f64; 3]) -> Interval {
        let centre = centre(low, high);
        if centre.iter().all(|x| x.is_finite()) {
            lipschitz(self.at(centre), low, high, 3)
        } else {
            self.outside_bounds(low, high)
        }
    }

    fn gradient_bounds(&self, low: [f64; 3], high: [f64; 3]) -> [Interval; 3] {
        let anything = [Interval::new(-1.0, 1.0); 3];
        let middle = DVec3::from_array(centre(low, high));
        let Some(found) = self.tree().closest(middle.to_array()) else { return anything };
        let half = (DVec3::from_array(high) - middle).length();
        // Nearest points of the whole box lie within this ball: the distance grows by at most half, the query moves
        // by at most half.
        let radius = (found.squared_distance.sqrt() + 2.0 * half) * (1.0 + 1e-9);
        let mut count = 0;
        let mut hull: Option<[Interval; 3]> = None;
        self.tree().triangles_near(middle, radius, |triangle| {
            count += 1;
            if count <= FEW {
                let normal = self.normal(triangle, crate::spatial::Feature::Face);
                let inward = normal.map(|x| Interval::new(-x, -x));
                hull = Some(hull.map_or(inward, |all| std::array::from_fn(|k| all[k].hull(inward[k]))));
            }
        });
        match hull {
            Some(hull) if count <= FEW => hull,
            _ => anything,
        }
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
        let mut count = 0;
        let mut hull: Option<[Interval; 2]> = None;
        self.edges_near([middle[0], middle[1]], radius, |normal| {
            count += 1;
            if count <= FEW {
                let inward = normal.map(|x| Interval::new(-x, -x));
                hull = Some(hull.map_or(inward, |all| std::array::from_fn(|k| all[k].hull(inward[k]))));
            }
        });
        match hull {
            Some([x, y]) if count <= FEW => [x, y, Interval::new(0.0, 0.0)],
            _ => anything,
        }
    }
}
