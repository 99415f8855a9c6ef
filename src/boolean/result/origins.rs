//! Where triangles came from: untouched triangles keep their order, so a bit for each triangle of an operand tells most of it.

use crate::boolean::complex::origin::Origin;

/// A list of [`Origin`]s.
#[derive(Clone, Debug, Default)]
pub(crate) struct Origins {
    stretches: Vec<Stretch>,
}

#[derive(Clone, Debug)]
enum Stretch {
    Kept(Kept),
    Runs(Vec<Run>),
}

/// Some triangles of one operand, in their order, each once.
#[derive(Clone, Debug)]
pub(crate) struct Kept {
    /// The operand, and its triangle that the first bit stands for.
    first: Origin,
    bits: Vec<u64>,
}

impl Kept {
    /// None yet of `count` triangles of an operand from `first` on.
    pub(crate) fn none(first: Origin, count: usize) -> Self {
        Self { first, bits: vec![0; count.div_ceil(64)] }
    }

    /// A bit for each triangle, 64 in a word, those past the last one zero.
    pub(crate) fn bits_mut(&mut self) -> &mut [u64] {
        &mut self.bits
    }

    fn count(&self) -> usize {
        self.bits.iter().map(|word| word.count_ones() as usize).sum()
    }

    fn runs(&self) -> impl Iterator<Item = Run> {
        let mut next = 0;
        std::iter::from_fn(move || {
            let start = self.next_with(next, 0)?;
            let end = self.next_with(start, u64::MAX).unwrap_or(64 * self.bits.len());
            next = end;
            let first = Origin { triangle: self.first.triangle + start as u32, ..self.first };
            Some(Run { first, count: (end - start) as u32 })
        })
    }

    /// The first place from `place` on whose bit differs from those of `word`, which are all alike.
    fn next_with(&self, place: usize, word: u64) -> Option<usize> {
        let mut index = place / 64;
        let mut differing = (self.bits.get(index)? ^ word) & (u64::MAX << (place % 64));
        while differing == 0 {
            index += 1;
            differing = self.bits.get(index)? ^ word;
        }
        Some(64 * index + differing.trailing_zeros() as usize)
    }
}

/// Consecutive triangles of one operand.
#[derive(Clone, Copy, Debug)]
struct Run {
    first: Origin,
    count: u32,
}

impl Run {
    /// Whether another run follows on this one.
    fn is_continued_by(&self, next: &Origin) -> bool {
        let Origin { operand, triangle, reversed } = self.first;
        (operand, reversed) == (next.operand, next.reversed) && triangle + self.count == next.triangle
    }
}

impl Origins {
    /// The first `count` triangles of an operand.
    pub(crate) fn of_operand(operand: u32, count: usize) -> Self {
        let mut origins = Self::default();
        origins
            .push_run(Run { first: Origin { operand, triangle: 0, reversed: false }, count: count as u32 });
        origins
    }

    /// Appends one.
    #[inline]
    pub(crate) fn push(&mut self, first: Origin) {
        self.push_run(Run { first, count: 1 });
    }

    /// Appends kept triangles.
    pub(crate) fn push_kept(&mut self, kept: Kept) {
        self.stretches.push(Stretch::Kept(kept));
    }

    #[inline]
    fn push_run(&mut self, run: Run) {
        if run.count == 0 {
            return;
        }
        if !matches!(self.stretches.last(), Some(Stretch::Runs(_))) {
            self.stretches.push(Stretch::Runs(Vec::new()));
        }
        if let Some(Stretch::Runs(runs)) = self.stretches.last_mut() {
            match runs.last_mut() {
                Some(last) if last.is_continued_by(&run.first) => last.count += run.count,
                _ => runs.push(run),
            }
        }
    }

    /// Appends another list.
    pub(crate) fn append(&mut self, other: Self) {
        self.stretches.extend(other.stretches);
    }

    /// All, one by one.
    pub(crate) fn iter(&self) -> impl Iterator<Item = Origin> {
        self.runs().flat_map(|Run { first, count }| {
            (0..count).map(move |i| Origin { triangle: first.triangle + i, ..first })
        })
    }

    /// The origins of the origins: `sources` are those of the operands.
    pub(crate) fn compose(mut self, sources: &[&Self]) -> Self {
        // Nearly always the operands are whole: only their numbers change.
        if let Some(whole) = sources.iter().map(|source| source.whole_operand()).collect::<Option<Vec<u32>>>()
        {
            for stretch in &mut self.stretches {
                let renumber = |origin: &mut Origin| origin.operand = whole[origin.operand as usize];
                match stretch {
                    Stretch::Kept(kept) => renumber(&mut kept.first),
                    Stretch::Runs(runs) => runs.iter_mut().for_each(|run| renumber(&mut run.first)),
                }
            }
            return self;
        }
        let sources: Vec<Sequence> = sources.iter().map(|source| Sequence::new(source)).collect();
        let mut result = Self::default();
        for Run { first, count } in self.runs() {
            sources[first.operand as usize].for_runs(first.triangle, count, |mut run| {
                run.first.reversed ^= first.reversed;
                result.push_run(run);
            });
        }
        result
    }

    /// The operand, if these are its first triangles.
    fn whole_operand(&self) -> Option<u32> {
        let [Stretch::Runs(runs)] = self.stretches.as_slice() else { return None };
        let [run] = runs.as_slice() else { return None };
        (run.first.triangle == 0 && !run.first.reversed).then_some(run.first.operand)
    }

    /// Consecutive triangles of one operand: the first, how many, and whether they are known to be those triangles, with
    /// vertices at the same places.
    pub(crate) fn stretches(&self) -> impl Iterator<Item = (Origin, u32, bool)> {
        self.stretches.iter().flat_map(|stretch| {
            let (kept, runs) = match stretch {
                Stretch::Kept(kept) => (Some(kept.runs().map(|run| (run.first, run.count, true))), [].iter()),
                Stretch::Runs(runs) => (None, runs.iter()),
            };
            kept.into_iter().flatten().chain(runs.map(|run| (run.first, run.count, false)))
        })
    }

    /// Consecutive triangles of one operand that are not known to be those triangles, with vertices at the same places: the number of the first
    /// in this list, its origin, and how many.
    pub(crate) fn not_known_whole(&self) -> impl Iterator<Item = (u32, Origin, u32)> {
        let mut next = 0;
        self.stretches.iter().flat_map(move |stretch| {
            let runs = match stretch {
                Stretch::Kept(kept) => {
                    next += kept.count() as u32;
                    [].iter()
                }
                Stretch::Runs(runs) => runs.iter(),
            };
            let mut first = next;
            next += runs.clone().map(|run| run.count).sum::<u32>();
            runs.map(move |run| {
                first += run.count;
                (first - run.count, run.first, run.count)
            })
        })
    }

    /// How many triangles of one operand follow each other, over and over.
    pub(crate) fn operands(&self) -> Vec<(u32, usize)> {
        let mut counts: Vec<(u32, usize)> = Vec::new();
        let mut add = |operand: u32, count: usize| match counts.last_mut() {
            Some(last) if last.0 == operand => last.1 += count,
            _ => counts.push((operand, count)),
        };
        for stretch in &self.stretches {
            match stretch {
                Stretch::Kept(kept) => add(kept.first.operand, kept.count()),
                Stretch::Runs(runs) => runs.iter().for_each(|run| add(run.first.operand, run.count as usize)),
            }
        }
        counts.retain(|&(_, count)| count > 0);
        counts
    }

    fn runs(&self) -> impl Iterator<Item = Run> {
        self.stretches.iter().flat_map(|stretch| {
            let (kept, runs) = match stretch {
                Stretch::Kept(kept) => (Some(kept.runs()), [].iter()),
                Stretch::Runs(runs) => (None, runs.iter()),
            };
            kept.into_iter().flatten().chain(runs.copied())
        })
    }
}

/// Runs with the place where each starts.
pub(crate) struct Sequence(Vec<(u32, Run)>);

impl Sequence {
    pub(crate) fn new(origins: &Origins) -> Self {
        let mut next = 0;
        let start = |run: Run| {
            next += run.count;
            (next - run.count, run)
        };
        Self(origins.runs().map(start).collect())
    }

    /// One of the origins.
    pub(crate) fn at(&self, place: u32) -> Origin {
        let index = self.0.partition_point(|&(start, _)| start <= place) - 1;
        let (start, Run { first, .. }) = self.0[index];
        Origin { triangle: first.triangle + (place - start), ..first }
    }

    /// The runs of `count` origins from a place on.
    fn for_runs(&self, place: u32, count: u32, mut found: impl FnMut(Run)) {
        let end = place + count;
        let first = self.0.partition_point(|&(start, _)| start <= place) - 1;
        for &(start, run) in self.0[first..].iter().take_while(|&&(start, _)| start < end) {
            let (from, to) = (start.max(place), (start + run.count).min(end));
            let first = Origin { triangle: run.first.triangle + (from - start), ..run.first };
            found(Run { first, count: to - from });
        }
    }
}

impl FromIterator<Origin> for Origins {
    fn from_iter<T: IntoIterator<Item = Origin>>(origins: T) -> Self {
        let mut result = Self::default();
        origins.into_iter().for_each(|origin| result.push(origin));
        result
    }
}

/// Whether a triangle has the corners of another in their order, or in the other one if it is turned round.
pub(in crate::boolean) fn is_as_given(own: [[f64; 3]; 3], [a, b, c]: [[f64; 3]; 3], reversed: bool) -> bool {
    let given = if reversed { [a, c, b] } else { [a, b, c] };
    (0..3).any(|turn| (0..3).all(|k| own[k] == given[(turn + k) % 3]))
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
        for round in 0..100 {
            let list = random(&mut rng, 2, 30);
            let runs: Origins = list.iter().copied().collect();
            assert_eq!(runs.iter().collect::<Vec<_>>(), list);
            let mut twice = runs.clone();
            twice.append(runs.clone());
            assert_eq!(twice.iter().collect::<Vec<_>>(), [&list[..], &list[..]].concat());
            let unknown = twice.not_known_whole();
            let unknown = unknown.flat_map(|(place, first, count)| {
                (0..count).map(move |i| (place + i, Origin { triangle: first.triangle + i, ..first }))
            });
            assert!(unknown.eq((0..).zip([&list[..], &list[..]].concat())));
            let runs_of: Vec<(u32, usize)> =
                list.chunk_by(|x, y| x.operand == y.operand).map(|run| (run[0].operand, run.len())).collect();
            assert_eq!(runs.operands(), runs_of);

            let whole = |operand| Origins::of_operand(operand, 30);
            let sources: [Origins; 2] = if round % 2 == 0 {
                [0, 1].map(|_| random(&mut rng, 9, 1_000).into_iter().collect())
            } else {
                [whole(7), whole(5)]
            };
            let lists = sources.each_ref().map(|source| source.iter().collect::<Vec<_>>());
            let expected: Vec<Origin> = list
                .iter()
                .map(|origin| {
                    let source = lists[origin.operand as usize][origin.triangle as usize];
                    Origin { reversed: source.reversed != origin.reversed, ..source }
                })
                .collect();
            let through = runs.compose(&sources.each_ref());
            assert_eq!(through.iter().collect::<Vec<_>>(), expected);
        }
    }

    #[test]
    fn kept_triangles_are_a_list_like_others() {
        let mut rng = ChaCha8Rng::seed_from_u64(22);
        for count in [0, 1, 63, 64, 65, 128, 1_000] {
            for share in [0.0, 0.3, 0.9, 1.0] {
                let first = Origin { operand: 1, triangle: 17, reversed: rng.random() };
                let (mut kept, mut list) = (Kept::none(first, count), Vec::new());
                for place in (0..count).filter(|_| rng.random_bool(share)).collect::<Vec<_>>() {
                    kept.bits_mut()[place / 64] |= 1 << (place % 64);
                    list.push(Origin { triangle: 17 + place as u32, ..first });
                }
                let mut origins = Origins::default();
                origins.push_kept(kept);
                let more = Origin { operand: 0, triangle: 3, reversed: false };
                origins.push(more);
                list.push(more);
                assert_eq!(origins.iter().collect::<Vec<_>>(), list, "{share} of {count}");
                let known = list.len() as u32 - 1;
                assert!(origins.not_known_whole().eq([(known, more, 1)]));
                let each = origins.operands().into_iter().flat_map(|(operand, count)| vec![operand; count]);
                assert!(each.eq(list.iter().map(|origin| origin.operand)));

                let whole = [7, 5].map(|operand| Origins::of_operand(operand, 2_000));
                let renumbered = origins.clone().compose(&whole.each_ref());
                let expected =
                    list.iter().map(|origin| Origin { operand: [7, 5][origin.operand as usize], ..*origin });
                assert!(renumbered.iter().eq(expected));
                let places: Vec<Origin> = (0..list.len() as u32)
                    .filter(|_| rng.random_bool(0.5))
                    .map(|triangle| Origin { operand: 0, triangle, reversed: true })
                    .collect();
                let through = places.iter().copied().collect::<Origins>().compose(&[&origins, &whole[1]]);
                let turned = |origin: &Origin| {
                    let source = list[origin.triangle as usize];
                    Origin { reversed: !source.reversed, ..source }
                };
                assert!(through.iter().eq(places.iter().map(turned)));
            }
        }
    }
}
