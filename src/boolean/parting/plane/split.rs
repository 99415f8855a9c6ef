//! On which side of the plane everything lies.

use std::cmp::Ordering;

use crate::Error;
use crate::exact::{Plane, Sign, orient2d};
use crate::mesh::Mesh;
use crate::parallel::Runner;

/// One of the halves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Half {
    Below,
    Above,
}

impl Half {
    pub(super) const BOTH: [Self; 2] = [Self::Below, Self::Above];

    /// The mark of what is strictly on this side.
    pub(super) fn mark(self) -> u8 {
        match self {
            Self::Below => BELOW,
            Self::Above => ABOVE,
        }
    }
}

/// Marks of vertices; those of a triangle's corners are joined by *or*.
pub(super) const ON: u8 = 0;
pub(super) const BELOW: u8 = 1;
pub(super) const ABOVE: u8 = 2;
const CUT: u8 = BELOW | ABOVE;

/// Vertices or triangles that one thread looks at before the limits are checked: about 100 us of work.
const AT_ONCE: usize = 1 << 15;

/// The mark of each vertex.
enum Marks<'a> {
    /// One by one.
    Each(Vec<u8>),
    /// By how many of several parallel planes each vertex has passed; see [`Split::of_rank`].
    Ranks { ranks: &'a [u32], on: u32, merged_with: u8 },
}

/// A mesh against a plane.
pub(super) struct Split<'a> {
    pub(super) mesh: &'a Mesh,
    pub(super) plane: &'a Plane,
    marks: Marks<'a>,
    /// Triangles with corners strictly on both sides, ascending.
    pub(super) cut: Vec<u32>,
    /// Triangles on one side that have a corner in the plane, and triangles in it, ascending.
    touching: Vec<u32>,
}

impl<'a> Split<'a> {
    /// Looks at all vertices and triangles once.
    pub(super) fn new(mesh: &'a Mesh, plane: &'a Plane, runner: Runner<'_>) -> Result<Self, Error> {
        let mut marks = vec![ON; mesh.positions.len()];
        runner.fill(&mut marks, AT_ONCE, |first, marks| {
            mark(plane, &mesh.positions[first..first + marks.len()], marks);
        })?;
        let of = |triangle: &[u32; 3]| triangle.map(|v| marks[v as usize]);
        let select = |wanted: fn([u8; 3]) -> bool| {
            runner.gather(mesh.triangles.len(), AT_ONCE, 0, |range, found: &mut Vec<u32>| {
                let first = range.start as u32;
                let chosen = (first..).zip(&mesh.triangles[range]).filter(|(_, corners)| wanted(of(corners)));
                found.extend(chosen.map(|(triangle, _)| triangle));
            })
        };
        let cut = select(|[a, b, c]| a | b | c == CUT)?;
        let touching = if marks.contains(&ON) {
            select(|[a, b, c]| a | b | c != CUT && (a == ON || b == ON || c == ON))?
        } else {
            Vec::new()
        };
        Ok(Self { mesh, plane, marks: Marks::Each(marks), cut, touching })
    }

    /// The same for one of several parallel planes: `ranks` are twice the number of planes that each vertex is above, and one more
    /// where it is on the next one. `on` is the rank of what is on this one, which counts as `merged_with`. `met` are the triangles
    /// that meet the plane, ascending.
    pub(super) fn of_rank(
        mesh: &'a Mesh,
        plane: &'a Plane,
        ranks: &'a [u32],
        on: u32,
        merged_with: u8,
        met: &[u32],
    ) -> Self {
        let marks = Marks::Ranks { ranks, on, merged_with };
        let mut split = Self { mesh, plane, marks, cut: Vec::new(), touching: Vec::new() };
        for &triangle in met {
            let [a, b, c] = split.corners(triangle).map(|v| split.mark(v));
            if a | b | c == CUT {
                split.cut.push(triangle);
            } else if a == ON || b == ON || c == ON {
                split.touching.push(triangle);
            }
        }
        split
    }

    /// Whether nothing meets the plane, so that each half is all or nothing.
    pub(super) fn is_apart(&self) -> bool {
        self.cut.is_empty() && self.touching.is_empty()
    }

    #[inline]
    pub(super) fn mark(&self, vertex: u32) -> u8 {
        match &self.marks {
            Marks::Each(marks) => marks[vertex as usize],
            Marks::Ranks { ranks, on, merged_with } => match ranks[vertex as usize].cmp(on) {
                Ordering::Less => BELOW,
                Ordering::Equal => *merged_with,
                Ordering::Greater => ABOVE,
            },
        }
    }

    /// Whether there are triangles on one side that have a corner in the plane, or lie in it.
    pub(super) fn has_touching(&self) -> bool {
        !self.touching.is_empty()
    }

    /// The number of vertices.
    pub(super) fn vertex_count(&self) -> usize {
        self.mesh.positions.len()
    }

    /// How many vertices lie on the plane.
    pub(super) fn count_on(&self) -> u64 {
        (0..self.vertex_count() as u32).filter(|&v| self.mark(v) == ON).count() as u64
    }

    #[inline]
    pub(super) fn corners(&self, triangle: u32) -> [u32; 3] {
        self.mesh.triangles[triangle as usize]
    }

    /// The half that a triangle is in as a whole; `None` if it is cut. What lies in the plane bounds the half that it looks away
    /// from; without area, the one below.
    #[inline]
    pub(super) fn half_of(&self, triangle: u32) -> Option<Half> {
        let corners = self.corners(triangle);
        match corners.map(|v| self.mark(v)).into_iter().fold(ON, |all, mark| all | mark) {
            BELOW => Some(Half::Below),
            ABOVE => Some(Half::Above),
            ON => Some(self.half_of_flat(corners)),
            _ => None,
        }
    }

    fn half_of_flat(&self, corners: [u32; 3]) -> Half {
        let projection = self.plane.projection();
        let [a, b, c] = corners.map(|v| projection.project(&self.mesh.positions[v as usize]));
        if orient2d(a, b, c) == Sign::Negative { Half::Above } else { Half::Below }
    }

    /// The whole triangles of a half that have corners in the plane, ascending.
    pub(super) fn touching(&self, half: Half) -> impl Iterator<Item = u32> {
        self.touching.iter().copied().filter(move |&triangle| self.half_of(triangle) == Some(half))
    }
}

/// Marks vertices.
fn mark(plane: &Plane, positions: &[[f64; 3]], marks: &mut [u8]) {
    if let Some((axis, at)) = plane.as_level() {
        for (mark, position) in marks.iter_mut().zip(positions) {
            *mark = u8::from(position[axis] < at) * BELOW + u8::from(position[axis] > at) * ABOVE;
        }
        return;
    }
    for (mark, position) in marks.iter_mut().zip(positions) {
        *mark = match plane.side(position) {
            Sign::Negative => BELOW,
            Sign::Zero => ON,
            Sign::Positive => ABOVE,
        };
    }
}
