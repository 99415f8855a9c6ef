//! One level of a cage of polygons: its faces, who is whose neighbour, and what is sharp.

use rustc_hash::FxHashMap;
use smallvec::SmallVec;

use crate::subdivision::error::CageError;
use crate::subdivision::halves::{Halves, first_of_vertices};
use crate::subdivision::level::{Kind, NONE};
use crate::subdivision::tags::{Corner, Crease, Tags};

/// The faces of a level with their neighbours and tags; positions are kept apart. Half-edge h runs from corner h to the next
/// one of its face.
#[derive(Clone, Debug)]
pub(crate) struct PolygonLevel {
    pub(crate) vertex_count: usize,
    /// The vertices of all faces, one face after the other.
    pub(crate) corners: Vec<u32>,
    /// For each face its first corner; one more at the end.
    pub(crate) starts: Vec<u32>,
    /// For each half-edge its face.
    pub(crate) face_of: Vec<u32>,
    /// For each half-edge the one that runs back; [`NONE`] at a border.
    pub(crate) twins: Vec<u32>,
    /// For each half-edge its edge.
    pub(crate) edge_of: Vec<u32>,
    /// For each edge one of its half-edges.
    pub(crate) edges: Vec<u32>,
    /// For each edge its sharpness: 0 smooth, infinite a crease. Borders are creases.
    pub(crate) sharpness: Vec<f64>,
    /// For each vertex a half-edge that leaves it, the first counter-clockwise at a border; [`NONE`] without faces.
    pub(crate) first: Vec<u32>,
    pub(crate) sharp_corners: FxHashMap<u32, f64>,
}

/// The half-edges that leave a vertex, counter-clockwise, and what they lead to.
#[derive(Clone, Debug, Default)]
pub(crate) struct Spokes {
    /// One for each face.
    pub(crate) halves: SmallVec<[u32; 8]>,
    /// Neighbours and edges: one more than faces at a border.
    pub(crate) vertices: SmallVec<[u32; 8]>,
    pub(crate) edges: SmallVec<[u32; 8]>,
}

impl PolygonLevel {
    /// A level from faces and tags, once found to be a surface. Indices are in range, corners of a face different.
    pub(crate) fn new(vertex_count: usize, faces: &[Vec<u32>], tags: &Tags) -> Result<Self, CageError> {
        let mut level = Self::of_faces(vertex_count, faces)?;
        level.check_fans()?;
        level.set_tags(tags)?;
        Ok(level)
    }

    fn of_faces(vertex_count: usize, faces: &[Vec<u32>]) -> Result<Self, CageError> {
        let corners = faces.concat();
        let (mut starts, mut face_of) = (vec![0], Vec::with_capacity(corners.len()));
        for (f, face) in faces.iter().enumerate() {
            face_of.extend(std::iter::repeat_n(f as u32, face.len()));
            starts.push(face_of.len() as u32);
        }
        // The half-edge after h in its face.
        let next = |h: u32| {
            let f = face_of[h as usize] as usize;
            if h + 1 == starts[f + 1] { starts[f] } else { h + 1 }
        };
        let ends = |h: u32| [h, next(h)].map(|h| corners[h as usize]);
        let halves = Halves::paired(corners.len(), ends, |h| face_of[h as usize] as usize)?;
        let sharpness = halves.sharpness();
        let Halves { twins, edge_of, edges } = halves;
        let mut level = Self {
            vertex_count,
            corners,
            starts,
            face_of,
            twins,
            edge_of,
            edges,
            sharpness,
            first: Vec::new(),
            sharp_corners: FxHashMap::default(),
        };
        level.find_first();
        Ok(level)
    }

    /// Finds for each vertex the half-edge its spokes begin with: the lowest, or that at a border.
    pub(crate) fn find_first(&mut self) {
        self.first = first_of_vertices(self.vertex_count, &self.twins, |h| self.from(h));
    }

    /// Refuses vertices with several fans of faces.
    fn check_fans(&self) -> Result<(), CageError> {
        let mut faces_at = vec![0usize; self.vertex_count];
        self.corners.iter().for_each(|&v| faces_at[v as usize] += 1);
        for v in 0..self.vertex_count as u32 {
            if self.first[v as usize] != NONE && self.spokes(v).halves.len() != faces_at[v as usize] {
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
        self.sharp_corners =
            tags.corners.iter().map(|&Corner { vertex, sharpness }| (vertex, sharpness)).collect();
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
            self.sharp_corners.iter().map(|(&vertex, &sharpness)| Corner { vertex, sharpness }).collect();
        tags.normalised()
    }

    pub(crate) fn face_count(&self) -> usize {
        self.starts.len() - 1
    }

    /// The vertices of a face.
    pub(crate) fn face(&self, f: usize) -> &[u32] {
        &self.corners[self.starts[f] as usize..self.starts[f + 1] as usize]
    }

    pub(crate) fn from(&self, h: u32) -> u32 {
        self.corners[h as usize]
    }

    pub(crate) fn to(&self, h: u32) -> u32 {
        self.corners[self.next(h) as usize]
    }

    /// The half-edge after h in its face.
    pub(crate) fn next(&self, h: u32) -> u32 {
        let f = self.face_of[h as usize] as usize;
        if h + 1 == self.starts[f + 1] { self.starts[f] } else { h + 1 }
    }

    /// The half-edge before h in its face.
    pub(crate) fn previous(&self, h: u32) -> u32 {
        let f = self.face_of[h as usize] as usize;
        if h == self.starts[f] { self.starts[f + 1] - 1 } else { h - 1 }
    }

    /// The edge between two vertices.
    fn edge_between(&self, u: u32, v: u32) -> Option<u32> {
        let spokes = self.spokes(u);
        let place = spokes.vertices.iter().position(|&w| w == v)?;
        Some(spokes.edges[place])
    }

    /// The first edge with a face on one side only.
    pub(crate) fn border(&self) -> Option<[u32; 2]> {
        let h = self.edges.iter().find(|&&h| self.twins[h as usize] == NONE)?;
        Some([self.from(*h), self.to(*h)])
    }

    /// What leaves a vertex; nothing if it has no faces.
    pub(crate) fn spokes(&self, v: u32) -> Spokes {
        let mut spokes = Spokes::default();
        let start = self.first[v as usize];
        let mut h = start;
        while h != NONE {
            spokes.halves.push(h);
            spokes.vertices.push(self.to(h));
            spokes.edges.push(self.edge_of[h as usize]);
            let back = self.previous(h);
            h = self.twins[back as usize];
            if h == NONE {
                spokes.vertices.push(self.from(back));
                spokes.edges.push(self.edge_of[back as usize]);
            } else if h == start {
                break;
            }
        }
        spokes
    }

    /// What a vertex is, if edges are as sharp as `sharp` says.
    pub(crate) fn kind(&self, spokes: &Spokes, corner: f64, sharp: impl Fn(f64) -> bool) -> Kind {
        if sharp(corner) {
            return Kind::Corner;
        }
        match spokes.edges.iter().filter(|&&e| sharp(self.sharpness[e as usize])).count() {
            0 => Kind::Smooth,
            1 => Kind::Dart,
            2 => Kind::Crease,
            _ => Kind::Corner,
        }
    }

    /// The sharpness of a vertex itself.
    pub(crate) fn corner(&self, v: u32) -> f64 {
        self.sharp_corners.get(&v).copied().unwrap_or(0.0)
    }

    /// The largest sharpness that ends some time; 0 if there is none.
    pub(crate) fn most_finite(&self) -> f64 {
        let all = self.sharpness.iter().chain(self.sharp_corners.values());
        all.copied().filter(|sharpness| sharpness.is_finite()).fold(0.0, f64::max)
    }
}
