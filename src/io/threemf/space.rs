//! Namespaces of 3MF, and which of them are understood.

use std::collections::HashMap;

use super::super::{Format, unsupported};
use crate::Error;

/// The core specification.
pub(super) const CORE: &str = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02";
/// Colours of triangles.
pub(super) const MATERIALS: &str = "http://schemas.microsoft.com/3dmanufacturing/material/2015/02";
/// Models in several parts.
pub(super) const PRODUCTION: &str = "http://schemas.microsoft.com/3dmanufacturing/production/2015/06";
/// Named sets of triangles.
pub(super) const TRIANGLE_SETS: &str = "http://schemas.microsoft.com/3dmanufacturing/trianglesets/2021/07";

/// Which specification an element belongs to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Space {
    Core,
    Materials,
    Production,
    TriangleSets,
    /// One that is not understood, by what it is about.
    Other(&'static str),
    #[default]
    Unknown,
}

impl Space {
    fn of(uri: &str) -> Self {
        match uri {
            CORE => Self::Core,
            MATERIALS => Self::Materials,
            PRODUCTION => Self::Production,
            TRIANGLE_SETS => Self::TriangleSets,
            uri => {
                let known = [
                    ("/beamlattice/", "beam lattices"),
                    ("/slice/", "slices"),
                    ("/securecontent/", "encrypted parts"),
                    ("/volumetric/", "volumetric data"),
                    ("/implicit/", "implicit surfaces"),
                    ("/booleanoperations/", "boolean operations"),
                    ("/displacement/", "displaced surfaces"),
                    ("/mirroring/", "mirrored meshes"),
                ];
                let about = known.into_iter().find(|(part, _)| uri.contains(part));
                about.map_or(Self::Unknown, |(_, what)| Self::Other(what))
            }
        }
    }
}

/// Prefixes and what they stand for. They are taken from wherever they are declared: files declare them at the root.
#[derive(Default)]
pub(super) struct Spaces {
    /// That of names without a prefix.
    default: Space,
    by_prefix: HashMap<String, Space>,
}

/// More prefixes are not noted.
const MOST_PREFIXES: usize = 256;

impl Spaces {
    /// Takes over an attribute, if it declares a namespace.
    pub(super) fn declare(&mut self, key: &str, uri: &str) {
        if key == "xmlns" {
            self.default = Space::of(uri);
        } else if let Some(prefix) = key.strip_prefix("xmlns:")
            && self.by_prefix.len() < MOST_PREFIXES
        {
            self.by_prefix.insert(prefix.to_owned(), Space::of(uri));
        }
    }

    /// The namespace and the local part of the name of an element.
    #[inline]
    pub(super) fn of<'n>(&self, name: &'n str) -> (Space, &'n str) {
        match name.split_once(':') {
            None => (self.default, name),
            Some((prefix, local)) => (self.by_prefix.get(prefix).copied().unwrap_or_default(), local),
        }
    }

    /// Whether an attribute is one of production, by its local name.
    pub(super) fn is_production(&self, key: &str, local: &str) -> bool {
        key.split_once(':').is_some_and(|(prefix, name)| {
            name == local && self.by_prefix.get(prefix) == Some(&Space::Production)
        })
    }

    /// Makes sure that the extensions a model requires, a list of prefixes, are understood.
    pub(super) fn check_required(&self, list: &str) -> Result<(), Error> {
        for prefix in list.split_ascii_whitespace() {
            let what = match self.by_prefix.get(prefix) {
                Some(Space::Core | Space::Materials | Space::Production | Space::TriangleSets) => continue,
                Some(Space::Other(what)) => (*what).to_owned(),
                Some(Space::Unknown) | None => {
                    format!("the extension {:?}", prefix.chars().take(40).collect::<String>())
                }
            };
            return Err(unsupported(
                Format::ThreeMf,
                format!("the model needs {what}, which are not read; export it as a plain mesh"),
            ));
        }
        Ok(())
    }
}
