//! Where patches meet: boundary curves compared in either direction, joined into shared edges, corners identified.

use super::surface::{Patch, PatchSide};
use crate::mesh::UnionFind;
use crate::parametric::curve::nurbs::NurbsCurve;
use crate::parametric::curve::nurbs_tools::rescaled_to_unit;
use crate::parametric::curve::param_curve::Curve;
use crate::parametric::error::{GeometryError, Result};
use crate::parametric::numeric::vector::{self, Point};

/// A boundary of a patch that meets no boundary of another (or of its own).
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Gap {
    /// Index of the patch, from 0.
    pub patch: usize,
    /// Which of its boundaries.
    pub side: PatchSide,
    /// Start and end of the open boundary (or of the open part between two creases).
    pub ends: [[f64; 3]; 2],
    /// Greatest distance from the boundary to the nearest other open boundary, and the place where it is so wide;
    /// `None` if there is no other.
    pub width: Option<(f64, [f64; 3])>,
}

impl std::fmt::Display for Gap {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "patch {}, {}, from {:?} to {:?}", self.patch, self.side, self.ends[0], self.ends[1])?;
        match &self.width {
            Some((width, place)) => write!(f, ", up to {width} from the nearest open boundary, at {place:?}"),
            None => write!(f, ", with no other open boundary"),
        }
    }
}

/// How the parameter of a patch's side follows from that of the shared edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Course {
    /// The same.
    Same,
    /// One minus it.
    Opposite,
    /// By the nearest point: the curves coincide but their parameters run differently. Reversed if true.
    Nearest(bool),
}

impl Course {
    /// Whether the side runs against the edge.
    pub(crate) fn is_reversed(self) -> bool {
        matches!(self, Self::Opposite | Self::Nearest(true))
    }
}

/// A boundary of one face.
#[derive(Clone, Debug)]
pub(crate) enum FaceSide {
    /// All of it is one point.
    Collapsed,
    /// It runs along a shared edge.
    Edge { edge: usize, course: Course },
}

/// A curve along which one or two faces lie.
#[derive(Clone, Debug)]
pub(crate) struct SharedEdge {
    pub(crate) curve: NurbsCurve<3>,
    /// Faces and the numbers of their sides.
    pub(crate) uses: Vec<(usize, usize)>,
}

/// Faces (smooth parts of patches) with their shared edges and corners.
#[derive(Clone, Debug)]
pub(crate) struct Joints {
    /// Sides of every face in the order of [`PatchSide::ALL`].
    pub(crate) sides: Vec<[FaceSide; 4]>,
    pub(crate) edges: Vec<SharedEdge>,
    /// For every face, the corner number of its corners (0,0), (1,0), (1,1), (0,1) of the unit square.
    pub(crate) corners: Vec<[usize; 4]>,
    /// Places of the corners.
    pub(crate) corner_places: Vec<Point<3>>,
    pub(crate) gaps: Vec<Gap>,
}

/// Corners at the start and the end of each side, in the order of [`PatchSide::ALL`].
const SIDE_CORNERS: [[usize; 2]; 4] = [[0, 1], [1, 2], [3, 2], [0, 3]];

/// One side as the comparison sees it.
struct Boundary {
    face: usize,
    side: usize,
    curve: NurbsCurve<3>,
    ends: [Point<3>; 2],
}

/// Joins the faces. `owner[i]` is the patch that face `i` is part of; boundaries within `tolerance` are one.
pub(crate) fn join(faces: &[Patch], owner: &[usize], tolerance: f64) -> Result<Joints> {
    let boundaries = collect_boundaries(faces, tolerance);
    let (edges, edge_of) = match_boundaries(&boundaries, owner, tolerance)?;
    let mut sides: Vec<[FaceSide; 4]> = vec![std::array::from_fn(|_| FaceSide::Collapsed); faces.len()];
    for (boundary, (edge, course)) in boundaries.iter().zip(edge_of) {
        sides[boundary.face][boundary.side] = FaceSide::Edge { edge, course };
    }
    let (corners, corner_places) = identify_corners(faces, &sides, &edges);
    let gaps = find_gaps(&edges, &boundaries, owner);
    Ok(Joints { sides, edges, corners, corner_places, gaps })
}

/// The sides of the faces that are not one point within `tolerance`.
fn collect_boundaries(faces: &[Patch], tolerance: f64) -> Vec<Boundary> {
    let mut boundaries = Vec::new();
    for (face, patch) in faces.iter().enumerate() {
        for (side, which) in PatchSide::ALL.into_iter().enumerate() {
            let curve = rescaled_to_unit(&patch.boundary(which));
            let control = curve.control();
            if control.iter().any(|p| vector::distance(*p, control[0]) > tolerance) {
                let ends = [control[0], control[control.len() - 1]];
                boundaries.push(Boundary { face, side, curve, ends });
            }
        }
    }
    boundaries
}

/// A shared edge, and how a boundary runs along it.
type OnEdge = (usize, Course);

/// The shared edges, and for every boundary its edge and how it runs along it.
fn match_boundaries(
    boundaries: &[Boundary],
    owner: &[usize],
    tolerance: f64,
) -> Result<(Vec<SharedEdge>, Vec<OnEdge>)> {
    let mut edges: Vec<SharedEdge> = Vec::new();
    let mut edge_of: Vec<Option<OnEdge>> = vec![None; boundaries.len()];
    // Boundaries that run along each other have near ends, whatever their direction: candidates are those whose lesser
    // end in x is within the tolerance.
    let least = |b: &Boundary| b.ends[0][0].min(b.ends[1][0]);
    let mut by_place: Vec<(f64, usize)> = boundaries.iter().map(least).zip(0..).collect();
    by_place.sort_by(|a, b| a.0.total_cmp(&b.0));
    let near_by = |x: f64| {
        let from = by_place.partition_point(|(key, _)| *key < x - tolerance);
        by_place[from..].iter().take_while(move |(key, _)| *key <= x + tolerance).map(|(_, index)| *index)
    };
    for (i, first) in boundaries.iter().enumerate() {
        if edge_of[i].is_some() {
            continue;
        }
        let mut mates: Vec<(usize, Course)> = near_by(least(first))
            .filter(|&j| j > i && edge_of[j].is_none())
            .filter_map(|j| find_course(first, &boundaries[j], tolerance).map(|course| (j, course)))
            .collect();
        mates.sort_by_key(|mate| mate.0);
        if mates.len() > 1 {
            let patches = [i].into_iter().chain(mates.iter().map(|m| m.0)).map(|b| owner[boundaries[b].face]);
            return Err(GeometryError::BoundaryShared {
                count: mates.len() + 1,
                patches: patches.collect(),
                place: first.curve.point(0.5),
            });
        }
        let edge = edges.len();
        edge_of[i] = Some((edge, Course::Same));
        let mut uses = vec![(first.face, first.side)];
        for &(j, course) in &mates {
            edge_of[j] = Some((edge, course));
            uses.push((boundaries[j].face, boundaries[j].side));
        }
        edges.push(SharedEdge { curve: first.curve.clone(), uses });
    }
    Ok((edges, edge_of.into_iter().flatten().collect()))
}

/// How `other` runs along `edge`, if it does.
fn find_course(edge: &Boundary, other: &Boundary, tolerance: f64) -> Option<Course> {
    let near = |a: Point<3>, b: Point<3>| vector::distance(a, b) <= tolerance;
    let [start, end] = edge.ends;
    let forward = near(start, other.ends[0]) && near(end, other.ends[1]);
    let backward = near(start, other.ends[1]) && near(end, other.ends[0]);
    if !(forward || backward) {
        return None;
    }
    let samples = comparison_parameters(&edge.curve, &other.curve);
    let runs = |reversed: bool| {
        samples.iter().all(|&t| {
            let mirrored = if reversed { 1.0 - t } else { t };
            near(edge.curve.point(t), other.curve.point(mirrored))
        })
    };
    if forward && runs(false) {
        return Some(Course::Same);
    }
    if backward && runs(true) {
        return Some(Course::Opposite);
    }
    // The same curve with another parameter: every sample has a near point on the other, and the other way round.
    let covers = |a: &NurbsCurve<3>, b: &NurbsCurve<3>| {
        samples.iter().all(|&t| {
            let p = a.point(t);
            near(p, b.point(nearest_parameter(b, p)))
        })
    };
    if covers(&edge.curve, &other.curve) && covers(&other.curve, &edge.curve) {
        return Some(Course::Nearest(!forward));
    }
    None
}

/// Parameters at which two curves are compared: enough in each of their pieces to distinguish polynomials of their
/// degrees.
fn comparison_parameters(a: &NurbsCurve<3>, b: &NurbsCurve<3>) -> Vec<f64> {
    let mut breaks: Vec<f64> = a.breaks();
    breaks.extend(b.breaks());
    breaks.extend(b.breaks().iter().map(|t| 1.0 - t));
    breaks.sort_by(f64::total_cmp);
    breaks.dedup();
    let count = 2 * (a.degree() + b.degree()) + 1;
    let at = |piece: &[f64], k: usize| vector::mix(piece[0], piece[1], k as f64 / count as f64);
    breaks.windows(2).flat_map(|piece| (1..=count).map(move |k| at(piece, k))).collect()
}

/// Parameter of the point of the curve (over 0..1) nearest to `p`.
pub(crate) fn nearest_parameter(curve: &NurbsCurve<3>, p: Point<3>) -> f64 {
    const SAMPLES: u32 = 64;
    let distance = |t: f64| vector::distance(curve.point(t), p);
    let nearest = (0..=SAMPLES)
        .map(|k| f64::from(k) / f64::from(SAMPLES))
        .min_by(|&s, &t| distance(s).total_cmp(&distance(t)))
        .unwrap_or(0.0);
    let step = 1.0 / f64::from(SAMPLES);
    let (mut low, mut high) = ((nearest - step).max(0.0), (nearest + step).min(1.0));
    // The foot of the perpendicular: the sign of (C - p) C' says on which side it lies.
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        let d = curve.derivatives(middle, 1);
        if vector::dot(vector::sub(d[0], p), d[1]) > 0.0 {
            high = middle;
        } else {
            low = middle;
        }
    }
    let foot = 0.5 * (low + high);
    [0.0, 1.0, foot].into_iter().min_by(|&s, &t| distance(s).total_cmp(&distance(t))).unwrap_or(foot)
}

/// Numbers the corners so that those joined through edges or collapsed sides are one.
fn identify_corners(
    faces: &[Patch],
    sides: &[[FaceSide; 4]],
    edges: &[SharedEdge],
) -> (Vec<[usize; 4]>, Vec<Point<3>>) {
    let mut sets = UnionFind::new(4 * faces.len());
    for (face, sides) in sides.iter().enumerate() {
        for (side, what) in sides.iter().enumerate() {
            let [start, end] = SIDE_CORNERS[side].map(|c| (4 * face + c) as u32);
            match what {
                FaceSide::Collapsed => sets.join(start, end),
                FaceSide::Edge { edge, course } => {
                    let (face0, side0) = edges[*edge].uses[0];
                    let [start0, end0] = SIDE_CORNERS[side0].map(|c| (4 * face0 + c) as u32);
                    let [start, end] = if course.is_reversed() { [end, start] } else { [start, end] };
                    sets.join(start0, start);
                    sets.join(end0, end);
                }
            }
        }
    }
    let mut number: Vec<Option<usize>> = vec![None; 4 * faces.len()];
    let mut places = Vec::new();
    let mut corners = Vec::new();
    for (face, patch) in faces.iter().enumerate() {
        corners.push(std::array::from_fn(|corner| {
            let root = sets.root((4 * face + corner) as u32) as usize;
            *number[root].get_or_insert_with(|| {
                let [i, j] = [[0, 0], [1, 0], [1, 1], [0, 1]][corner];
                let [rows, columns] = patch.counts;
                places.push(patch.points[i * (rows - 1) * columns + j * (columns - 1)]);
                places.len() - 1
            })
        }));
    }
    (corners, places)
}

/// The boundaries that met no other, with their distance to the nearest other such boundary.
fn find_gaps(edges: &[SharedEdge], boundaries: &[Boundary], owner: &[usize]) -> Vec<Gap> {
    const SAMPLES: u32 = 32;
    let open: Vec<&SharedEdge> = edges.iter().filter(|edge| edge.uses.len() == 1).collect();
    let polylines: Vec<Vec<Point<3>>> = open
        .iter()
        .map(|edge| (0..=SAMPLES).map(|k| edge.curve.point(f64::from(k) / f64::from(SAMPLES))).collect())
        .collect();
    let boxes: Vec<[Point<3>; 2]> = polylines
        .iter()
        .map(|line| vector::bounding_box(line.iter().copied()).unwrap_or([[0.0; 3]; 2]))
        .collect();
    let to_box = |p: Point<3>, [low, high]: [Point<3>; 2]| {
        vector::norm(std::array::from_fn::<f64, 3, _>(|k| (low[k] - p[k]).max(p[k] - high[k]).max(0.0)))
    };
    // Distance to the nearest polyline but the given one.
    let to_others = |p: Point<3>, own: usize| {
        (0..polylines.len()).filter(|&j| j != own).fold(f64::INFINITY, |best, j| {
            if to_box(p, boxes[j]) >= best {
                return best;
            }
            let edges = polylines[j].windows(2);
            edges.map(|e| vector::distance_to_segment(p, e[0], e[1])).fold(best, f64::min)
        })
    };
    let mut gaps = Vec::new();
    for (i, edge) in open.iter().enumerate() {
        let (face, side) = edge.uses[0];
        let widest = polylines[i].iter().map(|&p| (to_others(p, i), p)).max_by(|a, b| a.0.total_cmp(&b.0));
        let ends =
            boundaries.iter().find(|b| (b.face, b.side) == (face, side)).map_or([[0.0; 3]; 2], |b| b.ends);
        let width = widest.filter(|(width, _)| width.is_finite());
        gaps.push(Gap { patch: owner[face], side: PatchSide::ALL[side], ends, width });
    }
    gaps
}
