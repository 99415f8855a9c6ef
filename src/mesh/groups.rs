//! Face groups: which object, group and material of its file a triangle came from.

/// Colour and name of a surface material.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// Name as in the file.
    pub name: String,
    /// Red, green, blue and opacity, linear, in 0..=1.
    pub base_color: [f32; 4],
}

/// A named set of triangles with one material.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FaceGroup {
    /// Name of the object, group or node; may be empty.
    pub name: String,
    /// The material, if the file gives one.
    pub material: Option<Material>,
}

/// The groups of a mesh. A mesh without any has `list` empty and `of_triangle` empty.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FaceGroups {
    /// The groups.
    pub list: Vec<FaceGroup>,
    /// For every triangle the index of its group in `list`; empty when `list` is empty.
    pub of_triangle: Vec<u32>,
}
