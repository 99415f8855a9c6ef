//! The points of an arrangement under one numbering, and where each is: vertices of the operands, then nodes, then points
//! added later. This is the one place that says so.

use super::curve::Curve;
use super::location::Location;
use super::plane_faces::PlaneFaces;
use crate::Error;
use crate::boolean::complex::Complex;
use crate::boolean::complex::ids::{NodeId, PointId, VertexId};
use crate::exact::perturbed::PerturbedPoint;
use crate::parallel::Runner;

/// Where all points are.
#[derive(Debug)]
pub(crate) struct Points<'a> {
    complex: &'a Complex<'a>,
    /// By node, correctly rounded; not a number where the crossing is dropped.
    nodes: Vec<[f64; 3]>,
    /// After the nodes.
    added: Vec<AddedPoint>,
}

/// What a number of a point stands for.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Point<'a> {
    Vertex(VertexId),
    Node(NodeId),
    Added(&'a AddedPoint),
}

/// A point that is neither a vertex nor a node.
#[derive(Clone, Debug)]
pub(crate) enum AddedPoint {
    /// Where edges cross in the sum of a plane's faces. (There are few of these, and many copies.)
    Crossing(Box<SheetCrossing>),
    /// A copy of another point, or a point made where the result was cleaned up.
    Copy([f64; 3]),
}

/// A point where edges cross that the perturbation kept apart: rounded, and the edge and the triangle it comes from.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SheetCrossing {
    pub(crate) position: [f64; 3],
    pub(crate) edge: [PerturbedPoint; 2],
    pub(crate) triangle: [PerturbedPoint; 3],
}

impl AddedPoint {
    fn position(&self) -> &[f64; 3] {
        match self {
            Self::Crossing(crossing) => &crossing.position,
            Self::Copy(position) => position,
        }
    }
}

/// Crossings that one thread locates before the limits are checked.
const NODES_AT_ONCE: usize = 1024;
/// Crossings whose points are read before the first is located, so that cache misses overlap; their copies (120 bytes each)
/// fit the first-level cache.
const READ_AT_ONCE: usize = 64;

impl<'a> Points<'a> {
    /// Computes where the nodes are that are not dropped.
    ///
    /// # Errors
    /// Only limits.
    pub(crate) fn new(
        curve: &Curve<'a>,
        plane_faces: &PlaneFaces,
        runner: Runner<'_>,
    ) -> Result<Self, Error> {
        let Curve { complex, crossings, .. } = curve;
        let count = crossings.node_count();
        let nowhere = [f64::NAN; 3];
        let nodes = runner.gather(count, NODES_AT_ONCE, count, |range, positions| {
            let mut locations = Vec::with_capacity(READ_AT_ONCE);
            for start in range.clone().step_by(READ_AT_ONCE) {
                let batch = (start..(start + READ_AT_ONCE).min(range.end)).map(|i| NodeId::new(i as u32));
                locations.clear();
                locations.extend(batch.clone().map(|node| Location::read(complex, &crossings[node])));
                positions.extend(batch.zip(&locations).map(|(node, location)| {
                    if plane_faces.is_dropped(node) {
                        nowhere
                    } else {
                        location.locate(complex, &crossings[node])
                    }
                }));
            }
        })?;
        Ok(Self { complex, nodes, added: Vec::new() })
    }

    /// How many points there are.
    pub(crate) fn len(&self) -> usize {
        self.first_added() as usize + self.added.len()
    }

    /// The number that the next added point gets.
    pub(crate) fn next(&self) -> PointId {
        PointId::new(self.len() as u32)
    }

    /// Adds points after all others.
    pub(crate) fn add(&mut self, points: impl IntoIterator<Item = AddedPoint>) {
        self.added.extend(points);
    }

    /// A vertex as a point.
    #[inline]
    pub(crate) fn of_vertex(vertex: VertexId) -> PointId {
        PointId::new(vertex.number())
    }

    /// A node as a point.
    #[inline]
    pub(crate) fn of_node(&self, node: NodeId) -> PointId {
        PointId::new(self.complex.vertex_count() + node.number())
    }

    /// What a number stands for.
    #[inline]
    pub(crate) fn get(&self, point: PointId) -> Point<'_> {
        let vertices = self.complex.vertex_count();
        if point.number() < vertices {
            Point::Vertex(VertexId::new(point.number()))
        } else if point.number() < self.first_added() {
            Point::Node(NodeId::new(point.number() - vertices))
        } else {
            Point::Added(&self.added[(point.number() - self.first_added()) as usize])
        }
    }

    /// Where a point is.
    #[inline]
    pub(crate) fn position(&self, point: PointId) -> &[f64; 3] {
        match self.get(point) {
            Point::Vertex(vertex) => self.complex.position(vertex),
            Point::Node(node) => &self.nodes[node.index()],
            Point::Added(added) => added.position(),
        }
    }

    /// Where a node is.
    #[inline]
    pub(crate) fn position_of_node(&self, node: NodeId) -> &[f64; 3] {
        &self.nodes[node.index()]
    }

    fn first_added(&self) -> u32 {
        self.complex.vertex_count() + self.nodes.len() as u32
    }
}
