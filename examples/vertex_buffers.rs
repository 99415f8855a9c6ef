//! Buffers for a graphics library (wgpu, bevy, three.js) from the result of a boolean, with normals and texture coordinates.
//!
//! `cargo run --example vertex_buffers`

use trisect::mesh::Attribute;
use trisect::{BooleanOptions, CutFaces, Error, Mesh, Operation, Solid, primitives};

/// One vertex as a shader takes it: 32 bytes, in this order.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
struct Vertex {
    position: [f32; 3],
    normal: [f32; 3],
    uv: [f32; 2],
}

fn main() -> Result<(), Error> {
    // 1. A body with a texture all around, and a tool.
    let mut drum = primitives::cylinder(1.0, 3.0, 64)?;
    drum.set_attribute(wrapped(&drum));
    let drum = Solid::try_from(drum)?;
    let ball = Solid::try_from(primitives::icosphere(0.9, 4)?.translated([1.0, 0.0, 1.5]))?;

    // 2. Cut it. The faces that the tool made are to show the texture too, twice in a unit of length.
    let options = BooleanOptions::new().cut_faces(CutFaces::body().boxed(2.0));
    let mut cut = options.run(Operation::Difference, [&drum, &ball])?.into_solid().into_mesh();

    // 3. Normals: smooth, but for edges of more than 40 degrees.
    cut.set_attribute(cut.crease_normals(40.0));

    // 4. Buffers. A vertex on a seam or an edge is several.
    let buffers = cut.vertex_buffers(&["NORMAL", "TEXCOORD_0"]);
    let vertices: Vec<Vertex> = (0..buffers.positions.len())
        .map(|i| Vertex {
            position: buffers.positions[i],
            normal: std::array::from_fn(|k| buffers.attributes[0][3 * i + k]),
            uv: std::array::from_fn(|k| buffers.attributes[1][2 * i + k]),
        })
        .collect();
    println!(
        "{} triangles, {} vertices of the mesh, {} of the buffer ({} bytes), {} indices",
        cut.triangles.len(),
        cut.positions.len(),
        vertices.len(),
        size_of_val(vertices.as_slice()),
        buffers.indices.len(),
    );
    let Vertex { position, normal, uv } = vertices[0];
    println!("the first: at {position:?}, normal {normal:?}, uv {uv:?}");

    // The other way: a mesh of such arrays is an operand again, its vertices joined where they are at the same places.
    let flat: Vec<f32> = buffers.positions.iter().flatten().copied().collect();
    let again = Solid::try_from(Mesh::from_f32(&flat, &buffers.indices)?)?;
    println!("again: volume {:.6}, {} vertices", again.volume(), again.mesh().positions.len());
    Ok(())
}

/// A texture wrapped once around the axis, with a seam at the back.
fn wrapped(drum: &Mesh) -> Attribute {
    let mut uv = Attribute::new("TEXCOORD_0", 2);
    for triangle in &drum.triangles {
        let around = triangle.map(|vertex| {
            let [x, y, _] = drum.positions[vertex as usize];
            y.atan2(x) / std::f64::consts::TAU
        });
        let most = around.iter().copied().fold(f64::MIN, f64::max);
        for (&vertex, around) in triangle.iter().zip(around) {
            // No triangle spans half of the drum.
            let u = if most - around > 0.5 { around + 1.0 } else { around };
            uv.of_corner.push(uv.len() as u32);
            uv.values.extend([u, drum.positions[vertex as usize][2] / 3.0]);
        }
    }
    uv
}
