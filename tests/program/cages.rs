//! The program's `subdivide` and `freeform`.

use crate::common::program::{self, Folder, volume, workshop};

/// An octahedron that is stretched, turned and moved, with a tag line if there is one.
fn octahedron(scale: f64, way: f64, tags: &str) -> String {
    let mut text = String::new();
    for [x, y, z] in [
        [1.0, 0.1, 0.0],
        [-1.0, 0.0, 0.1],
        [0.0, 1.0, 0.0],
        [0.1, -1.0, 0.0],
        [0.0, 0.0, 1.0],
        [0.0, 0.1, -1.0],
    ] {
        text.push_str(&format!("v {} {} {}\n", scale * x + way, scale * y + 0.3 * way, scale * z));
    }
    for [a, b, c] in [[1, 3, 5], [3, 2, 5], [2, 4, 5], [4, 1, 5], [3, 1, 6], [2, 3, 6], [4, 2, 6], [1, 4, 6]]
    {
        text.push_str(&format!("f {a} {b} {c}\n"));
    }
    text + tags
}

fn folder() -> Folder {
    let folder = workshop();
    folder.write("one.obj", octahedron(2.0, 0.0, ""));
    folder.write(
        "two.obj",
        octahedron(1.5, 1.1, "t crease 2/1/0 0 2 10\nt crease 2/1/0 2 1 10\nt corner 1/1/0 4 10\n"),
    );
    folder.write("open.obj", octahedron(1.0, 0.0, "").replace("f 1 4 6\n", ""));
    folder.write("bad.obj", octahedron(1.0, 0.0, "t crease 2/1/0 0 99 10\n"));
    folder
}

#[test]
fn cages_are_refined_and_become_meshes() {
    let folder = folder();
    folder.run("subdivide two.obj --levels 2 -o fine.obj -o fine.json").exits(0);
    let fine = String::from_utf8(program::bytes(&folder.path("fine.obj"))).expect("text");
    // Each of two creases became four; the corner is one still.
    assert_eq!(fine.lines().filter(|line| line.starts_with("t crease")).count(), 8);
    assert_eq!(fine.lines().filter(|line| line.starts_with("t corner")).count(), 1);
    // The limit surface of the refined cage is that of the cage.
    folder.run("subdivide two.obj --tolerance 0.02 -o a.obj").exits(0);
    folder.run("subdivide fine.json --tolerance 0.02 -o b.obj --png b.png --png-size 64x48").exits(0);
    let (a, b) = (volume(&folder.read("a.obj")), volume(&folder.read("b.obj")));
    assert!((a - b).abs() < 0.02 * a && a > 0.0, "{a} {b}");
    folder.run("check a.obj").exits(0);
    // With borders, too; and creases from angles keep the octahedron what it is.
    folder.run("subdivide open.obj --levels 3 --limit -o open.off").exits(0);
    folder.run("subdivide one.obj --levels 3 --limit --creases-from-angle 10 -o sharp.obj").exits(0);
    let sharp = volume(&folder.read("sharp.obj"));
    assert!((sharp - volume(&folder.read("one.obj"))).abs() < 1e-9 * sharp);
}

#[test]
fn cages_are_combined_to_cages() {
    let folder = folder();
    let line = "freeform difference one.obj two.obj --tolerance 0.05 -o cut.obj -o cut.stl --exact exact.obj --png cut.png \
                --png-size 64x48 --json";
    let report = folder.run(line).exits(0).json();
    assert_eq!(report["verb"], "freeform");
    let result = &report["result"];
    assert_eq!(result["chains"], 1);
    assert!(result["errors"]["forward"].as_f64().expect("a number") < 0.1, "{result}");
    folder.run("convert cut.stl limit.obj").exits(0);
    let (near, exact) = (volume(&folder.read("limit.obj")), volume(&folder.read("exact.obj")));
    assert!((near - exact).abs() < 0.02 * exact, "{near} {exact}");
    assert!(program::bytes(&folder.path("cut.png")).starts_with(b"\x89PNG"));
    // The result is a cage again, with its curve as a crease; transforms belong to the cage before them.
    let line = "freeform union cut.obj two.obj --translate 0,0,0.4 --tolerance 0.05 -o both.json --details 1";
    folder.run(line).exits(0);
    folder.run("subdivide both.json --tolerance 0.02 -o both.stl").exits(0);
    folder.run("check both.stl").exits(0);
}

#[test]
fn cages_are_nodes_of_models() {
    let folder = folder();
    let node = |file: &str| format!(r#"{{"kind": "freeform", "file": "{file}"}}"#);
    for evaluate in ["exact", "freeform"] {
        let model = format!(
            r#"{{"tolerance": 0.02, "result": {{"kind": "difference", "evaluate": "{evaluate}", "operands": [{}, {}]}}}}"#,
            node("one.obj"),
            node("two.obj")
        );
        folder.write("model.json", model);
        folder.run(&format!("eval model.json -o {evaluate}.obj")).exits(0);
    }
    let (exact, cage) = (volume(&folder.read("exact.obj")), volume(&folder.read("freeform.obj")));
    assert!((exact - cage).abs() < 0.02 * exact, "{exact} {cage}");
    // What is no cage is refused under such an operation.
    let model = format!(
        r#"{{"kind": "union", "evaluate": "freeform", "operands": [{}, {{"kind": "sphere", "radius": 1}}]}}"#,
        node("one.obj")
    );
    folder.write("mixed.json", model);
    assert!(folder.run("eval mixed.json -o x.stl").exits(3).err.contains("no cage"));
}

#[test]
fn what_is_no_cage_is_refused_with_a_reason() {
    let folder = folder();
    for (line, exit, word) in [
        ("subdivide bad.obj -o x.obj", 3, "names vertex 99"),
        ("subdivide none.obj -o x.obj", 2, "none.obj"),
        ("subdivide one.obj --tolerance 0 -o x.obj", 1, "tolerance"),
        ("subdivide one.obj", 1, "nowhere"),
        ("freeform union one.obj -o x.obj", 1, "2"),
        ("freeform union one.obj open.obj -o x.obj", 3, "not closed"),
        ("freeform union one.obj two.obj -o -", 1, "file"),
        ("freeform difference one.obj two.obj --tolerance 0.001 --details 1 -o x.obj", 3, "--flatten"),
    ] {
        let ran = folder.run(line).exits(exit);
        assert!(ran.err.contains(word), "{line}: {ran:?}");
    }
    assert!(!folder.exists("x.obj"));
}
