//! Open edges made to cancel: vertices joined and edges split, where that closes the surface.

use rustc_hash::FxHashMap;

use super::super::UnionFind;
use super::super::places::Spots;
use super::super::weld::{self, OpenEdge};
use super::rounding::{Reaches, apart};
use super::{Surface, seams, splits};

/// What may be done to open edges.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sewing {
    /// Places within this distance are one, besides those that are by rounding.
    pub(super) distance: Option<f64>,
    /// Which vertices split open edges.
    pub(super) splits: Splits,
    /// Whether only that is done which makes all open edges around it cancel.
    pub(super) where_it_closes: bool,
}

/// Which vertices are on an edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Splits {
    None,
    /// Those that are by rounding.
    ByRounding,
    /// Those too that are within the distance that was asked for.
    ByDistance,
}

/// What would be done to the open edges of a surface.
struct Plan<'a> {
    edges: &'a [OpenEdge],
    reaches: Reaches,
    /// For each vertex of `reaches` the one it joins.
    targets: Vec<u32>,
    /// Edges still open once vertices are joined, the lower end first, with how often they run upwards, and the vertices on
    /// each in their order.
    open: Vec<(u32, u32, i64)>,
    on_open: Vec<Vec<u32>>,
    /// The part of the surface's rim that each vertex of `reaches` is in.
    part: Vec<u32>,
    /// Whether all edges of each part then cancel.
    closes: Vec<bool>,
}

/// Joins and splits. Returns whether something was found and not done, because it would not close the surface there.
pub(super) fn sew(surface: &mut Surface<'_>, how: Sewing) -> bool {
    let edges = weld::boundary(&surface.triangles, surface.mesh.positions.len());
    let plan = Plan::new(&surface.mesh.positions, &edges, how);
    let done = |vertex: u32| !how.where_it_closes || plan.closes[plan.part_of(vertex)];
    let found = plan.joins().map(|(vertex, _)| vertex).chain(plan.splits().map(|((low, _), _)| low));
    let rejected = found.clone().any(|vertex| !done(vertex));
    if found.clone().any(done) {
        let joins = plan.joins().filter(|&(vertex, _)| done(vertex)).collect();
        let splits = plan.splits().filter(|&((low, _), _)| done(low)).collect();
        apply(surface, &joins, &splits);
    }
    rejected
}

/// How many edges are in parts of the rim that stay open once vertices within `distance` (or a rounding) are joined and those on
/// edges split them.
pub(super) fn left_open(
    positions: &[[f64; 3]],
    edges: &[OpenEdge],
    distance: Option<f64>,
    splits: Splits,
) -> usize {
    let plan = Plan::new(positions, edges, Sewing { distance, splits, where_it_closes: true });
    edges.iter().filter(|edge| !plan.closes[plan.part_of(edge.from)]).count()
}

/// How far apart the vertices are that are joined within `distance`, ascending.
pub(super) fn gaps(positions: &[[f64; 3]], edges: &[OpenEdge], distance: f64) -> Vec<f64> {
    let how = Sewing { distance: Some(distance), splits: Splits::None, where_it_closes: true };
    let plan = Plan::new(positions, edges, how);
    let place = |vertex: u32| &positions[vertex as usize];
    let mut gaps: Vec<f64> =
        plan.joins().map(|(vertex, target)| apart(place(vertex), place(target))).collect();
    gaps.sort_unstable_by(f64::total_cmp);
    gaps.dedup();
    gaps
}

impl<'a> Plan<'a> {
    fn new(positions: &[[f64; 3]], edges: &'a [OpenEdge], how: Sewing) -> Self {
        // 1. Who joins whom.
        let reaches = Reaches::new(positions, edges, how.distance);
        let targets = seams::targets(positions, &reaches);
        let mut plan = Self {
            edges,
            reaches,
            targets,
            open: Vec::new(),
            on_open: Vec::new(),
            part: Vec::new(),
            closes: Vec::new(),
        };
        // 2. What is then still open, and which vertices lie on it.
        let joined = plan
            .edges
            .iter()
            .map(|edge| (plan.target(edge.from), plan.target(edge.to), i64::from(edge.count)));
        plan.open = sums(joined.collect());
        plan.on_open = vec![Vec::new(); plan.open.len()];
        if how.splits != Splits::None {
            let by_rounding = Reaches::new(positions, edges, None);
            let reaches = if how.splits == Splits::ByRounding { &by_rounding } else { &plan.reaches };
            let ends: Vec<(u32, u32)> = plan.open.iter().map(|&(low, high, _)| (low, high)).collect();
            if let Some(found) = splits::on_edges(positions, &ends, reaches) {
                plan.on_open = found;
            }
        }
        // 3. What hangs together, and whether all of it cancels.
        plan.find_parts();
        plan
    }

    fn find_parts(&mut self) {
        let mut parts = UnionFind::new(self.targets.len());
        for (vertex, &target) in self.reaches.vertices().iter().zip(&self.targets) {
            parts.join(self.number(*vertex), self.number(target));
        }
        for edge in self.edges {
            parts.join(self.number(edge.from), self.number(edge.to));
        }
        let mut pieces = Vec::new();
        for (&(low, high, net), on) in self.open.iter().zip(&self.on_open) {
            let path = [&[low], &on[..], &[high]].concat();
            for pair in path.windows(2) {
                parts.join(self.number(pair[0]), self.number(pair[1]));
                pieces.push((pair[0], pair[1], net));
            }
        }
        let (count, part) = parts.labels();
        self.part = part;
        self.closes = vec![true; count];
        for (low, _, _) in sums(pieces) {
            let part = self.part_of(low);
            self.closes[part] = false;
        }
    }

    fn number(&self, vertex: u32) -> u32 {
        self.reaches.vertices().binary_search(&vertex).unwrap_or_default() as u32
    }

    fn target(&self, vertex: u32) -> u32 {
        self.targets[self.number(vertex) as usize]
    }

    fn part_of(&self, vertex: u32) -> usize {
        self.part[self.number(vertex) as usize] as usize
    }

    /// Vertices that join others, ascending.
    fn joins(&self) -> impl Iterator<Item = (u32, u32)> + Clone + '_ {
        let all = self.reaches.vertices().iter().copied().zip(self.targets.iter().copied());
        all.filter(|(vertex, target)| vertex != target)
    }

    /// Edges that are split, with the vertices on them.
    fn splits(&self) -> impl Iterator<Item = ((u32, u32), &[u32])> + Clone {
        let all = self.open.iter().zip(&self.on_open).map(|(&(low, high, _), on)| ((low, high), &on[..]));
        all.filter(|(_, on)| !on.is_empty())
    }
}

/// Directed edges, each so many times, added up: those that do not cancel, the lower end first, ascending.
fn sums(edges: Vec<(u32, u32, i64)>) -> Vec<(u32, u32, i64)> {
    let upward = |(a, b, count): (u32, u32, i64)| if a < b { (a, b, count) } else { (b, a, -count) };
    let mut edges: Vec<_> = edges.into_iter().filter(|(a, b, _)| a != b).map(upward).collect();
    edges.sort_unstable();
    let sum = |equal: &[(u32, u32, i64)]| (equal[0].0, equal[0].1, equal.iter().map(|edge| edge.2).sum());
    edges.chunk_by(|x, y| (x.0, x.1) == (y.0, y.1)).map(sum).filter(|&(_, _, net)| net != 0).collect()
}

fn apply(surface: &mut Surface<'_>, joins: &FxHashMap<u32, u32>, splits: &FxHashMap<(u32, u32), &[u32]>) {
    let mut triangles = Vec::with_capacity(surface.triangles.len());
    let mut source = Vec::with_capacity(surface.triangles.len());
    // A triangle of each vertex that is joined or splits an edge: its place in the report.
    let mut at_joined: FxHashMap<u32, u32> = FxHashMap::default();
    let mut at_split: FxHashMap<u32, u32> = FxHashMap::default();
    for (&triangle, &index) in surface.triangles.iter().zip(&surface.source) {
        let corners = triangle.map(|corner| match joins.get(&corner) {
            Some(&target) => {
                at_joined.entry(corner).or_insert(index);
                target
            }
            None => corner,
        });
        let mut on: [Vec<u32>; 3] = Default::default();
        for side in 0..3 {
            let (a, b) = (corners[side], corners[(side + 1) % 3]);
            if let Some(&found) = splits.get(&(a.min(b), a.max(b))) {
                found.iter().for_each(|&vertex| {
                    at_split.entry(vertex).or_insert(index);
                });
                on[side] = if a < b { found.to_vec() } else { found.iter().rev().copied().collect() };
            }
        }
        let [a, b, c] = corners;
        if on.iter().all(Vec::is_empty) {
            if a != b && b != c && c != a {
                triangles.push(corners);
                source.push(index);
            }
            continue;
        }
        for piece in splits::fan_around_splits(corners, [&on[0], &on[1], &on[2]]) {
            triangles.push(piece);
            source.push(index);
        }
    }
    let vanished = vanished(&surface.source, &source);
    surface.triangles = triangles;
    surface.source = source;
    report(surface, joins, at_joined, at_split, &vanished);
}

/// The triangles of `before` of which nothing is left. Both are ascending.
fn vanished(before: &[u32], after: &[u32]) -> Vec<u32> {
    before.iter().copied().filter(|index| after.binary_search(index).is_err()).collect()
}

fn report(
    surface: &mut Surface<'_>,
    joins: &FxHashMap<u32, u32>,
    at_joined: FxHashMap<u32, u32>,
    at_split: FxHashMap<u32, u32>,
    vanished: &[u32],
) {
    let sorted = |found: FxHashMap<u32, u32>| {
        let mut found: Vec<(u32, u32)> = found.into_iter().collect();
        found.sort_unstable();
        found
    };
    let spots = Spots { mesh: surface.mesh };
    for (vertex, triangle) in sorted(at_joined) {
        let target = joins[&vertex];
        let [place, other] = [vertex, target].map(|vertex| &surface.mesh.positions[vertex as usize]);
        surface.report.widest_seam = surface.report.widest_seam.max(apart(place, other));
        surface.report.seams.add(|| spots.vertices_at(triangle, &[target, vertex]));
    }
    for (vertex, triangle) in sorted(at_split) {
        surface.report.split_edges.add(|| spots.vertices_at(triangle, &[vertex]));
    }
    for &triangle in vanished {
        surface.report.zero_area.add(|| spots.triangles(&[triangle]));
    }
}
