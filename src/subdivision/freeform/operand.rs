//! An operand: its cage, its limit surface, and triangles on that.

use std::sync::OnceLock;

use glam::DVec3;
use smallvec::SmallVec;

use crate::spatial::{TriangleTree, closest_on_triangle};
use crate::subdivision::control_mesh::ControlMesh;
use crate::subdivision::evaluate::Surface;
use crate::subdivision::limit_mesh::LimitMesh;
use crate::{Error, Solid};

/// A cage with what the boolean needs of it.
pub(super) struct Operand {
    pub(super) cage: ControlMesh,
    pub(super) surface: Surface,
    pub(super) fine: LimitMesh,
    /// How far its triangles may be from the surface.
    pub(super) within: f64,
    tree: TriangleTree,
    /// Whether its surface crosses itself: the nearest point may then be on another layer than the one that is meant.
    pub(super) crosses_itself: bool,
    /// The triangles at each fine vertex, made when first asked for.
    stars: OnceLock<Vec<SmallVec<[u32; 8]>>>,
}

/// The nearest point of a limit surface.
#[derive(Clone, Copy, Debug)]
pub(super) struct Foot {
    pub(super) position: DVec3,
    pub(super) normal: DVec3,
    /// The fine triangle, as a guess for the next search.
    pub(super) triangle: u32,
}

/// Every face is split at least this often: the vertices in between are those that a cut face's cage is chosen from.
const LEAST_STEPS: u32 = 2;
/// Layers that cross differ by more than 3 degrees, here as a cosine: at 5 they are refused.
const SAME_WAY: f64 = 0.9986;
/// Newton steps from the nearest point of the triangles to that of the surface: each squares the error, which begins at a
/// tenth of a fine triangle.
const CORRECTIONS: usize = 2;

impl Operand {
    /// Triangles within `tolerance` of the surface, split at most `most` times.
    pub(super) fn new(cage: &ControlMesh, tolerance: f64, most: u32) -> Result<Self, Error> {
        cage.check_closed()?;
        // What is sharp for a while is subdivided away: the surface stays the same.
        let mut cage = cage.flattened()?.into_owned();
        let mut unrolled = 0;
        while cage.level().is_semi_sharp() && unrolled < 10 {
            cage = cage.subdivided(1)?;
            unrolled += 1;
        }
        let surface = cage.surface();
        let steps: Vec<u32> = (0..cage.faces().len() as u32)
            .map(|f| {
                (LEAST_STEPS..most).find(|&s| surface.flatness(f, s as usize) <= tolerance).unwrap_or(most)
            })
            .collect();
        let bounds = steps.iter().enumerate().map(|(f, &s)| surface.flatness(f as u32, s as usize));
        let within = bounds.fold(0.0, f64::max);
        let fine = LimitMesh::new(&surface, &steps)?;
        let tree = TriangleTree::new(fine.mesh());
        Ok(Self { cage, surface, fine, within, tree, crosses_itself: false, stars: OnceLock::new() })
    }

    /// The triangles as an operand.
    pub(super) fn solid(&self) -> &Solid {
        self.fine.solid()
    }

    /// Whether the surface goes on from one of two fine triangles to the other: they have a vertex in common, or look the same way.
    /// (Where the exact result left out what rounding makes too thin, triangles side by side are not always neighbours here.)
    pub(super) fn continues(&self, one: u32, other: u32) -> bool {
        let triangles = &self.fine.mesh().triangles;
        let corners = triangles[other as usize];
        if triangles[one as usize].iter().any(|v| corners.contains(v)) {
            return true;
        }
        let [p, q] = [one, other].map(|triangle| {
            let [a, b, c] = self.corners(triangle);
            (b - a).cross(c - a).normalize_or_zero()
        });
        p.dot(q) > SAME_WAY
    }

    /// The nearest point of the surface to `x`; nothing if `x` is not finite. A surface that crosses itself is searched from `guess` on
    /// alone, over neighbours that are nearer; else a guess saves work and never changes the answer.
    pub(super) fn foot(&self, x: DVec3, guess: Option<u32>) -> Option<Foot> {
        if let Some(guess) = guess.filter(|_| self.crosses_itself && x.is_finite()) {
            let (triangle, point) = self.walk(x, guess);
            return Some(self.foot_near(x, triangle, point));
        }
        let closest = self.tree.closest_from(x.to_array(), guess)?;
        Some(self.foot_near(x, closest.triangle, closest.point.into()))
    }

    /// The point of the surface nearest to `x` in the face of a fine triangle, beginning at a point of that triangle.
    pub(super) fn foot_near(&self, x: DVec3, triangle: u32, point: DVec3) -> Foot {
        let weights = weights_in(self.corners(triangle), point);
        let mut place = self.fine.place_within(triangle, weights);
        let mut sample = self.surface.at(place.face, place.weights);
        for _ in 0..CORRECTIONS {
            let away = x - sample.position;
            let (uu, uv, vv) =
                (sample.du.length_squared(), sample.du.dot(sample.dv), sample.dv.length_squared());
            let determinant = uu * vv - uv * uv;
            if !(determinant > 1e-12 * uu * vv) {
                break;
            }
            let (a, b) = (sample.du.dot(away), sample.dv.dot(away));
            let (du, dv) = ((a * vv - b * uv) / determinant, (b * uu - a * uv) / determinant);
            let (moved, whole) = within_face(place.weights, [-du - dv, du, dv]);
            let next = self.surface.at(place.face, moved);
            if (x - next.position).length_squared() > away.length_squared() {
                break;
            }
            (place.weights, sample) = (moved, next);
            if !whole {
                break;
            }
        }
        Foot { position: sample.position, normal: sample.normal, triangle }
    }

    /// From a fine triangle to neighbours as long as they are nearer to `x`: the last one, and its nearest point.
    fn walk(&self, x: DVec3, from: u32) -> (u32, DVec3) {
        let triangles = &self.fine.mesh().triangles;
        let stars = self.stars.get_or_init(|| {
            let mut stars = vec![SmallVec::new(); self.fine.mesh().positions.len()];
            for (number, corners) in (0..).zip(triangles) {
                corners.iter().for_each(|&v| stars[v as usize].push(number));
            }
            stars
        });
        let nearest = |triangle: u32| {
            let corners = self.corners(triangle).map(|corner| corner.to_array());
            let point = DVec3::from(closest_on_triangle(x.to_array(), corners).0);
            (point.distance_squared(x), triangle, point)
        };
        let mut best = nearest(from);
        loop {
            let before = best.1;
            for &v in &triangles[before as usize] {
                for &other in &stars[v as usize] {
                    let found = nearest(other);
                    if found.0 < best.0 {
                        best = found;
                    }
                }
            }
            if best.1 == before {
                return (best.1, best.2);
            }
        }
    }

    /// The corners of a fine triangle.
    pub(super) fn corners(&self, triangle: u32) -> [DVec3; 3] {
        let mesh = self.fine.mesh();
        mesh.triangles[triangle as usize].map(|v| DVec3::from(mesh.positions[v as usize]))
    }

    /// How long the edges of a face are over the surface, on average.
    pub(super) fn size(&self, face: u32) -> f64 {
        let corners =
            self.cage.faces()[face as usize].map(|v| DVec3::from(self.fine.mesh().positions[v as usize]));
        (corners[0].distance(corners[1]) + corners[1].distance(corners[2]) + corners[2].distance(corners[0]))
            / 3.0
    }
}

/// A step within a face, shortened at its border; whether it was taken whole.
fn within_face(weights: [f64; 3], step: [f64; 3]) -> ([f64; 3], bool) {
    let mut share = 1.0f64;
    for k in 0..3 {
        if weights[k] + step[k] < 0.0 {
            share = share.min(weights[k].max(0.0) / -step[k]);
        }
    }
    let moved: [f64; 3] = std::array::from_fn(|k| (weights[k] + share * step[k]).max(0.0));
    let sum: f64 = moved.iter().sum();
    (moved.map(|w| w / sum), share == 1.0)
}

/// The weights of a triangle's corners at a point near it, none negative, by areas.
pub(super) fn weights_in(corners: [DVec3; 3], point: DVec3) -> [f64; 3] {
    let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
    let area = |k: usize| {
        let (p, q) = (corners[(k + 1) % 3] - point, corners[(k + 2) % 3] - point);
        p.cross(q).dot(normal).max(0.0)
    };
    let areas = [area(0), area(1), area(2)];
    let sum: f64 = areas.iter().sum();
    if sum > 0.0 { areas.map(|a| a / sum) } else { [1.0, 0.0, 0.0] }
}
