//! Where to look: cubes divided until each is certainly empty, or holds a piece of surface that one filling follows
//! to within the tolerance.

use std::sync::Arc;

use glam::DVec3;
use rustc_hash::FxHashSet;
use smallvec::SmallVec;

use super::faces::Face;
use super::filling::{Cell, Corner};
use super::lattice::{Cube, Key, Lattice, unkey};
use super::loops::{LoopLink, chain, stretches};
use super::solve::{crossing, deviation, kink, sample};
use crate::field::expression::{Choice, Scratch, Tape};
use crate::field::interval::Interval;
use crate::field::number::Number;
use crate::field::work;
use crate::{Control, Error};

/// A cube that is not divided further.
#[derive(Clone, Debug)]
pub(super) struct Leaf {
    pub(super) cube: Cube,
    /// Nothing if the surface certainly does not meet the cube.
    pub(super) tape: Option<Arc<Tape>>,
    /// For an empty cube whether it is inside.
    pub(super) inside: bool,
}

pub(super) struct Settings<'a> {
    pub(super) lattice: Lattice,
    pub(super) tolerance: f64,
    /// Cubes larger than this must be proven simple; smaller ones are trusted to be what their samples say.
    pub(super) resolution: f64,
    pub(super) control: &'a Control,
}

/// The default resolution. Bounds of formulas find small parts by themselves; those of distances are wide where a thin
/// part has faces both ways.
pub(super) fn usual_resolution(tape: &Tape, extent: f64, tolerance: f64) -> f64 {
    let coarse = extent / 64.0;
    if tape.has_leaf() { coarse.min(4.0 * tolerance) } else { coarse }
}

/// What becomes of a box.
pub(super) enum Judgement {
    Empty { inside: bool },
    Keep(Arc<Tape>),
    Divide(Arc<Tape>),
}

/// The leaves of the octree, coarse ones first, in an order that depends on the field alone.
pub(super) fn subdivide(tape: &Arc<Tape>, settings: &Settings<'_>) -> Result<Vec<Leaf>, Error> {
    let root = Cube { corner: [0; 3], size: settings.lattice.count };
    let mut leaves = Vec::new();
    divide(vec![(root, Arc::clone(tape))], &mut leaves, settings)?;
    Ok(leaves)
}

/// Divides the leaves that `wanted` picks, unless they are as small as can be. Returns the position of the first new
/// leaf; all after it are new.
pub(super) fn refine(
    leaves: &mut Vec<Leaf>,
    wanted: impl Fn(usize) -> bool,
    settings: &Settings<'_>,
) -> Result<usize, Error> {
    let mut level = Vec::new();
    let mut kept = Vec::with_capacity(leaves.len());
    for (index, leaf) in leaves.drain(..).enumerate() {
        match &leaf.tape {
            Some(tape) if leaf.cube.size > 1 && wanted(index) => {
                level.extend(leaf.cube.children().map(|child| (child, Arc::clone(tape))));
            }
            _ => kept.push(leaf),
        }
    }
    *leaves = kept;
    let first = leaves.len();
    divide(level, leaves, settings)?;
    Ok(first)
}

/// The cells that have one of the points on their boundary.
pub(super) fn touching(leaves: &[Leaf], points: &[Key], lattice: &Lattice) -> FxHashSet<Cube> {
    let cells: FxHashSet<Cube> =
        leaves.iter().filter(|leaf| leaf.tape.is_some()).map(|leaf| leaf.cube).collect();
    let mut found = FxHashSet::default();
    for &point in points {
        let point = unkey(point);
        // The finest cubes around the point, and the cubes that hold them.
        for octant in 0..8 {
            let lower: [u32; 3] = std::array::from_fn(|axis| octant >> axis & 1);
            if (0..3).any(|axis| point[axis] < lower[axis] || point[axis] - lower[axis] >= lattice.count) {
                continue;
            }
            let unit: [u32; 3] = std::array::from_fn(|axis| point[axis] - lower[axis]);
            let sizes = (0..=lattice.count.trailing_zeros()).map(|level| 1u32 << level);
            let holding = sizes.map(|size| Cube { corner: unit.map(|x| x & !(size - 1)), size });
            found.extend(holding.into_iter().find(|cube| cells.contains(cube)));
        }
    }
    found
}

/// Makes cells of the leaves that were held to be empty although the surface cuts one of the faces.
pub(super) fn reopen(leaves: &mut [Leaf], faces: &[Face], tape: &Arc<Tape>) {
    for leaf in leaves.iter_mut().filter(|leaf| leaf.tape.is_none()) {
        let Cube { corner, size } = leaf.cube;
        let holds = |face: &Face| {
            (0..3).all(|axis| {
                let (low, high) = (corner[axis], corner[axis] + size);
                if axis == face.axis {
                    face.corner[axis] == low || face.corner[axis] == high
                } else {
                    low <= face.corner[axis] && face.corner[axis] + face.size <= high
                }
            })
        };
        if faces.iter().any(holds) {
            leaf.tape = Some(Arc::clone(tape));
            leaf.inside = false;
        }
    }
}

fn divide(
    mut level: Vec<(Cube, Arc<Tape>)>,
    leaves: &mut Vec<Leaf>,
    settings: &Settings<'_>,
) -> Result<(), Error> {
    while !level.is_empty() {
        let stage = format!("subdivide {}", settings.lattice.count / level[0].0.size);
        let judged = work::pieces(level.len(), 32, settings.control, &stage, |range| {
            let mut scratch = Scratch::default();
            range
                .map(|k| judge(level[k].0, &level[k].1, settings, &mut scratch))
                .collect::<Result<Vec<_>, _>>()
        })?;
        let mut next = Vec::new();
        for ((cube, _), judgement) in level.iter().zip(judged.into_iter().flatten()) {
            match judgement {
                Judgement::Empty { inside } => leaves.push(Leaf { cube: *cube, tape: None, inside }),
                Judgement::Keep(tape) => leaves.push(Leaf { cube: *cube, tape: Some(tape), inside: false }),
                Judgement::Divide(tape) => {
                    next.extend(cube.children().map(|child| (child, Arc::clone(&tape))));
                }
            }
        }
        let held = (next.len() * size_of::<(Cube, Arc<Tape>)>() + leaves.len() * size_of::<Leaf>()) as u64;
        let _account = settings.control.reserve(held)?;
        level = next;
    }
    Ok(())
}

/// The value at a point; an error where the field has none.
pub(super) fn value_at(tape: &Tape, place: DVec3, scratch: &mut Scratch) -> Result<f64, Error> {
    let value = tape.value(place.to_array(), scratch);
    if value.is_nan() {
        let [x, y, z] = place.to_array();
        return Err(Error::Field(format!(
            "the field is not a number at ({x}, {y}, {z}): a root or logarithm of a negative number, or 0/0; \
             restrict the formula to where it is defined"
        )));
    }
    Ok(value)
}

/// What is known of a box that is not certainly empty.
pub(super) struct Probed {
    /// The tape with the branches that win all over the box.
    pub(super) tape: Arc<Tape>,
    pub(super) bounds: Interval,
    /// The field in the middle, and the length of its gradient there.
    pub(super) middle: f64,
    pub(super) slope: f64,
    /// Whether the surface in the box is certainly in one piece.
    pub(super) certain: bool,
}

/// Looks at a whole box at once: bounds of the field, by intervals and by the mean value theorem.
pub(super) fn probe(
    tape: &Arc<Tape>,
    low: DVec3,
    high: DVec3,
    scratch: &mut Scratch,
) -> Result<Result<Probed, Judgement>, Error> {
    let bounds = tape.bounds(low.to_array(), high.to_array(), scratch);
    if let Some(empty) = emptiness(bounds) {
        return Ok(Err(empty));
    }
    let tape = match tape.simplified(&scratch.choices) {
        Some(simpler) => Arc::new(simpler),
        None => Arc::clone(tape),
    };
    let mut slopes = slopes(&tape, low, high, scratch);
    for axis in (0..3).filter(|&axis| low[axis] == high[axis]) {
        for slope in &mut slopes {
            slope[axis] = Interval::new(0.0, 0.0);
        }
    }
    let centre = (low + high) * 0.5;
    let middle = value_at(&tape, centre, scratch)?;
    let bounds = mean_value_bounds(middle, &slopes, high - low).meet(bounds);
    if let Some(empty) = emptiness(bounds) {
        return Ok(Err(empty));
    }
    let (_, gradient) = tape.gradient(centre.to_array(), scratch);
    let certain = tape.branchings() <= MOST_BRANCHINGS && is_graph(&slopes);
    Ok(Ok(Probed { tape, bounds, middle, slope: gradient.length(), certain }))
}

fn judge(
    cube: Cube,
    tape: &Arc<Tape>,
    settings: &Settings<'_>,
    scratch: &mut Scratch,
) -> Result<Judgement, Error> {
    let lattice = &settings.lattice;
    let (low, high) = lattice.corners(cube);
    let probed = match probe(tape, low, high, scratch)? {
        Ok(probed) => probed,
        Err(empty) => return Ok(empty),
    };
    let tape = probed.tape;
    if cube.size > lattice.count / 8 {
        return Ok(Judgement::Divide(tape));
    }
    let points = cube.points().map(|point| lattice.place(point));
    let mut values = [0.0; 8];
    for (value, &point) in values.iter_mut().zip(&points) {
        *value = value_at(&tape, point, scratch)?;
    }
    let finest = cube.size == 1;
    let size = f64::from(cube.size) * lattice.step();
    let certain = probed.certain;
    let positive = values[0] > 0.0;
    let keep = if finest {
        true
    } else if values.iter().all(|&value| (value > 0.0) == positive) {
        let outside = if positive { -probed.bounds.low } else { probed.bounds.high };
        let intrusion = outside / probed.slope;
        let trusted = size <= settings.resolution * if certain { 0.25 } else { 1.0 };
        (certain && intrusion <= 0.5 * settings.tolerance) || (trusted && (probed.middle > 0.0) == positive)
    } else {
        // In a narrow wedge the distance from the crease is several times the deviation from either side.
        let tolerance = settings.tolerance * if tape.branchings() > 0 { 0.25 } else { 1.0 };
        let cell = Cell { tape: &tape, low, high, tolerance };
        let provable = certain || size <= settings.resolution;
        let crease_may_hide = size > settings.resolution && tape.branchings() > 0;
        provable && is_simple(&cell, &points, &values, crease_may_hide, scratch)
    };
    Ok(if keep { Judgement::Keep(tape) } else { Judgement::Divide(tape) })
}

fn emptiness(bounds: Interval) -> Option<Judgement> {
    if bounds.low > 0.0 {
        Some(Judgement::Empty { inside: true })
    } else if bounds.high <= 0.0 {
        Some(Judgement::Empty { inside: false })
    } else {
        None
    }
}

/// Cells with more undecided branchings than this are divided rather than looked at branch by branch.
const MOST_BRANCHINGS: usize = 3;

/// Bounds of the gradient over a box, for each combination of the branches that are open there.
fn slopes(tape: &Tape, low: DVec3, high: DVec3, scratch: &mut Scratch) -> SmallVec<[[Interval; 3]; 8]> {
    let (low, high) = (low.to_array(), high.to_array());
    let branchings = tape.branchings();
    if branchings > MOST_BRANCHINGS {
        return smallvec::smallvec![tape.gradient_bounds(low, high, &[], scratch)];
    }
    (0..1usize << branchings)
        .map(|number| {
            let choices: SmallVec<[Choice; MOST_BRANCHINGS]> = (0..branchings)
                .map(|k| if number >> k & 1 == 0 { Choice::Left } else { Choice::Right })
                .collect();
            tape.gradient_bounds(low, high, &choices, scratch)
        })
        .collect()
}

/// Bounds of the field over a box of the given size from its value in the middle and bounds of its gradient.
fn mean_value_bounds(middle: f64, slopes: &[[Interval; 3]], size: DVec3) -> Interval {
    let mut sum = Interval::new(middle, middle);
    for axis in 0..3 {
        let hull = slopes.iter().map(|slope| slope[axis]).reduce(Interval::hull).unwrap_or(Interval::ENTIRE);
        let reach = (size[axis] * 0.5).next_up();
        sum = sum.add(hull.mul(Interval::new(-reach, reach)));
    }
    // The middle's own rounding.
    Interval::new(sum.low - 1e-13 * middle.abs(), sum.high + 1e-13 * middle.abs())
}

/// Whether there is a direction in which every branch of the field grows: then the surface in the cell is a graph
/// over a plane, in one piece however the branches meet.
fn is_graph(slopes: &[[Interval; 3]]) -> bool {
    let middles: SmallVec<[DVec3; 8]> = slopes
        .iter()
        .map(|slope| DVec3::from_array(slope.map(Interval::middle)).normalize_or_zero())
        .collect();
    if middles.iter().any(|middle| !middle.is_finite() || *middle == DVec3::ZERO) {
        return false;
    }
    let mut direction = middles.iter().sum::<DVec3>().normalize_or_zero();
    for _ in 0..8 {
        let growth = |slope: &[Interval; 3]| {
            (0..3).map(|axis| slope[axis].mul(Interval::constant(direction[axis])).low).sum::<f64>()
        };
        let worst = (0..slopes.len()).min_by(|&a, &b| growth(&slopes[a]).total_cmp(&growth(&slopes[b])));
        let Some(worst) = worst else { return false };
        if growth(&slopes[worst]) > 0.0 {
            return true;
        }
        direction = (direction + middles[worst] * 0.5).normalize_or_zero();
    }
    false
}

/// The outline of each face of a cube, as numbers of its corners, counter-clockwise seen from outside.
fn outline(axis: usize, upper: bool) -> [usize; 4] {
    let (u, v) = (1 << ((axis + 1) % 3), 1 << ((axis + 2) % 3));
    if upper { [0, u, u | v, v].map(|corner| corner | 1 << axis) } else { [0, v, u | v, u] }
}

/// The lines on the faces of a cell, as far as its own eight corners show.
#[derive(Default)]
struct CellLines {
    /// Crossings of the cell's edges, which are named by two corners, the lower first.
    crossings: SmallVec<[((usize, usize), DVec3); 12]>,
    /// The lines, with the axis of their face and whether it is the upper one.
    lines: SmallVec<[(LoopLink, usize, bool); 6]>,
}

impl CellLines {
    /// `None` if a face is cut by several lines, or the lines are not one loop.
    fn new(cell: &Cell<'_>, points: &[DVec3; 8], values: &[f64; 8], scratch: &mut Scratch) -> Option<Self> {
        let mut found = Self::default();
        for axis in 0..3 {
            for upper in [false, true] {
                let corners = outline(axis, upper);
                let inside = corners.map(|corner| values[corner] > 0.0);
                let stretches = stretches(&inside);
                if stretches.len() > 1 {
                    return None;
                }
                for (enter, exit) in stretches {
                    let [from, to] = [enter, exit].map(|k| {
                        let (a, b) = (corners[k], corners[(k + 1) % 4]);
                        found.crossing(cell, (a.min(b), a.max(b)), points, values, scratch)
                    });
                    found.lines.push((LoopLink { from, to, kink: None }, axis, upper));
                }
            }
        }
        let segments: Vec<LoopLink> = found.lines.iter().map(|line| line.0).collect();
        (chain(&segments).len() == 1).then_some(found)
    }

    /// Number of the crossing of an edge, found if it is not known yet.
    fn crossing(
        &mut self,
        cell: &Cell<'_>,
        edge: (usize, usize),
        points: &[DVec3; 8],
        values: &[f64; 8],
        scratch: &mut Scratch,
    ) -> u32 {
        if let Some(known) = self.crossings.iter().position(|crossing| crossing.0 == edge) {
            return known as u32;
        }
        let (from, to) = edge;
        let at = crossing(cell.tape, points[from], points[to], [values[from], values[to]], 5, scratch);
        self.crossings.push((edge, at));
        (self.crossings.len() - 1) as u32
    }

    /// Whether all crossings lie on one branch of the field.
    fn have_one_branch(&self, cell: &Cell<'_>, scratch: &mut Scratch) -> bool {
        let first = sample(cell.tape, self.crossings[0].1, scratch).branch;
        self.crossings[1..].iter().all(|crossing| sample(cell.tape, crossing.1, scratch).branch == first)
    }

    /// The corners of the loop: crossings, and kinks where branches meet on a face.
    fn corners(&self, cell: &Cell<'_>, scratch: &mut Scratch) -> Vec<Corner> {
        let mut kinks: Vec<DVec3> = Vec::new();
        let mut segments = Vec::with_capacity(self.lines.len());
        for &(segment, axis, upper) in &self.lines {
            let ends = [segment.from, segment.to].map(|vertex| self.crossings[vertex as usize].1);
            let (mut low, mut high) = (cell.low, cell.high);
            if upper {
                low[axis] = high[axis];
            } else {
                high[axis] = low[axis];
            }
            let found = kink(cell.tape, ends, (low, high), axis, cell.tolerance, scratch);
            kinks.extend(found);
            let number = (self.crossings.len() + kinks.len() - 1) as u32;
            segments.push(LoopLink { kink: found.map(|_| number), ..segment });
        }
        chain(&segments).into_iter().next().map_or_else(Vec::new, |pieces| {
            corners_of(&pieces, |vertex| {
                let vertex = vertex as usize;
                let crossing = self.crossings.get(vertex);
                crossing.map_or_else(|| kinks[vertex - self.crossings.len()], |crossing| crossing.1)
            })
        })
    }
}

/// Whether the surface in the cell, as far as its own eight corners show, is one piece that a filling follows to within
/// the tolerance.
fn is_simple(
    cell: &Cell<'_>,
    points: &[DVec3; 8],
    values: &[f64; 8],
    crease_may_hide: bool,
    scratch: &mut Scratch,
) -> bool {
    let Some(lines) = CellLines::new(cell, points, values, scratch) else { return false };
    if crease_may_hide && lines.have_one_branch(cell, scratch) {
        return false;
    }
    let corners = lines.corners(cell, scratch);
    for (k, corner) in corners.iter().enumerate() {
        let next = corners[(k + 1) % corners.len()];
        if deviation(cell.tape, (corner.place + next.place) * 0.5, scratch) > cell.tolerance {
            return false;
        }
    }
    let filling = cell.fill(&corners, scratch);
    cell.error(&corners, &filling, scratch) <= cell.tolerance
}

/// The corners of a loop, kinks included.
pub(super) fn corners_of(pieces: &[LoopLink], place: impl Fn(u32) -> DVec3) -> Vec<Corner> {
    let mut corners = Vec::with_capacity(pieces.len());
    for piece in pieces {
        corners.push(Corner { place: place(piece.from), vertex: piece.from, kink: false });
        if let Some(vertex) = piece.kink {
            corners.push(Corner { place: place(vertex), vertex, kink: true });
        }
    }
    corners
}
