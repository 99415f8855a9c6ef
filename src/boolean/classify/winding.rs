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
use crate::mesh::{Bounds, WeightedUnionFind};
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
    /// Finds them for operands with the given boxes, outside which all are 0. Those around the vertices of an operand that nobody
    /// asks for are not found, and called 0: if the first is open, nothing winds around the second's.
    ///
    /// # Errors
    /// Only limits.
    pub(crate) fn new(
        curve: &Curve<'_>,
        overlap: &Overlap,
        bounds: &[Bounds; 2],
        wanted: [bool; 2],
        runner: Runner<'_>,
    ) -> Result<Self, Error> {
        let of_operand = |operand: usize| {
            if wanted[operand] {
                return winding_numbers(curve, operand, overlap, bounds, runner);
            }
            Ok((vec![0; curve.complex.operands[operand].positions.len()], 0))
        };
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

/// Sets of vertices of one operand whose winding numbers are known relative to each other, with the regions of the coarse
/// grid. Vertices in a region, or outside the other operand's box, are not distinguished.
struct WindingClasses<'a> {
    places: &'a [Place],
    regions: &'a Regions,
    /// One entry for all that is outside, then the regions, then the vertices.
    entries: WeightedUnionFind,
    /// The entry of the first vertex.
    first_vertex: u32,
}

impl<'a> WindingClasses<'a> {
    const OUTSIDE: u32 = 0;
    const FIRST_REGION: u32 = 1;

    fn new(places: &'a [Place], regions: &'a Regions) -> Self {
        let first_vertex = Self::FIRST_REGION + u32::from(regions.count());
        let entries = WeightedUnionFind::new(first_vertex as usize + places.len());
        Self { places, regions, entries, first_vertex }
    }

    /// The entry that stands for a vertex.
    #[inline]
    fn entry(&self, v: u32) -> u32 {
        let place = self.places[v as usize];
        if place.is_outside() {
            return Self::OUTSIDE;
        }
        match self.regions.of_cell(place.cell()) {
            Regions::PASSED => self.first_vertex + v,
            region => Self::FIRST_REGION + u32::from(region),
        }
    }

    /// Records that the value of vertex `v` is that of `u` plus `change`.
    #[inline]
    fn join(&mut self, u: u32, v: u32, change: i32) {
        let contradiction = self.entries.join(self.entry(u), self.entry(v), change);
        debug_assert_eq!(contradiction, 0, "signed crossings round a closed path cancel");
    }

    /// One vertex of every component that no outside vertex belongs to, ascending.
    fn unsettled(&mut self) -> Vec<u32> {
        // The lowest entry stands for its set.
        let mut seen = rustc_hash::FxHashSet::from_iter([Self::OUTSIDE]);
        let mut seen_regions = vec![false; usize::from(self.regions.count())];
        let mut seeds = Vec::new();
        for v in 0..self.places.len() as u32 {
            let entry = self.entry(v);
            let is_new = if entry >= self.first_vertex {
                true
            } else if entry == Self::OUTSIDE {
                false
            } else {
                // Nearly all vertices: one look at a small table.
                !std::mem::replace(&mut seen_regions[(entry - Self::FIRST_REGION) as usize], true)
            };
            if is_new && seen.insert(self.entries.root(entry).0) {
                seeds.push(v);
            }
        }
        seeds
    }

    /// Fixes the value of a vertex, and so of its component.
    fn settle(&mut self, v: u32, value: i32) {
        self.entries.join(Self::OUTSIDE, self.entry(v), value);
    }

    /// The values of all vertices, all of them settled: relative to the outside, which has 0.
    fn values(mut self) -> Vec<i32> {
        let of_region: Vec<i32> =
            (Self::FIRST_REGION..self.first_vertex).map(|entry| self.entries.root(entry).1).collect();
        (0..self.places.len() as u32)
            .map(|v| {
                let place = self.places[v as usize];
                if place.is_outside() {
                    return 0;
                }
                match self.regions.of_cell(place.cell()) {
                    Regions::PASSED => self.entries.root(self.first_vertex + v).1,
                    region => of_region[usize::from(region)],
                }
            })
            .collect()
    }
}
