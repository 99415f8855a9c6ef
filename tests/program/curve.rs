//! The program's `curve` verbs.
#![cfg(all(feature = "cli", feature = "parametric"))]

use crate::common::program::Folder;
use serde_json::Value;

fn curves() -> Folder {
    let folder = Folder::new();
    folder.write("p.json", include_str!("../../examples/parametric/p.json"));
    folder.write("q.json", include_str!("../../examples/parametric/q.json"));
    folder.write("space.json", r#"{"type": "bezier", "points": [[0, 0, 0], [1, 1, 1]]}"#);
    folder.write("nothing.json", "{}");
    folder
}

fn json(folder: &Folder, name: &str) -> Value {
    serde_json::from_str(&folder.read(name)).expect("JSON")
}

#[test]
fn join_reads_joins_reports_and_draws() {
    let folder = curves();
    let ran = folder.run("curve join p.json q.json --fix-ends -o r.json --svg r.svg --json").exits(0);
    let curve = json(&folder, "r.json");
    assert_eq!(curve["type"], "bezier");
    assert_eq!(curve["points"].as_array().expect("points").len(), 4);
    assert!(folder.read("r.svg").starts_with("<svg"));
    let report = ran.json();
    assert_eq!((&report["verb"], &report["curve"]), (&Value::from("curve join"), &curve));
    assert_eq!(report["join"]["constraints"].as_array().expect("constraints").len(), 2);
    assert_eq!(report["outputs"][1]["format"], "svg");
    assert!(ran.err.contains("joined at 0.5: integral metric "), "{ran:?}");
    // The ends are those of the curves.
    let ends = [&json(&folder, "p.json")["points"][0], &json(&folder, "q.json")["points"][3]];
    for (k, end) in ends.into_iter().enumerate() {
        for axis in 0..2 {
            let off = curve["points"][3 * k][axis].as_f64().expect("x") - end[axis].as_f64().expect("x");
            assert!(off.abs() < 1e-12, "{off}");
        }
    }
    let line = "curve join p.json q.json --metric discrete --keep first --keep-at first:0.5:1 --joint lengths --degree 5 -o -";
    let ran = folder.run(line).exits(0);
    assert_eq!(ran.json()["points"].as_array().expect("points").len(), 6);
    assert!(ran.err.contains("derivative 1 of P at 0.5 follows from P kept whole"), "{ran:?}");
}

#[test]
fn faults_name_the_curve_and_leave_no_file() {
    let folder = curves();
    let before = folder.names();
    folder.run("curve join nothing.json q.json -o r.json").exits(2).says("operand 1 (nothing.json)");
    folder.run("curve join p.json space.json -o r.json").exits(2).says("one curve is plane");
    folder.run("curve join p.json none.json -o r.json").exits(2).says("none.json");
    folder.run("curve join p.json q.json").exits(1).says("nowhere to put the result");
    folder.run("curve join p.json q.json -o r.json --svg r.json").exits(1).says("twice");
    folder.run("curve join p.json q.json -o - --json").exits(1).says("standard output");
    for bad in ["third:0.4", "first", "first:x", "first:0.4:-1", "first:0.4:1:2"] {
        folder.run(&format!("curve join p.json q.json -o r.json --keep-at {bad}")).exits(1);
    }
    folder.run("curve join p.json q.json -o r.json --joint middle").exits(1);
    folder.run("curve mesh p.json -o r.json --tolerance 0").exits(1);
    folder.run("curve convert space.json -o r.path").exits(2).says("no SVG path");
    // Two kept points that contradict the fixed ends are told apart from ones that follow.
    folder.run("curve join p.json q.json --keep first --keep second -o r.json").exits(1);
    assert_eq!(folder.names(), before);
}

#[test]
fn curves_become_polygons_paths_and_pictures() {
    let folder = curves();
    let count = |name: &str| json(&folder, name)["points"].as_array().expect("points").len();
    folder.run("curve mesh p.json --tolerance 0.01 -o even.json").exits(0);
    folder.run("curve mesh p.json --tolerance 0.01 --halving --nodes 3 -o halved.json").exits(0);
    assert!(count("even.json") > 2 && count("halved.json") >= count("even.json"));
    folder.run("curve convert p.json -o p.path").exits(0);
    let path = folder.read("p.path");
    assert!(path.starts_with('M') && path.contains('C'), "{path}");
    folder.run("curve convert p.path -o back.json").exits(0);
    assert_eq!(json(&folder, "back.json")["type"], "bspline");
    // What was written is a curve again.
    folder.run("curve draw p.json q.json back.json even.json space.json -o all.svg").exits(0);
    assert!(folder.read("all.svg").matches("<path").count() >= 10);
}
