//! The program from outside.

#![cfg(feature = "cli")]

#[path = "../common/mod.rs"]
mod common;

mod attributes;
#[cfg(feature = "subdivision")]
mod cages;
mod curve;
mod cuts;
mod engine;
mod eval;
mod kept;
mod making;
mod operations;
#[cfg(feature = "threemf")]
mod packages;
#[cfg(feature = "viewer")]
mod pages;
mod parts;
mod repairs;
mod stranger;
mod streams;
mod written;
