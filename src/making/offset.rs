//! Offsets and shells, from the distance field.
//!
//! The offset of a solid by d is all that is nearer to it than d, or for a negative d all that is deeper inside than -d: a level set
//! of its signed distance. Outwards convex edges become round, inwards they stay sharp, and concave ones the other way.

use glam::DVec3;

use crate::field::{Expression, Extracted, Extraction, Graph, SignedDistance};
use crate::spatial::TriangleTree;
use crate::{BooleanOptions, Control, Error, Operation, Solid, primitives};

/// An offset, and how near it is to the true one.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Offset {
    /// The offset solid; empty if nothing is that deep inside.
    pub solid: Solid,
    /// The tolerance that was kept.
    pub tolerance: f64,
    /// The largest deviation that was found.
    pub deviation: f64,
    /// Degrees that the normals of 95 of a hundred triangles of the offset surface are within of the true ones.
    pub normal_deviation: f64,
}

/// A hole through the wall of a hollow body.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct Drain {
    /// A point; the hole goes in square at the place of the surface nearest to it.
    pub at: [f64; 3],
    /// The radius of the hole.
    pub radius: f64,
}

/// Of the distance: what tolerance an offset has that nobody gives one.
const TOLERANCE: f64 = 0.05;
/// Of the diagonal: the least tolerance that is taken unasked, below which a million triangles and more would come out.
const LEAST_TOLERANCE: f64 = 5e-4;
/// Of the diagonal: the largest distance outwards. Farther away the solid is a point to all that is computed, and beyond 1e19 the
/// single precision of its tree overflows.
const FARTHEST: f64 = 1e9;
/// Around a drain.
const SEGMENTS: u32 = 64;

/// How an offset is made; for its tolerance, limits, and where smoothing is not worth its time.
///
/// ```
/// use trisect::making::OffsetOptions;
/// use trisect::{Solid, primitives};
///
/// let cube = Solid::try_from(primitives::cuboid([0.0; 3], [4.0; 3])?)?;
/// let larger = OffsetOptions::new().tolerance(0.2).smooth(false).offset(&cube, 1.0)?;
/// assert!(larger.solid.volume() > 64.0 + 96.0);
/// # Ok::<(), trisect::Error>(())
/// ```
#[derive(Clone, Debug)]
#[must_use]
pub struct OffsetOptions {
    tolerance: Option<f64>,
    smooth: bool,
    control: Control,
}

impl Default for OffsetOptions {
    fn default() -> Self {
        Self::new()
    }
}

fn invalid<T>(what: impl Into<String>) -> Result<T, Error> {
    Err(Error::InvalidArgument(what.into()))
}

/// The solid grown by `distance`, or shrunk if it is negative, as a mesh within `tolerance` of the true offset (`None` for a
/// twentieth of the distance, but no less than 1/2000 of the diagonal). Every vertex is as far from the solid as asked for, to the
/// tolerance. Bodies that grow together become one, parts thinner than twice the distance vanish when it shrinks. The cost grows with
/// the surface over the squared tolerance.
///
/// ```
/// use trisect::{Control, Solid, making, primitives};
///
/// let cube = Solid::try_from(primitives::cuboid([0.0; 3], [4.0; 3])?)?;
/// let smaller = making::offset(&cube, -1.0, Some(0.1), &Control::new())?;
/// assert!((smaller.solid.volume() - 8.0).abs() < 0.1);
/// # Ok::<(), trisect::Error>(())
/// ```
///
/// # Errors
/// [`Error::InvalidArgument`] if the distance is zero, not finite or more than 1e9 times the diagonal, or the tolerance not positive; as
/// [`Extraction::run`](crate::field::Extraction::run).
pub fn offset(
    solid: &Solid,
    distance: f64,
    tolerance: Option<f64>,
    control: &Control,
) -> Result<Offset, Error> {
    OffsetOptions { tolerance, smooth: true, control: control.clone() }.offset(solid, distance)
}

fn extracted(solid: &Solid, distance: f64, options: &OffsetOptions) -> Result<Offset, Error> {
    let OffsetOptions { tolerance, smooth, control } = options;
    if distance == 0.0 || !distance.is_finite() {
        return invalid(format!("offset: the distance must be finite and not zero, not {distance}"));
    }
    let Some(bounds) = solid.bounds() else {
        return Ok(Offset {
            solid: Solid::empty(),
            tolerance: tolerance.unwrap_or_default(),
            deviation: 0.0,
            normal_deviation: 0.0,
        });
    };
    if distance > FARTHEST * bounds.diagonal() {
        return invalid(format!(
            "offset: a distance of {distance:e} is too large for a solid with a diagonal of {:e}: at most {FARTHEST:e} times as large",
            bounds.diagonal()
        ));
    }
    let usual = (distance.abs() * TOLERANCE).max(bounds.diagonal() * LEAST_TOLERANCE);
    let tolerance = tolerance.unwrap_or(usual);
    if !(tolerance > 0.0 && tolerance.is_finite()) {
        return invalid(format!("offset: the tolerance must be positive and finite, not {tolerance}"));
    }
    // 1. Positive inside, so that adding d moves the surface outwards.
    let mut graph = Graph::new();
    let leaf = graph.leaf(std::sync::Arc::new(SignedDistance::new(solid)));
    let by = graph.constant(distance);
    let root = graph.add(leaf, by);
    let field = Expression::new(graph, root);
    // 2. What is in the box, and some room around it.
    let room = distance.max(0.0) + 4.0 * tolerance;
    let (low, high) = (bounds.low.map(|x| x - room), bounds.high.map(|x| x + room));
    let Extracted { mesh, deviation, normal_deviation, .. } =
        Extraction::new(low, high, tolerance).smooth(*smooth).control(control.clone()).run(&field)?;
    Ok(Offset { solid: Solid::try_from(mesh)?, tolerance, deviation, normal_deviation })
}

/// The solid with a cavity that leaves a wall of thickness `wall`, and holes through it. Outside nothing changes: it is the exact
/// difference of the solid and its [`offset`] inwards, and of the drains. The wall is as thick as asked for within the tolerance, or
/// thicker where the body is too thin to be hollow.
///
/// ```
/// use trisect::making::{self, Drain};
/// use trisect::{Control, Solid, primitives};
///
/// let cube = Solid::try_from(primitives::cuboid([0.0; 3], [20.0; 3])?)?;
/// let drain = Drain { at: [10.0, 10.0, 0.0], radius: 2.0 };
/// let hollow = making::hollow(&cube, 2.0, &[drain], Some(0.2), &Control::new())?;
/// assert_eq!(hollow.solid.components(), 1);
/// assert!(hollow.solid.volume() < 8000.0 - 4000.0);
/// # Ok::<(), trisect::Error>(())
/// ```
///
/// # Errors
/// [`Error::InvalidArgument`] if the wall or a radius is not positive and finite, if the solid is nowhere thick enough to be
/// hollow, or if a drain does not reach the cavity; as [`offset`] and [`boolean`](crate::boolean).
pub fn hollow(
    solid: &Solid,
    wall: f64,
    drains: &[Drain],
    tolerance: Option<f64>,
    control: &Control,
) -> Result<Offset, Error> {
    OffsetOptions { tolerance, smooth: true, control: control.clone() }.hollow(solid, wall, drains)
}

fn hollowed(solid: &Solid, wall: f64, drains: &[Drain], offsetting: &OffsetOptions) -> Result<Offset, Error> {
    if !(wall > 0.0 && wall.is_finite()) {
        return invalid(format!("hollow: the wall must be positive and finite, not {wall}"));
    }
    let inner = offsetting.offset(solid, -wall)?;
    if inner.solid.is_empty() {
        return invalid(format!(
            "hollow: the solid is nowhere thicker than two walls of {wall}: there is no room inside"
        ));
    }
    let tree = TriangleTree::new(solid.mesh());
    let options = BooleanOptions::new().control(offsetting.control.clone());
    let mut hollow = options.run(Operation::Difference, [solid, &inner.solid])?.into_solid();
    for (number, drain) in (1..).zip(drains) {
        let hole = hole(&tree, drain, wall)?;
        if !inner.solid.distance(&hole).is_some_and(|found| found.distance == 0.0) {
            return invalid(format!(
                "hollow: drain {number} does not reach the cavity: the solid is too thin near {:?}; put it where it is thicker",
                drain.at
            ));
        }
        hollow = options.run(Operation::Difference, [&hollow, &hole])?.into_solid();
    }
    Ok(Offset { solid: hollow, ..inner })
}

/// The hole of a drain: a cylinder through the wall, square to the surface.
fn hole(tree: &TriangleTree, drain: &Drain, wall: f64) -> Result<Solid, Error> {
    let Drain { at, radius } = *drain;
    if !(radius > 0.0 && radius.is_finite()) || at.iter().any(|x| !x.is_finite()) {
        return invalid(format!(
            "hollow: a drain needs a point and a positive radius, not {at:?} and {radius}"
        ));
    }
    let nearest = tree.closest(at).and_then(|found| Some((found.point, tree.corners(found.triangle)?)));
    let Some((point, [a, b, c])) = nearest else { return invalid("hollow: a solid without a surface") };
    let outwards = (b - a).cross(c - a).normalize_or_zero();
    let from = DVec3::from_array(point);
    // 1. From well outside, also of a hollow place, to half a wall behind the wall.
    let (out, into) = (wall + radius, 1.5 * wall);
    let upright = primitives::cylinder(radius, out + into, SEGMENTS)?;
    // 2. From z = 0 inside to z = out + into outside.
    let start = from - outwards * into;
    let (x, y) = outwards.any_orthonormal_pair();
    let row = |k: usize| [x[k], y[k], outwards[k], start[k]];
    let placed = upright.transformed([row(0), row(1), row(2)].as_flattened())?;
    Ok(Solid::try_from(placed)?)
}

impl OffsetOptions {
    /// The tolerance of [`offset`] where none is given, a smooth surface, no limits.
    pub fn new() -> Self {
        Self { tolerance: None, smooth: true, control: Control::new() }
    }

    /// How far the surface may be from the true one, in units of the coordinates.
    pub fn tolerance(mut self, tolerance: f64) -> Self {
        self.tolerance = Some(tolerance);
        self
    }

    /// Whether the surface is made smooth (default). See [`Extraction::smooth`](crate::field::Extraction::smooth).
    pub fn smooth(mut self, smooth: bool) -> Self {
        self.smooth = smooth;
        self
    }

    /// Limits and progress.
    pub fn control(mut self, control: Control) -> Self {
        self.control = control;
        self
    }

    /// The solid grown by `distance`, or shrunk if it is negative: as [`offset`].
    ///
    /// # Errors
    /// As [`offset`].
    pub fn offset(&self, solid: &Solid, distance: f64) -> Result<Offset, Error> {
        extracted(solid, distance, self)
    }

    /// The solid with a wall of thickness `wall` and drain holes: as [`hollow`].
    ///
    /// # Errors
    /// As [`hollow`].
    pub fn hollow(&self, solid: &Solid, wall: f64, drains: &[Drain]) -> Result<Offset, Error> {
        hollowed(solid, wall, drains, self)
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;
    use crate::Mesh;

    fn solid(mesh: Mesh) -> Solid {
        Solid::try_from(mesh).unwrap()
    }

    #[test]
    fn growing_convex_bodies_follows_steiner() {
        // V + A d + M d^2 + 4/3 pi d^3, with M half the sum of edge lengths times outer angles.
        let [a, b, c] = [3.0, 2.0, 1.5];
        let block = solid(primitives::cuboid([0.0; 3], [a, b, c]).unwrap());
        let (d, tolerance) = (0.5, 0.08);
        let grown = offset(&block, d, Some(tolerance), &Control::new()).unwrap();
        let area = 2.0 * (a * b + b * c + c * a);
        let wanted = a * b * c + area * d + PI * (a + b + c) * d * d + 4.0 / 3.0 * PI * d.powi(3);
        assert!(
            (grown.solid.volume() - wanted).abs() < grown.solid.area() * tolerance,
            "{}",
            grown.solid.volume()
        );
        assert!(grown.deviation <= tolerance && grown.solid.is_manifold());
        let distance = SignedDistance::new(&block);
        for vertex in &grown.solid.mesh().positions {
            assert!((distance.at(*vertex) + d).abs() <= tolerance, "{vertex:?}");
        }
    }

    #[test]
    fn shrinking_keeps_edges_sharp_and_ends_in_nothing() {
        let cube = solid(primitives::cuboid([0.0; 3], [4.0; 3]).unwrap());
        let smaller = offset(&cube, -0.5, Some(0.1), &Control::new()).unwrap().solid;
        let bounds = smaller.bounds().unwrap();
        assert!((0..3).all(|k| (bounds.low[k] - 0.5).abs() < 0.1 && (bounds.high[k] - 3.5).abs() < 0.1));
        assert!((smaller.volume() - 27.0).abs() < 0.1 * 54.0, "{}", smaller.volume());
        assert!(offset(&cube, -2.5, Some(0.2), &Control::new()).unwrap().solid.is_empty());
        assert!(offset(&cube, 0.0, None, &Control::new()).is_err());
        assert!(offset(&cube, 1e160, None, &Control::new()).unwrap_err().to_string().contains("too large"));
        assert!(offset(&cube, 1.0, Some(-1.0), &Control::new()).is_err());
    }

    #[test]
    fn hollow_bodies_have_walls_as_thick_as_asked_for() {
        let can = solid(primitives::cylinder(5.0, 12.0, 32).unwrap());
        let (wall, tolerance) = (1.0, 0.2);
        let closed = hollow(&can, wall, &[], Some(tolerance), &Control::new()).unwrap().solid;
        assert_eq!(closed.components(), 2);
        let drain = Drain { at: [0.0, 0.0, -3.0], radius: 0.8 };
        let hollow = hollow(&can, wall, &[drain], Some(tolerance), &Control::new()).unwrap().solid;
        assert!(hollow.is_manifold());
        assert_eq!((hollow.components(), hollow.genus()), (1, Some(0)));
        // Away from edges and from the drain.
        let tree = TriangleTree::new(hollow.mesh());
        for point in [[5.0, 0.0, 6.0], [0.0, -5.0, 4.0], [0.0, 0.0, 12.0], [3.0, 0.0, 0.0]] {
            let found = tree.thickness(point).unwrap().thickness;
            assert!((found - wall).abs() <= 2.0 * tolerance, "{point:?}: {found}");
        }
    }

    #[test]
    fn there_must_be_room() {
        let plate = solid(primitives::cuboid([0.0; 3], [20.0, 20.0, 1.0]).unwrap());
        let said = |result: Result<Offset, Error>| result.unwrap_err().to_string();
        assert!(said(hollow(&plate, 0.6, &[], Some(0.1), &Control::new())).contains("no room"));
        assert!(said(hollow(&plate, f64::NAN, &[], None, &Control::new())).contains("wall"));
        let block = solid(primitives::cuboid([0.0; 3], [10.0; 3]).unwrap());
        let fin = solid(primitives::cuboid([10.0, 4.5, 0.0], [20.0, 5.5, 10.0]).unwrap());
        let both = block.union(&fin).unwrap().into_solid();
        let drain = Drain { at: [19.0, 5.5, 5.0], radius: 0.5 };
        assert!(said(hollow(&both, 1.0, &[drain], Some(0.2), &Control::new())).contains("does not reach"));
    }
}
