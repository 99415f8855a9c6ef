//! Details: displacements of vertices after one, two, ... subdivisions, in frames that turn with the surface.
//!
//! p(l + 1) = S p(l) + R d(l + 1): S subdivides, R is the frame of the vertex on the surface of S p(l), d the detail.

use glam::{DMat3, DVec3};
use rustc_hash::FxHashMap;

use super::error::CageError;
use super::level::{Kind, Level};
use super::refine::apply;

/// A vertex of a subdivided cage: the first control face that holds it, and the weights of its corners times 2^level.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct DomainVertex {
    /// The control face.
    pub face: u32,
    /// Weights of its corners; their sum is 2^level.
    pub numerators: [u32; 3],
}

/// The details of one level: vertices that have one, ascending.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Details {
    /// Displacements along the first tangent, the second, and the normal.
    pub at: Vec<(DomainVertex, [f64; 3])>,
}

/// Levels of details at most: a face of the cage is 4^8 faces then.
pub(crate) const MOST_LEVELS: usize = 8;

/// For each vertex after `level` subdivisions where it is on the cage.
pub(crate) fn domain_vertices(level: &Level, steps: usize) -> Vec<DomainVertex> {
    let none = DomainVertex { face: u32::MAX, numerators: [0; 3] };
    let mut all = vec![none; level.vertex_count];
    for (f, corners) in level.faces.iter().enumerate() {
        let places = corner_numerators(f, steps);
        for k in 0..3 {
            let vertex = &mut all[corners[k] as usize];
            if *vertex == none {
                *vertex = DomainVertex { face: (f >> (2 * steps)) as u32, numerators: places[k] };
            }
        }
    }
    all
}

/// The numerators of a face's corners after `steps` subdivisions: face f came from f / 4, as its corner f % 4 or its middle.
fn corner_numerators(face: usize, steps: usize) -> [[u32; 3]; 3] {
    let mut corners = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];
    for step in (0..steps).rev() {
        let part = face >> (2 * step) & 3;
        let twice = |p: [u32; 3]| p.map(|x| 2 * x);
        let middle = |k: usize| -> [u32; 3] {
            let (p, q) = (corners[k % 3], corners[(k + 1) % 3]);
            std::array::from_fn(|i| p[i] + q[i])
        };
        corners = if part == 3 {
            [middle(0), middle(1), middle(2)]
        } else {
            [twice(corners[part]), middle(part), middle(part + 2)]
        };
    }
    corners
}

/// The frame of a vertex on the surface of these positions: first tangent, second tangent, normal. The axes of space at
/// corners, and where there is no tangent plane.
pub(crate) fn frame(level: &Level, positions: &[DVec3], v: u32) -> DMat3 {
    let ring = level.ring(v);
    let Some(face) = level.faces_at(v).next() else { return DMat3::IDENTITY };
    let kind = level.kind(v, &ring);
    if kind == Kind::Corner {
        return DMat3::IDENTITY;
    }
    let tangents = |face: u32| level.tangent_rows(v, face).map(|row| apply(&row, positions));
    let [first, second] = tangents(face);
    let mut normal = first.cross(second).normalize_or_zero();
    if kind == Kind::Crease {
        // The mean of both sides.
        normal = level.faces_at(v).fold(DVec3::ZERO, |sum, face| {
            let [a, b] = tangents(face);
            sum + a.cross(b).normalize_or_zero()
        });
        normal = normal.normalize_or_zero();
    }
    let first = (first - normal * first.dot(normal)).normalize_or_zero();
    if normal == DVec3::ZERO || first == DVec3::ZERO {
        return DMat3::IDENTITY;
    }
    DMat3::from_cols(first, normal.cross(first), normal)
}

/// One step of synthesis: the next level with its details.
pub(crate) fn synthesised(
    level: &Level,
    positions: &[DVec3],
    details: &Details,
    steps: usize,
) -> Result<(Level, Vec<DVec3>), CageError> {
    let (next, rows) = level.refined();
    let smooth: Vec<DVec3> = rows.iter().map(|row| apply(row, positions)).collect();
    let mut moved = smooth.clone();
    if !details.at.is_empty() {
        let keys = domain_vertices(&next, steps);
        let numbers: FxHashMap<DomainVertex, u32> =
            keys.iter().enumerate().map(|(v, &key)| (key, v as u32)).collect();
        for &(key, detail) in &details.at {
            let v = *numbers.get(&key).ok_or_else(|| {
                CageError::Tag(format!(
                    "the detail at face {}, {:?} of level {steps} names no vertex there; it names the first face that holds it",
                    key.face, key.numerators
                ))
            })?;
            moved[v as usize] += frame(&next, &smooth, v) * DVec3::from(detail);
        }
    }
    Ok((next, moved))
}

/// The details that turn the subdivided positions into the given ones, those shorter than `least` left out.
pub(crate) fn analysed(
    next: &Level,
    smooth: &[DVec3],
    wanted: &[DVec3],
    steps: usize,
    least: f64,
) -> Details {
    let keys = domain_vertices(next, steps);
    let mut at: Vec<(DomainVertex, [f64; 3])> = Vec::new();
    for v in 0..smooth.len() {
        let way = wanted[v] - smooth[v];
        if way.length() > least {
            at.push((keys[v], (frame(next, smooth, v as u32).transpose() * way).to_array()));
        }
    }
    at.sort_by_key(|entry| entry.0);
    Details { at }
}

#[cfg(test)]
mod tests {
    use glam::DQuat;

    use super::*;
    use crate::subdivision::{ControlMesh, Crease, Rules, Tags};

    /// A tetrahedron with a crease, and positions after one step that are not those of subdivision.
    fn roughened() -> (ControlMesh, Level, Vec<DVec3>, Vec<DVec3>) {
        let positions = vec![[0.0, 0.0, 1.0], [1.0, 0.0, 0.1], [-0.3, 1.0, 0.0], [-0.6, -1.0, -0.2]];
        let faces = vec![[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]];
        let tags = Tags { creases: vec![Crease { edge: [0, 1], sharpness: 10.0 }], ..Tags::default() };
        let cage = ControlMesh::new(positions, faces, tags, Rules::Loop).expect("valid");
        let (next, rows) = cage.level().refined();
        let smooth: Vec<DVec3> = rows.iter().map(|row| apply(row, &cage.points())).collect();
        let wave =
            |v: usize| DVec3::new((v as f64).sin(), (2.0 * v as f64).cos(), (v as f64 * 0.7).sin()) * 0.05;
        let wanted = smooth.iter().enumerate().map(|(v, &p)| p + wave(v)).collect();
        (cage, next, smooth, wanted)
    }

    #[test]
    fn synthesis_undoes_analysis() {
        let (cage, next, smooth, wanted) = roughened();
        let details = analysed(&next, &smooth, &wanted, 1, 0.0);
        assert_eq!(details.at.len(), wanted.len());
        let (_, found) = synthesised(cage.level(), &cage.points(), &details, 1).expect("its own vertices");
        for (p, q) in found.iter().zip(&wanted) {
            assert!(p.distance(*q) < 1e-14, "{p} {q}");
        }
        // Short ones are left out, and their vertices are those of subdivision.
        let few = analysed(&next, &smooth, &wanted, 1, 0.06);
        assert!(few.at.len() < details.at.len() && !few.at.is_empty());
    }

    #[test]
    #[cfg(feature = "formats")]
    fn details_turn_with_the_cage_and_survive_files() {
        let (cage, next, smooth, wanted) = roughened();
        let details = vec![Details::default(), analysed(&next, &smooth, &wanted, 1, 0.0)];
        // Level 1 has other vertices than level 2: refused.
        assert!(cage.clone().with_details(details.clone()).is_err());
        let cage = cage.with_details(details[1..].to_vec()).expect("vertices of level 1");
        let turn = DQuat::from_rotation_x(1.0) * DQuat::from_rotation_z(0.4);
        let turned: Vec<[f64; 3]> =
            cage.positions().iter().map(|&p| (turn * DVec3::from(p)).to_array()).collect();
        let turned = ControlMesh::new(turned, cage.faces().to_vec(), cage.tags().clone(), Rules::Loop)
            .and_then(|turned| turned.with_details(cage.details().to_vec()))
            .expect("the same faces");
        let (one, other) = (cage.subdivided(2).expect("small"), turned.subdivided(2).expect("small"));
        for (p, q) in one.positions().iter().zip(other.positions()) {
            assert!((turn * DVec3::from(*p)).distance(DVec3::from(*q)) < 1e-13);
        }
        let again = ControlMesh::from_json(cage.to_json().as_bytes()).expect("its own file");
        assert_eq!(again.details(), cage.details());
    }

    #[test]
    fn places_are_those_of_the_first_face() {
        let (_, next, ..) = roughened();
        let (two, _) = next.refined();
        let places = domain_vertices(&two, 2);
        let mut sorted = places.clone();
        sorted.sort_unstable();
        sorted.dedup();
        assert_eq!(sorted.len(), two.vertex_count);
        assert!(places.iter().all(|place| place.numerators.iter().sum::<u32>() == 4 && place.face < 4));
        assert_eq!(places[0], DomainVertex { face: 0, numerators: [4, 0, 0] });
    }
}
