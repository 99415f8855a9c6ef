//! Boxes in every relation along every axis.

use trisect::Operation;
use trisect::Operation::{Difference, Intersection, SymmetricDifference, Union};

use crate::common::{cuboid, same_bits};
use crate::judge::cells::Cells;
use crate::trial::{Expected, Trial, one_in};

/// All relations of an interval to the interval from 2 to 4: before, meets, overlaps, starts, within, ends, equals, contains
/// and their reverses.
const RELATIONS: [[i64; 2]; 13] =
    [[0, 1], [0, 2], [1, 3], [0, 4], [2, 3], [0, 6], [2, 4], [2, 6], [3, 4], [3, 5], [4, 6], [5, 6], [1, 5]];
/// One more relation needs a finer grid: strictly within.
const WITHIN: [f64; 2] = [2.5, 3.5];

pub(crate) const BOTH_WAYS: [(Operation, bool); 8] = [
    (Union, false),
    (Union, true),
    (Intersection, false),
    (Intersection, true),
    (Difference, false),
    (Difference, true),
    (SymmetricDifference, false),
    (SymmetricDifference, true),
];

#[test]
fn boxes_in_every_relation_along_every_axis() {
    let _bits = same_bits::group("battery boxes");
    let relations: Vec<[f64; 2]> =
        RELATIONS.iter().map(|interval| interval.map(|x| x as f64)).chain([WITHIN]).collect();
    let mut trial = Trial::default();
    let count = relations.len();
    // Cells of half a unit.
    let cells = |low: [f64; 3], high: [f64; 3]| {
        let doubled = |p: [f64; 3]| p.map(|x| (2.0 * x) as i64);
        Cells::new(doubled(low), doubled(high), |_| true)
    };
    let (low, high) = ([2.0; 3], [4.0; 3]);
    let (a, a_cells) = (cuboid(low, high), cells(low, high));
    for index in (0..count.pow(3)).step_by(one_in(3)) {
        let intervals = [index % count, index / count % count, index / count / count].map(|i| relations[i]);
        let (low, high) = (intervals.map(|i| i[0]), intervals.map(|i| i[1]));
        let (b, b_cells) = (cuboid(low, high), cells(low, high));
        for (operation, swapped) in BOTH_WAYS {
            let (solids, of) =
                if swapped { ([&b, &a], [&b_cells, &a_cells]) } else { ([&a, &b], [&a_cells, &b_cells]) };
            let result = of[0].combined(operation, of[1]);
            let surface = result.surface();
            let expected = Expected {
                volume: Some(result.count() as f64 / 8.0),
                area: Some(surface.squares as f64 / 4.0),
                empty: Some(result.count() == 0),
                components: Some(surface.components),
                euler: Some(surface.euler),
                ..Expected::default()
            };
            trial.run(&format!("box {low:?} {high:?}, swapped {swapped}"), operation, solids, &expected);
        }
    }
    trial.finish(7_000);
}
