//! The names in a file as a tree, and which triangle is under which.

use rustc_hash::FxHashMap;

use crate::FaceGroups;

/// Stands for no entry.
pub(super) const NOWHERE: u32 = u32::MAX;

/// The named parts of a file: nodes of a scene, objects with their groups, solids.
#[derive(Clone, Debug, Default)]
pub(super) struct Outline {
    /// Parents stand before their children.
    pub(super) entries: Vec<Entry>,
    /// For every triangle the innermost entry it is under, or `NOWHERE`; empty if there are no entries.
    pub(super) of_triangle: Vec<u32>,
}

/// A name, and the entry it stands under.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Entry {
    pub(super) name: String,
    pub(super) parent: Option<u32>,
}

impl Outline {
    /// The outline of a mesh whose groups are named by paths, "object/group".
    pub(super) fn of_groups(groups: &FaceGroups) -> Self {
        let mut outline = Self::default();
        let mut known: FxHashMap<(u32, &str), u32> = FxHashMap::default();
        let mut of_group = Vec::with_capacity(groups.list.len());
        for group in &groups.list {
            let mut at = NOWHERE;
            for name in group.name.split('/').filter(|name| !name.is_empty()) {
                at = *known
                    .entry((at, name))
                    .or_insert_with(|| outline.add(name, (at != NOWHERE).then_some(at)));
            }
            of_group.push(at);
        }
        let entry = |&group: &u32| of_group.get(group as usize).copied().unwrap_or(NOWHERE);
        outline.of_triangle = groups.of_triangle.iter().map(entry).collect();
        outline
    }

    /// A new entry, and its number.
    pub(super) fn add(&mut self, name: &str, parent: Option<u32>) -> u32 {
        self.entries.push(Entry { name: name.to_owned(), parent });
        self.entries.len() as u32 - 1
    }

    /// For every entry the number of triangles under it.
    pub(super) fn counts(&self) -> Vec<usize> {
        let mut counts = vec![0; self.entries.len()];
        for &entry in self.of_triangle.iter().filter(|&&entry| entry != NOWHERE) {
            counts[entry as usize] += 1;
        }
        for entry in (0..counts.len()).rev() {
            if let Some(parent) = self.entries[entry].parent {
                counts[parent as usize] += counts[entry];
            }
        }
        counts
    }
}
