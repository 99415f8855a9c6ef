//! Simple closed meshes made by code.
//!
//! All are closed 2-manifolds that face outwards, with as few vertices as their shape needs: caps and other flat
//! faces have no inner vertices. Bodies of revolution stand on the plane z = 0 (cylinder, cone) or are centred at
//! the origin (sphere, torus); [`Mesh`](crate::Mesh)'s transforms put them elsewhere. Their vertices are symmetric
//! to the last bit. Same arguments, same mesh, bit for bit; counts and order of vertices are stated with each.
//!
//! ```
//! use trisect::{Solid, primitives};
//!
//! let drill = primitives::cylinder(0.25, 3.0, 64)?.translated([0.5, 0.5, -1.0]);
//! assert!(Solid::try_from(drill)?.is_manifold());
//! # Ok::<(), trisect::Error>(())
//! ```

mod extrusion;
mod loft;
mod polygon;
mod polyhedra;
mod prism;
mod round;
mod sphere;

pub use extrusion::extrusion;
pub(crate) use loft::{boundary_edges, loft};
pub use polyhedra::{cuboid, octahedron, tetrahedron};
pub(crate) use prism::prism;
pub use round::{cone, cylinder, frustum, torus};
pub use sphere::{geodesic_sphere, icosphere, uv_sphere};

use crate::Error;

fn invalid<T>(what: String) -> Result<T, Error> {
    Err(Error::InvalidArgument(what))
}

/// Refuses a length that is not positive and finite.
fn check_length(of: &str, name: &str, length: f64) -> Result<(), Error> {
    if length.is_finite() && length > 0.0 {
        return Ok(());
    }
    invalid(format!("{of}: the {name} must be positive and finite, not {length}"))
}

/// Refuses too few of something.
fn check_count(of: &str, name: &str, count: u32, least: u32) -> Result<(), Error> {
    if count >= least {
        return Ok(());
    }
    invalid(format!("{of}: at least {least} {name} are needed, not {count}"))
}

/// Refuses more triangles than a [`Solid`](crate::Solid) may have.
fn check_size(of: &str, triangles: u128) -> Result<(), Error> {
    const MOST: u128 = u32::MAX as u128 / 3;
    if triangles <= MOST {
        return Ok(());
    }
    invalid(format!("{of}: {triangles} triangles would be needed, more than the limit of {MOST}"))
}

/// The point of the unit circle at `step` of `steps` equal steps from the x axis; symmetric in all eight octants
/// to the last bit, and exact on the axes.
fn circle_point(step: u32, steps: u32) -> [f64; 2] {
    let (step, steps) = (u64::from(step % steps), u64::from(steps));
    let quarter = 4 * step / steps;
    // How far into the quarter, in units of 1/(4 steps) turns: the quarter has `steps` of them.
    let part = 4 * step - quarter * steps;
    let eighth = part.min(steps - part);
    let angle = std::f64::consts::FRAC_PI_2 * (eighth as f64 / steps as f64);
    let (mut y, mut x) = angle.sin_cos();
    if 2 * part == steps {
        (x, y) = (std::f64::consts::FRAC_1_SQRT_2, std::f64::consts::FRAC_1_SQRT_2);
    } else if eighth != part {
        (x, y) = (y, x);
    }
    match quarter {
        0 => [x, y],
        1 => [-y, x],
        2 => [-x, -y],
        _ => [y, -x],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn circle_is_symmetric() {
        assert_eq!(circle_point(0, 3), [1.0, 0.0]);
        for steps in [4u32, 8, 12, 20, 64] {
            for step in 0..steps {
                let [x, y] = circle_point(step, steps);
                assert_eq!(circle_point(steps - step, steps), [x, -y]);
                assert_eq!(circle_point(step + steps / 4, steps), [-y, x]);
                assert!((x.hypot(y) - 1.0).abs() < 1e-15);
                let angle = std::f64::consts::TAU * f64::from(step) / f64::from(steps);
                assert!((angle.cos() - x).abs() < 1e-15 && (angle.sin() - y).abs() < 1e-15);
            }
        }
    }
}
