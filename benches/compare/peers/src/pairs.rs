//! A boolean of two meshes by several engines, turn by turn.

use std::error::Error;
use std::path::Path;
use std::time::Instant;

use boolmesh::prelude::{Manifold as Boolmesh, OpType as BoolmeshOperation, compute_boolean};
use manifold_rust::manifold::Manifold;
use manifold_rust::types::{BooleanEngine, Error as Status, MeshGLP, OpType};
use trisect::io::{ReadOptions, load};
use trisect::{BooleanOptions, Mesh, Operation, Solid};

/// The engines, with default settings of each. `trisect, taken to be clean` does not look whether operands cross themselves, as
/// `Exact` and boolmesh do not.
const ENGINES: [Engine; 6] = [
    ("trisect", |a, b, operation| trisect(a, b, operation, false)),
    ("trisect, taken to be clean", |a, b, operation| trisect(a, b, operation, true)),
    ("manifold-rust, Auto", |a, b, operation| manifold(a, b, operation, BooleanEngine::Auto)),
    ("manifold-rust, Robust", |a, b, operation| manifold(a, b, operation, BooleanEngine::Robust)),
    ("manifold-rust, Exact", |a, b, operation| manifold(a, b, operation, BooleanEngine::Exact)),
    ("boolmesh", boolmesh),
];

type Engine = (&'static str, fn(&Mesh, &Mesh, Operation) -> Result<Mesh, String>);

/// Prints for each engine the median and the least of its times, and what its result is.
pub fn run(words: &[String]) -> Result<(), Box<dyn Error>> {
    let [operation, a, b, rounds @ ..] = words else {
        return Err("trisect-peers pair OPERATION A B [ROUNDS]".into());
    };
    let operation: Operation = operation.parse()?;
    let rounds = rounds.first().map_or(Ok(5), |word| word.parse())?;
    let read = |path: &String| load(Path::new(path), &ReadOptions::new()).map(|loaded| loaded.mesh);
    let (a, b) = (read(a)?, read(b)?);
    let mut times: Vec<Vec<f64>> = vec![Vec::new(); ENGINES.len()];
    let mut results: Vec<Result<Mesh, String>> = vec![Err("not run".into()); ENGINES.len()];
    for _ in 0..rounds {
        for ((_, engine), (times, result)) in ENGINES.iter().zip(times.iter_mut().zip(&mut results)) {
            let start = Instant::now();
            *result = engine(&a, &b, operation);
            times.push(start.elapsed().as_secs_f64() * 1e3);
        }
    }
    for ((name, _), (mut times, result)) in ENGINES.iter().zip(times.into_iter().zip(results)) {
        times.sort_by(f64::total_cmp);
        let (median, least) = (times.get(times.len() / 2), times.first());
        let (median, least) = (median.copied().unwrap_or_default(), least.copied().unwrap_or_default());
        match result {
            Ok(mesh) => println!(
                "{{\"engine\": {name:?}, \"ms\": {median:.3}, \"least\": {least:.3}, \"triangles\": {}, \"volume\": {}}}",
                mesh.triangles.len(),
                mesh.volume()
            ),
            Err(error) => println!("{{\"engine\": {name:?}, \"ms\": {median:.3}, \"error\": {error:?}}}"),
        }
    }
    Ok(())
}

fn trisect(a: &Mesh, b: &Mesh, operation: Operation, assume_clean: bool) -> Result<Mesh, String> {
    let solid = |mesh: &Mesh| Solid::try_from(mesh.clone()).map_err(|error| error.to_string());
    let options = BooleanOptions::new().threads(1).assume_clean(assume_clean);
    let outcome = options.run(operation, [&solid(a)?, &solid(b)?]).map_err(|error| error.to_string())?;
    Ok(outcome.into_solid().into_mesh())
}

fn manifold(a: &Mesh, b: &Mesh, operation: Operation, engine: BooleanEngine) -> Result<Mesh, String> {
    let object = |mesh: &Mesh| {
        let mesh = MeshGLP::<f64, u32> {
            num_prop: 3,
            vert_properties: mesh.positions.as_flattened().to_vec(),
            tri_verts: mesh.triangles.as_flattened().to_vec(),
            ..Default::default()
        };
        let object = match engine {
            BooleanEngine::Exact => Manifold::from_mesh_glp(&mesh),
            _ => Manifold::from_mesh_glp_robust(&mesh),
        };
        checked(object)
    };
    let operation = match operation {
        Operation::Union => OpType::Add,
        Operation::Difference => OpType::Subtract,
        Operation::Intersection => OpType::Intersect,
        other => return Err(format!("it has no {other}")),
    };
    let result = checked(object(a)?.boolean_with_engine(&object(b)?, operation, engine))?;
    let mesh = result.get_mesh_glp::<f64, u32>(-1);
    let positions = mesh.vert_properties.chunks_exact(mesh.num_prop as usize).map(|p| [p[0], p[1], p[2]]);
    let positions: Vec<[f64; 3]> = positions.collect();
    let mut merged: Vec<u32> = (0..positions.len() as u32).collect();
    for (&from, &to) in mesh.merge_from_vert.iter().zip(&mesh.merge_to_vert) {
        merged[from as usize] = to;
    }
    let triangles = mesh.tri_verts.chunks_exact(3).map(|t| [0, 1, 2].map(|k| merged[t[k] as usize]));
    Ok(Mesh::new(positions, triangles.collect()))
}

fn checked(object: Manifold) -> Result<Manifold, String> {
    if object.status() == Status::NoError { Ok(object) } else { Err(format!("{:?}", object.status())) }
}

fn boolmesh(a: &Mesh, b: &Mesh, operation: Operation) -> Result<Mesh, String> {
    let object = |mesh: &Mesh| {
        let corners: Vec<usize> = mesh.triangles.as_flattened().iter().map(|&v| v as usize).collect();
        Boolmesh::new(mesh.positions.as_flattened(), &corners)
    };
    let operation = match operation {
        Operation::Union => BoolmeshOperation::Add,
        Operation::Difference => BoolmeshOperation::Subtract,
        Operation::Intersection => BoolmeshOperation::Intersect,
        other => return Err(format!("it has no {other}")),
    };
    let result = compute_boolean(&object(a)?, &object(b)?, operation)?;
    let triangles = result.hs.chunks_exact(3).map(|sides| [0, 1, 2].map(|k| sides[k].tail as u32));
    Ok(Mesh::new(result.ps.iter().map(|p| [p.x, p.y, p.z]).collect(), triangles.collect()))
}
