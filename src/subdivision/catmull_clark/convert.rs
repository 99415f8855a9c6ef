//! A cage of triangles whose Loop surface is near the Catmull-Clark surface of a cage of polygons, by least squares.

use glam::{DMat3, DVec3};

use super::PolygonCage;
use super::level::PolygonLevel;
use super::limit_mesh;
use crate::spatial::TriangleTree;
use crate::subdivision::error::CageError;
use crate::subdivision::freeform::solve::{Equation, solve, weighted};
use crate::subdivision::level::{Level, NONE};
use crate::subdivision::refine::{Row, add};
use crate::subdivision::rules::Rules;
use crate::subdivision::{ControlMesh, LimitMesh};
use crate::{Error, Mesh};

/// A cage of triangles that stands for a cage of polygons.
#[derive(Clone, Debug)]
pub struct Converted {
    /// The cage of triangles.
    pub cage: ControlMesh,
    /// The largest distance between both surfaces, in either direction, as far as measured: at vertices and middles of triangles
    /// an eighth as wide as the faces.
    pub distance: f64,
    /// How often the polygons were subdivided first.
    pub steps: usize,
}

/// Subdivisions of the polygons at most before they become triangles, beyond those without which it cannot be done.
const MOST_STEPS: usize = 3;
/// Each quad has samples on a grid so many subdivisions finer: 4 x 4 of them, twenty-five for some three unknowns.
const SAMPLE_STEPS: usize = 2;
/// Both surfaces are measured so many subdivisions finer than the quads.
const MEASURE_STEPS: usize = 3;
/// Rounds of fitting to tangent planes: the distance falls hardly any further after three.
const ROUNDS: usize = 3;
/// What a way along the surface weighs in them.
const ALONG: f64 = 0.05;
/// Pull towards the points one begins with, against equations that say nothing.
const RIDGE: f64 = 1e-9;

impl PolygonCage {
    /// A cage of triangles whose surface, by Loop's scheme, is as near to this one's as `tolerance`, or as near as three
    /// subdivisions make it; creases and corners stay such. Its control points are others: polygons are subdivided until they
    /// are quads without passing sharpness, split along their shorter diagonals, and control points are fitted to the limit
    /// surface.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] for a tolerance that is not positive; [`Error::TooLarge`] for too many faces.
    pub fn to_loop(&self, tolerance: f64) -> Result<Converted, Error> {
        if !(tolerance > 0.0) {
            return Err(Error::InvalidArgument(format!("a tolerance must be positive, not {tolerance}")));
        }
        let least = (self.level.most_finite().ceil() as usize)
            .max(usize::from(self.faces().any(|face| face.len() != 4)));
        let mut best: Option<Converted> = None;
        for steps in least..=least.max(MOST_STEPS) {
            let (level, points) = self.refined(steps)?;
            let next = fitted(&level, &points, steps)?;
            let done = next.distance <= tolerance;
            if best.as_ref().is_none_or(|best| next.distance < best.distance) {
                best = Some(next);
            }
            if done {
                break;
            }
        }
        best.ok_or_else(|| CageError::Operation("a cage without faces".into()).into())
    }
}

/// The cage of triangles over quads.
fn fitted(level: &PolygonLevel, points: &[DVec3], steps: usize) -> Result<Converted, Error> {
    // 1. What the surface is, at the vertices of a finer level.
    let (mut fine, mut fine_points) = (level.clone(), points.to_vec());
    for _ in 0..SAMPLE_STEPS {
        (fine, fine_points) = fine.refined(&fine_points);
    }
    let limits: Vec<DVec3> = (0..level.vertex_count as u32).map(|v| fine.limit(v, &fine_points)).collect();
    // 2. Quads as triangles, and where the samples of those are among the finer vertices.
    let (triangles, starts) = triangulated(level, &limits);
    let positions = points.iter().map(DVec3::to_array).collect();
    let cage = ControlMesh::new(positions, triangles, level.tags(), Rules::Loop)?;
    let (samples, rows) = rows(cage.level());
    let targets = targets(&samples, &fine, &starts, cage.faces().len());
    // 3. Least squares.
    let mut equations = Vec::with_capacity(rows.len());
    for (row, target) in rows.iter().zip(&targets) {
        if let &Some(vertex) = target {
            let target = fine.limit(vertex, &fine_points);
            equations.push(Equation {
                row: row.to_vec(),
                known: DVec3::ZERO,
                target,
                weight: DMat3::IDENTITY,
            });
        }
    }
    let mut unknowns = points.to_vec();
    for _ in 0..2 {
        solve(&equations, &mut unknowns, RIDGE);
    }
    // 4. Points need not be at their own places of the surface, if only they are on it: where nothing is sharp, distances from
    //    tangent planes count.
    let asked = limit_mesh::of_steps(level.clone(), points.to_vec(), MEASURE_STEPS)?;
    let tree = TriangleTree::new(&asked);
    let is_free = |vertex: usize| !samples.has_sharp[vertex];
    let of_equation: Vec<usize> = (0..rows.len()).filter(|&vertex| targets[vertex].is_some()).collect();
    let mut best = (f64::INFINITY, cage.clone());
    for round in 0..=ROUNDS {
        let fitted = cage.with_points(&unknowns);
        let distance = apart(&fitted.limit_mesh_of_steps(MEASURE_STEPS)?, &asked, &tree);
        if distance < best.0 {
            best = (distance, fitted);
        }
        if round < ROUNDS {
            for (equation, _) in
                equations.iter_mut().zip(&of_equation).filter(|(_, vertex)| is_free(**vertex))
            {
                let x = equation
                    .row
                    .iter()
                    .fold(DVec3::ZERO, |sum, &(v, weight)| sum + unknowns[v as usize] * weight);
                if let Some(found) = tree.closest_from(x.to_array(), None) {
                    let [a, b, c] = asked.triangles[found.triangle as usize]
                        .map(|v| DVec3::from(asked.positions[v as usize]));
                    let normal = (b - a).cross(c - a).normalize_or_zero();
                    (equation.target, equation.weight) = (found.point.into(), weighted(normal, 1.0, ALONG));
                }
            }
            solve(&equations, &mut unknowns, RIDGE);
        }
    }
    Ok(Converted { distance: best.0, cage: best.1, steps })
}

/// Each quad along its shorter diagonal between limits; for each triangle the quad's corner it begins at.
fn triangulated(level: &PolygonLevel, limits: &[DVec3]) -> (Vec<[u32; 3]>, Vec<u8>) {
    let mut triangles = Vec::with_capacity(2 * level.face_count());
    let mut starts = Vec::with_capacity(2 * level.face_count());
    for f in 0..level.face_count() {
        let face = level.face(f);
        let length = |i: usize| limits[face[i] as usize].distance(limits[face[i + 2] as usize]);
        let first = usize::from(length(1) < length(0) * (1.0 - 1e-9));
        let corner = |i: usize| face[(first + i) % 4];
        triangles.extend([[corner(0), corner(1), corner(2)], [corner(0), corner(2), corner(3)]]);
        starts.extend([first as u8; 2]);
    }
    (triangles, starts)
}

/// The level of the samples, and its vertices' limits as rows over the first level's.
fn rows(level: &Level) -> (Level, Vec<Row>) {
    let mut fine = level.clone();
    let mut of_vertex: Vec<Row> =
        (0..level.vertex_count as u32).map(|v| Row::from_slice(&[(v, 1.0)])).collect();
    let combined = |row: &Row, of_vertex: &[Row]| {
        let mut all = Row::new();
        row.iter().for_each(|&(v, weight)| add(&mut all, &of_vertex[v as usize], weight));
        all
    };
    for _ in 0..SAMPLE_STEPS {
        let (next, rows) = fine.refined();
        of_vertex = rows.iter().map(|row| combined(row, &of_vertex)).collect();
        fine = next;
    }
    let limits = (0..fine.vertex_count as u32).map(|v| combined(&fine.limit_row(v), &of_vertex)).collect();
    (fine, limits)
}

/// For each sample the finer vertex of the quads at the same place.
fn targets(samples: &Level, fine: &PolygonLevel, starts: &[u8], triangles: usize) -> Vec<Option<u32>> {
    let mut targets = vec![None; samples.vertex_count];
    let n = 1usize << SAMPLE_STEPS;
    for t in 0..triangles {
        let grid = grid(fine, t / 2, SAMPLE_STEPS);
        // Corners of the quad in its grid; its first triangle has three of them from the first on, the other the last two.
        let corners = [[0, 0], [n, 0], [n, n], [0, n]];
        let at = |i: usize| corners[(usize::from(starts[t]) + i) % 4];
        let places = if t % 2 == 1 { [at(0), at(2), at(3)] } else { [at(0), at(1), at(2)] };
        note(samples, t as u32, SAMPLE_STEPS, places.map(|p| p.map(|x| x as u32)), &mut |vertex, [x, y]| {
            targets[vertex as usize] = Some(grid[y as usize * (n + 1) + x as usize]);
        });
    }
    targets
}

/// The vertices of a level over quad `q` of the level `depth` steps above: that at (x, y) is number y (2^depth + 1) + x, x along the
/// quad's first side.
fn grid(level: &PolygonLevel, q: usize, depth: usize) -> Vec<u32> {
    let n = 1usize << depth;
    let mut grid = vec![NONE; (n + 1) * (n + 1)];
    fill(level, q, depth, (&mut grid, n), [0, 0], [n as i32, 0]);
    grid
}

/// Notes the corners of all quads that quad `q` of the level `depth` steps above has become. `along` leads from its first corner
/// to its second one, a quarter turn further to its last one.
fn fill(
    level: &PolygonLevel,
    q: usize,
    depth: usize,
    (grid, n): (&mut [u32], usize),
    at: [i32; 2],
    along: [i32; 2],
) {
    let turned = |[x, y]: [i32; 2]| [-y, x];
    let sum = |[a, b]: [i32; 2], [c, d]: [i32; 2]| [a + c, b + d];
    let left = turned(along);
    let places = [at, sum(at, along), sum(sum(at, along), left), sum(at, left)];
    if depth == 0 {
        for k in 0..4 {
            let [x, y] = places[k];
            grid[y as usize * (n + 1) + x as usize] = level.corners[4 * q + k];
        }
        return;
    }
    let mut half = along.map(|x| x / 2);
    for (k, &place) in places.iter().enumerate() {
        fill(level, 4 * q + k, depth - 1, (&mut *grid, n), place, half);
        half = turned(half);
    }
}

/// Tells the corners of all triangles that a triangle of the level `depth` steps above has become, with their places.
fn note(level: &Level, face: u32, depth: usize, places: [[u32; 2]; 3], told: &mut impl FnMut(u32, [u32; 2])) {
    if depth == 0 {
        for k in 0..3 {
            told(level.faces[face as usize][k], places[k]);
        }
        return;
    }
    let middle = |a: usize, b: usize| [0, 1].map(|axis| (places[a][axis] + places[b][axis]) / 2);
    let middles = [middle(0, 1), middle(1, 2), middle(2, 0)];
    for k in 0..3 {
        note(level, 4 * face + k as u32, depth - 1, [places[k], middles[k], middles[(k + 2) % 3]], told);
    }
    note(level, 4 * face + 3, depth - 1, middles, told);
}

/// The largest distance between two surfaces, from vertices and middles of the triangles of either to the other.
fn apart(own: &LimitMesh, asked: &Mesh, tree: &TriangleTree) -> f64 {
    let own_tree = TriangleTree::new(own.mesh());
    let from = |mesh: &Mesh, tree: &TriangleTree| {
        let middles = mesh.triangles.iter().map(|corners| {
            let [a, b, c] = corners.map(|v| DVec3::from(mesh.positions[v as usize]));
            ((a + b + c) / 3.0).to_array()
        });
        let mut guess = None;
        mesh.positions.iter().copied().chain(middles).fold(0.0f64, |largest, x| {
            let Some(found) = tree.closest_from(x, guess) else { return largest };
            guess = Some(found.triangle);
            largest.max(DVec3::from(x).distance(found.point.into()))
        })
    };
    from(own.mesh(), tree).max(from(asked, &own_tree))
}
