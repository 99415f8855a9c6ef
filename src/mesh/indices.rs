//! Indices of other widths, as arrays of other languages have them.

use super::Mesh;

/// Rows that are looked at and then narrowed while they are in the first-level cache: 24 KB.
const ROWS: usize = 1 << 10;

impl Mesh {
    /// Triangles of 64-bit indices, three to a triangle; numbers after the last triangle are left out. O(n), about as fast as memory is.
    ///
    /// ```
    /// assert_eq!(trisect::Mesh::triangles_of(&[0, 1, 2, 2, 1, 3], 4), Ok(vec![[0, 1, 2], [2, 1, 3]]));
    /// assert_eq!(trisect::Mesh::triangles_of(&[0, 1, 2, 2, -1, 3], 4), Err(4));
    /// ```
    ///
    /// # Errors
    /// The place among the numbers of the first that is no index below `vertices`, or that 32 bits cannot hold.
    pub fn triangles_of(numbers: &[i64], vertices: usize) -> Result<Vec<[u32; 3]>, usize> {
        let (rows, _) = numbers.as_chunks::<3>();
        let mut triangles = Vec::with_capacity(rows.len());
        let (mut bits, mut largest) = (0i64, 0u32);
        // Without a branch for each number: negative ones and large ones have high bits.
        for rows in rows.chunks(ROWS) {
            bits = rows.as_flattened().iter().fold(bits, |bits, number| bits | number);
            let first = triangles.len();
            triangles.extend(rows.iter().map(|row| row.map(|number| number as u32)));
            largest = triangles[first..].as_flattened().iter().fold(largest, |largest, &n| largest.max(n));
        }
        if bits >> 32 == 0 && (triangles.is_empty() || (largest as usize) < vertices) {
            return Ok(triangles);
        }
        let limit = vertices.min(u32::MAX as usize) as i64;
        Err(numbers.iter().position(|number| !(0..limit).contains(number)).unwrap_or_default())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_index_is_found() {
        let numbers: Vec<i64> = (0..9_000).map(|i| (i * 7) % 500).collect();
        let triangles = Mesh::triangles_of(&numbers, 500).expect("all are indices");
        assert!(
            triangles.as_flattened().iter().zip(&numbers).all(|(&narrow, &wide)| i64::from(narrow) == wide)
        );
        for (place, wrong) in [(0, -1), (3_071, 500), (3_072, 1 << 32), (8_999, i64::MIN), (5_000, i64::MAX)]
        {
            let mut numbers = numbers.clone();
            numbers[place] = wrong;
            assert_eq!(Mesh::triangles_of(&numbers, 500), Err(place), "{wrong}");
        }
        assert_eq!(Mesh::triangles_of(&[], 0), Ok(Vec::new()));
        assert_eq!(Mesh::triangles_of(&[0, 0, 0], 0), Err(0));
    }
}
