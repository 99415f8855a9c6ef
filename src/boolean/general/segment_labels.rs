//! The labels round every piece of every segment.

use super::crossings::Crossings;
use super::edges::Edges;
use super::lines::Lines;
use super::surfaces::Surfaces;
use super::walk::FaceLabels;
use crate::Error;
use crate::boolean::complex::ids::{FaceId, LabelId, NodeId, SegmentId};
use crate::control::Control;

/// The labels round a piece of a segment of faces f and g.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Quadrants {
    /// Outside both faces.
    pub(crate) outside: LabelId,
    /// Inside f and outside g.
    pub(crate) inside_first: LabelId,
    /// Inside g and outside f.
    pub(crate) inside_second: LabelId,
    /// Inside both.
    pub(crate) inside: LabelId,
}

/// For each segment, one for each piece between its three-face points.
#[derive(Debug)]
pub(crate) struct SegmentLabels {
    pub(super) starts: Vec<u32>,
    pub(super) pieces: Vec<Quadrants>,
}

/// Segments that are looked at before the limits are checked.
const SEGMENTS_AT_ONCE: usize = 1 << 12;

impl SegmentLabels {
    /// Those of no segments.
    pub(super) fn none() -> Self {
        Self { starts: Vec::new(), pieces: Vec::new() }
    }

    /// Takes them from the labels along the sides of faces, in which every segment ends.
    ///
    /// # Errors
    /// Only limits.
    pub(crate) fn new(
        surfaces: &Surfaces,
        edges: &Edges,
        crossings: &Crossings,
        lines: &Lines,
        faces: &mut FaceLabels,
        control: &Control,
    ) -> Result<Self, Error> {
        let mut all = Self { starts: Vec::with_capacity(crossings.segments.len()), pieces: Vec::new() };
        let mut outside: Vec<LabelId> = Vec::new();
        for (id, segment) in crossings.iter() {
            if id.index() % SEGMENTS_AT_ONCE == 0 {
                control.check()?;
            }
            let triples = lines.on_segment(id);
            let change = |i: usize| {
                let (face, head_inside) = lines.triple(triples[i]).beside(id);
                let step = surfaces.step(face);
                (surfaces.owner(face), if head_inside { step } else { -step })
            };
            // 1. Along the segment from an end that is a node.
            outside.clear();
            if let Some(node) = crossings.node_of(segment.tail) {
                let mut label = beside_node(edges, crossings, lines, faces, segment.faces, node);
                outside.push(label);
                for i in 0..triples.len() {
                    let (owner, step) = change(i);
                    label = faces.labels.step(label, owner, step);
                    outside.push(label);
                }
            } else if let Some(node) = crossings.node_of(segment.head) {
                let mut label = beside_node(edges, crossings, lines, faces, segment.faces, node);
                outside.push(label);
                for i in (0..triples.len()).rev() {
                    let (owner, step) = change(i);
                    label = faces.labels.step(label, owner, -step);
                    outside.push(label);
                }
                outside.reverse();
            }
            // 2. The other quadrants.
            all.starts.push(all.pieces.len() as u32);
            let [f, g] = segment.faces;
            let mut inside = |label: LabelId, face: FaceId| {
                faces.labels.step(label, surfaces.owner(face), surfaces.step(face))
            };
            for &outside in &outside {
                let inside_first = inside(outside, f);
                let inside_second = inside(outside, g);
                let inside = inside(inside_first, g);
                all.pieces.push(Quadrants { outside, inside_first, inside_second, inside });
            }
        }
        Ok(all)
    }

    /// Those of a segment with so many three-face points, from tail to head.
    #[inline]
    pub(crate) fn of_segment(&self, segment: SegmentId, triples: usize) -> &[Quadrants] {
        let first = self.starts[segment.index()] as usize;
        &self.pieces[first..=first + triples]
    }
}

/// The label outside both faces of a segment beside a node that it ends in.
fn beside_node(
    edges: &Edges,
    crossings: &Crossings,
    lines: &Lines,
    faces: &FaceLabels,
    pair: [FaceId; 2],
    id: NodeId,
) -> LabelId {
    let node = crossings.node(id);
    // The face whose edge it lies on; the other one is pierced.
    let face = if pair[0] == node.face { pair[1] } else { pair[0] };
    let k = (0..3).find(|&k| edges.edge(face, k) == node.edge).expect("the edge is one of the face's");
    let nodes = lines.on_edge(node.edge);
    let place = lines.place(id) as usize;
    let [labels, _] = faces.of_side(face, k, nodes.len());
    // Outside the pierced face the edge is after it has left, or before it enters.
    labels[place + usize::from(node.leaves)]
}
