//! Gathering a patch: the pieces of cut faces, and the kept uncut triangles around their points.

use rustc_hash::FxHashSet;

use super::face::{Face, LocalPoint};
use super::patch::{Contents, Patch};
use super::source::Source;
use crate::boolean::complex::ids::PointId;
use crate::boolean::cut::piece::Piece;
use crate::mesh::BitSet;

/// A patch of the pieces and of all kept triangles around their points, around points that became one, and around the `extra`
/// points. O(triangles of the operands).
pub(super) fn gather<'a>(source: Source<'a>, pieces: &[Piece], extra: &[PointId]) -> Patch<'a> {
    // 1. The points that are to have all their triangles in the patch. Kept triangles of both operands may share a point
    //    where all that was cut cancelled, so points that became one are among them.
    let mut complete = BitSet::new(source.point_count());
    let of_pieces = pieces.iter().flat_map(|piece| piece.corners);
    for point in of_pieces.chain(source.representatives()).chain(extra.iter().copied()) {
        complete.insert(point.number());
    }
    // 2. Their kept triangles, then the pieces, still by the numbers of the source.
    let (mut triangles, taken) = kept_triangles(source, &complete);
    triangles.extend(pieces.iter().map(|piece| GatheredTriangle { new: *piece, untouched: false }));
    // 3. Numbers of the patch's own.
    let numbering =
        Numbering::of(source.point_count(), triangles.iter().flat_map(|triangle| triangle.new.corners));
    let numbers = numbering.source_points();
    let mut locally_complete = BitSet::new(numbers.len());
    for (local, &point) in (0..).zip(&numbers) {
        if complete.contains(point.number()) {
            locally_complete.insert(local);
        }
    }
    let faces = triangles.into_iter().map(|GatheredTriangle { new, untouched }| Face {
        corners: new.corners.map(|point| numbering.local(point)),
        origin: new.origin,
        untouched,
        flat: new.flat,
        alive: true,
    });
    Patch::new(
        source,
        Contents {
            faces: faces.collect(),
            outer_edges: outer_edges(source, &complete, &numbering),
            numbers,
            complete: locally_complete,
            taken,
        },
    )
}

/// A triangle of the patch to be, by the numbers of the source.
struct GatheredTriangle {
    new: Piece,
    untouched: bool,
}

/// The kept triangles at points that are to be complete, as often as they count; and, by side, which they are.
fn kept_triangles(source: Source<'_>, complete: &BitSet) -> (Vec<GatheredTriangle>, [Vec<u32>; 2]) {
    let mut triangles = Vec::new();
    let mut taken = [Vec::new(), Vec::new()];
    source.for_each_kept(|kept| {
        if !kept.points.iter().any(|point| complete.contains(point.number())) {
            return;
        }
        taken[kept.origin.operand as usize].push(kept.origin.triangle);
        let [a, b, c] = kept.points;
        let corners = if kept.origin.reversed { [a, c, b] } else { [a, b, c] };
        let new = Piece { corners, origin: kept.origin, flat: false };
        for _ in 0..kept.copies {
            triangles.push(GatheredTriangle { new, untouched: kept.is_simple });
        }
    });
    (triangles, taken)
}

/// The directed edges between points of the patch that kept triangles outside the patch have.
fn outer_edges(
    source: Source<'_>,
    complete: &BitSet,
    numbering: &Numbering,
) -> FxHashSet<(LocalPoint, LocalPoint)> {
    let mut edges = FxHashSet::default();
    source.for_each_kept(|kept| {
        if kept.points.iter().any(|point| complete.contains(point.number())) {
            return;
        }
        for k in 0..3 {
            let (u, v) = (kept.points[k], kept.points[(k + 1) % 3]);
            if numbering.contains(u) && numbering.contains(v) {
                let (u, v) = (numbering.local(u), numbering.local(v));
                edges.insert(if kept.origin.reversed { (v, u) } else { (u, v) });
            }
        }
    });
    edges
}

/// Numbers without gaps for some of the source's points, in their order: a bit set with a count before each word.
struct Numbering {
    chosen: BitSet,
    /// How many chosen points come before each word of the set.
    before: Vec<u32>,
}

impl Numbering {
    /// Numbers for the given ones of `count` points.
    fn of(count: usize, points: impl IntoIterator<Item = PointId>) -> Self {
        let mut chosen = BitSet::new(count);
        points.into_iter().for_each(|point| chosen.insert(point.number()));
        let mut sum = 0;
        let mut before = Vec::with_capacity(chosen.words().len());
        for word in chosen.words() {
            before.push(sum);
            sum += word.count_ones();
        }
        Self { chosen, before }
    }

    fn contains(&self, point: PointId) -> bool {
        self.chosen.contains(point.number())
    }

    /// The patch's number of a chosen point.
    #[inline]
    fn local(&self, point: PointId) -> LocalPoint {
        let point = point.number();
        let (word, bit) = (point as usize / 64, point % 64);
        LocalPoint(self.before[word] + (self.chosen.words()[word] & ((1 << bit) - 1)).count_ones())
    }

    /// The chosen points, ascending: the one numbered i by the patch at place i.
    fn source_points(&self) -> Vec<PointId> {
        let mut all = Vec::new();
        for (word, first) in self.chosen.words().iter().zip((0..).step_by(64)) {
            let mut left = *word;
            while left != 0 {
                all.push(PointId::new(first + left.trailing_zeros()));
                left &= left - 1;
            }
        }
        all
    }
}
