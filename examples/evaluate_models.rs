//! Evaluates model files and writes what they describe: `cargo run --release --example evaluate_models -- OUT MODEL...`
//!
//! For every model a mesh (OBJ) and a section through the middle of its bounds (PNG) are written to the folder OUT.
#![allow(clippy::print_stdout, reason = "an example reports on standard output")]

use std::fmt::Write as _;
use std::path::Path;
use std::time::Instant;

use trisect::Control;
use trisect::field::{Section, SectionPicture};
use trisect::model::{Evaluation, Model};

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
        let mut text = String::new();
        for [x, y, z] in &found.mesh.positions {
            writeln!(text, "v {x:?} {y:?} {z:?}")?;
        }
        for triangle in &found.mesh.triangles {
            let [a, b, c] = triangle.map(|vertex| vertex + 1);
            writeln!(text, "f {a} {b} {c}")?;
        }
        std::fs::write(Path::new(&out).join(format!("{name}.obj")), text)?;
        if let Some([low, high]) = evaluation.bounds(&model)? {
            let room = (0..3).map(|axis| high[axis] - low[axis]).fold(0.0, f64::max) * 0.08;
            let (low, high) = (low.map(|x| x - room), high.map(|x| x + room));
            let middle = (low[2] + high[2]) / 2.0;
            let section = Section::across(2, middle, low, high)?;
            let field = evaluation.field(&model)?;
            let picture = SectionPicture::of(&field, &section, 480, None, &Control::new())?;
            let file = std::fs::File::create(Path::new(&out).join(format!("{name}-section.png")))?;
            picture.write_png(std::io::BufWriter::new(file))?;
        }
    }
    Ok(())
}
