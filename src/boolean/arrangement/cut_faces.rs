//! The triangles that the intersection curve passes, with the segments on each.

use std::ops::Range;

use crate::boolean::arrangement::crossings::{Crossing, Crossings};
use crate::boolean::arrangement::cut_edges::CutEdges;
use crate::boolean::complex::operands::Operands;
use crate::mesh::BitSet;
use crate::spatial::{radix_sort, read_ahead};

/// A cut triangle of one operand.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CutFace {
    pub(crate) triangle: u32,
    first: u32,
    end: u32,
    /// For each side of the triangle (from corner k to corner k+1) the cut edge it is, or [`UNCUT`].
    pub(crate) edges: [u32; 3],
}

/// Faces or segments whose data are read at once.
const READ_AHEAD: usize = 64;

/// Marks a side without crossings.
pub(crate) const UNCUT: u32 = u32::MAX;

/// The cut triangles of one operand, ascending.
#[derive(Debug, Default)]
pub(crate) struct CutFaces {
    pub(crate) faces: Vec<CutFace>,
    /// Segment numbers, face by face.
    segments: Vec<u32>,
    is_cut: BitSet,
}

impl CutFaces {
    pub(crate) fn new(operands: &Operands<'_>, side: usize, crossings: &Crossings, edges: &CutEdges) -> Self {
        let all = &crossings.segments;
        let segments: Vec<u32> = if side == 0 {
            // They are sorted by triangle of A already.
            (0..all.len() as u32).collect()
        } else {
            let mut order: Vec<[u32; 2]> =
                all.iter().zip(0..).map(|(segment, i)| [segment.triangles[1], i]).collect();
            let bits = u32::BITS - (operands.sides[1].triangles.len() as u32).leading_zeros();
            radix_sort(&mut order, &mut Vec::new(), |key| key[0], bits);
            order.iter().map(|key| key[1]).collect()
        };
        let first_vertex = operands.first_vertex(side);
        let mut corners = [0; 3];
        let mut is_cut = BitSet::new(operands.sides[side].triangles.len());
        let mut faces: Vec<CutFace> = Vec::new();
        for (i, &number) in segments.iter().enumerate() {
            if i % READ_AHEAD == 0 {
                let next = &segments[i..(i + READ_AHEAD).min(segments.len())];
                read_ahead(next.iter().map(|&segment| {
                    let segment = &all[segment as usize];
                    let [tail, head] = [segment.tail, segment.head].map(|node| node as usize);
                    crossings.nodes[tail].low
                        ^ crossings.nodes[head].low
                        ^ edges.edge_of_node[tail]
                        ^ edges.edge_of_node[head]
                }));
            }
            let segment = &all[number as usize];
            let triangle = segment.triangles[side];
            match faces.last_mut() {
                Some(face) if face.triangle == triangle => face.end += 1,
                _ => {
                    is_cut.insert(triangle);
                    faces.push(CutFace { triangle, first: i as u32, end: i as u32 + 1, edges: [UNCUT; 3] });
                    corners = operands.sides[side].triangles[triangle as usize].map(|v| first_vertex + v);
                }
            }
            // A segment that ends on the triangle's boundary ends on one of its own edges.
            let face = faces.last_mut().expect("pushed above");
            for node in [segment.tail, segment.head] {
                if crossings.side_of_node(node) != side {
                    continue;
                }
                let edge = edges.edge_of_node[node as usize];
                let Crossing { low, high, .. } = crossings.nodes[node as usize];
                let k = (0..3)
                    .find(|&k| {
                        let (u, v) = (corners[k], corners[(k + 1) % 3]);
                        (u.min(v), u.max(v)) == (low, high)
                    })
                    .expect("the edge is one of the triangle's");
                face.edges[k] = edge;
            }
        }
        Self { faces, segments, is_cut }
    }

    /// Whether a triangle is cut.
    #[inline]
    pub(crate) fn is_cut(&self, triangle: u32) -> bool {
        self.is_cut.contains(triangle)
    }

    /// A cut triangle by its number.
    pub(crate) fn face(&self, triangle: u32) -> Option<CutFace> {
        let place = self.faces.binary_search_by_key(&triangle, |face| face.triangle).ok()?;
        Some(self.faces[place])
    }

    /// Counts triangles without crossings as cut, so that their pieces (all or nothing) can be added to others.
    pub(crate) fn add_uncut(&mut self, triangles: impl IntoIterator<Item = u32>) {
        for triangle in triangles {
            if !self.is_cut(triangle) {
                self.is_cut.insert(triangle);
                self.faces.push(CutFace { triangle, first: 0, end: 0, edges: [UNCUT; 3] });
            }
        }
        self.faces.sort_by_key(|face| face.triangle);
    }

    /// Calls `visit` for a range of places of faces. What will be looked up for some dozens of them is read ahead, and
    /// `of_vertex` of the corners.
    pub(crate) fn for_each_place(
        &self,
        range: Range<usize>,
        side: usize,
        operands: &Operands<'_>,
        crossings: &Crossings,
        edges: &CutEdges,
        of_vertex: impl Fn(u32) -> u32,
        mut visit: impl FnMut(u32),
    ) {
        for start in range.clone().step_by(READ_AHEAD) {
            let part = start..(start + READ_AHEAD).min(range.end);
            self.read(part.clone(), side, operands, crossings, edges, &of_vertex);
            part.for_each(|place| visit(place as u32));
        }
    }

    /// Reads where the corners and nodes of some faces are.
    fn read(
        &self,
        range: Range<usize>,
        side: usize,
        operands: &Operands<'_>,
        crossings: &Crossings,
        edges: &CutEdges,
        of_vertex: impl Fn(u32) -> u32,
    ) {
        let operand = &operands.sides[side];
        let low_bits = |position: &[f64; 3]| (position[0].to_bits() ^ position[2].to_bits()) as u32;
        let faces = &self.faces[range];
        read_ahead(faces.iter().map(|face| {
            let [u, v, w] = operand.triangles[face.triangle as usize];
            let of_corner = |v: u32| low_bits(&operand.positions[v as usize]) ^ of_vertex(v);
            of_corner(u) ^ of_corner(v) ^ of_corner(w)
        }));
        let cut_edges = faces.iter().flat_map(|face| face.edges).filter(|&edge| edge != UNCUT);
        read_ahead(cut_edges.map(|edge| {
            let node = edges.first_node(edge) as usize;
            crossings.nodes[node].low ^ low_bits(&edges.positions[node])
        }));
        // (Faces without crossings have no place among the segments.)
        read_ahead(faces.iter().flat_map(|face| self.segments(face)).map(|&segment| {
            let segment = &crossings.segments[segment as usize];
            low_bits(&edges.positions[segment.tail as usize])
        }));
    }

    /// The segments on a cut face.
    pub(crate) fn segments(&self, face: &CutFace) -> &[u32] {
        &self.segments[face.first as usize..face.end as usize]
    }
}
