//! Finding what is wrong with a mesh.

use super::clean::{self, Cleaned, Weld};
use super::diagnosis::Diagnosis;
use super::edges::EdgeTable;
use super::mend::{self, Leave};
use super::orient::Facing;
use super::patches::Patches;
use super::places::{Fault, Spots};
use super::topology::{self, Shape, Topology};
use super::{Bounds, Links, Mesh, Solid, chain, duplicates, measure, weld};
use crate::exact::collinear;
use crate::parallel::get_or_compute;

/// Examines any mesh, however broken, and says what is wrong with it. O(n log n).
///
/// Self-crossings are not looked for here. Of a mesh with more than 2^31 vertices or 2^32/3 triangles only these
/// numbers are told.
///
/// ```
/// use trisect::mesh::{Mesh, diagnose};
///
/// let corners = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
/// let diagnosis = diagnose(&Mesh::new(corners, vec![[0, 2, 1], [0, 1, 3], [1, 2, 3]]));
/// assert!(!diagnosis.closed);
/// assert_eq!(diagnosis.open_edges.count, 3);
/// assert_eq!(diagnosis.open_edges.places[0].vertices, [0, 2]);
/// ```
#[must_use]
pub fn diagnose(mesh: &Mesh) -> Diagnosis {
    diagnose_tried(mesh, false)
}

/// The same; `mending_failed` of a mesh that mending is known not to close.
pub(super) fn diagnose_tried(mesh: &Mesh, mending_failed: bool) -> Diagnosis {
    let Mesh { positions, triangles, .. } = mesh;
    let mut diagnosis =
        Diagnosis { vertices: positions.len(), triangles: triangles.len(), ..Diagnosis::default() };
    if positions.len() > chain::MAX_VERTICES || triangles.len() > chain::MAX_TRIANGLES {
        return diagnosis;
    }
    let spots = Spots { mesh };
    vertices_one_by_one(&spots, &mut diagnosis);
    triangles_one_by_one(&spots, &mut diagnosis);
    let cleaned = clean::clean(positions, triangles, Weld::Exact);
    diagnosis.closed = cleaned.closed;
    if !cleaned.closed && !mending_failed {
        let mended = mend::mend(mesh, &cleaned.triangles, &cleaned.source, Leave::default());
        diagnosis.mending = mended.map(|mended| Box::new(mended.report));
    }
    diagnosis.closing_distance = closing_distance(positions, &cleaned);
    for &pair in &cleaned.opposite {
        diagnosis.opposite_duplicates.add(|| spots.triangles(&pair));
    }
    for pair in duplicates::find(&cleaned.triangles, positions.len()).same {
        diagnosis.duplicates.add(|| spots.triangles(&pair.map(|copy| cleaned.source[copy as usize])));
    }
    surface(&spots, &cleaned, &mut diagnosis);
    let corners = cleaned.triangles.iter().flatten().map(|&corner| &positions[corner as usize]);
    diagnosis.bounds = Bounds::of(corners);
    if let Some(bounds) = &diagnosis.bounds {
        diagnosis.area = measure::area(positions, &cleaned.triangles, bounds);
        let volume = || measure::signed_volume(positions, &cleaned.triangles, bounds).value;
        diagnosis.volume = cleaned.closed.then(volume);
    } else {
        diagnosis.volume = cleaned.closed.then_some(0.0);
    }
    diagnosis
}

/// Faults of vertices by themselves.
fn vertices_one_by_one(spots: &Spots<'_>, diagnosis: &mut Diagnosis) {
    let Mesh { positions, triangles, .. } = spots.mesh;
    let mut used = vec![false; positions.len()];
    for &corner in triangles.iter().flatten() {
        if let Some(used) = used.get_mut(corner as usize) {
            *used = true;
        }
    }
    let mut finite = Vec::new();
    for (position, vertex) in positions.iter().zip(0u32..) {
        if !used[vertex as usize] {
            diagnosis.unreferenced_vertices.add(|| spots.vertices(&[vertex]));
        } else if position.iter().all(|x| x.is_finite()) {
            finite.push(vertex);
        } else {
            diagnosis.not_finite.add(|| spots.vertices(&[vertex]));
        }
    }
    for (&vertex, first) in finite.iter().zip(weld::exact_targets(positions, &finite)) {
        if first != vertex {
            diagnosis.split_vertices.add(|| spots.vertices(&[first, vertex]));
        }
    }
}

/// Faults of triangles by themselves.
fn triangles_one_by_one(spots: &Spots<'_>, diagnosis: &mut Diagnosis) {
    let Mesh { positions, triangles, .. } = spots.mesh;
    for (&[a, b, c], index) in triangles.iter().zip(0u32..) {
        let place = || spots.triangles(&[index]);
        let corner = |vertex: u32| positions.get(vertex as usize);
        let (Some(&p), Some(&q), Some(&r)) = (corner(a), corner(b), corner(c)) else {
            diagnosis.index_out_of_range.add(place);
            continue;
        };
        if a == b || b == c || c == a {
            diagnosis.repeated_corners.add(place);
        } else if [p, q, r].iter().flatten().all(|x| x.is_finite()) && collinear(&p, &q, &r) {
            diagnosis.zero_area.add(place);
        }
    }
}

/// Faults of the surface as a whole.
fn surface(spots: &Spots<'_>, cleaned: &Cleaned, diagnosis: &mut Diagnosis) {
    let (triangles, vertices) = (&cleaned.triangles, spots.mesh.positions.len());
    let source = |triangle: u32| cleaned.source[triangle as usize];
    // Nearly always every edge has two triangles, and every vertex one fan of them.
    if cleaned.edge_manifold
        && let Ok(links) = Links::of(triangles, vertices)
        && links.pinched == 0
    {
        let shape = Shape::new(triangles, vertices, &links);
        diagnosis.shells = shape.components;
        diagnosis.euler_characteristic = shape.euler_characteristic;
        diagnosis.genus = shape.genus;
        let patches = Patches::of_components(topology::labels(triangles, vertices, &links));
        diagnosis.inside_out_shells = inside_out_shells(spots, &patches, triangles, source);
        return;
    }
    let table = EdgeTable::new(triangles, vertices);
    for edge in table.iter() {
        let place = || spots.edge(edge, &cleaned.source);
        match edge.valence() {
            1 => diagnosis.open_edges.add(place),
            2 if edge.net() != 0 => diagnosis.misoriented_edges.add(place),
            2 => {}
            _ => {
                diagnosis.non_manifold_edges.add(place);
                if edge.net() != 0 {
                    diagnosis.unbalanced_edges.add(place);
                }
            }
        }
    }
    let topology = Topology::of_edges(&table, triangles, vertices);
    diagnosis.shells = topology.components;
    diagnosis.euler_characteristic = topology.euler_characteristic;
    diagnosis.genus = topology.genus;
    for (vertex, _) in topology.pinched {
        diagnosis.pinched_vertices.add(|| spots.vertices(&[vertex]));
    }
    let patches = Patches::new(&table, triangles.len());
    diagnosis.inside_out_shells = inside_out_shells(spots, &patches, triangles, source);
}

/// Closed shells that certainly face the wrong way, each placed at its first triangle.
fn inside_out_shells(
    spots: &Spots<'_>,
    patches: &Patches,
    triangles: &[[u32; 3]],
    source: impl Fn(u32) -> u32,
) -> Fault {
    let facing = Facing::new(&spots.mesh.positions, triangles, patches);
    let mut fault = Fault::default();
    for patch in 0..patches.closed.len() {
        if facing.wrong[patch] && !facing.unclear[patch] && !patches.is_mixed(patch) {
            let first = patches.triangles.get(patch)[0];
            fault.add(|| spots.triangles(&[source(first)]));
        }
    }
    fault
}

impl Solid {
    /// Shells that face the wrong way: inwards without lying inside another, or outwards inside another (which then
    /// counts twice). A solid whose volume is positive on the whole may have such shells, and booleans then count
    /// regions as often as they are enclosed. Shells that cross others are not judged; see
    /// [`self_crossings`](Self::self_crossings). Triangles are named by their index in [`mesh`](Self::mesh). O(n log n).
    ///
    /// ```
    /// use trisect::{Mesh, Solid, primitives};
    ///
    /// let outer = primitives::cuboid([0.0; 3], [3.0; 3])?;
    /// let inner = primitives::cuboid([1.0; 3], [2.0; 3])?;
    /// let hollow = Solid::try_from(Mesh::merged([&outer, &inner.clone().reversed()])?)?;
    /// assert!(hollow.inside_out_shells().is_none());
    /// let doubled = Solid::try_from(Mesh::merged([&outer, &inner])?)?;
    /// assert_eq!(doubled.inside_out_shells().count, 1);
    /// # Ok::<(), trisect::Error>(())
    /// ```
    #[must_use]
    pub fn inside_out_shells(&self) -> Fault {
        self.inside_out().clone()
    }

    /// The same, computed once.
    pub(super) fn inside_out(&self) -> &Fault {
        let compute = || {
            let mesh = self.mesh();
            if self.components() < 2 {
                // The total volume is not negative.
                return Fault::default();
            }
            inside_out_shells(&Spots { mesh }, &self.patches(), &mesh.triangles, |triangle| triangle)
        };
        get_or_compute(&self.inside_out, compute)
    }
}

/// The least of a few distances within which welding would close the surface: powers of ten, so that they read well.
/// Not looked for where nearly everything is open.
fn closing_distance(positions: &[[f64; 3]], cleaned: &Cleaned) -> Option<f64> {
    const MOST: usize = 500_000;
    let open = chain::open_vertices(&cleaned.triangles, positions.len());
    if cleaned.closed || open.len() > MOST {
        return None;
    }
    let corners = cleaned.triangles.iter().flatten().map(|&corner| &positions[corner as usize]);
    let size = Bounds::of(corners)?.diagonal().log10().ceil();
    let boundary = weld::boundary(&cleaned.triangles, positions.len());
    let mut distances = (4..10).rev().filter_map(|digits| {
        let distance = format!("1e{}", size - f64::from(digits)).parse().ok();
        distance.filter(|distance: &f64| distance.is_finite() && *distance > 0.0)
    });
    distances.find(|&distance| {
        let map = weld::vertex_map(positions.len(), &open, &weld::near_targets(positions, &open, distance));
        weld::cancels(&boundary, |vertex| map[vertex as usize])
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::primitives;

    /// Coordinates are multiplied by `factor`.
    fn scaled(mesh: &Mesh, factor: f64) -> Mesh {
        let positions = mesh.positions.iter().map(|p| p.map(|x| x * factor)).collect();
        Mesh::new(positions, mesh.triangles.clone())
    }

    #[test]
    fn faults_are_found_at_any_magnitude() {
        let ball = primitives::octahedron(1.0).unwrap();
        let inner = primitives::octahedron(0.5).unwrap();
        for factor in [1e-300, 1.0, 1e300] {
            let sound = diagnose(&scaled(&ball, factor));
            assert!(sound.closed && sound.zero_area.is_none(), "{factor}");
            assert_eq!((sound.shells, sound.inside_out_shells.count), (1, 0), "{factor}");
            assert_eq!(diagnose(&scaled(&ball, factor).reversed()).inside_out_shells.count, 1, "{factor}");
            let doubled = Mesh::merged([&scaled(&ball, factor), &scaled(&inner, factor)]).unwrap();
            assert_eq!(diagnose(&doubled).inside_out_shells.count, 1, "{factor}");
        }
    }

    #[test]
    fn zero_area_is_told_from_the_last_bit_at_any_magnitude() {
        let next = f64::next_up;
        let count =
            |corners: [[f64; 3]; 3]| diagnose(&Mesh::new(corners.to_vec(), vec![[0, 1, 2]])).zero_area.count;
        for scale in [1e-300, 1.0, 1e300] {
            let line = [[0.0; 3], [scale, scale, 0.5 * scale], [2.0 * scale, 2.0 * scale, scale]];
            assert_eq!(count(line), 1, "{scale}");
            let mut bent = line;
            bent[2][1] = next(bent[2][1]);
            assert_eq!(count(bent), 0, "{scale}");
        }
        // A corner 1e-300 off a line that is 1e300 long, and on it.
        assert_eq!(count([[0.0; 3], [1e300, 0.0, 0.0], [1.0, 1e-300, 0.0]]), 0);
        assert_eq!(count([[0.0; 3], [1e300, 1e300, 0.0], [1e-300, 1e-300, 0.0]]), 1);
        assert_eq!(count([[0.0; 3], [1e300, 1e300, 0.0], [1e-300, next(1e-300), 0.0]]), 0);
    }
}
