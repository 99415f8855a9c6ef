//! How often the other operand winds around each vertex (kept apart by the intersection curve; step 2 of Vyatkin 2019
//! decides "which parts to throw away").
//!
//! Along an edge of A the winding number of B changes by one at every crossing, so one value per connected component of A
//! gives all: 0 for a component with a vertex outside B's box, else the signed count of crossings of a ray, by the same exact
//! predicate. Vertices in a region of the coarse grid that B does not pass (`overlap`) are one to begin with.

use crate::Error;
use crate::boolean::arrangement::curve::Curve;
use crate::boolean::candidates::overlap::{Overlap, Place};
use crate::boolean::complex::ids::VertexId;
use crate::boolean::complex::rays;
use crate::mesh::Bounds;
use crate::parallel::Runner;
use crate::spatial::Regions;

/// By operand, the winding number of the other one around each vertex.
#[derive(Debug)]
pub(crate) struct Windings {
    of_vertex: [Vec<i32>; 2],
    /// How many decisions plain coordinates left open.
    pub(crate) contacts: u64,
}

impl Windings {
    /// Finds them for operands with the given boxes, outside which all are 0.
    ///
    /// # Errors
    /// Only limits.
    pub(crate) fn new(
        curve: &Curve<'_>,
        overlap: &Overlap,
        bounds: &[Bounds; 2],
        runner: Runner<'_>,
    ) -> Result<Self, Error> {
        let of_operand = |operand: usize| winding_numbers(curve, operand, overlap, bounds, runner);
        let (a, b) = runner.both(|| of_operand(0), || of_operand(1));
        let ((a, contacts_a), (b, contacts_b)) = (a?, b?);
        Ok(Self { of_vertex: [a, b], contacts: contacts_a + contacts_b })
    }

    /// Around the vertices of an operand.
    pub(crate) fn of_operand(&self, operand: usize) -> &[i32] {
        &self.of_vertex[operand]
    }

    /// Around a vertex of a complex.
    pub(crate) fn around(&self, curve: &Curve<'_>, vertex: VertexId) -> i32 {
        let complex = curve.complex;
        self.of_vertex[complex.owner(vertex)][complex.index_in_operand(vertex)]
    }

    /// Whether some vertex, or some piece of an edge, has another winding number than 0 and 1: surfaces that cross
    /// themselves where they were rounded.
    pub(crate) fn have_repeats(&self, curve: &Curve<'_>) -> bool {
        let is_repeat = |winding: i32| !(0..=1).contains(&winding);
        self.of_vertex.iter().flatten().any(|&winding| is_repeat(winding))
            || curve.edges.iter().any(|(id, edge)| {
                let mut winding = self.around(curve, edge.low);
                curve.edges.nodes(id).iter().any(|&node| {
                    winding += curve.crossings[node].winding_step();
                    is_repeat(winding)
                })
            })
    }
}

/// The winding number of the other operand around each vertex of one, and the contacts met.
fn winding_numbers(
    curve: &Curve<'_>,
    operand: usize,
    overlap: &Overlap,
    bounds: &[Bounds; 2],
    runner: Runner<'_>,
) -> Result<(Vec<i32>, u64), Error> {
    let Curve { complex, crossings, edges, faces } = curve;
    let arrays = &complex.operands[operand];
    let places = &overlap.places[operand];
    if places.is_empty() {
        return Ok((vec![0; arrays.positions.len()], 0));
    }
    let mut classes = WindingClasses::new(places, &overlap.regions[operand]);
    // 1. Along edges without crossings nothing changes.
    let mut next_cut = faces[operand].iter();
    for &triangle in complex.near(operand) {
        let corners = arrays.triangles[triangle as usize];
        if !faces[operand].is_cut(triangle) {
            classes.join(corners[0], corners[1], 0);
            classes.join(corners[1], corners[2], 0);
            continue;
        }
        let face = next_cut.next().expect("cut faces are near, and ascending");
        for k in 0..3 {
            if face.edges[k].get().is_none() {
                classes.join(corners[k], corners[(k + 1) % 3], 0);
            }
        }
    }
    // 2. Along the others, each crossing changes it by one.
    let first = complex.first_vertex(operand);
    for (id, edge) in edges.iter() {
        if complex.owner(edge.low) == operand {
            let change = edges.nodes(id).iter().map(|&node| crossings[node].winding_step()).sum();
            classes.join(edge.low.number() - first, edge.high.number() - first, change);
        }
    }
    // 3. One vertex of every component that has none outside the other operand's box is decided by a ray.
    let seeds = classes.unsettled();
    let (values, contacts) = rays::winding_numbers(complex, operand, &seeds, &bounds[1 - operand], runner)?;
    for (&seed, value) in seeds.iter().zip(values) {
        classes.settle(seed, value);
    }
    Ok((classes.values(), contacts))
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
