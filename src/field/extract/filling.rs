//! The piece of surface inside one cell: triangles over a loop on the cell's boundary.
//!
//! A loop is a simple closed polygon on the boundary of a convex cell. The triangles from a point inside the cell to
//! its sides do not cross each other, and meet the cell's boundary in the loop alone; so do one triangle, or two
//! over four corners, if no diagonal or triangle lies in a face of the cell. This is what keeps the whole surface
//! free of self-crossings.

use glam::DVec3;

use super::solve::{Sample, deviation, distinct, is_sharp, least_step, meet, sample};
use crate::field::expression::{Scratch, Tape};

/// A corner of a loop.
#[derive(Clone, Copy, Debug)]
pub(super) struct Corner {
    pub(super) place: DVec3,
    /// Index of the vertex.
    pub(super) vertex: u32,
    /// Whether it is the kink of a line on a face, rather than a crossing of a lattice edge.
    pub(super) kink: bool,
}

/// Triangles over a loop: corners are positions in the loop, and the loop's length stands for the apex.
#[derive(Clone, Debug, Default)]
pub(super) struct Filling {
    pub(super) apex: Option<DVec3>,
    pub(super) triangles: Vec<[u32; 3]>,
}

/// The cell a filling is for.
#[derive(Clone, Copy)]
pub(super) struct Cell<'a> {
    pub(super) tape: &'a Tape,
    pub(super) low: DVec3,
    pub(super) high: DVec3,
    pub(super) tolerance: f64,
}

impl Cell<'_> {
    /// Triangles over the loop, facing the field's negative side.
    pub(super) fn fill(&self, corners: &[Corner], scratch: &mut Scratch) -> Filling {
        let flat = !corners.iter().any(|corner| corner.kink) && !self.share_face(corners);
        if flat && corners.len() == 3 {
            return Filling { apex: None, triangles: vec![[0, 1, 2]] };
        }
        if flat && corners.len() == 4 {
            let allowed = |a: usize, b: usize| !self.share_face(&[corners[a], corners[b]]);
            let middle = |a: usize, b: usize| (corners[a].place + corners[b].place) * 0.5;
            let ways = [([0, 2], [[0, 1, 2], [0, 2, 3]]), ([1, 3], [[1, 2, 3], [1, 3, 0]])];
            let best = ways
                .into_iter()
                .filter(|([a, b], _)| allowed(*a, *b))
                .map(|([a, b], triangles)| (deviation(self.tape, middle(a, b), scratch), triangles))
                .min_by(|a, b| a.0.total_cmp(&b.0));
            if let Some((_, triangles)) = best {
                return Filling { apex: None, triangles: triangles.to_vec() };
            }
        }
        let apex = self.apex(corners, scratch);
        let count = corners.len() as u32;
        let triangles = (0..count).map(|k| [k, (k + 1) % count, count]).collect();
        Filling { apex: Some(apex), triangles }
    }

    /// Whether all the corners lie in one face of the cell.
    fn share_face(&self, corners: &[Corner]) -> bool {
        (0..3).any(|axis| {
            [self.low[axis], self.high[axis]]
                .iter()
                .any(|&plane| corners.iter().all(|corner| corner.place[axis] == plane))
        })
    }

    /// A point inside the cell to span the loop from: on the crease or the corner that runs through the cell, if
    /// any, else on the surface near the middle of the loop.
    fn apex(&self, corners: &[Corner], scratch: &mut Scratch) -> DVec3 {
        let mean = corners.iter().map(|corner| corner.place).sum::<DVec3>() / corners.len() as f64;
        let size = (self.high - self.low).max_element();
        let samples: Vec<Sample> = corners
            .iter()
            .filter(|corner| !corner.kink)
            .map(|corner| sample(self.tape, corner.place, scratch))
            .collect();
        let smooth = self.projected(mean, scratch);
        if !is_sharp(&samples) {
            return smooth;
        }
        let planes: Vec<(DVec3, f64)> =
            samples.iter().map(|s| (s.normal, s.normal.dot(s.place - mean))).collect();
        let mut sharp = mean + least_step(&planes, 0.02);
        let branches = distinct(&samples);
        if branches.len() > 1 {
            let kinks: Vec<DVec3> = corners.iter().filter(|c| c.kink).map(|c| c.place).collect();
            // Two kinks are the ends of a crease, and its middle is a good start.
            let start =
                if kinks.len() == 2 && branches.len() == 2 { (kinks[0] + kinks[1]) * 0.5 } else { sharp };
            if let Some(met) = meet(self.tape, &branches, start, None, 2.0 * size, scratch) {
                sharp = met;
            }
        }
        let sharp = self.inside(sharp);
        let error = |apex: DVec3, scratch: &mut Scratch| self.fan_error(corners, apex, scratch);
        if error(sharp, scratch) <= error(smooth, scratch) { sharp } else { smooth }
    }

    /// The point moved into the cell, off its boundary.
    fn inside(&self, point: DVec3) -> DVec3 {
        let inset = (self.high - self.low) * 1e-5;
        point.clamp(self.low + inset, self.high - inset)
    }

    /// The point moved to the surface along the gradient.
    fn projected(&self, mut point: DVec3, scratch: &mut Scratch) -> DVec3 {
        for _ in 0..3 {
            let (value, gradient) = self.tape.gradient(point.to_array(), scratch);
            let squared = gradient.length_squared();
            if value == 0.0 || !(squared > 0.0) || !squared.is_finite() {
                break;
            }
            point = self.inside(point - gradient * (value / squared));
        }
        self.inside(point)
    }

    fn fan_error(&self, corners: &[Corner], apex: DVec3, scratch: &mut Scratch) -> f64 {
        let mut worst = deviation(self.tape, apex, scratch);
        for (k, corner) in corners.iter().enumerate() {
            let next = corners[(k + 1) % corners.len()];
            let centroid = (corner.place + next.place + apex) / 3.0;
            worst = worst.max(deviation(self.tape, centroid, scratch));
        }
        worst
    }

    /// The largest deviation found at the middles of the filling's triangles and edges.
    pub(super) fn error(&self, corners: &[Corner], filling: &Filling, scratch: &mut Scratch) -> f64 {
        let place = |k: u32| match corners.get(k as usize) {
            Some(corner) => corner.place,
            None => filling.apex.unwrap_or(corners[0].place),
        };
        let mut worst = 0f64;
        for triangle in &filling.triangles {
            let [a, b, c] = triangle.map(place);
            for point in [(a + b + c) / 3.0, (a + b) * 0.5, (b + c) * 0.5, (c + a) * 0.5] {
                worst = worst.max(deviation(self.tape, point, scratch));
                if worst > self.tolerance {
                    return worst;
                }
            }
        }
        worst
    }
}
