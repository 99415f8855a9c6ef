//! Makes the pictures of the documentation.
//!
//!     cargo run --release --example pictures -- [FOLDER]

mod algorithm;
mod contacts;
mod scene;

use std::path::PathBuf;

use trisect::Error;
use trisect::render::Picture;

/// A picture's name and what draws it.
type Drawing = (&'static str, fn() -> Result<Picture, Error>);

const PICTURES: [Drawing; 10] = [
    ("contacts", contacts::table),
    ("algorithm-1-candidates", algorithm::candidates),
    ("algorithm-2-perturbation", contacts::perturbation),
    ("algorithm-3-crossings", algorithm::crossings),
    ("algorithm-4-order", algorithm::order),
    ("algorithm-5-winding", algorithm::winding),
    ("algorithm-6-identify", algorithm::identify),
    ("algorithm-7-cut", algorithm::cut),
    ("algorithm-8-tidy", algorithm::tidy),
    ("algorithm-9-result", algorithm::result),
];

fn main() -> Result<(), Error> {
    let folder = PathBuf::from(std::env::args().nth(1).unwrap_or_else(|| "docs/images".into()));
    for (name, draw) in PICTURES {
        let path = folder.join(format!("{name}.png"));
        draw()?.save_png(&path)?;
        println!("{}", path.display());
    }
    Ok(())
}
