//! What the `curve` verbs do, from the text of input files to the text of output files.

use serde_json::{Value, json};
use trisect::parametric::json::{AnyCurve, bezier_to_json, bspline_to_json, curve, parse};
use trisect::parametric::svg::{Ink, Picture, curves_of_path, path_data};
use trisect::parametric::{
    Curve, CurveJoin, CurveMeshing, GeometryError, JoinInput, JoinMetric, JoinReport, JointAt, NurbsCurve,
    Refinement, SharedCurve,
};

/// What `curve join` was asked for.
#[derive(Clone, Debug, Default)]
pub(crate) struct JoinArguments {
    /// Minimise the change of the control points instead of that of the curves (`--metric discrete`).
    pub(crate) discrete: bool,
    /// Leave one curve as it is (`--keep first`, `--keep second`).
    pub(crate) keep: Option<JoinInput>,
    /// Leave the outer ends where they are (`--fix-ends`).
    pub(crate) fix_ends: bool,
    /// Keep position and derivatives (`--keep-at first:0.4:1`, any number of times).
    pub(crate) keep_at: Vec<KeptAt>,
    /// Where the joint comes to lie (`--joint 0.5`, `--joint lengths`, `--joint best`); 0.5 without.
    pub(crate) joint: Option<JointAt>,
    /// Raise the degree at least so far (`--degree`).
    pub(crate) degree: usize,
}

/// One `--keep-at`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct KeptAt {
    input: JoinInput,
    parameter: f64,
    order: usize,
}

impl std::str::FromStr for KeptAt {
    type Err = String;

    /// `first:0.4` (position) or `second:0.4:2` (position and two derivatives).
    fn from_str(text: &str) -> Result<Self, String> {
        let mut parts = text.split(':');
        let input = parts.next().unwrap_or("").parse::<InputName>()?.0;
        let parameter = parts.next().ok_or("a parameter is missing; write first:0.4 or first:0.4:1")?;
        let parameter = parameter.parse().map_err(|_| format!("{parameter} is not a number"))?;
        let order = match parts.next() {
            None => 0,
            Some(order) => order.parse().map_err(|_| format!("{order} is not a number of derivatives"))?,
        };
        match parts.next() {
            None => Ok(Self { input, parameter, order }),
            Some(rest) => Err(format!("{rest} after the number of derivatives")),
        }
    }
}

/// `first` or `second`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct InputName(pub(crate) JoinInput);

impl std::str::FromStr for InputName {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "first" => Ok(Self(JoinInput::First)),
            "second" => Ok(Self(JoinInput::Second)),
            other => Err(format!("{other} is neither first nor second")),
        }
    }
}

/// `0.5`, `lengths` or `best`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct JointName(pub(crate) JointAt);

impl std::str::FromStr for JointName {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "lengths" => Ok(Self(JointAt::Lengths)),
            "best" => Ok(Self(JointAt::Best)),
            number => match number.parse() {
                Ok(parameter) => Ok(Self(JointAt::Parameter(parameter))),
                Err(_) => Err(format!("{number} is neither a number nor lengths nor best")),
            },
        }
    }
}

/// What `curve join` delivers.
#[derive(Clone, Debug)]
pub(crate) struct JoinOutput {
    /// The joined curve, as JSON.
    pub(crate) curve: Value,
    /// Metric, deviations and constraints, as JSON.
    pub(crate) report: Value,
    /// One line for people.
    pub(crate) summary: String,
    /// Both curves and the joined one with its control polygon, as SVG; for curves of space their view along z.
    pub(crate) picture: String,
}

/// Joins the curves described by two JSON texts.
///
/// # Errors
/// Those of reading, with the name of the curve; those of [`CurveJoin::join_splines`].
pub(crate) fn join(
    texts: [&str; 2],
    names: &[String; 2],
    arguments: &JoinArguments,
) -> Result<JoinOutput, trisect::Error> {
    match (read(texts[0], 0, &names[0])?, read(texts[1], 1, &names[1])?) {
        (AnyCurve::Plane(p), AnyCurve::Plane(q)) => Ok(join_read(&p, &q, arguments)?),
        (AnyCurve::Space(p), AnyCurve::Space(q)) => Ok(join_read(&p, &q, arguments)?),
        _ => Err(GeometryError::Json {
            place: String::new(),
            what: "one curve is plane, the other in space: give both the same number of coordinates".into(),
        }
        .into()),
    }
}

/// The curve in a text; faults name it.
fn read(text: &str, position: usize, name: &str) -> Result<AnyCurve, trisect::Error> {
    parse(text)
        .and_then(|value| curve(&value))
        .map_err(|fault| trisect::Error::from(fault).of_operand(position, name))
}

/// All curves with their control polygons, as SVG (`curve draw`); curves of space as seen along z.
///
/// # Errors
/// Those of reading, with the name of the curve.
pub(crate) fn draw(texts: &[String], names: &[String]) -> Result<String, trisect::Error> {
    let mut picture = Picture::new();
    let inks = [Ink::Main, Ink::First, Ink::Second];
    for (index, (text, name)) in texts.iter().zip(names).enumerate() {
        let shown = match read(text, index, name)? {
            AnyCurve::Plane(curve) => viewed(&curve.to_nurbs())?,
            AnyCurve::Space(curve) => viewed(&curve.to_nurbs())?,
        };
        picture.control_polygon(shown.control(), Ink::Faint);
        picture.curve(&shown, inks[index % inks.len()])?;
    }
    Ok(picture.svg(900.0))
}

fn join_read<const D: usize>(
    first: &SharedCurve<D>,
    second: &SharedCurve<D>,
    arguments: &JoinArguments,
) -> Result<JoinOutput, GeometryError> {
    let mut join = CurveJoin::new().degree(arguments.degree);
    if arguments.discrete {
        join = join.metric(JoinMetric::Discrete);
    }
    if let Some(input) = arguments.keep {
        join = join.keep(input);
    }
    if arguments.fix_ends {
        join = join.fix_ends();
    }
    for kept in &arguments.keep_at {
        join = join.keep_at(kept.input, kept.parameter, kept.order);
    }
    if let Some(joint) = arguments.joint {
        join = join.joint(joint);
    }
    let (p, q) = (first.to_nurbs(), second.to_nurbs());
    let joined = join.join_splines(&p, &q)?;
    let mut picture = Picture::new();
    picture.curve(&viewed(&p)?, Ink::First)?;
    picture.curve(&viewed(&q)?, Ink::Second)?;
    let shown = viewed(&joined.curve)?;
    picture.control_polygon(shown.control(), Ink::Faint);
    picture.curve(&shown, Ink::Main)?;
    Ok(JoinOutput {
        curve: spline_to_json(&joined.curve),
        report: report_to_json(&joined.report),
        summary: summary(&joined.report),
        picture: picture.svg(900.0),
    })
}

/// A curve without inner knots as a Bezier curve, which it is.
fn spline_to_json<const D: usize>(spline: &NurbsCurve<D>) -> Value {
    match trisect::parametric::Bezier::new(spline.control()) {
        Ok(bezier) if bezier.degree() == spline.degree() => bezier_to_json(&bezier),
        _ => bspline_to_json(spline),
    }
}

/// The curve seen along z.
fn viewed<const D: usize>(curve: &NurbsCurve<D>) -> Result<NurbsCurve<2>, GeometryError> {
    let points: Vec<[f64; 2]> = curve.control().iter().map(|p| [p[0], p[1]]).collect();
    match curve.weights() {
        None => NurbsCurve::bspline(curve.degree(), curve.knots(), &points),
        Some(weights) => NurbsCurve::nurbs(curve.degree(), curve.knots(), &points, weights),
    }
}

fn report_to_json(report: &JoinReport) -> Value {
    let constraints = report
        .constraints
        .iter()
        .map(|c| json!({ "name": c.name, "residual": c.residual, "follows_from": c.follows_from }));
    json!({
        "joint": report.joint,
        "discrete_metric": report.discrete,
        "integral_metric": report.integral,
        "largest_deviation": report.largest_deviation,
        "freedom": report.freedom,
        "constraints": constraints.collect::<Vec<_>>(),
    })
}

fn summary(report: &JoinReport) -> String {
    let [first, second] = report.largest_deviation;
    let mut text = format!(
        "joined at {}: integral metric {:.6}, discrete metric {:.6}, largest deviation {first:.6} and {second:.6}",
        report.joint, report.integral, report.discrete
    );
    for constraint in report.constraints.iter().filter(|c| !c.follows_from.is_empty()) {
        text += &format!("; {} follows from {}", constraint.name, constraint.follows_from.join(", "));
    }
    text
}

/// A curve as a polygon within `tolerance` (`curve mesh`): JSON of a polyline, and how many nodes it has.
///
/// # Errors
/// Those of reading and of [`CurveMeshing::mesh`].
pub(crate) fn mesh(
    text: &str,
    tolerance: f64,
    nodes: usize,
    halving: bool,
) -> Result<(Value, usize), trisect::Error> {
    let refinement = if halving { Refinement::Halving } else { Refinement::Levelled };
    let meshing = CurveMeshing::new(tolerance).initial_nodes(nodes.max(2)).refinement(refinement);
    fn polyline<const D: usize>(
        curve: &dyn Curve<D>,
        meshing: &CurveMeshing,
    ) -> Result<(Value, usize), GeometryError> {
        let mut points = meshing.mesh(curve)?.points;
        if curve.is_closed() {
            points.pop();
        }
        let lists: Vec<Vec<f64>> = points.iter().map(|p| p.to_vec()).collect();
        Ok((json!({ "type": "polyline", "closed": curve.is_closed(), "points": lists }), points.len()))
    }
    let value = parse(text)?;
    Ok(match curve(&value)? {
        AnyCurve::Plane(curve) => polyline(curve.as_ref(), &meshing)?,
        AnyCurve::Space(curve) => polyline(curve.as_ref(), &meshing)?,
    })
}

/// A plane curve, given as JSON or as SVG path data, in the other form, and that form's name (`curve convert`).
///
/// # Errors
/// Those of reading; curves of space have no SVG form.
pub(crate) fn convert(text: &str, tolerance: f64) -> Result<(String, &'static str), trisect::Error> {
    if !text.trim_start().starts_with('{') {
        let found = curves_of_path(text)?;
        let all = found.closed.iter().chain(&found.open);
        let curves: Vec<Value> = all.map(|c| bspline_to_json(&c.to_nurbs())).collect();
        // One curve is read back as it is written.
        let value = match <[Value; 1]>::try_from(curves) {
            Ok([only]) => only,
            Err(curves) => json!({ "curves": curves }),
        };
        return Ok((value.to_string(), "json"));
    }
    match curve(&parse(text)?)? {
        AnyCurve::Plane(curve) => Ok((path_data(curve.as_ref(), tolerance)?, "path")),
        AnyCurve::Space(_) => Err(GeometryError::Json {
            place: String::new(),
            what: "a curve of space has no SVG path: leave out its third coordinate".into(),
        }
        .into()),
    }
}
