//! Vertices that are near an earlier one take its place.

use glam::DVec3;
use rustc_hash::FxHashMap;

use super::surfaces::Surfaces;

/// Joins each vertex to the nearest earlier one within the distance that was not itself joined to another, and leaves out the
/// triangles that thereby lose a corner, which are counted. So no vertex moves further than the distance, and of equal ones the first operand's stay.
pub(super) fn weld(surfaces: &mut Surfaces, distance: f64) -> u64 {
    let mut places = Places::new(distance);
    let positions = &surfaces.positions;
    let joined: Vec<u32> = (0..positions.len() as u32).map(|v| places.join(positions, v)).collect();
    let before = surfaces.triangles.len();
    surfaces.triangles.retain_mut(|triangle| {
        triangle.corners = triangle.corners.map(|v| joined[v as usize]);
        let [a, b, c] = triangle.corners;
        a != b && b != c && c != a
    });
    // Joined vertices are no corners any more; they are where they went.
    for (v, &to) in joined.iter().enumerate() {
        surfaces.positions[v] = surfaces.positions[to as usize];
    }
    (before - surfaces.triangles.len()) as u64
}

/// The distance of two points.
pub(super) fn apart(p: &[f64; 3], q: &[f64; 3]) -> f64 {
    let [x, y, z] = (DVec3::from_array(*p) - DVec3::from_array(*q)).to_array();
    x.hypot(y).hypot(z)
}

/// Vertices that have been met, by cells as long as the distance.
pub(super) struct Places {
    distance: f64,
    cells: FxHashMap<[i64; 3], Vec<u32>>,
}

impl Places {
    pub(super) fn new(distance: f64) -> Self {
        Self { distance, cells: FxHashMap::default() }
    }

    /// The nearest earlier vertex within the distance, the first of equally near ones; or the vertex itself, which is then met.
    pub(super) fn join(&mut self, positions: &[[f64; 3]], v: u32) -> u32 {
        let position = &positions[v as usize];
        let cell = position.map(|x| (x / self.distance).floor() as i64);
        let mut nearest = (f64::INFINITY, v);
        for near in 0..27 {
            let step = [near % 3 - 1, near / 3 % 3 - 1, near / 9 - 1];
            let cell: [i64; 3] = std::array::from_fn(|k| cell[k].saturating_add(step[k]));
            for &other in self.cells.get(&cell).into_iter().flatten() {
                let apart = apart(position, &positions[other as usize]);
                if apart <= self.distance && (apart, other) < nearest {
                    nearest = (apart, other);
                }
            }
        }
        let (_, to) = nearest;
        if to == v {
            self.cells.entry(cell).or_default().push(v);
        }
        to
    }
}
