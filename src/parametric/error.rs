//! What can be wrong with curves, regions, patches and their files.

/// A fault in the description of a curve, a region or a surface. Each says what, where, and how to mend it.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum GeometryError {
    /// Fewer points than the construction needs.
    #[error("{what} needs at least {needed} points, found {found}")]
    TooFewPoints {
        /// The construction.
        what: &'static str,
        /// Least number of points.
        needed: usize,
        /// Number given.
        found: usize,
    },
    /// More points than the construction can carry without losing accuracy.
    #[error("{what} takes at most {limit} points, found {found}; {advice}")]
    TooManyPoints {
        /// The construction.
        what: &'static str,
        /// Greatest number of points.
        limit: usize,
        /// Number given.
        found: usize,
        /// What to use instead.
        advice: &'static str,
    },
    /// Two points that must differ are the same.
    #[error("points {first} and {second} of the {what} coincide; remove one of them")]
    CoincidentPoints {
        /// The construction.
        what: &'static str,
        /// Index of the first point, from 0.
        first: usize,
        /// Index of the second.
        second: usize,
    },
    /// A coordinate, weight or parameter that is NaN or infinite.
    #[error("{what} {index} of the {of} is not a finite number")]
    NotFinite {
        /// "point", "weight", "knot", "parameter".
        what: &'static str,
        /// Its index, from 0.
        index: usize,
        /// The construction.
        of: &'static str,
    },
    /// A knot vector that does not define a continuous curve of the given degree.
    #[error("bad knot vector at knot {index}: {reason}")]
    BadKnots {
        /// Index of the knot, from 0.
        index: usize,
        /// What is wrong.
        reason: String,
    },
    /// A weight that is not positive.
    #[error("weight {index} is {value}; weights must be positive")]
    BadWeight {
        /// Index of the weight, from 0.
        index: usize,
        /// Its value.
        value: f64,
    },
    /// Parameter values that do not increase.
    #[error("parameter {index} is not greater than the one before it; parameters must increase")]
    ParametersNotIncreasing {
        /// Index of the second of the two, from 0.
        index: usize,
    },
    /// Two lists that must have matching lengths do not.
    #[error("the {what} must number {expected}, found {found}")]
    CountMismatch {
        /// Which list.
        what: &'static str,
        /// Its length by the others.
        expected: usize,
        /// Its length.
        found: usize,
    },
    /// A number outside its range: a radius that is not positive, a degree of 0.
    #[error("{what} is {value}; it must be {range}")]
    OutOfRange {
        /// Which number.
        what: &'static str,
        /// Its value.
        value: f64,
        /// The range in words.
        range: &'static str,
    },
    /// Vectors that must span a plane are parallel, or one that must have a direction is zero.
    #[error("degenerate {what}: {reason}")]
    Degenerate {
        /// The construction.
        what: &'static str,
        /// What is wrong.
        reason: &'static str,
    },
    /// A tolerance smaller than what coordinates of this size can resolve.
    #[error(
        "tolerance {tolerance} is below {smallest}, the least that f64 coordinates of this size can resolve"
    )]
    ToleranceTooSmall {
        /// The tolerance asked for.
        tolerance: f64,
        /// The least possible.
        smallest: f64,
    },
    /// The mesh would have more nodes than the limit.
    #[error("the {what} needs more than {limit} nodes at this tolerance; use a larger tolerance")]
    TooManyNodes {
        /// Curve or surface mesh.
        what: &'static str,
        /// The limit.
        limit: usize,
    },
    /// Consecutive segments of a composite curve do not meet.
    #[error("segment {segment} ends {distance} away from the start of segment {next}, at {place:?}")]
    SegmentsDoNotMeet {
        /// Index of the segment, from 0.
        segment: usize,
        /// Index of the one that follows.
        next: usize,
        /// Width of the gap.
        distance: f64,
        /// Where the segment ends.
        place: Vec<f64>,
    },
    /// A contour whose end is not its start.
    #[error("the contour is not closed: its end is {distance} away from its start {place:?}")]
    NotClosed {
        /// Width of the gap.
        distance: f64,
        /// Where it starts.
        place: Vec<f64>,
    },
    /// Contours that cross where they must not.
    #[error("contours cross near {place:?}; unite or normalise them first")]
    ContoursCross {
        /// A place where they cross.
        place: [f64; 2],
    },
    /// A region that crosses the axis it is revolved about.
    #[error("the region reaches across the axis of revolution at {place:?}; all of it must have x >= 0")]
    CrossesAxis {
        /// A point with negative x.
        place: [f64; 2],
    },
    /// A sweep whose section is too large for a bend of the path.
    #[error(
        "the section overlaps itself in the bend of the path near {place:?}; use a smaller section or a wider bend"
    )]
    SweepFolds {
        /// A place on the path.
        place: [f64; 3],
    },
    /// More than two patch boundaries run along the same curve.
    #[error(
        "{count} patch boundaries run along one curve near {place:?} (patches {patches:?}); a closed surface has two"
    )]
    BoundaryShared {
        /// How many.
        count: usize,
        /// Indices of the patches, from 0.
        patches: Vec<usize>,
        /// A point of the curve.
        place: [f64; 3],
    },
    /// The patches form a one-sided surface.
    #[error(
        "the patches form a one-sided surface: no choice of sides makes patch {patch} agree with its neighbours"
    )]
    OneSided {
        /// Index of a patch, from 0.
        patch: usize,
    },
    /// Boundaries of patches that meet no other boundary.
    #[error("the patches leave {} open boundaries; the first: {}", gaps.len(), gaps.first().map_or_else(String::new, ToString::to_string))]
    Gaps {
        /// Every open boundary.
        gaps: Vec<super::Gap>,
    },
    /// Constraints that no curve satisfies together.
    #[error("contradictory constraints: {} cannot hold together", constraints.join(", "))]
    Contradictory {
        /// Their names; without any one of them the rest can hold.
        constraints: Vec<String>,
    },
    /// A fault in something that a file describes, with its place in the file.
    #[error("{}: {fault}", if place.is_empty() { "document" } else { place })]
    At {
        /// JSON pointer to the description: "/regions/0".
        place: String,
        /// What is wrong with it.
        fault: Box<GeometryError>,
    },
    /// A JSON document that is not of the documented shape.
    #[error("{}: {what}", if place.is_empty() { "document" } else { place })]
    Json {
        /// JSON pointer ("/curves/2/points/1") or "line 3, column 7".
        place: String,
        /// What is wrong.
        what: String,
    },
    /// An SVG file or path that cannot be read.
    #[error("SVG, {place}: {what}")]
    Svg {
        /// Where: "path, character 17", "line 4, column 2".
        place: String,
        /// What is wrong.
        what: String,
    },
}

impl GeometryError {
    /// Whether the fault is in a file's form (rather than in the geometry it describes).
    #[must_use]
    pub fn is_unreadable(&self) -> bool {
        matches!(self, Self::Json { .. } | Self::Svg { .. })
    }
}

pub(crate) type Result<T> = std::result::Result<T, GeometryError>;

/// Refuses points that are not finite.
pub(crate) fn check_points<const D: usize>(of: &'static str, points: &[[f64; D]]) -> Result<()> {
    match points.iter().position(|p| !p.iter().all(|x| x.is_finite())) {
        Some(index) => Err(GeometryError::NotFinite { what: "point", index, of }),
        None => Ok(()),
    }
}

/// Refuses a list of points shorter than `needed`, or with points that are not finite.
pub(crate) fn check_count<const D: usize>(
    what: &'static str,
    points: &[[f64; D]],
    needed: usize,
) -> Result<()> {
    if points.len() < needed {
        return Err(GeometryError::TooFewPoints { what, needed, found: points.len() });
    }
    check_points(what, points)
}

/// Refuses a number that is not positive and finite.
pub(crate) fn check_positive(what: &'static str, value: f64) -> Result<()> {
    if value > 0.0 && value.is_finite() {
        Ok(())
    } else {
        Err(GeometryError::OutOfRange { what, value, range: "positive and finite" })
    }
}
