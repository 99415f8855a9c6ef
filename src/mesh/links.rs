//! The links of vertices: how the triangles around each hang together.
//!
//! A triangle (v, a, b) is the edge a -> b of the link of v. Where every link is made of simple cycles, every edge of the surface has
//! exactly two triangles, in opposite directions, so that it is closed; and each cycle is a fan. So one look around every vertex
//! settles at once whether a surface is closed, whether its edges are manifold, and where it is pinched.
//!
//! (A sum of hashes would tell in one pass without any memory that a surface is closed. It cannot tell whether an edge has two
//! triangles or four: to know of n directed edges that all differ takes memory for n of them, by any method. Of star-shaped surfaces it is known
//! otherwise; see `star`.)
//!
//! The edges are filed under their vertices, in rows of eight, every thread for vertices of its own; then no thread waits for
//! another. Where a vertex has more, its edges are filed by a counting sort. Memory: 68 bytes a vertex, given back at the end.

use std::ops::Range;

use rustc_hash::FxHashMap;
use smallvec::SmallVec;

use super::BitSet;
use crate::parallel::{map, piece_count, ranges};

/// Vertices from which a thread of its own is worth it: some tenths of a millisecond.
const VERTICES_PER_THREAD: usize = 1 << 14;

/// Where the surface of a result may hang together in another way than its operands do: at the corners of the triangles from some number on,
/// and at some other vertices. All other vertices have all triangles that they have in an operand, in one fan.
#[derive(Clone, Debug, Default)]
pub(crate) struct Changed {
    pub(crate) from: usize,
    pub(crate) vertices: Vec<u32>,
}

/// What the links of the vertices of a set of triangles are like.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Links {
    /// Some triangle has a repeated corner; then nothing else has been looked at.
    pub(super) repeated_corners: bool,
    /// The links are simple cycles: the surface is closed, and every edge has exactly two triangles. If not, what follows is not
    /// known.
    pub(super) edge_manifold: bool,
    /// How many vertices belong to no triangle.
    pub(super) unreferenced: usize,
    /// Some vertex belongs to just two triangles: these are opposite copies of each other.
    pub(super) two_triangle_vertex: bool,
    /// How many vertices have several fans.
    pub(super) pinched: usize,
    /// How many fans there are.
    pub(super) fans: usize,
}

impl Links {
    const NONE: Self = Self {
        repeated_corners: false,
        edge_manifold: true,
        unreferenced: 0,
        two_triangle_vertex: false,
        pinched: 0,
        fans: 0,
    };
    /// What is known of a surface that nobody has looked at.
    pub(super) const UNKNOWN: Self = Self { edge_manifold: false, ..Self::NONE };

    /// Those of a triangulation of the sphere.
    pub(super) fn of_ball(vertices: usize) -> Self {
        Self { fans: vertices, ..Self::NONE }
    }

    /// Looks around each of `vertices` vertices of `triangles`. O(n).
    ///
    /// # Errors
    /// The first triangle that names a vertex out of range. There are no more than 2^31 vertices and 2^32/3 triangles.
    pub(super) fn of(triangles: &[[u32; 3]], vertices: usize) -> Result<Self, usize> {
        let found = map(shares(vertices), |range| Self::of_range(triangles, vertices, range));
        let mut links = Self::NONE;
        for part in found {
            let Some(part) = part else {
                let is_out = |triangle: &[u32; 3]| triangle.iter().any(|&v| v as usize >= vertices);
                return Err(triangles.iter().position(is_out).unwrap_or_default());
            };
            links.repeated_corners |= part.repeated_corners;
            links.edge_manifold &= part.edge_manifold;
            links.unreferenced += part.unreferenced;
            links.two_triangle_vertex |= part.two_triangle_vertex;
            links.pinched += part.pinched;
            links.fans += part.fans;
        }
        Ok(links)
    }

    /// The same for a surface of which most is known. All corners must be in range and differ, and all vertices in use. A pass over the triangles,
    /// of a nanosecond or two each, and a look around the vertices that changed.
    pub(super) fn of_changed(triangles: &[[u32; 3]], vertices: usize, changed: &Changed) -> Self {
        let mut has_changed = BitSet::new(vertices);
        let corners = triangles[changed.from..].iter().flatten();
        corners.chain(&changed.vertices).for_each(|&v| has_changed.insert(v));
        let is_around = |corners: &&[u32; 3]| corners.iter().any(|&v| has_changed.contains(v));
        let around: Vec<[u32; 3]> = triangles.iter().filter(is_around).copied().collect();
        let mut numbers: FxHashMap<u32, usize> = FxHashMap::default();
        for vertex in has_changed.iter() {
            numbers.insert(vertex, numbers.len());
        }
        let count = numbers.len();
        let number = |vertex: u32| numbers.get(&vertex).copied().unwrap_or(count);
        let mut links = Self::of_ball(vertices - count);
        for link in LinkLists::of(around.iter().copied(), count, number).each() {
            if !links.add(link.len(), cycles(link)) {
                break;
            }
        }
        links
    }

    /// The same for some of the vertices; `None` where a triangle names one that is not there.
    fn of_range(triangles: &[[u32; 3]], vertices: usize, range: Range<usize>) -> Option<Self> {
        // 1. All edges, where a vertex has few.
        let mut rows = Rows::of(triangles, range);
        if !triangles.is_empty() && rows.highest as usize >= vertices {
            return None;
        }
        if rows.repeated_corners {
            return Some(Self { repeated_corners: true, edge_manifold: false, ..Self::NONE });
        }
        let mut links = Self::NONE;
        let mut has_many = false;
        for (row, &degree) in rows.rows.iter().zip(&rows.degrees[..rows.count()]) {
            if degree > FEW {
                has_many = true;
            } else if !links.add(degree as usize, cycles_of_row(row, degree)) {
                return Some(links);
            }
        }
        // 2. Those of the others.
        if has_many {
            for link in rows.take_lists_of_many(triangles).each() {
                if !links.add(link.len(), cycles(link)) {
                    return Some(links);
                }
            }
        }
        Some(links)
    }

    /// Whether both say the same, where they say anything.
    pub(super) fn agrees(&self, other: &Self) -> bool {
        self == other || !(self.edge_manifold || other.edge_manifold)
    }

    /// Adds the link of a vertex with so many triangles, which is so many cycles; false where it is none.
    #[inline]
    fn add(&mut self, degree: usize, cycles: Option<usize>) -> bool {
        match cycles {
            Some(0) => self.unreferenced += 1,
            Some(fans) => {
                self.two_triangle_vertex |= degree == 2;
                self.pinched += usize::from(fans > 1);
                self.fans += fans;
            }
            None => self.edge_manifold = false,
        }
        self.edge_manifold
    }
}

/// The vertices in pieces, one a thread. A thread that looks only at some of the vertices reads all triangles: more pieces than
/// threads cost more than they even out.
pub(super) fn shares(vertices: usize) -> Vec<Range<usize>> {
    ranges(vertices, piece_count(vertices, VERTICES_PER_THREAD).div_ceil(4))
}

/// The most edges of a link that are filed in its row: six is the mean of every closed surface, and sixteen numbers fill a line of a cache.
const FEW: u32 = 8;

/// The edges of a link, some of them where there are more than [`FEW`]: where they start, and then where they end. (Plain numbers, which
/// come zeroed from the system.)
type Row = [u32; 2 * FEW as usize];

/// How many cycles the edges of a row form, if there are `degree`; `None` where they are not simple cycles without a common vertex.
#[inline]
fn cycles_of_row(row: &Row, degree: u32) -> Option<usize> {
    let (starts, ends) = row.split_at(FEW as usize);
    // 1. Which edge goes on where each ends, and how many do, all side by side. (Those that are not there start at vertex 0: where one
    //    ends there, too many go on.)
    let (mut next, mut count) = ([0u32; FEW as usize], [0u32; FEW as usize]);
    for k in 0..FEW {
        let start = starts[k as usize];
        for i in 0..FEW as usize {
            let goes_on = u32::from(ends[i] == start);
            next[i] |= goes_on.wrapping_neg() & k;
            count[i] += goes_on;
        }
    }
    let all_have_one = count[..degree as usize].iter().fold(1, |all, &count| all & u32::from(count == 1));
    // 2. One round, nearly always, in which all are met; as many steps for any number, so that nothing has to be foreseen.
    let (mut at, mut met) = (0, 0u32);
    for _ in 0..FEW {
        met |= 1 << at;
        at = next[at as usize % FEW as usize];
    }
    if all_have_one == 1 && met == (1 << degree) - 1 {
        return Some(1);
    }
    let edges: SmallVec<[u64; FEW as usize]> =
        (0..degree as usize).map(|i| u64::from(ends[i]) << 32 | u64::from(starts[i])).collect();
    cycles(&edges)
}

/// The links of some vertices, filed in one pass, and what is seen on the way.
struct Rows {
    first: u32,
    /// By vertex; last of all others, which share that place. (So nothing branches: which it is, is as good as random.)
    rows: Vec<Row>,
    /// How many triangles each has.
    degrees: Vec<u32>,
    /// The highest vertex of all.
    highest: u32,
    repeated_corners: bool,
}

impl Rows {
    fn of(triangles: &[[u32; 3]], range: Range<usize>) -> Self {
        let (first, count) = (range.start as u32, range.len());
        let place = |vertex: u32| (vertex.wrapping_sub(first) as usize).min(count);
        let (mut rows, mut degrees) = (vec![[0; 2 * FEW as usize]; count + 1], vec![0u32; count + 1]);
        let (mut highest, mut repeated_corners) = (0, false);
        for &[a, b, c] in triangles {
            highest = highest.max(a).max(b).max(c);
            repeated_corners |= (a == b) | (b == c) | (c == a);
            for (vertex, from, to) in [(a, b, c), (b, c, a), (c, a, b)] {
                let place = place(vertex);
                let (row, degree) = (&mut rows[place], &mut degrees[place]);
                let slot = (*degree % FEW) as usize;
                (row[slot], row[slot + FEW as usize]) = (from, to);
                *degree = degree.wrapping_add(1);
            }
        }
        Self { first, rows, degrees, highest, repeated_corners }
    }

    fn count(&self) -> usize {
        self.degrees.len() - 1
    }

    /// The links of vertices with more edges than a row has. The degrees are gone then.
    fn take_lists_of_many(&mut self, triangles: &[[u32; 3]]) -> LinkLists {
        const NONE: u32 = u32::MAX;
        let count = self.count();
        let mut many = 0;
        for degree in &mut self.degrees[..count] {
            *degree = if *degree > FEW { many } else { NONE };
            many += u32::from(*degree != NONE);
        }
        self.degrees[count] = NONE;
        let (first, numbers) = (self.first, &self.degrees);
        let number = |vertex: u32| numbers[(vertex.wrapping_sub(first) as usize).min(count)];
        let has_many = |&&[a, b, c]: &&[u32; 3]| [a, b, c].into_iter().any(|v| number(v) != NONE);
        let around = triangles.iter().filter(has_many).copied();
        LinkLists::of(around, many as usize, |vertex| number(vertex) as usize)
    }
}

/// The links of some vertices.
pub(super) struct LinkLists {
    /// Where the list of each vertex ends; one more.
    ends: Vec<u32>,
    /// The edges, list after list: where each starts in the lower half, and where it ends in the upper one.
    edges: Vec<u64>,
}

impl LinkLists {
    /// Of some vertices, which `place` numbers from 0 to `count`; it gives `count` or more for all others.
    pub(super) fn of(
        triangles: impl Iterator<Item = [u32; 3]> + Clone,
        count: usize,
        place: impl Fn(u32) -> usize,
    ) -> Self {
        let place = |vertex| place(vertex).min(count);
        let mut counts = vec![0u32; count + 1];
        triangles.clone().flatten().for_each(|v| counts[place(v)] += 1);
        Self::filed(counts, triangles, place)
    }

    /// The same given how many there are of each; others share the last place.
    fn filed(
        mut ends: Vec<u32>,
        triangles: impl Iterator<Item = [u32; 3]>,
        place: impl Fn(u32) -> usize,
    ) -> Self {
        let count = ends.len() - 1;
        // Each start runs to the end of its list; what is filed under no vertex is written over, again and again.
        let mut total = 0;
        for end in &mut ends {
            total += std::mem::replace(end, total);
        }
        let mut edges = vec![0u64; ends[count] as usize + 1];
        for [a, b, c] in triangles {
            for (vertex, from, to) in [(a, b, c), (b, c, a), (c, a, b)] {
                let place = place(vertex);
                let end = &mut ends[place];
                edges[*end as usize] = u64::from(to) << 32 | u64::from(from);
                *end += u32::from(place != count);
            }
        }
        Self { ends, edges }
    }

    /// The edges of the link of each vertex.
    pub(super) fn each(&self) -> impl Iterator<Item = &[u64]> {
        let mut start = 0;
        self.ends[..self.ends.len() - 1].iter().map(move |&end| {
            let list = &self.edges[start..end as usize];
            start = end as usize;
            list
        })
    }
}

/// How many cycles the edges of a link form; `None` where they are not simple cycles without a common vertex.
#[inline]
fn cycles(edges: &[u64]) -> Option<usize> {
    match edges.len() {
        0 => Some(0),
        1..=8 => cycles_of_few::<8>(edges),
        9..=16 => cycles_of_few::<16>(edges),
        17..=32 => cycles_of_few::<32>(edges),
        _ => cycles_of_many(edges),
    }
}

/// The same for `N` edges at most, 32 at most: all are compared with all, side by side.
#[inline]
fn cycles_of_few<const N: usize>(edges: &[u64]) -> Option<usize> {
    // 1. Which edges go on where each ends, as bits. (No vertex has the number that stands for none.)
    let mut starts = [u32::MAX; N];
    starts.iter_mut().zip(edges).for_each(|(start, &edge)| *start = edge as u32);
    let mut next = [0u32; N];
    let (mut met, mut is_one) = (0u32, true);
    for (next, &edge) in next.iter_mut().zip(edges) {
        let end = (edge >> 32) as u32;
        for (k, &start) in starts.iter().enumerate() {
            *next |= u32::from(start == end) << k;
        }
        met |= *next;
        is_one &= next.is_power_of_two();
    }
    // 2. One goes on after each, and each goes on after one: none starts where another does.
    let all = u32::MAX >> (32 - edges.len());
    if !(is_one && met == all) {
        return None;
    }
    // 3. Round and round.
    let (mut left, mut cycles) = (all, 0);
    while left != 0 {
        let first = left & left.wrapping_neg();
        let mut at = first;
        loop {
            left &= !at;
            at = next[at.trailing_zeros() as usize % N];
            if at == first {
                break;
            }
        }
        cycles += 1;
    }
    Some(cycles)
}

/// The same for any number of edges, sorted.
#[inline(never)]
fn cycles_of_many(edges: &[u64]) -> Option<usize> {
    let mut edges = edges.to_vec();
    edges.sort_unstable_by_key(|&edge| edge as u32);
    if edges.windows(2).any(|pair| pair[0] as u32 == pair[1] as u32) {
        return None;
    }
    let mut is_seen = vec![false; edges.len()];
    let mut cycles = 0;
    for first in 0..edges.len() {
        if is_seen[first] {
            continue;
        }
        let mut at = first;
        // Each has one that goes on after it; where two have the same, the round does not come back to its first.
        while !std::mem::replace(&mut is_seen[at], true) {
            let end = (edges[at] >> 32) as u32;
            at = edges.binary_search_by_key(&end, |&edge| edge as u32).ok()?;
        }
        if at != first {
            return None;
        }
        cycles += 1;
    }
    Some(cycles)
}

#[cfg(test)]
mod tests {
    use rand::rngs::ChaCha8Rng;
    use rand::{RngExt, SeedableRng};

    use super::super::chain;
    use super::super::edges::EdgeTable;
    use super::super::topology::Topology;
    use super::*;

    const TETRAHEDRON: [[u32; 3]; 4] = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];

    #[test]
    fn a_tetrahedron_has_a_fan_at_every_vertex() {
        let links = Links::of(&TETRAHEDRON, 4).unwrap();
        assert_eq!(links, Links { fans: 4, ..Links::NONE });
        assert_eq!(Links::of(&TETRAHEDRON, 6).unwrap().unreferenced, 2);
        assert_eq!(Links::of(&TETRAHEDRON, 3), Err(1));
        assert!(!Links::of(&TETRAHEDRON[1..], 4).unwrap().edge_manifold);
        assert!(Links::of(&[[0, 0, 1]], 2).unwrap().repeated_corners);
        assert_eq!(Links::of(&[], 0), Ok(Links::NONE));
        assert!(Links::of(&[[0, 1, 2], [0, 2, 1]], 3).unwrap().two_triangle_vertex);
    }

    #[test]
    fn a_look_around_what_changed_tells_all() {
        let mut random = ChaCha8Rng::seed_from_u64(36);
        let (mut manifold, mut pinched) = (0, 0);
        for _ in 0..3_000 {
            // Balls with vertices and edges in common here and there, of which some come last.
            let mut triangles = Vec::new();
            let mut vertices = 0;
            for _ in 0..random.random_range(1..6) {
                let first = if vertices == 0 { 0 } else { vertices - random.random_range(0..3) };
                triangles.extend(TETRAHEDRON.map(|corners| corners.map(|corner| first + corner)));
                vertices = vertices.max(first + 4);
            }
            let from = random.random_range(0..=triangles.len());
            let lists = LinkLists::of(triangles.iter().copied(), vertices as usize, |v| v as usize);
            let is_one_fan = |link: &[u64]| cycles(link) == Some(1);
            let others = (0..).zip(lists.each()).filter(|(_, link)| !is_one_fan(link)).map(|(v, _)| v);
            let changed = Changed { from, vertices: others.collect() };
            let links = Links::of(&triangles, vertices as usize).unwrap();
            let found = Links::of_changed(&triangles, vertices as usize, &changed);
            assert!(links.agrees(&found), "{links:?}, not {found:?}: {triangles:?}, {changed:?}");
            manifold += u32::from(links.edge_manifold);
            pinched += u32::from(links.pinched > 0);
        }
        assert!(manifold > 500 && manifold < 2_500 && pinched > 200, "{manifold}, {pinched}");
    }

    #[test]
    fn hubs_of_any_size() {
        for ring in [3, 7, 8, 9, 15, 16, 17, 31, 32, 33, 1_000, 70_000] {
            // Two fans round hubs 0 and 1 over one ring, and the same again at the same hubs.
            let mut triangles = Vec::new();
            for copy in 0..2 {
                let at = |i: u32| 2 + copy * ring + i % ring;
                triangles.extend((0..ring).flat_map(|i| [[0, at(i), at(i + 1)], [1, at(i + 1), at(i)]]));
            }
            let vertices = 2 + 2 * ring as usize;
            let links = Links::of(&triangles, vertices).unwrap();
            assert!(links.edge_manifold);
            assert_eq!((links.pinched, links.fans), (2, 4 + 2 * ring as usize), "{ring}");
            triangles.pop();
            assert!(!Links::of(&triangles, vertices).unwrap().edge_manifold);
        }
    }

    #[test]
    fn links_agree_with_the_table_of_edges() {
        let mut random = ChaCha8Rng::seed_from_u64(16);
        let mut closed = 0;
        for round in 0..4_000 {
            // Tetrahedra over few vertices: closed, and nearly always they share edges or vertices somewhere.
            let vertices = random.random_range(4..40u32);
            let mut triangles = Vec::new();
            for _ in 0..random.random_range(1..8) {
                let corners: [u32; 4] = std::array::from_fn(|_| random.random_range(0..vertices));
                if (0..4).all(|i| (0..i).all(|j| corners[i] != corners[j])) {
                    triangles.extend(TETRAHEDRON.map(|triangle| triangle.map(|k| corners[k as usize])));
                }
            }
            if round % 4 == 0 && !triangles.is_empty() {
                let place = random.random_range(0..triangles.len());
                triangles[place].swap(0, 1);
            }
            let links = Links::of(&triangles, vertices as usize).unwrap();
            let chain = chain::examine(&triangles, vertices as usize).unwrap();
            assert_eq!(links.edge_manifold, chain.closed && chain.edge_manifold, "{triangles:?}");
            if links.edge_manifold {
                closed += 1;
                assert_eq!(links.unreferenced > 0, chain.unreferenced);
                assert_eq!(links.two_triangle_vertex, chain.two_triangle_vertex);
                let table = EdgeTable::new(&triangles, vertices as usize);
                let topology = Topology::of_edges(&table, &triangles, vertices as usize);
                assert_eq!(links.pinched, topology.pinched.len(), "{triangles:?}");
            }
        }
        assert!(closed > 500, "{closed}");
    }
}
