//! Places on a cage, and points of its limit surface.

/// Where on a cage: weights of the corners of a control face, which sum to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// The control face.
    pub face: u32,
    /// The weights of its corners.
    pub weights: [f64; 3],
}

/// A point of the limit surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LimitPoint {
    /// Where it is.
    pub position: [f64; 3],
    /// The derivative along the weight of the face's second corner, taken from the first one's.
    pub du: [f64; 3],
    /// The same for the third corner.
    pub dv: [f64; 3],
    /// The normal, outwards; zero where there is no tangent plane.
    pub normal: [f64; 3],
}
