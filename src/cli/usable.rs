//! Meshes made operands: what is mended and checked, and what would help where that is not enough.

use serde_json::Value;
use trisect::mesh::{Gate, SelfCrossings, Welding};
use trisect::{Control, Error, Mesh, MeshError, Solid};

use super::json::json_of;
use super::mended;
use super::remedy::Remedy;
use super::repairs::Repairs;

/// A solid that can be an operand, and what its checks found.
pub(crate) struct Usable {
    pub(crate) solid: Solid,
    /// The answer of the self-crossing check; `None` under `--assume-clean`.
    pub(crate) crossings: Option<Crossings>,
}

/// Self-crossings of an operand.
pub(crate) struct Crossings {
    /// How many pairs of triangles cross each other.
    pub(crate) count: usize,
    /// How many are no deeper than rounding.
    pub(crate) tolerated: usize,
    /// How many pairs lie on each other in one plane.
    pub(crate) touching: usize,
    /// All that is known about them.
    pub(crate) object: Value,
    /// The same, with the triangles' numbers in the file.
    pub(crate) found: SelfCrossings,
}

/// Why a mesh cannot be an operand.
pub(crate) struct Unusable {
    pub(crate) error: Error,
    /// Options that would make it one.
    pub(crate) remedy: Option<Remedy>,
}

/// Makes a mesh an operand, or says why it cannot be one and what would make it one, with the triangles' numbers in the
/// file.
pub(crate) fn usable(
    mesh: Mesh,
    repairs: Repairs,
    assume_clean: bool,
    control: &Control,
) -> Result<Usable, Box<Unusable>> {
    tried(mesh, repairs, assume_clean, control).map_err(|failed| {
        let (error, mesh) = *failed;
        let remedy = mesh.and_then(|mesh| remedy(&mesh, &error, repairs, assume_clean, control));
        Box::new(Unusable { error, remedy })
    })
}

/// The same without a look for what would make it one. With the error comes the mesh, if anything might.
fn tried(
    mesh: Mesh,
    repairs: Repairs,
    assume_clean: bool,
    control: &Control,
) -> Result<Usable, Box<(Error, Option<Mesh>)>> {
    let solid = match repairs.gate().solid(mesh) {
        Ok(solid) => solid,
        Err(refusal) => return Err(Box::new((refusal.error.into(), Some(refusal.mesh)))),
    };
    if assume_clean {
        return Ok(Usable { solid, crossings: None });
    }
    let mut found = match solid.self_crossings(control) {
        Ok(found) => found.clone(),
        Err(error) => return Err(Box::new((error, None))),
    };
    for place in &mut found.places {
        place.triangles = place.triangles.map(|triangle| solid.source_triangle(triangle));
    }
    // What a surface that crosses itself is inside and outside of, winding numbers tell.
    if found.is_clean() {
        let mut misplaced = solid.inside_out_shells();
        for place in &mut misplaced.places {
            for triangle in &mut place.triangles {
                *triangle = solid.source_triangle(*triangle);
            }
            // Vertices may have been joined since the file was read: their numbers are no longer its own.
            place.vertices.clear();
        }
        if !misplaced.is_none() {
            let error = MeshError::InsideOutShells(Box::new(misplaced)).into();
            return Err(Box::new((error, Some(solid.into_mesh()))));
        }
    }
    let crossings = Crossings {
        count: found.count,
        tolerated: found.tolerated,
        touching: found.touching,
        object: json_of(&found),
        found,
    };
    Ok(Usable { solid, crossings: Some(crossings) })
}

/// A warning if a mesh had triangles, but none that enclose anything.
pub(crate) fn nothing_left(solid: &Solid) -> Option<String> {
    let cleaning = solid.cleaning();
    let left_out = cleaning.repeated_corners + 2 * cleaning.opposite_pairs;
    (solid.is_empty() && left_out > 0).then(|| {
        format!(
            "it is empty: each of its {left_out} triangles has an opposite copy or a repeated corner, so they enclose \
             nothing (a sheet with two sides is not a body: give it a thickness)"
        )
    })
}

/// The mesh mended by joining vertices as asked for, and how many were joined. Where that does not close it, they are joined
/// all the same, if a distance is given.
pub(crate) fn welded(mesh: Mesh, weld: Welding) -> Result<(Mesh, usize), Error> {
    if weld == Welding::Rounding {
        return Ok((mesh, 0));
    }
    let refusal = match Gate::new().weld(weld).solid(mesh) {
        Ok(solid) => {
            let joined = solid.mending().seams.count;
            return Ok((solid.into_mesh(), joined));
        }
        Err(refusal) => refusal,
    };
    let (Welding::Within(distance), MeshError::NotClosed(_) | MeshError::InsideOut { .. }) =
        (weld, &refusal.error)
    else {
        return if matches!(refusal.error, MeshError::NotClosed(_) | MeshError::InsideOut { .. }) {
            Ok((refusal.mesh, 0))
        } else {
            Err(refusal.error.into())
        };
    };
    let before = refusal.mesh.positions.len();
    let mesh = refusal.mesh.welded(distance)?;
    let removed = before - mesh.positions.len();
    Ok((mesh, removed))
}

/// The mesh with its faces outwards, and whether that changed it.
pub(crate) fn oriented(mesh: Mesh) -> (Mesh, bool) {
    let before = mesh.triangles.clone();
    let mesh = mesh.oriented();
    let turned = mesh.triangles != before;
    (mesh, turned)
}

/// The first of few sets of options that makes `mesh` usable, which was refused with `error` under `repairs`: as small a
/// set as there is. Each set is tried in full, the check for self-crossings included.
fn remedy(
    mesh: &Mesh,
    error: &Error,
    repairs: Repairs,
    assume_clean: bool,
    control: &Control,
) -> Option<Remedy> {
    let inwards = matches!(error, Error::Mesh(MeshError::InsideOut { .. } | MeshError::InsideOutShells(_)));
    if !inwards && !matches!(error, Error::Mesh(MeshError::NotClosed(_))) {
        return None;
    }
    let mut sets = Vec::new();
    if repairs.as_is {
        sets.push((String::new(), Repairs { as_is: false, ..repairs }));
    }
    let (weld, orient, parts, fill) = ("--weld auto", "--orient", "--closed-parts", "--fill-holes");
    for names in [
        &[weld][..],
        &[orient],
        &[parts],
        &[weld, orient],
        &[weld, parts],
        &[orient, parts],
        &[weld, orient, parts],
        &[fill],
        &[orient, fill],
    ] {
        let has = |name: &str| names.contains(&name);
        let set_already = (has(weld) && repairs.weld != Welding::Rounding)
            || (has(orient) && repairs.orient)
            || (has(parts) && repairs.closed_parts)
            || (has(fill) && (repairs.fill_holes.is_some() || repairs.refine_holes));
        if set_already || (inwards && names != [orient]) {
            continue;
        }
        let asked = Repairs {
            weld: if has(weld) { Welding::Closing } else { repairs.weld },
            orient: repairs.orient || has(orient),
            closed_parts: repairs.closed_parts || has(parts),
            fill_holes: if has(fill) { Some(usize::MAX) } else { repairs.fill_holes },
            refine_holes: repairs.refine_holes,
            as_is: false,
        };
        sets.push((names.join(" "), asked));
    }
    let mut crossing = None;
    for (options, asked) in sets {
        let Ok(usable) = tried(mesh.clone(), asked, assume_clean, control) else { continue };
        if usable.solid.is_empty() {
            continue;
        }
        let remedy = Remedy { options, effect: mended::effect(usable.solid.mending()) };
        // What crosses itself afterwards is usable as well, but the second choice.
        if usable.crossings.is_none_or(|crossings| crossings.count == 0) {
            return Some(remedy);
        }
        crossing.get_or_insert(remedy);
    }
    crossing
}
