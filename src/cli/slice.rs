//! `trisect slice`: a picture of a plane section of a model, a mesh's distance, or a formula.

use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use trisect::field::{Expression, Formula, Graph, Section, SectionPicture, SignRule, SignedDistance, System};
use trisect::model::{Evaluation, Model};
use trisect::{Control, Error, Mesh};

/// What is pictured.
#[derive(Clone, Debug)]
pub(crate) enum SliceSource {
    /// A model file.
    Model(PathBuf),
    /// The signed distance of a mesh already read, by a sign rule.
    Mesh(Box<Mesh>, SignRule),
    /// A formula's text.
    Formula(String),
}

/// What is asked of `slice`.
#[derive(Clone, Debug)]
pub(crate) struct SliceRequest {
    pub(crate) source: SliceSource,
    /// Across x, y or z (0, 1, 2).
    pub(crate) axis: usize,
    /// Where along the axis; in the middle of the bounds if not given.
    pub(crate) position: Option<f64>,
    /// The part of space pictured; if not given, the solid's own bounds and a tenth more.
    pub(crate) bounds: Option<[[f64; 3]; 2]>,
    /// Pixels across.
    pub(crate) width: u32,
    /// Step between lines of equal value.
    pub(crate) bands: Option<f64>,
}

/// Draws the section.
pub(crate) fn slice(request: &SliceRequest, control: &Control) -> Result<SectionPicture, Error> {
    let (field, own_bounds) = field(&request.source, control)?;
    let bounds = match (request.bounds, own_bounds) {
        (Some(bounds), _) => bounds,
        (None, Some([low, high])) => {
            let room = (0..3).map(|axis| high[axis] - low[axis]).fold(0.0, f64::max) * 0.1;
            [low.map(|x| x - room), high.map(|x| x + room)]
        }
        (None, None) => {
            let found = field.positive_bounds(None, control)?;
            found.ok_or_else(|| {
                Error::Field("the field is positive nowhere: say which part to picture".into())
            })?
        }
    };
    let middle = |axis: usize| (bounds[0][axis] + bounds[1][axis]) / 2.0;
    let position = request.position.unwrap_or_else(|| middle(request.axis.min(2)));
    let section = Section::across(request.axis, position, bounds[0], bounds[1])?;
    SectionPicture::of(&field, &section, request.width, request.bands, control)
}

type Bounds = Option<[[f64; 3]; 2]>;

fn field(source: &SliceSource, control: &Control) -> Result<(Expression, Bounds), Error> {
    match source {
        SliceSource::Model(path) => {
            let model = Model::load(path)?;
            let evaluation = Evaluation::new().control(control.clone());
            Ok((evaluation.field(&model)?, evaluation.bounds(&model)?))
        }
        SliceSource::Mesh(mesh, rule) => {
            let distance = SignedDistance::of_mesh(mesh, *rule);
            let bounds = distance.tree().bounds();
            let mut graph = Graph::new();
            let root = graph.leaf(Arc::new(distance));
            Ok((Expression::new(graph, root), bounds))
        }
        SliceSource::Formula(text) => {
            let field = Formula::parse(text)?.compile(System::default(), &[], &[])?;
            Ok((field, None))
        }
    }
}

/// Writes the picture beside its place first, so that a failure leaves no half of it.
pub(crate) fn write(picture: &SectionPicture, path: &Path) -> Result<(), Error> {
    let fault = |action: &'static str| move |source| Error::File { action, path: path.to_owned(), source };
    let mut name = path.as_os_str().to_owned();
    name.push(".part");
    let part = PathBuf::from(name);
    let written = std::fs::File::create(&part).and_then(|file| {
        let mut writer = BufWriter::new(file);
        picture.write_png(&mut writer)?;
        writer.flush()
    });
    let result = match written {
        Ok(()) => std::fs::rename(&part, path).map_err(fault("replace")),
        Err(error) => Err(fault("write")(error)),
    };
    if result.is_err() {
        // Nothing more can be done about a file that cannot be removed.
        let _ = std::fs::remove_file(&part);
    }
    result
}
