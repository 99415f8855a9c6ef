//! The program and the system: streams, files, pipes, links, signals.

#![cfg(feature = "cli")]

use crate::common::program::{self, Folder, unit_cube, volume, workshop};
use serde_json::Value;

#[test]
fn standard_streams_need_formats_and_carry_meshes() {
    let folder = workshop();
    let ran =
        folder.run_with("convert - - --format obj --output-format off", unit_cube().as_bytes()).exits(0);
    assert!(ran.out.starts_with("OFF"), "{ran:?}");
    assert!(ran.err.contains("standard input") && ran.err.contains("standard output"), "{ran:?}");
    folder.write("piped.off", &ran.bytes);
    folder.run("convert piped.off piped.obj").exits(0);
    assert_eq!(volume(&folder.read("piped.obj")), 1.0);
}

#[test]
fn a_format_option_overrides_names() {
    let folder = workshop();
    folder.write("cube.dat", unit_cube());
    folder.run("convert cube.dat --format obj -o cube.out --output-format off").exits(0);
    assert!(folder.read("cube.out").starts_with("OFF"));
    folder.run("convert cube.out --format off c.obj").exits(0);
    assert_eq!(volume(&folder.read("c.obj")), 1.0);
}

#[test]
fn several_outputs_are_written_at_once() {
    let folder = workshop();
    let ran = folder.run("convert a.obj -o b.off -o c.obj --png d.png --report r.json -q").exits(0);
    assert_eq!((ran.out.as_str(), ran.err.as_str()), ("", ""));
    assert_eq!(volume(&folder.read("c.obj")), 1.0);
    let report: Value = serde_json::from_str(&folder.read("r.json")).expect("JSON");
    assert_eq!(report["verb"], "convert");
    let outputs = report["outputs"].as_array().expect("a list");
    assert_eq!(outputs.len(), 3);
    assert_eq!(outputs[2]["file"], "d.png");
    assert_eq!(outputs[2]["format"], "png");
    assert_eq!(outputs[0]["bytes"], folder.read("b.off").len());
    assert!(!folder.names().iter().any(|name| name.starts_with('.')), "{:?}", folder.names());
}

#[test]
fn a_failed_run_leaves_old_outputs_alone_and_no_new_ones() {
    let folder = workshop();
    folder.write("c.off", "precious");
    let before = folder.names();
    for line in [
        "convert damaged.obj c.off",
        "convert a.obj -o c.off -o none/d.off",
        "union a.obj open.obj -o c.off -o d.obj",
        "convert none.obj c.off --json",
    ] {
        assert_ne!(folder.run(line).code, 0, "{line}");
        assert_eq!(folder.names(), before, "{line}");
        assert_eq!(folder.read("c.off"), "precious", "{line}");
    }
}

#[test]
fn the_report_of_a_failed_run_says_so() {
    let folder = workshop();
    folder.run("convert damaged.obj c.off --report r.json").exits(2);
    let report: Value = serde_json::from_str(&folder.read("r.json")).expect("JSON");
    assert_eq!(report["exit_code"], 2);
    assert_eq!(report["error"]["kind"], "unreadable");
    folder.run("convert a.obj c.off --report none/r.json").exits(2).says("none/r.json");
}

#[test]
fn an_output_that_is_write_protected_is_left_alone() {
    let folder = workshop();
    folder.write("kept.off", "precious");
    let path = folder.path("kept.off");
    let mut permissions = path.metadata().expect("it exists").permissions();
    permissions.set_readonly(true);
    std::fs::set_permissions(&path, permissions).expect("it can be protected");
    folder.run("convert a.obj kept.off").exits(2).says("kept.off");
    assert_eq!(folder.read("kept.off"), "precious");
}

#[cfg(unix)]
#[test]
fn an_output_that_is_a_link_stays_one() {
    let folder = workshop();
    folder.write("real.off", "old");
    std::os::unix::fs::symlink(folder.path("real.off"), folder.path("link.off")).expect("a link");
    folder.run("convert a.obj link.off").exits(0);
    assert!(folder.path("link.off").is_symlink());
    assert!(folder.read("real.off").starts_with("OFF"));
}

#[cfg(unix)]
#[test]
fn pipes_in_the_file_system_are_written_to_and_not_replaced() {
    use std::os::unix::fs::FileTypeExt as _;
    let folder = workshop();
    let made = std::process::Command::new("mkfifo").arg(folder.path("pipe.off")).status();
    assert!(made.expect("mkfifo starts").success());
    let pipe = folder.path("pipe.off");
    let reader = std::thread::spawn(move || std::fs::read_to_string(pipe).expect("text"));
    folder.run("convert a.obj pipe.off").exits(0);
    assert!(reader.join().expect("the reader ends").starts_with("OFF"));
    assert!(folder.path("pipe.off").metadata().expect("it exists").file_type().is_fifo());
}

#[test]
fn a_reader_that_goes_away_is_no_failure() {
    let folder = Folder::new();
    folder.write("big.off", program::sphere(120, 1.0, [0.0; 3]));
    for line in ["convert big.off -o - --output-format obj -q", "info big.off -q"] {
        let mut child = folder.start(line);
        drop(child.stdout.take());
        let ran = program::ran(child.wait_with_output().expect("the program ends"));
        assert_eq!((ran.code, ran.err.as_str()), (0, ""), "{line}");
    }
}

#[test]
fn the_deadline_ends_a_run_that_waits_for_input() {
    let folder = Folder::new();
    let mut child = folder.start("convert - c.off --format obj --timeout 0.2 --json");
    // Held open, so that the input never ends.
    let _input = child.stdin.take();
    let ran = program::ran(child.wait_with_output().expect("the program ends")).exits(4).says("time limit");
    assert_eq!(ran.json()["error"]["kind"], "limit");
    assert!(folder.names().is_empty());
}

#[cfg(unix)]
#[test]
fn signals_end_a_run_that_waits_for_input() {
    for name in ["INT", "TERM"] {
        let folder = Folder::new();
        let mut child = folder.start("convert - c.off --format obj -vv");
        let _input = child.stdin.take();
        let (code, rest) = program::interrupted(child, |line| line.contains("reading"), name);
        assert_eq!((code, rest.contains("cancelled")), (Some(4), true), "{name}: {rest}");
        assert!(folder.names().is_empty());
    }
}
