//! Cuts: planes, sections, parts, sheets, repair.

#[path = "../common/mod.rs"]
mod common;
mod models;
mod parts;
mod planes;
mod sections;
mod sheets;
