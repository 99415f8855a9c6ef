//! The ZIP package, and which of its parts is the model.

use std::collections::HashMap;
use std::io::{self, BufReader, Cursor, Read};

use quick_xml::events::Event;
use zip::result::ZipError;
use zip::{ZipArchive, read::ZipFile};

use super::super::notes::Notes;
use super::super::{Format, malformed, unsupported};
use super::budget::Budget;
use super::xml;
use crate::Error;

/// Where relationships of the whole package stand.
const RELATIONSHIPS: &str = "/_rels/.rels";

/// What the relationship of a package to its model is called.
const IS_MODEL: &str = "http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel";

/// Text is unpacked by this much, bytes.
const BLOCK: usize = 64 << 10;

/// A package as it lies in memory. Nothing of it is ever written to a file.
pub(super) struct Package<'a> {
    archive: ZipArchive<Cursor<&'a [u8]>>,
    /// The names of all parts, with a slash in front.
    names: Vec<String>,
    /// Their numbers by their names in small letters: names of parts are the same in small and capital ones.
    by_name: HashMap<String, usize>,
}

/// The text of a part while it is unpacked, up to what may be.
pub(super) type PartText<'s, 'a> = BufReader<Metered<'s, ZipFile<'s, Cursor<&'a [u8]>>>>;

impl<'a> Package<'a> {
    pub(super) fn open(bytes: &'a [u8]) -> Result<Self, Error> {
        let archive =
            ZipArchive::new(Cursor::new(bytes)).map_err(|error| zip_error("the package", &error))?;
        let names: Vec<String> = (0..archive.len())
            .map(|index| match archive.name_for_index(index) {
                Some(Ok(name)) => format!("/{}", name.trim_start_matches('/')),
                _ => String::new(),
            })
            .collect();
        let numbered = names.iter().enumerate().rev();
        let by_name = numbered.map(|(index, name)| (name.to_ascii_lowercase(), index)).collect();
        Ok(Self { archive, names, by_name })
    }

    fn find(&self, path: &str) -> Option<usize> {
        self.by_name.get(&path.to_ascii_lowercase()).copied()
    }

    /// The text of a part.
    pub(super) fn open_part<'s>(
        &'s mut self,
        path: &str,
        budget: &'s mut Budget,
    ) -> Result<PartText<'s, 'a>, Error> {
        let missing = || malformed(Format::ThreeMf, path, "the package has no such part; it is incomplete");
        let index = self.find(path).ok_or_else(missing)?;
        budget.release_text();
        let file = self.archive.by_index(index).map_err(|error| zip_error(path, &error))?;
        Ok(BufReader::with_capacity(BLOCK, Metered { inner: file, budget }))
    }

    /// The name of the part that is the model.
    pub(super) fn root(&mut self, budget: &mut Budget, notes: &mut Notes) -> Result<String, Error> {
        if self.find(RELATIONSHIPS).is_some() {
            let part = self.open_part(RELATIONSHIPS, budget)?;
            let text = super::text_of(part, RELATIONSHIPS)?;
            if let Some(target) = model_of(&text)? {
                return part_name(&target, "/")
                    .map_err(|what| malformed(Format::ThreeMf, RELATIONSHIPS, what));
            }
        }
        let mut models = self.names.iter().filter(|name| name.to_ascii_lowercase().ends_with(".model"));
        match (models.next(), models.next()) {
            (Some(only), None) => {
                notes.say("the package does not say which part is its model; its only one is read");
                Ok(only.clone())
            }
            _ => Err(malformed(
                Format::ThreeMf,
                RELATIONSHIPS,
                "the package does not say which part is its model; it is damaged, or an archive of another kind",
            )),
        }
    }

    /// How many parts there are besides models and what describes the package.
    pub(super) fn attachments(&self, models: usize) -> usize {
        let is_known = |name: &str| {
            let name = name.to_ascii_lowercase();
            name.ends_with(".rels")
                || name == "/[content_types].xml"
                || name.ends_with('/')
                || name.is_empty()
        };
        self.names.iter().filter(|name| !is_known(name)).count().saturating_sub(models)
    }
}

/// The target of the relationship to the model.
fn model_of(text: &str) -> Result<Option<String>, Error> {
    let mut reader = quick_xml::Reader::from_str(text);
    loop {
        let event = reader.read_event();
        let place = reader.buffer_position();
        match event.map_err(|error| xml::error(RELATIONSHIPS, place, &error))? {
            Event::Start(element) | Event::Empty(element)
                if element.local_name().as_ref() == "Relationship" =>
            {
                let (mut target, mut is_model) = (None, false);
                for attribute in element.attributes().with_checks(false) {
                    let attribute = attribute.map_err(|e| xml::error(RELATIONSHIPS, place, &e.into()))?;
                    match attribute.key.0 {
                        "Target" => target = Some(xml::value(&attribute, RELATIONSHIPS, place)?.into_owned()),
                        "Type" => is_model = &*attribute.value == IS_MODEL,
                        _ => {}
                    }
                }
                if let Some(target) = target.filter(|_| is_model) {
                    return Ok(Some(target));
                }
            }
            Event::DocType(_) => return Err(xml::doctype(RELATIONSHIPS, place)),
            Event::Eof => return Ok(None),
            _ => {}
        }
    }
}

/// The name of a part as it is referred to from a folder; nothing outside the package has one.
pub(super) fn part_name(target: &str, folder: &str) -> Result<String, String> {
    let path = if target.starts_with('/') { target.to_owned() } else { format!("{folder}{target}") };
    let is_plain = |segment: &str| !segment.is_empty() && segment != "." && segment != "..";
    let is_inside = path[1..].split('/').all(is_plain) && !path.contains(['\\', ':', '\0']);
    if is_inside {
        Ok(path)
    } else {
        Err(format!("{:?} is not the name of a part of the package", short(&path)))
    }
}

/// The beginning of a name, for messages.
fn short(name: &str) -> String {
    name.chars().take(80).collect()
}

/// Reads what may still be unpacked, and keeps count.
pub(super) struct Metered<'b, R> {
    inner: R,
    budget: &'b mut Budget,
}

impl<R> Metered<'_, R> {
    pub(super) fn budget(&mut self) -> &mut Budget {
        self.budget
    }
}

impl<R: Read> Read for Metered<'_, R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.inner.read(buffer)?;
        if self.budget.unpack(count as u64) { Ok(count) } else { Err(io::Error::other("stopped")) }
    }
}

/// The error for a part that cannot be unpacked.
pub(super) fn read_error(path: &str, error: &io::Error) -> Error {
    malformed(Format::ThreeMf, path, format!("cannot be unpacked: {error}; the file is cut off or corrupt"))
}

fn zip_error(place: &str, error: &ZipError) -> Error {
    match error {
        ZipError::UnsupportedArchive(ZipError::PASSWORD_REQUIRED) => {
            unsupported(Format::ThreeMf, format!("{place} is encrypted; save it without a password"))
        }
        ZipError::UnsupportedArchive(what) => {
            unsupported(Format::ThreeMf, format!("{place}: {what}; save it again"))
        }
        ZipError::CompressionMethodNotSupported(method) => unsupported(
            Format::ThreeMf,
            format!(
                "{place} is packed by method {method}; 3MF has stored and deflated parts alone, save it again"
            ),
        ),
        error => malformed(Format::ThreeMf, place, format!("{error}; the file is cut off or corrupt")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_parts_stay_in_the_package() {
        assert_eq!(part_name("3D/a.model", "/").unwrap(), "/3D/a.model");
        assert_eq!(part_name("/3D/a.model", "/").unwrap(), "/3D/a.model");
        for name in ["../a", "/../etc/passwd", "//a", "/a/./b", "a\\b", "http://a/b", "", "/", "/a\0"] {
            assert!(part_name(name, "/").is_err(), "{name}");
        }
    }
}
