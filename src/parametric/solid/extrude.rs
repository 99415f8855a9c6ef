//! Solids by moving a plane region along z, turning and shrinking it on the way.

use crate::Mesh;
use crate::parametric::curve::arc::cos_sin;
use crate::parametric::error::{GeometryError, Result, check_points, check_positive};
use crate::parametric::numeric::vector::{self, Point};
use crate::parametric::region::polygons::Polygons;
use crate::parametric::region::triangulate::PlaneMesh;

/// Settings of an extrusion: a region of the plane z = 0 moved to z = `height`.
///
/// ```
/// use trisect::parametric::{Extrusion, Polygons};
///
/// let square = Polygons::rectangle([0.0, 0.0], [1.0, 1.0])?;
/// let block = Extrusion::new(2.0).mesh(&square)?;
/// assert_eq!((block.positions.len(), block.triangles.len()), (8, 12));
/// # Ok::<(), trisect::parametric::GeometryError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Extrusion {
    height: f64,
    twist: f64,
    top_scale: f64,
    centre: Point<2>,
    tolerance: f64,
}

impl Extrusion {
    /// A straight extrusion over `height`.
    #[must_use]
    pub fn new(height: f64) -> Self {
        Self { height, twist: 0.0, top_scale: 1.0, centre: [0.0; 2], tolerance: 0.0 }
    }

    /// Turns the region evenly on the way, by `angle` radians in all (counter-clockwise seen from above). The mesh
    /// deviates from the exact twisted surface by no more than `tolerance`.
    #[must_use]
    pub fn twist(mut self, angle: f64, tolerance: f64) -> Self {
        self.twist = angle;
        self.tolerance = tolerance;
        self
    }

    /// Scales the region evenly on the way, to `top_scale` at the top; 0 gives a point.
    #[must_use]
    pub fn taper(mut self, top_scale: f64) -> Self {
        self.top_scale = top_scale;
        self
    }

    /// The point of the plane about which the region turns and towards which it shrinks (by default the origin).
    #[must_use]
    pub fn about(mut self, centre: [f64; 2]) -> Self {
        self.centre = centre;
        self
    }

    /// The closed mesh of the extruded `region`; an empty one for an empty region.
    ///
    /// # Errors
    /// [`GeometryError::OutOfRange`] for a height or tolerance that is not positive, or a negative taper;
    /// [`GeometryError::NotFinite`]; [`GeometryError::TooManyNodes`].
    pub fn mesh(&self, region: &Polygons) -> Result<Mesh> {
        check_positive("height", self.height)?;
        check_points("extrusion", &[[self.twist, self.top_scale], self.centre])?;
        if self.top_scale < 0.0 {
            let value = self.top_scale;
            return Err(GeometryError::OutOfRange { what: "scale at the top", value, range: "0 or more" });
        }
        let (section, layers) = self.resolved(region)?;
        let section = section.triangulate()?;
        let mut rings: Vec<Vec<Point<3>>> = Vec::with_capacity(layers + 1);
        for k in 0..=layers {
            let w = k as f64 / layers as f64;
            let z = if k == layers { self.height } else { self.height * w };
            let [cos, sin] = cos_sin(self.twist * w);
            let scale = vector::mix(1.0, self.top_scale, w);
            let place = |p: &Point<2>| {
                if self.twist == 0.0 && scale == 1.0 {
                    return [p[0], p[1], z];
                }
                let [x, y] = vector::scale(vector::sub(*p, self.centre), scale);
                [self.centre[0] + x * cos - y * sin, self.centre[1] + x * sin + y * cos, z]
            };
            rings.push(section.points.iter().map(place).collect());
        }
        Ok(loft(&section, &rings, Closing::Caps))
    }

    /// The region with edges short enough, and the number of layers, for the tolerance of a twist.
    ///
    /// Of the surface over an edge of length L, with the layer as second parameter, the second derivatives are
    /// bounded by `mixed` and `along`; a triangle one edge long and one layer high then deviates by at most
    /// `(2 h mixed + h^2 along) / 8` (Filip, Magedson and Markot 1986). Half the tolerance goes to each term.
    fn resolved(&self, region: &Polygons) -> Result<(Polygons, usize)> {
        const MOST: f64 = 1e6;
        if self.twist == 0.0 || region.is_empty() {
            return Ok((region.clone(), 1));
        }
        check_positive("tolerance", self.tolerance)?;
        let radius =
            region.contours().flatten().map(|p| vector::distance(*p, self.centre)).fold(0.0, f64::max);
        let scale = self.top_scale.max(1.0);
        let (shrink, turn) = ((1.0 - self.top_scale).abs(), self.twist.abs());
        let along = radius * (2.0 * shrink * turn + turn * turn * scale);
        let layers = (along / (4.0 * self.tolerance)).sqrt().ceil().max(1.0);
        let longest = 2.0 * self.tolerance * layers / (shrink + turn * scale);
        let count = |a: Point<2>, b: Point<2>| (vector::distance(a, b) / longest).ceil().max(1.0);
        let edges: f64 = region.edges().map(|[a, b]| count(a, b)).sum();
        if layers * edges > MOST || !(layers * edges).is_finite() {
            return Err(GeometryError::TooManyNodes { what: "extrusion", limit: MOST as usize });
        }
        let refined = region.refined(|a, b| count(a, b) as usize);
        Ok((refined, layers as usize))
    }
}

/// How the ends of a loft are closed.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Closing {
    /// Both ends by the filled section.
    Caps,
    /// The last ring is followed by the first.
    Ring,
}

/// The closed mesh between rings of the same plane mesh: `rings[k][i]` is the place of its point `i` on ring `k`.
/// Seen against the direction of travel the section's triangles turn counter-clockwise. Points of consecutive
/// rings that coincide bit for bit become one vertex.
pub(crate) fn loft(section: &PlaneMesh, rings: &[Vec<Point<3>>], closing: Closing) -> Mesh {
    let count = section.points.len();
    let mut vertices = VertexTable::default();
    let ids: Vec<Vec<u32>> =
        rings.iter().map(|ring| ring.iter().map(|p| vertices.id(*p)).collect()).collect();
    let mut triangles: Vec<[u32; 3]> = Vec::new();
    let mut push = |triangle: [u32; 3]| {
        let [a, b, c] = triangle;
        if a != b && b != c && c != a {
            triangles.push(triangle);
        }
    };
    if closing == Closing::Caps && count > 0 {
        let (first, last) = (&ids[0], &ids[ids.len() - 1]);
        for [a, b, c] in section.triangles.iter().map(|t| t.map(|i| i as usize)) {
            push([first[a], first[c], first[b]]);
            push([last[a], last[b], last[c]]);
        }
    }
    let layers = if closing == Closing::Caps { rings.len() - 1 } else { rings.len() };
    for [a, b] in section.boundary().into_iter().map(|edge| edge.map(|i| i as usize)) {
        for k in 0..layers {
            let above = (k + 1) % rings.len();
            let (low, high) = (&ids[k], &ids[above]);
            let diagonals = [
                vector::distance(rings[k][a], rings[above][b]),
                vector::distance(rings[k][b], rings[above][a]),
            ];
            if diagonals[0] <= diagonals[1] {
                push([low[a], low[b], high[b]]);
                push([low[a], high[b], high[a]]);
            } else {
                push([low[a], low[b], high[a]]);
                push([low[b], high[b], high[a]]);
            }
        }
    }
    Mesh::new(vertices.positions, triangles)
}

/// Vertices, one for each place.
#[derive(Default)]
pub(crate) struct VertexTable {
    pub(crate) positions: Vec<Point<3>>,
    known: rustc_hash::FxHashMap<[u64; 3], u32>,
}

impl VertexTable {
    /// The vertex at `p`, made if there is none yet.
    pub(crate) fn id(&mut self, p: Point<3>) -> u32 {
        // Adding zero makes one of the two zeros.
        let p = p.map(|x| x + 0.0);
        *self.known.entry(p.map(f64::to_bits)).or_insert_with(|| {
            self.positions.push(p);
            (self.positions.len() - 1) as u32
        })
    }
}
