//! Limit surfaces of cages of polygons as triangles.
//!
//! Quads are subdivided until they are flat enough, each with the quads around it, which is all that its quarters depend on. A quad
//! that stays takes along its sides the points of finer neighbours.

use glam::DVec3;
use rustc_hash::FxHashMap;

use super::bound::distance;
use super::level::PolygonLevel;
use crate::subdivision::level::NONE;
use crate::{Error, Mesh};

/// How often a quad is split at most: then it is 1/4,096 as wide.
const MOST_STEPS: usize = 12;
/// Quads at most: two triangles each, and some 300 bytes while they are made.
const MOST_QUADS: usize = 1 << 24;

/// The limit surface over every quad of a level split `steps` times.
pub(crate) fn of_steps(level: PolygonLevel, points: Vec<DVec3>, steps: usize) -> Result<Mesh, Error> {
    Quadtree::new(level, points).grown(|step, _, _, _| step == steps)
}

/// The limit surface of a level of quads within a tolerance.
pub(crate) fn within(level: PolygonLevel, points: Vec<DVec3>, tolerance: f64) -> Result<Mesh, Error> {
    Quadtree::new(level, points).grown(|_, coarse, fine, q| distance(coarse, fine, q) <= tolerance)
}

/// A level with its points.
type Points<'l> = (&'l PolygonLevel, &'l [DVec3]);

/// A quad that is split no further.
struct Leaf {
    corners: [u32; 4],
    middle: DVec3,
}

/// Quads of many levels. Vertices have one number through all of them.
struct Quadtree {
    /// The quads that may have to be split, among others around them.
    level: PolygonLevel,
    points: Vec<DVec3>,
    numbers: Vec<u32>,
    active: Vec<u32>,
    leaves: Vec<Leaf>,
    /// The limits of corners of leaves.
    limits: Vec<Option<DVec3>>,
    /// Middles of edges of quads that were split, by the numbers of the ends, the lower first.
    middles: FxHashMap<[u32; 2], u32>,
}

impl Quadtree {
    fn new(level: PolygonLevel, points: Vec<DVec3>) -> Self {
        Self {
            numbers: (0..level.vertex_count as u32).collect(),
            active: (0..level.face_count() as u32).collect(),
            leaves: Vec::new(),
            limits: vec![None; level.vertex_count],
            middles: FxHashMap::default(),
            level,
            points,
        }
    }

    /// Splits quads until all are leaves by `is_leaf`, which knows how often a quad was split, its level and the next, and its number.
    fn grown(
        mut self,
        is_leaf: impl Fn(usize, Points<'_>, Points<'_>, usize) -> bool,
    ) -> Result<Mesh, Error> {
        for step in 0.. {
            if step > MOST_STEPS || self.leaves.len() + 4 * self.active.len() > MOST_QUADS {
                return Err(Error::TooLarge {
                    what: format!(
                        "a cage's limit surface, {} quads after {step} subdivisions; ask for a larger tolerance",
                        self.leaves.len() + self.active.len()
                    ),
                });
            }
            let (next, points) = self.level.refined(&self.points);
            let known = self.limits.len() as u32;
            let added = (next.vertex_count - self.level.vertex_count) as u32;
            self.limits.resize((known + added) as usize, None);
            let mut numbers = std::mem::take(&mut self.numbers);
            numbers.extend(known..known + added);
            let mut split = Vec::new();
            for q in std::mem::take(&mut self.active) {
                if is_leaf(step, (&self.level, &self.points), (&next, &points), q as usize) {
                    self.leaves.push(self.level.leaf(q, (&next, &points), &numbers, &mut self.limits));
                    continue;
                }
                for h in 4 * q..4 * q + 4 {
                    let ends = [self.level.from(h), self.level.to(h)].map(|v| numbers[v as usize]);
                    let middle = self.level.vertex_count as u32 + self.level.edge_of[h as usize];
                    self.middles.insert(sorted(ends), numbers[middle as usize]);
                    split.push(h);
                }
            }
            if split.is_empty() {
                return Ok(self.mesh());
            }
            self.take(next, points, numbers, split);
        }
        Ok(self.mesh())
    }

    /// Goes on with some quads of a level, and those around them.
    fn take(&mut self, level: PolygonLevel, points: Vec<DVec3>, numbers: Vec<u32>, quads: Vec<u32>) {
        let mut near = vec![false; level.vertex_count];
        quads.iter().flat_map(|&q| level.face(q as usize)).for_each(|&v| near[v as usize] = true);
        let kept: Vec<u32> = (0..level.face_count() as u32)
            .filter(|&q| level.face(q as usize).iter().any(|&v| near[v as usize]))
            .collect();
        if kept.len() == level.face_count() {
            (self.level, self.points, self.numbers, self.active) = (level, points, numbers, quads);
            return;
        }
        let (part, vertices) = level.part(&kept);
        // Both lists rise.
        let mut place = 0;
        self.active = quads
            .iter()
            .map(|&q| {
                while kept[place] != q {
                    place += 1;
                }
                place as u32
            })
            .collect();
        self.points = vertices.iter().map(|&v| points[v as usize]).collect();
        self.numbers = vertices.iter().map(|&v| numbers[v as usize]).collect();
        self.level = part;
    }

    /// Triangles of all leaves.
    fn mesh(self) -> Mesh {
        let Self { leaves, mut limits, middles, .. } = self;
        let mut triangles = Vec::with_capacity(2 * leaves.len());
        let mut outline = Vec::new();
        for leaf in &leaves {
            outline.clear();
            let mut corner_at = [0; 4];
            let mut finer = [false; 4];
            for k in 0..4 {
                corner_at[k] = outline.len();
                side([leaf.corners[k], leaf.corners[(k + 1) % 4]], &middles, &mut outline);
                finer[k] = outline.len() > corner_at[k] + 1;
            }
            let n = outline.len();
            if n == 4 {
                let at = |k: usize| limits[leaf.corners[k] as usize].unwrap_or_default();
                let turn = usize::from(at(1).distance(at(3)) < at(0).distance(at(2)));
                let corner = |k: usize| leaf.corners[(turn + k) % 4];
                triangles.extend([[corner(0), corner(1), corner(2)], [corner(0), corner(2), corner(3)]]);
                continue;
            }
            // A fan from a corner neither of whose sides has further points, or else from the middle.
            let free = (0..4).find(|&k| !finer[k] && !finer[(k + 3) % 4]);
            let (centre, start, count) = free
                .map_or((limits.len() as u32, 0, n), |k| (outline[corner_at[k]], corner_at[k] + 1, n - 2));
            if free.is_none() {
                limits.push(Some(leaf.middle));
            }
            let at = |i: usize| outline[(start + i) % n];
            triangles.extend((0..count).map(|i| [centre, at(i), at(i + 1)]));
        }
        // Only what is used, control vertices first.
        let mut names = vec![NONE; limits.len()];
        triangles.as_flattened().iter().for_each(|&v| names[v as usize] = 0);
        let mut positions = Vec::new();
        for (name, limit) in names.iter_mut().zip(&limits) {
            if *name != NONE {
                *name = positions.len() as u32;
                positions.push(limit.unwrap_or_default().to_array());
            }
        }
        triangles.as_flattened_mut().iter_mut().for_each(|v| *v = names[*v as usize]);
        Mesh::new(positions, triangles)
    }
}

impl PolygonLevel {
    /// A quad as a leaf, the limits of its corners noted by their numbers.
    fn leaf(
        &self,
        q: u32,
        (next, points): Points<'_>,
        numbers: &[u32],
        limits: &mut [Option<DVec3>],
    ) -> Leaf {
        let corners: [u32; 4] = std::array::from_fn(|k| self.corners[4 * q as usize + k]);
        for v in corners {
            limits[numbers[v as usize] as usize].get_or_insert_with(|| next.limit(v, points));
        }
        let middle = (self.vertex_count + self.edges.len()) as u32 + q;
        Leaf { corners: corners.map(|v| numbers[v as usize]), middle: next.limit(middle, points) }
    }

    /// Some quads of the level alone, in rising order, and its vertices. What is true of vertices whose quads are all there stays
    /// true.
    fn part(&self, quads: &[u32]) -> (Self, Vec<u32>) {
        let mut place_of = vec![NONE; self.face_count()];
        quads.iter().enumerate().for_each(|(place, &q)| place_of[q as usize] = place as u32);
        let (mut name_of, mut vertices) = (vec![NONE; self.vertex_count], Vec::new());
        let halves = 4 * quads.len();
        let mut part = Self {
            vertex_count: 0,
            corners: Vec::with_capacity(halves),
            starts: (0..=quads.len() as u32).map(|q| 4 * q).collect(),
            face_of: (0..halves as u32).map(|h| h / 4).collect(),
            twins: Vec::with_capacity(halves),
            edge_of: vec![NONE; halves],
            edges: Vec::with_capacity(halves / 2 + 1),
            sharpness: Vec::with_capacity(halves / 2 + 1),
            first: Vec::new(),
            sharp_corners: FxHashMap::default(),
        };
        for h in quads.iter().flat_map(|&q| 4 * q..4 * q + 4) {
            let v = self.from(h);
            if name_of[v as usize] == NONE {
                name_of[v as usize] = vertices.len() as u32;
                vertices.push(v);
            }
            part.corners.push(name_of[v as usize]);
            let twin = self.twins[h as usize];
            let there = if twin == NONE { NONE } else { place_of[twin as usize / 4] };
            let own = part.twins.len();
            part.twins.push(if there == NONE { NONE } else { 4 * there + twin % 4 });
            let other = part.twins[own] as usize;
            if there != NONE && other < own {
                part.edge_of[own] = part.edge_of[other];
                continue;
            }
            part.edge_of[own] = part.edges.len() as u32;
            part.edges.push(own as u32);
            let sharpness = self.sharpness[self.edge_of[h as usize] as usize];
            part.sharpness.push(if there == NONE { f64::INFINITY } else { sharpness });
        }
        part.vertex_count = vertices.len();
        for (&v, &sharpness) in &self.sharp_corners {
            if name_of[v as usize] != NONE {
                part.sharp_corners.insert(name_of[v as usize], sharpness);
            }
        }
        part.find_first();
        (part, vertices)
    }
}

fn sorted([u, v]: [u32; 2]) -> [u32; 2] {
    [u.min(v), u.max(v)]
}

/// The points along a side, from its first end on, without the other one.
fn side([from, to]: [u32; 2], middles: &FxHashMap<[u32; 2], u32>, outline: &mut Vec<u32>) {
    match middles.get(&sorted([from, to])) {
        Some(&middle) => {
            side([from, middle], middles, outline);
            side([middle, to], middles, outline);
        }
        None => outline.push(from),
    }
}
