//! Free forms: a mug, linked rings and a machine part, each a chain of booleans of cages. Writes the cages as OBJ files.
//!
//!     cargo run --release --example free_forms -- FOLDER
//!     trisect subdivide FOLDER/mug.obj --levels 0 --png mug.png -o mug-again.obj

use std::f64::consts::TAU;
use std::path::Path;

use trisect::subdivision::{ControlMesh, Crease, FreeForm, Rules, Tags};
use trisect::{Error, Operation};

/// A cylinder along z with creased rims.
fn cylinder(sides: u32, rows: u32, radius: f64, low: f64, high: f64) -> Result<ControlMesh, Error> {
    let mut positions = vec![[0.0, 0.0, low], [0.0, 0.0, high]];
    for j in 0..=rows {
        for i in 0..sides {
            let (sine, cosine) = (TAU * (f64::from(i) + 0.5 * f64::from(j % 2)) / f64::from(sides)).sin_cos();
            positions.push([
                radius * cosine,
                radius * sine,
                low + (high - low) * f64::from(j) / f64::from(rows),
            ]);
        }
    }
    let at = |j: u32, i: u32| 2 + j * sides + i % sides;
    let (mut faces, mut tags) = (Vec::new(), Tags::default());
    for i in 0..sides {
        faces.extend([[0, at(0, i + 1), at(0, i)], [1, at(rows, i), at(rows, i + 1)]]);
        for j in 0..rows {
            let (a, b, c, d) = (at(j, i), at(j, i + 1), at(j + 1, i), at(j + 1, i + 1));
            faces.extend(if j % 2 == 0 { [[a, b, c], [b, d, c]] } else { [[a, b, d], [a, d, c]] });
        }
        for j in [0, rows] {
            tags.creases.push(Crease { edge: [at(j, i), at(j, i + 1)], sharpness: f64::INFINITY });
        }
    }
    ControlMesh::new(positions, faces, tags, Rules::Loop)
}

/// A ring in the plane z = 0.
fn torus(around: u32, across: u32, radius: f64, tube: f64) -> Result<ControlMesh, Error> {
    let mut positions = Vec::new();
    for i in 0..around {
        for j in 0..across {
            let a = TAU * f64::from(i) / f64::from(around);
            let b = TAU * (f64::from(j) + 0.5 * f64::from(i % 2)) / f64::from(across);
            let r = radius + tube * b.cos();
            positions.push([r * a.cos(), r * a.sin(), tube * b.sin()]);
        }
    }
    let at = |i: u32, j: u32| (i % around) * across + j % across;
    let mut faces = Vec::new();
    for i in 0..around {
        for j in 0..across {
            let (a, b, c, d) = (at(i, j), at(i + 1, j), at(i, j + 1), at(i + 1, j + 1));
            faces.extend(if i % 2 == 0 { [[a, b, c], [c, b, d]] } else { [[a, b, d], [a, d, c]] });
        }
    }
    ControlMesh::new(positions, faces, Tags::default(), Rules::Loop)
}

/// A block of cells, faces outwards; edges between faces of the directions in `sharp` (pairs of axes) are creases.
fn block(cells: [u32; 3], low: [f64; 3], high: [f64; 3], sharp: &[[usize; 2]]) -> Result<ControlMesh, Error> {
    let mut numbers = std::collections::BTreeMap::new();
    let mut positions = Vec::new();
    let mut faces = Vec::new();
    let mut number = |at: [u32; 3]| {
        *numbers.entry(at).or_insert_with(|| {
            positions.push(std::array::from_fn(|k| {
                low[k] + (high[k] - low[k]) * f64::from(at[k]) / f64::from(cells[k])
            }));
            positions.len() as u32 - 1
        })
    };
    for axis in 0..3 {
        let (p, q) = ((axis + 1) % 3, (axis + 2) % 3);
        for side in [0, cells[axis]] {
            for i in 0..cells[p] {
                for j in 0..cells[q] {
                    let mut corner = |di: u32, dj: u32| {
                        let mut at = [0; 3];
                        (at[axis], at[p], at[q]) = (side, i + di, j + dj);
                        number(at)
                    };
                    let (a, b, c, d) = (corner(0, 0), corner(1, 0), corner(0, 1), corner(1, 1));
                    let two = [[a, b, d], [a, d, c]];
                    faces.extend(two.map(|[a, b, c]| if side == 0 { [a, c, b] } else { [a, b, c] }));
                }
            }
        }
    }
    let mut tags = Tags::default();
    for (at, &v) in &numbers {
        for axis in 0..3 {
            let mut next = *at;
            next[axis] += 1;
            let Some(&w) = numbers.get(&next) else { continue };
            let (p, q) = ((axis + 1) % 3, (axis + 2) % 3);
            let on_edge = [p, q].iter().all(|&k| at[k] == 0 || at[k] == cells[k]);
            if on_edge && sharp.iter().any(|pair| pair.contains(&p) && pair.contains(&q)) {
                tags.creases.push(Crease { edge: [v, w], sharpness: f64::INFINITY });
            }
        }
    }
    ControlMesh::new(positions, faces, tags, Rules::Loop)
}

/// The cage moved by a map that keeps its orientation.
fn moved(cage: &ControlMesh, map: impl Fn([f64; 3]) -> [f64; 3]) -> Result<ControlMesh, Error> {
    let positions = cage.positions().iter().map(|&p| map(p)).collect();
    ControlMesh::new(positions, cage.faces().to_vec(), cage.tags().clone(), cage.rules())
}

/// Takes steps one after the other, and says how near each result is.
fn chain(
    name: &str,
    folder: &Path,
    first: ControlMesh,
    steps: &[(Operation, ControlMesh)],
) -> Result<(), Box<dyn std::error::Error>> {
    let mut cage = first;
    for (index, (operation, next)) in steps.iter().enumerate() {
        std::fs::write(folder.join(format!("{name}-part{}.obj", index + 1)), next.to_obj())?;
        let outcome = FreeForm::new().attempts(0).run(*operation, &cage, next)?;
        let report = outcome.report();
        println!(
            "{name}, {operation}: {} control points, {} unchanged, at most {} faces at a vertex, off by {:.1e} (asked {:.1e}), \
             {:.2} s",
            report.vertices,
            report.unchanged,
            report.valence,
            report.errors.largest(),
            report.asked,
            report.seconds.iter().map(|(_, seconds)| seconds).sum::<f64>()
        );
        cage = outcome.into_surface();
    }
    std::fs::write(folder.join(format!("{name}.obj")), cage.to_obj())?;
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
    chain("part", folder, plate, &steps)
}
