//! Points where mistakes of a boolean would show: anywhere, close to the surfaces, and close to the curve.

use std::collections::HashSet;

use rand::RngExt;
use rand::rngs::ChaCha8Rng;
use trisect::Mesh;

use super::vector::{Point, cross, extent, minus, plus, unit};
use super::winding::corners;

/// `count` points for judging `result`, which came of `operands`.
pub(crate) fn points(operands: &[&Mesh], result: &Mesh, count: usize, random: &mut ChaCha8Rng) -> Vec<Point> {
    let all = || operands.iter().copied().chain([result]);
    let [low, high] = extent(all().flat_map(|mesh| &mesh.positions));
    if !low[0].is_finite() {
        return Vec::new();
    }
    let size = (0..3).map(|k| high[k] - low[k]).fold(f64::MIN_POSITIVE, f64::max);
    let filled: Vec<Vec<[Point; 3]>> = all().map(corners).filter(|triangles| !triangles.is_empty()).collect();
    let curve = new_vertices(operands, result);
    let mut points = Vec::with_capacity(count);
    for index in 0..count {
        // From a tenth of the size down to a few roundings.
        let step = size * 10f64.powf(random.random_range(-14.0..-1.0));
        let point = match index % 4 {
            0 => [0, 1, 2].map(|k| random.random_range(low[k] - 0.05 * size..high[k] + 0.05 * size)),
            1 if !curve.is_empty() => {
                let direction = [0; 3].map(|_| random.random_range(-1.0..1.0));
                plus(curve[random.random_range(0..curve.len())], unit(direction), step)
            }
            _ => {
                // Every mesh as often as any other, every triangle of it too: small ones matter most.
                let triangles = &filled[random.random_range(0..filled.len())];
                let [a, b, c] = triangles[random.random_range(0..triangles.len())];
                let (s, t): (f64, f64) = (random.random(), random.random());
                let (s, t) = if s + t > 1.0 { (1.0 - s, 1.0 - t) } else { (s, t) };
                let on = plus(plus(a, minus(b, a), s), minus(c, a), t);
                let normal = unit(cross(minus(b, a), minus(c, a)));
                plus(on, normal, if random.random() { step } else { -step })
            }
        };
        points.push(point);
    }
    points
}

/// Vertices of the result that no operand has.
fn new_vertices(operands: &[&Mesh], result: &Mesh) -> Vec<Point> {
    let bits = |p: &Point| p.map(f64::to_bits);
    let old: HashSet<[u64; 3]> = operands.iter().flat_map(|mesh| mesh.positions.iter().map(bits)).collect();
    result.positions.iter().filter(|p| !old.contains(&bits(p))).copied().collect()
}
