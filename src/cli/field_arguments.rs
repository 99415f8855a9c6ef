//! What may stand on the command line of `eval`, `slice`, `grid` and `curve`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use trisect::field::SignRule;

use super::argument_groups::{Placing, Reading, Results, Smoothness};
use super::values;

/// Evaluating a model.
#[derive(Debug, Args)]
pub(crate) struct Eval {
    /// Model file; `-` is standard input (file names in it then start at the current folder)
    #[arg(value_name = "MODEL")]
    pub(crate) model: PathBuf,
    /// Largest distance of a mesh from the true surface, whatever the model says
    #[arg(long, value_name = "LENGTH", value_parser = values::length, allow_hyphen_values = true)]
    pub(crate) tolerance: Option<f64>,
    #[command(flatten)]
    pub(crate) smoothness: Smoothness,
    /// Write the boundary in a plane, as polygons: *.svg or *.json
    #[arg(long, value_name = "FILE", help_heading = "Outputs")]
    pub(crate) contours: Option<PathBuf>,
    /// The plane of the contours
    #[arg(
        long, value_name = "Z", value_parser = values::number, default_value = "0", allow_hyphen_values = true,
        help_heading = "Outputs"
    )]
    pub(crate) contour_height: f64,
    #[command(flatten)]
    pub(crate) results: Results,
    /// Read and check the model, say what it needs, write nothing
    #[arg(long)]
    pub(crate) dry_run: bool,
}

/// A function of space: of a model, a mesh or a formula.
#[derive(Debug, Args)]
pub(crate) struct Source {
    /// Model file (*.json) or mesh file; `-` is standard input (a mesh, with --format)
    #[arg(value_name = "FILE", required_unless_present = "formula", num_args = 0..=1)]
    pub(crate) files: Vec<PathBuf>,
    /// A formula instead of a file
    #[arg(
        long,
        value_name = "TEXT",
        conflicts_with = "files",
        allow_hyphen_values = true,
        help_heading = "Inputs"
    )]
    pub(crate) formula: Option<String>,
    /// How a mesh's inside is told
    #[arg(long, value_enum, default_value_t = Rule::Automatic, help_heading = "Inputs")]
    pub(crate) sign: Rule,
    #[command(flatten)]
    pub(crate) reading: Reading,
    #[command(flatten)]
    pub(crate) placing: Placing,
    /// The part of space: two opposite corners [default: that of the solid and a tenth more]
    #[arg(
        long, value_name = "X,Y,Z,X,Y,Z", value_parser = values::corners, allow_hyphen_values = true
    )]
    pub(crate) bounds: Option<[[f64; 3]; 2]>,
}

/// How inside and outside of a mesh are distinguished.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Rule {
    /// By pseudonormals on clean surfaces, by winding where one crosses itself, by the fast winding number where it is open
    Automatic,
    /// By the side of the nearest point's pseudonormal
    Pseudonormal,
    /// An odd number of crossings
    Parity,
    /// A positive winding number
    Winding,
    /// The fast winding number: for open and dirty surfaces
    FastWinding,
}

impl Rule {
    pub(crate) fn rule(self) -> SignRule {
        match self {
            Self::Automatic => SignRule::Automatic,
            Self::Pseudonormal => SignRule::PseudoNormal,
            Self::Parity => SignRule::Parity,
            Self::Winding => SignRule::Winding,
            Self::FastWinding => SignRule::FastWinding,
        }
    }
}

/// The name of a rule, as on the command line.
pub(crate) fn rule_name(rule: SignRule) -> &'static str {
    match rule {
        SignRule::Automatic => "automatic",
        SignRule::PseudoNormal => "pseudonormal",
        SignRule::Parity => "parity",
        SignRule::Winding => "winding",
        SignRule::FastWinding => "fast-winding",
    }
}

/// Drawing a section.
#[derive(Debug, Args)]
pub(crate) struct Slice {
    #[command(flatten)]
    pub(crate) source: Source,
    /// The axis across which the section lies
    #[arg(long, value_enum, default_value_t = Axis::Z)]
    pub(crate) axis: Axis,
    /// Where along the axis [default: the middle of the bounds]
    #[arg(long, value_name = "POSITION", value_parser = values::number, allow_hyphen_values = true)]
    pub(crate) at: Option<f64>,
    /// Pixels across
    #[arg(long, value_name = "PIXELS", default_value_t = 800, value_parser = clap::value_parser!(u32).range(1..=16384))]
    pub(crate) width: u32,
    /// Step between lines of equal value [default: about ten lines]
    #[arg(long, value_name = "STEP", value_parser = values::length, allow_hyphen_values = true)]
    pub(crate) bands: Option<f64>,
    /// The picture: *.png; `-` is standard output
    #[arg(short, long, value_name = "FILE", help_heading = "Outputs")]
    pub(crate) output: PathBuf,
}

/// A coordinate axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Axis {
    /// The section lies in a plane x = constant
    X,
    /// The section lies in a plane y = constant
    Y,
    /// The section lies in a plane z = constant
    Z,
}

/// Sampling a grid.
#[derive(Debug, Args)]
pub(crate) struct SampleGrid {
    #[command(flatten)]
    pub(crate) source: Source,
    /// Distance of neighbouring points
    #[arg(long, value_name = "LENGTH", value_parser = values::length, allow_hyphen_values = true)]
    pub(crate) spacing: f64,
    /// Of a mesh: exact distances only as far as this from the surface, this value beyond
    #[arg(long, value_name = "LENGTH", value_parser = values::length, allow_hyphen_values = true)]
    pub(crate) band: Option<f64>,
    /// The grid: *.npy (NumPy) or *.raw (a line of text before the values); `-` is standard output, raw
    #[arg(short, long, value_name = "FILE", help_heading = "Outputs")]
    pub(crate) output: PathBuf,
}

#[cfg(feature = "parametric")]
pub(crate) use curve::*;

#[cfg(feature = "parametric")]
mod curve {
    use std::path::PathBuf;

    use clap::{Args, Subcommand, ValueEnum};

    use super::values;
    use crate::cli::curve_text::{InputName, JointName, KeptAt};

    /// What to do with curves.
    #[derive(Debug, Subcommand)]
    pub(crate) enum CurveVerb {
        /// Replace two Bezier or B-spline curves by one of the same degree, changing them as little as possible
        #[command(
            after_help = "Example:\n  trisect curve join p.json q.json --fix-ends -o r.json --svg picture.svg"
        )]
        Join(CurveJoin),
        /// Make a polygon of a curve, within a tolerance
        #[command(after_help = "Example:\n  trisect curve mesh c.json --tolerance 0.01 -o polygon.json")]
        Mesh(CurveMesh),
        /// Turn a plane curve in JSON into SVG path data, and back
        Convert(CurveConvert),
        /// Draw curves with their control polygons as SVG
        Draw(CurveDraw),
    }

    impl CurveVerb {
        pub(crate) fn name(&self) -> &'static str {
            match self {
                Self::Join(_) => "curve join",
                Self::Mesh(_) => "curve mesh",
                Self::Convert(_) => "curve convert",
                Self::Draw(_) => "curve draw",
            }
        }
    }

    /// Joining two curves.
    #[derive(Debug, Args)]
    pub(crate) struct CurveJoin {
        /// The first curve, JSON
        #[arg(value_name = "FIRST")]
        pub(crate) first: PathBuf,
        /// The second curve, JSON
        #[arg(value_name = "SECOND")]
        pub(crate) second: PathBuf,
        /// What is least: the change of the curves (integral) or that of the control points (discrete)
        #[arg(long, value_enum, default_value_t = Metric::Integral)]
        pub(crate) metric: Metric,
        /// Leave one curve as it is: first or second
        #[arg(long, value_name = "CURVE")]
        pub(crate) keep: Option<InputName>,
        /// Leave the outer ends where they are
        #[arg(long)]
        pub(crate) fix_ends: bool,
        /// Keep a point of a curve, and derivatives there if a third number says how many; may be repeated
        #[arg(long, value_name = "CURVE:PARAMETER[:ORDER]")]
        pub(crate) keep_at: Vec<KeptAt>,
        /// Where the joint comes to lie: a parameter between 0 and 1, lengths, or best [default: 0.5]
        #[arg(long, value_name = "JOINT")]
        pub(crate) joint: Option<JointName>,
        /// Raise the degree at least so far
        #[arg(long, value_name = "N", default_value_t = 0, hide_default_value = true)]
        pub(crate) degree: usize,
        /// The joined curve, JSON; `-` is standard output
        #[arg(short, long, value_name = "FILE", help_heading = "Outputs")]
        pub(crate) output: Option<PathBuf>,
        /// A picture of the curves, SVG
        #[arg(long, value_name = "FILE", help_heading = "Outputs")]
        pub(crate) svg: Option<PathBuf>,
    }

    /// What a join makes least.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
    pub(crate) enum Metric {
        /// The integral of the squared change of the curves
        Integral,
        /// The sum of the squared changes of the control points
        Discrete,
    }

    /// Making a polygon.
    #[derive(Debug, Args)]
    pub(crate) struct CurveMesh {
        /// The curve, JSON; `-` is standard input
        #[arg(value_name = "FILE")]
        pub(crate) file: PathBuf,
        /// Largest distance between curve and polygon
        #[arg(long, value_name = "LENGTH", value_parser = values::length, allow_hyphen_values = true)]
        pub(crate) tolerance: f64,
        /// Nodes at equal parameter steps to begin with
        #[arg(long, value_name = "N", default_value_t = 2)]
        pub(crate) nodes: usize,
        /// Halve edges that deviate, as in the paper, instead of placing nodes evenly
        #[arg(long)]
        pub(crate) halving: bool,
        /// The polygon, JSON; `-` is standard output
        #[arg(short, long, value_name = "FILE", help_heading = "Outputs")]
        pub(crate) output: PathBuf,
    }

    /// Converting a curve.
    #[derive(Debug, Args)]
    pub(crate) struct CurveConvert {
        /// The curve, JSON or SVG path data; `-` is standard input
        #[arg(value_name = "FILE")]
        pub(crate) file: PathBuf,
        /// How far path data may be off for curves that SVG does not have
        #[arg(
            long, value_name = "LENGTH", value_parser = values::length, default_value = "0.001",
            allow_hyphen_values = true
        )]
        pub(crate) tolerance: f64,
        /// The curve in the other form; `-` is standard output
        #[arg(short, long, value_name = "FILE", help_heading = "Outputs")]
        pub(crate) output: PathBuf,
    }

    /// Drawing curves.
    #[derive(Debug, Args)]
    pub(crate) struct CurveDraw {
        /// Curves, JSON; curves of space are seen along z
        #[arg(value_name = "FILE", required = true)]
        pub(crate) files: Vec<PathBuf>,
        /// The picture, SVG; `-` is standard output
        #[arg(short, long, value_name = "FILE", help_heading = "Outputs")]
        pub(crate) output: PathBuf,
    }
}
