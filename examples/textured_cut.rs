//! A textured model cut by a ball: the texture goes on, the wall of the hole gets the body's material, and a picture shows it.
//!
//! `cargo run --example textured_cut -- model.glb cut.glb cut.png`

use trisect::mesh::Welding;
use trisect::{BooleanOptions, CutFaces, Error, Mesh, Operation, Solid, mesh::Gate, primitives, render};

fn main() -> Result<(), Error> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [input, output, picture] = arguments.as_slice() else {
        eprintln!("three files: a model to read, one to write, a PNG to draw");
        std::process::exit(1);
    };
    // 1. The model, joined where its file has cracks.
    let mesh = Mesh::load(input)?;
    let body = Gate::new().weld(Welding::Closing).solid(mesh).map_err(|refusal| refusal.error)?;
    let Some(bounds) = body.bounds() else { return Ok(()) };

    // 2. A ball at a corner of its box.
    let size = bounds.size().into_iter().fold(0.0, f64::max);
    let middle = bounds.center();
    let place = [0, 1, 2].map(|k| middle[k] + 0.35 * bounds.size()[k]);
    let ball = primitives::icosphere(0.3 * size, 5)?.translated(place);
    let ball = Solid::try_from(ball)?;

    // 3. The cut, with the texture laid on the wall, once in the size of the model.
    let options = BooleanOptions::new().cut_faces(CutFaces::body().boxed(1.0 / size));
    let cut = options.run(Operation::Difference, [&body, &ball])?;
    println!("{}", cut.certificate());
    for attribute in &cut.solid().mesh().attributes {
        println!("{}: {} values, {} before", attribute.name, attribute.len(), {
            body.mesh().attribute(&attribute.name).map_or(0, trisect::mesh::Attribute::len)
        });
    }

    // 4. A file and a picture, with y upwards.
    let mesh = cut.into_solid().into_mesh();
    let mut view = render::View::default();
    (view.direction, view.up) = ([1.0, 0.8, 1.2], [0.0, 1.0, 0.0]);
    render::mesh(&mesh, &view, None).save_png(picture)?;
    mesh.save(output)?;
    Ok(())
}
