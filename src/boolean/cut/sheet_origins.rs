//! Which faces the triangles of a sum of faces come from.

use crate::boolean::complex::origin::Origin;
use crate::exact::{Sign, orient2d};
use crate::spatial::{BoxTree, Frame};

/// A face that triangles of a sum can come from, seen in the plane of the sum.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FlatSource {
    pub(crate) origin: Origin,
    /// Whether what comes from it is seen counter-clockwise.
    pub(crate) looks_up: bool,
    pub(crate) corners: [[f64; 2]; 3],
}

/// The faces of a sum, with a tree over them: there may be thousands.
pub(crate) struct SheetOrigins {
    sources: Vec<FlatSource>,
    frame: Frame,
    tree: BoxTree,
}

impl SheetOrigins {
    /// O(n log n).
    pub(crate) fn new(sources: Vec<FlatSource>) -> Self {
        let all = || sources.iter().flat_map(|source| source.corners);
        let low = all().fold([f64::INFINITY; 2], |low, p| [low[0].min(p[0]), low[1].min(p[1])]);
        let high = all().fold([f64::NEG_INFINITY; 2], |high, p| [high[0].max(p[0]), high[1].max(p[1])]);
        let frame = Frame::of(upright(low), upright(high));
        let numbers: Vec<u32> = (0..sources.len() as u32).collect();
        let tree =
            BoxTree::new(&numbers, |i| frame.triangle(sources[i as usize].corners.map(upright).each_ref()));
        Self { sources, frame, tree }
    }

    /// The first face that holds the middle of a triangle and looks its way; for a sliver, whose middle rounding has put outside all of
    /// them, any that looks its way. `None` if there is none.
    pub(crate) fn find(&self, triangle: [[f64; 2]; 3], upward: bool) -> Option<Origin> {
        let [p, q, r] = triangle;
        let middle = [0, 1].map(|k| p[k] / 3.0 + q[k] / 3.0 + r[k] / 3.0);
        let mut best = None;
        // (The frame keeps the order of coordinates, so that the boxes of all that hold the middle hold it there too.)
        self.tree.meeting(&self.frame.triangle([&upright(middle); 3]), |i| {
            let source = &self.sources[i as usize];
            let is_earlier = source.looks_up == upward && best.is_none_or(|best| i < best);
            if is_earlier && contains(&source.corners, middle) {
                best = Some(i);
            }
        });
        let source = match best {
            Some(i) => Some(&self.sources[i as usize]),
            None => self.sources.iter().find(|source| source.looks_up == upward),
        };
        source.map(|source| source.origin)
    }
}

fn upright(p: [f64; 2]) -> [f64; 3] {
    [p[0], p[1], 0.0]
}

fn contains(triangle: &[[f64; 2]; 3], p: [f64; 2]) -> bool {
    let sides = [0, 1, 2].map(|k| orient2d(triangle[k], triangle[(k + 1) % 3], p));
    !(sides.contains(&Sign::Positive) && sides.contains(&Sign::Negative))
}
