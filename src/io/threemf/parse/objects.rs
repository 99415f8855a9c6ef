//! Objects, their meshes, and where they are.

use glam::{DAffine3, DMat3, DVec3};
use quick_xml::events::BytesStart;
use quick_xml::events::attributes::Attribute;

use super::super::super::Format;
use super::super::super::faces::{index_error, too_large};
use super::super::model::{Label, Object, Placed};
use super::super::package::part_name;
use super::super::xml;
use super::Parser;
use crate::Error;

/// Bytes that an object takes besides its mesh.
const OBJECT: u64 = 400;

/// Bytes that a component or an item takes.
const PLACED: u64 = 160;

/// Bytes that what a triangle says of itself takes, and its set.
const LABEL: u64 = 20;

/// Bytes that a triangle set takes besides its name.
const SET: u64 = 48;

impl Parser<'_, '_, '_> {
    pub(super) fn start_object(&mut self, element: &BytesStart<'_>) -> Result<(), Error> {
        let (mut id, mut object) = (0, Object::default());
        let (mut property, mut index) = (None, None);
        for attribute in element.attributes().with_checks(false) {
            let attribute = self.attribute(attribute)?;
            match attribute.key.0 {
                "id" => id = self.whole(&attribute)?,
                "name" => object.name = self.value(&attribute)?.into_owned(),
                "pid" => property = Some(self.whole(&attribute)?),
                "pindex" => index = Some(self.whole(&attribute)?),
                "type" => {
                    object.left_out = match &*attribute.value {
                        "support" => Some("support"),
                        "solidsupport" => Some("solid support"),
                        "other" => Some("other"),
                        _ => None,
                    };
                }
                _ => {}
            }
        }
        if self.object.is_some() {
            return Err(self.error("an object within an object"));
        }
        if let (Some(property), Some(index)) = (property, index) {
            object.label = Some(Label { property, indices: [index; 3] });
        }
        self.charge(OBJECT + object.name.len() as u64)?;
        self.object = Some((id, object));
        Ok(())
    }

    /// Checks the triangles of an object against its vertices, which are all known now.
    pub(super) fn end_object(&mut self) -> Result<(), Error> {
        let Some((id, mut object)) = self.object.take() else { return Ok(()) };
        let mesh = &mut object.mesh;
        let vertices = mesh.positions.len();
        let beyond =
            mesh.triangles.as_flattened().iter().copied().find(|&corner| corner as usize >= vertices);
        if let Some(index) = beyond {
            let place = format!("{}, object {id}", self.part);
            return Err(index_error(Format::ThreeMf, place, u64::from(index), vertices));
        }
        if !mesh.labels.is_empty() {
            self.charge(LABEL * (mesh.triangles.len() - mesh.labels.len()) as u64)?;
            mesh.labels.resize(mesh.triangles.len(), None);
        }
        if self.model.objects.contains_key(&id) {
            self.notes.add("object whose number another one has ignored", 1);
            return Ok(());
        }
        self.model.objects.insert(id, object);
        Ok(())
    }

    pub(super) fn vertex(&mut self, element: &BytesStart<'_>) -> Result<(), Error> {
        let mut point = [f64::NAN; 3];
        for attribute in element.attributes().with_checks(false) {
            let attribute = self.attribute(attribute)?;
            let axis = match attribute.key.0 {
                "x" => 0,
                "y" => 1,
                "z" => 2,
                _ => continue,
            };
            point[axis] = self.number(&attribute)?;
        }
        if point.iter().any(|coordinate| coordinate.is_nan()) {
            return Err(self.error("a vertex without a coordinate x, y or z"));
        }
        self.charge(24)?;
        let Some((_, object)) = &mut self.object else {
            return Err(self.error("a vertex that is in no object"));
        };
        object.mesh.positions.push(point);
        Ok(())
    }

    pub(super) fn triangle(&mut self, element: &BytesStart<'_>) -> Result<(), Error> {
        let mut corners = [None; 3];
        let (mut property, mut indices) = (None, [None; 3]);
        for attribute in element.attributes().with_checks(false) {
            let attribute = self.attribute(attribute)?;
            let place = match attribute.key.0 {
                "v1" => &mut corners[0],
                "v2" => &mut corners[1],
                "v3" => &mut corners[2],
                "p1" => &mut indices[0],
                "p2" => &mut indices[1],
                "p3" => &mut indices[2],
                "pid" => &mut property,
                _ => continue,
            };
            *place = Some(self.whole(&attribute)?);
        }
        let [Some(a), Some(b), Some(c)] = corners else {
            return Err(self.error("a triangle without a corner v1, v2 or v3"));
        };
        let Some((_, object)) = &self.object else {
            return Err(self.error("a triangle that is in no object"));
        };
        let (count, said) = (object.mesh.triangles.len(), object.mesh.labels.len());
        if count >= u32::MAX as usize {
            return Err(too_large(Format::ThreeMf, "triangles"));
        }
        let mut label = None;
        if property.is_some() || indices[0].is_some() {
            let default = object.label;
            let first = indices[0].or(default.map(|label| label.indices[0]));
            if let (Some(property), Some(first)) = (property.or(default.map(|label| label.property)), first) {
                label = Some(Label { property, indices: indices.map(|index| index.unwrap_or(first)) });
            } else {
                let at = self.at() as usize;
                self.notes.at("triangle with half of a material taken as without", at);
            }
        }
        // Those before that say nothing have a place among the labels then.
        let labels = if label.is_some() { count - said + 1 } else { 0 };
        self.charge(12 + LABEL * labels as u64)?;
        if let Some((_, Object { mesh, .. })) = &mut self.object {
            if label.is_some() {
                mesh.labels.resize(count, None);
                mesh.labels.push(label);
            }
            mesh.triangles.push([a, b, c]);
        }
        Ok(())
    }

    pub(super) fn start_set(&mut self, element: &BytesStart<'_>) -> Result<(), Error> {
        let name = self.text_attribute(element, "name")?.unwrap_or_default();
        self.charge(SET + name.len() as u64)?;
        if let Some((_, object)) = &mut self.object {
            object.mesh.set_names.push(name);
        }
        Ok(())
    }

    /// Puts the triangles of `ref` or `refrange` into the open set; of several sets that have a triangle the last one counts.
    pub(super) fn set_triangles(&mut self, element: &BytesStart<'_>) -> Result<(), Error> {
        let (mut first, mut last) = (None, None);
        for attribute in element.attributes().with_checks(false) {
            let attribute = self.attribute(attribute)?;
            match attribute.key.0 {
                "index" => (first, last) = (Some(self.whole(&attribute)?), Some(self.whole(&attribute)?)),
                "startindex" => first = Some(self.whole(&attribute)?),
                "endindex" => last = Some(self.whole(&attribute)?),
                _ => {}
            }
        }
        let mesh = self.object.as_ref().map(|(_, object)| &object.mesh);
        let (count, known) = mesh.map_or((0, 0), |mesh| (mesh.triangles.len(), mesh.sets.len()));
        let (Some(first), Some(last)) = (first, last) else { return Ok(()) };
        if first > last || last as usize >= count {
            let at = self.at() as usize;
            self.notes.at("triangles of a set that are not there ignored", at);
            return Ok(());
        }
        // Ranges may cover each other as often as they are; so their length counts as memory.
        self.charge(4 * (u64::from(last - first) + 1 + (count - known) as u64))?;
        if let Some((_, object)) = &mut self.object {
            let (number, mesh) = (object.mesh.set_names.len() as u32, &mut object.mesh);
            mesh.sets.resize(count, 0);
            let triangles = &mut mesh.sets[first as usize..=last as usize];
            let taken = triangles.iter().filter(|&&set| set != 0 && set != number).count();
            triangles.fill(number);
            self.notes.add("triangle in several sets taken as in the last one", taken);
        }
        Ok(())
    }

    pub(super) fn component(&mut self, element: &BytesStart<'_>) -> Result<(), Error> {
        let placed = self.placed(element)?;
        if let Some((_, object)) = &mut self.object {
            object.components.push(placed);
        }
        Ok(())
    }

    pub(super) fn item(&mut self, element: &BytesStart<'_>) -> Result<(), Error> {
        let placed = self.placed(element)?;
        self.model.items.push(placed);
        Ok(())
    }

    /// An object at a place.
    fn placed(&mut self, element: &BytesStart<'_>) -> Result<Placed, Error> {
        self.charge(PLACED)?;
        let (mut object, mut part, mut transform) = (None, self.own, None);
        for attribute in element.attributes().with_checks(false) {
            let attribute = self.attribute(attribute)?;
            match attribute.key.0 {
                "objectid" => object = Some(self.whole(&attribute)?),
                "transform" => transform = Some(self.transform(&attribute)?),
                key if self.spaces.is_production(key, "path") => {
                    let path = self.value(&attribute)?;
                    let path = part_name(&path, "/").map_err(|what| self.error(what))?;
                    self.charge(2 * path.len() as u64)?;
                    part = self.document.path(&path);
                }
                _ => {}
            }
        }
        let object = object.ok_or_else(|| self.error("a component or item without an objectid"))?;
        Ok(Placed { object, part, transform })
    }

    /// A transform: four rows of three, the last one a translation, for points that are rows.
    fn transform(&self, attribute: &Attribute<'_>) -> Result<DAffine3, Error> {
        let numbers: Vec<f64> = (attribute.value.split_ascii_whitespace().take(13))
            .map_while(|word| xml::number(word).filter(|number| number.is_finite()))
            .collect();
        match <[f64; 12]>::try_from(numbers) {
            Ok(m) => Ok(DAffine3 {
                matrix3: DMat3::from_cols(
                    DVec3::new(m[0], m[1], m[2]),
                    DVec3::new(m[3], m[4], m[5]),
                    DVec3::new(m[6], m[7], m[8]),
                ),
                translation: DVec3::new(m[9], m[10], m[11]),
            }),
            Err(_) => {
                Err(self
                    .error(format!("the transform {} is not twelve numbers", xml::quoted(&attribute.value))))
            }
        }
    }

    #[inline]
    fn number(&self, attribute: &Attribute<'_>) -> Result<f64, Error> {
        match xml::number(&attribute.value) {
            Some(number) if !number.is_nan() => Ok(number),
            _ => {
                let (key, value) = (attribute.key.0, xml::quoted(&attribute.value));
                Err(self.error(format!("{key} is {value}, not a number")))
            }
        }
    }
}
