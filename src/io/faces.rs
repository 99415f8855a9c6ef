//! The faces of a file in order, and the triangles they become.

use super::notes::Notes;
use super::{Format, malformed};
use crate::polygon::{FaceTriangulator, Tiling};
use crate::{Control, Error};

/// Faces as the file gives them: triangles at once, larger polygons kept aside until all positions are known.
#[derive(Debug, Default)]
pub(super) struct FaceList {
    triangles: Vec<[u32; 3]>,
    polygons: Vec<Polygon>,
    corners: Vec<u32>,
    /// The largest index in faces that were left out.
    left_out: Option<u32>,
}

#[derive(Clone, Copy, Debug)]
struct Polygon {
    /// How many of `triangles` come before it.
    after: u32,
    /// Its first corner in `corners`; the last is where the next polygon begins.
    first: u32,
}

/// A place between two faces: how many triangles and how many polygons come before it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct FacePlace {
    triangles: u32,
    polygons: u32,
}

impl FaceList {
    /// With room for this many triangles.
    pub(super) fn with_capacity(triangles: usize) -> Self {
        Self { triangles: Vec::with_capacity(triangles), ..Self::default() }
    }

    /// These triangles, except those with a repeated corner; and how many those were.
    pub(super) fn from_triangles(mut triangles: Vec<[u32; 3]>) -> (Self, usize) {
        let count = triangles.len();
        let mut left_out = None;
        if !triangles.iter().all(whole) {
            left_out = triangles.iter().filter(|triangle| !whole(triangle)).flatten().copied().max();
            triangles.retain(whole);
        }
        let dropped = count - triangles.len();
        (Self { triangles, left_out, ..Self::default() }, dropped)
    }

    /// Adds a face, if it has three corners or more. Corners repeated one after the other count once, since the
    /// edges between them cancel.
    #[inline(always)]
    pub(super) fn push(&mut self, corners: &[u32]) -> bool {
        match *corners {
            [a, b, c] if whole(&[a, b, c]) => {
                self.triangles.push([a, b, c]);
                true
            }
            [_, _, _] => self.leave_out(corners),
            _ => self.push_polygon(corners),
        }
    }

    #[cold]
    fn leave_out(&mut self, corners: &[u32]) -> bool {
        self.left_out = self.left_out.max(corners.iter().copied().max());
        false
    }

    fn push_polygon(&mut self, corners: &[u32]) -> bool {
        let first = self.corners.len();
        for &corner in corners {
            if self.corners[first..].last() != Some(&corner) {
                self.corners.push(corner);
            }
        }
        while self.corners.len() > first + 1 && self.corners.last() == self.corners.get(first) {
            self.corners.pop();
        }
        if self.corners.len() < first + 3 {
            self.corners.truncate(first);
            return self.leave_out(corners);
        }
        self.polygons.push(Polygon { after: self.triangles.len() as u32, first: first as u32 });
        true
    }

    /// The place after the last face.
    pub(super) fn end(&self) -> FacePlace {
        FacePlace { triangles: self.triangles.len() as u32, polygons: self.polygons.len() as u32 }
    }

    /// Whether there is no face.
    pub(super) fn is_empty(&self) -> bool {
        self.triangles.is_empty() && self.polygons.is_empty()
    }

    /// Whether 32-bit places can hold another face.
    pub(super) fn has_room(&self) -> bool {
        self.triangles.len() < u32::MAX as usize - 1 && self.corners.len() < u32::MAX as usize / 2
    }

    /// The largest index, in faces that were left out too.
    pub(super) fn largest(&self) -> Option<u32> {
        // Three running maxima, so that the loop runs on vector registers.
        let in_triangles = self.triangles.iter().fold([0; 3], |largest, triangle| {
            [largest[0].max(triangle[0]), largest[1].max(triangle[1]), largest[2].max(triangle[2])]
        });
        let in_polygons = self.corners.iter().copied().max();
        let in_triangles = (!self.triangles.is_empty()).then(|| in_triangles.into_iter().max()).flatten();
        in_triangles.max(in_polygons).max(self.left_out)
    }

    /// The first face that names a vertex beyond `vertices`, counted from 0 among the faces kept, and that vertex;
    /// `None` for the face if it was left out.
    pub(super) fn first_beyond(&self, vertices: usize) -> Option<(Option<usize>, u32)> {
        let beyond = |corners: &[u32]| corners.iter().copied().find(|&corner| corner as usize >= vertices);
        let triangle = self.triangles.iter().enumerate().find_map(|(i, corners)| Some((i, beyond(corners)?)));
        let polygon = self.polygons.iter().enumerate().find_map(|(i, polygon)| {
            let end = self.polygons.get(i + 1).map_or(self.corners.len(), |next| next.first as usize);
            Some((i, beyond(&self.corners[polygon.first as usize..end])?))
        });
        let of_triangle = triangle.map(|(i, index)| {
            let polygons = self.polygons.partition_point(|polygon| polygon.after as usize <= i);
            (Some(i + polygons), index)
        });
        let of_polygon = polygon.map(|(i, index)| (Some(i + self.polygons[i].after as usize), index));
        let left_out = self.left_out.filter(|&index| index as usize >= vertices).map(|index| (None, index));
        of_triangle.into_iter().chain(of_polygon).min().or(left_out)
    }

    /// Whether there are faces of more than three corners.
    pub(super) fn has_polygons(&self) -> bool {
        !self.polygons.is_empty()
    }

    /// How many faces there are.
    pub(super) fn len(&self) -> usize {
        self.triangles.len() + self.polygons.len()
    }

    /// The triangles, in the order of the faces, with every index in range; and for each of `places` (in order) how
    /// many triangles come before it. Triangles with a repeated corner are dropped: their edges cancel. `of`, if it is there, gets
    /// the number of the face that each triangle is of.
    pub(super) fn into_triangles(
        mut self,
        positions: &[[f64; 3]],
        places: &[FacePlace],
        notes: &mut Notes,
        control: &Control,
        of: &mut Option<Vec<u32>>,
    ) -> Result<(Vec<[u32; 3]>, Vec<usize>), Error> {
        if self.polygons.is_empty() {
            if let Some(of) = of.as_mut() {
                of.extend(0..self.triangles.len() as u32);
            }
            let offsets = places.iter().map(|place| place.triangles as usize).collect();
            return Ok((self.triangles, offsets));
        }
        // A polygon of n corners gives n - 2 triangles.
        let count = self.triangles.len() + self.corners.len() - 2 * self.polygons.len();
        let mut row = Row { triangles: Vec::with_capacity(count), of: of.as_mut(), taken: 0, face: 0 };
        let mut offsets = Vec::with_capacity(places.len());
        let mut triangulator = FaceTriangulator::default();
        let mut improper = 0;
        let mut places = places.iter().peekable();
        let end = self.end();
        self.polygons.push(Polygon { after: end.triangles, first: self.corners.len() as u32 });
        for (i, polygon) in self.polygons.iter().enumerate() {
            if i % 1024 == 0 {
                control.check()?;
            }
            while let Some(place) = places.next_if(|place| place.polygons as usize == i) {
                row.copy_until(&self.triangles, place.triangles);
                offsets.push(row.triangles.len());
            }
            row.copy_until(&self.triangles, polygon.after);
            if let Some(following) = self.polygons.get(i + 1) {
                let corners = &self.corners[polygon.first as usize..following.first as usize];
                let tiling = row.add_polygon(&mut triangulator, positions, corners);
                improper += usize::from(tiling == Tiling::Improper);
            }
        }
        notes.add("triangle with a repeated corner dropped", count - row.triangles.len());
        notes.add("polygon that crosses itself or has no area: its triangles overlap or are flat", improper);
        Ok((row.triangles, offsets))
    }
}

/// Triangles in the order of the faces, as it grows.
struct Row<'a> {
    triangles: Vec<[u32; 3]>,
    /// The face of each, if anyone asks.
    of: Option<&'a mut Vec<u32>>,
    /// How many of the faces that are triangles are in it.
    taken: u32,
    /// How many faces are in it.
    face: u32,
}

impl Row<'_> {
    /// Adds the faces that are triangles up to one of them.
    fn copy_until(&mut self, triangles: &[[u32; 3]], end: u32) {
        self.triangles.extend_from_slice(&triangles[self.taken as usize..end as usize]);
        let next = self.face + (end - self.taken);
        if let Some(of) = self.of.as_mut() {
            of.extend(self.face..next);
        }
        (self.face, self.taken) = (next, end);
    }

    /// Adds the triangles of a polygon.
    fn add_polygon(
        &mut self,
        triangulator: &mut FaceTriangulator,
        positions: &[[f64; 3]],
        corners: &[u32],
    ) -> Tiling {
        let first = self.triangles.len();
        let tiling = triangulator.triangulate(positions, corners, &mut self.triangles);
        // Only a polygon that names a vertex twice can have triangles that are not whole; they are few.
        let mut kept = first;
        for k in first..self.triangles.len() {
            if whole(&self.triangles[k]) {
                self.triangles[kept] = self.triangles[k];
                kept += 1;
            }
        }
        self.triangles.truncate(kept);
        if let Some(of) = self.of.as_mut() {
            of.resize(kept, self.face);
        }
        self.face += 1;
        tiling
    }
}

/// Whether a triangle names three different vertices.
fn whole(triangle: &[u32; 3]) -> bool {
    triangle[0] != triangle[1] && triangle[1] != triangle[2] && triangle[2] != triangle[0]
}

/// The error for a file with more faces or vertices than 32-bit indices can name.
pub(super) fn too_large(format: Format, what: &str) -> Error {
    Error::TooLarge { what: format!("the {format} file has more {what} than 32-bit indices can name") }
}

/// The error for an index that names no vertex.
pub(super) fn index_error(format: Format, place: impl Into<String>, index: u64, vertices: usize) -> Error {
    let range = match vertices {
        0 => "the file has no vertices".to_string(),
        _ => format!("the file has vertices 0 to {}", vertices - 1),
    };
    malformed(
        format,
        place,
        format!("a face names vertex {index}, but {range}; the file is cut off or corrupt"),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn faces_keep_their_order_and_places() {
        let on_circle = |i: i32| [(0.7 * f64::from(i)).cos(), (0.7 * f64::from(i)).sin(), 0.0];
        let positions: Vec<[f64; 3]> = (0..8).map(on_circle).collect();
        let mut faces = FaceList::default();
        let mut places = vec![faces.end()];
        assert!(faces.push(&[0, 1, 2]));
        places.push(faces.end());
        assert!(faces.push(&[0, 1, 2, 3, 4]));
        assert!(!faces.push(&[3, 3, 4]));
        places.push(faces.end());
        assert!(!faces.push(&[1, 1, 2, 2, 1]));
        assert!(faces.push(&[4, 5, 6, 4, 4]));
        places.push(faces.end());
        assert!(faces.push(&[5, 6, 7]));
        places.push(faces.end());
        assert_eq!(faces.largest(), Some(7));
        // Face 1 is the pentagon, face 2 the triangle 4 5 6, face 3 the last.
        assert_eq!(faces.first_beyond(3), Some((Some(1), 3)));
        assert_eq!(faces.first_beyond(5), Some((Some(2), 5)));
        assert_eq!(faces.first_beyond(7), Some((Some(3), 7)));
        assert_eq!(faces.first_beyond(8), None);

        let mut notes = Notes::default();
        let mut of = Some(Vec::new());
        let (triangles, offsets) =
            faces.into_triangles(&positions, &places, &mut notes, &Control::new(), &mut of).unwrap();
        assert_eq!(offsets, [0, 1, 4, 5, 6]);
        assert_eq!(of.unwrap(), [0, 1, 1, 1, 2, 3]);
        assert_eq!(triangles[0], [0, 1, 2]);
        assert_eq!(triangles[5], [5, 6, 7]);
        assert_eq!(triangles[4], [4, 5, 6]);
        assert!(notes.into_warnings(|_| String::new()).is_empty());
    }
}
