//! Three numbers of every item of a tree, four items side by side, as their boxes are.

use super::pack::LANES;

/// The marks of the items of a pack. Two items that have one in common are no pair.
#[derive(Clone, Copy, Debug)]
#[repr(align(16))]
pub(crate) struct Marks([[u32; LANES]; 3]);

impl Marks {
    /// Of at most four items.
    pub(super) fn new(items: impl Iterator<Item = [u32; 3]>) -> Self {
        // Places that are not used have boxes that meet nothing: their marks do not matter.
        let mut marks = Self([[0; LANES]; 3]);
        for (lane, of_item) in items.enumerate() {
            (0..3).for_each(|k| marks.0[k][lane] = of_item[k]);
        }
        marks
    }

    /// The pairs of lanes that have a mark in common: lanes i of this pack and j of the other as bit 4 i + j.
    #[inline(always)]
    pub(super) fn shared(&self, other: &Self) -> u32 {
        let mut pairs = 0;
        for i in 0..LANES {
            // All ones where equal, so that this runs on vector registers.
            let mut is_equal = [0u32; LANES];
            for own in &self.0 {
                for others in &other.0 {
                    for lane in 0..LANES {
                        is_equal[lane] |= 0u32.wrapping_sub(u32::from(own[i] == others[lane]));
                    }
                }
            }
            for lane in 0..LANES {
                pairs |= (is_equal[lane] & 1) << (LANES * i + lane);
            }
        }
        pairs
    }
}

#[cfg(test)]
mod tests {
    use rand::rngs::ChaCha8Rng;
    use rand::{RngExt, SeedableRng};

    use super::*;

    #[test]
    fn common_marks_are_found() {
        let mut random = ChaCha8Rng::seed_from_u64(19);
        for _ in 0..500 {
            let mut items = || -> [[u32; 3]; LANES] {
                std::array::from_fn(|_| std::array::from_fn(|_| random.random_range(0..40)))
            };
            let (a, b) = (items(), items());
            let shared = Marks::new(a.into_iter()).shared(&Marks::new(b.into_iter()));
            for i in 0..LANES {
                for j in 0..LANES {
                    let expected = a[i].iter().any(|mark| b[j].contains(mark));
                    assert_eq!(shared >> (LANES * i + j) & 1 == 1, expected, "{a:?} {b:?}");
                }
            }
        }
    }
}
