//! The program with the boolean engine behind it: results, reports, limits inside a running operation.

#![cfg(feature = "cli")]

use crate::common::program::{
    self, Folder, bytes, cube, inside_out, opened, sphere, unit_cube, vertices, volume,
};
use serde_json::{Value, json};

/// Two cubes that share an eighth of each.
fn cubes() -> Folder {
    let folder = Folder::new();
    folder.write("a.obj", unit_cube());
    folder.write("b.obj", cube([0.5; 3], [1.5; 3]));
    folder
}

#[test]
fn every_verb_gives_the_exact_volume() {
    let folder = cubes();
    for (verb, expected) in [
        ("union", 1.875),
        ("difference", 0.875),
        ("intersection", 0.125),
        ("intersect", 0.125),
        ("xor", 1.75),
    ] {
        let object = folder.run(&format!("{verb} a.obj b.obj -o {verb}.obj --json")).exits(0).json();
        let result = &object["result"];
        assert_eq!(result["volume"], expected, "{verb}");
        assert_eq!(volume(&folder.read(&format!("{verb}.obj"))), expected, "{verb}");
        assert_eq!(result["closed"], true, "{verb}");
        assert_eq!(result["empty"], false, "{verb}");
        assert!(result["certificate"].is_object(), "{verb}");
    }
}

#[test]
fn the_summary_has_a_line_for_every_operand_and_one_for_the_result() {
    let ran = cubes().run("difference a.obj b.obj -o c.obj").exits(0);
    let lines: Vec<&str> = ran.err.lines().collect();
    assert_eq!(ran.out, "");
    assert_eq!(lines.len(), 3, "{ran:?}");
    assert!(lines[0].starts_with("a.obj: 12 triangles, closed, 1 shell, volume 1 ("), "{ran:?}");
    assert!(lines[1].starts_with("b.obj: 12 triangles, closed, 1 shell, volume 1 ("), "{ran:?}");
    assert!(lines[2].starts_with("result: "), "{ran:?}");
    assert!(lines[2].contains("closed, 1 shell, volume 0.875 ("), "{ran:?}");
    assert!(lines[2].ends_with("-> c.obj"), "{ran:?}");
}

#[test]
fn the_json_object_has_its_documented_keys() {
    let folder = cubes();
    let object = folder.run("union a.obj b.obj --scale 2 -o c.obj --json --strict").exits(0).json();
    let keys = |value: &Value| value.as_object().expect("an object").keys().cloned().collect::<Vec<_>>();
    assert_eq!(
        keys(&object),
        ["exit_code", "operands", "outputs", "program", "result", "schema", "seconds", "verb", "warnings"]
    );
    assert_eq!(object["schema"], 1);
    assert_eq!(object["exit_code"], 0);
    assert_eq!(object["warnings"], json!([]));
    for key in ["read", "run", "write", "total"] {
        assert!(object["seconds"][key].is_number(), "{key}");
    }
    for key in [
        "vertices",
        "triangles",
        "empty",
        "closed",
        "manifold",
        "shells",
        "genus",
        "volume",
        "area",
        "bounds",
    ] {
        assert!(!object["result"][key].is_null(), "{key}");
        assert!(!object["operands"][1][key].is_null(), "{key}");
    }
    assert_eq!(object["outputs"][0]["bytes"], bytes(&folder.path("c.obj")).len());
}

#[test]
fn a_report_file_says_the_same_as_json() {
    let folder = cubes();
    let printed = folder.run("union a.obj b.obj -o c.obj --json --report r.json").exits(0).json();
    let mut written: Value = serde_json::from_str(&folder.read("r.json")).expect("JSON");
    written["seconds"] = printed["seconds"].clone();
    for (index, operand) in printed["operands"].as_array().expect("a list").iter().enumerate() {
        written["operands"][index]["seconds"] = operand["seconds"].clone();
    }
    assert_eq!(written, printed);
}

#[test]
fn each_operand_has_its_own_transforms() {
    let folder = Folder::new();
    folder.write("a.obj", unit_cube());
    // A unit cube beside one twice as large beside one that is moved after it was scaled.
    let line =
        "union a.obj a.obj --scale 2 --translate 5,0,0 a.obj --translate 5,0,0 --scale 2 -o c.obj --json";
    let object = folder.run(line).exits(0).json();
    assert_eq!(object["result"]["volume"], 17.0);
    assert_eq!(object["result"]["shells"], 3);
    assert_eq!(object["result"]["bounds"], json!([[0.0, 0.0, 0.0], [12.0, 2.0, 2.0]]));
    folder
        .run("difference a.obj a.obj --translate 0,0,0.5 --rotate 0,0,90 --translate 1,0,0 -o d.obj")
        .exits(0);
    assert_eq!(volume(&folder.read("d.obj")), 0.5);
}

#[test]
fn a_difference_takes_all_others_from_the_first() {
    let folder = Folder::new();
    folder.write("a.obj", cube([0.0; 3], [4.0, 1.0, 1.0]));
    folder.write("t.obj", cube([0.25, 0.25, -1.0], [0.75, 0.75, 2.0]));
    let line = "difference a.obj t.obj t.obj --translate 1,0,0 t.obj --translate 2,0,0 -o c.obj --json";
    let object = folder.run(line).exits(0).json();
    assert_eq!(object["result"]["volume"], 4.0 - 3.0 * 0.25);
    assert_eq!(object["result"]["genus"], 3);
}

#[test]
fn an_empty_result_is_a_success() {
    let folder = cubes();
    let ran =
        folder.run("difference a.obj a.obj -o c.obj --png c.png --strict").exits(0).says("result: empty");
    assert_eq!(ran.out, "");
    assert!(folder.exists("c.obj") && folder.exists("c.png"));
    let object = folder.run("intersection a.obj b.obj --translate 9,9,9 --json").exits(0).json();
    assert_eq!(object["result"]["empty"], true);
    assert_eq!(object["result"]["volume"], 0.0);
}

#[test]
fn results_go_through_pipes() {
    let folder = cubes();
    let first = folder.run("union a.obj b.obj -o - --output-format ply -q").exits(0);
    assert_eq!(first.err, "");
    assert!(first.bytes.starts_with(b"ply"));
    let second =
        folder.run_with("difference - b.obj --format ply -o - --output-format obj", &first.bytes).exits(0);
    assert_eq!(volume(&second.out), 0.875);
}

#[test]
fn every_format_can_be_written_at_once() {
    let folder = cubes();
    let outputs: String =
        ["obj", "gltf", "glb", "stl", "ply", "off"].iter().map(|end| format!("-o c.{end} ")).collect();
    folder.run(&format!("union a.obj b.obj {outputs}")).exits(0);
    for end in ["obj", "gltf", "glb", "stl", "ply", "off"] {
        let object = folder.run(&format!("check c.{end} --json")).exits(0).json();
        assert_eq!(object["files"][0]["volume"], 1.875, "{end}");
        assert_eq!(object["files"][0]["format"], end);
    }
    folder.run("convert c.off -o t.stl -o t.ply --ascii").exits(0);
    assert!(folder.read("t.stl").starts_with("solid"));
    assert!(folder.read("t.ply").contains("format ascii"));
}

#[test]
fn results_are_operands_again() {
    let folder = cubes();
    folder.run("union a.obj b.obj -o c.obj").exits(0);
    for k in 1..5 {
        let by = 0.25 * f64::from(k);
        folder.run(&format!("union c.obj b.obj --translate {by},{by},{by} -o c.obj")).exits(0);
    }
    // Cubes along the diagonal: each adds a unit less what it shares with the one before.
    let shared = 0.75_f64.powi(3);
    assert_eq!(volume(&folder.read("c.obj")), 1.875 + 4.0 * (1.0 - shared));
    folder.run("check c.obj").exits(0);
}

#[test]
fn unusable_operands_are_refused_by_number_and_left_alone() {
    let folder = cubes();
    folder.write("open.obj", opened(&unit_cube()));
    folder.write("inside.obj", inside_out(&unit_cube()));
    // Two overlapping cubes in one file: the surface crosses itself.
    let second: String = cube([0.5; 3], [1.5; 3])
        .lines()
        .map(|line| match line.strip_prefix("f ") {
            Some(corners) => {
                let shifted: Vec<String> = corners
                    .split(' ')
                    .map(|corner| (corner.parse::<u32>().expect("an index") + 8).to_string())
                    .collect();
                format!("f {}\n", shifted.join(" "))
            }
            None => format!("{line}\n"),
        })
        .collect();
    folder.write("crossing.obj", unit_cube() + &second);
    folder.write("c.obj", "precious");

    folder.run("union a.obj open.obj -o c.obj").exits(3).says("operand 2 (open.obj)").says("open edge");
    folder.run("union inside.obj b.obj -o c.obj").exits(3).says("operand 1 (inside.obj)").says("--orient");
    assert_eq!(folder.read("c.obj"), "precious");
    // What a surface that crosses itself winds around counts once.
    let object = folder.run("check crossing.obj --json").exits(0).json();
    assert!(object["files"][0]["self_crossings"]["count"] == 6, "{object}");
    folder
        .run("difference crossing.obj a.obj -o c.obj")
        .exits(0)
        .says("6 self-crossings resolved by winding number (positive)");
    assert_eq!(volume(&folder.read("c.obj")), 0.875);
    folder.run("resolve crossing.obj -o c.obj").exits(0);
    assert_eq!(volume(&folder.read("c.obj")), 1.875);
    folder.run("resolve crossing.obj --rule even-odd -o c.obj").exits(0);
    assert_eq!(volume(&folder.read("c.obj")), 1.75);

    folder.run("union --orient inside.obj b.obj -o c.obj").exits(0);
    assert_eq!(volume(&folder.read("c.obj")), 1.875);
    folder
        .run("difference b.obj --scale 9 crossing.obj --translate 5,5,5 -o c.obj --assume-clean")
        .exits(0)
        .says("not checked for self-crossings");
}

#[test]
fn an_open_operand_says_where_it_is_open() {
    let folder = cubes();
    folder.write("open.obj", opened(&unit_cube()));
    let object = folder.run("union a.obj open.obj -o c.obj --json").exits(3).json();
    assert_eq!(object["error"]["operand"], 2);
    assert_eq!(object["error"]["diagnosis"]["open_edges"]["count"], 3);
    let ran = folder.run("check open.obj").exits(3);
    assert!(ran.out.contains("3 open edges"), "{ran:?}");
}

#[test]
fn pictures_show_operands_in_their_colours() {
    let folder = cubes();
    folder.run("union a.obj b.obj --png o.png --png-size 80x60").exits(0);
    folder.run("union a.obj b.obj --png n.png --png-size 80x60 --png-color none").exits(0);
    assert!(bytes(&folder.path("o.png")).starts_with(b"\x89PNG"));
    assert_ne!(bytes(&folder.path("o.png")), bytes(&folder.path("n.png")));
}

#[test]
fn thread_counts_do_not_change_a_byte() {
    let folder = Folder::new();
    folder.write("a.off", sphere(40, 1.0, [0.0; 3]));
    folder.write("b.off", sphere(40, 1.0, [0.3, 0.4, 0.5]));
    for threads in [1, 2, 8] {
        folder.run(&format!("difference a.off b.off -o {threads}.ply --threads {threads}")).exits(0);
    }
    let one = bytes(&folder.path("1.ply"));
    assert_eq!(bytes(&folder.path("2.ply")), one);
    assert_eq!(bytes(&folder.path("8.ply")), one);
}

#[test]
fn untouched_vertices_keep_their_bits() {
    let folder = cubes();
    folder.write("far.obj", cube([0.1, 0.2, 0.3], [1.0 / 3.0, 2.0 / 3.0, 0.7]));
    folder.run("union far.obj b.obj --translate 100,0,0 -o c.obj").exits(0);
    let result = vertices(&folder.read("c.obj"));
    for vertex in vertices(&folder.read("far.obj")) {
        assert!(result.contains(&vertex), "{vertex:?}");
    }
}

/// Two spheres heavy enough that their boolean takes longer than a signal.
#[cfg(unix)]
fn heavy() -> Folder {
    let folder = Folder::new();
    folder.write("a.off", sphere(300, 1.0, [0.0; 3]));
    folder.write("b.off", sphere(300, 1.0, [0.01, 0.02, 0.03]));
    folder.write("c.off", "precious");
    folder
}

#[cfg(unix)]
#[test]
fn ctrl_c_stops_a_running_operation_and_leaves_nothing() {
    for name in ["INT", "TERM"] {
        let folder = heavy();
        let before = folder.names();
        let child = folder.start("union a.off b.off -o c.off -o d.obj --threads 1 -v");
        // The operands are described after reading and before the operation.
        let (code, rest) = program::interrupted(child, |line| line.starts_with("b.off: "), name);
        assert_eq!((code, rest.as_str()), (Some(4), "trisect: error: cancelled\n"), "{name}");
        assert_eq!(folder.names(), before);
        assert_eq!(folder.read("c.off"), "precious");
    }
}

#[cfg(unix)]
#[test]
fn the_deadline_stops_a_running_operation_and_leaves_nothing() {
    let folder = heavy();
    let before = folder.names();
    // Generous or not, the work takes longer than this on any machine.
    let object = folder.run("union a.off b.off -o c.off --timeout 0.02 --json").exits(4).json();
    assert_eq!(object["error"]["kind"], "limit");
    assert_eq!(folder.names(), before);
    assert_eq!(folder.read("c.off"), "precious");
}

#[cfg(unix)]
#[test]
fn the_memory_ceiling_stops_a_running_operation_and_leaves_nothing() {
    let folder = heavy();
    folder.run("convert a.off a.ply").exits(0);
    folder.run("convert b.off b.ply").exits(0);
    let before = folder.names();
    // Enough to read the operands (9 MB each, and as much in memory), not for the tables of their boolean.
    let line = "union a.ply b.ply -o c.off --assume-clean --memory 60M --json";
    folder.run(&format!("{line} --dry-run")).exits(0);
    let object = folder.run(line).exits(4).json();
    assert_eq!(object["error"]["kind"], "limit");
    assert_eq!(folder.names(), before);
    assert_eq!(folder.read("c.off"), "precious");
}
