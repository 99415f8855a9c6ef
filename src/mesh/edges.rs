//! The edges of a mesh and the triangles at each.

use super::buckets::Buckets;
use super::chain::sorted;

/// Every edge with its triangles, in the order of its lower, then its higher vertex. Building it costs O(n), with
/// a short sort per vertex.
pub(super) struct EdgeTable<'a> {
    triangles: &'a [[u32; 3]],
    /// Under the lower vertex of each edge: higher vertex and triangle in one number, sorted.
    under: Buckets<u64>,
}

/// An undirected edge.
#[derive(Clone, Copy)]
pub(super) struct Edge<'a> {
    pub(super) low: u32,
    pub(super) high: u32,
    table: &'a EdgeTable<'a>,
    uses: &'a [u64],
}

impl<'a> EdgeTable<'a> {
    /// The edges of `triangles`, whose corners are in range and differ.
    pub(super) fn new(triangles: &'a [[u32; 3]], vertices: usize) -> Self {
        let entries = triangles.iter().enumerate().flat_map(|(index, &triangle)| {
            let ([low, mid, high], _) = sorted(triangle);
            let entry = |under: u32, top: u32| (under, u64::from(top) << 32 | index as u64);
            [entry(low, mid), entry(low, high), entry(mid, high)]
        });
        let mut under = Buckets::new(vertices, entries);
        for vertex in 0..under.len() {
            under.get_mut(vertex).sort_unstable();
        }
        Self { triangles, under }
    }

    /// The edges, lexicographically by their vertices.
    pub(super) fn iter(&'a self) -> impl Iterator<Item = Edge<'a>> {
        (0..self.under.len()).flat_map(move |low| {
            let chunks = self.under.get(low).chunk_by(|a, b| a >> 32 == b >> 32);
            chunks.map(move |uses| Edge { low: low as u32, high: (uses[0] >> 32) as u32, table: self, uses })
        })
    }
}

impl<'a> Edge<'a> {
    /// The triangles at the edge, in ascending order.
    pub(super) fn triangles(self) -> impl Iterator<Item = u32> + Clone + 'a {
        self.uses.iter().map(|&entry| entry as u32)
    }

    /// How many triangles are at the edge.
    pub(super) fn valence(self) -> usize {
        self.uses.len()
    }

    /// Whether `triangle`, one of the edge's, runs from the lower vertex to the higher.
    pub(super) fn is_upward(self, triangle: u32) -> bool {
        let [a, b, c] = self.table.triangles[triangle as usize];
        [(a, b), (b, c), (c, a)].contains(&(self.low, self.high))
    }

    /// How much more often the edge is run upwards than downwards.
    pub(super) fn net(self) -> i64 {
        self.triangles().map(|triangle| if self.is_upward(triangle) { 1 } else { -1 }).sum()
    }

    /// Whether it has exactly two triangles, in opposite directions.
    pub(super) fn is_manifold(self) -> bool {
        self.valence() == 2 && self.net() == 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edges_know_their_triangles() {
        let triangles = [[0, 1, 2], [3, 1, 0], [0, 1, 4]];
        let table = EdgeTable::new(&triangles, 5);
        let edges: Vec<_> =
            table.iter().map(|edge| (edge.low, edge.high, edge.valence(), edge.net())).collect();
        let expected = [
            (0, 1, 3, 1),
            (0, 2, 1, -1),
            (0, 3, 1, 1),
            (0, 4, 1, -1),
            (1, 2, 1, 1),
            (1, 3, 1, -1),
            (1, 4, 1, 1),
        ];
        assert_eq!(edges, expected);
        assert_eq!(table.iter().next().unwrap().triangles().collect::<Vec<_>>(), [0, 1, 2]);
    }
}
