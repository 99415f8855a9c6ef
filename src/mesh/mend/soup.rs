//! Soups made ready to be solidified: triangles of any kind, joined where they plainly belong together and turned alike, and
//! triangles that would close their holes.
//!
//! Nothing has to be certain here: what closes a hole becomes part of the result only where it parts inside from outside.

use rustc_hash::{FxHashMap, FxHashSet};

use super::super::edges::EdgeTable;
use super::super::orient::{Facing, reversed};
use super::super::patches::Patches;
use super::super::{
    Bounds, Mesh, MeshError, WeightedUnionFind, area_vector, attributes, chain, clean, measure, unit, weld,
};
use super::sew::{Sewing, Splits};
use super::{Surface, fill, rings, sew};
use crate::exact::collinear;
use crate::mesh::Welding;

/// A soup made ready.
pub(crate) struct Soup {
    /// Its triangles, without copies, those with repeated corners and those without area, turned alike; groups and attributes with
    /// them.
    pub(crate) mesh: Mesh,
    /// By triangle its number as given.
    pub(crate) source: Vec<u32>,
    /// By triangle, whether it was turned.
    pub(crate) turned: Vec<bool>,
    /// By triangle, whether there were as many copies of it that face the other way: a wall between what touches, say.
    pub(crate) cancelled: Vec<bool>,
    /// Triangles over the same vertices that fill holes.
    pub(crate) closing: Vec<[u32; 3]>,
    /// By filling triangle one of `mesh` beside the hole.
    pub(crate) beside: Vec<u32>,
    pub(crate) done: Readied,
}

/// What was done to make a soup ready.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct Readied {
    /// Vertices made one with others at the same place or near it.
    pub joined: usize,
    /// The distance within which they were joined, in units of the coordinates; 0 for equal coordinates only.
    pub distance: f64,
    /// Triangles left out that lie on the same three vertices as another.
    pub copies: usize,
    /// Triangles left out that have no area.
    pub without_area: usize,
    /// Open edges split at a vertex that lies on them.
    pub split_edges: usize,
    /// Triangles turned to agree with their neighbours, or to face outwards.
    pub turned: usize,
    /// Loops of open edges for which filling triangles were made.
    pub holes: usize,
}

impl Soup {
    /// Makes a mesh ready. O(n log n), and n^3 in the number of edges of each hole up to 200.
    ///
    /// # Errors
    /// Corners out of range or not finite, groups and attributes that do not fit, too many triangles, a distance that is none.
    pub(crate) fn new(given: &Mesh, welding: Welding) -> Result<Self, MeshError> {
        given.check()?;
        let (vertices, triangles) = (given.positions.len(), given.triangles.len());
        if vertices > chain::MAX_VERTICES || triangles > chain::MAX_TRIANGLES {
            return Err(MeshError::TooLarge { vertices, triangles });
        }
        if let Welding::Within(distance) = welding
            && !(distance.is_finite() && distance >= 0.0)
        {
            return Err(MeshError::WeldingDistance(distance));
        }
        let mut done = Readied::default();
        // 1. Equal places are one, then near ones on open edges.
        let mut working = Working { given, triangles: Vec::new(), source: Vec::new(), copies: Vec::new() };
        working.take_all(&mut done);
        let distance = match welding {
            Welding::Within(distance) => Some(distance),
            Welding::Rounding | Welding::Closing => joining_distance(&given.positions, &working.triangles),
        };
        if let Some(distance) = distance.filter(|&distance| distance > 0.0) {
            done.distance = distance;
            working.join(|open| weld::near_targets(&given.positions, open, distance), &mut done);
        }
        // 2. Vertices in the middle of open edges split them.
        let copies_of: FxHashMap<u32, i32> = working.source.iter().copied().zip(working.copies).collect();
        let mut surface = Surface::new(given, working.triangles, working.source);
        let sewing = Sewing { distance: None, splits: Splits::ByRounding, where_it_closes: false };
        sew::sew(&mut surface, sewing);
        done.split_edges = surface.report.split_edges.count;
        done.joined += surface.report.seams.count;
        let copies =
            surface.source.iter().map(|source| copies_of.get(source).copied().unwrap_or(1)).collect();
        let mut working = Working { given, triangles: surface.triangles, source: surface.source, copies };
        working.clean(&mut done);
        // 3. Turned alike.
        let Working { mut triangles, source, copies, .. } = working;
        let cancelled: Vec<bool> = copies.iter().map(|&copies| copies == 0).collect();
        let mut turned = turn_alike(&given.positions, &mut triangles);
        // 4. What would close it; outwards as a whole.
        let Closing { filling: mut closing, mut beside, of_loops, loops } =
            Closing::new(&given.positions, &triangles);
        done.holes = loops;
        let closed = [&triangles[..], &closing[..of_loops]].concat();
        if measure::enclosed_volume(&given.positions, &closed) < 0.0 {
            triangles.iter_mut().chain(&mut closing).for_each(|corners| *corners = reversed(*corners));
            turned.iter_mut().for_each(|turned| *turned ^= true);
        }
        done.turned = turned.iter().filter(|&&turned| turned).count();
        drop_known(&triangles, &mut closing, &mut beside);
        // 5. With the vertices that are used, groups and attributes.
        let count = triangles.len();
        let mut all = triangles;
        all.append(&mut closing);
        let positions = clean::compact(&given.positions, &mut all);
        let closing = all.split_off(count);
        let mesh = assembled(given, positions, all, &source, &turned);
        Ok(Self { mesh, source, turned, cancelled, closing, beside, done })
    }
}

/// The mesh of triangles that come from those of another, some of them turned.
fn assembled(
    given: &Mesh,
    positions: Vec<[f64; 3]>,
    triangles: Vec<[u32; 3]>,
    source: &[u32],
    turned: &[bool],
) -> Mesh {
    let mut groups = given.groups.clone();
    groups.select(source);
    // (As the given triangles face, for their attributes, then turned.)
    let as_given: Vec<[u32; 3]> = triangles
        .iter()
        .zip(turned)
        .map(|(&corners, &turned)| if turned { reversed(corners) } else { corners })
        .collect();
    let mut attributes = attributes::of_pieces(given, &positions, &as_given, source);
    let turned: Vec<u32> = (0..).zip(turned).filter(|(_, turned)| **turned).map(|(t, _)| t).collect();
    attributes::reverse_some(&mut attributes, &turned);
    Mesh { positions, triangles, groups, attributes, ..Mesh::default() }
}

/// Triangles on the way to a soup, over the vertices as given.
struct Working<'a> {
    given: &'a Mesh,
    triangles: Vec<[u32; 3]>,
    source: Vec<u32>,
    /// How often each counts, less for copies that face the other way.
    copies: Vec<i32>,
}

impl Working<'_> {
    /// Takes all triangles, with vertices at equal places made one: also where nothing is open, so that what touches hangs together.
    fn take_all(&mut self, done: &mut Readied) {
        let positions = &self.given.positions;
        let mut used = vec![false; positions.len()];
        let is_sound = |&[a, b, c]: &[u32; 3]| a != b && b != c && c != a;
        for (index, triangle) in (0..).zip(&self.given.triangles) {
            if is_sound(triangle) {
                self.triangles.push(*triangle);
                self.source.push(index);
                self.copies.push(1);
                triangle.iter().for_each(|&v| used[v as usize] = true);
            } else {
                done.without_area += 1;
            }
        }
        let vertices: Vec<u32> = (0..).zip(&used).filter(|(_, used)| **used).map(|(v, _)| v).collect();
        let targets = weld::exact_targets(positions, &vertices);
        self.rename(&vertices, &targets, done);
    }

    /// Makes one of vertices on open edges.
    fn join(&mut self, targets: impl FnOnce(&[u32]) -> Vec<u32>, done: &mut Readied) {
        let open = chain::open_vertices(&self.triangles, self.given.positions.len());
        let targets = targets(&open);
        self.rename(&open, &targets, done);
    }

    fn rename(&mut self, vertices: &[u32], targets: &[u32], done: &mut Readied) {
        done.joined += vertices.iter().zip(targets).filter(|(vertex, target)| vertex != target).count();
        let map = weld::vertex_map(self.given.positions.len(), vertices, targets);
        self.triangles.iter_mut().flatten().for_each(|corner| *corner = map[*corner as usize]);
        self.clean(done);
    }

    /// Leaves out what has no area and all but the first of the triangles on the same vertices.
    fn clean(&mut self, done: &mut Readied) {
        let positions = &self.given.positions;
        let mut kept = 0;
        let mut place_of: FxHashMap<[u32; 3], usize> = FxHashMap::default();
        for index in 0..self.triangles.len() {
            let (triangle, copies) = (self.triangles[index], self.copies[index]);
            let [p, q, r] = triangle.map(|v| &positions[v as usize]);
            if collinear(p, q, r) {
                done.without_area += 1;
                continue;
            }
            let place = *place_of.entry(unordered(triangle)).or_insert(kept);
            if place < kept {
                done.copies += 1;
                self.copies[place] +=
                    if is_same_way(self.triangles[place], triangle) { copies } else { -copies };
                continue;
            }
            (self.triangles[kept], self.source[kept], self.copies[kept]) =
                (triangle, self.source[index], copies);
            kept += 1;
        }
        self.triangles.truncate(kept);
        self.source.truncate(kept);
        self.copies.truncate(kept);
    }
}

/// Whether two triangles on the same vertices face the same way.
fn is_same_way(x: [u32; 3], y: [u32; 3]) -> bool {
    let turn = y.iter().position(|&v| v == x[0]).unwrap_or_default();
    y[(turn + 1) % 3] == x[1]
}

fn unordered(mut corners: [u32; 3]) -> [u32; 3] {
    corners.sort_unstable();
    corners
}

/// The least distance within which joining vertices on open edges leaves hardly fewer of them open than joining within more does;
/// `None` where it hardly helps. At most a hundredth of the size and a quarter of the usual open edge.
fn joining_distance(positions: &[[f64; 3]], triangles: &[[u32; 3]]) -> Option<f64> {
    /// Distances that are tried, each twice the one before.
    const TRIED: i32 = 24;
    let edges = weld::boundary(triangles, positions.len());
    let place = |v: u32| positions[v as usize];
    let size = Bounds::of(triangles.iter().flatten().map(|&v| &positions[v as usize]))?.diagonal();
    let mut lengths: Vec<f64> =
        edges.iter().map(|edge| super::rounding::apart(&place(edge.from), &place(edge.to))).collect();
    lengths.sort_unstable_by(f64::total_cmp);
    let usual = *lengths.get(lengths.len() / 2)?;
    let most = (0.01 * size).min(0.25 * usual);
    if !(most > 0.0 && most.is_finite()) {
        return None;
    }
    let mut open: Vec<u32> = edges.iter().flat_map(|edge| [edge.from, edge.to]).collect();
    open.sort_unstable();
    open.dedup();
    let left = |distance: f64| {
        let targets = weld::near_targets(positions, &open, distance);
        let target = |v: u32| open.binary_search(&v).map_or(v, |place| targets[place]);
        let mut joined: Vec<(u32, u32, i64)> = edges
            .iter()
            .map(|edge| (target(edge.from), target(edge.to), i64::from(edge.count)))
            .filter(|(from, to, _)| from != to)
            // (Faces may still be turned the wrong way: an edge is open where it has an odd number of faces.)
            .map(|(from, to, count)| (from.min(to), from.max(to), count))
            .collect();
        joined.sort_unstable();
        let each = joined.chunk_by(|x, y| (x.0, x.1) == (y.0, y.1));
        each.filter(|edge| edge.iter().map(|of| of.2).sum::<i64>() % 2 != 0).count()
    };
    let tried: Vec<(f64, usize)> = (0..TRIED)
        .rev()
        .map(|i| most * f64::from(-i).exp2())
        .map(|distance| (distance, left(distance)))
        .collect();
    let fewest = tried.iter().map(|tried| tried.1).min()?;
    let now = left(0.0);
    let gain = now.saturating_sub(fewest);
    if gain == 0 || 10 * gain < now {
        return None;
    }
    tried.into_iter().find(|&(_, left)| 20 * (left - fewest) <= gain).map(|tried| tried.0)
}

/// Turns the triangles of each patch alike, and outwards those of closed patches that disagreed; which were turned.
fn turn_alike(positions: &[[f64; 3]], triangles: &mut [[u32; 3]]) -> Vec<bool> {
    let table = EdgeTable::new(triangles, positions.len());
    let mut patches = Patches::new(&table, triangles.len());
    patches.reverse = flattest_first(positions, triangles, &table, &patches);
    let facing = Facing::new(positions, triangles, &patches);
    let mut disagrees = vec![false; patches.closed.len()];
    for (&patch, &reverse) in patches.of_triangle.iter().zip(&patches.reverse) {
        disagrees[patch as usize] |= reverse;
    }
    let is_turned = |t: usize| {
        let patch = patches.of_triangle[t] as usize;
        patches.reverse[t] != (disagrees[patch] && facing.wrong[patch])
    };
    let turned: Vec<bool> = (0..triangles.len()).map(is_turned).collect();
    for (corners, _) in triangles.iter_mut().zip(&turned).filter(|(_, turned)| **turned) {
        *corners = reversed(*corners);
    }
    turned
}

/// Which triangles to reverse so that those of each patch agree, the fewer giving way. Where they cannot all agree, because
/// something is folded back or joined to what it does not belong to, what is flat agrees rather than what is not.
fn flattest_first(
    positions: &[[f64; 3]],
    triangles: &[[u32; 3]],
    table: &EdgeTable<'_>,
    patches: &Patches,
) -> Vec<bool> {
    // 1. The edges between two triangles, from flat to folded back.
    let mut edges: Vec<(f64, u32, u32, bool)> = table
        .iter()
        .filter(|edge| edge.valence() == 2)
        .filter_map(|edge| {
            let mut both = edge.triangles();
            let (a, b) = (both.next()?, both.next()?);
            let normal = |t: u32| unit(area_vector(positions, &triangles[t as usize]));
            let along: f64 = (0..3).map(|k| normal(a)[k] * normal(b)[k]).sum();
            let agrees = edge.net() == 0;
            Some((if agrees { -along } else { along }, a, b, agrees))
        })
        .collect();
    edges.sort_by(|x, y| x.0.total_cmp(&y.0).then((x.1, x.2).cmp(&(y.1, y.2))));
    // 2. In this order they say who agrees with whom.
    let mut sets = WeightedUnionFind::new(triangles.len());
    for (_, a, b, agrees) in edges {
        sets.join(a, b, i32::from(!agrees));
    }
    let mut reverse: Vec<bool> = (0..triangles.len() as u32).map(|t| sets.root(t).1 % 2 != 0).collect();
    // 3. The fewer give way.
    for members in patches.triangles.each() {
        let reversed = members.iter().filter(|&&t| reverse[t as usize]).count();
        if 2 * reversed > members.len() {
            members.iter().for_each(|&t| reverse[t as usize] ^= true);
        }
    }
    reverse
}

/// Triangles that fill the loops of open edges. Neighbouring loops are filled by a band between them as well, where that is smaller.
struct Closing {
    /// Those of loops come first.
    filling: Vec<[u32; 3]>,
    of_loops: usize,
    /// By triangle one of the soup beside the loop.
    beside: Vec<u32>,
    loops: usize,
}

impl Closing {
    fn new(positions: &[[f64; 3]], triangles: &[[u32; 3]]) -> Self {
        let loops = rings::rings(positions, triangles, &weld::boundary(triangles, positions.len()));
        let at_edge = fill::between(triangles, &loops);
        let has_edge = |u: u32, v: u32| at_edge.contains_key(&(u, v)) || at_edge.contains_key(&(v, u));
        let mut all = Self { filling: Vec::new(), of_loops: 0, beside: Vec::new(), loops: loops.len() };
        for (number, found) in fill::fillings(positions, &loops, has_edge).into_iter().enumerate() {
            let [u, v] = found.rim;
            let beside = at_edge.get(&(u, v)).copied().unwrap_or(0);
            all.beside.extend(std::iter::repeat_n(beside, found.triangles.len()));
            if number < loops.len() {
                all.of_loops += found.triangles.len();
            }
            all.filling.extend(found.triangles);
        }
        all
    }
}

/// Leaves out triangles that the soup has, and copies of each other.
fn drop_known(triangles: &[[u32; 3]], closing: &mut Vec<[u32; 3]>, beside: &mut Vec<u32>) {
    let mut known: FxHashSet<[u32; 3]> = triangles.iter().map(|&corners| unordered(corners)).collect();
    let keep: Vec<bool> = closing.iter().map(|&corners| known.insert(unordered(corners))).collect();
    let mut kept = keep.iter();
    closing.retain(|_| kept.next() == Some(&true));
    let mut kept = keep.iter();
    beside.retain(|_| kept.next() == Some(&true));
}
