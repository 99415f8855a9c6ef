//! Pairs that once failed, made small by `trisect-proof minimise`: every pair in `fixtures/pairs`, all operations.

use std::path::{Path, PathBuf};

use trisect::{Mesh, Solid};

use crate::common::same_bits;
use crate::judge::cases::OPERATIONS;
use crate::judge::minimise::Pair;
use crate::judge::oracle;
use crate::trial::{Expected, Trial};

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .ancestors()
        .find(|p| p.join("fixtures").is_dir())
        .expect("fixtures")
        .join("fixtures/pairs")
}

/// Writes a pair as OBJ, as the driver does, and reads it again.
pub(crate) fn written_and_read(pair: &Pair, name: &str) -> Pair {
    let folder = std::env::temp_dir().join(format!("trisect-{}-{name}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a temporary folder");
    let paths = ["a.obj", "b.obj"].map(|file| folder.join(file));
    for (mesh, path) in pair.iter().zip(&paths) {
        mesh.save(path).expect("it can be written");
    }
    let read = paths.each_ref().map(|path| Mesh::load(path).expect("it can be read"));
    std::fs::remove_dir_all(&folder).expect("it can be removed");
    read
}

#[test]
fn pairs_that_once_failed() {
    let _bits = same_bits::group("pairs that once failed");
    let mut names: Vec<String> = std::fs::read_dir(folder())
        .expect("a folder")
        .filter_map(|entry| {
            entry.ok()?.file_name().into_string().ok()?.strip_suffix("-a.obj").map(str::to_owned)
        })
        .collect();
    names.sort();
    let mut trial = Trial::default();
    for name in &names {
        let [a, b] = ["a", "b"].map(|which| {
            let mesh = Mesh::load(folder().join(format!("{name}-{which}.obj"))).expect("it can be read");
            Solid::try_from(mesh).expect("closed")
        });
        let volume = |solid: &Solid| crate::judge::surface::volume(solid.mesh());
        let shared =
            trial.run(name, OPERATIONS[1], [&a, &b], &Expected::default()).map_or(f64::NAN, |s| volume(&s));
        for operation in OPERATIONS {
            use trisect::Operation::{Difference, Intersection, SymmetricDifference, Union};
            let (va, vb) = (volume(&a), volume(&b));
            let expected = match operation {
                Union => va + vb - shared,
                Intersection => shared,
                Difference => va - shared,
                SymmetricDifference => va + vb - 2.0 * shared,
                other => unreachable!("nothing is expected of {other}"),
            };
            let expected = Expected { volume: Some(expected), tolerance: 1e-12, ..Expected::default() };
            let Some(result) = trial.run(name, operation, [&a, &b], &expected) else { continue };
            let verdict = oracle::judge(operation, &[a.mesh(), b.mesh()], result.mesh(), 500, 3);
            assert!(verdict.mistakes.is_empty(), "{name} {operation:?}: {:?}", verdict.mistakes[0]);
        }
    }
    trial.finish(5 * names.len());
}
