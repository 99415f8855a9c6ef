//! Faces of one plane: merged where one map goes on, and nowhere else.

use trisect::{BooleanOptions, Contact, Mesh, Operation, Outcome, Rule, Solid, primitives};

use crate::common::shapes::cuboid;
use crate::maps::{judge, mapped, solid};

/// A plate whose upper side is a grid of cells of two triangles, each with a picture of its own: a texture atlas. One number a cell.
fn plate(cells: usize) -> (Mesh, Vec<f64>) {
    let mut mesh = Mesh::default();
    let mut numbers = Vec::new();
    let side = cells + 1;
    let at = |i: usize, j: usize, top: bool| (usize::from(top) * side * side + i * side + j) as u32;
    for top in [false, true] {
        for i in 0..side {
            for j in 0..side {
                mesh.positions.push([i as f64, j as f64, f64::from(u8::from(top))]);
            }
        }
    }
    let mut quad = |[a, b, c, d]: [u32; 4], number: f64| {
        mesh.triangles.extend([[a, b, c], [a, c, d]]);
        numbers.extend([number; 2]);
    };
    for i in 0..cells {
        for j in 0..cells {
            let corners = |top| [at(i, j, top), at(i + 1, j, top), at(i + 1, j + 1, top), at(i, j + 1, top)];
            quad(corners(true), (i * cells + j) as f64);
            let [a, b, c, d] = corners(false);
            quad([a, d, c, b], 1_000.0);
        }
        let walls = [(0, true), (cells, false)];
        for (edge, first) in walls {
            let [a, b, c, d] =
                [at(i, edge, false), at(i + 1, edge, false), at(i + 1, edge, true), at(i, edge, true)];
            quad(if first { [a, b, c, d] } else { [b, a, d, c] }, 2_000.0 + f64::from(u8::from(first)));
            let [a, b, c, d] =
                [at(edge, i, false), at(edge, i + 1, false), at(edge, i + 1, true), at(edge, i, true)];
            quad(if first { [b, a, d, c] } else { [a, b, c, d] }, 3_000.0 + f64::from(u8::from(first)));
        }
    }
    (mesh, numbers)
}

fn textured_plate(cells: usize) -> Solid {
    let (mesh, numbers) = plate(cells);
    crate::common::solid(mapped(mesh, |t| numbers[t]))
}

fn bare_plate(cells: usize) -> Solid {
    crate::common::solid(plate(cells).0)
}

/// How many triangles of the plate lie in more than one cell of its upper side.
fn astray(outcome: &Outcome) -> usize {
    let mesh = outcome.solid().mesh();
    let is_astray = |triangle: &&[u32; 3]| {
        let places = triangle.map(|v| mesh.positions[v as usize]);
        let range = |k: usize| {
            let along = places.map(|p| p[k]);
            (along.iter().copied().fold(f64::MAX, f64::min), along.iter().copied().fold(f64::MIN, f64::max))
        };
        places.iter().all(|p| p[2] == 1.0) && (0..2).any(|k| range(k).0.floor() + 1.0 < range(k).1)
    };
    let of_plate = mesh.triangles.iter().zip(outcome.origins()).filter(|(_, origin)| origin.operand == 0);
    of_plate.map(|(triangle, _)| triangle).filter(is_astray).count()
}

/// The trial that showed it: a plate with a picture in each cell less a block. Without attributes faces are merged, and origins are
/// in other cells; with them every triangle lies in its cell.
#[test]
fn triangles_stay_in_their_cells() {
    let tool = primitives::cuboid([0.5, 0.5, 0.5], [3.5, 2.5, 2.0]).unwrap();
    let merged = BooleanOptions::new()
        .run(Operation::Difference, [&bare_plate(4), &crate::common::solid(tool.clone())])
        .unwrap();
    assert!(astray(&merged) > 0);
    let outcome =
        BooleanOptions::new().run(Operation::Difference, [&textured_plate(4), &solid(tool, 10_000)]).unwrap();
    assert_eq!(astray(&outcome), 0);
    assert!(judge(outcome.solid().mesh(), "plate") < 1e-12);
    crate::common::assert_sound(&outcome, "plate");
    // The lower side, with one map, is merged as before: nothing of it was cut, so look at what a hole leaves.
    let drill = primitives::cuboid([0.5, 0.5, -0.5], [3.5, 2.5, 2.0]).unwrap();
    let below = |outcome: &Outcome| {
        let mesh = outcome.solid().mesh();
        let is_below = |t: &&[u32; 3]| t.iter().all(|&v| mesh.positions[v as usize][2] == 0.0);
        mesh.triangles.iter().filter(is_below).count()
    };
    let run =
        |body: &Solid, tool: &Solid| BooleanOptions::new().run(Operation::Difference, [body, tool]).unwrap();
    let bare = run(&bare_plate(4), &crate::common::solid(drill.clone()));
    // (A wall of the tool has one map too: two would meet in a corner of the hole's edge.)
    let drill = crate::common::solid(mapped(drill, |t| 10_000.0 + (t / 2) as f64));
    let outcome = run(&textured_plate(4), &drill);
    assert_eq!(below(&outcome), below(&bare));
    assert!(judge(outcome.solid().mesh(), "drilled plate") < 1e-12);
}

#[test]
fn flush_faces_keep_their_cells() {
    // Blocks that stand on the plate, end flush with its upper side, or share part of it.
    let tools = [
        ([0.5, 0.5, 1.0], [2.5, 2.5, 2.0]),
        ([0.5, 0.5, 0.5], [2.5, 2.5, 1.0]),
        ([-0.5, 0.25, 0.25], [2.5, 2.5, 1.0]),
        ([1.0, 1.0, 0.0], [2.0, 3.0, 1.0]),
        ([1.0, 1.0, -1.0], [2.0, 3.0, 1.5]),
        ([0.5, 0.5, 0.0], [3.5, 3.5, 1.0]),
    ];
    for (low, high) in tools {
        let tool = solid(cuboid(low, high), 10_000);
        for operation in Operation::ALL {
            for contact in [Contact::Fuse, Contact::Separate] {
                let options = BooleanOptions::new().contact(contact);
                let outcome = options.run(operation, [&textured_plate(4), &tool]).unwrap();
                let context = format!("{low:?} {operation:?} {contact:?}");
                assert!(judge(outcome.solid().mesh(), &context) < 1e-12, "{context}");
                assert_eq!(astray(&outcome), 0, "{context}");
            }
        }
    }
}

/// In the general arrangement faces that touch are added up in their plane.
#[test]
fn faces_added_up_in_their_plane_keep_their_cells() {
    let (plate, numbers) = plate(3);
    let block = cuboid([0.5, 0.5, 0.0], [2.5, 4.5, 1.0]);
    let count = plate.triangles.len();
    let both = Mesh::merged([&plate, &block]).unwrap();
    let operand = crate::common::solid(mapped(both, |t| {
        *numbers.get(t).unwrap_or(&(10_000.0 + (t - count.min(t)) as f64))
    }));
    for rule in [Rule::Positive, Rule::EvenOdd] {
        let outcome = BooleanOptions::new().rule(rule).resolve(&operand).unwrap();
        let context = format!("{rule:?}");
        assert!(judge(outcome.solid().mesh(), &context) < 1e-12, "{context}");
    }
}

#[test]
fn a_curved_map_on_a_plane_is_not_straightened() {
    // A strip of many faces whose texture bends so slowly that no two neighbours show it.
    let steps = 400u32;
    let mut body = Mesh::default();
    let ring = 4u32;
    for i in 0..=steps {
        let x = f64::from(i) / f64::from(steps);
        for [y, z] in [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]] {
            body.positions.push([x, y, z]);
        }
    }
    for i in 0..steps {
        for k in 0..ring {
            let (a, b) = (i * ring + k, i * ring + (k + 1) % ring);
            body.triangles.extend([[a, b, b + ring], [a, b + ring, a + ring]]);
        }
    }
    let last = steps * ring;
    body.triangles.extend([[0, 2, 1], [0, 3, 2], [last, last + 1, last + 2], [last, last + 2, last + 3]]);
    if body.volume() < 0.0 {
        body = body.reversed();
    }
    let bent = |p: [f64; 3]| p[0] * p[0];
    let mut heat = trisect::mesh::Attribute::new("_HEAT", 1);
    heat.values = body.positions.iter().map(|&p| bent(p)).collect();
    heat.of_corner = body.triangles.as_flattened().to_vec();
    body.attributes.push(heat);
    let body = crate::common::solid(body);
    let tool = crate::common::cuboid([-0.5, 0.5, 0.5], [1.5, 1.5, 1.5]);
    let outcome = BooleanOptions::new().run(Operation::Difference, [&body, &tool]).unwrap();
    let mesh = outcome.solid().mesh();
    let heat = mesh.attribute("_HEAT").unwrap();
    for (t, triangle) in mesh.triangles.iter().enumerate() {
        let values = [0, 1, 2].map(|k| heat.at(t, k).map(|value| value[0]));
        let [Some(a), Some(b), Some(c)] = values else { continue };
        let middle: [f64; 3] = std::array::from_fn(|k| {
            triangle.iter().map(|&v| mesh.positions[v as usize][k]).sum::<f64>() / 3.0
        });
        let error = ((a + b + c) / 3.0 - bent(middle)).abs();
        assert!(error < 4e-6, "triangle {t}: {error:e}");
    }
}
