//! Surfaces of fields as the cells give them, beside smooth ones.

use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

use glam::DVec3;
use trisect::field::{Expression, Extraction, Formula, Graph, SignedDistance, System};
use trisect::model::{Evaluation, Model};
use trisect::{Control, Mesh, Solid, primitives};

use super::files;

const TEXTS: [(&str, &str); 4] = [
    ("sphere", "sphere(x - 0.1, y, z, 1)"),
    ("torus", "torus(x, y, z, 0.8, 0.25)"),
    ("gyroid in a ball", "sin(6*x)*cos(6*y) + sin(6*y)*cos(6*z) + sin(6*z)*cos(6*x) and sphere(x, y, z, 1)"),
    ("box less a ball", "min(1 - abs(x), 1 - abs(y), 1 - abs(z)) and not sphere(x - 1, y - 1, z - 1, 0.8)"),
];

/// Model files that are evaluated as fields, with the tolerances that they give.
const MODELS: [(&str, f64); 6] = [
    ("w7-blended-plate.json", 0.01),
    ("hybrid-bracket.json", 0.01),
    ("torpedo.json", 0.01),
    ("w8-pawn.json", 0.01),
    ("w9-atom.json", 0.02),
    ("aircraft-with-engines.json", 0.02),
];
/// Steps from the middle of a triangle to each corner in which the gradient is asked for. On a smooth part it turns by some tenths of a
/// degree from one to the next, for the normals of the corners are within some ten degrees of each other.
const STEPS: u32 = 32;
/// Degrees between the gradients of two steps that are the jump of an edge; smoothing takes edges of less than 6 for smooth.
const JUMP: f64 = 3.0;

/// `offsets`: names of mesh files, each followed by a distance as a part of the diagonal.
pub(super) fn rows(offsets: &[String]) {
    for (name, text) in TEXTS {
        let field = Formula::parse(text).and_then(|f| f.compile(System::R0, &[], &[])).expect(name);
        // The default tolerance of models: a thousandth of the diagonal.
        both(name, &field, ([-1.2; 3], [1.2; 3]), 2.4e-3 * 3f64.sqrt());
    }
    for (name, tolerance) in MODELS {
        let model = Model::load(&Path::new("examples/models").join(name)).expect("the model");
        let (field, bounds) = (Evaluation::new().field(&model), Evaluation::new().bounds(&model));
        let [low, high] = bounds.expect("bounds").expect("a solid");
        both(name, &field.expect("a field"), (low, high), tolerance);
    }
    let cylinder = primitives::cylinder(5.0, 12.0, 32).expect("a cylinder");
    offset("cylinder of 32 sides", cylinder.clone(), 0.0625);
    offset("cylinder of 32 sides", cylinder, -0.0625);
    for pair in offsets.chunks_exact(2) {
        offset(&pair[0], files::read(&pair[0]), pair[1].parse().expect("a number"));
    }
}

/// As [`trisect::making::offset`] does it.
fn offset(name: &str, mesh: Mesh, part: f64) {
    let solid = Solid::try_from(mesh).expect("closed");
    let bounds = solid.bounds().expect("not empty");
    let distance = part * bounds.diagonal();
    let mut graph = Graph::new();
    let leaf = graph.leaf(Arc::new(SignedDistance::new(&solid)));
    let by = graph.constant(distance);
    let root = graph.add(leaf, by);
    let tolerance = (distance.abs() * 0.05).max(bounds.diagonal() * 5e-4);
    let room = distance.max(0.0) + 4.0 * tolerance;
    let region = (bounds.low.map(|x| x - room), bounds.high.map(|x| x + room));
    both(&format!("{name} offset by {part}"), &Expression::new(graph, root), region, tolerance);
}

fn both(name: &str, field: &Expression, (low, high): ([f64; 3], [f64; 3]), tolerance: f64) {
    for smooth in [false, true] {
        let (start, used) = (Instant::now(), processor_seconds());
        let found = Extraction::new(low, high, tolerance).smooth(smooth).run(field).expect(name);
        let seconds = start.elapsed().as_secs_f64();
        let processor = processor_seconds() - used;
        println!(
            "{name} {} triangles {} deviation {:.2} of the tolerance {} seconds {seconds:.2} processor {processor:.2}",
            if smooth { "smooth" } else { "cells" },
            found.mesh.triangles.len(),
            found.deviation / tolerance,
            figures(field, &found.mesh),
        );
    }
}

/// The processor time of all threads so far, where `/proc` tells it.
fn processor_seconds() -> f64 {
    // Fields 14 and 15 of the line, in hundredths of a second, counted from 1; the second is in parentheses.
    let line = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let after = line.rsplit(')').next().unwrap_or_default();
    after.split_whitespace().skip(11).take(2).filter_map(|word| word.parse::<f64>().ok()).sum::<f64>() / 100.0
}

/// Whether an edge of the solid is over a triangle: the gradient jumps somewhere on the way from its middle to a corner.
fn is_at_edge(field: &Expression, middle: DVec3, corners: [DVec3; 3]) -> bool {
    let outward = |place: DVec3| -DVec3::from_array(field.gradient(place.to_array()).1);
    corners.iter().any(|&corner| {
        let mut last = outward(middle);
        (1..=STEPS).any(|step| {
            let next = outward(middle.lerp(corner, 0.999 * f64::from(step) / f64::from(STEPS)));
            next.angle_between(std::mem::replace(&mut last, next)).to_degrees() > JUMP
        })
    })
}

/// Degrees between normals and gradients, of all triangles and of those away from edges, least angles, and crossings.
fn figures(field: &Expression, mesh: &Mesh) -> String {
    let (mut turns, mut away, mut angles) = (Vec::new(), Vec::new(), Vec::new());
    for t in &mesh.triangles {
        let p = t.map(|k| DVec3::from_array(mesh.positions[k as usize]));
        let middle = (p[0] + p[1] + p[2]) / 3.0;
        let outward = -DVec3::from_array(field.gradient(middle.to_array()).1);
        let turn = (p[1] - p[0]).cross(p[2] - p[0]).angle_between(outward).to_degrees();
        turns.push(turn);
        if !is_at_edge(field, middle, p) {
            away.push(turn);
        }
        let at = |k: usize| (p[(k + 1) % 3] - p[k]).angle_between(p[(k + 2) % 3] - p[k]).to_degrees();
        angles.push((0..3).map(at).fold(180.0, f64::min));
    }
    turns.sort_by(f64::total_cmp);
    away.sort_by(f64::total_cmp);
    angles.sort_by(f64::total_cmp);
    let at = |sorted: &[f64], part: usize| {
        sorted.get(sorted.len().saturating_sub(1) * part / 100).copied().unwrap_or(0.0)
    };
    let turned = |turns: &[f64]| turns.iter().filter(|turn| **turn > 90.0).count();
    let solid = Solid::try_from(mesh.clone()).expect("closed");
    let crossings = solid.self_crossings(&Control::new()).expect("no limits").count;
    format!(
        "normals 50% {:.2} 95% {:.2} 99% {:.2} 100% {:.1} turned {} away from edges {} normals 95% {:.2} turned {} \
         least angles 5% {:.1} 50% {:.1} crossings {crossings}",
        at(&turns, 50),
        at(&turns, 95),
        at(&turns, 99),
        at(&turns, 100),
        turned(&turns),
        away.len(),
        at(&away, 95),
        turned(&away),
        at(&angles, 5),
        at(&angles, 50),
    )
}
