//! Texture coordinates and normals that faces name corner by corner.

/// What stands for no index.
pub(super) const NO_INDEX: u32 = u32::MAX;

/// The texture coordinates and normals that faces name: for each corner its vertex, its texture coordinates and its normal.
#[derive(Debug, Default)]
pub(super) struct Labels {
    pub(super) corners: Vec<[u32; 3]>,
    /// The end of each face's corners; faces after the last one have none.
    pub(super) ends: Vec<u32>,
}

/// What the corners of one chunk's triangles name.
pub(super) struct ChunkCorners {
    pub(super) texture: Vec<u32>,
    pub(super) normals: Vec<u32>,
    /// Texture coordinates and normals that are named and not there.
    pub(super) beyond: usize,
}

/// The labels of each corner of triangles, each of a face; `counts` are those of all texture coordinates and normals.
pub(super) fn of_triangles(
    triangles: &[[u32; 3]],
    faces: &[u32],
    labels: &Labels,
    counts: [usize; 2],
) -> ChunkCorners {
    let room = if labels.corners.is_empty() { 0 } else { 3 * triangles.len() };
    let mut found = ChunkCorners {
        texture: Vec::with_capacity(if counts[0] > 0 { room } else { 0 }),
        normals: Vec::with_capacity(if counts[1] > 0 { room } else { 0 }),
        beyond: 0,
    };
    if room == 0 {
        return found;
    }
    let mut checked = |index: u32, count: usize| {
        let is_there = (index as usize) < count;
        found.beyond += usize::from(!is_there && index != NO_INDEX);
        if is_there { index } else { NO_INDEX }
    };
    for (triangle, &face) in triangles.iter().zip(faces) {
        let face = face as usize;
        let start = face.checked_sub(1).and_then(|before| labels.ends.get(before)).copied().unwrap_or(0);
        let corners = match labels.ends.get(face) {
            Some(&end) => labels.corners.get(start as usize..end as usize).unwrap_or_default(),
            None => &[],
        };
        for (k, &vertex) in triangle.iter().enumerate() {
            // Of a triangle the corners are in order; of a polygon the one with the vertex.
            let usual = corners.get(k).filter(|label| label[0] == vertex && corners.len() == 3);
            let label = usual.or_else(|| corners.iter().find(|label| label[0] == vertex));
            let [_, texture, normal] = label.copied().unwrap_or([NO_INDEX; 3]);
            if counts[0] > 0 {
                found.texture.push(checked(texture, counts[0]));
            }
            if counts[1] > 0 {
                found.normals.push(checked(normal, counts[1]));
            }
        }
    }
    found
}

/// Whether two values are the same but for rounding to single precision: those of two faces at an edge may have been computed on
/// different ways.
pub(super) fn agree(a: Option<&[f64]>, b: Option<&[f64]>) -> bool {
    const STEP: f64 = f32::EPSILON as f64;
    match (a, b) {
        (Some(a), Some(b)) => {
            a.iter().zip(b).all(|(a, b)| (a - b).abs() <= STEP * a.abs().max(b.abs()).max(1.0))
        }
        (a, b) => a.is_none() == b.is_none(),
    }
}

/// A coordinate counted from the lower edge of a picture, given from the upper one: the shortest decimal that reading turns into
/// the same number again, so that what was read is written as it was.
pub(super) fn from_below(v: f64) -> f64 {
    let exact = 1.0 - v;
    for scale in [1e6, 1e9, 1e12, 1e15] {
        let short = (exact * scale).round() / scale;
        if 1.0 - short == v {
            return short;
        }
    }
    exact
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_read_is_written_as_it_was() {
        for text in ["0.1", "0.375", "0.0001", "0.999999", "1", "0", "5.25", "-0.3", "0.123456789012"] {
            let value: f64 = text.parse().unwrap();
            assert_eq!(from_below(1.0 - value).to_string(), text);
        }
        for v in [1.0 / 3.0, 0.1_f32.into(), 1e-12] {
            assert!((from_below(v) - (1.0 - v)).abs() < 1e-15);
        }
    }
}
