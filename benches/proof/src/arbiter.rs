//! Two results of one case, trisect's and another engine's, judged at the same points.
//!
//! Reads records `u64 seed; u32 points; u32 vertices, triangles; f64[3] each vertex; u32[3] each triangle` until the end of
//! the input, and answers each with a line of JSON.

use std::io::{self, BufRead, Write};
use std::panic::{AssertUnwindSafe, catch_unwind};

use crate::judge::cases::{Case, Family, HARD_FROM};
use crate::judge::contacts::{Parted, Topology, touches_itself_along};
use crate::judge::many::{MANY_FROM, Many};
use crate::judge::oracle;
use crate::judge::origin;
use crate::judge::samples;
use crate::judge::surface::{Properties, volume};
use crate::{many, record, run};
use rand::SeedableRng;
use rand::rngs::ChaCha8Rng;
use trisect::Mesh;

pub(crate) fn serve(input: &mut impl BufRead, out: &mut impl Write, models: &[Mesh]) -> io::Result<()> {
    while !input.fill_buf()?.is_empty() {
        let (mut seed, mut points) = ([0; 8], [0; 4]);
        input.read_exact(&mut seed)?;
        input.read_exact(&mut points)?;
        let (seed, points) = (u64::from_le_bytes(seed), u32::from_le_bytes(points) as usize);
        let theirs = record::read_mesh(input)?;
        let (operands, ours, expected) = prepare(seed, models);
        let at_origin = is_as_at_origin(seed, models, &ours);
        let operands: Vec<&Mesh> = operands.iter().collect();
        let mut random = ChaCha8Rng::seed_from_u64(!seed);
        let mut places = samples::points(&operands, &ours, points / 2, &mut random);
        places.extend(samples::points(&operands, &theirs, points / 2, &mut random));
        let [ours, theirs] = [&ours, &theirs].map(|mesh| {
            let verdict = oracle::judge_by(&expected, &operands, mesh, &places);
            describe(mesh, &operands, &verdict)
        });
        writeln!(out, "{{\"ours\":{ours},\"theirs\":{theirs},\"at_origin\":{at_origin}}}")?;
        out.flush()?;
    }
    Ok(())
}

/// Whether a result at coordinates of 1e12 is what it is at the origin.
fn is_as_at_origin(seed: u64, models: &[Mesh], result: &Mesh) -> bool {
    if !(HARD_FROM..MANY_FROM).contains(&seed) {
        return false;
    }
    let case = Case::new(seed, models);
    let is_same = || origin::compared_at_origin(&case, result).is_ok();
    case.family == Family::Far12 && catch_unwind(AssertUnwindSafe(is_same)).unwrap_or(false)
}

/// How often a result should wind round a point that the operands wind round so often.
type Expected = Box<dyn Fn(&[i32]) -> i32>;

/// The operands of a case, trisect's result, and what is expected of it.
fn prepare(seed: u64, models: &[Mesh]) -> (Vec<Mesh>, Mesh, Expected) {
    if seed >= MANY_FROM {
        let case = Many::new(seed);
        let ours = many::attempt(&case).unwrap_or_default();
        return (case.merged(), ours, Box::new(move |windings| case.expected(windings)));
    }
    let case = Case::new(seed, models);
    let ours = run::attempt(&case).unwrap_or_default();
    let operation = case.operation;
    (vec![case.a, case.b], ours, Box::new(move |windings| oracle::expected(operation, windings)))
}

fn describe(mesh: &Mesh, operands: &[&Mesh], verdict: &oracle::Verdict) -> String {
    let found = Properties::of(mesh);
    let by_reach = run::parted_by_reach(mesh, run::smallest_part(operands, mesh));
    let text = |parted: Option<&Parted>| {
        let list = |parted: &Parted| format!("[{},{}]", parted.topology.components, parted.topology.euler);
        parted.map_or("null".to_string(), list)
    };
    // At the distance at which it is as the mesh is connected, if there is one: details may be smaller than others.
    let own = Topology { components: found.components, euler: found.euler };
    let agreeing = by_reach.iter().find(|parted| parted.topology == own).or(by_reach.first());
    let (parted, coarse) = (text(agreeing), text(by_reach.first()));
    let pinched = by_reach.iter().any(|parted| parted.pinched);
    // With the smallest of the distances: what is flat then is as thin as rounding.
    let mispaired = by_reach.last().map_or(&[][..], |parted| &parted.mispaired);
    // Where an operand touches itself, it stays connected as it is.
    let is_own = |edge: &&_| operands.iter().any(|operand| touches_itself_along(operand, edge));
    let own = mispaired.iter().filter(is_own).count();
    let mispaired = mispaired.len() - own;
    let bodies: Vec<String> = bodies(mesh).iter().map(|body| format!("{:e}", volume(body))).collect();
    format!(
        "{{\"judged\":{},\"mistakes\":{},\"farthest\":{:e},\"closed\":{},\"manifold\":{},\"zero_area\":{},\"volume\":{:e},\
         \"area\":{:e},\"components\":{},\"euler\":{},\"parted\":{parted},\"coarse\":{coarse},\"pinched\":{pinched},\"mispaired\":{mispaired},\"own\":{own},\"walls\":{},\"bodies\":[{}]}}",
        verdict.judged,
        verdict.mistakes.len(),
        verdict.farthest(),
        found.closed,
        found.manifold,
        found.zero_area,
        found.volume,
        found.area,
        found.components,
        found.euler,
        run::walls(mesh),
        bodies.join(",")
    )
}

/// The shells of a mesh.
fn bodies(mesh: &Mesh) -> Vec<Mesh> {
    let mut sets = crate::judge::surface::Sets::new(mesh.positions.len());
    for &[a, b, c] in &mesh.triangles {
        sets.join(a as usize, b as usize);
        sets.join(b as usize, c as usize);
    }
    let mut of: std::collections::BTreeMap<usize, Vec<[u32; 3]>> = std::collections::BTreeMap::new();
    for triangle in &mesh.triangles {
        of.entry(sets.find(triangle[0] as usize)).or_default().push(*triangle);
    }
    of.into_values().map(|triangles| Mesh::new(mesh.positions.clone(), triangles)).collect()
}
