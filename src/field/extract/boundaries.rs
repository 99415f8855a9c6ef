//! The boundaries of cells, looked up once: their undivided faces, the points around each face, and whether these are
//! inside.

use rustc_hash::FxHashMap;

use super::faces::{Corners, Face};
use super::lattice::Key;
use super::octree::Leaf;
use crate::field::work;
use crate::{Control, Error};

/// Faces of all cells, cell by cell, and points of all faces, face by face.
#[derive(Default)]
pub(super) struct Boundaries {
    /// Where the faces of each cell end in `faces`.
    cells: Vec<u32>,
    /// Each face, and where its points end in `points`.
    faces: Vec<(Face, u32)>,
    points: Vec<Key>,
    inside: Vec<bool>,
}

/// A face of a cell with the points around it, counter-clockwise seen from outside the cell.
#[derive(Clone, Copy)]
pub(super) struct CellFace<'a> {
    pub(super) face: Face,
    pub(super) points: &'a [Key],
    /// Whether each of the points is inside; empty until signs are known.
    pub(super) inside: &'a [bool],
}

impl Boundaries {
    pub(super) fn new(cells: &[&Leaf], corners: &Corners, control: &Control) -> Result<Self, Error> {
        let pieces = work::pieces(cells.len(), 256, control, "faces of cells", |range| {
            let mut piece = Self::default();
            for leaf in &cells[range] {
                for (face, upper) in corners.faces(leaf.cube) {
                    let outline = corners.outline(face);
                    if upper {
                        piece.points.extend(outline);
                    } else {
                        piece.points.extend(outline.into_iter().rev());
                    }
                    piece.faces.push((face, piece.points.len() as u32));
                }
                piece.cells.push(piece.faces.len() as u32);
            }
            Ok(piece)
        })?;
        let mut all = Self::default();
        for piece in pieces {
            let faces = all.faces.len() as u32;
            let points = u32::try_from(all.points.len() + piece.points.len()).map_err(|_| {
                Error::TooLarge { what: "the surface needs more than 2^32 lattice points".into() }
            })? - piece.points.len() as u32;
            all.cells.extend(piece.cells.iter().map(|end| faces + end));
            all.faces.extend(piece.faces.iter().map(|&(face, end)| (face, points + end)));
            all.points.extend(piece.points);
        }
        Ok(all)
    }

    /// Looks up the signs of all points.
    pub(super) fn find_signs(
        &mut self,
        values: &FxHashMap<Key, f64>,
        control: &Control,
    ) -> Result<(), Error> {
        let points = &self.points;
        let inside = work::pieces(points.len(), 4096, control, "signs of cells", |range| {
            let positive = |point: &Key| values.get(point).is_some_and(|&value| value > 0.0);
            Ok(points[range].iter().map(positive).collect::<Vec<bool>>())
        })?;
        self.inside = inside.concat();
        Ok(())
    }

    /// The faces of a cell.
    pub(super) fn of(&self, cell: usize) -> impl Iterator<Item = CellFace<'_>> {
        let start =
            |ends: &[u32], index: usize| index.checked_sub(1).map_or(0, |before| ends[before]) as usize;
        let faces = start(&self.cells, cell)..self.cells[cell] as usize;
        faces.map(|index| {
            let (face, end) = self.faces[index];
            let first = index.checked_sub(1).map_or(0, |before| self.faces[before].1) as usize;
            let range = first..end as usize;
            let inside = self.inside.get(range.clone()).unwrap_or(&[]);
            CellFace { face, points: &self.points[range], inside }
        })
    }

    /// Bytes held.
    pub(super) fn memory(&self) -> u64 {
        (self.cells.len() * 4 + self.faces.len() * size_of::<(Face, u32)>() + self.points.len() * 9) as u64
    }
}
