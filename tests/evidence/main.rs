//! What the project promises of real models, shown on real models: files of others with recorded answers, identities of
//! volumes, chains, refusals, bytes.
//!
//! The tests take the models in `fixtures/`. More of the same can be asked for by the environment:
//!
//! - `TRISECT_MODELS=FOLDER`: the models in a folder and the folders inside it, in place of those in `fixtures/`;
//! - `TRISECT_EXPECTATIONS=FILE`: recorded answers of booleans of these models, in place of `fixtures/expectations.json`;
//! - `TRISECT_SEEDS=NUMBER`: how many random pairs and chains.
//!
//! With `-- --nocapture` each prints a table of what it found. `docs/evidence.md` has the tables of a long run.

mod chains;
mod expectations;
mod identities;
mod known_shapes;
mod models;
#[cfg(feature = "cli")]
mod same_bytes;
mod smoke;
#[path = "../proof/judge/surface.rs"]
#[allow(dead_code, reason = "shared with the proof")]
mod surface;
#[path = "../proof/judge/vector.rs"]
#[allow(dead_code, reason = "shared with the proof")]
mod vector;

#[cfg(feature = "cli")]
mod answers;
#[cfg(feature = "cli")]
#[path = "../common/program.rs"]
mod program;
