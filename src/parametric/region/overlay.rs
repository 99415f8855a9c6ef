//! Exact booleans of polygons, by the integer engine of `i_overlay`.
//!
//! Coordinates are scaled by a power of two to 61-bit integers, combined there without rounding error in any
//! decision, and scaled back. A coordinate is carried exactly if its last bit is not below 2^-61 of the largest
//! coordinate, which holds for every coordinate of at least 1/256 of the largest; smaller ones move by at most
//! 2^-62 of the largest. Vertices of the operands come back bit for bit; crossing points are rounded twice, to the
//! grid and to `f64`. Should that second rounding make edges cross, the operation is done again on a grid whose
//! points are all `f64` numbers (2^-52 of the largest coordinate), so that a result never crosses itself.

use i_overlay::core::fill_rule::FillRule as EngineRule;
use i_overlay::core::overlay::{IntOverlayOptions, Overlay};
use i_overlay::core::overlay_rule::OverlayRule;
use i_overlay::i_float::int::point::IntPoint;
use rustc_hash::FxHashMap;

use super::polygons::Polygons;
use super::triangulate;
use crate::parametric::error::{GeometryError, Result, check_points};
use crate::parametric::numeric::vector::Point;

/// Which points crossing or nested contours enclose.
///
/// Decisions are exact on a grid of 2^-61 of the largest coordinate; vertices of the input keep their bits, new
/// crossing points are correct to one rounding of the coordinates, and results never cross themselves.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default)]
pub enum FillRule {
    /// Those enclosed an odd number of times (the parity rule of the papers, SVG's `evenodd`).
    #[default]
    EvenOdd,
    /// Those with a winding number other than zero (SVG's default).
    NonZero,
}

/// A regularised boolean operation on plane regions.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum RegionOperation {
    /// What is in either.
    Union,
    /// What is in both.
    Intersection,
    /// What is in the first and not in the second.
    Difference,
    /// What is in exactly one.
    SymmetricDifference,
}

type Shapes = Vec<Vec<Vec<Point<2>>>>;
type ContourSlices<'a> = Vec<&'a [Point<2>]>;

impl Polygons {
    /// The region that `contours` describe by `rule`, whatever their direction and crossings.
    ///
    /// # Errors
    /// [`GeometryError::NotFinite`], [`GeometryError::TooFewPoints`] for a contour of fewer than 3 points.
    pub fn new(contours: &[Vec<[f64; 2]>], rule: FillRule) -> Result<Self> {
        for contour in contours {
            check_points("contour", contour)?;
            if contour.len() < 3 {
                return Err(GeometryError::TooFewPoints { what: "contour", needed: 3, found: contour.len() });
            }
        }
        Ok(Self::trusted(normalised(contours, rule)))
    }

    /// This region and `other` combined; see [`RegionOperation`] and the notes on precision at
    /// [`FillRule`].
    #[must_use]
    pub fn combined(&self, operation: RegionOperation, other: &Self) -> Self {
        Self::trusted(combined(operation, self, other))
    }

    /// What is in either.
    #[must_use]
    pub fn union(&self, other: &Self) -> Self {
        self.combined(RegionOperation::Union, other)
    }

    /// What is in both.
    #[must_use]
    pub fn intersection(&self, other: &Self) -> Self {
        self.combined(RegionOperation::Intersection, other)
    }

    /// What is in this one and not in `other`.
    #[must_use]
    pub fn difference(&self, other: &Self) -> Self {
        self.combined(RegionOperation::Difference, other)
    }

    /// What is in exactly one.
    #[must_use]
    pub fn symmetric_difference(&self, other: &Self) -> Self {
        self.combined(RegionOperation::SymmetricDifference, other)
    }
}

/// The region that `contours` describe, as polygons with holes.
fn normalised(contours: &[Vec<Point<2>>], rule: FillRule) -> Shapes {
    let rule = match rule {
        FillRule::EvenOdd => EngineRule::EvenOdd,
        FillRule::NonZero => EngineRule::NonZero,
    };
    let contours: ContourSlices<'_> = contours.iter().map(Vec::as_slice).collect();
    overlay(&contours, &Vec::new(), OverlayRule::Subject, rule)
}

/// Two regions combined.
fn combined(operation: RegionOperation, a: &Polygons, b: &Polygons) -> Shapes {
    let rule = match operation {
        RegionOperation::Union => OverlayRule::Union,
        RegionOperation::Intersection => OverlayRule::Intersect,
        RegionOperation::Difference => OverlayRule::Difference,
        RegionOperation::SymmetricDifference => OverlayRule::Xor,
    };
    overlay(&a.contours().collect(), &b.contours().collect(), rule, EngineRule::EvenOdd)
}

/// Bits of the fine grid; the engine takes 62.
const FINE_BITS: i32 = 60;
/// Bits of the coarse grid, all of whose points are `f64` numbers.
const COARSE_BITS: i32 = 52;

fn overlay(
    subject: &ContourSlices<'_>,
    clip: &ContourSlices<'_>,
    operation: OverlayRule,
    rule: EngineRule,
) -> Shapes {
    let fine = IntegerGrid::new(subject, clip, FINE_BITS).combine(subject, clip, operation, rule);
    if triangulate::crossing(&Polygons::trusted(fine.clone())).is_none() {
        return fine;
    }
    IntegerGrid::new(subject, clip, COARSE_BITS).combine(subject, clip, operation, rule)
}

struct IntegerGrid {
    /// Powers of two whose product scales coordinates to integers; two, so that neither overflows.
    scale: [f64; 2],
    /// Whether grid points are `f64` numbers.
    coarse: bool,
}

impl IntegerGrid {
    fn new(subject: &ContourSlices<'_>, clip: &ContourSlices<'_>, bits: i32) -> Self {
        let coordinates = subject.iter().chain(clip).flat_map(|c| c.iter()).flatten();
        let largest = coordinates.fold(0.0_f64, |m, x| m.max(x.abs()));
        // 2^exponent > largest.
        let exponent = if largest > 0.0 { largest.log2().floor() as i32 + 1 } else { 0 };
        let shift = bits - exponent;
        let half = shift / 2;
        Self { scale: [power_of_two(half), power_of_two(shift - half)], coarse: bits == COARSE_BITS }
    }

    fn to_grid(&self, p: Point<2>) -> IntPoint<i64> {
        let [x, y] = p.map(|x| (x * self.scale[0] * self.scale[1]).round() as i64);
        IntPoint::new(x, y)
    }

    fn to_plane(&self, p: IntPoint<i64>) -> Point<2> {
        [p.x, p.y].map(|x| x as f64 / self.scale[0] / self.scale[1])
    }

    fn combine(
        &self,
        subject: &ContourSlices<'_>,
        clip: &ContourSlices<'_>,
        operation: OverlayRule,
        rule: EngineRule,
    ) -> Shapes {
        let grid = |contours: &ContourSlices<'_>| -> Vec<Vec<IntPoint<i64>>> {
            contours.iter().map(|c| c.iter().map(|p| self.to_grid(*p)).collect()).collect()
        };
        let (grid_subject, grid_clip) = (grid(subject), grid(clip));
        let mut originals: FxHashMap<[i64; 2], Point<2>> = FxHashMap::default();
        if !self.coarse {
            let points = subject.iter().chain(clip).flat_map(|c| c.iter());
            let grid_points = grid_subject.iter().chain(&grid_clip).flatten();
            for (point, on_grid) in points.zip(grid_points) {
                originals.entry([on_grid.x, on_grid.y]).or_insert(*point);
            }
        }
        let options = IntOverlayOptions::default();
        let shapes = Overlay::<i64>::from_subj_and_clip_custom(
            &grid_subject,
            &grid_clip,
            options,
            i_overlay::core::solver::Solver::default(),
        )
        .overlay(operation, rule);
        let back =
            |p: &IntPoint<i64>| originals.get(&[p.x, p.y]).copied().unwrap_or_else(|| self.to_plane(*p));
        shapes
            .iter()
            .map(|shape| shape.iter().map(|contour| contour.iter().map(back).collect()).collect())
            .collect()
    }
}

/// 2^exponent for exponents that `f64` can hold.
fn power_of_two(exponent: i32) -> f64 {
    2.0_f64.powi(exponent)
}
