//! A body of the result: which parts of the operands' surfaces it is put together from, and what of each face that is.

use super::multiplicity::Part;
use super::winding::Windings;
use crate::boolean::arrangement::Arrangement;
use crate::boolean::arrangement::cut_faces::CutFace;
use crate::boolean::arrangement::points::Points;
use crate::boolean::complex::Complex;
use crate::boolean::complex::ids::PointId;

/// A sum of parts, and all that is known of what they are cut from.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Body<'a> {
    pub(crate) arrangement: &'a Arrangement<'a>,
    pub(crate) windings: &'a Windings,
    pub(crate) parts: &'a [Part],
}

impl<'a> Body<'a> {
    pub(crate) fn complex(&self) -> &'a Complex<'a> {
        self.arrangement.curve.complex
    }

    /// The parts that are pieces of one operand's surface.
    pub(crate) fn parts_of(&self, operand: usize) -> impl Iterator<Item = Part> + use<'a> {
        self.parts.iter().copied().filter(move |part| part.operand == operand)
    }

    /// Appends the directed edges that bound the kept region of a face, to their left; each as often as it counts. (Those
    /// of a plane face's members add up.)
    pub(crate) fn add_boundary(&self, part: Part, face: &CutFace, boundary: &mut Vec<[PointId; 2]>) {
        self.for_boundary(part, face, |edge, _, count| {
            boundary.extend(std::iter::repeat_n(edge, count as usize));
        });
    }

    /// Calls `add` for every directed edge that bounds the kept region of a face, with the side of the face it is a part
    /// of, if it is one, and how often it counts.
    pub(crate) fn for_boundary(
        &self,
        part: Part,
        face: &CutFace,
        mut add: impl FnMut([PointId; 2], Option<usize>, u32),
    ) {
        let Arrangement { curve, plane_faces, points, identification, .. } = self.arrangement;
        let complex = curve.complex;
        let windings = self.windings.of_operand(part.operand);
        let first_vertex = complex.first_vertex(part.operand);
        let mut add = |from: PointId, to: PointId, side: Option<usize>, count: i32| {
            let (from, to) = (identification.representative(from), identification.representative(to));
            if from != to && count != 0 {
                add(if count > 0 { [from, to] } else { [to, from] }, side, count.unsigned_abs());
            }
        };
        // 1. The sides: between crossings the multiplicity is constant, and it is positive where the side runs as the face
        //    does.
        let corners = complex.vertices(face.id);
        for k in 0..3 {
            let (u, v) = (corners[k], corners[(k + 1) % 3]);
            let (low, high) = (u.min(v), u.max(v));
            let mut winding = windings[(low.number() - first_vertex) as usize];
            let Some(edge) = face.edges[k].get() else {
                let count = part.sign() * part.multiplicity(winding);
                add(Points::of_vertex(u), Points::of_vertex(v), Some(k), count);
                continue;
            };
            let direction = if u == low { part.sign() } else { -part.sign() };
            let mut from = Points::of_vertex(low);
            for &node in curve.edges.nodes(edge) {
                let to = points.of_node(node);
                add(from, to, Some(k), direction * part.multiplicity(winding));
                winding += curve.crossings[node].winding_step();
                from = to;
            }
            add(from, Points::of_vertex(high), Some(k), direction * part.multiplicity(winding));
        }
        // 2. The segments of the intersection curve.
        for &segment in curve.faces[part.operand].segments(face) {
            let ends = &curve.crossings[segment];
            if let Some(head) = plane_faces.run_end(segment, ends.head) {
                let (tail, head) = (points.of_node(ends.tail), points.of_node(head));
                add(tail, head, None, part.segment_direction());
            }
        }
    }
}
