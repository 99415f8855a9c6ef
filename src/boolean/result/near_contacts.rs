//! Where surfaces of different operands are nearly flush: films, gaps and slivers that single precision does not hold.
//!
//! Exact contact leaves nothing behind. Where faces that were meant to be flush are a little apart, the exact result has a film
//! of material or a gap between them. It is right, but lost as soon as it is written in single precision, and hardly meant.

use std::ops::Range;

use glam::DVec3;

use crate::boolean::complex::planes::unit_normal;
use crate::boolean::result::origins::Origins;
use crate::exact::at_hand::largest_coordinate;
use crate::exact::{Projection, Sign, orient2d, orient3d};
use crate::mesh::Bounds;
use crate::parallel::{Runner, build};
use crate::spatial::{BoxTree, Frame, visit_pairs};
use crate::{Control, Mesh};

/// What is thinner than this part of a coordinate has no thickness in single precision: the distance of neighbouring numbers.
const SINGLE: f64 = f32::EPSILON as f64;
/// Nothing thicker than this part of the region where operands meet is a film, however far from the origin it lies.
const PART_OF_REGION: f64 = 1e-6;
/// Faces at no larger angle than this, in radians, are nearly parallel: others meet along a curve, and are near it there.
const ANGLE: f64 = 1e-3;
/// Operands up to which each has a tree of its own, and a bit in a byte of marks; more are in one tree, where pairs within an operand are found for nothing.
const FEW_OPERANDS: usize = 8;
/// The thinnest places that are kept: enough to look at, and to print.
const PLACES: usize = 5;

/// A corner of the result that is nearly on a face of another operand.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct NearContact {
    /// Where the corner is.
    pub place: [f64; 3],
    /// How far from the face, in units of the coordinates; more than 0.
    pub distance: f64,
    /// A triangle of the result at the corner, and the one it is near to.
    pub triangles: [u32; 2],
}

/// Where operands are nearly flush in a result: corners that lie over or under a nearly parallel face of another operand, closer
/// than neighbouring numbers of single precision are at these coordinates (1.2e-7 of the largest), but not on it.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct NearContacts {
    /// How many corners.
    pub count: usize,
    /// The nearest few.
    pub places: Vec<NearContact>,
}

impl NearContacts {
    /// Of a result with the origins of its triangles. O(n) to find out where the parts of the operands are, O(k log k) for the k
    /// triangles where they may be near one another.
    pub(crate) fn find(mesh: &Mesh, origins: &Origins) -> Self {
        Self::find_with(mesh, origins, FEW_OPERANDS)
    }

    /// The same, where more operands than so many are many.
    fn find_with(mesh: &Mesh, origins: &Origins, most: usize) -> Self {
        let Some(region) = Region::of(mesh, &runs_of(origins), most) else { return Self::default() };
        let mut found = region.pairs().unwrap_or_default();
        // One for each corner, the nearest.
        found.sort_by(|x, y| {
            x.0.cmp(&y.0).then(x.1.distance.total_cmp(&y.1.distance)).then(x.1.triangles.cmp(&y.1.triangles))
        });
        found.dedup_by_key(|entry| entry.0);
        found.sort_by(|x, y| x.1.distance.total_cmp(&y.1.distance).then(x.0.cmp(&y.0)));
        let places = found.iter().take(PLACES).map(|entry| entry.1).collect();
        Self { count: found.len(), places }
    }
}

/// A vertex, and what it is near to.
type Found = (u32, NearContact);

/// Vertices a piece of work.
const CHUNK: usize = 1 << 14;

/// Triangles of a result that follow each other and are of one operand.
struct Run {
    operand: u32,
    triangles: Range<usize>,
}

fn runs_of(origins: &Origins) -> Vec<Run> {
    let mut end = 0;
    let run = |(operand, count)| {
        end += count;
        Run { operand, triangles: end - count..end }
    };
    origins.operands().into_iter().map(run).collect()
}

/// What a result has of a few operands.
struct Few {
    /// For each vertex which of them have it, a bit each.
    marks: Vec<u8>,
    /// The boxes of their triangles.
    boxes: Vec<Bounds>,
}

impl Few {
    /// Of operands in ascending order.
    fn of(operands: &[u32], mesh: &Mesh, runs: &[Run]) -> Self {
        // Marked first at the vertices, whose positions are then read once and in order.
        let mut marks = vec![0u8; mesh.positions.len()];
        for run in runs {
            let mark = 1 << operands.binary_search(&run.operand).unwrap_or_default();
            for corners in &mesh.triangles[run.triangles.clone()] {
                corners.iter().for_each(|&v| marks[v as usize] |= mark);
            }
        }
        let mut boxes = vec![Bounds::NOTHING; operands.len()];
        for (marks, positions) in marks.chunk_by(|x, y| x == y).scan(0, |end, marks| {
            *end += marks.len();
            Some((marks[0], &mesh.positions[*end - marks.len()..*end]))
        }) {
            let of_run = positions.iter().fold(Bounds::NOTHING, |mut bounds, position| {
                bounds.include(position);
                bounds
            });
            let of_them = boxes.iter_mut().enumerate().filter(|(k, _)| marks >> k & 1 == 1);
            of_them.for_each(|(_, bounds)| *bounds = bounds.united(of_run));
        }
        Self { marks, boxes }
    }

    /// For each vertex of others which sides of the box of one it lies beyond by more than `reach`.
    fn sides_beyond(&self, k: usize, reach: f64, mesh: &Mesh) -> Vec<u8> {
        let (bounds, others) = (self.boxes[k].grown(reach), !(1 << k));
        build(mesh.positions.len(), CHUNK, |first, sides: &mut [u8]| {
            let given = self.marks[first..].iter().zip(&mesh.positions[first..]);
            for (sides, (marks, position)) in sides.iter_mut().zip(given) {
                if marks & others != 0 {
                    *sides = bounds.sides_beyond(position);
                }
            }
        })
    }
}

/// The triangles of a result that may be near one of another operand.
struct Region<'a> {
    mesh: &'a Mesh,
    /// The operand of each triangle, if there are many.
    operands: Vec<u32>,
    frame: Frame,
    /// What is no further apart is near, at the most.
    reach: f64,
    /// By operand, if there are few.
    triangles: Vec<Vec<u32>>,
}

impl<'a> Region<'a> {
    /// `None` where no two operands come near one another.
    fn of(mesh: &'a Mesh, runs: &[Run], most: usize) -> Option<Self> {
        // 1. What is left of which operands, and where, if they are few.
        let mut used: Vec<u32> = runs.iter().map(|run| run.operand).collect();
        used.sort_unstable();
        used.dedup();
        if used.len() < 2 {
            return None;
        }
        let few = (used.len() <= most).then(|| Few::of(&used, mesh, runs));
        // 2. How near is near.
        let boxes = few.iter().flat_map(|few| few.boxes.iter().copied());
        let whole = boxes.reduce(Bounds::united).or_else(|| mesh.bounds())?;
        let extent = (0..3).fold(0.0f64, |extent, k| extent.max(0.5 * whole.high[k] - 0.5 * whole.low[k]));
        let reach = (SINGLE * whole.largest()).min(2.0 * PART_OF_REGION * extent);
        let frame = Frame::of(whole.low, whole.high);
        // 3. The triangles in reach of another's box, wholly beyond none of its sides. (Of many operands, each is near some other.)
        let Some(few) = few else {
            let operands = runs.iter().flat_map(|run| run.triangles.clone().map(|_| run.operand)).collect();
            let all = (0..mesh.triangles.len() as u32).collect();
            return Some(Self { mesh, operands, frame, reach, triangles: vec![all] });
        };
        let sides: Vec<Vec<u8>> = (0..used.len()).map(|k| few.sides_beyond(k, reach, mesh)).collect();
        let mut triangles = vec![Vec::new(); used.len()];
        for run in runs {
            let own = used.binary_search(&run.operand).unwrap_or_default();
            let others: Vec<&[u8]> =
                sides.iter().enumerate().filter(|(k, _)| *k != own).map(|(_, sides)| &**sides).collect();
            let is_near = |t: &usize| {
                let [a, b, c] = mesh.triangles[*t].map(|v| v as usize);
                others.iter().any(|sides| sides[a] & sides[b] & sides[c] == 0)
            };
            triangles[own].extend(run.triangles.clone().filter(is_near).map(|t| t as u32));
        }
        Some(Self { mesh, operands: Vec::new(), frame, reach, triangles })
    }

    fn pairs(mut self) -> Result<Vec<Found>, crate::control::Limit> {
        let control = Control::default();
        let runner = Runner::new(&control, true);
        let lists = std::mem::take(&mut self.triangles);
        let filled: Vec<Vec<u32>> = lists.into_iter().filter(|list| !list.is_empty()).collect();
        // Boxes are rounded to single precision, and grown by all that is near.
        let margin = (self.reach * self.frame.scale()) as f32 + 4.0 * f32::EPSILON;
        let box_of = |t: u32| {
            let mut of_triangle = self.frame.triangle(self.corners(t).each_ref());
            of_triangle.min -= margin;
            of_triangle.max += margin;
            of_triangle
        };
        let tree = |triangles: &[u32]| BoxTree::new(triangles, box_of);
        let examine = |pairs: &[[u32; 2]], found: &mut Vec<Found>| {
            pairs.iter().for_each(|&pair| self.examine(pair, found));
        };
        if !self.operands.is_empty() {
            let all = tree(&filled.concat());
            return visit_pairs(&all, &all, runner, examine);
        }
        let trees: Vec<BoxTree> = filled.iter().map(|list| tree(list)).collect();
        let mut found = Vec::new();
        for (k, one) in trees.iter().enumerate() {
            for other in &trees[k + 1..] {
                found.extend(visit_pairs(one, other, runner, examine)?);
            }
        }
        Ok(found)
    }

    fn corners(&self, t: u32) -> [[f64; 3]; 3] {
        self.mesh.triangles[t as usize].map(|v| self.mesh.positions[v as usize])
    }

    /// The corners of each of two triangles that are nearly on the other.
    fn examine(&self, [s, t]: [u32; 2], found: &mut Vec<Found>) {
        // (Those of few operands are never of one.)
        if !self.operands.is_empty() && self.operands[s as usize] == self.operands[t as usize] {
            return;
        }
        let (of_s, of_t) = (self.corners(s), self.corners(t));
        let (Some(n), Some(m)) = (unit_normal(&of_s), unit_normal(&of_t)) else { return };
        if n.cross(m).length_squared() > ANGLE * ANGLE {
            return;
        }
        for (own, other, normal, triangles) in [(s, &of_t, m, [s, t]), (t, &of_s, n, [t, s])] {
            let [_, near] = triangles;
            for v in self.mesh.triangles[own as usize] {
                if !self.mesh.triangles[near as usize].contains(&v)
                    && let Some(distance) = self.height(&self.mesh.positions[v as usize], other, normal)
                {
                    let place = self.mesh.positions[v as usize];
                    found.push((v, NearContact { place, distance, triangles }));
                }
            }
        }
    }

    /// How far a point is over or under a triangle, if it is near and not on it.
    fn height(&self, point: &[f64; 3], triangle: &[[f64; 3]; 3], normal: DVec3) -> Option<f64> {
        let [a, b, c] = triangle;
        let distance = (DVec3::from_array(*point) - DVec3::from_array(*a)).dot(normal).abs();
        if distance > self.reach.min(SINGLE * largest_coordinate(point)) {
            return None;
        }
        let seen = Projection::of(triangle);
        let (x, [p, q, r]) = (seen.project(point), triangle.map(|corner| seen.project(&corner)));
        let is_over = [(p, q), (q, r), (r, p)].iter().all(|&(u, v)| orient2d(u, v, x) != Sign::Negative);
        (is_over && orient3d(a, b, c, point) != Sign::Zero).then_some(distance)
    }
}

#[cfg(test)]
mod tests {
    use rand::rngs::ChaCha8Rng;
    use rand::{RngExt, SeedableRng};

    use super::*;
    use crate::{BooleanOptions, Operation, PlaneCut, Solid, exact::Plane, primitives};

    fn cuboid(low: [f64; 3], high: [f64; 3]) -> Solid {
        Solid::try_from(primitives::cuboid(low, high).expect("a box")).expect("closed")
    }

    #[test]
    fn a_film_is_told_with_its_place_and_thickness() {
        let body = cuboid([0.0; 3], [1.0; 3]);
        for gap in [1e-9, 1e-12, f64::EPSILON] {
            let tool = cuboid([0.25, 0.25, 0.0], [0.75, 0.75, 1.0 - gap]);
            let outcome = body.difference(&tool).expect("no limits");
            let near = &outcome.certificate().nearly_flush;
            assert_eq!(near.count, 4, "{gap}: {near:?}");
            assert!((near.places[0].distance - gap).abs() < 1e-16, "{near:?}");
            assert!((near.places[0].place[2] - 1.0).abs() <= gap);
            // A gap between two bodies.
            let beside = cuboid([1.0 + gap, 0.25, 0.25], [2.0, 0.75, 0.75]);
            let outcome = body.union(&beside).expect("no limits");
            assert_eq!(outcome.certificate().nearly_flush.count, 4);
        }
    }

    #[test]
    fn gaps_between_any_number_of_operands_are_told() {
        for count in [2, 8, 9, 20] {
            // A row of boxes that nearly touch: each but the last has four corners nearly on the face of the next. Of one inside the first
            // nothing is left.
            let row = (0..count).map(|i| {
                let x = f64::from(i) * (1.0 + 1e-9);
                cuboid([x, 0.0, 0.0], [x + 1.0, 1.0 + 0.1 * f64::from(i), 1.0 + 0.1 * f64::from(i)])
            });
            let mut boxes: Vec<Solid> = row.collect();
            boxes.insert(1, cuboid([0.25; 3], [0.5; 3]));
            let outcome = BooleanOptions::new().run(Operation::Union, &boxes).expect("no limits");
            let told = outcome.certificate().nearly_flush.count;
            assert!(told >= 4 * (count as usize - 1), "{count}: {told}");
        }
    }

    #[test]
    fn few_operands_are_told_what_all_triangles_with_one_another_tell() {
        let mut random = ChaCha8Rng::seed_from_u64(36);
        let mut all = 0;
        for round in 0..60 {
            // Boxes and balls whose faces are often apart by 1e-9, in results of results, so that operands alternate in their triangles.
            let mut place = || [0; 3].map(|_| f64::from(random.random_range(0..4)) * (0.5 + 1e-9));
            let mut bodies: Vec<Solid> = (0..4)
                .map(|_| {
                    let low = place();
                    cuboid(low, low.map(|x| x + 1.0))
                })
                .collect();
            if round % 3 == 0 {
                let ball = primitives::icosphere(0.7, 2).expect("a ball").translated(place());
                bodies.push(Solid::try_from(ball).expect("closed"));
            }
            let operation =
                [Operation::Union, Operation::SymmetricDifference, Operation::Difference][round % 3];
            let outcome = BooleanOptions::new().run(operation, &bodies).expect("no limits");
            let mesh = outcome.solid().mesh();
            let origins: Origins = outcome.origins().iter().copied().collect();
            let few = NearContacts::find_with(mesh, &origins, FEW_OPERANDS);
            assert_eq!(few, NearContacts::find_with(mesh, &origins, 0), "{round}");
            all += few.count;
        }
        assert!(all > 200, "{all}");
    }

    #[test]
    fn a_slot_nearly_through_a_side_is_told() {
        // No corner of either lies over the other's face, but for those of the cut.
        let body = cuboid([0.0; 3], [1.0; 3]);
        let slot = cuboid([-1.0, 0.25, -1.0], [2.0, 0.75, 1.0 - 1e-9]);
        let near = body.difference(&slot).expect("no limits").certificate().nearly_flush.clone();
        assert_eq!(near.count, 4, "{near:?}");
    }

    #[test]
    fn a_cut_of_a_result_is_told_of_the_operands_of_that() {
        let (body, beside) =
            (cuboid([0.0; 3], [1.0; 3]), cuboid([1.0 + 1e-9, 0.25, 0.25], [2.0, 0.75, 0.75]));
        let both = body.union(&beside).expect("no limits");
        let plane = Plane::new([0.0, 1.0, 0.0], 0.5).expect("a plane");
        let half = PlaneCut::new(plane).below(both.solid()).expect("no limits");
        assert_eq!(half.nearly_flush().count, 0);
        assert_eq!(half.after(&both, 2).nearly_flush().count, 4);
    }

    #[test]
    fn what_is_flush_or_thick_is_not_told() {
        let body = cuboid([0.0; 3], [1.0; 3]);
        for tool in [
            cuboid([0.25, 0.25, 0.0], [0.75, 0.75, 1.0]),
            cuboid([0.25, 0.25, 0.0], [0.75, 0.75, 1.0 - 1e-6]),
            cuboid([0.0; 3], [1.0, 1.0, 0.5]),
        ] {
            for outcome in [body.difference(&tool), body.union(&tool), body.symmetric_difference(&tool)] {
                assert_eq!(outcome.expect("no limits").certificate().nearly_flush.count, 0);
            }
        }
        // Far from the origin single precision holds little, but a body is no film.
        let by = [1e12, 0.0, 0.0];
        let [a, b] = [[0.0; 3], [0.5; 3]].map(|at| {
            let mesh = primitives::cuboid(at, at.map(|x| x + 1.0)).expect("a box").translated(by);
            Solid::try_from(mesh).expect("closed")
        });
        assert_eq!(a.union(&b).expect("no limits").certificate().nearly_flush.count, 0);
        // Balls that meet at a flat angle, and everywhere else.
        let ball = primitives::geodesic_sphere(1.0, 12).expect("a ball");
        for offset in [0.01, 0.5, 1.9] {
            let [a, b] = [0.0, offset]
                .map(|x| Solid::try_from(ball.clone().translated([x, 0.0, 0.0])).expect("closed"));
            assert_eq!(a.union(&b).expect("no limits").certificate().nearly_flush.count, 0, "{offset}");
        }
    }
}
