//! `check`: can files be operands, and if not, why and where.

use clap::ArgMatches;
#[cfg(feature = "parallel")]
use rayon::prelude::*;
use serde_json::{Value, json};
use trisect::mesh::Diagnosis;
use trisect::{Error, MeshError};

use super::arguments::Check;
use super::fault::{self, Exit, Fault};
use super::json::json_of;
use super::mended;
use super::reading::{self, Input};
use super::remedy::Remedy;
use super::report::{self, Measures, into_map};
use super::requests::{self, Request};
use super::selection;
use super::session::Session;
use super::stream;
use super::usable::{self, Crossings, Unusable, Usable};
use trisect::mesh::diagnose;

/// What `check` found out about one file.
struct Verdict {
    exit: Exit,
    text: String,
    object: Value,
    warnings: Vec<String>,
}

/// Checks every input; the worst answer decides the exit code, an unreadable file before an unusable one.
pub(crate) fn run(arguments: &Check, matches: &ArgMatches, session: &mut Session<'_>) -> Result<Exit, Fault> {
    let requests = requests::requests(matches, arguments.inputs.from.reading.format)?;
    let requests = selection::each(requests, &session.limits, &session.control())?;
    let (mut unreadable, mut unusable) = (false, false);
    let mut objects = Vec::new();
    for batch in requests.chunks(at_once()) {
        for (request, verdict) in batch.iter().zip(verdicts(batch, arguments, session)) {
            let verdict = verdict?;
            unreadable |= verdict.exit == Exit::Unreadable;
            unusable |= verdict.exit != Exit::Fine;
            if !session.common.json && (!session.common.quiet || verdict.exit != Exit::Fine) {
                session.console.pause(|| stream::print(&verdict.text))?;
            }
            for warning in verdict.warnings {
                session.warn(format!("{}: {warning}", request.name()));
            }
            objects.push(verdict.object);
        }
    }
    session.note("files", objects);
    session.note("usable", !unusable);
    Ok(match (unreadable, unusable) {
        (true, _) => Exit::Unreadable,
        (false, true) => Exit::Unusable,
        (false, false) => Exit::Fine,
    })
}

/// How many inputs are checked side by side: no more are in memory at once.
fn at_once() -> usize {
    #[cfg(feature = "parallel")]
    return rayon::current_num_threads();
    #[cfg(not(feature = "parallel"))]
    1
}

/// Checks some inputs side by side; the answers come in their order.
fn verdicts(requests: &[Request], arguments: &Check, session: &Session<'_>) -> Vec<Result<Verdict, Fault>> {
    let one = |request: &Request| {
        session.console.stage(&format!("checking {}", request.name()), 0.0);
        check(request, arguments, session)
    };
    #[cfg(feature = "parallel")]
    return requests.par_iter().map(one).collect();
    #[cfg(not(feature = "parallel"))]
    requests.iter().map(one).collect()
}

/// Checks one input. Only limits end the run; every other fault is the answer.
fn check(request: &Request, arguments: &Check, session: &Session<'_>) -> Result<Verdict, Fault> {
    let control = session.control();
    let name = request.name();
    let input = match reading::read(request, &session.limits, &control) {
        Ok(input) => input,
        Err(error) => return refused(&name, error, None, None),
    };
    let Input { mesh, format, mut warnings, reserved: _reserved, .. } = input;
    let mut diagnosis = diagnose(&mesh);
    let mut object = Measures::of_mesh(&mesh).to_json();
    object.insert("format".into(), format.extension().into());
    object.insert("warnings".into(), json!(warnings));
    object.insert("diagnosis".into(), json_of(&diagnosis));
    let usable = usable::usable(mesh, request.repairs, arguments.inputs.using.assume_clean, &control);
    let Usable { solid, crossings } = match usable {
        Ok(usable) => usable,
        Err(unusable) => {
            let Unusable { error, remedy } = *unusable;
            let mut verdict = refused(&name, error, remedy, Some(&diagnosis))?;
            object.extend(into_map(verdict.object));
            verdict.object = object.into();
            return Ok(Verdict { warnings, ..verdict });
        }
    };
    warnings.extend(mended::left_out(solid.mending()));
    warnings.extend(usable::nothing_left(&solid));
    object.insert("warnings".into(), json!(warnings));
    let mending = solid.mending();
    let measures = Measures::of_solid(&solid);
    let (cleaning, cleaned) = report::cleaning(&solid);
    object.extend(measures.to_json());
    object.extend(into_map(json!({
        "file": name,
        "usable": true,
        "turned": mending.turned > 0,
        "welded": mended::welded_vertices(mending),
        "cleaning": cleaned,
        "mending": json_of(mending),
        "self_crossings": crossings.as_ref().map(|crossings| &crossings.object),
    })));
    let mut text = format!("{name}: usable: {}{}\n", measures.line(), mended::in_line(mending));
    text.push_str(&indented(&mended::listed(mending).join("\n")));
    if let Some(crossings) = &crossings {
        text.push_str(&indented(&crossing_lines(crossings)));
        if crossings.count > 0 {
            diagnosis.self_crossings = Some((&crossings.found).into());
            object.insert("diagnosis".into(), json_of(&diagnosis));
        }
    }
    text.push_str(&cleaning.map(|cleaning| format!("  {cleaning}\n")).unwrap_or_default());
    if mending.is_none() {
        text.push_str(&indented(&diagnosis.listed(PLACES).join("\n")));
    }
    Ok(Verdict { exit: Exit::Fine, text, object: object.into(), warnings })
}

/// What is said of an operand's crossings with itself.
fn crossing_lines(crossings: &Crossings) -> String {
    let mut text = String::new();
    if crossings.count > 0 {
        text.push_str(
            "it crosses itself: as an operand it is what its surface winds around (--rule), and `trisect resolve` makes a \
             clean file of it\n",
        );
    }
    if crossings.touching > 0 {
        let count = crossings.touching;
        text.push_str(&format!(
            "{count} pairs of triangles lie on each other in one plane: as an operand, what touches is one body\n"
        ));
    }
    if crossings.tolerated > 0 {
        let count = crossings.tolerated;
        text.push_str(&format!("{count} self-crossings no deeper than rounding, which are tolerated\n"));
    }
    text
}

/// Places listed of each kind of fault: all that are kept.
const PLACES: usize = usize::MAX;

/// The verdict for a file that cannot be used.
fn refused(
    name: &str,
    error: Error,
    remedy: Option<Remedy>,
    diagnosis: Option<&Diagnosis>,
) -> Result<Verdict, Fault> {
    let exit = fault::exit_of(&error);
    if matches!(exit, Exit::Limit | Exit::Internal) {
        return Err(error.into());
    }
    let answer = if exit == Exit::Unreadable { "unreadable" } else { "not usable" };
    // The places are listed below, so the first line does without them.
    let (reason, diagnosis) = match &error {
        Error::Mesh(MeshError::NotClosed(found)) => {
            ("the mesh is not a closed surface".into(), Some(&**found))
        }
        Error::Mesh(MeshError::InsideOutShells(found)) => {
            let shells = match found.count {
                1 => "one of its shells faces".to_owned(),
                count => format!("{count} of its shells face"),
            };
            let reason = "the wrong way (outwards inside another, or inwards by themselves); turn them, or unite bodies \
                          that lie inside others one by one";
            (format!("{shells} {reason}"), diagnosis)
        }
        other => (fault::text_of(other), diagnosis),
    };
    let mut text = format!("{name}: {answer}: {reason}\n");
    if let Some(way_out) = fault::way_out(&error, remedy.as_ref()) {
        text.push_str(&indented(&way_out));
    }
    text.push_str(&diagnosis.map(|found| indented(&found.listed(PLACES).join("\n"))).unwrap_or_default());
    let error = Fault::of_unusable(error, remedy).to_json();
    let object = json!({ "file": name, "usable": false, "error": error });
    Ok(Verdict { exit, text, object, warnings: Vec::new() })
}

fn indented(text: &str) -> String {
    text.lines()
        .filter(|line| !line.trim().is_empty())
        .map(|line| format!("  {}\n", line.trim_end()))
        .collect()
}
