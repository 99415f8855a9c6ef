//! What a package says, before it is one mesh.

use std::collections::HashMap;

use glam::DAffine3;

/// The models of a package.
#[derive(Default)]
pub(super) struct Document {
    /// The names of the parts that hold models, the first one the root; each once.
    pub(super) paths: Vec<String>,
    by_path: HashMap<String, u32>,
    /// Their models, in the same order.
    pub(super) models: Vec<Model>,
    /// How many pieces of metadata there are.
    pub(super) metadata: usize,
}

impl Document {
    /// The number of a part by its name.
    pub(super) fn path(&mut self, name: &str) -> u32 {
        let paths = &mut self.paths;
        *self.by_path.entry(name.to_ascii_lowercase()).or_insert_with(|| {
            paths.push(name.to_owned());
            paths.len() as u32 - 1
        })
    }
}

/// One model.
#[derive(Default)]
pub(super) struct Model {
    /// How many millimetres its unit is.
    pub(super) unit: f64,
    pub(super) objects: HashMap<u32, Object>,
    pub(super) properties: HashMap<u32, Property>,
    /// What is built.
    pub(super) items: Vec<Placed>,
}

/// What triangles may be made of.
pub(super) enum Property {
    /// Base materials: name and colour, red, green, blue and opacity.
    Base(Vec<(String, [u8; 4])>),
    /// Colours.
    Colours(Vec<[u8; 4]>),
    /// Pictures, mixtures and others, by what is said of triangles that have them.
    Other(&'static str),
}

/// A mesh, or objects put together.
#[derive(Default)]
pub(super) struct Object {
    pub(super) name: String,
    /// What it is for, where that is not the model itself.
    pub(super) left_out: Option<&'static str>,
    /// What triangles without a label have.
    pub(super) label: Option<Label>,
    pub(super) mesh: ObjectMesh,
    pub(super) components: Vec<Placed>,
}

/// The mesh of an object.
#[derive(Default)]
pub(super) struct ObjectMesh {
    pub(super) positions: Vec<[f64; 3]>,
    pub(super) triangles: Vec<[u32; 3]>,
    /// For every triangle what it says of itself; empty if none says anything.
    pub(super) labels: Vec<Option<Label>>,
    /// For every triangle the last triangle set it is in, counted from 1, or 0; empty if there are no sets.
    pub(super) sets: Vec<u32>,
    pub(super) set_names: Vec<String>,
}

/// Which entries of a property the corners of a triangle have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Label {
    pub(super) property: u32,
    pub(super) indices: [u32; 3],
}

/// An object at a place.
#[derive(Clone, Copy)]
pub(super) struct Placed {
    pub(super) object: u32,
    /// The number of the part that it stands in.
    pub(super) part: u32,
    pub(super) transform: Option<DAffine3>,
}
