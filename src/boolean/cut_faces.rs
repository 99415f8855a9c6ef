//! The triangles that the intersection curve passes, with the segments on each.

use super::crossings::Crossings;
use super::cut_edges::CutEdges;
use super::operands::Operands;

/// A set of small integers.
#[derive(Debug, Default)]
pub(super) struct BitSet(Vec<u64>);

impl BitSet {
    pub(super) fn new(size: usize) -> Self {
        Self(vec![0; size.div_ceil(64)])
    }

    pub(super) fn insert(&mut self, index: u32) {
        self.0[index as usize / 64] |= 1 << (index % 64);
    }

    pub(super) fn remove(&mut self, index: u32) {
        self.0[index as usize / 64] &= !(1 << (index % 64));
    }

    /// The elements, ascending.
    pub(super) fn iter(&self) -> impl Iterator<Item = u32> {
        let words = self.0.iter().enumerate().filter(|&(_, &word)| word != 0);
        words.flat_map(|(i, &word)| {
            (0..64).filter(move |bit| word >> bit & 1 == 1).map(move |bit| 64 * i as u32 + bit)
        })
    }

    /// Its bits, 64 in a word.
    pub(super) fn words(&self) -> &[u64] {
        &self.0
    }

    #[inline]
    pub(super) fn contains(&self, index: u32) -> bool {
        self.0[index as usize / 64] >> (index % 64) & 1 == 1
    }
}

/// A cut triangle of one operand.
#[derive(Clone, Copy, Debug)]
pub(super) struct CutFace {
    pub(super) triangle: u32,
    first: u32,
    end: u32,
    /// For each side of the triangle (from corner k to corner k+1) the cut edge it is, or [`UNCUT`].
    pub(super) edges: [u32; 3],
}

/// Marks a side without crossings.
pub(super) const UNCUT: u32 = u32::MAX;

/// The cut triangles of one operand, ascending.
#[derive(Debug, Default)]
pub(super) struct CutFaces {
    pub(super) faces: Vec<CutFace>,
    /// Segment numbers, face by face.
    segments: Vec<u32>,
    is_cut: BitSet,
}

impl CutFaces {
    pub(super) fn new(operands: &Operands<'_>, side: usize, crossings: &Crossings, edges: &CutEdges) -> Self {
        let triangle_of = |segment: u32| crossings.segments[segment as usize].triangles[side];
        let mut segments: Vec<u32> = (0..crossings.segments.len() as u32).collect();
        if side == 1 {
            // They are sorted by triangle of A already.
            segments.sort_by_key(|&segment| triangle_of(segment));
        }
        let mut is_cut = BitSet::new(operands.sides[side].triangles.len());
        let mut faces: Vec<CutFace> = Vec::new();
        for (i, &segment) in segments.iter().enumerate() {
            let triangle = triangle_of(segment);
            match faces.last_mut() {
                Some(face) if face.triangle == triangle => face.end += 1,
                _ => {
                    is_cut.insert(triangle);
                    faces.push(CutFace { triangle, first: i as u32, end: i as u32 + 1, edges: [UNCUT; 3] });
                }
            }
            // A segment that ends on the triangle's boundary ends on one of its own edges.
            let face = faces.last_mut().expect("pushed above");
            let first = operands.first_vertex(side);
            let corners = operands.sides[side].triangles[triangle as usize].map(|v| first + v);
            for node in [crossings.segments[segment as usize].tail, crossings.segments[segment as usize].head]
            {
                let edge = edges.edge_of_node[node as usize];
                let (low, high) = (edges.edges[edge as usize].low, edges.edges[edge as usize].high);
                if operands.side_of(low) == side {
                    let k = (0..3)
                        .find(|&k| {
                            let (u, v) = (corners[k], corners[(k + 1) % 3]);
                            (u.min(v), u.max(v)) == (low, high)
                        })
                        .expect("the edge is one of the triangle's");
                    face.edges[k] = edge;
                }
            }
        }
        Self { faces, segments, is_cut }
    }

    /// Whether a triangle is cut.
    #[inline]
    pub(super) fn is_cut(&self, triangle: u32) -> bool {
        self.is_cut.contains(triangle)
    }

    /// A cut triangle by its number.
    pub(super) fn face(&self, triangle: u32) -> Option<CutFace> {
        let place = self.faces.binary_search_by_key(&triangle, |face| face.triangle).ok()?;
        Some(self.faces[place])
    }

    /// Counts triangles without crossings as cut, so that their pieces (all or nothing) can be added to others.
    pub(super) fn add_uncut(&mut self, triangles: impl IntoIterator<Item = u32>) {
        for triangle in triangles {
            if !self.is_cut(triangle) {
                self.is_cut.insert(triangle);
                self.faces.push(CutFace { triangle, first: 0, end: 0, edges: [UNCUT; 3] });
            }
        }
        self.faces.sort_by_key(|face| face.triangle);
    }

    /// The segments on a cut face.
    pub(super) fn segments(&self, face: &CutFace) -> &[u32] {
        &self.segments[face.first as usize..face.end as usize]
    }
}
