//! `cut`, `section`, `split`, and holes filled.

use crate::common::program::Folder;
use trisect::{Mesh, primitives};

fn folder() -> Folder {
    let folder = Folder::new();
    let save = |name: &str, mesh: &Mesh| mesh.save(folder.path(name)).expect("written");
    save("block.off", &primitives::cuboid([0.0; 3], [2.0, 3.0, 4.0]).expect("a box"));
    let mut two = primitives::cuboid([0.0; 3], [1.0; 3]).expect("a box");
    two.append(&primitives::cuboid([5.0; 3], [8.0; 3]).expect("a box")).expect("few vertices");
    save("two.off", &two);
    let mut open = primitives::geodesic_sphere(1.0, 6).expect("a ball");
    open.triangles.drain(..5);
    save("open.off", &open);
    folder
}

fn volume(folder: &Folder, name: &str) -> f64 {
    Mesh::load(folder.path(name)).expect("a mesh").volume()
}

#[test]
fn a_file_is_cut_in_two() {
    let folder = folder();
    folder.run("cut block.off --plane z=1 -o above.off -o below.off").exits(0).says("above:").says("below:");
    assert_eq!([volume(&folder, "above.off"), volume(&folder, "below.off")], [18.0, 6.0]);
    folder.run("cut block.off --plane 0,0,2,2 --keep below -o low.off").exits(0);
    assert_eq!(folder.read("low.off"), folder.read("below.off"));
    folder.run("cut block.off --plane 0,0,1;1,0,1;0,1,1 -o half.off").exits(0);
    assert_eq!(folder.read("half-above.off"), folder.read("above.off"));
    let object = folder.run("cut block.off --plane z=9 --keep above --json").exits(0).json();
    assert_eq!(object["results"][0]["triangles"], 0);
}

#[test]
fn a_picture_is_no_piece() {
    let folder = folder();
    folder.run("cut block.off --plane z=1 -o low.off -o low.png --png-size 16x16").exits(0);
    assert_eq!([volume(&folder, "low-above.off"), volume(&folder, "low-below.off")], [18.0, 6.0]);
    folder.run("cut block.off --plane z=1 -o a.off -o b.off --png c.png --png-size 16x16").exits(0);
    assert_eq!([volume(&folder, "a.off"), volume(&folder, "b.off")], [18.0, 6.0]);
    assert!(folder.path("c-above.png").exists() && folder.path("c-below.png").exists());
}

#[test]
fn parts_get_the_normals_and_the_place_that_are_asked_for() {
    let folder = folder();
    folder.run("split two.off --recenter --normals flat -o part.ply").exits(0).says("moved by");
    for name in ["part-1.ply", "part-2.ply"] {
        let mesh = Mesh::load(folder.path(name)).expect("a mesh");
        let bounds = mesh.bounds().expect("a body");
        assert!((0..3).all(|axis| (bounds.low[axis] + bounds.high[axis]).abs() < 1e-6), "{bounds:?}");
        assert!(mesh.attributes.iter().any(|attribute| attribute.name == "NORMAL"));
    }
}

#[test]
fn what_is_wound_inwards_and_lost_is_told() {
    let folder = folder();
    let mut both = primitives::cuboid([0.0; 3], [4.0; 3]).expect("a box");
    let mut inwards = primitives::cuboid([3.0; 3], [5.0; 3]).expect("a box");
    inwards.triangles.iter_mut().for_each(|triangle| triangle.swap(1, 2));
    both.append(&inwards).expect("few vertices");
    both.save(folder.path("both.off")).expect("written");
    for line in ["split both.off -o part.off", "split both.off --by block.off -o cell.off"] {
        folder.run(line).exits(0).says("is wound around inwards");
    }
}

#[test]
fn the_solid_that_splits_has_the_format_that_is_said() {
    let folder = folder();
    for name in ["block", "two"] {
        folder.write(&format!("{name}.dat"), folder.read(&format!("{name}.off")));
    }
    folder.run("split block.dat --by two.dat --format off -o cell.off").exits(0);
    assert_eq!(volume(&folder, "cell-intersection.off"), 1.0);
}

#[test]
fn several_planes_make_pieces() {
    let folder = folder();
    folder.run("cut block.off --plane x=1 --plane y=1 --cap cut#d08030 -o piece.obj").exits(0);
    let volumes = ["aa", "ba", "ab", "bb"].map(|name| volume(&folder, &format!("piece-{name}.obj")));
    assert_eq!(volumes, [8.0, 8.0, 4.0, 4.0]);
    assert!(folder.read("piece-aa.obj").contains("cut"));
    folder.run("cut block.off --plane x=1 --plane y=1 --keep below -o corner.obj").exits(0);
    assert_eq!(volume(&folder, "corner.obj"), 4.0);
}

#[test]
fn what_is_no_plane_is_told() {
    let folder = folder();
    folder.run("cut block.off --plane w=1 -o c.off").exits(1).says("x=, y= or z=");
    folder.run("cut block.off --plane 0,0,0,1 -o c.off").exits(1).says("normal");
    folder.run("cut block.off two.off --plane z=1 -o c.off").exits(1).says("one input");
    folder.run("cut block.off --plane z=1").exits(1).says("nowhere to put the result");
    folder.run("cut open.off --plane z=0 -o c.off").exits(3).says("--fill-holes");
}

#[test]
fn sections_are_written_in_three_formats() {
    let folder = folder();
    let line = "section block.off --heights 0:1:4 --side above -o s.svg -o s.dxf -o s.json --json";
    let object = folder.run(line).exits(0).json();
    let areas: Vec<f64> = object["sections"]
        .as_array()
        .expect("a list")
        .iter()
        .map(|s| s["area"].as_f64().expect("a number"))
        .collect();
    assert_eq!(areas, [6.0, 6.0, 6.0, 6.0, 0.0]);
    assert!(folder.read("s.svg").contains("<path"));
    assert_eq!(folder.read("s.dxf").matches("POLYLINE").count(), 4);
    let drawing: serde_json::Value = serde_json::from_str(&folder.read("s.json")).expect("JSON");
    assert_eq!(drawing["layers"][1]["polygons"][0]["outline"].as_array().expect("points").len(), 4);
    folder.run("section block.off --plane x=1 --axis y -o s.svg").exits(1).says("--axis");
    folder.run("section block.off --plane x=1 -o s.stl").exits(1).says("*.svg, *.dxf or *.json");
}

#[test]
fn bodies_and_cells_get_files_of_their_own() {
    let folder = folder();
    folder.run("split two.off -o part.off").exits(0).says("2 parts");
    assert_eq!(["part-1.off", "part-2.off"].map(|name| volume(&folder, name)), [27.0, 1.0]);
    folder.run("split block.off --by two.off -o cell.off").exits(0);
    let names = ["cell-difference.off", "cell-intersection.off", "cell-reverse.off"];
    assert_eq!(names.map(|name| volume(&folder, name)), [23.0, 1.0, 27.0]);
    folder.run("split two.off --by block.off --explode -o cell.off").exits(0);
    assert_eq!(volume(&folder, "cell-difference-1.off"), 27.0);
}

#[test]
fn holes_are_filled_only_when_asked() {
    let folder = folder();
    folder.run("union open.off -o c.off").exits(3).says("usable with --fill-holes");
    folder.run("union open.off --fill-holes -o c.off").exits(0).says("hole filled").says("area");
    folder.run("union open.off --fill-holes=3 -o c.off").exits(3);
    folder.run("union open.off --fill-holes --as-is -o c.off").exits(1).says("contradict");
}

#[test]
fn an_open_surface_is_trimmed() {
    let folder = folder();
    let square = vec![[-1.0, -1.0, 1.0], [9.0, -1.0, 1.0], [9.0, 9.0, 1.0], [-1.0, 9.0, 1.0]];
    let sheet = Mesh::new(square, vec![[0, 1, 2], [0, 2, 3]]);
    sheet.save(folder.path("sheet.obj")).expect("written");
    folder.run("trim sheet.obj block.off --inside -o in.obj").exits(0).says("not closed");
    folder.run("trim sheet.obj block.off --outside -o out.obj").exits(0);
    let area = |name: &str| Mesh::load(folder.path(name)).expect("a mesh").area();
    assert_eq!([area("in.obj"), area("out.obj")], [6.0, 94.0]);
    folder.run("trim sheet.obj block.off -o in.obj").exits(1).says("--inside");
    folder.run("trim sheet.obj --inside -o in.obj").exits(1).says("two inputs");
    // What is mended in the surface.
    let halves = vec![
        [-1.0, -1.0, 1.0],
        [9.0, -1.0, 1.0],
        [9.0, 9.0, 1.0],
        [-1.0, -1.0, 1.001],
        [9.0, 9.0, 1.001],
        [-1.0, 9.0, 1.001],
    ];
    Mesh::new(halves, vec![[0, 1, 2], [3, 4, 5]]).save(folder.path("torn.obj")).expect("written");
    folder.run("trim torn.obj --weld 0.01 block.off --inside -o in.obj").exits(0).says("2 vertices welded");
    folder.run("trim sheet.obj --fill-holes block.off --inside -o in.obj").exits(0).says("stays open");
}

#[test]
fn caps_show_what_is_asked_for() {
    let folder = Folder::new();
    let block = crate::common::program::cube([0.0; 3], [2.0; 3]);
    folder.write("a.mtl", "newmtl red\nKd 1 0 0\n");
    folder.write("a.obj", format!("mtllib a.mtl\nvn 0 0 1\no body\nusemtl red\n{block}"));
    folder.run("convert a.obj --normals flat -o block.glb").exits(0);
    let on_cap = |mesh: &Mesh| -> Vec<usize> {
        let is_on = |triangle: &[u32; 3]| {
            triangle.iter().all(|&v| (mesh.positions[v as usize][2] - 1.0).abs() < 1e-6)
        };
        (0..mesh.triangles.len()).filter(|&t| is_on(&mesh.triangles[t])).collect()
    };
    for (options, name, material) in [
        ("", "", None),
        ("--cut-material body", "body", Some("red")),
        ("--cut-material brass --cut-uv planar:0.5", "brass", Some("brass")),
        ("--cap lid", "lid", None),
    ] {
        folder.run(&format!("cut block.glb --plane z=1 --keep below {options} -o half.glb")).exits(0);
        let mesh = Mesh::load(folder.path("half.glb")).expect("a mesh");
        let cap = on_cap(&mesh);
        assert_eq!(cap.len(), 2, "{options}");
        for &triangle in &cap {
            let group = &mesh.groups.list[mesh.groups.of_triangle[triangle] as usize];
            assert_eq!(group.name, name, "{options}");
            if name != "lid" {
                assert_eq!(
                    group.material.as_ref().map(|material| material.name.as_str()),
                    material,
                    "{options}"
                );
            }
            let normals = mesh.attribute("NORMAL").expect("normals");
            assert_eq!(normals.at(triangle, 0), Some(&[0.0, 0.0, 1.0][..]), "{options}");
            let uv = mesh.attribute("TEXCOORD_0").and_then(|uv| uv.at(triangle, 1));
            assert_eq!(uv.is_some(), options.contains("planar"), "{options}");
        }
    }
    folder.run("cut block.glb --plane z=1 --cap lid --cut-material body -o half.glb").exits(1);
}

/// A wide square at a height, from one x to another.
fn square(from: f64, to: f64, height: f64) -> Mesh {
    let corners = vec![[from, -9.0, height], [to, -9.0, height], [to, 9.0, height], [from, 9.0, height]];
    Mesh::new(corners, vec![[0, 1, 2], [0, 2, 3]])
}

#[test]
fn surfaces_part_a_solid_or_are_refused() {
    let folder = folder();
    square(-9.0, 9.0, 1.0).save(folder.path("through.off")).expect("written");
    square(-9.0, 1.5, 2.0).save(folder.path("short.off")).expect("written");
    folder.run("split block.off --sheet through.off -o cell.off").exits(0).says("2 parts");
    assert_eq!([volume(&folder, "cell-1.off"), volume(&folder, "cell-2.off")], [18.0, 6.0]);
    folder
        .run("split block.off --sheet through.off --sheet short.off -o cell.off")
        .exits(3)
        .says("ends inside the solid");
    folder.run("split block.off --sheet through.off --groups -o cell.off").exits(1);
}

#[test]
fn what_parts_an_input_is_read_as_it_is_named() {
    let folder = folder();
    // (An input that is no file is made, not read; what parts it is a file all the same.)
    square(-9.0, 9.0, 0.5).save(folder.path("through.off")).expect("written");
    folder.run("split box:2 --sheet through.off -o cell.off").exits(0).says("2 parts");
    folder.run("split box:2 --by block.off -o cell.off").exits(0).says("reverse:");
    // A part of a file.
    let text = "v -9 -9 0.5\nv 9 -9 0.5\nv 9 9 0.5\nv -9 9 0.5\nv -9 -9 -9\nv 0 0 0.25\nv 9 9 -9\n\
                o floor\nf 1 2 3\nf 1 3 4\no short\nf 5 6 7\n";
    std::fs::write(folder.path("sheets.obj"), text).expect("written");
    folder.run("split box:2 --sheet sheets.obj#floor -o cell.off").exits(0).says("2 parts");
    folder.run("split box:2 --sheet sheets.obj#none -o cell.off").exits(3).says("none");
    // The format of standard input is not that of a file.
    square(-9.0, 9.0, 0.5).save(folder.path("through.stl")).expect("written");
    let bytes = std::fs::read(folder.path("block.off")).expect("a file");
    folder.run_with("split - --format off --sheet through.stl -o cell.off", &bytes).exits(0).says("2 parts");
}

#[test]
fn curves_are_drawn_on_two_files() {
    let folder = folder();
    square(-9.0, 9.0, 1.0).save(folder.path("sheet.off")).expect("written");
    folder.run("imprint block.off sheet.off -o marked.off").exits(0);
    let [block, sheet] =
        ["marked-1.off", "marked-2.off"].map(|name| Mesh::load(folder.path(name)).expect("a mesh"));
    assert_eq!((block.volume(), sheet.area()), (24.0, 18.0 * 18.0));
    let common = block.positions.iter().filter(|point| sheet.positions.contains(point)).count();
    assert!(common >= 4, "{common}");
    folder.run("imprint block.off -o marked.off").exits(1);
}

#[test]
fn a_soup_becomes_a_solid() {
    let folder = folder();
    let object = folder.run("solidify open.off -o made.off --json").exits(0).json();
    let report = &object["result"]["solidify"];
    assert_eq!((report["cells_inside"].as_u64(), report["still_crossing"].as_u64()), (Some(1), Some(0)));
    assert!(report["added_area"].as_f64().is_some_and(|area| area > 0.0));
    folder.run("check made.off").exits(0);
    square(0.0, 1.0, 0.0).save(folder.path("flat.off")).expect("written");
    folder.run("solidify flat.off -o nothing.off").exits(0).says("enclose nothing");
    folder.run("solidify open.off two.off -o made.off").exits(1);
}

#[test]
fn half_spaces_are_operands_of_expressions() {
    let folder = folder();
    let run = |text: &str| folder.run_args(&["combine", "--expr", text, "block.off", "-o", "made.off"]);
    run("a & below(z=1) - above(x=1.5)").exits(0);
    assert_eq!(volume(&folder, "made.off"), 1.5 * 3.0);
    run("a & above(z=9)").exits(0);
    assert_eq!(volume(&folder, "made.off"), 0.0);
    run("a + above(z=1)").exits(1).says("unbounded");
    // Planes askew: of the block of 2 by 3 by 4 what is below x + z = 3 and not beyond y = x.
    run("a & below(1,0,1,3)").exits(0);
    assert_eq!(volume(&folder, "made.off"), 3.0 * 4.0);
    run("a & (below(1,0,1,3) + above(z=2)) - above(0,0,0, 1,1,0, 0,0,1)").exits(0);
    run("a - above(0,0,0,1)").exits(1).says("normal");
    run("a ^ below(1,0,1,3)").exits(1).says("unbounded");
}

#[test]
fn what_fills_holes_is_refined_if_that_is_asked_for() {
    let folder = folder();
    let mut wide = primitives::geodesic_sphere(1.0, 12).expect("a ball");
    let positions = wide.positions.clone();
    wide.triangles.retain(|corners| corners.iter().all(|&v| positions[v as usize][2] < 0.7));
    wide.save(folder.path("wide.off")).expect("written");
    folder.run("union wide.off --refine-holes -o fair.off").exits(0).says("new vertices");
    folder.run("union wide.off --fill-holes -o flat.off").exits(0);
    assert!(volume(&folder, "fair.off") > volume(&folder, "flat.off"));
    folder.run("union open.off --refine-holes --as-is -o fair.off").exits(1);
}
