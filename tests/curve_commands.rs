//! The program's `curve` verbs as functions.
#![cfg(feature = "parametric")]

#[path = "../src/cli/curve.rs"]
mod curve;

use curve::{JoinArguments, JointName, KeptAt, OperandName};
use trisect::parametric::{JointAt, Operand};

const P: &str = include_str!("../examples/parametric/p.json");
const Q: &str = include_str!("../examples/parametric/q.json");

#[test]
fn join_reads_joins_reports_and_draws() {
    let output = curve::join(P, Q, &JoinArguments { fix_ends: true, ..JoinArguments::default() }).unwrap();
    assert_eq!(output.curve["type"], "bezier");
    assert_eq!(output.curve["points"].as_array().unwrap().len(), 4);
    assert_eq!(output.report["constraints"].as_array().unwrap().len(), 2);
    assert!(output.summary.starts_with("joined at 0.5: integral metric "), "{}", output.summary);
    assert!(output.picture.starts_with("<svg"));
    let arguments = JoinArguments {
        discrete: true,
        keep: Some(Operand::First),
        keep_at: vec!["first:0.5:1".parse().unwrap()],
        joint: Some(JointAt::Lengths),
        degree: 5,
        ..JoinArguments::default()
    };
    let output = curve::join(P, Q, &arguments).unwrap();
    assert_eq!(output.curve["points"].as_array().unwrap().len(), 6);
    assert!(
        output.summary.contains("derivative 1 of P at 0.5 follows from P kept whole"),
        "{}",
        output.summary
    );
}

#[test]
fn faults_name_the_operand() {
    let fault = curve::join("{}", Q, &JoinArguments::default()).unwrap_err().to_string();
    assert_eq!(fault, "operand 1 (first curve): document: \"type\" is missing");
    let space = r#"{"type": "bezier", "points": [[0, 0, 0], [1, 1, 1]]}"#;
    let fault = curve::join(P, space, &JoinArguments::default()).unwrap_err().to_string();
    assert_eq!(fault, "invalid argument: one curve is plane, the other in space");
}

#[test]
fn arguments_are_understood() {
    assert!("first:0.4".parse::<KeptAt>().is_ok() && "second:1:3".parse::<KeptAt>().is_ok());
    for bad in ["", "third:0.4", "first", "first:x", "first:0.4:-1", "first:0.4:1:2"] {
        assert!(bad.parse::<KeptAt>().is_err(), "{bad}");
    }
    assert_eq!("best".parse::<JointName>().unwrap().0, JointAt::Best);
    assert_eq!("0.25".parse::<JointName>().unwrap().0, JointAt::Parameter(0.25));
    assert!("middle".parse::<JointName>().is_err());
    assert_eq!("second".parse::<OperandName>().unwrap().0, Operand::Second);
}

#[test]
fn curves_become_polygons_and_paths() {
    let (polygon, count) = curve::mesh(P, 0.01, 2, false).unwrap();
    assert_eq!(polygon["points"].as_array().unwrap().len(), count);
    let (_, halved) = curve::mesh(P, 0.01, 2, true).unwrap();
    assert!(halved >= count);
    let path = curve::convert(P, 0.01).unwrap();
    assert!(path.starts_with('M') && path.contains('C'), "{path}");
    let back = curve::convert(&path, 0.01).unwrap();
    assert!(back.contains("\"bspline\""), "{back}");
}
