//! Free forms: a mug, linked rings and a machine part, each a chain of booleans of cages. Writes the cages as OBJ files.
//!
//!     cargo run --release --example free_forms -- FOLDER
//!     trisect subdivide FOLDER/mug.obj --levels 0 --png mug.png -o mug-again.obj

#[allow(dead_code, reason = "another example uses the rest")]
mod shapes;

use std::path::Path;

use trisect::subdivision::{ControlMesh, FreeForm, FreeFormReport, Rules, Tags};
use trisect::{Operation, primitives};

use shapes::{block, cylinder, moved, torus};

/// How near a result is, and what it has.
fn described(report: &FreeFormReport) -> String {
    format!(
        "{} control points, {} unchanged, at most {} faces at a vertex, {} corners of three surfaces, off by {:.1e} (asked {:.1e}), {:.2} s",
        report.vertices,
        report.unchanged,
        report.valence,
        report.junctions,
        report.errors.largest(),
        report.asked,
        report.seconds.iter().map(|(_, seconds)| seconds).sum::<f64>()
    )
}

/// Takes steps one after the other, and says how near each result is.
fn chain(
    name: &str,
    folder: &Path,
    first: ControlMesh,
    steps: &[(Operation, ControlMesh)],
) -> Result<(), Box<dyn std::error::Error>> {
    std::fs::write(folder.join(format!("{name}-body.obj")), first.to_obj())?;
    let mut cage = first;
    for (index, (operation, next)) in steps.iter().enumerate() {
        std::fs::write(folder.join(format!("{name}-part{}.obj", index + 1)), next.to_obj())?;
        let outcome = FreeForm::new().attempts(0).run(*operation, &cage, next)?;
        println!("{name}, {operation}: {}", described(outcome.report()));
        cage = outcome.into_surface();
    }
    std::fs::write(folder.join(format!("{name}.obj")), cage.to_obj())?;
    Ok(())
}

/// The same operands all at once: distances do not add up.
fn at_once(
    name: &str,
    folder: &Path,
    operation: Operation,
    cages: &[&ControlMesh],
) -> Result<(), Box<dyn std::error::Error>> {
    let outcome = FreeForm::new().attempts(0).run_all(operation, cages)?;
    println!("{name}, {operation} of {} at once: {}", cages.len(), described(outcome.report()));
    std::fs::write(folder.join(format!("{name}.obj")), outcome.surface().to_obj())?;
    Ok(())
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = std::env::args().nth(1).unwrap_or_else(|| ".".into());
    let folder = Path::new(&folder);
    std::fs::create_dir_all(folder)?;
    // The mug of the paper's figure 3.
    let body = cylinder(12, 6, 1.0, 0.0, 2.4)?;
    let handle = moved(&torus(12, 6, 0.65, 0.16)?, |[x, y, z]| [x + 1.05, -z + 0.02, y + 1.2])?;
    let inside = cylinder(12, 6, 0.85, 0.2, 2.8)?;
    chain("mug", folder, body, &[(Operation::Union, handle), (Operation::Difference, inside)])?;
    // Two rings that cross in two places.
    let ring = torus(20, 10, 1.0, 0.35)?;
    let other = moved(&ring, |[x, y, z]| [x + 0.55, -z + 0.03, y + 0.02])?;
    chain("rings", folder, ring, &[(Operation::Union, other)])?;
    // A block with round corners and sharp rims, four bores and a slot.
    let plate = block([10, 8, 2], [-1.5, -1.2, 0.0], [1.5, 1.2, 0.6], &[[0, 2], [1, 2]])?;
    let mut steps = Vec::new();
    for [x, y] in [[-0.9, -0.6], [0.9, -0.6], [0.9, 0.6], [-0.9, 0.6]] {
        steps.push((
            Operation::Difference,
            moved(&cylinder(8, 4, 0.22, -0.3, 0.9)?, |[a, b, z]| [a + x, b + y, z])?,
        ));
    }
    let slot = block([6, 2, 3], [-0.6, -0.14, 0.3], [0.6, 0.14, 1.2], &[[0, 2], [1, 2]])?;
    steps.push((Operation::Difference, slot));
    let mut cages = vec![&plate];
    cages.extend(steps.iter().map(|(_, tool)| tool));
    at_once("part-at-once", folder, Operation::Difference, &cages)?;
    chain("part", folder, plate, &steps)?;
    // Three balls, and a tube that goes through itself.
    let ball = |at: [f64; 3]| {
        let ball = primitives::icosphere(1.0, 2)?.translated(at);
        ControlMesh::new(ball.positions, ball.triangles, Tags::default(), Rules::Loop)
    };
    let balls = [ball([0.0; 3])?, ball([0.9, 0.1, 0.2])?, ball([0.4, 0.8, 0.1])?];
    at_once("balls", folder, Operation::Union, &balls.each_ref())?;
    let eight = moved(&torus(40, 10, 1.0, 0.16)?, |[x, y, z]| {
        // The ring bent to a figure of eight: its middle line goes to (sin t, sin t cos t), what is beside it along.
        let (t, r) = (y.atan2(x), x.hypot(y) - 1.0);
        let along = [t.cos(), (2.0 * t).cos()];
        let length = along[0].hypot(along[1]);
        [t.sin() + r * along[1] / length, t.sin() * t.cos() - r * along[0] / length, z + 0.05 * t.cos()]
    })?;
    std::fs::write(folder.join("eight-itself.obj"), eight.to_obj())?;
    at_once("eight", folder, Operation::Union, &[&eight])
}
