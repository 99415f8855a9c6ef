//! The plane case: contours of a field in a plane z = constant.
//!
//! The plane is divided into squares as space is into cubes, and a square is treated like a face of a cube: one line
//! from crossing to crossing, with a kink where branches meet; squares that are cut more than once at the finest level
//! are divided into triangles over their middle.

use std::sync::Arc;

use glam::DVec3;
use rustc_hash::FxHashMap;
use smallvec::SmallVec;

use super::faces::{Corners, Face, edge_between};
use super::lattice::{DEEPEST, Key, Lattice, directed, key, moved, undirected, unkey};
use super::loops::stretches;
use super::octree::{Judgement, Settings, probe, usual_resolution, value_at};
use super::solve::{crossing, deviation, kink};
use crate::field::expression::{Scratch, Tape};
use crate::field::{Contours, Expression, work};
use crate::{Control, Error};

/// Settings of a contour extraction.
#[derive(Clone, Debug)]
pub struct ContourExtraction {
    low: [f64; 2],
    high: [f64; 2],
    height: f64,
    tolerance: f64,
    resolution: Option<f64>,
    control: Control,
}

/// A square that is not divided further.
struct Square {
    face: Face,
    tape: Option<Arc<Tape>>,
    inside: bool,
}

impl ContourExtraction {
    /// An extraction in the rectangle `low..high` of the plane z = 0, which must contain the region, to within
    /// `tolerance`.
    #[must_use]
    pub fn new(low: [f64; 2], high: [f64; 2], tolerance: f64) -> Self {
        Self { low, high, height: 0.0, tolerance, resolution: None, control: Control::default() }
    }

    /// The plane z = `height` instead of z = 0.
    #[must_use]
    pub fn height(mut self, height: f64) -> Self {
        self.height = height;
        self
    }

    /// Parts of the region at least this wide are found for certain. Default: as of
    /// [`Extraction::resolution`](super::Extraction::resolution).
    #[must_use]
    pub fn resolution(mut self, resolution: f64) -> Self {
        self.resolution = Some(resolution);
        self
    }

    /// Limits and progress.
    #[must_use]
    pub fn control(mut self, control: Control) -> Self {
        self.control = control;
        self
    }

    /// The boundary of where `field` is positive: closed polygons with the inside on their left (outer ones
    /// counter-clockwise, holes clockwise) that neither cross nor touch.
    ///
    /// # Errors
    /// As [`Extraction::run`](super::Extraction::run).
    pub fn run(&self, field: &Expression) -> Result<Contours, Error> {
        let flat = |[x, y]: [f64; 2]| DVec3::new(x, y, self.height);
        let (low, high) = (flat(self.low), flat(self.high));
        if !(low.is_finite() && high.is_finite() && low.x < high.x && low.y < high.y) {
            let what = format!("the rectangle from {:?} to {:?} is empty or not finite", self.low, self.high);
            return Err(Error::InvalidArgument(what));
        }
        if !(self.tolerance > 0.0 && self.tolerance.is_finite()) {
            return Err(Error::InvalidArgument(format!(
                "the tolerance must be positive, not {}",
                self.tolerance
            )));
        }
        let extent = (high - low).max_element();
        let depth = (extent / self.tolerance).log2().ceil().clamp(4.0, f64::from(DEEPEST)) as u32;
        let lattice = Lattice::around(low, high, depth).flattened(self.height);
        let field = field.sign_form();
        let settings = Settings {
            lattice,
            tolerance: self.tolerance,
            resolution: self
                .resolution
                .unwrap_or_else(|| usual_resolution(field.tape(), extent, self.tolerance)),
            control: &self.control,
        };
        let squares = subdivide(field.tape(), &settings)?;
        Lines::new(&squares, &settings)?.contours()
    }
}

fn subdivide(tape: &Arc<Tape>, settings: &Settings<'_>) -> Result<Vec<Square>, Error> {
    let root = Face { corner: [0; 3], axis: 2, size: settings.lattice.count };
    let mut level = vec![(root, Arc::clone(tape))];
    let mut squares = Vec::new();
    while !level.is_empty() {
        let judged = work::pieces(level.len(), 32, settings.control, "subdivide", |range| {
            let mut scratch = Scratch::default();
            range
                .map(|k| judge(level[k].0, &level[k].1, settings, &mut scratch))
                .collect::<Result<Vec<_>, _>>()
        })?;
        let mut next = Vec::new();
        for (&(face, _), judgement) in level.iter().zip(judged.into_iter().flatten()) {
            match judgement {
                Judgement::Empty { inside } => squares.push(Square { face, tape: None, inside }),
                Judgement::Keep(tape) => squares.push(Square { face, tape: Some(tape), inside: false }),
                Judgement::Divide(tape) => {
                    let half = face.size / 2;
                    for (dx, dy) in [(0, 0), (half, 0), (0, half), (half, half)] {
                        let corner = moved(moved(face.corner, 0, dx), 1, dy);
                        next.push((Face { corner, size: half, ..face }, Arc::clone(&tape)));
                    }
                }
            }
        }
        level = next;
    }
    Ok(squares)
}

fn points_of(face: Face) -> [[u32; 3]; 4] {
    let far = moved(face.corner, 0, face.size);
    [face.corner, far, moved(far, 1, face.size), moved(face.corner, 1, face.size)]
}

fn judge(
    face: Face,
    tape: &Arc<Tape>,
    settings: &Settings<'_>,
    scratch: &mut Scratch,
) -> Result<Judgement, Error> {
    let lattice = &settings.lattice;
    let points = points_of(face).map(|point| lattice.place(point));
    let (low, high) = (points[0], points[2]);
    let probed = match probe(tape, low, high, scratch)? {
        Ok(probed) => probed,
        Err(judgement) => return Ok(judgement),
    };
    let tape = probed.tape;
    if face.size > lattice.count / 8 {
        return Ok(Judgement::Divide(tape));
    }
    let mut values = [0.0; 4];
    for (value, &point) in values.iter_mut().zip(&points) {
        *value = value_at(&tape, point, scratch)?;
    }
    let size = f64::from(face.size) * lattice.step();
    let positive = values[0] > 0.0;
    let keep = if face.size == 1 {
        true
    } else if values.iter().all(|&value| (value > 0.0) == positive) {
        let trusted = size <= settings.resolution * if probed.certain { 0.25 } else { 1.0 };
        let outside = if positive { -probed.bounds.low } else { probed.bounds.high };
        let intrusion = outside / probed.slope;
        (probed.certain && intrusion <= 0.5 * settings.tolerance)
            || (trusted && (probed.middle > 0.0) == positive)
    } else {
        let stretches = stretches(&values.map(|value| value > 0.0));
        let crease_may_hide = size > settings.resolution && tape.branchings() > 0;
        match stretches[..] {
            [(enter, exit)] if (probed.certain && !crease_may_hide) || size <= settings.resolution => {
                let end = |k: usize, scratch: &mut Scratch| {
                    let (from, to) = (k, (k + 1) % 4);
                    crossing(&tape, points[from], points[to], [values[from], values[to]], 8, scratch)
                };
                let ends = [end(enter, scratch), end(exit, scratch)];
                let bend = kink(&tape, ends, (low, high), 2, settings.tolerance, scratch);
                follows(&tape, ends, bend, settings.tolerance, scratch)
            }
            _ => false,
        }
    };
    Ok(if keep { Judgement::Keep(tape) } else { Judgement::Divide(tape) })
}

/// Whether the line from end to end, perhaps over a kink, stays within the tolerance of the field's zero.
fn follows(
    tape: &Tape,
    ends: [DVec3; 2],
    bend: Option<DVec3>,
    tolerance: f64,
    scratch: &mut Scratch,
) -> bool {
    let mut line = vec![ends[0]];
    line.extend(bend);
    line.push(ends[1]);
    line.windows(2).all(|pair| {
        [0.25, 0.5, 0.75].iter().all(|&at| deviation(tape, pair[0].lerp(pair[1], at), scratch) <= tolerance)
    })
}

/// The lines of all squares.
struct Lines<'a> {
    settings: &'a Settings<'a>,
    corners: Corners,
    squares: Vec<(&'a Square, &'a Tape)>,
    values: FxHashMap<Key, f64>,
}

/// One end of a line: the crossing of a lattice edge, or of a spoke from a square's middle to a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum End {
    Edge(u64),
    Spoke(Key, Key),
}

impl<'a> Lines<'a> {
    fn new(squares: &'a [Square], settings: &'a Settings<'a>) -> Result<Self, Error> {
        let corners = Corners::of_points(squares.iter().flat_map(|square| points_of(square.face)));
        let mut scratch = Scratch::default();
        let mut values = FxHashMap::default();
        let lattice = &settings.lattice;
        let boundary = |point: [u32; 3]| point[..2].iter().any(|&x| x == 0 || x == lattice.count);
        for square in squares {
            let points = points_of(square.face);
            match &square.tape {
                None if square.inside && points.into_iter().any(boundary) => {
                    return Err(super::tables::unbounded(lattice.place(points[0]).to_array()));
                }
                None => {}
                Some(tape) => {
                    for point in corners.outline(square.face) {
                        if let std::collections::hash_map::Entry::Vacant(entry) = values.entry(point) {
                            let place = lattice.place(unkey(point));
                            let value = *entry.insert(value_at(tape, place, &mut scratch)?);
                            if value > 0.0 && boundary(unkey(point)) {
                                return Err(super::tables::unbounded(place.to_array()));
                            }
                        }
                    }
                }
            }
            settings.control.check()?;
        }
        let squares = squares.iter().filter_map(|square| Some((square, square.tape.as_deref()?))).collect();
        Ok(Self { settings, corners, squares, values })
    }

    fn is_inside(&self, point: Key) -> bool {
        self.values.get(&point).is_some_and(|&value| value > 0.0)
    }

    fn contours(&self) -> Result<Contours, Error> {
        let mut drawing = Drawing::default();
        for &(square, tape) in &self.squares {
            let outline = self.corners.outline(square.face);
            let inside: SmallVec<[bool; 8]> = outline.iter().map(|&point| self.is_inside(point)).collect();
            self.cross_edges(&outline, &inside, tape, &mut drawing);
            match stretches(&inside)[..] {
                [] => {}
                [(enter, exit)] => {
                    let ends = [end_on_edge(&outline, enter), end_on_edge(&outline, exit)];
                    self.join_with_kink(square.face, tape, ends, &mut drawing);
                }
                // Several lines may run either way: over the square's middle only one way is left.
                _ => self.join_over_middle(square.face, tape, &outline, &mut drawing)?,
            }
        }
        Ok(drawing.chained())
    }

    /// Finds the crossings of the outline's edges that begin inside and end outside, or the other way.
    fn cross_edges(&self, outline: &[Key], inside: &[bool], tape: &Tape, drawing: &mut Drawing) {
        let lattice = &self.settings.lattice;
        for k in 0..outline.len() {
            let after = (k + 1) % outline.len();
            let End::Edge(name) = end_on_edge(outline, k) else { continue };
            if inside[k] != inside[after] {
                // Always from the edge's lower point, so that both squares agree.
                let (low, _) = undirected(name);
                let high = if low == outline[k] { outline[after] } else { outline[k] };
                let values = [low, high].map(|point| self.value(point));
                let ends = [low, high].map(|point| lattice.place(unkey(point)));
                let Drawing { places, scratch, .. } = drawing;
                places
                    .entry(End::Edge(name))
                    .or_insert_with(|| crossing(tape, ends[0], ends[1], values, 60, scratch));
            }
        }
    }

    /// The one line of a square, with a kink where two branches meet.
    fn join_with_kink(&self, face: Face, tape: &Tape, [from, to]: [End; 2], drawing: &mut Drawing) {
        let lattice = &self.settings.lattice;
        let points = points_of(face).map(|point| lattice.place(point));
        let ends = [drawing.places[&from], drawing.places[&to]];
        let span = (points[0], points[2]);
        let bend = kink(tape, ends, span, 2, self.settings.tolerance, &mut drawing.scratch);
        drawing.join(from, to, bend);
    }

    /// The lines of a square that has several: of the triangles between its middle and its edges.
    fn join_over_middle(
        &self,
        face: Face,
        tape: &Tape,
        outline: &[Key],
        drawing: &mut Drawing,
    ) -> Result<(), Error> {
        let lattice = &self.settings.lattice;
        let points = points_of(face).map(|point| lattice.place(point));
        let middle = (points[0] + points[2]) * 0.5;
        let value = value_at(tape, middle, &mut drawing.scratch)?;
        let name = key(face.corner);
        for (k, &start) in outline.iter().enumerate() {
            let next = outline[(k + 1) % outline.len()];
            let end = |number: usize| match number {
                0 => end_on_edge(outline, k),
                1 => End::Spoke(name, next),
                _ => End::Spoke(name, start),
            };
            for point in [start, next] {
                let ends = [value, self.value(point)];
                if (ends[0] > 0.0) != (ends[1] > 0.0) {
                    let place = lattice.place(unkey(point));
                    let Drawing { places, scratch, .. } = drawing;
                    places
                        .entry(End::Spoke(name, point))
                        .or_insert_with(|| crossing(tape, middle, place, ends, 60, scratch));
                }
            }
            let signs = [self.is_inside(start), self.is_inside(next), value > 0.0];
            for (enter, exit) in stretches(&signs) {
                drawing.join(end(enter), end(exit), None);
            }
        }
        Ok(())
    }

    /// The field at a point of the lattice that was looked at.
    fn value(&self, point: Key) -> f64 {
        self.values.get(&point).copied().unwrap_or(0.0)
    }
}

/// The crossing of edge `k` of an outline.
fn end_on_edge(outline: &[Key], k: usize) -> End {
    let (point, axis) = edge_between(outline[k], outline[(k + 1) % outline.len()]);
    End::Edge(directed(point, axis))
}

/// The lines found so far.
#[derive(Default)]
struct Drawing {
    places: FxHashMap<End, DVec3>,
    /// From the end of a line to its start, since lines have the inside on their right.
    before: FxHashMap<End, (End, Option<DVec3>)>,
    starts: Vec<End>,
    scratch: Scratch,
}

impl Drawing {
    fn join(&mut self, from: End, to: End, bend: Option<DVec3>) {
        self.before.insert(to, (from, bend));
        self.starts.push(to);
    }

    /// The lines end to end.
    fn chained(&self) -> Contours {
        let mut used = rustc_hash::FxHashSet::default();
        let mut contours = Contours::default();
        for &start in &self.starts {
            let mut points = Vec::new();
            let mut at = start;
            while used.insert(at) {
                let Some(&(previous, bend)) = self.before.get(&at) else { break };
                points.extend(self.places.get(&at).map(|place| [place.x, place.y]));
                points.extend(bend.map(|place| [place.x, place.y]));
                at = previous;
            }
            if points.len() > 2 {
                contours.loops.push(points);
            }
        }
        contours
    }
}
