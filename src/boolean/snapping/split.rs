//! Edges and faces get the points that are near them as vertices, and faces that lie on each other the same triangles.

use rustc_hash::{FxHashMap, FxHashSet};
use smallvec::SmallVec;

use super::near::{Edge, Found, OnEdge, sorted};
use super::planes;
use super::surfaces::{Surfaces, Triangle, check_numbers};
use super::weld::Places;
use crate::Error;
use crate::exact::{Projection, Sign, orient2d};
use crate::mesh::fan_around_splits;
use crate::parallel::Runner;
use crate::polygon::Overlay;

/// What was split.
#[derive(Debug, Default)]
pub(super) struct Split {
    pub(super) edges: u64,
    pub(super) faces: u64,
}

/// The vertices along the edges that are split, from the lower end to the higher one, both included.
type Chains = FxHashMap<Edge, Vec<u32>>;

/// Splits edges and faces where something is near.
///
/// # Errors
/// Limits, and [`Error::TooLarge`] where vertices cannot be numbered.
pub(super) fn split(
    surfaces: &mut Surfaces,
    found: &mut Found,
    distance: f64,
    runner: Runner<'_>,
) -> Result<Split, Error> {
    // 1. Vertices where edges pass each other, and onto edges and faces.
    add_passing(surfaces, found, distance)?;
    move_vertices(surfaces, found);
    // 2. The vertices along edges, and inside faces.
    let chains = chains(surfaces, found);
    let inside = inside(surfaces, found, &chains);
    // 3. Faces that lie on each other in one plane, together.
    let mut splitter = Splitter::new(surfaces, &chains, &inside, found);
    for set in planes::find(surfaces, &found.pairs, &splitter.is_split, distance) {
        runner.control.check()?;
        splitter.split_together(&set);
    }
    // 4. The triangles of every face.
    let mut triangles = Vec::with_capacity(surfaces.triangles.len());
    let mut faces = 0;
    for t in 0..surfaces.triangles.len() as u32 {
        if t % 1024 == 0 {
            runner.control.check()?;
        }
        let before = triangles.len();
        splitter.split_face(t, &mut triangles);
        faces += u64::from(triangles.len() > before + 1);
    }
    let edges = chains.len() as u64;
    surfaces.triangles = triangles;
    Ok(Split { edges, faces })
}

/// Adds vertices where edges pass each other, one for those that are nearer than the distance, and notes them as near both edges.
fn add_passing(surfaces: &mut Surfaces, found: &mut Found, distance: f64) -> Result<(), Error> {
    check_numbers(surfaces.positions.len() + found.passing.len())?;
    // Every pair of edges once, in order: faces on both sides of an edge have found it.
    found.passing.sort_by_key(|passing| passing.edges);
    found.passing.dedup_by(|x, y| x.edges == y.edges);
    if found.passing.is_empty() {
        return Ok(());
    }
    let mut places = Places::new(distance);
    let mut corners: Vec<u32> = surfaces.triangles.iter().flat_map(|triangle| triangle.corners).collect();
    corners.sort_unstable();
    corners.dedup();
    corners.iter().for_each(|&v| {
        places.join(&surfaces.positions, v);
    });
    for passing in &found.passing {
        let new = surfaces.positions.len() as u32;
        surfaces.positions.push(passing.place);
        let vertex = places.join(&surfaces.positions, new);
        if vertex != new {
            surfaces.positions.pop();
        }
        let place = surfaces.positions[vertex as usize];
        let on = |edge: Edge| OnEdge { edge, vertex, place };
        found.on_edges.extend(passing.edges.map(on));
    }
    Ok(())
}

/// Moves vertices to the edges and faces that they are near, to the first of each: those of the first operand come first, and edges
/// before faces. So it is vertices that give way, and plane faces stay plane.
fn move_vertices(surfaces: &mut Surfaces, found: &Found) {
    let mut moved = FxHashSet::default();
    let mut edges: Vec<&OnEdge> = found.on_edges.iter().collect();
    edges.sort_by_key(|on| (on.vertex, on.edge));
    let mut faces: Vec<_> = found.in_faces.iter().collect();
    faces.sort_by_key(|inside| (inside.vertex, inside.triangle));
    let places = edges.into_iter().map(|on| (on.vertex, on.place));
    for (vertex, place) in places.chain(faces.into_iter().map(|inside| (inside.vertex, inside.place))) {
        if moved.insert(vertex) {
            surfaces.positions[vertex as usize] = place;
        }
    }
}

/// The vertices along each edge that has any.
fn chains(surfaces: &Surfaces, found: &Found) -> Chains {
    let mut on: FxHashMap<Edge, Vec<(f64, u32)>> = FxHashMap::default();
    for near in found.on_edges.iter().filter(|near| !near.edge.contains(&near.vertex)) {
        let [a, b] = near.edge.map(|v| surfaces.positions[v as usize]);
        let place = surfaces.positions[near.vertex as usize];
        let along = |k: usize| (place[k] - a[k]) * (b[k] - a[k]);
        on.entry(near.edge).or_default().push((along(0) + along(1) + along(2), near.vertex));
    }
    on.into_iter()
        .map(|(edge, mut on)| {
            on.sort_by(|x, y| x.0.total_cmp(&y.0).then(x.1.cmp(&y.1)));
            let mut chain = vec![edge[0]];
            chain.extend(on.into_iter().map(|(_, v)| v));
            chain.push(edge[1]);
            let mut seen = FxHashSet::default();
            chain.retain(|v| seen.insert(*v));
            (edge, chain)
        })
        .collect()
}

/// The vertices inside each face that has any, without those along its sides.
fn inside(surfaces: &Surfaces, found: &Found, chains: &Chains) -> FxHashMap<u32, Vec<u32>> {
    let mut inside: FxHashMap<u32, Vec<u32>> = FxHashMap::default();
    for near in &found.in_faces {
        let sides = surfaces.triangles[near.triangle as usize].sides().map(sorted);
        let is_along = |edge: &Edge| chains.get(edge).is_some_and(|chain| chain.contains(&near.vertex));
        if !sides.iter().any(is_along) {
            inside.entry(near.triangle).or_default().push(near.vertex);
        }
    }
    inside.values_mut().for_each(|list| {
        list.sort_unstable();
        list.dedup();
    });
    inside
}

/// Faces with what is to become of them, and what has become of some.
struct Splitter<'a> {
    surfaces: &'a Surfaces,
    chains: &'a Chains,
    inside: &'a FxHashMap<u32, Vec<u32>>,
    /// Whether each face has vertices along its sides or inside.
    is_split: Vec<bool>,
    /// The faces near each face that is split.
    near: FxHashMap<u32, Vec<u32>>,
    /// The triangles of the faces that have been split.
    parts: FxHashMap<u32, Vec<[u32; 3]>>,
}

impl<'a> Splitter<'a> {
    fn new(
        surfaces: &'a Surfaces,
        chains: &'a Chains,
        inside: &'a FxHashMap<u32, Vec<u32>>,
        found: &Found,
    ) -> Self {
        let is_split = |t: u32| {
            let sides = surfaces.triangles[t as usize].sides().map(sorted);
            inside.contains_key(&t) || sides.iter().any(|side| chains.contains_key(side))
        };
        let is_split: Vec<bool> = (0..surfaces.triangles.len() as u32).map(is_split).collect();
        let mut near: FxHashMap<u32, Vec<u32>> = FxHashMap::default();
        for [x, y] in found.pairs.iter().flat_map(|&[s, t]| [[s, t], [t, s]]) {
            if is_split[x as usize] {
                near.entry(x).or_default().push(y);
            }
        }
        Self { surfaces, chains, inside, is_split, near, parts: FxHashMap::default() }
    }

    /// Splits the faces of a set that lies in one plane, all in one triangulation.
    fn split_together(&mut self, set: &[u32]) {
        // 1. All their points and edges, in the plane of the first.
        let seen = Projection::of(&self.surfaces.corners(set[0] as usize));
        let outlines: Vec<Vec<u32>> = set.iter().map(|&t| self.outline(t)).collect();
        let inside = set.iter().flat_map(|t| self.inside.get(t).into_iter().flatten().copied());
        let mut vertices: Vec<u32> = outlines.iter().flatten().copied().chain(inside).collect();
        vertices.sort_unstable();
        vertices.dedup();
        let local: FxHashMap<u32, u32> = vertices.iter().copied().zip(0..).collect();
        let points = self.project(&vertices, seen);
        let outlines: Vec<Vec<u32>> =
            outlines.iter().map(|outline| outline.iter().map(|v| local[v]).collect()).collect();
        let sides = |outline: &'_ Vec<u32>| -> Vec<[u32; 2]> {
            (0..outline.len()).map(|k| sorted([outline[k], outline[(k + 1) % outline.len()]])).collect()
        };
        let mut edges: Vec<[u32; 2]> = outlines.iter().flat_map(sides).collect();
        edges.sort_unstable();
        edges.dedup();
        // 2. What of the triangulation each face has; seen from behind it runs the other way round.
        let Some(overlay) = Overlay::new(&points, &edges) else { return };
        for (&t, mut outline) in set.iter().zip(outlines) {
            let corners = self.surfaces.corners(t as usize);
            let [a, b, c] = corners.map(|corner| seen.project(&corner));
            let is_behind = orient2d(a, b, c) == Sign::Negative;
            if is_behind {
                outline.reverse();
            }
            if let Some(parts) = overlay.inside(&points, &outline) {
                let turned = |[a, b, c]: [u32; 3]| if is_behind { [a, c, b] } else { [a, b, c] };
                let parts = parts.into_iter().map(|part| turned(part.map(|i| vertices[i as usize])));
                self.parts.insert(t, parts.collect());
            }
        }
    }

    /// Appends the triangles that a face becomes.
    fn split_face(&mut self, t: u32, triangles: &mut Vec<Triangle>) {
        let face = self.surfaces.triangles[t as usize];
        if self.is_split[t as usize] && !self.parts.contains_key(&t) {
            let parts = self.split_alone(t);
            self.parts.insert(t, parts);
        }
        match self.parts.get(&t) {
            Some(parts) => triangles.extend(parts.iter().map(|&corners| Triangle { corners, ..face })),
            None => triangles.push(face),
        }
    }

    /// The vertices along a side in its direction, both ends included.
    fn along(&self, [from, to]: [u32; 2]) -> SmallVec<[u32; 8]> {
        match self.chains.get(&sorted([from, to])) {
            None => [from, to].into_iter().collect(),
            Some(chain) if from < to => chain.iter().copied().collect(),
            Some(chain) => chain.iter().rev().copied().collect(),
        }
    }

    /// The vertices around a face.
    fn outline(&self, t: u32) -> Vec<u32> {
        let sides = self.surfaces.triangles[t as usize].sides().map(|side| self.along(side));
        sides.iter().flat_map(|side| side[..side.len() - 1].iter().copied()).collect()
    }

    fn project(&self, vertices: &[u32], seen: Projection) -> Vec<[f64; 2]> {
        vertices.iter().map(|&v| seen.project(&self.surfaces.positions[v as usize])).collect()
    }

    /// The triangles of a face with vertices along its sides and inside.
    fn split_alone(&self, t: u32) -> Vec<[u32; 3]> {
        let face = &self.surfaces.triangles[t as usize];
        // 1. The points in the plane.
        let outline = self.outline(t);
        let inside = self.inside.get(&t).map_or(&[][..], Vec::as_slice);
        let vertices: Vec<u32> = outline.iter().chain(inside).copied().collect();
        let local: FxHashMap<u32, u32> = vertices.iter().copied().zip(0..).collect();
        let points = self.project(&vertices, Projection::of(&self.surfaces.corners(t as usize)));
        // 2. Its sides, then the edges of near faces between its points: as they became, or will.
        let n = outline.len() as u32;
        let mut edges: Vec<[u32; 2]> = (0..n).map(|k| [k, (k + 1) % n]).collect();
        let mut add = |edge: Edge| {
            if let [Some(&u), Some(&v)] = edge.map(|v| local.get(&v)) {
                edges.push([u, v]);
            }
        };
        for near in self.near.get(&t).into_iter().flatten() {
            match self.parts.get(near) {
                Some(parts) => {
                    parts
                        .iter()
                        .for_each(|&[a, b, c]| [[a, b], [b, c], [c, a]].into_iter().for_each(&mut add));
                }
                None => {
                    for side in self.surfaces.triangles[*near as usize].sides() {
                        self.along(side).windows(2).for_each(|pair| add([pair[0], pair[1]]));
                    }
                }
            }
        }
        // 3. Filled; if the shape does not allow it, as a fan that leaves the inside out.
        let is_simple = local.len() == vertices.len();
        let overlay = if is_simple { Overlay::new(&points, &edges) } else { None };
        let all: Vec<u32> = (0..n).collect();
        match overlay.and_then(|overlay| overlay.inside(&points, &all)) {
            Some(parts) => parts.into_iter().map(|part| part.map(|i| vertices[i as usize])).collect(),
            None => {
                let sides = face.sides().map(|side| self.along(side));
                let between = |k: usize| &sides[k][1..sides[k].len() - 1];
                fan_around_splits(face.corners, [between(0), between(1), between(2)])
            }
        }
    }
}
