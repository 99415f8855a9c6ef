//! A face seen from the front, with all pieces of lines on it: which regions lie beside which, in rounded numbers.

use rustc_hash::FxHashMap;

use super::cells::{Beside, Ground};
use crate::boolean::complex::ids::{FaceId, PointId};
use crate::exact::Projection;
use crate::mesh::UnionFind;

/// Outside and inside the face.
pub(crate) type Both = [u32; 2];

/// A face with its lines in the plane.
pub(crate) struct FaceView {
    pub(crate) projection: Projection,
    pub(crate) pieces: Vec<Piece>,
    /// How many sets of lines there are that hang together. That of the border is the first.
    pub(crate) parts: usize,
}

/// A piece of a side of the face, or of a segment on it.
pub(crate) struct Piece {
    pub(crate) from: [f64; 2],
    pub(crate) to: [f64; 2],
    /// What lies to the left of it.
    left: Both,
    /// What lies to the right; nothing of a side.
    right: Option<Both>,
    /// Which of the parts it belongs to.
    pub(crate) part: u32,
}

/// Where a line across the face meets a piece.
#[derive(Clone, Copy)]
pub(crate) struct Crossing {
    pub(crate) x: f64,
    pub(crate) piece: usize,
    is_upward: bool,
}

impl FaceView {
    pub(crate) fn new(sectors: &Beside<'_>, face: FaceId) -> Self {
        let Ground { surfaces, edges, crossings, lines } = sectors.ground;
        let projection = Projection::of(&surfaces.positions(face));
        let place = |point: PointId| projection.project(lines.position(surfaces, point));
        let mut numbers: FxHashMap<PointId, u32> = FxHashMap::default();
        let mut pieces: Vec<([PointId; 2], Both, Option<Both>)> = Vec::new();
        // 1. The sides, as the face runs.
        for k in 0..3 {
            let (edge, is_forward) = edges.of_side(surfaces, face, k);
            let [low, high] = edges.ends(edge).map(|v| PointId::new(v.number()));
            let nodes = lines.on_edge(edge).iter().map(|&node| crossings.point(node));
            let mut from = low;
            for (piece, to) in nodes.chain([high]).enumerate() {
                let ends = if is_forward { [from, to] } else { [to, from] };
                pieces.push((ends, sectors.side(face, k, piece), None));
                from = to;
            }
        }
        // 2. The segments: on the first face the inner side of the second is to the left, on the second that of the first to the
        //    right.
        for &id in crossings.of_face(face) {
            let segment = crossings.segment(id);
            let is_first = segment.faces[0] == face;
            let mut from = segment.tail;
            let ends = lines.on_segment(id).iter().map(|&triple| lines.point(triple));
            for (piece, to) in ends.chain([segment.head]).enumerate() {
                let beside = |inside_partner: bool| {
                    [false, true].map(|inside_face| {
                        let inside = [inside_face, inside_partner];
                        let inside = if is_first { inside } else { [inside[1], inside[0]] };
                        sectors.quadrant(id, piece, inside)
                    })
                };
                pieces.push(([from, to], beside(is_first), Some(beside(!is_first))));
                from = to;
            }
        }
        // 3. What hangs together. (The sides come first, and so do their points.)
        let points = pieces.iter().flat_map(|(ends, ..)| *ends);
        for point in points {
            let next = numbers.len() as u32;
            numbers.entry(point).or_insert(next);
        }
        let mut sets = UnionFind::new(numbers.len());
        pieces.iter().for_each(|([from, to], ..)| sets.join(numbers[from], numbers[to]));
        let (parts, part_of) = sets.labels();
        let pieces = pieces.into_iter().map(|([from, to], left, right)| Piece {
            from: place(from),
            to: place(to),
            left,
            right,
            part: part_of[numbers[&from] as usize],
        });
        Self { projection, pieces: pieces.collect(), parts }
    }

    /// Where a line of a constant second coordinate meets pieces, ascending.
    pub(crate) fn crossings_at(&self, y: f64, found: &mut Vec<Crossing>) {
        found.clear();
        for (index, piece) in self.pieces.iter().enumerate() {
            let ([from_x, from_y], [to_x, to_y]) = (piece.from, piece.to);
            if (from_y <= y) != (to_y <= y) {
                let share = (y - from_y) / (to_y - from_y);
                let x = from_x + share * (to_x - from_x);
                found.push(Crossing { x, piece: index, is_upward: from_y < to_y });
            }
        }
        found.sort_by(|p, q| p.x.total_cmp(&q.x));
    }

    /// What lies before a crossing, where x is less; nothing beyond the border.
    pub(crate) fn before(&self, crossing: Crossing) -> Option<Both> {
        let piece = &self.pieces[crossing.piece];
        if crossing.is_upward { Some(piece.left) } else { piece.right }
    }

    /// What lies after it.
    pub(crate) fn after(&self, crossing: Crossing) -> Option<Both> {
        let piece = &self.pieces[crossing.piece];
        if crossing.is_upward { piece.right } else { Some(piece.left) }
    }

    /// What lies beside the face at a point of it.
    pub(crate) fn at(&self, point: &[f64; 3], found: &mut Vec<Crossing>) -> Option<Both> {
        let [x, y] = self.projection.project(point);
        self.crossings_at(y, found);
        let next = found.partition_point(|crossing| crossing.x <= x);
        let by_next = found.get(next).and_then(|&crossing| self.before(crossing));
        by_next.or_else(|| self.after(*found.get(next.checked_sub(1)?)?))
    }

    /// What of different parts is beside each other, so that all regions of the face are one each.
    pub(crate) fn join_parts(&self, joins: &mut Vec<[u32; 2]>) {
        /// Lines that are tried, through the steepest pieces of a part.
        const TRIED: usize = 8;
        let mut found = Vec::new();
        for part in 1..self.parts as u32 {
            let height = |piece: &Piece| (piece.to[1] - piece.from[1]).abs();
            let mut own: Vec<&Piece> = self.pieces.iter().filter(|piece| piece.part == part).collect();
            own.sort_by(|p, q| height(q).total_cmp(&height(p)));
            let tried = own.iter().take(TRIED);
            let joined = tried.flat_map(|piece| {
                self.crossings_at(0.5 * (piece.from[1] + piece.to[1]), &mut found);
                [self.past_last(part, &found), self.before_first(part, &found)]
            });
            // Where lines touch, their order is not known: the first place where they are apart.
            if let Some([x, y]) = joined.flatten().next() {
                joins.extend([[x[0], y[0]], [x[1], y[1]]]);
            }
        }
    }

    /// What lies past the last crossing with a part, seen from there and from the next crossing.
    fn past_last(&self, part: u32, found: &[Crossing]) -> Option<[Both; 2]> {
        let last = found.iter().rposition(|crossing| self.pieces[crossing.piece].part == part)?;
        let (last, next) = (found[last], *found.get(last + 1)?);
        if !are_apart(last, next) {
            return None;
        }
        Some([self.after(last)?, self.before(next)?])
    }

    /// The same before the first.
    fn before_first(&self, part: u32, found: &[Crossing]) -> Option<[Both; 2]> {
        let first = found.iter().position(|crossing| self.pieces[crossing.piece].part == part)?;
        let (first, last) = (found[first], *found.get(first.checked_sub(1)?)?);
        if !are_apart(last, first) {
            return None;
        }
        Some([self.before(first)?, self.after(last)?])
    }
}

/// Whether two crossings of a line are further apart than rounding.
fn are_apart(x: Crossing, y: Crossing) -> bool {
    y.x - x.x > 64.0 * f64::EPSILON * x.x.abs().max(y.x.abs())
}
