//! 3MF, the format of slicers: a ZIP package with models in XML. The core specification with its triangle sets, colours of the
//! materials extension, and models in several files of the production extension.
//!
//! The crates `zip` and `quick-xml` take packages and XML apart. (`threemf2` and `lib3mf` have types for all extensions, but hold a whole
//! model as objects, and the text of a file besides, for which they reserve what the file says it needs.)

mod budget;
mod flatten;
mod model;
mod package;
mod parse;
mod space;
mod write;
mod xml;

pub(super) use write::write;

use std::io::Read as _;

use super::finish::check_finite;
use super::notes::Notes;
use super::{Contents, Format, ReadOptions};
use crate::{Error, Mesh};
use budget::Budget;
use model::Document;
use package::Package;

/// Smaller files may take this much all the same, bytes.
const SMALLEST_LIMIT: u64 = 64 << 20;

/// Reads the mesh that the build items of a package show, in millimetres, with what it holds besides and the warnings.
pub(super) fn read(bytes: &[u8], options: &ReadOptions) -> Result<(Mesh, Contents, Vec<String>), Error> {
    let mut notes = Notes::default();
    let mut budget = Budget::new(bytes.len() as u64, options);
    let mut package = Package::open(bytes)?;
    let root = package.root(&mut budget, &mut notes)?;
    let mut document = Document::default();
    document.path(&root);
    // Components may stand in further models, which are noted where they are named.
    while let Some(path) = document.paths.get(document.models.len()).cloned() {
        let text = package.open_part(&path, &mut budget)?;
        let model = parse::model(text, &path, &mut document, &mut notes)?;
        document.models.push(model);
    }
    let contents = Contents {
        metadata: document.metadata,
        attachments: package.attachments(document.paths.len()),
        ..Contents::default()
    };
    let mut mesh = flatten::flatten(&document, &mut budget, &mut notes)?;
    check_finite(&mut mesh, Format::ThreeMf, &mut notes, |vertex| format!("vertex {vertex} of the build"))?;
    Ok((mesh, contents, notes.into_warnings(|offset| format!("byte {offset}"))))
}

/// The text of a small part of a package.
fn text_of(mut part: package::PartText<'_, '_>, path: &str) -> Result<String, Error> {
    let mut text = String::new();
    match part.read_to_string(&mut text) {
        Ok(_) => Ok(text),
        Err(error) => {
            Err(part.get_mut().budget().take_fault().unwrap_or_else(|| package::read_error(path, &error)))
        }
    }
}

#[cfg(test)]
mod tests;
