//! What triangles are made of: base materials and colours.

use quick_xml::events::BytesStart;

use super::super::model::Property;
use super::super::xml;
use super::{Parser, Space};
use crate::Error;

/// Bytes that a base material takes.
const BASE: u64 = 80;

/// Bytes that a colour takes, in the table of the mesh too.
const COLOUR: u64 = 60;

/// Bytes that a list of materials or colours takes.
const PROPERTY: u64 = 120;

/// What is said of triangles with a property that is not kept, by the name of its element.
pub(super) fn told(element: &str) -> &'static str {
    match element {
        "compositematerials" => "triangle with a mixture of materials, which is not kept",
        "multiproperties" => "triangle with several layers of materials, which are not kept",
        _ => "triangle with a picture for its material, which is not kept",
    }
}

impl Parser<'_, '_, '_> {
    pub(super) fn start_property(
        &mut self,
        element: &BytesStart<'_>,
        property: Property,
    ) -> Result<(), Error> {
        let mut id = 0;
        for attribute in element.attributes().with_checks(false) {
            let attribute = self.attribute(attribute)?;
            if attribute.key.0 == "id" {
                id = self.whole(&attribute)?;
            }
        }
        self.charge(PROPERTY)?;
        self.property = Some((id, property));
        Ok(())
    }

    /// Whether the end of an element is that of the open property.
    pub(super) fn ends_property(&self, name: &str) -> bool {
        let (space, local) = self.spaces.of(name);
        match &self.property {
            Some((_, Property::Base(_))) => (space, local) == (Space::Core, "basematerials"),
            Some((_, Property::Colours(_))) => local == "colorgroup",
            Some((_, Property::Other(_))) => {
                matches!(local, "texture2dgroup" | "compositematerials" | "multiproperties")
            }
            None => false,
        }
    }

    pub(super) fn base(&mut self, element: &BytesStart<'_>) -> Result<(), Error> {
        let name = self.text_attribute(element, "name")?.unwrap_or_default();
        let colour = self.colour_attribute(element, "displaycolor")?;
        self.charge(BASE + name.len() as u64)?;
        if let Some((_, Property::Base(list))) = &mut self.property {
            list.push((name, colour));
        }
        Ok(())
    }

    pub(super) fn colour(&mut self, element: &BytesStart<'_>) -> Result<(), Error> {
        let colour = self.colour_attribute(element, "color")?;
        self.charge(COLOUR)?;
        if let Some((_, Property::Colours(list))) = &mut self.property {
            list.push(colour);
        }
        Ok(())
    }

    /// A colour that an attribute holds; white where there is none that can be read.
    fn colour_attribute(&mut self, element: &BytesStart<'_>, key: &str) -> Result<[u8; 4], Error> {
        let text = self.text_attribute(element, key)?;
        let colour = text.as_deref().and_then(xml::colour);
        if colour.is_none() {
            let at = self.at() as usize;
            self.notes.at("colour that is not #RRGGBB or #RRGGBBAA taken for white", at);
        }
        Ok(colour.unwrap_or([255; 4]))
    }
}
