//! In which order many operands are united: halves of space by halves of space, so that neighbours meet early, and what is
//! united keeps a simple shape.

/// Rounds of pairs to merge; the pairs of a round have nothing in common. The second of a pair is merged into the place of
/// the first.
///
/// Space is halved along its longer side, where possible between operands that lie in layers: rows and grids are then put
/// together from whole layers. O(n log^2 n).
pub(crate) fn halving(centres: &[[f64; 3]]) -> Vec<Vec<[usize; 2]>> {
    let mut rounds = Vec::new();
    let mut all: Vec<usize> = (0..centres.len()).collect();
    if !all.is_empty() {
        halve(centres, &mut all, &mut rounds);
    }
    rounds
}

/// What merging some operands gives: the place it ends at, and in how many rounds.
fn halve(centres: &[[f64; 3]], part: &mut [usize], rounds: &mut Vec<Vec<[usize; 2]>>) -> (usize, usize) {
    if let [only] = *part {
        return (only, 0);
    }
    let extent = |axis: usize| {
        let (low, high) = part.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &i| {
            (low.min(centres[i][axis]), high.max(centres[i][axis]))
        });
        high - low
    };
    let extents = [0, 1, 2].map(extent);
    let axis = (1..3).fold(0, |best, axis| if extents[axis] > extents[best] { axis } else { best });
    part.sort_unstable_by(|&i, &j| centres[i][axis].total_cmp(&centres[j][axis]).then(i.cmp(&j)));
    let (first, second) = part.split_at_mut(cut_between_layers(part, |i| centres[i][axis]));
    let ((x, round_x), (y, round_y)) = (halve(centres, first, rounds), halve(centres, second, rounds));
    let round = round_x.max(round_y);
    if rounds.len() <= round {
        rounds.resize(round + 1, Vec::new());
    }
    rounds[round].push([x, y]);
    (x, round + 1)
}

/// Where to cut a sorted list: at the change of coordinate next to its middle, unless one part were below a quarter.
fn cut_between_layers(sorted: &[usize], coordinate: impl Fn(usize) -> f64) -> usize {
    let (count, middle) = (sorted.len(), sorted.len() / 2);
    let changes = |cut: usize| coordinate(sorted[cut - 1]) < coordinate(sorted[cut]);
    (0..=count / 4)
        .flat_map(|away| [middle - away, middle + away])
        .filter(|&cut| 0 < cut && cut < count)
        .find(|&cut| changes(cut))
        .unwrap_or(middle)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn everything_is_merged_once_and_in_time() {
        let centres: Vec<[f64; 3]> = (0..100).map(|i| [f64::from(i % 7), f64::from(i % 3), 0.0]).collect();
        let mut groups: Vec<Vec<usize>> = (0..100).map(|i| vec![i]).collect();
        for round in halving(&centres) {
            let mut used: Vec<usize> = round.iter().flatten().copied().collect();
            used.sort_unstable();
            let count = used.len();
            used.dedup();
            assert_eq!(used.len(), count, "pairs of a round have nothing in common");
            for [x, y] in round {
                assert!(!groups[x].is_empty() && !groups[y].is_empty());
                let other = std::mem::take(&mut groups[y]);
                groups[x].extend(other);
            }
        }
        let left: Vec<&Vec<usize>> = groups.iter().filter(|group| !group.is_empty()).collect();
        assert_eq!(left.len(), 1);
        assert_eq!(left[0].len(), 100);
    }

    #[test]
    fn a_grid_is_put_together_from_boxes() {
        let centres: Vec<[f64; 3]> = (0..125).map(|i| [i % 5, i / 5 % 5, i / 25].map(f64::from)).collect();
        let mut groups: Vec<Vec<usize>> = (0..125).map(|i| vec![i]).collect();
        for [x, y] in halving(&centres).into_iter().flatten() {
            let other = std::mem::take(&mut groups[y]);
            groups[x].extend(other);
            let cells: usize = (0..3)
                .map(|k| {
                    let along = || groups[x].iter().map(|&i| centres[i][k] as usize);
                    along().max().unwrap() - along().min().unwrap() + 1
                })
                .product();
            assert_eq!(cells, groups[x].len(), "{:?} fill a box", groups[x]);
        }
    }

    #[test]
    fn equal_centres_are_halved_all_the_same() {
        let rounds = halving(&[[1.0; 3]; 64]);
        assert_eq!(rounds.len(), 6);
        assert!(halving(&[]).is_empty() && halving(&[[0.0; 3]]).is_empty());
    }
}
