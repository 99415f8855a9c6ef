//! Which triangles are an object: slicers want closed ones.

use std::collections::HashMap;

use super::super::super::weld::Weld;
use super::super::super::{Format, WriteOptions, unsupported};
use crate::control::Reservation;
use crate::mesh::is_closed;
use crate::{Error, Mesh};

/// The most vertices and triangles of an object: indices are below 2^31.
const MOST: usize = 1 << 31;

/// Bytes that a vertex or a triangle takes at most while objects are told apart.
const ROOM: u64 = 32;

/// An object that is written.
pub(super) struct ObjectParts {
    pub(super) name: String,
    /// Its triangles in the mesh, and its vertices there; nothing where these are all.
    pub(super) selection: Option<Selection>,
    /// Whether it is closed; an object that is not is a surface to slicers.
    pub(super) is_closed: bool,
    /// Names of groups, and runs of its triangles that have them; empty where all have the object's.
    pub(super) sets: Vec<(String, Vec<[u32; 2]>)>,
}

/// A part of a mesh.
pub(super) struct Selection {
    pub(super) triangles: Vec<u32>,
    pub(super) vertices: Vec<u32>,
    /// The triangles, by those vertices.
    pub(super) corners: Vec<[u32; 3]>,
}

/// The objects of a mesh. Where all that has a name is closed, for every name, each is an object of its own. Else the mesh is one
/// object, and names are those of sets of its triangles. With them the memory that they take.
pub(super) fn objects(
    mesh: &Mesh,
    options: &WriteOptions,
) -> Result<(Vec<ObjectParts>, Option<Reservation>), Error> {
    if mesh.positions.len().max(mesh.triangles.len()) >= MOST {
        return Err(unsupported(
            Format::ThreeMf,
            "more than 2^31 vertices or triangles; write PLY or several files",
        ));
    }
    if mesh.is_empty() {
        return Ok((Vec::new(), None));
    }
    let room = || options.control.reserve(ROOM * (mesh.positions.len() + mesh.triangles.len()) as u64);
    let (names, of_group) = names(mesh);
    if names.len() > 1 {
        let reservation = room()?;
        if let Some(objects) = closed_objects(mesh, &names, &of_group) {
            return Ok((objects, Some(reservation)));
        }
    }
    let sets = if names.len() > 1 { sets(mesh, &names, &of_group) } else { Vec::new() };
    let name = if names.len() == 1 { names[0].to_owned() } else { String::new() };
    if is_closed(mesh) {
        return Ok((vec![ObjectParts { name, selection: None, is_closed: true, sets }], None));
    }
    let reservation = room()?;
    let selection = welded(mesh)?;
    Ok((vec![ObjectParts { name, is_closed: selection.is_some(), selection, sets }], Some(reservation)))
}

/// The mesh with one vertex for all at a place, if it is closed then: seams of its file make it look open.
fn welded(mesh: &Mesh) -> Result<Option<Selection>, Error> {
    // Negative zero is zero.
    let places: Vec<[f64; 3]> = mesh.positions.iter().map(|point| point.map(|x| x + 0.0)).collect();
    let mut numbers = vec![0; places.len()];
    Weld::new(Format::ThreeMf, mesh.triangles.len()).vertices(&places, &mut numbers)?;
    let mut vertices = Vec::new();
    for (vertex, &number) in (0..).zip(&numbers) {
        // Numbers come in the order of the first vertex at their place.
        if number as usize == vertices.len() {
            vertices.push(vertex);
        }
    }
    let corners: Vec<[u32; 3]> =
        mesh.triangles.iter().map(|triangle| triangle.map(|vertex| numbers[vertex as usize])).collect();
    let is_whole = corners.iter().all(|&[a, b, c]| a != b && b != c && c != a);
    let alone = Mesh::new(vec![[0.0; 3]; vertices.len()], corners);
    let triangles = (0..mesh.triangles.len() as u32).collect();
    let is_closed = is_whole && is_closed(&alone);
    Ok(is_closed.then_some(Selection { triangles, vertices, corners: alone.triangles }))
}

/// The names of groups that have triangles, each once, and for every group the number of its name.
fn names(mesh: &Mesh) -> (Vec<&str>, Vec<usize>) {
    let mut is_used = vec![false; mesh.groups.list.len()];
    mesh.groups.of_triangle.iter().for_each(|&group| is_used[group as usize] = true);
    let (mut names, mut known) = (Vec::new(), HashMap::new());
    let mut of_group = Vec::with_capacity(mesh.groups.list.len());
    for (group, is_used) in mesh.groups.list.iter().zip(is_used) {
        let name = group.name.as_str();
        let mut number = || {
            names.push(name);
            names.len() - 1
        };
        of_group.push(if is_used { *known.entry(name).or_insert_with(&mut number) } else { usize::MAX });
    }
    (names, of_group)
}

/// An object for each name, if all of them are closed.
fn closed_objects(mesh: &Mesh, names: &[&str], of_group: &[usize]) -> Option<Vec<ObjectParts>> {
    let mut triangles: Vec<Vec<u32>> = vec![Vec::new(); names.len()];
    for (triangle, &group) in mesh.groups.of_triangle.iter().enumerate() {
        triangles[of_group[group as usize]].push(triangle as u32);
    }
    // The numbers of vertices in the object at hand; those of others are overwritten.
    let mut numbers = vec![(u32::MAX, 0_u32); mesh.positions.len()];
    let mut objects = Vec::with_capacity(names.len());
    for (part, (name, triangles)) in names.iter().zip(triangles).enumerate() {
        let mut vertices = Vec::new();
        let mut number = |vertex: u32| {
            let known = &mut numbers[vertex as usize];
            if known.0 != part as u32 {
                *known = (part as u32, vertices.len() as u32);
                vertices.push(vertex);
            }
            known.1
        };
        let corners: Vec<[u32; 3]> =
            triangles.iter().map(|&triangle| mesh.triangles[triangle as usize].map(&mut number)).collect();
        // Whether it is closed is a matter of the corners alone.
        let alone = Mesh::new(vec![[0.0; 3]; vertices.len()], corners);
        if !is_closed(&alone) {
            return None;
        }
        let selection = Some(Selection { triangles, vertices, corners: alone.triangles });
        objects.push(ObjectParts { name: (*name).to_owned(), selection, is_closed: true, sets: Vec::new() });
    }
    Some(objects)
}

/// The triangles of each name in runs, each with its first and last one. Triangles of the empty name are in no set.
fn sets(mesh: &Mesh, names: &[&str], of_group: &[usize]) -> Vec<(String, Vec<[u32; 2]>)> {
    let mut runs: Vec<Vec<[u32; 2]>> = vec![Vec::new(); names.len()];
    for (triangle, &group) in mesh.groups.of_triangle.iter().enumerate() {
        let triangle = triangle as u32;
        let list = &mut runs[of_group[group as usize]];
        match list.last_mut() {
            Some(run) if run[1] + 1 == triangle => run[1] = triangle,
            _ => list.push([triangle; 2]),
        }
    }
    names
        .iter()
        .zip(runs)
        .filter(|(name, _)| !name.is_empty())
        .map(|(name, runs)| ((*name).to_owned(), runs))
        .collect()
}
