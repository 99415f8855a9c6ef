//! Meshes that are not closed and enclose a volume all the same: what is certain is mended and told, the rest is refused
//! and left as it is.

use crate::common::meshes::{chain_of, is_closed};
use crate::common::threejs;
use rand::rngs::ChaCha8Rng;
use rand::{RngExt as _, SeedableRng as _};
use trisect::io::{self, Format, ReadOptions, WriteOptions};
use trisect::mesh::{Gate, Mending, Welding, diagnose};
use trisect::{Mesh, MeshError, Solid, primitives};

fn fixture(name: &str) -> Mesh {
    Mesh::load(format!("{}/fixtures/{name}", env!("CARGO_MANIFEST_DIR"))).expect("a fixture")
}

fn mended(name: &str) -> (Solid, Mending) {
    let solid = Solid::try_from(fixture(&format!("reported/{name}"))).expect(name);
    let mending = solid.mending().clone();
    (solid, mending)
}

fn cube() -> Mesh {
    primitives::cuboid([0.0; 3], [1.0; 3]).expect("a cube")
}

/// Kinds of mending, counted: seams, split edges, zero area, copies, fins, strays, walls.
fn counts(mending: &Mending) -> [usize; 7] {
    let all = [
        &mending.seams,
        &mending.split_edges,
        &mending.zero_area,
        &mending.copies,
        &mending.fins,
        &mending.strays,
        &mending.walls,
    ];
    all.map(|fault| fault.count)
}

#[test]
fn reported_files_have_their_right_volumes() {
    let cases = [
        ("seam-ulp.obj", 1.0 / 6.0, [1, 0, 0, 0, 0, 0, 0]),
        ("t-vertex.obj", 1.0 / 6.0, [0, 1, 0, 0, 0, 0, 0]),
        ("face-twice.obj", 1.0 / 6.0, [0, 0, 0, 1, 0, 0, 0]),
        ("fin.obj", 1.0 / 6.0, [0, 0, 0, 0, 1, 0, 0]),
        ("one-wall.obj", 1.0 / 3.0, [0, 0, 0, 0, 0, 0, 1]),
    ];
    for (name, volume, expected) in cases {
        let (solid, mending) = mended(name);
        assert!((solid.volume() - volume).abs() < 1e-15, "{name}: {}", solid.volume());
        assert_eq!(counts(&mending), expected, "{name}: {mending}");
        assert!(solid.is_manifold(), "{name}");
        // As it is, it is refused, and the diagnosis says what mending would do.
        let refusal = Gate::new().as_is(true).solid(fixture(&format!("reported/{name}"))).expect_err(name);
        let MeshError::NotClosed(diagnosis) = &refusal.error else { panic!("{name}: {}", refusal.error) };
        assert_eq!(diagnosis.mending.as_deref(), Some(&mending), "{name}");
        assert!(!refusal.error.to_string().contains("hole"), "{name}: {}", refusal.error);
        assert_eq!(refusal.mesh, fixture(&format!("reported/{name}")), "{name}");
    }
    // Seams along all edges of a part as CAD wrote it.
    let block = Solid::try_from(fixture("open/angle_block.stl")).expect("seams");
    assert!((block.volume() - 1.145_522_542_530_532_1).abs() < 1e-12, "{}", block.volume());
    assert_eq!(counts(block.mending()), [46, 0, 0, 0, 0, 0, 0]);
    // Places are those of the file.
    assert_eq!(mended("seam-ulp.obj").1.seams.places[0].vertices, [3, 4]);
    assert_eq!(mended("seam-ulp.obj").1.widest_seam, 2.449_293_598_294_706_4e-16);
    assert_eq!(mended("t-vertex.obj").1.split_edges.places[0].vertices, [4]);
    assert_eq!(mended("fin.obj").1.fins.places[0].triangles, [4]);
    assert_eq!(mended("one-wall.obj").1.walls.places[0].triangles, [0]);
    let (cylinder, mending) = mended("web-cylinder.glb");
    assert!((cylinder.volume() / std::f64::consts::PI - 1.0).abs() < 0.3, "{}", cylinder.volume());
    assert!(mending.seams.count > 0 && cylinder.is_manifold());
}

#[test]
fn a_shell_stored_twice_is_one_where_that_is_asked_for() {
    let twice = fixture("reported/shell-twice.obj");
    // It is closed: what is enclosed twice counts twice, unless told otherwise.
    assert_eq!(Solid::try_from(twice.clone()).expect("closed").volume(), 1.0 / 3.0);
    let single = Gate::new().single_shells(true).solid(twice.clone()).expect("closed");
    assert_eq!(single.volume(), 1.0 / 6.0);
    assert_eq!(single.mending().copied_shells.count, 1);
    assert_eq!(single.mending().copied_shells.places[0].triangles, [4]);
    assert_eq!((0..4).map(|triangle| single.source_triangle(triangle)).collect::<Vec<_>>(), [0, 1, 2, 3]);
    // A copy is not inside out, and orienting turns neither.
    assert!(diagnose(&twice).inside_out_shells.is_none());
    assert_eq!(twice.clone().oriented(), twice);
    // What lies inside is a cavity, however often the outside is stored.
    let outer = primitives::cuboid([-1.0; 3], [2.0; 3]).expect("a cube");
    let nested = Mesh::merged([&outer, &cube(), &outer]).expect("small").oriented();
    assert_eq!(Gate::new().single_shells(true).solid(nested).expect("closed").volume(), 26.0);
    let apart = Mesh::merged([&cube(), &outer.translated([5.0, 0.0, 0.0])]).expect("small");
    assert!(Gate::new().single_shells(true).solid(apart).expect("closed").mending().is_none());
}

#[test]
fn what_is_open_stays_refused() {
    for name in ["open/blob.off", "open/moebius.obj", "open/open_cube.off", "reported/hole-one-face.obj"] {
        let mesh = fixture(name);
        let refusal = Gate::new().solid(mesh.clone()).expect_err(name);
        assert!(matches!(refusal.error, MeshError::NotClosed(_)), "{name}: {}", refusal.error);
        assert_eq!(refusal.mesh, mesh, "{name}");
        for gate in [Gate::new().closed_parts(true), Gate::new().orient(true)] {
            assert!(gate.solid(mesh.clone()).is_err(), "{name}");
        }
    }
    for (name, mesh) in threejs::open_shapes() {
        let refusal =
            Gate::new().weld(Welding::Closing).closed_parts(true).solid(mesh.clone()).expect_err(&name);
        assert_eq!(refusal.mesh, mesh, "{name}");
    }
    // A slit is no seam: a pyramid one of whose edges gapes by a hundredth, and a box far from the origin without a lid.
    let mut slit = cube();
    let [a, b, _] = slit.triangles[0];
    for (end, other) in [(a, 8), (b, 9)] {
        let moved = slit.positions[end as usize].map(|x| x + 0.01);
        slit.positions.push(moved);
        slit.triangles[0].iter_mut().filter(|corner| **corner == end).for_each(|corner| *corner = other);
    }
    assert!(Solid::try_from(slit).is_err());
    let mut far = cube().scaled([0.5; 3]).expect("a scale").translated([4_649_776.0, 500_000.0, 1e7]);
    far.triangles.truncate(10);
    assert!(Solid::try_from(far).is_err());
}

#[test]
fn shapes_of_three_js_are_usable_in_every_format() {
    for (name, mesh) in threejs::closed_shapes() {
        let solid = Solid::try_from(mesh.clone()).unwrap_or_else(|error| panic!("{name}: {error}"));
        let expected = mesh.volume();
        assert!(expected > 0.0, "{name}");
        assert!((solid.volume() / expected - 1.0).abs() < 1e-6, "{name}: {} {expected}", solid.volume());
        assert_eq!(solid.components(), 1, "{name}");
        assert!(solid.is_manifold(), "{name}");
        for format in [Format::Glb, Format::Stl, Format::Obj] {
            let mut bytes = Vec::new();
            io::write(&mesh, format, &mut bytes, &WriteOptions::new()).expect("written");
            let read = io::read(&bytes, format, &ReadOptions::new()).expect("read").mesh;
            let again = Solid::try_from(read).unwrap_or_else(|error| panic!("{name} as {format}: {error}"));
            assert!((again.volume() / solid.volume() - 1.0).abs() < 1e-6, "{name} as {format}");
        }
    }
}

#[test]
fn places_name_the_triangles_of_the_file() {
    // A cube with a fin before its triangles: all numbers are one higher in the file than in the solid.
    let mut mesh = cube();
    mesh.positions.push([2.0, 2.0, -1.0]);
    let [a, b, _] = mesh.triangles[0];
    mesh.triangles.insert(0, [a, b, 8]);
    let solid = Solid::try_from(mesh.clone()).expect("mended");
    let sources: Vec<u32> = (0..12).map(|triangle| solid.source_triangle(triangle)).collect();
    assert_eq!(sources, (1..13).collect::<Vec<_>>());
    // Origins of a result lead to the file as well, through the triangles that were split.
    let t_vertex = Solid::try_from(fixture("reported/t-vertex.obj")).expect("mended");
    assert_eq!(t_vertex.mesh().triangles.len(), 6);
    for triangle in 0..6 {
        let source = t_vertex.source_triangle(triangle) as usize;
        assert!(source < 5);
    }
    let (apart, _) = solid.separated();
    assert_eq!((0..12).map(|triangle| apart.source_triangle(triangle)).collect::<Vec<_>>(), sources);
    assert_eq!(apart.mending(), solid.mending());
}

#[test]
fn groups_follow_what_is_mended() {
    let mut mesh = fixture("reported/t-vertex.obj");
    mesh.groups.list =
        (0..5).map(|k| trisect::FaceGroup { name: format!("face {k}"), material: None }).collect();
    mesh.groups.of_triangle = (0..5).collect();
    let solid = Solid::try_from(mesh).expect("mended");
    let groups = &solid.mesh().groups.of_triangle;
    assert_eq!(groups.len(), solid.mesh().triangles.len());
    assert!((0..).zip(groups).all(|(triangle, &group)| solid.source_triangle(triangle) == group));
}

#[test]
fn the_least_distance_that_closes_is_found() {
    // One corner of one triangle off by a thousandth, another by less.
    let mut mesh = primitives::icosphere(1.0, 2).expect("a sphere");
    for (triangle, off) in [(7usize, 1e-3), (100, 2e-4)] {
        let vertex = mesh.triangles[triangle][0] as usize;
        let moved = mesh.positions[vertex].map(|x| x + off);
        mesh.triangles[triangle][0] = mesh.positions.len() as u32;
        mesh.positions.push(moved);
    }
    assert!(Solid::try_from(mesh.clone()).is_err());
    let solid = Gate::new().weld(Welding::Closing).solid(mesh.clone()).expect("welded");
    let distance = solid.mending().distance.expect("a distance");
    assert!((distance / (1e-3 * 3f64.sqrt()) - 1.0).abs() < 1e-9, "{distance}");
    assert_eq!(solid.mending().seams.count, 2);
    assert!(Gate::new().weld(Welding::Within(distance)).solid(mesh.clone()).is_ok());
    // By less, only if edges are split as well.
    let less = Gate::new().weld(Welding::Within(distance.next_down())).solid(mesh);
    assert!(less.is_err() || less.is_ok_and(|solid| solid.mending().split_edges.count > 0));
}

#[test]
fn the_distance_that_closes_parts_is_found_beside_what_stays_open() {
    // A ball that gapes by a thousandth in one corner, over an open floor.
    let mut ball = primitives::icosphere(1.0, 2).expect("a sphere");
    let volume = ball.volume();
    let vertex = ball.triangles[7][0] as usize;
    ball.triangles[7][0] = ball.positions.len() as u32;
    ball.positions.push(ball.positions[vertex].map(|x| x + 1e-3));
    let floor = Mesh::new(
        vec![[-9.0, -9.0, -2.0], [9.0, -9.0, -2.0], [9.0, 9.0, -2.0], [-9.0, 9.0, -2.0]],
        vec![[0, 1, 2], [0, 2, 3]],
    );
    let scene = Mesh::merged([&floor, &ball]).expect("small");
    assert!(Gate::new().closed_parts(true).solid(scene.clone()).is_err());
    assert!(Gate::new().weld(Welding::Closing).solid(scene.clone()).is_err());
    let solid = Gate::new().weld(Welding::Closing).closed_parts(true).solid(scene).expect("the ball");
    let distance = solid.mending().distance.expect("a distance");
    assert!((distance / (1e-3 * 3f64.sqrt()) - 1.0).abs() < 1e-9, "{distance}");
    assert_eq!(solid.mending().open_part_count, 1);
    assert!((solid.volume() - volume).abs() < 1e-2, "{}", solid.volume());
}

#[test]
fn open_parts_are_left_out_where_that_is_asked_for() {
    let plane = Mesh::new(
        vec![[-9.0, -9.0, 0.0], [9.0, -9.0, 0.0], [9.0, 9.0, 0.0], [-9.0, 9.0, 0.0]],
        vec![[0, 1, 2], [0, 2, 3]],
    );
    let mut dented = cube().translated([3.0, 0.0, 0.0]);
    dented.triangles.truncate(9);
    let scene = Mesh::merged([&plane, &cube(), &dented]).expect("small");
    assert!(Solid::try_from(scene.clone()).is_err());
    let solid = Gate::new().closed_parts(true).solid(scene).expect("the cube");
    assert_eq!(solid.volume(), 1.0);
    let mending = solid.mending();
    assert_eq!((mending.open_parts.count, mending.open_part_count), (11, 2));
    assert_eq!(mending.open_area, 324.0 + 4.5);
    assert_eq!(mending.open_parts.places[0].triangles, [0]);
    assert_eq!(solid.source_triangle(0), 2);
    // Nothing but open parts is no body.
    assert!(Gate::new().closed_parts(true).solid(plane).is_err());
}

#[test]
fn an_inverted_mesh_is_turned_on_request_only() {
    let inverted = fixture("reported/t-vertex.obj").reversed();
    assert!(matches!(Solid::try_from(inverted.clone()), Err(MeshError::InsideOut { .. })));
    let solid = Gate::new().orient(true).solid(inverted.clone()).expect("turned");
    assert_eq!(solid.volume(), 1.0 / 6.0);
    assert!(solid.mending().turned > 0);
    let refusal = Gate::new().orient(true).as_is(true).solid(inverted.clone()).expect_err("open");
    assert_eq!(refusal.mesh, inverted);
}

/// Damage of the kinds that can be mended with certainty. Each takes a mesh of closed shells and leaves none closed that it
/// touches.
mod damage {
    use super::*;

    fn vertex_of(mesh: &Mesh, triangle: usize, corner: usize) -> [f64; 3] {
        mesh.positions[mesh.triangles[triangle][corner] as usize]
    }

    fn any(mesh: &Mesh, random: &mut ChaCha8Rng) -> usize {
        random.random_range(0..mesh.triangles.len())
    }

    /// Some triangles get corners of their own, a rounding off.
    pub(super) fn seam(mesh: &mut Mesh, random: &mut ChaCha8Rng) {
        for _ in 0..random.random_range(1..6) {
            let (triangle, corner) = (any(mesh, random), random.random_range(0..3));
            let place = vertex_of(mesh, triangle, corner);
            // The origin has no rounding of its own: that of the places around it counts there.
            let size = place.iter().fold(0.0f64, |size, x| size.max(x.abs())).max(0.5);
            let off = |random: &mut ChaCha8Rng| {
                random.random_range(-1.0..1.0) * size * f64::from(f32::EPSILON) * 0.4
            };
            mesh.triangles[triangle][corner] = mesh.positions.len() as u32;
            mesh.positions.push(place.map(|x| x + off(random)));
        }
    }

    /// A triangle is cut into several along one side, its neighbour is not.
    pub(super) fn t_vertices(mesh: &mut Mesh, random: &mut ChaCha8Rng) {
        for _ in 0..random.random_range(1..4) {
            let triangle = any(mesh, random);
            let [a, b, c] = mesh.triangles[triangle];
            let [p, q] = [a, b].map(|corner| mesh.positions[corner as usize]);
            let pieces = random.random_range(2..5u32);
            let mut last = a;
            for k in 1..pieces {
                let at = f64::from(k) / f64::from(pieces);
                mesh.positions.push(std::array::from_fn(|axis| p[axis] + (q[axis] - p[axis]) * at));
                let next = mesh.positions.len() as u32 - 1;
                mesh.triangles.push([last, next, c]);
                last = next;
            }
            mesh.triangles[triangle] = [last, b, c];
        }
    }

    /// Triangles are stored again.
    pub(super) fn copies(mesh: &mut Mesh, random: &mut ChaCha8Rng) {
        for _ in 0..random.random_range(1..4) {
            let triangle = mesh.triangles[any(mesh, random)];
            let at = any(mesh, random);
            mesh.triangles.insert(at, triangle);
        }
    }

    /// A triangle hangs on an edge. (The edge has its own: two on one edge would not be flat.)
    pub(super) fn fin(mesh: &mut Mesh, random: &mut ChaCha8Rng) {
        let [a, b, _] = mesh.triangles[any(mesh, random)];
        mesh.positions.push(std::array::from_fn(|_| random.random_range(-2.0..2.0)));
        let apex = mesh.positions.len() as u32 - 1;
        mesh.triangles.push(if random.random() { [a, b, apex] } else { [b, a, apex] });
    }

    /// A triangle hangs on nothing.
    pub(super) fn stray(mesh: &mut Mesh, random: &mut ChaCha8Rng) {
        let first = mesh.positions.len() as u32;
        mesh.positions.extend((0..3).map(|_| std::array::from_fn(|_| random.random_range(-2.0..2.0))));
        mesh.triangles.push([first, first + 1, first + 2]);
    }

    /// A second body on a face of the first, the wall between them stored once.
    pub(super) fn wall(mesh: &mut Mesh, random: &mut ChaCha8Rng) {
        let [a, b, c] = mesh.triangles[any(mesh, random)];
        let [p, q, r] = [a, b, c].map(|corner| mesh.positions[corner as usize]);
        let (u, v): ([f64; 3], [f64; 3]) =
            (std::array::from_fn(|k| q[k] - p[k]), std::array::from_fn(|k| r[k] - p[k]));
        let cross = |i: usize, j: usize| u[i] * v[j] - u[j] * v[i];
        let normal = [cross(1, 2), cross(2, 0), cross(0, 1)];
        let length = normal.iter().map(|x| x * x).sum::<f64>().sqrt();
        mesh.positions.push(std::array::from_fn(|k| (p[k] + q[k] + r[k]) / 3.0 + normal[k] / length * 0.1));
        let apex = mesh.positions.len() as u32 - 1;
        mesh.triangles.extend([[a, b, apex], [b, c, apex], [c, a, apex]]);
    }
}

/// Six times the signed volume that triangles enclose, judged by adding up: right for what is closed, and for what is closed
/// but for rounding.
fn volume_with_walls(mesh: &Mesh, dropped: &[usize]) -> f64 {
    let kept = mesh.triangles.iter().enumerate().filter(|(index, _)| !dropped.contains(index));
    Mesh::new(mesh.positions.clone(), kept.map(|(_, triangle)| *triangle).collect()).volume()
}

#[test]
fn damage_of_known_kinds_is_undone() {
    let bodies = [
        primitives::icosphere(1.0, 2).expect("a sphere"),
        primitives::torus(1.5, 0.4, 12, 9).expect("a torus"),
        cube(),
        Mesh::merged([&cube(), &cube().scaled([0.25; 3]).expect("a scale").translated([0.3; 3]).reversed()])
            .expect("small"),
    ];
    type Damage = fn(&mut Mesh, &mut ChaCha8Rng);
    let kinds: [(&str, Damage); 6] = [
        ("seam", damage::seam),
        ("t-vertices", damage::t_vertices),
        ("copies", damage::copies),
        ("fin", damage::fin),
        ("stray", damage::stray),
        ("wall", damage::wall),
    ];
    let mut undone = 0;
    for seed in 0..600 {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let mut mesh = bodies[seed as usize % bodies.len()].clone();
        let (name, damage) = kinds[seed as usize / bodies.len() % kinds.len()];
        damage(&mut mesh, &mut random);
        let (before, body) = (mesh.clone(), &bodies[seed as usize % bodies.len()]);
        let solid = Solid::try_from(mesh).unwrap_or_else(|error| panic!("seed {seed}, {name}: {error}"));
        let mending = solid.mending();
        assert!(!mending.is_none(), "seed {seed}, {name}");
        assert!(is_closed(&solid.mesh().triangles), "seed {seed}, {name}");
        let expected = match name {
            "wall" => volume_with_walls(&before, &places(mending)),
            _ => body.volume(),
        };
        assert!(
            (solid.volume() - expected).abs() <= 1e-6,
            "seed {seed}, {name}: {} {expected}",
            solid.volume()
        );
        if matches!(name, "copies" | "fin" | "stray") {
            // The same triangles in another order: sums differ in the last places.
            let difference = (solid.volume() - expected).abs();
            assert!(difference <= 1e-14, "seed {seed}, {name}: {difference}");
            assert_eq!(chain_of(solid.mesh()), chain_of(body), "seed {seed}, {name}");
        }
        undone += 1;
    }
    assert_eq!(undone, 600);
}

/// The triangles of walls that were left out, where all places are kept.
fn places(mending: &Mending) -> Vec<usize> {
    assert_eq!(mending.walls.count, mending.walls.places.len());
    mending.walls.places.iter().map(|place| place.triangles[0] as usize).collect()
}

/// A box whose faces are cut by planes as csg.js cuts polygons: each face alone, so that the neighbours have vertices in the
/// middle of their edges; as a soup in single precision.
fn cut_like_csg_js(random: &mut ChaCha8Rng) -> Mesh {
    let planes: Vec<([f64; 3], f64)> = (0..6)
        .map(|_| (std::array::from_fn(|_| random.random_range(-1.0..1.0)), random.random_range(-0.5..0.5)))
        .collect();
    let corner = |k: usize| [k & 1, k >> 1 & 1, k >> 2 & 1].map(|bit| bit as f64 * 2.0 - 1.0);
    let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let mut mesh = Mesh::default();
    for face in faces {
        let mut polygons = vec![face.map(corner).to_vec()];
        for (normal, offset) in &planes {
            if random.random() {
                polygons =
                    polygons.into_iter().flat_map(|polygon| halves(&polygon, normal, *offset)).collect();
            }
        }
        for polygon in polygons {
            let first = mesh.positions.len() as u32;
            let count = polygon.len() as u32;
            mesh.positions.extend(polygon);
            mesh.triangles.extend((1..count - 1).map(|k| [first, first + k, first + k + 1]));
        }
    }
    threejs::single(mesh)
}

fn halves(polygon: &[[f64; 3]], normal: &[f64; 3], offset: f64) -> Vec<Vec<[f64; 3]>> {
    let height = |p: &[f64; 3]| p[0] * normal[0] + p[1] * normal[1] + p[2] * normal[2] - offset;
    let (mut below, mut above) = (Vec::new(), Vec::new());
    for (k, p) in polygon.iter().enumerate() {
        let q = &polygon[(k + 1) % polygon.len()];
        let (from, to) = (height(p), height(q));
        if from <= 0.0 {
            below.push(*p);
        } else {
            above.push(*p);
        }
        if (from <= 0.0) != (to <= 0.0) {
            let at = from / (from - to);
            let crossing = std::array::from_fn(|axis| p[axis] + (q[axis] - p[axis]) * at);
            below.push(crossing);
            above.push(crossing);
        }
    }
    [below, above].into_iter().filter(|half| half.len() > 2).collect()
}

#[test]
fn t_junctions_on_both_sides_of_edges_are_closed() {
    let mut split = 0;
    for seed in 0..200 {
        let mesh = cut_like_csg_js(&mut ChaCha8Rng::seed_from_u64(seed));
        let mut bytes = Vec::new();
        io::write(&mesh, Format::Stl, &mut bytes, &WriteOptions::new()).expect("written");
        let read = io::read(&bytes, Format::Stl, &ReadOptions::new()).expect("read").mesh;
        let solid = Solid::try_from(read).unwrap_or_else(|error| panic!("seed {seed}: {error}"));
        assert!((solid.volume() - 8.0).abs() < 1e-5, "seed {seed}: {}", solid.volume());
        split += solid.mending().split_edges.count;
    }
    assert!(split > 200, "{split}");
}

#[test]
fn any_soup_is_taken_or_refused() {
    let (mut taken, mut refused) = (0, 0);
    for seed in 0..10_000 {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let mesh = soup(&mut random);
        let gates = [
            Gate::new(),
            Gate::new().orient(true).closed_parts(true).single_shells(true),
            Gate::new().weld(Welding::Closing).closed_parts(true),
            Gate::new().weld(Welding::Within(0.3)),
        ];
        let gate = gates[seed as usize % gates.len()];
        match gate.solid(mesh.clone()) {
            Ok(solid) => {
                taken += 1;
                assert!(is_closed(&solid.mesh().triangles), "seed {seed}");
                assert!(solid.volume() >= 0.0, "seed {seed}");
                let sources =
                    (0..solid.mesh().triangles.len() as u32).map(|triangle| solid.source_triangle(triangle));
                assert!(
                    sources.clone().all(|source| (source as usize) < mesh.triangles.len()),
                    "seed {seed}"
                );
            }
            Err(refusal) => {
                refused += 1;
                assert_eq!(refusal.mesh, mesh, "seed {seed}");
                assert!(!refusal.error.to_string().is_empty());
            }
        }
    }
    assert!(taken > 500 && refused > 500, "{taken} {refused}");
}

/// A closed mesh with triangles removed, turned, repeated, moved; or triangles at random on a small grid.
fn soup(random: &mut ChaCha8Rng) -> Mesh {
    let mut mesh = match random.random_range(0..4) {
        0 => cube(),
        1 => primitives::octahedron(1.0).expect("an octahedron"),
        2 => primitives::torus(1.0, 0.5, 4, 3).expect("a torus"),
        _ => {
            let count = random.random_range(3..10u32);
            let grid = |random: &mut ChaCha8Rng| f64::from(random.random_range(0..3u32)) * 0.5;
            let positions = (0..count).map(|_| std::array::from_fn(|_| grid(random))).collect();
            let triangles = (0..random.random_range(1..20))
                .map(|_| std::array::from_fn(|_| random.random_range(0..count)));
            Mesh::new(positions, triangles.collect())
        }
    };
    for _ in 0..random.random_range(0..4) {
        let any = random.random_range(0..mesh.triangles.len().max(1));
        if mesh.triangles.is_empty() {
            break;
        }
        match random.random_range(0..7) {
            0 => {
                mesh.triangles.remove(any);
            }
            1 => mesh.triangles[any].swap(0, 1),
            2 => mesh.triangles.push(mesh.triangles[any]),
            3 => damage::t_vertices(&mut mesh, random),
            4 => damage::seam(&mut mesh, random),
            5 => damage::fin(&mut mesh, random),
            _ => {
                let vertex = random.random_range(0..mesh.positions.len());
                mesh.positions[vertex][0] += random.random_range(-0.2..0.2);
            }
        }
    }
    mesh
}
