//! Vertices in the middle of an open edge: which, and the triangles of the edge cut up with them.

use super::points::PointTree;
use super::rounding::{Reaches, apart};

/// Boxes and points that may be looked at for each edge on average, before the search is given up: some ten times what
/// the densest meshes met so far need. Only a soup made for it comes near.
const LOOKS_PER_EDGE: usize = 4_000;
/// The same for all edges together: about a second.
const LOOKS: usize = 100_000_000;

/// For each of the edges (two vertices) the vertices that lie on it, in their order from the first end to the second.
/// `None` if the search takes too long.
pub(super) fn on_edges(
    positions: &[[f64; 3]],
    edges: &[(u32, u32)],
    reaches: &Reaches,
) -> Option<Vec<Vec<u32>>> {
    let mut points: Vec<u32> = edges.iter().flat_map(|&(a, b)| [a, b]).collect();
    points.sort_unstable();
    points.dedup();
    let tree = PointTree::new(positions, points);
    let mut looks = LOOKS.min(LOOKS_PER_EDGE * edges.len() + LOOKS_PER_EDGE);
    let mut found = Vec::with_capacity(edges.len());
    for &(a, b) in edges {
        let ends = [&positions[a as usize], &positions[b as usize]];
        let reach = reaches.of(a).min(reaches.of(b));
        let mut on: Vec<(f64, u32)> = Vec::new();
        let looked_at = tree.near_segment(ends, reach, |point| {
            if point != a && point != b {
                let within = reach.min(reaches.of(point));
                on.extend(along(ends, &positions[point as usize], within).map(|at| (at, point)));
            }
        });
        looks = looks.checked_sub(looked_at)?;
        on.sort_unstable_by(|x, y| x.0.total_cmp(&y.0).then(x.1.cmp(&y.1)));
        found.push(on.into_iter().map(|(_, point)| point).collect());
    }
    Some(found)
}

/// How far along the segment (between 0 and 1) a place lies, if it is within `reach` of its inside.
fn along([a, b]: [&[f64; 3]; 2], place: &[f64; 3], reach: f64) -> Option<f64> {
    let whole: [f64; 3] = std::array::from_fn(|axis| b[axis] - a[axis]);
    // Divided by its longest side, so that squares neither under- nor overflow.
    let scale = whole.iter().fold(0.0f64, |scale, x| scale.max(x.abs()));
    let unit = whole.map(|x| x / scale);
    let way: [f64; 3] = std::array::from_fn(|axis| (place[axis] - a[axis]) / scale);
    let dot = |u: &[f64; 3], v: &[f64; 3]| u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
    let at = dot(&way, &unit) / dot(&unit, &unit);
    let foot = unit.map(|x| x * at);
    (at > 0.0 && at < 1.0 && apart(&way, &foot) * scale <= reach).then_some(at)
}

/// The triangle cut up so that its sides run over further vertices: `on[k]` those between corner k and the next, in their
/// order. A vertex that is the opposite corner (of a triangle without area) makes pieces with a repeated corner, which are
/// left out: the boundary of the pieces is always the sides with their vertices.
pub(crate) fn fan_around_splits(triangle: [u32; 3], on: [&[u32]; 3]) -> Vec<[u32; 3]> {
    let Some(side) = (0..3).find(|&side| !on[side].is_empty()) else { return vec![triangle] };
    let [a, b, c] = [0, 1, 2].map(|k| triangle[(side + k) % 3]);
    let [first, second, third] = [0, 1, 2].map(|k| on[(side + k) % 3]);
    // A fan from the opposite corner over the inside of the side; the two triangles beside it as fans from the outermost
    // vertices of the side over the other two.
    let (near_a, near_b) = (first[0], first[first.len() - 1]);
    let mut pieces = Vec::with_capacity(on.iter().map(|on| on.len()).sum::<usize>() + 1);
    let mut fan = |apex: u32, path: &[u32]| {
        let triangles = path.windows(2).map(|pair| [apex, pair[0], pair[1]]);
        pieces.extend(triangles.filter(|[a, b, c]| a != b && b != c && c != a));
    };
    fan(near_a, &[&[c], third, &[a]].concat());
    fan(c, first);
    fan(near_b, &[&[b], second, &[c]].concat());
    pieces
}

#[cfg(test)]
mod tests {
    use super::super::super::weld;
    use super::*;

    #[test]
    fn pieces_have_the_boundary_of_the_whole() {
        let lists: [&[u32]; 4] = [&[], &[3], &[4, 5], &[6, 7, 8]];
        for (i, j, k) in (0..64).map(|n| (n % 4, n / 4 % 4, n / 16)) {
            // Different vertices on every side.
            let [first, second, third] = [(lists[i], 0), (lists[j], 10), (lists[k], 20)]
                .map(|(list, by)| list.iter().map(|v| v + by).collect::<Vec<u32>>());
            let pieces = fan_around_splits([0, 1, 2], [&first, &second, &third]);
            assert_eq!(pieces.len(), first.len() + second.len() + third.len() + 1);
            let outline = [&[0], &first[..], &[1], &second, &[2], &third, &[0]].concat();
            let mut expected: Vec<(u32, u32)> = outline.windows(2).map(|pair| (pair[0], pair[1])).collect();
            expected.sort_unstable();
            let mut found: Vec<(u32, u32)> =
                weld::boundary(&pieces, 30).iter().map(|edge| (edge.from, edge.to)).collect();
            found.sort_unstable();
            assert_eq!(found, expected, "{first:?} {second:?} {third:?}");
        }
    }

    #[test]
    fn a_triangle_without_area_vanishes() {
        assert_eq!(fan_around_splits([0, 1, 2], [&[2], &[], &[]]), [[0u32; 3]; 0]);
        assert_eq!(fan_around_splits([0, 1, 2], [&[3, 2], &[], &[]]), [[3, 2, 0]]);
    }

    #[test]
    fn vertices_are_found_in_their_order() {
        let x = |x: f64| [x, 2.0 * x, -x];
        let positions = [x(0.0), x(1.0), x(0.75), x(0.25), [0.5, 1.0, -0.4], x(1.25), x(1e-9)];
        let edges = [(0, 1), (1, 0), (2, 3), (4, 5), (6, 6)];
        let open: Vec<_> = edges.iter().map(|&(from, to)| weld::OpenEdge { from, to, count: 1 }).collect();
        let reaches = Reaches::new(&positions, &open, None);
        let found = on_edges(&positions, &edges, &reaches).unwrap();
        assert_eq!(found[..4], [vec![6, 3, 2], vec![2, 3, 6], vec![], vec![]]);
    }

    #[test]
    fn a_segment_of_any_magnitude_has_an_inside() {
        for scale in [1e-300, 1.0, 1e300] {
            let ends = [&[0.0; 3], &[scale, scale, 0.0]];
            assert_eq!(along(ends, &[0.5 * scale, 0.5 * scale, 0.0], 0.0), Some(0.5), "{scale}");
            assert_eq!(along(ends, &[0.5 * scale, 0.25 * scale, 0.0], 0.1 * scale), None, "{scale}");
        }
        assert_eq!(along([&[1.0; 3], &[1.0; 3]], &[1.0; 3], 1.0), None);
    }
}
