//! Hulls, sums, offsets, shells, patterns, text, measures and distances.

use serde_json::Value;

use super::common::program::Folder;

const FONT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/fixtures/fonts/DejaVuSans-Latin.ttf");

/// A tetrahedron in two groups.
const NAMED: &str =
    "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\ng side\nf 1 3 2\nf 1 2 4\ng other\nf 2 3 4\nf 3 1 4\n";

fn volume(object: &Value) -> f64 {
    object["result"]["volume"].as_f64().expect("a volume")
}

#[test]
fn hulls_of_one_and_of_several() {
    let folder = Folder::new();
    let ran = folder.run("hull torus:3,1,24 -o hull.stl --json").exits(0);
    assert_eq!(ran.json()["result"]["genus"], 0);
    let both = folder.run("hull box:2 box:2 --translate 10,0,0 -o hull.off --json").exits(0);
    assert_eq!((volume(&both.json()), both.json()["result"]["vertices"].as_u64()), (48.0, Some(8)));
    folder.write("flat.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    folder.run("hull flat.obj -o x.off").exits(3).says("one plane");
    folder.write("named.obj", NAMED);
    folder.run("hull named.obj -o hull.off").exits(0).says("groups and materials not kept");
    folder.run("hull box:1").exits(1).says("nowhere to put the result");
    assert!(!folder.exists("x.off"));
}

#[test]
fn sums_need_a_convex_tool() {
    let folder = Folder::new();
    let sum = folder.run("minkowski box:4,3,2 box:1 -o sum.off --json").exits(0).json();
    assert_eq!((volume(&sum), sum["result"]["triangles"].as_u64()), (60.0, Some(12)));
    let round = folder.run("minkowski box:4,3,2 sphere:0.5,16 -o round.off --json").exits(0).json();
    // V + A d + pi (a + b + c) d^2 + 4/3 pi d^3 for a ball; a polyhedron in it makes less.
    let steiner = 24.0 + 52.0 * 0.5 + std::f64::consts::PI * (9.0 * 0.25 + 4.0 / 3.0 * 0.125);
    assert!(volume(&round) < steiner && volume(&round) > 0.98 * steiner, "{round}");
    folder.run("minkowski box:4 torus:3,1 -o x.off").exits(3).says("must be convex").says("trisect hull");
    folder.run("minkowski box:4 -o x.off").exits(1).says("two inputs");
}

#[test]
fn offsets_and_shells_say_how_near_they_are() {
    let folder = Folder::new();
    let grown = folder.run("offset box:4 --distance 1 --tolerance 0.3 -o grown.off --json").exits(0).json();
    let steiner = 64.0 + 96.0 + std::f64::consts::PI * (12.0 + 4.0 / 3.0);
    assert!((volume(&grown) - steiner).abs() < 0.3 * 150.0, "{grown}");
    assert!(grown["deviation"].as_f64() <= grown["tolerance"].as_f64());
    folder.run("offset box:4 --distance=-3 --tolerance 0.5 -o none.off --json").exits(0);
    let rough = folder.run("offset box:4 --distance 1 --tolerance 0.3 --no-smooth --json").exits(0).json();
    let triangles = |report: &Value| report["result"]["triangles"].as_u64().expect("a number");
    assert!(triangles(&grown) < triangles(&rough));
    let hollow = folder
        .run("hollow box:20 --wall 2 --drain 0,0,-10:1.5 --tolerance 0.8 -o hollow.stl --json")
        .exits(0);
    let result = &hollow.json()["result"];
    assert_eq!((result["shells"].as_u64(), result["manifold"].as_bool()), (Some(1), Some(true)));
    let found = folder.run("measure hollow.stl --at 0,0,10 --at 10,0,0 --json").exits(0).json();
    for point in found["files"][0]["points"].as_array().expect("points") {
        let wall = point["thickness"].as_f64().expect("a wall");
        assert!((wall - 2.0).abs() < 0.8, "{point}");
    }
    folder.run("hollow box:2 --wall 2 -o x.stl").exits(3).says("no room inside");
    folder.run("hollow box:2 -o x.stl").exits(1).says("--wall");
    folder.run("offset box:2 --distance 0 -o x.stl").exits(3).says("not zero");
    folder.write("named.obj", NAMED);
    folder
        .run("offset named.obj --distance 0.2 --tolerance 0.2 -o named.off")
        .exits(0)
        .says("named.obj: groups and materials not kept");
}

#[test]
fn patterns_are_one_operand() {
    let folder = Folder::new();
    let line = "difference box:12,12,1 cylinder:0.3,4,12 --translate=-4.5,-4.5,0 --pattern grid:10x10:1,1 -o plate.off --json";
    let plate = folder.run(line).exits(0).json();
    assert_eq!(plate["result"]["genus"], 100);
    assert_eq!(plate["operands"][1]["transforms"][1], "pattern grid:10x10x1:1,1,0");
    folder.write("places.csv", "x,y,z\n-3,0,0\n3,0,0\n");
    let two = folder
        .run("difference box:12,12,1 cylinder:1,4 --pattern points:places.csv -o two.off --json")
        .exits(0);
    assert_eq!(two.json()["result"]["genus"], 2);
    folder.write("line.txt", "-4 -4 0\n4 -4 0\n4 4 0\n-4 4 0\n-4 -4 0\n");
    let ring = "difference box:12,12,1 box:0.5,0.2,4 --pattern along:line.txt:16:turn -o ring.off --json";
    assert_eq!(folder.run(ring).exits(0).json()["result"]["genus"], 16);
    // Copies that overlap are resolved.
    let chain = folder.run("union box:2 --pattern linear:5:1,0,0 box:1 -o chain.off --json").exits(0).json();
    assert_eq!((volume(&chain), chain["result"]["shells"].as_u64()), (24.0, Some(1)));
    folder.run("union box:1 --pattern points:none.csv box:1 -o x.off").exits(2).says("none.csv");
    folder.run("union box:1 --pattern grid:0x1:1,1 box:1 -o x.off").exits(1).says("number of copies");
    folder
        .run("union box:1 --pattern linear:9999999:2,0,0 box:1 -o x.off --memory 100M")
        .exits(4)
        .says("limit");
    folder.run("union box:1 --pattern linear:999999999:2,0,0 box:1 -o x.off").says("at most 10000000");
}

#[test]
fn transforms_by_bounds() {
    let folder = Folder::new();
    let bounds = |line: &str| -> Vec<f64> {
        let object = folder.run(&format!("convert {line} -o out.off --json")).exits(0).json();
        let corners = object["input"]["bounds"].as_array().expect("bounds").clone();
        corners
            .iter()
            .flat_map(|corner| corner.as_array().expect("three").clone())
            .map(|x| x.as_f64().expect("a number"))
            .collect()
    };
    let block = "box:2,4,6 --translate 10,20,30";
    assert_eq!(bounds(&format!("{block} --center")), [-1.0, -2.0, -3.0, 1.0, 2.0, 3.0]);
    assert_eq!(bounds(&format!("{block} --center=xy --drop")), [-1.0, -2.0, 0.0, 1.0, 2.0, 6.0]);
    assert_eq!(bounds(&format!("{block} --align x=high:5 --align y=low")), [3.0, 0.0, 27.0, 5.0, 4.0, 33.0]);
    assert_eq!(bounds(&format!("{block} --mirror x")), [-11.0, 18.0, 27.0, -9.0, 22.0, 33.0]);
    assert_eq!(bounds("box:2,4,6 --fit 12 --rotate 90"), [-4.0, -2.0, -6.0, 4.0, 2.0, 6.0]);
    assert_eq!(bounds("box:2,4,6 --scale 50%"), [-0.5, -1.0, -1.5, 0.5, 1.0, 1.5]);
    folder.run("convert box:1 --align z -o out.off").exits(1).says("z=low:10");
    folder.run("convert box:1 --fit 0 -o out.off").exits(1).says("more than zero");
}

#[test]
fn text_is_an_input_and_a_verb() {
    let folder = Folder::new();
    let run = |words: &[&str]| folder.run_args(words);
    let set =
        run(&["text", "B8\\nO", "--font", FONT, "--size", "8", "--depth", "2", "-o", "t.stl", "--json"])
            .exits(0);
    let result = set.json()["result"].clone();
    assert_eq!((result["shells"].as_u64(), result["genus"].as_u64()), (Some(3), Some(5)));
    let words = [
        "difference",
        "box:40,12,4",
        "text:No 42",
        "--font",
        FONT,
        "--size",
        "8",
        "--depth",
        "3",
        "--center=xy",
    ];
    let engraved =
        run(&[&words[..], &["--translate", "0,0,1", "-o", "e.stl", "--json"]].concat()).exits(0).json();
    assert!(volume(&engraved) < 40.0 * 12.0 * 4.0 - 20.0, "{engraved}");
    assert_eq!(engraved["operands"][1]["file"], "text:No 42");
    run(&["text", "A", "-o", "x.stl"]).exits(1).says("--font");
    run(&["text", "A", "--font", "none.ttf", "-o", "x.stl"]).exits(2).says("none.ttf");
    run(&["text", "\u{4e2d}", "--font", FONT, "-o", "x.stl"]).exits(1).says("U+4E2D");
    run(&["union", "box:1", "--font", FONT, "box:1", "-o", "x.stl"]).exits(1).says("text:...");
    folder.write("no.ttf", "not a font");
    run(&["text", "A", "--font", "no.ttf", "-o", "x.stl"]).exits(2).says("no TrueType");
}

#[test]
fn shapes_are_inputs() {
    let folder = Folder::new();
    let ran =
        folder.run("difference box:4,4,1 cylinder:1,3 sphere:1 --translate 2,2,0 -o x.off --json").exits(0);
    assert_eq!(ran.json()["operands"][0]["file"], "box:4,4,1");
    folder.run("union box:1,2 sphere:1 -o x.off").exits(1).says("box:X,Y,Z");
    // A file of such a name is that file.
    folder.write("box:9", "OFF\n4 4 0\n0 0 0\n6 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 2 0 3\n");
    folder.run("info box:9 --format off").exits(0).prints("volume     1\n");
}

#[test]
fn measures_and_points() {
    let folder = Folder::new();
    folder.write("points.txt", "0 0 0\n0 0 5\n1 0 0\n");
    let ran = folder.run("measure box:2,4,6 --points points.txt --json").exits(0).json();
    let file = &ran["files"][0];
    assert_eq!((file["volume"].as_f64(), file["centroid"][1].as_f64()), (Some(48.0), Some(0.0)));
    let moment = file["inertia"][0][0].as_f64().expect("a number");
    assert!((moment - 48.0 * (16.0 + 36.0) / 12.0).abs() < 1e-9);
    let sides: Vec<&str> = (0..3).map(|k| file["points"][k]["side"].as_str().expect("a side")).collect();
    assert_eq!(sides, ["inside", "outside", "on"]);
    assert_eq!(file["points"][1]["distance"], 2.0);
    assert_eq!(file["points"][2]["thickness"], 2.0);
    folder.run("measure box:2 --at 0,0,1").exits(0).prints("at 0 0 1: on").prints("wall 2");
    folder.write("bad.txt", "1 2\n");
    folder.run("measure box:2 --points bad.txt").exits(2).says("line 1");
}

#[test]
fn distances_and_overlaps() {
    let folder = Folder::new();
    let apart = folder.run("distance box:2 box:2 --translate 5,0,0 --json").exits(0).json();
    assert_eq!((apart["distance"].as_f64(), apart["overlap_volume"].as_f64()), (Some(3.0), Some(0.0)));
    let over = folder.run("distance box:2 box:2 --translate 1,1,1 --json").exits(0).json();
    assert_eq!((over["distance"].as_f64(), over["overlap_volume"].as_f64()), (Some(0.0), Some(1.0)));
    let inside = folder.run("distance box:6 box:2 --json").exits(0).json();
    assert_eq!((inside["encloses"].as_bool(), inside["surface_distance"].as_f64()), (Some(true), Some(2.0)));
    assert_eq!(inside["overlap_volume"], 8.0);
    folder.run("distance box:2 box:2 --translate 5,0,0").exits(0).prints("distance 3");
    folder.run("distance box:2").exits(1).says("two inputs");
}

#[test]
fn operands_are_groups_where_that_is_asked_for() {
    let folder = Folder::new();
    folder.run("convert box:2 -o body.off").exits(0);
    folder.run("difference body.off box:1 --translate 1,1,1 box:1 --translate=-1,-1,-1 --color-by operand -o c.glb").exits(0);
    let info = folder.run("info c.glb --json").exits(0).json();
    let groups = info["files"][0]["groups"].as_array().expect("groups").clone();
    let names: Vec<&str> = groups.iter().map(|group| group["name"].as_str().expect("a name")).collect();
    assert_eq!(names, ["body", "box:1", "box:1 2"]);
    assert_ne!(groups[0]["base_color"], groups[1]["base_color"]);
}

#[test]
fn model_nodes_make_the_same() {
    let folder = Folder::new();
    let model = |text: &str| {
        folder.write("model.json", text);
        folder.run("eval model.json -o model.off --json")
    };
    let hull = model(
        r#"{"kind": "hull", "operands": [{"kind": "box", "size": [2, 2, 2]},
        {"kind": "box", "size": [2, 2, 2], "transform": [{"translate": [10, 0, 0]}]}]}"#,
    );
    assert_eq!(volume(&hull.exits(0).json()), 48.0);
    let sum = model(
        r#"{"kind": "minkowski", "operands": [{"kind": "box", "size": [4, 3, 2]}, {"kind": "box", "size": [1, 1, 1]}]}"#,
    );
    assert_eq!(volume(&sum.exits(0).json()), 60.0);
    let row = model(
        r#"{"kind": "pattern", "operand": {"kind": "box", "size": [1, 1, 1]},
        "pattern": {"linear": {"count": 4, "step": [3, 0, 0]}}}"#,
    );
    assert_eq!(row.exits(0).json()["result"]["shells"], 4);
    let shell = model(
        r#"{"kind": "hollow", "operand": {"kind": "box", "size": [10, 10, 10]}, "wall": 1.5, "tolerance": 0.6}"#,
    );
    assert_eq!(shell.exits(0).json()["result"]["shells"], 2);
    let grown = model(
        r#"{"kind": "offset", "operand": {"kind": "box", "size": [4, 4, 4]}, "distance": -1, "tolerance": 0.3}"#,
    );
    assert!((volume(&grown.exits(0).json()) - 8.0).abs() < 3.0);
    let text = format!(r#"{{"kind": "text", "text": "O", "font": "{FONT}", "size": 5, "depth": 1}}"#);
    assert_eq!(model(&text).exits(0).json()["result"]["genus"], 1);
    model(r#"{"kind": "pattern", "operand": {"kind": "box", "size": [1, 1, 1]}, "pattern": {"spiral": 3}}"#)
        .exits(3)
        .says("linear");
    model(r#"{"kind": "hollow", "operand": {"kind": "box", "size": [1, 1, 1]}}"#).exits(3).says("`wall`");
    model(r#"{"kind": "minkowski", "operands": [{"kind": "box", "size": [1, 1, 1]}]}"#)
        .exits(3)
        .says("takes 2");
}
