//! What may stand on the command line.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, ValueEnum};
use trisect::Operation;

use super::argument_groups::{Common, Inputs, Placing, Reading, Repair, Results};
use super::batch::Batch;
#[cfg(feature = "subdivision")]
use super::cage_arguments::{FreeFormVerb, Subdivide};
use super::cut_arguments::{Cut, Imprint, Section, Solidify, Split, Trim};
#[cfg(feature = "parametric")]
use super::field_arguments::CurveVerb;
use super::field_arguments::{Eval, SampleGrid, Slice};
use super::making_arguments::{Completions, Distance, Hollow, Hull, Man, Measure, Minkowski, Offset, Text};
use super::surface::{self, CutUv};
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
    max_term_width = 100
)]
pub(crate) struct Arguments {
    #[command(flatten)]
    pub(crate) common: Common,
    #[command(subcommand)]
    pub(crate) verb: Verb,
}

/// What to do.
#[derive(Debug, Subcommand)]
pub(crate) enum Verb {
    /// What is in any of the inputs
    #[command(
        visible_aliases = ["merge", "add"],
        after_help = "Example:\n  trisect union a.obj b.glb --translate 10,0,0 -o out.stl"
    )]
    Union(Combine),
    /// What is in the first input and in none of the others
    #[command(
        visible_alias = "subtract",
        after_help = "Examples:\n  trisect difference body.stl tool1.obj tool2.obj -o part.obj\n  trisect difference plate.stl \
                            drill.stl --pattern grid:10x10:5,5 -o drilled.stl"
    )]
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
    /// An expression of the inputs, what is in at least so many of them, or all results of two
    #[command(
        after_help = "Examples:\n  trisect combine --expr 'a - (b + c)' body.stl pin.stl slot.stl -o part.stl\n  trisect \
                            combine --expr 'body & box - pin' body=a.stl box=b.obj pin=c.glb -o part.glb\n  trisect \
                            combine --at-least 2 a.stl b.stl c.stl -o common.stl\n  trisect combine --all a.stl b.stl \
                            -o parts.stl"
    )]
    Combine(Combination),
    /// What an input's surface winds around, as a surface that does not cross itself
    #[command(
        after_help = "Examples:\n  trisect resolve scan.stl -o clean.stl\n  trisect resolve logo.obj --rule even-odd -o \
                            logo.glb"
    )]
    Resolve(Combine),
    /// Cut at planes, closed by caps
    #[command(
        after_help = "Examples:\n  trisect cut part.stl --plane z=12.5 -o above.stl -o below.stl\n  trisect cut part.stl --plane \
                            x=0 --plane y=0 -o quarter.stl\n  trisect cut part.glb --plane 1,1,0,3 --keep below --cap \
                            cut#d08030 -o open.glb --png open.png"
    )]
    Cut(Cut),
    /// The polygons where planes meet a solid
    #[command(
        after_help = "Examples:\n  trisect section part.stl --plane z=1 -o section.svg\n  trisect section part.stl --heights \
                            0:0.2:10 --side above -o layers.json -o layers.dxf"
    )]
    Section(Section),
    /// Bodies as files of their own, or the cells that another solid makes of one
    #[command(
        after_help = "Examples:\n  trisect split parts.stl -o part.stl\n  trisect split block.stl --by mould.stl -o half.stl"
    )]
    Split(Split),
    /// What of an open surface lies inside a solid, or outside it
    #[command(after_help = "Example:\n  trisect trim terrain.obj house.stl --outside -o terrain-cut.obj")]
    Trim(Trim),
    /// The curve in which two surfaces meet, as edges of both
    #[command(after_help = "Example:\n  trisect imprint terrain.obj wall.obj -o marked.obj")]
    Imprint(Imprint),
    /// A solid of any soup of triangles: holes closed, what is inside found by winding numbers
    #[command(after_help = "Example:\n  trisect solidify scan.ply -o solid.stl --png solid.png")]
    Solidify(Solidify),
    /// The convex hull of all inputs together
    #[command(after_help = "Example:\n  trisect hull a.stl b.obj -o hull.stl")]
    Hull(Hull),
    /// Text in a TrueType or OpenType font, as a solid
    #[command(
        after_help = "Examples:\n  trisect text 'No 42' --font DejaVuSans.ttf --size 8 --depth 2 -o text.stl\n  trisect difference \
                            part.stl 'text:No 42' --font DejaVuSans.ttf --size 8 --translate 5,5,9 -o engraved.stl"
    )]
    Text(Text),
    /// What a convex tool sweeps while its origin goes through all of a solid
    #[command(after_help = "Example:\n  trisect minkowski body.stl ball.stl -o rounded.stl")]
    Minkowski(Minkowski),
    /// A solid grown by a distance, or shrunk
    #[command(
        after_help = "Examples:\n  trisect offset part.stl --distance 0.5 -o larger.stl\n  trisect offset part.stl --distance -0.2 -o smaller.stl"
    )]
    Offset(Offset),
    /// A solid made hollow, with a wall of even thickness and drain holes
    #[command(after_help = "Example:\n  trisect hollow bust.stl --wall 2 --drain 0,0,0:1.5 -o hollow.stl")]
    Hollow(Hollow),
    /// Volume, area, centroid and moments of inertia of solids, and what is at points
    #[command(
        after_help = "Examples:\n  trisect measure part.stl --json\n  trisect measure part.stl --at 0,0,5 --points probes.csv"
    )]
    Measure(Measure),
    /// How far two solids are apart and where, or how much of them overlaps
    #[command(after_help = "Example:\n  trisect distance a.stl b.stl --translate 10,0,0")]
    Distance(Distance),
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
    /// Run many jobs from a file, each in a process of its own, and report each
    #[command(
        after_help = "A job: {\"id\": \"p7\", \"verb\": \"difference\", \"inputs\": [\"a.stl\", {\"file\": \"b.stl\", \"translate\": [1, 0, \
                            0]}], \"output\": \"out/p7.ply\", \"options\": {\"weld\": \"auto\"}}\n\nExample:\n  trisect batch \
                            jobs.jsonl -o reports.jsonl"
    )]
    Batch(Batch),
    /// Join, mesh, convert and draw curves
    #[cfg(feature = "parametric")]
    #[command(subcommand)]
    Curve(CurveVerb),
    /// Refine a cage (a subdivision surface's control mesh), or make a mesh of its limit surface
    #[cfg(feature = "subdivision")]
    #[command(
        after_help = "Examples:\n  trisect subdivide cage.obj --levels 2 -o fine.obj\n  trisect subdivide cage.obj --tolerance \
                            0.01 -o smooth.stl"
    )]
    Subdivide(Subdivide),
    /// Booleans of cages that give a cage
    #[cfg(feature = "subdivision")]
    #[command(
        after_help = "Example:\n  trisect freeform difference mug.obj inside.obj -o cup.obj --tolerance 0.02 --png cup.png"
    )]
    Freeform(FreeFormVerb),
    /// Print what a shell needs to complete command lines of this program
    #[command(
        after_help = "Examples:\n  trisect completions bash > ~/.local/share/bash-completion/completions/trisect\n  trisect \
                            completions zsh > ~/.zfunc/_trisect\n  trisect completions fish > \
                            ~/.config/fish/completions/trisect.fish"
    )]
    Completions(Completions),
    /// Print a page of the manual, for `man`
    #[command(
        after_help = "Examples:\n  trisect man | man -l -\n  trisect man --folder /usr/local/share/man/man1"
    )]
    Man(Man),
}

impl Verb {
    /// The verb's name, as on the command line.
    pub(crate) fn name(&self) -> &'static str {
        match self {
            Self::Union(_) => Operation::Union.name(),
            Self::Difference(_) => Operation::Difference.name(),
            Self::Intersection(_) => Operation::Intersection.name(),
            Self::Xor(_) => Operation::SymmetricDifference.name(),
            Self::Combine(_) => "combine",
            Self::Resolve(_) => "resolve",
            Self::Cut(_) => "cut",
            Self::Section(_) => "section",
            Self::Split(_) => "split",
            Self::Trim(_) => "trim",
            Self::Imprint(_) => "imprint",
            Self::Solidify(_) => "solidify",
            Self::Hull(_) => "hull",
            Self::Text(_) => "text",
            Self::Minkowski(_) => "minkowski",
            Self::Offset(_) => "offset",
            Self::Hollow(_) => "hollow",
            Self::Measure(_) => "measure",
            Self::Distance(_) => "distance",
            Self::Completions(_) => "completions",
            Self::Man(_) => "man",
            Self::Check(_) => "check",
            Self::Info(_) => "info",
            Self::Convert(_) => "convert",
            Self::Eval(_) => "eval",
            Self::Slice(_) => "slice",
            Self::Grid(_) => "grid",
            Self::Batch(_) => "batch",
            #[cfg(feature = "parametric")]
            Self::Curve(verb) => verb.name(),
            #[cfg(feature = "subdivision")]
            Self::Subdivide(_) => "subdivide",
            #[cfg(feature = "subdivision")]
            Self::Freeform(_) => "freeform",
        }
    }
}

/// A boolean of several inputs.
#[derive(Debug, Args)]
pub(crate) struct Combine {
    #[command(flatten)]
    pub(crate) inputs: Inputs,
    #[command(flatten)]
    pub(crate) results: Results,
    /// Round the result to the numbers of the output's format (single precision in STL and glTF) and resolve all that crosses
    /// there: what is read back does not cross itself. Without it this is done where the operation made triangles, in double precision
    #[arg(long, help_heading = "Results", conflicts_with = "exact_rounding")]
    pub(crate) embed: bool,
    /// Leave every point where it rounds to, also where that makes thin parts cross
    #[arg(long, help_heading = "Results")]
    pub(crate) exact_rounding: bool,
    /// What the faces show that a tool has cut: keep (what the tool has there), body, or the name of a material
    #[arg(long, value_name = "keep|body|NAME", value_parser = surface::cut_material, help_heading = "Results")]
    pub(crate) cut_material: Option<String>,
    /// Lay texture coordinates on cut faces: planar or box, with how many to a unit of length (box:0.5)
    #[arg(long, value_name = "KIND[:DENSITY]", value_parser = surface::cut_uv, help_heading = "Results")]
    pub(crate) cut_uv: Option<CutUv>,
    /// Put the faces of each input into a group of its name, with a colour of its own
    #[arg(long, value_name = "WHAT", value_enum, alias = "colour-by", help_heading = "Results")]
    pub(crate) color_by: Option<ColorBy>,
    /// Before the operation, make the same what is no further apart than this: vertices, edges and faces of all inputs
    #[arg(long, value_name = "UNITS", value_parser = values::length, help_heading = "Results", allow_hyphen_values = true)]
    pub(crate) snap: Option<f64>,
    /// Read and check the inputs, say what would be done, write nothing
    #[arg(long)]
    pub(crate) dry_run: bool,
}

/// What faces are coloured by in outputs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum ColorBy {
    /// The input they come from
    Operand,
}

/// Expressions of several inputs.
#[derive(Debug, Args)]
#[command(group = clap::ArgGroup::new("wanted").required(true).args(["expr", "at_least", "all"]))]
pub(crate) struct Combination {
    /// An expression: + union, - difference, & intersection, ^ symmetric difference, parentheses, atleast(2, a, b, c). Inputs
    /// are called a, b, c and so on, or as in name=FILE
    #[arg(long, value_name = "EXPRESSION", help_heading = "Results", allow_hyphen_values = true)]
    pub(crate) expr: Option<String>,
    /// What is in at least so many inputs
    #[arg(
        long, value_name = "K", value_parser = clap::value_parser!(u16).range(1..), help_heading = "Results",
        allow_hyphen_values = true
    )]
    pub(crate) at_least: Option<u16>,
    /// Of two inputs their union, intersection and both differences, with the same vertices where they meet; the names of
    /// outputs get -union, -intersection, -difference and -reverse
    #[arg(long, help_heading = "Results")]
    pub(crate) all: bool,
    #[command(flatten)]
    pub(crate) combine: Combine,
}

/// Checking files.
#[derive(Debug, Args)]
pub(crate) struct Check {
    #[command(flatten)]
    pub(crate) inputs: Inputs,
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
    #[command(flatten)]
    repair: Repair,
    #[command(flatten)]
    pub(crate) results: Results,
    /// Read the input, say what would be done, write nothing
    #[arg(long)]
    pub(crate) dry_run: bool,
}
