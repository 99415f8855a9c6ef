//! All operands under one numbering of vertices and triangles.

use rustc_hash::FxHashMap;

use crate::mesh::{FaceGroups, Polygons, attributes_of_pieces};
use crate::{Error, Mesh, Solid};

/// The most vertices, given and new.
const MOST_VERTICES: usize = 1 << 31;

/// Whether so many vertices can be numbered.
pub(super) fn check_numbers(vertices: usize) -> Result<(), Error> {
    if vertices > MOST_VERTICES {
        return Err(Error::TooLarge { what: format!("{vertices} vertices of operands to be snapped") });
    }
    Ok(())
}

/// A triangle of an operand, or a part of one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Triangle {
    pub(super) corners: [u32; 3],
    /// The operand.
    pub(super) operand: u32,
    /// The given triangle that this is a part of.
    pub(super) source: u32,
}

impl Triangle {
    /// Its sides, from each corner to the next.
    pub(super) fn sides(&self) -> [[u32; 2]; 3] {
        let [a, b, c] = self.corners;
        [[a, b], [b, c], [c, a]]
    }
}

/// The vertices and triangles of all operands.
#[derive(Debug, Default)]
pub(super) struct Surfaces {
    pub(super) positions: Vec<[f64; 3]>,
    pub(super) triangles: Vec<Triangle>,
    /// The largest coordinate.
    largest: f64,
}

impl Surfaces {
    pub(super) fn of(operands: &[&Solid]) -> Result<Self, Error> {
        let vertices = operands.iter().map(|solid| solid.mesh().positions.len()).sum();
        check_numbers(vertices)?;
        let mut all = Self::default();
        for (operand, solid) in (0..).zip(operands) {
            let (mesh, first) = (solid.mesh(), all.positions.len() as u32);
            all.positions.extend_from_slice(&mesh.positions);
            all.largest =
                mesh.positions.iter().flatten().fold(all.largest, |largest, x| largest.max(x.abs()));
            all.triangles.extend((0..).zip(&mesh.triangles).map(|(source, corners)| Triangle {
                corners: corners.map(|v| first + v),
                operand,
                source,
            }));
        }
        Ok(all)
    }

    /// More than the error of the distance of a vertex from a plane.
    pub(super) fn rounding(&self) -> f64 {
        /// A plane is off by the rounding of its normal and its level, a distance by that of three products: some ten units.
        const ULPS: f64 = 32.0;
        ULPS * f64::EPSILON * self.largest
    }

    /// The corners of a triangle.
    pub(super) fn corners(&self, triangle: usize) -> [[f64; 3]; 3] {
        self.triangles[triangle].corners.map(|v| self.positions[v as usize])
    }

    /// The triangles without those that lie back to back in one operand, in pairs: bodies that touch there are one.
    fn without_walls(&self) -> Vec<Triangle> {
        let mut seen: FxHashMap<(u32, [u32; 3], bool), Vec<usize>> = FxHashMap::default();
        let mut is_wall = vec![false; self.triangles.len()];
        for (t, triangle) in self.triangles.iter().enumerate() {
            let [a, b, c] = triangle.corners;
            let mut sorted = triangle.corners;
            sorted.sort_unstable();
            // Whether the corners run round as their numbers do.
            let is_even = [[a, b, c], [b, c, a], [c, a, b]].contains(&sorted);
            match seen.get_mut(&(triangle.operand, sorted, !is_even)).and_then(Vec::pop) {
                Some(back) => (is_wall[t], is_wall[back]) = (true, true),
                None => seen.entry((triangle.operand, sorted, is_even)).or_default().push(t),
            }
        }
        let kept = self.triangles.iter().zip(&is_wall).filter(|(_, is_wall)| !**is_wall);
        kept.map(|(triangle, _)| *triangle).collect()
    }

    /// The operands, with the given triangle of each of theirs, in the groups of these, with their attributes and polygons.
    pub(super) fn into_solids(self, operands: &[&Solid]) -> Vec<(Solid, Vec<u32>)> {
        let mut meshes = vec![(Mesh::default(), Vec::new()); operands.len()];
        for triangle in &self.without_walls() {
            let (mesh, sources) = &mut meshes[triangle.operand as usize];
            mesh.triangles.push(triangle.corners);
            sources.push(triangle.source);
        }
        // By vertex, its number in the operand at hand: vertices keep their order.
        let mut numbers = vec![u32::MAX; self.positions.len()];
        for ((mesh, sources), given) in meshes.iter_mut().zip(operands) {
            numbers.fill(u32::MAX);
            mesh.triangles.iter().flatten().for_each(|&v| numbers[v as usize] = 0);
            for (number, &position) in
                numbers.iter_mut().zip(&self.positions).filter(|(number, _)| **number == 0)
            {
                *number = mesh.positions.len() as u32;
                mesh.positions.push(position);
            }
            mesh.triangles.iter_mut().flatten().for_each(|v| *v = numbers[*v as usize]);
            mesh.polygons = polygons_of_pieces(&given.mesh().polygons, given.mesh().triangles.len(), sources);
            mesh.attributes = attributes_of_pieces(given.mesh(), &mesh.positions, &mesh.triangles, sources);
            let groups = &given.mesh().groups;
            if !groups.is_empty() {
                let of_triangle =
                    sources.iter().map(|&source: &u32| groups.of_triangle[source as usize]).collect();
                mesh.groups = FaceGroups { list: groups.list.clone(), of_triangle };
            }
        }
        let solid = |(mesh, sources)| (Solid::from_closed_unchecked(mesh), sources);
        meshes.into_iter().map(solid).collect()
    }
}

/// The polygons of pieces of triangles: a triangle in pieces is part of none, and so its polygon is not whole any more.
fn polygons_of_pieces(polygons: &Polygons, given: usize, sources: &[u32]) -> Polygons {
    if polygons.of_triangle.len() != given {
        return Polygons::default();
    }
    let mut pieces = vec![0_u32; given];
    sources.iter().for_each(|&source| pieces[source as usize] += 1);
    let polygon = |&source: &u32| match pieces[source as usize] {
        1 => polygons.of_triangle[source as usize],
        _ => Polygons::NONE,
    };
    Polygons { of_triangle: sources.iter().map(polygon).collect(), triangles: polygons.triangles.clone() }
}
