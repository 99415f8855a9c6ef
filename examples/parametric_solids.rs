//! Solids from JSON descriptions: the aircraft of six Bezier patches (Choporov 2017) with the volume at falling
//! tolerances, and an extrusion, a revolution and a sweep. Writes OBJ files into the folder given as argument (without:
//! `out`).
#![allow(clippy::print_stdout, reason = "the program's output")]

use std::fmt::Write as _;
use std::path::PathBuf;

use trisect::parametric::json::{named_patches, parse, solid};
use trisect::parametric::{Patch, PatchMeshing};
use trisect::{Control, Mesh};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = PathBuf::from(std::env::args().nth(1).unwrap_or_else(|| "out".into()));
    std::fs::create_dir_all(&folder)?;
    for (name, text) in [
        ("aircraft", include_str!("parametric/aircraft.json")),
        ("engine", include_str!("parametric/engine.json")),
        ("naca0011", include_str!("parametric/naca0011.json")),
        ("column", include_str!("parametric/column.json")),
        ("vase", include_str!("parametric/vase.json")),
        ("knot", include_str!("parametric/knot.json")),
    ] {
        let mesh = solid(&parse(text)?, &Control::new())?;
        println!(
            "{name}: {} vertices, {} triangles, volume {}",
            mesh.positions.len(),
            mesh.triangles.len(),
            volume(&mesh)
        );
        std::fs::write(folder.join(format!("{name}.obj")), obj(&mesh))?;
    }

    let aircraft = parse(include_str!("parametric/aircraft.json"))?;
    let patches: Vec<Patch> = named_patches(&aircraft)?.into_iter().map(|named| named.1).collect();
    let exact: f64 = patches.iter().map(Patch::volume_share).sum();
    let mut volumes = Vec::new();
    println!("delta      triangles  volume      (volume - exact) / delta");
    for k in 0..8 {
        let delta = 0.1 * 0.5_f64.powi(k);
        let made = PatchMeshing::new(delta).closed(&patches)?;
        let found = volume(&made.mesh);
        println!(
            "{delta:<10.6} {:<10} {found:<11.6} {:.2}",
            made.mesh.triangles.len(),
            (found - exact) / delta
        );
        volumes.push([delta, found]);
    }
    println!(
        "extrapolated to delta = 0: {:.6}; by integration over the patches: {exact:.6}",
        at_zero(&volumes[3..])
    );
    Ok(())
}

fn volume(mesh: &Mesh) -> f64 {
    let p = |i: u32| glam::DVec3::from(mesh.positions[i as usize]);
    mesh.triangles.iter().map(|&[a, b, c]| p(a).dot(p(b).cross(p(c)))).sum::<f64>() / 6.0
}

/// The least-squares line through the points, at 0.
fn at_zero(points: &[[f64; 2]]) -> f64 {
    let n = points.len() as f64;
    let (x, y) = (points.iter().map(|p| p[0]).sum::<f64>() / n, points.iter().map(|p| p[1]).sum::<f64>() / n);
    let products: f64 = points.iter().map(|p| (p[0] - x) * (p[1] - y)).sum();
    let squares: f64 = points.iter().map(|p| (p[0] - x).powi(2)).sum();
    y - products / squares * x
}

fn obj(mesh: &Mesh) -> String {
    let mut text = String::new();
    for [x, y, z] in &mesh.positions {
        let _ = writeln!(text, "v {x} {y} {z}");
    }
    let mut group = None;
    for (i, [a, b, c]) in mesh.triangles.iter().enumerate() {
        let of_triangle = mesh.groups.of_triangle.get(i);
        if of_triangle != group {
            group = of_triangle;
            let _ = writeln!(text, "g patch{}", of_triangle.copied().unwrap_or(0));
        }
        let _ = writeln!(text, "f {} {} {}", a + 1, b + 1, c + 1);
    }
    text
}
