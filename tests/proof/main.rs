//! The engine against judges that share nothing with it: exact volumes and areas of degenerate contacts, lattice solids
//! counted cell by cell, an exact oracle at points, another engine's answers, models made by others, long chains.
//!
//! Most tests take a sample of what they could try; `TRISECT_PROOF=4` tries four times as much, `TRISECT_PROOF=all` all.
//! What fails is named, and saved as OBJ files in the folder `TRISECT_PROOF_SAVE` if that is set. See `docs/proof.md`.

mod arrangement;
mod battery;
mod chains;
#[path = "../common/mod.rs"]
mod common;
mod contacts;
#[allow(dead_code, reason = "shared with the driver of the live comparison")]
mod judge;
mod live;
mod minimiser;
mod models;
mod named;
mod properties;
mod recorded;
mod regressions;
mod same_bits;
mod scales;
mod snapping;
mod trial;
mod turned;
