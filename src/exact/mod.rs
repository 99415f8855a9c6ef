//! Arithmetic that does not round.
