//! `solidify`: a solid of any soup of triangles.

use std::time::Instant;

use clap::ArgMatches;
use trisect::{Embed, Grid, Solidified, Solidify};

use super::argument_groups::Colours;
use super::cut_arguments::Solidify as Arguments;
use super::fault::{Exit, Fault};
use super::json::json_of;
use super::made::{self, Begun};
use super::output::Target;
use super::reading::{self, Input};
use super::report::Measures;
use super::scenes;
use super::session::Session;
use super::words;
use super::written::Written;

/// Makes a solid of an input.
pub(crate) fn run(
    arguments: &Arguments,
    matches: &ArgMatches,
    session: &mut Session<'_>,
) -> Result<Exit, Fault> {
    let otherwise = "solidify takes one input; union puts several together afterwards";
    let Begun { requests: [request], targets, options: write_options, control } =
        made::begin(matches, &arguments.from, &arguments.results, otherwise, session)?;
    let writing = &arguments.results.writing;

    let start = Instant::now();
    let Input { mesh, format, mut warnings, contents, reserved: _reserved } =
        reading::read(&request, &session.limits, &control)
            .map_err(|error| error.of_operand(0, request.name()))?;
    session.took("read", start);
    warnings.extend(scenes::lost(&contents, writing, 0));
    warnings.into_iter().for_each(|warning| session.warn(format!("{}: {warning}", request.name())));
    session.console.say(&format!("{}: {}", request.name(), Measures::of_mesh(&mesh).line()));

    let start = Instant::now();
    let single = writing.single || targets.iter().any(Target::is_single);
    let embed = Embed::OnGrid(if single { Grid::Single } else { Grid::Double });
    let options = session.boolean_options(control).embed(embed);
    let how = Solidify::new().options(options).weld(request.repairs.weld);
    let made = mesh.solidify(&how).map_err(|error| error.of_operand(0, request.name()))?;
    let seconds = session.took("run", start);
    tell(&made, &targets, seconds, session);

    let written = Written {
        usual: Colours::Operand,
        operand: &|triangle| made.origins[triangle].operand as usize,
        ..Written::new(made.solid.mesh(), write_options, Some(format))
    };
    made::write(written, &arguments.results, &targets, session)?;
    Ok(Exit::Fine)
}

/// Says what was done, and what the result is.
fn tell(made: &Solidified, targets: &[Target], seconds: f64, session: &mut Session<'_>) {
    let report = &made.report;
    let readied = &report.readied;
    // 1. To the triangles.
    let mut done: Vec<String> = Vec::new();
    let mut count = |count: usize, one: &str, several: &str| {
        if count > 0 {
            done.push(format!("{count} {}", if count == 1 { one } else { several }));
        }
    };
    count(readied.joined, "vertex joined", "vertices joined");
    count(readied.copies, "copy of a triangle left out", "copies of triangles left out");
    count(readied.without_area, "triangle without area left out", "triangles without area left out");
    count(readied.split_edges, "edge split", "edges split");
    count(readied.turned, "triangle turned", "triangles turned");
    if readied.distance > 0.0 {
        done.push(format!("joined within {}", words::short(readied.distance)));
    }
    if !done.is_empty() {
        session.console.say(&format!("  {}", done.join(", ")));
    }
    // 2. To what they enclose.
    session.console.say(&format!(
        "  {}, {} inside; added an area of {} across {}, dropped one of {}",
        words::counted(report.cells, "cell"),
        report.cells_inside,
        words::short(report.added_area),
        words::counted(readied.holes, "hole"),
        words::short(report.dropped_area),
    ));
    if report.doubtful_volume > 0.0 || report.dropped_volume > 0.0 {
        session.warn(format!(
            "not much more than half of what surrounds it is there: a volume of {} was taken for inside, and one of {} for outside",
            words::short(report.doubtful_volume),
            words::short(report.dropped_volume),
        ));
    }
    if made.solid.is_empty() {
        session.warn("the triangles enclose nothing: the result is empty".to_owned());
    }
    if report.still_crossing > 0 {
        let triangles = words::counted(report.still_crossing, "triangle");
        session.warn(format!("{triangles} still cross others or lie on them after rounding"));
    }
    let measures = Measures::of_solid(&made.solid);
    let mut result = measures.to_json();
    result.insert("solidify".into(), json_of(report));
    session.note("result", result);
    made::say(&measures, targets, seconds, session);
}
