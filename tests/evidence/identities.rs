//! Random pairs of real models: what volumes must add up to, however the models lie.

use rand::{RngExt, SeedableRng, rngs::ChaCha8Rng};
use trisect::{BooleanOptions, Operation, Solid};

use super::models::{clean_models, number, placed};
use super::surface::{self, Properties};
use super::vector::extent;

/// Asserts that a result is closed and a 2-manifold, and returns its volume.
pub(crate) fn sound(solid: &Solid, context: &str) -> f64 {
    let found = Properties::of(solid.mesh());
    assert!(found.closed && found.manifold, "{context}: {found:?}");
    found.volume
}

/// How far the volumes of union, intersection and difference are from adding up, as a part of the volume of the box
/// round both operands; and the union, intersection and difference.
pub(crate) fn identities(a: &Solid, b: &Solid, context: &str) -> (f64, [Solid; 3]) {
    let results = [Operation::Union, Operation::Intersection, Operation::Difference]
        .map(|operation| BooleanOptions::new().run(operation, [a, b]).expect("no limits").into_solid());
    let names = ["union", "intersection", "difference"];
    let [union, both, rest] = [0, 1, 2].map(|i| sound(&results[i], &format!("{context}, {}", names[i])));
    let [volume_a, volume_b] = [a, b].map(|solid| surface::volume(solid.mesh()));
    let [low, high] = extent(a.mesh().positions.iter().chain(&b.mesh().positions));
    let of_box: f64 = (0..3).map(|k| high[k] - low[k]).product();
    let sum = (union + both - (volume_a + volume_b)).abs() / of_box;
    let difference = (rest - (volume_a - both)).abs() / of_box;
    (sum.max(difference), results)
}

#[test]
fn volumes_add_up_for_random_pairs_of_models() {
    let models = clean_models();
    assert!(models.len() >= 15, "only {} models", models.len());
    let (mut worst, mut meeting, mut used) = (0.0f64, 0, vec![0; models.len()]);
    let seeds = number("TRISECT_SEEDS", 40);
    for seed in 0..seeds {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        // The first models of the pairs are all models in turn.
        let pick = [seed as usize % models.len(), random.random_range(0..models.len())];
        let [a, b] = pick.map(|i| &models[i]);
        used[pick[0]] += 1;
        used[pick[1]] += 1;
        let context = format!("seed {seed}: {} and {}", a.name, b.name);
        let (a, b) = (placed(&a.solid, 0.0, &mut random), placed(&b.solid, 0.3, &mut random));
        let (off, [_, both, _]) = identities(&a, &b, &context);
        meeting += usize::from(!both.is_empty());
        assert!(off <= 1e-12, "{context}: off by {off:e} of the box");
        worst = worst.max(off);
    }
    println!(
        "{seeds} pairs of {} models, {meeting} of them meet; worst: {worst:.1e} of the box",
        models.len()
    );
    assert!(2 * meeting as u64 > seeds, "only {meeting} of {seeds} pairs meet");
}
