//! Triangles without area, all those of one line at once.
//!
//! As long as the patch is a sum of triangles, a triangle without area only says that its longest side is the other two
//! together. So along every line that such triangles lie on, every edge gets the vertices between its ends; the triangles
//! without area then have no boundary left, and go.

use rustc_hash::{FxHashMap, FxHashSet};

use super::face::{Edge, LocalFace, LocalPoint, edge_between};
use super::flatness::is_exactly_flat;
use super::patch::Patch;
use super::snap::{pairs_at_one_place, snap_pairs};
use super::split_faces::split_faces;
use super::splits::Splits;
use crate::exact::collinear;
use crate::mesh::{BitSet, UnionFind};

/// Rounds at most: points that become one, and faces that are split, may leave further triangles without area. A round
/// removes all there are, so the bound is for time alone; the chain step takes what is left.
const MOST_ROUNDS: usize = 8;

/// Removes the triangles without area all of whose corners are complete. Those of one plane whose sides get vertices are
/// triangulated together if `merge` says so.
pub(super) fn remove_flat_by_line(patch: &mut Patch<'_>, merge: bool) {
    for _ in 0..MOST_ROUNDS {
        // No triangle has a corner twice then.
        patch.cancel();
        let flats = removable_flats(patch);
        if flats.is_empty() {
            return;
        }
        let lines = Lines::of(patch, &flats);
        if !lines.coincident.is_empty() {
            snap_pairs(patch, &lines.coincident);
            continue;
        }
        flats.iter().for_each(|&face| patch.drop_face(face));
        let splits = lines.splits(patch);
        split_faces(patch, &splits, merge);
    }
    if !removable_flats(patch).is_empty() {
        patch.count_stop();
    }
}

/// The faces without area all of whose corners are complete.
fn removable_flats(patch: &Patch<'_>) -> Vec<LocalFace> {
    let has_no_area = patch.face_numbers().filter(|&face| is_exactly_flat(patch, face));
    has_no_area.filter(|&face| patch[face].corners.iter().all(|&point| patch.is_complete(point))).collect()
}

/// Lines with the points on them.
struct Lines {
    /// For each line its points, from one end to the other.
    points: Vec<Vec<LocalPoint>>,
    /// The lines through a point.
    through: FxHashMap<LocalPoint, Vec<u32>>,
    /// Pairs of points of a line at the same place.
    coincident: Vec<(LocalPoint, LocalPoint)>,
}

impl Lines {
    /// The lines that some triangles without area lie on.
    fn of(patch: &Patch<'_>, flats: &[LocalFace]) -> Self {
        let mut line_of = group_by_line(patch, flats);
        // The points of each line.
        let mut members: Vec<(u32, LocalPoint)> = (0..flats.len())
            .flat_map(|place| {
                let line = line_of.root(place as u32);
                patch[flats[place]].corners.map(|point| (line, point))
            })
            .collect();
        members.sort_unstable();
        members.dedup();
        let mut lines = Self { points: Vec::new(), through: FxHashMap::default(), coincident: Vec::new() };
        for group in members.chunk_by(|x, y| x.0 == y.0) {
            let mut points: Vec<LocalPoint> = group.iter().map(|entry| entry.1).collect();
            points.sort_unstable_by(|&u, &v| compare_on_line(patch, u, v));
            lines.coincident.extend(pairs_at_one_place(patch, &points));
            for &point in &points {
                lines.through.entry(point).or_default().push(lines.points.len() as u32);
            }
            lines.points.push(points);
        }
        lines
    }

    /// The edges with points between their ends; these from the edge's lower number to the higher one.
    fn splits(&self, patch: &Patch<'_>) -> Splits {
        let mut splits = Splits::new(patch);
        // Most points are on none of the lines.
        let mut is_on_line = BitSet::new(patch.point_count());
        self.through.keys().for_each(|point| is_on_line.insert(point.0));
        let mut seen: FxHashSet<Edge> = FxHashSet::default();
        for (_, face) in patch.faces() {
            for (u, v) in face.sides() {
                if !is_on_line.contains(u.0) || !is_on_line.contains(v.0) {
                    continue;
                }
                let Some(line) = self.common_line(u, v) else { continue };
                let edge = edge_between(u, v);
                if !seen.insert(edge) {
                    continue;
                }
                let between = self.points_between(patch, line, edge);
                if !between.is_empty() {
                    splits.insert(edge, between);
                }
            }
        }
        splits
    }

    /// The line through two points, if there is one.
    fn common_line(&self, u: LocalPoint, v: LocalPoint) -> Option<u32> {
        let (of_u, of_v) = (self.through.get(&u)?, self.through.get(&v)?);
        of_u.iter().find(|line| of_v.contains(line)).copied()
    }

    /// The points of a line between two of its points, from the first one to the second one.
    fn points_between(&self, patch: &Patch<'_>, line: u32, (u, v): Edge) -> Vec<LocalPoint> {
        let points = &self.points[line as usize];
        let rank = |point: LocalPoint| points.binary_search_by(|&other| compare_on_line(patch, other, point));
        let (Ok(from), Ok(to)) = (rank(u), rank(v)) else { return Vec::new() };
        let mut between = points[from.min(to) + 1..from.max(to)].to_vec();
        if from > to {
            between.reverse();
        }
        between
    }
}

/// Triangles without area by line: two are of the same line if they have a point in common, and lie on one line.
fn group_by_line(patch: &Patch<'_>, flats: &[LocalFace]) -> UnionFind {
    let corners = |place: usize| patch[flats[place]].corners;
    let ends: Vec<[LocalPoint; 2]> = (0..flats.len())
        .map(|place| {
            let mut sorted = corners(place);
            sorted.sort_unstable_by(|&u, &v| compare_on_line(patch, u, v));
            [sorted[0], sorted[2]]
        })
        .collect();
    let mut at_points: Vec<(LocalPoint, usize)> =
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
            let same = first_of_line.iter().find(|&&other| are_on_one_line(patch, ends[place], ends[other]));
            match same {
                Some(&other) => line_of.join(place as u32, other as u32),
                None => first_of_line.push(place),
            }
        }
    }
    line_of
}

/// The order of points along any line: by coordinates, then by number.
fn compare_on_line(patch: &Patch<'_>, u: LocalPoint, v: LocalPoint) -> std::cmp::Ordering {
    let key = |point: LocalPoint| patch.position(point).map(|x| x + 0.0);
    let (p, q) = (key(u), key(v));
    let by_coordinates = p.iter().zip(&q).map(|(x, y)| x.total_cmp(y)).find(|order| order.is_ne());
    by_coordinates.unwrap_or(u.cmp(&v))
}

/// Whether two segments lie on one line.
fn are_on_one_line(patch: &Patch<'_>, x: [LocalPoint; 2], y: [LocalPoint; 2]) -> bool {
    let ([p, q], ends) = (x.map(|end| patch.position(end)), y.map(|end| patch.position(end)));
    ends.iter().all(|end| collinear(p, q, end))
}
