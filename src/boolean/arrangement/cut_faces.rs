//! The faces that the intersection curve passes, with the segments on each.

use std::ops::{Index, Range};

use super::crossings::{Crossing, Crossings};
use super::cut_edges::CutEdges;
use crate::boolean::complex::Complex;
use crate::boolean::complex::ids::{CutEdgeId, CutFaceId, FaceId, NodeId, SegmentId, VertexId};
use crate::mesh::BitSet;
use crate::parallel::read_ahead;
use crate::spatial::radix_sort;

/// A cut face.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CutFace {
    pub(crate) id: FaceId,
    /// Where its segments start and end in [`CutFaces::segments`].
    first: u32,
    end: u32,
    /// For each side of the face (from corner k to corner k+1) the cut edge it is, or none.
    pub(crate) edges: [CutEdgeId; 3],
}

/// Segments whose ends are read before the first is looked at, so that cache misses overlap.
const SEGMENTS_AT_ONCE: usize = 64;

/// The cut faces of one operand, ascending.
#[derive(Debug, Default)]
pub(crate) struct CutFaces {
    faces: Vec<CutFace>,
    /// Face by face.
    segments: Vec<SegmentId>,
    /// By triangle of the operand.
    is_cut: BitSet,
}

impl Index<CutFaceId> for CutFaces {
    type Output = CutFace;

    #[inline]
    fn index(&self, face: CutFaceId) -> &CutFace {
        &self.faces[face.index()]
    }
}

impl CutFaces {
    /// The cut faces of an operand: those with segments, and those without that are given by index because their pieces
    /// (all or nothing) are added to those of others.
    pub(crate) fn new(
        complex: &Complex<'_>,
        operand: usize,
        crossings: &Crossings,
        edges: &CutEdges,
        uncut: impl IntoIterator<Item = u32>,
    ) -> Self {
        let segments = segments_by_face(complex, operand, crossings);
        let mut is_cut = BitSet::new(complex.operands[operand].triangles.len());
        let mut faces: Vec<CutFace> = Vec::new();
        let mut corners = [VertexId::NONE; 3];
        for (i, &segment) in segments.iter().enumerate() {
            if i % SEGMENTS_AT_ONCE == 0 {
                read_ends(&segments[i..(i + SEGMENTS_AT_ONCE).min(segments.len())], crossings, edges);
            }
            let segment = &crossings[segment];
            let id = segment.faces[operand];
            match faces.last_mut() {
                Some(face) if face.id == id => face.end += 1,
                _ => {
                    let (_, triangle) = complex.triangle(id);
                    is_cut.insert(triangle);
                    let (first, end) = (i as u32, i as u32 + 1);
                    faces.push(CutFace { id, first, end, edges: [CutEdgeId::NONE; 3] });
                    corners = complex.vertices(id);
                }
            }
            // A segment that ends on the face's boundary ends on one of its own edges.
            let face = faces.last_mut().expect("pushed above");
            for node in [segment.tail, segment.head] {
                if crossings.owner_of_node(node) != operand {
                    continue;
                }
                let Crossing { low, high, .. } = crossings[node];
                let k = (0..3)
                    .find(|&k| {
                        let (u, v) = (corners[k], corners[(k + 1) % 3]);
                        (u.min(v), u.max(v)) == (low, high)
                    })
                    .expect("the edge is one of the face's");
                face.edges[k] = edges.edge_of(node);
            }
        }
        let mut result = Self { faces, segments, is_cut };
        result.add_uncut(complex, operand, uncut);
        result
    }

    fn add_uncut(&mut self, complex: &Complex<'_>, operand: usize, uncut: impl IntoIterator<Item = u32>) {
        let before = self.faces.len();
        for triangle in uncut {
            if !self.is_cut(triangle) {
                self.is_cut.insert(triangle);
                let id = complex.face(operand, triangle);
                self.faces.push(CutFace { id, first: 0, end: 0, edges: [CutEdgeId::NONE; 3] });
            }
        }
        if self.faces.len() > before {
            self.faces.sort_by_key(|face| face.id);
        }
    }

    /// How many faces are cut.
    pub(crate) fn len(&self) -> usize {
        self.faces.len()
    }

    /// All cut faces, ascending.
    pub(crate) fn iter(&self) -> std::slice::Iter<'_, CutFace> {
        self.faces.iter()
    }

    /// Some of them by their places.
    pub(crate) fn range(&self, range: Range<usize>) -> &[CutFace] {
        &self.faces[range]
    }

    /// Whether a triangle of the operand is cut.
    #[inline]
    pub(crate) fn is_cut(&self, triangle: u32) -> bool {
        self.is_cut.contains(triangle)
    }

    /// A cut face by its number.
    pub(crate) fn find(&self, face: FaceId) -> Option<&CutFace> {
        let place = self.faces.binary_search_by_key(&face, |cut| cut.id).ok()?;
        Some(&self.faces[place])
    }

    /// The segments on a cut face.
    #[inline]
    pub(crate) fn segments(&self, face: &CutFace) -> &[SegmentId] {
        &self.segments[face.first as usize..face.end as usize]
    }
}

/// All segments in the order of their faces of one operand.
fn segments_by_face(complex: &Complex<'_>, operand: usize, crossings: &Crossings) -> Vec<SegmentId> {
    if operand == 0 {
        // They are sorted by face of A already.
        return crossings.segments().map(|(id, _)| id).collect();
    }
    let key = |(id, segment): (SegmentId, &super::crossings::Segment)| {
        [complex.triangle(segment.faces[1]).1, id.number()]
    };
    let mut order: Vec<[u32; 2]> = crossings.segments().map(key).collect();
    let bits = u32::BITS - (complex.operands[1].triangles.len() as u32).leading_zeros();
    radix_sort(&mut order, &mut Vec::new(), |key| key[0], bits);
    order.iter().map(|key| SegmentId::new(key[1])).collect()
}

/// Reads the ends of some segments, and the edges these lie on.
fn read_ends(segments: &[SegmentId], crossings: &Crossings, edges: &CutEdges) {
    read_ahead(segments.iter().map(|&segment| {
        let segment = &crossings[segment];
        let of_node = |node: NodeId| crossings[node].low.number() ^ edges.edge_of(node).number();
        of_node(segment.tail) ^ of_node(segment.head)
    }));
}
