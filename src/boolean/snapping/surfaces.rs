//! All operands under one numbering of vertices and triangles.

use crate::mesh::{Polygons, attributes_of_pieces, compact, opposite_pairs};
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
    /// Those of the first operand, then those of the second, and so on.
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

    /// How much memory this takes, and the positions once more as they were.
    pub(super) fn bytes(&self) -> u64 {
        let vertices = 2 * self.positions.len() * size_of::<[f64; 3]>();
        (vertices + self.triangles.len() * size_of::<Triangle>()) as u64
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

    /// The operands, with the given triangle of each of theirs, in the groups of these, with their attributes and polygons. What of one
    /// operand lies back to back is left out, in pairs: bodies that touch there are one.
    pub(super) fn into_solids(self, operands: &[&Solid]) -> Vec<(Solid, Vec<u32>)> {
        let mut rest = self.triangles.as_slice();
        let of_operand = |(operand, given): (u32, &&Solid)| {
            let count = rest.partition_point(|triangle| triangle.operand <= operand);
            let (own, others) = rest.split_at(count);
            rest = others;
            self.solid(own, given.mesh())
        };
        (0..).zip(operands).map(of_operand).collect()
    }

    /// The solid of some triangles, with the given triangle of each.
    fn solid(&self, own: &[Triangle], given: &Mesh) -> (Solid, Vec<u32>) {
        // 1. Vertices keep their order.
        let mut vertices: Vec<u32> = own.iter().flat_map(|triangle| triangle.corners).collect();
        vertices.sort_unstable();
        vertices.dedup();
        let number = |v: u32| vertices.partition_point(|&other| other < v) as u32;
        let triangles: Vec<[u32; 3]> = own.iter().map(|triangle| triangle.corners.map(number)).collect();
        let positions: Vec<[f64; 3]> = vertices.iter().map(|&v| self.positions[v as usize]).collect();
        // 2. Without walls.
        let mut is_wall = vec![false; triangles.len()];
        for triangle in opposite_pairs(&triangles, positions.len()).into_iter().flatten() {
            is_wall[triangle as usize] = true;
        }
        let kept = || (0..own.len()).filter(|&t| !is_wall[t]);
        let mut triangles: Vec<[u32; 3]> = kept().map(|t| triangles[t]).collect();
        let sources: Vec<u32> = kept().map(|t| own[t].source).collect();
        let positions = compact(&positions, &mut triangles);
        // 3. What the given triangles say.
        let mut mesh = Mesh::new(positions, triangles);
        mesh.polygons = polygons_of_pieces(&given.polygons, given.triangles.len(), &sources);
        mesh.attributes = attributes_of_pieces(given, &mesh.positions, &mesh.triangles, &sources);
        mesh.groups = given.groups.clone();
        if !mesh.groups.is_empty() {
            let group = |&source: &u32| given.groups.of_triangle[source as usize];
            mesh.groups.of_triangle = sources.iter().map(group).collect();
        }
        (Solid::from_closed_unchecked(mesh), sources)
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
