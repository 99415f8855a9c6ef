//! Sections of the aircraft's signed distance (Choporov 2017), alone and united with two torpedo-shaped engines by
//! R-functions, at y = 0 and z = 0. By the paper's formulas over all triangles, for show: a hierarchy answers such
//! queries far faster. Writes PNG pictures into the folder given as argument (without: `out`).
#![allow(clippy::print_stdout, reason = "the program's output")]

use std::fs::File;
use std::path::{Path, PathBuf};

use glam::DVec3;
use trisect::parametric::json::{parse, solid};
use trisect::{Control, Mesh};

/// Pixels per unit.
const SCALE: f64 = 60.0;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = PathBuf::from(std::env::args().nth(1).unwrap_or_else(|| "out".into()));
    std::fs::create_dir_all(&folder)?;
    let mut leaf = parse(include_str!("parametric/aircraft.json"))?;
    leaf["tolerance"] = 0.02.into();
    let mesh = solid(&leaf, &Control::new())?;
    let alone = |p: DVec3| signed_distance(&mesh, p);
    let with_engines = |p: DVec3| {
        let or = |a: f64, b: f64| a + b + a.hypot(b);
        let left = torpedo(p - DVec3::new(0.0, 1.5, 0.0));
        or(or(signed_distance(&mesh, p), left), torpedo(p + DVec3::new(0.0, 1.5, 0.0)))
    };
    let upright = |x: f64, z: f64| DVec3::new(x, 0.0, z);
    let level = |x: f64, y: f64| DVec3::new(x, y, 0.0);
    draw(&folder.join("aircraft-y0.png"), [[-1.0, 9.0], [-1.5, 4.0]], |a, b| alone(upright(a, b)))?;
    draw(&folder.join("aircraft-z0.png"), [[-1.0, 9.0], [-5.0, 5.0]], |a, b| alone(level(a, b)))?;
    draw(&folder.join("aircraft-engines-z0.png"), [[-1.0, 9.0], [-5.0, 5.0]], |a, b| {
        with_engines(level(a, b))
    })?;
    println!("distance at (4, 0, 1): {}", alone(DVec3::new(4.0, 0.0, 1.0)));
    Ok(())
}

/// x AND (r^2 - y^2 - z^2) AND (4 - x), with the radius falling from 1 to 0.5, constant, then falling to 0.
fn torpedo(p: DVec3) -> f64 {
    let and = |a: f64, b: f64| a + b - a.hypot(b);
    let r = if p.x <= 1.0 {
        1.0 - 0.5 * p.x
    } else if p.x <= 3.0 {
        0.5
    } else {
        0.5 - 0.5 * (p.x - 3.0)
    };
    and(and(p.x, r * r - p.y * p.y - p.z * p.z), 4.0 - p.x)
}

/// Distance to the nearest triangle, positive inside.
fn signed_distance(mesh: &Mesh, p: DVec3) -> f64 {
    let corners = |t: &[u32; 3]| t.map(|i| DVec3::from(mesh.positions[i as usize]));
    let distance = mesh.triangles.iter().map(|t| to_triangle(p, corners(t))).fold(f64::INFINITY, f64::min);
    // The solid angles of the triangles make a full sphere inside and nothing outside (van Oosterom and Strackee 1983).
    let angle: f64 = mesh.triangles.iter().map(|t| solid_angle(p, corners(t))).sum();
    if angle > std::f64::consts::TAU { distance } else { -distance }
}

fn solid_angle(p: DVec3, corners: [DVec3; 3]) -> f64 {
    let [a, b, c] = corners.map(|corner| corner - p);
    let (la, lb, lc) = (a.length(), b.length(), c.length());
    let below = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
    2.0 * a.dot(b.cross(c)).atan2(below)
}

/// Foot on the plane if it is inside the triangle, else the nearest edge (equations 6 and 9 of the paper).
fn to_triangle(p: DVec3, [a, b, c]: [DVec3; 3]) -> f64 {
    let normal = (b - a).cross(c - a);
    let edges = [(a, b), (b, c), (c, a)];
    if edges.iter().all(|(u, v)| normal.cross(*v - *u).dot(p - *u) >= 0.0) && normal.length() > 0.0 {
        return normal.dot(p - a).abs() / normal.length();
    }
    let to_edge = |(u, v): (DVec3, DVec3)| {
        let along = ((p - u).dot(v - u) / (v - u).length_squared()).clamp(0.0, 1.0);
        p.distance(u + (v - u) * along)
    };
    edges.into_iter().map(to_edge).fold(f64::INFINITY, f64::min)
}

/// Bands of colour, orange inside and blue outside, a line every quarter, a strong one at zero.
fn draw(
    path: &Path,
    [across, up]: [[f64; 2]; 2],
    f: impl Fn(f64, f64) -> f64,
) -> Result<(), Box<dyn std::error::Error>> {
    let [width, height] = [across, up].map(|[low, high]| ((high - low) * SCALE) as u32);
    let mut pixels = Vec::new();
    for row in 0..height {
        for column in 0..width {
            let x = across[0] + (f64::from(column) + 0.5) / SCALE;
            let y = up[1] - (f64::from(row) + 0.5) / SCALE;
            pixels.extend(colour(f(x, y)));
        }
    }
    let mut encoder = png::Encoder::new(File::create(path)?, width, height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    Ok(encoder.write_header()?.write_image_data(&pixels)?)
}

fn colour(value: f64) -> [u8; 3] {
    let pixel = 1.0 / SCALE;
    if value.abs() < pixel {
        return [0, 0, 0];
    }
    let strength = (value.abs() / 2.0).sqrt().min(1.0);
    let full = if value > 0.0 { [214.0, 96.0, 30.0] } else { [40.0, 90.0, 160.0] };
    let line = (value / 0.25 - (value / 0.25).round()).abs() * 0.25 < 0.4 * pixel;
    let shade = if line { 0.75 } else { 1.0 };
    full.map(|channel| (shade * (255.0 + (channel - 255.0) * (0.15 + 0.75 * strength))) as u8)
}
