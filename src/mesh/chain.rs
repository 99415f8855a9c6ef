//! Whether triangles form a closed chain: every directed edge is met by its opposite as often as it occurs.
//!
//! Exact, and near the cost of reading the triangles: each edge is filed under the lower of its two vertices by a
//! counting sort (one pass to count, one to file), then every vertex has a short list to look through. Nothing is
//! hashed, so the order of triangles and vertices hardly matters, and a vertex of any valence is handled alike.
//! Memory: 12 bytes a triangle and 9 a vertex.

use crate::parallel::join;

/// The most triangles a mesh may have, so that three entries each can be counted in 32 bits.
pub(super) const MAX_TRIANGLES: usize = (u32::MAX / 3) as usize;
/// The most vertices a mesh may have: an entry keeps one bit of 32 for the direction.
pub(super) const MAX_VERTICES: usize = 1 << 31;

/// What the edges of a set of triangles are like.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Chain {
    /// Some triangle has a repeated corner; then nothing else has been looked at.
    pub(super) repeated_corners: bool,
    /// Some vertex belongs to no triangle.
    pub(super) unreferenced: bool,
    /// Some vertex belongs to just two triangles. In a closed chain these are opposite copies of each other.
    pub(super) two_triangle_vertex: bool,
    /// Every directed edge is met by its opposite equally often.
    pub(super) closed: bool,
    /// Every edge has exactly two triangles, in opposite directions.
    pub(super) edge_manifold: bool,
}

/// The triangle's corners in ascending order, and whether that order is an odd permutation of them: whether the
/// triangle runs from the lowest to the highest to the middle one.
///
/// Without a branch: the order of the corners is as good as random.
#[inline]
pub(super) fn sorted([a, b, c]: [u32; 3]) -> ([u32; 3], bool) {
    let (low, high) = (a.min(b).min(c), a.max(b).max(c));
    ([low, a ^ b ^ c ^ low ^ high, high], (a < b) ^ (b < c) ^ (c < a))
}

/// Examines the edges of `triangles` over `vertices` vertices.
///
/// # Errors
/// The first triangle that names a vertex out of range. The limits above are the caller's to check.
pub(super) fn examine(triangles: &[[u32; 3]], vertices: usize) -> Result<Chain, usize> {
    let counts = Counts::new(triangles, vertices)?;
    let mut chain = Chain {
        repeated_corners: counts.repeated_corners,
        unreferenced: false,
        two_triangle_vertex: false,
        closed: false,
        edge_manifold: false,
    };
    if chain.repeated_corners {
        return Ok(chain);
    }
    for ((&low, &mid), &high) in counts.lowest.iter().zip(&counts.middle).zip(&counts.highest) {
        let valence = u64::from(low) + u64::from(mid) + u64::from(high);
        chain.unreferenced |= valence == 0;
        chain.two_triangle_vertex |= valence == 2;
    }
    let (ends, mut entries) = counts.file(triangles);
    let balance = weigh(&ends, 0, &mut entries);
    Ok(Chain { closed: balance.closed, edge_manifold: balance.closed && balance.edge_manifold, ..chain })
}

/// The vertices on edges whose directions do not cancel, ascending. The corners of `triangles` are in range and
/// differ.
pub(super) fn open_vertices(triangles: &[[u32; 3]], vertices: usize) -> Vec<u32> {
    let Ok(counts) = Counts::new(triangles, vertices) else { return Vec::new() };
    let (ends, mut entries) = counts.file(triangles);
    let mut open = vec![false; vertices];
    let mut begin = 0;
    for (low, &end) in ends.iter().enumerate() {
        let list = &mut entries[begin..end as usize];
        begin = end as usize;
        if is_two_by_two(list) {
            continue;
        }
        list.sort_unstable();
        for edge in list.chunk_by(|a, b| a >> 1 == b >> 1).filter(|edge| !cancels(edge)) {
            open[low] = true;
            open[(edge[0] >> 1) as usize] = true;
        }
    }
    (0..).zip(open).filter(|&(_, open)| open).map(|(vertex, _)| vertex).collect()
}

/// How often each vertex is the lowest, the middle and (up to 255 times) the highest of a triangle.
struct Counts {
    lowest: Vec<u32>,
    middle: Vec<u32>,
    highest: Vec<u8>,
    repeated_corners: bool,
}

impl Counts {
    fn new(triangles: &[[u32; 3]], vertices: usize) -> Result<Self, usize> {
        let mut lowest = vec![0u32; vertices];
        let mut middle = vec![0u32; vertices];
        let mut highest = vec![0u8; vertices];
        let mut repeated_corners = false;
        for (index, &triangle) in triangles.iter().enumerate() {
            let ([low, mid, high], _) = sorted(triangle);
            let counts =
                (lowest.get_mut(low as usize), middle.get_mut(mid as usize), highest.get_mut(high as usize));
            let (Some(low_count), Some(mid_count), Some(high_count)) = counts else {
                return Err(index);
            };
            *low_count += 1;
            *mid_count += 1;
            *high_count = high_count.saturating_add(1);
            repeated_corners |= (low == mid) | (mid == high);
        }
        Ok(Self { lowest, middle, highest, repeated_corners })
    }

    /// The edges filed under their lower vertices: where the list of each vertex ends, and all lists.
    fn file(self, triangles: &[[u32; 3]]) -> (Vec<u32>, Vec<u32>) {
        // The lowest corner files two edges, the middle one files one.
        let mut total = 0;
        let mut ends = self.lowest;
        for (low, mid) in ends.iter_mut().zip(self.middle) {
            let filed = 2 * *low + mid;
            *low = total;
            total += filed;
        }
        let mut entries = vec![0u32; total as usize];
        let mut file = |under: u32, entry: u32| {
            let end = &mut ends[under as usize];
            entries[*end as usize] = entry;
            *end += 1;
        };
        for &triangle in triangles {
            let ([low, mid, high], odd) = sorted(triangle);
            file(low, entry(mid, odd));
            file(low, entry(high, !odd));
            file(mid, entry(high, odd));
        }
        (ends, entries)
    }
}

/// An edge filed under its lower vertex: up to `high`, or down from there.
#[inline]
fn entry(high: u32, down: bool) -> u32 {
    high << 1 | u32::from(down)
}

#[derive(Clone, Copy)]
struct Balance {
    closed: bool,
    edge_manifold: bool,
}

/// Looks through the lists of the vertices whose lists end at `ends`; `entries` are those lists, the first of them
/// beginning at `start` of the whole.
fn weigh(ends: &[u32], start: u32, entries: &mut [u32]) -> Balance {
    const PIECE: usize = 1 << 15;
    if ends.len() > PIECE {
        let (left, right) = ends.split_at(ends.len() / 2);
        let middle = left[left.len() - 1];
        let (left_entries, right_entries) = entries.split_at_mut((middle - start) as usize);
        let (a, b) =
            join(usize::MAX, || weigh(left, start, left_entries), || weigh(right, middle, right_entries));
        return Balance { closed: a.closed && b.closed, edge_manifold: a.edge_manifold && b.edge_manifold };
    }
    let mut balance = Balance { closed: true, edge_manifold: true };
    let mut begin = 0;
    for &end in ends {
        let end = (end - start) as usize;
        let list = &mut entries[begin..end];
        begin = end;
        if !is_two_by_two(list) {
            balance.edge_manifold = false;
            if !is_balanced(list) {
                balance.closed = false;
                break;
            }
        }
    }
    balance
}

/// Whether the list has every edge exactly once in each direction.
#[inline]
fn is_two_by_two(list: &mut [u32]) -> bool {
    /// Up to this length looking for each entry's partner is faster than sorting.
    const SHORT: usize = 32;
    if list.len() % 2 == 1 {
        return false;
    }
    if list.len() > SHORT {
        list.sort_unstable();
        let pairs = || list.chunks_exact(2);
        return pairs().all(|pair| pair[0] ^ pair[1] == 1)
            && pairs().zip(pairs().skip(1)).all(|(a, b)| a[0] != b[0]);
    }
    let mut different = true;
    for first in (0..list.len()).step_by(2) {
        let partner = list[first] ^ 1;
        let Some(found) = (first + 1..list.len()).find(|&index| list[index] == partner) else {
            return false;
        };
        list.swap(first + 1, found);
        for before in (0..first).step_by(2) {
            different &= list[before] >> 1 != partner >> 1;
        }
    }
    different
}

/// Whether the list has every edge equally often in each direction.
fn is_balanced(list: &mut [u32]) -> bool {
    list.sort_unstable();
    list.chunk_by(|a, b| a >> 1 == b >> 1).all(cancels)
}

/// Whether the entries of one edge are equally many in each direction.
fn cancels(edge: &[u32]) -> bool {
    2 * edge.iter().filter(|&entry| entry & 1 == 0).count() == edge.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    const TETRAHEDRON: [[u32; 3]; 4] = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];

    #[test]
    fn tetrahedron_is_closed() {
        let chain = examine(&TETRAHEDRON, 4).unwrap();
        let expected = Chain {
            repeated_corners: false,
            unreferenced: false,
            two_triangle_vertex: false,
            closed: true,
            edge_manifold: true,
        };
        assert_eq!(chain, expected);
        assert!(examine(&TETRAHEDRON, 5).unwrap().unreferenced);
        assert!(!examine(&TETRAHEDRON[1..], 4).unwrap().closed);
        assert_eq!(examine(&TETRAHEDRON, 3), Err(1));
        assert_eq!(open_vertices(&TETRAHEDRON, 4), [0; 0]);
        assert_eq!(open_vertices(&TETRAHEDRON[1..], 4), [0, 1, 2]);
    }

    #[test]
    fn one_reversed_triangle_opens_it() {
        let mut triangles = TETRAHEDRON;
        triangles[2].swap(0, 1);
        assert!(!examine(&triangles, 4).unwrap().closed);
    }

    #[test]
    fn multiplicities_count() {
        let mut twice = TETRAHEDRON.to_vec();
        twice.extend(TETRAHEDRON);
        let chain = examine(&twice, 4).unwrap();
        assert!(chain.closed && !chain.edge_manifold);
        let pillow = [[0, 1, 2], [0, 2, 1]];
        let chain = examine(&pillow, 3).unwrap();
        assert!(chain.closed && chain.edge_manifold && chain.two_triangle_vertex);
    }

    #[test]
    fn a_vertex_of_any_valence_is_handled() {
        // Two fans round hubs 0 and 1 over one ring: a double cone.
        let ring = 100_000u32;
        let mut triangles = Vec::new();
        for i in 0..ring {
            let (a, b) = (2 + i, 2 + (i + 1) % ring);
            triangles.push([0, a, b]);
            triangles.push([1, b, a]);
        }
        let chain = examine(&triangles, ring as usize + 2).unwrap();
        assert!(chain.closed && chain.edge_manifold && !chain.unreferenced);
        triangles.pop();
        assert!(!examine(&triangles, ring as usize + 2).unwrap().closed);
    }
}
