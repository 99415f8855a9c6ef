//! Sheets: faces of both operands that lie in one plane and touch, where the perturbation cannot keep them apart.
//!
//! Where faces of the operands touch from opposite sides, the perturbation makes both vanish (or both stay), provided that
//! each vertex of A moves away from all its faces. At a saddle no direction does. A face there tilts through the face it
//! touches instead of moving off, and parts of both may be kept: two opposite faces at the same place, a wall without
//! thickness. So faces of one plane that look opposite ways, near such vertices, are added up before they are triangulated
//! (`cut::plane_sums`), and what cancels is gone.
//!
//! In a symmetric difference pieces of A and of B that coincide always cancel, whichever way they look, and so all faces
//! that touch are added up. That is right with any perturbation: as a chain the result tends to the boundary of what is in
//! an odd number of operands, so in each plane the sum of all pieces there is what is left of that boundary, once all faces
//! of the plane that overlap are in one sum.

use rustc_hash::FxHashSet;

use crate::Error;
use crate::boolean::candidates::Candidates;
use crate::boolean::complex::Complex;
use crate::boolean::complex::along::sides_along;
use crate::boolean::complex::ids::{FaceId, VertexId};
use crate::exact::{Projection, Sign, collinear, orient2d, orient3d};
use crate::mesh::SparseUnionFind;
use crate::parallel::Runner;

/// Faces of one plane that are added up, ascending.
pub(crate) type Sheet = Vec<FaceId>;

/// Which faces that touch are added up.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Rule {
    /// Those of A at vertices without a direction, with all faces of B they touch that look the opposite way (or the same
    /// way, where one of the operands is turned over).
    AtSaddles { opposite: bool },
    /// All.
    All,
}

/// What touches.
#[derive(Debug, Default)]
pub(crate) struct Touching {
    /// Sets of faces connected by touching.
    pub(crate) sheets: Vec<Sheet>,
    /// The vertices of edges of both operands that run along one another, ascending: where all faces that touch are added up.
    pub(crate) along_edges: Vec<VertexId>,
}

/// Finds the sheets and, where all faces are added up, the edges that run along one another. `contacts` is what the search for
/// crossings met: without any, nothing touches.
///
/// # Errors
/// Only limits.
pub(crate) fn find_sheets(
    complex: &Complex<'_>,
    candidates: &Candidates,
    contacts: u64,
    rule: Rule,
    runner: Runner<'_>,
) -> Result<Touching, Error> {
    if contacts == 0 {
        return Ok(Touching::default());
    }
    // 1. Pairs of faces that touch.
    let mut along_edges = Vec::new();
    let touching = match rule {
        Rule::All => {
            let met = candidates.visit(runner, |s, t, found| {
                let face = look_opposite_ways(complex, [s, t]).map(|_| Met::Faces([s, t]));
                found.extend(face);
                found.extend(vertices_along_edges(complex, [s, t]).map(Met::Edges));
            })?;
            met.into_iter().filter_map(|met| met.sorted_into(&mut along_edges)).collect()
        }
        Rule::AtSaddles { opposite } => {
            let at_saddles = faces_at_saddles(complex);
            if at_saddles.is_empty() {
                return Ok(Touching::default());
            }
            candidates.visit(runner, |s, t, found| {
                if at_saddles.contains(&s) && look_opposite_ways(complex, [s, t]) == Some(opposite) {
                    found.push([s, t]);
                }
            })?
        }
    };
    // 2. Sets of them.
    let mut classes = SparseUnionFind::default();
    for [s, t] in touching {
        classes.join(complex.face(0, s), complex.face(1, t));
    }
    along_edges.sort_unstable();
    along_edges.dedup();
    Ok(Touching { sheets: classes.into_sets(), along_edges })
}

/// What of two triangles touches.
enum Met {
    Faces([u32; 2]),
    /// The vertices of two edges that run along one another.
    Edges([VertexId; 4]),
}

impl Met {
    /// Faces as they are; vertices are added to a list.
    fn sorted_into(self, vertices: &mut Vec<VertexId>) -> Option<[u32; 2]> {
        match self {
            Self::Faces(faces) => Some(faces),
            Self::Edges(ends) => {
                vertices.extend(ends);
                None
            }
        }
    }
}

/// The vertices of edges of a triangle of A and one of B that run along one another. Where one operand is inside the other there, none of
/// its faces need cross any, and only the order of all faces round the edge tells which bound the same material.
fn vertices_along_edges(complex: &Complex<'_>, triangles: [u32; 2]) -> impl Iterator<Item = [VertexId; 4]> {
    let [a, b] = [0, 1].map(|operand| complex.corners_of_triangle(operand, triangles[operand]));
    let positions = [a, b].map(|corners| corners.map(|corner| corner.position));
    let ends = move |[i, j]: [usize; 2]| [a[i].id, a[(i + 1) % 3].id, b[j].id, b[(j + 1) % 3].id];
    sides_along(&positions[0], &positions[1]).map(ends)
}

/// The faces of A near B that have a vertex without a direction, as triangles of A.
fn faces_at_saddles(complex: &Complex<'_>) -> FxHashSet<u32> {
    let saddles = complex.vertices_without_direction();
    if saddles.is_empty() {
        return FxHashSet::default();
    }
    let corners = |t: u32| complex.operands[0].triangles[t as usize];
    let near = complex.near(0).iter().copied();
    near.filter(|&t| corners(t).iter().any(|v| saddles.contains(v))).collect()
}

/// For a triangle of A and one of B in exactly the same plane whether they look opposite ways; `None` for others.
fn look_opposite_ways(complex: &Complex<'_>, triangles: [u32; 2]) -> Option<bool> {
    let [a, b] = [0, 1].map(|k| complex.corners_of_triangle(k, triangles[k]).map(|corner| corner.position));
    let coplanar = b.iter().all(|p| orient3d(&a[0], &a[1], &a[2], p) == Sign::Zero);
    if !coplanar || collinear(&a[0], &a[1], &a[2]) || collinear(&b[0], &b[1], &b[2]) {
        return None;
    }
    let seen = Projection::of(&a);
    let [p, q, r] = b.map(|p| seen.project(&p));
    Some(orient2d(p, q, r) != Sign::Positive)
}
