//! Triangles without area, all those of one line at once.
//!
//! As long as the patch is a sum of triangles, a triangle without area only says that its longest side is the other two
//! together. So along every line that such triangles lie on, every edge gets the vertices between its ends; the triangles
//! without area then have nothing left for a boundary, and go.

use rustc_hash::{FxHashMap, FxHashSet};

use super::patch::Patch;
use super::split_faces::{Edge, Splits, split_faces};
use super::zero_area::{identify, is_exactly_flat};
use crate::boolean::complex::Complex;
use crate::exact::collinear;
use crate::mesh::BitSet;
use crate::mesh::Surface;
use crate::mesh::UnionFind;

/// Rounds: points that become one may leave further triangles without area.
const ROUNDS: usize = 8;

/// Removes the triangles without area all of whose corners are complete.
pub(super) fn straighten(patch: &mut Patch<'_>, planes: Option<&Complex<'_>>) {
    for _ in 0..ROUNDS {
        // No triangle has a corner twice then.
        patch.cancel();
        let flats: Vec<u32> = (0..patch.faces.len() as u32)
            .filter(|&index| is_exactly_flat(patch, index))
            .filter(|&index| {
                patch.faces[index as usize].corners.iter().all(|&point| patch.is_complete(point))
            })
            .collect();
        if flats.is_empty() {
            return;
        }
        let lines = Lines::new(patch, &flats);
        if !lines.coincident.is_empty() {
            identify(patch, &lines.coincident);
            continue;
        }
        for &index in &flats {
            patch.faces[index as usize].alive = false;
        }
        let splits = lines.splits(patch);
        split_faces(patch, &splits, planes);
    }
}

/// Lines with the points on them.
struct Lines {
    /// For each line its points, from one end to the other.
    points: Vec<Vec<u32>>,
    /// The lines through a point.
    through: FxHashMap<u32, Vec<u32>>,
    /// Pairs of points of a line at the same place.
    coincident: Vec<(u32, u32)>,
}

impl Lines {
    /// Triangles belong to the same line if they have a point in common, and lie on one line.
    fn new(patch: &Patch<'_>, flats: &[u32]) -> Self {
        let corners = |place: usize| patch.faces[flats[place] as usize].corners;
        let ends: Vec<[u32; 2]> = (0..flats.len())
            .map(|place| {
                let mut sorted = corners(place);
                sorted.sort_unstable_by(|&u, &v| along(patch, u, v));
                [sorted[0], sorted[2]]
            })
            .collect();
        let mut at_points: Vec<(u32, usize)> =
            (0..flats.len()).flat_map(|place| corners(place).map(|point| (point, place))).collect();
        at_points.sort_unstable();
        let mut line_of = UnionFind::new(flats.len());
        for group in at_points.chunk_by(|x, y| x.0 == y.0) {
            // One triangle of each line through this point.
            let mut first_of_line: Vec<usize> = Vec::new();
            for &(_, place) in group {
                if patch.position(ends[place][0]) == patch.position(ends[place][1]) {
                    continue;
                }
                let same = first_of_line.iter().find(|&&other| on_one_line(patch, ends[place], ends[other]));
                match same {
                    Some(&other) => line_of.join(place as u32, other as u32),
                    None => first_of_line.push(place),
                }
            }
        }
        let mut members: Vec<(u32, u32)> = (0..flats.len())
            .flat_map(|place| {
                let line = line_of.root(place as u32);
                corners(place).map(|point| (line, point))
            })
            .collect();
        members.sort_unstable();
        members.dedup();
        let mut result = Self { points: Vec::new(), through: FxHashMap::default(), coincident: Vec::new() };
        for group in members.chunk_by(|x, y| x.0 == y.0) {
            let mut points: Vec<u32> = group.iter().map(|entry| entry.1).collect();
            points.sort_unstable_by(|&u, &v| along(patch, u, v));
            let same_place = |pair: &&[u32]| patch.position(pair[0]) == patch.position(pair[1]);
            result.coincident.extend(points.windows(2).filter(same_place).map(|pair| (pair[0], pair[1])));
            for &point in &points {
                result.through.entry(point).or_default().push(result.points.len() as u32);
            }
            result.points.push(points);
        }
        result
    }

    /// The edges with points between their ends; these from the edge's lower number to the higher one.
    fn splits(&self, patch: &Patch<'_>) -> Splits {
        let mut splits = Splits::new(patch);
        // Most points are on none of the lines.
        let mut is_on_line = BitSet::new(patch.point_count());
        self.through.keys().for_each(|&point| is_on_line.insert(point));
        let mut seen: FxHashSet<Edge> = FxHashSet::default();
        for face in patch.faces.iter().filter(|face| face.alive) {
            for k in 0..3 {
                let (u, v) = (face.corners[k], face.corners[(k + 1) % 3]);
                if !is_on_line.contains(u) || !is_on_line.contains(v) {
                    continue;
                }
                let (Some(of_u), Some(of_v)) = (self.through.get(&u), self.through.get(&v)) else { continue };
                let Some(line) = of_u.iter().find(|line| of_v.contains(line)) else { continue };
                let edge = (u.min(v), u.max(v));
                if !seen.insert(edge) {
                    continue;
                }
                let points = &self.points[*line as usize];
                let rank = |point: u32| points.binary_search_by(|&other| along(patch, other, point));
                let (Ok(from), Ok(to)) = (rank(edge.0), rank(edge.1)) else { continue };
                let mut between = points[from.min(to) + 1..from.max(to)].to_vec();
                if from > to {
                    between.reverse();
                }
                if !between.is_empty() {
                    splits.insert(edge, between);
                }
            }
        }
        splits
    }
}

/// The order of points along any line: by coordinates, then by number.
fn along(patch: &Patch<'_>, u: u32, v: u32) -> std::cmp::Ordering {
    let key = |point: u32| patch.position(point).map(|x| x + 0.0);
    let (p, q) = (key(u), key(v));
    let by_coordinates = p.iter().zip(&q).map(|(x, y)| x.total_cmp(y)).find(|order| order.is_ne());
    by_coordinates.unwrap_or(u.cmp(&v))
}

/// Whether two segments lie on one line.
fn on_one_line(patch: &Patch<'_>, x: [u32; 2], y: [u32; 2]) -> bool {
    let ([p, q], ends) = (x.map(|end| patch.position(end)), y.map(|end| patch.position(end)));
    ends.iter().all(|end| collinear(p, q, end))
}
