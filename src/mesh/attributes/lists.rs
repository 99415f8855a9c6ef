//! Attributes of meshes that are put together, of which triangles are left out, or whose triangles are turned round.

use rustc_hash::FxHashMap;

use super::{Attribute, AttributeKind};

/// What a missing component of an attribute is taken for: full opacity, a tangent space that is not mirrored, or nothing.
pub(super) fn missing(kind: AttributeKind) -> f64 {
    match kind {
        AttributeKind::Colour | AttributeKind::Tangent => 1.0,
        _ => 0.0,
    }
}

/// Appends the attributes `other` of `added` further triangles to those of `own` triangles. Those of one name become one:
/// a side that does not have it has no values there, and the side with fewer components gets opacity 1 or zeros.
pub(in crate::mesh) fn append(
    attributes: &mut Vec<Attribute>,
    own: usize,
    other: &[Attribute],
    added: usize,
) {
    for addition in other {
        let found = attributes.iter().position(|attribute| attribute.name == addition.name);
        let index = found.unwrap_or_else(|| {
            let mut fresh = Attribute::new(addition.name.clone(), addition.components);
            fresh.of_corner = vec![Attribute::NONE; 3 * own];
            attributes.push(fresh);
            attributes.len() - 1
        });
        attributes[index].append(addition);
    }
    for attribute in attributes {
        attribute.of_corner.resize(3 * (own + added), Attribute::NONE);
    }
}

/// Keeps of the attributes what the triangles `kept` have, in that order. The tables stay as they are.
pub(in crate::mesh) fn keep(attributes: &mut [Attribute], kept: &[u32]) {
    for attribute in attributes {
        let corners = |&triangle: &u32| {
            let first = 3 * triangle as usize;
            [0, 1, 2].map(|k| attribute.of_corner.get(first + k).copied().unwrap_or(Attribute::NONE))
        };
        attribute.of_corner = kept.iter().flat_map(corners).collect();
    }
}

/// The same as a copy, without the values that none of them has.
pub(in crate::mesh) fn selected(attributes: &[Attribute], kept: &[u32]) -> Vec<Attribute> {
    let of_kept = |attribute: &Attribute| {
        let mut of_corner: Vec<u32> = Vec::with_capacity(3 * kept.len());
        for &triangle in kept {
            let first = 3 * triangle as usize;
            let corner = |k: usize| attribute.of_corner.get(first + k).copied().unwrap_or(Attribute::NONE);
            of_corner.extend([0, 1, 2].map(corner));
        }
        // Sorted, so that what few triangles of many have is found without a look at the whole table.
        let mut used: Vec<u32> =
            of_corner.iter().copied().filter(|&index| attribute.value(index).is_some()).collect();
        used.sort_unstable();
        used.dedup();
        let number = |index: &u32| used.binary_search(index).map_or(Attribute::NONE, |number| number as u32);
        Attribute {
            name: attribute.name.clone(),
            components: attribute.components,
            values: used.iter().filter_map(|&index| attribute.value(index)).flatten().copied().collect(),
            of_corner: of_corner.iter().map(number).collect(),
        }
    };
    attributes.iter().map(of_kept).collect()
}

/// The attributes of a mesh with every triangle turned round: the last two corners change places, normals point the other
/// way, and tangent spaces change hands.
pub(in crate::mesh) fn reverse(attributes: &mut [Attribute]) {
    for attribute in attributes {
        attribute.of_corner.chunks_exact_mut(3).for_each(|corners| corners.swap(1, 2));
        let (kind, components) = (attribute.kind(), attribute.components.max(1));
        attribute.values.chunks_exact_mut(components).for_each(|value| turn_over(kind, value));
    }
}

/// The same for some triangles, each once.
pub(in crate::mesh) fn reverse_some(attributes: &mut [Attribute], turned: &[u32]) {
    for attribute in attributes {
        let has_sides = attribute.kind().has_sides();
        let mut other_side: FxHashMap<u32, u32> = FxHashMap::default();
        for &triangle in turned {
            let first = 3 * triangle as usize;
            let Some(corners) = attribute.of_corner.get_mut(first..first + 3) else { continue };
            corners.swap(1, 2);
            for corner in first..first + 3 {
                let index = attribute.of_corner[corner];
                if has_sides && index != Attribute::NONE {
                    attribute.of_corner[corner] =
                        *other_side.entry(index).or_insert_with(|| attribute.push_turned(index));
                }
            }
        }
    }
}

/// The value as it is on the other side of its face.
pub(in crate::mesh) fn turn_over(kind: AttributeKind, value: &mut [f64]) {
    match kind {
        AttributeKind::Normal => value.iter_mut().for_each(|x| *x = 0.0 - *x),
        AttributeKind::Tangent => value.iter_mut().skip(3).for_each(|x| *x = -*x),
        _ => {}
    }
}

impl Attribute {
    /// Appends further values, those of no corner yet.
    pub(crate) fn push_values(&mut self, addition: Self) {
        if self.values.is_empty() && self.of_corner.iter().all(|&index| index == Self::NONE) {
            (self.values, self.components) = (addition.values, addition.components);
        } else {
            self.append(&addition);
        }
    }

    fn append(&mut self, addition: &Self) {
        let components = self.components.max(addition.components);
        self.widen(components);
        let first = self.len() as u32;
        let shifted = |&index: &u32| if index == Self::NONE { index } else { index.saturating_add(first) };
        self.of_corner.extend(addition.of_corner.iter().map(shifted));
        if addition.components == components {
            self.values.extend_from_slice(&addition.values);
        } else {
            self.values.extend(all_widened(addition, components));
        }
    }

    fn widen(&mut self, components: usize) {
        if self.components < components {
            self.values = all_widened(self, components).collect();
            self.components = components;
        }
    }

    /// A further value: that one as it is on the other side.
    fn push_turned(&mut self, index: u32) -> u32 {
        let Some(mut value) = self.value(index).map(<[f64]>::to_vec) else { return Self::NONE };
        turn_over(self.kind(), &mut value);
        self.values.extend(value);
        self.len() as u32 - 1
    }
}

fn all_widened(attribute: &Attribute, components: usize) -> impl Iterator<Item = f64> {
    let kind = attribute.kind();
    let values = attribute.values.chunks_exact(attribute.components.max(1));
    values.flat_map(move |value| widened(value, kind, components))
}

/// A value with that many components.
pub(super) fn widened(value: &[f64], kind: AttributeKind, components: usize) -> impl Iterator<Item = f64> {
    let fill = std::iter::repeat_n(missing(kind), components.saturating_sub(value.len()));
    value.iter().copied().chain(fill)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn attribute(name: &str, components: usize, values: &[f64], of_corner: &[u32]) -> Attribute {
        Attribute { name: name.into(), components, values: values.to_vec(), of_corner: of_corner.to_vec() }
    }

    #[test]
    fn appending_joins_by_name() {
        const NONE: u32 = Attribute::NONE;
        let mut own = vec![attribute("COLOR_0", 3, &[0.1, 0.2, 0.3], &[0, 0, NONE])];
        let other = [
            attribute("COLOR_0", 4, &[0.4, 0.5, 0.6, 0.7], &[0, NONE, 0]),
            attribute("_HEAT", 1, &[9.0], &[0, 0, 0]),
        ];
        append(&mut own, 1, &other, 1);
        assert_eq!(own[0].components, 4);
        assert_eq!(own[0].values, [0.1, 0.2, 0.3, 1.0, 0.4, 0.5, 0.6, 0.7]);
        assert_eq!(own[0].of_corner, [0, 0, NONE, 1, NONE, 1]);
        assert_eq!(own[1].of_corner, [NONE, NONE, NONE, 0, 0, 0]);
        append(&mut own, 2, &[], 1);
        assert!(own.iter().all(|attribute| attribute.fault(3).is_none()));
        assert_eq!(own[1].of_corner[6..], [NONE; 3]);
    }

    #[test]
    fn turning_some_leaves_the_others() {
        let mut normals = [attribute("NORMAL", 3, &[0.0, 0.0, 1.0], &[0; 6])];
        reverse_some(&mut normals, &[1]);
        assert_eq!(normals[0].values, [0.0, 0.0, 1.0, 0.0, 0.0, -1.0]);
        assert_eq!(normals[0].of_corner, [0, 0, 0, 1, 1, 1]);
        let mut tangents = [attribute("TANGENT", 4, &[1.0, 0.0, 0.0, 1.0, 0.0, 1.0, 0.0, -1.0], &[0, 1, 1])];
        reverse(&mut tangents);
        assert_eq!(tangents[0].values, [1.0, 0.0, 0.0, -1.0, 0.0, 1.0, 0.0, 1.0]);
        assert_eq!(tangents[0].of_corner, [0, 1, 1]);
        let mut uv = [attribute("TEXCOORD_0", 2, &[0.0, 0.0, 1.0, 0.0, 1.0, 1.0], &[0, 1, 2])];
        reverse_some(&mut uv, &[0]);
        assert_eq!(uv[0].of_corner, [0, 2, 1]);
    }

    #[test]
    fn a_choice_of_triangles_keeps_its_corners() {
        let mut uv = [attribute("TEXCOORD_0", 2, &[0.0; 12], &[0, 1, 2, 3, 4, 5])];
        let some = selected(&uv, &[1, 1]);
        keep(&mut uv, &[1, 0, 1]);
        assert_eq!(uv[0].of_corner, [3, 4, 5, 0, 1, 2, 3, 4, 5]);
        assert_eq!((some[0].len(), &some[0].of_corner[..]), (3, &[0, 1, 2, 0, 1, 2][..]));
    }

    #[test]
    fn what_does_not_fit_is_turned_as_far_as_it_goes() {
        let mut odd =
            [attribute("TANGENT", 2, &[1.0, 2.0], &[0]), attribute("NORMAL", 3, &[0.0; 3], &[0, 0, 0])];
        reverse_some(&mut odd, &[0, 1]);
        reverse(&mut odd);
        assert_eq!(odd[0].values, [1.0, 2.0]);
    }
}
