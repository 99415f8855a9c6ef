//! What is said of an output is what it holds.

use crate::common::program::{Folder, cube};

/// Two cubes of 1 at the coordinates of a map, 0.7 of each side common.
fn map() -> Folder {
    let folder = Folder::new();
    let at = |by: f64| [500_000.0 + by, 4_649_776.0 + by, 120.0 + by];
    folder.write("a.obj", cube(at(0.0), at(1.0)));
    folder.write("b.obj", cube(at(0.3), at(1.3)));
    folder
}

fn volume(folder: &Folder, file: &str) -> f64 {
    let report = folder.run(&format!("info {file} --json")).exits(0).json();
    report["files"][0]["volume"].as_f64().expect("closed")
}

#[test]
fn map_coordinates_in_stl_are_told_and_recenter_is_a_way_out() {
    let folder = map();
    let told = folder.run("difference a.obj b.obj -o c.stl --json --strict").exits(5);
    let report = told.json();
    let rounding = &report["outputs"][0]["rounding"];
    let (said, in_file) =
        (rounding["volume"].as_f64().unwrap(), rounding["written_volume"].as_f64().unwrap());
    assert!((said - 0.657).abs() < 1e-8 && (in_file - said).abs() > 0.01, "{rounding}");
    assert_eq!(volume(&folder, "c.stl"), in_file);
    assert_eq!((&rounding["step"], &rounding["closed"]), (&0.5.into(), &true.into()));
    told.says("c.stl: rounding to single precision").says("from 0.65").says("GLB").says("--recenter");

    let moved = folder.run("difference a.obj b.obj --recenter -o c.stl -o c.obj --json --strict").exits(0);
    let by: Vec<f64> = serde_json::from_value(moved.json()["moved_by"].clone()).expect("three numbers");
    assert_eq!(by, [-500_000.5, -4_649_776.5, -120.5]);
    moved.says("moved by -500000.5,-4649776.5,-120.5").says("--translate=500000.5,4649776.5,120.5");
    assert!((volume(&folder, "c.stl") - 0.657).abs() < 1e-6);
    // Back where it was, to the bit.
    folder.run("difference a.obj b.obj -o d.obj").exits(0);
    folder.run("convert c.obj --translate=500000.5,4649776.5,120.5 back.obj").exits(0);
    assert_eq!(folder.read("back.obj"), folder.read("d.obj"));

    for format in ["glb", "obj", "ply"] {
        folder.run(&format!("difference a.obj b.obj -o c.{format} --strict")).exits(0);
        assert!((volume(&folder, &format!("c.{format}")) - 0.657).abs() < 1e-6, "{format}");
    }
}

#[test]
fn a_film_without_thickness_in_the_file_is_told() {
    let folder = Folder::new();
    folder.write("body.obj", cube([0.0; 3], [1.0; 3]));
    folder.write("tool.obj", cube([0.25, 0.25, 0.0], [0.75, 0.75, 0.999_999_999]));
    let told = folder.run("difference body.obj tool.obj -o c.stl --json --strict").exits(5);
    let report = told.json();
    assert!(report["outputs"][0]["rounding"]["lost_films"].as_u64() > Some(0), "{report}");
    let told = told.says("film 1.0e-9 thick").says("OBJ or PLY");
    assert!(!told.err.contains("--recenter"), "that would not help: {told:?}");
    // PLY holds it; what is left is that the operands are nearly flush.
    let told = folder.run("difference body.obj tool.obj -o c.ply --strict").exits(5);
    let told = told.says("nearly flush").says("1 warning");
    assert!(!told.err.contains("thick"), "{told:?}");
    folder.run("convert c.ply c.stl --strict").exits(5).says("film");
    let plain = folder.run("convert body.obj b.stl --json --strict").exits(0).json();
    assert!(plain["outputs"][0]["rounding"].is_null());
}

#[test]
fn names_of_ascii_stl_are_no_warning() {
    let folder = Folder::new();
    folder.write("a.obj", cube([0.0; 3], [1.0; 3]).replace("f ", "g part\nf "));
    folder.run("convert a.obj a.stl --ascii").exits(0);
    assert!(folder.read("a.stl").contains("solid part"));
    folder.run("convert a.stl -o b.stl -o b.ply -o b.off --strict").exits(0);
}

/// A block of a hundred metres at map coordinates with a slanted bottom, and a pit whose tip ends a hair above it.
fn pit(heights: [f64; 3]) -> trisect::Mesh {
    let base = [500_000.0, 4_649_776.0, 120.0];
    let plane = heights[0] + (heights[1] - heights[0]) * 0.33 + (heights[2] - heights[0]) * 0.33;
    let mut positions = vec![
        [0.0, 0.0, heights[0]],
        [1.0, 0.0, heights[1]],
        [0.0, 1.0, heights[2]],
        [0.33, 0.33, plane + 1e-9],
        [0.0, 0.0, 0.4],
        [1.0, 0.0, 0.4],
        [0.0, 1.0, 0.4],
        [0.1, 0.1, 0.4],
        [0.8, 0.1, 0.4],
        [0.1, 0.8, 0.4],
    ];
    positions.iter_mut().for_each(|p| (0..3).for_each(|k| p[k] = base[k] + 100.0 * p[k]));
    let triangles = vec![
        [0, 2, 1],
        [0, 1, 5],
        [0, 5, 4],
        [1, 2, 6],
        [1, 6, 5],
        [2, 0, 4],
        [2, 4, 6],
        // The ring on top, and the pit.
        [4, 5, 8],
        [4, 8, 7],
        [5, 6, 9],
        [5, 9, 8],
        [6, 4, 7],
        [6, 7, 9],
        [7, 8, 3],
        [8, 9, 3],
        [9, 7, 3],
    ];
    trisect::Mesh::new(positions, triangles)
}

#[test]
fn a_file_that_crosses_itself_by_rounding_is_told() {
    let folder = Folder::new();
    let crosses = |mesh: &trisect::Mesh| {
        mesh.save(folder.path("try.glb")).expect("written");
        let back = trisect::Mesh::load(folder.path("try.glb")).expect("read");
        let solid = trisect::Solid::try_from(back).expect("closed");
        !solid.self_crossings(&trisect::Control::new()).expect("no limits").is_clean()
    };
    // Some slant rounds the bottom up and the tip down.
    let slants = (1..400).map(|k| pit([0.1 + 1.3e-9 * f64::from(k), 0.2 + 1.7e-9 * f64::from(k), 0.3]));
    let mesh = slants.into_iter().find(|mesh| crosses(mesh)).expect("one of many");
    mesh.save(folder.path("pit.ply")).expect("written");
    folder.run("check pit.ply").exits(0);
    folder
        .run("convert pit.ply out.glb --strict")
        .exits(5)
        .says("out.glb: rounding")
        .says("cross")
        .says("--recenter");
    assert!(folder.run("check out.glb").out.contains("crosses itself"));
    folder.run("convert pit.ply out.glb --recenter --strict").exits(0);
    assert!(!folder.run("check out.glb").exits(0).out.contains("crosses itself"));
}
