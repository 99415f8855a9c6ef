//! `subdivide`: a cage refined, or its limit surface as a mesh.

use std::borrow::Cow;
use std::path::{Path, PathBuf};
use std::time::Instant;

use clap::ArgMatches;
use serde_json::{Value, json};
use trisect::subdivision::{Cage, Rules};
use trisect::{Error, Mesh};

use super::argument_groups::{Drawing, Writing};
use super::cage_arguments::Subdivide;
use super::cages;
use super::documents;
use super::fault::{Exit, Fault};
use super::output::{self, Product, Shown, Target};
use super::recenter;
use super::report::Measures;
use super::scenes;
use super::session::Session;
use super::surface::Normals;
use super::words;

/// What subdivision gave.
enum Made {
    Cage(Box<Cage>),
    Mesh(Mesh),
}

/// Subdivides one cage.
pub(crate) fn run(
    arguments: &Subdivide,
    matches: &ArgMatches,
    session: &mut Session<'_>,
) -> Result<Exit, Fault> {
    let outputs = &arguments.results.writing.output;
    let drawing = &arguments.results.drawing;
    let keeps_cage = arguments.tolerance.is_none() && !arguments.limit;
    // 1. Where to: files that hold cages, and meshes.
    let (cage_paths, mesh_paths) =
        if keeps_cage { cages::sorted(outputs)? } else { (Vec::new(), outputs.clone()) };
    let writing = Writing { output: mesh_paths, ..arguments.results.writing.clone() };
    scenes::refuse(&writing)?;
    let targets = output::targets(&writing, drawing, session.common)?;
    documents::check(cage_paths.iter().map(|path| -> &Path { path }), session.common, &session.limits)?;
    if targets.is_empty() && cage_paths.is_empty() && !session.is_reported() {
        return Err(Fault::usage(
            "nowhere to put the result: add -o FILE, --png FILE, --json or --report FILE",
        ));
    }
    output::probe(&targets, &session.limits)?;
    // 2. The cage, subdivided.
    let start = Instant::now();
    let mut read = cages::read(matches, arguments.cages, session)?;
    let Some(input) = read.pop() else { return Err(Fault::usage("a cage is needed")) };
    session.took("read", start);
    let start = Instant::now();
    let made = make(arguments, &input.cage).map_err(|error| error.of_operand(0, input.name.clone()))?;
    let seconds = session.took("run", start);
    // 3. The outputs.
    let mesh = match &made {
        Made::Cage(cage) => cage.mesh()?,
        Made::Mesh(mesh) => mesh.clone(),
    };
    let written = write((&made, &input.cage), &mesh, &cage_paths, &targets, &writing, (drawing, session))?;
    let measures = Measures::of_mesh(&mesh);
    session.note("result", measures.to_json());
    session.note("outputs", written);
    session.note(
        "cage",
        json!({ "vertices": input.cage.positions().len(), "faces": input.cage.face_count(),
                "creases": input.cage.tags().creases.len(), "scheme": input.cage.scheme().name(), "rules": rules(&input.cage) }),
    );
    session.console.say(&format!(
        "{}: {} -> {} ({})",
        input.name,
        words::counted(input.cage.face_count(), "face"),
        words::counted(mesh.triangles.len(), "triangle"),
        words::time(seconds)
    ));
    Ok(Exit::Fine)
}

/// Writes cages, meshes and pictures; what the report says of them.
fn write(
    (made, input): (&Made, &Cage),
    mesh: &Mesh,
    cage_paths: &[PathBuf],
    targets: &[Target],
    writing: &Writing,
    (drawing, session): (&Drawing, &mut Session<'_>),
) -> Result<Vec<Value>, Fault> {
    let start = Instant::now();
    if !cage_paths.is_empty() && (writing.recenter || writing.normals != Normals::Keep) {
        session.warn("cages are written as they are: --recenter and --normals are for meshes");
    }
    let mesh =
        if targets.is_empty() { Cow::Borrowed(mesh) } else { recenter::placed(mesh, writing, session) };
    let mesh = mesh.as_ref();
    let cage = match made {
        Made::Cage(cage) => Some(&**cage),
        Made::Mesh(_) => None,
    };
    let documents = cage
        .iter()
        .flat_map(|cage| cage_paths.iter().map(|path| cages::document(path, cage)))
        .collect::<Result<Vec<_>, Fault>>()?;
    let picture = || match cage.map(|cage| cages::picture(cage, drawing)) {
        Some(Ok(picture)) => picture,
        _ => trisect::render::mesh(mesh, &output::view(drawing, None), None),
    };
    let mut options = output::write_options(writing, &session.limits);
    if !writing.recenter {
        options = cage.unwrap_or(input).beside(options);
    }
    let shown = Shown::new(drawing, None, None);
    let product = Product { mesh, options, picture: &picture, documents: &documents, shown };
    let (written, warnings) = output::write_all(targets, &product, &session.limits)?;
    for warning in warnings {
        session.warn(warning);
    }
    session.took("write", start);
    Ok(written)
}

/// The name of the rules a cage has.
fn rules(cage: &Cage) -> &'static str {
    match cage {
        Cage::Loop(cage) => cage.rules().name(),
        _ => Rules::OpenSubdiv.name(),
    }
}

fn make(arguments: &Subdivide, cage: &Cage) -> Result<Made, Error> {
    let levels = arguments.levels.unwrap_or(1) as usize;
    Ok(match arguments.tolerance {
        Some(tolerance) => Made::Mesh(cage.limit_mesh(tolerance)?),
        None if arguments.limit => Made::Mesh(cage.limit_mesh_of_steps(levels)?),
        None => Made::Cage(Box::new(cage.subdivided(levels)?)),
    })
}
