//! The loops of open edges around holes.

use rustc_hash::{FxHashMap, FxHashSet};

use super::super::UnionFind;
use super::super::weld::OpenEdge;

/// The loops around holes, each directed so that its filling lies to the left: against the open edges. A loop passes no vertex twice.
///
/// Where several holes meet in a vertex, faces meet there in several fans, and each hole lies between two of them. Which two no
/// loop can be sure of, but for a triangle all of whose edges are open: its own loop would be filled with itself, and the hole around it stay
/// open. At its corners a loop that comes along one fan goes on along another, by the smallest angle.
pub(super) fn rings(positions: &[[f64; 3]], triangles: &[[u32; 3]], boundary: &[OpenEdge]) -> Vec<Vec<u32>> {
    // 1. Which vertices follow on each, and where there are several the fans.
    let mut next: FxHashMap<u32, Vec<u32>> = FxHashMap::default();
    for edge in boundary {
        next.entry(edge.to).or_default().extend(std::iter::repeat_n(edge.from, edge.count as usize));
    }
    let is_open: FxHashSet<(u32, u32)> = boundary.iter().map(|edge| (edge.from, edge.to)).collect();
    let is_alone =
        |&&[a, b, c]: &&[u32; 3]| [(a, b), (b, c), (c, a)].iter().all(|edge| is_open.contains(edge));
    let alone = triangles.iter().filter(is_alone).flatten().copied();
    let fans =
        Fans::new(triangles, alone.filter(|v| next.get(v).is_some_and(|ends| ends.len() > 1)).collect());
    // (Taken from the end: the lowest first.)
    next.values_mut().for_each(|ends| ends.sort_unstable_by(|x, y| y.cmp(x)));
    // 2. From vertices that such triangles have not, then from the others.
    let mut starts: Vec<u32> = next.keys().copied().collect();
    starts.sort_unstable_by_key(|v| (fans.vertices.contains(v), *v));
    let mut loops = Vec::new();
    for start in starts {
        let mut path = vec![start];
        let mut place_of: FxHashMap<u32, usize> = FxHashMap::from_iter([(start, 0)]);
        while let Some(to) = path.last().copied().and_then(|end| {
            let ends = next.get_mut(&end)?;
            let before = path.len().checked_sub(2).map(|place| path[place]);
            let chosen = before
                .filter(|_| ends.len() > 1 && fans.vertices.contains(&end))
                .and_then(|from| fans.next(positions, [from, end], ends));
            match chosen {
                Some(place) => Some(ends.remove(place)),
                None => ends.pop(),
            }
        }) {
            match place_of.get(&to) {
                // Back at a vertex: what was passed since is a loop of its own.
                Some(&place) => {
                    let ring: Vec<u32> = path.drain(place..).collect();
                    ring.iter().for_each(|v| {
                        place_of.remove(v);
                    });
                    loops.push(ring);
                    place_of.insert(to, path.len());
                    path.push(to);
                }
                None => {
                    place_of.insert(to, path.len());
                    path.push(to);
                }
            }
        }
    }
    // A loop of two edges is closed by nothing, and open edges do not make one.
    loops.retain(|ring| ring.len() > 2);
    loops
}

/// The fans of faces at some vertices.
struct Fans {
    vertices: FxHashSet<u32>,
    /// By one of these vertices and one beside it the number of the edge between them.
    edges: FxHashMap<(u32, u32), u32>,
    /// By edge its fan.
    fans: Vec<u32>,
}

impl Fans {
    fn new(triangles: &[[u32; 3]], vertices: FxHashSet<u32>) -> Self {
        let (mut edges, mut pairs) = (FxHashMap::default(), Vec::new());
        if !vertices.is_empty() {
            for corners in triangles {
                for k in (0..3).filter(|&k| vertices.contains(&corners[k])) {
                    let pair = [1, 2].map(|i| {
                        let count = edges.len() as u32;
                        *edges.entry((corners[k], corners[(k + i) % 3])).or_insert(count)
                    });
                    pairs.push(pair);
                }
            }
        }
        let mut one = UnionFind::new(edges.len());
        pairs.into_iter().for_each(|[a, b]| one.join(a, b));
        Self { vertices, edges, fans: one.labels().1 }
    }

    /// Where in a list of vertices that follow on `end` the one is that a loop from `from` goes on to: of those of other fans the one by the
    /// smallest angle.
    fn next(&self, positions: &[[f64; 3]], [from, end]: [u32; 2], ends: &[u32]) -> Option<usize> {
        let fan = |other: u32| self.edges.get(&(end, other)).map(|&edge| self.fans[edge as usize]);
        let own = fan(from);
        let way = |other: u32| -> [f64; 3] {
            std::array::from_fn(|k| positions[other as usize][k] - positions[end as usize][k])
        };
        let dot = |x: [f64; 3], y: [f64; 3]| x[0] * y[0] + x[1] * y[1] + x[2] * y[2];
        let back = way(from);
        let cosine = |other: u32| {
            let way = way(other);
            dot(back, way) / (dot(back, back) * dot(way, way)).sqrt()
        };
        let others = (0..ends.len()).filter(|&place| fan(ends[place]) != own);
        others.max_by(|&i, &j| cosine(ends[i]).total_cmp(&cosine(ends[j])).then(ends[j].cmp(&ends[i])))
    }
}
