//! Where vertices of a level of quads end up.

use glam::DVec3;

use super::level::PolygonLevel;
use crate::subdivision::level::Kind;
use crate::subdivision::tags::{Corner, Crease, Tags};

/// Steps of the power iteration: the second eigenvalue is at most 0.9 for up to 40 faces.
const STEPS: usize = 400;

impl PolygonLevel {
    /// The limit of a vertex all of whose faces are quads. Exact: weights of the literature at smooth vertices, creases and
    /// corners, the eigenvector of its ring at a dart; what is sharp for a while is subdivided first, with the faces around it.
    pub(crate) fn limit(&self, v: u32, positions: &[DVec3]) -> DVec3 {
        let spokes = self.spokes(v);
        let own = positions[v as usize];
        if spokes.halves.is_empty() {
            return own;
        }
        let corner = self.corner(v);
        if is_finite(corner) || spokes.edges.iter().any(|&e| is_finite(self.sharpness[e as usize])) {
            return self.limit_of_semi_sharp(v, positions);
        }
        let across = |h: u32| positions[self.to(self.next(h)) as usize];
        let at = |w: &u32| positions[*w as usize];
        match self.kind(&spokes, corner, f64::is_infinite) {
            Kind::Corner => own,
            Kind::Crease => {
                let ends = spokes.vertices.iter().zip(&spokes.edges);
                let ends = ends.filter(|&(_, &e)| self.sharpness[e as usize].is_infinite());
                ends.fold(own * (2.0 / 3.0), |sum, (w, _)| sum + at(w) / 6.0)
            }
            Kind::Smooth => {
                let k = spokes.halves.len() as f64;
                let near = spokes.vertices.iter().fold(DVec3::ZERO, |sum, w| sum + at(w));
                let far = spokes.halves.iter().fold(DVec3::ZERO, |sum, &h| sum + across(h));
                (own * (k * k) + near * 4.0 + far) / (k * (k + 5.0))
            }
            Kind::Dart => {
                let k = spokes.halves.len();
                let is_crease = |&e: &u32| self.sharpness[e as usize].is_infinite();
                let start = spokes.edges.iter().position(is_crease).unwrap_or(0);
                let weights = dart_weights(k);
                (0..k).fold(own * weights[0], |sum, i| {
                    let place = (start + i) % k;
                    let (near, far) = (at(&spokes.vertices[place]), across(spokes.halves[place]));
                    sum + near * weights[1 + i] + far * weights[1 + k + i]
                })
            }
        }
    }

    /// The faces around the vertex alone, subdivided until nothing around it is sharp for a while only: what it becomes
    /// depends on no others.
    fn limit_of_semi_sharp(&self, v: u32, positions: &[DVec3]) -> DVec3 {
        let mut part = self.around(v, positions);
        while let Some((level, points)) = &part {
            let sharp = level.spokes(0).edges.iter().map(|&e| level.sharpness[e as usize]).fold(
                level.corner(0),
                |a, b| {
                    if is_finite(b) { b } else { a }
                },
            );
            if !is_finite(sharp) {
                return level.limit(0, points);
            }
            let (next, points) = level.refined(points);
            part = next.around(0, &points);
        }
        positions[v as usize]
    }

    /// The faces around a vertex, which becomes vertex 0, alone.
    pub(super) fn around(&self, v: u32, positions: &[DVec3]) -> Option<(Self, Vec<DVec3>)> {
        let spokes = self.spokes(v);
        let mut vertices = vec![v];
        let mut faces = Vec::with_capacity(spokes.halves.len());
        for &h in &spokes.halves {
            let mut face = Vec::with_capacity(4);
            for &w in self.face(self.face_of[h as usize] as usize) {
                let known = vertices.iter().position(|&x| x == w);
                face.push(known.unwrap_or_else(|| {
                    vertices.push(w);
                    vertices.len() - 1
                }) as u32);
            }
            faces.push(face);
        }
        let mut tags = Tags::default();
        for (&w, &e) in spokes.vertices.iter().zip(&spokes.edges) {
            let place = vertices.iter().position(|&x| x == w)? as u32;
            tags.creases.push(Crease { edge: [0, place], sharpness: self.sharpness[e as usize] });
        }
        if self.corner(v) > 0.0 {
            tags.corners.push(Corner { vertex: 0, sharpness: self.corner(v) });
        }
        let points: Vec<DVec3> = vertices.iter().map(|&w| positions[w as usize]).collect();
        Some((Self::new(points.len(), &faces, &tags).ok()?, points))
    }
}

/// Whether something is sharp for a while only.
fn is_finite(sharpness: f64) -> bool {
    sharpness > 0.0 && sharpness.is_finite()
}

/// The weights of a dart's limit with k faces around it: the centre, the k neighbours, the crease's end first, and the k
/// vertices across the faces after them. The left eigenvector of its ring's refinement to the eigenvalue 1. O(k).
pub(crate) fn dart_weights(k: usize) -> Vec<f64> {
    let count = k as f64;
    let mut weights = vec![1.0 / (2 * k + 1) as f64; 2 * k + 1];
    for _ in 0..STEPS {
        // What the points of the next ring weigh is shared out to those that they are made of.
        let mut next = vec![0.0; 2 * k + 1];
        let own = weights[0] / (count * count);
        let mut faces: Vec<f64> = weights[1 + k..].iter().map(|weight| weight + own).collect();
        next[0] = weights[0] * (count - 2.0) / count + 0.5 * weights[1];
        next[1] = own + 0.5 * weights[1];
        for i in 1..k {
            let quarter = 0.25 * weights[1 + i];
            next[0] += quarter;
            next[1 + i] = own + quarter;
            faces[i] += quarter;
            faces[i - 1] += quarter;
        }
        for (i, face) in faces.into_iter().enumerate() {
            for place in [0, 1 + i, 1 + k + i, 1 + (i + 1) % k] {
                next[place] += 0.25 * face;
            }
        }
        let sum: f64 = next.iter().sum();
        weights = next.into_iter().map(|weight| weight / sum).collect();
    }
    weights
}
