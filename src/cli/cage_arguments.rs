//! What may stand on the command line of `subdivide` and `freeform`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use trisect::Operation;
use trisect::subdivision::{Rules, Scheme};

use super::argument_groups::{Drawing, Placing, Results};
use super::values;

/// How cages are read.
#[derive(Clone, Copy, Debug, Args)]
#[command(next_help_heading = "Cages")]
pub(crate) struct Cages {
    /// Tag edges as creases where faces meet at more than this angle, in degrees
    #[arg(long, value_name = "DEGREES", value_parser = values::number, allow_hyphen_values = true)]
    pub(crate) creases_from_angle: Option<f64>,
    /// Weights of Loop's scheme
    #[arg(long, value_enum, default_value_t = RulesChoice::Loop)]
    pub(crate) rules: RulesChoice,
    /// Scheme of OBJ files [default: catmull-clark if a face has more than three corners, loop otherwise]
    #[arg(long, value_enum)]
    pub(crate) scheme: Option<SchemeChoice>,
}

/// Schemes of subdivision.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum SchemeChoice {
    /// Loop's: triangles; larger faces are split
    Loop,
    /// Catmull and Clark's: polygons
    CatmullClark,
}

impl SchemeChoice {
    pub(crate) fn scheme(self) -> Scheme {
        match self {
            Self::Loop => Scheme::Loop,
            Self::CatmullClark => Scheme::CatmullClark,
        }
    }
}

/// Weights of the subdivision.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum RulesChoice {
    /// Loop's, smooth beside creases
    Loop,
    /// As OpenSubdiv has them, beside creases too
    #[value(name = "opensubdiv")]
    OpenSubdiv,
    /// As libigl has them
    Biermann,
}

impl RulesChoice {
    pub(crate) fn rules(self) -> Rules {
        match self {
            Self::Loop => Rules::Loop,
            Self::OpenSubdiv => Rules::OpenSubdiv,
            Self::Biermann => Rules::Biermann,
        }
    }
}

/// Subdividing a cage.
#[derive(Debug, Args)]
pub(crate) struct Subdivide {
    /// Cage: *.obj with tag lines, *.json, or a *.glb that has one
    #[arg(value_name = "CAGE", required = true, num_args = 1)]
    pub(crate) files: Vec<PathBuf>,
    #[command(flatten)]
    pub(crate) placing: Placing,
    #[command(flatten)]
    pub(crate) cages: Cages,
    /// Split every face so many times [default: 1, without --tolerance]
    #[arg(
        long, value_name = "N", value_parser = clap::value_parser!(u32).range(0..=10), conflicts_with = "tolerance",
        allow_hyphen_values = true
    )]
    pub(crate) levels: Option<u32>,
    /// Split faces until triangles are this near to the limit surface, vertices on it
    #[arg(long, value_name = "LENGTH", value_parser = values::length, allow_hyphen_values = true)]
    pub(crate) tolerance: Option<f64>,
    /// With --levels: vertices on the limit surface, a mesh and no cage
    #[arg(long)]
    pub(crate) limit: bool,
    #[command(flatten)]
    pub(crate) results: Results,
}

/// A boolean of cages.
#[derive(Debug, Args)]
pub(crate) struct FreeFormVerb {
    /// What to do
    #[arg(value_name = "OPERATION", value_enum)]
    pub(crate) operation: CageOperation,
    /// Cages: *.obj with tag lines, *.json, or *.glb that have one; all are combined at once; of one that crosses itself, union makes one that does not
    #[arg(value_name = "CAGE", required = true, num_args = 1..)]
    pub(crate) files: Vec<PathBuf>,
    #[command(flatten)]
    pub(crate) placing: Placing,
    #[command(flatten)]
    pub(crate) cages: Cages,
    /// Output file; may be repeated: *.obj and *.json get the cage, *.glb the limit surface with the cage in it, others the limit surface, *.png a picture
    #[arg(short, long, value_name = "FILE", help_heading = "Outputs")]
    pub(crate) output: Vec<PathBuf>,
    /// Write the exact boolean of the limit meshes
    #[arg(long, value_name = "FILE", help_heading = "Outputs")]
    pub(crate) exact: Option<PathBuf>,
    /// Largest distance between the cage's surface and the exact boolean [default: 1/1000 of the diagonal]
    #[arg(long, value_name = "LENGTH", value_parser = values::length, allow_hyphen_values = true)]
    pub(crate) tolerance: Option<f64>,
    /// Begin with faces beside the curve halved so many times
    #[arg(
        long, value_name = "N", value_parser = clap::value_parser!(u32).range(0..=4), default_value = "0",
        allow_hyphen_values = true
    )]
    pub(crate) refine: u32,
    /// Halve them so many times more while the tolerance is not reached [default: 2, with --details 0]
    #[arg(
        long, value_name = "N", value_parser = clap::value_parser!(u32).range(0..=4), allow_hyphen_values = true
    )]
    pub(crate) attempts: Option<u32>,
    /// Add up to so many levels of details while the tolerance is not reached; they are kept by *.json
    #[arg(
        long, value_name = "LEVELS", value_parser = clap::value_parser!(u32).range(0..=4), default_value = "0",
        allow_hyphen_values = true
    )]
    pub(crate) details: u32,
    /// Subdivide the result until it has no details, so that *.obj can have it
    #[arg(long)]
    pub(crate) flatten: bool,
    /// Rings of control points around what changed that may move
    #[arg(
        long, value_name = "R", value_parser = clap::value_parser!(u32).range(1..=8), default_value = "2",
        allow_hyphen_values = true
    )]
    pub(crate) rings: u32,
    /// Take surfaces that nearly touch along their curve
    #[arg(long)]
    pub(crate) allow_tangent: bool,
    #[command(flatten)]
    pub(crate) drawing: Drawing,
}

/// The operations of cages.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum CageOperation {
    /// What is in any of the cages
    Union,
    /// What is in all of them
    Intersection,
    /// What is in the first and in none of the others
    Difference,
}

impl CageOperation {
    pub(crate) fn operation(self) -> Operation {
        match self {
            Self::Union => Operation::Union,
            Self::Intersection => Operation::Intersection,
            Self::Difference => Operation::Difference,
        }
    }
}
