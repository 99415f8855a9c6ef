//! What may stand on the command line of `cut`, `section` and `split`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use trisect::FaceGroup;
use trisect::exact::Plane;
use trisect::mesh::Welding;

use super::argument_groups::{Files, Inputs, Repair, Results};
use super::field_arguments::Axis;
use super::surface::{self, CutUv};
use super::values::{self, Heights};

/// Which halves of a cut are wanted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Keep {
    /// What is above the plane, or above all of them
    Above,
    /// What is below the plane, or below all of them
    Below,
    /// Both, or all pieces that several planes make
    Both,
}

/// Cutting at planes.
#[derive(Debug, Args)]
pub(crate) struct Cut {
    #[command(flatten)]
    pub(crate) inputs: Inputs,
    /// The plane: z=12.5 (or x=, y=), a,b,c,d for a x + b y + c z = d, or three points; several cut one after the other
    #[arg(
        long, value_name = "PLANE", value_parser = values::plane, allow_hyphen_values = true,
        help_heading = "Results"
    )]
    pub(crate) plane: Vec<Plane>,
    /// Which part is kept; above is where the coordinate, or a x + b y + c z, is larger, or from where three points run
    /// counter-clockwise
    #[arg(long, value_name = "PART", value_enum, default_value_t = Keep::Both, help_heading = "Results")]
    pub(crate) keep: Keep,
    /// The group of the new faces, with a colour if it ends with #RRGGBB
    #[arg(long, value_name = "MATERIAL", value_parser = values::material, help_heading = "Results")]
    pub(crate) cap: Option<FaceGroup>,
    /// What the new faces show: nothing of their own, the group around them, or a material by its name, new or of the input
    #[arg(
        long, value_name = "keep|body|NAME", value_parser = surface::cut_material, conflicts_with = "cap",
        help_heading = "Results"
    )]
    pub(crate) cut_material: Option<String>,
    /// Texture coordinates of the new faces: planar or box, with how many to a unit of length, as box:0.5
    #[arg(long, value_name = "KIND[:DENSITY]", value_parser = surface::cut_uv, help_heading = "Results")]
    pub(crate) cut_uv: Option<CutUv>,
    #[command(flatten)]
    pub(crate) results: Results,
    /// Read and check the input, say what would be done, write nothing
    #[arg(long)]
    pub(crate) dry_run: bool,
}

/// What counts where faces lie in the plane of a section.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Side {
    /// What has the solid above and below
    Inside,
    /// What has the solid above: a layer that begins there
    Above,
    /// What has the solid below: a layer that ends there
    Below,
}

/// Sections at planes.
#[derive(Debug, Args)]
#[command(group = clap::ArgGroup::new("where").required(true).args(["plane", "heights"]))]
pub(crate) struct Section {
    #[command(flatten)]
    pub(crate) inputs: Inputs,
    /// The plane: z=12.5 (or x=, y=), a,b,c,d for a x + b y + c z = d, or three points; there may be several
    #[arg(
        long, value_name = "PLANE", value_parser = values::plane, allow_hyphen_values = true, help_heading = "Results"
    )]
    pub(crate) plane: Vec<Plane>,
    /// Layers: FIRST:STEP:LAST, or heights separated by commas
    #[arg(
        long, value_name = "HEIGHTS", value_parser = values::heights, allow_hyphen_values = true,
        help_heading = "Results"
    )]
    pub(crate) heights: Option<Heights>,
    /// The axis of the heights
    #[arg(long, value_enum, default_value_t = Axis::Z, conflicts_with = "plane", help_heading = "Results")]
    pub(crate) axis: Axis,
    /// What counts where faces of the solid lie in the plane
    #[arg(long, value_enum, default_value_t = Side::Inside, help_heading = "Results")]
    pub(crate) side: Side,
    /// Where the polygons go: *.svg, *.dxf or *.json; `-` is standard output, as JSON
    #[arg(short, long, value_name = "FILE", help_heading = "Outputs")]
    pub(crate) output: Vec<PathBuf>,
}

/// Trimming an open surface.
#[derive(Debug, Args)]
#[command(group = clap::ArgGroup::new("side").required(true).args(["inside", "outside"]))]
pub(crate) struct Trim {
    #[command(flatten)]
    pub(crate) inputs: Inputs,
    /// Keep what of the first input, which may be open, lies inside the second
    #[arg(long, help_heading = "Results")]
    pub(crate) inside: bool,
    /// Keep what lies outside it
    #[arg(long, help_heading = "Results")]
    pub(crate) outside: bool,
    #[command(flatten)]
    pub(crate) results: Results,
}

/// Making a solid of a soup.
#[derive(Debug, Args)]
pub(crate) struct Solidify {
    #[command(flatten)]
    pub(crate) from: Files,
    /// Join vertices on open edges that are no further apart than this; auto: than the least distance that hardly leaves more
    /// edges open than larger ones do
    #[arg(long, value_name = "DISTANCE|auto", value_parser = values::welding, allow_hyphen_values = true, help_heading = "Inputs")]
    weld: Vec<Welding>,
    #[command(flatten)]
    pub(crate) results: Results,
}

/// Drawing curves on surfaces.
#[derive(Debug, Args)]
pub(crate) struct Imprint {
    #[command(flatten)]
    pub(crate) from: Files,
    #[command(flatten)]
    repair: Repair,
    #[command(flatten)]
    pub(crate) results: Results,
}

/// Splitting into parts.
#[derive(Debug, Args)]
pub(crate) struct Split {
    #[command(flatten)]
    pub(crate) inputs: Inputs,
    /// Cut by this solid first: what is outside it, inside it, and of it outside the input, with common seams
    #[arg(long, value_name = "FILE", conflicts_with = "groups", help_heading = "Results")]
    pub(crate) by: Option<PathBuf>,
    /// Part by this surface, which may be open but has to pass through: the cells on its sides. May be repeated
    #[arg(long, value_name = "FILE", conflicts_with_all = ["groups", "by"], help_heading = "Results")]
    pub(crate) sheet: Vec<PathBuf>,
    /// The surfaces of the face groups instead of bodies; they are open where groups meet
    #[arg(long, help_heading = "Results")]
    pub(crate) groups: bool,
    /// With --by: each cell's bodies as files of their own
    #[arg(long, requires = "by", help_heading = "Results")]
    pub(crate) explode: bool,
    #[command(flatten)]
    pub(crate) results: Results,
}
