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
    folder.run("info two.3mf").exits(0).says("body: 12 triangles").says("tool: 12 triangles");
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
    assert_eq!(
        std::fs::read(folder.path("a.3mf")).expect("a"),
        std::fs::read(folder.path("b.3mf")).expect("b")
    );
    folder.write("bad.3mf", b"PK\x03\x04 and nothing more, but a.model");
    folder.run("info bad.3mf").exits(3).says("3MF");
}
