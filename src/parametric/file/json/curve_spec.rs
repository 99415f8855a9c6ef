//! What descriptions of curves consist of, as `serde` reads them.

use serde::Deserialize;
use serde_json::Value;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct PointsSpec {
    pub(crate) points: Vec<Vec<f64>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct LineSpec {
    pub(crate) point: Vec<f64>,
    pub(crate) direction: Vec<f64>,
    pub(crate) domain: [f64; 2],
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct CircleSpec {
    pub(crate) center: Vec<f64>,
    pub(crate) radius: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct EllipseSpec {
    pub(crate) center: Vec<f64>,
    pub(crate) radii: [f64; 2],
    #[serde(default)]
    pub(crate) rotation: f64,
}

/// An arc of a circle in the plane (`radius`), or of any ellipse (`a` and `b`).
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct ArcSpec {
    pub(crate) center: Vec<f64>,
    pub(crate) radius: Option<f64>,
    pub(crate) a: Option<Vec<f64>>,
    pub(crate) b: Option<Vec<f64>>,
    #[serde(default)]
    pub(crate) start: f64,
    pub(crate) sweep: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct SvgSpec {
    pub(crate) d: String,
}

/// `"uniform"`, `"chord"`, `"centripetal"`, or the parameters themselves.
#[derive(Deserialize, Default)]
#[serde(rename_all = "snake_case")]
pub(crate) enum NamedSpacing {
    Uniform,
    #[default]
    Chord,
    Centripetal,
}

#[derive(Deserialize)]
#[serde(untagged)]
pub(crate) enum SpacingSpec {
    Named(NamedSpacing),
    Given(Vec<f64>),
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct PolylineSpec {
    pub(crate) points: Vec<Vec<f64>>,
    #[serde(default)]
    pub(crate) closed: bool,
    pub(crate) spacing: Option<SpacingSpec>,
}

#[derive(Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum NamedTangents {
    Central,
    Nearer,
    Farther,
}

#[derive(Deserialize)]
#[serde(untagged)]
pub(crate) enum TangentsSpec {
    Rule(NamedTangents),
    Given(Vec<Vec<f64>>),
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct HermiteSpec {
    pub(crate) points: Vec<Vec<f64>>,
    pub(crate) tangents: Option<TangentsSpec>,
    #[serde(default)]
    pub(crate) closed: bool,
    pub(crate) spacing: Option<SpacingSpec>,
}

#[derive(Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum EndsSpec {
    Natural,
    Periodic,
    Clamped([Vec<f64>; 2]),
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct CubicSpec {
    pub(crate) points: Vec<Vec<f64>>,
    pub(crate) ends: Option<EndsSpec>,
    pub(crate) spacing: Option<SpacingSpec>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct LagrangeSpec {
    pub(crate) points: Vec<Vec<f64>>,
    pub(crate) spacing: Option<SpacingSpec>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct BsplineSpec {
    pub(crate) degree: usize,
    pub(crate) points: Vec<Vec<f64>>,
    pub(crate) knots: Option<Vec<f64>>,
    pub(crate) weights: Option<Vec<f64>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct CompositeSpec {
    pub(crate) segments: Vec<Value>,
    #[serde(default)]
    pub(crate) closed: bool,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct ReversedSpec {
    pub(crate) curve: Value,
}
