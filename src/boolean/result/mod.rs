//! The result: its arrays, where each triangle comes from, and what is known of it.

pub(super) mod assemble;
pub(super) mod attributes;
pub(super) mod certificate;
pub(super) mod chains;
pub(super) mod cut_faces;
pub(super) mod inverted;
pub(super) mod near_contacts;
pub(super) mod numbers;
pub(super) mod origins;
pub(super) mod outcome;
