//! What the cells share: signs at lattice points, crossings of lattice edges, lines on faces.

use glam::DVec3;
use rustc_hash::FxHashMap;
use smallvec::SmallVec;

use super::boundaries::{Boundaries, CellFace};
use super::faces::{Corners, Face, edge_between};
use super::lattice::{Key, Lattice, directed, moved, undirected, unkey};
use super::loops::{LoopLink, chain, stretches};
use super::octree::{Leaf, value_at};
use super::solve::{crossing, kink};
use crate::field::expression::{Scratch, Tape};
use crate::field::work;
use crate::{Control, Error};

/// The cells that the surface may meet, and everything about their boundaries that is known before fillings are made.
pub(super) struct Tables<'a> {
    pub(super) lattice: Lattice,
    pub(super) tolerance: f64,
    pub(super) corners: &'a Corners,
    /// Leaves that are not certainly empty.
    pub(super) cells: Vec<&'a Leaf>,
    pub(super) boundaries: Boundaries,
    /// Cells that are divided into tetrahedra, by position in `cells`.
    pub(super) divided: Vec<bool>,
    /// Cut faces that only one of the cells has.
    pub(super) one_sided: Vec<Face>,
    /// The field at corners of cells, of earlier rounds too.
    values: &'a mut FxHashMap<Key, f64>,
    /// Numbers of the crossed edges' vertices.
    edges: FxHashMap<u64, u32>,
    faces: FxHashMap<u64, FaceLine>,
    /// Places of all vertices on edges and faces.
    pub(super) places: Vec<DVec3>,
}

/// How the surface cuts a face.
#[derive(Clone, Debug)]
pub(super) enum FaceLine {
    /// In one line from crossing to crossing, perhaps over a kink.
    Plain { kink: Option<u32> },
    /// By the triangles from the face's middle to its outline: whether the middle is inside, and the vertex between
    /// the middle and each point of the outline where the surface passes between them.
    Fanned { inside: bool, spokes: Vec<(Key, u32)> },
}

/// What a cell reports of its boundary.
#[derive(Default)]
struct Boundary {
    edges: Vec<u64>,
    /// Faces with a line, and whether the cell is to be divided.
    faces: Vec<(Face, bool)>,
    divided: bool,
}

/// Crossed edges, each with its first cell, and crossed faces.
type Crossed = (Vec<(u64, u32)>, Vec<SharedFace>);

/// A face met by several cells: the first of them is the one whose tape is used.
struct SharedFace {
    face: Face,
    cell: usize,
    fanned: bool,
}

impl<'a> Tables<'a> {
    /// Tables of the given cells. `corners` are those of all leaves, `values` the field at them as far as it is known:
    /// at all points of the cells, or perhaps not.
    pub(super) fn new(
        cells: Vec<&'a Leaf>,
        corners: &'a Corners,
        values: &'a mut FxHashMap<Key, f64>,
        known: bool,
        lattice: Lattice,
        tolerance: f64,
        control: &Control,
    ) -> Result<Self, Error> {
        let mut tables = Self {
            lattice,
            tolerance,
            corners,
            divided: vec![false; cells.len()],
            one_sided: Vec::new(),
            boundaries: Boundaries::default(),
            cells,
            values,
            edges: FxHashMap::default(),
            faces: FxHashMap::default(),
            places: Vec::new(),
        };
        tables.boundaries = Boundaries::new(&tables.cells, corners, control)?;
        let _account = control.reserve(tables.boundaries.memory())?;
        if !known {
            tables.find_values(control)?;
        }
        tables.boundaries.find_signs(tables.values, control)?;
        let (edges, faces) = tables.find_crossed(control)?;
        tables.place_edges(&edges, control)?;
        tables.place_lines(&faces, control)?;
        Ok(tables)
    }

    pub(super) fn tape(&self, cell: usize) -> Result<&Tape, Error> {
        // Cells are those leaves that have a tape.
        self.cells[cell].tape.as_deref().ok_or_else(|| Error::Field("an empty cell has no field".into()))
    }

    pub(super) fn is_inside(&self, point: Key) -> bool {
        self.values.get(&point).is_some_and(|&value| value > 0.0)
    }

    pub(super) fn value(&self, point: Key) -> f64 {
        self.values.get(&point).copied().unwrap_or(f64::NAN)
    }

    /// The vertex on the lattice edge between two points of an outline.
    pub(super) fn on_edge(&self, a: Key, b: Key) -> u32 {
        let (point, axis) = edge_between(a, b);
        self.edges.get(&directed(point, axis)).copied().unwrap_or(0)
    }

    pub(super) fn line(&self, face: Face) -> Option<&FaceLine> {
        self.faces.get(&directed(super::lattice::key(face.corner), face.axis))
    }

    /// Evaluates the field at every point of the cells' boundaries.
    fn find_values(&mut self, control: &Control) -> Result<(), Error> {
        let pieces = work::pieces(self.cells.len(), 64, control, "points", |range| {
            let mut points: Vec<(Key, u32)> = Vec::new();
            for cell in range {
                for side in self.boundaries.of(cell) {
                    let unknown = side.points.iter().filter(|&point| !self.values.contains_key(point));
                    points.extend(unknown.map(|&point| (point, cell as u32)));
                }
            }
            Ok(first_of_each(points, |point| point.0))
        })?;
        let points = first_of_each(pieces.concat(), |point| point.0);
        let _account = control.reserve(points.len() as u64 * 40)?;
        let values = work::pieces(points.len(), 256, control, "signs", |range| {
            let mut scratch = Scratch::default();
            let value = |&(point, cell): &(Key, u32)| {
                value_at(self.tape(cell as usize)?, self.lattice.place(unkey(point)), &mut scratch)
            };
            points[range].iter().map(value).collect::<Result<Vec<f64>, Error>>()
        })?;
        for (&(point, _), value) in points.iter().zip(values.into_iter().flatten()) {
            if value > 0.0 && self.lattice.on_boundary(unkey(point)) {
                let [x, y, z] = self.lattice.place(unkey(point)).to_array();
                return Err(unbounded([x, y, z]));
            }
            self.values.insert(point, value);
        }
        Ok(())
    }

    /// Finds crossed edges and faces, each with the first cell that has it, and the cells to divide.
    fn find_crossed(&mut self, control: &Control) -> Result<Crossed, Error> {
        let boundaries = work::pieces(self.cells.len(), 64, control, "crossings", |range| {
            Ok(range.map(|cell| self.crossed(cell)).collect::<Vec<Boundary>>())
        })?;
        let mut edges = Vec::new();
        let mut faces = Vec::new();
        for (cell, boundary) in boundaries.into_iter().flatten().enumerate() {
            self.divided[cell] = boundary.divided;
            edges.extend(boundary.edges.into_iter().map(|edge| (edge, cell as u32)));
            faces.extend(boundary.faces.into_iter().map(|(face, fanned)| SharedFace { face, cell, fanned }));
        }
        let edges = first_of_each(edges, |edge| edge.0);
        let name = |shared: &SharedFace| directed(super::lattice::key(shared.face.corner), shared.face.axis);
        faces.sort_by_key(|shared| (name(shared), shared.cell));
        let same = |a: &SharedFace, b: &SharedFace| name(a) == name(b);
        let alone = faces.chunk_by(same).filter(|run| run.len() == 1).map(|run| run[0].face);
        self.one_sided = alone.collect();
        faces.dedup_by(|later, first| {
            let same = name(later) == name(first);
            first.fanned |= same && later.fanned;
            same
        });
        Ok((edges, faces))
    }

    fn crossed(&self, cell: usize) -> Boundary {
        let mut found = Boundary::default();
        let mut segments = Vec::new();
        let mut names: Vec<u64> = Vec::new();
        let mut number = |a: Key, b: Key| {
            let (point, axis) = edge_between(a, b);
            let name = directed(point, axis);
            let known = names.iter().position(|&other| other == name);
            known.unwrap_or_else(|| {
                names.push(name);
                names.len() - 1
            }) as u32
        };
        for CellFace { face, points: outline, inside } in self.boundaries.of(cell) {
            let stretches = stretches(inside);
            if stretches.is_empty() {
                continue;
            }
            found.divided |= stretches.len() > 1;
            found.faces.push((face, false));
            let next = |k: usize| outline[(k + 1) % outline.len()];
            for (enter, exit) in stretches {
                let from = number(outline[enter], next(enter));
                let to = number(outline[exit], next(exit));
                segments.push(LoopLink { from, to, kink: None });
            }
        }
        found.divided |= chain(&segments).len() > 1;
        for face in &mut found.faces {
            face.1 = found.divided;
        }
        found.edges = names;
        found
    }

    fn place_edges(&mut self, edges: &[(u64, u32)], control: &Control) -> Result<(), Error> {
        let _account = control.reserve(edges.len() as u64 * 56)?;
        let places = work::pieces(edges.len(), 128, control, "edges", |range| {
            let mut scratch = Scratch::default();
            let place = |&(edge, cell): &(u64, u32)| {
                let (point, axis) = undirected(edge);
                let end = self.edge_end(unkey(point), axis, cell as usize);
                let [from, to] = [unkey(point), end].map(|point| self.lattice.place(point));
                let values = [self.value(point), self.value(super::lattice::key(end))];
                Ok(crossing(self.tape(cell as usize)?, from, to, values, 60, &mut scratch))
            };
            edges[range].iter().map(place).collect::<Result<Vec<DVec3>, Error>>()
        })?;
        self.places = places.concat();
        self.edges = edges.iter().enumerate().map(|(number, &(edge, _))| (edge, number as u32)).collect();
        Ok(())
    }

    /// The next point after `start` along `axis` on an edge of a cell.
    fn edge_end(&self, start: [u32; 3], axis: usize, cell: usize) -> [u32; 3] {
        let size = self.cells[cell].cube.size;
        // Undivided edges have a power of two for a length; the shortest whose end is a point is the one.
        let mut length = 1;
        while length < size && !self.values.contains_key(&super::lattice::key(moved(start, axis, length))) {
            length *= 2;
        }
        moved(start, axis, length)
    }

    fn place_lines(&mut self, faces: &[SharedFace], control: &Control) -> Result<(), Error> {
        let lines = work::pieces(faces.len(), 64, control, "faces", |range| {
            let mut scratch = Scratch::default();
            faces[range]
                .iter()
                .map(|face| self.line_of(face, &mut scratch))
                .collect::<Result<Vec<_>, Error>>()
        })?;
        let mut table = FxHashMap::default();
        for (shared, line) in faces.iter().zip(lines.into_iter().flatten()) {
            let mut add = |place: DVec3| {
                self.places.push(place);
                (self.places.len() - 1) as u32
            };
            let line = match line {
                Line::Plain(kink) => FaceLine::Plain { kink: kink.map(&mut add) },
                Line::Fanned(inside, spokes) => FaceLine::Fanned {
                    inside,
                    spokes: spokes.into_iter().map(|(point, place)| (point, add(place))).collect(),
                },
            };
            table.insert(directed(super::lattice::key(shared.face.corner), shared.face.axis), line);
        }
        self.faces = table;
        Ok(())
    }

    fn line_of(&self, shared: &SharedFace, scratch: &mut Scratch) -> Result<Line, Error> {
        let tape = self.tape(shared.cell)?;
        let outline = self.corners.outline(shared.face);
        let (low, high) = self.span(shared.face);
        if shared.fanned {
            let middle = (low + high) * 0.5;
            let value = value_at(tape, middle, scratch)?;
            let spokes = outline
                .iter()
                .filter(|&&point| self.is_inside(point) != (value > 0.0))
                .map(|&point| {
                    let values = [value, self.value(point)];
                    (point, crossing(tape, middle, self.lattice.place(unkey(point)), values, 60, scratch))
                })
                .collect();
            return Ok(Line::Fanned(value > 0.0, spokes));
        }
        let inside: SmallVec<[bool; 8]> = outline.iter().map(|&point| self.is_inside(point)).collect();
        let Some(&(enter, exit)) = stretches(&inside).first() else { return Ok(Line::Plain(None)) };
        let end = |k: usize| self.places[self.on_edge(outline[k], outline[(k + 1) % outline.len()]) as usize];
        let ends = [end(enter), end(exit)];
        Ok(Line::Plain(kink(tape, ends, (low, high), shared.face.axis, self.tolerance, scratch)))
    }

    /// The lowest and the highest corner of a face.
    pub(super) fn span(&self, face: Face) -> (DVec3, DVec3) {
        let (u, v) = face.directions();
        let far = moved(moved(face.corner, u, face.size), v, face.size);
        (self.lattice.place(face.corner), self.lattice.place(far))
    }
}

/// A [`FaceLine`] whose vertices have no numbers yet.
enum Line {
    Plain(Option<DVec3>),
    Fanned(bool, Vec<(Key, DVec3)>),
}

/// Sorted by name, and for equal names only the least entry.
fn first_of_each<T: Ord + Copy, N: PartialEq>(mut entries: Vec<T>, name: impl Fn(&T) -> N) -> Vec<T> {
    entries.sort_unstable();
    entries.dedup_by(|later, first| name(later) == name(first));
    entries
}

pub(super) fn unbounded([x, y, z]: [f64; 3]) -> Error {
    Error::Field(format!(
        "the solid does not end inside the box: it reaches ({x:.6}, {y:.6}, {z:.6}) on its boundary; give larger \
         bounds, or clip the solid to the box"
    ))
}
