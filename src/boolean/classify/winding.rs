//! How often the other operand winds round each vertex (kept apart by the intersection curve; step 2 of Vyatkin 2019
//! decides "which parts to throw away").
//!
//! Along an edge of A the winding number of B changes by one at every crossing, so one value per connected component of A
//! gives all: 0 for a component with a vertex outside B's box, else the signed count of crossings of a ray, by the same exact
//! predicate. Vertices in a region of the coarse grid that B does not pass (`overlap`) are one to begin with.

use crate::Error;
use crate::boolean::arrangement::crossings::Crossings;
use crate::boolean::arrangement::cut_edges::CutEdges;
use crate::boolean::arrangement::cut_faces::{CutFaces, UNCUT};
use crate::boolean::candidates::overlap::{Overlap, Place};
use crate::boolean::complex::operands::{Corner, Operand, Operands};
use crate::mesh::Bounds;
use crate::parallel::Runner;
use crate::spatial::{BoxTree, Frame, Regions};

/// From this many box tests on, and this many rays, a tree is built for them.
const TREE_FROM: usize = 1 << 20;
const TREE_FROM_RAYS: usize = 16;

/// The winding number of the other operand round each vertex of `side`. `bounds` is the other operand's box, outside which
/// all have 0.
pub(crate) fn of_vertices(
    operands: &Operands<'_>,
    side: usize,
    overlap: &Overlap,
    bounds: &Bounds,
    crossings: &Crossings,
    edges: &CutEdges,
    faces: &CutFaces,
    runner: Runner<'_>,
) -> Result<Vec<i32>, Error> {
    let operand = &operands.sides[side];
    let first = operands.first_vertex(side);
    let places = &overlap.places[side];
    if places.is_empty() {
        return Ok(vec![0; operand.positions.len()]);
    }
    let mut classes = WindingClasses::new(places, &overlap.regions[side]);
    let mut next_cut = faces.faces.iter();
    for &triangle in operands.near(side) {
        let corners = operand.triangles[triangle as usize];
        if !faces.is_cut(triangle) {
            classes.join(corners[0], corners[1], 0);
            classes.join(corners[1], corners[2], 0);
            continue;
        }
        let face = next_cut.next().expect("cut faces are near, and ascending");
        for k in 0..3 {
            if face.edges[k] == UNCUT {
                classes.join(corners[k], corners[(k + 1) % 3], 0);
            }
        }
    }
    for (index, edge) in edges.edges.iter().enumerate() {
        if operands.side_of(edge.low) == side {
            let change: i32 = edges
                .nodes(index as u32)
                .iter()
                .map(|&node| if crossings.nodes[node as usize].leaves { -1 } else { 1 })
                .sum();
            classes.join(edge.low - first, edge.high - first, change);
        }
    }
    let seeds = classes.unsettled();
    let values = cast_rays(operands, side, &seeds, bounds, runner)?;
    for (&seed, value) in seeds.iter().zip(values) {
        classes.settle(seed, value);
    }
    Ok(classes.values())
}

/// Union-find over the vertices of one operand and the regions of the coarse grid, with the difference of winding numbers to
/// the parent. Vertices in a region, or outside the other operand's box, are not told apart.
struct WindingClasses<'a> {
    places: &'a [Place],
    regions: &'a Regions,
    /// Vertices, then regions, then one entry for all that is outside. 0 for a root, else one more than the parent: memory
    /// that starts as zeros costs nothing until it is used.
    parent: Vec<u32>,
    offset: Vec<i32>,
}

impl<'a> WindingClasses<'a> {
    fn new(places: &'a [Place], regions: &'a Regions) -> Self {
        let count = places.len() + usize::from(regions.count()) + 1;
        Self { places, regions, parent: vec![0; count], offset: vec![0; count] }
    }

    fn outside(&self) -> u32 {
        self.parent.len() as u32 - 1
    }

    /// The entry that stands for a vertex.
    #[inline]
    fn entry(&self, v: u32) -> u32 {
        let place = self.places[v as usize];
        if place.is_outside() {
            return self.outside();
        }
        match self.regions.of_cell(place.cell()) {
            Regions::PASSED => v,
            region => self.places.len() as u32 + u32::from(region),
        }
    }

    /// The representative of an entry, and the entry's value relative to it.
    #[inline]
    fn find(&mut self, mut v: u32) -> (u32, i32) {
        let mut sum = 0;
        loop {
            let parent = self.parent[v as usize];
            if parent == 0 {
                return (v, sum);
            }
            let grandparent = self.parent[parent as usize - 1];
            // Path halving.
            if grandparent != 0 {
                self.offset[v as usize] += self.offset[parent as usize - 1];
                self.parent[v as usize] = grandparent;
            }
            sum += self.offset[v as usize];
            v = self.parent[v as usize] - 1;
        }
    }

    /// Records that the value of vertex `v` is that of `u` plus `change`.
    #[inline]
    fn join(&mut self, u: u32, v: u32, change: i32) {
        let (u, v) = (self.entry(u), self.entry(v));
        let ((root_u, value_u), (root_v, value_v)) = (self.find(u), self.find(v));
        if root_u == root_v {
            debug_assert_eq!(value_v - value_u, change, "signed crossings round a closed path cancel");
            return;
        }
        // value(root_v) = value(root_u) + value_u + change - value_v. Of two vertices the lower stays above; regions and
        // the outside stay above both.
        let difference = value_u + change - value_v;
        let is_vertex = |entry: u32| (entry as usize) < self.places.len();
        if (is_vertex(root_v) && !is_vertex(root_u))
            || (is_vertex(root_u) == is_vertex(root_v) && root_u < root_v)
        {
            self.parent[root_v as usize] = root_u + 1;
            self.offset[root_v as usize] = difference;
        } else {
            self.parent[root_u as usize] = root_v + 1;
            self.offset[root_u as usize] = -difference;
        }
    }

    /// One vertex of every component that no outside vertex belongs to, ascending.
    fn unsettled(&mut self) -> Vec<u32> {
        let (outside, _) = self.find(self.outside());
        let mut seen = rustc_hash::FxHashSet::from_iter([outside]);
        let mut seen_regions = vec![false; usize::from(self.regions.count())];
        let mut seeds = Vec::new();
        for v in 0..self.places.len() as u32 {
            let entry = self.entry(v);
            let is_new = match (entry as usize).checked_sub(self.places.len()) {
                // Nearly all vertices: one look at a small table.
                Some(region) => {
                    seen_regions.get_mut(region).is_some_and(|seen| !std::mem::replace(seen, true))
                }
                None => true,
            };
            if is_new {
                let (root, _) = self.find(entry);
                if seen.insert(root) {
                    seeds.push(v);
                }
            }
        }
        seeds
    }

    /// Fixes the value of a vertex, and so of its component.
    fn settle(&mut self, v: u32, value: i32) {
        let (outside, outside_value) = self.find(self.outside());
        let (root, relative) = self.find(self.entry(v));
        self.parent[root as usize] = outside + 1;
        // value(v) - value(outside) = relative + offset - outside_value, and outside has 0.
        self.offset[root as usize] = value - relative + outside_value;
    }

    fn values(mut self) -> Vec<i32> {
        let (_, outside_value) = self.find(self.outside());
        let first_region = self.places.len() as u32;
        let of_region: Vec<i32> = (0..u32::from(self.regions.count()))
            .map(|region| self.find(first_region + region).1 - outside_value)
            .collect();
        (0..self.places.len() as u32)
            .map(|v| {
                let place = self.places[v as usize];
                if place.is_outside() {
                    return 0;
                }
                match self.regions.of_cell(place.cell()) {
                    Regions::PASSED => self.find(v).1 - outside_value,
                    region => of_region[usize::from(region)],
                }
            })
            .collect()
    }
}

/// The winding numbers of the other operand round some vertices of `side`, by rays in +x.
fn cast_rays(
    operands: &Operands<'_>,
    side: usize,
    seeds: &[u32],
    bounds: &Bounds,
    runner: Runner<'_>,
) -> Result<Vec<i32>, Error> {
    let other = &operands.sides[1 - side];
    let end_x = beyond(bounds.low[0], bounds.high[0]);
    let ray = |index: usize| {
        let start = operands.corner(operands.first_vertex(side) + seeds[index]);
        let end = Corner {
            id: operands.vertex_count() + index as u32,
            position: [end_x, start.position[1], start.position[2]],
        };
        (start, end)
    };
    if seeds.len() * other.triangles.len() < TREE_FROM || seeds.len() < TREE_FROM_RAYS {
        return Ok(runner.pieces(seeds.len(), 1, |range| {
            let (start, end) = ray(range.start);
            let beside = Beside::new(other, &start);
            let meeting = (0..other.triangles.len() as u32).filter(|&t| beside.may_meet(other, t, &start));
            meeting.map(|t| ray_crossing(operands, 1 - side, t, &start, &end)).sum()
        })?);
    }
    let frame = Frame::of(bounds.low, bounds.high);
    let all: Vec<u32> = (0..other.triangles.len() as u32).collect();
    let box_of = |t: u32| frame.triangle(other.triangles[t as usize].map(|v| &other.positions[v as usize]));
    let tree = BoxTree::new(&all, box_of);
    Ok(runner.pieces(seeds.len(), 1, |range| {
        let (start, end) = ray(range.start);
        let query = frame.triangle([&start.position, &start.position, &end.position]);
        let mut sum = 0;
        tree.meeting(&query, |t| sum += ray_crossing(operands, 1 - side, t, &start, &end));
        sum
    })?)
}

/// A coordinate beyond an interval.
pub(crate) fn beyond(low: f64, high: f64) -> f64 {
    let end = high + (high - low);
    if end.is_finite() && end > high { end } else { high.next_up().min(f64::MAX) }
}

/// On which sides of a ray in +x the vertices of an operand lie.
struct Beside(Vec<u8>);

impl Beside {
    /// From so many triangles on, every vertex is looked at once instead of once for each of its triangles.
    const FROM: usize = 256;

    fn new(operand: &Operand<'_>, start: &Corner) -> Self {
        if operand.triangles.len() < Self::FROM {
            return Self(Vec::new());
        }
        Self(operand.positions.iter().map(|position| Self::of(position, &start.position)).collect())
    }

    #[inline]
    fn of(position: &[f64; 3], start: &[f64; 3]) -> u8 {
        let bit = |is_beside: bool, place: u32| u8::from(is_beside) << place;
        bit(position[0] < start[0], 0)
            | bit(position[1] < start[1], 1)
            | bit(position[1] > start[1], 2)
            | bit(position[2] < start[2], 3)
            | bit(position[2] > start[2], 4)
    }

    /// Whether the ray may meet a triangle: not if all its corners lie on one side.
    #[inline]
    fn may_meet(&self, operand: &Operand<'_>, triangle: u32, start: &Corner) -> bool {
        let of_corners = operand.triangles[triangle as usize].map(|v| match self.0.get(v as usize) {
            Some(&sides) => sides,
            None => Self::of(&operand.positions[v as usize], &start.position),
        });
        of_corners[0] & of_corners[1] & of_corners[2] == 0
    }
}

/// +1 where the way from `start` to `end` leaves the triangle's solid, -1 where it enters it, 0 where they do not meet.
pub(crate) fn ray_crossing(
    operands: &Operands<'_>,
    side: usize,
    triangle: u32,
    start: &Corner,
    end: &Corner,
) -> i32 {
    let [a, b, c] = operands.corners(side, triangle);
    let start_inside = operands.positive(&a, &b, &c, start);
    if operands.positive(&a, &b, &c, end) == start_inside {
        return 0;
    }
    let ab = operands.positive(start, end, &a, &b);
    if operands.positive(start, end, &b, &c) != ab || operands.positive(start, end, &c, &a) != ab {
        return 0;
    }
    if start_inside { 1 } else { -1 }
}
