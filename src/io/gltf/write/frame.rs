//! Where the coordinates of a file are measured from, and in which unit.

use glam::DVec3;

use crate::Mesh;

/// Where the coordinates of the file are measured from, and in which unit.
pub(in crate::io::gltf) struct Frame {
    pub(super) offset: DVec3,
    pub(super) scale: f64,
    /// One over the scale, exactly: both are powers of two.
    unit: f64,
    /// Whether single precision holds all coordinates exactly.
    pub(in crate::io::gltf) exact: bool,
}

impl Frame {
    /// The origin and the model's own unit, if single precision holds all coordinates exactly; else axis by axis the
    /// middle of the model, where that is farther from the origin than twice the model's width, and a power of two as
    /// the unit where coordinates are beyond the range of single precision.
    pub(super) fn of(mesh: &Mesh) -> Self {
        let mut frame = Self { offset: DVec3::ZERO, scale: 1.0, unit: 1.0, exact: true };
        if mesh.positions.as_flattened().iter().all(|&coordinate| f64::from(coordinate as f32) == coordinate)
        {
            return frame;
        }
        frame.exact = false;
        let points = || mesh.positions.iter().copied().map(DVec3::from_array);
        let low = points().fold(DVec3::INFINITY, DVec3::min);
        let high = points().fold(DVec3::NEG_INFINITY, DVec3::max);
        for axis in 0..3 {
            let middle = low[axis] * 0.5 + high[axis] * 0.5;
            let rounded = f64::from(middle as f32);
            if rounded.is_finite() && middle.abs() * 0.5 > high[axis] - low[axis] {
                frame.offset[axis] = rounded;
            }
        }
        let size = points().fold(0.0_f64, |size, point| size.max((point - frame.offset).abs().max_element()));
        if size > 0.0 && !(1e-30..1e30).contains(&size) {
            // The power of two at or below the size, in the range whose reciprocal is exact.
            frame.scale = f64::from_bits(size.clamp(1e-300, 1e300).to_bits() & (0x7ff << 52));
            frame.unit = frame.scale.recip();
        }
        frame
    }

    /// The model's own origin and unit, whatever is lost.
    pub(in crate::io::gltf) fn plain(mesh: &Mesh) -> Self {
        let exact = mesh.positions.as_flattened().iter().all(|&x| f64::from(x as f32) == x);
        Self { offset: DVec3::ZERO, scale: 1.0, unit: 1.0, exact }
    }

    /// A point as the file holds it.
    pub(super) fn local(&self, point: [f64; 3]) -> [f32; 3] {
        let local = (DVec3::from_array(point) - self.offset) * self.unit;
        [local.x as f32, local.y as f32, local.z as f32]
    }
}
