//! The integer lattice of the finest cells: keys of its points, edges and faces, and their places in space.

use glam::DVec3;

/// Deepest subdivision: lattice coordinates fit twenty bits.
pub(super) const DEEPEST: u32 = 19;

/// A cube of the octree: its lowest corner and its side, in units of the finest cells.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) struct Cube {
    pub(super) corner: [u32; 3],
    pub(super) size: u32,
}

/// Where the lattice is in space.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lattice {
    origin: DVec3,
    step: f64,
    /// Finest cells along a side.
    pub(super) count: u32,
}

/// A lattice point as one number.
pub(super) type Key = u64;

pub(super) fn key([x, y, z]: [u32; 3]) -> Key {
    u64::from(x) << 40 | u64::from(y) << 20 | u64::from(z)
}

pub(super) fn unkey(key: Key) -> [u32; 3] {
    [40, 20, 0].map(|shift| (key >> shift) as u32 & 0xf_ffff)
}

/// A point and one of three directions, as one number: names an edge or a face that cannot be divided further.
pub(super) fn directed(key: Key, axis: usize) -> u64 {
    key << 2 | axis as u64
}

pub(super) fn undirected(key: u64) -> (Key, usize) {
    (key >> 2, (key & 3) as usize)
}

pub(super) fn moved(mut point: [u32; 3], axis: usize, by: u32) -> [u32; 3] {
    point[axis] += by;
    point
}

impl Lattice {
    /// A cube of `2^depth` cells a side around the box `low..high`. Off-centre by odd fractions, so that planes at
    /// round coordinates do not coincide with planes of the lattice.
    pub(super) fn around(low: DVec3, high: DVec3, depth: u32) -> Self {
        let extent = (high - low).max_element();
        let side = extent * 1.127;
        let margin = (DVec3::splat(side) - (high - low)) * 0.5;
        let origin = low - margin + DVec3::new(0.013_71, 0.017_93, 0.011_37) * extent;
        let count = 1 << depth.min(DEEPEST);
        Self { origin, step: side / f64::from(count), count }
    }

    /// The lattice with its lowest layer at z = `height`.
    pub(super) fn flattened(mut self, height: f64) -> Self {
        self.origin.z = height;
        self
    }

    /// Side of a finest cell.
    pub(super) fn step(&self) -> f64 {
        self.step
    }

    /// Where the lattice point is.
    pub(super) fn place(&self, point: [u32; 3]) -> DVec3 {
        DVec3::new(
            self.origin.x + f64::from(point[0]) * self.step,
            self.origin.y + f64::from(point[1]) * self.step,
            self.origin.z + f64::from(point[2]) * self.step,
        )
    }

    /// The finest cell that holds a place; nothing outside the lattice.
    pub(super) fn unit_at(&self, place: DVec3) -> Option<[u32; 3]> {
        let at = (place - self.origin) / self.step;
        let within = at.cmpge(DVec3::ZERO).all() && at.cmplt(DVec3::splat(f64::from(self.count))).all();
        within.then(|| at.to_array().map(|x| x as u32))
    }

    /// The lowest and the highest corner of a cube.
    pub(super) fn corners(&self, cube: Cube) -> (DVec3, DVec3) {
        (self.place(cube.corner), self.place(cube.corner.map(|x| x + cube.size)))
    }

    /// Whether the point is on the outside of the whole lattice.
    pub(super) fn on_boundary(&self, point: [u32; 3]) -> bool {
        point.iter().any(|&x| x == 0 || x == self.count)
    }
}

impl Cube {
    /// The eight halves.
    pub(super) fn children(self) -> [Self; 8] {
        let half = self.size / 2;
        std::array::from_fn(|k| Self { corner: offset(self.corner, k, half), size: half })
    }

    /// The eight corners; bit `a` of the number says which side along axis `a`.
    pub(super) fn points(self) -> [[u32; 3]; 8] {
        std::array::from_fn(|k| offset(self.corner, k, self.size))
    }
}

fn offset(corner: [u32; 3], number: usize, by: u32) -> [u32; 3] {
    std::array::from_fn(|axis| corner[axis] + if number >> axis & 1 == 1 { by } else { 0 })
}
