//! Which polygons of a file triangles are parts of, so that those that nothing touched are polygons again where files have some.

/// The polygons that the triangles of a mesh are parts of; nothing where all faces of its file were triangles.
///
/// A polygon is whole where all its triangles are there; only then is it written as a polygon.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Polygons {
    /// For every triangle the number of its polygon, or [`NONE`](Self::NONE); empty if there are no polygons.
    pub of_triangle: Vec<u32>,
    /// For every polygon how many triangles it has.
    pub triangles: Vec<u32>,
}

impl Polygons {
    /// In [`of_triangle`](Self::of_triangle): the triangle is part of no polygon.
    pub const NONE: u32 = u32::MAX;

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.of_triangle.is_empty()
    }

    /// The polygons of triangles, of each of which the face is known; triangles of one face follow each other.
    pub(crate) fn of_faces(faces: &[u32]) -> Self {
        let mut polygons = Self::default();
        if faces.windows(2).all(|pair| pair[0] != pair[1]) {
            return polygons;
        }
        for face in faces.chunk_by(|a, b| a == b) {
            let number = match face.len() {
                1 => Self::NONE,
                count => {
                    polygons.triangles.push(count as u32);
                    polygons.triangles.len() as u32 - 1
                }
            };
            polygons.of_triangle.resize(polygons.of_triangle.len() + face.len(), number);
        }
        polygons
    }

    /// Keeps of the assignment what the triangles `kept` have, in that order.
    pub(super) fn select(&mut self, kept: &[u32]) {
        if !self.is_empty() {
            let polygon =
                |&triangle: &u32| self.of_triangle.get(triangle as usize).copied().unwrap_or(Self::NONE);
            self.of_triangle = kept.iter().map(polygon).collect();
        }
    }

    /// The same as a copy, without the polygons that none of them is part of.
    pub(super) fn selected(&self, kept: &[u32]) -> Self {
        let known = |polygon: &u32| (*polygon as usize) < self.triangles.len();
        let of_kept = |&triangle: &u32| self.of_triangle.get(triangle as usize).copied().filter(known);
        let mut used: Vec<u32> = kept.iter().filter_map(of_kept).collect();
        used.sort_unstable();
        used.dedup();
        if used.is_empty() {
            return Self::default();
        }
        let number = |polygon: u32| used.partition_point(|&other| other < polygon) as u32;
        Self {
            of_triangle: kept.iter().map(|triangle| of_kept(triangle).map_or(Self::NONE, number)).collect(),
            triangles: used.iter().map(|&polygon| self.triangles[polygon as usize]).collect(),
        }
    }

    /// Appends the polygons of `added` further triangles to those of `own` triangles.
    pub(crate) fn append(&mut self, own: usize, other: &Self, added: usize) {
        if self.is_empty() && other.is_empty() {
            return;
        }
        let offset = self.triangles.len() as u32;
        self.of_triangle.resize(own, Self::NONE);
        let shifted =
            |&number: &u32| if number == Self::NONE { number } else { number.saturating_add(offset) };
        self.of_triangle.extend(other.of_triangle.iter().map(shifted));
        self.of_triangle.resize(own + added, Self::NONE);
        self.triangles.extend_from_slice(&other.triangles);
    }
}

/// The faces of a mesh as a file with polygons has them: each a list of corners, that is of places in the flat list of the
/// triangles' corners.
#[cfg(feature = "formats")]
pub(crate) struct Faces {
    /// Nothing if all faces are triangles.
    listed: Option<(Vec<u32>, Vec<u32>)>,
    triangles: usize,
}

#[cfg(feature = "formats")]
impl Faces {
    /// The faces of triangles: whole polygons of at most `most` corners, each at the place of its first triangle, and all
    /// other triangles. `is_one` says whether two corners at one vertex are the same to the file, and so the faces around them.
    pub(crate) fn of(mesh: &super::Mesh, most: usize, is_one: impl Fn(u32, u32) -> bool) -> Self {
        let (polygons, count) = (&mesh.polygons, mesh.triangles.len());
        if polygons.of_triangle.len() != count || count == 0 {
            return Self { listed: None, triangles: count };
        }
        // 1. The triangles of each polygon.
        let mut members: Vec<Vec<u32>> = vec![Vec::new(); polygons.triangles.len()];
        for (triangle, &polygon) in polygons.of_triangle.iter().enumerate() {
            if let Some(list) = members.get_mut(polygon as usize) {
                list.push(triangle as u32);
            }
        }
        // 2. Face by face.
        let (mut corners, mut ends) = (Vec::with_capacity(3 * count), Vec::new());
        let mut is_written = vec![false; count];
        for triangle in 0..count {
            if is_written[triangle] {
                continue;
            }
            let polygon = polygons.of_triangle[triangle] as usize;
            let list = members.get(polygon).filter(|list| {
                list.len() >= 2 && list.len() + 2 <= most && list.len() as u32 == polygons.triangles[polygon]
            });
            match list.and_then(|list| outline(mesh, list, &is_one)) {
                Some(outline) => {
                    corners.extend(outline);
                    list.into_iter().flatten().for_each(|&triangle| is_written[triangle as usize] = true);
                }
                None => {
                    let first = 3 * triangle as u32;
                    corners.extend([first, first + 1, first + 2]);
                }
            }
            ends.push(corners.len() as u32);
        }
        Self { listed: Some((corners, ends)), triangles: count }
    }

    /// How many there are.
    pub(crate) fn len(&self) -> usize {
        self.listed.as_ref().map_or(self.triangles, |(_, ends)| ends.len())
    }

    /// Whether all are triangles.
    pub(crate) fn are_triangles(&self) -> bool {
        self.len() == self.triangles
    }

    /// The corners of a face. The first one is one of the triangle whose place the face has.
    pub(crate) fn corners(&self, face: usize) -> impl ExactSizeIterator<Item = u32> + '_ {
        let (start, end) = match &self.listed {
            None => (3 * face, 3 * face + 3),
            Some((_, ends)) => {
                (face.checked_sub(1).map_or(0, |before| ends[before] as usize), ends[face] as usize)
            }
        };
        (start..end).map(move |at| match &self.listed {
            None => at as u32,
            Some((corners, _)) => corners[at],
        })
    }
}

/// The corners around triangles that make one polygon, beginning where all of them meet, if they do: most readers triangulate from
/// there. Nothing if the triangles are no polygon, or differ in what a file says of their corners. O(n log n).
#[cfg(feature = "formats")]
fn outline(mesh: &super::Mesh, triangles: &[u32], is_one: &impl Fn(u32, u32) -> bool) -> Option<Vec<u32>> {
    let vertex = |corner: u32| mesh.triangles[corner as usize / 3][corner as usize % 3];
    // 1. The edges that no other triangle passes the other way, by the vertex where they begin.
    let mut edges: Vec<(u32, u32, u32)> = Vec::with_capacity(3 * triangles.len());
    for &triangle in triangles {
        for k in 0..3 {
            let (from, to) = (3 * triangle + k, 3 * triangle + (k + 1) % 3);
            edges.push((vertex(from), vertex(to), from));
        }
    }
    edges.sort_unstable();
    let passed = |from: u32, to: u32| {
        let at = edges.partition_point(|edge| (edge.0, edge.1) < (from, to));
        edges.get(at).is_some_and(|edge| (edge.0, edge.1) == (from, to))
    };
    let border: Vec<(u32, u32, u32)> = edges.iter().copied().filter(|edge| !passed(edge.1, edge.0)).collect();
    if border.len() != triangles.len() + 2 || border.windows(2).any(|pair| pair[0].0 == pair[1].0) {
        return None;
    }
    // 2. Corners at one vertex are one.
    let mut at = 0;
    let mut fullest = (0, false, 0);
    for (index, edge) in border.iter().enumerate() {
        let start = at;
        while edges.get(at).is_some_and(|other| other.0 == edge.0) {
            if !is_one(edge.2, edges[at].2) {
                return None;
            }
            at += 1;
        }
        // Of several with most triangles the one that the first triangle begins with.
        let begins = triangles.first().is_some_and(|&first| vertex(3 * first) == edge.0);
        fullest = fullest.max((at - start, begins, border.len() - index));
    }
    // 3. Around, from the vertex with the most triangles.
    let first = border.len() - fullest.2;
    let mut outline = Vec::with_capacity(border.len());
    let mut here = first;
    loop {
        outline.push(border[here].2);
        here = border.binary_search_by_key(&border[here].1, |edge| edge.0).ok()?;
        if here == first || outline.len() > border.len() {
            break;
        }
    }
    (outline.len() == border.len()).then_some(outline)
}

#[cfg(test)]
#[cfg(feature = "formats")]
mod tests {
    use super::*;
    use crate::Mesh;

    /// A square of two triangles, a pentagon of three, and a triangle.
    fn plate() -> Mesh {
        let positions = (0..8).map(|i| [f64::from(i), f64::from(i * i), 0.0]).collect();
        let triangles = vec![[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 7], [4, 7, 1], [1, 2, 7]];
        let mut mesh = Mesh::new(positions, triangles);
        mesh.polygons = Polygons::of_faces(&[0, 0, 1, 1, 1, 2]);
        mesh
    }

    fn faces(mesh: &Mesh, most: usize) -> Vec<Vec<u32>> {
        let faces = Faces::of(mesh, most, |_, _| true);
        let vertex = |corner: u32| mesh.triangles.as_flattened()[corner as usize];
        (0..faces.len()).map(|face| faces.corners(face).map(vertex).collect()).collect()
    }

    #[test]
    fn whole_polygons_are_polygons() {
        let mut mesh = plate();
        assert_eq!(mesh.polygons.triangles, [2, 3]);
        assert_eq!(faces(&mesh, 100), [vec![0, 1, 2, 3], vec![4, 5, 6, 7, 1], vec![1, 2, 7]]);
        assert_eq!(faces(&mesh, 4).len(), 5);
        // All turned round.
        mesh.triangles.iter_mut().for_each(|triangle| triangle.swap(1, 2));
        assert_eq!(faces(&mesh, 100)[0], [0, 3, 2, 1]);
        // One turned round, one missing.
        mesh.triangles[0].swap(1, 2);
        assert_eq!(faces(&mesh, 100).len(), 4);
        let mut mesh = plate();
        mesh.triangles.remove(3);
        mesh.polygons.select(&[0, 1, 2, 4, 5]);
        assert_eq!(faces(&mesh, 100).len(), 4);
    }

    #[test]
    fn corners_that_differ_keep_triangles_apart() {
        let mesh = plate();
        let differs = |a: u32, b: u32| !(a.min(b) == 0 && a.max(b) == 3);
        assert_eq!(Faces::of(&mesh, 100, differs).len(), 4);
    }

    #[test]
    fn polygons_are_appended() {
        let mut mesh = Mesh::new(vec![[0.0; 3]; 3], vec![[0, 1, 2]]);
        mesh.append(&plate()).unwrap();
        assert_eq!(mesh.polygons.of_triangle, [Polygons::NONE, 0, 0, 1, 1, 1, Polygons::NONE]);
        mesh.append(&plate()).unwrap();
        assert_eq!((mesh.polygons.of_triangle[7], mesh.polygons.triangles.len()), (2, 4));
        assert_eq!(faces(&mesh, 100).len(), 7);
    }

    #[test]
    fn numbers_that_fit_nothing_are_no_danger() {
        let mut mesh = plate();
        mesh.polygons.of_triangle = vec![9; 6];
        assert_eq!(faces(&mesh, 100).len(), 6);
        mesh.polygons.of_triangle.pop();
        assert_eq!(faces(&mesh, 100).len(), 6);
    }
}
