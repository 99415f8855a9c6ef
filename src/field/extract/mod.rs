//! From a field back to a mesh: the boundary of where it is positive, as a closed surface.
//!
//! # How
//! Space is divided into cubes (an octree) until each is certainly empty, by interval arithmetic, or holds a piece of
//! surface that one small filling follows to within the tolerance. On every face of the cubes the surface's cut is a
//! line between crossings of lattice edges, with a kink where a crease passes; the lines around a cube form a loop, and
//! the loop is filled with triangles, from a point on the crease or corner inside the cube if there is one. This is
//! cubical marching squares (Ho, Wu, Chen, Chuang, Ouhyoung 2005: features on faces and in cells, no cracks between
//! cells of different size), with the positions of features from Newton's method on the branches of minima and maxima
//! that meet there instead of from fitted planes. Cubes that hold several pieces, or whose faces are cut by several
//! lines, at the finest level, are divided into tetrahedra instead, where neither can happen.
//!
//! The surface of the cubes is then made smooth (`smooth`): vertices on the zero set, facets that face the way of the gradient, round triangles
//! and far fewer of them.
//!
//! # What is promised
//! - **Closed and 2-manifold, always**: every face of a cube has one line, seen alike from both sides; every cube
//!   fills its loop with a disc. Should bounds have been wrong and a cube held to be empty have a cut face, it is looked
//!   at again.
//! - **No self-crossings**, up to the rounding of coordinates: each filling stays in its cube, and fillings in one cube do
//!   not cross; what smoothing changes is tested exactly, and left undone where it crosses.
//! - Deterministic: the same bytes for any number of threads.
//!
//! What is *not* promised: parts of the solid thinner than [`Extraction::resolution`] may be missed or joined, and the
//! tolerance is checked at sample points (the largest deviation found is in the report), not proven.

mod boundaries;
mod cell_lines;
mod centre;
mod contour;
mod faces;
mod filling;
mod lattice;
mod loops;
mod octree;
mod smooth;
mod solve;
mod surface;
mod tables;
mod tetrahedra;

use std::sync::Arc;

use glam::DVec3;
use rustc_hash::{FxHashMap, FxHashSet};

use super::Expression;
use super::expression::Tape;
use crate::{Control, Error, Mesh};
pub use contour::ContourExtraction;
use faces::Corners;
use lattice::{Cube, DEEPEST, Key, Lattice};
use octree::{Leaf, Settings};
use smooth::{Nearby, Smooth};
use tables::Tables;

/// Rounds in which cells are divided again after their neighbours are known: each halves the cells that need it.
const ROUNDS: usize = 6;
/// Rounds in which cubes are looked at again that were held to be empty but have a cut face.
const OPENINGS: usize = 16;

/// Settings of an extraction.
#[derive(Clone, Debug)]
pub struct Extraction {
    low: [f64; 3],
    high: [f64; 3],
    tolerance: f64,
    resolution: Option<f64>,
    smallest: Option<f64>,
    clip: bool,
    smooth: bool,
    control: Control,
}

/// A surface extracted from a field.
#[derive(Clone, Debug)]
pub struct Extracted {
    /// The surface, facing where the field is negative. Empty if the field is positive nowhere in the box.
    pub mesh: Mesh,
    /// Cubes that the surface was sought in.
    pub cells: usize,
    /// Cubes at the finest level that were divided into tetrahedra: places where the surface has several pieces
    /// closer together than the smallest cube.
    pub divided_cells: usize,
    /// Side of the smallest cube used.
    pub smallest_cell: f64,
    /// The largest deviation from the field's zero found at the middles of the triangles, and of large ones at six places more: to first
    /// order (the value over the length of the gradient) or along the normal of the triangle, whichever is less.
    pub deviation: f64,
    /// Degrees that the normals of 95 of a hundred triangles are within of the field's gradient at their middles, reversed.
    pub normal_deviation: f64,
}

impl Extraction {
    /// An extraction in the box `low..high`, which must contain the solid, to within `tolerance`.
    #[must_use]
    pub fn new(low: [f64; 3], high: [f64; 3], tolerance: f64) -> Self {
        Self {
            low,
            high,
            tolerance,
            resolution: None,
            smallest: None,
            clip: false,
            smooth: true,
            control: Control::default(),
        }
    }

    /// Parts of the solid at least this thick are found for certain where the field is given by formulas. Default: a
    /// 64th of the longest side of the box, and for fields with distances of meshes or polygons no more than four
    /// times the tolerance.
    #[must_use]
    pub fn resolution(mut self, resolution: f64) -> Self {
        self.resolution = Some(resolution);
        self
    }

    /// Side of the smallest cubes, which are reached where features meet and along edges that branches
    /// do not show. Default: the tolerance. Rounded down to a halving of the whole box.
    #[must_use]
    pub fn smallest(mut self, smallest: f64) -> Self {
        self.smallest = Some(smallest);
        self
    }

    /// Whether to cut the solid off at the box, instead of failing if it does not end inside.
    #[must_use]
    pub fn clip(mut self, clip: bool) -> Self {
        self.clip = clip;
        self
    }

    /// Whether to make the surface smooth (default): facets that face the way the field says, well-shaped, and a fraction of as many.
    /// Otherwise the result is the surface of the cells, as near to the field, in about half the time, but crumpled to look at.
    #[must_use]
    pub fn smooth(mut self, smooth: bool) -> Self {
        self.smooth = smooth;
        self
    }

    /// Limits and progress.
    #[must_use]
    pub fn control(mut self, control: Control) -> Self {
        self.control = control;
        self
    }

    /// Extracts the surface of where `field` is positive.
    ///
    /// # Errors
    /// - [`Error::InvalidArgument`] for an empty box or a tolerance that is not positive, or finer than the box
    ///   divided 2^19 times;
    /// - [`Error::Field`] if the solid does not end inside the box, or the field is not a number somewhere near the
    ///   surface;
    /// - the limits of the control.
    pub fn run(&self, field: &Expression) -> Result<Extracted, Error> {
        let (low, high) = self.checked_box()?;
        let tolerance = positive(self.tolerance, "tolerance")?;
        let extent = (high - low).max_element();
        let lattice = self.lattice(low, high, tolerance)?;
        let field = if self.clip { self.clipped(field) } else { field.clone() }.sign_form();
        let usual = octree::usual_resolution(field.tape(), extent, tolerance);
        let resolution = positive(self.resolution.unwrap_or(usual), "resolution")?;
        let settings = Settings { lattice, tolerance, resolution, control: &self.control };
        Rounds::new(field.tape(), settings)?.run(self.smooth)
    }

    fn checked_box(&self) -> Result<(DVec3, DVec3), Error> {
        let (low, high) = (DVec3::from_array(self.low), DVec3::from_array(self.high));
        if low.is_finite() && high.is_finite() && low.cmplt(high).all() {
            Ok((low, high))
        } else {
            let what = format!("the box from {:?} to {:?} is empty or not finite", self.low, self.high);
            Err(Error::InvalidArgument(what))
        }
    }

    /// The lattice of the smallest cells over the box.
    fn lattice(&self, low: DVec3, high: DVec3, tolerance: f64) -> Result<Lattice, Error> {
        let extent = (high - low).max_element();
        let smallest = positive(self.smallest.unwrap_or(tolerance), "smallest cell")?;
        let depth = (extent / smallest).log2().ceil().max(3.0);
        if depth > f64::from(DEEPEST) {
            let what = format!(
                "cells of {smallest:e} in a box of {extent:e} need {depth} halvings; at most {DEEPEST} are possible"
            );
            return Err(Error::InvalidArgument(what));
        }
        Ok(Lattice::around(low, high, depth as u32))
    }

    /// The field, cut off at the box.
    fn clipped(&self, field: &Expression) -> Expression {
        let (graph, root) = field.graph();
        let mut graph = graph.clone();
        let axes = graph.axes();
        let mut all = graph.sign_form(root);
        for axis in 0..3 {
            let (low, high) = (graph.constant(self.low[axis]), graph.constant(self.high[axis]));
            let above = graph.sub(axes[axis], low);
            let below = graph.sub(high, axes[axis]);
            all = graph.min(all, above);
            all = graph.min(all, below);
        }
        Expression::new(graph, all)
    }
}

fn positive(value: f64, name: &str) -> Result<f64, Error> {
    if value > 0.0 && value.is_finite() {
        Ok(value)
    } else {
        Err(Error::InvalidArgument(format!("the {name} must be positive, not {value}")))
    }
}

/// The octree between the rounds of an extraction.
struct Rounds<'a> {
    tape: &'a Arc<Tape>,
    settings: Settings<'a>,
    leaves: Vec<Leaf>,
    corners: Corners,
    /// The field at corners, as far as it was needed.
    values: FxHashMap<Key, f64>,
    /// Whether the field is known at all corners.
    known: bool,
    /// The cells to look at: all, or those whose neighbours have changed since they were looked at.
    changed: Option<FxHashSet<Cube>>,
    refinements: usize,
    openings: usize,
}

impl<'a> Rounds<'a> {
    fn new(tape: &'a Arc<Tape>, settings: Settings<'a>) -> Result<Self, Error> {
        let leaves = octree::subdivide(tape, &settings)?;
        let corners = Corners::of(leaves.iter().map(|leaf| leaf.cube));
        let values = FxHashMap::default();
        let (known, changed, refinements, openings) = (false, None, 0, 0);
        Ok(Self { tape, settings, leaves, corners, values, known, changed, refinements, openings })
    }

    fn run(mut self, smooth: bool) -> Result<Extracted, Error> {
        let Settings { lattice, tolerance, control, .. } = self.settings;
        loop {
            self.check_bounded()?;
            // 1. The lines on the faces of the cells to look at.
            let chosen = self.chosen();
            let cells = chosen.iter().map(|&index| &self.leaves[index]).collect();
            let tables =
                Tables::new(cells, &self.corners, &mut self.values, self.known, lattice, tolerance, control)?;
            // 2. Cubes held to be empty whose faces are cut are looked at again.
            if self.changed.is_none() && !tables.one_sided.is_empty() && self.openings < OPENINGS {
                let faces = tables.one_sided;
                octree::reopen(&mut self.leaves, &faces, self.tape);
                self.openings += 1;
                self.known = false;
                continue;
            }
            // 3. The surface in each cell, and cells that it does not follow closely enough divided.
            let (mesh, deviations) = surface::assemble(&tables, control)?;
            let divided = tables.divided;
            if self.refine(&chosen, &divided, &deviations)? {
                continue;
            }
            // 4. The surface is put together only from all cells.
            if self.changed.take().is_some() {
                self.known = true;
                continue;
            }
            let sizes = chosen.iter().map(|&index| self.leaves[index].cube.size);
            let nearby = Nearby::new(self.tape, &self.leaves, lattice, tolerance);
            let Smooth { mesh, deviation, normal_deviation } = if smooth {
                smooth::smoothed(mesh, &nearby, tolerance, lattice.step(), control)?
            } else {
                smooth::rough(mesh, &nearby, control)?
            };
            return Ok(Extracted {
                mesh,
                cells: chosen.len(),
                divided_cells: divided.iter().filter(|&&divided| divided).count(),
                smallest_cell: f64::from(sizes.min().unwrap_or(lattice.count)) * lattice.step(),
                deviation,
                normal_deviation,
            });
        }
    }

    /// Fails if the solid does not end inside the box.
    fn check_bounded(&self) -> Result<(), Error> {
        let lattice = &self.settings.lattice;
        let Some(leaf) = self.leaves.iter().find(|leaf| leaf.inside && at_edge(lattice, leaf.cube)) else {
            return Ok(());
        };
        let place = leaf.cube.points().into_iter().find(|&point| lattice.on_boundary(point));
        Err(tables::unbounded(lattice.place(place.unwrap_or(leaf.cube.corner)).to_array()))
    }

    /// Positions of the leaves to look at.
    fn chosen(&self) -> Vec<usize> {
        let changed = self.changed.as_ref();
        let looked_at =
            |leaf: &Leaf| leaf.tape.is_some() && changed.is_none_or(|changed| changed.contains(&leaf.cube));
        (0..self.leaves.len()).filter(|&index| looked_at(&self.leaves[index])).collect()
    }

    /// Divides the cells that need it and can be: finer neighbours may have shown what a cell's own corners did not.
    /// Whether there were any.
    fn refine(&mut self, chosen: &[usize], divided: &[bool], deviations: &[f64]) -> Result<bool, Error> {
        let mut wanted = vec![false; self.leaves.len()];
        for (&index, (&divided, &deviation)) in chosen.iter().zip(divided.iter().zip(deviations)) {
            let cell = &self.leaves[index];
            wanted[index] = cell.cube.size > 1 && (divided || deviation > self.settings.tolerance);
        }
        if self.refinements >= ROUNDS || !wanted.contains(&true) {
            return Ok(false);
        }
        let first = octree::refine(&mut self.leaves, |leaf| wanted[leaf], &self.settings)?;
        let new_points = self.corners.extend(self.leaves[first..].iter().map(|leaf| leaf.cube));
        let mut cubes = octree::touching(&self.leaves, &new_points, &self.settings.lattice);
        cubes.extend(self.leaves[first..].iter().map(|leaf| leaf.cube));
        self.changed = Some(cubes);
        self.refinements += 1;
        self.known = false;
        Ok(true)
    }
}

fn at_edge(lattice: &Lattice, cube: Cube) -> bool {
    cube.corner.iter().any(|&x| x == 0 || x + cube.size == lattice.count)
}
