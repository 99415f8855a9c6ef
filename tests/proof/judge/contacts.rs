//! The topology that a solid has where its surface touches itself, whatever way a mesh of it is connected there: along an
//! edge and in a vertex, touching material stays apart. Two meshes of one solid agree in it.

use std::collections::HashMap;

use trisect::Mesh;

use super::boxes::{Boxes, overlap};
use super::surface::Sets;
use super::vector::{Point, cross, dot, extent, length, minus, plus, unit};

/// Topology of a surface whose contacts are parted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Topology {
    pub(crate) components: usize,
    pub(crate) euler: i64,
}

/// What [`parted`] finds.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Parted {
    pub(crate) topology: Topology,
    /// Somewhere an edge lies on the inner side of a face: material is pinched there too, and the faces are not parted.
    pub(crate) pinched: bool,
    /// The edges, once for each wedge of material, at which the mesh joins faces that do not bound that wedge. Neither flat triangles are
    /// asked nor edges that are one only because vertices were joined: what goes through there is as thin as that. (Nor the two halves of
    /// a flat face that happens to be cut where an edge lies on its inner side: that is a pinch.)
    pub(crate) mispaired: Vec<[Point; 2]>,
}

/// A face after its sides are split at the vertices that lie on them.
struct Face {
    corners: Vec<usize>,
    triangle: [usize; 3],
    normal: Point,
    /// The triangle's number in the mesh.
    number: usize,
    /// For each corner the side of the triangle that it begins or is on.
    sides: Vec<usize>,
}

/// Where a face meets an edge: the face, its side, and whether the side runs from the edge's first vertex to its second.
struct Side {
    face: usize,
    side: usize,
    forward: bool,
    /// Angle of the face round the edge.
    angle: f64,
    /// By how much rounding may have turned the face, in radians, where that is small.
    uncertainty: f64,
}

impl Side {
    /// Whether the face is so thin that its angle is the work of rounding.
    fn is_needle(&self) -> bool {
        self.uncertainty >= 1.0
    }

    /// Whether two faces are halves of a flat one, and all others at the edge lie on its inner side: they touch it from inside.
    fn is_touched_with(&self, other: &Self, sides: &[Side]) -> bool {
        use std::f64::consts::{PI, TAU};
        let (forward, back) = if self.forward { (self, other) } else { (other, self) };
        // Material is behind a face that runs with the edge.
        let behind = |side: &Side| (forward.angle - side.angle).rem_euclid(TAU);
        let is_inside = |side: &&Side| (NO_ANGLE..PI - NO_ANGLE).contains(&behind(side));
        forward.forward != back.forward
            && (behind(back) - PI).abs() <= NO_ANGLE
            && sides.iter().filter(is_inside).count() + 2 == sides.len()
    }
}

/// Which of the sides at an edge one is.
fn place_of(sides: &[Side], side: &Side) -> usize {
    sides.iter().position(|other| std::ptr::eq(other, side)).expect("it is one of them")
}

/// Faces at no larger angle, in radians, lie on one another.
const NO_ANGLE: f64 = 1e-7;

/// What is no higher over an edge than so many units in the last place of the coordinates there may have been turned to any side by
/// rounding: a corner over the edge is off by half a unit along each axis, and so is the edge under it, by the shares of its ends (more
/// than one in all, if the corner is not over the edge itself). What was that high may be twice as high now: sqrt(3) units for
/// each share.
const NEEDLE_ULPS: f64 = 2.0;

/// A place on a side is computed to so many roundings of the side's length: the difference of its ends, the share, the product and the sum.
const SIDE_ROUNDINGS: f64 = 4.0;

/// The topology of `mesh` with its contacts parted. Vertices nearer than `reach` times the size of the mesh are one. Exact
/// where features are larger and contacts closer than that; `None` if the surface is not closed after joining them, or if
/// faces lie on one another.
pub(crate) fn parted(mesh: &Mesh, reach: f64) -> Option<Parted> {
    if mesh.triangles.is_empty() {
        return Some(Parted { topology: Topology::default(), pinched: false, mispaired: Vec::new() });
    }
    // About a vertex where details are smallest: far from it a place on a side is rounded, and would fall on vertices that are beside it.
    let origin = among_details(mesh);
    let positions: Vec<Point> = mesh.positions.iter().map(|p| minus(*p, origin)).collect();
    let [low, high] = extent(&positions);
    let near = reach * (0..3).map(|k| high[k] - low[k]).fold(0.0, f64::max);
    let (points, of) = joined(&positions, near);
    let numbered = mesh.triangles.iter().enumerate();
    let faces: Vec<Face> =
        numbered.filter_map(|(t, corners)| face(t, corners.map(|v| of[v as usize]), &points, near)).collect();
    let joined = Joined::new(mesh, &faces);
    let mut edges: HashMap<(usize, usize), Vec<Side>> = HashMap::new();
    let mut first = Vec::new();
    let mut corners = 0;
    for (index, face) in faces.iter().enumerate() {
        first.push(corners);
        corners += face.corners.len();
        for side in 0..face.corners.len() {
            let (u, v) = (face.corners[side], face.corners[(side + 1) % face.corners.len()]);
            let (from, to) = (u.min(v), u.max(v));
            let forward = u < v;
            let angle = angle_round(points[from], points[to], face.normal, forward);
            let corners = face.triangle.map(|v| points[v]);
            let uncertainty = uncertainty([points[from], points[to]], &corners, origin);
            edges.entry((from, to)).or_default().push(Side {
                face: index,
                side,
                forward,
                angle,
                uncertainty,
            });
        }
    }
    let boxes = Boxes::new(faces.iter().map(|face| extent(&face.triangle.map(|v| points[v]))));
    let is_pinched = |edge, sides: &[Side]| is_pinched(edge, sides, &faces, &boxes, &points, near);
    let mut pinched = edges.iter().any(|(edge, sides)| is_pinched(*edge, sides));
    let (mut fans, mut bodies) = (Sets::new(corners), Sets::new(faces.len()));
    let (mut pairs, mut mispaired) = (0, Vec::new());
    for (&edge, sides) in &edges {
        let is_one_edge = joined.are_at_one_place(&faces, sides);
        let wedges = match wedges(sides) {
            Some(wedges) => {
                wedges.into_iter().map(|(a, b)| [a, b].map(|side| place_of(sides, side))).collect()
            }
            // The face that the edge touches from inside goes on through it, and has no sides there.
            None if are_all_apart(sides) && is_pinched(edge, sides) => joined.pairs(&faces, sides),
            None => return None,
        };
        for [a, b] in wedges.into_iter().map(|pair: [usize; 2]| pair.map(|at| &sides[at])) {
            pairs += 1;
            bodies.join(a.face, b.face);
            let corner =
                |of: &Side, next: usize| first[of.face] + (of.side + next) % faces[of.face].corners.len();
            fans.join(corner(a, 0), corner(b, 1));
            fans.join(corner(a, 1), corner(b, 0));
            if !is_one_edge || !joined.otherwise(&faces, a, b) {
                continue;
            }
            let is_pinch = |side: &Side| {
                joined.across(&faces, side, sides).is_some_and(|across| side.is_touched_with(across, sides))
            };
            if is_pinch(a) || is_pinch(b) {
                pinched = true;
            } else {
                mispaired.push([edge.0, edge.1].map(|v| plus(points[v], origin, 1.0)));
            }
        }
    }
    let euler = fans.count() as i64 - pairs + faces.len() as i64;
    Some(Parted { topology: Topology { components: bodies.count(), euler }, pinched, mispaired })
}

/// How a mesh joins its triangles.
struct Joined<'m> {
    mesh: &'m Mesh,
    /// The triangle on each side of each edge, by the ends as that triangle passes them.
    passed: HashMap<(u32, u32), usize>,
    is_flat: Vec<bool>,
}

impl<'m> Joined<'m> {
    fn new(mesh: &'m Mesh, faces: &[Face]) -> Self {
        let mut is_flat = vec![true; mesh.triangles.len()];
        faces.iter().for_each(|face| is_flat[face.number] = false);
        let sides = |(t, corners): (usize, &[u32; 3])| {
            let corners = *corners;
            (0..3).map(move |k| ((corners[k], corners[(k + 1) % 3]), t))
        };
        Self { mesh, passed: mesh.triangles.iter().enumerate().flat_map(sides).collect(), is_flat }
    }

    /// Whether the vertices at both ends of an edge are where the others there are, to the last bit.
    fn are_at_one_place(&self, faces: &[Face], sides: &[Side]) -> bool {
        let mut ends: [Option<Point>; 2] = [None; 2];
        sides.iter().all(|side| {
            let face = &faces[side.face];
            [0, 1].into_iter().all(|step| {
                let at = (side.side + step) % face.corners.len();
                let before = (at + face.corners.len() - 1) % face.corners.len();
                if face.sides[at] == face.sides[before] {
                    // No vertex of its own, but one that lies on its side.
                    return true;
                }
                let vertex = self.mesh.triangles[face.number][face.sides[at]];
                let position = self.mesh.positions[vertex as usize];
                let end = usize::from((step == 0) != side.forward);
                *ends[end].get_or_insert(position) == position
            })
        })
    }

    /// The triangle that the mesh joins the face of `a` to across that side; `None` where that is a flat one.
    fn triangle_across(&self, faces: &[Face], a: &Side) -> Option<usize> {
        let (face, corners) = (&faces[a.face], self.mesh.triangles[faces[a.face].number]);
        let side = face.sides[a.side];
        let across = self.passed.get(&(corners[(side + 1) % 3], corners[side]));
        across.copied().filter(|&across| !self.is_flat[across])
    }

    /// Whether the mesh joins the face of `a` across that side to another one than that of `b`, and not to a flat one.
    fn otherwise(&self, faces: &[Face], a: &Side, b: &Side) -> bool {
        self.triangle_across(faces, a).is_some_and(|across| across != faces[b.face].number)
    }

    /// Of the sides at an edge, the one that the mesh joins the face of `a` to there.
    fn across<'s>(&self, faces: &[Face], a: &Side, sides: &'s [Side]) -> Option<&'s Side> {
        let across = self.triangle_across(faces, a)?;
        sides.iter().find(|other| faces[other.face].number == across && other.forward != a.forward)
    }

    /// The sides at an edge by twos, as the mesh joins them.
    fn pairs(&self, faces: &[Face], sides: &[Side]) -> Vec<[usize; 2]> {
        let forward = sides.iter().filter(|side| side.forward);
        let pairs = forward.filter_map(|a| Some([a, self.across(faces, a, sides)?]));
        pairs.map(|pair| pair.map(|side| place_of(sides, side))).collect()
    }
}

/// Whether a mesh touches itself along a segment: sides of four triangles and more run along it.
pub(crate) fn touches_itself_along(mesh: &Mesh, segment: &[Point; 2]) -> bool {
    let runs_along = |[from, to]: [Point; 2]| {
        let along = minus(to, from);
        let reach = SIDE_ROUNDINGS
            * f64::EPSILON
            * length(along).max(segment.iter().map(|p| length(*p)).fold(0.0, f64::max));
        segment.iter().all(|p| {
            let share = dot(minus(*p, from), along) / dot(along, along);
            length(minus(*p, plus(from, along, share.clamp(0.0, 1.0)))) <= reach
        })
    };
    let corners = mesh.triangles.iter().map(|corners| corners.map(|v| mesh.positions[v as usize]));
    let sides = corners.flat_map(|[a, b, c]| [[a, b], [b, c], [c, a]]);
    sides.filter(|side| runs_along(*side)).count() >= 4
}

/// An end of the shortest side.
fn among_details(mesh: &Mesh) -> Point {
    let ends = mesh.triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
    let ends = ends.map(|ends| ends.map(|v| mesh.positions[v as usize]));
    let sides = ends.map(|[from, to]| (length(minus(to, from)), from)).filter(|side| side.0 > 0.0);
    sides.min_by(|x, y| x.0.total_cmp(&y.0)).map_or([0.0; 3], |side| side.1)
}

/// One point for those nearer than `near`, and the number of each vertex's.
fn joined(positions: &[Point], near: f64) -> (Vec<Point>, Vec<usize>) {
    let mut points: Vec<Point> = Vec::new();
    // In order along x, so that only a few have to be looked at.
    let mut order: Vec<usize> = (0..positions.len()).collect();
    order.sort_by(|&i, &j| positions[i][0].total_cmp(&positions[j][0]));
    let mut of = vec![0; positions.len()];
    for &i in &order {
        let p = positions[i];
        let candidates = points.iter().enumerate().rev().take_while(|(_, q)| p[0] - q[0] <= near);
        let found = candidates.into_iter().find(|(_, q)| length(minus(p, **q)) <= near).map(|(at, _)| at);
        of[i] = found.unwrap_or_else(|| {
            points.push(p);
            points.len() - 1
        });
    }
    (points, of)
}

/// A triangle with the points on its sides as corners; nothing if it is flat.
fn face(number: usize, triangle: [usize; 3], points: &[Point], near: f64) -> Option<Face> {
    let [a, b, c] = triangle.map(|v| points[v]);
    let normal = cross(minus(b, a), minus(c, a));
    let longest = length(minus(b, a)).max(length(minus(c, b))).max(length(minus(a, c)));
    // What is flat is left out: on both sides of it the same points lie on its sides.
    if length(normal) <= 2.0 * near * longest {
        return None;
    }
    let [low, high] = extent(&[a, b, c]);
    // Points are in order along x.
    let first = points.partition_point(|p| p[0] < low[0] - near);
    let close: Vec<usize> = (first..points.len())
        .take_while(|&v| points[v][0] <= high[0] + near)
        .filter(|v| {
            !triangle.contains(v)
                && (0..3).all(|k| points[*v][k] >= low[k] - near && points[*v][k] <= high[k] + near)
        })
        .collect();
    let (mut corners, mut sides) = (Vec::new(), Vec::new());
    for side in 0..3 {
        let (from, to) = (triangle[side], triangle[(side + 1) % 3]);
        corners.push(from);
        let along = minus(points[to], points[from]);
        let squared = dot(along, along);
        let on_side = 2.0 * near + SIDE_ROUNDINGS * f64::EPSILON * squared.sqrt();
        let mut on: Vec<(f64, usize)> = close
            .iter()
            .map(|&v| (dot(minus(points[v], points[from]), along) / squared, v))
            .filter(|&(t, v)| {
                t > 0.0 && t < 1.0 && length(minus(points[v], plus(points[from], along, t))) <= on_side
            })
            .collect();
        on.sort_by(|a, b| a.0.total_cmp(&b.0));
        corners.extend(on.into_iter().map(|(_, v)| v));
        sides.resize(corners.len(), side);
    }
    Some(Face { corners, triangle, normal: unit(normal), number, sides })
}

/// The angle at which a face leaves an edge, looking from its end to its beginning.
fn angle_round(from: Point, to: Point, normal: Point, forward: bool) -> f64 {
    let axis = unit(minus(to, from));
    // Some direction across the edge to count from.
    let least = (0..3).fold(0, |least, k| if axis[k].abs() < axis[least].abs() { k } else { least });
    let mut helper = [0.0; 3];
    helper[least] = 1.0;
    let across = unit(cross(axis, helper));
    let up = cross(axis, across);
    let inward = cross(normal, if forward { axis } else { axis.map(|x| -x) });
    dot(inward, up).atan2(dot(inward, across))
}

/// How much rounding may have moved the highest corner of a triangle over an edge of it, as a part of its height.
fn uncertainty([from, to]: [Point; 2], corners: &[Point; 3], origin: Point) -> f64 {
    let along = minus(to, from);
    let largest =
        corners.iter().flat_map(|p| plus(*p, origin, 1.0)).fold(0.0f64, |most, x| most.max(x.abs()));
    let ulp = largest.next_up() - largest;
    let of_corner = |p: &Point| {
        let height = length(cross(unit(along), minus(*p, from)));
        let part = dot(minus(*p, from), along) / dot(along, along);
        NEEDLE_ULPS * (1.0 + part.abs() + (1.0 - part).abs()) * ulp / height
    };
    corners.iter().map(of_corner).fold(f64::INFINITY, f64::min)
}

/// Whether an edge lies on the inner side of some face, not only touching its rim.
fn is_pinched(
    edge: (usize, usize),
    sides: &[Side],
    faces: &[Face],
    boxes: &Boxes,
    points: &[Point],
    near: f64,
) -> bool {
    let (from, to) = (points[edge.0], points[edge.1]);
    let holds_some = |face: &Face| {
        let [a, b, c] = face.triangle.map(|v| points[v]);
        if [from, to].iter().any(|&p| dot(minus(p, a), face.normal).abs() > near) {
            return false;
        }
        // The part of the edge that is within the triangle.
        let (mut begin, mut end) = (0.0f64, 1.0f64);
        for (p, q) in [(a, b), (b, c), (c, a)] {
            let inward = unit(cross(face.normal, minus(q, p)));
            let depth = |at: Point| dot(minus(at, p), inward) - 4.0 * near;
            let (s, t) = (depth(from), depth(to));
            if s <= 0.0 && t <= 0.0 {
                return false;
            }
            if s < 0.0 {
                begin = begin.max(s / (s - t));
            } else if t < 0.0 {
                end = end.min(s / (s - t));
            }
        }
        let axis = unit(minus(to, from));
        let is_inside = |side: &Side| {
            let inward = cross(faces[side.face].normal, if side.forward { axis } else { axis.map(|x| -x) });
            dot(inward, face.normal) < 1e-7
        };
        begin < end && sides.iter().any(is_inside)
    };
    let [low, high] = extent(&[from, to]);
    let reach = [low.map(|x| x - near), high.map(|x| x + near)];
    let mut found = false;
    boxes.visit(
        |bounds| overlap(bounds, &reach),
        |number| {
            found = holds_some(&faces[number]);
            !found
        },
    );
    found
}

/// The pairs of faces that bound one wedge of material; `None` if they do not alternate, wherever needles are put.
fn wedges(sides: &[Side]) -> Option<Vec<(&Side, &Side)>> {
    if sides.len() == 2 {
        return (sides[0].forward != sides[1].forward).then(|| vec![(&sides[0], &sides[1])]);
    }
    let mut given: Vec<&Side> = sides.iter().collect();
    given.sort_by(|a, b| a.angle.total_cmp(&b.angle));
    let (needles, mut round): (Vec<&Side>, Vec<&Side>) = given.iter().partition(|side| side.is_needle());
    if sides.len() % 2 == 1 {
        return None;
    }
    for i in 0..round.len() {
        let next = (i + 1) % round.len();
        let turn = (round[next].angle - round[i].angle).rem_euclid(std::f64::consts::TAU);
        if round.len() == 1 || turn > NO_ANGLE {
            continue;
        }
        // Beside a very short edge even that may be rounding's; then either order will do.
        if round[i].uncertainty + round[next].uncertainty <= NO_ANGLE {
            return None;
        }
        if needles.is_empty() && !alternate(&round) {
            round.swap(i, next);
        }
    }
    // (So many at one edge are not told apart in reasonable time.)
    if needles.len() > 4 {
        return None;
    }
    let order = if !needles.is_empty() && alternate(&given) { given } else { with_needles(round, &needles)? };
    // A face that runs with the edge has its material behind it, in the sense of growing angles before it.
    let (count, start) = (order.len(), usize::from(order[0].forward));
    Some(
        (0..count / 2)
            .map(|k| (order[(start + 2 * k) % count], order[(start + 2 * k + 1) % count]))
            .collect(),
    )
}

/// Whether no two faces at an edge lie on one another, and none is so thin that it may.
fn are_all_apart(sides: &[Side]) -> bool {
    let is_apart = |x: &Side, y: &Side| {
        let turn = (x.angle - y.angle).rem_euclid(std::f64::consts::TAU);
        (NO_ANGLE..std::f64::consts::TAU - NO_ANGLE).contains(&turn)
    };
    let pairs = sides.iter().enumerate().flat_map(|(i, x)| sides[..i].iter().map(move |y| (x, y)));
    !sides.iter().any(Side::is_needle) && pairs.into_iter().all(|(x, y)| is_apart(x, y))
}

fn alternate(order: &[&Side]) -> bool {
    (0..order.len()).all(|i| order[i].forward != order[(i + 1) % order.len()].forward)
}

/// The first order, of those that leave all but needles as they are, in which faces alternate.
fn with_needles<'a>(order: Vec<&'a Side>, needles: &[&'a Side]) -> Option<Vec<&'a Side>> {
    let Some((first, rest)) = needles.split_first() else { return alternate(&order).then_some(order) };
    (0..=order.len()).find_map(|at| {
        let mut order = order.clone();
        order.insert(at, first);
        with_needles(order, rest)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::judge::cells::Cells;

    #[test]
    fn cells_are_parted_as_counted() {
        for bits in 0..256 {
            let cells = Cells::new([0; 3], [2; 3], |[x, y, z]| bits >> (x + 2 * y + 4 * z) & 1 == 1);
            let surface = cells.surface();
            let topology = Topology { components: surface.components, euler: surface.euler };
            assert_eq!(
                parted(&surface.mesh, 1e-9),
                Some(Parted { topology, pinched: false, mispaired: Vec::new() }),
                "{bits}"
            );
        }
    }

    #[test]
    fn hanging_vertices_are_found() {
        // Boxes of different lengths that touch along a part of an edge, as one mesh and apart.
        let boxed = |low, high| trisect::primitives::cuboid(low, high).expect("a box");
        let mut mesh = boxed([0.0; 3], [1.0, 1.0, 3.0]);
        mesh.append(&boxed([1.0, 1.0, 1.0], [2.0, 2.0, 5.0])).expect("small");
        let topology = Topology { components: 2, euler: 4 };
        assert_eq!(parted(&mesh, 1e-9), Some(Parted { topology, pinched: false, mispaired: Vec::new() }));
    }

    #[test]
    fn an_edge_on_the_inner_side_of_a_face_is_a_pinch() {
        // A roof whose ridge, turned down, touches the floor; and the same a little higher.
        for (depth, pinched) in [(1.0, true), (0.9, false)] {
            let notched = [[0.0, 0.0], [4.0, 0.0], [4.0, 1.0], [2.0, 1.0 - depth], [0.0, 1.0]];
            let mesh = trisect::primitives::extrusion(&notched, &[], 1.0);
            let Ok(mesh) = mesh else { continue };
            assert_eq!(parted(&mesh, 1e-9).map(|parted| parted.pinched), Some(pinched));
        }
    }

    #[test]
    fn needles_that_rounding_turned_are_put_where_faces_alternate() {
        let side = |angle: f64, forward, needle| {
            let uncertainty = if needle { 2.0 } else { 1e-15 };
            Side { face: 0, side: 0, forward, angle, uncertainty }
        };
        // As found at coordinates of 1e12 (seed 4294968311): the first is 0.0004 high, of four units.
        for (needle, found) in [(true, true), (false, false)] {
            let sides = [
                side(-2.8, false, needle),
                side(-1.7, false, false),
                side(0.0, true, false),
                side(3.1, true, false),
            ];
            assert_eq!(wedges(&sides).is_some(), found);
        }
        // What does not alternate without needles is not made to.
        let sides =
            [side(0.0, true, false), side(0.0, false, false), side(1.0, true, true), side(2.0, false, true)];
        assert!(wedges(&sides).is_none());
    }

    #[test]
    fn walls_of_no_thickness_are_not_a_topology() {
        let boxed = |low, high| trisect::primitives::cuboid(low, high).expect("a box");
        let mut mesh = boxed([0.0; 3], [1.0; 3]);
        mesh.append(&boxed([1.0, 0.0, 0.0], [2.0, 1.0, 1.0])).expect("small");
        assert_eq!(parted(&mesh, 1e-9), None);
    }
}
