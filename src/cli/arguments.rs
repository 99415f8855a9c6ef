//! What may stand on the command line.

use std::path::PathBuf;
use std::time::Duration;

use clap::{Args, Parser, Subcommand, ValueEnum};
use trisect::Operation;
use trisect::io::Format;

#[cfg(feature = "parametric")]
use super::field_arguments::CurveVerb;
use super::field_arguments::{Eval, SampleGrid, Slice};
use super::values;

const EXIT_CODES: &str = "\
Exit codes:
  0   done (an empty result is a result)
  1   the command line makes no sense
  2   an input cannot be read, or an output cannot be written
  3   an input was read but cannot be used as asked
  4   a limit was hit, or the run was cancelled
  5   done, with warnings, under --strict
  70  a fault of the program itself";

/// Exact booleans of closed triangle meshes
#[derive(Debug, Parser)]
#[command(
    name = "trisect",
    version,
    after_help = EXIT_CODES,
    arg_required_else_help = true,
    disable_help_subcommand = true,
    max_term_width = 100
)]
pub(crate) struct Arguments {
    #[command(flatten)]
    pub(crate) common: Common,
    #[command(subcommand)]
    pub(crate) verb: Verb,
}

/// Options that every verb takes.
#[derive(Clone, Debug, Args)]
pub(crate) struct Common {
    /// Print one JSON object, on one line, on standard output
    #[arg(long, global = true, help_heading = "Reports")]
    pub(crate) json: bool,
    /// Write that JSON object to a file, also when the run fails (but not for a usage error)
    #[arg(long, global = true, value_name = "FILE", help_heading = "Reports")]
    pub(crate) report: Option<PathBuf>,
    /// Print only warnings and errors
    #[arg(short, long, global = true, conflicts_with = "verbose", help_heading = "Reports")]
    pub(crate) quiet: bool,
    /// Print more; twice: every stage
    #[arg(short, long, global = true, action = clap::ArgAction::Count, help_heading = "Reports")]
    pub(crate) verbose: u8,
    /// Exit with code 5 if there were warnings (outputs are still written)
    #[arg(long, global = true, help_heading = "Reports")]
    pub(crate) strict: bool,
    /// Use this many threads, or as many as the machine can use [default: all processors]
    #[arg(
        long, global = true, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024),
        allow_negative_numbers = true, help_heading = "Limits"
    )]
    pub(crate) threads: Option<u16>,
    /// Give up after this time
    #[arg(
        long, global = true, value_name = "SECONDS", value_parser = values::seconds,
        help_heading = "Limits", allow_hyphen_values = true
    )]
    pub(crate) timeout: Option<Duration>,
    /// Give up before the tables of the operation exceed this size, such as 512M or 4G
    #[arg(
        long, global = true, value_name = "SIZE", value_parser = values::bytes,
        help_heading = "Limits", allow_hyphen_values = true
    )]
    pub(crate) memory: Option<u64>,
}

/// What to do.
#[derive(Debug, Subcommand)]
pub(crate) enum Verb {
    /// What is in any of the inputs
    #[command(after_help = "Example:\n  trisect union a.obj b.glb --translate 10,0,0 -o out.stl")]
    Union(Combine),
    /// What is in the first input and in none of the others
    #[command(after_help = "Example:\n  trisect difference body.stl tool1.obj tool2.obj -o part.obj")]
    Difference(Combine),
    /// What is in all of the inputs
    #[command(
        visible_alias = "intersect",
        after_help = "Example:\n  trisect intersection a.obj b.obj -o common.ply"
    )]
    Intersection(Combine),
    /// What is in an odd number of the inputs (of two: in exactly one)
    #[command(after_help = "Example:\n  trisect xor old.stl new.stl -o changes.glb")]
    Xor(Combine),
    /// Say whether files can be used as operands, and if not, why and where
    #[command(
        after_help = "Exit code 0: all usable; 3: at least one is not; 2: at least one cannot be read."
    )]
    Check(Check),
    /// Print counts, bounds, area, volume and groups of files
    Info(Info),
    /// Read a file and write it in another format
    #[command(
        after_help = "Examples:\n  trisect convert a.stl a.glb\n  trisect convert a.obj --scale 0.001 \
                            -o a.glb -o a.ply\n  trisect convert a.glb --png a.png"
    )]
    Convert(Convert),
    /// Evaluate a model file to a closed mesh
    #[command(
        after_help = "Examples:\n  trisect eval model.json -o out.glb --png out.png\n  trisect eval plate.json \
                            --contours plate.svg"
    )]
    Eval(Eval),
    /// Draw a plane section of a model, of a mesh's signed distance, or of a formula
    #[command(
        after_help = "Examples:\n  trisect slice model.json -o z0.png\n  trisect slice part.stl --axis y --at 2.5 -o \
                            y.png\n  trisect slice --formula '1 - x^2 - y^2' --bounds=-2,-2,-1,2,2,1 -o disc.png"
    )]
    Slice(Slice),
    /// Sample a model, a mesh's signed distance, or a formula on a grid
    #[command(after_help = "Example:\n  trisect grid part.stl --spacing 0.5 --band 2 -o part.npy")]
    Grid(SampleGrid),
    /// Join, mesh, convert and draw curves
    #[cfg(feature = "parametric")]
    #[command(subcommand)]
    Curve(CurveVerb),
}

impl Verb {
    /// The verb's name, as on the command line.
    pub(crate) fn name(&self) -> &'static str {
        match self {
            Self::Union(_) => Operation::Union.name(),
            Self::Difference(_) => Operation::Difference.name(),
            Self::Intersection(_) => Operation::Intersection.name(),
            Self::Xor(_) => Operation::SymmetricDifference.name(),
            Self::Check(_) => "check",
            Self::Info(_) => "info",
            Self::Convert(_) => "convert",
            Self::Eval(_) => "eval",
            Self::Slice(_) => "slice",
            Self::Grid(_) => "grid",
            #[cfg(feature = "parametric")]
            Self::Curve(verb) => verb.name(),
        }
    }
}

/// A boolean of several inputs.
#[derive(Debug, Args)]
pub(crate) struct Combine {
    /// Input files; `-` is standard input (with --format)
    #[arg(value_name = "FILE", required = true)]
    pub(crate) files: Vec<PathBuf>,
    #[command(flatten)]
    pub(crate) reading: Reading,
    #[command(flatten)]
    pub(crate) placing: Placing,
    #[command(flatten)]
    pub(crate) using: Using,
    #[command(flatten)]
    pub(crate) writing: Writing,
    #[command(flatten)]
    pub(crate) drawing: Drawing,
    /// Read and check the inputs, say what would be done, write nothing
    #[arg(long)]
    pub(crate) dry_run: bool,
}

/// Checking files.
#[derive(Debug, Args)]
pub(crate) struct Check {
    /// Input files; `-` is standard input (with --format)
    #[arg(value_name = "FILE", required = true)]
    pub(crate) files: Vec<PathBuf>,
    #[command(flatten)]
    pub(crate) reading: Reading,
    #[command(flatten)]
    pub(crate) placing: Placing,
    #[command(flatten)]
    pub(crate) using: Using,
}

/// Describing files.
#[derive(Debug, Args)]
pub(crate) struct Info {
    /// Input files; `-` is standard input (with --format)
    #[arg(value_name = "FILE", required_unless_present = "formats")]
    pub(crate) files: Vec<PathBuf>,
    /// List the formats that can be read and written
    #[arg(long, conflicts_with = "files")]
    pub(crate) formats: bool,
    #[command(flatten)]
    pub(crate) reading: Reading,
    #[command(flatten)]
    pub(crate) placing: Placing,
}

/// Converting a file.
#[derive(Debug, Args)]
pub(crate) struct Convert {
    /// Input file, and the output file if there is no -o; `-` is standard input or output
    #[arg(value_name = "FILE", required = true, num_args = 1..=2)]
    pub(crate) files: Vec<PathBuf>,
    #[command(flatten)]
    pub(crate) reading: Reading,
    #[command(flatten)]
    pub(crate) placing: Placing,
    /// Turn surfaces whose faces point inwards
    #[arg(long, help_heading = "Inputs")]
    pub(crate) orient: bool,
    /// Join vertices on open edges that are no further apart than this
    #[arg(
        long, value_name = "DISTANCE", value_parser = values::distance, help_heading = "Inputs",
        allow_hyphen_values = true
    )]
    pub(crate) weld: Option<f64>,
    #[command(flatten)]
    pub(crate) writing: Writing,
    #[command(flatten)]
    pub(crate) drawing: Drawing,
    /// Read the input, say what would be done, write nothing
    #[arg(long)]
    pub(crate) dry_run: bool,
}

/// How inputs are read.
#[derive(Debug, Args)]
pub(crate) struct Reading {
    /// Format of standard input, or of all inputs if standard input is not among them
    #[arg(long, value_name = "FORMAT", value_parser = values::format, help_heading = "Inputs")]
    pub(crate) format: Option<Format>,
}

/// Transforms. Each applies to the input just before it on the command line; several apply in their order. The
/// values are taken from the matches together with their positions, not from these fields.
#[derive(Debug, Args)]
#[command(next_help_heading = "Transforms, of the input just before them, in their order")]
pub(crate) struct Placing {
    /// Move by x, y, z
    #[arg(long, value_name = "X,Y,Z", value_parser = values::vector, allow_hyphen_values = true)]
    translate: Vec<[f64; 3]>,
    /// Turn by x degrees about the x axis, then y about y, then z about z
    #[arg(long, value_name = "X,Y,Z", value_parser = values::vector, allow_hyphen_values = true)]
    rotate: Vec<[f64; 3]>,
    /// Scale by one factor, or by one for each axis
    #[arg(long, value_name = "S|X,Y,Z", value_parser = values::scale, allow_hyphen_values = true)]
    scale: Vec<[f64; 3]>,
    /// Apply an affine map: 16 numbers, row by row, the translation in the fourth column
    #[arg(long, value_name = "M11,M12,...", value_parser = values::matrix, allow_hyphen_values = true)]
    matrix: Vec<[[f64; 4]; 4]>,
}

/// What makes an input an operand.
#[derive(Clone, Copy, Debug, Args)]
pub(crate) struct Using {
    /// Turn inputs whose faces point inwards
    #[arg(long, help_heading = "Inputs")]
    pub(crate) orient: bool,
    /// Join vertices on open edges that are no further apart than this
    #[arg(
        long, value_name = "DISTANCE", value_parser = values::distance, help_heading = "Inputs",
        allow_hyphen_values = true
    )]
    pub(crate) weld: Option<f64>,
    /// Do not look for places where an input crosses itself
    #[arg(long, help_heading = "Inputs")]
    pub(crate) assume_clean: bool,
}

/// What is written.
#[derive(Debug, Args)]
#[command(next_help_heading = "Outputs")]
pub(crate) struct Writing {
    /// Output file; may be repeated; `-` is standard output (with --output-format); *.png draws a picture
    #[arg(short, long, value_name = "FILE")]
    pub(crate) output: Vec<PathBuf>,
    /// Format of standard output, or of all outputs if standard output is not among them
    #[arg(long, value_name = "FORMAT", value_parser = values::format)]
    pub(crate) output_format: Option<Format>,
    /// Write text where the format can be text or binary (STL, PLY)
    #[arg(long)]
    pub(crate) ascii: bool,
    /// Round coordinates to single precision
    #[arg(long)]
    pub(crate) single: bool,
}

/// Pictures.
#[derive(Debug, Args)]
#[command(next_help_heading = "Pictures")]
pub(crate) struct Drawing {
    /// Draw the result, shaded
    #[arg(long, value_name = "FILE")]
    pub(crate) png: Option<PathBuf>,
    /// Size of the picture in pixels
    #[arg(long, value_name = "WxH", value_parser = values::picture_size, default_value = "1024x768")]
    pub(crate) png_size: [u32; 2],
    /// Where to look from: x,y,z or front, back, left, right, top, bottom [default: 1,-1.2,0.8]
    #[arg(long, value_name = "X,Y,Z", value_parser = values::direction, allow_hyphen_values = true)]
    pub(crate) view: Option<[f64; 3]>,
    /// Which axis points upwards in the picture [default: y if the first input is glTF, else z]
    #[arg(long, value_enum)]
    pub(crate) png_up: Option<Up>,
    /// What the colours show [default: operand for a boolean, material otherwise]
    #[arg(long, value_enum, alias = "png-colour")]
    pub(crate) png_color: Option<Colours>,
    /// Parallel projection instead of perspective
    #[arg(long)]
    pub(crate) png_parallel: bool,
}

/// The upward axis of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Up {
    /// The y axis, as in glTF
    Y,
    /// The z axis, as in most CAD and printing files
    Z,
}

/// What the colours of a picture show.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Colours {
    /// The operand a face came from
    Operand,
    /// The material of the face's group
    Material,
    /// Nothing: one colour
    None,
}
