//! The numbers that points have in a result.

use std::sync::atomic::{AtomicBool, Ordering};

use rustc_hash::FxHashMap;

use crate::Error;
use crate::boolean::complex::ids::PointId;
use crate::parallel::{Runner, parts};

/// Which points a result uses, and their numbers in it.
///
/// Vertices are in use where the winding number says so, except doubtful ones, which must be found in some triangle. Points
/// are added in their order: the vertices of A, those of B, all others.
#[derive(Debug)]
pub(crate) struct Numbers {
    /// By point; first one of the states below, then its number.
    numbers: Vec<u32>,
    /// Numbers of vertices that are not kept where they were, and stand for another point.
    of_others: FxHashMap<PointId, u32>,
    /// Points that were once in doubt.
    doubtful: Vec<PointId>,
    /// By operand, whether every kept vertex has the winding number 0 or 1.
    once: Vec<bool>,
    positions: Vec<[f64; 3]>,
    points: usize,
}

/// Points that one thread looks at before another may take the rest.
const POINTS_PER_SHARE: usize = 1 << 16;

/// States of points before they are numbered. A vertex that is not kept but in use stands for another point.
const KEPT: u32 = u32::MAX - 1;
const DOUBTFUL: u32 = u32::MAX - 2;
const STANDS: u32 = u32::MAX - 3;

impl Numbers {
    /// The number of what is not in the result.
    pub(crate) const NONE: u32 = u32::MAX;

    /// For a number of points.
    pub(crate) fn new(points: usize) -> Self {
        Self {
            numbers: Vec::with_capacity(points),
            of_others: FxHashMap::default(),
            doubtful: Vec::new(),
            once: Vec::new(),
            positions: Vec::new(),
            points,
        }
    }

    /// Adds the vertices of the next operand by their winding numbers.
    ///
    /// # Errors
    /// Only limits.
    pub(crate) fn add_vertices(
        &mut self,
        windings: &[i32],
        is_kept: impl Fn(i32) -> bool + Sync,
        runner: Runner<'_>,
    ) -> Result<(), Error> {
        let [zero, one] = [0, 1].map(|winding| if is_kept(winding) { KEPT } else { Self::NONE });
        let once = AtomicBool::new(true);
        let state = |&winding: &i32| match winding {
            0 => zero,
            1 => one,
            winding => {
                once.store(false, Ordering::Relaxed);
                if is_kept(winding) { KEPT } else { Self::NONE }
            }
        };
        if runner.is_parallel() {
            let start = self.numbers.len();
            self.numbers.resize(start + windings.len(), 0);
            runner.fill(&mut self.numbers[start..], POINTS_PER_SHARE, |first, states| {
                states.iter_mut().zip(&windings[first..]).for_each(|(of, winding)| *of = state(winding));
            })?;
        } else {
            self.numbers.extend(windings.iter().map(state));
        }
        self.once.push(once.into_inner());
        Ok(())
    }

    /// Adds all other points, in use only if they are marked.
    pub(crate) fn add_others(&mut self) {
        self.numbers.resize(self.points, DOUBTFUL);
    }

    /// Whether all winding numbers around the vertices of an operand are 0 or 1.
    pub(crate) fn are_once(&self, operand: usize) -> bool {
        self.once[operand]
    }

    /// Doubts that a point is in use.
    #[inline]
    pub(crate) fn doubt(&mut self, point: PointId) {
        let state = &mut self.numbers[point.index()];
        if *state == KEPT {
            *state = DOUBTFUL;
            self.doubtful.push(point);
        }
    }

    /// Marks a point as in use.
    #[inline]
    pub(crate) fn mark(&mut self, point: PointId) {
        let state = &mut self.numbers[point.index()];
        *state = match *state {
            Self::NONE | STANDS => STANDS,
            _ => KEPT,
        };
    }

    /// Whether it is not known whether a point is in use.
    #[inline]
    pub(crate) fn is_doubtful(&self, point: PointId) -> bool {
        self.numbers[point.index()] == DOUBTFUL
    }

    /// Whether that is not known of some point.
    pub(crate) fn are_doubtful(&self) -> bool {
        self.doubtful.iter().any(|&point| self.is_doubtful(point))
    }

    /// Numbers the points in use, in their order. Kept vertices for which another point stands get its number.
    ///
    /// # Errors
    /// Only limits.
    pub(crate) fn count(
        &mut self,
        position: impl Fn(PointId) -> [f64; 3] + Sync,
        representative: impl Fn(PointId) -> PointId,
        runner: Runner<'_>,
    ) -> Result<(), Error> {
        let of_others = if runner.is_parallel() {
            self.count_in_parallel(position, runner)?
        } else {
            self.positions.reserve(self.points);
            number(&mut self.numbers, 0, 0, |point| self.positions.push(position(point)))
        };
        self.of_others.extend(of_others);
        for &point in &self.doubtful {
            let other = representative(point);
            if other != point {
                self.numbers[point.index()] = self.of(other);
            }
        }
        Ok(())
    }

    /// Numbers the points share by share, after those in use have been counted in each.
    fn count_in_parallel(
        &mut self,
        position: impl Fn(PointId) -> [f64; 3] + Sync,
        runner: Runner<'_>,
    ) -> Result<Vec<(PointId, u32)>, Error> {
        let states = &self.numbers;
        let is_used = |state: &&u32| [KEPT, STANDS].contains(state);
        let counts = runner
            .pieces(states.len(), POINTS_PER_SHARE, |range| states[range].iter().filter(is_used).count())?;
        self.positions = vec![[0.0; 3]; counts.iter().sum()];
        let (mut start, mut next) = (0, 0);
        let pieces = self.numbers.chunks_mut(POINTS_PER_SHARE).zip(parts(&mut self.positions, counts));
        let pieces = pieces.map(|(states, positions)| {
            let first = (start, next);
            (start, next) = (start + states.len() as u32, next + positions.len() as u32);
            (first, states, positions)
        });
        let of_others = runner.each(pieces.collect(), |((start, next), states, positions)| {
            let mut places = positions.iter_mut();
            let of_others = number(states, start, next, |point| {
                *places.next().expect("as many as were counted") = position(point);
            });
            assert!(places.next().is_none(), "fewer than were counted");
            of_others
        })?;
        Ok(of_others.concat())
    }

    /// The number of a point in use.
    #[inline]
    pub(crate) fn of(&self, point: PointId) -> u32 {
        match self.numbers[point.index()] {
            Self::NONE => self.of_others.get(&point).copied().unwrap_or(Self::NONE),
            number => number,
        }
    }

    /// The numbers of points from `first` on that are kept where they were; [`NONE`](Self::NONE) for the others.
    pub(crate) fn from(&self, first: PointId) -> &[u32] {
        &self.numbers[first.index()..]
    }

    /// The positions of the points in use, by number.
    pub(crate) fn into_positions(self) -> Vec<[f64; 3]> {
        self.positions
    }
}

/// Numbers the points in use from `next` on, of points from `start` on with the given states, and calls `add` for each.
/// Returns those that stand for others with their numbers.
fn number(
    states: &mut [u32],
    start: u32,
    mut next: u32,
    mut add: impl FnMut(PointId),
) -> Vec<(PointId, u32)> {
    let mut of_others = Vec::new();
    for (point, state) in (start..).map(PointId::new).zip(states) {
        *state = match *state {
            KEPT => next,
            STANDS => {
                of_others.push((point, next));
                Numbers::NONE
            }
            _ => {
                *state = Numbers::NONE;
                continue;
            }
        };
        add(point);
        next += 1;
    }
    of_others
}
