//! Faces that touch in one plane form sheets; points of one face or sheet at the same place become one.

use super::crossings::Crossings;
use super::edges::Edges;
use super::lines::Lines;
use super::surfaces::Surfaces;
use crate::Error;
use crate::boolean::arrangement::identify::{Identification, Placed, find_coincidences};
use crate::boolean::arrangement::sheets::Sheet;
use crate::boolean::complex::ids::{FaceId, PointId};
use crate::mesh::SparseUnionFind;
use crate::parallel::Runner;

/// Faces that one thread looks at before the limits are checked.
const FACES_AT_ONCE: usize = 1024;

/// The sets of faces that are connected by touching; each ascending.
pub(crate) fn find_sheets(touching: &[[FaceId; 2]]) -> Vec<Sheet> {
    let mut classes = SparseUnionFind::default();
    touching.iter().for_each(|&[f, g]| classes.join(f, g));
    classes.into_sets()
}

/// Identifies the points of every cut face, and those of every sheet.
///
/// # Errors
/// Only limits.
pub(crate) fn identify(
    surfaces: &Surfaces,
    edges: &Edges,
    crossings: &Crossings,
    lines: &Lines,
    cut: &[FaceId],
    sheets: &[Sheet],
    runner: Runner<'_>,
) -> Result<Identification, Error> {
    let points = PointsOfFaces { surfaces, edges, crossings, lines };
    let pairs = runner.gather(cut.len(), FACES_AT_ONCE, 0, |range, pairs| {
        let mut at = Vec::new();
        for &face in &cut[range] {
            at.clear();
            points.collect(face, &mut at);
            find_coincidences(&mut at, pairs);
        }
    })?;
    let mut classes = SparseUnionFind::default();
    let mut join = |pairs: Vec<[u32; 2]>| {
        pairs.into_iter().for_each(|[u, v]| classes.join(PointId::new(u), PointId::new(v)));
    };
    join(pairs);
    for sheet in sheets {
        let (mut at, mut pairs) = (Vec::new(), Vec::new());
        sheet.iter().for_each(|&face| points.collect(face, &mut at));
        find_coincidences(&mut at, &mut pairs);
        join(pairs);
    }
    Ok(Identification::of_classes(classes, lines.point_count() as usize))
}

struct PointsOfFaces<'a> {
    surfaces: &'a Surfaces,
    edges: &'a Edges,
    crossings: &'a Crossings,
    lines: &'a Lines,
}

impl PointsOfFaces<'_> {
    /// Appends the corners of a face and all points on it.
    fn collect(&self, face: FaceId, at: &mut Vec<Placed>) {
        let mut add = |point: PointId| at.push((point.number(), *self.lines.position(self.surfaces, point)));
        self.surfaces.vertices(face).into_iter().for_each(|v| add(PointId::new(v.number())));
        let segments = self.crossings.of_face(face);
        if segments.is_empty() {
            return;
        }
        for k in 0..3 {
            let nodes = self.lines.on_edge(self.edges.edge(face, k));
            nodes.iter().for_each(|&node| add(self.crossings.point(node)));
        }
        for &segment in segments {
            let of = self.crossings.segment(segment);
            // Nodes of edges of the other face.
            for end in [of.tail, of.head] {
                if self.crossings.node_of(end).is_some_and(|node| self.crossings.node(node).face == face) {
                    add(end);
                }
            }
            self.lines.on_segment(segment).iter().for_each(|&triple| add(self.lines.point(triple)));
        }
    }
}
