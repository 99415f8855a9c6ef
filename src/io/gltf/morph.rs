//! Morph targets: meshes in the shape that their weights show.

use std::collections::BTreeMap;

use serde_json::value::RawValue;

use super::accessor::{Accessors, shape_of};
use super::budget::Budget;
use crate::Error;
use crate::mesh::{Attribute, AttributeKind};

/// The accessors of a target, by attribute.
type Target = BTreeMap<String, u32>;

/// The targets of a primitive that have a weight.
#[derive(Default)]
pub(super) struct Morph<'a> {
    targets: Vec<(f64, Target)>,
    pointer: &'a str,
}

impl<'a> Morph<'a> {
    /// The targets of a primitive with the weights of its node or mesh.
    pub(super) fn new(
        targets: Option<&RawValue>,
        weights: &[f64],
        pointer: &'a str,
        accessors: &Accessors<'_>,
    ) -> Result<(Self, bool), Error> {
        let Some(text) = targets else { return Ok((Self { targets: Vec::new(), pointer }, false)) };
        let malformed = |error: serde_json::Error| {
            accessors.reader.error(format!("{pointer}/targets"), error.to_string())
        };
        let targets: Vec<&RawValue> = serde_json::from_str(text.get()).map_err(malformed)?;
        let any = !targets.is_empty();
        let mut shown = Vec::new();
        for (target, &weight) in targets.iter().zip(weights) {
            if weight != 0.0 {
                shown.push((weight, serde_json::from_str(target.get()).map_err(malformed)?));
            }
        }
        Ok((Self { targets: shown, pointer }, any))
    }

    /// Whether the mesh is shown as it is stored.
    pub(super) fn is_none(&self) -> bool {
        self.targets.is_empty()
    }

    /// Moves positions to where the weights show them.
    pub(super) fn move_points(
        &self,
        points: &mut [[f64; 3]],
        accessors: &Accessors<'_>,
        budget: &mut Budget<'_>,
    ) -> Result<(), Error> {
        self.add("POSITION", points.as_flattened_mut(), 3, accessors, budget)
    }

    /// Changes the values of an attribute, one for each vertex of the primitive, to what the weights show.
    pub(super) fn deform(
        &self,
        attribute: &mut Attribute,
        accessors: &Accessors<'_>,
        budget: &mut Budget<'_>,
    ) -> Result<(), Error> {
        if self.is_none() {
            return Ok(());
        }
        let components = attribute.components;
        self.add(&attribute.name.clone(), &mut attribute.values, components, accessors, budget)?;
        if matches!(attribute.kind(), AttributeKind::Normal | AttributeKind::Tangent) {
            // A sum of directions has no length of its own.
            for value in attribute.values.chunks_exact_mut(components) {
                set_length(value);
            }
        }
        Ok(())
    }

    /// Adds the differences that targets have for an attribute, times their weights. Those of tangents have no hand.
    fn add(
        &self,
        name: &str,
        values: &mut [f64],
        components: usize,
        accessors: &Accessors<'_>,
        budget: &mut Budget<'_>,
    ) -> Result<(), Error> {
        let items = values.len() / components.max(1);
        for (weight, target) in &self.targets {
            let Some(&accessor) = target.get(name) else { continue };
            let pointer = format!("{}/targets/{name}", self.pointer);
            let width = if name == "TANGENT" { 3 } else { components };
            let found = accessors.get(accessor, shape_of(width), &pointer)?;
            if found.count != items as u64 {
                let what = format!("has {} values for {items} vertices", found.count);
                return Err(accessors.reader.error(pointer, what));
            }
            budget.charge(found.count.saturating_mul(8 * width as u64))?;
            let differences = accessors.list(accessor, width, &pointer)?;
            for (value, difference) in
                values.chunks_exact_mut(components).zip(differences.chunks_exact(width))
            {
                for (number, change) in value.iter_mut().zip(difference) {
                    *number += weight * change;
                }
            }
        }
        Ok(())
    }
}

/// Gives the direction that begins a value the length one; none where it has none.
fn set_length(value: &mut [f64]) {
    let length = value.iter().take(3).map(|x| x * x).sum::<f64>().sqrt();
    if length > 0.0 {
        value.iter_mut().take(3).for_each(|x| *x /= length);
    }
}
