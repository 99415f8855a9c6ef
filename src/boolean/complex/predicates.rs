//! The one predicate every decision is made with: on which side of a plane a point lies, never on it.

use std::sync::atomic::{AtomicU8, AtomicU64, Ordering};

use super::decided::{Answer, Asker, remembered};
use super::ids::VertexId;
use super::{Complex, Corner};
use crate::exact::perturbed::{self, PerturbedPoint, jitter};
use crate::exact::{FILTER_RANGE, PlaneFilter, Sign, orient3d_filter};

/// The plane through three corners, for many points against it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Plane<'a> {
    corners: [&'a Corner; 3],
    filter: PlaneFilter,
}

impl<'a> Plane<'a> {
    #[inline(always)]
    pub(crate) fn new(a: &'a Corner, b: &'a Corner, c: &'a Corner) -> Self {
        Self { corners: [a, b, c], filter: PlaneFilter::new(&a.position, &b.position, &c.position) }
    }
}

/// Vertices that are perturbed.
pub(crate) trait Perturbed: Sync + std::fmt::Debug {
    /// The direction a vertex moves along to first order.
    fn first_direction(&self, vertex: VertexId) -> [i32; 3];

    /// The largest coordinate.
    fn largest_coordinate(&self) -> f64;

    /// How many there are: numbers from here on are free, and stand now for this point and now for that.
    fn vertex_count(&self) -> u32;

    /// A corner with the directions it is perturbed along.
    fn perturbed(&self, corner: &Corner) -> PerturbedPoint {
        PerturbedPoint {
            position: corner.position,
            first: self.first_direction(corner.id),
            second: jitter(u64::from(corner.id.number())),
        }
    }
}

/// What a step asks of a complex, and how often plain coordinates left the answer open.
#[derive(Debug)]
pub(crate) struct Predicates<'a> {
    complex: &'a dyn Perturbed,
    /// Added to every filter's error bound: 0, or infinity where coordinates are so large that filters are unsound.
    filter_floor: f64,
    ties: AtomicU64,
    asker: Asker,
    first_free: u32,
}

impl<'a> Predicates<'a> {
    pub(crate) fn new(complex: &'a dyn Perturbed) -> Self {
        let filter_floor = if complex.largest_coordinate() <= FILTER_RANGE { 0.0 } else { f64::INFINITY };
        let (asker, first_free) = (Asker::new(), complex.vertex_count());
        Self { complex, filter_floor, ties: AtomicU64::new(0), asker, first_free }
    }

    /// How many answers plain coordinates left open.
    pub(crate) fn into_contacts(self) -> u64 {
        self.ties.into_inner()
    }

    /// Whether `D((a, b, c); d)` is positive. The four corners must be different.
    #[inline(always)]
    pub(crate) fn is_positive(&self, a: &Corner, b: &Corner, c: &Corner, d: &Corner) -> bool {
        let (determinant, bound) = orient3d_filter(&a.position, &b.position, &c.position, &d.position);
        if determinant.abs() > bound + self.filter_floor {
            determinant > 0.0
        } else {
            self.count(self.decide(a, b, c, d))
        }
    }

    /// Whether a corner lies on the positive side of a plane, that is inside it.
    #[inline(always)]
    pub(crate) fn is_inside(&self, plane: &Plane<'_>, d: &Corner) -> bool {
        let (determinant, bound) = plane.filter.determinant(&d.position);
        if determinant.abs() > bound + self.filter_floor {
            determinant > 0.0
        } else {
            let [a, b, c] = plane.corners;
            self.count(self.decide(a, b, c, d))
        }
    }

    /// Whether plain coordinates alone tell that some corners lie on one side of a plane; false where they leave that open.
    pub(crate) fn are_plainly_on_one_side(&self, [a, b, c]: &[Corner; 3], corners: &[Corner]) -> bool {
        let filter = PlaneFilter::new(&a.position, &b.position, &c.position);
        let side = |corner: &Corner| {
            let (determinant, bound) = filter.determinant(&corner.position);
            (determinant.abs() > bound + self.filter_floor).then_some(determinant > 0.0)
        };
        let first = corners.first().and_then(side);
        first.is_some() && corners.iter().all(|corner| side(corner) == first)
    }

    /// Whether a line through a triangle's plane passes the triangle.
    pub(crate) fn passes(&self, p: &Corner, q: &Corner, [a, b, c]: &[Corner; 3]) -> bool {
        let first = self.is_positive(p, q, a, b);
        self.is_positive(p, q, b, c) == first && self.is_positive(p, q, c, a) == first
    }

    fn count(&self, answer: Answer) -> bool {
        if answer.is_tie {
            self.ties.fetch_add(1, Ordering::Relaxed);
        }
        answer.is_positive
    }

    /// Decides exactly, and by the perturbation where coordinates leave it open.
    #[cold]
    #[inline(never)]
    fn decide(&self, a: &Corner, b: &Corner, c: &Corner, d: &Corner) -> Answer {
        let corners = [a, b, c, d];
        let vertices = corners.map(|corner| corner.id);
        if vertices.iter().any(|vertex| vertex.number() >= self.first_free) {
            return self.decide_anew(corners);
        }
        remembered(self.asker, vertices, || self.decide_anew(corners))
    }

    fn decide_anew(&self, corners: [&Corner; 4]) -> Answer {
        let [a, b, c, d] = corners;
        let sign = crate::exact::orient3d(&a.position, &b.position, &c.position, &d.position);
        if sign != Sign::Zero {
            return Answer { is_positive: sign == Sign::Positive, is_tie: false };
        }
        let sign = perturbed::linear_filter(
            corners.map(|corner| &corner.position),
            corners.map(|corner| self.complex.first_direction(corner.id)),
            |i| jitter(u64::from(corners[i].id.number())),
        )
        .unwrap_or_else(|| {
            let points = corners.map(|corner| self.complex.perturbed(corner));
            perturbed::orient3d_of_tie_exact(points.each_ref())
        });
        Answer { is_positive: sign == Sign::Positive, is_tie: true }
    }
}

/// For small operands: for each triangle on which side of it the other operand's vertices lie, once known. Small meshes ask
/// this of every pair of a triangle and a vertex several times.
#[derive(Debug)]
pub(crate) struct KnownSides {
    /// By operand of the triangle: triangle by triangle, the other operand's vertices.
    tables: [Vec<AtomicU8>; 2],
    /// How many vertices the other operand has.
    vertices: [usize; 2],
    /// The number of its first one.
    first: [u32; 2],
}

const UNKNOWN: u8 = 0;
const INSIDE: u8 = 1;
const OUTSIDE: u8 = 2;

impl KnownSides {
    /// Most vertices against triangles that are remembered: a table of this many bytes fits the first-level cache.
    const MOST: usize = 1 << 14;

    /// A table, if the operands are small enough for one.
    pub(crate) fn new(complex: &Complex<'_>) -> Option<Self> {
        let vertices = [1, 0].map(|other| complex.operands[other].positions.len());
        let entries = [0, 1].map(|k| complex.operands[k].triangles.len().saturating_mul(vertices[k]));
        let table = |entries| std::iter::repeat_with(|| AtomicU8::new(UNKNOWN)).take(entries).collect();
        (entries[0].saturating_add(entries[1]) <= Self::MOST).then(|| Self {
            tables: entries.map(table),
            vertices,
            first: [1, 0].map(|other| complex.first_vertex(other)),
        })
    }

    /// Which of three vertices of the other operand lie inside the plane of a triangle.
    #[inline]
    pub(crate) fn inside(
        &self,
        predicates: &Predicates<'_>,
        operand: usize,
        triangle: u32,
        corners: &[Corner; 3],
        vertices: &[Corner; 3],
    ) -> [bool; 3] {
        let row = triangle as usize * self.vertices[operand];
        let [a, b, c] = corners;
        [0, 1, 2].map(|i| {
            let vertex = (vertices[i].id.number() - self.first[operand]) as usize;
            let entry = &self.tables[operand][row + vertex];
            let known = entry.load(Ordering::Relaxed);
            if known != UNKNOWN {
                return known == INSIDE;
            }
            let answer = predicates.decide_by_filter(a, b, c, &vertices[i]);
            // Counted by the first thread alone, so that the count does not depend on how many there are.
            let state = if answer.is_positive { INSIDE } else { OUTSIDE };
            if entry.swap(state, Ordering::Relaxed) == UNKNOWN {
                predicates.count(answer);
            }
            answer.is_positive
        })
    }
}

impl Predicates<'_> {
    fn decide_by_filter(&self, a: &Corner, b: &Corner, c: &Corner, d: &Corner) -> Answer {
        let (determinant, bound) = orient3d_filter(&a.position, &b.position, &c.position, &d.position);
        if determinant.abs() > bound + self.filter_floor {
            return Answer { is_positive: determinant > 0.0, is_tie: false };
        }
        self.decide(a, b, c, d)
    }
}
