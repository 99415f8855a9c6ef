//! Binary STL: 80 bytes of header, the number of facets, 50 bytes for each.

use super::super::notes::Notes;
use super::super::{Format, malformed};
use super::weld::Weld;
use crate::{Control, Error, Mesh};

const HEADER: usize = 84;
const FACET: usize = 50;

/// Facets between two looks at the limits.
const CHECK_INTERVAL: usize = 1 << 14;

/// The length that a binary STL file with this beginning should have.
pub(in crate::io) fn exact_length(bytes: &[u8]) -> Option<u64> {
    let count = bytes.get(80..HEADER)?.try_into().ok().map(u32::from_le_bytes)?;
    Some(HEADER as u64 + FACET as u64 * u64::from(count))
}

/// Reads the facets that are there.
pub(super) fn read(bytes: &[u8], notes: &mut Notes, control: &Control) -> Result<Mesh, Error> {
    let Some(expected) = exact_length(bytes) else {
        return Err(malformed(
            Format::Stl,
            "byte 0",
            format!(
                "{} bytes are too few for a binary STL file, and it is no ASCII STL file, which would begin with \
                 \"solid\"",
                bytes.len()
            ),
        ));
    };
    let (facets, rest) = bytes[HEADER..].as_chunks::<FACET>();
    let announced = (expected - HEADER as u64) / FACET as u64;
    let count = if announced == facets.len() as u64 || rest.is_empty() && matches!(announced, 0 | 0xffff_ffff)
    {
        // Programs that write to a pipe cannot go back to fill in the count.
        if announced != facets.len() as u64 {
            notes.say(format!("the header announces {announced} facets; all {} were read", facets.len()));
        }
        facets.len()
    } else if announced > facets.len() as u64 {
        return Err(malformed(
            Format::Stl,
            format!("byte {}", bytes.len()),
            format!(
                "the header announces {announced} facets, but the file ends after {}; it is cut off (export or \
                 download it again) or not an STL file",
                facets.len()
            ),
        ));
    } else {
        let surplus = bytes.len() as u64 - expected;
        notes.say(format!("{surplus} bytes after the last facet ignored"));
        announced as usize
    };

    let _reservation = control.reserve(count as u64 * 28)?;
    let mut weld = Weld::new(count);
    let mut triangles = Vec::with_capacity(count);
    let mut degenerate = 0;
    for (block, chunk) in facets[..count].chunks(CHECK_INTERVAL).enumerate() {
        control.check()?;
        for (i, facet) in chunk.iter().enumerate() {
            let corners = corners(facet);
            if !corners.as_flattened().iter().all(|coordinate| coordinate.is_finite()) {
                let facet = block * CHECK_INTERVAL + i;
                return Err(malformed(
                    Format::Stl,
                    format!("byte {}", HEADER + facet * FACET),
                    format!("facet {facet} has a coordinate that is not a finite number"),
                ));
            }
            let [a, b, c] = corners;
            let triangle = [weld.vertex(a)?, weld.vertex(b)?, weld.vertex(c)?];
            if triangle[0] == triangle[1] || triangle[1] == triangle[2] || triangle[2] == triangle[0] {
                degenerate += 1;
            } else {
                triangles.push(triangle);
            }
        }
    }
    notes.add("facet with two equal corners dropped", degenerate);
    Ok(Mesh::new(weld.into_positions(), triangles))
}

/// The corners of a facet, after its normal; zeros made positive.
#[inline(always)]
fn corners(facet: &[u8; FACET]) -> [[f32; 3]; 3] {
    let (numbers, _) = facet[12..48].as_chunks::<4>();
    let number = |i: usize| f32::from_le_bytes(numbers[i]) + 0.0;
    [[number(0), number(1), number(2)], [number(3), number(4), number(5)], [number(6), number(7), number(8)]]
}
