//! Where results go: files, standard output, pictures, the report.

use std::fs::{self, File};
use std::io::{IsTerminal as _, Write, stdout};
use std::path::{Path, PathBuf};

use serde_json::{Value, json};
use trisect::io::{self, Format, Written};
use trisect::render::{self, Picture};
use trisect::{Error, Failure, Mesh, Outcome, Solid};

use super::argument_groups::{Colours, Common, Drawing, Up, Writing};
use super::crossings;
use super::documents::{self, Document};
use super::fault::Fault;
use super::json::json_of;
use super::limits::Limits;
use super::stage::{self, Stage};
use super::stream::STANDARD;
use super::stream::is_device;

/// Where one output goes.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Target {
    pub(crate) path: PathBuf,
    kind: Kind,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    /// A file named for its format.
    Mesh(Format),
    /// A file of a format its name does not tell, or contradicts.
    Forced(Format),
    Standard(Format),
    Picture,
    /// A page that shows the mesh in a browser.
    #[cfg(feature = "viewer")]
    Page,
}

impl Target {
    /// The name in messages.
    pub(crate) fn name(&self) -> String {
        if self.path == Path::new(STANDARD) {
            "standard output".into()
        } else {
            self.path.display().to_string()
        }
    }

    /// The same with the file's name ending otherwise, before its extension.
    pub(crate) fn with_suffix(&self, suffix: &str) -> Result<Self, Fault> {
        if suffix.is_empty() {
            return Ok(self.clone());
        }
        if self.path == Path::new(STANDARD) {
            return Err(Fault::usage("several results cannot go to standard output; name a file with -o"));
        }
        let mut name = self.path.file_stem().unwrap_or_default().to_os_string();
        name.push(suffix);
        if let Some(extension) = self.path.extension() {
            name.push(".");
            name.push(extension);
        }
        Ok(Self { path: self.path.with_file_name(name), kind: self.kind })
    }

    /// Whether it is a picture, which holds no mesh.
    pub(crate) fn is_picture(&self) -> bool {
        self.kind == Kind::Picture
    }

    /// Whether the format has coordinates of single precision.
    pub(crate) fn is_single(&self) -> bool {
        match self.kind {
            Kind::Mesh(format) | Kind::Forced(format) | Kind::Standard(format) => {
                matches!(format, Format::Stl | Format::Glb | Format::Gltf)
            }
            #[cfg(feature = "viewer")]
            Kind::Page => true,
            Kind::Picture => false,
        }
    }

    /// The format in lower case, as in JSON.
    pub(crate) fn format(&self) -> String {
        match self.kind {
            Kind::Mesh(format) | Kind::Forced(format) | Kind::Standard(format) => format.extension().into(),
            #[cfg(feature = "viewer")]
            Kind::Page => "html".into(),
            Kind::Picture => "png".into(),
        }
    }
}

/// Where outputs go, as the end of a summary line.
pub(crate) fn arrow(targets: &[Target]) -> String {
    let names: Vec<String> = targets.iter().map(Target::name).collect();
    if names.is_empty() { String::new() } else { format!(" -> {}", names.join(", ")) }
}

/// What is to be written: the mesh, how, and how to draw it.
pub(crate) struct Product<'a> {
    pub(crate) mesh: &'a Mesh,
    pub(crate) options: io::WriteOptions,
    /// Draws the picture, when one is asked for.
    pub(crate) picture: &'a dyn Fn() -> Picture,
    /// What else is written with it.
    pub(crate) documents: &'a [Document],
    /// How a page shows it.
    #[cfg_attr(not(feature = "viewer"), allow(dead_code, reason = "pages are left out"))]
    pub(crate) shown: Shown<'a>,
}

impl Product<'_> {
    /// The solid that a binary file holds, and its mesh as it is written, perhaps elsewhere; if it is known to be one.
    fn known_solid(&self, target: &Target) -> Option<(&Solid, &Mesh)> {
        let (Kind::Mesh(format) | Kind::Forced(format)) = target.kind else { return None };
        let solid = self.shown.outcome.map(Outcome::solid)?;
        let is_it = std::ptr::eq(solid.mesh(), self.mesh) || solid.mesh().triangles == self.mesh.triangles;
        (is_it && !self.options.is_text(format)).then_some((solid, self.mesh))
    }
}

/// How a page shows a mesh.
#[cfg_attr(not(feature = "viewer"), allow(dead_code, reason = "pages are left out"))]
pub(crate) struct Shown<'a> {
    /// The boolean that it is the result of, if it is of one.
    pub(crate) outcome: Option<&'a Outcome>,
    pub(crate) view: render::View,
    pub(crate) colours: Option<Colours>,
}

impl<'a> Shown<'a> {
    /// As pictures of a mesh that was read as `format` are.
    pub(crate) fn new(drawing: &Drawing, format: Option<Format>, outcome: Option<&'a Outcome>) -> Self {
        Self { outcome, view: view(drawing, format), colours: drawing.png_color }
    }
}

/// The outputs a command line asks for.
pub(crate) fn targets(writing: &Writing, drawing: &Drawing, common: &Common) -> Result<Vec<Target>, Fault> {
    let forced = writing.output_format;
    let standard = writing.output.iter().filter(|path| path.as_os_str() == STANDARD).count();
    if standard > 1 {
        return Err(Fault::usage("standard output can be only one of the outputs"));
    }
    if standard == 1 && common.json {
        return Err(Fault::usage("--json and -o - both want standard output; use --report FILE"));
    }
    let mut targets = Vec::new();
    if let Some(path) = writing.output.iter().chain(&drawing.png).find(|path| path.is_dir()) {
        return Err(Fault::usage(format!("{} is a folder; name a file in it", path.display())));
    }
    for path in &writing.output {
        let kind = if path.as_os_str() == STANDARD {
            let format = forced.ok_or_else(|| {
                Fault::usage(
                    "standard output has no name to tell its format; add --output-format, such as \
                     --output-format stl",
                )
            })?;
            refuse_terminal(format, writing.ascii)?;
            Kind::Standard(format)
        } else if let (Some(format), 0) = (forced, standard) {
            if Format::from_path(path) == Some(format) { Kind::Mesh(format) } else { Kind::Forced(format) }
        } else if is_png(path) {
            Kind::Picture
        } else if let Some(page) = page(path) {
            page
        } else {
            Kind::Mesh(Format::from_path(path).ok_or_else(|| unknown_format(path))?)
        };
        targets.push(Target { path: path.clone(), kind });
    }
    targets.extend(drawing.png.iter().map(|path| Target { path: path.clone(), kind: Kind::Picture }));
    for (index, target) in targets.iter().enumerate() {
        let earlier = targets[..index].iter().map(|earlier| &earlier.path);
        if earlier.chain(&common.report).any(|path| *path == target.path) {
            return Err(Fault::usage(format!("{} is named as an output twice", target.name())));
        }
    }
    Ok(targets)
}

fn is_png(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("png"))
}

/// A page, if the name is one's.
#[cfg(feature = "viewer")]
fn page(path: &Path) -> Option<Kind> {
    let extension = path.extension()?;
    let is_page = ["html", "htm"].iter().any(|known| extension.eq_ignore_ascii_case(known));
    is_page.then_some(Kind::Page)
}

#[cfg(not(feature = "viewer"))]
fn page(_path: &Path) -> Option<Kind> {
    None
}

fn unknown_format(path: &Path) -> Fault {
    Fault::usage(format!(
        "cannot tell the format of {} by its name; known endings: {}, png{}; or add --output-format",
        path.display(),
        Format::ALL.map(Format::extension).join(", "),
        if cfg!(feature = "viewer") { ", html" } else { "" }
    ))
}

fn refuse_terminal(format: Format, ascii: bool) -> Result<(), Fault> {
    let binary = match format {
        Format::Glb => true,
        Format::Stl | Format::Ply => !ascii,
        #[cfg(feature = "threemf")]
        Format::ThreeMf => true,
        // Obj, Gltf and Off are text; a new format must be added here if it is not (the enum is open to this program).
        _ => false,
    };
    if binary && stdout().is_terminal() {
        return Err(Fault::usage(format!(
            "standard output is a terminal, and {format} is binary; send it to a file or a pipe{}",
            if matches!(format, Format::Stl | Format::Ply) { ", or add --ascii" } else { "" }
        )));
    }
    Ok(())
}

/// How to write meshes.
pub(crate) fn write_options(writing: &Writing, limits: &Limits) -> io::WriteOptions {
    let mut options = io::WriteOptions::new()
        .control(limits.control())
        .separate(writing.separate)
        .manifold(writing.manifold);
    if writing.ascii {
        options = options.encoding(io::Encoding::Ascii);
    }
    if writing.single {
        options = options.precision(io::Precision::Single);
    }
    options
}

/// Fails early where an output could not be written after a long run.
pub(crate) fn probe(targets: &[Target], limits: &Limits) -> Result<(), Fault> {
    for target in targets {
        if !is_device(&target.path) && !matches!(target.kind, Kind::Standard(_)) {
            Stage::new(&target.path, limits).map_err(|error| Fault::output(&target.path, error))?;
        }
    }
    Ok(())
}

/// Writes every output, and returns a JSON description of each, and warnings. No file changes before all of them
/// are written in full.
pub(crate) fn write_all(
    targets: &[Target],
    product: &Product<'_>,
    limits: &Limits,
) -> Result<(Vec<Value>, Vec<String>), Fault> {
    let mut stages = Vec::new();
    let mut staged = Vec::new();
    let mut warnings = Vec::new();
    let mut sizes = vec![None; targets.len()];
    let mut roundings: Vec<Option<io::Rounding>> = vec![None; targets.len()];
    let (mut streams, mut files) = (Vec::new(), Vec::new());
    for (index, target) in targets.iter().enumerate() {
        let stream = matches!(target.kind, Kind::Standard(_)) || is_device(&target.path);
        if stream { &mut streams } else { &mut files }.push((index, target));
    }
    for (index, target) in files {
        let stage = Stage::new(&target.path, limits).map_err(|error| Fault::output(&target.path, error))?;
        let said = write_file(target, &stage.path(), product).map_err(|error| failed(target, error))?;
        warnings.extend(said_of(target, &said));
        if let Some(rounding) =
            said.rounding.as_ref().filter(|_| matches!(target.kind, Kind::Mesh(_) | Kind::Forced(_)))
        {
            let crossing =
                crossings::in_file(&stage.path(), || product.known_solid(target), rounding, limits)?;
            warnings.extend(crossing.map(|warning| format!("{}: {warning}", target.name())));
        }
        roundings[index] = said.rounding;
        stages.push(stage);
        staged.push(index);
    }
    for document in product.documents {
        stages.extend(documents::staged(document, limits)?);
    }
    for (index, target) in streams {
        match write_stream(target, product).map_err(|error| failed(target, error)) {
            Ok(said) => {
                warnings.extend(said_of(target, &said));
                roundings[index] = said.rounding;
            }
            Err(fault) if fault.is_broken_pipe() => {}
            Err(fault) => return Err(fault),
        }
    }
    for (index, bytes) in staged.iter().zip(stage::commit(&stages, limits)?) {
        sizes[*index] = Some(bytes);
    }
    let described = targets.iter().zip(sizes).zip(roundings).map(|((target, bytes), rounding)| {
        json!({
            "file": target.path.display().to_string(),
            "format": target.format(),
            "bytes": bytes,
            "rounding": rounding.as_ref().map(json_of),
        })
    });
    let described = described.chain(product.documents.iter().map(documents::described));
    Ok((described.collect(), warnings))
}

/// The warnings of an output, with the option that does what the last one advises.
fn said_of(target: &Target, said: &Written) -> Vec<String> {
    let mut warnings: Vec<String> =
        said.warnings.iter().map(|warning| format!("{}: {warning}", target.name())).collect();
    let told = |rounding: &io::Rounding| rounding.finer_at_origin && rounding.differs();
    let finer = said.rounding.as_ref().is_some_and(told);
    if let (Some(last), true) = (warnings.last_mut(), finer) {
        last.push_str(" (--recenter moves it)");
    }
    warnings
}

/// Writes a file in its hidden folder.
fn write_file(target: &Target, path: &Path, product: &Product<'_>) -> Result<Written, Error> {
    match target.kind {
        Kind::Mesh(_) => {
            // Pictures that are beside the output already stay as they are.
            let place = fs::canonicalize(&target.path).unwrap_or_else(|_| target.path.clone());
            let folder = place.parent().unwrap_or(Path::new("")).to_path_buf();
            io::save_report(product.mesh, path, &product.options.clone().destination(folder))
        }
        Kind::Forced(format) | Kind::Standard(format) => {
            let mut file = File::create(path).map_err(|source| file_error(path, source))?;
            io::write_report(product.mesh, format, &mut file, &product.options)
        }
        Kind::Picture => (product.picture)().save_png(path).map(|()| Written::default()),
        #[cfg(feature = "viewer")]
        Kind::Page => {
            let file = File::create(path).map_err(|source| file_error(path, source))?;
            write_page(target, product, &mut std::io::BufWriter::new(file))
        }
    }
}

/// Writes a page, named for its file.
#[cfg(feature = "viewer")]
fn write_page(target: &Target, product: &Product<'_>, out: &mut dyn Write) -> Result<Written, Error> {
    let name = target.path.file_stem().unwrap_or_default().to_string_lossy();
    let written = super::page::write(product.mesh, &product.shown, &name, &product.options, out)?;
    out.flush().map_err(|source| file_error(&target.path, source))?;
    Ok(written)
}

/// Writes to standard output or to a device, which cannot be replaced by a finished file.
fn write_stream(target: &Target, product: &Product<'_>) -> Result<Written, Error> {
    let failed = |source| file_error(&target.path, source);
    let mut out: Box<dyn Write> = match target.kind {
        Kind::Standard(_) => Box::new(stdout().lock()),
        _ => Box::new(File::options().write(true).open(&target.path).map_err(failed)?),
    };
    let written = match target.kind {
        Kind::Mesh(format) | Kind::Forced(format) | Kind::Standard(format) => {
            io::write_report(product.mesh, format, &mut out, &product.options)?
        }
        Kind::Picture => {
            (product.picture)().write_png(&mut out).map_err(failed)?;
            Written::default()
        }
        #[cfg(feature = "viewer")]
        Kind::Page => write_page(target, product, &mut out)?,
    };
    out.flush().map_err(failed)?;
    Ok(written)
}

/// The error, said of the output the user named instead of the file in the hidden folder.
fn failed(target: &Target, error: Error) -> Fault {
    match error {
        Error::File { action, source, .. } => {
            Error::File { action, path: target.path.clone(), source }.into()
        }
        limit if limit.failure() == Failure::Limit => limit.into(),
        other => Fault::from(other).during(&format!("writing {}", target.name())),
    }
}

fn file_error(path: &Path, source: std::io::Error) -> Error {
    Error::File { action: trisect::FileAction::Write, path: path.to_path_buf(), source }
}

/// How the picture of something that was read as `format` is taken.
pub(crate) fn view(drawing: &Drawing, format: Option<Format>) -> render::View {
    let mut view = render::View::default();
    [view.width, view.height] = drawing.png_size;
    view.perspective = !drawing.png_parallel;
    // glTF says so. OBJ does not, but Blender, three.js and MeshLab write and read it so.
    let upright = matches!(format, Some(Format::Gltf | Format::Glb | Format::Obj));
    let usual = if upright { Up::Y } else { Up::Z };
    if drawing.png_up.unwrap_or(usual) == Up::Y {
        let [x, y, z] = view.direction;
        (view.direction, view.up) = ([x, z, -y], [0.0, 1.0, 0.0]);
    }
    view.direction = drawing.view.unwrap_or(view.direction);
    view
}

/// The colours of a picture, unless they are the mesh's own; `operand` tells the operand of each triangle.
pub(crate) fn colours(what: Colours, operand: impl Iterator<Item = usize>) -> Option<Vec<[u8; 3]>> {
    match what {
        Colours::Operand => Some(operand.map(render::palette).collect()),
        Colours::Material => None,
        // No triangle has a colour of its own.
        Colours::None => Some(Vec::new()),
    }
}

/// Writes the report file.
pub(crate) fn write_report(path: &Path, report: &Value, limits: &Limits) -> Result<(), Fault> {
    let failed = |error| Fault::output(path, error);
    let text = format!("{report:#}\n");
    if is_device(path) {
        let mut out = File::options().write(true).open(path).map_err(failed)?;
        return out.write_all(text.as_bytes()).map_err(failed);
    }
    let stage = Stage::new(path, limits).map_err(failed)?;
    fs::write(stage.path(), text).map_err(failed)?;
    stage::replace(&stage, limits)?;
    Ok(())
}
