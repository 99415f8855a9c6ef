//! Fillings of holes refined until their edges are as long as those around, and made fair: bent on like the surface around them.
//!
//! After Liepa 2003: triangles are split at their middles while these are further from the corners than edges around are long, edges
//! between them flipped to the better diagonal, and the new vertices placed where the sum of all squared bends is least.

use rustc_hash::{FxHashMap, FxHashSet};

use super::rounding::apart;

/// Rounds of splitting: each makes edges shorter by nearly a half, so that this is enough for any hole of an ordinary mesh.
const MOST_ROUNDS: usize = 24;
/// Passes of flips after each round.
const MOST_FLIPS: usize = 8;
/// New vertices at most.
const MOST_VERTICES: usize = 1 << 18;
/// A triangle is split if its middle is further from its corners than this part of the length of edges there.
const SPLIT_FROM: f64 = std::f64::consts::FRAC_1_SQRT_2;
/// Steps of the search for the fair shape, and the part of the first error that is left at its end.
const MOST_STEPS: usize = 2000;
const LEFT: f64 = 1e-10;

/// Refines the triangles from `first` on, which fill holes of the others, and makes them fair. New vertices are appended.
pub(in crate::mesh) fn refine(
    positions: &mut Vec<[f64; 3]>,
    triangles: &mut Vec<[u32; 3]>,
    source: &mut Vec<u32>,
    first: usize,
) {
    let given = positions.len();
    let around = Around::new(positions, triangles, first);
    let mut filling = Filling {
        lengths: around.lengths.clone(),
        positions,
        triangles: triangles.split_off(first),
        source: source.split_off(first),
        given,
        around: &around,
    };
    for _ in 0..MOST_ROUNDS {
        if !filling.split() {
            break;
        }
        for _ in 0..MOST_FLIPS {
            if !filling.flip() {
                break;
            }
        }
    }
    let Filling { triangles: mut refined, source: mut sources, .. } = filling;
    make_fair(positions, &refined, given, &around);
    triangles.append(&mut refined);
    source.append(&mut sources);
}

/// The surface beside the holes.
struct Around {
    /// By vertex of a rim, how long the edges of the surface there are.
    lengths: FxHashMap<u32, f64>,
    /// Its edges between vertices of rims, the lower end first.
    edges: FxHashSet<[u32; 2]>,
    /// By vertex of a rim, its neighbours in the surface, ascending.
    neighbours: FxHashMap<u32, Vec<u32>>,
}

impl Around {
    fn new(positions: &[[f64; 3]], triangles: &[[u32; 3]], first: usize) -> Self {
        let rim: FxHashSet<u32> = triangles[first..].iter().flatten().copied().collect();
        let (mut edges, mut neighbours) = (FxHashSet::default(), FxHashMap::<u32, Vec<u32>>::default());
        for corners in &triangles[..first] {
            for k in 0..3 {
                let (u, v) = (corners[k], corners[(k + 1) % 3]);
                for (at, other) in [(u, v), (v, u)] {
                    if rim.contains(&at) {
                        neighbours.entry(at).or_default().push(other);
                    }
                }
                if rim.contains(&u) && rim.contains(&v) {
                    edges.insert([u.min(v), u.max(v)]);
                }
            }
        }
        let mut lengths = FxHashMap::default();
        for (&at, others) in &mut neighbours {
            others.sort_unstable();
            others.dedup();
            let sum: f64 =
                others.iter().map(|&v| apart(&positions[at as usize], &positions[v as usize])).sum();
            lengths.insert(at, sum / others.len() as f64);
        }
        Self { lengths, edges, neighbours }
    }
}

/// A filling on its way.
struct Filling<'a> {
    positions: &'a mut Vec<[f64; 3]>,
    triangles: Vec<[u32; 3]>,
    source: Vec<u32>,
    /// By vertex, how long edges there should be.
    lengths: FxHashMap<u32, f64>,
    given: usize,
    around: &'a Around,
}

impl Filling<'_> {
    fn place(&self, v: u32) -> [f64; 3] {
        self.positions[v as usize]
    }

    /// Splits what is too large at its middle; whether anything was.
    fn split(&mut self) -> bool {
        let count = self.triangles.len();
        for index in 0..count {
            let corners = self.triangles[index];
            let places = corners.map(|v| self.place(v));
            let middle: [f64; 3] = std::array::from_fn(|k| places.iter().map(|p| p[k]).sum::<f64>() / 3.0);
            let lengths = corners.map(|v| self.lengths.get(&v).copied().unwrap_or(0.0));
            let length = lengths.iter().sum::<f64>() / 3.0;
            let is_far = (0..3).all(|k| {
                let away = apart(&middle, &places[k]);
                away > SPLIT_FROM * length && away > SPLIT_FROM * lengths[k]
            });
            if !is_far || length <= 0.0 || self.positions.len() >= self.given + MOST_VERTICES {
                continue;
            }
            let new = self.positions.len() as u32;
            self.positions.push(middle);
            self.lengths.insert(new, length);
            let [a, b, c] = corners;
            self.triangles[index] = [a, b, new];
            self.triangles.extend([[b, c, new], [c, a, new]]);
            self.source.extend([self.source[index]; 2]);
        }
        self.triangles.len() > count
    }

    /// Flips edges whose opposite angles are more than half a turn together; whether any was.
    fn flip(&mut self) -> bool {
        // 1. The edges between two triangles, in their order.
        let mut edges: Vec<([u32; 2], u32)> = Vec::with_capacity(3 * self.triangles.len());
        for (index, corners) in (0u32..).zip(&self.triangles) {
            edges.extend((0..3).map(|k| {
                let (u, v) = (corners[k], corners[(k + 1) % 3]);
                ([u.min(v), u.max(v)], index)
            }));
        }
        edges.sort_unstable();
        let mut known: FxHashSet<[u32; 2]> = edges.iter().map(|edge| edge.0).collect();
        // 2. Each that may be, of triangles that are still as they were.
        let mut changed = vec![false; self.triangles.len()];
        let mut any = false;
        for pair in edges.chunk_by(|x, y| x.0 == y.0) {
            let &[(edge, s), (_, t)] = pair else { continue };
            if changed[s as usize] || changed[t as usize] {
                continue;
            }
            let opposite = |of: u32| self.triangles[of as usize].into_iter().find(|v| !edge.contains(v));
            let (Some(p), Some(q)) = (opposite(s), opposite(t)) else { continue };
            let new = [p.min(q), p.max(q)];
            if p == q || known.contains(&new) || self.around.edges.contains(&new) {
                continue;
            }
            let angle = |at: u32| angle(self.place(at), edge.map(|v| self.place(v)));
            if angle(p) + angle(q) <= std::f64::consts::PI * (1.0 + 1e-9) {
                continue;
            }
            // The edge as the first triangle runs.
            let corners = self.triangles[s as usize];
            let k = corners.iter().position(|&v| v == p).unwrap_or_default();
            let (u, v) = (corners[(k + 1) % 3], corners[(k + 2) % 3]);
            self.triangles[s as usize] = [p, u, q];
            self.triangles[t as usize] = [q, v, p];
            changed[s as usize] = true;
            changed[t as usize] = true;
            known.insert(new);
            any = true;
        }
        any
    }
}

/// The angle at a point between the ways to two others.
fn angle(at: [f64; 3], to: [[f64; 3]; 2]) -> f64 {
    let [u, v]: [[f64; 3]; 2] = to.map(|to| std::array::from_fn(|k| to[k] - at[k]));
    let dot: f64 = (0..3).map(|k| u[k] * v[k]).sum();
    let across = crate::mesh::cross(u, v);
    across.iter().map(|x| x * x).sum::<f64>().sqrt().atan2(dot)
}

/// By vertex of a filling, its neighbours there and in the surface, ascending.
fn rows(filling: &[[u32; 3]], around: &Around) -> Vec<(u32, Vec<u32>)> {
    let mut neighbours: FxHashMap<u32, Vec<u32>> = FxHashMap::default();
    for corners in filling {
        for k in 0..3 {
            let (u, v) = (corners[k], corners[(k + 1) % 3]);
            neighbours.entry(u).or_default().push(v);
            neighbours.entry(v).or_default().push(u);
        }
    }
    let mut rows: Vec<(u32, Vec<u32>)> = neighbours.into_iter().collect();
    rows.sort_unstable_by_key(|row| row.0);
    for (at, others) in &mut rows {
        others.extend(around.neighbours.get(at).into_iter().flatten());
        others.sort_unstable();
        others.dedup();
    }
    rows
}

/// Places the vertices from `given` on where the sum of the squared bends at them and at the rim is least: a bend is how far a vertex is
/// from the mean of its neighbours. (Conjugate gradients on the normal equations.)
fn make_fair(positions: &mut [[f64; 3]], filling: &[[u32; 3]], given: usize, around: &Around) {
    if positions.len() == given {
        return;
    }
    // 1. One row for each vertex of the filling.
    let rows = rows(filling, around);
    let unknown = positions.len() - given;
    let place = |v: u32| (v as usize).checked_sub(given);
    // 2. Axis by axis.
    for axis in 0..3 {
        let mut values: Vec<f64> = positions[given..].iter().map(|p| p[axis]).collect();
        let bend = |values: &dyn Fn(u32) -> f64, bends: &mut Vec<f64>| {
            bends.clear();
            bends.extend(rows.iter().map(|(at, others)| {
                others.iter().map(|&v| values(v)).sum::<f64>() / others.len() as f64 - values(*at)
            }));
        };
        let gather = |bends: &[f64], sums: &mut Vec<f64>| {
            sums.clear();
            sums.resize(unknown, 0.0);
            for ((at, others), bend) in rows.iter().zip(bends) {
                if let Some(i) = place(*at) {
                    sums[i] -= bend;
                }
                for i in others.iter().filter_map(|&v| place(v)) {
                    sums[i] += bend / others.len() as f64;
                }
            }
        };
        let (mut residual, mut slope, mut moved) = (Vec::new(), Vec::new(), Vec::new());
        bend(&|v| positions[v as usize][axis], &mut residual);
        residual.iter_mut().for_each(|x| *x = -*x);
        gather(&residual, &mut slope);
        let mut direction = slope.clone();
        let square = |x: &[f64]| x.iter().map(|x| x * x).sum::<f64>();
        let mut now = square(&slope);
        let goal = LEFT * LEFT * now;
        for _ in 0..MOST_STEPS {
            if now <= goal || now == 0.0 {
                break;
            }
            bend(&|v| place(v).map_or(0.0, |i| direction[i]), &mut moved);
            let size = square(&moved);
            if !(size > 0.0 && size.is_finite()) {
                break;
            }
            let step = now / size;
            values.iter_mut().zip(&direction).for_each(|(value, x)| *value += step * x);
            residual.iter_mut().zip(&moved).for_each(|(r, m)| *r -= step * m);
            gather(&residual, &mut slope);
            let next = square(&slope);
            direction.iter_mut().zip(&slope).for_each(|(d, s)| *d = s + next / now * *d);
            now = next;
        }
        if values.iter().all(|x| x.is_finite()) {
            positions[given..].iter_mut().zip(&values).for_each(|(p, x)| p[axis] = *x);
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::mesh::{Gate, Mesh};
    use crate::primitives;

    #[test]
    fn a_refined_filling_goes_on_like_the_surface() {
        let ball = primitives::geodesic_sphere(1.0, 16).unwrap();
        let low = |corners: &[u32; 3]| corners.iter().all(|&v| ball.positions[v as usize][2] < 0.7);
        let open = Mesh::new(ball.positions.clone(), ball.triangles.iter().copied().filter(low).collect());
        let whole = Mesh::volume(&ball);
        let flat = Gate::new().fill_holes(usize::MAX).solid(open.clone()).unwrap();
        let fair = Gate::new().fill_holes(usize::MAX).refine_holes(true).solid(open).unwrap();
        assert!(fair.is_manifold() && fair.genus() == Some(0));
        assert!(fair.mending().filled_vertices > 20, "{}", fair.mending().filled_vertices);
        let (off, before) = ((fair.volume() - whole).abs(), (flat.volume() - whole).abs());
        // (A plate that bends least is flatter than a ball in the middle of so large a hole.)
        assert!(off < 0.3 * before, "{off} {before}");
        assert!(fair.self_crossings(&crate::Control::new()).unwrap().is_simple());
    }
}
