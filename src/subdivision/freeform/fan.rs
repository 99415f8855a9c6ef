//! Triangles with points on their sides as triangles.

/// A triangle with points on at most two of its sides, as triangles.
pub(super) fn fan(corners: [u32; 3], sides: &[Vec<u32>; 3]) -> Vec<[u32; 3]> {
    if sides.iter().all(Vec::is_empty) {
        return vec![corners];
    }
    // Turned so that the side from a to b is one without points.
    let Some(empty) = (0..3).find(|&k| sides[k].is_empty()) else {
        return vec![corners];
    };
    let (a, b, c) = (corners[empty], corners[(empty + 1) % 3], corners[(empty + 2) % 3]);
    // From c to a, and from c to b.
    let mut left: Vec<u32> = vec![c];
    left.extend(&sides[(empty + 2) % 3]);
    left.push(a);
    let mut right: Vec<u32> = vec![c];
    right.extend(sides[(empty + 1) % 3].iter().rev());
    right.push(b);
    let mut triangles = vec![[c, left[1], right[1]]];
    let (mut i, mut j) = (1, 1);
    while i + 1 < left.len() || j + 1 < right.len() {
        let (p, q) = (i as f64 / (left.len() - 1) as f64, j as f64 / (right.len() - 1) as f64);
        if i + 1 < left.len() && (p <= q || j + 1 == right.len()) {
            triangles.push([left[i], left[i + 1], right[j]]);
            i += 1;
        } else {
            triangles.push([left[i], right[j + 1], right[j]]);
            j += 1;
        }
    }
    triangles
}

#[cfg(test)]
mod tests {
    use rustc_hash::FxHashSet;

    use super::*;

    /// The boundary of a fan is that of the triangle with its points.
    #[test]
    fn fans_fill_the_triangle() {
        for sides in [
            [vec![], vec![], vec![]],
            [vec![3], vec![], vec![]],
            [vec![3, 4, 5], vec![], vec![6]],
            [vec![], vec![3, 4, 5], vec![6, 7, 8]],
            [vec![3, 4], vec![5, 6, 7], vec![]],
        ] {
            let triangles = fan([0, 1, 2], &sides);
            let points = 3 + sides.iter().map(Vec::len).sum::<usize>();
            assert_eq!(triangles.len(), points - 2, "{sides:?}: {triangles:?}");
            let mut open: FxHashSet<(u32, u32)> = FxHashSet::default();
            for t in &triangles {
                for k in 0..3 {
                    let (u, v) = (t[k], t[(k + 1) % 3]);
                    if !open.remove(&(v, u)) {
                        assert!(open.insert((u, v)));
                    }
                }
            }
            let mut outline = Vec::new();
            for k in 0..3 {
                outline.push(k as u32);
                outline.extend(&sides[k]);
            }
            for i in 0..outline.len() {
                assert!(
                    open.contains(&(outline[i], outline[(i + 1) % outline.len()])),
                    "{sides:?} {triangles:?}"
                );
            }
            assert_eq!(open.len(), outline.len());
        }
    }
}
