//! Points on a grid, and what becomes of triangles there.

use rustc_hash::FxHashMap;

use super::{Grid, Parts};
use crate::mesh::opposite_pairs;
use crate::mesh::star::mixed;

/// Rounds all positions to the grid, those of some triangles to one that is coarser by some bits, and there to a place beside the nearest if they are
/// shaken, with a seed. Returns how far a point has moved at most.
pub(super) fn round(
    parts: &mut Parts,
    grid: Grid,
    coarser: u32,
    shakes: Option<u64>,
    troubled: &[u32],
) -> f64 {
    let mut bits = vec![0; parts.positions.len()];
    if coarser > 0 {
        for &triangle in troubled {
            parts.triangles[triangle as usize].iter().for_each(|&v| bits[v as usize] = coarser);
        }
    }
    let mut furthest = 0.0f64;
    for (position, bits) in parts.positions.iter_mut().zip(bits) {
        let old = *position;
        *position = match grid {
            Grid::Double => old,
            Grid::Single => old.map(single),
        };
        if bits > 0 {
            let steps = shakes.map_or([0.0; 3], |seed| steps_beside(&old, seed));
            let largest = old.iter().fold(0.0f64, |largest, x| largest.max(x.abs()));
            *position = std::array::from_fn(|k| to_spacing(position[k], steps[k], largest, grid, bits));
        }
        let moved = (0..3).map(|k| (position[k] - old[k]).powi(2)).sum::<f64>().sqrt();
        furthest = furthest.max(moved);
    }
    furthest
}

/// -1, 0 or 1 along each axis, as good as at random, the same for points at one place.
fn steps_beside(position: &[f64; 3], seed: u64) -> [f64; 3] {
    let mut number = position.iter().fold(seed, |number, x| mixed(number ^ (x + 0.0).to_bits()));
    [(); 3].map(|()| {
        number = mixed(number);
        (number % 3) as f64 - 1.0
    })
}

/// The nearest `f32`, or the largest.
pub(super) fn single(x: f64) -> f64 {
    f64::from((x as f32).clamp(-f32::MAX, f32::MAX))
}

/// A coordinate rounded to a multiple of a spacing, and so many steps on: that of the grid at the largest coordinate of its point, times 2^bits.
fn to_spacing(x: f64, steps: f64, largest: f64, grid: Grid, bits: u32) -> f64 {
    // The power of two below the largest coordinate.
    let leading = f64::from_bits(largest.to_bits() & 0x7ff0_0000_0000_0000);
    let spacing = leading * grid.unit() * f64::from(bits).exp2();
    if spacing == 0.0 || !spacing.is_normal() {
        return x;
    }
    let rounded = ((x / spacing).round() + steps) * spacing;
    if rounded.is_finite() { rounded } else { x }
}

/// Makes one of points that have become equal, and drops triangles with a repeated corner.
pub(super) fn merge(parts: &mut Parts) {
    let mut first: FxHashMap<[u64; 3], u32> = FxHashMap::default();
    let number: Vec<u32> = (0..)
        .zip(&parts.positions)
        .map(|(v, position)| *first.entry(position.map(|x| (x + 0.0).to_bits())).or_insert(v))
        .collect();
    let mut kept = 0;
    for t in 0..parts.triangles.len() {
        let [a, b, c] = parts.triangles[t].map(|v| number[v as usize]);
        if a != b && b != c && c != a {
            parts.triangles[kept] = [a, b, c];
            parts.origins[kept] = parts.origins[t];
            if !parts.groups.is_empty() {
                parts.groups[kept] = parts.groups[t];
            }
            kept += 1;
        }
    }
    parts.triangles.truncate(kept);
    parts.origins.truncate(kept);
    parts.groups.truncate(kept);
}

/// Drops pairs of triangles on the same corners that look opposite ways: there is nothing between them.
pub(super) fn cancel(parts: &mut Parts) {
    let pairs = opposite_pairs(&parts.triangles, parts.positions.len());
    if pairs.is_empty() {
        return;
    }
    let mut is_dropped = vec![false; parts.triangles.len()];
    pairs.into_iter().flatten().for_each(|t| is_dropped[t as usize] = true);
    let keep = |t: &mut usize| {
        *t += 1;
        !is_dropped[*t - 1]
    };
    let [mut a, mut b, mut c] = [0; 3];
    parts.triangles.retain(|_| keep(&mut a));
    parts.origins.retain(|_| keep(&mut b));
    parts.groups.retain(|_| keep(&mut c));
}
