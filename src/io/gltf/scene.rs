//! From the tree of nodes to a list of meshes with their transforms.

use glam::{DAffine3, DMat3, DQuat, DVec3, DVec4};
use gltf_json::accessor::Type;

use super::Reader;
use super::document::{Instancing, NodeFields};
use super::primitive::Builder;
use crate::Error;

/// The nodes of a level, how many of them are done, the transform they are under, and the entry of the outline.
type Level<'a> = (&'a [u32], usize, DAffine3, Option<u32>);

/// Adds the meshes of the default scene to the builder.
pub(super) fn flatten(reader: &Reader<'_>, builder: &mut Builder<'_>) -> Result<(), Error> {
    let document = reader.document;
    let mut visited = vec![false; document.nodes.len()];
    if document.scenes.is_empty() && document.nodes.is_empty() {
        for mesh in 0..document.meshes.len() as u32 {
            builder.add(mesh, None, &DAffine3::IDENTITY, None)?;
        }
    }
    // One level of the tree each: the nodes of the level, how many are done, the transform and the name they are under. A list
    // of single nodes with their transforms could grow to fifty times the size of the file.
    let roots = roots(reader, builder)?;
    let mut levels: Vec<Level<'_>> = vec![(&roots, 0, DAffine3::IDENTITY, None)];
    while let Some((nodes, done, parent, above)) = levels.last_mut() {
        let Some(&index) = nodes.get(*done) else {
            levels.pop();
            continue;
        };
        *done += 1;
        let (parent, above) = (*parent, *above);
        let pointer = format!("/nodes/{index}");
        let node = reader.get(&document.nodes, "nodes", index as usize, &pointer)?;
        if std::mem::replace(&mut visited[index as usize], true) {
            return Err(reader.error(
                pointer,
                "is reached twice: nodes must form a tree, without cycles and with one parent each",
            ));
        }
        let Some(node) = node.0.as_deref() else { continue };
        let local = transform(reader, node, &pointer)?;
        // Multiplying by the identity would turn negative zeros into positive ones.
        let world = match (parent == DAffine3::IDENTITY, local) {
            (true, local) => local.unwrap_or(parent),
            (false, None) => parent,
            (false, Some(local)) => parent * local,
        };
        let entry = builder.enter(node.name.as_deref(), above)?;
        if let Some(mesh) = node.mesh {
            if node.skin.is_some() {
                builder.skinned += 1;
            }
            let instancing = node.extensions.as_ref().and_then(|extensions| extensions.instancing.as_ref());
            match instancing {
                None => builder.add(mesh, Some(index), &world, entry)?,
                Some(instancing) => {
                    for instance in instances(reader, builder, instancing, &pointer)? {
                        builder.add(mesh, Some(index), &(world * instance), entry)?;
                    }
                }
            }
        }
        levels.push((&node.children, 0, world, entry));
    }
    Ok(())
}

/// The root nodes of the default scene; of the first one if none is the default; without scenes all roots.
fn roots(reader: &Reader<'_>, builder: &mut Builder<'_>) -> Result<Vec<u32>, Error> {
    let document = reader.document;
    if document.scenes.is_empty() {
        let mut is_child = vec![false; document.nodes.len()];
        for node in document.nodes.iter().filter_map(|node| node.0.as_deref()) {
            for &child in &node.children {
                if let Some(is_child) = is_child.get_mut(child as usize) {
                    *is_child = true;
                }
            }
        }
        return Ok((0..is_child.len() as u32).filter(|&node| !is_child[node as usize]).collect());
    }
    if document.scenes.len() > 1 {
        builder.notes.say(format!("the file has {} scenes; the default one was read", document.scenes.len()));
    }
    let scene = document.scene.unwrap_or(0) as usize;
    let scene = reader.get(&document.scenes, "scenes", scene, "/scene")?;
    Ok(scene.nodes.to_vec())
}

/// The transform of a node, if it has one.
pub(super) fn transform(
    reader: &Reader<'_>,
    node: &NodeFields,
    pointer: &str,
) -> Result<Option<DAffine3>, Error> {
    if let Some(matrix) = node.matrix.as_deref() {
        let column = |i: usize| DVec4::from_slice(&matrix[4 * i..]);
        let columns = [column(0), column(1), column(2), column(3)];
        if columns.map(|column| column.w) != [0.0, 0.0, 0.0, 1.0] {
            return Err(
                reader.error(format!("{pointer}/matrix"), "is a projection: its last row must be 0, 0, 0, 1")
            );
        }
        let [x, y, z, w] = columns.map(DVec4::truncate);
        return Ok(Some(DAffine3 { matrix3: DMat3::from_cols(x, y, z), translation: w }));
    }
    if node.translation.is_none() && node.rotation.is_none() && node.scale.is_none() {
        return Ok(None);
    }
    let vector = |vector: &Option<Box<[f64; 3]>>, default| {
        vector.as_deref().map_or(default, |vector| DVec3::from_array(*vector))
    };
    let rotation = node.rotation.as_deref().copied().unwrap_or([0.0, 0.0, 0.0, 1.0]);
    let rotation = unit_quaternion(rotation)
        .ok_or_else(|| reader.error(format!("{pointer}/rotation"), "is not a unit quaternion"))?;
    Ok(Some(DAffine3::from_scale_rotation_translation(
        vector(&node.scale, DVec3::ONE),
        rotation,
        vector(&node.translation, DVec3::ZERO),
    )))
}

/// The rotation of a quaternion, whose length is brought to one: files hold seven digits.
fn unit_quaternion(components: [f64; 4]) -> Option<DQuat> {
    let [x, y, z, w] = components;
    let length = (x * x + y * y + z * z + w * w).sqrt();
    ((0.5..2.0).contains(&length)).then(|| DQuat::from_xyzw(x / length, y / length, z / length, w / length))
}

/// The transforms of `EXT_mesh_gpu_instancing`.
fn instances(
    reader: &Reader<'_>,
    builder: &mut Builder<'_>,
    instancing: &Instancing,
    pointer: &str,
) -> Result<Vec<DAffine3>, Error> {
    let pointer = format!("{pointer}/extensions/EXT_mesh_gpu_instancing");
    let attributes = &instancing.attributes;
    let mut count = None;
    for (attribute, shape) in [
        (attributes.translation, Type::Vec3),
        (attributes.rotation, Type::Vec4),
        (attributes.scale, Type::Vec3),
    ] {
        if let Some(accessor) = attribute {
            let items = builder.accessors.get(accessor, shape, &pointer)?.count;
            if count.is_some_and(|count| count != items) {
                return Err(reader.error(pointer, "its attributes have different counts"));
            }
            count = Some(items);
        }
    }
    let count = count.unwrap_or(0);
    builder.charge(count.saturating_mul(200))?;
    let vectors = |accessor: Option<u32>, default: f64| match accessor {
        Some(accessor) => builder.accessors.numbers::<3>(accessor, &pointer),
        None => Ok(vec![[default; 3]; count as usize]),
    };
    let translations = vectors(attributes.translation, 0.0)?;
    let scales = vectors(attributes.scale, 1.0)?;
    let rotations = match attributes.rotation {
        Some(accessor) => builder.accessors.numbers::<4>(accessor, &pointer)?,
        None => vec![[0.0, 0.0, 0.0, 1.0]; count as usize],
    };
    let instance = |((translation, scale), rotation): ((&[f64; 3], &[f64; 3]), &[f64; 4])| {
        let rotation = unit_quaternion(*rotation)
            .ok_or_else(|| reader.error(&*pointer, "a rotation is not a unit quaternion"))?;
        Ok(DAffine3::from_scale_rotation_translation(
            DVec3::from_array(*scale),
            rotation,
            DVec3::from_array(*translation),
        ))
    };
    translations.iter().zip(&scales).zip(&rotations).map(instance).collect()
}
