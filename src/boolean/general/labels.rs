//! Vectors of winding numbers, one for each operand: *labels*. Each different one is stored once.

use rustc_hash::FxHashMap;

use crate::boolean::complex::ids::LabelId;

/// The winding numbers that are not 0, by operand.
pub(crate) type Label = Box<[(u32, i32)]>;

/// All labels that occur, in the order in which they were first met.
#[derive(Debug)]
pub(crate) struct Labels {
    labels: Vec<Label>,
    numbers: FxHashMap<Label, LabelId>,
    /// Label, operand and change -> label.
    steps: FxHashMap<(LabelId, u32, i32), LabelId>,
}

impl Labels {
    /// The label of all that is outside of every operand.
    pub(crate) const OUTSIDE: LabelId = LabelId::new(0);

    pub(crate) fn new() -> Self {
        let nothing = Label::default();
        Self {
            labels: vec![nothing.clone()],
            numbers: FxHashMap::from_iter([(nothing, Self::OUTSIDE)]),
            steps: FxHashMap::default(),
        }
    }

    /// The number of a label given by its entries, in any order.
    pub(crate) fn intern(&mut self, mut entries: Vec<(u32, i32)>) -> LabelId {
        entries.sort_unstable();
        entries.retain(|&(_, winding)| winding != 0);
        let label = entries.into_boxed_slice();
        let next = LabelId::new(self.labels.len() as u32);
        *self.numbers.entry(label).or_insert_with_key(|label| {
            self.labels.push(label.clone());
            next
        })
    }

    /// The label with the winding number of one operand changed.
    #[inline]
    pub(crate) fn step(&mut self, from: LabelId, operand: u32, change: i32) -> LabelId {
        if let Some(&known) = self.steps.get(&(from, operand, change)) {
            return known;
        }
        let mut entries = self.labels[from.index()].to_vec();
        match entries.iter_mut().find(|entry| entry.0 == operand) {
            Some(entry) => entry.1 += change,
            None => entries.push((operand, change)),
        }
        let to = self.intern(entries);
        self.steps.insert((from, operand, change), to);
        self.steps.insert((to, operand, -change), from);
        to
    }

    /// All labels by number.
    pub(crate) fn all(&self) -> &[Label] {
        &self.labels
    }
}

/// The winding number of an operand in a label.
pub(crate) fn winding(label: &[(u32, i32)], operand: u32) -> i32 {
    label.iter().find(|entry| entry.0 == operand).map_or(0, |entry| entry.1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_same_vector_has_the_same_number() {
        let mut labels = Labels::new();
        let a = labels.step(Labels::OUTSIDE, 7, 2);
        let b = labels.step(a, 3, -1);
        assert_eq!(labels.intern(vec![(7, 2), (5, 0), (3, -1)]), b);
        assert_eq!(labels.step(b, 3, 1), a);
        assert_eq!(labels.step(a, 7, -2), Labels::OUTSIDE);
        assert_eq!(winding(&labels.all()[b.index()], 7), 2);
        assert_eq!(winding(&labels.all()[b.index()], 6), 0);
    }
}
