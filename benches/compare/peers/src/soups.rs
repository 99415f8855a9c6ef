//! What manifold-rust's robust engine makes of soups.

use std::error::Error;
use std::time::Instant;

use manifold_rust::manifold::Manifold;
use manifold_rust::types::{MeshGL64, WindingRule};

/// Prints what becomes of each file.
pub fn run(files: &[String]) -> Result<(), Box<dyn Error>> {
    for path in files {
        let mesh = read(path)?;
        let start = Instant::now();
        let soup = Manifold::from_mesh_gl64_robust(&mesh);
        let made = soup.repair_orientation().rebuild_solid(WindingRule::Positive);
        println!(
            "{{\"file\": {path:?}, \"status\": \"{:?}\", \"volume\": {}, \"ms\": {:.3}}}",
            made.status(),
            made.volume(),
            start.elapsed().as_secs_f64() * 1e3
        );
    }
    Ok(())
}

/// Reads an OFF file of triangles, as the benchmark writes it.
fn read(path: &str) -> Result<MeshGL64, Box<dyn Error>> {
    let text = std::fs::read_to_string(path)?;
    let mut words = text.split_ascii_whitespace().skip(1);
    let mut next = || words.next().ok_or("too few numbers");
    let (vertices, faces): (usize, usize) = (next()?.parse()?, next()?.parse()?);
    next()?;
    let mut mesh = MeshGL64 { num_prop: 3, ..MeshGL64::default() };
    for _ in 0..3 * vertices {
        mesh.vert_properties.push(next()?.parse()?);
    }
    for _ in 0..faces {
        next()?;
        for _ in 0..3 {
            mesh.tri_verts.push(next()?.parse()?);
        }
    }
    Ok(mesh)
}
