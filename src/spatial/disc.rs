//! Flat discs around parts of a mesh: on a surface that bends little they bound far more tightly than boxes, whose
//! thickness is that of a tilted triangle. A query at the distance d opens the boxes within about the square root of
//! d times that thickness of the nearest point, but only the discs within the square root of d times the surface's
//! rise.

use glam::DVec3;

use super::wide::{Child, WideTree};
use super::{Frame, LANES};

/// Parts of more triangles than this have no disc: they are hardly ever flat.
const MOST: u32 = 512;
/// Room for the single-precision rounding of a disc, as a part of the sizes compared.
const SLACK: f64 = 1e-6;

/// All points no farther than `thickness` from the plane through `centre` with the normal `normal`, and no farther
/// than `radius` from its axis; in the frame of a hierarchy.
#[derive(Clone, Copy, Debug)]
pub(super) struct Disc {
    centre: [f32; 3],
    normal: [f32; 3],
    thickness: f32,
    radius: f32,
}

impl Disc {
    /// Round everything.
    const EVERYTHING: Self =
        Self { centre: [0.0; 3], normal: [0.0; 3], thickness: f32::INFINITY, radius: f32::INFINITY };

    /// Round the triangles with these corners.
    fn around(triangles: &[[DVec3; 3]]) -> Self {
        let area = triangles.iter().map(|[a, b, c]| (*b - *a).cross(*c - *a)).sum::<DVec3>();
        let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for &corner in triangles.as_flattened() {
            (low, high) = (low.min(corner), high.max(corner));
        }
        let stored = |v: DVec3| v.to_array().map(|x| x as f32);
        let mut disc = Self {
            centre: stored((low + high) * 0.5),
            normal: stored(area.normalize_or_zero()),
            thickness: 0.0,
            radius: 0.0,
        };
        for &corner in triangles.as_flattened() {
            let (along, squared) = disc.seen(corner);
            let aside = (squared * (1.0 + SLACK) - along * along).max(0.0).sqrt();
            let wider = |x: f64| ((x * (1.0 + SLACK) + 1e-12) as f32).next_up();
            disc.thickness = disc.thickness.max(wider(along.abs()));
            disc.radius = disc.radius.max(wider(aside));
        }
        disc
    }

    /// How far along the normal `point` is from the centre, and its squared distance.
    fn seen(&self, point: DVec3) -> (f64, f64) {
        let away = point - DVec3::from_array(self.centre.map(f64::from));
        (DVec3::from_array(self.normal.map(f64::from)).dot(away), away.length_squared())
    }

    /// No more than the squared distance of `point` from anything in the disc.
    pub(super) fn squared_distance(&self, point: DVec3) -> f64 {
        let (along, squared) = self.seen(point);
        let over = (along.abs() - f64::from(self.thickness)).max(0.0);
        let aside = (squared * (1.0 - SLACK) - along * along).max(0.0).sqrt() - f64::from(self.radius);
        let aside = aside.max(0.0);
        (over * over + aside * aside) * (1.0 - SLACK)
    }
}

/// A disc for every node of a tree over triangles.
pub(super) fn discs(tree: &WideTree, frame: &Frame, corners: impl Fn(u32) -> [DVec3; 3]) -> Vec<Disc> {
    // Children come after their parents.
    let mut counts = vec![0u32; tree.nodes.len()];
    for index in (0..tree.nodes.len()).rev() {
        counts[index] = (0..LANES)
            .map(|lane| match tree.nodes[index].child(lane) {
                Child::Node(child) => counts[child as usize],
                Child::Leaf(_) => 1,
                Child::None => 0,
            })
            .fold(0, u32::saturating_add);
    }
    let (mut triangles, mut pending) = (Vec::new(), Vec::new());
    let mut disc = |index: usize| {
        if counts[index] > MOST {
            return Disc::EVERYTHING;
        }
        triangles.clear();
        pending.push(index as u32);
        while let Some(node) = pending.pop() {
            for lane in 0..LANES {
                match tree.nodes[node as usize].child(lane) {
                    Child::Node(child) => pending.push(child),
                    Child::Leaf(leaf) => triangles.push(corners(leaf).map(|corner| frame.local(corner))),
                    Child::None => {}
                }
            }
        }
        Disc::around(&triangles)
    };
    (0..tree.nodes.len()).map(&mut disc).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn discs_are_never_farther_than_what_they_hold() {
        use rand::{RngExt, SeedableRng};
        let mut random = rand::rngs::ChaCha8Rng::seed_from_u64(5);
        let mut number = |size: f64| size * (2.0 * random.random::<f64>() - 1.0);
        for _ in 0..2000 {
            let flat = 10f64.powf(number(6.0) - 6.0);
            let triangles: Vec<[DVec3; 3]> = (0..5)
                .map(|_| [0; 3].map(|_| DVec3::new(number(0.1), number(0.1), 0.3 + number(0.1) * flat)))
                // All facing the same way, as on a surface.
                .map(|[a, b, c]| if (b - a).cross(c - a).z < 0.0 { [a, c, b] } else { [a, b, c] })
                .collect();
            let disc = Disc::around(&triangles);
            for _ in 0..20 {
                let point = DVec3::new(number(2.0), number(2.0), number(2.0));
                let bound = disc.squared_distance(point);
                for &corner in triangles.as_flattened() {
                    assert!(bound <= corner.distance_squared(point));
                }
            }
            // Tight where it matters: over the middle of a flat part.
            if flat < 1e-3 {
                let bound = disc.squared_distance(DVec3::new(0.0, 0.0, 1.0)).sqrt();
                assert!((bound - 0.7).abs() < 0.01, "{bound}");
            }
        }
    }
}
