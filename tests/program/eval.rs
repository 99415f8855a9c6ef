//! The program's `eval`, `slice` and `grid`.

#![cfg(feature = "cli")]

use crate::common::program::{self, Folder, volume, workshop};
use serde_json::Value;

const MODEL: &str = r#"{
  "tolerance": 0.02,
  "nodes": {
    "block": "a.obj",
    "bore": { "kind": "cylinder", "radius": 0.25, "height": 4 , "transform": [{ "translate": [0.5, 0.5, 0] }] }
  },
  "result": { "kind": "difference", "operands": ["block", "bore"] }
}"#;

fn folder() -> Folder {
    let folder = workshop();
    folder.write("model.json", MODEL);
    folder.write("field.json", MODEL.replace("\"difference\",", "\"difference\", \"evaluate\": \"field\","));
    folder.write(
        "bad.json",
        MODEL.replace("\"a.obj\"", "{\"kind\": \"formula\", \"formula\": \"1 - sinn(x)\"}"),
    );
    folder.write("missing.json", MODEL.replace("a.obj", "none.obj"));
    folder
}

#[test]
fn eval_writes_meshes_pictures_and_a_report() {
    let folder = folder();
    let line = "eval model.json -o out.obj -o out.stl --png out.png --png-size 64x48 --report r.json --json";
    let ran = folder.run(line).exits(0);
    let report = ran.json();
    assert_eq!(report["verb"], "eval");
    assert_eq!(report["result"]["genus"], 1);
    assert_eq!(report["result"]["extraction"], Value::Null);
    assert_eq!(report["model"]["nodes"], serde_json::json!(["block", "bore"]));
    assert_eq!(report["outputs"].as_array().expect("outputs").len(), 3);
    let expected = 1.0 - std::f64::consts::PI / 16.0;
    assert!((volume(&folder.read("out.obj")) - expected).abs() < 0.02);
    assert!(ran.err.contains("genus 1") && ran.err.contains("out.obj"), "{ran:?}");
    assert!(program::bytes(&folder.path("out.png")).starts_with(b"\x89PNG"));
    assert!(folder.exists("r.json"));
    folder.run("check out.stl").exits(0);
}

#[test]
fn eval_extracts_fields_within_the_tolerance_asked_for() {
    let folder = folder();
    let report = folder.run("eval field.json --tolerance 0.01 -o out.obj --json").exits(0).json();
    let extraction = &report["result"]["extraction"];
    assert_eq!(extraction["tolerance"], 0.01);
    assert!(extraction["deviation"].as_f64().expect("a number") <= 0.01);
    assert_eq!(report["result"]["genus"], 1);
    let expected = 1.0 - std::f64::consts::PI / 16.0;
    assert!((volume(&folder.read("out.obj")) - expected).abs() < 0.01);
    let ran = folder.run("eval field.json -o - --output-format off").exits(0);
    assert!(ran.out.starts_with("OFF"), "{ran:?}");
    // The model from standard input; its files are where the program runs.
    folder.run_with("eval - -o piped.obj", MODEL.as_bytes()).exits(0);
    assert!(folder.exists("piped.obj"));
}

#[test]
fn surfaces_are_left_as_the_cells_have_them_where_that_is_asked_for() {
    let folder = folder();
    let count = |line: &str| {
        let report = folder.run(line).exits(0).json();
        assert_eq!(report["result"]["genus"], 1, "{line}");
        report["result"]["triangles"].as_u64().expect("a number")
    };
    let smooth = count("eval field.json --json");
    let rough = count("eval field.json --no-smooth --json");
    assert!(2 * smooth < rough, "{smooth} {rough}");
    // The model says so itself, of all of it or of a node.
    let model = folder.read("field.json");
    folder.write("rough.json", model.replacen('{', "{ \"smooth\": false, ", 1));
    assert_eq!(count("eval rough.json --json"), rough);
    folder.write("node.json", model.replace("\"evaluate\"", "\"smooth\": false, \"evaluate\""));
    assert_eq!(count("eval node.json --json"), rough);
    folder.write("odd.json", model.replacen('{', "{ \"smooth\": 1, ", 1));
    folder.run("eval odd.json --json").exits(3).says("smooth");
}

#[test]
fn eval_writes_contours() {
    let folder = folder();
    let line = "eval field.json --contours c.svg --contour-height 0.5 --json";
    let report = folder.run(line).exits(0).json();
    assert_eq!(report["contours"]["count"], 2);
    let expected = 1.0 - std::f64::consts::PI / 16.0;
    let area = report["contours"]["area"].as_f64().expect("an area");
    assert!((area - expected).abs() < 0.02, "{area}");
    assert_eq!(folder.read("c.svg").matches('M').count(), 2);
    // Polygons are a leaf of a model again.
    folder.run("eval field.json --contours c.json --contour-height 0.5").exits(0);
    let node = folder.read("c.json").trim_end().trim_end_matches('}').to_owned() + r#", "extrude": 2}"#;
    folder.write("again.json", node);
    folder.run("eval again.json -o again.obj").exits(0);
    assert!((volume(&folder.read("again.obj")) - 2.0 * area).abs() < 1e-9);
}

#[test]
fn failures_have_their_codes_and_leave_nothing() {
    let folder = folder();
    folder.write("precious.obj", "precious");
    let before = folder.names();
    let report = folder.run("eval bad.json -o precious.obj --json").exits(3).says("unknown function").json();
    assert_eq!(report["error"]["node"], "`block` (/nodes/block)");
    folder.run("eval missing.json -o out.obj").exits(2).says("none.obj");
    folder.run("eval none.json -o out.obj").exits(2).says("none.json");
    folder.run("eval model.json").exits(1).says("nowhere to put the result");
    folder.run("eval model.json -o out.xyz").exits(1);
    folder.run("eval model.json --contours out.png").exits(1).says("svg");
    folder.run("eval model.json -o out.obj --tolerance 0").exits(1);
    folder.run("eval field.json -o out.obj --tolerance 1e-4 --memory 10K").exits(4);
    folder.run("eval field.json -o out.obj --tolerance 1e-5 --timeout 0.2").exits(4);
    folder.run("slice none.stl -o out.png").exits(2);
    folder.run("slice model.json -o out.png --translate 1,0,0").exits(1);
    folder.run("slice --formula x -o out.png").exits(3).says("unbounded");
    folder.run("grid model.json --spacing 0.1 --band 1 -o out.npy").exits(1).says("--band");
    assert_eq!(folder.names(), before);
    assert_eq!(folder.read("precious.obj"), "precious");
    folder.run("eval model.json --dry-run").exits(0).says("2 named nodes");
    folder.run("eval missing.json --dry-run").exits(2);
    assert_eq!(folder.names(), before);
}

/// Width and height in a PNG file.
fn size(png: &[u8]) -> [u32; 2] {
    [16, 20].map(|at| u32::from_be_bytes(png[at..at + 4].try_into().expect("four bytes")))
}

#[test]
fn slice_draws_models_meshes_and_formulas() {
    let folder = folder();
    folder.run("slice model.json --axis y --width 60 -o m.png --bounds 0,0,0,2,1,1").exits(0);
    assert_eq!(size(&program::bytes(&folder.path("m.png"))), [60, 30]);
    let line =
        "slice a.obj --scale 2,1,1 --axis z --at 0.25 --sign winding --width 48 --bands 0.1 -o s.png --json";
    let report = folder.run(line).exits(0).json();
    assert_eq!(report["section"]["at"], 0.25);
    // The box is two wide and one high, with a fifth all round.
    assert_eq!(report["section"]["size"], serde_json::json!([48, 28]));
    let ran = folder.run("slice --formula sphere(x,y,z,1) --width 20 -o -").exits(0);
    assert_eq!(size(&ran.bytes), [20, 20]);
    folder.run("slice open.obj --sign fast-winding --width 20 -o open.png").exits(0);
}

#[test]
fn outputs_named_for_another_format_are_refused() {
    let folder = workshop();
    let before = folder.names();
    folder.run("slice a.obj -o s.svg").exits(1).says("*.png").says("--contours").says("not s.svg");
    folder.run("slice a.obj -o s").exits(1).says("*.png");
    folder.run("grid a.obj --spacing 0.5 -o g.vti").exits(1).says("*.npy or *.raw, not g.vti");
    assert_eq!(folder.names(), before);
}

#[test]
fn grids_hold_the_distance() {
    let folder = folder();
    let line = "grid a.obj --spacing 0.25 --bounds=-0.5,-0.5,-0.5,1.5,1.5,1.5 -o g.npy --json";
    let report = folder.run(line).exits(0).json();
    assert_eq!(report["grid"]["shape"], serde_json::json!([9, 9, 9]));
    let values = |name: &str| -> Vec<f32> {
        let bytes = program::bytes(&folder.path(name));
        let values = bytes[bytes.len() - 4 * 729..].chunks(4);
        values.map(|four| f32::from_le_bytes(four.try_into().expect("four bytes"))).collect()
    };
    let dense = values("g.npy");
    // The middle, a face's middle, and outside a corner.
    assert_eq!((dense[4 * 81 + 4 * 9 + 4], dense[2 * 81 + 4 * 9 + 4], dense[0]), (0.5, 0.0, -0.75f32.sqrt()));
    folder.run("grid a.obj --spacing 0.25 --bounds=-0.5,-0.5,-0.5,1.5,1.5,1.5 --band 0.3 -o g.raw").exits(0);
    for (banded, exact) in values("g.raw").iter().zip(&dense) {
        assert_eq!(*banded, exact.clamp(-0.3, 0.3));
    }
    folder.run("grid model.json --spacing 0.5 -o m.raw").exits(0);
    assert!(program::bytes(&folder.path("m.raw")).starts_with(b"trisect-grid 1 float32 little-endian"));
}

/// Two overlapping boxes, and an open one, in files.
fn unclean() -> Folder {
    let folder = folder();
    let boxes = [
        trisect::primitives::cuboid([0.0; 3], [1.0; 3]).expect("a box"),
        trisect::primitives::cuboid([0.5; 3], [1.5; 3]).expect("a box"),
    ];
    let both = trisect::Mesh::merged(&boxes).expect("small");
    both.save(folder.path("overlap.obj")).expect("written");
    let mut open = boxes[0].clone();
    open.triangles.truncate(10);
    open.save(folder.path("hole.obj")).expect("written");
    folder
}

#[test]
fn the_inside_of_unclean_meshes_is_told_by_winding_numbers() {
    let folder = unclean();
    let line = "grid overlap.obj --spacing 0.25 --bounds=0,0,0,2,2,2 -o g.raw --json --strict";
    let ran = folder.run(line).exits(0);
    assert_eq!(ran.json()["grid"]["sign"], "winding");
    let bytes = program::bytes(&folder.path("g.raw"));
    let values = bytes[bytes.len() - 4 * 729..].chunks(4);
    let values: Vec<f32> = values.map(|four| f32::from_le_bytes(four.try_into().expect("four"))).collect();
    // At (0.75, 0.75, 1.25), which only the second box holds, nearest to the wall of the first.
    assert_eq!(values[3 * 81 + 3 * 9 + 5], 0.25);
    let clean = folder.run("grid a.obj --spacing 0.5 -o a.raw --json --strict").exits(0);
    assert_eq!(clean.json()["grid"]["sign"], "pseudonormal");
    let open = folder.run("grid hole.obj --spacing 0.5 -o h.raw --json --strict").exits(5);
    assert_eq!(open.json()["grid"]["sign"], "fast-winding");
    open.says("hole.obj: it is not closed");
    folder.run("slice hole.obj -o h.png --width 40 --sign fast-winding --strict").exits(0);
}
