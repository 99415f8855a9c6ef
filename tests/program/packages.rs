//! 3MF files in and out of the program.

use trisect::Mesh;

use crate::common::program::{Folder, cube};

#[test]
fn packages_go_through_the_program() {
    let folder = Folder::new();
    folder.write("a.obj", format!("o body\n{}", cube([0.0; 3], [2.0; 3])));
    folder.write("b.obj", format!("o tool\n{}", cube([1.0; 3], [3.0; 3])));
    folder.run("convert a.obj -o a.3mf").exits(0);
    folder.run("difference a.3mf b.obj -o c.3mf").exits(0);
    let mesh = Mesh::load(folder.path("c.3mf")).expect("a package");
    assert!((mesh.volume() - 7.0).abs() < 1e-12);
    // The faces of either input are a set of triangles.
    let names: Vec<&str> = mesh.groups.list.iter().map(|group| group.name.as_str()).collect();
    assert_eq!(names, ["body", "tool"]);
    let object = folder.run("info c.3mf --json").exits(0).json();
    assert_eq!(object["files"][0]["format"], "3mf");
    // Two bodies are two objects, by their names.
    folder.run("union a.obj b.obj --translate 5,0,0 -o two.3mf").exits(0);
    let two = Mesh::load(folder.path("two.3mf")).expect("a package");
    assert_eq!(two.groups.of_triangle, [[0; 12], [1; 12]].concat());
    folder.run("convert two.3mf#tool -o tool.ply").exits(0);
    assert!((Mesh::load(folder.path("tool.ply")).expect("a mesh").volume() - 8.0).abs() < 1e-12);
}

#[test]
fn what_a_package_loses_is_told() {
    let folder = Folder::new();
    let fixture = concat!(env!("CARGO_MANIFEST_DIR"), "/fixtures/formats/vertex-colours.3mf");
    folder.run_args(&["convert", fixture, "-o", "a.3mf"]).exits(0).says("3 metadata entries not kept");
    folder.run_args(&["convert", "a.3mf", "-o", "a.glb"]).exits(0);
    folder.run_args(&["convert", "a.glb", "-o", "b.3mf"]).exits(0);
    // Bytes of colours come back from single precision; which one is the first of the list may differ.
    let shown = |name: &str| -> Vec<[u8; 3]> {
        let mesh = Mesh::load(folder.path(name)).expect("a mesh");
        let colours = mesh.attribute("COLOR_0").expect("colours");
        let byte = |x: f64| (x * 255.0).round() as u8;
        (0..12).map(|i| [0, 1, 2].map(|k| byte(colours.at(i / 3, i % 3).expect("a colour")[k]))).collect()
    };
    assert_eq!(shown("a.3mf"), shown("b.3mf"));
    folder.write("bad.3mf", b"PK\x03\x04 and nothing more, but a.model");
    folder.run("info bad.3mf").exits(2).says("3MF");
}
