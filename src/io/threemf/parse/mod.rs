//! A model in XML, read element by element.

mod objects;
mod properties;

use quick_xml::Reader;
use quick_xml::events::attributes::Attribute;
use quick_xml::events::{BytesStart, Event};

use super::super::notes::Notes;
use super::super::{Format, malformed};
use super::model::{Document, Model, Object, Property};
use super::package::PartText;
use super::space::{Space, Spaces};
use super::xml;
use crate::Error;

/// Elements may stand this deep in each other; those of 3MF do ten at most. The reader of XML remembers each.
const MOST_DEPTH: usize = 256;

/// Reads the model in the text of a part.
pub(super) fn model(
    text: PartText<'_, '_>,
    part: &str,
    document: &mut Document,
    notes: &mut Notes,
) -> Result<Model, Error> {
    let own = document.path(part);
    let mut parser = Parser {
        reader: Reader::from_reader(text),
        part,
        own,
        document,
        notes,
        spaces: Spaces::default(),
        model: Model { unit: 1.0, ..Model::default() },
        object: None,
        property: None,
        told: Vec::new(),
        root: Root::Awaited,
    };
    parser.read_all()?;
    match parser.root {
        Root::Ended => Ok(parser.model),
        Root::Begun => Err(parser.error("the text ends before its model does; the file is cut off")),
        Root::Awaited => Err(malformed(Format::ThreeMf, part, "holds no model of 3MF; the file is damaged")),
    }
}

/// Where the element of the whole model is.
#[derive(Clone, Copy, PartialEq)]
enum Root {
    Awaited,
    Begun,
    Ended,
}

/// What is read of a model so far. Elements are told apart by name and namespace alone: none has two meanings.
struct Parser<'p, 's, 'a> {
    reader: Reader<PartText<'s, 'a>>,
    part: &'p str,
    /// The number of this part.
    own: u32,
    document: &'p mut Document,
    notes: &'p mut Notes,
    spaces: Spaces,
    model: Model,
    object: Option<(u32, Object)>,
    property: Option<(u32, Property)>,
    /// The specifications of which something was left out.
    told: Vec<&'static str>,
    root: Root,
}

impl Parser<'_, '_, '_> {
    fn read_all(&mut self) -> Result<(), Error> {
        let mut buffer = Vec::new();
        let mut depth = 0_usize;
        loop {
            buffer.clear();
            self.reader.get_mut().get_mut().budget().release_text();
            match self.reader.read_event_into(&mut buffer) {
                Ok(Event::Start(element)) => {
                    depth += 1;
                    if depth > MOST_DEPTH {
                        return Err(
                            self.error(format!("elements stand more than {MOST_DEPTH} deep in each other"))
                        );
                    }
                    self.start(&element)?;
                }
                Ok(Event::Empty(element)) => {
                    self.start(&element)?;
                    self.end(element.name().0)?;
                }
                Ok(Event::End(element)) => {
                    depth = depth.saturating_sub(1);
                    self.end(element.name().0)?;
                }
                Ok(Event::DocType(_)) => return Err(xml::doctype(self.part, self.at())),
                Ok(Event::Eof) => return Ok(()),
                Ok(_) => {}
                Err(error) => {
                    let fault = self.reader.get_mut().get_mut().budget().take_fault();
                    return Err(fault.unwrap_or_else(|| xml::error(self.part, self.at(), &error)));
                }
            }
        }
    }

    fn start(&mut self, element: &BytesStart<'_>) -> Result<(), Error> {
        match self.spaces.of(element.name().0) {
            (Space::Core, "vertex") => self.vertex(element),
            (Space::Core, "triangle") => self.triangle(element),
            _ => self.start_other(element),
        }
    }

    /// Elements of which there are few.
    fn start_other(&mut self, element: &BytesStart<'_>) -> Result<(), Error> {
        for attribute in element.attributes().with_checks(false) {
            let attribute = self.attribute(attribute)?;
            if attribute.key.0.starts_with("xmlns") {
                let uri = self.value(&attribute)?;
                self.spaces.declare(attribute.key.0, &uri);
            }
        }
        match self.spaces.of(element.name().0) {
            (Space::Core, "model") => self.start_model(element),
            (Space::Core, "metadata") => self.metadata(element),
            (Space::Core, "object") => self.start_object(element),
            (Space::Core, "component") => self.component(element),
            (Space::Core, "item") => self.item(element),
            (Space::Core, "basematerials") => self.start_property(element, Property::Base(Vec::new())),
            (Space::Core, "base") => self.base(element),
            (Space::Materials, "colorgroup") => self.start_property(element, Property::Colours(Vec::new())),
            (Space::Materials, "color") => self.colour(element),
            (Space::Materials, name @ ("texture2dgroup" | "compositematerials" | "multiproperties")) => {
                self.start_property(element, Property::Other(properties::told(name)))
            }
            (Space::Materials, "texture2d") => {
                self.notes.add("picture not kept", 1);
                Ok(())
            }
            (Space::TriangleSets, "triangleset") => self.start_set(element),
            (Space::TriangleSets, "ref" | "refrange") => self.set_triangles(element),
            (Space::Other(what), name) => {
                self.not_kept(what, name);
                Ok(())
            }
            _ => Ok(()),
        }
    }

    /// Notes an element of a specification that is not understood: how many there are of the known ones that stand for a whole.
    fn not_kept(&mut self, what: &'static str, name: &str) {
        if matches!(name, "beamlattice" | "slicestack" | "volumetricstack" | "booleanshape") {
            self.notes.add(format!("{what} not kept"), 1);
        } else if !self.told.contains(&what) {
            self.notes.say(format!("{what} not kept"));
            self.told.push(what);
        }
    }

    fn end(&mut self, name: &str) -> Result<(), Error> {
        match self.spaces.of(name) {
            (Space::Core, "object") => self.end_object(),
            (Space::Core, "basematerials") | (Space::Materials, _) if self.ends_property(name) => {
                let ended = self.property.take();
                self.model.properties.extend(ended);
                Ok(())
            }
            (Space::Core, "model") => {
                self.root = Root::Ended;
                Ok(())
            }
            _ => Ok(()),
        }
    }

    fn start_model(&mut self, element: &BytesStart<'_>) -> Result<(), Error> {
        if self.root != Root::Awaited {
            return Err(self.error("a model within or after a model"));
        }
        self.root = Root::Begun;
        let mut required = String::new();
        for attribute in element.attributes().with_checks(false) {
            let attribute = self.attribute(attribute)?;
            match attribute.key.0 {
                "unit" => self.unit(&attribute)?,
                "requiredextensions" => required = self.value(&attribute)?.into_owned(),
                _ => {}
            }
        }
        self.spaces.check_required(&required)
    }

    fn unit(&mut self, attribute: &Attribute<'_>) -> Result<(), Error> {
        let name = self.value(attribute)?;
        self.model.unit = match &*name {
            "micron" => 0.001,
            "millimeter" => 1.0,
            "centimeter" => 10.0,
            "inch" => 25.4,
            "foot" => 304.8,
            "meter" => 1000.0,
            name => return Err(self.error(format!("the unit {} is none of 3MF", xml::quoted(name)))),
        };
        if self.model.unit != 1.0 && self.own == 0 {
            let times = self.model.unit;
            self.notes
                .say(format!("the unit of the file is the {name}; it is read in millimetres, times {times}"));
        }
        Ok(())
    }

    /// Metadata are counted; what says which program wrote the file is not the user's.
    fn metadata(&mut self, element: &BytesStart<'_>) -> Result<(), Error> {
        let name = self.text_attribute(element, "name")?;
        self.document.metadata += usize::from(name.as_deref() != Some("Application"));
        Ok(())
    }

    fn at(&self) -> u64 {
        self.reader.buffer_position()
    }

    fn error(&self, what: impl Into<String>) -> Error {
        malformed(Format::ThreeMf, xml::place(self.part, self.at()), what)
    }

    fn charge(&mut self, bytes: u64) -> Result<(), Error> {
        self.reader.get_mut().get_mut().budget().charge(bytes)
    }

    #[inline]
    fn attribute<'e>(
        &self,
        attribute: Result<Attribute<'e>, quick_xml::events::attributes::AttrError>,
    ) -> Result<Attribute<'e>, Error> {
        attribute.map_err(|error| xml::error(self.part, self.at(), &error.into()))
    }

    fn value<'e>(&self, attribute: &Attribute<'e>) -> Result<std::borrow::Cow<'e, str>, Error> {
        xml::value(attribute, self.part, self.at())
    }

    /// The text of an attribute, if it is there.
    fn text_attribute(&self, element: &BytesStart<'_>, key: &str) -> Result<Option<String>, Error> {
        for attribute in element.attributes().with_checks(false) {
            let attribute = self.attribute(attribute)?;
            if attribute.key.0 == key {
                return Ok(Some(self.value(&attribute)?.into_owned()));
            }
        }
        Ok(None)
    }

    /// A whole number that an attribute holds.
    #[inline]
    fn whole(&self, attribute: &Attribute<'_>) -> Result<u32, Error> {
        xml::whole(&attribute.value).ok_or_else(|| {
            let key = attribute.key.0;
            self.error(format!("{key} is {}, not a whole number", xml::quoted(&attribute.value)))
        })
    }
}
