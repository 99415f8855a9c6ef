//! Solids of unit cubes, with all their contacts along faces, edges and vertices, against one another.

use trisect::{Mesh, Solid};

use super::boxes::BOTH_WAYS;
use crate::common::same_bits;
use crate::judge::cells::Cells;
use crate::trial::{Expected, Trial, one_in};

/// The set of cells of the 2 x 2 x 2 lattice that has the bits of a number.
fn cells(bits: usize) -> Cells {
    Cells::new([0; 3], [2; 3], |[x, y, z]| bits >> (x + 2 * y + 4 * z) & 1 == 1)
}

fn solid(cells: &Cells) -> Solid {
    Solid::try_from(cells.surface().mesh).expect("the boundary of cells is closed")
}

/// Whether several vertices of a surface are at the same place.
fn touches_itself(mesh: &Mesh) -> bool {
    let mut places: Vec<_> = mesh.positions.iter().map(|p| p.map(f64::to_bits)).collect();
    places.sort_unstable();
    places.windows(2).any(|pair| pair[0] == pair[1])
}

fn run(trial: &mut Trial, context: &str, of: [&Cells; 2], solids: [&Solid; 2]) {
    for (operation, swapped) in BOTH_WAYS {
        let (of, solids) = if swapped { ([of[1], of[0]], [solids[1], solids[0]]) } else { (of, solids) };
        let result = of[0].combined(operation, of[1]);
        let surface = result.surface();
        // Where an operand touches itself, its own way of being connected there stays.
        let connected = !solids.iter().any(|solid| touches_itself(solid.mesh()));
        let expected = Expected {
            volume: Some(result.count() as f64),
            area: Some(surface.squares as f64),
            empty: Some(result.count() == 0),
            components: connected.then_some(surface.components),
            euler: connected.then_some(surface.euler),
            ..Expected::default()
        };
        trial.run(&format!("{context}, swapped {swapped}"), operation, solids, &expected);
    }
}

#[test]
fn every_set_of_eight_cells_with_every_other() {
    let _bits = same_bits::group("battery cells");
    let mut trial = Trial::default();
    for index in (0..256 * 257 / 2).step_by(one_in(29)) {
        // Pairs a <= b, numbered row by row.
        let b = (((8 * index + 1) as f64).sqrt() as usize - 1) / 2;
        let a = index - b * (b + 1) / 2;
        let of = [cells(a), cells(b)];
        run(&mut trial, &format!("cells {a} {b}"), [&of[0], &of[1]], [&solid(&of[0]), &solid(&of[1])]);
    }
    trial.finish(9_000);
}

#[test]
fn cells_shifted_by_halves() {
    let _bits = same_bits::group("battery cells off by halves");
    // Every set against itself and its mirror image, half a cell off: edges cross in the middle of faces.
    let mut trial = Trial::default();
    for bits in (1..256usize).step_by(one_in(7)) {
        for shift in 1..8i64 {
            let by = [shift & 1, shift >> 1 & 1, shift >> 2 & 1];
            for other in [bits, bits.reverse_bits() >> (usize::BITS - 8)] {
                let fine = |bits: usize, by: [i64; 3]| {
                    Cells::new([0; 3], [5; 3], |p| {
                        let q = [0, 1, 2].map(|k| p[k] - by[k]);
                        q.iter().all(|&x| (0..4).contains(&x)) && cells(bits).contains(q.map(|x| x / 2))
                    })
                };
                let of = [fine(bits, [0; 3]), fine(other, by)];
                // Operands with long edges: unit cubes of the coarse lattice, doubled.
                let doubled = |bits: usize, by: [i64; 3]| {
                    let mesh = cells(bits).surface().mesh;
                    let double = |p: &[f64; 3]| [0, 1, 2].map(|k| 2.0 * p[k] + by[k] as f64);
                    Solid::try_from(Mesh::new(mesh.positions.iter().map(double).collect(), mesh.triangles))
                        .expect("closed")
                };
                let solids = [doubled(bits, [0; 3]), doubled(other, by)];
                let context = format!("cells {bits} and {other} off by {by:?} halves");
                run(&mut trial, &context, [&of[0], &of[1]], [&solids[0], &solids[1]]);
            }
        }
    }
    trial.finish(4_000);
}
