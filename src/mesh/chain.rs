//! Whether triangles form a closed chain: every directed edge is met by its opposite as often as it occurs.
//!
//! Exact, and near the cost of reading the triangles: each edge is filed under the lower of its two vertices by a
//! counting sort (one pass to count, one to file), then every vertex has a short list to look through. Nothing is
//! hashed, so the order of triangles and vertices hardly matters, and a vertex of any valence is handled alike.
//! Memory: 12 bytes a triangle and 9 a vertex.

use super::parallel::join;

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

/// The triangle's corners turned so that the lowest comes first.
#[inline]
pub(super) fn lowest_first([a, b, c]: [u32; 3]) -> [u32; 3] {
    // Selections instead of branches: the order of the corners is as good as random.
    let low = a.min(b).min(c);
    let next = if low == a {
        b
    } else if low == b {
        c
    } else {
        a
    };
    let last = if low == a {
        c
    } else if low == b {
        a
    } else {
        b
    };
    [low, next, last]
}

/// Examines the edges of `triangles` over `vertices` vertices.
///
/// # Errors
/// The first triangle that names a vertex out of range. The limits above are the caller's to check.
pub(super) fn examine(triangles: &[[u32; 3]], vertices: usize) -> Result<Chain, usize> {
    // How often a vertex is the lowest, the middle and (up to 255 times) the highest of a triangle.
    let mut lowest = vec![0u32; vertices];
    let mut middle = vec![0u32; vertices];
    let mut highest = vec![0u8; vertices];
    let mut repeated_corners = false;
    for (index, &triangle) in triangles.iter().enumerate() {
        let [low, next, last] = lowest_first(triangle);
        let (mid, high) = (next.min(last), next.max(last));
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
    let mut chain = Chain {
        repeated_corners,
        unreferenced: false,
        two_triangle_vertex: false,
        closed: false,
        edge_manifold: false,
    };
    if repeated_corners {
        return Ok(chain);
    }
    // The lowest corner files two edges, the middle one files one.
    let mut total = 0;
    for ((low, &mid), &high) in lowest.iter_mut().zip(&middle).zip(&highest) {
        let valence = u64::from(*low) + u64::from(mid) + u64::from(high);
        chain.unreferenced |= valence == 0;
        chain.two_triangle_vertex |= valence == 2;
        let filed = 2 * *low + mid;
        *low = total;
        total += filed;
    }
    drop((middle, highest));
    let mut ends = lowest;
    let mut entries = vec![0u32; total as usize];
    let mut file = |under: u32, entry: u32| {
        let end = &mut ends[under as usize];
        entries[*end as usize] = entry;
        *end += 1;
    };
    for &triangle in triangles {
        let [low, next, last] = lowest_first(triangle);
        file(low, upward(next));
        file(low, downward(last));
        if next < last {
            file(next, upward(last));
        } else {
            file(last, downward(next));
        }
    }
    let balance = weigh(&ends, 0, &mut entries);
    Ok(Chain { closed: balance.closed, edge_manifold: balance.closed && balance.edge_manifold, ..chain })
}

/// An edge filed under its lower vertex, running up to `high`.
#[inline]
fn upward(high: u32) -> u32 {
    high << 1
}

/// An edge filed under its lower vertex, coming down from `high`.
#[inline]
fn downward(high: u32) -> u32 {
    high << 1 | 1
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
        let (a, b) = join(|| weigh(left, start, left_entries), || weigh(right, middle, right_entries));
        return Balance { closed: a.closed && b.closed, edge_manifold: a.edge_manifold && b.edge_manifold };
    }
    let mut balance = Balance { closed: true, edge_manifold: true };
    let mut begin = 0;
    for &end in ends {
        let end = (end - start) as usize;
        let list = &mut entries[begin..end];
        begin = end;
        list.sort_unstable();
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

/// Whether the sorted list has every edge exactly once in each direction.
#[inline]
fn is_two_by_two(list: &[u32]) -> bool {
    let mut good = list.len().is_multiple_of(2);
    let mut previous = u32::MAX;
    for pair in list.chunks_exact(2) {
        good &= (pair[0] & 1 == 0) & (pair[0] ^ pair[1] == 1) & (pair[0] != previous);
        previous = pair[0];
    }
    good
}

/// Whether the sorted list has every edge equally often in each direction.
fn is_balanced(list: &[u32]) -> bool {
    list.chunk_by(|a, b| a >> 1 == b >> 1)
        .all(|edge| 2 * edge.iter().filter(|&entry| entry & 1 == 0).count() == edge.len())
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
