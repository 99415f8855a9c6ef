//! Where vertices end up, and the tangent plane there: rows over the vertices of their level.

use std::f64::consts::{PI, TAU};

use super::level::{Kind, Level, Ring, Span};
use super::refine::{Row, add};
use super::rules::dart_eigenvectors;

impl Level {
    /// The limit position of a vertex. Exact where nothing around it is sharp for a while only.
    ///
    /// The masks of the literature hold where all edges around are regular. Beside a vertex with other weights the row is that
    /// of the next level times its refinement; a dart has weights of its own.
    pub(crate) fn limit_row(&self, v: u32) -> Row {
        let ring = self.ring(v);
        if ring.vertices.is_empty() {
            return Row::from_slice(&[(v, 1.0)]);
        }
        let k = ring.vertices.len();
        match self.kind(v, &ring) {
            Kind::Corner => Row::from_slice(&[(v, 1.0)]),
            Kind::Crease => {
                let mut row = Row::from_slice(&[(v, 2.0 / 3.0)]);
                let ends = ring.vertices.iter().zip(&ring.edges);
                row.extend(
                    ends.filter(|&(_, &e)| self.sharpness[e as usize].is_infinite())
                        .map(|(&w, _)| (w, 1.0 / 6.0)),
                );
                row
            }
            Kind::Smooth => {
                let weight = self.rules.limit_weight(k);
                let mut weights = vec![weight; k + 1];
                weights[0] = 1.0 - k as f64 * weight;
                self.ring_row(v, &ring, 0, &weights)
            }
            Kind::Dart => {
                let [limit, ..] = dart_eigenvectors(self.rules, k);
                self.ring_row(v, &ring, self.crease_place(&ring), &limit)
            }
        }
    }

    /// Two rows that span the tangent plane at `v` on the side of `face`: their cross product points outwards. The lengths
    /// have no meaning.
    pub(crate) fn tangent_rows(&self, v: u32, face: u32) -> [Row; 2] {
        let ring = self.ring(v);
        let k = ring.vertices.len();
        let corners = self.faces[face as usize];
        let at = (0..3).find(|&i| corners[i] == v).unwrap_or(0);
        let (after, before) = (corners[(at + 1) % 3], corners[(at + 2) % 3]);
        let kind = self.kind(v, &ring);
        let place = ring.vertices.iter().position(|&w| w == after).unwrap_or(0);
        match kind {
            Kind::Smooth => {
                let turn = |function: fn(f64) -> f64| -> Vec<f64> {
                    std::iter::once(0.0).chain((0..k).map(|i| function(TAU * i as f64 / k as f64))).collect()
                };
                [self.ring_row(v, &ring, 0, &turn(f64::cos)), self.ring_row(v, &ring, 0, &turn(f64::sin))]
            }
            Kind::Dart => {
                let start = self.crease_place(&ring);
                let [_, first, second] = dart_eigenvectors(self.rules, k);
                [self.ring_row(v, &ring, start, &first), self.ring_row(v, &ring, start, &second)]
            }
            Kind::Crease => {
                let span = self.span(v, &ring, kind, place);
                let end = ring.vertices[(span.start + span.faces) % k];
                let along = Row::from_slice(&[(ring.vertices[span.start], 1.0), (end, -1.0)]);
                [along, self.across_row(v, &ring, span)]
            }
            Kind::Corner => {
                let span = self.span(v, &ring, kind, place);
                let sharp = ring.edges.iter().filter(|&&e| self.sharpness[e as usize].is_infinite()).count();
                // The creases of a convex sector; within a concave one, or on a cone, the face's own edges.
                let (first, last) = if sharp >= 2 && span.opening.angle < PI {
                    (ring.vertices[span.start], ring.vertices[(span.start + span.faces) % k])
                } else {
                    (after, before)
                };
                [Row::from_slice(&[(first, 1.0), (v, -1.0)]), Row::from_slice(&[(last, 1.0), (v, -1.0)])]
            }
        }
    }

    /// The direction across a crease into a sector: the left eigenvector of the crease's ring.
    fn across_row(&self, v: u32, ring: &Ring, span: Span) -> Row {
        let (k, count) = (span.faces, ring.vertices.len());
        let theta = PI / k as f64;
        let mut row = Row::new();
        if k == 1 {
            let (p, q) = (ring.vertices[span.start], ring.vertices[(span.start + 1) % count]);
            return Row::from_slice(&[(p, 1.0), (q, 1.0), (v, -2.0)]);
        }
        let end = -0.5 * theta.cos() / (0.5 * theta).tan();
        for i in 0..=k {
            let place = (span.start + i) % count;
            let weight = if i == 0 || i == k { end } else { (theta * i as f64).sin() };
            add(&mut row, &self.edge_row(ring.edges[place]), weight);
        }
        add(&mut row, &self.vertex_row(v), -theta.sin());
        row
    }

    /// A combination of the centre and the ring of the next level, from place `start` of the ring on.
    fn ring_row(&self, v: u32, ring: &Ring, start: usize, weights: &[f64]) -> Row {
        let k = ring.vertices.len();
        let mut row = Row::new();
        if ring.edges.iter().all(|&e| self.sharpness[e as usize] == 0.0 && self.is_regular_edge(e)) {
            add(&mut row, &[(v, 1.0)], weights[0]);
            for i in 0..k {
                add(&mut row, &[(ring.vertices[(start + i) % k], 1.0)], weights[1 + i]);
            }
            return row;
        }
        add(&mut row, &self.vertex_row(v), weights[0]);
        for i in 0..k {
            add(&mut row, &self.edge_row(ring.edges[(start + i) % k]), weights[1 + i]);
        }
        row
    }

    fn crease_place(&self, ring: &Ring) -> usize {
        ring.edges.iter().position(|&e| self.sharpness[e as usize].is_infinite()).unwrap_or(0)
    }
}
