//! Edges to split.

use rustc_hash::FxHashMap;

use super::face::{Edge, Face, LocalPoint, edge_between};
use super::patch::Patch;
use crate::mesh::BitSet;

/// Edges to split, with the vertices on them.
pub(super) struct Splits {
    /// The vertices from the lower end to the higher one.
    on: FxHashMap<Edge, Vec<LocalPoint>>,
    /// The lower ends: most edges are told from those to split by this alone.
    lower_ends: BitSet,
}

impl Splits {
    pub(super) fn new(patch: &Patch<'_>) -> Self {
        Self { on: FxHashMap::default(), lower_ends: BitSet::new(patch.point_count()) }
    }

    /// Adds an edge with the vertices on it, from its lower end to its higher one.
    pub(super) fn insert(&mut self, edge: Edge, on: Vec<LocalPoint>) {
        self.lower_ends.insert(edge.0.0);
        self.on.insert(edge, on);
    }

    pub(super) fn is_empty(&self) -> bool {
        self.on.is_empty()
    }

    /// Whether the edge between two points is to be split.
    pub(super) fn contains(&self, from: LocalPoint, to: LocalPoint) -> bool {
        self.get(from, to).is_some()
    }

    /// Whether a side of a face is to be split.
    pub(super) fn concern(&self, face: &Face) -> bool {
        face.alive && face.sides().iter().any(|&(from, to)| self.contains(from, to))
    }

    fn get(&self, from: LocalPoint, to: LocalPoint) -> Option<&Vec<LocalPoint>> {
        let edge = edge_between(from, to);
        if self.lower_ends.contains(edge.0.0) { self.on.get(&edge) } else { None }
    }

    /// Puts the vertices along an edge into `path`, both ends included.
    pub(super) fn trace(&self, from: LocalPoint, to: LocalPoint, path: &mut Vec<LocalPoint>) {
        path.clear();
        path.push(from);
        match self.get(from, to) {
            Some(on) if from < to => path.extend(on),
            Some(on) => path.extend(on.iter().rev()),
            None => {}
        }
        path.push(to);
    }
}
