//! A closed surface that can be changed edge by edge: every vertex knows its triangles.

use glam::DVec3;
use smallvec::SmallVec;

use super::stirred::{Stirred, Task};

/// What may be done with a vertex.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// On a smooth part of the surface: it may move and go.
    Free,
    /// On a crease that passes through: it may go along it.
    Crease,
    /// A corner, an end of a crease, or anything else that has to stay.
    Fixed,
    /// Its triangles stay as they are.
    Frozen,
}

#[derive(Clone, Debug)]
pub(super) struct Vertex {
    pub(super) place: DVec3,
    /// The unit normals of the surface there, outward: one, or those of the sides that meet.
    pub(super) normals: SmallVec<[DVec3; 1]>,
    pub(super) kind: Kind,
    /// It does not move, and goes only where triangles face quite another way than the surface.
    pub(super) calm: bool,
}

impl Vertex {
    pub(super) fn free(place: DVec3, normal: DVec3) -> Self {
        Self { place, normals: SmallVec::from_elem(normal, 1), kind: Kind::Free, calm: false }
    }

    /// Which of the normals is that of the side that faces the way of `side`.
    pub(super) fn facing(&self, side: DVec3) -> usize {
        let mut best = 0;
        for k in 1..self.normals.len() {
            if self.normals[k].dot(side) > self.normals[best].dot(side) {
                best = k;
            }
        }
        best
    }

    /// The normal on the side that faces the way of `side`.
    pub(super) fn normal(&self, side: DVec3) -> DVec3 {
        self.normals.get(self.facing(side)).copied().unwrap_or(side)
    }
}

/// A removed triangle.
const GONE: [u32; 3] = [u32::MAX; 3];

/// Triangles around a vertex.
pub(super) type Star = SmallVec<[u32; 8]>;

/// A closed 2-manifold of triangles. Removed vertices have no triangles.
#[derive(Clone)]
pub(super) struct Net {
    pub(super) vertices: Vec<Vertex>,
    triangles: Vec<[u32; 3]>,
    /// For every triangle which way the surface there faces: it tells which of several normals of a corner is meant.
    sides: Vec<DVec3>,
    stars: Vec<Star>,
    /// Where triangles around a vertex have changed since they were looked at.
    pub(super) stirred: Stirred,
    /// What changes on trial began from.
    before: Option<Before>,
}

/// Triangles and stars as they were before a change on trial, each as often as it was changed, and how many of all there were.
#[derive(Clone, Debug, Default)]
struct Before {
    triangles: Vec<(u32, [u32; 3], DVec3)>,
    stars: Vec<(u32, Star)>,
    vertices: usize,
    count: usize,
}

impl Net {
    pub(super) fn new(vertices: Vec<Vertex>, triangles: Vec<[u32; 3]>, sides: Vec<DVec3>) -> Self {
        let mut stars = vec![Star::new(); vertices.len()];
        for (number, corners) in (0..).zip(&triangles) {
            for &corner in corners {
                stars[corner as usize].push(number);
            }
        }
        let stirred = Stirred::all(vertices.len());
        Self { vertices, triangles, sides, stars, stirred, before: None }
    }

    pub(super) fn vertex(&self, vertex: u32) -> &Vertex {
        &self.vertices[vertex as usize]
    }

    pub(super) fn place(&self, vertex: u32) -> DVec3 {
        self.vertices[vertex as usize].place
    }

    pub(super) fn is(&self, vertex: u32, kind: Kind) -> bool {
        self.vertices[vertex as usize].kind == kind
    }

    pub(super) fn corners(&self, triangle: u32) -> [u32; 3] {
        self.triangles[triangle as usize]
    }

    pub(super) fn side(&self, triangle: u32) -> DVec3 {
        self.sides[triangle as usize]
    }

    /// Tells which way the surface faces at a triangle.
    pub(super) fn turn(&mut self, triangle: u32, side: DVec3) {
        self.sides[triangle as usize] = side;
    }

    pub(super) fn is_present(&self, triangle: u32) -> bool {
        self.corners(triangle) != GONE
    }

    pub(super) fn star(&self, vertex: u32) -> &[u32] {
        &self.stars[vertex as usize]
    }

    /// The triangles that are not removed, with their numbers.
    pub(super) fn present(&self) -> impl Iterator<Item = (u32, [u32; 3])> {
        (0..).zip(self.triangles.iter().copied()).filter(|&(_, corners)| corners != GONE)
    }

    /// The ends of all edges, the lower one first, in the order of the triangles.
    pub(super) fn edges(&self) -> impl Iterator<Item = [u32; 2]> {
        let sides = |[a, b, c]: [u32; 3]| [[a, b], [b, c], [c, a]];
        self.present().flat_map(move |(_, corners)| sides(corners)).filter(|[a, b]| a < b)
    }

    /// The edges with an end where something has changed since they were last looked at for this, which they are now.
    pub(super) fn stirred_edges(&mut self, task: Task) -> Vec<[u32; 2]> {
        let is_new = |edge: &[u32; 2]| edge.iter().any(|&end| self.stirred.for_task(end, task));
        let edges = self.edges().filter(is_new).collect();
        self.stirred.settle_all(task);
        edges
    }

    /// The two triangles at an edge: that which goes from `a` to `b`, and that which goes back.
    pub(super) fn beside(&self, a: u32, b: u32) -> Option<[u32; 2]> {
        let along = |from: u32, to: u32| {
            let goes = |&&triangle: &&u32| self.after(triangle, from) == to;
            self.stars[a as usize]
                .iter()
                .find(|triangle| self.triangles[**triangle as usize].contains(&b) && goes(triangle))
        };
        Some([*along(a, b)?, *along(b, a)?])
    }

    /// The corner of a triangle that follows `vertex`.
    pub(super) fn after(&self, triangle: u32, vertex: u32) -> u32 {
        let [a, b, c] = self.triangles[triangle as usize];
        if vertex == a {
            b
        } else if vertex == b {
            c
        } else {
            a
        }
    }

    /// The third corner of a triangle that goes from `a` to `b`.
    pub(super) fn opposite(&self, triangle: u32, b: u32) -> u32 {
        self.after(triangle, b)
    }

    pub(super) fn neighbours(&self, vertex: u32) -> impl Iterator<Item = u32> {
        self.stars[vertex as usize].iter().map(move |&triangle| self.after(triangle, vertex))
    }

    /// Whether one of the triangles has to stay as it is.
    pub(super) fn is_frozen(&self, triangles: [u32; 2]) -> bool {
        triangles
            .iter()
            .any(|&triangle| self.corners(triangle).iter().any(|&corner| self.is(corner, Kind::Frozen)))
    }

    /// Whether the surface has a crease along the edge of two triangles: both ends have another normal on either side.
    pub(super) fn is_crease(&self, a: u32, b: u32, beside: [u32; 2]) -> bool {
        let [left, right] = beside.map(|triangle| self.side(triangle));
        [a, b].iter().all(|&end| {
            let vertex = self.vertex(end);
            vertex.normals.len() > 1 && vertex.facing(left) != vertex.facing(right)
        })
    }

    /// Moves a vertex.
    pub(super) fn displace(&mut self, vertex: u32, moved: Vertex) {
        self.vertices[vertex as usize] = moved;
        self.stir(vertex);
    }

    /// Notes that triangles of `vertex` have changed.
    fn stir(&mut self, vertex: u32) {
        self.stirred.stir(vertex);
        for &triangle in &self.stars[vertex as usize] {
            self.triangles[triangle as usize].into_iter().for_each(|corner| self.stirred.stir(corner));
        }
    }

    /// Begins changes on trial, which [`Net::undo`] takes back.
    pub(super) fn try_out(&mut self) {
        let (vertices, count) = (self.vertices.len(), self.triangles.len());
        self.before = Some(Before { vertices, count, ..Before::default() });
    }

    /// The triangles changed on trial, as they were before and as they are: corners, and which way they face.
    pub(super) fn tried(&self) -> [Vec<([u32; 3], DVec3)>; 2] {
        let Some(before) = &self.before else { return [Vec::new(), Vec::new()] };
        let old = before.triangles.iter().filter(|record| (record.0 as usize) < before.count);
        let mut touched: Vec<(u32, [u32; 3], DVec3)> = old.copied().collect();
        // The first record of each is what it was in the beginning: the sort is stable.
        touched.sort_by_key(|record| record.0);
        touched.dedup_by_key(|record| record.0);
        let new = (before.count..self.triangles.len()).map(|triangle| triangle as u32);
        let now = touched.iter().map(|record| record.0).chain(new);
        let now = now.map(|triangle| (self.corners(triangle), self.side(triangle)));
        let now = now.filter(|(corners, _)| *corners != GONE).collect();
        [touched.iter().map(|&(_, corners, side)| (corners, side)).collect(), now]
    }

    /// Ends changes on trial: all is as before.
    pub(super) fn undo(&mut self) {
        let Some(before) = self.before.take() else { return };
        for (triangle, corners, side) in before.triangles.into_iter().rev() {
            self.triangles[triangle as usize] = corners;
            self.sides[triangle as usize] = side;
        }
        for (vertex, star) in before.stars.into_iter().rev() {
            self.stars[vertex as usize] = star;
        }
        self.vertices.truncate(before.vertices);
        self.stars.truncate(before.vertices);
        self.stirred.truncate(before.vertices);
        self.triangles.truncate(before.count);
        self.sides.truncate(before.count);
    }

    /// Notes triangles and stars that are about to change, if that is on trial.
    fn note(&mut self, triangles: &[u32], vertices: &[u32]) {
        let Some(before) = &mut self.before else { return };
        for &triangle in triangles {
            before.triangles.push((
                triangle,
                self.triangles[triangle as usize],
                self.sides[triangle as usize],
            ));
        }
        before.stars.extend(vertices.iter().map(|&vertex| (vertex, self.stars[vertex as usize].clone())));
    }

    /// Turns the edge from `a` to `b` in the two triangles beside it: from then on it joins the other two corners.
    pub(super) fn flip(&mut self, a: u32, b: u32, [left, right]: [u32; 2]) {
        let (c, d) = (self.opposite(left, b), self.opposite(right, a));
        self.note(&[left, right], &[a, b, c, d]);
        let side = (self.side(left) + self.side(right)).normalize_or(self.side(left));
        self.triangles[left as usize] = [c, a, d];
        self.triangles[right as usize] = [d, b, c];
        self.sides[left as usize] = side;
        self.sides[right as usize] = side;
        self.leave(a, right);
        self.leave(b, left);
        self.stars[c as usize].push(right);
        self.stars[d as usize].push(left);
        for corner in [a, b, c, d] {
            self.stirred.stir(corner);
        }
    }

    /// Moves `a` into its neighbour `b`. The two triangles between them go.
    pub(super) fn collapse(&mut self, a: u32, b: u32, beside: [u32; 2]) {
        let apexes = beside.map(|triangle| {
            let corners = self.corners(triangle);
            corners.into_iter().find(|&corner| corner != a && corner != b).unwrap_or(a)
        });
        if self.before.is_some() {
            let star = self.stars[a as usize].clone();
            self.note(&star, &[a, b, apexes[0], apexes[1]]);
        }
        for triangle in beside {
            for corner in self.triangles[triangle as usize] {
                if corner != a {
                    self.leave(corner, triangle);
                }
            }
            self.triangles[triangle as usize] = GONE;
        }
        for triangle in std::mem::take(&mut self.stars[a as usize]) {
            if beside.contains(&triangle) {
                continue;
            }
            let corners = &mut self.triangles[triangle as usize];
            *corners = corners.map(|corner| if corner == a { b } else { corner });
            self.stars[b as usize].push(triangle);
        }
        self.stir(b);
    }

    /// Puts a vertex on the edge from `a` to `b`.
    pub(super) fn split(&mut self, a: u32, b: u32, [left, right]: [u32; 2], vertex: Vertex) {
        let (c, d) = (self.opposite(left, b), self.opposite(right, a));
        self.note(&[left, right], &[a, b, c, d]);
        let middle = self.vertices.len() as u32;
        let first = self.triangles.len() as u32;
        self.vertices.push(vertex);
        self.triangles[left as usize] = [a, middle, c];
        self.triangles[right as usize] = [middle, a, d];
        self.triangles.extend([[middle, b, c], [b, middle, d]]);
        self.sides.extend([self.side(left), self.side(right)]);
        self.leave(b, left);
        self.leave(b, right);
        self.stars[b as usize].extend([first, first + 1]);
        self.stars[c as usize].push(first);
        self.stars[d as usize].push(first + 1);
        self.stars.push(SmallVec::from_slice(&[left, right, first, first + 1]));
        self.stirred.push(None);
        self.stir(middle);
    }

    fn leave(&mut self, vertex: u32, triangle: u32) {
        self.stars[vertex as usize].retain(|other| *other != triangle);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An octahedron.
    fn net() -> Net {
        let places = [DVec3::X, -DVec3::X, DVec3::Y, -DVec3::Y, DVec3::Z, -DVec3::Z];
        let triangles =
            [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];
        let sides =
            triangles.map(|t: [u32; 3]| t.iter().map(|&k| places[k as usize]).sum::<DVec3>().normalize());
        Net::new(places.map(|p| Vertex::free(p, p)).to_vec(), triangles.to_vec(), sides.to_vec())
    }

    /// Fails unless every directed edge has one other way round, and stars are those of the triangles.
    fn check(net: &Net) -> usize {
        let mut edges: Vec<[u32; 2]> =
            net.present().flat_map(|(_, [a, b, c])| [[a, b], [b, c], [c, a]]).collect();
        edges.sort_unstable();
        for window in edges.windows(2) {
            assert_ne!(window[0], window[1]);
        }
        for &[a, b] in &edges {
            assert!(edges.binary_search(&[b, a]).is_ok());
            let [left, right] = net.beside(a, b).unwrap();
            assert_eq!((net.after(left, a), net.after(right, b)), (b, a));
        }
        for vertex in 0..net.vertices.len() as u32 {
            let of = net.present().filter(|(_, corners)| corners.contains(&vertex)).map(|(t, _)| t);
            let mut star = net.star(vertex).to_vec();
            star.sort_unstable();
            assert_eq!(star, of.collect::<Vec<u32>>());
        }
        edges.len() / 3
    }

    #[test]
    fn changes_keep_the_surface_closed() {
        let mut net = net();
        let beside = net.beside(0, 2).unwrap();
        net.split(0, 2, beside, Vertex::free(DVec3::new(0.5, 0.5, 0.0), DVec3::X));
        assert_eq!(check(&net), 10);
        let beside = net.beside(6, 4).unwrap();
        net.flip(6, 4, beside);
        assert_eq!(check(&net), 10);
        assert!(net.beside(6, 4).is_none() && net.beside(0, 2).is_some());
        let beside = net.beside(6, 5).unwrap();
        net.collapse(6, 5, beside);
        assert_eq!(check(&net), 8);
        assert!(net.star(6).is_empty());
    }

    #[test]
    fn changes_on_trial_are_undone() {
        let mut net = net();
        let before = net.clone();
        net.try_out();
        let beside = net.beside(0, 2).unwrap();
        net.split(0, 2, beside, Vertex::free(DVec3::new(0.5, 0.5, 0.0), DVec3::X));
        let beside = net.beside(6, 4).unwrap();
        net.flip(6, 4, beside);
        let beside = net.beside(6, 5).unwrap();
        net.collapse(6, 5, beside);
        let [old, new] = net.tried();
        // One edge more and one fewer: as many triangles.
        assert!(old.len() == new.len() && !old.is_empty());
        net.undo();
        assert_eq!((net.triangles.clone(), net.stars.clone()), (before.triangles, before.stars));
        assert_eq!(net.vertices.len(), before.vertices.len());
        check(&net);
    }
}
