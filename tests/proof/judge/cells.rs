//! Solids made of unit cubes of a lattice: everything about them can be counted.

use std::collections::HashMap;

use trisect::Mesh;

use super::surface::Sets;

type Cell = [i64; 3];

/// A set of unit cubes, each named by its lowest corner.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Cells(std::collections::BTreeSet<Cell>);

/// A unit square between a cell that is in and one that is not: its corners, counter-clockwise seen from outside.
struct Square {
    inside: Cell,
    corners: [Cell; 4],
}

/// The surface of cells, cut apart where they touch in edges and vertices alone.
pub(crate) struct CellSurface {
    pub(crate) mesh: Mesh,
    pub(crate) squares: usize,
    pub(crate) components: usize,
    pub(crate) euler: i64,
}

impl Cells {
    /// Those of a box of lattice points that fulfil a condition.
    pub(crate) fn new(low: Cell, high: Cell, is_in: impl Fn(Cell) -> bool) -> Self {
        let mut cells = std::collections::BTreeSet::new();
        for x in low[0]..high[0] {
            for y in low[1]..high[1] {
                for z in low[2]..high[2] {
                    if is_in([x, y, z]) {
                        cells.insert([x, y, z]);
                    }
                }
            }
        }
        Self(cells)
    }

    pub(crate) fn contains(&self, cell: Cell) -> bool {
        self.0.contains(&cell)
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    pub(crate) fn count(&self) -> usize {
        self.0.len()
    }

    /// The cells in the result of an operation.
    pub(crate) fn combined(&self, operation: trisect::Operation, other: &Self) -> Self {
        use trisect::Operation::{Difference, Intersection, SymmetricDifference, Union};
        Self(match operation {
            Union => self.0.union(&other.0).copied().collect(),
            Intersection => self.0.intersection(&other.0).copied().collect(),
            Difference => self.0.difference(&other.0).copied().collect(),
            SymmetricDifference => self.0.symmetric_difference(&other.0).copied().collect(),
            other => unreachable!("nothing is expected of {other}"),
        })
    }

    fn squares(&self) -> Vec<Square> {
        let mut squares = Vec::new();
        for &cell in &self.0 {
            for axis in 0..3 {
                for up in [false, true] {
                    let mut beyond = cell;
                    beyond[axis] += if up { 1 } else { -1 };
                    if self.contains(beyond) {
                        continue;
                    }
                    let (next, last) = ((axis + 1) % 3, (axis + 2) % 3);
                    let mut corners = [(0, 0), (1, 0), (1, 1), (0, 1)].map(|(u, v)| {
                        let mut corner = cell;
                        corner[axis] += i64::from(up);
                        corner[next] += u;
                        corner[last] += v;
                        corner
                    });
                    if !up {
                        corners.reverse();
                    }
                    squares.push(Square { inside: cell, corners });
                }
            }
        }
        squares
    }

    /// The boundary as a 2-manifold: at an edge of four squares, those of one cell belong together; at a vertex of several
    /// fans, each has a vertex of its own.
    pub(crate) fn surface(&self) -> CellSurface {
        let squares = self.squares();
        let mut at_edge: HashMap<[Cell; 2], Vec<(usize, usize)>> = HashMap::new();
        for (index, square) in squares.iter().enumerate() {
            for k in 0..4 {
                let (u, v) = (square.corners[k], square.corners[(k + 1) % 4]);
                at_edge.entry([u.min(v), u.max(v)]).or_default().push((index, k));
            }
        }
        let (mut corners, mut bodies) = (Sets::new(4 * squares.len()), Sets::new(squares.len()));
        for sides in at_edge.values() {
            for (i, &(s, k)) in sides.iter().enumerate() {
                for &(t, l) in &sides[i + 1..] {
                    if sides.len() == 2 || squares[s].inside == squares[t].inside {
                        bodies.join(s, t);
                        // The squares run along the edge in opposite directions.
                        corners.join(4 * s + k, 4 * t + (l + 1) % 4);
                        corners.join(4 * s + (k + 1) % 4, 4 * t + l);
                    }
                }
            }
        }
        let mut number: HashMap<usize, u32> = HashMap::new();
        let mut mesh = Mesh::default();
        for (index, square) in squares.iter().enumerate() {
            let quad = [0, 1, 2, 3].map(|k| {
                *number.entry(corners.find(4 * index + k)).or_insert_with(|| {
                    mesh.positions.push(square.corners[k].map(|x| x as f64));
                    mesh.positions.len() as u32 - 1
                })
            });
            mesh.triangles.extend([[quad[0], quad[1], quad[2]], [quad[0], quad[2], quad[3]]]);
        }
        CellSurface {
            euler: number.len() as i64 - 2 * squares.len() as i64 + squares.len() as i64,
            components: bodies.count(),
            squares: squares.len(),
            mesh,
        }
    }
}
