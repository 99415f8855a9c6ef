//! A step of subdivision: each face becomes four. Everything is a row: weights of vertices of the level before.

use std::f64::consts::PI;

use glam::DVec3;
use rustc_hash::FxHashMap;
use smallvec::SmallVec;

use super::level::{Kind, Level, NONE, Ring, Span, next};
use super::rules::REGULAR_GAMMA;

/// Weights of vertices.
pub(crate) type Row = SmallVec<[(u32, f64); 14]>;

/// Adds a multiple of one row to another.
pub(crate) fn add(row: &mut Row, other: &[(u32, f64)], factor: f64) {
    for &(vertex, weight) in other {
        match row.iter_mut().find(|entry| entry.0 == vertex) {
            Some(entry) => entry.1 += factor * weight,
            None => row.push((vertex, factor * weight)),
        }
    }
}

/// What a row makes of positions.
pub(crate) fn apply(row: &[(u32, f64)], positions: &[DVec3]) -> DVec3 {
    row.iter().fold(DVec3::ZERO, |sum, &(vertex, weight)| sum + positions[vertex as usize] * weight)
}

/// The sharpness after a step.
fn after(sharpness: f64) -> f64 {
    (sharpness - 1.0).max(0.0)
}

impl Level {
    /// What a vertex becomes at the next level.
    pub(crate) fn vertex_row(&self, v: u32) -> Row {
        let ring = self.ring(v);
        if ring.vertices.is_empty() {
            return Row::from_slice(&[(v, 1.0)]);
        }
        let corner = self.corners.get(&v).copied().unwrap_or(0.0);
        let now = self.rule(&ring, corner, |sharpness| sharpness);
        let then = self.rule(&ring, after(corner), after);
        let row = self.masked(v, &ring, now, |sharpness| sharpness);
        if now == then {
            return row;
        }
        // Between two rules: by how much of the sharpness that ends here is left (DeRose, Kass, Truong 1998).
        let ending = ring.edges.iter().map(|&e| self.sharpness[e as usize]).chain([corner]);
        let ending: SmallVec<[f64; 8]> =
            ending.filter(|&sharpness| sharpness > 0.0 && sharpness <= 1.0).collect();
        let weight = (ending.iter().sum::<f64>() / ending.len().max(1) as f64).min(1.0);
        let mut blended = Row::new();
        add(&mut blended, &row, weight);
        add(&mut blended, &self.masked(v, &ring, then, after), 1.0 - weight);
        blended
    }

    fn rule(&self, ring: &Ring, corner: f64, sharp: impl Fn(f64) -> f64) -> Kind {
        if corner > 0.0 {
            return Kind::Corner;
        }
        match ring.edges.iter().filter(|&&e| sharp(self.sharpness[e as usize]) > 0.0).count() {
            // A dart moves as a smooth vertex does.
            0 | 1 => Kind::Smooth,
            2 => Kind::Crease,
            _ => Kind::Corner,
        }
    }

    fn masked(&self, v: u32, ring: &Ring, kind: Kind, sharp: impl Fn(f64) -> f64) -> Row {
        let mut row = Row::new();
        match kind {
            Kind::Corner => row.push((v, 1.0)),
            Kind::Crease => {
                row.push((v, 0.75));
                let ends = ring.vertices.iter().zip(&ring.edges);
                row.extend(
                    ends.filter(|&(_, &e)| sharp(self.sharpness[e as usize]) > 0.0).map(|(&w, _)| (w, 0.125)),
                );
            }
            Kind::Smooth | Kind::Dart => {
                let k = ring.vertices.len();
                let beta = self.rules.beta(k);
                row.push((v, 1.0 - k as f64 * beta));
                row.extend(ring.vertices.iter().map(|&w| (w, beta)));
            }
        }
        row
    }

    /// The point that an edge gets at the next level.
    pub(crate) fn edge_row(&self, e: u32) -> Row {
        let h = self.edges[e as usize];
        let (u, v) = (self.from(h), self.to(h));
        let sharpness = self.sharpness[e as usize];
        if sharpness >= 1.0 {
            return Row::from_slice(&[(u, 0.5), (v, 0.5)]);
        }
        let smooth = self.smooth_edge_row(e);
        if sharpness == 0.0 {
            return smooth;
        }
        let mut row = Row::new();
        add(&mut row, &[(u, 0.5), (v, 0.5)], sharpness);
        add(&mut row, &smooth, 1.0 - sharpness);
        row
    }

    fn smooth_edge_row(&self, e: u32) -> Row {
        let h = self.edges[e as usize];
        let twin = self.twins[h as usize];
        let (u, v) = (self.from(h), self.to(h));
        let (left, right) = (self.to(next(h)), self.to(next(twin)));
        let at = [self.special(u, e), self.special(v, e)];
        // Both ends special, at the first level only: the mean of both masks.
        let gamma = |i: usize| at[i].as_ref().map(|special| special.0);
        let (near_u, near_v) = match (gamma(0), gamma(1)) {
            (None, None) => (REGULAR_GAMMA, REGULAR_GAMMA),
            (Some(gamma), None) => (0.75 - gamma, gamma),
            (None, Some(gamma)) => (gamma, 0.75 - gamma),
            (Some(one), Some(other)) => (0.5 * (0.75 - one + other), 0.5 * (0.75 - other + one)),
        };
        let mut row = Row::from_slice(&[(u, near_u), (v, near_v)]);
        add(&mut row, &[(left, 0.125), (right, 0.125)], 1.0);
        for (end, special) in [u, v].into_iter().zip(&at) {
            if let Some((_, ring, span, place)) = special
                && span.opening.flatness > 0.0
            {
                row = flattened(&row, end, ring, *span, *place);
            }
        }
        row
    }

    /// Whether the edge has the weights of a regular neighbourhood: a crease, or 3/8, 3/8, 1/8, 1/8.
    pub(crate) fn is_regular_edge(&self, e: u32) -> bool {
        let sharpness = self.sharpness[e as usize];
        if sharpness > 0.0 {
            return sharpness.is_infinite();
        }
        let h = self.edges[e as usize];
        [self.from(h), self.to(h)].into_iter().all(|end| match self.special(end, e) {
            None => true,
            Some((gamma, _, span, _)) => {
                (gamma - REGULAR_GAMMA).abs() < 1e-15 && span.opening.flatness == 0.0
            }
        })
    }

    /// The next level and, row by row, its vertices: first those of this level, then one for each edge.
    ///
    /// Face f becomes 4f to 4f + 3: its corners in their order, each with the edge points beside it, then the middle.
    pub(crate) fn refined(&self) -> (Self, Vec<Row>) {
        let vertices = self.vertex_count as u32;
        let mut rows = Vec::with_capacity(self.vertex_count + self.edges.len());
        rows.extend((0..vertices).map(|v| self.vertex_row(v)));
        rows.extend((0..self.edges.len() as u32).map(|e| self.edge_row(e)));
        (self.refined_faces(), rows)
    }

    /// The next level without its weights.
    pub(crate) fn refined_faces(&self) -> Self {
        let vertices = self.vertex_count as u32;
        let halves = self.twins.len();
        let mut faces = Vec::with_capacity(4 * self.faces.len());
        let mut twins = vec![NONE; 4 * halves];
        let mut edge_of = vec![NONE; 4 * halves];
        let mut edges = vec![NONE; 2 * self.edges.len() + halves];
        for (f, &corners) in self.faces.iter().enumerate() {
            let f = f as u32;
            let middle: [u32; 3] = std::array::from_fn(|k| vertices + self.edge_of[3 * f as usize + k]);
            for k in 0..3 {
                faces.push([corners[k], middle[k], middle[(k + 2) % 3]]);
            }
            faces.push(middle);
            for k in 0..3u32 {
                let h = 3 * f + k;
                let edge = self.edge_of[h as usize];
                // The half-edge's two halves: out of its corner, and into the next corner.
                let (out, into) = (3 * (4 * f + k), 3 * (4 * f + (k + 1) % 3) + 2);
                let forward = self.edges[edge as usize] == h;
                let (first, second) = (2 * edge, 2 * edge + 1);
                edge_of[out as usize] = if forward { first } else { second };
                edge_of[into as usize] = if forward { second } else { first };
                let twin = self.twins[h as usize];
                if twin != NONE {
                    let (tf, tk) = (twin / 3, twin % 3);
                    twins[out as usize] = 3 * (4 * tf + (tk + 1) % 3) + 2;
                    twins[into as usize] = 3 * (4 * tf + tk);
                }
                // The edge across corner k: in the corner's face from middle k to middle k + 2, and back in the middle face.
                let (across, back) = (3 * (4 * f + k) + 1, 3 * (4 * f + 3) + (k + 2) % 3);
                let inner = 2 * self.edges.len() as u32 + h;
                (edge_of[across as usize], edge_of[back as usize]) = (inner, inner);
                (twins[across as usize], twins[back as usize]) = (back, across);
            }
        }
        for h in (0..4 * halves as u32).rev() {
            edges[edge_of[h as usize] as usize] = h;
        }
        self.inherited(faces, twins, edge_of, edges)
    }

    /// The next level from its faces, with this level's tags.
    fn inherited(&self, faces: Vec<[u32; 3]>, twins: Vec<u32>, edge_of: Vec<u32>, edges: Vec<u32>) -> Self {
        let vertices = self.vertex_count as u32;
        let mut sharpness = vec![0.0; edges.len()];
        for (e, &before) in self.sharpness.iter().enumerate() {
            sharpness[2 * e] = after(before);
            sharpness[2 * e + 1] = after(before);
        }
        let mut level = Self {
            rules: self.rules,
            faces,
            vertex_count: self.vertex_count + self.edges.len(),
            twins,
            edge_of,
            edges,
            sharpness,
            first: Vec::new(),
            has_sharp: Vec::new(),
            corners: self.corners.iter().map(|(&v, &s)| (v, after(s))).filter(|&(_, s)| s > 0.0).collect(),
            openings: FxHashMap::default(),
        };
        for (&(v, first), &opening) in &self.openings {
            if let Some(edge) = self.edge_between(v, first) {
                level.openings.insert((v, vertices + edge), opening);
            }
        }
        level.find_first();
        level.find_sharp();
        level
    }
}

/// The row of a ring's vertex at place `place` of a sector, pulled into the plane of the two creases at its corner.
fn flattened(row: &Row, corner: u32, ring: &Ring, span: Span, place: usize) -> Row {
    let Span { start, faces, opening } = span;
    let count = ring.vertices.len();
    let step = opening.angle / faces as f64;
    // A half turn leaves the plane open: then nothing is pulled.
    if (opening.angle.sin()).abs() < 1e-6 || faces < 2 || place == 0 || place >= faces {
        return row.clone();
    }
    let first = (((faces - place) as f64) * step).sin() / opening.angle.sin();
    let last = ((place as f64) * step).sin() / opening.angle.sin();
    let (p, q) = (ring.vertices[start], ring.vertices[(start + faces) % count]);
    let mut flat = Row::from_slice(&[(corner, 1.0 - 0.5 * first - 0.5 * last)]);
    add(&mut flat, &[(p, 0.5 * first), (q, 0.5 * last)], 1.0);
    let mut pulled = Row::new();
    add(&mut pulled, row, 1.0 - opening.flatness);
    add(&mut pulled, &flat, opening.flatness);
    pulled
}

/// The angle that tells convex from concave sectors of a cage: beyond it a sector is concave.
pub(crate) const CONCAVE_FROM: f64 = PI + PI / 8.0;
