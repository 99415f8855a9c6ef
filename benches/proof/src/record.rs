//! The records that the comparison reads: little-endian, one after the other, no padding.
//!
//! ```text
//! u64 seed; u8 family, operation; u16 faults
//! twice (A, B): u32 vertices, triangles; f64[3] each vertex; u32[3] each triangle
//! f64 volume, area; i64 Euler characteristic; u32 components, triangles, points judged, mistakes
//! f64 error of the volume identity, relative to the box; f64 farthest point within rounding, in ulps
//! ```

use std::io::{self, Read, Write};

use crate::judge::cases::{Case, Family, OPERATIONS};
use crate::judge::many::{self, Many};
use crate::run::Found;
use trisect::Mesh;

pub(crate) fn write(out: &mut impl Write, seed: u64, case: &Case, found: &Found) -> io::Result<()> {
    let operation = OPERATIONS.iter().position(|&operation| operation == case.operation).unwrap_or(0);
    head(out, seed, case.family, operation, found)?;
    mesh(out, &case.a)?;
    mesh(out, &case.b)?;
    tail(out, found)
}

/// The record of a case of several bodies: instead of A and B `u32` operands, for each `u32` bodies and these; `u32` length of an
/// expression as JSON, and its text. The operation is the number behind the last.
pub(crate) fn write_many(out: &mut impl Write, seed: u64, case: &Many, found: &Found) -> io::Result<()> {
    head(out, seed, case.family, OPERATIONS.len(), found)?;
    count(out, case.operands.len())?;
    for bodies in &case.operands {
        count(out, bodies.len())?;
        bodies.iter().try_for_each(|body| mesh(out, body))?;
    }
    let text = many::json(&case.expression);
    count(out, text.len())?;
    out.write_all(text.as_bytes())?;
    tail(out, found)
}

fn count(out: &mut impl Write, count: usize) -> io::Result<()> {
    out.write_all(&(count as u32).to_le_bytes())
}

fn head(out: &mut impl Write, seed: u64, family: Family, operation: usize, found: &Found) -> io::Result<()> {
    let family = Family::ALL.iter().position(|&of| of == family).unwrap_or(0);
    out.write_all(&seed.to_le_bytes())?;
    out.write_all(&[family as u8, operation as u8])?;
    out.write_all(&found.faults.to_le_bytes())
}

fn tail(out: &mut impl Write, found: &Found) -> io::Result<()> {
    for value in [found.volume, found.area] {
        out.write_all(&value.to_le_bytes())?;
    }
    out.write_all(&found.euler.to_le_bytes())?;
    for number in [found.components, found.triangles, found.judged, found.mistakes] {
        count(out, number)?;
    }
    for value in [found.identity_error, found.farthest_rounded] {
        out.write_all(&value.to_le_bytes())?;
    }
    Ok(())
}

fn mesh(out: &mut impl Write, mesh: &Mesh) -> io::Result<()> {
    count(out, mesh.positions.len())?;
    count(out, mesh.triangles.len())?;
    for x in mesh.positions.iter().flatten() {
        out.write_all(&x.to_le_bytes())?;
    }
    for v in mesh.triangles.iter().flatten() {
        out.write_all(&v.to_le_bytes())?;
    }
    Ok(())
}

/// A mesh in the form of the records.
pub(crate) fn read_mesh(input: &mut impl Read) -> io::Result<Mesh> {
    let mut word = [0; 4];
    let mut number = |input: &mut dyn Read| {
        input.read_exact(&mut word)?;
        io::Result::Ok(u32::from_le_bytes(word))
    };
    let (vertices, triangles) = (number(input)?, number(input)?);
    let mut mesh = Mesh::default();
    for _ in 0..vertices {
        let mut point = [0.0; 3];
        for x in &mut point {
            let mut bytes = [0; 8];
            input.read_exact(&mut bytes)?;
            *x = f64::from_le_bytes(bytes);
        }
        mesh.positions.push(point);
    }
    for _ in 0..triangles {
        mesh.triangles.push([number(input)?, number(input)?, number(input)?]);
    }
    Ok(mesh)
}
