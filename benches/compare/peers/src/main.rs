//! Engines in pure Rust beside trisect.
//!
//! - `trisect-peers pair OPERATION A B [ROUNDS]`: `union`, `intersection` or `difference` of two files by every engine, turn by turn, from
//!   arrays to arrays;
//! - `trisect-peers soups FILE.off ...`: what manifold-rust's robust engine makes of soups.
//!
//! Both print lines of JSON.

mod pairs;
mod soups;

use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    match words.split_first() {
        Some((verb, files)) if verb == "soups" => soups::run(files),
        Some((verb, rest)) if verb == "pair" => pairs::run(rest),
        _ => Err("trisect-peers pair OPERATION A B [ROUNDS], or trisect-peers soups FILE.off ...".into()),
    }
}
