//! Ganchuk 2024: two cubics over x in 0..20 joined into one, with the paper's six sets of constraints. Prints the
//! metrics and writes SVG pictures into the folder given as argument (without: `out`).
#![allow(clippy::print_stdout, reason = "the program's output")]

use std::path::PathBuf;

use trisect::parametric::json::{AnyCurve, curve, parse};
use trisect::parametric::svg::{Ink, Picture};
use trisect::parametric::{Bezier, Curve, CurveJoin, JoinInput, JoinMetric, JointAt};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = PathBuf::from(std::env::args().nth(1).unwrap_or_else(|| "out".into()));
    std::fs::create_dir_all(&folder)?;
    let p = cubic(include_str!("parametric/p.json"))?;
    let q = cubic(include_str!("parametric/q.json"))?;
    let at = |operand, t, order| CurveJoin::new().keep_at(operand, t, order);
    let through = at(JoinInput::First, 0.0, 0)
        .keep_at(JoinInput::First, 0.5, 0)
        .keep_at(JoinInput::Second, 0.1, 0)
        .keep_at(JoinInput::Second, 1.0, 0);
    let cases = [
        ("free", CurveJoin::new()),
        ("ends", CurveJoin::new().fix_ends()),
        ("points", through),
        ("position", at(JoinInput::First, 0.4, 0)),
        ("first-derivative", at(JoinInput::First, 0.4, 1)),
        ("second-derivative", at(JoinInput::First, 0.4, 2)),
    ];
    println!(
        "{:18} {:>10} {:>10} {:>10} {:>10}  largest deviation of P, of Q",
        "", "integral", "discrete", "best joint", "there"
    );
    for (name, join) in cases {
        let joined = join.join(&p, &q)?;
        let discrete = join.clone().metric(JoinMetric::Discrete).join(&p, &q)?.report.discrete;
        let best = join.clone().joint(JointAt::Best).join(&p, &q)?.report;
        let [first, second] = joined.report.largest_deviation;
        println!(
            "{name:18} {:>10.5} {discrete:>10.5} {:>10.5} {:>10.5}  {first:.4}, {second:.4}",
            joined.report.integral, best.joint, best.integral
        );
        let mut picture = Picture::new();
        picture.curve(&p, Ink::First)?;
        picture.curve(&q, Ink::Second)?;
        picture.control_polygon(joined.curve.control(), Ink::Faint);
        picture.curve(&joined.curve, Ink::Main)?;
        picture.dots(&[joined.curve.point(0.5)], Ink::Main);
        std::fs::write(folder.join(format!("join-{name}.svg")), picture.svg(600.0))?;
    }
    Ok(())
}

fn cubic(text: &str) -> Result<Bezier<2>, Box<dyn std::error::Error>> {
    match curve(&parse(text)?)? {
        AnyCurve::Plane(curve) => Ok(Bezier::new(curve.to_nurbs().control())?),
        AnyCurve::Space(_) => Err("a plane curve was expected".into()),
    }
}
