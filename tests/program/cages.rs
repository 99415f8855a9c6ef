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
fn any_number_of_cages_is_combined_at_once() {
    let folder = folder();
    // Twice the second cage, apart: what two steps of each take off.
    folder.run("subdivide two.obj --translate 0,0,0.4 --levels 0 -o up.obj").exits(0);
    folder.run("subdivide two.obj --translate -2.2,-0.6,-0.4 --levels 0 -o down.obj").exits(0);
    let line =
        "freeform difference one.obj up.obj down.obj --tolerance 0.05 -o cut.obj --exact exact.obj --json";
    let report = folder.run(line).exits(0).json();
    assert!(report["result"]["seconds"]["boolean"].is_number(), "{report}");
    let found = report["result"]["chains"].as_u64().expect("a number");
    let first =
        folder.run("freeform difference one.obj up.obj --tolerance 0.05 -o a.obj --json").exits(0).json();
    let alone = first["result"]["chains"].as_u64().expect("a number");
    assert!(found > alone && alone > 0, "{found} {alone}");
    let surface = folder.run("subdivide cut.obj --tolerance 0.01 -o fine.obj").exits(0);
    let (near, exact) = (volume(&folder.read("fine.obj")), volume(&folder.read("exact.obj")));
    assert!((near - exact).abs() < 0.03 * exact, "{near} {exact} {surface:?}");
    // One alone is united with itself.
    folder.run("freeform union one.obj -o same.obj").exits(0);
    let same = folder.run("subdivide same.obj --levels 2 --limit -o x.obj").exits(0);
    folder.run("subdivide one.obj --levels 2 --limit -o y.obj").exits(0);
    assert_eq!(volume(&folder.read("x.obj")), volume(&folder.read("y.obj")), "{same:?}");
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
        ("freeform difference one.obj -o x.obj", 1, "freeform union"),
        ("freeform union one.obj open.obj -o x.obj", 3, "not closed"),
        ("freeform union one.obj two.obj -o -", 1, "file"),
        ("freeform difference one.obj two.obj --tolerance 0.001 --details 1 -o x.obj", 3, "--flatten"),
    ] {
        let ran = folder.run(line).exits(exit);
        assert!(ran.err.contains(word), "{line}: {ran:?}");
    }
    assert!(!folder.exists("x.obj"));
}

/// A cube of quads, its upper edges creases if asked for.
fn cube(sharp: bool) -> String {
    let mut text = String::new();
    for i in 0..8 {
        let [x, y, z] = [i & 1, i >> 1 & 1, i >> 2].map(|x| 2 * x - 1);
        text.push_str(&format!("v {x} {y} {z}\n"));
    }
    for face in ["1 3 4 2", "5 6 8 7", "1 2 6 5", "3 7 8 4", "1 5 7 3", "2 4 8 6"] {
        text.push_str(&format!("f {face}\n"));
    }
    if sharp {
        text.push_str("t crease 5/1/0 4 5 7 6 4 10\n");
    }
    text
}

#[test]
fn quads_stay_quads() {
    let folder = workshop();
    folder.write("cube.obj", cube(true));
    let ran = folder.run("subdivide cube.obj -o one.obj -o one.json -o one.glb").exits(0);
    assert!(!ran.err.contains("warning"), "{ran:?}");
    let one = String::from_utf8(program::bytes(&folder.path("one.obj"))).expect("text");
    let quads = one.lines().filter(|line| line.starts_with("f ")).map(|line| line.split(' ').count());
    assert!(quads.clone().all(|words| words == 5) && quads.count() == 24, "{one}");
    assert_eq!(one.lines().filter(|line| line.starts_with("t crease")).count(), 8);
    // One surface, whichever cage it is made of; from which file is all the same.
    let mut volumes = Vec::new();
    for file in ["cube.obj", "one.obj", "one.json", "one.glb"] {
        folder.run(&format!("subdivide {file} --tolerance 0.01 -o limit.obj")).exits(0);
        volumes.push(volume(&folder.read("limit.obj")));
        folder.run("check limit.obj").exits(0);
    }
    assert!(volumes.iter().all(|v| (v - volumes[0]).abs() < 0.01 * v), "{volumes:?}");
    let report = folder.run("subdivide cube.obj --limit --levels 3 -o limit.glb --json").exits(0).json();
    assert_eq!(report["cage"]["scheme"], "catmull-clark");
    // Beside the limit surface stands the cage that it is of.
    folder.run("subdivide limit.glb --levels 0 -o again.obj").exits(0);
    let again = String::from_utf8(program::bytes(&folder.path("again.obj"))).expect("text");
    assert_eq!(again.lines().filter(|line| line.starts_with("f ")).count(), 6);
    // As triangles only if it is asked for, and then it is said.
    let ran = folder.run("subdivide cube.obj --scheme loop -o triangles.obj").exits(0);
    assert!(ran.err.contains("6 faces with more than three corners were split"), "{ran:?}");
}

#[test]
fn quads_are_fitted_for_booleans_of_cages() {
    let folder = workshop();
    folder.write("cube.obj", cube(true));
    folder.write("ball.obj", cube(false));
    let line = "freeform difference cube.obj ball.obj --translate 0.7,0.1,0.9 --tolerance 0.05 -o cut.obj -o cut.glb";
    let ran = folder.run(line).exits(0);
    assert!(ran.err.contains("fitted to the Catmull-Clark surface"), "{ran:?}");
    folder.run("subdivide cut.glb --tolerance 0.01 -o near.obj").exits(0);
    let line = "difference cube.obj --subdivide=0.005 ball.obj --translate 0.7,0.1,0.9 --subdivide=0.005 -o exact.obj";
    folder.run(line).exits(0);
    let (near, exact) = (volume(&folder.read("near.obj")), volume(&folder.read("exact.obj")));
    assert!((near - exact).abs() < 0.03 * exact, "{near} {exact}");
}

#[test]
fn a_result_without_a_mesh_has_no_place_for_a_cage() {
    let folder = folder();
    let line = "freeform intersection one.obj two.obj --translate 90,0,0 -o none.glb";
    let ran = folder.run(line).exits(0);
    assert!(ran.err.contains("no mesh that could have `trisect_cage`"), "{ran:?}");
    folder.run("subdivide none.glb -o x.obj").exits(2).says("no mesh of it has a cage");
}

#[test]
fn cages_are_operands_of_every_verb() {
    let folder = folder();
    folder.write("cube.obj", cube(true));
    folder.run("subdivide two.obj --tolerance 0.01 -o two.off -o fine.obj").exits(0);
    folder.run("subdivide cube.obj --levels 0 -o cube.json").exits(0);
    let two = volume(&folder.read("fine.obj"));
    let made = |line: &str| {
        folder.run(&format!("{line} -o made.obj")).exits(0);
        volume(&folder.read("made.obj"))
    };
    // The same triangles as those of the verb; per input, in the order of the transforms.
    assert_eq!(made("union two.obj --subdivide=0.01"), two);
    assert!((made("union two.obj --subdivide=0.01 --scale 2") - 8.0 * two).abs() < 1e-9 * two);
    assert!((made("union two.obj --scale 2 --subdivide=0.02") - 8.0 * two).abs() < 1e-9 * two);
    let twice = made("union two.obj --subdivide=0.01 --pattern linear:2:0,0,9");
    assert!((twice - 2.0 * two).abs() < 1e-9 * two, "{twice}");
    let mirrored = made("union two.obj --mirror x --subdivide=0.01");
    assert!((mirrored - two).abs() < 1e-3 * two, "{mirrored} {two}");
    let (own, rest) = (made("union cube.json --subdivide"), made("difference box:4 cube.json --subdivide"));
    assert!((own + rest - 64.0).abs() < 1e-6, "{own} {rest}");
    let sharp = made("union cube.obj --subdivide=creases:80,0.1");
    assert!((sharp - 8.0).abs() < 1e-9, "{sharp}");
    // Without the option a file is what it always was.
    assert!(folder.run("union cube.obj -o plain.stl").exits(0).err.contains("volume 8"));
    folder.run("measure cube.json --subdivide=0.1").exits(0);
    let report = folder.run("union cube.obj --subdivide --json -o made.obj").exits(0).json();
    assert!(report.to_string().contains("subdivide auto"), "{report}");
    for (line, code, word) in [
        ("union bad.obj --subdivide -o x.off", 3, "names vertex 99"),
        ("union two.off --subdivide -o x.off", 1, "`convert` makes an OBJ"),
        ("union box:1 --subdivide -o x.off", 1, "`convert` makes an OBJ"),
        ("union one.obj --subdivide --subdivide -o x.off", 1, "twice"),
        ("union open.obj --subdivide -o x.off", 3, "not a closed surface"),
        ("union one.obj --pattern linear:2:9,0,0 --subdivide -o x.off", 1, "by --pattern"),
        ("subdivide one.obj --subdivide -o x.off", 1, "every input is a cage"),
    ] {
        let ran = folder.run(line).exits(code);
        assert!(ran.err.contains(word), "{line}: {ran:?}");
    }
    let ran = folder.run("union one.obj --subdivide=fine -o x.off").exits(1);
    assert!(ran.err.contains("creases:DEGREES"), "{ran:?}");
}
