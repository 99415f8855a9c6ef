//! What is told of a boolean of cages.

use super::measure::Errors;

/// What was asked for and what came of it.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct FreeFormReport {
    /// The distance asked for.
    pub asked: f64,
    /// The distances of the cage that is returned.
    pub errors: Errors,
    /// Whether the largest of both directions is within what was asked for.
    pub reached: bool,
    /// Control points of the result.
    pub vertices: usize,
    /// Faces of the result.
    pub faces: usize,
    /// Control points that no operand had.
    pub added: usize,
    /// Control points of the operands that moved.
    pub fitted: usize,
    /// Control points of the operands that are there bit for bit.
    pub unchanged: usize,
    /// Chains of the intersection curve.
    pub chains: usize,
    /// Its ends, turns, and meetings with creases.
    pub features: usize,
    /// Places where curves of three and more surfaces meet.
    pub junctions: usize,
    /// The smallest angle between both surfaces along the curve, in degrees; 90 without a curve.
    #[cfg_attr(feature = "serde", serde(rename = "crossing_degrees"))]
    pub crossing: f64,
    /// The most faces around a vertex that an operand did not have so.
    #[cfg_attr(feature = "serde", serde(rename = "largest_valence"))]
    pub valence: usize,
    /// How often faces beside the curve were halved in size for the cage that is returned.
    pub refined: u32,
    /// Levels of details of the result, and how many details there are.
    pub levels: usize,
    /// Vertices with details.
    pub details: usize,
    /// Vertices in the working mesh that could not be taken out.
    pub left_over: usize,
    /// Triangles of the exact result.
    pub exact_triangles: usize,
    /// Seconds by step: limit meshes, exact boolean, curve, cage, fit, measure.
    #[cfg_attr(feature = "serde", serde(serialize_with = "as_map"))]
    pub seconds: Vec<(&'static str, f64)>,
    /// What a user should know: tolerance not reached, and where; surfaces nearly tangential.
    pub warnings: Vec<String>,
}

/// Seconds under the names of their steps.
#[cfg(feature = "serde")]
fn as_map<S: serde::Serializer>(seconds: &[(&'static str, f64)], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_map(seconds.iter().copied())
}
