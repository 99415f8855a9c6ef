//! Rigid motions, scalings and mirrorings in a model file.

use glam::{DAffine3, DMat3, DQuat, DVec3};
use serde::Deserialize;

/// One step of a transform.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "lowercase", deny_unknown_fields)]
pub(super) enum Step {
    Translate([f64; 3]),
    Rotate(Rotation),
    Scale(Scale),
    /// Mirrored in the plane through the origin with this normal.
    Mirror([f64; 3]),
    /// Three rows of four: the linear part and the shift.
    Matrix([[f64; 4]; 3]),
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Rotation {
    axis: [f64; 3],
    /// In degrees, counter-clockwise seen against the axis.
    angle: f64,
    /// A point of the axis.
    #[serde(default)]
    about: [f64; 3],
}

#[derive(Debug, Deserialize)]
#[serde(untagged)]
pub(super) enum Scale {
    Uniform(f64),
    Axes([f64; 3]),
}

/// All steps one after the other.
pub(super) fn of(steps: &[Step]) -> Result<DAffine3, String> {
    let mut whole = DAffine3::IDENTITY;
    for (number, step) in steps.iter().enumerate() {
        let map = one(step).map_err(|what| format!("transform step {}: {what}", number + 1))?;
        whole = map * whole;
    }
    let determinant = whole.matrix3.determinant();
    if !whole.is_finite() || !(determinant.abs() > 0.0) || !determinant.is_finite() {
        return Err("the transform flattens space or is not finite".to_owned());
    }
    Ok(whole)
}

fn one(step: &Step) -> Result<DAffine3, String> {
    Ok(match step {
        Step::Translate(by) => DAffine3::from_translation(DVec3::from_array(*by)),
        Step::Rotate(rotation) => {
            let axis = DVec3::from_array(rotation.axis).try_normalize().ok_or("the axis has no direction")?;
            let about = DVec3::from_array(rotation.about);
            // Quarter turns are exact, so that boxes stay boxes.
            let quarters = rotation.angle / 90.0;
            let turn = if quarters.fract() == 0.0 && axis.abs().max_element() == 1.0 {
                let (sine, cosine) =
                    [(0.0, 1.0), (1.0, 0.0), (0.0, -1.0), (-1.0, 0.0)][quarters.rem_euclid(4.0) as usize % 4];
                quarter(axis, sine, cosine)
            } else {
                DMat3::from_quat(DQuat::from_axis_angle(axis, rotation.angle.to_radians()))
            };
            DAffine3 { matrix3: turn, translation: about - turn * about }
        }
        Step::Scale(Scale::Uniform(factor)) => DAffine3::from_scale(DVec3::splat(*factor)),
        Step::Scale(Scale::Axes(factors)) => DAffine3::from_scale(DVec3::from_array(*factors)),
        Step::Mirror(normal) => {
            let normal = DVec3::from_array(*normal).try_normalize().ok_or("the normal has no direction")?;
            let twice = normal * 2.0;
            let flip = DMat3::from_cols(twice * normal.x, twice * normal.y, twice * normal.z);
            DAffine3::from_mat3(DMat3::IDENTITY - flip)
        }
        Step::Matrix(rows) => {
            let column = |k: usize| DVec3::new(rows[0][k], rows[1][k], rows[2][k]);
            DAffine3::from_cols(column(0), column(1), column(2), column(3))
        }
    })
}

/// A turn about a coordinate axis (Rodrigues).
fn quarter(axis: DVec3, sine: f64, cosine: f64) -> DMat3 {
    let column = |v: DVec3| v * cosine + axis.cross(v) * sine + axis * (axis.dot(v) * (1.0 - cosine));
    DMat3::from_cols(column(DVec3::X), column(DVec3::Y), column(DVec3::Z))
}
