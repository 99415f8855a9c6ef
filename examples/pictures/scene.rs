//! Meshes, lines and dots with colours, put together to be drawn.

use trisect::render::{self, Picture, View};
use trisect::{Error, Mesh, primitives};

pub(crate) type Colour = [u8; 3];
pub(crate) type Point = [f64; 3];

pub(crate) const BLUE: Colour = [130, 164, 206];
pub(crate) const ORANGE: Colour = [238, 168, 96];
pub(crate) const GREEN: Colour = [138, 190, 132];
pub(crate) const RED: Colour = [196, 72, 64];
pub(crate) const GREY: Colour = [214, 218, 224];
pub(crate) const DARK: Colour = [52, 56, 64];

/// What is to be drawn.
#[derive(Default)]
pub(crate) struct Scene {
    mesh: Mesh,
    colours: Vec<Colour>,
}

impl Scene {
    /// Adds a mesh, each triangle in its colour.
    pub(crate) fn add(&mut self, mesh: &Mesh, colour: impl Fn(usize) -> Colour) -> Result<(), Error> {
        self.mesh.append(mesh)?;
        self.colours.extend((0..mesh.triangles.len()).map(colour));
        Ok(())
    }

    /// Adds a small ball.
    pub(crate) fn dot(&mut self, at: Point, radius: f64, colour: Colour) -> Result<(), Error> {
        self.add(&primitives::geodesic_sphere(radius, 4)?.translated(at), |_| colour)
    }

    /// Adds a thick line.
    pub(crate) fn line(&mut self, from: Point, to: Point, radius: f64, colour: Colour) -> Result<(), Error> {
        self.add(&rod(from, to, [radius, radius])?, |_| colour)
    }

    /// Adds a thick line that ends in a tip.
    pub(crate) fn arrow(&mut self, from: Point, to: Point, radius: f64, colour: Colour) -> Result<(), Error> {
        let length = distance(from, to);
        let neck = blend(to, from, (7.0 * radius / length).min(0.5));
        self.add(&rod(from, neck, [radius, radius])?, |_| colour)?;
        self.add(&rod(neck, to, [2.8 * radius, 0.0])?, |_| colour)
    }

    /// Adds lines along the edges of a mesh that `wanted` picks, given their ends.
    pub(crate) fn edges(
        &mut self,
        mesh: &Mesh,
        radius: f64,
        colour: Colour,
        wanted: impl Fn(Point, Point) -> bool,
    ) -> Result<(), Error> {
        let mut edges: Vec<[u32; 2]> = mesh
            .triangles
            .iter()
            .flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]])
            .map(|[u, v]| [u.min(v), u.max(v)])
            .collect();
        edges.sort_unstable();
        edges.dedup();
        for [u, v] in edges {
            let (p, q) = (mesh.positions[u as usize], mesh.positions[v as usize]);
            if p != q && wanted(p, q) {
                self.line(p, q, radius, colour)?;
            }
        }
        Ok(())
    }

    /// Draws what there is.
    pub(crate) fn draw(&self, view: &View) -> Picture {
        render::mesh(&self.mesh, view, Some(&self.colours))
    }
}

/// A view of a size, from a direction, on white.
pub(crate) fn view(width: u32, height: u32, direction: Point) -> View {
    let mut view = View::default();
    (view.width, view.height, view.direction) = (width, height, direction);
    view.background = [[255; 3]; 2];
    view
}

/// Pictures side by side.
pub(crate) fn beside(pictures: &[Picture]) -> Picture {
    let width = pictures.iter().map(Picture::width).sum();
    let height = pictures.iter().map(Picture::height).max().unwrap_or(0);
    let mut all = Picture::new(width, height, [255; 3]);
    let mut left = 0;
    for picture in pictures {
        paste(&mut all, picture, left, 0);
        left += i64::from(picture.width());
    }
    all
}

/// Copies a picture into another.
pub(crate) fn paste(target: &mut Picture, picture: &Picture, left: i64, top: i64) {
    for y in 0..picture.height() {
        for x in 0..picture.width() {
            if let Some(colour) = picture.get(x, y) {
                target.set(left + i64::from(x), top + i64::from(y), colour);
            }
        }
    }
}

/// The point a part of the way from one point to another.
pub(crate) fn blend(from: Point, to: Point, part: f64) -> Point {
    [0, 1, 2].map(|k| from[k] + part * (to[k] - from[k]))
}

fn distance(p: Point, q: Point) -> f64 {
    (0..3).map(|k| (q[k] - p[k]).powi(2)).sum::<f64>().sqrt()
}

/// A frustum from one point to another.
fn rod(from: Point, to: Point, radii: [f64; 2]) -> Result<Mesh, Error> {
    let length = distance(from, to);
    let along = [0, 1, 2].map(|k| (to[k] - from[k]) / length);
    // Two directions across, from the axis the line is least along.
    let axis = (1..3).fold(0, |best, k| if along[k].abs() < along[best].abs() { k } else { best });
    let mut helper = [0.0; 3];
    helper[axis] = 1.0;
    let cross = |u: Point, v: Point| {
        [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
    };
    let u = cross(along, helper);
    let size = distance([0.0; 3], u);
    let u = u.map(|x| x / size);
    let v = cross(along, u);
    let rod = primitives::frustum(radii[0], radii[1], length, 10)?;
    let mut matrix = [0.0; 16];
    for k in 0..3 {
        (matrix[4 * k], matrix[4 * k + 1]) = (u[k], v[k]);
        (matrix[4 * k + 2], matrix[4 * k + 3]) = (along[k], from[k]);
    }
    matrix[15] = 1.0;
    Ok(rod.transformed(&matrix)?)
}
