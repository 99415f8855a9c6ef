//! Nodes of model files for mending and cuts.

use std::path::{Path, PathBuf};

use trisect::model::{Evaluated, Evaluation, Model};
use trisect::{Error, Mesh, primitives};

/// The files of the tests, by name: no file is read.
fn file(path: &Path) -> Result<Mesh, Error> {
    let name = path.file_stem().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    let mut block = primitives::cuboid([0.0; 3], [2.0; 3])?;
    match name.as_str() {
        "open" => {
            block.triangles.truncate(10);
        }
        "soup" => {
            block.triangles.truncate(10);
            block.triangles[3].swap(0, 1);
        }
        "two" => block.append(&primitives::cuboid([5.0; 3], [6.0; 3])?)?,
        "sheet" | "short" => {
            let end = if name == "short" { 1.0 } else { 3.0 };
            let square = vec![[-1.0, -1.0, 0.5], [end, -1.0, 0.5], [end, 3.0, 0.5], [-1.0, 3.0, 0.5]];
            block = Mesh::new(square, vec![[0, 1, 2], [0, 2, 3]]);
        }
        _ => {}
    }
    Ok(block)
}

fn run(text: &str) -> Result<Evaluated, Error> {
    let model = Model::parse(text, &PathBuf::from("."))?;
    Evaluation::new().tolerance(0.05).loader(file).run(&model)
}

fn volume(text: &str) -> f64 {
    let found = run(text).unwrap();
    assert!(!found.is_open);
    found.mesh.volume()
}

#[test]
fn files_are_mended_as_their_nodes_ask_for() {
    let filled = run(r#"{"kind": "mesh", "file": "open.stl", "fill_holes": true}"#).unwrap();
    assert_eq!(filled.mesh.volume(), 8.0);
    assert!(filled.warnings.iter().any(|warning| warning.contains("filled")), "{:?}", filled.warnings);
    assert!(volume(r#"{"kind": "mesh", "file": "open.stl", "refine_holes": true, "weld": 0.01}"#) > 7.0);
    let inside = r#"{"kind": "difference", "operands": [{"kind": "mesh", "file": "open.stl", "fill_holes": 4},
        {"kind": "box", "low": [1, 1, 1], "high": [3, 3, 3]}]}"#;
    assert_eq!(volume(inside), 7.0);
    for (node, part) in [
        (r#""fill_holes": 3"#, "not a closed"),
        (r#""fill_holes": 2"#, "3 or more"),
        (r#""fill_holes": "all""#, "3 or more"),
        (r#""weld": -1"#, "`weld`"),
        (r#""weld": "much""#, "`weld`"),
        (r#""weld": 1e999"#, "not JSON"),
        (r#""fill": true"#, "unknown key `fill`"),
    ] {
        let error =
            run(&format!(r#"{{"kind": "mesh", "file": "open.stl", {node}}}"#)).unwrap_err().to_string();
        assert!(error.contains(part), "{node}: {error}");
    }
}

#[test]
fn soups_are_made_solids() {
    let text = r#"{"kind": "solidify", "file": "soup.stl", "transform": [{"scale": 2}]}"#;
    let made = run(text).unwrap();
    assert_eq!(made.mesh.volume(), 64.0);
    assert!(made.warnings.iter().any(|warning| warning.contains("solidified")), "{:?}", made.warnings);
    let error = run(r#"{"kind": "solidify", "operand": "soup.stl"}"#).unwrap_err().to_string();
    assert!(error.contains("`file` is missing"), "{error}");
}

#[test]
fn parts_are_taken_by_size() {
    let part = |sheets: &str, number: &str| {
        let keys = format!(r#"{sheets} "part": {number}"#);
        run(&format!(r#"{{"kind": "split", "operand": "two.stl", {keys}}}"#)).map(|found| found.mesh.volume())
    };
    assert_eq!([part("", "1").unwrap(), part("", "2").unwrap()], [8.0, 1.0]);
    let sheets = r#""sheets": ["sheet.obj"],"#;
    let found: Vec<f64> = ["1", "2", "3"].iter().map(|number| part(sheets, number).unwrap()).collect();
    assert_eq!(found, [6.0, 2.0, 1.0]);
    let with_keys = r#""sheets": [{"file": "sheet.obj", "weld": "auto", "orient": true}],"#;
    assert_eq!(part(with_keys, "2").unwrap(), 2.0);
    for (sheets, number, what) in [
        ("", "3", "there are 2 parts"),
        ("", "0", "1 is the largest"),
        ("", "-1", "`part`"),
        (r#""sheets": ["short.obj"],"#, "1", "ends inside"),
        (r#""sheets": "sheet.obj","#, "1", "a list of files"),
        (r#""sheets": [{"file": "sheet.obj", "fill": 1}],"#, "1", "unknown key `fill`"),
    ] {
        let error = part(sheets, number).unwrap_err().to_string();
        assert!(error.contains(what), "{sheets} {number}: {error}");
    }
}

#[test]
fn trimmed_surfaces_are_results() {
    let trim = |side: &str| {
        format!(
            r#"{{"kind": "trim", "sheet": "sheet.obj", "{side}": {{"kind": "box", "size": [2, 2, 2]}},
                "transform": [{{"scale": 2}}]}}"#
        )
    };
    let [inside, outside] = ["inside", "outside"].map(|side| run(&trim(side)).unwrap());
    assert!(inside.is_open && outside.is_open);
    assert_eq!([inside.mesh.area(), outside.mesh.area()], [4.0 * 4.0, 4.0 * 12.0]);
    let named = format!(r#"{{"nodes": {{"roof": {}}}, "result": "roof"}}"#, trim("inside"));
    assert_eq!(run(&named).unwrap().mesh.area(), 16.0);
    let operand = format!(r#"{{"kind": "union", "operands": ["two.stl", {}]}}"#, trim("inside"));
    let error = run(&operand).unwrap_err().to_string();
    assert!(error.contains("open") && error.contains("/operands/1"), "{error}");
    let error = run(r#"{"kind": "trim", "sheet": "sheet.obj"}"#).unwrap_err().to_string();
    assert!(error.contains("`inside` or `outside`"), "{error}");
    let files = Model::parse(&trim("inside"), Path::new("in")).unwrap().files();
    assert_eq!(files, [Path::new("in").join("sheet.obj")]);
}
