//! One known label for each piece of surface, by a ray; and the radial order of faces round edges that have many.
//!
//! Beside its vertex v with the largest x a piece of surface does not reach into the direction +x. So the label there is the
//! signed count of the other faces that a ray from v in +x crosses. Turning from +x round the z axis through v, the first edge
//! of v that is met has this label on the side from which it is met.

use super::edges::{Edges, Side};
use super::pairs::FaceBoxes;
use super::surfaces::Surfaces;
use crate::Error;
use crate::boolean::complex::Corner;
use crate::boolean::complex::ids::{EdgeId, FaceId, VertexId};
use crate::boolean::complex::predicates::{Perturbed, Predicates};
use crate::boolean::complex::rays::{Ray, coordinate_past, signed_crossing};
use crate::exact::Sign;
use crate::exact::perturbed::{self, PerturbedPoint, jitter};
use crate::mesh::{Bounds, Buckets};
use crate::parallel::Runner;

/// The label on the outer side of a face at one end of an edge of it.
#[derive(Clone, Debug)]
pub(crate) struct Seed {
    pub(crate) side: Side,
    pub(crate) at_low: bool,
    /// Winding numbers by operand.
    pub(crate) label: Vec<(u32, i32)>,
}

/// Puts the faces round every edge with more than two into radial order: counter-clockwise about the direction from its low end
/// to its high end.
pub(crate) fn sort_radially(surfaces: &Surfaces, edges: &mut Edges) -> u64 {
    let predicates = Predicates::new(surfaces);
    let many: Vec<EdgeId> =
        edges.iter().map(|(edge, _)| edge).filter(|&edge| edges.sides(edge).len() > 2).collect();
    for edge in many {
        let [low, high] = edges.ends(edge).map(|v| surfaces.corner(v));
        let opposite = |side: &Side| {
            let corners = surfaces.vertices(side.face());
            surfaces.corner(corners[(side.place() + 2) % 3])
        };
        let sides = edges.sides_mut(edge);
        let first = opposite(&sides[0]);
        // More than half a turn after the first face.
        let is_late = |x: &Corner| x.id != first.id && predicates.is_positive(&low, &high, &first, x);
        sides[1..].sort_by(|x, y| {
            let (x, y) = (opposite(x), opposite(y));
            if x.id == y.id {
                return std::cmp::Ordering::Equal;
            }
            is_late(&x).cmp(&is_late(&y)).then_with(|| {
                // Within half a turn, what lies below the face through x comes before it.
                if predicates.is_positive(&low, &high, &x, &y) {
                    std::cmp::Ordering::Greater
                } else {
                    std::cmp::Ordering::Less
                }
            })
        });
    }
    predicates.into_contacts()
}

/// The last vertex of each piece of surface in x, perturbed; `None` for one without vertices.
pub(crate) fn last_vertices(surfaces: &Surfaces) -> Vec<Option<VertexId>> {
    let mut last: Vec<Option<VertexId>> = vec![None; surfaces.component_count() as usize];
    for vertex in (0..surfaces.vertex_count()).map(VertexId::new) {
        let last = &mut last[surfaces.component_of_vertex(vertex) as usize];
        if last.is_none_or(|last| is_further(surfaces, vertex, last)) {
            *last = Some(vertex);
        }
    }
    last
}

/// Rays up to which it is cheaper to look at every face for each than to make a hierarchy of all: that costs as much as 8.6 looks
/// (328,000 triangles of a ball).
const FEW_RAYS: usize = 8;

/// Whether the box of a triangle meets the ray in +x from a point.
fn may_cross(start: &[f64; 3], [a, b, c]: &[[f64; 3]; 3]) -> bool {
    let meets = |k: usize| a[k].min(b[k]).min(c[k]) <= start[k] && start[k] <= a[k].max(b[k]).max(c[k]);
    a[0].max(b[0]).max(c[0]) >= start[0] && meets(1) && meets(2)
}

/// The seeds of all pieces of surface, in their order; `last` are their last vertices.
///
/// # Errors
/// Only limits.
pub(crate) fn find(
    surfaces: &Surfaces,
    edges: &Edges,
    bounds: &Bounds,
    last: &[Option<VertexId>],
    boxes: Option<FaceBoxes>,
    runner: Runner<'_>,
) -> Result<(Vec<Seed>, u64), Error> {
    // 1. The edges at these vertices.
    let count = last.len();
    let mut component_of_last = rustc_hash::FxHashMap::default();
    for (component, vertex) in (0..).zip(last) {
        component_of_last.extend(vertex.map(|vertex| (vertex, component)));
    }
    let at_last = edges.iter().flat_map(|(edge, ends)| {
        ends.map(|end| component_of_last.get(&end).map(|&component| (component, edge)))
    });
    let at_last: Vec<(u32, EdgeId)> = at_last.flatten().collect();
    let at_last = Buckets::new(count, at_last.into_iter());
    // 2. A ray from each.
    let predicates = Predicates::new(surfaces);
    let boxes = boxes.or_else(|| (count > FEW_RAYS).then(|| FaceBoxes::new(surfaces, bounds)));
    let search = Search { surfaces, edges, predicates };
    let end_x = coordinate_past(bounds.low[0], bounds.high[0]);
    let seeds = runner.pieces(count, 1, |range| {
        let component = range.start;
        // Pieces without faces are vertices that only left-out triangles had.
        let vertex = last[component].filter(|_| !at_last.get(component).is_empty())?;
        let mut crossed = Vec::new();
        if count > 1 {
            let start = surfaces.corner(vertex);
            let id = VertexId::new(surfaces.vertex_count() + component as u32);
            let end = Corner { id, position: [end_x, start.position[1], start.position[2]] };
            let ray = Ray { start, end };
            let mut visit = |face| crossed.extend(search.crossed(face, &ray, component as u32));
            match &boxes {
                Some(boxes) => boxes.meeting([&ray.start.position, &ray.end.position], visit),
                None => {
                    let may_cross =
                        |face: &FaceId| may_cross(&ray.start.position, &surfaces.positions(*face));
                    surfaces.faces().filter(may_cross).for_each(&mut visit);
                }
            }
        }
        Some(search.seed(vertex, at_last.get(component), crossed))
    })?;
    Ok((seeds.into_iter().flatten().collect(), search.predicates.into_contacts()))
}

impl Default for EdgeId {
    fn default() -> Self {
        Self::NONE
    }
}

/// Whether a vertex lies further in x than another, perturbed.
fn is_further(surfaces: &Surfaces, x: VertexId, y: VertexId) -> bool {
    let (at_x, at_y) = (surfaces.position(x)[0], surfaces.position(y)[0]);
    if at_x != at_y {
        return at_x > at_y;
    }
    let key = |v: VertexId| (surfaces.first_direction(v)[0], jitter(u64::from(v.number()))[0], v);
    key(x) > key(y)
}

struct Search<'a> {
    surfaces: &'a Surfaces,
    edges: &'a Edges,
    predicates: Predicates<'a>,
}

impl Search<'_> {
    /// The owner of a face that a ray crosses and by how much its winding number is larger before.
    fn crossed(&self, face: FaceId, ray: &Ray, component: u32) -> Option<(u32, i32)> {
        if self.surfaces.component(face) == component {
            return None;
        }
        let sign = signed_crossing(&self.predicates, &self.surfaces.corners(face), ray);
        (sign != 0).then(|| (self.surfaces.owner(face), sign * self.surfaces.step(face)))
    }

    /// The label beside a vertex, given that in +x, as the label of a face.
    fn seed(&self, vertex: VertexId, around: &[EdgeId], crossed: Vec<(u32, i32)>) -> Seed {
        let point = |v: VertexId| self.surfaces.perturbed(&self.surfaces.corner(v));
        // 1. The edge that is met first.
        let v = point(vertex);
        let mut above = v;
        above.position[2] = coordinate_above(v.position[2]);
        let other = |edge: EdgeId| {
            let [low, high] = self.edges.ends(edge);
            if low == vertex { high } else { low }
        };
        let is_before = |a: &PerturbedPoint, b: &PerturbedPoint| {
            perturbed::orient3d([a, b, &above, &v]) == Sign::Positive
        };
        let first = around.iter().copied().reduce(|best, edge| {
            if is_before(&point(other(edge)), &point(other(best))) { edge } else { best }
        });
        let edge = first.expect("a vertex has edges");
        // 2. The face at it that no other lies before, turning about the way from the vertex.
        let end = self.surfaces.corner(other(edge));
        let v = self.surfaces.corner(vertex);
        let opposite = |side: &Side| {
            let corners = self.surfaces.vertices(side.face());
            self.surfaces.corner(corners[(side.place() + 2) % 3])
        };
        let sides = self.edges.sides(edge);
        let side = sides.iter().copied().reduce(|best, side| {
            let (x, y) = (opposite(&best), opposite(&side));
            if self.predicates.is_positive(&v, &end, &x, &y) { side } else { best }
        });
        let side = side.expect("an edge has faces");
        // 3. Before a face whose side runs from the vertex on is its inner side.
        let (face, k) = (side.face(), side.place());
        let mut label = add_up(crossed);
        if self.surfaces.vertices(face)[k] == vertex {
            label.push((self.surfaces.owner(face), -self.surfaces.step(face)));
            label = add_up(label);
        }
        let at_low = self.edges.ends(edge)[0] == vertex;
        Seed { side, at_low, label }
    }
}

/// A larger coordinate than one below the largest there is, exactly.
fn coordinate_above(z: f64) -> f64 {
    match z {
        z if z < 0.0 => 0.0,
        0.0 => 1.0,
        z => (2.0 * z).min(f64::MAX),
    }
}

/// Entries of the same operand added up.
fn add_up(mut entries: Vec<(u32, i32)>) -> Vec<(u32, i32)> {
    entries.sort_unstable();
    let groups = entries.chunk_by(|x, y| x.0 == y.0);
    groups.map(|group| (group[0].0, group.iter().map(|entry| entry.1).sum())).collect()
}
