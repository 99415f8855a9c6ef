//! The fit: control points near the curve move until the cage's surface is where the exact result is.

use glam::DVec3;
use rustc_hash::FxHashMap;

use super::assemble::Draft;
use super::curve::{Chain, polished};
use super::operand::Operand;
use super::solve::{Equation, solve, weighted};
use super::work::Sharp;
use crate::subdivision::level::Level;
use crate::subdivision::refine::{Row, add};

/// Rounds of moving the samples' targets and solving.
const ROUNDS: usize = 6;
/// What a residual along the surface weighs: much in the first round, then little, so that samples may slide.
const SLIDING: [f64; 2] = [0.3, 0.05];
/// What a residual of a sample on the curve or a crease weighs.
const SHARP_WEIGHT: f64 = 3.0;
/// Draws unknowns that no sample holds to where they were.
const RIDGE: f64 = 1e-5;

/// Where a sample belongs.
#[derive(Clone, Copy, Debug)]
enum Aim {
    /// An operand, and a fine triangle to begin the next search from.
    Surface(u16, u32),
    /// A chain, and the length along it to begin from.
    Curve(u32, f64),
    /// An operand.
    Crease(u16),
    Point(DVec3),
}

struct Sample {
    /// Over the control points.
    row: Vec<(u32, f64)>,
    aim: Aim,
    /// The target and its normal or direction, once known.
    last: Option<(DVec3, DVec3)>,
}

/// Everything that the fit of one draft needs.
pub(super) struct Fit<'a> {
    operands: &'a [Operand],
    reversed: &'a [bool],
    chains: &'a [Chain],
    creases: Vec<CreaseLines>,
    samples: Vec<Sample>,
    /// The unknown control points.
    pub(super) unknown: Vec<u32>,
    number: Vec<u32>,
}

/// The creases of an operand as segments on its surface.
pub(super) struct CreaseLines(Vec<[DVec3; 2]>);

impl CreaseLines {
    pub(super) fn new(operand: &Operand) -> Self {
        let level = &operand.surface.level;
        let mesh = operand.fine.mesh();
        let at = |v: u32| DVec3::from(mesh.positions[v as usize]);
        let mut segments = Vec::new();
        for (e, &h) in level.edges.iter().enumerate() {
            if level.sharpness[e] > 0.0 {
                let mut points = vec![level.from(h)];
                points.extend(&operand.fine.edge_points[e]);
                points.push(level.to(h));
                segments.extend(points.windows(2).map(|pair| [at(pair[0]), at(pair[1])]));
            }
        }
        Self(segments)
    }

    /// The nearest point, and the direction there.
    fn nearest(&self, x: DVec3) -> Option<(DVec3, DVec3)> {
        let mut best: Option<(f64, DVec3, DVec3)> = None;
        for &[p, q] in &self.0 {
            let along = q - p;
            let t = ((x - p).dot(along) / along.length_squared()).clamp(0.0, 1.0);
            let point = p + along * t;
            let distance = x.distance_squared(point);
            if best.is_none_or(|(least, ..)| distance < least) {
                best = Some((distance, point, along.normalize_or_zero()));
            }
        }
        best.map(|(_, point, along)| (point, along))
    }
}

/// Rows of the limit surface at the vertices after one or two steps, over the control points.
pub(super) struct LimitRows {
    one: Level,
    first: Vec<Row>,
    /// The level after two steps, and its rows, made when asked for.
    two: Option<(Level, Vec<Option<Row>>)>,
}

impl LimitRows {
    pub(super) fn new(level: &Level, steps: u32) -> Self {
        let (one, first) = level.refined();
        let two = (steps > 1).then(|| {
            let two = one.refined_faces();
            let rows = vec![None; two.vertex_count];
            (two, rows)
        });
        Self { one, first, two }
    }

    fn last(&self) -> &Level {
        self.two.as_ref().map_or(&self.one, |(two, _)| two)
    }

    /// A vertex of the last level over the control points.
    fn row(&mut self, v: u32) -> Row {
        let Some((_, rows)) = &mut self.two else { return self.first[v as usize].clone() };
        let (one, first) = (&self.one, &self.first);
        rows[v as usize]
            .get_or_insert_with(|| {
                let before = one.vertex_count as u32;
                let row = if v < before { one.vertex_row(v) } else { one.edge_row(v - before) };
                let mut all = Row::new();
                row.iter().for_each(|&(w, weight)| add(&mut all, &first[w as usize], weight));
                all
            })
            .clone()
    }

    pub(super) fn limit(&mut self, v: u32) -> Vec<(u32, f64)> {
        let mut all = Row::new();
        for (w, weight) in self.last().limit_row(v) {
            let row = self.row(w);
            add(&mut all, &row, weight);
        }
        all.sort_unstable_by_key(|entry| entry.0);
        all.into_vec()
    }
}

/// Vertices within `rings` rings of the changed ones.
pub(super) fn unknowns(draft: &Draft, rings: usize) -> Vec<u32> {
    let mut near = draft.changed.clone();
    for _ in 0..rings {
        let before = near.clone();
        for corners in draft.cage.faces() {
            if corners.iter().any(|&v| before[v as usize]) {
                corners.iter().for_each(|&v| near[v as usize] = true);
            }
        }
    }
    (0..near.len() as u32).filter(|&v| near[v as usize]).collect()
}

impl<'a> Fit<'a> {
    pub(super) fn new(
        draft: &Draft,
        operands: &'a [Operand],
        reversed: &'a [bool],
        chains: &'a [Chain],
        rings: usize,
        steps: u32,
    ) -> Self {
        let unknown = unknowns(draft, rings);
        let mut number = vec![u32::MAX; draft.changed.len()];
        unknown.iter().enumerate().for_each(|(i, &v)| number[v as usize] = i as u32);
        let creases = operands.iter().map(CreaseLines::new).collect();
        let mut fit = Self { operands, reversed, chains, creases, samples: Vec::new(), unknown, number };
        if !fit.unknown.is_empty() {
            fit.take_samples(draft, steps);
        }
        fit
    }

    /// Samples over all faces whose surface depends on an unknown: at the vertices after one or two `steps`.
    fn take_samples(&mut self, draft: &Draft, steps: u32) {
        let mut rows = LimitRows::new(draft.cage.level(), steps);
        let mut aims: FxHashMap<u32, Aim> = FxHashMap::default();
        let faces = draft.cage.faces();
        let mut moves = vec![false; self.number.len()];
        for corners in faces {
            if corners.iter().any(|&v| self.number[v as usize] != u32::MAX) {
                corners.iter().for_each(|&v| moves[v as usize] = true);
            }
        }
        // 1. On faces.
        for (f, corners) in faces.iter().enumerate() {
            if corners.iter().any(|&v| moves[v as usize]) {
                for inner in &rows.last().faces[f << (2 * steps)..(f + 1) << (2 * steps)] {
                    inner.iter().for_each(|&v| {
                        aims.insert(v, Aim::Surface(draft.operand_of[f], draft.seeds[f]));
                    });
                }
            }
        }
        // 2. On curves and creases: the points of an edge.
        let level = draft.cage.level();
        for (e, &h) in level.edges.iter().enumerate() {
            let (u, v) = (level.from(h), level.to(h));
            let Some(&sharp) = draft.sharp.get(&(u.min(v), u.max(v))) else { continue };
            let middle = level.vertex_count as u32 + e as u32;
            let quarter = |i: u32| rows.one.vertex_count as u32 + 2 * e as u32 + i;
            let points = [(u, 0.0), (middle, 0.5), (v, 1.0), (quarter(0), 0.25), (quarter(1), 0.75)];
            for &(point, t) in &points[..if steps > 1 { 5 } else { 3 }] {
                if let Some(aim) = aims.get_mut(&point) {
                    *aim = match sharp {
                        Sharp::Curve(c) => self.curve_aim(draft, c, [u, v], t),
                        Sharp::Crease(o) => Aim::Crease(o),
                    };
                }
            }
        }
        // 3. At fixed points.
        for v in 0..draft.fixed.len() {
            if draft.fixed[v]
                && let Some(aim) = aims.get_mut(&(v as u32))
            {
                *aim = Aim::Point(draft.targets[v]);
            }
        }
        let mut all: Vec<(u32, Aim)> = aims.into_iter().collect();
        all.sort_unstable_by_key(|entry| entry.0);
        for (v, aim) in all {
            let row = rows.limit(v);
            if row.iter().any(|&(w, _)| self.number[w as usize] != u32::MAX) {
                self.samples.push(Sample { row, aim, last: None });
            }
        }
    }

    /// Where `t` of an edge of the curve belongs: its chain, and the length there.
    fn curve_aim(&self, draft: &Draft, c: u32, ends: [u32; 2], t: f64) -> Aim {
        let chain = &self.chains[c as usize];
        // Where chains meet, the end may name another.
        let [from, to] = ends.map(|v| match draft.on_curve[v as usize] {
            Some((own, length)) if own == c => length,
            _ => chain.nearest(draft.targets[v as usize], 0.0, f64::INFINITY).length,
        });
        let mut apart = to - from;
        if chain.closed && chain.length() > 0.0 {
            apart -= chain.length() * (apart / chain.length()).round();
        }
        Aim::Curve(c, from + t * apart)
    }

    /// Fits the unknown control points; returns the steps of the solver.
    pub(super) fn run(&mut self, positions: &mut [DVec3], loose: f64) -> usize {
        let mut steps = 0;
        for round in 0..ROUNDS {
            let equations = self.equations(positions, SLIDING[usize::from(round > 0)]);
            let mut unknowns: Vec<DVec3> = self.unknown.iter().map(|&v| positions[v as usize]).collect();
            let before = unknowns.clone();
            steps += solve(&equations, &mut unknowns, RIDGE);
            self.unknown.iter().zip(&unknowns).for_each(|(&v, &x)| positions[v as usize] = x);
            let moved = before.iter().zip(&unknowns).map(|(p, q)| p.distance(*q)).fold(0.0, f64::max);
            if round > 0 && moved < loose {
                break;
            }
        }
        steps
    }

    fn equations(&mut self, positions: &[DVec3], sliding: f64) -> Vec<Equation> {
        let mut samples = std::mem::take(&mut self.samples);
        let equations = samples
            .iter_mut()
            .filter_map(|sample| {
                let point =
                    sample.row.iter().fold(DVec3::ZERO, |sum, &(v, w)| sum + positions[v as usize] * w);
                let (target, weight) = self.aim(sample, point, sliding)?;
                let mut known = DVec3::ZERO;
                let mut row = Vec::new();
                for &(v, w) in &sample.row {
                    match self.number[v as usize] {
                        u32::MAX => known += positions[v as usize] * w,
                        i => row.push((i, w)),
                    }
                }
                Some(Equation { row, known, target, weight })
            })
            .collect();
        self.samples = samples;
        equations
    }

    /// Where a sample now at `point` should be, and what it weighs.
    fn aim(&self, sample: &mut Sample, point: DVec3, sliding: f64) -> Option<(DVec3, glam::DMat3)> {
        match sample.aim {
            Aim::Point(target) => Some((target, glam::DMat3::IDENTITY * (10.0 * SHARP_WEIGHT))),
            Aim::Surface(o, guess) => {
                let foot = self.operands[usize::from(o)].foot(point, Some(guess))?;
                let normal = if self.reversed[usize::from(o)] { -foot.normal } else { foot.normal };
                // The foot jumped to another layer: the last one stays the target.
                let (target, normal) = match sample.last {
                    Some((target, known)) if known.dot(normal) < 0.5 => (target, known),
                    _ => {
                        sample.aim = Aim::Surface(o, foot.triangle);
                        (foot.position, normal)
                    }
                };
                sample.last = Some((target, normal));
                Some((target, weighted(normal, 1.0, sliding)))
            }
            Aim::Curve(c, guess) => {
                let chain = &self.chains[c as usize];
                let reach = 0.1 * chain.length();
                let near = chain.nearest(point, guess, reach);
                sample.aim = Aim::Curve(c, near.length);
                let layers = chain.layers[near.stretch];
                let (target, _) =
                    polished(self.operands, layers, near.point, near.along, 0.1 * chain.length());
                Some((target, weighted(near.along, SHARP_WEIGHT * sliding, SHARP_WEIGHT)))
            }
            Aim::Crease(o) => {
                let (target, along) = self.creases[usize::from(o)].nearest(point)?;
                Some((target, weighted(along, SHARP_WEIGHT * sliding, SHARP_WEIGHT)))
            }
        }
    }
}
