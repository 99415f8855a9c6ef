//! Welding: making one vertex of several at the same place, so that surfaces split along seams close.
//!
//! Only vertices on open edges are welded. For closing the surface the others do not matter: the boundary of a
//! chain is a sum of its open edges, and maps to zero or not by where their ends go. So bodies that are closed
//! already and merely touch stay apart.

use rustc_hash::FxHashMap;

use super::edges::EdgeTable;

/// A directed edge whose opposite is missing, so many times.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct OpenEdge {
    pub(super) from: u32,
    pub(super) to: u32,
    pub(super) count: u32,
}

/// The boundary of `triangles` as a chain: empty iff they are closed. In ascending order of the edges.
pub(super) fn boundary(triangles: &[[u32; 3]], vertices: usize) -> Vec<OpenEdge> {
    let table = EdgeTable::new(triangles, vertices);
    let open = table.iter().filter_map(|edge| {
        let net = edge.net();
        let (from, to) = if net > 0 { (edge.low, edge.high) } else { (edge.high, edge.low) };
        (net != 0).then_some(OpenEdge { from, to, count: net.unsigned_abs() as u32 })
    });
    open.collect()
}

/// Whether the edges cancel once every vertex is replaced by what `target` says.
pub(super) fn cancels(edges: &[OpenEdge], target: impl Fn(u32) -> u32) -> bool {
    let mut directed: Vec<(u32, u32, i64)> = edges
        .iter()
        .map(|edge| (target(edge.from), target(edge.to), i64::from(edge.count)))
        .filter(|(from, to, _)| from != to)
        .map(|(from, to, count)| if from < to { (from, to, count) } else { (to, from, -count) })
        .collect();
    directed.sort_unstable();
    let mut edges = directed.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1));
    edges.all(|edge| edge.iter().map(|entry| entry.2).sum::<i64>() == 0)
}

/// The coordinates as bits that are equal for equal numbers: minus zero counts as zero.
pub(super) fn position_bits(position: &[f64; 3]) -> [u64; 3] {
    position.map(|x| (x + 0.0).to_bits())
}

/// For each of `vertices` (ascending) the first of them at exactly its place.
pub(super) fn exact_targets(positions: &[[f64; 3]], vertices: &[u32]) -> Vec<u32> {
    // Open addressing with linear probing. A map of the standard library takes three times as long, and every
    // vertex of an STL file comes through here.
    const FREE: u32 = u32::MAX;
    let capacity = (2 * vertices.len()).next_power_of_two().max(2);
    let shift = 64 - capacity.trailing_zeros();
    let mut table = vec![FREE; capacity];
    let place = |vertex: u32| position_bits(&positions[vertex as usize]);
    let insert = |&vertex: &u32| {
        let bits = place(vertex);
        let mut slot = (mix(bits) >> shift) as usize;
        loop {
            let found = table[slot];
            if found == FREE {
                table[slot] = vertex;
                return vertex;
            }
            if place(found) == bits {
                return found;
            }
            slot = (slot + 1) & (capacity - 1);
        }
    };
    vertices.iter().map(insert).collect()
}

/// A number whose high bits depend on all bits of the coordinates.
fn mix(bits: [u64; 3]) -> u64 {
    const ODD: [u64; 3] = [0x9E37_79B9_7F4A_7C15, 0xBF58_476D_1CE4_E5B9, 0x94D0_49BB_1331_11EB];
    let mut sum = 0u64;
    for axis in 0..3 {
        // Short floats have their lower half zero: fold it in before multiplying.
        let folded = bits[axis] ^ bits[axis] >> 32;
        sum = (sum ^ folded).wrapping_mul(ODD[axis]).rotate_left(29);
    }
    (sum ^ sum >> 32).wrapping_mul(ODD[0])
}

/// For each of `vertices` (ascending) the one it joins when places within `distance` become one: taken in order,
/// a vertex joins the nearest (of equally near ones the first) of those that stand for a place, or else stands
/// for its own. Takes time in proportion to the number of vertices.
pub(super) fn near_targets(positions: &[[f64; 3]], vertices: &[u32], distance: f64) -> Vec<u32> {
    // Cells a little wider than twice the distance: what is near a place is in its cell or in those beyond the
    // nearer side of the cell along each axis. The places that stand are far enough apart to be few in a cell.
    let width = 2.5 * distance;
    let mut cells: FxHashMap<[i64; 3], Vec<u32>> = FxHashMap::default();
    let mut targets = Vec::with_capacity(vertices.len());
    for &vertex in vertices {
        let place = positions[vertex as usize];
        let spans = place.map(|x| cells_near(x, width));
        let mut nearest: Option<(f64, u32)> = None;
        for choice in 0..8 {
            let near = cells.get(&[0, 1, 2].map(|axis: usize| spans[axis][choice >> axis & 1]));
            for &standing in near.into_iter().flatten() {
                let other = positions[standing as usize];
                let apart = (place[0] - other[0]).hypot(place[1] - other[1]).hypot(place[2] - other[2]);
                if apart <= distance && nearest.is_none_or(|found| (apart, standing) < found) {
                    nearest = Some((apart, standing));
                }
            }
        }
        targets.push(nearest.map_or(vertex, |(_, standing)| standing));
        if nearest.is_none() {
            cells.entry(spans.map(|span| span[0])).or_default().push(vertex);
        }
    }
    targets
}

/// The number of the cell of width `width` that `x` is in, and that of the neighbour nearer to `x`. Where cells are
/// too many to count, neighbouring floats are farther apart than a cell is wide, and each has a cell of its own.
pub(super) fn cells_near(x: f64, width: f64) -> [i64; 2] {
    let (cell, within) = ((x / width).floor(), x / width);
    if cell.abs() > 4.0e18 {
        return [position_bits(&[x; 3])[0] as i64; 2];
    }
    let number = cell as i64;
    [number, if within - cell < 0.5 { number - 1 } else { number + 1 }]
}

/// A map of all vertices to themselves but for `vertices`, which go to `targets`.
pub(super) fn vertex_map(count: usize, vertices: &[u32], targets: &[u32]) -> Vec<u32> {
    let mut map: Vec<u32> = (0..count as u32).collect();
    for (&vertex, &target) in vertices.iter().zip(targets) {
        map[vertex as usize] = target;
    }
    map
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_places_join_the_first() {
        let positions = [[0.0, 1.0, 2.0], [5.0; 3], [-0.0, 1.0, 2.0], [0.0, 1.0, 2.0], [5.0; 3]];
        assert_eq!(exact_targets(&positions, &[0, 1, 2, 3, 4]), [0, 1, 0, 0, 1]);
        assert_eq!(exact_targets(&positions, &[2, 3, 4]), [2, 2, 4]);
        assert_eq!(exact_targets(&positions, &[]), [0; 0]);
        let ulp = [[1.0, 0.0, 0.0], [1.0_f64.next_up(), 0.0, 0.0]];
        assert_eq!(exact_targets(&ulp, &[0, 1]), [0, 1]);
    }

    #[test]
    fn near_places_join_the_nearest() {
        let line = |x: f64| [x, 0.0, 0.0];
        let positions = [line(0.0), line(1.0), line(0.6), line(-0.04), line(1e300), line(1.5)];
        assert_eq!(near_targets(&positions, &[0, 1, 2, 3, 4, 5], 0.5), [0, 1, 1, 0, 4, 1]);
        assert_eq!(near_targets(&positions, &[0, 1, 2, 3, 4, 5], 0.01), [0, 1, 2, 3, 4, 5]);
    }

    #[test]
    fn boundary_of_a_triangle() {
        let boundary = boundary(&[[2, 0, 1]], 3);
        let edge = |from, to| OpenEdge { from, to, count: 1 };
        assert_eq!(boundary, [edge(0, 1), edge(2, 0), edge(1, 2)]);
        assert!(!cancels(&boundary, |vertex| vertex));
        assert!(cancels(&boundary, |vertex| vertex.min(1)));
    }
}
