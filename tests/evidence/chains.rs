//! Results as operands, again and again.

use rand::{RngExt, SeedableRng, rngs::ChaCha8Rng};
use trisect::{Control, Solid};

use super::identities::identities;
use super::models::{clean_models, number, placed};

const LENGTH: usize = 20;

#[test]
fn chains_of_twenty_keep_closed_and_right() {
    let models = clean_models();
    let (mut worst, mut tolerated, mut largest) = (0.0f64, 0, 0);
    let (mut beyond, mut deepest) = (0, 0.0f64);
    let chains = number("TRISECT_SEEDS", 16).div_ceil(8);
    for seed in 0..chains {
        let mut random = ChaCha8Rng::seed_from_u64(1000 + seed);
        let mut body = placed(&models[random.random_range(0..models.len())].solid, 0.0, &mut random);
        for step in 0..LENGTH {
            let tool = &models[random.random_range(0..models.len())];
            let context = format!("chain {seed}, step {step}, {}", tool.name);
            let tool = placed(&tool.solid, 0.5, &mut random);
            let (off, [union, both, rest]) = identities(&body, &tool, &context);
            assert!(off <= 1e-12, "{context}: off by {off:e} of the box");
            worst = worst.max(off);
            // Rarely an intersection: it would soon leave nothing.
            body = match random.random_range(0..10) {
                0..5 => rest,
                5..9 => union,
                _ if !both.is_empty() => both,
                _ => union,
            };
            if body.is_empty() {
                body = tool;
            }
            largest = largest.max(body.mesh().triangles.len());
            // The way of a file: through the gate, and with the check for self-crossings.
            body = Solid::try_from(body.into_mesh()).unwrap_or_else(|error| panic!("{context}: {error}"));
            let crossings = body.self_crossings(&Control::new()).expect("no limits");
            tolerated += crossings.tolerated;
            beyond += usize::from(!crossings.is_clean());
            for crossing in &crossings.places {
                // What rounding did, and not what the operations did.
                assert!(crossing.depth <= 1e-12, "{context}: {crossings}");
                deepest = deepest.max(crossing.depth);
            }
        }
    }
    println!(
        "{chains} chains of {LENGTH}, up to {largest} triangles; worst: {worst:.1e} of the box; {tolerated} crossings of \
         the size of rounding in {} results, and in {beyond} results deeper ones than a file may have, by {deepest:.1e} \
         at most",
        chains as usize * LENGTH
    );
}
