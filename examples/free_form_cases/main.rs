//! Booleans of cages, case by case, as rows of a table; and what else one may do with two cages.
//!
//!     cargo run --release --example free_form_cases -- FOLDER            # all cases; FOLDER gets cages and exact results
//!     cargo run --release --example free_form_cases -- apart A.ply B.ply # the distance of two meshes, over the diagonal of A

#[path = "../free_forms/shapes.rs"]
mod shapes;

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::time::Instant;

use shapes::{block, cylinder, moved, torus};
use trisect::spatial::TriangleTree;
use trisect::subdivision::{ControlMesh, Crease, FreeForm, FreeFormOutcome, Place, Rules, Tags};
use trisect::{Control, Error, Mesh, Operation, Solid, primitives};

const SHARP: f64 = f64::INFINITY;

type Done = Result<(), Box<dyn std::error::Error>>;

fn ball(level: u32, radius: f64, centre: [f64; 3]) -> Result<ControlMesh, Error> {
    let mesh = primitives::icosphere(radius, level)?.translated(centre);
    ControlMesh::new(mesh.positions, mesh.triangles, Tags::default(), Rules::Loop)
}

fn shifted(cage: &ControlMesh, by: [f64; 3]) -> Result<ControlMesh, Error> {
    moved(cage, |p| std::array::from_fn(|k| p[k] + by[k]))
}

/// With other tags.
fn tagged(cage: &ControlMesh, creases: Vec<Crease>) -> Result<ControlMesh, Error> {
    let tags = Tags { creases, ..Tags::default() };
    ControlMesh::new(cage.positions().to_vec(), cage.faces().to_vec(), tags, cage.rules())
}

fn diagonal(mesh: &Mesh) -> f64 {
    let Some(bounds) = mesh.bounds() else { return 1.0 };
    (0..3).map(|k| (bounds.high[k] - bounds.low[k]).powi(2)).sum::<f64>().sqrt()
}

/// The largest distance between two meshes, from vertices and middles of triangles.
fn apart(a: &Mesh, b: &Mesh) -> f64 {
    let from = |mesh: &Mesh, tree: &TriangleTree| {
        let middle = |corners: &[u32; 3]| -> [f64; 3] {
            std::array::from_fn(|k| corners.iter().map(|&v| mesh.positions[v as usize][k]).sum::<f64>() / 3.0)
        };
        let points = mesh.positions.iter().copied().chain(mesh.triangles.iter().map(middle));
        points
            .filter_map(|x| {
                let found = tree.closest(x)?.point;
                Some((0..3).map(|k| (found[k] - x[k]).powi(2)).sum::<f64>().sqrt())
            })
            .fold(0.0, f64::max)
    };
    from(a, &TriangleTree::new(b)).max(from(b, &TriangleTree::new(a)))
}

/// The largest angle between the tangent planes of both faces at the middles of smooth edges, in degrees.
fn fold(cage: &ControlMesh) -> f64 {
    let creases: BTreeSet<[u32; 2]> = cage.tags().creases.iter().map(|crease| crease.edge).collect();
    let evaluator = cage.evaluator();
    let mut known = std::collections::BTreeMap::new();
    let mut largest = 0.0f64;
    for (f, face) in cage.faces().iter().enumerate() {
        for k in 0..3 {
            let edge = [face[k].min(face[(k + 1) % 3]), face[k].max(face[(k + 1) % 3])];
            let mut weights = [0.5; 3];
            weights[(k + 2) % 3] = 0.0;
            let Some(here) = evaluator.at(Place { face: f as u32, weights }) else { continue };
            if creases.contains(&edge) {
                continue;
            }
            if let Some(there) = known.insert(edge, here.normal) {
                let dot: f64 = (0..3).map(|k| here.normal[k] * there[k]).sum();
                largest = largest.max(dot.clamp(-1.0, 1.0).acos().to_degrees());
            }
        }
    }
    largest
}

/// The boolean of the cages as they are, before subdivision: the curve is made a crease, and so is what meets at 40 degrees.
fn of_cages(operation: Operation, a: &ControlMesh, b: &ControlMesh) -> Result<Mesh, Error> {
    let outcome = trisect::boolean(operation, &Solid::try_from(a.mesh())?, &Solid::try_from(b.mesh())?)?;
    let mesh = outcome.solid().mesh();
    let mut tags = Tags::default();
    let mut sides = std::collections::BTreeMap::new();
    for (triangle, origin) in mesh.triangles.iter().zip(outcome.origins()) {
        for k in 0..3 {
            let edge = [triangle[k].min(triangle[(k + 1) % 3]), triangle[k].max(triangle[(k + 1) % 3])];
            if sides.insert(edge, origin.operand).is_some_and(|other| other != origin.operand) {
                tags.creases.push(Crease { edge, sharpness: SHARP });
            }
        }
    }
    let cage = ControlMesh::new(mesh.positions.clone(), mesh.triangles.clone(), tags, Rules::Loop)?;
    Ok(cage.with_creases_from_angle(40.0)?.limit_mesh_of_steps(4)?.mesh().clone())
}

struct Table {
    folder: PathBuf,
}

impl Table {
    /// Runs a case and prints its row.
    fn row(
        &self,
        name: &str,
        settings: &FreeForm,
        operation: Operation,
        [a, b]: [&ControlMesh; 2],
    ) -> Option<FreeFormOutcome> {
        let start = Instant::now();
        let outcome = match settings.run(operation, a, b) {
            Ok(outcome) => outcome,
            Err(error) => {
                println!("| {name} | refused: {error} |");
                return None;
            }
        };
        let seconds = start.elapsed().as_secs_f64();
        let report = outcome.report();
        let exact = outcome.exact().solid();
        let scale = diagonal(exact.mesh());
        let errors = report.errors;
        let (cage, kept) = (outcome.surface(), a.positions().len() + b.positions().len());
        let fine = cage.limit_mesh_of_steps(3).ok();
        let crossings =
            fine.and_then(|fine| Some(fine.solid().self_crossings(&Control::default()).ok()?.count));
        let crossings = crossings.map_or("?".into(), |count| count.to_string());
        let naive = of_cages(operation, a, b).map_or(f64::NAN, |mesh| apart(exact.mesh(), &mesh) / scale);
        println!(
            "| {name} | {:.1e} | {:.1e} | {:.1e} | {:.1e} | {} | {} | {} of {kept} | {} | {} | {:.1} | {:.4} | {crossings} | {} | \
             {naive:.1e} | {seconds:.2} |",
            errors.largest() / scale,
            errors.curve / scale,
            errors.band / scale,
            errors.outside / scale,
            report.vertices,
            report.added,
            report.unchanged,
            report.valence,
            report.chains,
            report.crossing,
            fold(cage),
            report.exact_triangles,
        );
        let file = |ending: &str| self.folder.join(format!("{}{ending}", name.replace(' ', "-")));
        if let Err(error) = std::fs::write(file(".obj"), cage.to_obj()) {
            println!("{name}: {error}");
        }
        if let Err(error) = exact.mesh().save(file("-exact.ply")) {
            println!("{name}: {error}");
        }
        Some(outcome)
    }
}

fn cases(folder: &Path) -> Done {
    std::fs::create_dir_all(folder)?;
    let table = Table { folder: folder.into() };
    let native = FreeForm::new().attempts(0);
    let all = [Operation::Union, Operation::Intersection, Operation::Difference];
    println!(
        "| case | off by | curve | band | outside | points | added | as they were | faces at a vertex | chains | crossing angle | \
         angle at smooth edges | self-crossings | exact triangles | boolean before subdivision | seconds |\n|{}",
        "---|".repeat(16)
    );
    // 1. A ball and a cylinder.
    let (coarse, fine) = (ball(1, 1.0, [0.0; 3])?, ball(2, 1.0, [0.0; 3])?);
    let bore = cylinder(8, 6, 0.5, -1.5, 1.5)?;
    table.row("ball of 162 less cylinder", &native, all[2], [&fine, &bore]);
    table.row("ball of 162 less cylinder halved", &native.clone().refine(1), all[2], [&fine, &bore]);
    // 2. Two tori.
    let ring = torus(24, 12, 1.0, 0.35)?;
    let other = moved(&ring, |[x, y, z]| [x + 0.55, -z + 0.03, y + 0.02])?;
    for operation in all {
        table.row(&format!("tori {operation}"), &native, operation, [&ring, &other]);
    }
    // 3. Blobs.
    let blob = |turn: f64| {
        moved(&fine, |[x, y, z]| {
            let r = 1.0 + 0.25 * (3.0 * x + turn).sin() * (2.0 * y - turn).cos();
            [x * r, y * r, 0.8 * z * r]
        })
    };
    let (one, two) = (blob(0.3)?, shifted(&blob(1.7)?, [0.9, 0.2, 0.3])?);
    for operation in all {
        table.row(&format!("blobs {operation}"), &native, operation, [&one, &two]);
    }
    // 4. Densities.
    table.row("42 with 642", &native, all[0], [&coarse, &ball(3, 0.7, [0.8, 0.1, 0.2])?]);
    table.row("42 with 2562", &native, all[0], [&coarse, &ball(4, 0.7, [0.8, 0.1, 0.2])?]);
    let dense = primitives::geodesic_sphere(0.7, 20)?.translated([0.8, 0.1, 0.2]);
    let dense = ControlMesh::new(dense.positions, dense.triangles, Tags::default(), Rules::Loop)?;
    table.row("42 with 4002", &native, all[0], [&coarse, &dense]);
    // 5. Sharp things beside the curve.
    sharp(&table, &native, &fine)?;
    // 6. A chain, each step on the result before.
    chain(&table, &native, &fine)?;
    // 7. Nothing to be cut, or hardly anything.
    table.row("identical union", &native, all[0], [&fine, &fine]);
    table.row("identical intersection", &native, all[1], [&fine, &fine]);
    table.row("identical difference", &native, all[2], [&fine, &fine]);
    table.row("apart", &native, all[0], [&fine, &shifted(&fine, [3.0, 0.0, 0.0])?]);
    table.row("inside", &native, all[2], [&fine, &ball(1, 0.3, [0.0; 3])?]);
    let tall = cylinder(8, 6, 0.5, -1.5, 1.5)?;
    table.row("cylinders close by", &native, all[0], [&tall, &shifted(&tall, [0.98, 0.0, 0.0])?]);
    table.row("nearly identical", &native, all[0], [&fine, &shifted(&fine, [0.001, 0.0, 0.0])?]);
    table.row(
        "flush caps",
        &native,
        all[0],
        [&tall, &shifted(&cylinder(8, 6, 0.3, -1.5, 1.5)?, [0.3, 0.0, 0.0])?],
    );
    Ok(())
}

/// Concave corners, darts and semi-sharp rims beside the curve.
fn sharp(table: &Table, native: &FreeForm, fine: &ControlMesh) -> Done {
    let ell = shapes::of_cells(&|[x, y, _]| x < 3 || y < 3, [6, 6, 2], 0.5)?;
    let over = ball(2, 0.6, [1.5, 1.5, 1.0])?;
    table.row("concave corner cut off", native, Operation::Difference, [&ell, &over]);
    let beside = ball(2, 0.45, [2.2, 0.8, 1.0])?;
    table.row("concave corner beside the curve", native, Operation::Difference, [&ell, &beside]);
    // A crease of three edges that ends on the ball, at the bore and beside it.
    let start = (0..fine.positions().len() as u32)
        .min_by(|&a, &b| {
            let off = |v: u32| {
                let [x, y, z] = fine.positions()[v as usize];
                (x - 0.75).powi(2) + y.powi(2) + (z - 0.66).powi(2)
            };
            off(a).total_cmp(&off(b))
        })
        .unwrap_or(0);
    let mut path = vec![start];
    for _ in 0..3 {
        let last = path[path.len() - 1];
        let towards = |v: u32| fine.positions()[v as usize][2];
        let faces = fine.faces().iter().filter(|face| face.contains(&last));
        let next = faces
            .flatten()
            .copied()
            .filter(|v| !path.contains(v))
            .max_by(|&a, &b| towards(a).total_cmp(&towards(b)));
        path.extend(next);
    }
    let creases = path.windows(2).map(|pair| Crease { edge: [pair[0], pair[1]], sharpness: SHARP }).collect();
    let darted = tagged(fine, creases)?;
    table.row(
        "dart crossing the curve",
        native,
        Operation::Difference,
        [&darted, &cylinder(8, 6, 0.5, -1.5, 1.5)?],
    );
    // A rim that is sharp for two steps and a half.
    let soft = cylinder(10, 4, 1.0, -0.6, 0.6)?;
    let creases = soft.tags().creases.iter().map(|&crease| Crease { sharpness: 2.5, ..crease }).collect();
    let soft = tagged(&soft, creases)?;
    table.row("semi-sharp rim", native, Operation::Difference, [&soft, &ball(2, 0.5, [1.0, 0.1, 0.6])?]);
    Ok(())
}

/// Five operations, one on the result of the other; then a box taken off.
fn chain(table: &Table, native: &FreeForm, fine: &ControlMesh) -> Done {
    let bore = cylinder(8, 6, 0.35, -1.5, 1.5)?;
    let steps = [
        ("chain 1", Operation::Difference, shifted(&bore, [0.3, 0.0, 0.0])?),
        ("chain 2", Operation::Difference, moved(&bore, |[x, y, z]| [z, x - 0.1, y + 0.55])?),
        ("chain 3", Operation::Union, shifted(&cylinder(8, 4, 0.25, 0.3, 1.5)?, [-0.45, 0.3, 0.0])?),
        ("chain 4", Operation::Difference, ball(1, 0.4, [-0.6, -0.7, -0.5])?),
        ("chain 5", Operation::Union, ball(1, 0.4, [0.0, 0.9, -0.5])?),
        (
            "chain and a box",
            Operation::Difference,
            block([4, 4, 4], [-0.2, -1.3, -1.3], [0.2, -0.6, -0.3], &[[0, 1], [0, 2], [1, 2]])?,
        ),
    ];
    let mut cage = fine.clone();
    for (name, operation, next) in &steps {
        if let Some(outcome) = table.row(name, native, *operation, [&cage, next]) {
            cage = outcome.into_surface();
        }
    }
    Ok(())
}

fn main() -> Done {
    let words: Vec<String> = std::env::args().skip(1).collect();
    match &words[..] {
        [word, a, b] if word == "apart" => {
            let (a, b) = (Mesh::load(a)?, Mesh::load(b)?);
            println!(
                "{:.2e} ({} and {} triangles)",
                apart(&a, &b) / diagonal(&a),
                a.triangles.len(),
                b.triangles.len()
            );
            Ok(())
        }
        [folder] => cases(Path::new(folder)),
        _ => Err("a folder is needed, or: apart A.ply B.ply".into()),
    }
}
