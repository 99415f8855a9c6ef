//! All coincidences on small integer grids.

mod boxes;
mod cells;
mod convex;
mod lattice;
mod sweeps;
