//! What of a net has changed since it was last looked at.
//!
//! Every step of smoothing goes over the whole net many times, and finds next to nothing the later times: what is as it was when a step left
//! it alone, that step leaves alone again.

/// What vertices and the edges at them are looked at for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Task {
    /// A better place for the vertex.
    Move = 1,
    /// Edges that are better turned.
    Flip = 2,
    /// Edges that the surface does without.
    Collapse = 4,
    /// Edges that bridge a crease.
    Sharpen = 8,
    /// Triangles that face another way than the field, or are too far from it.
    Divide = 16,
    /// Triangles that are too far from the field in the end.
    Check = 32,
}

/// For every vertex the tasks for which something around it is new: one bit for each.
#[derive(Clone, Debug, Default)]
pub(super) struct Stirred(Vec<u8>);

impl Stirred {
    /// Nothing was looked at.
    pub(super) fn all(count: usize) -> Self {
        Self(vec![u8::MAX; count])
    }

    /// As it is in `other`, for the vertices with these numbers there.
    pub(super) fn of(other: &Self, numbers: &[u32]) -> Self {
        Self(numbers.iter().map(|&number| other.0[number as usize]).collect())
    }

    pub(super) fn for_task(&self, vertex: u32, task: Task) -> bool {
        self.0[vertex as usize] & task as u8 != 0
    }

    /// Notes a change around a vertex.
    pub(super) fn stir(&mut self, vertex: u32) {
        self.0[vertex as usize] = u8::MAX;
    }

    /// Notes that a vertex was looked at.
    pub(super) fn settle(&mut self, vertex: u32, task: Task) {
        self.0[vertex as usize] &= !(task as u8);
    }

    /// Notes that all vertices are looked at.
    pub(super) fn settle_all(&mut self, task: Task) {
        self.0.iter_mut().for_each(|bits| *bits &= !(task as u8));
    }

    /// Adds a vertex, with what is known of `number` in `other`; nothing is of a new one.
    pub(super) fn push(&mut self, known: Option<(&Self, u32)>) {
        self.0.push(known.map_or(u8::MAX, |(other, number)| other.0[number as usize]));
    }

    pub(super) fn truncate(&mut self, count: usize) {
        self.0.truncate(count);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_task_is_done_until_something_stirs() {
        let mut stirred = Stirred::all(3);
        stirred.settle_all(Task::Flip);
        stirred.settle(1, Task::Move);
        assert!(!stirred.for_task(0, Task::Flip) && stirred.for_task(0, Task::Collapse));
        assert!(!stirred.for_task(1, Task::Move) && stirred.for_task(2, Task::Move));
        stirred.push(None);
        stirred.push(Some((&stirred.clone(), 1)));
        assert!(stirred.for_task(3, Task::Flip) && !stirred.for_task(4, Task::Move));
        stirred.stir(1);
        assert!(stirred.for_task(1, Task::Flip) && stirred.for_task(1, Task::Move));
        assert!(!Stirred::of(&stirred, &[4]).for_task(0, Task::Move));
    }
}
