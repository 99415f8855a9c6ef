//! Where a surface is not: connected sets of grid cells that it does not pass.

use super::Occupancy;
use crate::mesh::UnionFind;

/// Which connected set of free cells each cell of a grid belongs to. Inside one set nothing tells one point from another by
/// that surface: its winding number is the same for all of them.
#[derive(Debug)]
pub(crate) struct Regions {
    /// By cell number: the region, or [`PASSED`](Self::PASSED).
    region_of: Vec<u16>,
    count: u16,
}

impl Regions {
    /// Marks cells the surface may pass.
    pub(crate) const PASSED: u16 = u16::MAX;

    /// The regions of a grid of at most 32 cells along each axis, whose marked cells are those the surface may pass. Cells
    /// are neighbours if they share a face.
    pub(crate) fn of(passed: &Occupancy) -> Self {
        let resolution = passed.resolution();
        let rows = resolution * resolution;
        // Runs of free cells of each row along x: first and last place. Those of neighbouring rows that overlap belong together.
        let mut runs: Vec<[u32; 2]> = Vec::new();
        let mut first_run = vec![0];
        for row in 0..rows {
            let mut free = (0..resolution).filter(|x| !passed.is_number_marked(row * resolution + x));
            let mut run = free.next().map(|x| [x, x]);
            for x in free {
                match &mut run {
                    Some([_, last]) if *last + 1 == x => *last = x,
                    _ => runs.extend(run.replace([x, x])),
                }
            }
            runs.extend(run);
            first_run.push(runs.len());
        }
        let mut sets = UnionFind::new(runs.len());
        for row in 0..rows {
            let here = first_run[row as usize]..first_run[row as usize + 1];
            let neighbours = [(row % resolution > 0).then(|| row - 1), row.checked_sub(resolution)];
            for below in neighbours.into_iter().flatten() {
                let mut below = first_run[below as usize]..first_run[below as usize + 1];
                for run in here.clone() {
                    while below.start < below.end && runs[below.start][1] < runs[run][0] {
                        below.start += 1;
                    }
                    // The last one that overlaps may overlap the next run, too.
                    for other in below.clone().take_while(|&other| runs[other][0] <= runs[run][1]) {
                        sets.join(run as u32, other as u32);
                    }
                }
            }
        }
        let (count, label) = sets.labels();
        let mut region_of = vec![Self::PASSED; (rows * resolution) as usize];
        for row in 0..rows {
            for run in first_run[row as usize]..first_run[row as usize + 1] {
                let [first, last] = runs[run].map(|x| (row * resolution + x) as usize);
                region_of[first..=last].fill(label[run] as u16);
            }
        }
        Self { region_of, count: count as u16 }
    }

    /// How many regions there are; they are numbered from 0.
    pub(crate) fn count(&self) -> u16 {
        self.count
    }

    /// The region of a cell by its number, or [`PASSED`](Self::PASSED).
    #[inline]
    pub(crate) fn of_cell(&self, number: u32) -> u16 {
        self.region_of[number as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3A;
    use obvhs::aabb::Aabb;
    use rand::rngs::ChaCha8Rng;
    use rand::{RngExt, SeedableRng};

    #[test]
    fn a_wall_parts_a_grid_and_a_hole_in_it_joins_the_parts() {
        let whole = Aabb { min: Vec3A::ZERO, max: Vec3A::splat(8.0) };
        let mut grid = Occupancy::over(&whole, 8);
        assert_eq!(Regions::of(&grid).count(), 1);
        let hole = grid.number(grid.cell(Vec3A::new(3.5, 5.5, 2.5)));
        for y in 0..8 {
            for z in 0..8 {
                let cell = grid.number(grid.cell(Vec3A::new(3.5, y as f32 + 0.5, z as f32 + 0.5)));
                if cell != hole {
                    grid.mark_number(cell);
                }
            }
        }
        let region =
            |regions: &Regions, x: f32| regions.of_cell(grid.number(grid.cell(Vec3A::new(x, 1.0, 7.0))));
        let joined = Regions::of(&grid);
        assert_eq!(joined.count(), 1);
        assert_eq!(region(&joined, 0.5), region(&joined, 7.5));
        assert_eq!(region(&joined, 3.5), Regions::PASSED);
        let mut closed = grid.empty();
        (0..512).filter(|&cell| grid.is_number_marked(cell) || cell == hole).for_each(|cell| {
            closed.mark_number(cell);
        });
        let parted = Regions::of(&closed);
        assert_eq!(parted.count(), 2);
        assert_ne!(region(&parted, 0.5), region(&parted, 7.5));
    }

    #[test]
    fn regions_are_the_components_of_the_free_cells() {
        let mut rng = ChaCha8Rng::seed_from_u64(8);
        let whole = Aabb { min: Vec3A::ZERO, max: Vec3A::ONE };
        for (resolution, part) in [(1, 0.5), (8, 0.3), (8, 0.6), (16, 0.68), (16, 0.95), (32, 0.7)] {
            let mut grid = Occupancy::over(&whole, resolution);
            let cells: u32 = resolution * resolution * resolution;
            (0..cells).filter(|_| rng.random_bool(part)).for_each(|cell| grid.mark_number(cell));
            let regions = Regions::of(&grid);
            let mut sets = UnionFind::new(cells as usize);
            let is_free = |cell: u32| !grid.is_number_marked(cell);
            for cell in (0..cells).filter(|&cell| is_free(cell)) {
                for step in [1, resolution, resolution * resolution] {
                    if cell / step % resolution + 1 < resolution && is_free(cell + step) {
                        sets.join(cell, cell + step);
                    }
                }
            }
            let mut representative = vec![None; usize::from(regions.count())];
            for cell in 0..cells {
                assert_eq!(regions.of_cell(cell) == Regions::PASSED, !is_free(cell));
                if is_free(cell) {
                    let root = sets.root(cell);
                    let known = representative[usize::from(regions.of_cell(cell))].get_or_insert(root);
                    assert_eq!(*known, root);
                }
            }
            let mut roots: Vec<u32> = representative.into_iter().flatten().collect();
            assert_eq!(roots.len(), usize::from(regions.count()), "every region has cells");
            roots.sort_unstable();
            assert!(roots.windows(2).all(|pair| pair[0] < pair[1]), "no region is in two parts");
        }
    }
}
