//! Which group and material each triangle belongs to.

use std::collections::HashMap;
use std::path::Path;

use super::super::notes::Notes;
use super::super::scan::{decode, quote};
use super::library;
use super::parse::{Change, Kind};
use crate::{Error, FaceGroup, FaceGroups, Material};

/// The material of faces without one, after faces that have one: OBJ has no statement for it. Blender's word.
pub(super) const NO_MATERIAL: &str = "(null)";

/// The state of `o`, `g` and `usemtl` along the file, and the runs of triangles under each.
#[derive(Debug, Default)]
pub(super) struct Groups<'a> {
    object: &'a [u8],
    group: &'a [u8],
    material: &'a [u8],
    /// Where each run begins, and its index in `keys`.
    runs: Vec<(usize, u32)>,
    keys: Vec<Key<'a>>,
    known: HashMap<Key<'a>, u32>,
    libraries: Vec<&'a [u8]>,
    materials: library::Materials,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
struct Key<'a> {
    object: &'a [u8],
    group: &'a [u8],
    material: &'a [u8],
}

impl<'a> Groups<'a> {
    /// Takes over a change that applies from triangle `at` on.
    pub(super) fn change(&mut self, change: &Change<'a>, at: usize) {
        match change.kind {
            Kind::Object => (self.object, self.group) = (change.name, b""),
            Kind::Group => self.group = change.name,
            Kind::Material if change.name == NO_MATERIAL.as_bytes() => self.material = b"",
            Kind::Material => self.material = change.name,
        }
        let key = Key { object: self.object, group: self.group, material: self.material };
        if self.runs.is_empty() && at > 0 {
            self.intern(Key { object: b"", group: b"", material: b"" }, 0);
        }
        self.runs.pop_if(|run| run.0 == at);
        self.intern(key, at);
    }

    fn intern(&mut self, key: Key<'a>, at: usize) {
        let keys = &mut self.keys;
        let index = *self.known.entry(key).or_insert_with(|| {
            keys.push(key);
            keys.len() as u32 - 1
        });
        self.runs.push((at, index));
    }

    /// Reads the material libraries that an `mtllib` statement names, each once.
    pub(super) fn add_library(&mut self, names: &'a [u8], folder: Option<&Path>, notes: &mut Notes) {
        if names.is_empty() || self.libraries.contains(&names) {
            return;
        }
        if self.libraries.len() == library::MOST {
            notes.add("material library not read, there are too many", 1);
            return;
        }
        self.libraries.push(names);
        library::read(names, folder, &mut self.materials, notes);
    }

    /// The groups of `triangles` triangles. Their names may take `room` bytes; a long name with many groups and
    /// materials under it could take the square of the file's size.
    pub(super) fn finish(
        self,
        triangles: usize,
        mut room: usize,
        notes: &mut Notes,
    ) -> Result<FaceGroups, Error> {
        let ends = self.runs.iter().skip(1).map(|run| run.0).chain([triangles]);
        let runs: Vec<(usize, usize, u32)> = self
            .runs
            .iter()
            .zip(ends)
            .map(|(&(start, key), end)| (start, end, key))
            .filter(|(start, end, _)| start < end)
            .collect();
        let mut groups = FaceGroups::default();
        // Groups without a triangle are left out; the others are numbered as they first occur.
        let mut numbers = vec![u32::MAX; self.keys.len()];
        let mut missing: Vec<&[u8]> = Vec::new();
        for &(start, end, key) in &runs {
            let number = &mut numbers[key as usize];
            if *number == u32::MAX {
                *number = groups.list.len() as u32;
                let key = self.keys[key as usize];
                let length = key.object.len() + key.group.len() + key.material.len();
                room = room.checked_sub(length).ok_or_else(|| Error::TooLarge {
                    what: "the names of the OBJ file's groups, each with object and material, take more room than \
                           the file"
                        .to_string(),
                })?;
                let material = (!key.material.is_empty()).then(|| {
                    let name = decode(key.material);
                    let known = self.materials.get(&name);
                    if known.is_none() && !missing.contains(&key.material) && missing.len() < 4 {
                        missing.push(key.material);
                    }
                    let base_color = library::base_color(known.and_then(Option::as_deref));
                    Material::plain(name, base_color)
                });
                groups.list.push(FaceGroup { name: name_of(key), material });
            }
            if start == 0 {
                groups.of_triangle.reserve_exact(triangles);
            }
            groups.of_triangle.resize(end, *number);
        }
        if groups.list.len() <= 1 && groups.list.iter().all(|group| *group == FaceGroup::default()) {
            return Ok(FaceGroups::default());
        }
        if !self.materials.is_empty() {
            for name in missing {
                notes.say(format!("material {} is in no material library; it is white", quote(name)));
            }
        }
        Ok(groups)
    }
}

/// "object", "group", or "object/group" where both are given and differ.
fn name_of(key: Key<'_>) -> String {
    let (object, group) = (decode(key.object), decode(key.group));
    if object.is_empty() || object == group {
        group
    } else if group.is_empty() {
        object
    } else {
        format!("{object}/{group}")
    }
}
