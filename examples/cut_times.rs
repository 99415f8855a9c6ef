//! How long cuts and sections of given models take: `cargo run --release --example cut_times -- MODEL...`
//!
//! One line of JSON for each model. `benches/cuts.py` runs it beside other libraries.

use std::time::Instant;

use trisect::exact::Plane;
use trisect::{BooleanOptions, Mesh, PlaneCut, SectionSide, Sections, Solid};

/// Milliseconds of the fastest of several runs.
fn fastest(runs: usize, mut work: impl FnMut()) -> f64 {
    let times = (0..runs).map(|_| {
        let start = Instant::now();
        work();
        start.elapsed().as_secs_f64() * 1e3
    });
    times.fold(f64::INFINITY, f64::min)
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    for path in std::env::args().skip(1) {
        let solid = Solid::try_from(Mesh::load(&path)?)?;
        let Some(bounds) = solid.bounds() else { continue };
        let centre = bounds.center();
        let oblique = [1.0, 2.0, 3.0];
        let offset = (0..3).map(|k| oblique[k] * centre[k]).sum();
        let planes = [("z", Plane::across(2, centre[2])?), ("oblique", Plane::new(oblique, offset)?)];
        let options = BooleanOptions::new().threads(1).assume_clean(true);
        for (name, plane) in planes {
            let cut = PlaneCut::new(plane).options(options.clone());
            let milliseconds = fastest(7, || {
                cut.halves(&solid).expect("a cut");
            });
            let (above, below) = cut.halves(&solid)?;
            let sum = above.solid().volume() + below.solid().volume();
            let area = solid.section(&plane).map(|section| section.area())?;
            println!(
                "{{\"model\": \"{path}\", \"triangles\": {}, \"plane\": \"{name}\", \"ms\": {milliseconds:.3}, \"off\": {:e}, \
                 \"area\": {area}, \"new\": {}}}",
                solid.mesh().triangles.len(),
                (sum - solid.volume()).abs() / bounds.size().iter().product::<f64>(),
                above.origins().iter().filter(|origin| origin.operand == 1).count(),
            );
        }
        let (low, high) = (bounds.low[2], bounds.high[2]);
        let layers: Vec<Plane> = (0..1000)
            .map(|i| Plane::across(2, low + (high - low) * (f64::from(i) + 0.5) / 1000.0))
            .collect::<Result<_, _>>()?;
        let sections = Sections::new().side(SectionSide::Above).options(options);
        let mut sum = 0.0;
        let milliseconds = fastest(3, || {
            let found = sections.at(&solid, &layers).expect("sections");
            sum = found.iter().map(trisect::Section::area).sum::<f64>() * (high - low) / 1000.0;
        });
        println!(
            "{{\"model\": \"{path}\", \"layers\": 1000, \"ms\": {milliseconds:.3}, \"integral\": {sum}, \"volume\": {}}}",
            solid.volume()
        );
    }
    Ok(())
}
