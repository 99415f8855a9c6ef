//! What tidying asks of the arrangement.

use crate::boolean::arrangement::points::Points;
use crate::boolean::classify::body::Body;
use crate::boolean::complex::ids::{PointId, VertexId};

/// The body that is tidied.
#[derive(Clone, Copy, Debug)]
pub(super) struct Source<'a> {
    pub(super) body: Body<'a>,
    /// The size of rounding.
    pub(super) rounding: f64,
    /// How many decisions plain coordinates left open.
    pub(super) contacts: u64,
}

impl Source<'_> {
    /// How many points the arrangement has.
    pub(super) fn point_count(&self) -> u32 {
        self.body.arrangement.points.next().number()
    }

    /// Where a point of the arrangement is.
    pub(super) fn position(&self, point: u32) -> &[f64; 3] {
        self.body.arrangement.points.position(PointId::new(point))
    }

    /// The point that stands for a vertex.
    pub(super) fn representative(&self, vertex: VertexId) -> u32 {
        self.body.arrangement.identification.representative(Points::of_vertex(vertex)).number()
    }

    /// All points that stand for others, ascending.
    pub(super) fn representatives(&self) -> impl Iterator<Item = u32> {
        self.body.arrangement.identification.representatives().into_iter().map(PointId::number)
    }

    /// Whether three points lay on one line before they were rounded.
    pub(super) fn were_on_one_line(&self, points: [u32; 3]) -> bool {
        self.body.arrangement.were_on_one_line(points.map(PointId::new))
    }
}
