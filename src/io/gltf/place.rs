//! A node of a scene by its name, and where it is.

use std::collections::HashSet;

use glam::DAffine3;

use super::super::FormatError;
use super::Reader;
use super::scene;
use crate::{Error, Mesh};

/// The node that gets the mesh.
pub(super) struct Place {
    pub(super) node: usize,
    /// What stands under it: its meshes are in the new one.
    pub(super) below: Vec<usize>,
    pub(super) world: DAffine3,
}

/// The node of a name.
pub(super) fn find(reader: &Reader<'_>, name: &str) -> Result<Place, Error> {
    let nodes = &reader.document.nodes;
    let mut parents = vec![None; nodes.len()];
    for (index, node) in nodes.iter().enumerate() {
        for &child in node.0.iter().flat_map(|node| node.children.iter()) {
            if let Some(parent) = parents.get_mut(child as usize) {
                *parent = Some(index);
            }
        }
    }
    let own_name = |index: usize| nodes[index].0.as_ref()?.name.as_deref();
    let is_meant = |index: usize| {
        let mut at = Some(index);
        own_name(index) == Some(name)
            || name.split('/').rev().all(|part| {
                let Some(here) = at else { return false };
                at = parents[here];
                own_name(here) == Some(part)
            })
    };
    let meant: Vec<usize> = (0..nodes.len()).filter(|&index| is_meant(index)).collect();
    let node = match meant[..] {
        [node] => node,
        [] => {
            let near = (0..nodes.len()).filter_map(own_name).take(5).map(str::to_owned).collect();
            let format = reader.format;
            return Err(FormatError::NoSuchPart { format, name: name.to_owned(), empty: false, near }.into());
        }
        _ => {
            let count = meant.len();
            return Err(Error::InvalidArgument(format!(
                "{count} nodes are called {name:?}, and one is needed to keep its scene; name it as PARENT/NAME"
            )));
        }
    };
    // The transforms from the root down; a chain longer than the list of nodes runs in a circle.
    let (mut world, mut at, mut steps) = (DAffine3::IDENTITY, Some(node), 0);
    while let Some(here) = at.filter(|_| steps <= nodes.len()) {
        if let Some(fields) = nodes[here].0.as_deref()
            && let Some(transform) = scene::transform(reader, fields, &format!("/nodes/{here}"))?
        {
            world = if world == DAffine3::IDENTITY { transform } else { transform * world };
        }
        (at, steps) = (parents[here], steps + 1);
    }
    let mut below = Vec::new();
    let mut seen: HashSet<usize> = HashSet::from([node]);
    let mut open = vec![node];
    while let Some(here) = open.pop() {
        for &child in nodes[here].0.iter().flat_map(|node| node.children.iter()) {
            let child = child as usize;
            if child < nodes.len() && seen.insert(child) {
                below.push(child);
                open.push(child);
            }
        }
    }
    Ok(Place { node, below, world })
}

/// A mesh of the scene in the coordinates of a node.
pub(super) fn in_node(mesh: &Mesh, world: &DAffine3) -> Result<Mesh, Error> {
    if *world == DAffine3::IDENTITY {
        return Ok(mesh.clone());
    }
    let inverse = world.inverse();
    let m = inverse.matrix3.to_cols_array();
    let t = inverse.translation;
    let rows = [m[0], m[3], m[6], t.x, m[1], m[4], m[7], t.y, m[2], m[5], m[8], t.z];
    if rows.iter().any(|number| !number.is_finite()) {
        return Err(Error::InvalidArgument(
            "the node is flattened by its transform, no mesh can be put there".into(),
        ));
    }
    Ok(mesh.clone().transformed(&rows)?)
}
