//! Cuts: planes, sections, parts, sheets, repair.

#![cfg(feature = "formats")]

#[path = "../common/mod.rs"]
mod common;
mod models;
#[cfg(feature = "model")]
mod nodes;
mod partitions;
mod parts;
mod planes;
mod sections;
mod sheets;
mod soups;
