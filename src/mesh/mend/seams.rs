//! Seams whose two sides are a rounding apart: which vertex joins which.

use rustc_hash::FxHashMap;

use super::super::weld::cells_near;
use super::rounding::{Reaches, apart};

/// A cell of a grid: the number of the grid, and where in it.
type Cell = (usize, [i64; 3]);

/// For each of the vertices the one it joins: taken in ascending order, a vertex joins the nearest (of equally near ones the
/// first) of those that stand for a place, if it is within the reach of both, or else stands for its own. Near-linear: the
/// reaches are sorted by their powers of two, and each power has a grid of its own.
pub(super) fn targets(positions: &[[f64; 3]], reaches: &Reaches) -> Vec<u32> {
    let power = |reach: f64| (reach.to_bits() >> 52) as i64;
    let mut powers: Vec<i64> = reaches.iter().map(|(_, reach)| power(reach)).collect();
    powers.sort_unstable();
    powers.dedup();
    // A little more than twice what the reaches of a power can be: what is near a place is in its cell, or in those beyond
    // the nearer side of the cell along each axis.
    let widths: Vec<f64> =
        powers.iter().map(|&power| 2.5 * f64::from_bits(((power + 1) as u64).min(2046) << 52)).collect();
    let mut cells: FxHashMap<Cell, Vec<(u32, f64)>> = FxHashMap::default();
    let mut targets = Vec::with_capacity(reaches.vertices().len());
    for (vertex, reach) in reaches.iter() {
        let place = positions[vertex as usize];
        let mut nearest: Option<(f64, u32)> = None;
        for (level, &width) in widths.iter().enumerate() {
            let spans = place.map(|x| cells_near(x, width));
            for choice in 0..8 {
                let near = cells.get(&(level, [0, 1, 2].map(|axis: usize| spans[axis][choice >> axis & 1])));
                for &(standing, its_reach) in near.into_iter().flatten() {
                    let distance = apart(&place, &positions[standing as usize]);
                    let within = distance <= reach.min(its_reach);
                    if within && nearest.is_none_or(|found| (distance, standing) < found) {
                        nearest = Some((distance, standing));
                    }
                }
            }
        }
        targets.push(nearest.map_or(vertex, |(_, standing)| standing));
        if nearest.is_none() {
            let level = powers.binary_search(&power(reach)).unwrap_or_default();
            let cell = place.map(|x| cells_near(x, widths[level])[0]);
            cells.entry((level, cell)).or_default().push((vertex, reach));
        }
    }
    targets
}

#[cfg(test)]
mod tests {
    use super::super::super::weld::OpenEdge;
    use super::*;

    #[test]
    fn places_a_rounding_apart_join_the_first() {
        let ulp = f64::from(f32::EPSILON);
        let positions = [
            [1.0, 0.0, 0.0],
            [2.0, 0.0, 0.0],
            [1.0 + ulp, -ulp, 0.0],
            [1.0 + 16.0 * ulp, 0.0, 0.0],
            [1e-5, 0.0, 0.0],
        ];
        let edges = [(0, 1), (2, 1), (3, 1), (4, 1)].map(|(from, to)| OpenEdge { from, to, count: 1 });
        let reaches = Reaches::new(&positions, &edges, None);
        assert_eq!(targets(&positions, &reaches), [0, 1, 0, 3, 4]);
        let reaches = Reaches::new(&positions, &edges, Some(0.99));
        assert_eq!(targets(&positions, &reaches), [0, 1, 0, 0, 4]);
    }

    #[test]
    fn both_reaches_count() {
        // The third vertex has a short edge, so that little is rounding there.
        let positions = [[1.0, 0.0, 0.0], [0.0; 3], [1.0, 1e-7, 0.0], [1.0, 2e-7, 0.0]];
        let edges = [(0, 1), (2, 3)].map(|(from, to)| OpenEdge { from, to, count: 1 });
        assert_eq!(targets(&positions, &Reaches::new(&positions, &edges, None)), [0, 1, 2, 3]);
        assert_eq!(targets(&positions, &Reaches::new(&positions, &edges[..1], None)), [0, 1]);
    }
}
