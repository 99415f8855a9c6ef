//! Checks that end every reader and begin every writer.

use super::notes::Notes;
use super::{Format, malformed};
use crate::mesh::{GroupFault, MeshError, check_attributes};
use crate::{Error, Mesh};

/// The vertices whose coordinates are not all finite; usually none.
fn not_finite(positions: &[[f64; 3]]) -> Vec<usize> {
    // Zero times a finite number is zero, times anything else NaN: a whole block is tested without a branch.
    let mut found = Vec::new();
    for (block, chunk) in positions.chunks(4096).enumerate() {
        let zero: [f64; 3] = chunk.iter().fold([0.0; 3], |sum, point| {
            [sum[0] + point[0] * 0.0, sum[1] + point[1] * 0.0, sum[2] + point[2] * 0.0]
        });
        if zero != [0.0; 3] {
            let bad = |point: &[f64; 3]| !point.iter().all(|coordinate| coordinate.is_finite());
            found.extend((0..chunk.len()).filter(|&i| bad(&chunk[i])).map(|i| block * 4096 + i));
        }
    }
    found
}

/// Makes sure that every coordinate is finite: an error with the vertex's place if a triangle uses it, else the
/// vertex is left out.
pub(super) fn check_finite(
    mesh: &mut Mesh,
    format: Format,
    notes: &mut Notes,
    place: impl Fn(usize) -> String,
) -> Result<(), Error> {
    let bad = not_finite(&mesh.positions);
    if bad.is_empty() {
        return Ok(());
    }
    let mut used = vec![false; mesh.positions.len()];
    for &corner in mesh.triangles.as_flattened() {
        used[corner as usize] = true;
    }
    if let Some(&vertex) = bad.iter().find(|&&vertex| used[vertex]) {
        let position = mesh.positions[vertex];
        return Err(malformed(
            format,
            place(vertex),
            format!(
                "vertex {vertex} (counted from 0) is at {position:?}, which is not a finite point, and faces use it; \
                 remove these faces or correct the number"
            ),
        ));
    }
    notes.add("vertex that is not a finite point left out, no face uses it", bad.len());
    let mut bad = bad.into_iter().peekable();
    let mut renumbered = Vec::with_capacity(mesh.positions.len());
    let mut kept = 0;
    for vertex in 0..mesh.positions.len() {
        renumbered.push(kept as u32);
        if bad.next_if_eq(&vertex).is_none() {
            mesh.positions[kept] = mesh.positions[vertex];
            kept += 1;
        }
    }
    mesh.positions.truncate(kept);
    for corner in mesh.triangles.as_flattened_mut() {
        *corner = renumbered[*corner as usize];
    }
    Ok(())
}

/// Makes sure that a mesh is fit to be written: indices in range, coordinates finite, groups for every triangle.
pub(super) fn check_for_writing(mesh: &Mesh) -> Result<(), Error> {
    let vertices = mesh.positions.len();
    for (what, count) in [("vertices", vertices), ("triangles", mesh.triangles.len())] {
        if count > u32::MAX as usize {
            return Err(Error::TooLarge { what: format!("{count} {what}") });
        }
    }
    let largest = mesh.triangles.iter().fold([0; 3], |largest, triangle| {
        [largest[0].max(triangle[0]), largest[1].max(triangle[1]), largest[2].max(triangle[2])]
    });
    if largest.into_iter().any(|index| index as usize >= vertices) {
        for (triangle, corners) in mesh.triangles.iter().enumerate() {
            if let Some(&index) = corners.iter().find(|&&index| index as usize >= vertices) {
                return Err(MeshError::IndexOutOfRange { triangle, index, vertices }.into());
            }
        }
    }
    if let Some(&vertex) = not_finite(&mesh.positions).first() {
        return Err(MeshError::NotFinite { vertex, position: mesh.positions[vertex] }.into());
    }
    let (groups, triangles) = (&mesh.groups, mesh.triangles.len());
    let assigned = groups.of_triangle.len();
    if assigned != if groups.list.is_empty() { 0 } else { triangles } {
        return Err(MeshError::Groups(GroupFault::Count { assigned, triangles }).into());
    }
    if let Some(fault) = groups.fault(triangles) {
        return Err(MeshError::Groups(fault).into());
    }
    Ok(check_attributes(mesh)?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::FaceGroup;

    fn triangle() -> Mesh {
        Mesh::new(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]])
    }

    #[test]
    fn unused_vertices_that_are_not_finite_are_left_out() {
        let mut mesh = Mesh::new(
            vec![[f64::NAN, 0.0, 0.0], [0.0; 3], [1.0, 0.0, 0.0], [0.0, f64::INFINITY, 0.0], [0.0, 1.0, 0.0]],
            vec![[1, 2, 4]],
        );
        let mut notes = Notes::default();
        check_finite(&mut mesh, Format::Obj, &mut notes, |_| String::new()).unwrap();
        assert_eq!(mesh, triangle());
        assert_eq!(notes.into_warnings(|_| String::new()).len(), 1);
    }

    #[test]
    fn used_vertices_that_are_not_finite_are_an_error() {
        let mut mesh = triangle();
        mesh.positions[2][1] = f64::NAN;
        let place = |vertex: usize| format!("line {vertex}");
        let error = check_finite(&mut mesh, Format::Obj, &mut Notes::default(), place).unwrap_err();
        assert!(error.to_string().contains("line 2"), "{error}");
        assert!(matches!(check_for_writing(&mesh), Err(Error::Mesh(MeshError::NotFinite { vertex: 2, .. }))));
    }

    #[test]
    fn a_mesh_at_fault_is_not_written() {
        let mut mesh = triangle();
        mesh.triangles.push([0, 1, 3]);
        let error = check_for_writing(&mesh).unwrap_err();
        assert!(matches!(
            error,
            Error::Mesh(MeshError::IndexOutOfRange { triangle: 1, index: 3, vertices: 3 })
        ));
        let mut mesh = triangle();
        mesh.groups.list.push(FaceGroup::default());
        assert!(matches!(check_for_writing(&mesh), Err(Error::Mesh(MeshError::Groups(_)))));
        mesh.groups.of_triangle.push(1);
        assert!(matches!(check_for_writing(&mesh), Err(Error::Mesh(MeshError::Groups(_)))));
        mesh.groups.of_triangle[0] = 0;
        check_for_writing(&mesh).unwrap();
        check_for_writing(&Mesh::default()).unwrap();
    }
}
