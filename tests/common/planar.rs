//! Plane shapes that several tests and benchmarks take.
#![allow(dead_code, reason = "each program uses its own part")]

/// The polygon of Choporov 2017, in the shape of an E, counter-clockwise.
pub(crate) const POLYGON: [[f64; 2]; 12] = [
    [0.0, 0.0],
    [3.0, 0.0],
    [3.0, 2.0],
    [2.0, 2.0],
    [2.0, 1.0],
    [1.0, 1.0],
    [1.0, 4.0],
    [2.0, 4.0],
    [2.0, 3.0],
    [3.0, 3.0],
    [3.0, 5.0],
    [0.0, 5.0],
];

/// Control points of the closed Bezier curve of degree 9 of Choporov 2017.
pub(crate) const DEGREE_9: [[f64; 2]; 10] = [
    [0.0, 0.0],
    [0.0, 3.0],
    [1.0, 3.0],
    [1.0, 1.0],
    [4.0, 1.0],
    [4.0, -1.0],
    [1.0, -1.0],
    [1.0, -3.0],
    [0.0, -3.0],
    [0.0, 0.0],
];
