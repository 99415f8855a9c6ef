//! The same bits from version to version, where no other test of the proof runs the operations. See `common/same_bits.rs`.

use std::path::{Path, PathBuf};

use rand::SeedableRng;
use rand::rngs::ChaCha8Rng;
#[cfg(feature = "parametric")]
use trisect::model::{Evaluation, Model};
use trisect::{BooleanOptions, Contact, Mesh, Solid};

use crate::common::same_bits;
use crate::judge::cases::{Case, OPERATIONS, models};
use crate::judge::placement::{anywhere, normalized};

fn root(folder: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(folder)
}

/// Every file in a folder and the folders inside it, in the order of their names.
fn files(folder: &Path) -> Vec<PathBuf> {
    let mut entries: Vec<PathBuf> =
        std::fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").path()).collect();
    entries.sort();
    entries.into_iter().flat_map(|path| if path.is_dir() { files(&path) } else { vec![path] }).collect()
}

/// What cannot be read is no mesh: a fault is noted as the empty mesh.
fn read(format: &str, name: &'static str) {
    let _bits = same_bits::group(name);
    let mut count = 0;
    for path in files(&root("fixtures")) {
        if path.extension().is_some_and(|extension| extension == format) {
            same_bits::note_mesh(|| Mesh::load(&path).unwrap_or_default());
            count += 1;
        }
    }
    assert!(count > 0, "no file of the format {format}");
}

#[test]
fn files_read() {
    read("obj", "read OBJ");
    read("off", "read OFF");
    read("stl", "read STL");
    read("ply", "read PLY");
    read("glb", "read GLB");
    read("gltf", "read glTF");
}

#[test]
fn every_model_with_the_next() {
    let _bits = same_bits::group("models by others, each with the next");
    let models = [
        models(root("fixtures/solids").to_str().expect("a path")),
        models(root("fixtures/models").to_str().expect("a path")),
    ]
    .concat();
    let mut random = ChaCha8Rng::seed_from_u64(13);
    for (index, a) in models.iter().enumerate() {
        let b = anywhere(&normalized(&models[(index + 1) % models.len()]), 0.5, &mut random);
        let [a, b] = [normalized(a), b].map(|mesh| Solid::try_from(mesh).expect("closed"));
        for operation in OPERATIONS {
            same_bits::run(operation, &[&a, &b]);
        }
    }
}

#[cfg(feature = "parametric")]
#[test]
fn model_files_evaluated_exactly() {
    let _bits = same_bits::group("model files");
    for path in files(&root("examples/models")) {
        let text = std::fs::read_to_string(&path).expect("a model");
        // Trees of fields have no booleans of meshes; their extraction is in the tests of models.
        if path.to_string_lossy().ends_with("-exact.json") {
            let model = Model::parse(&text, &root("examples/models")).expect("a model");
            same_bits::note_mesh(|| Evaluation::new().tolerance(0.05).run(&model).expect("a mesh").mesh);
        }
    }
    for operation in ["union", "intersection", "difference", "xor"] {
        let text = format!(
            r#"{{"kind": "{operation}", "evaluate": "exact", "operands": [
                {{"kind": "box", "size": [2, 1.5, 1]}},
                {{"kind": "sphere", "radius": 0.7, "center": [0.9, 0.6, 0.4]}},
                {{"kind": "cylinder", "radius": 0.3, "height": 3, "transform": [{{"rotate": {{"axis": [1, 0.3, 0], "angle": 37}}}}]}}
            ]}}"#
        );
        let model = Model::parse(&text, Path::new(".")).expect("a model");
        same_bits::note_mesh(|| Evaluation::new().tolerance(0.01).run(&model).expect("a mesh").mesh);
    }
}

#[test]
fn random_cases_with_other_options() {
    let _bits = same_bits::group("random cases with other options");
    let models = models(root("fixtures/solids").to_str().expect("a path"));
    for seed in 1_000_000..1_000_200 {
        let case = Case::new(seed, &models);
        let [a, b] = [&case.a, &case.b].map(|mesh| Solid::try_from(mesh.clone()).expect("closed"));
        for options in
            [BooleanOptions::new().remove_vertices(false), BooleanOptions::new().contact(Contact::Separate)]
        {
            same_bits::run_with(&options, case.operation, &[&a, &b]);
        }
    }
}
