//! A step of Catmull and Clark's subdivision: each corner of a face becomes a quad. Weights are those of DeRose, Kass and Truong
//! (1998), which OpenSubdiv and most modellers have.

use glam::DVec3;
use smallvec::SmallVec;

use super::level::PolygonLevel;
use crate::subdivision::level::{Kind, NONE};

/// The sharpness after a step.
fn after(sharpness: f64) -> f64 {
    (sharpness - 1.0).max(0.0)
}

impl PolygonLevel {
    /// The next level and its vertices: those of this level, then one for each edge, then one for each face.
    ///
    /// Corner h becomes quad h: the vertex, the point of the edge after it, the face's point, the point of the edge before it.
    pub(crate) fn refined(&self, positions: &[DVec3]) -> (Self, Vec<DVec3>) {
        let faces: Vec<DVec3> = (0..self.face_count())
            .map(|f| {
                let face = self.face(f);
                face.iter().fold(DVec3::ZERO, |sum, &v| sum + positions[v as usize]) / face.len() as f64
            })
            .collect();
        let mut next = Vec::with_capacity(self.vertex_count + self.edges.len() + faces.len());
        next.extend((0..self.vertex_count as u32).map(|v| self.vertex_point(v, positions, &faces)));
        next.extend((0..self.edges.len()).map(|e| self.edge_point(e, positions, &faces)));
        next.extend(&faces);
        (self.refined_faces(), next)
    }

    fn edge_point(&self, e: usize, positions: &[DVec3], faces: &[DVec3]) -> DVec3 {
        let h = self.edges[e];
        let ends = positions[self.from(h) as usize] + positions[self.to(h) as usize];
        let sharpness = self.sharpness[e];
        if sharpness >= 1.0 {
            return ends * 0.5;
        }
        let side = |h: u32| faces[self.face_of[h as usize] as usize];
        let smooth = (ends + side(h) + side(self.twins[h as usize])) * 0.25;
        if sharpness == 0.0 { smooth } else { smooth.lerp(ends * 0.5, sharpness) }
    }

    fn vertex_point(&self, v: u32, positions: &[DVec3], faces: &[DVec3]) -> DVec3 {
        let spokes = self.spokes(v);
        let own = positions[v as usize];
        let corner = self.corner(v);
        if spokes.halves.is_empty() {
            return own;
        }
        let masked = |kind: Kind, lost: f64| match kind {
            Kind::Corner => own,
            Kind::Crease => {
                let ends = spokes.vertices.iter().zip(&spokes.edges);
                let ends = ends.filter(|&(_, &e)| self.sharpness[e as usize] > lost);
                ends.fold(own * 0.75, |sum, (&w, _)| sum + positions[w as usize] * 0.125)
            }
            // A dart moves as a smooth vertex does.
            Kind::Smooth | Kind::Dart => {
                let n = spokes.halves.len() as f64;
                let near = spokes.vertices.iter().fold(DVec3::ZERO, |sum, &w| sum + positions[w as usize]);
                let across = spokes
                    .halves
                    .iter()
                    .fold(DVec3::ZERO, |sum, &h| sum + faces[self.face_of[h as usize] as usize]);
                own * ((n - 2.0) / n) + (near + across) / (n * n)
            }
        };
        let rule = |lost: f64| match self.kind(&spokes, corner, |sharpness| sharpness > lost) {
            Kind::Dart => Kind::Smooth,
            kind => kind,
        };
        let (now, then) = (rule(0.0), rule(1.0));
        if now == then {
            return masked(now, 0.0);
        }
        // Between two rules: by how much of the sharpness that ends here is left.
        let ending = spokes.edges.iter().map(|&e| self.sharpness[e as usize]).chain([corner]);
        let ending: SmallVec<[f64; 8]> = ending.filter(|&s| s > 0.0 && s <= 1.0).collect();
        let weight = (ending.iter().sum::<f64>() / ending.len().max(1) as f64).min(1.0);
        masked(then, 1.0).lerp(masked(now, 0.0), weight)
    }

    /// The next level without its positions.
    pub(crate) fn refined_faces(&self) -> Self {
        let halves = self.corners.len();
        let (vertices, edges) = (self.vertex_count as u32, self.edges.len() as u32);
        let mut next = Self {
            vertex_count: self.vertex_count + self.edges.len() + self.face_count(),
            corners: Vec::with_capacity(4 * halves),
            starts: (0..=halves as u32).map(|h| 4 * h).collect(),
            face_of: (0..4 * halves as u32).map(|h| h / 4).collect(),
            twins: Vec::with_capacity(4 * halves),
            edge_of: Vec::with_capacity(4 * halves),
            edges: vec![NONE; 2 * edges as usize + halves],
            sharpness: Vec::with_capacity(2 * edges as usize + halves),
            first: Vec::new(),
            sharp_corners: self
                .sharp_corners
                .iter()
                .map(|(&v, &sharpness)| (v, after(sharpness)))
                .filter(|&(_, sharpness)| sharpness > 0.0)
                .collect(),
        };
        let or_none = |twin: u32, of: &dyn Fn(u32) -> u32| if twin == NONE { NONE } else { of(twin) };
        for h in 0..halves as u32 {
            let before = self.previous(h);
            let (edge, edge_before) = (self.edge_of[h as usize], self.edge_of[before as usize]);
            let face = vertices + edges + self.face_of[h as usize];
            next.corners.extend([self.from(h), vertices + edge, face, vertices + edge_before]);
            next.twins.extend([
                or_none(self.twins[h as usize], &|twin| 4 * self.next(twin) + 3),
                4 * self.next(h) + 2,
                4 * before + 1,
                or_none(self.twins[before as usize], &|twin| 4 * twin),
            ]);
            // The half of an edge at its beginning is 2e, the other one 2e + 1; then one edge for each half-edge to the face's
            // point.
            let out = 2 * edge + u32::from(self.edges[edge as usize] != h);
            let into = 2 * edge_before + u32::from(self.edges[edge_before as usize] == before);
            next.edge_of.extend([out, 2 * edges + h, 2 * edges + before, into]);
        }
        for h in (0..next.edge_of.len()).rev() {
            next.edges[next.edge_of[h] as usize] = h as u32;
        }
        for (e, &sharpness) in self.sharpness.iter().enumerate() {
            let border = self.twins[self.edges[e] as usize] == NONE;
            next.sharpness.extend([if border { f64::INFINITY } else { after(sharpness) }; 2]);
        }
        next.sharpness.resize(2 * edges as usize + halves, 0.0);
        next.find_first();
        next
    }
}
