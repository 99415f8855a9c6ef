//! The label on the outer side of every face: along its sides for faces that are cut, one for all others.
//!
//! Everything follows from local steps, and no region is traced:
//!
//! - past a node with face g a side's label changes by the step of g, up where the side goes inside g and down where it leaves;
//! - round a corner v of f, from side to side, it changes by the step of every g whose segment with f begins at v, up where
//!   the next side lies inside g;
//! - round an edge with two faces it is the same for both; with more, crossing a face in radial order changes it;
//! - in a patch, and in a face that is not cut, it is the same everywhere.
//!
//! So one label for each piece of surface gives all: that beside its vertex with the largest x, by a ray in +x.

use super::crossings::Crossings;
use super::edges::{Edges, Side};
use super::labels::Labels;
use super::lines::Lines;
use super::locality::Locality;
use super::seeds::Seed;
use super::surfaces::Surfaces;
use crate::Error;
use crate::boolean::complex::ids::{EdgeId, FaceId, LabelId, NodeId};
use crate::control::Control;

/// Faces that are looked at before the limits are checked.
const FACES_AT_ONCE: usize = 1 << 14;

/// The labels of all faces.
#[derive(Debug)]
pub(crate) struct FaceLabels {
    pub(crate) labels: Labels,
    /// By face: its label where it is not cut, else its place among the cut faces met.
    pub(super) of_face: Vec<u32>,
    /// By face, the label on the inner side, where it is not cut.
    pub(super) inner: Vec<LabelId>,
    /// For each cut face, side by side, the labels of its pieces from the low end of the edge to the high end.
    pub(super) of_pieces: Vec<LabelId>,
    /// The same on the inner side.
    pub(super) inner_of_pieces: Vec<LabelId>,
    /// By cut face met, where the lists of its three sides begin.
    pub(super) starts: Vec<[u32; 3]>,
}

impl FaceLabels {
    /// Those of no faces.
    pub(super) fn none() -> Self {
        let (inner, of_pieces, inner_of_pieces) = (Vec::new(), Vec::new(), Vec::new());
        Self {
            labels: Labels::new(),
            of_face: Vec::new(),
            inner,
            of_pieces,
            inner_of_pieces,
            starts: Vec::new(),
        }
    }

    /// Walks over all pieces of surface, each from its seed.
    ///
    /// # Errors
    /// Only limits.
    pub(crate) fn new(
        surfaces: &Surfaces,
        edges: &Edges,
        locality: &Locality,
        crossings: &Crossings,
        lines: &Lines,
        seeds: &[Seed],
        control: &Control,
    ) -> Result<Self, Error> {
        let count = surfaces.face_count() as usize;
        let mut walk = Walk {
            surfaces,
            edges,
            locality,
            crossings,
            lines,
            of_patches: vec![LabelId::NONE; locality.count()],
            found: Self {
                labels: Labels::new(),
                of_face: vec![u32::MAX; count],
                inner: vec![LabelId::NONE; count],
                of_pieces: Vec::new(),
                inner_of_pieces: Vec::new(),
                starts: Vec::new(),
            },
            stack: Vec::new(),
        };
        for seed in seeds {
            let label = walk.found.labels.intern(seed.label.clone());
            walk.enter(seed.side, seed.at_low, label);
            let mut seen = 0;
            while let Some(face) = walk.stack.pop() {
                if seen % FACES_AT_ONCE == 0 {
                    control.check()?;
                }
                seen += 1;
                walk.leave(face);
            }
        }
        walk.fill_patches();
        debug_assert!(walk.found.of_face.iter().all(|&label| label != u32::MAX), "every piece has a seed");
        Ok(walk.found)
    }

    /// The labels on the outer side and on the inner side of a face that is not cut.
    #[inline]
    pub(crate) fn of_face(&self, face: FaceId) -> [LabelId; 2] {
        [LabelId::new(self.of_face[face.index()]), self.inner[face.index()]]
    }

    /// The labels on the outer side of a cut face along its side k, from the low end of the edge to the high end: one more than
    /// there are nodes; and those on the inner side.
    pub(crate) fn of_side(&self, face: FaceId, k: usize, nodes: usize) -> [&[LabelId]; 2] {
        let first = self.starts[self.of_face[face.index()] as usize][k] as usize;
        let range = first..=first + nodes;
        [&self.of_pieces[range.clone()], &self.inner_of_pieces[range]]
    }
}

struct Walk<'a> {
    surfaces: &'a Surfaces,
    edges: &'a Edges,
    locality: &'a Locality,
    crossings: &'a Crossings,
    lines: &'a Lines,
    /// By patch, its label, if it is known.
    of_patches: Vec<LabelId>,
    found: FaceLabels,
    stack: Vec<FaceId>,
}

impl Walk<'_> {
    /// Gives a face its labels, of which one is known: that at an end of the edge that one of its sides is.
    fn enter(&mut self, side: Side, at_low: bool, label: LabelId) {
        let face = side.face();
        if self.found.of_face[face.index()] != u32::MAX {
            debug_assert_eq!(self.label_at(side, at_low), label, "labels agree round every loop");
            return;
        }
        self.stack.push(face);
        let (owner, step) = (self.surfaces.owner(face), self.surfaces.step(face));
        if self.crossings.of_face(face).is_empty() {
            self.found.of_face[face.index()] = label.number();
            self.found.inner[face.index()] = self.found.labels.step(label, owner, step);
            return;
        }
        // Room for the labels of the three sides.
        let first = self.found.of_pieces.len() as u32;
        let mut starts = [0; 3];
        let mut end = first;
        for (k, start) in starts.iter_mut().enumerate() {
            *start = end;
            end += self.lines.on_edge(self.edges.edge(face, k)).len() as u32 + 1;
        }
        self.found.of_face[face.index()] = self.found.starts.len() as u32;
        self.found.of_pieces.resize(end as usize, LabelId::NONE);
        self.found.starts.push(starts);
        // Round the face, from the known side on.
        let mut known = (at_low, label);
        for i in 0..3 {
            let k = (side.place() + i) % 3;
            let last = self.along_side(face, k, starts[k] as usize, known);
            if i < 2 {
                let (_, next_is_forward) = self.edges.of_side(self.surfaces, face, (k + 1) % 3);
                known = (next_is_forward, self.round_corner(face, (k + 1) % 3, last));
            }
        }
        for place in first as usize..end as usize {
            let inner = self.found.labels.step(self.found.of_pieces[place], owner, step);
            self.found.inner_of_pieces.push(inner);
        }
    }

    /// Fills in the labels along a side, from its known one, and returns that at its end.
    fn along_side(
        &mut self,
        face: FaceId,
        k: usize,
        first: usize,
        (at_low, label): (bool, LabelId),
    ) -> LabelId {
        let (edge, is_forward) = self.edges.of_side(self.surfaces, face, k);
        let nodes = self.lines.on_edge(edge);
        let labels = &mut self.found.labels;
        let pieces = &mut self.found.of_pieces[first..=first + nodes.len()];
        // Up the edge: inside a face after it was entered.
        let change = |node: NodeId| {
            let node = self.crossings.node(node);
            let step = self.surfaces.step(node.face);
            (self.surfaces.owner(node.face), if node.leaves { -step } else { step })
        };
        if at_low {
            pieces[0] = label;
            for (i, &node) in nodes.iter().enumerate() {
                let (owner, step) = change(node);
                pieces[i + 1] = labels.step(pieces[i], owner, step);
            }
        } else {
            pieces[nodes.len()] = label;
            for (i, &node) in nodes.iter().enumerate().rev() {
                let (owner, step) = change(node);
                pieces[i] = labels.step(pieces[i + 1], owner, -step);
            }
        }
        if is_forward { pieces[nodes.len()] } else { pieces[0] }
    }

    /// The label at the start of side k of a face, from that at the end of the side before: past all segments that begin at the
    /// corner between them.
    fn round_corner(&mut self, face: FaceId, k: usize, mut label: LabelId) -> LabelId {
        let vertices = self.surfaces.vertices(face);
        let corner = vertices[k];
        for &id in self.crossings.of_face(face) {
            let segment = self.crossings.segment(id);
            let begins = |point: crate::boolean::complex::ids::PointId| point.number() == corner.number();
            if !begins(segment.tail) && !begins(segment.head) {
                continue;
            }
            let g = segment.partner(face);
            // From tail to head the inner side of the partner lies to the left on the first face, to the right on the second.
            // Seen from the corner, the side that begins there lies to the right of the segment.
            let from_corner = begins(segment.tail);
            let inside_left = from_corner == (segment.faces[0] == face);
            let step = self.surfaces.step(g);
            label =
                self.found.labels.step(label, self.surfaces.owner(g), if inside_left { -step } else { step });
        }
        label
    }

    /// The label on a face's outer side at an end of the edge that a side of it is.
    fn label_at(&self, side: Side, at_low: bool) -> LabelId {
        let face = side.face();
        if self.crossings.of_face(face).is_empty() {
            return self.found.of_face(face)[0];
        }
        let nodes = self.lines.on_edge(self.edges.edge(face, side.place())).len();
        let [labels, _] = self.found.of_side(face, side.place(), nodes);
        labels[if at_low { 0 } else { nodes }]
    }

    /// Goes on from a face to those round its edges.
    fn leave(&mut self, face: FaceId) {
        for k in 0..3 {
            let edge = self.edges.edge(face, k);
            let sides = self.edges.sides(edge);
            let place = sides.iter().position(|side| side.face() == face && side.place() == k);
            let place = place.expect("the side is one of its edge's");
            let label = self.label_at(sides[place], true);
            match sides {
                // Beyond lies a patch.
                [_] => {}
                [x, y] => self.enter(if place == 0 { *y } else { *x }, true, label),
                _ => self.round_edge(edge, place, label),
            }
        }
        for vertex in self.surfaces.vertices(face) {
            if let Some(patch) = self.locality.of_vertex(vertex)
                && self.of_patches[patch] == LabelId::NONE
            {
                self.cross_patch(patch, self.found.of_face(face)[0]);
            }
        }
    }

    /// Goes on to the faces at the border of a patch. (They are not cut, or they would have no vertex in it.)
    fn cross_patch(&mut self, patch: usize, label: LabelId) {
        self.of_patches[patch] = label;
        let locality = self.locality;
        for &face in locality.bordering(patch) {
            self.enter(Side::first_of(face), true, label);
        }
    }

    /// Gives all faces within patches their labels.
    fn fill_patches(&mut self) {
        let mut last = (usize::MAX, [LabelId::NONE; 2]);
        for face in self.surfaces.faces() {
            let of_face = &mut self.found.of_face[face.index()];
            if *of_face != u32::MAX {
                continue;
            }
            let Some(patch) = self.locality.of_vertex(self.surfaces.vertices(face)[0]) else { continue };
            if last.0 != patch {
                // (A patch is of one operand, and each of its faces counts once.)
                let outer = self.of_patches[patch];
                let inner =
                    self.found.labels.step(outer, self.surfaces.owner(face), self.surfaces.step(face));
                last = (patch, [outer, inner]);
            }
            *of_face = last.1[0].number();
            self.found.inner[face.index()] = last.1[1];
        }
    }

    /// Goes round an edge with more than two faces, in the radial order that its sides are in.
    fn round_edge(&mut self, edge: EdgeId, place: usize, label: LabelId) {
        let sides = self.edges.sides(edge).to_vec();
        let step = |side: Side| (self.surfaces.owner(side.face()), self.surfaces.step(side.face()));
        let is_forward = |side: Side| self.edges.of_side(self.surfaces, side.face(), side.place()).1;
        // The sector after a face that runs as the edge does is its outer side.
        let (owner, change) = step(sides[place]);
        let mut sector =
            if is_forward(sides[place]) { label } else { self.found.labels.step(label, owner, change) };
        for i in 1..sides.len() {
            let side = sides[(place + i) % sides.len()];
            let (owner, change) = step(side);
            let outer = if is_forward(side) {
                sector = self.found.labels.step(sector, owner, -change);
                sector
            } else {
                let outer = sector;
                sector = self.found.labels.step(sector, owner, change);
                outer
            };
            self.enter(side, true, outer);
        }
    }
}
