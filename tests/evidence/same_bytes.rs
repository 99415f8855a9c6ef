//! The same command gives the same bytes: on any number of threads, and when repeated.

use std::path::PathBuf;

use super::models::fixtures;
use super::program::{Folder, Ran, bytes};

/// Every format, as text and binary.
const OUTPUTS: [&str; 7] = ["r.obj", "r.glb", "r.gltf", "r.stl", "r.ply", "r.off", "r.png"];

fn run(folder: &Folder, verb: &str, inputs: &[PathBuf], more: &[&str]) -> Ran {
    let mut arguments: Vec<String> = vec![verb.into()];
    arguments.extend(inputs.iter().map(|path| path.to_string_lossy().into_owned()));
    arguments.extend(more.iter().map(ToString::to_string));
    folder.run_args(&arguments).exits(0)
}

/// Runs on 1, 2 and 8 threads and once more, and compares all outputs with the first's.
fn assert_same(verb: &str, inputs: &[PathBuf], more: &[&str]) {
    let mut first: Option<Vec<Vec<u8>>> = None;
    for threads in ["1", "2", "8", "8"] {
        let folder = Folder::new();
        let outputs = OUTPUTS.iter().flat_map(|name| ["-o", name]);
        let rest: Vec<&str> = more
            .iter()
            .copied()
            .chain(outputs)
            .chain(["--threads", threads, "--png-size", "200x150"])
            .collect();
        run(&folder, verb, inputs, &rest);
        let all: Vec<Vec<u8>> = OUTPUTS.iter().map(|name| bytes(&folder.path(name))).collect();
        assert!(all.iter().all(|bytes| bytes.len() > 80), "{verb}: an output is empty");
        match &first {
            None => first = Some(all),
            Some(first) => {
                for (name, (one, other)) in OUTPUTS.iter().zip(first.iter().zip(&all)) {
                    assert!(one == other, "{verb}: {name} differs on {threads} threads");
                }
            }
        }
    }
}

#[test]
fn every_operation_and_format_on_any_number_of_threads() {
    let models = |names: [&str; 2]| names.map(|name| fixtures("solids").join(name));
    for verb in ["union", "intersection", "difference", "xor"] {
        assert_same(verb, &models(["elephant.off", "sphere.off"]), &[]);
        // Everything touches: every decision is the perturbation's.
        assert_same(verb, &models(["plate_holes.stl", "plate_holes.stl"]), &["--translate", "25,0,0"]);
    }
    let three = ["ballA.off", "ballB.off", "couplingdown.off"].map(|name| fixtures("solids").join(name));
    assert_same("union", &three, &["--scale", "20", "--ascii"]);
}

#[test]
fn conversions_on_any_number_of_threads() {
    for name in ["solids/elephant.off", "models/spot.ply", "solids/plate_holes.stl", "formats/nested.glb"] {
        assert_same("convert", &[fixtures(name)], &[]);
    }
}

#[test]
fn what_is_said_of_files_does_not_depend_on_threads() {
    for verb in ["check", "info"] {
        let inputs: Vec<PathBuf> =
            ["solids/elephant.off", "solids/plate_holes.stl", "solids/stairs.obj"].map(fixtures).into();
        let said = |threads: &str| {
            let ran = run(&Folder::new(), verb, &inputs, &["--threads", threads, "--json"]);
            let mut object = ran.json();
            object.as_object_mut().expect("an object").remove("seconds");
            object["files"].as_array_mut().expect("a list").iter_mut().for_each(|file| {
                file.as_object_mut().expect("an object").remove("seconds");
            });
            object
        };
        let one = said("1");
        for threads in ["2", "8", "8"] {
            assert_eq!(said(threads), one, "{verb} on {threads} threads");
        }
    }
}
