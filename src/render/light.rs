//! Light: colours as bytes and as amounts of it, and the lamps.

use glam::DVec3;

/// Two lamps fixed to the camera, a strong one from the upper left and a weak one from the right, and light from
/// all around that is brighter from above.
pub(super) fn lit(colour: [f64; 3], normal: DVec3, front: bool) -> [f32; 3] {
    let key = DVec3::new(-0.60, 0.60, 0.53);
    let fill = DVec3::new(0.80, -0.05, 0.60);
    let around = 0.30 + 0.10 * normal.y;
    let light = around + 0.78 * normal.dot(key).max(0.0) + 0.17 * normal.dot(fill).max(0.0);
    let tint = if front { [1.0; 3] } else { [0.85, 0.32, 0.28] };
    std::array::from_fn(|channel| (colour[channel] * tint[channel] * light) as f32)
}

/// An sRGB byte as linear light, with the curve taken as a square: close enough to the eye, and the same bits on
/// every machine, which a power function does not promise.
pub(super) fn linear(byte: u8) -> f64 {
    let value = f64::from(byte) / 255.0;
    value * value
}

/// A linear channel in 0..=1 as an sRGB byte, by the standard's curve.
pub(super) fn encoded(linear: f32) -> u8 {
    let linear = if linear.is_finite() { linear.clamp(0.0, 1.0) } else { 0.0 };
    let curve = if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 };
    (curve * 255.0).round() as u8
}
