//! Which edges of two triangles run along one another.

use crate::exact::{collinear, orient3d_filter};

/// The sides of two triangles that lie on one line, exactly, and have a length in common there; side k runs from corner k to the
/// next. Nearly always two corners of the second are plainly off the plane of the first, and nothing else is asked.
pub(crate) fn sides_along(a: &[[f64; 3]; 3], b: &[[f64; 3]; 3]) -> impl Iterator<Item = [usize; 2]> + use<> {
    let is_plainly_off = |p: &[f64; 3]| {
        let (determinant, bound) = orient3d_filter(&a[0], &a[1], &a[2], p);
        determinant.abs() > bound
    };
    let asked = b.iter().filter(|p| is_plainly_off(p)).count() < 2;
    let pairs = asked.then(|| pairs_along(a, b));
    pairs.into_iter().flatten()
}

#[cold]
fn pairs_along(a: &[[f64; 3]; 3], b: &[[f64; 3]; 3]) -> Vec<[usize; 2]> {
    // (Seen along an axis nearly all sides are plainly askew, where their planes are one but for rounding, too.)
    let side = |of: &[[f64; 3]; 3], k: usize| [of[k], of[(k + 1) % 3]];
    let pairs = (0..3).flat_map(|j| (0..3).map(move |i| [i, j]));
    pairs.filter(|&[i, j]| run_along(side(a, i), side(b, j))).collect()
}

/// Whether two segments lie on one line and have a length in common.
fn run_along([p, q]: [[f64; 3]; 2], [u, v]: [[f64; 3]; 2]) -> bool {
    // Along an axis on which the first has a length; on one line places along it are in the order of the points.
    let Some(axis) = (0..3).find(|&k| p[k] != q[k]) else { return false };
    let (low, high) = (p[axis].min(q[axis]), p[axis].max(q[axis]));
    u[axis].min(v[axis]).max(low) < u[axis].max(v[axis]).min(high)
        && collinear(&p, &q, &u)
        && collinear(&p, &q, &v)
}

#[cfg(test)]
mod tests {
    use super::*;

    const FIRST: [[f64; 3]; 3] = [[0.0, 0.0, 0.0], [4.0, 2.0, 6.0], [0.0, 5.0, 0.0]];

    fn sides(second: [[f64; 3]; 3]) -> Vec<[usize; 2]> {
        sides_along(&FIRST, &second).collect()
    }

    #[test]
    fn a_part_of_a_side_runs_along_it_either_way() {
        let within = [[1.0, 0.5, 1.5], [2.0, 1.0, 3.0], [3.0, -7.0, 2.0]];
        assert_eq!(sides(within), [[0, 0]]);
        assert_eq!(sides([within[2], within[1], within[0]]), [[0, 1]]);
        let across_its_end = [[3.0, -7.0, 2.0], [2.0, 1.0, 3.0], [6.0, 3.0, 9.0]];
        assert_eq!(sides(across_its_end), [[0, 1]]);
    }

    #[test]
    fn a_triangle_runs_along_itself_with_all_sides() {
        assert_eq!(sides(FIRST), [[0, 0], [1, 1], [2, 2]]);
    }

    #[test]
    fn sides_that_meet_in_a_point_or_not_at_all_do_not_run_along_each_other() {
        let beyond = [[4.0, 2.0, 6.0], [6.0, 3.0, 9.0], [3.0, -7.0, 2.0]];
        assert_eq!(sides(beyond), [[0_usize; 2]; 0]);
        let beside = [[1.0, 0.5, 1.5], [2.0, 1.0, 3.0 + 1e-15 * 4.0], [3.0, -7.0, 2.0]];
        assert_eq!(sides(beside), [[0_usize; 2]; 0]);
        let across = [[1.0, 0.5, 1.5], [2.0, 3.0, 3.0], [3.0, -7.0, 2.0]];
        assert_eq!(sides(across), [[0_usize; 2]; 0]);
    }
}
