//! Volumes and areas of booleans of solids with integer corners, in rational arithmetic: the solids are sums of convex pieces,
//! and convex pieces are clipped by planes. Nothing is shared with the engine, and no case is special.

use dashu::base::ConversionError;
use dashu::integer::IBig;
use dashu::rational::RBig;
use trisect::{Mesh, Operation};

/// A point with rational coordinates: x, y, z over the positive fourth, in lowest terms.
type Point = [i128; 4];
/// a x + b y + c z <= d, in lowest terms.
type Plane = [i128; 4];
type Polygon = Vec<Point>;

fn greatest_common_divisor(mut a: i128, mut b: i128) -> i128 {
    while b != 0 {
        (a, b) = (b, a % b);
    }
    a.abs()
}

fn lowest_terms(values: [i128; 4]) -> [i128; 4] {
    let divisor = values.into_iter().fold(0, greatest_common_divisor).max(1);
    values.map(|x| x / divisor)
}

/// How far beyond the plane the point is, up to a positive factor.
fn beyond(plane: &Plane, p: &Point) -> i128 {
    plane[0] * p[0] + plane[1] * p[1] + plane[2] * p[2] - plane[3] * p[3]
}

/// The part of a convex polygon on the inner side of a plane, the plane included.
fn clipped(polygon: &[Point], plane: &Plane) -> Polygon {
    let mut kept = Polygon::new();
    for (i, p) in polygon.iter().enumerate() {
        let q = &polygon[(i + 1) % polygon.len()];
        let (s, t) = (beyond(plane, p), beyond(plane, q));
        if s <= 0 {
            kept.push(*p);
        }
        if (s < 0 && t > 0) || (s > 0 && t < 0) {
            // The crossing is q s - p t over s - t, each scaled by the other's denominator, which s and t contain already.
            let crossing = [0, 1, 2, 3].map(|k| q[k] * s - p[k] * t);
            let sign = if crossing[3] < 0 { -1 } else { 1 };
            kept.push(lowest_terms(crossing.map(|x| sign * x)));
        }
    }
    kept
}

fn clipped_by_all(polygon: &[Point], planes: &[Plane]) -> Polygon {
    planes.iter().fold(polygon.to_vec(), |polygon, plane| clipped(&polygon, plane))
}

fn rational(numerator: i128, denominator: i128) -> RBig {
    RBig::from_parts(
        IBig::from(numerator),
        u128::try_from(denominator).expect("a positive denominator").into(),
    )
}

/// Six times the volume of the cone from the origin over a polygon.
fn six_cones(polygon: &[Point]) -> RBig {
    let mut sum = RBig::ZERO;
    for i in 2..polygon.len() {
        let [a, b, c] = [polygon[0], polygon[i - 1], polygon[i]];
        let determinant = a[0] * (b[1] * c[2] - b[2] * c[1])
            + a[1] * (b[2] * c[0] - b[0] * c[2])
            + a[2] * (b[0] * c[1] - b[1] * c[0]);
        sum += rational(determinant, 1) / rational(a[3] * b[3] * c[3], 1);
    }
    sum
}

fn area(polygon: &[Point]) -> f64 {
    let float = |p: &Point| [0, 1, 2].map(|k| p[k] as f64 / p[3] as f64);
    let points: Vec<[f64; 3]> = polygon.iter().map(float).collect();
    let mut sum = [0.0; 3];
    for i in 2..points.len() {
        let normal = super::vector::cross(
            super::vector::minus(points[i - 1], points[0]),
            super::vector::minus(points[i], points[0]),
        );
        sum = super::vector::plus(sum, normal, 1.0);
    }
    0.5 * super::vector::length(sum)
}

/// A triangle with its plane.
#[derive(Clone, Debug)]
struct Face {
    corners: Polygon,
    plane: Plane,
}

fn faces(mesh: &Mesh) -> Vec<Face> {
    let integer = |x: f64| {
        assert!(x.fract() == 0.0 && x.abs() < 1e6, "{x} is not a small integer");
        x as i128
    };
    let face = |corners: &[u32; 3]| {
        let [a, b, c] = corners.map(|corner| mesh.positions[corner as usize].map(integer));
        let (u, v) = ([0, 1, 2].map(|k| b[k] - a[k]), [0, 1, 2].map(|k| c[k] - a[k]));
        let n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
        let plane = lowest_terms([n[0], n[1], n[2], n[0] * a[0] + n[1] * a[1] + n[2] * a[2]]);
        Face { corners: [a, b, c].map(|p| [p[0], p[1], p[2], 1]).to_vec(), plane }
    };
    mesh.triangles.iter().map(face).collect()
}

fn planes(faces: &[Face]) -> Vec<Plane> {
    let mut planes: Vec<Plane> = faces.iter().map(|face| face.plane).collect();
    planes.sort_unstable();
    planes.dedup();
    planes
}

/// A convex piece.
#[derive(Clone, Debug)]
struct Piece {
    faces: Vec<Face>,
    planes: Vec<Plane>,
}

/// A solid: its surface, and convex pieces that fill it without overlapping.
#[derive(Clone, Debug)]
pub(crate) struct Exact {
    surface: Vec<Face>,
    pieces: Vec<Piece>,
}

/// How large parts of a surface are by where they lie towards the other solid.
#[derive(Clone, Copy, Debug, Default)]
struct Areas {
    inside: f64,
    outside: f64,
    /// On the other's surface, facing the same way, and the opposite way.
    same: f64,
    opposite: f64,
}

/// What a boolean of two solids is.
#[derive(Clone, Debug)]
pub(crate) struct Expected {
    pub(crate) volume: f64,
    pub(crate) area: f64,
    pub(crate) empty: bool,
}

impl Exact {
    /// A solid with integer corners from its surface and the surfaces of its convex pieces.
    pub(crate) fn new(surface: &Mesh, pieces: &[Mesh]) -> Self {
        let piece = |mesh: &Mesh| {
            let faces = faces(mesh);
            Piece { planes: planes(&faces), faces }
        };
        let solid = Self { surface: faces(surface), pieces: pieces.iter().map(piece).collect() };
        let six: RBig =
            solid.surface.iter().map(|face| six_cones(&face.corners)).fold(RBig::ZERO, |s, x| s + x);
        assert_eq!(six, solid.six_volumes(), "the pieces do not fill the solid");
        solid
    }

    pub(crate) fn convex(surface: &Mesh) -> Self {
        Self::new(surface, std::slice::from_ref(surface))
    }

    fn six_volumes(&self) -> RBig {
        let all = self.pieces.iter().flat_map(|piece| &piece.faces);
        all.map(|face| six_cones(&face.corners)).fold(RBig::ZERO, |sum, x| sum + x)
    }

    /// Six times the volume of what two solids share.
    fn six_shared(&self, other: &Self) -> RBig {
        let mut sum = RBig::ZERO;
        for a in &self.pieces {
            for b in &other.pieces {
                for face in &a.faces {
                    sum += six_cones(&clipped_by_all(&face.corners, &b.planes));
                }
                // Where both have the same face it counts once.
                for face in b.faces.iter().filter(|face| !a.planes.contains(&face.plane)) {
                    sum += six_cones(&clipped_by_all(&face.corners, &a.planes));
                }
            }
        }
        sum
    }

    fn areas(&self, other: &Self) -> Areas {
        let mut areas = Areas::default();
        for face in &self.surface {
            let opposite = face.plane.map(|x| -x);
            let parts: Vec<(Polygon, &Piece)> = other
                .pieces
                .iter()
                .map(|piece| (clipped_by_all(&face.corners, &piece.planes), piece))
                .filter(|(polygon, _)| polygon.len() > 2)
                .collect();
            // A piece of which this is a face fills one side of it only.
            let above = |piece: &Piece| !piece.planes.contains(&face.plane);
            let below = |piece: &Piece| !piece.planes.contains(&opposite);
            let sum = |fills: &dyn Fn(&Piece) -> bool| -> f64 {
                parts.iter().filter(|(_, piece)| fills(piece)).map(|(polygon, _)| area(polygon)).sum()
            };
            let (whole, above_sum, below_sum) = (area(&face.corners), sum(&above), sum(&below));
            let mut both = 0.0;
            for (polygon, piece) in parts.iter().filter(|(_, piece)| above(piece)) {
                for (_, under) in parts.iter().filter(|(_, piece)| below(piece)) {
                    both += if std::ptr::eq(*piece, *under) {
                        area(polygon)
                    } else {
                        area(&clipped_by_all(polygon, &under.planes))
                    };
                }
            }
            areas.inside += both;
            areas.same += below_sum - both;
            areas.opposite += above_sum - both;
            areas.outside += whole - above_sum - below_sum + both;
        }
        areas
    }

    /// The volume and area of a boolean with another solid.
    pub(crate) fn expected(&self, other: &Self, operation: Operation) -> Expected {
        Facts::new(self, other).of(operation)
    }
}

/// All that the booleans of two solids need.
#[derive(Clone, Debug)]
pub(crate) struct Facts {
    six: [RBig; 2],
    pub(crate) six_shared: RBig,
    areas: [Areas; 2],
}

impl Facts {
    pub(crate) fn new(a: &Exact, b: &Exact) -> Self {
        let areas = [a.areas(b), b.areas(a)];
        // Sums of some dozens of areas in `f64`, in other orders: of a million units the last place alone is 1e-10.
        let are_equal = |x: f64, y: f64| (x - y).abs() < 1e-9 + 1e-14 * x;
        assert!(are_equal(areas[0].same, areas[1].same), "{areas:?}");
        assert!(are_equal(areas[0].opposite, areas[1].opposite), "{areas:?}");
        Self { six: [a.six_volumes(), b.six_volumes()], six_shared: a.six_shared(b), areas }
    }

    /// Whether the solids meet at most in edges and vertices.
    pub(crate) fn apart(&self) -> bool {
        self.six_shared == RBig::ZERO && self.areas[0].opposite < 1e-9
    }

    pub(crate) fn of(&self, operation: Operation) -> Expected {
        let ([six_a, six_b], shared, [a, b]) = (&self.six, &self.six_shared, &self.areas);
        let (six, area) = match operation {
            Operation::Union => (six_a + six_b - shared, a.outside + b.outside + a.same),
            Operation::Intersection => (shared.clone(), a.inside + b.inside + a.same),
            Operation::Difference => (six_a - shared, a.outside + b.inside + a.opposite),
            Operation::SymmetricDifference => {
                (six_a + six_b - shared - shared, a.outside + b.outside + a.inside + b.inside)
            }
            other => unreachable!("nothing is expected of {other}"),
        };
        let empty = six == RBig::ZERO;
        // Regularised: what has no volume has no surface either.
        Expected { volume: float(&(six / rational(6, 1))), area: if empty { 0.0 } else { area }, empty }
    }
}

fn float(value: &RBig) -> f64 {
    let converted: Result<f64, ConversionError> = value.clone().try_into();
    converted.unwrap_or_else(|_| value.to_f64().value())
}
