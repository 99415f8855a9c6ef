//! The curve in which two surfaces meet, on both, with nothing taken away.

use super::Sheet;
use crate::boolean::complex::ids::{FaceId, PointId};
use crate::boolean::complex::origin::Origin;
use crate::boolean::general::arrangement::{Crossed, General};
use crate::boolean::many::made::whole_polygons;
use crate::boolean::many::options::BooleanOptions;
use crate::boolean::result::origins::Origins;
use crate::exact::{Projection, collinear};
use crate::mesh::{Descent, Run, carry};
use crate::parallel::Runner;
use crate::polygon::{Overlay, Triangulator};
use crate::{Error, Mesh, MeshError};

/// A surface with the curve in which another meets it.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Imprinted {
    /// The surface. Where it was not met its triangles and vertices are as they were.
    pub mesh: Mesh,
    /// By triangle the one of the given surface that it is a piece of.
    pub origins: Vec<u32>,
    /// Triangles on which the curve is not drawn in full, because rounding has made it cross itself there; 0 nearly always.
    pub incomplete: usize,
}

impl BooleanOptions {
    /// Two surfaces, open or closed, with the curve in which they meet as edges of both: its vertices are the same on both, bit for
    /// bit. Nothing is taken away, and each is as closed as it was. Where they lie on each other in a plane nothing is drawn.
    ///
    /// ```
    /// use trisect::{BooleanOptions, Mesh};
    ///
    /// let corners = vec![[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]];
    /// let flat = Mesh::new(corners, vec![[0, 1, 2], [0, 2, 3]]);
    /// let corners = vec![[-2.0, 0.0, -1.0], [2.0, 0.0, -1.0], [2.0, 0.0, 1.0], [-2.0, 0.0, 1.0]];
    /// let upright = Mesh::new(corners, vec![[0, 1, 2], [0, 2, 3]]);
    /// let [a, b] = BooleanOptions::new().imprint(&flat, &upright)?;
    /// assert_eq!([a.mesh.area(), b.mesh.area()], [4.0, 8.0]);
    /// let on_both = a.mesh.positions.iter().filter(|point| b.mesh.positions.contains(point)).count();
    /// assert_eq!(on_both, 3);
    /// # Ok::<(), trisect::Error>(())
    /// ```
    ///
    /// # Errors
    /// As [`trim`](Self::trim), of both.
    pub fn imprint(&self, a: &Mesh, b: &Mesh) -> Result<[Imprinted; 2], Error> {
        let sheet = |operand: usize, surface| {
            let of_operand =
                |error: MeshError| Error::from(error).of_operand(operand, format!("surface {}", operand + 1));
            Sheet::new(surface).map_err(of_operand)
        };
        let sheets = [sheet(0, a)?, sheet(1, b)?];
        self.work(|_, runner| {
            let crossed = Crossed::of_open(&[&sheets[0].mesh, &sheets[1].mesh], runner)?;
            let general = General::without_labels(crossed, runner)?;
            let [a, b] = [0, 1].map(|owner| imprinted(&general, owner, &sheets[owner as usize], runner));
            Ok([a?, b?])
        })
    }
}

/// One of the surfaces.
fn imprinted(general: &General, owner: u32, of: &Sheet<'_>, runner: Runner<'_>) -> Result<Imprinted, Error> {
    let (surfaces, given) = (&general.surfaces, &*of.mesh);
    let mut numbers = vec![u32::MAX; general.lines.point_count() as usize];
    let (mut positions, mut triangles, mut origins, mut incomplete) = (Vec::new(), Vec::new(), Vec::new(), 0);
    let mut drawing = Drawing::default();
    for face in surfaces.faces().filter(|&face| surfaces.owner(face) == owner) {
        let vertices = surfaces.vertices(face).map(|v| PointId::new(v.number()));
        drawing.triangles.clear();
        if general.crossings.of_face(face).is_empty() {
            drawing.triangles.push(vertices.map(|point| general.identification.representative(point)));
        } else if !drawing.draw(general, face) {
            incomplete += 1;
        }
        for corners in &drawing.triangles {
            triangles.push(corners.map(|point| {
                let number = &mut numbers[point.index()];
                if *number == u32::MAX {
                    *number = positions.len() as u32;
                    positions.push(*general.lines.position(surfaces, point));
                }
                *number
            }));
            origins.push(surfaces.triangle(face));
        }
    }
    let mut mesh = Mesh::new(positions, triangles);
    mesh.groups = given.groups.clone();
    mesh.groups.select(&origins);
    let run = |&triangle: &u32| Run { source: 0, triangle, count: 1, reversed: false, whole: false };
    let runs: Vec<Run> = origins.iter().map(run).collect();
    let descent = Descent {
        sources: &[given],
        positions: &mesh.positions,
        triangles: &mesh.triangles,
        runs: &runs,
        unit: f64::EPSILON,
        beyond: &|_, _, _| None,
    };
    mesh.attributes = carry(&descent, runner)?;
    let origin = |&triangle: &u32| Origin { operand: 0, triangle, reversed: false };
    mesh.polygons = whole_polygons(&Origins::from_iter(origins.iter().map(origin)), &mesh, &[given]);
    origins.iter_mut().for_each(|origin| *origin = of.number[*origin as usize]);
    Ok(Imprinted { mesh, origins, incomplete })
}

/// Triangulates faces along all lines on them.
#[derive(Default)]
struct Drawing {
    triangulator: Triangulator,
    triangles: Vec<[PointId; 3]>,
}

impl Drawing {
    /// The triangles of a face; whether all lines on it are edges of them.
    fn draw(&mut self, general: &General, face: FaceId) -> bool {
        let General { surfaces, lines, .. } = general;
        let seen = Projection::of(&surfaces.positions(face));
        // 1. The outline, and the lines within.
        let within = lines_within(general, face);
        let outline = outline(general, face, &within);
        // 2. Local numbers.
        let mut ids: Vec<PointId> = outline.iter().copied().chain(within.iter().flatten().copied()).collect();
        ids.sort_unstable();
        ids.dedup();
        let local = |point: PointId| ids.partition_point(|&other| other < point) as u32;
        let points: Vec<[f64; 2]> =
            ids.iter().map(|&point| seen.project(lines.position(surfaces, point))).collect();
        let ring: Vec<u32> = outline.iter().map(|&point| local(point)).collect();
        let sides: Vec<[u32; 2]> = (0..ring.len()).map(|i| [ring[i], ring[(i + 1) % ring.len()]]).collect();
        let lines: Vec<[u32; 2]> = within.iter().map(|ends| ends.map(local)).collect();
        // 3. One triangulation with all of them; the outline alone where that cannot be.
        let all = [&sides[..], &lines[..]].concat();
        let found = Overlay::new(&points, &all).and_then(|overlay| overlay.inside(&points, &ring));
        let mut is_complete = found.is_some();
        let found = found.unwrap_or_else(|| {
            let mut triangles = Vec::new();
            self.triangulator.triangulate(&points, &sides, &mut triangles);
            triangles
        });
        if is_complete {
            let mut drawn: Vec<[u32; 2]> =
                found.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]).collect();
            drawn.sort_unstable();
            let is_drawn = |&[u, v]: &[u32; 2]| {
                drawn.binary_search(&[u, v]).is_ok() || drawn.binary_search(&[v, u]).is_ok()
            };
            is_complete = lines.iter().all(is_drawn);
        }
        self.triangles.extend(found.into_iter().map(|corners| corners.map(|v| ids[v as usize])));
        is_complete
    }
}

/// The points round a face. Of those of lines `within` it has what lies exactly on an open side: where two borders cross, the curve
/// ends on both, but only one of them pierces the other surface. (A side between two faces is left alone, or they would come apart.)
fn outline(general: &General, face: FaceId, within: &[[PointId; 2]]) -> Vec<PointId> {
    let General { surfaces, edges, crossings, lines, identification, .. } = general;
    let vertices = surfaces.vertices(face).map(|v| identification.representative(PointId::new(v.number())));
    let mut outline: Vec<PointId> = Vec::new();
    for k in 0..3 {
        let (edge, is_forward) = edges.of_side(surfaces, face, k);
        let nodes =
            lines.on_edge(edge).iter().map(|&node| identification.representative(crossings.point(node)));
        let mut along: Vec<PointId> = nodes.collect();
        if !is_forward {
            along.reverse();
        }
        if edges.sides(edge).len() == 1 {
            let place = |point: PointId| *lines.position(surfaces, point);
            add_touching(place, [vertices[k], vertices[(k + 1) % 3]], within, &mut along);
        }
        outline.push(vertices[k]);
        outline.extend(along);
    }
    outline.dedup();
    if outline.len() > 1 && outline.first() == outline.last() {
        outline.pop();
    }
    outline
}

/// Adds the ends of lines that lie exactly on a side, between its ends, to the points along it.
fn add_touching(
    place: impl Fn(PointId) -> [f64; 3],
    side: [PointId; 2],
    lines: &[[PointId; 2]],
    along: &mut Vec<PointId>,
) {
    let [from, to] = side.map(&place);
    let length = |axis: usize| (to[axis] - from[axis]).abs();
    let axis = (1..3).fold(0, |best, axis| if length(axis) > length(best) { axis } else { best });
    // How far along the side, in its direction.
    let way = |at: &[f64; 3]| if from[axis] < to[axis] { at[axis] } else { -at[axis] };
    for &point in lines.iter().flatten() {
        let at = place(point);
        let is_between = way(&from) < way(&at) && way(&at) < way(&to);
        if is_between && collinear(&from, &at, &to) && !along.contains(&point) {
            let next = along.partition_point(|&other| way(&place(other)) < way(&at));
            along.insert(next, point);
        }
    }
}

/// The pieces of lines on a face where it meets the other surface.
fn lines_within(general: &General, face: FaceId) -> Vec<[PointId; 2]> {
    let General { surfaces, crossings, lines, identification, .. } = general;
    let mut within: Vec<[PointId; 2]> = Vec::new();
    for &id in crossings.of_face(face) {
        let segment = crossings.segment(id);
        if surfaces.owner(segment.partner(face)) == surfaces.owner(face) {
            continue;
        }
        let points = lines.on_segment(id).iter().map(|&triple| lines.point(triple));
        let mut from = identification.representative(segment.tail);
        for to in points.chain([segment.head]).map(|point| identification.representative(point)) {
            if to != from {
                within.push([from, to]);
            }
            from = to;
        }
    }
    within
}
