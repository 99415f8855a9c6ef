//! Parts of a file by name: nodes of glTF, objects and groups of OBJ, solids of ASCII STL.

use std::path::Path;

use rustc_hash::FxHashMap;

use super::outline::{NOWHERE, Outline};
use super::{Format, FormatError, Loaded, ReadOptions, file, gltf, read};
use crate::mesh::Attribute;
use crate::{Error, Mesh};

/// This many names are told where one is not found.
const NEAREST: usize = 5;

/// A file with the names of its parts.
///
/// ```
/// use trisect::io::{self, Format, ReadOptions};
///
/// let text = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\no base\nf 1 3 2\nf 1 2 4\no cut_0\nf 2 3 4\no cut_1\nf 1 4 3\n";
/// let parts = io::read_parts(text, Format::Obj, &ReadOptions::new())?;
/// let names: Vec<String> = parts.names().into_iter().map(|part| part.name).collect();
/// assert_eq!(names, ["base", "cut_0", "cut_1"]);
/// assert_eq!(parts.select("base")?[0].mesh.triangles.len(), 2);
/// assert_eq!(parts.select("cut_*")?.len(), 2);
/// assert!(parts.select("bsae").unwrap_err().to_string().contains("base"));
/// # Ok::<(), trisect::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Parts {
    /// The whole file.
    pub whole: Loaded,
    outline: Outline,
}

/// A part of a file.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Part {
    /// Its own name.
    pub name: String,
    /// Its triangles, in the order of the file, with the vertices they use.
    pub mesh: Mesh,
}

/// The name of a part.
#[derive(Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct PartName {
    /// Its own name.
    pub name: String,
    /// How many names it stands under.
    pub depth: usize,
    /// Triangles in it and in what stands under it.
    pub triangles: usize,
}

/// Reads a file as [`read`] does, with the names of its parts. Takes about 4 bytes a triangle and 40 a name more.
///
/// # Errors
/// Those of [`read`].
pub fn read_parts(bytes: &[u8], format: Format, options: &ReadOptions) -> Result<Parts, Error> {
    if bytes.is_empty() || !matches!(format, Format::Gltf | Format::Glb) {
        let whole = read(bytes, format, options)?;
        let outline = Outline::of_groups(&whole.mesh.groups);
        return Ok(Parts { whole, outline });
    }
    let _reservation = options.control.reserve(2 * bytes.len() as u64)?;
    let gltf::SceneRead { mesh, warnings, outline, contents } = gltf::read(bytes, format, options, true)?;
    Ok(Parts { whole: Loaded { mesh, format, warnings, contents }, outline })
}

/// Reads a file as [`load`](super::load) does, with the names of its parts.
///
/// # Errors
/// Those of [`load`](super::load).
pub fn load_parts(path: impl AsRef<Path>, options: &ReadOptions) -> Result<Parts, Error> {
    file::loaded(path.as_ref(), options, read_parts, |parts| &mut parts.whole.warnings)
}

impl Parts {
    /// The names in the file, each before those that stand under it. Nodes without a name are left out.
    #[must_use]
    pub fn names(&self) -> Vec<PartName> {
        let counts = self.outline.counts();
        let mut depths: Vec<usize> = Vec::with_capacity(counts.len());
        let mut names = Vec::with_capacity(counts.len());
        for (entry, triangles) in self.outline.entries.iter().zip(counts) {
            let depth = entry.parent.map_or(0, |parent| depths[parent as usize] + 1);
            depths.push(depth);
            names.push(PartName { name: entry.name.clone(), depth, triangles });
        }
        names
    }

    /// The parts that a name or pattern means, in the order of the file, each with all that stands under it.
    ///
    /// A part has the name if its own is that name; "wheel/rim" means the rim that stands right under a wheel. If no part has
    /// the name, `*` in it stands for any letters and `?` for one. What stands under a part that is meant is no further part;
    /// parts without triangles are left out.
    ///
    /// # Errors
    /// [`FormatError::NoSuchPart`] if there is none, with the names that are nearest.
    pub fn select(&self, pattern: &str) -> Result<Vec<Part>, Error> {
        let mut chosen = self.chosen(pattern, |pattern, name| pattern == name);
        if !chosen.contains(&true) {
            chosen = self.chosen(pattern, matches);
        }
        let parts = self.gathered(&chosen);
        match parts.is_empty() {
            true => Err(self.no_such_part(pattern, chosen.contains(&true))),
            false => Ok(parts),
        }
    }

    /// Which entries a pattern means: by their own name, or name by name upwards where the pattern has slashes.
    fn chosen(&self, pattern: &str, means: impl Fn(&str, &str) -> bool) -> Vec<bool> {
        let entries = &self.outline.entries;
        let names: Vec<&str> = pattern.split('/').collect();
        let by_path = |entry: usize| {
            let mut at = Some(entry as u32);
            names.iter().rev().all(|name| {
                let Some(here) = at.and_then(|at| entries.get(at as usize)) else { return false };
                at = here.parent;
                means(name, &here.name)
            })
        };
        (0..entries.len()).map(|entry| means(pattern, &entries[entry].name) || by_path(entry)).collect()
    }

    /// The parts at the outermost of the chosen entries.
    fn gathered(&self, chosen: &[bool]) -> Vec<Part> {
        // 1. The chosen entry that each entry is under: parents come first.
        let mut under = vec![NOWHERE; chosen.len()];
        for (entry, place) in self.outline.entries.iter().enumerate() {
            let above = place.parent.map_or(NOWHERE, |parent| under[parent as usize]);
            under[entry] = if above == NOWHERE && chosen[entry] { entry as u32 } else { above };
        }
        // 2. The triangles of each.
        let mut triangles: FxHashMap<u32, Vec<u32>> = FxHashMap::default();
        for (triangle, &entry) in self.outline.of_triangle.iter().enumerate() {
            let part = under.get(entry as usize).copied().unwrap_or(NOWHERE);
            if part != NOWHERE {
                triangles.entry(part).or_default().push(triangle as u32);
            }
        }
        // 3. In the order of the file.
        let mut entries: Vec<u32> = triangles.keys().copied().collect();
        entries.sort_unstable();
        let part = |entry: u32| Part {
            name: self.outline.entries[entry as usize].name.clone(),
            mesh: cut_out(&self.whole.mesh, &triangles[&entry]),
        };
        entries.into_iter().map(part).collect()
    }

    fn no_such_part(&self, pattern: &str, empty: bool) -> Error {
        let own = pattern.rsplit('/').next().unwrap_or(pattern);
        let names = self.outline.entries.iter().map(|entry| entry.name.as_str());
        let mut near: Vec<(usize, &str)> = names.map(|name| (distance(own, name), name)).collect();
        near.sort_unstable();
        near.dedup();
        let near = near.into_iter().take(NEAREST).map(|(_, name)| name.to_owned()).collect();
        FormatError::NoSuchPart { format: self.whole.format, name: pattern.to_owned(), empty, near }.into()
    }
}

/// The given triangles of a mesh, with the vertices and groups they use.
fn cut_out(mesh: &Mesh, triangles: &[u32]) -> Mesh {
    let corners = || triangles.iter().flat_map(|&triangle| mesh.triangles[triangle as usize]);
    let mut vertices: Vec<u32> = corners().collect();
    vertices.sort_unstable();
    vertices.dedup();
    let numbers: FxHashMap<u32, u32> = vertices.iter().copied().zip(0..).collect();
    let renumbered = |&triangle: &u32| mesh.triangles[triangle as usize].map(|corner| numbers[&corner]);
    let mut part = Mesh::new(
        vertices.iter().map(|&vertex| mesh.positions[vertex as usize]).collect(),
        triangles.iter().map(renumbered).collect(),
    );
    if !mesh.groups.is_empty() {
        let mut known: FxHashMap<u32, u32> = FxHashMap::default();
        for &triangle in triangles {
            let group = mesh.groups.of_triangle[triangle as usize];
            let number = *known.entry(group).or_insert_with(|| {
                part.groups.list.push(mesh.groups.list[group as usize].clone());
                part.groups.list.len() as u32 - 1
            });
            part.groups.of_triangle.push(number);
        }
    }
    part.attributes =
        mesh.attributes.iter().filter_map(|attribute| cut_values(attribute, triangles)).collect();
    part
}

/// The values of an attribute that the given triangles have; nothing if they have none.
fn cut_values(attribute: &Attribute, triangles: &[u32]) -> Option<Attribute> {
    let mut part = Attribute::new(attribute.name.clone(), attribute.components);
    let mut known: FxHashMap<u32, u32> = FxHashMap::default();
    for &triangle in triangles {
        for corner in 0..3 {
            let index = attribute.of_corner[3 * triangle as usize + corner];
            let number = match attribute.value(index) {
                Some(value) => *known.entry(index).or_insert_with(|| {
                    part.values.extend_from_slice(value);
                    part.len() as u32 - 1
                }),
                None => Attribute::NONE,
            };
            part.of_corner.push(number);
        }
    }
    (!part.is_empty()).then_some(part)
}

/// Whether a name is what a pattern with `*` and `?` means. O(letters of both, multiplied).
fn matches(pattern: &str, name: &str) -> bool {
    let (pattern, name): (Vec<char>, Vec<char>) = (pattern.chars().collect(), name.chars().collect());
    // The last star met, and how much of the name it stands for.
    let (mut p, mut n, mut star) = (0, 0, None);
    while n < name.len() {
        match (pattern.get(p), star) {
            (Some('*'), _) => {
                star = Some((p, n));
                p += 1;
            }
            (Some(&letter), _) if letter == '?' || letter == name[n] => (p, n) = (p + 1, n + 1),
            (_, Some((at, taken))) => {
                star = Some((at, taken + 1));
                (p, n) = (at + 1, taken + 1);
            }
            _ => return false,
        }
    }
    pattern[p..].iter().all(|&letter| letter == '*')
}

/// How many letters to insert, leave out or replace (Levenshtein 1966), in any case, of the first 64 letters.
fn distance(a: &str, b: &str) -> usize {
    let letters = |text: &str| text.chars().flat_map(char::to_lowercase).take(64).collect::<Vec<char>>();
    let (a, b) = (letters(a), letters(b));
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, x) in a.iter().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, y) in b.iter().enumerate() {
            let replaced = diagonal + usize::from(x != y);
            diagonal = row[j + 1];
            row[j + 1] = replaced.min(diagonal + 1).min(row[j] + 1);
        }
    }
    row[b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn patterns_match_as_in_a_shell() {
        for (pattern, name, expected) in [
            ("cut_*", "cut_12", true),
            ("cut_*", "cut_", true),
            ("cut_?", "cut_12", false),
            ("*_*b", "a_b_ab", true),
            ("*", "", true),
            ("a*", "ba", false),
            ("", "a", false),
            ("*a*a*", "xax", false),
        ] {
            assert_eq!(matches(pattern, name), expected, "{pattern} {name}");
        }
        assert_eq!((distance("bsae", "Base"), distance("", "abc"), distance("wheel", "wheels")), (2, 3, 1));
    }
}
