//! Cages as files: reading, moving to their place, writing, drawing.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use clap::ArgMatches;
use trisect::io::{Contents, Format};
use trisect::render::Picture;
use trisect::subdivision::{Cage, Rules, Scheme};
use trisect::{Control, Error, Mesh};

use super::argument_groups::Drawing;
use super::cage_arguments::{Cages, SchemeChoice};
use super::documents::Document;
use super::fault::Fault;
use super::limits::Limits;
use super::output;
use super::reading::{self, Input};
use super::requests::{self, Request};
use super::session::Session;
use super::shapes;
use super::stream::STANDARD;
use super::transforms::Transform;

/// A cage that was read.
pub(crate) struct Read {
    pub(crate) cage: Cage,
    pub(crate) name: String,
}

/// Reads all cages of the command line, each at its place.
pub(crate) fn read(
    matches: &ArgMatches,
    choice: Cages,
    session: &mut Session<'_>,
) -> Result<Vec<Read>, Fault> {
    let requests = requests::placed_requests(matches)?;
    let mut cages = Vec::new();
    for (index, request) in requests.iter().enumerate() {
        let (cage, warnings) =
            one(request, choice, session).map_err(|error| error.of_operand(index, request.name()))?;
        for warning in warnings {
            session.warn(format!("{}: {warning}", request.name()));
        }
        cages.push(Read { cage, name: request.name() });
    }
    Ok(cages)
}

fn one(request: &Request, choice: Cages, session: &Session<'_>) -> Result<(Cage, Vec<String>), Error> {
    if request.is_cage() {
        let what = "--subdivide is for inputs of other verbs: here every input is a cage";
        return Err(Error::InvalidArgument(what.into()));
    }
    let scheme = choice.scheme.map(SchemeChoice::scheme);
    let (cage, warnings) = load(request, choice.rules.rules(), scheme, &session.limits)?;
    let mut cage = moved(cage, &request.transforms, &session.control())?;
    if let Some(degrees) = choice.creases_from_angle {
        cage = cage.with_creases_from_angle(degrees)?;
    }
    Ok((cage, warnings))
}

/// A cage as its file has it, and warnings.
fn load(
    request: &Request,
    rules: Rules,
    scheme: Option<Scheme>,
    limits: &Limits,
) -> Result<(Cage, Vec<String>), Error> {
    if let Some(part) = &request.part {
        return Err(Error::InvalidArgument(format!("a cage is a whole file, and not its part `{part}`")));
    }
    let path = &request.path;
    if has_ending(path, "glb") || has_ending(path, "gltf") {
        return Ok((Cage::from_gltf(&reading::file(path, limits)?)?, Vec::new()));
    }
    let is_known = request.is_standard() || has_ending(path, "obj") || has_ending(path, "json");
    if !is_known || request.chosen.as_ref().is_some_and(|_| shapes::named(path).is_some()) {
        return Err(Error::InvalidArgument(
            "a cage is read from *.obj, *.json, or a *.glb that has one; `convert` makes an OBJ of other meshes, with the \
             polygons of their files"
                .into(),
        ));
    }
    let text = reading::text(path, limits)?;
    if has_ending(path, "json") || (request.is_standard() && text.trim_start().starts_with('{')) {
        return Ok((Cage::from_json(text.as_bytes())?, Vec::new()));
    }
    Cage::from_obj(text.as_bytes(), rules, scheme)
}

/// A cage after transforms.
fn moved(cage: Cage, transforms: &[Transform], control: &Control) -> Result<Cage, Error> {
    if transforms.is_empty() {
        return Ok(cage);
    }
    if transforms.iter().any(Transform::is_repetition) {
        let what = "a cage cannot be repeated by --pattern: repeat the mesh that `subdivide` makes of it, or put --subdivide \
                    before --pattern";
        return Err(Error::InvalidArgument(what.into()));
    }
    // Control points alone are moved: what makes a mesh of a cage would leave out polygons.
    let points = |positions: &[[f64; 3]]| {
        let mesh = Mesh::new(positions.to_vec(), Vec::new());
        Ok(reading::moved(mesh, transforms, control)?.positions)
    };
    let reflects = transforms.iter().filter(|transform| transform.reflects()).count() % 2 == 1;
    cage.moved(points, reflects, transforms.iter().all(Transform::is_rigid))
}

/// An input with `--subdivide`: transforms before it move the cage, those after it the triangles of its surface.
pub(crate) fn input(request: &Request, limits: &Limits, control: &Control) -> Result<Option<Input>, Error> {
    let found = request.transforms.iter().enumerate().find_map(|(at, transform)| match transform {
        Transform::Subdivide(smoothing) => Some((at, smoothing)),
        _ => None,
    });
    let Some((at, smoothing)) = found else { return Ok(None) };
    let (before, after) = (&request.transforms[..at], &request.transforms[at + 1..]);
    if after.iter().any(|transform| matches!(transform, Transform::Subdivide(_))) {
        return Err(Error::InvalidArgument("--subdivide is given twice".into()));
    }
    let (cage, warnings) = load(request, smoothing.rules.unwrap_or_default(), smoothing.scheme, limits)?;
    let cage = moved(cage, before, control)?;
    control.check()?;
    let mesh = reading::moved(smoothing.mesh(&cage)?, after, control)?;
    let bytes = size_of_val(&*mesh.positions) + size_of_val(&*mesh.triangles);
    let reserved = control.reserve(bytes as u64)?;
    let is_gltf = has_ending(&request.path, "glb") || has_ending(&request.path, "gltf");
    let format = if is_gltf { Format::Glb } else { Format::Obj };
    Ok(Some(Input { mesh, format, warnings, contents: Contents::default(), reserved }))
}

/// The length of the diagonal of a cage's bounds; 1 of a cage that is a point.
pub(crate) fn diagonal(cage: &Cage) -> f64 {
    let bounds = Mesh::new(cage.positions().to_vec(), Vec::new()).bounds();
    let length = bounds
        .map_or(1.0, |bounds| (0..3).map(|k| (bounds.high[k] - bounds.low[k]).powi(2)).sum::<f64>().sqrt());
    if length > 0.0 { length } else { 1.0 }
}

fn has_ending(path: &Path, ending: &str) -> bool {
    path.extension().is_some_and(|known| known.eq_ignore_ascii_case(ending))
}

/// Whether an output gets the cage rather than the limit surface.
pub(crate) fn holds_cage(path: &Path) -> bool {
    has_ending(path, "obj") || has_ending(path, "json")
}

/// The cage as a file, by its name's ending.
pub(crate) fn document(path: &Path, cage: &Cage) -> Result<Document, Fault> {
    let json = has_ending(path, "json");
    let levels = match cage {
        Cage::Loop(cage) => cage.details().len(),
        _ => 0,
    };
    if !json && levels > 0 {
        return Err(Fault::unusable(format!(
            "{}: OBJ has no details, and the result has {} levels of them; write *.json, or subdivide it (--flatten)",
            path.display(),
            levels
        )));
    }
    let mut text = if json { cage.to_json() } else { cage.to_obj() };
    if json {
        text.push('\n');
    }
    Ok(Document {
        path: path.to_path_buf(),
        format: if json { "json" } else { "obj" },
        bytes: text.into_bytes(),
    })
}

/// Outputs that get a cage, and the others.
pub(crate) fn sorted(outputs: &[PathBuf]) -> Result<(Vec<PathBuf>, Vec<PathBuf>), Fault> {
    if outputs.iter().any(|path| path == Path::new(STANDARD)) {
        return Err(Fault::usage("a cage is written to files: -o FILE.obj or -o FILE.json"));
    }
    Ok(outputs.iter().cloned().partition(|path| holds_cage(path)))
}

/// Steps of the limit surface in pictures.
const PICTURE_STEPS: usize = 3;
/// Widths of cage lines in pictures, over the diagonal: edges, and creases.
const WIDTHS: [f64; 2] = [0.001, 0.0025];
const COLOURS: [[u8; 3]; 2] = [[70, 88, 120], [214, 40, 32]];
const SURFACE: [u8; 3] = [196, 203, 212];

/// The cage's lines over its shaded limit surface, creases red.
pub(crate) fn picture(cage: &Cage, drawing: &Drawing) -> Result<Picture, Error> {
    let mut mesh = cage.limit_mesh_of_steps(PICTURE_STEPS)?;
    let mut colours = vec![SURFACE; mesh.triangles.len()];
    let mut view = output::view(drawing, None);
    view.edges = false;
    if let Some(bounds) = mesh.bounds() {
        view.frame = Some([bounds.low, bounds.high]);
        let length: f64 = (0..3).map(|k| (bounds.high[k] - bounds.low[k]).powi(2)).sum::<f64>().sqrt();
        let creases: BTreeSet<[u32; 2]> = cage.tags().creases.iter().map(|crease| crease.edge).collect();
        let mut seen = BTreeSet::new();
        for face in cage.faces() {
            for k in 0..face.len() {
                let (u, v) = (face[k], face[(k + 1) % face.len()]);
                let edge = [u.min(v), u.max(v)];
                if seen.insert(edge) {
                    let kind = usize::from(creases.contains(&edge));
                    let ends = edge.map(|v| cage.positions()[v as usize]);
                    let added = add_bar(&mut mesh, ends, WIDTHS[kind] * length);
                    colours.extend(std::iter::repeat_n(COLOURS[kind], added));
                }
            }
        }
    }
    Ok(trisect::render::mesh(&mesh, &view, Some(&colours)))
}

/// A bar with three sides between two points; how many triangles it has.
fn add_bar(mesh: &mut Mesh, [p, q]: [[f64; 3]; 2], width: f64) -> usize {
    let along: [f64; 3] = std::array::from_fn(|k| q[k] - p[k]);
    let length = along.iter().map(|x| x * x).sum::<f64>().sqrt();
    if length == 0.0 {
        return 0;
    }
    let along = along.map(|x| x / length);
    let least = (0..3).min_by(|&i, &j| along[i].abs().total_cmp(&along[j].abs())).unwrap_or(0);
    let mut other = [0.0; 3];
    other[least] = 1.0;
    let cross = |a: [f64; 3], b: [f64; 3]| {
        [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    };
    let x = cross(along, other);
    let norm = x.iter().map(|x| x * x).sum::<f64>().sqrt();
    let x = x.map(|value| value / norm);
    let y = cross(along, x);
    let first = mesh.positions.len() as u32;
    for end in [p, q] {
        for i in 0..3 {
            let (sine, cosine) = (std::f64::consts::TAU * f64::from(i) / 3.0).sin_cos();
            mesh.positions.push(std::array::from_fn(|k| end[k] + width * (x[k] * cosine + y[k] * sine)));
        }
    }
    for i in 0..3 {
        let j = (i + 1) % 3;
        mesh.triangles.push([first + i, first + j, first + 3 + i]);
        mesh.triangles.push([first + j, first + 3 + j, first + 3 + i]);
    }
    6
}
