//! Draws the sign of `orient3d` near a plane, point by point, four times: in plain `f64`, exactly, and exactly with the
//! triangle moved outwards and inwards by an infinitesimal.
//!
//!     cargo run --release --example sign_map -- [OUTPUT.png]
//!
//! Every cell is one position of the fourth point; neighbours differ by one unit in the last place (2^-53) in x or in y.
//! The plane is x = y, the diagonal. Blue: above zero, orange: below zero, black: exactly zero.

use trisect::Error;
use trisect::exact::{Sign, orient3d, orient3d_perturbed};
use trisect::render::Picture;

/// Positions along each axis, and pixels of a cell.
const CELLS: i64 = 40;
const CELL: i64 = 8;
const GAP: i64 = 16;

/// A triangle in the plane x = y.
const TRIANGLE: [[f64; 3]; 3] = [[12.1, 12.1, 3.3], [24.7, 24.7, -7.7], [17.3, 17.3, 21.9]];
/// Its normal, towards which it moves.
const NORMAL: [i32; 3] = [-1, 1, 0];

/// A name and the sign it gives each position of the fourth point.
type Map<'a> = (&'a str, &'a dyn Fn([f64; 3]) -> Sign);

fn main() -> Result<(), Error> {
    let output = std::env::args().nth(1).unwrap_or_else(|| "sign-map.png".into());
    let maps: [Map<'_>; 4] = [
        ("plain f64", &plain),
        ("exact", &|d| orient3d(&TRIANGLE[0], &TRIANGLE[1], &TRIANGLE[2], &d)),
        ("perturbed outwards", &|d| perturbed_sign(d, 1)),
        ("perturbed inwards", &|d| perturbed_sign(d, -1)),
    ];
    let panel = CELLS * CELL;
    let width = maps.len() as i64 * (panel + GAP) - GAP;
    let mut picture = Picture::new(width as u32, panel as u32, [255; 3]);
    for (place, (name, map)) in maps.iter().enumerate() {
        let (mut wrong, mut zero) = (0, 0);
        for row in 0..CELLS {
            for column in 0..CELLS {
                let sign = map(point(column, row));
                // On this side of x = y the triangle's plane is below the point or above it.
                let truth = row.cmp(&column) as i32;
                wrong += i32::from(truth != 0 && sign as i32 != truth);
                zero += i32::from(sign == Sign::Zero);
                let left = place as i64 * (panel + GAP) + column * CELL;
                fill(&mut picture, left, (CELLS - 1 - row) * CELL, colour(sign));
            }
        }
        println!("{name}: {wrong} of {} signs wrong, {zero} zero", CELLS * CELLS);
    }
    picture.save_png(&output)
}

/// The fourth point of a cell.
fn point(column: i64, row: i64) -> [f64; 3] {
    let ulp = f64::EPSILON / 2.0;
    [0.5 + column as f64 * ulp, 0.5 + row as f64 * ulp, 0.5]
}

/// The determinant as one would write it down.
fn plain(d: [f64; 3]) -> Sign {
    let [u, v, w] = TRIANGLE.map(|p| [p[0] - d[0], p[1] - d[1], p[2] - d[2]]);
    let determinant = u[0] * (v[1] * w[2] - v[2] * w[1])
        + u[1] * (v[2] * w[0] - v[0] * w[2])
        + u[2] * (v[0] * w[1] - v[1] * w[0]);
    if determinant > 0.0 {
        Sign::Positive
    } else if determinant < 0.0 {
        Sign::Negative
    } else {
        Sign::Zero
    }
}

/// The sign where the triangle moves along its normal (or against it) and the point stays.
fn perturbed_sign(d: [f64; 3], sense: i32) -> Sign {
    let normal = NORMAL.map(|component| sense * component);
    let [a, b, c] = &TRIANGLE;
    orient3d_perturbed([a, b, c, &d], [normal, normal, normal, [0; 3]])
}

fn colour(sign: Sign) -> [u8; 3] {
    match sign {
        Sign::Positive => [118, 160, 212],
        Sign::Negative => [240, 170, 96],
        Sign::Zero => [0; 3],
    }
}

fn fill(picture: &mut Picture, left: i64, top: i64, colour: [u8; 3]) {
    for y in top..top + CELL {
        for x in left..left + CELL {
            picture.set(x, y, colour);
        }
    }
}
