//! Which closed patches lie inside others.
//!
//! From a few vertices of each patch a ray goes up (+z), and the crossings with every other patch are counted, by
//! exact predicates: the start is moved by infinitesimals (e, e^2) in x and y, so that no ray meets an edge. The
//! triangles look up the vertices above which they may lie in a grid over x and y, hence near-linear time.

use rustc_hash::FxHashMap;

use super::Bounds;
use super::patches::Patches;
use super::{scale, shells};
use crate::exact::{Sign, orient2d, orient3d};

/// Vertices farthest along the axes and the diagonals of space: the first to stick out where a patch is not wholly
/// inside.
const EXTREMES: usize = 14;
/// At most this many rays a patch: from its extremes, and last from the middle of its largest triangle, for patches all
/// of whose extremes lie on the surface of another (an octahedron in a cube).
const RAYS: usize = EXTREMES + 1;

/// The start of a ray.
struct Start {
    patch: u32,
    /// Which of its patch's rays this is.
    slot: usize,
    place: [f64; 3],
}

/// Whether the ray has crossed a patch an odd number of times; whether it starts on it.
#[derive(Clone, Copy, Default)]
struct Crossings {
    odd: bool,
    touching: bool,
}

/// Where a closed patch lies with respect to the others.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Nesting {
    /// Inside an odd number of other closed patches, so that its triangles should face inwards.
    pub(super) inside: bool,
    /// It crosses another, or touches it wherever it was looked at: then it does not count as inside that one.
    pub(super) unclear: bool,
}

/// The nesting of each patch. Neither inside nor unclear for patches that are not closed.
/// Copies of a patch are as nested as the first of them, and do not count otherwise.
pub(super) fn nesting(positions: &[[f64; 3]], triangles: &[[u32; 3]], patches: &Patches) -> Vec<Nesting> {
    let count = patches.closed.len();
    let Some(looked) = look(positions, triangles, patches) else { return vec![Nesting::default(); count] };
    let nesting = decide(count, &looked.rays, &looked.met);
    looked.originals.iter().map(|&original| nesting[original as usize]).collect()
}

/// For each patch the patches that it lies inside of, ascending. Those that it crosses, or touches wherever it was looked at, are
/// not among them.
pub(super) fn containers(positions: &[[f64; 3]], triangles: &[[u32; 3]], patches: &Patches) -> Vec<Vec<u32>> {
    let mut containers = vec![Vec::new(); patches.closed.len()];
    let Some(looked) = look(positions, triangles, patches) else { return containers };
    for (&(inner, outer), crossings) in &looked.met {
        if is_inside(crossings, looked.rays[inner as usize]).0 {
            containers[inner as usize].push(outer);
        }
    }
    containers.iter_mut().for_each(|of_patch| of_patch.sort_unstable());
    looked.originals.iter().map(|&original| containers[original as usize].clone()).collect()
}

/// What the rays of all patches met.
struct Looked {
    /// The first copy of each patch.
    originals: Vec<u32>,
    /// How many rays each patch has.
    rays: Vec<usize>,
    /// By inner and outer patch.
    met: FxHashMap<(u32, u32), [Crossings; RAYS]>,
}

/// `None` where there are not two closed patches.
fn look(positions: &[[f64; 3]], triangles: &[[u32; 3]], patches: &Patches) -> Option<Looked> {
    let count = patches.closed.len();
    let originals = shells::originals(positions, triangles, patches, false);
    let counts: Vec<bool> = (0..)
        .zip(&originals)
        .map(|(patch, &original)| patches.closed[patch] && original as usize == patch)
        .collect();
    if counts.iter().filter(|&&counts| counts).count() < 2 {
        return None;
    }
    let corners = |patch: usize| {
        let members = patches.triangles.get(patch).iter();
        members.flat_map(|&triangle| triangles[triangle as usize]).map(|corner| positions[corner as usize])
    };
    let mut boxes = vec![Bounds::NOTHING; count];
    let mut starts = Vec::new();
    let mut rays = vec![0; count];
    for patch in (0..count).filter(|&patch| counts[patch]) {
        corners(patch).for_each(|corner| boxes[patch].include(&corner));
        let mut places = extremes(corners(patch));
        let members = patches.triangles.get(patch).iter();
        let shapes = members.map(|&triangle| triangles[triangle as usize].map(|v| positions[v as usize]));
        places.extend(middle_of_largest(shapes, scale::factor(boxes[patch].largest())));
        rays[patch] = places.len();
        let start = |(slot, &place): (usize, &[f64; 3])| Start { patch: patch as u32, slot, place };
        starts.extend(places.iter().enumerate().map(start));
    }
    let grid = Grid::new(&starts);
    let mut met: FxHashMap<(u32, u32), [Crossings; RAYS]> = FxHashMap::default();
    for (triangle, &patch) in triangles.iter().zip(&patches.of_triangle) {
        if !counts[patch as usize] {
            continue;
        }
        let corners = triangle.map(|corner| positions[corner as usize]);
        let mut extent = Bounds::NOTHING;
        corners.iter().for_each(|corner| extent.include(corner));
        grid.visit(&extent, |start| {
            let start = &starts[start as usize];
            let [x, y, z] = start.place;
            let below = extent.low[0] <= x
                && x <= extent.high[0]
                && extent.low[1] <= y
                && y <= extent.high[1]
                && z <= extent.high[2];
            if start.patch == patch || !below || !boxes[patch as usize].contains(&boxes[start.patch as usize])
            {
                return;
            }
            let crossings = &mut met.entry((start.patch, patch)).or_default()[start.slot];
            crossings.odd ^= crosses(&corners, start.place);
            crossings.touching |= extent.low[2] <= z && side_of_plane(&corners, start.place) == Sign::Zero;
        });
    }
    Some(Looked { originals, rays, met })
}

/// Whether rays tell that a patch is inside another, and whether that is unclear.
fn is_inside(crossings: &[Crossings; RAYS], rays: usize) -> (bool, bool) {
    let (middle, extremes) = crossings[..rays].split_last().unwrap_or((&crossings[0], &[]));
    let mut telling: Vec<bool> = extremes.iter().filter(|ray| !ray.touching).map(|ray| ray.odd).collect();
    if telling.is_empty() && !middle.touching {
        telling.push(middle.odd);
    }
    let inside = !telling.is_empty() && telling.iter().all(|&odd| odd);
    (inside, !inside && (telling.is_empty() || telling.contains(&true)))
}

/// What the crossings of the rays of each patch with each other patch say.
fn decide(count: usize, rays: &[usize], met: &FxHashMap<(u32, u32), [Crossings; RAYS]>) -> Vec<Nesting> {
    let mut nesting = vec![Nesting::default(); count];
    for (&(inner, _), crossings) in met {
        let (inside, unclear) = is_inside(crossings, rays[inner as usize]);
        let nesting = &mut nesting[inner as usize];
        nesting.inside ^= inside;
        nesting.unclear |= unclear;
    }
    nesting
}

/// The first of the places that are farthest in each direction, without repetition.
fn extremes(mut places: impl Iterator<Item = [f64; 3]>) -> Vec<[f64; 3]> {
    let Some(first) = places.next() else { return Vec::new() };
    let directions = (0..27).map(|index| [index % 3 - 1, index / 3 % 3 - 1, index / 9 - 1]);
    let to_faces_and_corners =
        directions.filter(|direction| matches!(direction.map(i32::abs).iter().sum(), 1 | 3));
    let directions: Vec<[f64; 3]> = to_faces_and_corners.map(|direction| direction.map(f64::from)).collect();
    let mut farthest = vec![(f64::NEG_INFINITY, first); EXTREMES];
    for place in std::iter::once(first).chain(places) {
        for (direction, farthest) in directions.iter().zip(&mut farthest) {
            let reach = direction[0] * place[0] + direction[1] * place[1] + direction[2] * place[2];
            if reach > farthest.0 {
                *farthest = (reach, place);
            }
        }
    }
    let mut distinct: Vec<[f64; 3]> = Vec::new();
    for (_, place) in farthest {
        if !distinct.contains(&place) {
            distinct.push(place);
        }
    }
    distinct
}

/// The middle of the triangle with the largest area, the first of equal ones. Areas are compared after multiplying all
/// coordinates by `factor`, so that they neither under- nor overflow.
fn middle_of_largest(triangles: impl Iterator<Item = [[f64; 3]; 3]>, factor: f64) -> Option<[f64; 3]> {
    let extent = |[a, b, c]: &[[f64; 3]; 3]| {
        let cross = |i: usize, j: usize| (b[i] - a[i]) * (c[j] - a[j]) - (b[j] - a[j]) * (c[i] - a[i]);
        cross(0, 1).powi(2) + cross(1, 2).powi(2) + cross(2, 0).powi(2)
    };
    let largest = triangles
        .map(|corners| corners.map(|corner| corner.map(|x| x * factor)))
        .map(|corners| (extent(&corners), corners))
        .reduce(|largest, next| if next.0 > largest.0 { next } else { largest })?;
    let [a, b, c] = largest.1;
    Some([0, 1, 2].map(|k| (a[k] + b[k] + c[k]) / 3.0 / factor))
}

/// Where the plane of the triangle lies from `place`, seen along the triangle's own orientation: positive if `place` is
/// on the side from which the corners run clockwise.
fn side_of_plane([a, b, c]: &[[f64; 3]; 3], place: [f64; 3]) -> Sign {
    orient3d(a, b, c, &place)
}

/// Whether the ray up from `place`, moved by infinitesimals in x and y, crosses the triangle.
fn crosses(corners: &[[f64; 3]; 3], place: [f64; 3]) -> bool {
    let flat = |[x, y, _]: [f64; 3]| [x, y];
    let order = |a: f64, b: f64| (a > b) as i8 - (a < b) as i8;
    let side = |from: [f64; 3], to: [f64; 3]| match orient2d(flat(from), flat(to), flat(place)) {
        Sign::Zero if from[1] != to[1] => order(from[1], to[1]),
        Sign::Zero => order(to[0], from[0]),
        sign => sign as i8,
    };
    let [a, b, c] = *corners;
    let turn = side(a, b);
    let over = turn != 0 && turn == side(b, c) && turn == side(c, a);
    over && side_of_plane(corners, place) as i8 == turn
}

/// Starts of rays by their place in x and y.
struct Grid {
    low: [f64; 2],
    /// Cells per unit of length.
    density: [f64; 2],
    /// Cells along each axis.
    cells: usize,
    starts: super::buckets::Buckets<u32>,
}

impl Grid {
    fn new(starts: &[Start]) -> Self {
        let extent = Bounds::of(starts.iter().map(|start| &start.place)).unwrap_or(Bounds::NOTHING);
        let cells = (starts.len() as f64).sqrt().ceil() as usize;
        let density = [0, 1].map(|axis| {
            let density = cells as f64 / (extent.high[axis] - extent.low[axis]);
            if density.is_finite() { density } else { 0.0 }
        });
        let mut grid = Self {
            low: [extent.low[0], extent.low[1]],
            density,
            cells,
            starts: super::buckets::Buckets::new(0, std::iter::empty()),
        };
        let filed = starts.iter().zip(0..).map(|(start, index)| {
            let [column, row] = [0, 1].map(|axis| grid.cell(start.place[axis], axis));
            ((row * cells + column) as u32, index)
        });
        let filed: Vec<_> = filed.collect();
        grid.starts = super::buckets::Buckets::new(cells * cells, filed.into_iter());
        grid
    }

    /// Never falls as `x` rises, so a place between two others is in a cell between theirs.
    fn cell(&self, x: f64, axis: usize) -> usize {
        let cell = ((x - self.low[axis]) * self.density[axis]) as usize;
        cell.min(self.cells - 1)
    }

    fn visit(&self, extent: &Bounds, mut visit: impl FnMut(u32)) {
        let range = |axis: usize| self.cell(extent.low[axis], axis)..=self.cell(extent.high[axis], axis);
        for row in range(1) {
            for column in range(0) {
                self.starts.get(row * self.cells + column).iter().for_each(|&start| visit(start));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::edges::EdgeTable;
    use super::super::{Mesh, patches::Patches};
    use super::*;
    use crate::primitives;

    fn nested(shells: &[Mesh]) -> Vec<bool> {
        let mesh = Mesh::merged(shells).unwrap();
        let table = EdgeTable::new(&mesh.triangles, mesh.positions.len());
        let patches = Patches::new(&table, mesh.triangles.len());
        nesting(&mesh.positions, &mesh.triangles, &patches).iter().map(|nesting| nesting.inside).collect()
    }

    fn cube(center: [f64; 3], half: f64) -> Mesh {
        primitives::cuboid(center.map(|x| x - half), center.map(|x| x + half)).unwrap()
    }

    #[test]
    fn shells_in_shells_alternate() {
        let shells = [1.0, 2.0, 4.0, 3.0].map(|half| cube([0.0; 3], half));
        assert_eq!(nested(&shells[..1]), [false]);
        assert_eq!(nested(&shells), [true, false, false, true]);
    }

    #[test]
    fn touching_from_inside_is_inside() {
        // The inner cube touches the outer one from inside with a face, in an edge's two faces, or in a corner.
        for place in 1..27 {
            let offset = [place % 3, place / 3 % 3, place / 9].map(|x| f64::from(x) - 1.0);
            assert_eq!(nested(&[cube([0.0; 3], 2.0), cube(offset, 1.0)]), [false, true], "{offset:?}");
        }
    }

    #[test]
    fn inscribed_bodies_are_inside() {
        let inner = primitives::octahedron(1.0).unwrap();
        assert_eq!(nested(&[cube([0.0; 3], 1.0), inner.clone()]), [false, true]);
        assert_eq!(nested(&[inner.clone(), cube([0.0; 3], 1.0)]), [true, false]);
    }

    #[test]
    fn rays_may_meet_edges_and_corners() {
        // The corners of the inner body lie below corners, edges and diagonals of the outer one.
        let inner = primitives::octahedron(1.0).unwrap();
        let (cube, octahedron) = (cube([0.0; 3], 3.0), primitives::octahedron(3.0).unwrap());
        for outer in [cube.clone(), octahedron.clone(), primitives::cylinder(3.0, 6.0, 4).unwrap()] {
            for turn in 0..4 {
                let turned = outer.clone().rotated([0.0, 0.0, 1.0], 90.0 * f64::from(turn)).unwrap();
                let lowered = turned.translated([0.0, 0.0, -outer.bounds().unwrap().center()[2]]);
                assert_eq!(nested(&[lowered, inner.clone()]), [false, true]);
            }
        }
    }

    #[test]
    fn side_by_side_or_crossing_is_not_inside() {
        let unit = cube([0.0; 3], 1.0);
        assert_eq!(nested(&[unit.clone(), cube([2.0, 0.0, 0.0], 1.0)]), [false, false]);
        assert_eq!(nested(&[cube([0.0; 3], 2.0), cube([1.5; 3], 1.0)]), [false, false]);
        assert_eq!(nested(&[unit.clone(), unit]), [false, false]);
        // A body in the hole of a ring is within its box, but not inside.
        let ring = primitives::torus(3.0, 1.0, 16, 16).unwrap();
        assert_eq!(nested(&[ring, cube([0.0; 3], 0.5)]), [false, false]);
    }

    #[test]
    fn any_magnitude_will_do() {
        let scaled = |mesh: Mesh, factor: f64| {
            let positions = mesh.positions.iter().map(|p| p.map(|x| x * factor)).collect();
            Mesh::new(positions, mesh.triangles)
        };
        let octahedron = primitives::octahedron(1.0).unwrap();
        for factor in [1e-300, 1e-160, 1e160, 1e300, 1.7e308] {
            let shells = [
                cube([0.0; 3], 1.0),
                octahedron.clone(),
                cube([0.0; 3], 0.25),
                cube([0.25, 0.5, 0.75], 0.125),
            ]
            .map(|shell| scaled(shell, factor));
            // The last is outside the octahedron.
            assert_eq!(nested(&shells), [false, true, false, true], "{factor}");
        }
        // A body of 1e-300 in one of 1e300, off its corner and in its middle.
        let tiny = |at: [f64; 3]| {
            let mut body = scaled(octahedron.clone(), 1e-300);
            body.positions.iter_mut().for_each(|p| *p = [0, 1, 2].map(|k| p[k] + at[k]));
            body
        };
        let huge = scaled(octahedron.clone(), 1e300);
        assert_eq!(nested(&[tiny([0.0; 3]), huge.clone()]), [true, false]);
        let slab = scaled(octahedron.clone().translated([1.0, 0.0, 0.0]), 1e300);
        assert_eq!(nested(&[tiny([3e-300, 0.0, 0.0]), slab.clone()]), [true, false]);
        assert_eq!(nested(&[tiny([-3e-300, 0.0, 0.0]), slab]), [false, false]);
    }

    #[test]
    fn many_shells_in_a_box() {
        let mut shells = vec![cube([0.0; 3], 20.0)];
        let places = (0..1000).map(|i| [i % 10, i / 10 % 10, i / 100].map(|x| f64::from(x) * 2.0 - 9.0));
        shells.extend(places.map(|place| cube(place, 0.5)));
        let nested = nested(&shells);
        assert!(!nested[0] && nested[1..].iter().all(|&inside| inside));
    }
}
