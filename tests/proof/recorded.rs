//! What manifold3d finds of the first few thousand random cases, as `compare.py record` wrote it. See `docs/proof.md`.

use trisect::Solid;

use crate::common::same_bits;
use crate::judge::cases::{Case, Family, models};
use crate::judge::surface::{Properties, volume};
use crate::judge::vector::extent;
use crate::trial::one_in;

/// Relative to the box round the operands, as in `compare.py`.
const EQUAL: f64 = 1e-9;

#[test]
fn results_of_manifold3d() {
    let _bits = same_bits::group("recorded cases");
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR"))
        .ancestors()
        .find(|folder| folder.join("fixtures/manifold3d.txt").is_file())
        .expect("fixtures");
    let text = std::fs::read_to_string(root.join("fixtures/manifold3d.txt")).expect("a file");
    let models = models(root.join("fixtures/solids").to_str().expect("a path"));
    let mut failures = Vec::new();
    let mut compared = 0;
    for line in text.lines().filter(|line| !line.starts_with('#')).step_by(one_in(1)) {
        let words: Vec<&str> = line.split(' ').collect();
        let &[seed, of_a, of_b, of_result, area, euler, components] = words.as_slice() else {
            panic!("not a record: {line}");
        };
        let number = |word: &str| word.parse::<f64>().expect("a number");
        let case = Case::new(seed.parse().expect("a seed"), &models);
        for (mesh, recorded) in [(&case.a, of_a), (&case.b, of_b)] {
            let (found, recorded) = (volume(mesh), number(recorded));
            assert!(
                (found - recorded).abs() <= 1e-4 * recorded.abs(),
                "seed {seed} makes other operands than when this was recorded ({found}, not {recorded}): record again"
            );
        }
        let solids = [&case.a, &case.b].map(|mesh| Solid::try_from(mesh.clone()).expect("closed"));
        let outcome = same_bits::run(case.operation, &[&solids[0], &solids[1]]);
        let found = Properties::of(outcome.solid().mesh());
        let [low, high] = extent(case.a.positions.iter().chain(&case.b.positions));
        let [x, y, z] = [0, 1, 2].map(|k| high[k] - low[k]);
        let mut compare = |name: &str, found: f64, recorded: &str, tolerance: f64| {
            // "-": manifold3d is wrong there, or connects what touches, or rounding decides; see `compare.py`.
            if recorded != "-" {
                compared += 1;
                if (found - number(recorded)).abs() > tolerance {
                    failures.push(format!(
                        "seed {seed} {:?} {:?}: {name} {found}, not {recorded}",
                        case.family, case.operation
                    ));
                }
            }
        };
        // Far from the origin, and where they are off by rounding, operands are known to fewer digits.
        let equal = if case.family == Family::Far { 1e-8 } else { 2.0 * EQUAL };
        compare("volume", found.volume, of_result, equal * x * y * z);
        compare("area", found.area, area, equal * 2.0 * (x * y + y * z + z * x));
        compare("Euler characteristic", found.euler as f64, euler, 0.0);
        compare("components", found.components as f64, components, 0.0);
    }
    // Its operands are results themselves: faces in one slanted plane are so but for the rounding of their corners, and
    // films stay between them. manifold3d closes them. See `docs/proof.md`.
    let known = "seed 2914 Grid SymmetricDifference";
    let others = failures.iter().filter(|failure| !failure.starts_with(known)).count();
    assert_eq!(failures.len() - others, 1, "{known} is right now: take it off the list");
    failures.retain(|failure| !failure.starts_with(known));
    failures.truncate(12);
    assert!(failures.is_empty(), "{failures:#?}");
    assert!(compared > 8_000, "only {compared} compared");
}
