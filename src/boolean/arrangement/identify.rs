//! Which points have become one: what the perturbation kept apart and correct rounding made equal.
//!
//! Points of one cut face with equal coordinates become one, everywhere. Points of faces that have nothing to do with each
//! other stay apart, even at the same place: bodies that touch are not glued.

use rustc_hash::FxHashMap;

use crate::Error;
use crate::boolean::arrangement::crossings::Crossings;
use crate::boolean::arrangement::cut_edges::CutEdges;
use crate::boolean::arrangement::cut_faces::{CutFace, CutFaces, UNCUT};
use crate::boolean::arrangement::plane_faces::PlaneFaces;
use crate::boolean::complex::operands::Operands;
use crate::mesh::{BitSet, SparseUnionFind};
use crate::parallel::Runner;

/// Up to this many points are compared pair by pair.
const FEW: usize = 12;

/// The classes of vertices and nodes that are one; only those that coincide with another are stored.
#[derive(Debug, Default)]
pub(crate) struct Identification {
    /// For every point that is not the lowest of its class, the lowest.
    parent: FxHashMap<u32, u32>,
    /// The points that are stored: most are told from them by this alone.
    stored: BitSet,
}

impl Identification {
    /// Identifies the points of every plane face that is cut, and those of every set of faces that are added up.
    pub(crate) fn new(
        operands: &Operands<'_>,
        crossings: &Crossings,
        edges: &CutEdges,
        faces: &[CutFaces; 2],
        plane_faces: &PlaneFaces,
        sheets: &[Vec<(usize, u32)>],
        runner: Runner<'_>,
    ) -> Result<Self, Error> {
        let mut classes = SparseUnionFind::default();
        let collect = |side: usize, face: &CutFace, points: &mut Vec<Point>| {
            collect_points(operands, side, face, &faces[side], crossings, edges, plane_faces, points);
        };
        for side in 0..2 {
            let all = &faces[side].faces;
            let pairs = runner.gather(all.len(), 1024, 0, |range, pairs| {
                let mut points = Vec::new();
                faces[side].for_each_place(
                    range,
                    side,
                    operands,
                    crossings,
                    edges,
                    |_| 0,
                    |place| {
                        if plane_faces.belongs_to_earlier(side, place) {
                            return;
                        }
                        points.clear();
                        for member in plane_faces.members(side, place) {
                            collect(side, &all[member as usize], &mut points);
                        }
                        coincidences(&mut points, pairs);
                    },
                );
            })?;
            for [u, v] in pairs {
                classes.join(u, v);
            }
        }
        for sheet in sheets {
            let (mut points, mut pairs) = (Vec::new(), Vec::new());
            for &(side, triangle) in sheet {
                if let Some(face) = faces[side].face(triangle) {
                    collect(side, &face, &mut points);
                }
            }
            coincidences(&mut points, &mut pairs);
            for [u, v] in pairs {
                classes.join(u, v);
            }
        }
        if classes.is_empty() {
            return Ok(Self::default());
        }
        let parent = classes.into_roots();
        let mut stored = BitSet::new(operands.vertex_count() as usize + edges.positions.len());
        parent.keys().for_each(|&point| stored.insert(point));
        Ok(Self { parent, stored })
    }

    /// Whether every point is its own.
    pub(crate) fn is_empty(&self) -> bool {
        self.parent.is_empty()
    }

    /// The point that stands for a point: the lowest number of its class.
    #[inline]
    pub(crate) fn representative(&self, point: u32) -> u32 {
        if self.parent.is_empty() || !self.stored.contains(point) {
            return point;
        }
        self.parent.get(&point).copied().unwrap_or(point)
    }

    /// All points that another stands for, in no particular order.
    pub(crate) fn identified(&self) -> impl Iterator<Item = u32> {
        self.parent.keys().copied()
    }

    /// All points that stand for others, ascending.
    pub(crate) fn representatives(&self) -> Vec<u32> {
        let mut all: Vec<u32> = self.parent.values().copied().collect();
        all.sort_unstable();
        all.dedup();
        all
    }
}

/// A point's number and where it is.
type Point = (u32, [f64; 3]);

/// Appends the corners and nodes of a face that are not dropped.
fn collect_points(
    operands: &Operands<'_>,
    side: usize,
    face: &CutFace,
    faces: &CutFaces,
    crossings: &Crossings,
    edges: &CutEdges,
    plane_faces: &PlaneFaces,
    points: &mut Vec<Point>,
) {
    let first_node = operands.vertex_count();
    points.extend(operands.corners(side, face.triangle).map(|corner| (corner.id, corner.position)));
    let mut add = |node: u32| {
        if !plane_faces.is_dropped(node) {
            points.push((first_node + node, edges.positions[node as usize]));
        }
    };
    for edge in face.edges {
        if edge != UNCUT {
            edges.nodes(edge).iter().for_each(|&node| add(node));
        }
    }
    for &segment in faces.segments(face) {
        let segment = &crossings.segments[segment as usize];
        // Inner nodes are crossings of edges of the other operand; each is the tail of one segment and the head of another.
        if crossings.side_of_node(segment.tail) != side {
            add(segment.tail);
        }
    }
}

/// Appends pairs of points that have equal coordinates; enough of them to join all.
fn coincidences(points: &mut [Point], pairs: &mut Vec<[u32; 2]>) {
    if points.len() <= FEW {
        for i in 1..points.len() {
            for j in 0..i {
                if points[i].1 == points[j].1 && points[i].0 != points[j].0 {
                    pairs.push([points[j].0, points[i].0]);
                }
            }
        }
        return;
    }
    let key = |point: &Point| (point.1.map(|x| (x + 0.0).to_bits()), point.0);
    points.sort_unstable_by_key(key);
    for pair in points.windows(2) {
        if pair[0].1 == pair[1].1 && pair[0].0 != pair[1].0 {
            pairs.push([pair[0].0, pair[1].0]);
        }
    }
}
