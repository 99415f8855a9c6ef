//! Groups of options that several verbs share.

use std::path::PathBuf;
use std::time::Duration;

use clap::{Args, ColorChoice, ValueEnum};
use trisect::io::Format;
use trisect::mesh::Welding;

use super::shapes::Justify;
use super::surface::{self, Normals};
use super::transforms::{self, Alignment, Repetition};
use super::values;

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
    /// Colour errors, warnings and progress
    #[arg(
        long, global = true, value_name = "WHEN", value_enum, default_value_t = ColorChoice::Auto,
        help_heading = "Reports"
    )]
    pub(crate) color: ColorChoice,
    /// Exit with code 5 if there were warnings (outputs are still written)
    #[arg(long, global = true, help_heading = "Reports")]
    pub(crate) strict: bool,
    /// Use this many threads, or as many as the machine can use [default: all processors]
    #[arg(
        long, global = true, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024),
        help_heading = "Limits", allow_hyphen_values = true
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

/// Files that are read and placed. They are taken from the matches together with the options after each.
#[derive(Debug, Args)]
pub(crate) struct Files {
    /// Input files; `-` is standard input (with --format)
    #[arg(value_name = "FILE", required = true)]
    files: Vec<PathBuf>,
    #[command(flatten)]
    pub(crate) reading: Reading,
    #[command(flatten)]
    placing: Placing,
}

/// Files that are used as operands.
#[derive(Debug, Args)]
pub(crate) struct Inputs {
    #[command(flatten)]
    pub(crate) from: Files,
    #[command(flatten)]
    pub(crate) using: Using,
}

/// What becomes of the resulting mesh.
#[derive(Debug, Args)]
pub(crate) struct Results {
    #[command(flatten)]
    pub(crate) writing: Writing,
    #[command(flatten)]
    pub(crate) drawing: Drawing,
}

/// What surfaces of fields are like.
#[derive(Clone, Copy, Debug, Args)]
pub(crate) struct Smoothness {
    /// Leave surfaces of fields as the cells give them: as near and in less time, but crumpled and of several times the triangles
    #[arg(long)]
    pub(crate) no_smooth: bool,
}

/// How inputs are read.
#[derive(Debug, Args)]
pub(crate) struct Reading {
    /// Format of standard input, or of all inputs if standard input is not among them
    #[arg(long, value_name = "FORMAT", value_parser = values::format, help_heading = "Inputs")]
    pub(crate) format: Option<Format>,
    /// A glTF scene may take this many times the bytes of its file: many nodes can show one mesh [default: 64]
    #[arg(
        long, value_name = "TIMES", value_parser = clap::value_parser!(u64).range(1..), help_heading = "Inputs",
        allow_hyphen_values = true
    )]
    expansion: Option<u64>,
}

/// Transforms. Each applies to the input just before it on the command line; several apply in their order. The
/// values are taken from the matches together with their positions, not from these fields.
#[derive(Debug, Args)]
#[command(next_help_heading = "Transforms, of the input just before them, in their order")]
pub(crate) struct Placing {
    /// Move by x, y, z
    #[arg(long, value_name = "X,Y,Z", value_parser = values::vector, allow_hyphen_values = true)]
    translate: Vec<[f64; 3]>,
    /// Turn by so many degrees about the z axis; or by x degrees about x, then y about y, then z about z
    #[arg(long, value_name = "Z|X,Y,Z", value_parser = transforms::rotation, allow_hyphen_values = true)]
    rotate: Vec<[f64; 3]>,
    /// Scale by one factor, or by one for each axis; 200% is 2
    #[arg(long, value_name = "S|X,Y,Z", value_parser = values::scale, allow_hyphen_values = true)]
    scale: Vec<[f64; 3]>,
    /// Apply an affine map: 16 numbers, row by row, the translation in the fourth column
    #[arg(long, value_name = "M11,M12,...", value_parser = values::matrix, allow_hyphen_values = true)]
    matrix: Vec<[[f64; 4]; 4]>,
    /// Move the middle of the bounds to the origin, along all axes or along those given, as --center=xy
    #[arg(
        long, value_name = "AXES", value_parser = transforms::axes, num_args = 0..=1, require_equals = true,
        default_missing_value = "xyz", action = clap::ArgAction::Append
    )]
    center: Vec<[bool; 3]>,
    /// Move a side of the bounds (low, middle or high) to a coordinate, 0 if none is given: z=low, x=middle:25
    #[arg(long, value_name = "AXIS=SIDE[:AT]", value_parser = transforms::alignment, allow_hyphen_values = true)]
    align: Vec<Alignment>,
    /// Move the lowest point to z = 0, as z=low of --align does
    #[arg(long, num_args = 0, default_missing_value = "true", action = clap::ArgAction::Append)]
    drop: Vec<bool>,
    /// Mirror in the plane through the origin across an axis
    #[arg(long, value_name = "x|y|z", value_parser = transforms::axis)]
    mirror: Vec<usize>,
    /// Scale evenly so that the largest extent is this, or so that it just fits into a box
    #[arg(long, value_name = "SIZE|X,Y,Z", value_parser = transforms::size, allow_hyphen_values = true)]
    fit: Vec<[f64; 3]>,
    /// Repeat as one input: linear:COUNT:X,Y,Z, grid:NXxNYxNZ:X,Y,Z, circular:COUNT[:AXIS[:DEGREES]], points:FILE, or
    /// along:FILE:COUNT[:turn]
    #[arg(long, value_name = "PATTERN", value_parser = transforms::repetition, allow_hyphen_values = true)]
    pattern: Vec<Repetition>,
    /// Take the input, a cage (*.obj, *.json, *.glb with a cage), as its limit surface, within a tolerance in its units there
    /// [default: 1/1000 of its diagonal]; with commas: creases:DEGREES, loop or catmull-clark, opensubdiv or biermann
    #[cfg(feature = "subdivision")]
    #[arg(
        long, value_name = "TOLERANCE,...", value_parser = super::smoothing::smoothing, num_args = 0..=1,
        require_equals = true, default_missing_value = "auto", action = clap::ArgAction::Append
    )]
    subdivide: Vec<super::smoothing::Smoothing>,
    #[command(flatten)]
    texts: Texts,
}

/// How inputs that are text are set. The values are taken from the matches together with their positions.
#[derive(Debug, Args)]
#[command(
    next_help_heading = "Text, of the input text:... just before them, or of all before the first input"
)]
pub(crate) struct Texts {
    /// The font: a file *.ttf, *.otf or *.ttc
    #[arg(long, value_name = "FILE")]
    font: Vec<PathBuf>,
    /// The size of the font, its em: capitals are about 0.7 of it [default: 10]
    #[arg(long, value_name = "LENGTH", value_parser = values::length, allow_hyphen_values = true)]
    size: Vec<f64>,
    /// How far text is extruded, from z = 0 upwards [default: 1]
    #[arg(long, value_name = "LENGTH", value_parser = values::length, allow_hyphen_values = true)]
    depth: Vec<f64>,
    /// To which side lines are flush [default: left]
    #[arg(long, value_name = "SIDE", value_enum)]
    justify: Vec<Justify>,
}

/// What is mended in inputs where it is asked for. Each applies to the input just before it, or to all inputs if it stands
/// before the first. The values are taken from the matches together with their positions, not from these fields.
#[derive(Debug, Args)]
#[command(next_help_heading = "Mending, of the input just before them, or of all inputs before the first")]
pub(crate) struct Repair {
    /// Turn an input whose faces point inwards, or disagree
    #[arg(long, num_args = 0, default_missing_value = "true", action = clap::ArgAction::Append)]
    orient: Vec<bool>,
    /// Join vertices on open edges that are no further apart than this; auto: than the least distance that closes the
    /// surface
    #[arg(long, value_name = "DISTANCE|auto", value_parser = values::welding, allow_hyphen_values = true)]
    weld: Vec<Welding>,
}

/// What is mended in operands.
#[derive(Debug, Args)]
#[command(next_help_heading = "Mending, of the input just before them, or of all inputs before the first")]
pub(crate) struct Admitting {
    /// Leave out the parts of an input that are not closed
    #[arg(long, num_args = 0, default_missing_value = "true", action = clap::ArgAction::Append)]
    closed_parts: Vec<bool>,
    /// Fill holes, those with up to MAX edges if it is given; the surface that was there is not known
    #[arg(
        long, value_name = "MAX", num_args = 0..=1, require_equals = true, default_missing_value = "all",
        value_parser = values::hole, action = clap::ArgAction::Append
    )]
    fill_holes: Vec<usize>,
    /// Refine what fills holes to the edges around it, and bend it on like the surface there; fills all if --fill-holes is not given
    #[arg(long, num_args = 0, default_missing_value = "true", action = clap::ArgAction::Append)]
    refine_holes: Vec<bool>,
    /// Mend nothing: refuse an input that is not closed as it is
    #[arg(long, num_args = 0, default_missing_value = "true", action = clap::ArgAction::Append)]
    as_is: Vec<bool>,
}

/// What makes an input an operand.
#[derive(Debug, Args)]
pub(crate) struct Using {
    #[command(flatten)]
    repair: Repair,
    #[command(flatten)]
    admitting: Admitting,
    /// What is inside an input that crosses itself: where its surface winds around more often outwards than inwards
    /// (positive), at all (nonzero), or an odd number of times (even-odd) [default: positive]
    #[arg(long, value_name = "RULE", value_parser = values::rule, help_heading = "Inputs")]
    rule: Vec<trisect::Rule>,
    /// Do not look for places where an input crosses itself
    #[arg(long, help_heading = "Inputs")]
    pub(crate) assume_clean: bool,
}

/// What is written.
#[derive(Clone, Debug, Default, Args)]
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
    /// Put the buffer and the pictures of .gltf files into files beside them
    #[arg(long)]
    pub(crate) separate: bool,
    /// Write into glTF files which vertices of seams are one (EXT_mesh_manifold)
    #[arg(long)]
    pub(crate) manifold: bool,
    /// Normals of the outputs: keep, flat, none, or an angle in degrees up to which edges are smooth
    #[arg(long, value_name = "keep|flat|none|DEGREES", value_parser = surface::normals, default_value = "keep")]
    pub(crate) normals: Normals,
    /// What becomes of the glTF scene that a node given as the first input stands in
    #[arg(long, value_enum, default_value = "drop")]
    pub(crate) scene: SceneChoice,
    /// The node of the first input, as FILE#NAME means it
    #[arg(long, value_name = "NAME")]
    pub(crate) node: Option<String>,
    /// Move the outputs so that the middle of their bounds is near the origin
    #[arg(long)]
    pub(crate) recenter: bool,
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
    /// Which axis points upwards in the picture [default: y if the first input is glTF or OBJ, else z]
    #[arg(long, value_enum)]
    pub(crate) png_up: Option<Up>,
    /// What the colours show [default: operand for a boolean, material otherwise]
    #[arg(long, value_enum, alias = "png-colour")]
    pub(crate) png_color: Option<Colours>,
    /// Parallel projection instead of perspective
    #[arg(long)]
    pub(crate) png_parallel: bool,
}

/// What becomes of the scene that a part of the first input stands in.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum SceneChoice {
    /// The result stands alone
    #[default]
    Drop,
    /// glTF outputs are the scene, with the result at the node
    Keep,
}

/// The upward axis of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Up {
    /// The y axis, as in glTF and most OBJ files
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
