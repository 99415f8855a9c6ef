//! The library by capabilities: solids, limits, fields, models, parametric geometry. One program, since each links the crate anew.

#[path = "../common/mod.rs"]
mod common;

mod conjugation;
mod contours;
mod curves;
mod distance;
mod extraction;
mod grids;
mod hostile_text;
mod limits;
mod mending;
mod models;
mod models_exact;
mod models_parametric;
mod parametric_files;
mod patches;
mod regions;
mod repeated;
mod rfunctions;
mod solids;
