//! Where triangles came from, as runs: untouched triangles keep their order, so most of a result is a few of them.

use super::outcome::Origin;

/// A list of [`Origin`]s, as runs of consecutive triangles of one operand.
#[derive(Clone, Debug, Default)]
pub(super) struct Origins {
    runs: Vec<Run>,
    count: u32,
}

/// Triangles from `start` on, up to the next run.
#[derive(Clone, Copy, Debug)]
struct Run {
    start: u32,
    /// The origin of the first; the triangles of the others follow.
    first: Origin,
}

impl Origins {
    /// The first `count` triangles of an operand.
    pub(super) fn of_operand(operand: u32, count: usize) -> Self {
        let mut origins = Self::default();
        origins.push_run(Origin { operand, triangle: 0, reversed: false }, count as u32);
        origins
    }

    /// Appends one.
    #[inline]
    pub(super) fn push(&mut self, origin: Origin) {
        self.push_run(origin, 1);
    }

    /// Appends consecutive triangles, of which `first` is the first.
    #[inline]
    pub(super) fn push_run(&mut self, first: Origin, count: u32) {
        if count == 0 {
            return;
        }
        let follows = self.runs.last().is_some_and(|last| {
            last.first.operand == first.operand
                && last.first.reversed == first.reversed
                && first.triangle.wrapping_sub(last.first.triangle) == self.count - last.start
        });
        if !follows {
            self.runs.push(Run { start: self.count, first });
        }
        self.count += count;
    }

    /// Appends another list.
    pub(super) fn append(&mut self, other: &Self) {
        for (first, count) in other.runs() {
            self.push_run(first, count);
        }
    }

    /// All, one by one.
    pub(super) fn iter(&self) -> impl Iterator<Item = Origin> {
        self.runs().flat_map(|(first, count)| {
            (0..count).map(move |i| Origin { triangle: first.triangle + i, ..first })
        })
    }

    /// The origins of the origins: `sources` are those of the operands.
    pub(super) fn through(&self, sources: [&Self; 2]) -> Self {
        let mut result = Self::default();
        for (first, count) in self.runs() {
            let source = sources[first.operand as usize];
            let (mut at, end) = (first.triangle, first.triangle + count);
            let mut place = source.run_of(at);
            while at < end {
                let run = &source.runs[place];
                let run_end = source.runs.get(place + 1).map_or(source.count, |next| next.start).min(end);
                let origin = Origin {
                    operand: run.first.operand,
                    triangle: run.first.triangle + (at - run.start),
                    reversed: run.first.reversed != first.reversed,
                };
                result.push_run(origin, run_end - at);
                (at, place) = (run_end, place + 1);
            }
        }
        result
    }

    /// The runs, with how many triangles each has.
    fn runs(&self) -> impl Iterator<Item = (Origin, u32)> {
        self.runs.iter().enumerate().map(|(i, run)| {
            let end = self.runs.get(i + 1).map_or(self.count, |next| next.start);
            (run.first, end - run.start)
        })
    }

    fn run_of(&self, triangle: u32) -> usize {
        self.runs.partition_point(|run| run.start <= triangle) - 1
    }
}

impl FromIterator<Origin> for Origins {
    fn from_iter<T: IntoIterator<Item = Origin>>(origins: T) -> Self {
        let mut result = Self::default();
        origins.into_iter().for_each(|origin| result.push(origin));
        result
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::rngs::ChaCha8Rng;
    use rand::{RngExt, SeedableRng};

    fn random(rng: &mut ChaCha8Rng, operands: u32, triangles: u32) -> Vec<Origin> {
        let mut list = Vec::new();
        for _ in 0..20 {
            let first = Origin {
                operand: rng.random_range(0..operands),
                triangle: rng.random_range(0..triangles - 5),
                reversed: rng.random(),
            };
            let count = rng.random_range(1..=5);
            list.extend((0..count).map(|i| Origin { triangle: first.triangle + i, ..first }));
        }
        list
    }

    #[test]
    fn runs_are_the_list_they_were_made_of() {
        let mut rng = ChaCha8Rng::seed_from_u64(21);
        for _ in 0..50 {
            let list = random(&mut rng, 2, 30);
            let runs: Origins = list.iter().copied().collect();
            assert_eq!(runs.iter().collect::<Vec<_>>(), list);
            let mut twice = runs.clone();
            twice.append(&runs);
            assert_eq!(twice.iter().collect::<Vec<_>>(), [&list[..], &list[..]].concat());

            let sources = [0, 1].map(|_| random(&mut rng, 9, 1_000));
            let of_sources = sources.each_ref().map(|list| list.iter().copied().collect::<Origins>());
            let expected: Vec<Origin> = list
                .iter()
                .map(|origin| {
                    let source = sources[origin.operand as usize][origin.triangle as usize];
                    Origin { reversed: source.reversed != origin.reversed, ..source }
                })
                .collect();
            let through = runs.through(of_sources.each_ref());
            assert_eq!(through.iter().collect::<Vec<_>>(), expected);
        }
    }
}
