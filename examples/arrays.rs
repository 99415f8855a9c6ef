//! Arrays in, arrays out, no files: a body prepared once and cut many times, and results that are operands again.
//!
//!     cargo run --release --example arrays

use trisect::{BooleanOptions, Error, Mesh, Operation, Solid};

/// What other libraries hold: three numbers per vertex, three indices per triangle.
type Arrays = (Vec<[f64; 3]>, Vec<[u32; 3]>);

fn main() -> Result<(), Error> {
    // The gate: here, and only here, a mesh is checked. The solid can then be an operand any number of times.
    let body = solid(pyramid([0.0, 0.0, 0.0], 2.0))?;
    let options = BooleanOptions::new().threads(1);

    // The same body against many tools: nothing about it is computed anew.
    for step in 0..5 {
        let tool = solid(pyramid([0.25 * f64::from(step), 0.1, 0.3], 1.0))?;
        let common = options.run(Operation::Intersection, [&body, &tool])?;
        println!("step {step}: common volume {:.6}", common.solid().volume());
    }

    // A chain: each result is the next operand, without another check.
    let mut left = body;
    for step in 0..5 {
        let tool = solid(pyramid([0.5 * f64::from(step) - 1.0, 0.0, 0.0], 0.7))?;
        left = options.run(Operation::Difference, [&left, &tool])?.into_solid();
    }
    println!("left of the body: volume {:.6}", left.volume());

    let (positions, triangles) = arrays(left);
    println!("{} vertices, {} triangles", positions.len(), triangles.len());
    Ok(())
}

/// A solid of two arrays.
fn solid((positions, triangles): Arrays) -> Result<Solid, Error> {
    Solid::try_from(Mesh::new(positions, triangles))
}

/// The arrays of a solid; nothing is copied.
fn arrays(solid: Solid) -> Arrays {
    let mesh = solid.into_mesh();
    (mesh.positions, mesh.triangles)
}

/// A square pyramid about a point.
fn pyramid(about: [f64; 3], size: f64) -> Arrays {
    let corners = [[-0.5, -0.5, 0.0], [0.5, -0.5, 0.0], [0.5, 0.5, 0.0], [-0.5, 0.5, 0.0], [0.0, 0.0, 0.8]];
    let place = |corner: [f64; 3]| [0, 1, 2].map(|k| about[k] + size * corner[k]);
    let triangles = vec![[0, 2, 1], [0, 3, 2], [0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]];
    (corners.map(place).to_vec(), triangles)
}
