//! Cells that the surface crosses in more than one piece, or whose faces it cuts in more than one line: divided into
//! tetrahedra from a point in the cell, each of which the surface crosses in at most one piece.

/// A corner of a tetrahedron: its number in the cell, and whether it is inside.
pub(super) type Corner = (u32, bool);

/// Adds the surface's triangles in the tetrahedron `corners`, where the first three are counter-clockwise seen from
/// outside the fourth's side. `cut` gives the vertex between two corners.
pub(super) fn add(corners: [Corner; 4], mut cut: impl FnMut(u32, u32) -> u32, triangles: &mut Vec<[u32; 3]>) {
    // The faces opposite each corner, outward.
    const OPPOSITE: [[usize; 3]; 4] = [[1, 3, 2], [0, 2, 3], [0, 3, 1], [0, 1, 2]];
    let number = |k: usize| corners[k].0;
    let inside: Vec<usize> = (0..4).filter(|&k| corners[k].1).collect();
    let outside: Vec<usize> = (0..4).filter(|&k| !corners[k].1).collect();
    match (&inside[..], &outside[..]) {
        (&[alone], _) => {
            triangles.push(OPPOSITE[alone].map(|k| cut(number(alone), number(k))));
        }
        (_, &[alone]) => {
            let [a, b, c] = OPPOSITE[alone].map(|k| cut(number(alone), number(k)));
            triangles.push([a, c, b]);
        }
        (&[p, q], &[r, s]) => {
            // In order, so even permutations are those of (0,1|2,3), (0,3|1,2), (1,2|0,3) and their complements.
            let even = matches!((p, q), (0, 1) | (2, 3) | (0, 3) | (1, 2));
            let (r, s) = if even { (r, s) } else { (s, r) };
            let [pr, qr, qs, ps] = [(p, r), (q, r), (q, s), (p, s)].map(|(a, b)| cut(number(a), number(b)));
            triangles.push([pr, qr, qs]);
            triangles.push([pr, qs, ps]);
        }
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;

    #[test]
    fn every_sign_pattern_faces_the_outside() {
        // The first three corners counter-clockwise from above, the fourth below.
        let places = [DVec3::ZERO, DVec3::X, DVec3::Y, -DVec3::Z];
        for pattern in 1..15u32 {
            let corners: [Corner; 4] = std::array::from_fn(|k| (k as u32, pattern >> k & 1 == 1));
            let mut middles = Vec::new();
            let mut triangles = Vec::new();
            let cut = |a: u32, b: u32| {
                middles.push((places[a as usize] + places[b as usize]) * 0.5);
                (middles.len() - 1) as u32
            };
            add(corners, cut, &mut triangles);
            assert_eq!(triangles.len(), if pattern.count_ones() == 2 { 2 } else { 1 });
            let mean = |inside: bool| {
                let chosen: Vec<DVec3> =
                    (0..4).filter(|&k| corners[k].1 == inside).map(|k| places[k]).collect();
                chosen.iter().sum::<DVec3>() / chosen.len() as f64
            };
            for [a, b, c] in triangles.into_iter().map(|t| t.map(|k| middles[k as usize])) {
                let normal = (b - a).cross(c - a);
                assert!(normal.dot(mean(false) - mean(true)) > 0.0, "pattern {pattern:04b}");
            }
        }
    }
}
