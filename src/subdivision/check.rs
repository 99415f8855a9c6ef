//! What a cage must be, and what is derived of it when it is made.

use std::f64::consts::PI;

use glam::DVec3;

use super::error::CageError;
use super::level::{Kind, Level, Opening};
use super::refine::CONCAVE_FROM;
use super::tags::{Sector, Tags};

/// Refuses coordinates that are not finite, indices of no vertex, and values without meaning.
pub(super) fn check<'f>(
    positions: &[[f64; 3]],
    faces: impl Iterator<Item = &'f [u32]>,
    tags: &Tags,
) -> Result<(), CageError> {
    let count = positions.len();
    if let Some(vertex) = positions.iter().position(|p| !p.iter().all(|x| x.is_finite())) {
        return Err(CageError::NotFinite { vertex });
    }
    let known = |what: &dyn Fn() -> String, vertex: u32| {
        if (vertex as usize) < count {
            return Ok(());
        }
        Err(CageError::NoSuchVertex { what: what(), vertex: u64::from(vertex), count })
    };
    for (f, face) in faces.enumerate() {
        for (k, &vertex) in face.iter().enumerate() {
            known(&|| format!("face {f}"), vertex)?;
            // (Of faces with very many corners, neighbours alone: a look at all others would take too long.)
            let others = if face.len() > 64 { &face[k.saturating_sub(1)..k] } else { &face[..k] };
            if others.contains(&vertex) {
                return Err(CageError::RepeatedVertex { face: f, vertex });
            }
        }
    }
    let sharp = |what: &str, sharpness: f64| {
        if sharpness >= 0.0 {
            return Ok(());
        }
        Err(CageError::Tag(format!("{what} has sharpness {sharpness}; it must be 0 or more")))
    };
    for crease in &tags.creases {
        let what = || format!("crease {}-{}", crease.edge[0], crease.edge[1]);
        known(&what, crease.edge[0])?;
        known(&what, crease.edge[1])?;
        sharp(&what(), crease.sharpness)?;
    }
    for corner in &tags.corners {
        known(&|| "a corner".into(), corner.vertex)?;
        sharp(&format!("corner {}", corner.vertex), corner.sharpness)?;
    }
    for sector in &tags.sectors {
        known(&|| "a sector".into(), sector.vertex)?;
        known(&|| "a sector".into(), sector.first)?;
        let turns = sector.angle > 0.0 && sector.angle < 2.0 * PI && (sector.angle - PI).abs() > 1e-3;
        if !turns || !(0.0..=1.0).contains(&sector.flatness) {
            return Err(CageError::Tag(format!(
                "the sector at {} from {} has angle {} and flatness {}; angles are between 0 and 2 pi, but not pi, and flatness \
                 is 0 to 1",
                sector.vertex, sector.first, sector.angle, sector.flatness
            )));
        }
    }
    Ok(())
}

/// Notes which sectors at corners are concave, where nothing is said of them.
pub(super) fn note_concave(level: &mut Level, positions: &[[f64; 3]]) {
    let mut found = Vec::new();
    for v in 0..level.vertex_count as u32 {
        let ring = level.ring(v);
        if ring.vertices.is_empty() || level.kind(v, &ring) != Kind::Corner {
            continue;
        }
        let count = ring.vertices.len();
        for place in 0..ring.face_count() {
            let span = level.span(v, &ring, Kind::Corner, place);
            let sharp = level.sharpness[ring.edges[span.start] as usize].is_infinite();
            let key = (v, ring.vertices[span.start]);
            if span.start != place || !sharp || span.faces < 2 || level.openings.contains_key(&key) {
                continue;
            }
            let at = |i: usize| {
                DVec3::from(positions[ring.vertices[i % count] as usize]) - DVec3::from(positions[v as usize])
            };
            let opening: f64 = (0..span.faces).map(|i| at(place + i).angle_between(at(place + i + 1))).sum();
            if opening > CONCAVE_FROM {
                found.push(Sector { vertex: v, first: key.1, angle: 1.5 * PI, flatness: 0.5 });
            }
        }
    }
    for Sector { vertex, first, angle, flatness } in found {
        level.openings.insert((vertex, first), Opening { angle, flatness });
    }
}
