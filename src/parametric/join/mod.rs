//! Two curves replaced by one (conjugation).

mod conjugation;
mod constraints;
mod report;

pub use conjugation::{CurveJoin, JoinMetric, Joined, JoinedSpline, JointAt, Operand};
pub use report::{ConstraintReport, JoinReport};
