//! A value that one function leaves for another to take.

use std::sync::{Mutex, PoisonError};

/// Something too large to be kept, which whoever asks first takes away. A copy of its holder has nothing.
#[derive(Debug)]
pub(crate) struct Handover<T>(Mutex<Option<T>>);

impl<T> Handover<T> {
    /// Leaves a value, in place of an earlier one.
    pub(crate) fn leave(&self, value: T) {
        *self.0.lock().unwrap_or_else(PoisonError::into_inner) = Some(value);
    }

    /// Takes what was left.
    pub(crate) fn take(&self) -> Option<T> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).take()
    }
}

impl<T> Default for Handover<T> {
    fn default() -> Self {
        Self(Mutex::new(None))
    }
}

impl<T> Clone for Handover<T> {
    fn clone(&self) -> Self {
        Self::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_is_taken_once() {
        let handover = Handover::default();
        handover.leave(1);
        handover.leave(2);
        assert_eq!(handover.clone().take(), None);
        assert_eq!((handover.take(), handover.take()), (Some(2), None));
    }
}
