//! The program on inputs that are nearly usable: what it advises, and that the advice holds.

#![cfg(feature = "cli")]

use crate::common::program::{Folder, Ran, bytes, cube, inside_out, opened, unit_cube, volume};

/// Two surfaces in one file.
fn together(first: &str, second: &str) -> String {
    let vertices = first.lines().filter(|line| line.starts_with("v ")).count();
    let shifted = second.lines().map(|line| match line.strip_prefix("f ") {
        None => format!("{line}\n"),
        Some(corners) => {
            let shift = |corner: &str| (corner.parse::<usize>().expect("an index") + vertices).to_string();
            format!("f {}\n", corners.split(' ').map(shift).collect::<Vec<_>>().join(" "))
        }
    });
    first.to_string() + &shifted.collect::<String>()
}

/// Asserts what a run printed on standard output.
#[track_caller]
fn prints(ran: &Ran, text: &str) {
    assert!(ran.out.contains(text), "'{text}' is missing: {}", ran.out);
}

/// The unit cube whose last three faces have a corner of their own, `off` along x.
fn cracked(off: &str) -> String {
    let (mut text, mut faces) = (String::new(), 0);
    for line in unit_cube().lines() {
        let is_face = line.starts_with("f ");
        if is_face && faces == 0 {
            text.push_str(&format!("v {off} 1 1\n"));
        }
        faces += usize::from(is_face);
        let cracked = if faces > 9 { line.replace('8', "9") } else { line.to_string() };
        text.push_str(&format!("{cracked}\n"));
    }
    text
}

#[test]
fn a_cracked_surface_is_welded_on_request() {
    let folder = Folder::new();
    folder.write("cracked.obj", cracked("1.0001"));
    prints(&folder.run("check cracked.obj").exits(3), "usable with --weld auto (1 vertex of a seam joined");
    let ran = folder.run("union cracked.obj -o refused.obj --json").exits(3).says("--weld auto");
    assert_eq!(ran.json()["error"]["remedy"], "--weld auto");
    for distance in ["auto", "1e-3"] {
        let object =
            folder.run(&format!("union cracked.obj --weld {distance} -o w.obj --json")).exits(0).json();
        assert_eq!(object["operands"][0]["welded"], 1);
        assert_eq!(object["operands"][0]["mending"]["seams"]["count"], 1);
        assert!((volume(&folder.read("w.obj")) - 1.0).abs() < 1e-3);
        prints(
            &folder.run(&format!("check cracked.obj --weld {distance}")).exits(0),
            "by a distance of 1.000e-",
        );
        folder.run(&format!("convert cracked.obj --weld {distance} c.obj")).exits(0).says("1 vertex welded");
        folder.run("check c.obj").exits(0);
    }
    folder.run("check cracked.obj --weld -1").exits(1);
    folder.run("check cracked.obj --weld x").exits(1);
}

#[test]
fn a_seam_a_rounding_apart_is_joined_and_told() {
    let folder = Folder::new();
    folder.write("seam.obj", cracked("1.000000001"));
    let ran = folder.run("union seam.obj -o c.obj --json --strict").exits(0);
    let operand = &ran.json()["operands"][0];
    assert_eq!(operand["mending"]["seams"]["count"], 1);
    assert_eq!(operand["mending"]["seams"]["places"][0]["vertices"], serde_json::json!([7, 8]));
    assert_eq!(operand["welded"], 0);
    folder
        .run("union seam.obj -o c.obj")
        .exits(0)
        .says("mended: 1 vertex of a seam joined (at most 1.0e-9 apart)");
    let ran = folder.run("check seam.obj").exits(0);
    prints(&ran, "1 vertex of a seam joined: triangle ");
    prints(&ran, " vertices 7-8 at");
    prints(&folder.run("info seam.obj").exits(0), "1 vertex of a seam joined");
    folder.run("union seam.obj --as-is -o c.obj").exits(3).says("usable without --as-is");
    folder.run("union --as-is seam.obj -o c.obj").exits(3).says("usable without --as-is");
    folder.run("union seam.obj --as-is --weld auto -o c.obj").exits(1).says("contradict");
}

#[test]
fn what_closes_an_open_surface_is_told() {
    let folder = Folder::new();
    folder.write("open.obj", opened(&unit_cube()));
    let ran = folder.run("union open.obj -o c.obj --json").exits(3).says("usable with --fill-holes");
    assert_eq!(ran.json()["error"]["remedy"], "--fill-holes");
    // A triangle by itself is all rim: filled it encloses nothing.
    folder.write("sheet.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    let ran = folder.run("union sheet.obj -o c.obj --json").exits(3).says("rims of holes");
    assert!(ran.json()["error"]["remedy"].is_null());
    prints(&folder.run("check sheet.obj").exits(3), "no option closes it");
}

#[test]
fn what_has_no_hole_is_not_said_to_have_one() {
    let folder = Folder::new();
    let path = |name: &str| format!("{}/fixtures/reported/{name}.obj", env!("CARGO_MANIFEST_DIR"));
    for name in ["t-vertex", "fin", "face-twice", "one-wall", "seam-ulp"] {
        let path = path(name);
        folder.run(&format!("union {path} -o c.obj")).exits(0).says("mended: 1 ");
        let ran = folder.run(&format!("check {path} --as-is")).exits(3);
        prints(&ran, "usable without --as-is");
        assert!(!ran.out.contains("hole"), "{}", ran.out);
    }
    // What leaves out a piece of the surface is a warning, the rest is none.
    let strict = |name: &str| folder.run(&format!("union {} -o c.obj --strict", path(name))).code;
    assert_eq!(["t-vertex", "face-twice", "seam-ulp", "shell-twice"].map(strict), [0; 4]);
    assert_eq!(["fin", "one-wall"].map(strict), [5; 2]);
}

#[test]
fn a_shell_stored_twice_is_taken_once() {
    let folder = Folder::new();
    let path = format!("{}/fixtures/reported/shell-twice.obj", env!("CARGO_MANIFEST_DIR"));
    let ran = folder.run(&format!("check {path}")).exits(0);
    prints(&ran, "volume 0.1666666667");
    prints(&ran, "1 copy of a shell left out: triangle 4");
    folder.run(&format!("union {path} --orient -o c.obj")).exits(0).says("volume 0.1666666667");
}

#[test]
fn open_parts_are_left_out_on_request() {
    let folder = Folder::new();
    let floor = "v -1 -1 0\nv 3 -1 0\nv 3 3 0\nv -1 3 0\nf 1 2 3\nf 1 3 4\n";
    folder.write("scene.obj", together(floor, &unit_cube()));
    folder.write("b.obj", cube([0.5; 3], [1.5; 3]));
    prints(
        &folder.run("check scene.obj").exits(3),
        "usable with --closed-parts (2 triangles of open parts left out",
    );
    let ran = folder.run("difference scene.obj --closed-parts b.obj -o c.obj --strict").exits(5);
    assert!(ran.err.contains("operand 1 (scene.obj): 2 triangles of open parts left out"), "{}", ran.err);
    assert!(ran.err.contains("(1 part, area 16)"), "{}", ran.err);
    assert_eq!(volume(&folder.read("c.obj")), 0.875);
    // The option is for the file before it.
    folder.run("difference scene.obj b.obj --closed-parts -o c.obj").exits(3).says("--closed-parts");
    folder.run("difference --closed-parts scene.obj b.obj -o c.obj").exits(0);
    // Two options where one does not do.
    folder.write("both.obj", together(floor, &inside_out(&unit_cube())));
    prints(&folder.run("check both.obj").exits(3), "usable with --orient --closed-parts");
    folder.run("union both.obj --orient --closed-parts -o c.obj").exits(0).says("volume 1");
}

#[test]
fn bodies_inside_bodies_are_refused_unless_they_are_cavities() {
    let folder = Folder::new();
    let (outer, inner) = (cube([0.0; 3], [3.0; 3]), cube([1.0; 3], [2.0; 3]));
    folder.write("doubled.obj", together(&outer, &inner));
    folder.write("hollow.obj", together(&outer, &inside_out(&inner)));
    folder.run("union hollow.obj -o c.obj").exits(0).says("volume 26");
    folder.run("check doubled.obj").exits(3);
    let ran = folder.run("union doubled.obj -o c.obj --json").exits(3).says("wrong way").says("--orient");
    let shells = &ran.json()["error"]["inside_out_shells"];
    assert_eq!(shells["count"], 1);
    assert_eq!(shells["places"][0]["triangles"][0], 12);
    folder.run("union doubled.obj --orient -o c.obj").exits(0).says("volume 26");
    folder.run("union doubled.obj --assume-clean -o c.obj").exits(0).says("volume 28");
}

#[test]
fn a_shell_that_faces_inwards_by_itself_is_refused() {
    let folder = Folder::new();
    let beside = inside_out(&cube([5.0; 3], [6.0; 3]));
    folder.write("beside.obj", together(&cube([0.0; 3], [3.0; 3]), &beside));
    folder.run("union beside.obj -o c.obj").exits(3).says("wrong way");
    folder.run("union beside.obj --orient -o c.obj").exits(0).says("volume 28");
}

#[test]
fn a_cavity_that_touches_the_outside_everywhere_it_can_is_one() {
    let folder = Folder::new();
    folder.write("cube.obj", cube([-1.0; 3], [1.0; 3]));
    // An octahedron whose corners lie in the middles of the cube's faces.
    let octahedron = "v 1 0 0\nv -1 0 0\nv 0 1 0\nv 0 -1 0\nv 0 0 1\nv 0 0 -1\n\
                      f 1 3 5\nf 3 2 5\nf 2 4 5\nf 4 1 5\nf 3 1 6\nf 2 3 6\nf 4 2 6\nf 1 4 6\n";
    folder.write("octahedron.obj", octahedron);
    folder.run("difference cube.obj octahedron.obj -o hollow.obj").exits(0).says("2 shells");
    folder.run("union hollow.obj octahedron.obj -o whole.obj").exits(0).says("volume 8");
}

#[test]
fn pictures_of_gltf_and_obj_have_y_upwards() {
    let folder = Folder::new();
    folder.write("a.obj", cube([0.0; 3], [1.0, 2.0, 4.0]));
    folder.run("convert a.obj -o a.glb -o a.stl -o a.ply -o a.off").exits(0);
    let picture = |line: &str| {
        folder.run(&format!("{line} --png p.png --png-size 64x48 --png-color none")).exits(0);
        bytes(&folder.path("p.png"))
    };
    let (up_y, up_z) = (picture("convert a.obj --png-up y"), picture("convert a.obj --png-up z"));
    assert_ne!(up_y, up_z);
    assert_eq!(picture("convert a.obj"), up_y);
    assert_eq!(picture("convert a.glb"), up_y);
    for z in ["a.stl", "a.ply", "a.off"] {
        assert_eq!(picture(&format!("convert {z}")), up_z, "{z}");
    }
    assert_eq!(picture("union a.glb"), up_y);
    assert_eq!(picture("convert a.glb --png-up z"), up_z);
}

#[test]
fn a_sheet_with_two_sides_is_said_to_be_empty() {
    let folder = Folder::new();
    folder.write("a.obj", unit_cube());
    folder.write("sheet.obj", "v 0 0 0.5\nv 1 0 0.5\nv 0 1 0.5\nv 1 1 0.5\nf 1 2 4 3\nf 1 3 4 2\n");
    let ran = folder.run("difference a.obj sheet.obj --json --strict").exits(5).says("operand 2 (sheet.obj)");
    assert_eq!(ran.json()["result"]["volume"], 1.0);
    assert!(ran.err.contains("each of its 4 triangles has an opposite copy"), "{}", ran.err);
    folder.run("check sheet.obj").exits(0).says("enclose nothing");
}
