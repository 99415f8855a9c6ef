//! Where the eye is: direction, projection, size of the picture, and the fit of the camera to what it shows.

use glam::{DVec2, DVec3};

use crate::Mesh;

/// How a mesh is looked at. The default is a three-quarter view in perspective, z upwards, 1024 x 768 pixels.
///
/// ```
/// let mut view = trisect::render::View::default();
/// view.direction = [0.0, 0.0, 1.0]; // from above
/// view.perspective = false;
/// ```
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct View {
    /// From the scene towards the eye; any length but zero.
    pub direction: [f64; 3],
    /// What points upwards in the picture; any length but zero.
    pub up: [f64; 3],
    /// Perspective, or parallel projection.
    pub perspective: bool,
    /// Columns of the picture.
    pub width: u32,
    /// Rows of the picture.
    pub height: u32,
    /// Background colours at the top and at the bottom, blended in between.
    pub background: [[u8; 3]; 2],
    /// Colour of triangles that have none of their own.
    pub colour: [u8; 3],
    /// Whether creases and outlines are drawn darker.
    pub edges: bool,
    /// The corners of the box to show, low and high. Without it the camera fits the mesh; with it several meshes
    /// can be shown alike.
    pub frame: Option<[[f64; 3]; 2]>,
}

impl Default for View {
    fn default() -> Self {
        Self {
            direction: [1.0, -1.2, 0.8],
            up: [0.0, 0.0, 1.0],
            perspective: true,
            width: 1024,
            height: 768,
            background: [[250, 251, 252], [226, 231, 237]],
            colour: [196, 203, 212],
            edges: true,
            frame: None,
        }
    }
}

/// Half the opening angle of the picture's shorter side, as a tangent: about 30 degrees in all, a long lens, so
/// that proportions stay legible.
const HALF_OPENING: f64 = 0.27;
/// The part of the picture that the mesh may fill.
const FILL: f64 = 0.9;

/// A fitted camera: turns points into picture coordinates and closeness.
#[derive(Clone, Copy, Debug)]
pub(super) struct Camera {
    /// Centre and scale that bring the scene into the unit ball, whatever its units.
    centre: DVec3,
    shrink: f64,
    /// Rows: to the right, upwards, towards the eye.
    pub(super) axes: [DVec3; 3],
    eye: DVec3,
    perspective: bool,
    /// Pixels per unit at distance one (perspective) or everywhere (parallel).
    focal: f64,
    middle: DVec2,
}

/// A point as seen: position in the picture (y downwards) and closeness, which is linear across a flat triangle
/// and larger for nearer points: the reciprocal distance in perspective, minus the distance otherwise.
#[derive(Clone, Copy, Debug)]
pub(super) struct Seen {
    pub(super) at: DVec2,
    pub(super) closeness: f64,
}

impl Camera {
    /// A camera for `view` that shows all of `points`, or the view's own frame. `scale` multiplies the size of
    /// the picture. `None` if there is nothing finite to show.
    pub(super) fn fit(mesh: &Mesh, view: &View, scale: f64) -> Option<Self> {
        let points = points_to_show(mesh, view);
        let (low, high) = points.iter().fold(None, |bounds: Option<(DVec3, DVec3)>, &p| {
            Some(bounds.map_or((p, p), |(low, high)| (low.min(p), high.max(p))))
        })?;
        // Halved first: the sum or difference of two huge coordinates would overflow.
        let centre = low * 0.5 + high * 0.5;
        let half = (high * 0.5 - low * 0.5).max_element();
        let shrink = if half > 0.0 { 0.5 / half } else { 1.0 };
        let shrink = if shrink.is_finite() { shrink } else { f64::MAX };

        let axes = axes(view);
        let size = DVec2::new(f64::from(view.width), f64::from(view.height)) * scale;
        let mut camera = Self {
            centre,
            shrink,
            axes,
            eye: DVec3::ZERO,
            perspective: view.perspective,
            focal: 1.0,
            middle: size * 0.5,
        };
        let local: Vec<DVec3> = points.iter().map(|&p| camera.local(p)).collect();
        if view.perspective {
            camera.stand_back(&local, size);
        } else {
            camera.zoom(&local, size);
        }
        Some(camera)
    }

    /// The scene's coordinates along the camera's axes, brought into the unit ball.
    pub(super) fn local(&self, point: DVec3) -> DVec3 {
        let p = (point * 0.5 - self.centre * 0.5) * self.shrink * 2.0;
        DVec3::new(p.dot(self.axes[0]), p.dot(self.axes[1]), p.dot(self.axes[2]))
    }

    /// A direction of the scene along the camera's axes.
    pub(super) fn direction(&self, direction: DVec3) -> DVec3 {
        DVec3::new(direction.dot(self.axes[0]), direction.dot(self.axes[1]), direction.dot(self.axes[2]))
    }

    /// Whether it shows in perspective.
    pub(super) fn is_perspective(&self) -> bool {
        self.perspective
    }

    /// A point in local coordinates as seen; `None` at or behind the eye.
    pub(super) fn see(&self, local: DVec3) -> Option<Seen> {
        let p = local - self.eye;
        let (factor, closeness) = if self.perspective {
            let closeness = 1.0 / -p.z;
            (self.focal * closeness, closeness)
        } else {
            (self.focal, p.z)
        };
        let at = DVec2::new(self.middle.x + p.x * factor, self.middle.y - p.y * factor);
        let visible = p.z < -1e-3 || !self.perspective;
        (visible && at.is_finite() && closeness.is_finite()).then_some(Seen { at, closeness })
    }

    /// The distance in local units that a change of closeness means near `closeness`.
    pub(super) fn depth_of(&self, change: f64, closeness: f64) -> f64 {
        if self.perspective { change / (closeness * closeness) } else { change }
    }

    /// The direction towards the eye from a point in local coordinates.
    pub(super) fn towards_eye(&self, local: DVec3) -> DVec3 {
        if self.perspective { self.eye - local } else { DVec3::Z }
    }

    /// Moves the eye back until every point lies inside the four planes of the view. With the planes' slope `t`,
    /// a point is inside the right plane when x + t z <= eye.x + t eye.z, and likewise for the others; so the
    /// extreme values of x + t z and -x + t z give the nearest eye exactly.
    fn stand_back(&mut self, points: &[DVec3], size: DVec2) {
        self.focal = size.min_element() / 2.0 / HALF_OPENING;
        let slope = size / 2.0 / self.focal * FILL;
        let extreme =
            |f: &dyn Fn(DVec3) -> f64| points.iter().map(|&p| f(p)).fold(f64::NEG_INFINITY, f64::max);
        let right = extreme(&|p| p.x + slope.x * p.z);
        let left = extreme(&|p| -p.x + slope.x * p.z);
        let top = extreme(&|p| p.y + slope.y * p.z);
        let bottom = extreme(&|p| -p.y + slope.y * p.z);
        let nearest = extreme(&|p| p.z);
        let back = ((right + left) / slope.x).max((top + bottom) / slope.y) / 2.0;
        self.eye = DVec3::new((right - left) / 2.0, (top - bottom) / 2.0, back.max(nearest + 0.1));
    }

    /// Centres the points and magnifies them to fill the picture.
    fn zoom(&mut self, points: &[DVec3], size: DVec2) {
        let (low, high) = points
            .iter()
            .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), &p| (low.min(p), high.max(p)));
        let extent = (high - low).truncate().max(DVec2::splat(1e-3));
        self.eye = DVec3::new((low.x + high.x) / 2.0, (low.y + high.y) / 2.0, high.z + 1.0);
        self.focal = (size / extent).min_element() * FILL;
    }
}

/// The corners of the view's frame, or else every vertex that a triangle uses; finite ones only.
fn points_to_show(mesh: &Mesh, view: &View) -> Vec<DVec3> {
    if let Some([low, high]) = view.frame {
        let corner = |k: usize| {
            let pick = |axis: usize| if k >> axis & 1 == 0 { low[axis] } else { high[axis] };
            DVec3::new(pick(0), pick(1), pick(2))
        };
        return (0..8).map(corner).filter(|p| p.is_finite()).collect();
    }
    let mut used = vec![false; mesh.positions.len()];
    for &corner in mesh.triangles.as_flattened() {
        if let Some(used) = used.get_mut(corner as usize) {
            *used = true;
        }
    }
    let positions = mesh.positions.iter().zip(&used);
    positions.filter(|&(_, &used)| used).map(|(&p, _)| DVec3::from(p)).filter(|p| p.is_finite()).collect()
}

/// The camera's axes: right, up, towards the eye. Directions without meaning give way to the default ones.
fn axes(view: &View) -> [DVec3; 3] {
    let normal = |v: [f64; 3]| {
        let v = DVec3::from(v);
        // Scaled by the largest component first: squares of tiny or huge ones leave the range.
        (v / v.abs().max_element()).try_normalize()
    };
    let towards = normal(view.direction).or_else(|| normal(View::default().direction)).unwrap_or(DVec3::Z);
    let mut up = normal(view.up).unwrap_or(DVec3::Z);
    if towards.cross(up).length() < 1e-6 {
        up = if towards.y.abs() < 0.9 { DVec3::Y } else { DVec3::Z };
    }
    let right = up.cross(towards).normalize();
    [right, towards.cross(right), towards]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn box_mesh(low: [f64; 3], high: [f64; 3]) -> Mesh {
        let positions: Vec<[f64; 3]> = (0..8)
            .map(|k: usize| {
                std::array::from_fn(|axis| if k >> axis & 1 == 0 { low[axis] } else { high[axis] })
            })
            .collect();
        Mesh::new(positions, vec![[0, 1, 2], [3, 4, 5], [6, 7, 0]])
    }

    /// Every point shown must be inside the picture, and the tightest side at the promised margin.
    #[test]
    fn the_camera_fits_any_box_in_any_direction() {
        let boxes = [
            box_mesh([0.0; 3], [1.0; 3]),
            box_mesh([-1e308, -1.2e308, -9e307], [1.5e308, 1e308, 1.2e308]),
            box_mesh([1e-308, 0.0, 0.0], [3e-308, 2e-308, 1e-308]),
            box_mesh([500_000.0, 4_649_776.0, 120.0], [500_001.0, 4_649_777.0, 121.0]),
            box_mesh([2.0, 2.0, 2.0], [2.0, 2.0, 2.0]),
        ];
        for mesh in &boxes {
            for direction in
                [[1.0, -1.2, 0.8], [0.0, 0.0, 1.0], [0.0, 0.0, -3.0], [1e-200, 0.0, 0.0], [0.0; 3]]
            {
                for perspective in [true, false] {
                    let view = View { direction, perspective, width: 300, height: 200, ..View::default() };
                    let camera = Camera::fit(mesh, &view, 1.0).expect("finite points");
                    let mut reach: f64 = 0.0;
                    for &position in &mesh.positions {
                        let seen = camera.see(camera.local(position.into())).expect("in front of the eye");
                        reach = reach.max(
                            ((seen.at - DVec2::new(150.0, 100.0)) / DVec2::new(150.0, 100.0))
                                .abs()
                                .max_element(),
                        );
                    }
                    assert!(reach <= FILL + 1e-9, "{direction:?} {perspective} {reach}");
                    let point = mesh.positions.iter().all(|p| *p == mesh.positions[0]);
                    assert!(point || reach > FILL - 0.02, "{direction:?} {perspective} {reach}");
                }
            }
        }
    }

    #[test]
    fn nothing_finite_gives_no_camera() {
        let mesh = Mesh::new(vec![[f64::NAN; 3]; 3], vec![[0, 1, 2]]);
        assert!(Camera::fit(&mesh, &View::default(), 1.0).is_none());
        assert!(Camera::fit(&Mesh::default(), &View::default(), 1.0).is_none());
    }

    #[test]
    fn z_points_up_and_x_to_the_right_when_seen_from_the_front() {
        let view = View { direction: [0.0, -1.0, 0.0], ..View::default() };
        let mesh = box_mesh([0.0; 3], [1.0; 3]);
        let camera = Camera::fit(&mesh, &view, 1.0).expect("finite points");
        let at = |p: [f64; 3]| camera.see(camera.local(p.into())).expect("visible").at;
        assert!(at([1.0, 0.0, 0.0]).x > at([0.0, 0.0, 0.0]).x);
        assert!(at([0.0, 0.0, 1.0]).y < at([0.0, 0.0, 0.0]).y);
    }
}
