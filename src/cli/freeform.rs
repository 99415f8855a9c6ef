//! `freeform`: booleans of cages that give cages.

use std::time::Instant;

use clap::ArgMatches;
use trisect::subdivision::{Cage, ControlMesh, FreeForm, FreeFormOutcome, FreeFormReport, Scheme};
use trisect::{Error, Operation};

use super::argument_groups::{Drawing, Writing};
use super::cage_arguments::FreeFormVerb;
use super::cages::{self, Read};
use super::fault::{Exit, Fault};
use super::json::json_of;
use super::output::{self, Product, Shown};
use super::session::Session;
use super::words;

/// Combines cages.
pub(crate) fn run(
    arguments: &FreeFormVerb,
    matches: &ArgMatches,
    session: &mut Session<'_>,
) -> Result<Exit, Fault> {
    // 1. Where to: files that hold cages, meshes and pictures of the limit surface, the exact result.
    let (cage_paths, mesh_paths) = cages::sorted(&arguments.output)?;
    let writing = |output| Writing { output, ..Writing::default() };
    let targets = output::targets(&writing(mesh_paths), &arguments.drawing, session.common)?;
    let no_picture = Drawing { png: None, ..arguments.drawing };
    let exact_targets =
        output::targets(&writing(arguments.exact.iter().cloned().collect()), &no_picture, session.common)?;
    super::documents::check(
        cage_paths.iter().map(std::path::PathBuf::as_path),
        session.common,
        &session.limits,
    )?;
    if targets.len() + exact_targets.len() + cage_paths.len() == 0
        && !session.common.json
        && session.common.report.is_none()
    {
        return Err(Fault::usage(
            "nowhere to put the result: add -o FILE.obj, --png FILE, --json or --report FILE",
        ));
    }
    output::probe(&targets, &session.limits)?;
    output::probe(&exact_targets, &session.limits)?;
    // 2. The cages, combined all at once.
    let start = Instant::now();
    let read = cages::read(matches, arguments.cages, session)?;
    session.took("read", start);
    let start = Instant::now();
    let read = of_triangles(read, arguments.tolerance, session)?;
    let outcome = combine(arguments, &read, session)?;
    let seconds = session.took("run", start);
    // 3. The outputs.
    let start = Instant::now();
    let flat = arguments.flatten.then(|| outcome.surface().subdivided(0)).transpose()?;
    let cage = Cage::from(flat.unwrap_or_else(|| outcome.surface().clone()));
    write(arguments, &cage, &cage_paths, &targets, session)?;
    if !exact_targets.is_empty() {
        let mesh = outcome.exact().solid().mesh();
        let options = output::write_options(&writing(Vec::new()), &session.limits);
        let picture = || trisect::render::mesh(mesh, &output::view(&arguments.drawing, None), None);
        let shown = Shown::new(&arguments.drawing, None, None);
        let product = Product { mesh, options, picture: &picture, documents: &[], shown };
        output::write_all(&exact_targets, &product, &session.limits)?;
    }
    session.took("write", start);
    say(outcome.report(), seconds, session);
    Ok(Exit::Fine)
}

/// All cages as cages of triangles; what had to be fitted is told.
fn of_triangles(
    read: Vec<Read>,
    tolerance: Option<f64>,
    session: &mut Session<'_>,
) -> Result<Vec<(String, ControlMesh)>, Fault> {
    let mut cages = Vec::with_capacity(read.len());
    for (index, Read { cage, name }) in read.into_iter().enumerate() {
        // Half of the tolerance; the other half is for the boolean.
        let allowed = 0.5 * tolerance.unwrap_or_else(|| 1e-3 * cages::diagonal(&cage));
        let found = cage.to_loop(allowed).map_err(|error| error.of_operand(index, name.clone()))?;
        if cage.scheme() == Scheme::CatmullClark {
            session.warn(format!(
                "{name}: its polygons became {}, fitted to the Catmull-Clark surface: within {} of it; the result is a cage of \
                 triangles",
                words::counted(found.0.faces().len(), "triangle"),
                words::short(found.1)
            ));
        }
        cages.push((name, found.0));
    }
    Ok(cages)
}

fn combine(
    arguments: &FreeFormVerb,
    read: &[(String, ControlMesh)],
    session: &mut Session<'_>,
) -> Result<FreeFormOutcome, Fault> {
    let mut settings = FreeForm::new()
        .refine(arguments.refine)
        .attempts(arguments.attempts.unwrap_or(if arguments.details > 0 { 0 } else { 2 }))
        .details(arguments.details as usize)
        .rings(arguments.rings as usize)
        .allow_tangent(arguments.allow_tangent)
        .control(session.control());
    if let Some(tolerance) = arguments.tolerance {
        settings = settings.tolerance(tolerance);
    }
    let operation = arguments.operation.operation();
    if read.len() < 2 && operation != Operation::Union {
        return Err(Fault::usage(format!(
            "{} needs two cages at least; one alone can be united with itself: freeform union",
            operation.name()
        )));
    }
    let surfaces: Vec<&ControlMesh> = read.iter().map(|(_, cage)| cage).collect();
    let outcome = settings.run_all(operation, &surfaces).map_err(name_option)?;
    for warning in &outcome.report().warnings {
        session.warn(warning.clone());
    }
    Ok(outcome)
}

/// The error of surfaces that nearly touch, with the option that takes them.
fn name_option(error: Error) -> Fault {
    let text = error.to_string();
    if text.contains("allow tangential curves") {
        return Fault::unusable(format!("{text} (--allow-tangent)"));
    }
    error.into()
}

fn write(
    arguments: &FreeFormVerb,
    cage: &Cage,
    cage_paths: &[std::path::PathBuf],
    targets: &[output::Target],
    session: &mut Session<'_>,
) -> Result<(), Fault> {
    let documents: Vec<_> =
        cage_paths.iter().map(|path| cages::document(path, cage)).collect::<Result<_, Fault>>()?;
    let mesh = if targets.is_empty() {
        trisect::Mesh::default()
    } else {
        let tolerance = arguments.tolerance.unwrap_or_else(|| 1e-3 * cages::diagonal(cage));
        if cage.face_count() == 0 { cage.mesh()? } else { cage.limit_mesh(tolerance)? }
    };
    let picture = || {
        cages::picture(cage, &arguments.drawing)
            .unwrap_or_else(|_| trisect::render::mesh(&mesh, &output::view(&arguments.drawing, None), None))
    };
    let empty = Writing::default();
    let options = cage.beside(output::write_options(&empty, &session.limits));
    let shown = Shown::new(&arguments.drawing, None, None);
    let product = Product { mesh: &mesh, options, picture: &picture, documents: &documents, shown };
    let (written, warnings) = output::write_all(targets, &product, &session.limits)?;
    session.note("outputs", written);
    for warning in warnings {
        session.warn(warning);
    }
    Ok(())
}

fn say(found: &FreeFormReport, seconds: f64, session: &mut Session<'_>) {
    session.console.say(&format!(
        "cage: {}, {} ({} added, {} moved, {} as they were), within {} of the exact result ({})",
        words::counted(found.vertices, "control point"),
        words::counted(found.faces, "face"),
        found.added,
        found.fitted,
        found.unchanged,
        words::short(found.errors.largest()),
        words::time(seconds)
    ));
    session.note("result", json_of(found));
}
