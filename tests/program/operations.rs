//! The program from outside: command lines, exit codes, verbs, reports, pictures.

#![cfg(feature = "cli")]

use crate::common::program::{self, Folder, cube, unit_cube, vertices, volume, workshop};
use serde_json::{Value, json};

#[test]
fn without_arguments_the_help_is_shown() {
    let ran = Folder::new().run("").exits(1).says("Usage:");
    assert_eq!(ran.out, "");
}

#[test]
fn help_and_version_go_to_standard_output() {
    let folder = Folder::new();
    for line in ["--help", "-h", "union --help", "convert -h"] {
        let ran = folder.run(line).exits(0);
        assert!(ran.out.contains("Usage:"), "{line}");
        assert_eq!(ran.err, "", "{line}");
    }
    assert_eq!(folder.run("--version").exits(0).out, format!("trisect {}\n", env!("CARGO_PKG_VERSION")));
}

#[test]
fn a_mistyped_verb_or_option_gets_a_suggestion() {
    let folder = workshop();
    folder.run("differense a.obj b.obj").exits(1).says("difference");
    folder.run("union a.obj b.obj --outpt c.obj").exits(1).says("--output");
}

#[test]
fn command_lines_that_make_no_sense_are_usage_errors() {
    let folder = workshop();
    let before = folder.names();
    for (line, reason) in [
        ("union", "required"),
        ("union a.obj b.obj", "nowhere to put the result"),
        ("difference a.obj -o c.obj", "at least two inputs"),
        ("union a.obj b.obj -o c.step", "cannot tell the format of c.step"),
        ("union a.obj b.obj -o c", "--output-format"),
        ("union a.obj b.obj -o -", "--output-format"),
        ("union a.obj b.obj -o c.obj -o c.obj", "twice"),
        ("union a.obj b.obj -o c.obj --report c.obj", "twice"),
        ("union a.obj b.obj -o - -o - --output-format obj", "standard output can be only one"),
        ("union a.obj b.obj -o - --output-format obj --json", "both want standard output"),
        ("union - b.obj -o c.obj", "--format"),
        ("union - - -o c.obj --format obj", "standard input can be only one"),
        ("union --translate 1,0,0 a.obj b.obj -o c.obj", "--translate stands before the first input"),
        ("union a.obj --translate 1,0 b.obj -o c.obj", "3 numbers"),
        ("union a.obj --scale 0 b.obj -o c.obj", "flatten"),
        ("union a.obj --matrix 1,2,3 b.obj -o c.obj", "16 numbers"),
        ("union a.obj b.obj -o c.obj --timeout -1", "more than 0"),
        ("union a.obj b.obj -o c.obj --memory 4X", "unit"),
        ("union a.obj b.obj -o c.obj --threads 0", "0 is not in"),
        ("union a.obj b.obj -o c.obj --threads -1", "-1 is not in"),
        ("union a.obj b.obj -o c.obj -q -v", "cannot be used with"),
        ("union a.obj b.obj -o .", "is a folder"),
        ("union a.obj b.obj -o c.obj --format dwg", "known formats: obj"),
        ("convert a.obj", "nowhere to put the result"),
        ("convert a.obj b.obj -o c.obj", "one input"),
        ("convert a.obj b.off --scale 2", "after the output"),
        ("convert a.obj c.obj --png-size 9x", "WIDTHxHEIGHT"),
        ("info", "required"),
    ] {
        let ran = folder.run(line).exits(1).says(reason);
        assert_eq!(ran.out.is_empty(), !line.contains("--json"), "{line}");
        assert_eq!(folder.names(), before, "{line}");
    }
}

#[test]
fn a_transform_that_overflows_is_a_usage_error_of_its_input() {
    let folder = workshop();
    folder
        .run("convert a.obj --scale 1e200 --scale 1e200 -o c.obj")
        .exits(1)
        .says("operand 1 (a.obj)")
        .says("out of the range");
    assert!(!folder.exists("c.obj"));
}

#[test]
fn unreadable_inputs_say_which_and_where() {
    let folder = workshop();
    let before = folder.names();
    folder.run("union a.obj none.obj -o c.obj").exits(2).says("trisect: error: operand 2 (none.obj): cannot");
    folder
        .run("union damaged.obj a.obj -o c.obj")
        .exits(2)
        .says("trisect: error: operand 1 (damaged.obj): damaged OBJ file, line 4");
    folder.run("convert damaged.obj c.off").exits(2).says("line 4");
    folder.run("info a.obj none.obj").exits(2).says("operand 2 (none.obj)");
    folder.run("union a.obj b.obj -o none/c.obj").exits(2).says("none/c.obj");
    folder.run("union a.obj b.obj -o a.obj/c.obj").exits(2).says("a.obj/c.obj");
    assert_eq!(folder.names(), before);
}

#[test]
fn errors_are_one_line() {
    let folder = workshop();
    for line in ["union a.obj none.obj -o c.obj", "union a.obj open.obj -o c.obj", "union a.obj b.obj"] {
        let ran = folder.run(line);
        assert_ne!(ran.code, 0);
        assert_eq!(ran.err.lines().count(), 1, "{ran:?}");
        assert!(ran.err.starts_with("trisect: "), "{ran:?}");
    }
}

#[test]
fn errors_are_json_objects_under_json() {
    let folder = workshop();
    let object = folder.run("union a.obj damaged.obj -o c.obj --json").exits(2).json();
    assert_eq!(object["schema"], 1);
    assert_eq!(object["exit_code"], 2);
    assert_eq!(object["verb"], "union");
    let error = &object["error"];
    assert_eq!(error["kind"], "unreadable");
    assert_eq!(error["operand"], 2);
    assert_eq!(error["file"], "damaged.obj");
    assert_eq!(error["format"], "obj");
    assert!(error["place"].as_str().is_some_and(|place| place.contains("line 4")), "{object}");
    assert!(error["message"].as_str().is_some_and(|message| message.starts_with("operand 2")), "{object}");

    let object = folder.run("union a.obj b.obj --colour --json").exits(1).json();
    assert_eq!(object["schema"], 1);
    assert_eq!(object["error"]["kind"], "usage");

    let object = folder.run("union a.obj open.obj -o c.obj --json").exits(3).json();
    assert_eq!(object["error"]["kind"], "unusable");
    assert!(object["error"]["diagnosis"].is_object(), "{object}");
}

#[test]
fn json_is_one_line() {
    let folder = workshop();
    for line in
        ["info a.obj --json", "check open.obj --json", "union a.obj none.obj --json", "nonsense --json"]
    {
        assert_eq!(folder.run(line).out.lines().count(), 1, "{line}");
    }
}

#[test]
fn unusable_operands_say_why() {
    let folder = workshop();
    folder
        .run("union a.obj open.obj -o c.obj")
        .exits(3)
        .says("operand 2 (open.obj): the mesh is not a closed surface");
    folder.run("union inside.obj a.obj -o c.obj").exits(3).says("operand 1 (inside.obj)").says("--orient");
    assert!(!folder.exists("c.obj"));
}

#[test]
fn convert_keeps_coordinates_and_shape() {
    let folder = workshop();
    folder.write("odd.obj", cube([0.1, 1.0 / 3.0, -1e-9], [1e9, 2.0 / 3.0, 123.456]));
    folder.run("convert odd.obj odd.off").exits(0).says("12 triangles").says("-> odd.off");
    folder.run("convert odd.off -o back.obj").exits(0);
    assert_eq!(vertices(&folder.read("back.obj")), vertices(&folder.read("odd.obj")));
    assert_eq!(volume(&folder.read("back.obj")), volume(&folder.read("odd.obj")));
}

#[test]
fn transforms_apply_in_the_order_of_the_command_line() {
    let folder = Folder::new();
    folder.write("a.obj", cube([0.0; 3], [1.0, 2.0, 3.0]));
    let corner = |line: &str| {
        folder.run(&format!("convert a.obj {line} -o b.obj")).exits(0);
        let text = folder.read("b.obj");
        assert!(volume(&text) > 0.0, "{line}: turned inside out");
        // The last corner was 1, 2, 3.
        vertices(&text)[7]
    };
    assert_eq!(corner("--translate 1,0,-1"), [2.0, 2.0, 2.0]);
    assert_eq!(corner("--scale 2 --translate 1,0,0"), [3.0, 4.0, 6.0]);
    assert_eq!(corner("--translate 1,0,0 --scale 2"), [4.0, 4.0, 6.0]);
    assert_eq!(corner("--scale 1,-1,2"), [1.0, -2.0, 6.0]);
    assert_eq!(corner("--rotate 90,0,0"), [1.0, -3.0, 2.0]);
    assert_eq!(corner("--rotate 0,90,0"), [3.0, 2.0, -1.0]);
    assert_eq!(corner("--rotate 0,0,90"), [-2.0, 1.0, 3.0]);
    assert_eq!(corner("--rotate 90,0,90"), [3.0, 1.0, 2.0], "about x first, then about z");
    assert_eq!(corner("--rotate 0,0,360"), [1.0, 2.0, 3.0]);
    assert_eq!(corner("--matrix 1,0,0,10,0,1,0,20,0,0,1,30,0,0,0,1"), [11.0, 22.0, 33.0]);
    // A mirror keeps the faces outwards.
    assert_eq!(corner("--matrix -1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1"), [-1.0, 2.0, 3.0]);
}

#[test]
fn matrices_may_be_separated_by_blanks() {
    let folder = workshop();
    let ran = folder.run_args(&[
        "convert",
        "a.obj",
        "--matrix",
        "2 0 0 0  0 2 0 0  0 0 2 0  0 0 0 1",
        "-o",
        "c.obj",
    ]);
    ran.exits(0);
    assert_eq!(volume(&folder.read("c.obj")), 8.0);
}

#[test]
fn check_tells_usable_from_unusable_from_unreadable() {
    let folder = workshop();
    let ran = folder.run("check a.obj b.obj").exits(0);
    assert!(ran.out.contains("a.obj: usable: 12 triangles, closed"), "{ran:?}");
    assert!(ran.out.contains("volume 1"), "{ran:?}");
    let ran = folder.run("check a.obj open.obj").exits(3);
    assert!(ran.out.contains("open.obj: not usable: the mesh is not a closed surface"), "{ran:?}");
    let ran = folder.run("check damaged.obj open.obj a.obj").exits(2);
    assert!(ran.out.contains("damaged.obj: unreadable: damaged OBJ file, line 4"), "{ran:?}");
    assert!(ran.out.contains("a.obj: usable"), "all are checked: {ran:?}");
    let ran = folder.run("check inside.obj").exits(3);
    assert!(ran.out.contains("--orient"), "{ran:?}");
    folder.run("check inside.obj --orient").exits(0);
    assert_eq!(folder.run("check a.obj -q").exits(0).out, "");
}

#[test]
fn check_reports_every_file_as_json() {
    let folder = workshop();
    let object = folder.run("check a.obj open.obj none.obj --json").exits(2).json();
    assert_eq!(object["schema"], 1);
    assert_eq!(object["usable"], false);
    let files = object["files"].as_array().expect("a list");
    let usable: Vec<&Value> = files.iter().map(|file| &file["usable"]).collect();
    assert_eq!(usable, [&json!(true), &json!(false), &json!(false)]);
    assert_eq!(files[0]["file"], "a.obj");
    assert_eq!(files[0]["volume"], 1.0);
    assert_eq!(files[0]["closed"], true);
    assert_eq!(files[0]["bounds"], json!([[0.0, 0.0, 0.0], [1.0, 1.0, 1.0]]));
    assert!(files[0]["self_crossings"].is_object());
    assert!(files[1]["diagnosis"].is_object());
    assert_eq!(files[1]["error"]["kind"], "unusable");
    assert_eq!(files[1]["triangles"], 11);
    assert_eq!(files[2]["error"]["kind"], "unreadable");
    let object = folder.run("check a.obj --assume-clean --json").exits(0).json();
    assert_eq!(object["files"][0]["self_crossings"], Value::Null);
}

#[test]
fn info_describes_files() {
    let folder = workshop();
    folder.write("two.obj", format!("g first\n{}g second\n", unit_cube()));
    let ran = folder.run("info two.obj open.obj").exits(0);
    for text in
        ["two.obj (OBJ)", "vertices   8", "triangles  12", "volume     1\n", "area       6", "first: 12"]
    {
        assert!(ran.out.contains(text), "'{text}' is missing: {ran:?}");
    }
    assert!(ran.out.contains("not a closed surface"), "{ran:?}");
    let object = folder.run("info two.obj open.obj --translate 0,0,5 --json").exits(0).json();
    assert_eq!(
        object["files"][0]["groups"][0],
        json!({
            "name": "first", "triangles": 12, "material": null, "base_color": null
        })
    );
    assert_eq!(object["files"][0]["volume"], 1.0);
    assert_eq!(object["files"][1]["volume"], Value::Null);
    assert_eq!(object["files"][1]["closed"], false);
    assert_eq!(object["files"][1]["bounds"], json!([[0.0, 0.0, 5.0], [1.0, 1.0, 6.0]]));
}

#[test]
fn info_lists_the_formats() {
    let folder = Folder::new();
    let ran = folder.run("info --formats").exits(0);
    for extension in [".obj", ".gltf", ".glb", ".stl", ".ply", ".off", ".3mf"] {
        assert!(ran.out.contains(extension), "{ran:?}");
    }
    let object = folder.run("info --formats --json").exits(0).json();
    assert_eq!(object["formats"].as_array().map(Vec::len), Some(7));
}

#[test]
fn strict_turns_warnings_into_an_exit_code_after_writing() {
    let folder = workshop();
    folder.run("convert warned.obj c.off").exits(0).says("trisect: warning: warned.obj: ");
    let ran = folder.run("convert warned.obj d.off --strict --report r.json").exits(5).says("1 warning");
    assert!(ran.err.contains("warning"), "{ran:?}");
    assert!(folder.read("d.off").starts_with("OFF"));
    let report: Value = serde_json::from_str(&folder.read("r.json")).expect("JSON");
    assert_eq!(report["exit_code"], 5);
    assert_eq!(report["warnings"].as_array().map(Vec::len), Some(1));
    folder.run("convert a.obj e.off --strict").exits(0);
    folder.run("check warned.obj --strict").exits(5);
}

#[test]
fn a_dry_run_reads_and_checks_but_writes_nothing() {
    let folder = workshop();
    let before = folder.names();
    let ran = folder.run("difference a.obj b.obj -o c.obj --png d.png --dry-run").exits(0);
    assert!(ran.err.contains("a.obj: 12 triangles, closed"), "{ran:?}");
    assert!(ran.err.contains("dry run: would"), "{ran:?}");
    assert!(ran.err.contains("c.obj (obj), d.png (png)"), "{ran:?}");
    folder.run("difference a.obj open.obj -o c.obj --dry-run").exits(3);
    folder.run("convert a.obj c.off --dry-run").exits(0).says("would write c.off");
    let object = folder.run("union a.obj b.obj --dry-run --json").exits(0).json();
    assert_eq!(object["dry_run"], true);
    assert_eq!(object["operands"].as_array().map(Vec::len), Some(2));
    assert_eq!(folder.names(), before);
}

#[test]
fn what_is_a_hair_short_goes_through_when_snapped() {
    let folder = Folder::new();
    folder.write("plate.obj", cube([0.0; 3], [4.0, 4.0, 1.0]));
    folder.write("short.obj", cube([1.0, 1.0, 1e-8], [3.0, 3.0, 1.0 - 1e-8]));
    // Films are left, and the warning says what takes them away.
    folder.run("difference plate.obj short.obj -o c.obj").exits(0).says("--snap 1e-6").says("2 shells");
    let ran = folder.run("difference plate.obj short.obj -o c.obj --snap 1e-6 --json").exits(0);
    let ran = ran.says("snapped by up to 1e-6: 8 vertices moved");
    let report: Value = serde_json::from_str(&ran.out).unwrap();
    let certificate = &report["result"]["certificate"];
    assert_eq!((&certificate["genus"], &certificate["components"]), (&json!(1), &json!(1)));
    assert_eq!(certificate["snapping"]["unfinished"], false);
    assert_eq!(volume(&folder.read("c.obj")), 12.0);
    for wrong in ["0", "-1", "nan", "short"] {
        folder
            .run(&format!("difference plate.obj short.obj -o c.obj --snap {wrong}"))
            .exits(1)
            .says("--snap");
    }
}

#[test]
fn operands_are_described_one_by_one() {
    let folder = workshop();
    let line = "union a.obj --translate 0,0,2 inside.obj --scale 2 --orient --dry-run --json -v";
    let ran = folder.run(line).exits(0);
    let operands = &ran.json()["operands"];
    assert_eq!(operands[0]["operand"], 1);
    assert_eq!(operands[0]["transforms"], json!(["translate 0,0,2"]));
    assert_eq!(operands[0]["turned"], false);
    assert_eq!(operands[0]["bounds"], json!([[0.0, 0.0, 2.0], [1.0, 1.0, 3.0]]));
    assert_eq!(operands[1]["transforms"], json!(["scale 2,2,2"]));
    assert_eq!(operands[1]["turned"], true);
    assert_eq!(operands[1]["volume"], 8.0);
    assert_eq!(operands[1]["format"], "obj");
    assert!(ran.err.contains("turned outwards"), "{ran:?}");
    assert!(ran.err.contains("  scale 2,2,2"), "{ran:?}");
}

#[test]
fn very_verbose_runs_name_their_stages() {
    workshop().run("convert a.obj c.off -vv").exits(0).says("s] reading a.obj").says("s] writing");
}

#[test]
fn pictures_have_the_size_asked_for_and_show_the_mesh() {
    let folder = workshop();
    folder.run("convert a.obj --png c.png --png-size 60x40").exits(0);
    folder.run("convert a.obj -o d.png --png-size 60x40 --view top --png-parallel").exits(0);
    let picture = |name: &str| {
        let file = std::io::Cursor::new(program::bytes(&folder.path(name)));
        let mut reader = png::Decoder::new(file).read_info().expect("a PNG file");
        let mut pixels = vec![0; reader.output_buffer_size().expect("a size")];
        let info = reader.next_frame(&mut pixels).expect("pixels");
        assert_eq!((info.width, info.height), (60, 40), "{name}");
        pixels
    };
    // From the top, in parallel projection, the cube is a square nine tenths as high as the picture.
    let top = picture("d.png");
    let grey = |x: usize, y: usize| top[3 * (60 * y + x) + 1];
    let covered = (0..60).filter(|&x| grey(x, 20).abs_diff(grey(0, 20)) > 8).count();
    assert_eq!(covered, 36);
    assert_ne!(picture("c.png"), top);
}

#[test]
fn the_memory_ceiling_is_a_limit() {
    let folder = workshop();
    let object = folder.run("union a.obj b.obj -o c.obj --memory 100 --json").exits(4).json();
    assert_eq!(object["error"]["kind"], "limit");
    folder.run("convert a.obj c.obj --memory 100").exits(4).says("limit of 100");
    folder.run("convert a.obj c.obj --memory 1M").exits(0);
}

#[test]
fn thread_counts_do_not_change_a_byte() {
    let folder = Folder::new();
    folder.write("a.off", program::sphere(40, 1.0, [0.1, 0.2, 0.3]));
    for threads in [1, 2, 8, 1024] {
        folder
            .run(&format!("convert a.off -o {threads}.obj --png {threads}.png --threads {threads}"))
            .exits(0);
    }
    for extension in ["obj", "png"] {
        let one = program::bytes(&folder.path(&format!("1.{extension}")));
        assert_eq!(program::bytes(&folder.path(&format!("2.{extension}"))), one);
        assert_eq!(program::bytes(&folder.path(&format!("8.{extension}"))), one);
    }
}

#[test]
fn help_is_a_verb_and_words_that_mean_verbs_get_a_hint() {
    let folder = workshop();
    assert!(folder.run("help union").exits(0).out.contains("Usage: trisect union"));
    for (word, verb) in [
        ("minus", "`difference`"),
        ("cut", "`trisect difference a.obj b.obj"),
        ("unite", "`union`"),
        ("repair", "`check`"),
    ] {
        let ran = folder.run(&format!("{word} a.obj b.obj")).exits(1).says(verb);
        assert_eq!(ran.err.lines().count(), 1, "{ran:?}");
    }
    let object = folder.run("plus a.obj b.obj --json").exits(1).json();
    assert!(object["error"]["message"].as_str().unwrap().contains("`union`"), "{object}");
}

#[test]
fn all_errors_begin_alike_and_are_coloured_on_request() {
    let folder = workshop();
    for line in ["union a.obj", "union a.obj b.obj --outpt c.obj", "unin", "minus"] {
        let ran = folder.run(line).exits(1);
        assert!(ran.err.starts_with("trisect: error: "), "{ran:?}");
        let ran = folder.run(&format!("{line} --color always")).exits(1);
        assert!(
            ran.err.starts_with("\x1b[1m\x1b[31mtrisect:") || ran.err.starts_with("\x1b[1;31mtrisect:"),
            "{ran:?}"
        );
    }
    let ran = folder.run("convert warned.obj c.off --color=always").exits(0);
    assert!(ran.err.starts_with("\x1b[1;33mtrisect: warning:\x1b[0m"), "{ran:?}");
    let ran = folder.run("union a.obj b.obj -o c.obj --threads -1").exits(1).says("-1 is not in 1..=1024");
    assert!(!ran.err.contains("-- -1"), "{ran:?}");
}

#[test]
fn inside_out_shells_are_named_by_their_numbers_in_the_file() {
    let folder = Folder::new();
    // A pair of opposite triangles comes first: the cleaning leaves it out, and it counts in the file's numbers.
    let (mut text, second) = (unit_cube().replacen('f', "f 1 2 7\nf 7 2 1\nf", 1), cube([5.0; 3], [5.5; 3]));
    for line in program::inside_out(&second).lines() {
        let shifted =
            |word: &str| word.parse::<u32>().map_or(word.to_owned(), |corner| (corner + 8).to_string());
        let words: Vec<String> = line.split(' ').map(shifted).collect();
        text += &if line.starts_with('f') { words.join(" ") + "\n" } else { format!("{line}\n") };
    }
    folder.write("two.obj", text);
    let ran = folder.run("check two.obj").exits(3);
    assert!(ran.out.contains("one of its shells faces the wrong way"), "{ran:?}");
    let number = |text: &str| {
        let after = text.split("triangle ").nth(1).expect("a number");
        after.split(' ').next().expect("a word").parse::<u32>().expect("a number")
    };
    assert_eq!(number(&ran.out), 14, "{ran:?}");
    assert_eq!(number(&folder.run("union two.obj two.obj -o c.obj").exits(3).err), 14);
}

#[test]
fn a_film_is_warned_about_with_its_place() {
    let folder = workshop();
    folder.write("body.obj", cube([0.0; 3], [1.0; 3]));
    folder.write("tool.obj", cube([0.25, 0.25, 0.0], [0.75, 0.75, 0.999_999_999]));
    let ran = folder.run("difference body.obj tool.obj -o cut.obj --json --strict").exits(5);
    let ran =
        ran.says("4 corners of the result are nearly flush").says("1.0e-9 at (0.25, 0.25, 0.999999999)");
    let object = ran.json();
    let near = &object["result"]["certificate"]["nearly_flush"];
    assert_eq!(near["count"], 4, "{near}");
    assert_eq!(near["places"].as_array().map(Vec::len), Some(4));
    // What is flush, or thick, is not told.
    folder.write("tool.obj", cube([0.25, 0.25, 0.0], [0.75, 0.75, 1.0]));
    folder.run("difference body.obj tool.obj -o cut.obj --strict").exits(0);
}

#[test]
fn expressions_and_counts_of_several_inputs() {
    let folder = Folder::new();
    folder.write("a.obj", unit_cube());
    folder.write("b.obj", cube([0.5; 3], [1.5; 3]));
    folder.write("c.obj", cube([0.25; 3], [0.75; 3]));
    // The unit cube, one moved by half of it, and one in the middle of the first.
    folder.run("combine --expr a-(b+c) a.obj b.obj c.obj -o e.obj").exits(0);
    let volume_of = |name: &str| volume(&folder.read(name));
    assert_eq!(volume_of("e.obj"), 1.0 - 0.125 - 0.125 + 0.015625);
    folder.run("combine --expr body&pin body=a.obj pin=c.obj -o e.obj").exits(0);
    assert_eq!(volume_of("e.obj"), 0.125);
    folder.run("combine --at-least 2 a.obj b.obj c.obj -o e.obj").exits(0);
    assert_eq!(volume_of("e.obj"), 0.125 + 0.125 - 0.015625);
    folder.run("combine --all a.obj b.obj -o e.obj").exits(0).says("intersection: ");
    assert_eq!(volume_of("e-union.obj"), 1.875);
    assert_eq!(volume_of("e-intersection.obj"), 0.125);
    assert_eq!((volume_of("e-difference.obj"), volume_of("e-reverse.obj")), (0.875, 0.875));
}

#[test]
fn expressions_that_cannot_be_meant_are_refused_with_the_place() {
    let folder = Folder::new();
    folder.write("a.obj", unit_cube());
    folder.write("b.obj", cube([0.5; 3], [1.5; 3]));
    folder.run("combine a.obj b.obj -o e.obj").exits(1);
    folder.run("combine --expr a- a.obj b.obj -o e.obj").exits(1).says("character 3");
    folder.run("combine --expr a+d a.obj b.obj -o e.obj").exits(1).says("no operand is called 'd'");
    folder.run("combine --expr a a.obj b.obj -o e.obj").exits(1).says("does not name operand b (b.obj)");
    folder.run("combine --at-least 3 a.obj b.obj -o e.obj").exits(1).says("is nothing");
    folder.run("combine --all a.obj -o e.obj").exits(1).says("takes two inputs");
    folder.run("resolve a.obj b.obj -o e.obj").exits(1).says("takes one input");
    folder.run("resolve a.obj --rule odd -o e.obj").exits(1).says("known are positive, nonzero, even-odd");
}
