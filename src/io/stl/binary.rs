//! Binary STL: 80 bytes of header, the number of facets, 50 bytes for each.

use super::super::notes::Notes;
use super::super::pieces::Blocks;
use super::super::weld::Weld;
use super::super::{Format, malformed};
use crate::parallel;
use crate::{Control, Error, Mesh};

pub(in crate::io) const HEADER: usize = 84;
const FACET: usize = 50;

/// Facets whose corners are looked up together.
const BATCH: usize = 32;

/// Facets that one of several threads reads: only the vertices of each chunk are looked up among all, by one thread.
const CHUNK: usize = 1 << 14;

/// Chunks that are read before their vertices are looked up: 13 MB of a file. More threads have nothing to do while one looks up.
const MOST_CHUNKS: usize = 16;

/// Where chunks were work for nothing, it is tried again after so many times as many facets.
const WAVES_TO_TRY_AGAIN: usize = 16;

/// The length that a binary STL file with this beginning should have.
pub(in crate::io) fn exact_length(bytes: &[u8]) -> Option<u64> {
    let count = bytes.get(80..HEADER)?.try_into().ok().map(u32::from_le_bytes)?;
    Some(HEADER as u64 + FACET as u64 * u64::from(count))
}

/// How many facets a file of that length has.
pub(super) fn facets_in(length: u64) -> usize {
    (length.saturating_sub(HEADER as u64) / FACET as u64) as usize
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
    read_facets(&mut facets.as_flattened(), count, notes, control)
}

/// Reads so many facets.
pub(super) fn read_facets(
    blocks: &mut dyn Blocks,
    count: usize,
    notes: &mut Notes,
    control: &Control,
) -> Result<Mesh, Error> {
    let mut whole = Chunk::new(count);
    let chunks_at_once = parallel::piece_count(usize::MAX, 1).min(MOST_CHUNKS);
    // Where facets that follow each other have no corners in common, there are as many vertices to look up in the chunks as
    // corners, and chunks are work for nothing. (Two balls whose triangles are in four runs, one thread: 0.17 s for 0.12 s.)
    let (mut first, mut wave, mut is_shared) = (0, 0_usize, true);
    while first < count {
        control.check()?;
        let length = (count - first).min(chunks_at_once * CHUNK);
        let (facets, _) = blocks.next(length * FACET)?.as_chunks::<FACET>();
        if chunks_at_once == 1 || !is_shared && !wave.is_multiple_of(WAVES_TO_TRY_AGAIN) {
            whole.read(facets, first)?;
        } else {
            let mut vertices = 0;
            let chunks = facets.chunks(CHUNK).enumerate().collect();
            for chunk in parallel::map(chunks, |(k, facets)| Chunk::of(facets, first + k * CHUNK)) {
                let chunk = chunk?;
                vertices += chunk.weld.corners().len();
                whole.append(&chunk)?;
            }
            is_shared = vertices < length * 3 / 2;
        }
        (first, wave) = (first + length, wave + 1);
    }
    notes.add("facet with two equal corners dropped", whole.degenerate);
    Ok(Mesh::new(whole.weld.into_positions(), whole.triangles))
}

/// A run of facets, with vertices of its own.
struct Chunk {
    weld: Weld<[f32; 3]>,
    triangles: Vec<[u32; 3]>,
    degenerate: usize,
}

impl Chunk {
    fn new(facets: usize) -> Self {
        Self { weld: Weld::new(Format::Stl, facets), triangles: Vec::with_capacity(facets), degenerate: 0 }
    }

    /// Facets, the first of which is number `first` of the file.
    fn of(facets: &[[u8; FACET]], first: usize) -> Result<Self, Error> {
        let mut chunk = Self::new(facets.len());
        chunk.read(facets, first)?;
        Ok(chunk)
    }

    /// Adds facets, corner by corner; the first is number `first` of the file.
    fn read(&mut self, facets: &[[u8; FACET]], first: usize) -> Result<(), Error> {
        let (batches, rest) = facets.as_chunks::<BATCH>();
        for (i, batch) in batches.iter().enumerate() {
            self.add(batch, first + i * BATCH)?;
        }
        for (i, facet) in rest.iter().enumerate() {
            self.add(&[*facet], first + facets.len() - rest.len() + i)?;
        }
        Ok(())
    }

    /// Adds facets, the first of which is number `first` of the file.
    fn add<const N: usize>(&mut self, facets: &[[u8; FACET]; N], first: usize) -> Result<(), Error> {
        let mut numbers = [[[0.0; 3]; 3]; N];
        for (i, facet) in facets.iter().enumerate() {
            numbers[i] = corners(facet);
            if !numbers[i].as_flattened().iter().all(|coordinate| coordinate.is_finite()) {
                return Err(malformed(
                    Format::Stl,
                    format!("byte {}", HEADER + (first + i) * FACET),
                    format!("facet {} has a coordinate that is not a finite number", first + i),
                ));
            }
        }
        // Corner by corner, in the order of the file.
        let mut triangles = [[0; 3]; N];
        self.weld.vertices(numbers.as_flattened(), triangles.as_flattened_mut())?;
        for triangle in triangles {
            if triangle[0] == triangle[1] || triangle[1] == triangle[2] || triangle[2] == triangle[0] {
                self.degenerate += 1;
            } else {
                self.triangles.push(triangle);
            }
        }
        Ok(())
    }

    /// Adds the facets that follow: their vertices are looked up once each, and numbered as if read in one run.
    fn append(&mut self, later: &Self) -> Result<(), Error> {
        let mut numbers = vec![0; later.weld.corners().len()];
        self.weld.vertices(later.weld.corners(), &mut numbers)?;
        self.triangles
            .extend(later.triangles.iter().map(|triangle| triangle.map(|corner| numbers[corner as usize])));
        self.degenerate += later.degenerate;
        Ok(())
    }
}

/// The corners of a facet, after its normal; zeros made positive.
#[inline(always)]
fn corners(facet: &[u8; FACET]) -> [[f32; 3]; 3] {
    let (numbers, _) = facet[12..48].as_chunks::<4>();
    let number = |i: usize| f32::from_le_bytes(numbers[i]) + 0.0;
    [[number(0), number(1), number(2)], [number(3), number(4), number(5)], [number(6), number(7), number(8)]]
}
