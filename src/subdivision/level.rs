//! One level of a subdivided cage: its faces, who is whose neighbour, and what is sharp.

use std::f64::consts::PI;

use rustc_hash::FxHashMap;
use smallvec::SmallVec;

use super::error::CageError;
use super::halves::{Halves, first_of_vertices};
use super::rules::{REGULAR_GAMMA, Rules};
use super::tags::{Corner, Crease, Sector, Tags};

/// No face, no edge, no half-edge.
pub(crate) const NONE: u32 = u32::MAX;

/// Half-edge h runs along face h / 3 from its corner h % 3 to the next.
pub(crate) fn next(h: u32) -> u32 {
    if h % 3 == 2 { h - 2 } else { h + 1 }
}

/// The half-edge before h in its face.
pub(crate) fn previous(h: u32) -> u32 {
    if h.is_multiple_of(3) { h + 2 } else { h - 1 }
}

/// How wide a sector opens, and how strongly it is flattened.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Opening {
    pub(crate) angle: f64,
    pub(crate) flatness: f64,
}

/// The usual sector at a corner: a quarter turn.
const CONVEX: Opening = Opening { angle: PI / 2.0, flatness: 0.0 };

/// The faces of a level with their neighbours and tags; positions are kept apart.
#[derive(Clone, Debug)]
pub(crate) struct Level {
    pub(crate) rules: Rules,
    pub(crate) faces: Vec<[u32; 3]>,
    pub(crate) vertex_count: usize,
    /// For each half-edge the one that runs back; [`NONE`] at a border.
    pub(crate) twins: Vec<u32>,
    /// For each half-edge its edge.
    pub(crate) edge_of: Vec<u32>,
    /// For each edge one of its half-edges, the lower one.
    pub(crate) edges: Vec<u32>,
    /// For each edge its sharpness: 0 smooth, infinite a crease. Borders are creases.
    pub(crate) sharpness: Vec<f64>,
    /// For each vertex a half-edge that leaves it, the first counter-clockwise at a border; [`NONE`] without faces.
    pub(crate) first: Vec<u32>,
    /// For each vertex whether it is a corner or has a sharp edge: most have neither, and need no look at their ring.
    pub(crate) has_sharp: Vec<bool>,
    pub(crate) corners: FxHashMap<u32, f64>,
    /// By corner and the other end of the sector's first crease.
    pub(crate) openings: FxHashMap<(u32, u32), Opening>,
}

/// What a vertex is, by what is sharp for ever around it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    Smooth,
    /// A crease ends here.
    Dart,
    Crease,
    Corner,
}

/// The neighbours of a vertex, counter-clockwise.
#[derive(Clone, Debug, Default)]
pub(crate) struct Ring {
    pub(crate) vertices: SmallVec<[u32; 12]>,
    pub(crate) edges: SmallVec<[u32; 12]>,
    /// Whether the last neighbour and the first share a face with the vertex.
    pub(crate) closed: bool,
}

impl Ring {
    /// How many faces there are.
    pub(crate) fn face_count(&self) -> usize {
        self.vertices.len() - usize::from(!self.closed)
    }
}

/// The faces around a vertex between two sharp edges: places in its ring from `start`, `faces` faces on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Span {
    pub(crate) start: usize,
    pub(crate) faces: usize,
    pub(crate) opening: Opening,
}

impl Level {
    /// A level from faces and tags, once found to be a surface.
    pub(crate) fn new(
        rules: Rules,
        vertex_count: usize,
        faces: Vec<[u32; 3]>,
        tags: &Tags,
    ) -> Result<Self, CageError> {
        let mut level = Self::of_faces(rules, vertex_count, faces)?;
        level.check_fans()?;
        level.set_tags(tags)?;
        Ok(level)
    }

    /// A level without tags but its borders. Indices are in range, corners of a face different.
    fn of_faces(rules: Rules, vertex_count: usize, faces: Vec<[u32; 3]>) -> Result<Self, CageError> {
        let ends =
            |h: u32| [faces[h as usize / 3][h as usize % 3], faces[h as usize / 3][next(h) as usize % 3]];
        let halves = Halves::paired(3 * faces.len(), ends, |h| h as usize / 3)?;
        let sharpness = halves.sharpness();
        let Halves { twins, edge_of, edges } = halves;
        let mut level = Self {
            rules,
            faces,
            vertex_count,
            twins,
            edge_of,
            edges,
            sharpness,
            first: Vec::new(),
            has_sharp: Vec::new(),
            corners: FxHashMap::default(),
            openings: FxHashMap::default(),
        };
        level.find_first();
        Ok(level)
    }

    /// Finds for each vertex the half-edge its ring begins with: the lowest, or that at a border.
    pub(crate) fn find_first(&mut self) {
        self.first = first_of_vertices(self.vertex_count, &self.twins, |h| self.from(h));
    }

    /// Notes which vertices have something sharp; to be called when tags are known.
    pub(crate) fn find_sharp(&mut self) {
        self.has_sharp = vec![false; self.vertex_count];
        for (e, &h) in self.edges.iter().enumerate() {
            if self.sharpness[e] > 0.0 {
                for v in [self.from(h), self.to(h)] {
                    self.has_sharp[v as usize] = true;
                }
            }
        }
        self.corners.keys().for_each(|&v| self.has_sharp[v as usize] = true);
    }

    /// Refuses vertices with several fans of faces.
    fn check_fans(&self) -> Result<(), CageError> {
        let mut faces_at = vec![0usize; self.vertex_count];
        self.faces.as_flattened().iter().for_each(|&v| faces_at[v as usize] += 1);
        for v in 0..self.vertex_count as u32 {
            if self.first[v as usize] != NONE && self.ring(v).face_count() != faces_at[v as usize] {
                return Err(CageError::VertexNotManifold { vertex: v });
            }
        }
        Ok(())
    }

    /// Takes over tags; their edges must be edges of the level.
    fn set_tags(&mut self, tags: &Tags) -> Result<(), CageError> {
        for &Crease { edge: [u, v], sharpness } in &tags.creases {
            let edge = self.edge_between(u, v).ok_or_else(|| {
                CageError::Tag(format!(
                    "crease {u}-{v} is no edge of a face (vertices counted from 0); take the tag out"
                ))
            })?;
            self.sharpness[edge as usize] = self.sharpness[edge as usize].max(sharpness);
        }
        self.corners = tags.corners.iter().map(|&Corner { vertex, sharpness }| (vertex, sharpness)).collect();
        for &Sector { vertex, first, angle, flatness } in &tags.sectors {
            self.openings.insert((vertex, first), Opening { angle, flatness });
        }
        self.find_sharp();
        Ok(())
    }

    /// The tags, as a cage keeps them; borders need none.
    pub(crate) fn tags(&self) -> Tags {
        let mut tags = Tags::default();
        for (e, &h) in self.edges.iter().enumerate() {
            if self.sharpness[e] > 0.0 && self.twins[h as usize] != NONE {
                tags.creases.push(Crease { edge: [self.from(h), self.to(h)], sharpness: self.sharpness[e] });
            }
        }
        tags.corners =
            self.corners.iter().map(|(&vertex, &sharpness)| Corner { vertex, sharpness }).collect();
        tags.sectors = self
            .openings
            .iter()
            .map(|(&(vertex, first), &Opening { angle, flatness })| Sector { vertex, first, angle, flatness })
            .collect();
        tags.normalised()
    }

    pub(crate) fn from(&self, h: u32) -> u32 {
        self.faces[h as usize / 3][h as usize % 3]
    }

    pub(crate) fn to(&self, h: u32) -> u32 {
        self.from(next(h))
    }

    /// The edge between two vertices.
    pub(crate) fn edge_between(&self, u: u32, v: u32) -> Option<u32> {
        if *self.first.get(u as usize)? == NONE {
            return None;
        }
        let ring = self.ring(u);
        let place = ring.vertices.iter().position(|&w| w == v)?;
        Some(ring.edges[place])
    }

    /// The first edge with a face on one side only.
    pub(crate) fn border(&self) -> Option<[u32; 2]> {
        let h = self.edges.iter().find(|&&h| self.twins[h as usize] == NONE)?;
        Some([self.from(*h), self.to(*h)])
    }

    /// The neighbours of a vertex that has faces.
    pub(crate) fn ring(&self, v: u32) -> Ring {
        let mut ring = Ring::default();
        let start = self.first[v as usize];
        if start == NONE {
            return ring;
        }
        let mut h = start;
        loop {
            ring.vertices.push(self.to(h));
            ring.edges.push(self.edge_of[h as usize]);
            let back = previous(h);
            let twin = self.twins[back as usize];
            if twin == start {
                ring.closed = true;
                return ring;
            }
            if twin == NONE {
                ring.vertices.push(self.from(back));
                ring.edges.push(self.edge_of[back as usize]);
                return ring;
            }
            h = twin;
        }
    }

    /// What the vertex with this ring is, by what is sharp for ever.
    pub(crate) fn kind(&self, v: u32, ring: &Ring) -> Kind {
        if self.corners.get(&v).is_some_and(|sharpness| sharpness.is_infinite()) {
            return Kind::Corner;
        }
        match ring.edges.iter().filter(|&&e| self.sharpness[e as usize].is_infinite()).count() {
            0 => Kind::Smooth,
            1 => Kind::Dart,
            2 => Kind::Crease,
            _ => Kind::Corner,
        }
    }

    /// The sector of a crease or corner vertex that holds the face after place `place` of its ring (before it, at the end of
    /// an open ring). Without two sharp edges: the whole ring.
    pub(crate) fn span(&self, v: u32, ring: &Ring, kind: Kind, place: usize) -> Span {
        let count = ring.vertices.len();
        let sharp = |i: usize| self.sharpness[ring.edges[i] as usize].is_infinite();
        let mut start = place.min(if ring.closed { count - 1 } else { count - 2 });
        let mut steps = 0;
        while !sharp(start) && steps < count {
            start = (start + count - 1) % count;
            steps += 1;
        }
        if steps == count {
            return Span {
                start: 0,
                faces: ring.face_count(),
                opening: Opening { angle: 2.0 * PI, flatness: 0.0 },
            };
        }
        let mut faces = 1;
        while faces < ring.face_count() && !sharp((start + faces) % count) {
            faces += 1;
        }
        let opening = match kind {
            Kind::Corner => self.openings.get(&(v, ring.vertices[start])).copied().unwrap_or(CONVEX),
            _ => Opening { angle: PI, flatness: 0.0 },
        };
        Span { start, faces, opening }
    }

    /// What the edge `e` takes at vertex `v` by its kind: gamma and the sector, if `v` is a crease or corner vertex with at
    /// least two sharp edges.
    pub(crate) fn special(&self, v: u32, e: u32) -> Option<(f64, Ring, Span, usize)> {
        if !self.has_sharp[v as usize] {
            return None;
        }
        let ring = self.ring(v);
        let kind = self.kind(v, &ring);
        if !matches!(kind, Kind::Crease | Kind::Corner) {
            return None;
        }
        let place = ring.edges.iter().position(|&other| other == e)?;
        let span = self.span(v, &ring, kind, place);
        if !ring.edges.iter().any(|&e| self.sharpness[e as usize].is_infinite()) {
            return Some((REGULAR_GAMMA, ring, span, 0));
        }
        let count = ring.vertices.len();
        let within = (place + count - span.start) % count;
        Some((self.rules.gamma(span.opening.angle, span.faces), ring, span, within))
    }

    /// Whether anything is sharp for a while only.
    pub(crate) fn is_semi_sharp(&self) -> bool {
        let finite = |sharpness: &f64| *sharpness > 0.0 && sharpness.is_finite();
        self.sharpness.iter().any(finite) || self.corners.values().any(finite)
    }
}
