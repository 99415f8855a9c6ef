//! What of the arrangement a result keeps.

use super::arrangement::General;
use crate::boolean::arrangement::points::{AddedPoint, SheetCrossing};
use crate::boolean::complex::ids::{FaceId, LabelId, PointId};
use crate::boolean::complex::origin::Origin;
use crate::boolean::complex::planes::{lie_in_one_plane, look_same_way};
use crate::exact::unrounded::{Unrounded, on_one_line};
use crate::mesh::BitSet;

/// What of a face counts: what the result keeps as it is, what it turns over, or both with their signs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Part {
    Kept,
    Reversed,
    Both,
}

/// One result: which labels are inside it, and the points made for it.
pub(crate) struct Shape<'a> {
    pub(crate) general: &'a General,
    /// By label.
    pub(crate) inside: &'a [bool],
    /// Points numbered after all those of the arrangement.
    pub(crate) added: Vec<AddedPoint>,
    /// Faces that are not taken as they are: they are cut, or were added up with others.
    pub(crate) parted: BitSet,
}

impl<'a> Shape<'a> {
    /// 1 where a face between two labels is kept, -1 where it is turned over.
    #[inline]
    fn count(&self, outer: LabelId, inner: LabelId) -> i32 {
        i32::from(self.inside[inner.index()]) - i32::from(self.inside[outer.index()])
    }

    /// The shape of all labels that are `inside`.
    pub(crate) fn new(general: &'a General, inside: &'a [bool]) -> Self {
        let mut parted = BitSet::new(general.surfaces.face_count() as usize);
        general.cut.iter().for_each(|face| parted.insert(face.number()));
        Self { general, inside, added: Vec::new(), parted }
    }

    /// Calls `visit` for every whole face that counts, with its points and how often, in order.
    pub(crate) fn for_each_kept(&self, mut visit: impl FnMut(FaceId, [PointId; 3], i32)) {
        let identification = &self.general.identification;
        for face in self.general.surfaces.faces() {
            if self.parted.contains(face.number()) {
                continue;
            }
            let count = self.count_of_face(face);
            if count != 0 {
                let vertices = self.general.surfaces.vertices(face);
                let points = vertices.map(|v| identification.representative(PointId::new(v.number())));
                visit(face, points, count);
            }
        }
    }

    /// The nodes on edges between two faces of one plane.
    pub(crate) fn points_on_coplanar_edges(&self) -> Vec<PointId> {
        let General { edges, lines, crossings, .. } = self.general;
        let mut found = Vec::new();
        let mut last = None;
        for node in &crossings.nodes {
            // Nodes come by edges.
            if last.replace(node.edge) == Some(node.edge) {
                continue;
            }
            if let [x, y] = edges.sides(node.edge)
                && self.are_mergeable(self.origin(x.face(), false), self.origin(y.face(), false))
            {
                found.extend(lines.on_edge(node.edge).iter().map(|&node| crossings.point(node)));
            }
        }
        found
    }

    /// The ends of edges with more than two faces.
    pub(crate) fn points_on_pinched_edges(&self) -> Vec<PointId> {
        let General { edges, identification, .. } = self.general;
        let pinched = edges.iter().filter(|&(edge, _)| edges.sides(edge).len() > 2);
        let ends = pinched.flat_map(|(_, ends)| ends.map(|v| PointId::new(v.number())));
        ends.map(|point| identification.representative(point)).collect()
    }

    /// How often a face that is not cut counts.
    #[inline]
    pub(crate) fn count_of_face(&self, face: FaceId) -> i32 {
        let [outer, inner] = self.general.faces.of_face(face);
        self.count(outer, inner)
    }

    /// Whether something of a cut face is turned over.
    pub(crate) fn has_reversed(&self, face: FaceId) -> bool {
        let general = self.general;
        (0..3).any(|k| {
            let nodes = general.lines.on_edge(general.edges.edge(face, k)).len();
            let [outer, inner] = general.faces.of_side(face, k, nodes);
            outer.iter().zip(inner).any(|(&outer, &inner)| self.count(outer, inner) < 0)
        }) || general.crossings.of_face(face).iter().any(|&id| {
            let segment = general.crossings.segment(id);
            let triples = general.lines.on_segment(id).len();
            general.segment_labels.of_segment(id, triples).iter().any(|around| {
                let [near, far] = if segment.faces[0] == face {
                    [(around.outside, around.inside_first), (around.inside_second, around.inside)]
                } else {
                    [(around.outside, around.inside_second), (around.inside_first, around.inside)]
                };
                self.count(near.0, near.1) < 0 || self.count(far.0, far.1) < 0
            })
        })
    }

    /// Calls `add` for every directed edge that bounds a part of a face, to their left, with the side of the face it lies on, if
    /// on one, and how often it counts, which is never 0.
    pub(crate) fn for_boundary(
        &self,
        face: FaceId,
        part: Part,
        mut add: impl FnMut([PointId; 2], Option<usize>, i32),
    ) {
        let general = self.general;
        let (surfaces, crossings, lines) = (&general.surfaces, &general.crossings, &general.lines);
        let of_part = |count: i32| match part {
            Part::Kept => count.max(0),
            Part::Reversed => (-count).max(0),
            Part::Both => count,
        };
        let count = |outer: LabelId, inner: LabelId| of_part(self.count(outer, inner));
        let mut add = |from: PointId, to: PointId, side: Option<usize>, count: i32| {
            let identification = &general.identification;
            let (from, to) = (identification.representative(from), identification.representative(to));
            if from != to && count != 0 {
                add([from, to], side, count);
            }
        };
        let vertices = surfaces.vertices(face).map(|v| PointId::new(v.number()));
        let segments = crossings.of_face(face);
        // 1. The sides.
        if segments.is_empty() {
            let count = of_part(self.count_of_face(face));
            (0..3).for_each(|k| add(vertices[k], vertices[(k + 1) % 3], Some(k), count));
            return;
        }
        for k in 0..3 {
            let (edge, is_forward) = general.edges.of_side(surfaces, face, k);
            let nodes = lines.on_edge(edge);
            let [outer, inner] = general.faces.of_side(face, k, nodes.len());
            let [low, high] = general.edges.ends(edge).map(|v| PointId::new(v.number()));
            let direction = if is_forward { 1 } else { -1 };
            let mut from = low;
            let ends = nodes.iter().map(|&node| crossings.point(node)).chain([high]);
            for ((to, &outer), &inner) in ends.zip(outer).zip(inner) {
                add(from, to, Some(k), direction * count(outer, inner));
                from = to;
            }
        }
        // 2. The segments.
        for &id in segments {
            let segment = crossings.segment(id);
            let triples = lines.on_segment(id);
            let mut from = segment.tail;
            let ends = triples.iter().map(|&triple| lines.point(triple)).chain([segment.head]);
            for (to, around) in ends.zip(general.segment_labels.of_segment(id, triples.len())) {
                // Left less right.
                let count = if segment.faces[0] == face {
                    count(around.inside_second, around.inside) - count(around.outside, around.inside_first)
                } else {
                    count(around.outside, around.inside_second) - count(around.inside_first, around.inside)
                };
                add(from, to, None, count);
                from = to;
            }
        }
    }

    /// Where a point is.
    #[inline]
    pub(crate) fn position(&self, point: PointId) -> &[f64; 3] {
        match point.number().checked_sub(self.general.lines.point_count()) {
            None => self.general.lines.position(&self.general.surfaces, point),
            Some(place) => match &self.added[place as usize] {
                AddedPoint::Crossing(crossing) => &crossing.position,
                AddedPoint::Copy(position) => position,
            },
        }
    }

    /// The number that the next added point gets.
    pub(crate) fn next(&self) -> PointId {
        PointId::new(self.general.lines.point_count() + self.added.len() as u32)
    }

    /// A face as the origin of what is cut from it. (Origins are of one operand, the whole complex, until they are handed out.)
    pub(crate) fn origin(&self, face: FaceId, reversed: bool) -> Origin {
        Origin { operand: 0, triangle: face.number(), reversed }
    }

    /// The corners of the face that something comes from, turned over if that was.
    pub(crate) fn source(&self, origin: Origin) -> [[f64; 3]; 3] {
        let [a, b, c] = self.general.surfaces.positions(FaceId::new(origin.triangle));
        if origin.reversed { [a, c, b] } else { [a, b, c] }
    }

    /// Whether two sources look the same way from the same plane and belong to the same group.
    pub(crate) fn are_mergeable(&self, x: Origin, y: Origin) -> bool {
        if !self.belong_together(x, y) {
            return false;
        }
        if x.triangle == y.triangle {
            return x.reversed == y.reversed;
        }
        self.are_coplanar(x, y) && look_same_way(&self.source(x), &self.source(y))
    }

    /// Whether two sources belong to the same group.
    pub(crate) fn belong_together(&self, x: Origin, y: Origin) -> bool {
        let group = |origin: Origin| self.general.surfaces.group(FaceId::new(origin.triangle));
        group(x) == group(y)
    }

    /// Whether two sources lie in the same plane, exactly; false for triangles without area.
    pub(crate) fn are_coplanar(&self, x: Origin, y: Origin) -> bool {
        lie_in_one_plane(&self.source(x), &self.source(y))
    }

    /// Whether three points lay on one line before they were rounded; false if one of them is a copy.
    pub(crate) fn were_collinear(&self, points: [PointId; 3]) -> bool {
        let [Some(p), Some(q), Some(r)] = points.map(|point| self.unrounded(point)) else { return false };
        on_one_line(&[p, q, r])
    }

    fn unrounded(&self, point: PointId) -> Option<Unrounded> {
        let general = self.general;
        let crossing = |of: &SheetCrossing| Unrounded::Crossing(Box::new((of.edge, of.triangle)));
        if point >= self.next() {
            return None;
        }
        if let Some(place) = point.number().checked_sub(general.lines.point_count()) {
            return match &self.added[place as usize] {
                AddedPoint::Crossing(of) => Some(crossing(of)),
                AddedPoint::Copy(_) => None,
            };
        }
        if let Some(triple) = general.lines.triple_of(point) {
            let planes = super::triples::perturbed(&general.surfaces, general.lines.triple(triple));
            return Some(Unrounded::Planes(Box::new(planes)));
        }
        Some(match general.crossings.node_of(point) {
            None => Unrounded::Given(*self.position(point)),
            Some(node) => {
                let node = general.crossings.node(node);
                let of = super::lines::perturbed(&general.surfaces, &general.edges, node);
                Unrounded::Crossing(Box::new(of))
            }
        })
    }
}
