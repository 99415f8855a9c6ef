//! Evaluates model files and writes what they describe: `cargo run --release --example evaluate_models -- OUT MODEL...`
//!
//! For every model a mesh (OBJ), its picture (PNG) and a section through the middle of its bounds (PNG) are written to the folder OUT.
#![allow(clippy::print_stdout, reason = "an example reports on standard output")]

use std::path::Path;
use std::time::Instant;

use trisect::Control;
use trisect::field::Section;
use trisect::model::{Evaluation, Model};
use trisect::render::View;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let out = arguments.next().ok_or("name a folder to write to, then models")?;
    for path in arguments {
        let path = Path::new(&path);
        let name = path.file_stem().and_then(|stem| stem.to_str()).unwrap_or("model");
        let model = Model::load(path)?;
        let evaluation = Evaluation::new();
        let start = Instant::now();
        let found = match evaluation.run(&model) {
            Ok(found) => found,
            Err(error) => {
                println!("{name}: {error}");
                continue;
            }
        };
        println!(
            "{name}: {} triangles in {:.2} s, {:?}",
            found.mesh.triangles.len(),
            start.elapsed().as_secs_f64(),
            found.extraction
        );
        found.mesh.save(Path::new(&out).join(format!("{name}.obj")))?;
        let mut view = View::default();
        (view.width, view.height) = (480, 360);
        trisect::render::mesh(&found.mesh, &view, None)
            .save_png(Path::new(&out).join(format!("{name}.png")))?;
        if let Some([low, high]) = evaluation.bounds(&model)? {
            let room = (0..3).map(|axis| high[axis] - low[axis]).fold(0.0, f64::max) * 0.08;
            let (low, high) = (low.map(|x| x - room), high.map(|x| x + room));
            let middle = (low[2] + high[2]) / 2.0;
            let section = Section::across(2, middle, low, high)?;
            let field = evaluation.field(&model)?;
            let picture = section.picture(&field, 480, None, &Control::new())?;
            picture.save_png(Path::new(&out).join(format!("{name}-section.png")))?;
        }
    }
    Ok(())
}
