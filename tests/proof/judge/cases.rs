//! A pair of solids and an operation from a seed.

use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};
use trisect::{Mesh, Operation};

use super::placement::{anywhere, mapped, moved, normalized, rotated, rotation, turned_on_grid};
use super::shapes;

/// How a pair is placed, hence what may be asked of an engine that decides with rounding.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Family {
    /// Small integers: contacts are common, and exact.
    Grid,
    /// General position.
    Generic,
    /// A grid pair scaled, turned or nudged: contacts are off by rounding, or by 1e-3 down to 1e-17.
    Near,
    /// General position, far from the origin: coordinates of a million, sizes of one.
    Far,
    /// Models made by others, turned at random.
    Models,
    /// Sizes apart by 1 to 1e300: half-spaces as people write them, and corners of huge bodies.
    Apart,
    /// A million times as long as wide.
    Needle,
    /// Thin sheets.
    Flat,
    /// Turned, and rounded to single precision.
    Single,
    /// Coordinates of 1e12.
    Far12,
    /// The result of cuts with turns in between.
    Chain,
    /// The same, written and read in between.
    Files,
    /// Two operands, each of bodies that overlap and touch.
    Bodies,
    /// Three to eight operands.
    Several,
    /// Two to five operands, each of bodies that overlap and touch.
    Mixed,
}

/// The seeds from here on are those of [`hard`](super::hard) pairs.
pub(crate) const HARD_FROM: u64 = 1 << 32;

impl Family {
    pub(crate) const ALL: [Self; 15] = [
        Self::Grid,
        Self::Generic,
        Self::Near,
        Self::Far,
        Self::Models,
        Self::Apart,
        Self::Needle,
        Self::Flat,
        Self::Single,
        Self::Far12,
        Self::Chain,
        Self::Files,
        Self::Bodies,
        Self::Several,
        Self::Mixed,
    ];
}

pub(crate) const OPERATIONS: [Operation; 4] =
    [Operation::Union, Operation::Intersection, Operation::Difference, Operation::SymmetricDifference];

#[derive(Clone, Debug)]
pub(crate) struct Case {
    pub(crate) family: Family,
    pub(crate) operation: Operation,
    pub(crate) a: Mesh,
    pub(crate) b: Mesh,
}

impl Case {
    /// The case of a seed. `models` are solids to draw from.
    pub(crate) fn new(seed: u64, models: &[Mesh]) -> Self {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let random = &mut random;
        let operation = OPERATIONS[random.random_range(0..4)];
        if seed >= HARD_FROM {
            let (family, a, b) = super::hard::pair(random);
            return Self { family, operation, a, b };
        }
        let family = match random.random_range(0..100) {
            0..40 => Family::Grid,
            40..68 => Family::Generic,
            68..90 => Family::Near,
            90..95 => Family::Far,
            _ => Family::Models,
        };
        let (a, b) = match family {
            Family::Grid => grid_pair(random),
            Family::Generic => generic_pair(random),
            Family::Near => near_pair(random),
            Family::Far => {
                let (a, b) = generic_pair(random);
                let by = [500_000.0, 4_649_776.0, 120.0];
                (moved(&a, by), moved(&b, by))
            }
            _ => model_pair(random, models),
        };
        Self { family, operation, a, b }
    }
}

fn grid_pair(random: &mut ChaCha8Rng) -> (Mesh, Mesh) {
    let a = shapes::on_grid(random);
    // Now and then the same again, or the same elsewhere.
    let b = if random.random_range(0..8) == 0 { a.clone() } else { shapes::on_grid(random) };
    let step = if random.random_range(0..4) == 0 { 0.5 } else { 1.0 };
    let by = [0; 3].map(|_| step * f64::from(random.random_range(-3..4)));
    let b = if random.random() { turned_on_grid(&b, random) } else { b };
    (a, moved(&b, by))
}

fn generic_pair(random: &mut ChaCha8Rng) -> (Mesh, Mesh) {
    let a = shapes::round_or_any(random);
    let b = shapes::round_or_any(random);
    (anywhere(&a, 0.1, random), anywhere(&b, 0.8, random))
}

fn near_pair(random: &mut ChaCha8Rng) -> (Mesh, Mesh) {
    let (a, b) = match random.random_range(0..8) {
        // Round bodies against copies of themselves.
        0 => {
            let a = shapes::round_or_any(random);
            (a.clone(), a)
        }
        _ => grid_pair(random),
    };
    match random.random_range(0..4) {
        0 => {
            let factor = [0.1, 1.0 / 3.0, 1e-3, 7e5][random.random_range(0..4)];
            (mapped(&a, false, |p| p.map(|x| x * factor)), mapped(&b, false, |p| p.map(|x| x * factor)))
        }
        1 => {
            let matrix = rotation(random);
            (rotated(&a, &matrix), rotated(&b, &matrix))
        }
        2 => {
            // The whole of B moved a little.
            let by = [0; 3].map(|_| random.random_range(-1.0..1.0) * 10f64.powi(-random.random_range(3..18)));
            (a, moved(&b, by))
        }
        _ => {
            // Turned a little, about an axis of the grid.
            let angle = 10f64.powi(-random.random_range(3..18));
            (a, mapped(&b, false, |[x, y, z]| [x - angle * y, y + angle * x, z]))
        }
    }
}

fn model_pair(random: &mut ChaCha8Rng, models: &[Mesh]) -> (Mesh, Mesh) {
    if models.is_empty() {
        return generic_pair(random);
    }
    let one = |random: &mut ChaCha8Rng| normalized(&models[random.random_range(0..models.len())]);
    let a = one(random);
    let b = if random.random() { one(random) } else { shapes::round_or_any(random) };
    (anywhere(&a, 0.1, random), anywhere(&b, 1.0, random))
}

/// The solids in a folder, in the order of their names.
pub(crate) fn models(folder: &str) -> Vec<Mesh> {
    let mut paths: Vec<_> = std::fs::read_dir(folder)
        .map(|entries| entries.filter_map(|entry| Some(entry.ok()?.path())).collect())
        .unwrap_or_default();
    paths.sort();
    let solid = |path: &std::path::PathBuf| {
        let solid = trisect::Solid::try_from(Mesh::load(path).ok()?).ok()?;
        Some(solid.into_mesh())
    };
    paths.iter().filter_map(solid).collect()
}
