//! Many jobs from a file.

use std::collections::BTreeSet;

use serde_json::{Value, json};

use crate::common::program::Folder;

fn run(folder: &Folder, line: &str) -> (i32, String) {
    let ran = folder.run(line);
    (ran.code, ran.err)
}

/// Two cubes, an open box and a file that is none.
fn files(folder: &Folder) {
    let mut box_ = String::from("OFF\n8 12 0\n");
    for i in 0..8 {
        box_.push_str(&format!("{} {} {}\n", i & 1, i >> 1 & 1, i >> 2));
    }
    for [a, b, c, d] in [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]] {
        box_.push_str(&format!("3 {a} {b} {c}\n3 {a} {c} {d}\n"));
    }
    folder.write("cube.off", &box_);
    folder.write("open.off", box_.replace("8 12 0", "8 11 0").replacen("3 0 2 3\n", "", 1));
    folder.write("broken.off", "OFF\n3 1 0\n");
}

fn jobs() -> Vec<Value> {
    let moved = json!({ "file": "cube.off", "translate": [0.5, 0.5, 0.5] });
    let mut jobs: Vec<Value> = ["union", "difference", "intersection", "xor"]
        .iter()
        .map(|verb| json!({ "id": verb, "verb": verb, "inputs": ["cube.off", moved], "output": format!("out/{verb}.ply") }))
        .collect();
    jobs.push(json!({ "id": "open", "verb": "union", "inputs": ["open.off", "cube.off"], "output": "out/open.ply" }));
    let filled = json!({ "file": "open.off", "fill-holes": true });
    jobs.push(json!({ "id": "filled", "verb": "union", "inputs": [filled], "output": "out/filled.ply" }));
    jobs.push(
        json!({ "id": "broken", "verb": "union", "inputs": ["broken.off"], "output": "out/broken.ply" }),
    );
    jobs.push(json!({ "id": "wrong", "verb": "merge", "inputs": ["cube.off"] }));
    jobs
}

fn reports(folder: &Folder) -> Vec<Value> {
    folder.read("reports.jsonl").lines().map(|line| serde_json::from_str(line).unwrap()).collect()
}

fn status(reports: &[Value], id: &str) -> String {
    let of_job: Vec<&Value> = reports.iter().filter(|report| report["id"] == id).collect();
    assert_eq!(of_job.len(), 1, "{id} is reported once");
    of_job[0]["status"].as_str().unwrap().to_owned()
}

#[test]
fn every_job_is_reported_once_and_makes_what_it_makes_alone() {
    let folder = &Folder::new();
    files(folder);
    let lines: String = jobs().iter().map(|job| format!("{job}\n\n")).collect::<String>() + "no json\n";
    folder.write("jobs.jsonl", lines);
    let (code, told) = run(folder, "batch jobs.jsonl -o reports.jsonl --workers 2 -v");
    assert_eq!(code, 3, "{told}");
    assert!(told.contains("5 done, 4 failed, 0 reported before"), "{told}");
    let found = reports(folder);
    assert_eq!(found.len(), 9);
    for id in ["union", "difference", "intersection", "xor", "filled"] {
        assert_eq!(status(&found, id), "done");
    }
    for (id, kind) in [("open", "unusable"), ("broken", "unreadable"), ("wrong", "usage"), ("9", "usage")] {
        assert_eq!(status(&found, id), "failed");
        let report = found.iter().find(|report| report["id"] == id).unwrap();
        assert_eq!(report["error"]["kind"], kind, "{report}");
    }
    let union = found.iter().find(|report| report["id"] == "union").unwrap();
    assert_eq!(union["result"]["volume"], 1.875);
    // The same bytes as one by one.
    let (code, _) = run(folder, "union cube.off cube.off --translate 0.5,0.5,0.5 -o alone.ply");
    assert_eq!(code, 0);
    let bytes = |name: &str| std::fs::read(folder.path(name)).expect("a file");
    assert!(bytes("alone.ply") == bytes("out/union.ply"));
}

#[test]
fn a_run_goes_on_and_failures_are_tried_again() {
    let folder = &Folder::new();
    files(folder);
    let lines: String = jobs().iter().map(|job| format!("{job}\n")).collect();
    folder.write("jobs.jsonl", lines);
    // What a run leaves that was stopped: two reports, and the beginning of a third.
    let left = "{\"id\":\"union\",\"status\":\"done\"}\n{\"id\":\"open\",\"status\":\"failed\"}\n{\"id\":\"xor\",\"stat";
    folder.write("reports.jsonl", left);
    let (_, told) = run(folder, "batch jobs.jsonl -o reports.jsonl");
    assert!(told.contains("2 reported before"), "{told}");
    let found = reports(folder);
    let ids: BTreeSet<&str> = found.iter().map(|report| report["id"].as_str().unwrap()).collect();
    assert_eq!((found.len(), ids.len()), (8, 8));
    assert!(!folder.exists("out/union.ply"));
    // Nothing is left to do; failures alone are tried again.
    let (code, told) = run(folder, "batch jobs.jsonl -o reports.jsonl");
    assert!(code == 0 && told.contains("0 done, 0 failed, 8 reported before"), "{told}");
    let (code, told) = run(folder, "batch jobs.jsonl -o reports.jsonl --retry-failed --json");
    assert!(code == 3 && told.contains("0 done, 3 failed, 5 reported before"), "{told}");
    let (_, told) = run(folder, "batch jobs.jsonl -o reports.jsonl --anew");
    assert!(told.contains("5 done, 3 failed, 0 reported before"), "{told}");
}

#[test]
fn limits_of_jobs_are_theirs() {
    let folder = &Folder::new();
    files(folder);
    let job = |id: &str, options: Value| json!({ "id": id, "verb": "union", "inputs": ["cube.off", { "file": "cube.off", "translate": [0.5, 0, 0] }], "output": "x.ply", "options": options });
    let lines =
        format!("{}\n{}\n", job("short", json!({})), job("long", json!({ "memory": "1G", "timeout": 600 })));
    folder.write("jobs.jsonl", lines);
    run(folder, "batch jobs.jsonl -o reports.jsonl --job-memory 1K --job-timeout 500");
    let found = reports(folder);
    assert_eq!((status(&found, "short").as_str(), status(&found, "long").as_str()), ("failed", "done"));
    let (code, told) = run(folder, "batch nothing.jsonl -o reports.jsonl");
    assert!(code == 2 && told.contains("nothing.jsonl"), "{told}");
    let (code, _) = run(folder, "batch jobs.jsonl -o - --json");
    assert_eq!(code, 1);
}
