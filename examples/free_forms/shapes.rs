//! Cages made by code.

use std::f64::consts::TAU;

use trisect::Error;
use trisect::subdivision::{ControlMesh, Crease, Rules, Tags};

/// A cylinder along z with creased rims.
pub(crate) fn cylinder(
    sides: u32,
    rows: u32,
    radius: f64,
    low: f64,
    high: f64,
) -> Result<ControlMesh, Error> {
    let mut positions = vec![[0.0, 0.0, low], [0.0, 0.0, high]];
    for j in 0..=rows {
        for i in 0..sides {
            let (sine, cosine) = (TAU * (f64::from(i) + 0.5 * f64::from(j % 2)) / f64::from(sides)).sin_cos();
            positions.push([
                radius * cosine,
                radius * sine,
                low + (high - low) * f64::from(j) / f64::from(rows),
            ]);
        }
    }
    let at = |j: u32, i: u32| 2 + j * sides + i % sides;
    let (mut faces, mut tags) = (Vec::new(), Tags::default());
    for i in 0..sides {
        faces.extend([[0, at(0, i + 1), at(0, i)], [1, at(rows, i), at(rows, i + 1)]]);
        for j in 0..rows {
            let (a, b, c, d) = (at(j, i), at(j, i + 1), at(j + 1, i), at(j + 1, i + 1));
            faces.extend(if j % 2 == 0 { [[a, b, c], [b, d, c]] } else { [[a, b, d], [a, d, c]] });
        }
        for j in [0, rows] {
            tags.creases.push(Crease { edge: [at(j, i), at(j, i + 1)], sharpness: f64::INFINITY });
        }
    }
    ControlMesh::new(positions, faces, tags, Rules::Loop)
}

/// A ring in the plane z = 0.
pub(crate) fn torus(around: u32, across: u32, radius: f64, tube: f64) -> Result<ControlMesh, Error> {
    let mut positions = Vec::new();
    for i in 0..around {
        for j in 0..across {
            let a = TAU * f64::from(i) / f64::from(around);
            let b = TAU * (f64::from(j) + 0.5 * f64::from(i % 2)) / f64::from(across);
            let r = radius + tube * b.cos();
            positions.push([r * a.cos(), r * a.sin(), tube * b.sin()]);
        }
    }
    let at = |i: u32, j: u32| (i % around) * across + j % across;
    let mut faces = Vec::new();
    for i in 0..around {
        for j in 0..across {
            let (a, b, c, d) = (at(i, j), at(i + 1, j), at(i, j + 1), at(i + 1, j + 1));
            faces.extend(if i % 2 == 0 { [[a, b, c], [c, b, d]] } else { [[a, b, d], [a, d, c]] });
        }
    }
    ControlMesh::new(positions, faces, Tags::default(), Rules::Loop)
}

/// A block of cells, faces outwards; edges between faces of the directions in `sharp` (pairs of axes) are creases.
pub(crate) fn block(
    cells: [u32; 3],
    low: [f64; 3],
    high: [f64; 3],
    sharp: &[[usize; 2]],
) -> Result<ControlMesh, Error> {
    let mut numbers = std::collections::BTreeMap::new();
    let mut positions = Vec::new();
    let mut faces = Vec::new();
    let mut number = |at: [u32; 3]| {
        *numbers.entry(at).or_insert_with(|| {
            positions.push(std::array::from_fn(|k| {
                low[k] + (high[k] - low[k]) * f64::from(at[k]) / f64::from(cells[k])
            }));
            positions.len() as u32 - 1
        })
    };
    for axis in 0..3 {
        let (p, q) = ((axis + 1) % 3, (axis + 2) % 3);
        for side in [0, cells[axis]] {
            for i in 0..cells[p] {
                for j in 0..cells[q] {
                    let mut corner = |di: u32, dj: u32| {
                        let mut at = [0; 3];
                        (at[axis], at[p], at[q]) = (side, i + di, j + dj);
                        number(at)
                    };
                    let (a, b, c, d) = (corner(0, 0), corner(1, 0), corner(0, 1), corner(1, 1));
                    let two = [[a, b, d], [a, d, c]];
                    faces.extend(two.map(|[a, b, c]| if side == 0 { [a, c, b] } else { [a, b, c] }));
                }
            }
        }
    }
    let mut tags = Tags::default();
    for (at, &v) in &numbers {
        for axis in 0..3 {
            let mut next = *at;
            next[axis] += 1;
            let Some(&w) = numbers.get(&next) else { continue };
            let (p, q) = ((axis + 1) % 3, (axis + 2) % 3);
            let on_edge = [p, q].iter().all(|&k| at[k] == 0 || at[k] == cells[k]);
            if on_edge && sharp.iter().any(|pair| pair.contains(&p) && pair.contains(&q)) {
                tags.creases.push(Crease { edge: [v, w], sharpness: f64::INFINITY });
            }
        }
    }
    ControlMesh::new(positions, faces, tags, Rules::Loop)
}

/// The cage moved by a map that keeps its orientation.
pub(crate) fn moved(cage: &ControlMesh, map: impl Fn([f64; 3]) -> [f64; 3]) -> Result<ControlMesh, Error> {
    let positions = cage.positions().iter().map(|&p| map(p)).collect();
    ControlMesh::new(positions, cage.faces().to_vec(), cage.tags().clone(), cage.rules())
}

/// The boundary of some cells of a grid, with creases wherever it turns.
pub(crate) fn of_cells(
    is_in: &dyn Fn([u32; 3]) -> bool,
    cells: [u32; 3],
    size: f64,
) -> Result<ControlMesh, Error> {
    let inside = |at: [i64; 3]| {
        (0..3).all(|k| at[k] >= 0 && at[k] < i64::from(cells[k])) && is_in(at.map(|x| x as u32))
    };
    let mut numbers = std::collections::BTreeMap::new();
    let (mut positions, mut faces) = (Vec::new(), Vec::new());
    for index in 0..cells.iter().product::<u32>() {
        let at = [index % cells[0], index / cells[0] % cells[1], index / cells[0] / cells[1]].map(i64::from);
        for axis in (0..3).filter(|_| inside(at)) {
            for side in [0, 1] {
                let mut beside = at;
                beside[axis] += 2 * side - 1;
                if inside(beside) {
                    continue;
                }
                let (p, q) = ((axis + 1) % 3, (axis + 2) % 3);
                let mut corner = |i: i64, j: i64| {
                    let mut corner = at;
                    corner[axis] += side;
                    corner[p] += i;
                    corner[q] += j;
                    *numbers.entry(corner).or_insert_with(|| {
                        positions.push(corner.map(|x| x as f64 * size));
                        positions.len() as u32 - 1
                    })
                };
                let [a, b, c, d] = [corner(0, 0), corner(1, 0), corner(0, 1), corner(1, 1)];
                let two = [[a, b, d], [a, d, c]];
                faces.extend(two.map(|[a, b, c]| if side == 0 { [a, c, b] } else { [a, b, c] }));
            }
        }
    }
    ControlMesh::new(positions, faces, Tags::default(), Rules::Loop)?.with_creases_from_angle(45.0)
}
