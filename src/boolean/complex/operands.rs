//! The two operands of a boolean in general position: their vertices under one numbering, and the one predicate every
//! decision is made with.
//!
//! Notation of this folder: operands are A (side 0) and B (side 1). A *corner* is a vertex of either with its number:
//! the vertices of A come first, then those of B, then points made on the way (ends of rays). `D(T; x)` is `orient3d` of
//! triangle T and point x; with T counter-clockwise seen from outside it is positive inside. All points are perturbed (see
//! [`crate::exact::perturbed`]): only A moves to first order, along its normals, outwards for a union and inwards for an
//! intersection or a difference, so that coincident faces resolve as regularised set operations want it. (Outwards for a
//! symmetric difference, where they are added up: see `walls`.)

use std::sync::OnceLock;
use std::sync::atomic::{AtomicU8, AtomicU64, Ordering};

use rustc_hash::FxHashSet;

use crate::boolean::complex::directions::Directions;
use crate::exact::perturbed::{self, PerturbedPoint, jitter};
use crate::exact::{FILTER_RANGE, PlaneFilter, Sign, orient3d_filter};

/// One operand: borrowed arrays.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Operand<'a> {
    pub(crate) positions: &'a [[f64; 3]],
    pub(crate) triangles: &'a [[u32; 3]],
}

/// A vertex: its number over both operands, and where it is.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Corner {
    pub(crate) id: u32,
    pub(crate) position: [f64; 3],
}

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

/// Both operands, and what decides ties between them.
#[derive(Debug)]
pub(crate) struct Operands<'a> {
    pub(crate) sides: [Operand<'a>; 2],
    /// Number of the first vertex of B.
    first_of_b: u32,
    /// +1: A swells; -1: A shrinks.
    sense: i32,
    /// Added to every filter's error bound: 0, or infinity where coordinates are so large that filters are unsound.
    filter_floor: f64,
    /// Triangles that may meet the other operand, by side (see `overlap`): what the directions are computed from.
    near: [Vec<u32>; 2],
    directions: OnceLock<Directions>,
    ties: AtomicU64,
    /// For small operands, by side: for each triangle on which side of it the other operand's vertices are, once known.
    known_sides: Option<[Vec<AtomicU8>; 2]>,
}

/// Up to so many vertices against triangles are remembered.
const REMEMBERED_SIDES: usize = 1 << 14;
const UNKNOWN: u8 = 0;
const INSIDE: u8 = 1;
const OUTSIDE: u8 = 2;

impl<'a> Operands<'a> {
    /// `near` lists the triangles of A and of B that may meet the other operand, with all those round such places.
    pub(crate) fn new(sides: [Operand<'a>; 2], sense: i32, largest: f64, near: [Vec<u32>; 2]) -> Self {
        let entries =
            [0, 1].map(|side| sides[side].triangles.len().saturating_mul(sides[1 - side].positions.len()));
        let table = |entries| std::iter::repeat_with(|| AtomicU8::new(UNKNOWN)).take(entries).collect();
        Self {
            known_sides: (entries[0].saturating_add(entries[1]) <= REMEMBERED_SIDES)
                .then(|| entries.map(table)),
            first_of_b: sides[0].positions.len() as u32,
            sides,
            sense,
            filter_floor: if largest <= FILTER_RANGE { 0.0 } else { f64::INFINITY },
            near,
            directions: OnceLock::new(),
            ties: AtomicU64::new(0),
        }
    }

    /// One operand to be tested against itself, shrunk: parts that touch separate.
    pub(crate) fn alone(operand: Operand<'a>, largest: f64) -> Self {
        let nothing = Operand { positions: &[], triangles: &[] };
        let all = (0..operand.triangles.len() as u32).collect();
        Self::new([operand, nothing], -1, largest, [all, Vec::new()])
    }

    /// Triangles of a side that may meet the other operand, ascending.
    pub(crate) fn near(&self, side: usize) -> &[u32] {
        &self.near[side]
    }

    /// The number of the first vertex of a side.
    pub(crate) fn first_vertex(&self, side: usize) -> u32 {
        if side == 0 { 0 } else { self.first_of_b }
    }

    /// The number after the last vertex of B.
    pub(crate) fn vertex_count(&self) -> u32 {
        self.first_of_b + self.sides[1].positions.len() as u32
    }

    /// Which side a vertex belongs to.
    pub(crate) fn side_of(&self, vertex: u32) -> usize {
        usize::from(vertex >= self.first_of_b)
    }

    /// Where a vertex is.
    pub(crate) fn position(&self, vertex: u32) -> &[f64; 3] {
        let side = self.side_of(vertex);
        &self.sides[side].positions[(vertex - self.first_vertex(side)) as usize]
    }

    /// A vertex by its number.
    pub(crate) fn corner(&self, vertex: u32) -> Corner {
        Corner { id: vertex, position: *self.position(vertex) }
    }

    /// The corners of a triangle.
    #[inline]
    pub(crate) fn corners(&self, side: usize, triangle: u32) -> [Corner; 3] {
        let operand = &self.sides[side];
        let first = self.first_vertex(side);
        let corner = |v: u32| Corner { id: first + v, position: operand.positions[v as usize] };
        let [u, v, w] = operand.triangles[triangle as usize];
        [corner(u), corner(v), corner(w)]
    }

    /// How many decisions plain positions left open.
    pub(crate) fn ties(&self) -> u64 {
        self.ties.load(Ordering::Relaxed)
    }

    /// Whether `D((a, b, c); d)` is positive. The four corners must be different.
    #[inline(always)]
    pub(crate) fn positive(&self, a: &Corner, b: &Corner, c: &Corner, d: &Corner) -> bool {
        let (determinant, bound) = orient3d_filter(&a.position, &b.position, &c.position, &d.position);
        if determinant.abs() > bound + self.filter_floor {
            determinant > 0.0
        } else {
            self.positive_exactly(a, b, c, d)
        }
    }

    /// [`positive`](Self::positive) for the corners of a plane and another.
    #[inline(always)]
    pub(crate) fn positive_of_plane(&self, plane: &Plane<'_>, d: &Corner) -> bool {
        let (determinant, bound) = plane.filter.determinant(&d.position);
        if determinant.abs() > bound + self.filter_floor {
            determinant > 0.0
        } else {
            let [a, b, c] = plane.corners;
            self.positive_exactly(a, b, c, d)
        }
    }

    /// Which of the other operand's vertices lie inside the plane of a triangle of `side`.
    #[inline]
    pub(crate) fn inside(
        &self,
        side: usize,
        triangle: u32,
        corners: &[Corner; 3],
        vertices: &[Corner; 3],
    ) -> [bool; 3] {
        let [a, b, c] = corners;
        let Some(known) = &self.known_sides else {
            let plane = Plane::new(a, b, c);
            let [u, v, w] = vertices;
            return [u, v, w].map(|vertex| self.positive_of_plane(&plane, vertex));
        };
        let (count, first) = (self.sides[1 - side].positions.len(), self.first_vertex(1 - side));
        [0, 1, 2].map(|i| {
            let entry = &known[side][triangle as usize * count + (vertices[i].id - first) as usize];
            match entry.load(Ordering::Relaxed) {
                UNKNOWN => {
                    let inside = self.positive(a, b, c, &vertices[i]);
                    entry.store(if inside { INSIDE } else { OUTSIDE }, Ordering::Relaxed);
                    inside
                }
                entry => entry == INSIDE,
            }
        })
    }

    #[cold]
    #[inline(never)]
    fn positive_exactly(&self, a: &Corner, b: &Corner, c: &Corner, d: &Corner) -> bool {
        match crate::exact::orient3d(&a.position, &b.position, &c.position, &d.position) {
            Sign::Positive => true,
            Sign::Negative => false,
            Sign::Zero => {
                self.ties.fetch_add(1, Ordering::Relaxed);
                let corners = [a, b, c, d];
                perturbed::linear_filter(
                    corners.map(|corner| &corner.position),
                    corners.map(|corner| self.first_direction(corner.id)),
                    |i| jitter(u64::from(corners[i].id)),
                )
                .unwrap_or_else(|| {
                    let points = corners.map(|corner| self.perturbed(corner));
                    perturbed::orient3d_of_tie_exact(points.each_ref())
                }) == Sign::Positive
            }
        }
    }

    /// Vertices of A that no direction moves away from all their faces, if directions were needed and there are such.
    pub(crate) fn vertices_without_direction(&self) -> Option<&FxHashSet<u32>> {
        self.directions.get().map(Directions::stuck).filter(|stuck| !stuck.is_empty())
    }

    /// The direction a vertex moves along to first order.
    #[inline]
    fn first_direction(&self, vertex: u32) -> [i32; 3] {
        if vertex >= self.first_of_b {
            return [0; 3];
        }
        let directions = self.directions.get_or_init(|| Directions::new(&self.sides[0], &self.near[0]));
        directions.of(vertex).map(|component| self.sense * component)
    }

    /// A corner with the directions it is perturbed along.
    pub(crate) fn perturbed(&self, corner: &Corner) -> PerturbedPoint {
        PerturbedPoint {
            position: corner.position,
            first: self.first_direction(corner.id),
            second: jitter(u64::from(corner.id)),
        }
    }
}
