//! Attributes of primitives as values at the corners of triangles.

use std::borrow::Cow;
use std::collections::{BTreeMap, HashMap};

use glam::DAffine3;
use gltf_json::accessor::Type;
use gltf_json::validation::Checked;

use super::super::notes::Notes;
use super::accessor::Accessors;
use super::budget::Budget;
use super::morph::Morph;
use crate::mesh::{Attribute, AttributeKind, move_attributes};
use crate::{Error, Failure};

/// More attributes than these are not read. Devices have room for sixteen.
const MOST: usize = 64;

/// The names and accessors of the attributes of a primitive.
pub(super) type Names<'a> = BTreeMap<Cow<'a, str>, u32>;

/// An attribute, and the accessor, the count and the linear part of the transform that its values are from.
type Placed = (usize, u32, u64, Option<[u64; 9]>);

/// The attributes of a scene so far.
#[derive(Default)]
pub(super) struct Corners {
    pub(super) list: Vec<Attribute>,
    /// The first value of those placed: primitives share their values.
    placed: HashMap<Placed, u32>,
}

/// A primitive whose triangles were added.
pub(super) struct Shown<'a> {
    pub(super) pointer: &'a str,
    pub(super) world: &'a DAffine3,
    pub(super) mirrored: bool,
    pub(super) vertices: u64,
    pub(super) morph: &'a Morph<'a>,
    /// Triangles of the mesh before.
    pub(super) before: usize,
    /// The corners of its triangles as vertices of the primitive.
    pub(super) corners: &'a [[u32; 3]],
}

impl Corners {
    /// Adds the attributes of a primitive. What cannot be read of them is left out, with a note.
    pub(super) fn add(
        &mut self,
        names: &Names<'_>,
        shown: &Shown<'_>,
        accessors: &Accessors<'_>,
        budget: &mut Budget<'_>,
        notes: &mut Notes,
    ) -> Result<(), Error> {
        for (name, &accessor) in names.iter().filter(|(name, _)| *name != "POSITION") {
            if AttributeKind::of(name).is_none() {
                notes.add("attribute whose name glTF does not have left out", 1);
                continue;
            }
            match self.attribute(name, accessor, shown, accessors, budget, notes) {
                Ok(true) => {}
                Ok(false) => notes.add("attribute after the first 64 left out", 1),
                Err(error)
                    if matches!(error, Error::TooLarge { .. }) || error.failure() == Failure::Limit =>
                {
                    return Err(error);
                }
                Err(error) => notes.say(format!("attribute {} left out: {error}", shorten(name))),
            }
        }
        Ok(())
    }

    /// Adds one attribute; whether there was room for it.
    fn attribute(
        &mut self,
        name: &str,
        accessor: u32,
        shown: &Shown<'_>,
        accessors: &Accessors<'_>,
        budget: &mut Budget<'_>,
        notes: &mut Notes,
    ) -> Result<bool, Error> {
        let kind = AttributeKind::of(name).unwrap_or(AttributeKind::Plain);
        // 1. The values under a transform, from the file if they are new.
        let moves = matches!(kind, AttributeKind::Normal | AttributeKind::Tangent);
        let is_moved = moves && shown.world.matrix3 != glam::DMat3::IDENTITY;
        let linear = is_moved.then(|| shown.world.matrix3.to_cols_array().map(f64::to_bits));
        let known = self.list.iter().position(|attribute| attribute.name == name);
        let key = |index| (index, accessor, shown.vertices, linear);
        let shared = known.filter(|_| shown.morph.is_none()).and_then(|known| self.placed.get(&key(known)));
        let shared = shared.copied();
        let addition = match shared {
            Some(_) => Attribute::new(name, 1),
            None => shown_values(name, accessor, shown, is_moved, accessors, budget, notes)?,
        };
        if known.is_none() && self.list.len() == MOST {
            return Ok(false);
        }
        // 2. The corners: none for triangles before, then those of the primitive.
        let triangles = shown.before + shown.corners.len();
        budget.charge(
            12 * (triangles as u64)
                .saturating_sub(known.map_or(0, |known| self.list[known].of_corner.len() as u64 / 3)),
        )?;
        let index = known.unwrap_or_else(|| {
            self.list.push(Attribute::new(name, addition.components));
            self.list.len() - 1
        });
        let attribute = &mut self.list[index];
        let first = match shared {
            Some(first) => first,
            None => {
                attribute.push_values(addition);
                let first = attribute.len() as u64 - shown.vertices;
                if attribute.len() >= u32::MAX as usize {
                    return Err(Error::TooLarge {
                        what: format!("the scene has {} values of {name}", attribute.len()),
                    });
                }
                first as u32
            }
        };
        if shown.morph.is_none() {
            self.placed.insert(key(index), first);
        }
        attribute.of_corner.resize(3 * shown.before, Attribute::NONE);
        attribute.of_corner.extend(shown.corners.as_flattened().iter().map(|&vertex| first + vertex));
        Ok(true)
    }

    /// The attributes of a mesh of `triangles` triangles.
    pub(super) fn finish(mut self, triangles: usize) -> Vec<Attribute> {
        for attribute in &mut self.list {
            attribute.of_corner.resize(3 * triangles, Attribute::NONE);
        }
        self.list
    }
}

/// The values of an accessor as a primitive shows them, `is_moved` if its transform changes them.
fn shown_values(
    name: &str,
    accessor: u32,
    shown: &Shown<'_>,
    is_moved: bool,
    accessors: &Accessors<'_>,
    budget: &mut Budget<'_>,
    notes: &mut Notes,
) -> Result<Attribute, Error> {
    let mut attribute = Attribute::new(name, 1);
    let pointer = format!("{}/attributes/{}", shown.pointer, shorten(name));
    attribute.components = read_values(&mut attribute, accessor, &pointer, shown, accessors, budget)?;
    shown.morph.deform(&mut attribute, accessors, budget)?;
    let mut wrong = 0;
    for number in attribute.values.iter_mut().filter(|number| !number.is_finite()) {
        *number = 0.0;
        wrong += 1;
    }
    notes.add("number of an attribute that is not finite taken as 0", wrong);
    if is_moved {
        let linear = shown.world.matrix3.to_cols_array();
        let [x, y, z] = [0, 1, 2].map(|i| [linear[i], linear[3 + i], linear[6 + i]]);
        move_attributes(std::slice::from_mut(&mut attribute), &[x, y, z], shown.mirrored);
    }
    Ok(attribute)
}

/// Reads the values of an accessor, and gives the number of components of each.
fn read_values(
    attribute: &mut Attribute,
    accessor: u32,
    pointer: &str,
    shown: &Shown<'_>,
    accessors: &Accessors<'_>,
    budget: &mut Budget<'_>,
) -> Result<usize, Error> {
    let reader = accessors.reader;
    let found = reader.get(&reader.document.accessors, "accessors", accessor as usize, pointer)?;
    if found.count != shown.vertices {
        let what = format!("has {} values for {} vertices", found.count, shown.vertices);
        return Err(reader.error(pointer, what));
    }
    let components = match found.shape {
        Checked::Valid(Type::Scalar) => 1,
        Checked::Valid(Type::Vec2) => 2,
        Checked::Valid(Type::Vec3) => 3,
        Checked::Valid(Type::Vec4) => 4,
        _ => return Err(reader.error(pointer, "has matrices")),
    };
    if !attribute.kind().allows(&attribute.name, components) {
        return Err(reader.error(pointer, format!("has {components} components")));
    }
    budget.charge(found.count.saturating_mul(8 * components as u64))?;
    attribute.values = accessors.list(accessor, components, pointer)?;
    Ok(components)
}

fn shorten(name: &str) -> String {
    name.chars().filter(|letter| !letter.is_control()).take(40).collect()
}
