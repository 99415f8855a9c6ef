//! Faces of cells as polygons, and the lines in which the surface cuts them.
//!
//! A cell's boundary is tiled by the smallest faces of the cells on either side; a face's outline is divided at
//! every corner of another cell. Both cells of a face, and all cells around an edge, therefore see the same points.

use rustc_hash::FxHashSet;
use smallvec::SmallVec;

use super::lattice::{Cube, Key, key, moved, unkey};

/// A face that no neighbour divides: its lowest corner, the axis it is flat along, its side.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Face {
    pub(super) corner: [u32; 3],
    pub(super) axis: usize,
    pub(super) size: u32,
}

/// All corners of cells.
pub(super) struct Corners(FxHashSet<Key>);

impl Corners {
    pub(super) fn of(cubes: impl Iterator<Item = Cube>) -> Self {
        Self::of_points(cubes.flat_map(Cube::points))
    }

    pub(super) fn of_points(points: impl Iterator<Item = [u32; 3]>) -> Self {
        Self(points.map(key).collect())
    }

    /// Adds the corners of cubes, and returns those that were not known.
    pub(super) fn extend(&mut self, cubes: impl Iterator<Item = Cube>) -> Vec<Key> {
        cubes.flat_map(Cube::points).map(key).filter(|&point| self.0.insert(point)).collect()
    }

    fn contains(&self, point: [u32; 3]) -> bool {
        self.0.contains(&key(point))
    }

    /// The undivided faces of a cube, each with whether the cube lies below it along its axis.
    pub(super) fn faces(&self, cube: Cube) -> SmallVec<[(Face, bool); 8]> {
        let mut faces = SmallVec::new();
        for axis in 0..3 {
            for upper in [false, true] {
                let corner = moved(cube.corner, axis, if upper { cube.size } else { 0 });
                self.divide(Face { corner, axis, size: cube.size }, &mut |face| faces.push((face, upper)));
            }
        }
        faces
    }

    fn divide(&self, face: Face, push: &mut impl FnMut(Face)) {
        let (u, v) = face.directions();
        let half = face.size / 2;
        // At most as deep as the octree.
        if face.size > 1 && self.contains(moved(moved(face.corner, u, half), v, half)) {
            for (du, dv) in [(0, 0), (half, 0), (0, half), (half, half)] {
                let corner = moved(moved(face.corner, u, du), v, dv);
                self.divide(Face { corner, size: half, ..face }, push);
            }
        } else {
            push(face);
        }
    }

    /// The points of a face's outline, counter-clockwise about its axis.
    pub(super) fn outline(&self, face: Face) -> Outline {
        let (u, v) = face.directions();
        let far_u = moved(face.corner, u, face.size);
        let far_v = moved(face.corner, v, face.size);
        let far = moved(far_u, v, face.size);
        let mut points = Outline::new();
        points.push(key(face.corner));
        self.points_within(face.corner, u, face.size, false, &mut points);
        points.push(key(far_u));
        self.points_within(far_u, v, face.size, false, &mut points);
        points.push(key(far));
        self.points_within(far_v, u, face.size, true, &mut points);
        points.push(key(far_v));
        self.points_within(face.corner, v, face.size, true, &mut points);
        points
    }

    /// Corners of cells between the ends of an edge, in order or the other way round.
    fn points_within(&self, start: [u32; 3], axis: usize, length: u32, reverse: bool, points: &mut Outline) {
        let half = length / 2;
        let middle = moved(start, axis, half);
        if length > 1 && self.contains(middle) {
            let (first, second) = if reverse { (middle, start) } else { (start, middle) };
            self.points_within(first, axis, half, reverse, points);
            points.push(key(middle));
            self.points_within(second, axis, half, reverse, points);
        }
    }
}

/// Points around a face.
pub(super) type Outline = SmallVec<[Key; 8]>;

impl Face {
    /// The two axes of the face, such that they and the face's own axis are right-handed.
    pub(super) fn directions(self) -> (usize, usize) {
        ((self.axis + 1) % 3, (self.axis + 2) % 3)
    }

    pub(super) fn centre_doubled(self) -> [u32; 3] {
        let (u, v) = self.directions();
        let doubled = self.corner.map(|x| 2 * x);
        moved(moved(doubled, u, self.size), v, self.size)
    }
}

/// The lattice edge between two neighbouring points of an outline: its lower point and its axis.
pub(super) fn edge_between(a: Key, b: Key) -> (Key, usize) {
    let (low, high) = (a.min(b), a.max(b));
    let (p, q) = (unkey(low), unkey(high));
    (low, (0..3).find(|&axis| p[axis] != q[axis]).unwrap_or(0))
}
