//! Attributes as a file holds them: which numbers, and what stands where a corner has no value.

use gltf_json::accessor::ComponentType;

use crate::Mesh;
use crate::mesh::{Attribute, AttributeKind};

/// Values have at most so many components in glTF.
const MOST_COMPONENTS: usize = 4;

/// A file has at most so many attributes, one bit of a part each. Devices have room for sixteen.
const MOST_COLUMNS: usize = 64;

/// How far the length of a direction may be from one before it is set right: below what validators admit, above what rounding
/// to bytes does.
const UNIT_TOLERANCE: f64 = 5e-4;

/// An attribute that is written.
pub(super) struct Column<'a> {
    pub(super) attribute: &'a Attribute,
    pub(super) number: Number,
    /// The value of corners without one, where others of the same primitive have some.
    filler: [f64; 4],
}

/// How numbers are held.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Number {
    Single,
    /// Parts of 255 or of 65,535.
    Bytes,
    Shorts,
    /// Whole numbers.
    Whole8,
    Whole16,
}

impl<'a> Column<'a> {
    /// The attributes of a mesh that glTF can hold, and what is said of the others. Joints and weights need the skeleton that
    /// the mesh does not have, so they are written only if `skinned`.
    pub(super) fn of(mesh: &'a Mesh, skinned: bool, warnings: &mut Vec<String>) -> Vec<Self> {
        let mut columns = Vec::new();
        let mut unskinned = false;
        for attribute in &mesh.attributes {
            let kind = attribute.kind();
            if attribute.of_corner.iter().all(|&index| index == Attribute::NONE) {
                continue;
            }
            if matches!(kind, AttributeKind::Joints | AttributeKind::Weights) && !skinned {
                unskinned = true;
                continue;
            }
            if attribute.components > MOST_COMPONENTS {
                warnings.push(format!(
                    "attribute {} not written: it has {} components, glTF has at most {MOST_COMPONENTS}",
                    attribute.name, attribute.components
                ));
                continue;
            }
            if columns.len() == MOST_COLUMNS {
                warnings.push(format!(
                    "attribute {} not written: a file has at most {MOST_COLUMNS}",
                    attribute.name
                ));
                continue;
            }
            let filler = match kind {
                AttributeKind::Normal => [0.0, 0.0, 1.0, 0.0],
                AttributeKind::Tangent => [1.0, 0.0, 0.0, 1.0],
                AttributeKind::Colour => [1.0; 4],
                // All sets together have the sum 1.
                AttributeKind::Weights if attribute.name == "WEIGHTS_0" => [1.0, 0.0, 0.0, 0.0],
                _ => [0.0; 4],
            };
            columns.push(Self { attribute, number: Number::of(attribute), filler });
        }
        if unskinned {
            warnings.push(
                "joints and weights not written: the skeleton that they belong to is not kept".to_string(),
            );
        }
        columns
    }

    pub(super) fn components(&self) -> usize {
        self.attribute.components
    }

    /// Bytes from one value to the next, a multiple of four.
    pub(super) fn stride(&self) -> usize {
        (self.components() * self.number.size()).next_multiple_of(4)
    }

    /// A value, or what stands for none.
    pub(super) fn value(&self, index: u32) -> &[f64] {
        self.attribute.value(index).unwrap_or(&self.filler[..self.components()])
    }

    /// Writes a value into `stride` bytes. Directions have the length one in glTF; OBJ has them of any.
    pub(super) fn write(&self, index: u32, bytes: &mut [u8]) {
        let size = self.number.size();
        let mut unit = [0.0; 4];
        let mut numbers = self.value(index);
        if matches!(self.attribute.kind(), AttributeKind::Normal | AttributeKind::Tangent) {
            let length = numbers.iter().take(3).map(|x| x * x).sum::<f64>().sqrt();
            if !(1.0 - UNIT_TOLERANCE..=1.0 + UNIT_TOLERANCE).contains(&length) {
                unit[..numbers.len()].copy_from_slice(numbers);
                if length > 0.0 && length.is_finite() {
                    unit.iter_mut().take(3).for_each(|x| *x /= length);
                } else {
                    unit[..3].copy_from_slice(&self.filler[..3]);
                }
                numbers = &unit[..numbers.len()];
            }
        }
        for (bytes, &value) in bytes.chunks_exact_mut(size).zip(numbers) {
            match self.number {
                // Infinite numbers are not allowed.
                Number::Single => {
                    bytes.copy_from_slice(&(value as f32).clamp(f32::MIN, f32::MAX).to_le_bytes());
                }
                Number::Bytes => bytes[0] = (value * 255.0).round() as u8,
                Number::Shorts => bytes.copy_from_slice(&((value * 65_535.0).round() as u16).to_le_bytes()),
                Number::Whole8 => bytes[0] = value as u8,
                Number::Whole16 => bytes.copy_from_slice(&(value as u16).to_le_bytes()),
            }
        }
    }

    /// Whether two values are the same in the file.
    pub(super) fn is_same(&self, a: u32, b: u32) -> bool {
        if a == b {
            return true;
        }
        let (a, b) = (self.value(a), self.value(b));
        a.iter()
            .zip(b)
            .all(|(&a, &b)| a.to_bits() == b.to_bits() || (a as f32).to_bits() == (b as f32).to_bits())
    }
}

impl Number {
    /// The smallest numbers that hold all values to the bit, else single precision.
    fn of(attribute: &Attribute) -> Self {
        let all = |holds: &dyn Fn(f64) -> bool| attribute.values.iter().all(|&value| holds(value));
        let is_whole =
            |largest: f64| move |value: f64| (0.0..=largest).contains(&value) && value.fract() == 0.0;
        let is_part =
            |of: f64| move |value: f64| (0.0..=1.0).contains(&value) && (value * of).round() / of == value;
        match attribute.kind() {
            AttributeKind::Joints => {
                if all(&is_whole(255.0)) {
                    Self::Whole8
                } else {
                    Self::Whole16
                }
            }
            AttributeKind::Normal | AttributeKind::Tangent => Self::Single,
            _ if attribute.name.starts_with('_') => Self::Single,
            _ if all(&|value| f64::from(value as f32) == value) => Self::Single,
            _ if all(&is_part(255.0)) => Self::Bytes,
            _ if all(&is_part(65_535.0)) => Self::Shorts,
            _ => Self::Single,
        }
    }

    fn size(self) -> usize {
        match self {
            Self::Single => 4,
            Self::Bytes | Self::Whole8 => 1,
            Self::Shorts | Self::Whole16 => 2,
        }
    }

    /// The type of glTF, and whether it is normalised.
    pub(super) fn component_type(self) -> (ComponentType, bool) {
        match self {
            Self::Single => (ComponentType::F32, false),
            Self::Bytes => (ComponentType::U8, true),
            Self::Shorts => (ComponentType::U16, true),
            Self::Whole8 => (ComponentType::U8, false),
            Self::Whole16 => (ComponentType::U16, false),
        }
    }
}
