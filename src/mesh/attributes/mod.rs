//! Attributes: what a file says of the corners of its triangles, such as texture coordinates, normals and colours.

mod affine;
mod carry;
mod descent;
mod interpolate;
mod lists;
mod moved;
mod pieces;
mod plan;
mod table;

pub(crate) use affine::continues;
pub(crate) use carry::carry;
pub(crate) use descent::{CornerPlace, Descent, Run, reach};
pub(super) use lists::{append, keep, reverse, reverse_some, selected};
pub(crate) use moved::moved;
pub(super) use moved::turn_corners;
pub(crate) use pieces::of_pieces;

use super::{AttributeFault, Mesh, MeshError};

/// What is wrong with the attributes of a mesh of `triangles` triangles, if anything.
pub(super) fn check(attributes: &[Attribute], triangles: usize) -> Result<(), MeshError> {
    for (index, attribute) in attributes.iter().enumerate() {
        let twice = attributes[..index].iter().any(|before| before.name == attribute.name);
        let fault = if twice { Some(AttributeFault::Twice) } else { attribute.fault(triangles) };
        if let Some(fault) = fault {
            return Err(MeshError::Attribute { name: attribute.name.clone(), fault });
        }
    }
    Ok(())
}

/// Values at the corners of a mesh's triangles: a table, and for every corner the row that it has.
///
/// Corners share rows where the file does, so that a seam is nothing but two rows at one vertex, and a vertex stays one
/// vertex. Numbers are `f64`, which holds every number of every file to the bit.
///
/// ```
/// use trisect::mesh::Attribute;
///
/// // One triangle with texture coordinates; the next one has none.
/// let uv = Attribute {
///     name: "TEXCOORD_0".into(),
///     components: 2,
///     values: vec![0.0, 0.0, 1.0, 0.0, 0.0, 1.0],
///     of_corner: vec![0, 1, 2, Attribute::NONE, Attribute::NONE, Attribute::NONE],
/// };
/// assert_eq!(uv.at(0, 1), Some(&[1.0, 0.0][..]));
/// assert_eq!(uv.at(1, 1), None);
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Attribute {
    /// A name of glTF (`NORMAL`, `TANGENT`, `TEXCOORD_n`, `COLOR_n`, `JOINTS_n`, `WEIGHTS_n`), or one of its own, which
    /// begins with an underscore (`_TEMPERATURE`). It says how values are interpolated: see [`AttributeKind`].
    pub name: String,
    /// How many numbers a value has: 3 for `NORMAL`, 4 for `TANGENT`, `JOINTS_n` and `WEIGHTS_n`, 2 for `TEXCOORD_n`, 3 or
    /// 4 for `COLOR_n` (linear, in 0..=1), any number but 0 for others.
    pub components: usize,
    /// The table: `components` finite numbers for each value, one value after the other.
    pub values: Vec<f64>,
    /// For every corner, three for a triangle, the value it has, counted in values; [`NONE`](Self::NONE) for none.
    pub of_corner: Vec<u32>,
}

/// What the values of an attribute are, by its name: how they are interpolated, turned and reversed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum AttributeKind {
    /// `NORMAL`: a direction, renormalised where interpolated, reversed with its face, moved by the inverse transpose.
    Normal,
    /// `TANGENT`: a direction and a sign. The direction moves with the surface; the sign changes with the side of the face
    /// and in a mirror.
    Tangent,
    /// `COLOR_n`: kept within 0..=1.
    Colour,
    /// `JOINTS_n`: numbers of joints, which are interpolated by their `WEIGHTS_n`: never numbers between two joints.
    Joints,
    /// `WEIGHTS_n`: interpolated joint by joint, the largest ones kept, with sum 1.
    Weights,
    /// `TEXCOORD_n` and names with an underscore: interpolated, and nothing else.
    Plain,
}

impl AttributeKind {
    /// Whether values say which side of a face is out, so that they change where it is turned round.
    pub(crate) fn has_sides(self) -> bool {
        matches!(self, Self::Normal | Self::Tangent)
    }

    /// Whether values of this kind and name may have so many components.
    pub(crate) fn allows(self, name: &str, components: usize) -> bool {
        match self {
            Self::Normal => components == 3,
            Self::Tangent | Self::Joints | Self::Weights => components == 4,
            Self::Colour => matches!(components, 3 | 4),
            Self::Plain if !name.starts_with('_') => components == 2,
            Self::Plain => components > 0,
        }
    }

    /// What a name says; `None` for a name that is neither one of glTF nor begins with an underscore.
    #[must_use]
    pub fn of(name: &str) -> Option<Self> {
        let numbered = |stem: &str| {
            let number = name.strip_prefix(stem)?;
            (!number.is_empty() && number.bytes().all(|byte| byte.is_ascii_digit())).then_some(())
        };
        if name.starts_with('_') || numbered("TEXCOORD_").is_some() {
            return Some(Self::Plain);
        }
        let stems = [("COLOR_", Self::Colour), ("JOINTS_", Self::Joints), ("WEIGHTS_", Self::Weights)];
        match name {
            "NORMAL" => Some(Self::Normal),
            "TANGENT" => Some(Self::Tangent),
            _ => stems.into_iter().find(|&(stem, _)| numbered(stem).is_some()).map(|(_, kind)| kind),
        }
    }
}

impl Attribute {
    /// In [`of_corner`](Self::of_corner): the corner has no value.
    pub const NONE: u32 = u32::MAX;

    /// An attribute without corners and values, to be filled.
    #[must_use]
    pub fn new(name: impl Into<String>, components: usize) -> Self {
        Self { name: name.into(), components, ..Self::default() }
    }

    /// What its name says of its values; [`AttributeKind::Plain`] for a name that says nothing.
    #[must_use]
    pub fn kind(&self) -> AttributeKind {
        AttributeKind::of(&self.name).unwrap_or(AttributeKind::Plain)
    }

    /// How many values the table has.
    #[must_use]
    pub fn len(&self) -> usize {
        self.values.len() / self.components.max(1)
    }

    /// Whether the table has no values.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.values.is_empty()
    }

    /// A value of the table, if there is one of that number.
    #[must_use]
    pub fn value(&self, index: u32) -> Option<&[f64]> {
        let first = (index as usize).checked_mul(self.components)?;
        self.values.get(first..first.checked_add(self.components)?).filter(|value| !value.is_empty())
    }

    /// The value at corner `corner` (0, 1 or 2) of a triangle; `None` if it has none.
    #[must_use]
    pub fn at(&self, triangle: usize, corner: usize) -> Option<&[f64]> {
        let &index = self.of_corner.get(triangle.checked_mul(3)?.checked_add(corner)?)?;
        self.value(index)
    }

    /// What is wrong with the attribute for a mesh of `triangles` triangles, if anything.
    pub(crate) fn fault(&self, triangles: usize) -> Option<AttributeFault> {
        let Some(kind) = AttributeKind::of(&self.name) else { return Some(AttributeFault::Name) };
        let components = self.components;
        if !kind.allows(&self.name, components) {
            return Some(AttributeFault::Components { components });
        }
        let (numbers, corners) = (self.values.len(), self.of_corner.len());
        if !numbers.is_multiple_of(components) || numbers / components >= Self::NONE as usize {
            return Some(AttributeFault::Values { numbers, components });
        }
        if corners != 3 * triangles {
            return Some(AttributeFault::Count { corners, triangles });
        }
        let values = numbers / components;
        let outside = |&index: &u32| index as usize >= values && index != Self::NONE;
        if let Some(wrong) = self.of_corner.iter().position(outside) {
            let (triangle, corner, value) = (wrong / 3, wrong % 3, self.of_corner[wrong]);
            return Some(AttributeFault::OutOfRange { triangle, corner, value, values });
        }
        let wrong = self.values.iter().position(|number| !number.is_finite())?;
        Some(AttributeFault::NotFinite { value: wrong / components, number: self.values[wrong] })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_say_how_values_are_taken() {
        assert_eq!(AttributeKind::of("NORMAL"), Some(AttributeKind::Normal));
        assert_eq!(AttributeKind::of("COLOR_12"), Some(AttributeKind::Colour));
        assert_eq!(AttributeKind::of("TEXCOORD_0"), Some(AttributeKind::Plain));
        assert_eq!(AttributeKind::of("_TEMPERATURE"), Some(AttributeKind::Plain));
        for name in ["", "COLOR", "COLOR_", "COLOR_x", "normal", "TEMPERATURE", "WEIGHTS_-1"] {
            assert_eq!(AttributeKind::of(name), None, "{name}");
        }
    }

    #[test]
    fn faults_are_named() {
        let good = Attribute {
            name: "TEXCOORD_0".into(),
            components: 2,
            values: vec![0.0, 0.5],
            of_corner: vec![0, 0, Attribute::NONE],
        };
        assert_eq!(good.fault(1), None);
        let fault = |attribute: Attribute| attribute.fault(1).map(|fault| fault.to_string());
        let said = |attribute, words: &str| {
            let text = fault(attribute).unwrap();
            assert!(text.contains(words), "{text}");
        };
        said(Attribute { name: "HEAT".into(), ..good.clone() }, "begins with an underscore");
        said(Attribute { components: 3, ..good.clone() }, "3 numbers");
        said(Attribute { components: 0, name: "_X".into(), ..good.clone() }, "0 numbers");
        said(Attribute { values: vec![0.0; 3], ..good.clone() }, "3 numbers are no whole number");
        said(Attribute { of_corner: vec![0; 4], ..good.clone() }, "4 corners");
        said(Attribute { of_corner: vec![0, 1, 0], ..good.clone() }, "corner 1 of triangle 0 names value 1");
        said(Attribute { values: vec![0.0, f64::NAN], ..good }, "value 0 is not finite");
    }
}
