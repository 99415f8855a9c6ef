//! Pairs of models whose booleans another engine has worked out with exact constructions.

use serde_json::Value;
use trisect::{BooleanOptions, Mesh, Operation, Solid};

use super::models::{find, fixtures};
use super::surface::Properties;

const TOLERANCE: f64 = 1e-9;

#[test]
fn recorded_answers_of_an_exact_engine_are_met() {
    let file =
        std::env::var_os("TRISECT_EXPECTATIONS").map_or_else(|| fixtures("expectations.json"), Into::into);
    let text = std::fs::read_to_string(file).expect("the recorded answers");
    let all: Value = serde_json::from_str(&text).expect("JSON");
    let entries = all["files"].as_array().expect("a list");
    let (mut met, mut failed) = (0, Vec::new());
    println!("| case | volume off by | area off by | components | genus | |\n|---|---|---|---|---|---|");
    for entry in entries {
        let name = entry["name"].as_str().expect("a name");
        match judged(entry) {
            Ok(row) => {
                met += 1;
                println!("| {name} | {row} | as recorded |");
            }
            Err(why) => {
                println!("| {name} | | | | | **{why}** |");
                failed.push(format!("{name}: {why}"));
            }
        }
    }
    println!("{} cases: {met} as recorded, {} otherwise", entries.len(), failed.len());
    assert!(failed.is_empty(), "{failed:#?}");
    assert!(met >= 20 && met == entries.len());
}

/// A row of the table, or what differs. Surfaces that cross themselves are resolved like all others.
fn judged(entry: &Value) -> Result<String, String> {
    let names: Vec<&str> = entry["inputs"]
        .as_array()
        .expect("inputs")
        .iter()
        .map(|name| name.as_str().expect("a name"))
        .collect();
    let operation = match entry["operation"].as_str() {
        Some("union" | "self-union") => Operation::Union,
        Some("intersection") => Operation::Intersection,
        Some("difference") => Operation::Difference,
        other => panic!("operation {other:?}"),
    };
    let mut solids = Vec::new();
    for name in &names {
        let mesh = Mesh::load(find(name)).map_err(|error| error.to_string())?;
        let solid = Solid::try_from(mesh).map_err(|error| error.to_string())?;
        solids.push(solid);
    }
    let outcome = BooleanOptions::new().run(operation, &solids).map_err(|error| error.to_string())?;
    let found = Properties::of(outcome.solid().mesh());
    let expected = &entry["expected"];
    let mut faults = Vec::new();
    if expected["empty"] == true {
        return match outcome.solid().is_empty() {
            true => Ok("empty | | |".into()),
            false => Err(format!("not empty: {found:?}")),
        };
    }
    if !(found.closed && found.manifold) {
        faults.push("not closed or not a manifold".to_string());
    }
    if found.zero_area > 0 {
        faults.push(format!("{} triangles without area", found.zero_area));
    }
    let mut off = |what: &str, found: f64| {
        let expected = expected[what].as_f64().expect("a number");
        let off = (found - expected).abs() / expected;
        if off > TOLERANCE {
            faults.push(format!("{what} {found}, recorded {expected}"));
        }
        off
    };
    let (volume, area) = (off("volume", found.volume), off("area", found.area));
    let components = expected["components_by_edges"].as_u64().expect("a number") as usize;
    if found.components != components {
        faults.push(format!("{} components, recorded {components}", found.components));
    }
    let genus = outcome.certificate().genus;
    // Of a result that touches itself there is no genus on record; ours comes apart there.
    let touching = expected["manifold"] == false;
    if !touching && genus.map(|genus| genus as u64) != expected["genus"].as_u64() {
        faults.push(format!("genus {genus:?}, recorded {}", expected["genus"]));
    }
    if !touching && Some(found.euler) != expected["euler_characteristic"].as_i64() {
        faults.push(format!("Euler characteristic {}", found.euler));
    }
    let genus = genus.map_or_else(|| "-".into(), |genus| genus.to_string());
    match faults.is_empty() {
        true => Ok(format!("{volume:.0e} | {area:.0e} | {components} | {genus}")),
        false => Err(faults.join("; ")),
    }
}
