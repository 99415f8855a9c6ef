//! What may stand on the command line of `hull`, `text`, `minkowski`, `offset`, `hollow`, `measure`, `distance`, `completions` and
//! `man`.

use std::path::PathBuf;

use clap::Args;
use clap_complete::Shell;
use trisect::making::Drain;

use super::argument_groups::{Files, Inputs, Placing, Results, Smoothness};
use super::values;

/// Convex hulls.
#[derive(Debug, Args)]
pub(crate) struct Hull {
    #[command(flatten)]
    pub(crate) from: Files,
    #[command(flatten)]
    pub(crate) results: Results,
}

/// Text as a solid.
#[derive(Debug, Args)]
pub(crate) struct Text {
    /// The text; \n begins a new line
    #[arg(value_name = "TEXT", required = true, num_args = 1)]
    pub(crate) files: Vec<PathBuf>,
    #[command(flatten)]
    pub(crate) placing: Placing,
    #[command(flatten)]
    pub(crate) results: Results,
}

/// Minkowski sums.
#[derive(Debug, Args)]
pub(crate) struct Minkowski {
    #[command(flatten)]
    pub(crate) inputs: Inputs,
    #[command(flatten)]
    pub(crate) results: Results,
}

/// Offsets.
#[derive(Debug, Args)]
pub(crate) struct Offset {
    #[command(flatten)]
    pub(crate) inputs: Inputs,
    /// How far the surface moves outwards; inwards if it is negative
    #[arg(long, value_name = "LENGTH", value_parser = values::number, allow_hyphen_values = true, required = true)]
    pub(crate) distance: f64,
    /// Largest distance from the true offset [default: a twentieth of the distance, but no less than 1/2000 of the diagonal]
    #[arg(long, value_name = "LENGTH", value_parser = values::length, allow_hyphen_values = true)]
    pub(crate) tolerance: Option<f64>,
    #[command(flatten)]
    pub(crate) smoothness: Smoothness,
    #[command(flatten)]
    pub(crate) results: Results,
}

/// Shells.
#[derive(Debug, Args)]
pub(crate) struct Hollow {
    #[command(flatten)]
    pub(crate) inputs: Inputs,
    /// The thickness of the wall
    #[arg(long, alias = "thickness", value_name = "LENGTH", value_parser = values::length, allow_hyphen_values = true, required = true)]
    pub(crate) wall: f64,
    /// A hole through the wall, square to the surface at the place nearest to a point; may be repeated
    #[arg(long, value_name = "X,Y,Z:RADIUS", value_parser = drain, allow_hyphen_values = true)]
    pub(crate) drain: Vec<Drain>,
    /// Largest distance of the cavity from the true one [default: a twentieth of the wall, but no less than 1/2000 of the diagonal]
    #[arg(long, value_name = "LENGTH", value_parser = values::length, allow_hyphen_values = true)]
    pub(crate) tolerance: Option<f64>,
    #[command(flatten)]
    pub(crate) smoothness: Smoothness,
    #[command(flatten)]
    pub(crate) results: Results,
}

/// `X,Y,Z:RADIUS`.
fn drain(text: &str) -> Result<Drain, String> {
    let (at, radius) = text.rsplit_once(':').ok_or("expected a point and a radius, such as 0,0,0:1.5")?;
    Ok(Drain { at: values::vector(at)?, radius: values::length(radius)? })
}

/// Measuring solids.
#[derive(Debug, Args)]
pub(crate) struct Measure {
    #[command(flatten)]
    pub(crate) inputs: Inputs,
    /// A point to be measured at: inside or outside, how far from the surface, how thick the wall there; may be repeated
    #[arg(long, value_name = "X,Y,Z", value_parser = values::vector, allow_hyphen_values = true, help_heading = "Points")]
    pub(crate) at: Vec<[f64; 3]>,
    /// The same at every point of a file, three numbers a line; `-` is standard input
    #[arg(long, value_name = "FILE", help_heading = "Points")]
    pub(crate) points: Option<PathBuf>,
}

/// The distance between solids.
#[derive(Debug, Args)]
pub(crate) struct Distance {
    #[command(flatten)]
    pub(crate) inputs: Inputs,
}

/// Completions.
#[derive(Debug, Args)]
pub(crate) struct Completions {
    /// The shell
    #[arg(value_name = "SHELL", value_enum)]
    pub(crate) shell: Shell,
}

/// Manual pages.
#[derive(Debug, Args)]
pub(crate) struct Man {
    /// The verb, such as union; without it, the page of the program
    #[arg(value_name = "VERB")]
    pub(crate) verb: Vec<String>,
    /// Write all pages into this folder, trisect.1 and one for each verb
    #[arg(long, value_name = "FOLDER", conflicts_with = "verb")]
    pub(crate) folder: Option<PathBuf>,
}
