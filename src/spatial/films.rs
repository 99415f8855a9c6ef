//! Films and gaps of a surface that moving its vertices a little closes: pairs of triangles back to back, or face to face,
//! that a plane separates before and none does after.
//!
//! Only triangles with nearly opposite normals can lie so, and on most surfaces neighbours have similar ones. The hierarchy
//! keeps a box of normals beside each box of points and passes over every part without opposite normals, which leaves next to
//! nothing of a surface without thin walls (Volino, Magnenat-Thalmann 1994, cull self-collisions by cones alike).

use glam::DVec3;

use super::morton::coherent_order;
use crate::exact::{Sign, orient3d};
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

/// Looks for films and gaps between `triangles` that were there with the vertices at `before` and are not at `after`, no
/// coordinate being moved by more than half a `step`. O(n log n).
///
/// # Errors
/// The limits of `control`.
pub(crate) fn lost_films(
    before: &[[f64; 3]],
    after: &[[f64; 3]],
    triangles: &[[u32; 3]],
    step: f64,
    control: &Control,
) -> Result<LostFilms, Limit> {
    let candidates = candidates(before, after, triangles, step);
    if candidates.is_empty() {
        return Ok(LostFilms::default());
    }
    let tree = Tree::new(&candidates);
    let mut search =
        Search { before, after, triangles, step, candidates: &candidates, found: LostFilms::default() };
    tree.visit_pairs(2.0 * step, control, |i, j| search.examine(i, j))?;
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

/// The triangles wide enough to be a side of a film, in an order along a curve through space; those far from every moved
/// vertex left out.
fn candidates(before: &[[f64; 3]], after: &[[f64; 3]], triangles: &[[u32; 3]], step: f64) -> Vec<Candidate> {
    let has_moved = |triangle: &[u32; 3]| triangle.iter().any(|&v| before[v as usize] != after[v as usize]);
    let corners = |triangle: &[u32; 3]| triangle.map(|v| DVec3::from_array(before[v as usize]));
    let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for triangle in triangles.iter().filter(|triangle| has_moved(triangle)) {
        let [a, b, c] = corners(triangle);
        (low, high) = (low.min(a).min(b).min(c), high.max(a).max(b).max(c));
    }
    (low, high) = (low - 2.0 * step, high + 2.0 * step);
    let mut found = Vec::new();
    let mut middles = Vec::new();
    for (index, triangle) in triangles.iter().enumerate() {
        let [a, b, c] = corners(triangle);
        let (least, most) = (a.min(b).min(c), a.max(b).max(c));
        if most.cmplt(low).any() || least.cmpgt(high).any() {
            continue;
        }
        let normal = (b - a).cross(c - a);
        let (doubled_area, longest) =
            (normal.length(), (b - a).length().max((c - b).length()).max((a - c).length()));
        if doubled_area > LEAST_ALTITUDE * step * longest && doubled_area.is_finite() {
            let normal = normal / doubled_area;
            let moved = has_moved(triangle);
            found.push(Candidate { triangle: index as u32, moved, normal, low: least, high: most });
            middles.push((least * 0.5 + most * 0.5).to_array());
        }
    }
    let mut in_order = Vec::with_capacity(found.len());
    let mut found: Vec<Option<Candidate>> = found.into_iter().map(Some).collect();
    in_order.extend(coherent_order(&middles).into_iter().filter_map(|index| found[index as usize].take()));
    in_order
}

/// A node: a box of points and a box of normals.
#[derive(Clone, Copy)]
struct Node {
    low: DVec3,
    high: DVec3,
    least_normal: [f32; 3],
    most_normal: [f32; 3],
    moved: bool,
}

impl Node {
    const NOTHING: Self = Self {
        low: DVec3::INFINITY,
        high: DVec3::NEG_INFINITY,
        least_normal: [f32::INFINITY; 3],
        most_normal: [f32::NEG_INFINITY; 3],
        moved: false,
    };

    fn with(self, other: &Self) -> Self {
        Self {
            low: self.low.min(other.low),
            high: self.high.max(other.high),
            least_normal: [0, 1, 2].map(|k| self.least_normal[k].min(other.least_normal[k])),
            most_normal: [0, 1, 2].map(|k| self.most_normal[k].max(other.most_normal[k])),
            moved: self.moved || other.moved,
        }
    }

    /// Whether triangles of both may lie back to back within `reach`.
    fn may_meet(&self, other: &Self, reach: f64) -> bool {
        (self.moved || other.moved)
            && (self.low - reach).cmple(other.high).all()
            && (other.low - reach).cmple(self.high).all()
            && (0..3).all(|k| {
                self.least_normal[k] + other.least_normal[k] <= NORMAL_SLACK
                    && self.most_normal[k] + other.most_normal[k] >= -NORMAL_SLACK
            })
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
                let normal = candidate.normal.as_vec3().to_array();
                let Candidate { low, high, moved, .. } = *candidate;
                node.with(&Node { low, high, least_normal: normal, most_normal: normal, moved })
            });
        }
        for node in (0..leaves - 1).rev() {
            nodes[node] = nodes[2 * node + 1].with(&nodes[2 * node + 2]);
        }
        Self { nodes, leaves, candidates: candidates.len() }
    }

    /// Calls `visit` for every two candidates in leaves that may meet, until too many nodes have been looked at.
    fn visit_pairs(
        &self,
        reach: f64,
        control: &Control,
        mut visit: impl FnMut(usize, usize),
    ) -> Result<(), Limit> {
        let mut stack = vec![(0, 0)];
        let (mut steps, most) = (0_usize, MOST_PAIRS.saturating_mul(self.candidates));
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

    fn lost(mesh: &Mesh) -> LostFilms {
        let step = f64::from(f32::EPSILON) * mesh.bounds().unwrap().largest();
        lost_films(&mesh.positions, &rounded(mesh), &mesh.triangles, step, &Control::new()).unwrap()
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
    fn smooth_surfaces_and_exact_ones_have_none() {
        let ball = primitives::uv_sphere(1.0, 24, 12).unwrap().translated([0.1, 0.2, 0.3]);
        assert_eq!(lost(&ball), LostFilms::default());
        let plate = primitives::cuboid([0.0; 3], [1.0, 1.0, 1e-9]).unwrap();
        let found = lost_films(&plate.positions, &plate.positions, &plate.triangles, 1e-7, &Control::new());
        assert_eq!(found.unwrap(), LostFilms::default());
    }
}
