//! The cells into which surfaces, open ones too, part space: what stands in the place of labels where winding numbers do not
//! exist.
//!
//! A *sector* is what lies on one side of a piece of a face's border, or in one quadrant round a piece of a segment. At first
//! each is by itself; those that nothing parts are joined:
//!
//! - round an edge, what is after a face and before the next one in radial order;
//! - where an edge pierces a face, the sectors of the edge before and after and the quadrants of the segment that ends there;
//! - where three faces meet, each octant is seen from three segments;
//! - round a corner of a face, from side to side, past the segments that begin there;
//! - and what touches nothing around it is found in faces and in space (`cell_neighbours`).
//!
//! Any choice of cells has a closed boundary (the argument in `general` asks nothing of labels). So an error in the last step,
//! which computes with rounded numbers, may misjudge a cell, but never opens a result.

use super::cell_neighbours;
use super::crossings::Crossings;
use super::edges::{Edges, Side};
use super::lines::Lines;
use super::pairs::FaceBoxes;
use super::segment_labels::{Quadrants, SegmentLabels};
use super::surfaces::Surfaces;
use super::walk::FaceLabels;
use crate::Error;
use crate::boolean::complex::ids::{FaceId, LabelId, PointId, SegmentId};
use crate::boolean::complex::predicates::Predicates;
use crate::mesh::{Bounds, UnionFind};
use crate::parallel::Runner;

/// What cells are made of.
#[derive(Clone, Copy)]
pub(crate) struct Ground<'a> {
    pub(crate) surfaces: &'a Surfaces,
    pub(crate) edges: &'a Edges,
    pub(crate) crossings: &'a Crossings,
    pub(crate) lines: &'a Lines,
}

/// How many cells there are. The one around everything is the first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct CellCount(pub(crate) usize);

/// The cells beside all pieces, by number.
pub(crate) struct Cells {
    pub(crate) faces: FaceLabels,
    pub(crate) segments: SegmentLabels,
    pub(crate) count: CellCount,
}

impl Cells {
    /// Finds them.
    ///
    /// # Errors
    /// Only limits.
    pub(crate) fn new(
        ground: &Ground<'_>,
        bounds: &Bounds,
        boxes: &FaceBoxes,
        runner: Runner<'_>,
    ) -> Result<Self, Error> {
        let mut sectors = Sectors::new(ground);
        runner.control.check()?;
        sectors.join_round_edges();
        sectors.join_at_nodes();
        sectors.join_at_triples();
        sectors.join_round_corners();
        runner.control.check()?;
        let joins = cell_neighbours::find(&sectors.all(), bounds, boxes, runner)?;
        joins.into_iter().for_each(|[x, y]| sectors.sets.join(x, y));
        let Sectors { mut sets, mut faces, mut segments, .. } = sectors;
        let (count, cells) = sets.labels();
        let to_cell = |sector: &mut LabelId| *sector = LabelId::new(cells[sector.index()]);
        for face in ground.surfaces.faces().filter(|&face| ground.crossings.of_face(face).is_empty()) {
            let outer = &mut faces.of_face[face.index()];
            *outer = cells[*outer as usize];
            to_cell(&mut faces.inner[face.index()]);
        }
        faces.of_pieces.iter_mut().chain(&mut faces.inner_of_pieces).for_each(to_cell);
        for around in &mut segments.pieces {
            let Quadrants { outside, inside_first, inside_second, inside } = around;
            [outside, inside_first, inside_second, inside].into_iter().for_each(to_cell);
        }
        Ok(Self { faces, segments, count: CellCount(count) })
    }
}

/// What lies beside every piece: sectors, or the cells that they are in.
#[derive(Clone, Copy)]
pub(crate) struct Beside<'a> {
    pub(crate) ground: Ground<'a>,
    pub(crate) faces: &'a FaceLabels,
    pub(crate) segments: &'a SegmentLabels,
}

impl Beside<'_> {
    /// What is outside and inside a face along a piece of its side, counted from the low end of the edge.
    pub(crate) fn side(&self, face: FaceId, k: usize, piece: usize) -> [u32; 2] {
        if self.ground.crossings.of_face(face).is_empty() {
            return self.faces.of_face(face).map(LabelId::number);
        }
        let nodes = self.ground.lines.on_edge(self.ground.edges.edge(face, k)).len();
        self.faces.of_side(face, k, nodes).map(|sectors| sectors[piece].number())
    }

    /// What is in a quadrant round a piece of a segment, counted from its tail: inside its first face or not, inside its second
    /// or not.
    pub(crate) fn quadrant(&self, segment: SegmentId, piece: usize, inside: [bool; 2]) -> u32 {
        let all = &self.segments.pieces[self.segments.starts[segment.index()] as usize + piece];
        let sector = match inside {
            [false, false] => all.outside,
            [true, false] => all.inside_first,
            [false, true] => all.inside_second,
            [true, true] => all.inside,
        };
        sector.number()
    }
}

/// All sectors, numbered; in the tables their numbers stand where labels do.
struct Sectors<'a> {
    ground: &'a Ground<'a>,
    sets: UnionFind,
    faces: FaceLabels,
    segments: SegmentLabels,
}

/// The sector of what is around everything.
pub(super) const AROUND: u32 = 0;

impl<'a> Sectors<'a> {
    fn new(ground: &'a Ground<'a>) -> Self {
        let Ground { surfaces, edges, crossings, lines } = *ground;
        let count = surfaces.face_count() as usize;
        let mut next = AROUND;
        let mut new = || {
            next += 1;
            LabelId::new(next)
        };
        let (of_face, inner) = (vec![u32::MAX; count], vec![LabelId::NONE; count]);
        let mut faces = FaceLabels { of_face, inner, ..FaceLabels::none() };
        for face in surfaces.faces() {
            if crossings.of_face(face).is_empty() {
                faces.of_face[face.index()] = new().number();
                faces.inner[face.index()] = new();
                continue;
            }
            faces.of_face[face.index()] = faces.starts.len() as u32;
            faces.starts.push([0, 1, 2].map(|k| {
                let start = faces.of_pieces.len() as u32;
                for _ in 0..=lines.on_edge(edges.edge(face, k)).len() {
                    faces.of_pieces.push(new());
                    faces.inner_of_pieces.push(new());
                }
                start
            }));
        }
        let mut segments = SegmentLabels::none();
        for (id, _) in crossings.iter() {
            segments.starts.push(segments.pieces.len() as u32);
            for _ in 0..=lines.on_segment(id).len() {
                segments.pieces.push(Quadrants {
                    outside: new(),
                    inside_first: new(),
                    inside_second: new(),
                    inside: new(),
                });
            }
        }
        Self { ground, sets: UnionFind::new(next as usize + 1), faces, segments }
    }

    fn all(&self) -> Beside<'_> {
        Beside { ground: *self.ground, faces: &self.faces, segments: &self.segments }
    }

    fn beside(&self, face: FaceId, k: usize, piece: usize) -> [u32; 2] {
        self.all().side(face, k, piece)
    }

    fn quadrant(&self, segment: SegmentId, piece: usize, inside: [bool; 2]) -> u32 {
        self.all().quadrant(segment, piece, inside)
    }

    /// What is round an edge between two faces that follow on each other.
    fn join_round_edges(&mut self) {
        let Ground { surfaces, edges, lines, .. } = *self.ground;
        for (edge, _) in edges.iter() {
            let sides = edges.sides(edge);
            for piece in 0..=lines.on_edge(edge).len() {
                for (i, side) in sides.iter().enumerate() {
                    let next = sides[(i + 1) % sides.len()];
                    let around = |side: Side| {
                        let [outer, inner] = self.beside(side.face(), side.place(), piece);
                        // After a face that runs as the edge does is its outer side.
                        let (_, is_forward) = edges.of_side(surfaces, side.face(), side.place());
                        if is_forward { [inner, outer] } else { [outer, inner] }
                    };
                    let ([_, after], [before, _]) = (around(*side), around(next));
                    self.sets.join(after, before);
                }
            }
        }
    }

    /// Where an edge of a face pierces another: along the edge before and after, and round the segment that ends there.
    fn join_at_nodes(&mut self) {
        let Ground { edges, crossings, lines, .. } = *self.ground;
        for (id, segment) in crossings.iter() {
            let last = lines.on_segment(id).len();
            for (end, piece) in [(segment.tail, 0), (segment.head, last)] {
                let Some(node_id) = crossings.node_of(end) else { continue };
                let node = crossings.node(node_id);
                // The face whose edge it is; the other one is pierced.
                let owner = usize::from(segment.faces[0] == node.face);
                let face = segment.faces[owner];
                let Some(k) = (0..3).find(|&k| edges.edge(face, k) == node.edge) else { continue };
                let place = lines.place(node_id) as usize;
                for (piece_of_edge, inside_pierced) in [(place, node.leaves), (place + 1, !node.leaves)] {
                    let beside = self.beside(face, k, piece_of_edge);
                    for (sector, inside_face) in beside.into_iter().zip([false, true]) {
                        let mut inside = [inside_pierced; 2];
                        inside[owner] = inside_face;
                        let quadrant = self.quadrant(id, piece, inside);
                        self.sets.join(sector, quadrant);
                    }
                }
            }
        }
    }

    /// Each octant where three faces meet.
    fn join_at_triples(&mut self) {
        let Ground { crossings, lines, .. } = *self.ground;
        // The place of each three-face point on its three segments.
        let mut places = vec![[0usize; 3]; lines.triples.len()];
        for (id, _) in crossings.iter() {
            for (place, &triple) in lines.on_segment(id).iter().enumerate() {
                let of = lines.triple(triple).segments.iter().position(|&segment| segment == id);
                places[triple.index()][of.unwrap_or_default()] = place;
            }
        }
        /// The faces of the segments of a three-face point, by their places in it, and the one that is left.
        const FACES: [[usize; 3]; 3] = [[0, 1, 2], [0, 2, 1], [1, 2, 0]];
        for (triple, places) in lines.triples.iter().zip(&places) {
            for octant in 0..8 {
                let inside = [0, 1, 2].map(|i| octant >> i & 1 == 1);
                let seen = [0, 1, 2].map(|s| {
                    let [f, g, third] = FACES[s];
                    let piece = places[s] + usize::from(inside[third] == triple.head_inside[s]);
                    self.quadrant(triple.segments[s], piece, [inside[f], inside[g]])
                });
                self.sets.join(seen[0], seen[1]);
                self.sets.join(seen[0], seen[2]);
            }
        }
    }

    /// Round the corners of faces.
    fn join_round_corners(&mut self) {
        let Ground { surfaces, crossings, .. } = *self.ground;
        let predicates = Predicates::new(surfaces);
        for face in surfaces.faces().filter(|&face| !crossings.of_face(face).is_empty()) {
            for k in 0..3 {
                self.join_round_corner(&predicates, face, k);
            }
        }
    }

    /// From the start of side k of a face, counter-clockwise, to the end of the side before it.
    fn join_round_corner(&mut self, predicates: &Predicates<'_>, face: FaceId, k: usize) {
        let Ground { surfaces, edges, crossings, lines } = *self.ground;
        let corner = surfaces.vertices(face)[k];
        let at_end = |k: usize, is_start: bool| {
            let (edge, is_forward) = edges.of_side(surfaces, face, k);
            if is_start == is_forward { 0 } else { lines.on_edge(edge).len() }
        };
        // 1. The segments that begin here, each with the piece that does, whether the inner side of its partner is to the left of
        //    it, seen from the corner, and where it ends.
        let mut rays: Vec<Ray> = Vec::new();
        for &id in crossings.of_face(face) {
            let segment = crossings.segment(id);
            let begins = |point: PointId| point.number() == corner.number();
            let from_tail = begins(segment.tail);
            if !from_tail && !begins(segment.head) {
                continue;
            }
            let (piece, end) =
                if from_tail { (0, segment.head) } else { (lines.on_segment(id).len(), segment.tail) };
            let is_first = segment.faces[0] == face;
            let partner = segment.partner(face);
            rays.push(Ray { id, piece, is_first, partner, inside_left: from_tail == is_first, end });
        }
        // 2. By angle: a ray comes before another if it ends on the side of the other's partner that the first side lies on.
        rays.sort_by(|x, y| {
            let inside = crossings.is_inside(surfaces, edges, predicates, x.end, y.partner);
            if x.id == y.id {
                std::cmp::Ordering::Equal
            } else if inside == y.inside_left {
                std::cmp::Ordering::Greater
            } else {
                std::cmp::Ordering::Less
            }
        });
        // 3. From one to the next.
        let mut last = self.beside(face, k, at_end(k, true));
        for ray in &rays {
            for (inside_face, last) in [false, true].into_iter().zip(&mut last) {
                let quadrant = |is_left: bool| {
                    let inside_partner = is_left == ray.inside_left;
                    let inside = [inside_face, inside_partner];
                    let inside = if ray.is_first { inside } else { [inside[1], inside[0]] };
                    self.quadrant(ray.id, ray.piece, inside)
                };
                let (right, left) = (quadrant(false), quadrant(true));
                self.sets.join(*last, right);
                *last = left;
            }
        }
        let before = (k + 2) % 3;
        let end = self.beside(face, before, at_end(before, false));
        (0..2).for_each(|i| self.sets.join(last[i], end[i]));
    }
}

/// A segment that begins at a corner of a face.
struct Ray {
    id: SegmentId,
    piece: usize,
    is_first: bool,
    partner: FaceId,
    inside_left: bool,
    end: PointId,
}
