//! Operands that touch: what the perturbation makes of them, in section and in space.

use trisect::render::{Picture, palette};
use trisect::{BooleanOptions, Error, Operation, Solid, primitives};

use crate::scene::{BLUE, Colour, DARK, GREY, ORANGE, Point, Scene, paste, view};

const OPERATIONS: [Operation; 3] = [Operation::Union, Operation::Intersection, Operation::Difference];

/// A box of the contact table: low and high corner.
type Corners = (Point, Point);

/// The contacts of a box B with the cube A between 0 and 4; each row a contact, then the three results.
pub(crate) fn table() -> Result<Picture, Error> {
    const WIDTH: u32 = 190;
    const HEIGHT: u32 = 140;
    let a: Corners = ([0.0; 3], [4.0; 3]);
    let contacts: [Corners; 6] = [
        ([4.0, 0.0, 0.0], [8.0, 4.0, 4.0]),
        ([4.0, 1.0, 2.0], [8.0, 3.0, 6.0]),
        ([1.0, 1.0, 2.0], [3.0, 3.0, 4.0]),
        ([2.0, 0.0, 2.0], [4.0, 2.0, 4.0]),
        ([1.0, 1.0, 0.0], [3.0, 3.0, 4.0]),
        ([4.0, 0.0, 4.0], [8.0, 4.0, 8.0]),
    ];
    let mut all = Picture::new(4 * WIDTH, contacts.len() as u32 * HEIGHT, [255; 3]);
    for (row, &b) in contacts.iter().enumerate() {
        let solids = [a, b].map(|(low, high)| primitives::cuboid(low, high).and_then(Solid::try_from));
        let [solid_a, solid_b] = solids;
        let (solid_a, solid_b) = (solid_a?, solid_b?);
        let mut view = view(WIDTH, HEIGHT, [1.0, -1.6, 1.1]);
        view.frame = Some([[0.0; 3], [0, 1, 2].map(|k| b.1[k].max(4.0))]);
        let top = i64::from(HEIGHT) * row as i64;

        let mut operands = Scene::default();
        // A as a frame, so that B inside it can be seen.
        operands.edges(solid_a.mesh(), 0.05, BLUE, |p, q| (0..3).filter(|&k| p[k] != q[k]).count() == 1)?;
        operands.add(solid_b.mesh(), |_| ORANGE)?;
        paste(&mut all, &operands.draw(&view), 0, top);
        for (column, operation) in OPERATIONS.into_iter().enumerate() {
            let outcome = BooleanOptions::new().run(operation, [&solid_a, &solid_b])?;
            let mut result = Scene::default();
            result.add(outcome.solid().mesh(), |t| palette(outcome.origins()[t].operand as usize))?;
            paste(&mut all, &result.draw(&view), i64::from(WIDTH) * (column as i64 + 1), top);
        }
    }
    Ok(all)
}

/// A rectangle: low and high corner.
type Rectangle = [[f64; 2]; 2];

/// In section, much exaggerated: A is moved out for a union and in for the others, B stays.
pub(crate) fn perturbation() -> Result<Picture, Error> {
    const SIZE: i64 = 230;
    const SCALE: f64 = 24.0;
    const EPSILON: f64 = 0.35;
    const A: Rectangle = [[0.0, 0.0], [4.0, 4.0]];
    const CONTACTS: [Rectangle; 2] = [[[4.0, 1.0], [6.5, 4.0]], [[1.2, 1.5], [3.2, 4.0]]];
    let mut picture = Picture::new(3 * SIZE as u32, 2 * SIZE as u32, [255; 3]);
    for (row, b) in CONTACTS.into_iter().enumerate() {
        for (column, operation) in OPERATIONS.into_iter().enumerate() {
            let shift = if operation == Operation::Union { EPSILON } else { -EPSILON };
            let moved = [A[0].map(|x| x - shift), A[1].map(|x| x + shift)];
            let (left, top) = (column as i64 * SIZE, row as i64 * SIZE);
            let inside = |r: &Rectangle, p: [f64; 2]| (0..2).all(|k| r[0][k] <= p[k] && p[k] <= r[1][k]);
            // Pixels from the lower left corner of A, y upwards.
            let origin = [left as f64 + 34.0, (top + SIZE) as f64 - 60.0];
            for y in top..top + SIZE {
                for x in left..left + SIZE {
                    let p = [(x as f64 - origin[0]) / SCALE, (origin[1] - y as f64) / SCALE];
                    let (in_a, in_b) = (inside(&moved, p), inside(&b, p));
                    let kept = match operation {
                        Operation::Union => in_a || in_b,
                        Operation::Intersection => in_a && in_b,
                        _ => in_a && !in_b,
                    };
                    if kept {
                        picture.set(x, y, GREY);
                    }
                }
            }
            let mut outline = |r: &Rectangle, width: f64, colour: Colour| {
                let corner = |i: usize, j: usize| [origin[0] + SCALE * r[i][0], origin[1] - SCALE * r[j][1]];
                let corners = [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)];
                for k in 0..4 {
                    picture.line(corners[k], corners[(k + 1) % 4], width, colour);
                }
            };
            outline(&A, 1.0, DARK);
            outline(&moved, 3.0, BLUE);
            outline(&b, 3.0, ORANGE);
        }
    }
    Ok(picture)
}
