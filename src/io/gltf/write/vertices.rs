//! Vertices as a file holds them: one for each place and values at it, so that a vertex at a seam becomes several.

use rustc_hash::FxHashMap;
use smallvec::SmallVec;

use super::columns::Column;
use crate::Mesh;
use crate::mesh::Attribute;

/// More vertices at one place are looked up by hash: walking through them all for each corner would take a square.
const LONGEST_CHAIN: usize = 16;

/// The end of a chain.
const END: u32 = u32::MAX;

/// The vertices of a file.
pub(super) struct Vertices {
    /// The vertex of the mesh that each is at; nothing if they are those of the mesh.
    pub(super) source: Option<Vec<u32>>,
    /// The value that each has of each column.
    pub(super) values: Vec<Vec<u32>>,
    /// The triangles, in vertices of the file; nothing if they are those of the mesh.
    corners: Option<Vec<[u32; 3]>>,
    count: usize,
}

impl Vertices {
    /// Makes a vertex of each place and values there, in the order of the mesh's vertices. O(corners).
    pub(super) fn of(mesh: &Mesh, columns: &[Column<'_>]) -> Self {
        if columns.is_empty() {
            return Self { source: None, values: Vec::new(), corners: None, count: mesh.positions.len() };
        }
        let mut split = Split::new(mesh, columns);
        let mut corners = mesh.triangles.clone();
        for (corner, vertex) in corners.as_flattened_mut().iter_mut().enumerate() {
            *vertex = split.vertex(*vertex, corner);
        }
        split.sorted(corners)
    }

    /// How many there are.
    pub(super) fn len(&self) -> usize {
        self.count
    }

    /// The corners of a triangle.
    pub(super) fn triangle(&self, mesh: &Mesh, triangle: u32) -> [u32; 3] {
        self.corners.as_ref().unwrap_or(&mesh.triangles)[triangle as usize]
    }

    /// The vertex of the mesh that a vertex of the file is at.
    pub(super) fn source(&self, vertex: u32) -> u32 {
        self.source.as_ref().map_or(vertex, |source| source[vertex as usize])
    }
}

/// Vertices as they come up.
struct Split<'a> {
    columns: &'a [Column<'a>],
    /// The first vertex at each place, and after each vertex the next one at the same place.
    first: Vec<u32>,
    next: Vec<u32>,
    source: Vec<u32>,
    values: Vec<Vec<u32>>,
    /// Vertices at places that have many.
    crowded: FxHashMap<(u32, SmallVec<[u32; 16]>), u32>,
}

impl<'a> Split<'a> {
    fn new(mesh: &Mesh, columns: &'a [Column<'a>]) -> Self {
        Self {
            columns,
            first: vec![END; mesh.positions.len()],
            next: Vec::new(),
            source: Vec::new(),
            values: vec![Vec::new(); columns.len()],
            crowded: FxHashMap::default(),
        }
    }

    /// The vertex at a place with the values of a corner.
    fn vertex(&mut self, place: u32, corner: usize) -> u32 {
        let value = |column: &Column<'_>| column.attribute.of_corner[corner];
        let (mut at, mut steps, mut last) = (self.first[place as usize], 0, END);
        while at != END && steps < LONGEST_CHAIN {
            let same = |(column, values): (&Column<'_>, &Vec<u32>)| {
                let (a, b) = (values[at as usize], value(column));
                (a == Attribute::NONE) == (b == Attribute::NONE) && column.is_same(a, b)
            };
            if self.columns.iter().zip(&self.values).all(same) {
                return at;
            }
            (last, at, steps) = (at, self.next[at as usize], steps + 1);
        }
        let fresh = self.source.len() as u32;
        if steps == LONGEST_CHAIN {
            let mut key = SmallVec::new();
            for column in self.columns {
                let index = value(column);
                key.push(u32::from(index == Attribute::NONE));
                key.extend(column.value(index).iter().map(|&number| (number as f32).to_bits()));
            }
            let found = *self.crowded.entry((place, key)).or_insert(fresh);
            if found != fresh {
                return found;
            }
        } else if last == END {
            self.first[place as usize] = fresh;
        } else {
            self.next[last as usize] = fresh;
        }
        self.next.push(END);
        self.source.push(place);
        for (column, values) in self.columns.iter().zip(&mut self.values) {
            values.push(column.attribute.of_corner[corner]);
        }
        fresh
    }

    /// The vertices in the order of their places, those at one place as they came up.
    fn sorted(self, mut corners: Vec<[u32; 3]>) -> Vertices {
        let count = self.source.len();
        let mut order: Vec<u32> = (0..count as u32).collect();
        if !self.source.is_sorted() {
            order.sort_by_key(|&vertex| self.source[vertex as usize]);
        }
        let mut number = vec![0; count];
        for (new, &old) in order.iter().enumerate() {
            number[old as usize] = new as u32;
        }
        corners.as_flattened_mut().iter_mut().for_each(|vertex| *vertex = number[*vertex as usize]);
        let sorted = |list: &[u32]| order.iter().map(|&old| list[old as usize]).collect::<Vec<u32>>();
        Vertices {
            source: Some(sorted(&self.source)),
            values: self.values.iter().map(|values| sorted(values)).collect(),
            corners: Some(corners),
            count,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::primitives;

    #[test]
    fn seams_split_vertices_and_equal_values_do_not() {
        let mut mesh = primitives::cuboid([0.0; 3], [1.0; 3]).unwrap();
        let mut normals = Attribute::new("NORMAL", 3);
        // A value for each corner, though those of one face are equal.
        for triangle in &mesh.triangles {
            let [a, b, c] = triangle.map(|corner| glam::DVec3::from(mesh.positions[corner as usize]));
            let normal = (b - a).cross(c - a).normalize();
            (0..3).for_each(|_| normals.values.extend(normal.to_array()));
        }
        normals.of_corner = (0..36).collect();
        mesh.attributes = vec![normals];
        let columns = Column::of(&mesh, false, &mut Vec::new());
        let vertices = Vertices::of(&mesh, &columns);
        assert_eq!(vertices.len(), 24);
        for triangle in 0..12 {
            let sources = vertices.triangle(&mesh, triangle).map(|vertex| vertices.source(vertex));
            assert_eq!(sources, mesh.triangles[triangle as usize]);
        }
    }

    #[test]
    fn a_hub_with_many_values_is_split_in_linear_time() {
        // Each triangle has values of its own, but for every second corner at the hub.
        let count = 50_000_u32;
        let positions = (0..=count).map(|i| [f64::from(i), 0.0, 0.0]).collect();
        let triangles = (1..count).map(|i| [0, i, i + 1]).collect();
        let mut mesh = Mesh::new(positions, triangles);
        let mut values = Attribute::new("_ID", 1);
        values.values = (0..count).map(f64::from).collect();
        values.of_corner = (0..count - 1).flat_map(|i| [i / 2, i, i]).collect();
        mesh.attributes = vec![values];
        let columns = Column::of(&mesh, false, &mut Vec::new());
        let vertices = Vertices::of(&mesh, &columns);
        let hub = (0..vertices.len() as u32).filter(|&vertex| vertices.source(vertex) == 0).count();
        assert_eq!(hub as u32, count / 2);
    }
}
