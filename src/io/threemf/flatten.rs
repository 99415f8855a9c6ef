//! One mesh of what is built.

use std::collections::HashMap;
use std::sync::Arc;

use glam::{DAffine3, DVec3};

use super::super::mirror::is_mirrored;
use super::super::notes::Notes;
use super::super::{Format, color, malformed};
use super::budget::Budget;
use super::model::{Document, Label, Object, ObjectMesh, Placed, Property};
use crate::mesh::Attribute;
use crate::{Error, FaceGroup, FaceGroups, Material, Mesh};

/// Components may stand this deep in each other.
const MOST_DEPTH: usize = 256;

/// Bytes that an instance takes, besides its name.
const INSTANCE: u64 = 120;

/// Bytes that a name of groups takes, besides its text.
const NAME: u64 = 80;

/// Bytes that a group takes, besides its name and that of its material.
const GROUP: u64 = size_of::<FaceGroup>() as u64 + 40;

/// A mesh at a place.
struct Instance {
    part: u32,
    object: u32,
    transform: DAffine3,
    name: String,
}

/// The mesh of all build items, in millimetres.
pub(super) fn flatten(document: &Document, budget: &mut Budget, notes: &mut Notes) -> Result<Mesh, Error> {
    let instances = instances(document, budget, notes)?;
    let mut builder = Builder {
        document,
        mesh: Mesh::default(),
        groups: Vec::new(),
        list: Vec::new(),
        known: HashMap::new(),
        names: Vec::new(),
        by_name: HashMap::new(),
        colours: Colours::default(),
    };
    for instance in &instances {
        builder.add(instance, budget, notes)?;
    }
    Ok(builder.finish())
}

/// The object that stands at a place.
fn object_of<'d>(document: &'d Document, placed: &Placed) -> Result<&'d Object, Error> {
    let objects = document.models.get(placed.part as usize).map(|model| &model.objects);
    objects.and_then(|objects| objects.get(&placed.object)).ok_or_else(|| {
        let part = document.paths.get(placed.part as usize).map_or("", String::as_str);
        let what =
            format!("object {} is built or a component, and not there; the file is damaged", placed.object);
        malformed(Format::ThreeMf, part, what)
    })
}

/// All meshes that build items show, in order.
fn instances(document: &Document, budget: &mut Budget, notes: &mut Notes) -> Result<Vec<Instance>, Error> {
    let Some(root) = document.models.first() else { return Ok(Vec::new()) };
    let scale = root.unit;
    let is_other = |model: &&super::model::Model| model.unit != scale;
    notes.add(
        "model of another unit than the root's read in the root's",
        document.models.iter().filter(is_other).count(),
    );
    let mut list = Vec::new();
    // What is still to be looked at, the next one last: an object, where its parent is, its parent's name, how deep it is.
    let mut open: Vec<(Placed, DAffine3, String, usize)> = Vec::new();
    open.extend(root.items.iter().rev().map(|item| (*item, DAffine3::IDENTITY, String::new(), 0)));
    while let Some((placed, above, name, depth)) = open.pop() {
        let object = object_of(document, &placed)?;
        if let Some(what) = object.left_out {
            notes.add(format!("object of the type \"{what}\" left out"), 1);
            continue;
        }
        if depth > MOST_DEPTH {
            let part = document.paths.get(placed.part as usize).map_or("", String::as_str);
            let what = format!("components stand more than {MOST_DEPTH} deep in each other, or in a circle");
            return Err(malformed(Format::ThreeMf, part, what));
        }
        let transform = match placed.transform {
            None => above,
            Some(own) if above == DAffine3::IDENTITY => own,
            Some(own) => above * own,
        };
        let name = joined(&name, &object.name);
        budget.charge((INSTANCE + name.len() as u64) * (1 + object.components.len() as u64))?;
        open.extend(object.components.iter().rev().map(|part| (*part, transform, name.clone(), depth + 1)));
        if !object.mesh.triangles.is_empty() || !object.mesh.positions.is_empty() {
            list.push(Instance { part: placed.part, object: placed.object, transform, name });
        }
    }
    Ok(list)
}

/// "assembly/part", or one of them where the other has no name.
fn joined(above: &str, own: &str) -> String {
    match (above, own) {
        (above, "") => above.to_owned(),
        ("", own) => own.to_owned(),
        (above, own) => format!("{above}/{own}"),
    }
}

/// A base material: its part, its list, its number there.
type BaseKey = (u32, u32, u32);

/// What a group is known by: its name, and which base material it has.
type GroupKey = (u32, Option<BaseKey>);

struct Builder<'d> {
    document: &'d Document,
    mesh: Mesh,
    /// For every triangle its group.
    groups: Vec<u32>,
    list: Vec<FaceGroup>,
    known: HashMap<GroupKey, u32>,
    /// The names of groups, each once, and their numbers.
    names: Vec<Arc<str>>,
    by_name: HashMap<Arc<str>, u32>,
    colours: Colours,
}

impl Builder<'_> {
    fn add(&mut self, instance: &Instance, budget: &mut Budget, notes: &mut Notes) -> Result<(), Error> {
        let placed = Placed { object: instance.object, part: instance.part, transform: None };
        let object = object_of(self.document, &placed)?;
        let mesh = &object.mesh;
        budget.charge(24 * mesh.positions.len() as u64 + 28 * mesh.triangles.len() as u64)?;
        let first = self.mesh.positions.len();
        if first + mesh.positions.len() > u32::MAX as usize {
            return Err(super::super::faces::too_large(Format::ThreeMf, "vertices"));
        }
        // 1. Vertices, moved and in millimetres.
        let scale = self.document.models.first().map_or(1.0, |model| model.unit);
        let is_moved = instance.transform != DAffine3::IDENTITY;
        self.mesh.positions.extend(mesh.positions.iter().map(|&point| {
            let point = if is_moved {
                instance.transform.transform_point3(DVec3::from_array(point)).to_array()
            } else {
                point
            };
            if scale == 1.0 { point } else { point.map(|coordinate| coordinate * scale) }
        }));
        // 2. Triangles: a mirror turns them round.
        let is_mirrored = is_mirrored(&instance.transform.matrix3);
        let mut groups = GroupFinder { name: &instance.name, mesh, names: HashMap::new(), last: None };
        let mut dropped = 0;
        for (index, &[a, b, c]) in mesh.triangles.iter().enumerate() {
            if a == b || b == c || c == a {
                dropped += 1;
                continue;
            }
            let corners = if is_mirrored { [a, c, b] } else { [a, b, c] };
            self.mesh.triangles.push(corners.map(|corner| corner + first as u32));
            // 3. What they are made of.
            let label = mesh.labels.get(index).copied().flatten().or(object.label);
            let material = self.material(instance.part, label, is_mirrored, notes);
            let group = groups.group(self, index, material, budget)?;
            self.groups.push(group);
        }
        notes.add("triangle with a repeated corner dropped", dropped);
        Ok(())
    }

    /// The base material of a label, by part, property and number. Colours are noted for the corners of the next triangle.
    fn material(
        &mut self,
        part: u32,
        label: Option<Label>,
        is_mirrored: bool,
        notes: &mut Notes,
    ) -> Option<BaseKey> {
        let triangle = self.mesh.triangles.len() - 1;
        let label = label?;
        let model = self.document.models.get(part as usize)?;
        match model.properties.get(&label.property) {
            Some(Property::Base(list)) => {
                let is_there = (label.indices[0] as usize) < list.len();
                if !is_there {
                    notes.add("triangle with a material that is not there", 1);
                }
                is_there.then_some((part, label.property, label.indices[0]))
            }
            Some(Property::Colours(list)) => {
                let [a, b, c] = label.indices.map(|index| list.get(index as usize).copied());
                if a.is_none() || b.is_none() || c.is_none() {
                    notes.add("triangle with a colour that is not there", 1);
                }
                self.colours.set(triangle, if is_mirrored { [a, c, b] } else { [a, b, c] });
                None
            }
            Some(Property::Other(what)) => {
                notes.add(*what, 1);
                None
            }
            None => {
                notes.add("triangle with a material that is not there", 1);
                None
            }
        }
    }

    /// The number of a name.
    fn name(&mut self, name: &str, budget: &mut Budget) -> Result<u32, Error> {
        // A long name may be looked up for many sets; that counts as if each had its own.
        budget.charge(NAME + name.len() as u64)?;
        if let Some(&number) = self.by_name.get(name) {
            return Ok(number);
        }
        let (name, number): (Arc<str>, _) = (name.into(), self.names.len() as u32);
        self.names.push(Arc::clone(&name));
        self.by_name.insert(name, number);
        Ok(number)
    }

    /// The number of a group, by the number of its name.
    fn group(&mut self, key: GroupKey, budget: &mut Budget) -> Result<u32, Error> {
        if let Some(&known) = self.known.get(&key) {
            return Ok(known);
        }
        let (name, material) = key;
        let name = self.names.get(name as usize).map_or("", |name| &**name);
        let entry = material.and_then(|key| base(self.document, key));
        budget.charge(GROUP + (name.len() + entry.map_or(0, |(name, _)| name.len())) as u64)?;
        self.list.push(FaceGroup { name: name.to_owned(), material: entry.map(material_of) });
        let number = self.list.len() as u32 - 1;
        self.known.insert(key, number);
        Ok(number)
    }

    fn finish(self) -> Mesh {
        let Self { mut mesh, groups, list, colours, .. } = self;
        if list.len() > 1 || list.iter().any(|group| *group != FaceGroup::default()) {
            mesh.groups = FaceGroups { list, of_triangle: groups };
        }
        mesh.attributes.extend(colours.finish(mesh.triangles.len()));
        mesh
    }
}

/// The groups of the triangles of one instance; those of neighbours are mostly the same.
struct GroupFinder<'i> {
    name: &'i str,
    mesh: &'i ObjectMesh,
    /// The numbers of the names of its sets.
    names: HashMap<u32, u32>,
    /// The triangle set and the material of the last one, and its group.
    last: Option<(u32, Option<BaseKey>, u32)>,
}

impl GroupFinder<'_> {
    fn group(
        &mut self,
        builder: &mut Builder<'_>,
        triangle: usize,
        material: Option<BaseKey>,
        budget: &mut Budget,
    ) -> Result<u32, Error> {
        let set = self.mesh.sets.get(triangle).copied().unwrap_or(0);
        if let Some((_, _, group)) = self.last.filter(|&(s, m, _)| (s, m) == (set, material)) {
            return Ok(group);
        }
        let name = match self.names.get(&set) {
            Some(&name) => name,
            None => {
                let set_name = (set as usize).checked_sub(1).and_then(|set| self.mesh.set_names.get(set));
                let name = builder.name(&joined(self.name, set_name.map_or("", String::as_str)), budget)?;
                self.names.insert(set, name);
                name
            }
        };
        let group = builder.group((name, material), budget)?;
        self.last = Some((set, material, group));
        Ok(group)
    }
}

/// A base material: its name, and its colour as in the file.
fn base(document: &Document, (part, property, index): BaseKey) -> Option<&(String, [u8; 4])> {
    let model = document.models.get(part as usize)?;
    let Some(Property::Base(list)) = model.properties.get(&property) else { return None };
    list.get(index as usize)
}

/// The material of such an entry; colours of files are encoded for screens.
fn material_of((name, [red, green, blue, opacity]): &(String, [u8; 4])) -> Material {
    let [red, green, blue] = [red, green, blue].map(|&byte| color::linear(f64::from(byte) / 255.0) as f32);
    Material::plain(name.clone(), [red, green, blue, f32::from(*opacity) / 255.0])
}

/// Colours of corners, as they become known.
#[derive(Default)]
struct Colours {
    known: HashMap<[u8; 4], u32>,
    list: Vec<[u8; 4]>,
    of_corner: Vec<u32>,
}

impl Colours {
    fn set(&mut self, triangle: usize, colours: [Option<[u8; 4]>; 3]) {
        self.of_corner.resize(3 * triangle, Attribute::NONE);
        for colour in colours {
            let number = colour.map_or(Attribute::NONE, |colour| {
                *self.known.entry(colour).or_insert_with(|| {
                    self.list.push(colour);
                    self.list.len() as u32 - 1
                })
            });
            self.of_corner.push(number);
        }
    }

    /// The attribute, if there is a colour; with opacities where one is not opaque.
    fn finish(mut self, triangles: usize) -> Option<Attribute> {
        if self.list.is_empty() {
            return None;
        }
        self.of_corner.resize(3 * triangles, Attribute::NONE);
        let components = if self.list.iter().any(|colour| colour[3] != 255) { 4 } else { 3 };
        let mut attribute = Attribute::new("COLOR_0", components);
        for [red, green, blue, opacity] in self.list {
            attribute.values.extend([red, green, blue].map(|byte| color::linear(f64::from(byte) / 255.0)));
            if components == 4 {
                attribute.values.push(f64::from(opacity) / 255.0);
            }
        }
        attribute.of_corner = self.of_corner;
        Some(attribute)
    }
}
