//! Curves.

use std::sync::Arc;

use serde::Deserialize;
use serde_json::Value;

use super::{JsonNode, point, points};
use crate::parametric::error::Result;
use crate::parametric::file::svg::curves_of_path;
use crate::parametric::{
    Bezier, Composite, CubicSpline, EllipticArc, HermiteSpline, LagrangeCurve, NurbsCurve, Polyline,
    Reversed, Segment, SharedCurve, Spacing, SplineEnds, TangentRule,
};

/// A curve of the plane or of space, whichever the points of its description are.
#[derive(Clone, Debug)]
pub enum AnyCurve {
    /// In the plane.
    Plane(SharedCurve<2>),
    /// In space.
    Space(SharedCurve<3>),
}

/// Reads a curve.
///
/// # Errors
/// [`GeometryError::Json`](crate::parametric::GeometryError::Json) with the place, or the fault of the construction
/// with it ([`GeometryError::At`](crate::parametric::GeometryError::At)).
pub fn curve(value: &Value) -> Result<AnyCurve> {
    read_any(&JsonNode::root(value))
}

pub(crate) fn read_any(node: &JsonNode<'_>) -> Result<AnyCurve> {
    match dimension(node.value) {
        3 => read_space(node).map(AnyCurve::Space),
        _ => read_plane(node).map(AnyCurve::Plane),
    }
}

pub(crate) fn read_space(node: &JsonNode<'_>) -> Result<SharedCurve<3>> {
    read_common::<3>(node)
}

/// Curves of the plane have kinds of their own besides those of any dimension.
pub(crate) fn read_plane(node: &JsonNode<'_>) -> Result<SharedCurve<2>> {
    match node.type_name()? {
        "circle" => {
            let spec: CircleSpec = node.members()?;
            let centre = point(node, "center", &spec.center)?;
            Ok(Arc::new(node.place(EllipticArc::circle(centre, spec.radius))?))
        }
        "ellipse" => {
            let spec: EllipseSpec = node.members()?;
            let centre = point(node, "center", &spec.center)?;
            let made = EllipticArc::ellipse(centre, spec.radii, spec.rotation.to_radians());
            Ok(Arc::new(node.place(made)?))
        }
        "svg_path" => {
            let spec: SvgSpec = node.members()?;
            let mut found = node.place(curves_of_path(&spec.d))?;
            let mut all: Vec<Composite<2>> = found.closed.drain(..).chain(found.open.drain(..)).collect();
            match (all.pop(), all.len()) {
                (Some(one), 0) => Ok(Arc::new(one)),
                (None, _) => Err(node.fault("the path draws nothing")),
                (Some(_), more) => {
                    Err(node.fault(format!("the path has {} parts, a curve has one", more + 1)))
                }
            }
        }
        _ => read_common::<2>(node),
    }
}

/// Number of coordinates of the first point found in a description.
fn dimension(value: &Value) -> usize {
    let length = |value: &Value| value.as_array().map(Vec::len);
    let first_of = |name: &str| value.get(name).and_then(Value::as_array).and_then(|list| list.first());
    if let Some(count) = first_of("points").and_then(length) {
        return count;
    }
    for name in ["center", "point"] {
        if let Some(count) = value.get(name).and_then(length) {
            return count;
        }
    }
    match first_of("segments").or_else(|| value.get("curve")) {
        Some(inner) => dimension(inner),
        None => 2,
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct PointsSpec {
    points: Vec<Vec<f64>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct LineSpec {
    point: Vec<f64>,
    direction: Vec<f64>,
    domain: [f64; 2],
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct CircleSpec {
    center: Vec<f64>,
    radius: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct EllipseSpec {
    center: Vec<f64>,
    radii: [f64; 2],
    #[serde(default)]
    rotation: f64,
}

/// An arc of a circle in the plane (`radius`), or of any ellipse (`a` and `b`).
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ArcSpec {
    center: Vec<f64>,
    radius: Option<f64>,
    a: Option<Vec<f64>>,
    b: Option<Vec<f64>>,
    #[serde(default)]
    start: f64,
    sweep: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct SvgSpec {
    d: String,
}

/// `"uniform"`, `"chord"`, `"centripetal"`, or the parameters themselves.
#[derive(Deserialize, Default)]
#[serde(rename_all = "snake_case")]
enum NamedSpacing {
    Uniform,
    #[default]
    Chord,
    Centripetal,
}

#[derive(Deserialize)]
#[serde(untagged)]
enum SpacingSpec {
    Named(NamedSpacing),
    Given(Vec<f64>),
}

fn spacing(spec: Option<SpacingSpec>) -> Spacing {
    match spec {
        None | Some(SpacingSpec::Named(NamedSpacing::Chord)) => Spacing::ChordLength,
        Some(SpacingSpec::Named(NamedSpacing::Uniform)) => Spacing::Uniform,
        Some(SpacingSpec::Named(NamedSpacing::Centripetal)) => Spacing::Centripetal,
        Some(SpacingSpec::Given(values)) => Spacing::Given(values),
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct PolylineSpec {
    points: Vec<Vec<f64>>,
    #[serde(default)]
    closed: bool,
    spacing: Option<SpacingSpec>,
}

#[derive(Deserialize)]
#[serde(rename_all = "snake_case")]
enum NamedTangents {
    Central,
    Nearer,
    Farther,
}

#[derive(Deserialize)]
#[serde(untagged)]
enum TangentsSpec {
    Rule(NamedTangents),
    Given(Vec<Vec<f64>>),
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct HermiteSpec {
    points: Vec<Vec<f64>>,
    tangents: Option<TangentsSpec>,
    #[serde(default)]
    closed: bool,
    spacing: Option<SpacingSpec>,
}

#[derive(Deserialize)]
#[serde(rename_all = "snake_case")]
enum EndsSpec {
    Natural,
    Periodic,
    Clamped([Vec<f64>; 2]),
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct CubicSpec {
    points: Vec<Vec<f64>>,
    ends: Option<EndsSpec>,
    spacing: Option<SpacingSpec>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct LagrangeSpec {
    points: Vec<Vec<f64>>,
    spacing: Option<SpacingSpec>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct BsplineSpec {
    degree: usize,
    points: Vec<Vec<f64>>,
    knots: Option<Vec<f64>>,
    weights: Option<Vec<f64>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct CompositeSpec {
    segments: Vec<Value>,
    #[serde(default)]
    closed: bool,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ReversedSpec {
    curve: Value,
}

const TYPES: [&str; 13] = [
    "segment",
    "line",
    "circle",
    "ellipse",
    "arc",
    "polyline",
    "hermite",
    "cubic_spline",
    "lagrange",
    "bezier",
    "bspline",
    "composite",
    "reversed",
];

/// A part of another curve: plane curves may be of the kinds that only the plane has.
fn read_inner<const D: usize>(node: &JsonNode<'_>) -> Result<SharedCurve<D>>
where
    SharedCurve<D>: FromAny,
{
    FromAny::from_node(node)
}

/// Curves that can be read where the dimension is known.
trait FromAny: Sized {
    fn from_node(node: &JsonNode<'_>) -> Result<Self>;
}

impl FromAny for SharedCurve<2> {
    fn from_node(node: &JsonNode<'_>) -> Result<Self> {
        read_plane(node)
    }
}

impl FromAny for SharedCurve<3> {
    fn from_node(node: &JsonNode<'_>) -> Result<Self> {
        read_space(node)
    }
}

/// Curves whose description is the same in the plane and in space.
fn read_common<const D: usize>(node: &JsonNode<'_>) -> Result<SharedCurve<D>>
where
    SharedCurve<D>: FromAny,
{
    let name = node.type_name()?;
    Ok(match name {
        "segment" => {
            let spec: PointsSpec = node.members()?;
            let ends = points::<D>(node, "points", &spec.points)?;
            let [start, end] = ends[..] else { return Err(node.fault("a segment has two points")) };
            Arc::new(node.place(Segment::new(start, end))?)
        }
        "line" => read_line::<D>(node)?,
        "arc" => Arc::new(read_arc::<D>(node)?),
        "polyline" => {
            let spec: PolylineSpec = node.members()?;
            let through = points::<D>(node, "points", &spec.points)?;
            Arc::new(node.place(Polyline::new(&through, &spacing(spec.spacing), spec.closed))?)
        }
        "hermite" => read_hermite::<D>(node)?,
        "cubic_spline" => read_cubic_spline::<D>(node)?,
        "lagrange" => {
            let spec: LagrangeSpec = node.members()?;
            let through = points::<D>(node, "points", &spec.points)?;
            Arc::new(node.place(LagrangeCurve::new(&through, &spacing(spec.spacing)))?)
        }
        "bezier" => {
            let spec: PointsSpec = node.members()?;
            Arc::new(node.place(Bezier::new(&points::<D>(node, "points", &spec.points)?))?)
        }
        "bspline" => read_bspline::<D>(node)?,
        "composite" => read_composite::<D>(node)?,
        "reversed" => {
            let spec: ReversedSpec = node.members()?;
            Arc::new(Reversed::new(read_inner::<D>(&JsonNode::child(&spec.curve, &node.pointer, "curve"))?))
        }
        "circle" | "ellipse" | "svg_path" => {
            return Err(
                node.fault(format!("a {name} lies in the plane; in space use an arc with \"a\" and \"b\""))
            );
        }
        _ => return Err(node.unknown_type(name, "curve", &TYPES)),
    })
}

fn read_line<const D: usize>(node: &JsonNode<'_>) -> Result<SharedCurve<D>> {
    let spec: LineSpec = node.members()?;
    let (at, direction) =
        (point::<D>(node, "point", &spec.point)?, point(node, "direction", &spec.direction)?);
    Ok(Arc::new(node.place(Segment::on_line(at, direction, spec.domain))?))
}

fn read_cubic_spline<const D: usize>(node: &JsonNode<'_>) -> Result<SharedCurve<D>> {
    let spec: CubicSpec = node.members()?;
    let through = points::<D>(node, "points", &spec.points)?;
    let ends = match spec.ends {
        None | Some(EndsSpec::Natural) => SplineEnds::Natural,
        Some(EndsSpec::Periodic) => SplineEnds::Periodic,
        Some(EndsSpec::Clamped([start, end])) => SplineEnds::Clamped([
            point(node, "ends/clamped/0", &start)?,
            point(node, "ends/clamped/1", &end)?,
        ]),
    };
    Ok(Arc::new(node.place(CubicSpline::new(&through, &ends, &spacing(spec.spacing)))?))
}

fn read_bspline<const D: usize>(node: &JsonNode<'_>) -> Result<SharedCurve<D>> {
    let spec: BsplineSpec = node.members()?;
    let control = points::<D>(node, "points", &spec.points)?;
    let knots = match spec.knots {
        Some(knots) => knots,
        None => node.place(NurbsCurve::clamped_uniform(spec.degree, &control))?.knots().to_vec(),
    };
    Ok(Arc::new(node.place(match spec.weights {
        None => NurbsCurve::bspline(spec.degree, &knots, &control),
        Some(weights) => NurbsCurve::nurbs(spec.degree, &knots, &control, &weights),
    })?))
}

fn read_composite<const D: usize>(node: &JsonNode<'_>) -> Result<SharedCurve<D>>
where
    SharedCurve<D>: FromAny,
{
    let spec: CompositeSpec = node.members()?;
    let pointer = format!("{}/segments", node.pointer);
    let parts = spec.segments.iter().enumerate();
    let parts = parts
        .map(|(i, part)| read_inner::<D>(&JsonNode::child(part, &pointer, i)))
        .collect::<Result<Vec<_>>>()?;
    let made = if spec.closed { Composite::closed(&parts) } else { Composite::new(&parts) };
    Ok(Arc::new(node.place(made)?))
}

fn read_arc<const D: usize>(node: &JsonNode<'_>) -> Result<EllipticArc<D>> {
    let spec: ArcSpec = node.members()?;
    let centre = point::<D>(node, "center", &spec.center)?;
    let (a, b) = match (spec.radius, spec.a, spec.b) {
        (Some(radius), None, None) if D == 2 => {
            let axis = |k: usize| std::array::from_fn(|i| if i == k { radius } else { 0.0 });
            (axis(0), axis(1))
        }
        (None, Some(a), Some(b)) => (point(node, "a", &a)?, point(node, "b", &b)?),
        _ => return Err(node.fault("an arc has either \"radius\" (in the plane) or \"a\" and \"b\"")),
    };
    node.place(EllipticArc::new(centre, a, b, spec.start.to_radians(), spec.sweep.to_radians()))
}

fn read_hermite<const D: usize>(node: &JsonNode<'_>) -> Result<SharedCurve<D>> {
    let spec: HermiteSpec = node.members()?;
    let through = points::<D>(node, "points", &spec.points)?;
    let spacing = spacing(spec.spacing);
    let rule = match spec.tangents {
        Some(TangentsSpec::Given(given)) => {
            let tangents = points::<D>(node, "tangents", &given)?;
            let made = HermiteSpline::with_tangents(&through, &tangents, &spacing, spec.closed);
            return Ok(Arc::new(node.place(made)?));
        }
        None | Some(TangentsSpec::Rule(NamedTangents::Central)) => TangentRule::Central,
        Some(TangentsSpec::Rule(NamedTangents::Nearer)) => TangentRule::NearerNeighbour,
        Some(TangentsSpec::Rule(NamedTangents::Farther)) => TangentRule::FartherNeighbour,
    };
    Ok(Arc::new(node.place(HermiteSpline::through(&through, rule, &spacing, spec.closed))?))
}
