//! Films and gaps of a surface that moving its vertices a little closes: pairs of triangles back to back, or face to face,
//! that a plane separates before and none does after.
//!
//! Only triangles with nearly opposite normals can lie so, and on most surfaces neighbours have similar ones. A coarse grid with the
//! normals in each cell, and then a hierarchy with a box of normals beside each box of points, pass over every part without opposite
//! normals, which leaves next to nothing of a surface without thin walls (Volino, Magnenat-Thalmann 1994, cull self-collisions by
//! cones alike).

use glam::DVec3;

use super::morton::coherent_order;
use super::opposed::{Cells, Normals};
use crate::exact::{Sign, orient3d};
use crate::mesh::{BitSet, Bounds};
use crate::parallel::read_ahead;
use crate::{Control, Limit};

/// Triangles in a leaf: few, since all pairs in a leaf are looked at; more than one, so that the tree is small.
const LEAF: usize = 4;
/// The cosine beyond which normals count as opposite: 8 degrees. A film is thinner than rounding and wider than several
/// times that, so its sides differ by less.
const OPPOSITE: f64 = -0.99;
/// How far components of opposite normals may be apart: 2 sin(4 degrees), and the rounding to single precision.
const NORMAL_SLACK: f32 = 0.15;
/// Triangles whose least altitude is below this many steps are rounding's own: they may turn anyhow.
const LEAST_ALTITUDE: f64 = 4.0;
/// Pairs of nodes and of triangles looked at for each triangle before the search ends. Usual surfaces have about one; where
/// so many triangles lie within a rounding of each other, the surface is lost as a whole, and its volume tells.
const MOST_PAIRS: usize = 64;
/// Triangles whose corners are read ahead, as where volumes are summed up.
const RUN: u32 = 16;
/// Cells that triangles pass on average, at most: bounds the time of marking them where triangles are large.
const MOST_PASSED: usize = 8;
/// In place of the number of a cell: several.
const SEVERAL: u32 = u32::MAX - 1;
/// In place of the number of a cell: the triangle is no candidate.
const NOWHERE: u32 = u32::MAX;

/// A pair of triangles that lost what was between them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Film {
    /// The middle of one of them, before.
    pub(crate) place: [f64; 3],
    /// How far apart they were.
    pub(crate) thickness: f64,
}

/// What is no longer between triangles.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct LostFilms {
    /// Pairs with material between them, back to back.
    pub(crate) films: usize,
    /// Pairs with nothing between them, face to face.
    pub(crate) gaps: usize,
    /// The first of each in the order of the search.
    pub(crate) first_film: Option<Film>,
    pub(crate) first_gap: Option<Film>,
}

/// Looks for films and gaps between `triangles` that were there with the vertices at `before` and are not at `after`, where those in
/// `moved` are elsewhere, no coordinate being moved by more than half a `step`. O(n log n).
///
/// # Errors
/// The limits of `control`.
pub(crate) fn lost_films(
    before: &[[f64; 3]],
    after: &[[f64; 3]],
    moved: &BitSet,
    triangles: &[[u32; 3]],
    step: f64,
    control: &Control,
) -> Result<LostFilms, Limit> {
    let surface = Surface { before, after, moved, triangles, step };
    search(&surface, MOST_PASSED * triangles.len(), control)
}

/// The same, with marks for no more than so many cells that triangles pass.
fn search(surface: &Surface<'_>, most_passed: usize, control: &Control) -> Result<LostFilms, Limit> {
    let Surface { before, after, triangles, step, .. } = *surface;
    let candidates = surface.candidates(most_passed);
    if candidates.is_empty() {
        return Ok(LostFilms::default());
    }
    let tree = Tree::new(&candidates);
    let mut search =
        Search { before, after, triangles, step, candidates: &candidates, found: LostFilms::default() };
    let most = MOST_PAIRS.saturating_mul(triangles.len());
    tree.visit_pairs(2.0 * step, most, control, |i, j| search.examine(i, j))?;
    Ok(search.found)
}

/// A triangle that may be one side of a film.
struct Candidate {
    triangle: u32,
    moved: bool,
    normal: DVec3,
    low: DVec3,
    high: DVec3,
}

impl Candidate {
    fn normals(&self) -> Normals {
        Normals::of(self.normal.as_vec3().to_array(), self.moved)
    }
}

/// A surface before and after its vertices were moved.
struct Surface<'a> {
    before: &'a [[f64; 3]],
    after: &'a [[f64; 3]],
    moved: &'a BitSet,
    triangles: &'a [[u32; 3]],
    step: f64,
}

impl Surface<'_> {
    fn has_moved(&self, triangle: &[u32; 3]) -> bool {
        triangle.iter().any(|&v| self.moved.contains(v))
    }

    fn corners(&self, triangle: &[u32; 3]) -> [DVec3; 3] {
        triangle.map(|v| DVec3::from_array(self.before[v as usize]))
    }

    /// A triangle, if it is wide enough to be a side of a film.
    #[inline]
    fn candidate(&self, index: u32) -> Option<Candidate> {
        let triangle = &self.triangles[index as usize];
        let [a, b, c] = self.corners(triangle);
        let normal = (b - a).cross(c - a);
        // (All in squares: coordinates that single precision has room for have squares of squares that are numbers.)
        let longest = (b - a).length_squared().max((c - b).length_squared()).max((a - c).length_squared());
        let (least, area) = (LEAST_ALTITUDE * self.step, normal.length_squared());
        let is_wide = area > least * least * longest && area.is_finite();
        is_wide.then(|| Candidate {
            triangle: index,
            moved: self.has_moved(triangle),
            normal: normal / area.sqrt(),
            low: a.min(b).min(c),
            high: a.max(b).max(c),
        })
    }

    /// For each vertex which sides of a box it lies beyond, if most lie beyond some.
    fn sides_of_most(&self, low: DVec3, high: DVec3) -> Option<Vec<u8>> {
        let mut sides = vec![0; self.before.len()];
        Bounds { low: low.to_array(), high: high.to_array() }.mark_sides_beyond(self.before, &mut sides);
        (2 * sides.iter().filter(|&&sides| sides != 0).count() > sides.len()).then_some(sides)
    }

    /// The candidates, in an order along a curve through space; those far from every moved vertex, and from all that look the other way,
    /// left out.
    fn candidates(&self, most_passed: usize) -> Vec<Candidate> {
        // 1. The box of all triangles that have moved. (Their corners are marked, and then read in order.)
        let mut ends = BitSet::new(self.before.len());
        let triangles = self.triangles.iter().filter(|triangle| self.has_moved(triangle));
        triangles.flatten().for_each(|&v| ends.insert(v));
        let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for place in ends.iter().map(|v| DVec3::from_array(self.before[v as usize])) {
            (low, high) = (low.min(place), high.max(place));
        }
        let reach = 2.0 * self.step;
        (low, high) = (low - reach, high + reach);
        if !low.cmple(high).all() {
            return Vec::new();
        }
        let is_there =
            |candidate: &Candidate| candidate.high.cmpge(low).all() && candidate.low.cmple(high).all();
        // (Where hardly a vertex was moved, most triangles are wholly beyond one of its sides.)
        let sides = self.sides_of_most(low, high);
        let is_beyond = |index: u32| {
            sides.as_ref().is_some_and(|sides| {
                let [a, b, c] = self.triangles[index as usize].map(|v| sides[v as usize]);
                a & b & c != 0
            })
        };
        // 2. Which cells have nearly opposite normals. (Where triangles pass many cells each, that is not asked.)
        let around = |of: &Candidate| [of.low - reach, of.high + reach];
        let mut cells = Cells::new(low, high, self.triangles.len());
        let (mut homes, mut passed) = (Vec::with_capacity(self.triangles.len()), 0);
        for index in 0..self.triangles.len() as u32 {
            if is_beyond(index) {
                homes.push(NOWHERE);
                continue;
            }
            if sides.is_none() && index.is_multiple_of(RUN) {
                let run = self.triangles[index as usize..].iter().take(RUN as usize).flatten();
                read_ahead(run.map(|&v| self.before[v as usize][0].to_bits() as u32));
            }
            let home = match self.candidate(index).filter(is_there) {
                Some(candidate) if passed <= most_passed => {
                    let (cell, count) = cells.add(around(&candidate), &candidate.normals());
                    passed += count;
                    cell.unwrap_or(SEVERAL)
                }
                Some(_) => SEVERAL,
                None => NOWHERE,
            };
            homes.push(home);
        }
        // 3. The triangles there.
        let are_all = passed > most_passed;
        let is_opposed = |of: &Candidate| are_all || cells.is_any_opposed(around(of), NORMAL_SLACK);
        let found = (0..).zip(&homes).filter_map(|(index, &home)| match home {
            NOWHERE => None,
            SEVERAL => self.candidate(index).filter(is_opposed),
            cell if are_all || cells.is_opposed(cell, NORMAL_SLACK) => self.candidate(index),
            _ => None,
        });
        let found: Vec<Candidate> = found.collect();
        drop((cells, homes));
        let middle = |of: &Candidate| (of.low * 0.5 + of.high * 0.5).to_array();
        let middles: Vec<[f64; 3]> = found.iter().map(middle).collect();
        let mut found: Vec<Option<Candidate>> = found.into_iter().map(Some).collect();
        coherent_order(&middles).into_iter().filter_map(|index| found[index as usize].take()).collect()
    }
}

/// A node: a box of points and the normals there.
#[derive(Clone, Copy)]
struct Node {
    low: DVec3,
    high: DVec3,
    normals: Normals,
}

impl Node {
    const NOTHING: Self = Self { low: DVec3::INFINITY, high: DVec3::NEG_INFINITY, normals: Normals::NOTHING };

    fn with(self, other: &Self) -> Self {
        Self {
            low: self.low.min(other.low),
            high: self.high.max(other.high),
            normals: self.normals.with(&other.normals),
        }
    }

    /// Whether triangles of both may lie back to back within `reach`.
    fn may_meet(&self, other: &Self, reach: f64) -> bool {
        (self.low - reach).cmple(other.high).all()
            && (other.low - reach).cmple(self.high).all()
            && self.normals.may_oppose(&other.normals, NORMAL_SLACK)
    }
}

/// A binary tree over runs of candidates, as a heap: the children of node i are 2 i + 1 and 2 i + 2.
struct Tree {
    nodes: Vec<Node>,
    /// Number of leaves, a power of two.
    leaves: usize,
    candidates: usize,
}

impl Tree {
    fn new(candidates: &[Candidate]) -> Self {
        let leaves = candidates.len().div_ceil(LEAF).next_power_of_two();
        let mut nodes = vec![Node::NOTHING; 2 * leaves - 1];
        for (leaf, run) in candidates.chunks(LEAF).enumerate() {
            nodes[leaves - 1 + leaf] = run.iter().fold(Node::NOTHING, |node, candidate| {
                node.with(&Node { low: candidate.low, high: candidate.high, normals: candidate.normals() })
            });
        }
        for node in (0..leaves - 1).rev() {
            nodes[node] = nodes[2 * node + 1].with(&nodes[2 * node + 2]);
        }
        Self { nodes, leaves, candidates: candidates.len() }
    }

    /// Calls `visit` for every two candidates in leaves that may meet, until `most` pairs of nodes have been looked at.
    fn visit_pairs(
        &self,
        reach: f64,
        most: usize,
        control: &Control,
        mut visit: impl FnMut(usize, usize),
    ) -> Result<(), Limit> {
        let mut stack = vec![(0, 0)];
        let mut steps = 0_usize;
        while let Some((a, b)) = stack.pop() {
            steps += 1;
            if steps > most {
                break;
            }
            if steps.is_multiple_of(1 << 14) {
                control.check()?;
            }
            if !self.nodes[a].may_meet(&self.nodes[b], reach) {
                continue;
            }
            let (inner_a, inner_b) = (a < self.leaves - 1, b < self.leaves - 1);
            match (inner_a, inner_b) {
                (true, _) if a == b => {
                    stack.extend([(2 * a + 1, 2 * a + 1), (2 * a + 1, 2 * a + 2), (2 * a + 2, 2 * a + 2)]);
                }
                // Both are at the same depth but for leaves, and all leaves are.
                (true, true) => stack.extend(
                    [1, 2].into_iter().flat_map(|i| [(2 * a + i, 2 * b + 1), (2 * a + i, 2 * b + 2)]),
                ),
                _ => {
                    let run = |node: usize| {
                        let start = (node + 1 - self.leaves) * LEAF;
                        start..(start + LEAF).min(self.candidates)
                    };
                    for i in run(a) {
                        for j in run(b).filter(|&j| a != b || j > i) {
                            visit(i, j);
                        }
                    }
                }
            }
        }
        Ok(())
    }
}

/// The search, with what it has found.
struct Search<'a> {
    before: &'a [[f64; 3]],
    after: &'a [[f64; 3]],
    triangles: &'a [[u32; 3]],
    step: f64,
    candidates: &'a [Candidate],
    found: LostFilms,
}

impl Search<'_> {
    fn examine(&mut self, i: usize, j: usize) {
        let (s, t) = (&self.candidates[i], &self.candidates[j]);
        if !(s.moved || t.moved) || s.normal.dot(t.normal) > OPPOSITE {
            return;
        }
        let (a, b) = (self.triangles[s.triangle as usize], self.triangles[t.triangle as usize]);
        let place = |v: u32| DVec3::from_array(self.before[v as usize]);
        let (p, q) = (a.map(place), b.map(place));
        let heights = |from: &Candidate, origin: DVec3, corners: &[DVec3; 3]| {
            corners.map(|corner| from.normal.dot(corner - origin))
        };
        let (over_s, over_t) = (heights(s, p[0], &q), heights(t, q[0], &p));
        let largest = |heights: &[f64; 3]| heights.iter().fold(0.0_f64, |most, h| most.max(h.abs()));
        let thickness = largest(&over_s).min(largest(&over_t));
        // Each side moves by less than a step along every axis.
        if !(thickness <= 4.0 * self.step) || !overlap(&p, &q, s.normal, 2.0 * self.step) {
            return;
        }
        if !separated(self.before, a, b) || separated(self.after, a, b) {
            return;
        }
        let film = Film { place: ((p[0] + p[1] + p[2]) / 3.0).to_array(), thickness };
        // In front of the other is face to face.
        if over_s.iter().sum::<f64>() > 0.0 {
            self.found.gaps += 1;
            self.found.first_gap.get_or_insert(film);
        } else {
            self.found.films += 1;
            self.found.first_film.get_or_insert(film);
        }
    }
}

/// Whether the plane of one triangle has the other's corners, but for common ones, strictly on one side. Exact.
fn separated(positions: &[[f64; 3]], a: [u32; 3], b: [u32; 3]) -> bool {
    let beside = |plane: [u32; 3], corners: [u32; 3]| {
        let [p, q, r] = plane.map(|v| &positions[v as usize]);
        let mut sides = corners
            .into_iter()
            .filter(|corner| !plane.iter().any(|v| v == corner))
            .map(|corner| orient3d(p, q, r, &positions[corner as usize]));
        match sides.next() {
            None | Some(Sign::Zero) => false,
            Some(side) => sides.all(|other| other == side),
        }
    };
    beside(a, b) || beside(b, a)
}

/// Whether two triangles overlap by more than `least` in every direction of the plane across `normal`.
fn overlap(p: &[DVec3; 3], q: &[DVec3; 3], normal: DVec3, least: f64) -> bool {
    let clear = |t: &[DVec3; 3], k: usize| {
        let axis = normal.cross(t[(k + 1) % 3] - t[k]).normalize_or_zero();
        let range = |corners: &[DVec3; 3]| {
            let along = corners.map(|corner| axis.dot(corner - t[k]));
            (along[0].min(along[1]).min(along[2]), along[0].max(along[1]).max(along[2]))
        };
        let (x, y) = (range(p), range(q));
        x.1.min(y.1) - x.0.max(y.0) > least
    };
    (0..3).all(|k| clear(p, k) && clear(q, k))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Mesh, primitives};

    fn rounded(mesh: &Mesh) -> Vec<[f64; 3]> {
        mesh.positions.iter().map(|p| p.map(|x| f64::from(x as f32))).collect()
    }

    fn moved(mesh: &Mesh, after: &[[f64; 3]]) -> BitSet {
        let mut moved = BitSet::new(after.len());
        (0..)
            .zip(mesh.positions.iter().zip(after))
            .filter(|(_, (p, q))| p != q)
            .for_each(|(v, _)| moved.insert(v));
        moved
    }

    fn lost(mesh: &Mesh) -> LostFilms {
        let step = f64::from(f32::EPSILON) * mesh.bounds().unwrap().largest();
        let after = rounded(mesh);
        let moved = moved(mesh, &after);
        lost_films(&mesh.positions, &after, &moved, &mesh.triangles, step, &Control::new()).unwrap()
    }

    #[test]
    fn a_wall_thinner_than_rounding_is_found_and_a_thicker_one_is_not() {
        for (thickness, films) in [(1e-9, true), (1e-3, false)] {
            let plate = primitives::cuboid([0.0, 0.0, 1.0], [3.0, 2.0, 1.0 + thickness]).unwrap();
            let found = lost(&plate);
            assert_eq!((found.films > 0, found.gaps), (films, 0), "{thickness}");
            if let Some(film) = found.first_film {
                assert!((film.thickness - thickness).abs() < 1e-15 && (film.place[2] - 1.0).abs() < 1e-8);
            }
        }
    }

    #[test]
    fn a_gap_is_told_from_a_film() {
        let low = primitives::cuboid([0.0; 3], [1.0; 3]).unwrap();
        let high = primitives::cuboid([0.25, 0.25, 1.0 + 1e-9], [0.75, 0.75, 2.0]).unwrap();
        let found = lost(&Mesh::merged([&low, &high]).unwrap());
        assert!(found.gaps > 0 && found.films == 0, "{found:?}");
    }

    #[test]
    fn cells_leave_out_nothing_that_is_lost() {
        // Shells with thin walls and without, in one surface, and nearly closed slots of a plate.
        let ball = primitives::icosphere(1.0, 4).unwrap().rotated([1.0, 2.0, 3.0], 0.7).unwrap();
        let hollow = |thickness: f64| {
            let inner = ball.clone().scaled([1.0 - thickness; 3]).unwrap().reversed();
            Mesh::merged([&ball, &inner]).unwrap()
        };
        let plates = [1e-9, 3e-8, 1e-3].map(|gap| {
            let low = primitives::cuboid([3.0; 3], [4.0; 3]).unwrap();
            let high = primitives::cuboid([3.25, 3.25, 4.0 + gap], [3.75, 3.75, 5.0]).unwrap();
            Mesh::merged([&low, &high]).unwrap()
        });
        for thickness in [1e-9, 2e-8, 3e-7, 0.1] {
            let far = hollow(0.3).translated([5.0, 0.0, 0.0]);
            let meshes: Vec<&Mesh> = plates.iter().collect();
            let mesh = Mesh::merged([&[&hollow(thickness), &far], &*meshes].concat()).unwrap();
            let step = f64::from(f32::EPSILON) * mesh.bounds().unwrap().largest();
            let after = rounded(&mesh);
            let moved = moved(&mesh, &after);
            let (before, triangles) = (&*mesh.positions, &*mesh.triangles);
            let surface = Surface { before, after: &after, moved: &moved, triangles, step };
            let all = surface.candidates(0);
            let some = surface.candidates(MOST_PASSED * mesh.triangles.len());
            assert!(some.len() < all.len(), "{} of {}", some.len(), all.len());
            let with = |most_passed: usize| search(&surface, most_passed, &Control::new()).unwrap();
            let (found, expected) = (with(MOST_PASSED * mesh.triangles.len()), with(0));
            assert_eq!((found.films, found.gaps), (expected.films, expected.gaps), "{thickness}");
            assert!(found.gaps > 0 && (found.films > 0) == (thickness < 1e-7), "{thickness}: {found:?}");
        }
    }

    #[test]
    fn where_hardly_a_vertex_moves_all_is_found_that_pairs_lose() {
        let ball = primitives::icosphere(1.0, 3).unwrap().rotated([1.0, 2.0, 3.0], 0.7).unwrap();
        for thickness in [1e-9, 1e-8, 2e-8] {
            let inner = ball.clone().scaled([1.0 - thickness; 3]).unwrap().reversed();
            let mut mesh = Mesh::merged([&ball, &inner]).unwrap();
            let is_cut = |position: &[f64; 3]| position[0] + 0.3 * position[1] > 0.9;
            let held = rounded(&mesh);
            let all = mesh.positions.len();
            (mesh.positions.iter_mut().zip(&held))
                .filter(|(position, _)| !is_cut(position))
                .for_each(|(position, held)| *position = *held);
            let step = f64::from(f32::EPSILON) * mesh.bounds().unwrap().largest();
            let after = rounded(&mesh);
            let moved = moved(&mesh, &after);
            assert!(0 < moved.count() && moved.count() < all / 8);
            let (before, triangles) = (&*mesh.positions, &*mesh.triangles);
            let surface = Surface { before, after: &after, moved: &moved, triangles, step };
            let [low, high] = [f64::min, f64::max].map(|of| {
                let cut = mesh.positions.iter().filter(|position| is_cut(position));
                cut.fold(mesh.positions[moved.iter().next().unwrap() as usize], |all, position| {
                    [0, 1, 2].map(|k| of(all[k], position[k]))
                })
            });
            assert!(surface.sides_of_most(DVec3::from_array(low), DVec3::from_array(high)).is_some());
            let candidates: Vec<Candidate> =
                (0..triangles.len() as u32).filter_map(|index| surface.candidate(index)).collect();
            let found = LostFilms::default();
            let mut expected =
                Search { before, after: &after, triangles, step, candidates: &candidates, found };
            for i in 0..candidates.len() {
                (i + 1..candidates.len()).for_each(|j| expected.examine(i, j));
            }
            let expected = expected.found;
            let found = search(&surface, MOST_PASSED * triangles.len(), &Control::new()).unwrap();
            assert_eq!((found.films, found.gaps), (expected.films, expected.gaps), "{thickness}");
            assert!(found.films > 3, "{thickness}: {found:?}");
        }
    }

    #[test]
    fn sides_of_films_may_reach_beyond_all_that_moves() {
        // Two large triangles, and a fine sheet a little over them in one corner, higher elsewhere.
        let (along, last) = (40u32, 40.0);
        let mut positions = vec![[0.0, 0.0, 0.5], [last, 0.0, 0.5], [last, last, 0.5], [0.0, last, 0.5]];
        let mut triangles = vec![[0, 2, 1], [0, 3, 2]];
        let at = |i: u32, j: u32| 4 + i * (along + 1) + j;
        let height = |i: u32, j: u32| if i < 6 && j < 6 { 0.5 + 1e-9 } else { 0.75 };
        let places = (0..=along).flat_map(|i| (0..=along).map(move |j| (i, j)));
        positions.extend(places.map(|(i, j)| [f64::from(i), f64::from(j), height(i, j)]));
        for (i, j) in (0..along).flat_map(|i| (0..along).map(move |j| (i, j))) {
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            triangles.extend([[a, b, c], [a, c, d]]);
        }
        let mesh = Mesh::new(positions, triangles);
        let after = rounded(&mesh);
        let moved = moved(&mesh, &after);
        assert_eq!(moved.count(), 36);
        let (before, triangles) = (&*mesh.positions, &*mesh.triangles);
        let surface = Surface { before, after: &after, moved: &moved, triangles, step: 1e-6 };
        let (low, high) = (DVec3::new(0.0, 0.0, 0.5), DVec3::new(6.0, 6.0, 0.75));
        assert!(surface.sides_of_most(low, high).is_some());
        let found = search(&surface, MOST_PASSED * triangles.len(), &Control::new()).unwrap();
        // Each of the fifty lies over one of the large ones, or along the diagonal over both.
        assert!((50..=60).contains(&found.films) && found.gaps == 0, "{found:?}");
    }

    #[test]
    fn a_gap_at_the_border_of_cells_is_found() {
        // Two sheets of many triangles, face to face, with a border of cells between them: on either side all look the same way.
        let (gap, along) = (1e-9, 24u32);
        let (mut positions, mut triangles) = (Vec::new(), Vec::new());
        for side in [-1.0, 1.0] {
            let first = positions.len() as u32;
            let at = |i: u32, j: u32| first + i * (along + 1) + j;
            let place = |i: u32| 2.0 * f64::from(i) / f64::from(along) - 1.0;
            let places = (0..=along).flat_map(|i| (0..=along).map(move |j| (i, j)));
            positions.extend(places.map(|(i, j)| [place(i), place(j), 0.5 * side * gap]));
            // (And one far from it, so that the sheets are the middle of all.)
            positions.extend([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]].map(|[x, y]| [x, y, side * (3.0 + 1e-7)]));
            let last = positions.len() as u32;
            let squares = (0..along).flat_map(|i| (0..along).map(move |j| (i, j)));
            let mut own: Vec<[u32; 3]> = squares
                .flat_map(|(i, j)| {
                    let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
                    [[a, b, c], [a, c, d]]
                })
                .collect();
            own.push([last - 3, last - 2, last - 1]);
            triangles.extend(own.into_iter().map(|[a, b, c]| if side < 0.0 { [a, b, c] } else { [a, c, b] }));
        }
        let mesh = Mesh::new(positions, triangles);
        let step = 1e-6;
        let after: Vec<[f64; 3]> =
            mesh.positions.iter().map(|point| point.map(|x| (x / step).round() * step)).collect();
        let moved = moved(&mesh, &after);
        let (before, triangles) = (&*mesh.positions, &*mesh.triangles);
        let surface = Surface { before, after: &after, moved: &moved, triangles, step };
        let found = search(&surface, MOST_PASSED * triangles.len(), &Control::new()).unwrap();
        assert!(found.gaps > 0 && found.films == 0, "{found:?}");
        assert!((found.first_gap.unwrap().thickness - gap).abs() < 1e-15);
    }

    #[test]
    fn smooth_surfaces_and_exact_ones_have_none() {
        let ball = primitives::uv_sphere(1.0, 24, 12).unwrap().translated([0.1, 0.2, 0.3]);
        assert_eq!(lost(&ball), LostFilms::default());
        let plate = primitives::cuboid([0.0; 3], [1.0, 1.0, 1e-9]).unwrap();
        let none = BitSet::new(plate.positions.len());
        let Mesh { positions, triangles, .. } = &plate;
        let found = lost_films(positions, positions, &none, triangles, 1e-7, &Control::new());
        assert_eq!(found.unwrap(), LostFilms::default());
    }
}
