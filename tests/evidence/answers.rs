//! Damaged, open and odd files through the program: the right answer, no panic, nothing left behind.

use std::path::{Path, PathBuf};

use super::models::{files, fixtures, model_folder};
use super::program::{Folder, Ran, cube};

/// What the program must say of a file as an operand: the exit code and a part of the message.
struct Answer(&'static str, i32, &'static str);

/// Files that cannot be read, open ones, odd ones; and what lets an odd one pass.
const ANSWERS: [Answer; 26] = [
    Answer("malformed.obj", 2, "line 28"),
    Answer("issue-140-zero-face-idx.obj", 2, "line 16"),
    Answer("invalid.off", 2, "line 7"),
    Answer("invalid-buffer-view-index.gltf", 2, "/bufferViews/0"),
    #[cfg(feature = "draco")]
    Answer("nested-draco.glb", 0, ""),
    #[cfg(not(feature = "draco"))]
    Answer("nested-draco.glb", 2, "KHR_draco_mesh_compression"),
    Answer("nested-meshopt.glb", 2, "EXT_meshopt_compression"),
    Answer("open_cube.off", 3, "4 open edges"),
    Answer("blob.off", 3, "4 open edges"),
    Answer("moebius.obj", 3, "112 open edges"),
    Answer("angle_block.stl", 0, "\"seams\":{\"count\":46"),
    Answer("elephant-with-holes.off", 3, "1353 open edges"),
    Answer("ChineseDragon-10kv.off", 3, "6 open edges"),
    Answer("stanford-bunny.obj", 3, "223 open edges"),
    Answer("wallhole.obj", 0, "00.mtl"),
    Answer("spheres_intersecting.off", 0, "resolved by winding number"),
    Answer("three_cubes.stl", 0, "resolved by winding number"),
    Answer("beam-inside-out.off", 3, "inside out"),
    Answer("negative_indices.obj", 0, ""),
    Answer("comments.off", 0, ""),
    Answer("nancolor.obj", 0, "not a number"),
    Answer("two_objects_mixed_case_names.stl", 0, ""),
    Answer("capsule.obj", 0, ""),
    Answer("cube-vertex-w-component.obj", 0, "weight"),
    Answer("issue-295-trianguation-failure.obj", 0, ""),
    Answer("cube_binary_header_with_RN_newline.ply", 0, ""),
    Answer("box_without_lineending.obj", 0, ""),
];

/// The files to try: all of the formats' and the open ones, or those of the folders of all models.
fn candidates() -> Vec<PathBuf> {
    let folders: Vec<PathBuf> = match model_folder() {
        Some(folder) => ["bad", "open", "odd", "selfint", "nonmanifold"].map(|name| folder.join(name)).into(),
        None => ["formats", "open"].map(fixtures).into(),
    };
    let is_mesh = |path: &PathBuf| {
        let extension = path.extension().unwrap_or_default();
        ["obj", "off", "stl", "ply", "glb", "gltf"].iter().any(|known| extension == *known)
    };
    folders.iter().flat_map(|folder| files(folder)).filter(is_mesh).collect()
}

fn united_with_a_cube(folder: &Folder, path: &Path, more: &[&str]) -> Ran {
    let path = path.to_string_lossy();
    let mut arguments = vec!["union", "cube.off", &path, "-o", "old.obj", "-o", "new.glb", "--json"];
    arguments.extend(more);
    folder.run_args(&arguments)
}

#[test]
fn every_file_gets_the_right_answer_and_leaves_nothing_behind() {
    let (mut known, mut rows) = (0, Vec::new());
    for path in candidates() {
        let name = path.file_name().expect("a name").to_string_lossy().into_owned();
        let folder = Folder::new();
        folder.write("cube.obj", cube([1e4; 3], [1e4 + 1.0; 3]));
        folder.run("convert cube.obj cube.off").exits(0);
        folder.write("old.obj", "precious");
        let before = folder.names();
        let ran = united_with_a_cube(&folder, &path, &[]);
        let said = format!("{}{}", ran.err, ran.out);
        let answer = ANSWERS.iter().find(|answer| answer.0 == name);
        if let Some(Answer(_, code, words)) = answer {
            known += 1;
            assert_eq!(ran.code, *code, "{name}: {} {}", ran.code, ran.err);
            assert!(said.contains(words), "{name}: {} {}", ran.code, ran.err);
        }
        assert!([0, 2, 3].contains(&ran.code), "{name}: {} {}", ran.code, ran.err);
        let object = ran.json();
        if ran.code == 0 {
            let result = &object["result"];
            assert_eq!(
                (&result["closed"], &result["manifold"]),
                (&true.into(), &true.into()),
                "{name}: {} {}",
                ran.code,
                ran.err
            );
            // The cube lies far away, so the file's solid is what there is besides: what its surface winds around.
            let operand = &object["operands"][1];
            let crosses =
                operand["self_crossings"]["count"] != 0 || operand["self_crossings"]["touching"] != 0;
            let own = if crosses {
                let resolved = folder.run_args(&["resolve", &path.to_string_lossy(), "--json"]);
                resolved.json()["result"]["volume"].as_f64()
            } else {
                operand["volume"].as_f64()
            };
            let sum = result["volume"].as_f64();
            let (sum, own) = (sum.expect("a volume"), own.expect("a volume"));
            assert!((sum - own - 1.0).abs() <= 1e-9 * sum, "{name}: {sum} {own}");
            assert!(
                folder.read("old.obj").starts_with('#') || folder.read("old.obj").contains("v "),
                "{name}"
            );
            rows.push(format!("| {name} | 0 | {} shells, volume {own} |", result["shells"]));
        } else {
            // The message names the file; nothing is written, and nothing old is harmed.
            let message = object["error"]["message"].as_str().expect("a message");
            assert!(message.contains(&name), "{name}: {message}");
            assert_eq!(folder.names(), before, "{name}");
            assert_eq!(folder.read("old.obj"), "precious", "{name}");
            rows.push(format!("| {name} | {} | {} |", ran.code, message.replace('|', "\\|")));
        }
        // The other verbs do not stumble either, and check gives the same answer.
        for verb in ["check", "info"] {
            let other = folder.run_args(&[verb, &path.to_string_lossy(), "--json"]);
            assert!([0, 2, 3].contains(&other.code), "{name}: {} {}", other.code, other.err);
            assert!(verb == "info" || other.code == ran.code, "{name}: {} {}", other.code, other.err);
        }
    }
    println!("| file | exit code | answer |\n|---|---|---|\n{}", rows.join("\n"));
    assert!(known >= 18, "only {known} files have known answers");
}

#[test]
fn what_is_inside_out_passes_when_turned() {
    let folder = Folder::new();
    folder.write("cube.off", "OFF\n0 0 0\n");
    let ran = united_with_a_cube(&folder, &fixtures("formats/beam-inside-out.off"), &["--orient"]).exits(0);
    let volume = ran.json()["result"]["volume"].as_f64().expect("a volume");
    assert!((volume - 0.576).abs() <= 1e-14, "{volume}");
}
