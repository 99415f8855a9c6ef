//! The value that a place inside a triangle has.

use smallvec::SmallVec;

use super::{Attribute, AttributeKind};
use crate::exact::barycentric::Place;

/// The value at a place of a triangle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Found {
    /// A corner that would have to say something has no value.
    Nothing,
    /// A value of the table, as it is.
    Same(u32),
    /// Another: it has been written.
    Made,
}

/// A number of values that may be in use at once: three corners.
type Rows<'a> = [&'a [f64]; 3];

/// The attributes of one mesh, by what interpolation has to know of them.
pub(super) struct Interpolator<'a> {
    attributes: &'a [Attribute],
    /// The sets of joints with their weights, by number.
    skin: Vec<[&'a Attribute; 2]>,
}

impl<'a> Interpolator<'a> {
    pub(super) fn new(attributes: &'a [Attribute]) -> Self {
        let mut skin: Vec<(u32, [&Attribute; 2])> = attributes
            .iter()
            .filter_map(|joints| {
                let number = joints.name.strip_prefix("JOINTS_")?;
                let weights = format!("WEIGHTS_{number}");
                let weights = attributes.iter().find(|attribute| attribute.name == weights)?;
                Some((number.parse().ok()?, [joints, weights]))
            })
            .collect();
        skin.sort_by_key(|&(number, _)| number);
        Self { attributes, skin: skin.into_iter().map(|(_, pair)| pair).collect() }
    }

    /// The value that a place of a triangle has of an attribute. What is made is appended to `made`.
    pub(super) fn value(&self, attribute: usize, triangle: u32, place: Place, made: &mut Vec<f64>) -> Found {
        let attribute = &self.attributes[attribute];
        let kind = attribute.kind();
        let skin_set =
            self.skin.iter().position(|pair| pair.iter().any(|of_skin| std::ptr::eq(*of_skin, attribute)));
        // 1. What the corners say that have any weight.
        let weights = place.weights();
        let of_corner = corners(attribute, triangle);
        let mut involved = (0..3).filter(|&k| weights[k] > 0.0);
        let Some(first) = involved.next() else { return Found::Nothing };
        let first = of_corner[first];
        let is_same = |other: u32| {
            other == first
                || attribute
                    .value(other)
                    .is_some_and(|other| attribute.value(first).is_some_and(|value| same_bits(value, other)))
        };
        let (mut all_same, mut all_there) = (true, attribute.value(first).is_some());
        for k in involved {
            all_there &= attribute.value(of_corner[k]).is_some();
            all_same &= is_same(of_corner[k]);
        }
        if !all_there {
            return Found::Nothing;
        }
        // 2. Nothing to do, or between them.
        match (kind, skin_set) {
            (AttributeKind::Joints | AttributeKind::Weights, Some(set)) => {
                return self.skin_value(set, kind, triangle, weights, made);
            }
            (AttributeKind::Joints, None) => {
                let most = (1..3).fold(0, |most, k| if weights[k] > weights[most] { k } else { most });
                return Found::Same(of_corner[most]);
            }
            _ if all_same => return Found::Same(first),
            _ => {}
        }
        let Some(rows) = rows(attribute, of_corner, first) else { return Found::Nothing };
        let start = made.len();
        blend(rows, place, made);
        finish(kind, &mut made[start..], nearest(rows, weights));
        Found::Made
    }

    /// A set of joints or of their weights: all sets added up by joint, the heaviest kept.
    fn skin_value(
        &self,
        set: usize,
        kind: AttributeKind,
        triangle: u32,
        weights: [f64; 3],
        made: &mut Vec<f64>,
    ) -> Found {
        // 1. A corner alone keeps what it has.
        let is_weight = kind == AttributeKind::Weights;
        if let Some(k) = (0..3).find(|&k| weights[k] == 1.0) {
            return Found::Same(corners(self.skin[set][usize::from(is_weight)], triangle)[k]);
        }
        // 2. How much each joint has.
        let mut of_joint: SmallVec<[(f64, f64); 16]> = SmallVec::new();
        for [joints, weights_of_joints] in &self.skin {
            let (j, w) = (corners(joints, triangle), corners(weights_of_joints, triangle));
            for k in (0..3).filter(|&k| weights[k] > 0.0) {
                let (Some(joints), Some(of_joints)) = (joints.value(j[k]), weights_of_joints.value(w[k]))
                else {
                    return Found::Nothing;
                };
                for (&joint, &weight) in joints.iter().zip(of_joints) {
                    let share = weights[k] * weight;
                    match of_joint.iter_mut().find(|entry| entry.0 == joint) {
                        Some(entry) => entry.1 += share,
                        None if share > 0.0 => of_joint.push((joint, share)),
                        None => {}
                    }
                }
            }
        }
        // 3. The heaviest, of equal ones the first joints.
        of_joint.sort_by(|x, y| y.1.total_cmp(&x.1).then(x.0.total_cmp(&y.0)));
        let components = self.skin[set][0].components;
        of_joint.truncate(components * self.skin.len());
        let sum: f64 = of_joint.iter().map(|entry| entry.1).sum();
        for place in 0..components {
            let (joint, share) = of_joint.get(components * set + place).copied().unwrap_or_default();
            made.push(if is_weight { share / sum.max(f64::MIN_POSITIVE) } else { joint });
        }
        Found::Made
    }
}

/// The values of a triangle's corners, counted in the table.
fn corners(attribute: &Attribute, triangle: u32) -> [u32; 3] {
    let first = 3 * triangle as usize;
    [0, 1, 2].map(|k| attribute.of_corner.get(first + k).copied().unwrap_or(Attribute::NONE))
}

/// The three values; a corner that has none has no weight either, and stands in with another's.
fn rows<'a>(attribute: &'a Attribute, of_corner: [u32; 3], first: u32) -> Option<Rows<'a>> {
    let stand_in = attribute.value(first)?;
    Some(of_corner.map(|index| attribute.value(index).unwrap_or(stand_in)))
}

fn same_bits(x: &[f64], y: &[f64]) -> bool {
    x.iter().zip(y).all(|(x, y)| x.to_bits() == y.to_bits())
}

/// The corner with the most weight, the first of equal ones.
fn nearest<'a>(rows: Rows<'a>, weights: [f64; 3]) -> &'a [f64] {
    rows[(1..3).fold(0, |most, k| if weights[k] > weights[most] { k } else { most })]
}

/// Appends the value between three. On a side only its ends count, in the order of the place, so that the triangle beyond it
/// that has the same values there gets the same bits.
fn blend(rows: Rows<'_>, place: Place, made: &mut Vec<f64>) {
    let components = 0..rows[0].len();
    match place {
        Place::Side { ends: [from, to], at } => {
            // From the nearer end, which then keeps its bits.
            let (from, to, at) = if at > 0.5 { (to, from, 1.0 - at) } else { (from, to, at) };
            made.extend(components.map(|i| rows[from][i] + at * (rows[to][i] - rows[from][i])));
        }
        Place::Inside(weights) => {
            let base = (1..3).fold(0, |most, k| if weights[k] > weights[most] { k } else { most });
            let (i, j) = ((base + 1) % 3, (base + 2) % 3);
            made.extend(components.map(|c| {
                let value = rows[base][c];
                value + weights[i] * (rows[i][c] - value) + weights[j] * (rows[j][c] - value)
            }));
        }
    }
}

/// Makes of a sum what the attribute has to be; `nearest` is what the nearest corner says.
fn finish(kind: AttributeKind, value: &mut [f64], nearest: &[f64]) {
    match kind {
        AttributeKind::Normal | AttributeKind::Tangent => {
            let length = value[..3].iter().fold(0.0f64, |length, x| length.hypot(*x));
            if length > 0.0 {
                value[..3].iter_mut().for_each(|x| *x /= length);
            } else {
                // Opposite directions have nothing between them.
                value[..3].copy_from_slice(&nearest[..3]);
            }
            if let (Some(hand), Some(&of_nearest)) = (value.get_mut(3), nearest.get(3)) {
                *hand = of_nearest;
            }
        }
        AttributeKind::Colour => value.iter_mut().for_each(|x| *x = x.clamp(0.0, 1.0)),
        AttributeKind::Joints | AttributeKind::Weights | AttributeKind::Plain => {}
    }
    // Values at the ends of the range of numbers may leave it between them.
    if !value.iter().all(|x| x.is_finite()) {
        value.copy_from_slice(nearest);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn attribute(name: &str, components: usize, values: &[f64]) -> Attribute {
        Attribute { name: name.into(), components, values: values.to_vec(), of_corner: vec![0, 1, 2] }
    }

    fn value(attributes: &[Attribute], index: usize, place: Place) -> (Found, Vec<f64>) {
        let mut made = Vec::new();
        let found = Interpolator::new(attributes).value(index, 0, place, &mut made);
        (found, made)
    }

    const MIDDLE: Place = Place::Inside([0.25, 0.25, 0.5]);
    const HALFWAY: Place = Place::Side { ends: [0, 1], at: 0.5 };

    #[test]
    fn plain_values_and_colours_are_sums() {
        let uv = [attribute("TEXCOORD_0", 2, &[0.0, 0.0, 4.0, 0.0, 0.0, 8.0])];
        assert_eq!(value(&uv, 0, MIDDLE), (Found::Made, vec![1.0, 4.0]));
        assert_eq!(value(&uv, 0, HALFWAY), (Found::Made, vec![2.0, 0.0]));
        assert_eq!(value(&uv, 0, Place::Side { ends: [1, 2], at: 1.0 }), (Found::Same(2), vec![]));
        let colours = [attribute("COLOR_0", 3, &[2.0; 9])];
        assert_eq!(value(&colours, 0, MIDDLE), (Found::Same(0), vec![]));
        let colours = [attribute("COLOR_0", 3, &[2.0, 2.0, 0.5, 2.0, 2.0, 0.25, 2.0, 2.0, 0.5])];
        assert_eq!(value(&colours, 0, HALFWAY), (Found::Made, vec![1.0, 1.0, 0.375]));
    }

    #[test]
    fn a_corner_without_a_value_matters_where_it_has_weight() {
        let mut uv = [attribute("TEXCOORD_0", 2, &[0.0, 0.0, 4.0, 0.0])];
        uv[0].of_corner[2] = Attribute::NONE;
        assert_eq!(value(&uv, 0, MIDDLE).0, Found::Nothing);
        assert_eq!(value(&uv, 0, HALFWAY), (Found::Made, vec![2.0, 0.0]));
    }

    #[test]
    fn directions_keep_their_length() {
        let normals = [attribute("NORMAL", 3, &[1.0, 0.0, 0.0, 0.0, 1.0, 0.0, -1.0, 0.0, 0.0])];
        let half = 0.5f64.sqrt();
        let (found, made) = value(&normals, 0, HALFWAY);
        assert_eq!(found, Found::Made);
        assert!((made[0] - half).abs() < 1e-15 && (made[1] - half).abs() < 1e-15);
        // Opposite ones.
        assert_eq!(value(&normals, 0, Place::Side { ends: [0, 2], at: 0.5 }).1, [1.0, 0.0, 0.0]);
        let tangents =
            [attribute("TANGENT", 4, &[1.0, 0.0, 0.0, -1.0, 0.0, 1.0, 0.0, -1.0, 0.0, 0.0, 1.0, 1.0])];
        assert_eq!(value(&tangents, 0, HALFWAY).1[3], -1.0);
    }

    #[test]
    fn joints_are_added_up_by_number() {
        let skin = [
            attribute("JOINTS_0", 4, &[1.0, 2.0, 3.0, 4.0, 2.0, 5.0, 6.0, 7.0, 1.0, 0.0, 0.0, 0.0]),
            attribute("WEIGHTS_0", 4, &[0.4, 0.3, 0.2, 0.1, 0.4, 0.3, 0.2, 0.1, 1.0, 0.0, 0.0, 0.0]),
        ];
        assert_eq!(value(&skin, 0, HALFWAY).1, [2.0, 1.0, 5.0, 3.0]);
        let weights = value(&skin, 1, HALFWAY).1;
        let sum = 0.35 + 0.2 + 0.15 + 0.1;
        let expected = [0.35, 0.2, 0.15, 0.1].map(|x| x / sum);
        assert!((0..4).all(|k| (weights[k] - expected[k]).abs() < 1e-15), "{weights:?}");
        assert_eq!(value(&skin, 0, Place::Side { ends: [0, 1], at: 1.0 }), (Found::Same(1), vec![]));
        let unweighted = [skin[0].clone()];
        assert_eq!(value(&unweighted, 0, MIDDLE), (Found::Same(2), vec![]));
    }
}
