//! Where surfaces of different operands are nearly flush: films, gaps and slivers that single precision does not hold.
//!
//! Exact contact leaves nothing behind. Where faces that were meant to be flush are a little apart, the exact result has a film
//! of material or a gap between them. It is right, but lost as soon as it is written in single precision, and hardly meant.

use glam::DVec3;

use crate::boolean::complex::planes::unit_normal;
use crate::boolean::result::origins::Origins;
use crate::exact::at_hand::largest_coordinate;
use crate::exact::{Projection, Sign, orient2d, orient3d};
use crate::mesh::Bounds;
use crate::parallel::{Runner, map_chunks};
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
        let mut operands: Vec<u32> = Vec::with_capacity(mesh.triangles.len());
        for (origin, count, _) in origins.stretches() {
            operands.resize(operands.len() + count as usize, origin.operand);
        }
        let Some(region) = Region::of(mesh, &operands) else { return Self::default() };
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

/// The boxes of what a result has of each of a few operands.
fn boxes_of(few: &[u32], mesh: &Mesh, operands: &[u32]) -> Vec<Bounds> {
    // Marked first at the vertices, whose positions are then read once and in order.
    let mut marks = vec![0u8; mesh.positions.len()];
    let mut t = 0;
    for run in operands.chunk_by(|one, next| one == next) {
        let mark = 1 << few.iter().position(|operand| *operand == run[0]).unwrap_or_default();
        for corners in &mesh.triangles[t..t + run.len()] {
            corners.iter().for_each(|&v| marks[v as usize] |= mark);
        }
        t += run.len();
    }
    let mut boxes = vec![Bounds::NOTHING; few.len()];
    for (&marks, position) in marks.iter().zip(&*mesh.positions) {
        let mut left = marks;
        while left != 0 {
            boxes[left.trailing_zeros() as usize].include(position);
            left &= left - 1;
        }
    }
    boxes
}

/// For each vertex which sides of a box it lies beyond by more than `reach`.
fn sides_beyond(of: &Bounds, reach: f64, mesh: &Mesh) -> Vec<u8> {
    map_chunks(&mesh.positions, CHUNK, |positions| {
        positions.iter().map(|position| of.sides_beyond(position, reach)).collect::<Vec<u8>>()
    })
    .concat()
}

/// The triangles of a result that may be near one of another operand.
struct Region<'a> {
    mesh: &'a Mesh,
    operands: &'a [u32],
    frame: Frame,
    /// What is no further apart is near, at the most.
    reach: f64,
    /// By operand.
    triangles: Vec<Vec<u32>>,
}

impl<'a> Region<'a> {
    /// `None` where no two operands come near one another.
    fn of(mesh: &'a Mesh, operands: &'a [u32]) -> Option<Self> {
        // 1. What is left of which operands, and where, if they are few.
        let mut used: Vec<u32> = operands.chunk_by(|one, next| one == next).map(|run| run[0]).collect();
        used.sort_unstable();
        used.dedup();
        if used.len() < 2 {
            return None;
        }
        let are_many = used.len() > FEW_OPERANDS;
        let boxes = if are_many { Vec::new() } else { boxes_of(&used, mesh, operands) };
        // 2. How near is near.
        let whole = boxes.iter().copied().reduce(Bounds::united).or_else(|| mesh.bounds())?;
        let extent = (0..3).fold(0.0f64, |extent, k| extent.max(0.5 * whole.high[k] - 0.5 * whole.low[k]));
        let reach = (SINGLE * whole.largest()).min(2.0 * PART_OF_REGION * extent);
        // 3. The triangles in reach of another's box, wholly beyond none of its sides. (Of many operands, each is near some other.)
        let sides: Vec<Vec<u8>> = boxes.iter().map(|of| sides_beyond(of, reach, mesh)).collect();
        let is_near = |t: usize| {
            let [a, b, c] = mesh.triangles[t].map(|v| v as usize);
            let is_in_reach = |sides: &Vec<u8>| sides[a] & sides[b] & sides[c] == 0;
            let mut others = used.iter().zip(&sides).filter(|(k, _)| **k != operands[t]);
            are_many || others.any(|(_, sides)| is_in_reach(sides))
        };
        let mut triangles = vec![Vec::new(); 1 + *used.last()? as usize];
        (0..mesh.triangles.len())
            .filter(|&t| is_near(t))
            .for_each(|t| triangles[operands[t] as usize].push(t as u32));
        let frame = Frame::of(whole.low, whole.high);
        Some(Self { mesh, operands, frame, reach, triangles })
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
        if filled.len() > FEW_OPERANDS {
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
        if self.operands[s as usize] == self.operands[t as usize] {
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
    use crate::{PlaneCut, Solid, exact::Plane, primitives};

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
            let outcome =
                crate::BooleanOptions::new().run(crate::Operation::Union, &boxes).expect("no limits");
            let told = outcome.certificate().nearly_flush.count;
            assert!(told >= 4 * (count as usize - 1), "{count}: {told}");
        }
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
