//! The points along each edge and each segment, in order, and where all points are.
//!
//! Correct rounding keeps order: where the rounded positions of two points of a line differ, they tell. Only points with equal
//! bits need a predicate.

use std::cmp::Ordering;

use super::cross::Node;
use super::crossings::{Crossings, compare_on_edge};
use super::edges::Edges;
use super::surfaces::Surfaces;
use super::triples::{self, Triple};
use crate::Error;
use crate::boolean::complex::ids::{EdgeId, NodeId, PointId, SegmentId, TripleId, VertexId};
use crate::boolean::complex::predicates::{Perturbed, Predicates};
use crate::exact::{Sign, planes, position};
use crate::mesh::Buckets;
use crate::parallel::Runner;

/// Lines whose points one thread puts in order before the limits are checked.
const LINES_AT_ONCE: usize = 1024;

/// All points and their order.
#[derive(Debug)]
pub(crate) struct Lines {
    /// Where each node is, then each three-face point.
    located: Vec<[f64; 3]>,
    pub(crate) triples: Vec<Triple>,
    /// Edge by edge, from the low end to the high end.
    on_edges: Buckets<NodeId>,
    /// By node, its place on its edge.
    places: Vec<u32>,
    /// Segment by segment, from tail to head.
    on_segments: Buckets<TripleId>,
    pub(crate) contacts: u64,
    first_triple: u32,
    vertex_count: u32,
}

impl Default for NodeId {
    fn default() -> Self {
        Self::NONE
    }
}

impl Default for TripleId {
    fn default() -> Self {
        Self::NONE
    }
}

impl Lines {
    /// Locates all points and puts them in order.
    ///
    /// # Errors
    /// Limits, and [`Error::TooLarge`] where the points cannot be numbered.
    pub(crate) fn new(
        surfaces: &Surfaces,
        edges: &Edges,
        crossings: &Crossings,
        triples: Vec<Triple>,
        runner: Runner<'_>,
    ) -> Result<Self, Error> {
        // 1. Where they are.
        let (nodes, points) = (&crossings.nodes, crossings.nodes.len() + triples.len());
        if surfaces.vertex_count() as usize + points > 0xf000_0000 {
            return Err(Error::TooLarge { what: format!("{points} crossings in one operation") });
        }
        let located = runner.gather(points, LINES_AT_ONCE, points, |range, located| {
            located.extend(range.map(|i| match nodes.get(i) {
                Some(node) => locate(surfaces, edges, node),
                None => triples::locate(surfaces, &triples[i - nodes.len()]),
            }));
        })?;
        // 2. Which lie on which line.
        let of_edge = (0..).map(NodeId::new).zip(nodes).map(|(id, node)| (node.edge.number(), id));
        let on_edges = Buckets::new(edges.len(), of_edge);
        let of_segment = (0..).map(TripleId::new).zip(&triples);
        let of_segment =
            of_segment.flat_map(|(id, triple)| triple.segments.map(|segment| (segment.number(), id)));
        let on_segments = Buckets::new(crossings.segments.len(), of_segment);
        let vertex_count = surfaces.vertex_count();
        let first_triple = vertex_count + nodes.len() as u32;
        let mut lines = Self {
            located,
            triples,
            on_edges,
            places: Vec::new(),
            on_segments,
            contacts: 0,
            first_triple,
            vertex_count,
        };
        // 3. In which order.
        let sorter =
            Sorter { surfaces, edges, crossings, predicates: Predicates::new(surfaces), lines: &lines };
        let on_edges = sorter.sort(&lines.on_edges, runner, |edge, nodes: &mut [NodeId]| {
            nodes.sort_by(|x, y| sorter.compare_nodes(*x, *y));
            debug_assert!(nodes.iter().all(|&node| crossings.node(node).edge.index() == edge));
        })?;
        let on_segments = sorter.sort(&lines.on_segments, runner, |segment, points: &mut [TripleId]| {
            let segment = SegmentId::new(segment as u32);
            points.sort_by(|x, y| sorter.compare_triples(segment, *x, *y));
        })?;
        lines.contacts = sorter.predicates.into_contacts();
        for (key, nodes) in on_edges.into_iter().flatten() {
            lines.on_edges.get_mut(key).copy_from_slice(&nodes);
        }
        for (key, points) in on_segments.into_iter().flatten() {
            lines.on_segments.get_mut(key).copy_from_slice(&points);
        }
        lines.places = places(&lines.on_edges, nodes.len());
        Ok(lines)
    }

    /// The place of a node on its edge.
    #[inline]
    pub(crate) fn place(&self, node: NodeId) -> u32 {
        self.places[node.index()]
    }

    /// The nodes of an edge, from its low end to its high end.
    #[inline]
    pub(crate) fn on_edge(&self, edge: EdgeId) -> &[NodeId] {
        self.on_edges.get(edge.index())
    }

    /// The three-face points of a segment, from its tail to its head.
    #[inline]
    pub(crate) fn on_segment(&self, segment: SegmentId) -> &[TripleId] {
        self.on_segments.get(segment.index())
    }

    #[inline]
    pub(crate) fn triple(&self, triple: TripleId) -> &Triple {
        &self.triples[triple.index()]
    }

    /// A three-face point as a point: they come after the nodes.
    #[inline]
    pub(crate) fn point(&self, triple: TripleId) -> PointId {
        PointId::new(self.first_triple + triple.number())
    }

    /// The number of points: vertices, nodes, three-face points.
    pub(crate) fn point_count(&self) -> u32 {
        self.first_triple + self.triples.len() as u32
    }

    /// Where a vertex, a node or a three-face point is.
    #[inline]
    pub(crate) fn position<'a>(&'a self, surfaces: &'a Surfaces, point: PointId) -> &'a [f64; 3] {
        match point.number().checked_sub(self.vertex_count) {
            None => surfaces.position(VertexId::new(point.number())),
            Some(place) => &self.located[place as usize],
        }
    }

    /// The three-face point that a point is, if it is one.
    pub(crate) fn triple_of(&self, point: PointId) -> Option<TripleId> {
        point.number().checked_sub(self.first_triple).map(TripleId::new)
    }
}

/// By node, its place on its edge.
fn places(on_edges: &Buckets<NodeId>, count: usize) -> Vec<u32> {
    let mut places = vec![0; count];
    for nodes in on_edges.each() {
        (0..).zip(nodes).for_each(|(place, node)| places[node.index()] = place);
    }
    places
}

/// Where a node is, correctly rounded.
fn locate(surfaces: &Surfaces, edges: &Edges, node: &Node) -> [f64; 3] {
    let [p, q] = edges.ends(node.edge).map(|v| *surfaces.position(v));
    let face = surfaces.positions(node.face);
    position::crossing_filter(&p, &q, face.each_ref()).unwrap_or_else(|| {
        let ([p, q], face) = perturbed(surfaces, edges, node);
        position::crossing(&p, &q, face.each_ref())
    })
}

/// The edge and the face of a node, perturbed.
pub(crate) fn perturbed(
    surfaces: &Surfaces,
    edges: &Edges,
    node: &Node,
) -> ([crate::exact::perturbed::PerturbedPoint; 2], [crate::exact::perturbed::PerturbedPoint; 3]) {
    let end = |v: VertexId| surfaces.perturbed(&surfaces.corner(v));
    let face = surfaces.corners(node.face).map(|corner| surfaces.perturbed(&corner));
    (edges.ends(node.edge).map(end), face)
}

/// Along which axis rounded positions tell most of a line, and whether they grow there; `None` if its ends coincide.
fn axis(from: &[f64; 3], to: &[f64; 3]) -> Option<(usize, bool)> {
    let extent = |k: usize| (to[k] - from[k]).abs();
    let k = (1..3).fold(0, |best, k| if extent(k) > extent(best) { k } else { best });
    (to[k] != from[k]).then(|| (k, to[k] > from[k]))
}

/// The order of two points of a line with the given ends, if their rounded positions tell.
fn compare_positions(ends: [&[f64; 3]; 2], x: &[f64; 3], y: &[f64; 3]) -> Option<Ordering> {
    let (k, grows) = axis(ends[0], ends[1])?;
    if x[k] == y[k] {
        return None;
    }
    Some(if (x[k] < y[k]) == grows { Ordering::Less } else { Ordering::Greater })
}

struct Sorter<'a> {
    surfaces: &'a Surfaces,
    edges: &'a Edges,
    crossings: &'a Crossings,
    predicates: Predicates<'a>,
    lines: &'a Lines,
}

impl Sorter<'_> {
    /// The lists of several items, sorted, with their keys.
    #[allow(clippy::type_complexity, reason = "pieces of lists with keys")]
    fn sort<T: Copy + Default + Send + Sync>(
        &self,
        lists: &Buckets<T>,
        runner: Runner<'_>,
        sort: impl Fn(usize, &mut [T]) + Sync,
    ) -> Result<Vec<Vec<(usize, Vec<T>)>>, Error> {
        let long: Vec<usize> = (0..lists.len()).filter(|&key| lists.get(key).len() > 1).collect();
        Ok(runner.pieces(long.len(), LINES_AT_ONCE, |range| {
            let sorted = |&key: &usize| {
                let mut list = lists.get(key).to_vec();
                sort(key, &mut list);
                (key, list)
            };
            long[range].iter().map(sorted).collect()
        })?)
    }

    fn compare_nodes(&self, x: NodeId, y: NodeId) -> Ordering {
        if x == y {
            return Ordering::Equal;
        }
        let [at_x, at_y] = [x, y].map(|node| self.lines.position(self.surfaces, self.crossings.point(node)));
        let (x, y) = (self.crossings.node(x), self.crossings.node(y));
        let ends = self.edges.ends(x.edge).map(|v| self.surfaces.position(v));
        if let Some(order) = compare_positions(ends, at_x, at_y) {
            return order;
        }
        match compare_on_edge(self.surfaces, self.edges, &self.predicates, x, (y.face, y.leaves)) {
            Sign::Negative => Ordering::Less,
            _ => Ordering::Greater,
        }
    }

    fn compare_triples(&self, segment: SegmentId, x: TripleId, y: TripleId) -> Ordering {
        if x == y {
            return Ordering::Equal;
        }
        let [at_x, at_y] = [x, y].map(|triple| self.lines.position(self.surfaces, self.lines.point(triple)));
        let of = self.crossings.segment(segment);
        let ends = [of.tail, of.head].map(|end| self.lines.position(self.surfaces, end));
        if let Some(order) = compare_positions(ends, at_x, at_y) {
            return order;
        }
        // X comes before Y along n_f x n_g iff D4(f, g, x, y) det(f, g, x) det(f, g, y) is positive, and a determinant is iff
        // the head lies outside.
        let ((face_x, x_inside), (face_y, y_inside)) =
            (self.lines.triple(x).beside(segment), self.lines.triple(y).beside(segment));
        let faces = [of.faces[0], of.faces[1], face_x, face_y];
        let corners =
            faces.map(|face| self.surfaces.corners(face).map(|corner| self.surfaces.perturbed(&corner)));
        let sign = planes::order(corners.each_ref().map(<[_; 3]>::each_ref));
        if (sign == Sign::Positive) == (x_inside == y_inside) { Ordering::Less } else { Ordering::Greater }
    }
}
