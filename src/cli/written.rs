//! A mesh that a verb has made, written to all outputs.

use serde_json::Value;
use trisect::io::{Format, WriteOptions};
use trisect::{Mesh, Outcome};

use super::argument_groups::{Colours, Drawing, Writing};
use super::documents::Document;
use super::fault::Fault;
use super::output::{self, Product, Shown, Target};
use super::recenter;
use super::session::Session;

/// A mesh with what tells how it is written and drawn.
pub(crate) struct Written<'a> {
    pub(crate) mesh: &'a Mesh,
    pub(crate) options: WriteOptions,
    /// The format of the first input, which tells what is up in pictures.
    pub(crate) format: Option<Format>,
    /// The colours of pictures where none are asked for.
    pub(crate) usual: Colours,
    /// The operand of a triangle.
    pub(crate) operand: &'a dyn Fn(usize) -> usize,
    /// The boolean that it is the result of, if it is of one.
    pub(crate) outcome: Option<&'a Outcome>,
    /// What else is written with it.
    pub(crate) documents: &'a [Document],
}

impl<'a> Written<'a> {
    /// A mesh in the colours of its materials.
    pub(crate) fn new(mesh: &'a Mesh, options: WriteOptions, format: Option<Format>) -> Self {
        Self {
            mesh,
            options,
            format,
            usual: Colours::Material,
            operand: &|_| 0,
            outcome: None,
            documents: &[],
        }
    }

    /// Writes it; returns what the report says of the files.
    pub(crate) fn to(
        self,
        targets: &[Target],
        writing: &Writing,
        drawing: &Drawing,
        session: &mut Session<'_>,
    ) -> Result<Vec<Value>, Fault> {
        let Self { mesh, options, format, usual, operand, outcome, documents } = self;
        let mesh = recenter::placed(mesh, writing, session);
        let mesh = mesh.as_ref();
        let picture = || {
            let operands = (0..mesh.triangles.len()).map(operand);
            let colours = output::colours(drawing.png_color.unwrap_or(usual), operands);
            trisect::render::mesh(mesh, &output::view(drawing, format), colours.as_deref())
        };
        let shown = Shown::new(drawing, format, outcome);
        let product = Product { mesh, options, picture: &picture, documents, shown };
        let (outputs, warnings) = output::write_all(targets, &product, &session.limits)?;
        warnings.into_iter().for_each(|warning| session.warn(warning));
        Ok(outputs)
    }
}
