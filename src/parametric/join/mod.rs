//! Two curves replaced by one (conjugation).

mod conjugation;
mod constraints;
mod metric;
mod report;

pub use conjugation::{CurveJoin, JoinInput, Joined, JoinedSpline, JointAt};
pub use metric::JoinMetric;
pub use report::{ConstraintReport, JoinReport};
