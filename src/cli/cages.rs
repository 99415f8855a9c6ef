//! Cages as files: reading, moving to their place, writing, drawing.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use clap::ArgMatches;
use trisect::render::Picture;
use trisect::subdivision::{ControlMesh, LimitMesh};
use trisect::{Error, Mesh};

use super::argument_groups::Drawing;
use super::cage_arguments::Cages;
use super::documents::Document;
use super::fault::Fault;
use super::output;
use super::reading;
use super::requests::{self, Request};
use super::session::Session;
use super::stream::STANDARD;
use super::transforms::Transform;

/// A cage that was read.
pub(crate) struct Read {
    pub(crate) cage: ControlMesh,
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

fn one(request: &Request, choice: Cages, session: &Session<'_>) -> Result<(ControlMesh, Vec<String>), Error> {
    let text = reading::text(&request.path, &session.limits)?;
    let rules = choice.rules.rules();
    let is_json =
        has_ending(&request.path, "json") || (request.is_standard() && text.trim_start().starts_with('{'));
    let (mut cage, warnings) = if is_json {
        (ControlMesh::from_json(text.as_bytes())?, Vec::new())
    } else if has_ending(&request.path, "obj") || request.is_standard() {
        ControlMesh::from_obj(text.as_bytes(), rules)?
    } else {
        return Err(Error::InvalidArgument(
            "a cage is read from *.obj or *.json; `convert` makes an OBJ of other meshes".into(),
        ));
    };
    if !request.transforms.is_empty() {
        // Details turn with the surface, but keep their lengths: a cage that is scaled loses them first.
        if request.transforms.iter().any(Transform::is_repetition) {
            let what = "a cage cannot be repeated by --pattern: repeat the mesh that `subdivide` makes of it";
            return Err(Error::InvalidArgument(what.into()));
        }
        if !request.transforms.iter().all(Transform::is_rigid) {
            cage = cage.subdivided(0)?;
        }
        let mut mesh = cage.mesh();
        for transform in &request.transforms {
            mesh = transform.apply(mesh, &session.control())?;
        }
        // A reflection turns the faces over: the mesh has done that already.
        let details = cage.details().to_vec();
        cage = ControlMesh::new(mesh.positions, mesh.triangles, cage.tags().clone(), cage.rules())?
            .with_details(details)?;
    }
    if let Some(degrees) = choice.creases_from_angle {
        cage = cage.with_creases_from_angle(degrees)?;
    }
    Ok((cage, warnings))
}

fn has_ending(path: &Path, ending: &str) -> bool {
    path.extension().is_some_and(|known| known.eq_ignore_ascii_case(ending))
}

/// Whether an output gets the cage rather than the limit surface.
pub(crate) fn holds_cage(path: &Path) -> bool {
    has_ending(path, "obj") || has_ending(path, "json")
}

/// The cage as a file, by its name's ending.
pub(crate) fn document(path: &Path, cage: &ControlMesh) -> Result<Document, Fault> {
    let json = has_ending(path, "json");
    if !json && !cage.details().is_empty() {
        return Err(Fault::unusable(format!(
            "{}: OBJ has no details, and the result has {} levels of them; write *.json, or subdivide it (--flatten)",
            path.display(),
            cage.details().len()
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
pub(crate) fn picture(cage: &ControlMesh, drawing: &Drawing) -> Result<Picture, Error> {
    let fine: LimitMesh = cage.limit_mesh_of_steps(PICTURE_STEPS)?;
    let mut mesh = fine.mesh().clone();
    let mut colours = vec![SURFACE; mesh.triangles.len()];
    let mut view = output::view(drawing, None);
    view.edges = false;
    if let Some(bounds) = mesh.bounds() {
        view.frame = Some([bounds.low, bounds.high]);
        let length: f64 = (0..3).map(|k| (bounds.high[k] - bounds.low[k]).powi(2)).sum::<f64>().sqrt();
        let creases: BTreeSet<[u32; 2]> = cage.tags().creases.iter().map(|crease| crease.edge).collect();
        let mut seen = BTreeSet::new();
        for face in cage.faces() {
            for k in 0..3 {
                let (u, v) = (face[k], face[(k + 1) % 3]);
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
