//! What a file holds is what was said of it: results of booleans written and read back.
#![allow(clippy::print_stdout, reason = "counts for the documentation, shown with --nocapture")]

use std::collections::HashMap;

use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};
use trisect::io::{Format, ReadOptions, Rounding, WriteOptions, Written, read, write_report};
use trisect::{Control, Mesh, Operation, Solid, boolean, primitives};

use crate::common::single;

/// How many results are written; TRISECT_WRITTEN_CASES asks for more.
fn cases() -> u64 {
    std::env::var("TRISECT_WRITTEN_CASES").map_or(200, |text| text.parse().expect("a number"))
}

fn written(mesh: &Mesh, format: Format, options: &WriteOptions) -> (Written, Mesh) {
    let mut bytes = Vec::new();
    let written = write_report(mesh, format, &mut bytes, options).unwrap();
    (written, read(&bytes, format, &ReadOptions::new()).unwrap().mesh)
}

/// The mesh as STL has it: vertices of equal coordinates are one, numbered in order of first use.
fn without_vertices(mesh: &Mesh) -> Vec<[u32; 3]> {
    let mut known = HashMap::new();
    let mut number = |v: u32| {
        let next = known.len() as u32;
        *known.entry(mesh.positions[v as usize].map(|x| (x + 0.0).to_bits())).or_insert(next)
    };
    mesh.triangles.iter().map(|triangle| triangle.map(&mut number)).collect()
}

/// A body and a tool somewhere; every few a film, a corner that nearly touches, or map coordinates.
fn operands(random: &mut ChaCha8Rng) -> [Mesh; 2] {
    let mut number = |low: f64, high: f64| low + (high - low) * random.random::<f64>();
    let place: [f64; 3] = match number(0.0, 4.0) as u32 {
        0 => [0.0; 3],
        1 => [0; 3].map(|_| number(-1.0, 1.0)),
        2 => [0; 3].map(|_| number(-1e4, 1e4)),
        _ => [500_000.0, 4_649_776.0, 120.0],
    };
    let (sort, turn, short) = (number(0.0, 5.0) as u32, number(0.0, 90.0), 10f64.powf(number(-13.0, -1.0)));
    let body = primitives::cuboid([0.0; 3], [1.0; 3]).unwrap();
    let (body, tool) = match sort {
        // A pocket that ends a little short of the other side.
        0 => (body, primitives::cuboid([0.25, 0.25, -1.0], [0.75, 0.75, 1.0 - short]).unwrap()),
        1 => {
            let ball = primitives::icosphere(0.6, 2).unwrap().translated([0.9, number(0.0, 1.0), 0.5]);
            (body.rotated([1.0, 2.0, 3.0], turn).unwrap(), ball)
        }
        2 => {
            let bar = primitives::cylinder(0.2, 3.0, 24).unwrap().translated([0.5, 0.5, -1.0]);
            (body, bar.rotated([1.0, 0.3, 0.0], 0.1 * turn).unwrap())
        }
        // Side by side, a little apart.
        3 => (body, primitives::cuboid([1.0 + short, 0.2, 0.2], [2.0, 0.8, 0.8]).unwrap()),
        _ => {
            let ring = primitives::torus(0.7, 0.25, 24, 12).unwrap();
            (ring.clone().rotated([1.0, 0.0, 1.0], turn).unwrap(), ring)
        }
    };
    [body.translated(place), tool.translated(place)]
}

/// Whether the file holds what was said: to the digits of the volume, triangle by triangle.
fn check(solid: &Solid, volume: f64, format: Format, case: &str) -> Option<Rounding> {
    let mesh = solid.mesh();
    let (said, back) = written(mesh, format, &WriteOptions::new());
    let Some(rounding) = said.rounding else {
        assert!(said.warnings.is_empty(), "{case}: {:?}", said.warnings);
        let bits = |mesh: &Mesh| -> Vec<u64> {
            let corners = mesh.triangles.as_flattened().iter();
            corners.flat_map(|&v| mesh.positions[v as usize].map(|x| (x + 0.0).to_bits())).collect()
        };
        assert_eq!(bits(&back), bits(mesh), "{case}");
        return None;
    };
    assert_eq!(rounding.warning(format).as_ref(), said.warnings.last(), "{case}");
    let (exact, in_file) = (rounding.volume.unwrap(), rounding.written_volume.unwrap());
    assert!(rounding.closed && (exact - volume).abs() <= 1e-12 * volume, "{case}");
    // The volume is that of the file, whatever it is.
    assert!((back.volume() - in_file).abs() <= 1e-8 * volume.abs().max(in_file.abs()), "{case}");
    // Needles that turned over are named, and what crosses in the file does so there; with an offset it may be anywhere. (STL joins what has
    // come to lie at one place.)
    assert_eq!(rounding.overturned.len(), rounding.turned_triangles + rounding.flat_triangles, "{case}");
    let is_same = back.triangles == mesh.triangles || format == Format::Stl && rounding.joined_vertices == 0;
    if !rounding.has_offset
        && is_same
        && let Ok(read) = Solid::try_from(back.clone())
        && read.mesh().triangles.len() == mesh.triangles.len()
    {
        let held = mesh.positions.iter().map(|position| position.map(|x| f64::from(x as f32))).collect();
        let found = solid.self_crossings_moved(held, &rounding.overturned, &Control::new()).unwrap();
        let all = read.self_crossings(&Control::new()).unwrap();
        assert_eq!((found.count, found.tolerance), (all.count, all.tolerance), "{case}");
    }
    if rounding.differs() {
        assert_eq!(said.warnings.len(), 1, "{case}");
        return Some(rounding);
    }
    assert!(said.warnings.is_empty(), "{case}");
    assert!((in_file - volume).abs() <= 1e-5 * volume, "{case}: {in_file} for {volume}");
    let triangles = if format == Format::Stl { without_vertices(mesh) } else { mesh.triangles.clone() };
    assert_eq!(back.triangles, triangles, "{case}");
    Solid::try_from(back).unwrap_or_else(|error| panic!("{case}: {error}"));
    Some(rounding)
}

#[test]
fn results_are_read_as_they_were_told() {
    let (mut kept, mut right, mut warned, mut overturned) = (0, 0, 0, 0);
    let mut kinds = [0; 5];
    for seed in 0..cases() {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let [body, tool] = operands(&mut random).map(|mesh| Solid::try_from(mesh).unwrap());
        let operation = [Operation::Difference, Operation::Union, Operation::Intersection]
            [random.random_range(0..3_usize)];
        let result = boolean(operation, &body, &tool).unwrap();
        if result.solid().is_empty() {
            continue;
        }
        let volume = result.solid().volume();
        for format in [Format::Stl, Format::Glb, Format::Obj, Format::Ply] {
            let case = format!("seed {seed}, {operation}, {format}");
            let checked = check(result.solid(), volume, format, &case);
            overturned += checked.iter().filter(|found| !found.overturned.is_empty()).count();
            match checked {
                None => kept += 1,
                Some(found) if found.differs() => {
                    warned += 1;
                    let volume = found.volume != found.written_volume
                        && found.warning(format).unwrap().contains("volume");
                    let facts = [
                        volume,
                        found.collapsed_triangles > 0,
                        found.joined_vertices > 0,
                        found.lost_films > 0,
                        found.lost_gaps > 0,
                    ];
                    kinds.iter_mut().zip(facts).for_each(|(count, fact)| *count += usize::from(fact));
                }
                Some(_) => right += 1,
            }
        }
    }
    println!(
        "{kept} kept to the bit, {right} right after rounding, {warned} with a warning, of which {kinds:?}"
    );
    assert!(overturned > 20, "{overturned}");
    assert!(kept > 0 && right > 0 && kinds.iter().all(|&count| count > 0), "{kept} {right} {kinds:?}");
}

#[test]
fn map_coordinates_are_told_and_every_way_out_works() {
    let place = [500_000.0, 4_649_776.0, 120.0];
    let at = |low: [f64; 3], high: [f64; 3]| {
        Solid::try_from(primitives::cuboid(low, high).unwrap().translated(place)).unwrap()
    };
    let cut = at([0.0; 3], [1.0; 3]).difference(&at([0.3; 3], [1.5; 3])).unwrap();
    let (mesh, volume) = (cut.solid().mesh(), cut.solid().volume());
    assert!((volume - 0.657).abs() < 1e-9);
    let (told, back) = written(mesh, Format::Stl, &WriteOptions::new());
    let rounding = told.rounding.unwrap();
    assert!((back.volume() - 0.657).abs() > 0.01 && rounding.step == 0.5 && rounding.finer_at_origin);
    for part in ["changes the volume from 0.65", "OBJ", "PLY", "GLB", "moved to the origin"] {
        assert!(told.warnings[0].contains(part), "{part}: {:?}", told.warnings);
    }
    // Each way out that is named.
    for format in [Format::Obj, Format::Ply, Format::Glb] {
        let (told, back) = written(mesh, format, &WriteOptions::new());
        assert_eq!(told.warnings, [""; 0]);
        assert!((back.volume() - volume).abs() < 1e-6);
    }
    let (moved, by) = mesh.clone().recentered();
    assert_eq!(by, place.map(|x| -(x + 0.5)));
    let (told, back) = written(&moved, Format::Stl, &WriteOptions::new());
    assert_eq!(told.warnings, [""; 0]);
    assert!((back.volume() - volume).abs() < 1e-6);
}

#[test]
fn films_that_lose_their_thickness_are_told_with_their_place() {
    let solid = |low, high| Solid::try_from(primitives::cuboid(low, high).unwrap()).unwrap();
    let body = solid([0.0; 3], [1.0; 3]);
    for (short, told) in [(1e-9, true), (1e-3, false)] {
        let tool = solid([0.25, 0.25, 0.0], [0.75, 0.75, 1.0 - short]);
        let cut = body.difference(&tool).unwrap();
        for format in [Format::Stl, Format::Glb] {
            let (said, _) = written(cut.solid().mesh(), format, &WriteOptions::new());
            let rounding = said.rounding.unwrap();
            assert_eq!((rounding.lost_films > 0, rounding.lost_gaps), (told, 0), "{format} {short}");
            assert_eq!(said.warnings.len(), usize::from(told), "{format} {short}");
            if told {
                assert!((rounding.lost_thickness.unwrap() - short).abs() < 1e-15);
                assert!((rounding.lost_place.unwrap()[2] - 1.0).abs() < 1e-8);
                assert!(
                    said.warnings[0].contains("leaves nothing of a film 1.0e-9 thick"),
                    "{:?}",
                    said.warnings
                );
                assert!(!said.warnings[0].contains("origin"), "it would be lost there, too");
            }
        }
        let (said, _) = written(cut.solid().mesh(), Format::Ply, &WriteOptions::new());
        assert!(said.warnings.is_empty() && said.rounding.is_none());
        let (said, _) = written(cut.solid().mesh(), Format::Ply, &single(&WriteOptions::new()));
        assert_eq!(said.warnings.len(), usize::from(told));
    }
}

#[test]
fn names_alone_are_nothing_to_warn_of() {
    let mut mesh = primitives::cuboid([0.0; 3], [1.0; 3]).unwrap();
    mesh.groups.list = vec![trisect::FaceGroup { name: "part".into(), material: None }];
    mesh.groups.of_triangle = vec![0; 12];
    for format in Format::ALL {
        assert!(written(&mesh, format, &WriteOptions::new()).0.warnings.is_empty(), "{format}");
    }
    mesh.groups.list[0].material = Some(trisect::Material::plain("red", [1.0; 4]));
    for format in [Format::Ply, Format::Off] {
        assert_eq!(written(&mesh, format, &WriteOptions::new()).0.warnings.len(), 1, "{format}");
    }
}
