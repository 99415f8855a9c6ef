//! Pairs of solids as people have them, from a seed: sizes far apart, needles, sheets, single precision, far from the origin,
//! results of chains of cuts and turns, and of files written and read between the steps.

use rand::RngExt;
use rand::rngs::ChaCha8Rng;
use trisect::io::{Format, ReadOptions, WriteOptions};
use trisect::{BooleanOptions, Control, Mesh, Operation, Solid, primitives};

use super::cases::Family;
use super::placement::{anywhere, mapped, moved, rotated, rotation};
use super::shapes;

/// A family, by its share, and a pair of it.
pub(crate) fn pair(random: &mut ChaCha8Rng) -> (Family, Mesh, Mesh) {
    match random.random_range(0..100) {
        0..20 => apart(random),
        20..32 => needles(random),
        32..42 => sheets(random),
        42..56 => single(random),
        56..70 => far(random),
        70..88 => chain(Family::Chain, random),
        _ => chain(Family::Files, random),
    }
}

fn cuboid(half: [f64; 3]) -> Mesh {
    primitives::cuboid(half.map(|x| -x), half).expect("a box")
}

/// A body of size one, and one of up to 1e300 with a corner, an edge or a face there.
fn apart(random: &mut ChaCha8Rng) -> (Family, Mesh, Mesh) {
    let small = anywhere(&shapes::round_or_any(random), 0.5, random);
    let size =
        10f64.powf([3.0, 12.0, 40.0, 300.0][random.random_range(0..4)] * random.random_range(0.0..1.0));
    let (mut low, mut high) = ([-size; 3], [size; 3]);
    for k in 0..random.random_range(1..4) {
        let at = random.random_range(-0.5..0.5);
        if random.random() { low[k] = at } else { high[k] = at }
    }
    if (0..3).any(|k| low[k] >= high[k]) {
        return apart(random);
    }
    let large = primitives::cuboid(low, high).expect("a box");
    let large = match random.random_range(0..3) {
        // A tetrahedron with a corner near the small one.
        0 => loop {
            let mut corners = [0; 4].map(|_| [0; 3].map(|_| size * random.random_range(-1.0..1.0)));
            corners[0] = [0; 3].map(|_| random.random_range(-0.5..0.5));
            if let Ok(mesh) = primitives::tetrahedron(corners)
                && Solid::try_from(mesh.clone()).is_ok()
            {
                break mesh;
            }
        },
        _ => large,
    };
    if random.random() { (Family::Apart, large, small) } else { (Family::Apart, small, large) }
}

fn needles(random: &mut ChaCha8Rng) -> (Family, Mesh, Mesh) {
    let mut needle = || {
        let width = 10f64.powf(random.random_range(-6.0..-2.0));
        let aside = width * random.random_range(0.2..5.0);
        let mesh = if random.random() {
            cuboid([1.0, width, aside])
        } else {
            let turned = primitives::cylinder(width, 2.0, random.random_range(3..9)).expect("a cylinder");
            mapped(&turned, false, |[x, y, z]| [z, x, y])
        };
        anywhere(&mesh, width, random)
    };
    let (a, b) = (needle(), needle());
    if random.random() {
        (Family::Needle, a, b)
    } else {
        (Family::Needle, anywhere(&shapes::round_or_any(random), 0.2, random), b)
    }
}

fn sheets(random: &mut ChaCha8Rng) -> (Family, Mesh, Mesh) {
    let mut sheet = || cuboid([1.0, 0.8, 10f64.powf(random.random_range(-9.0..-3.0))]);
    let (a, b) = (sheet(), sheet());
    let body = shapes::round_or_any(random);
    let b = anywhere(&b, 0.1, random);
    let a = if random.random() { a } else { body };
    (Family::Flat, anywhere(&a, 0.1, random), b)
}

/// In single precision, once turned.
fn single(random: &mut ChaCha8Rng) -> (Family, Mesh, Mesh) {
    let pick = |random: &mut ChaCha8Rng| {
        if random.random() { shapes::on_grid(random) } else { shapes::round_or_any(random) }
    };
    let (a, b) = (pick(random), pick(random));
    let matrix = rotation(random);
    let by = [0; 3].map(|_| random.random_range(-1.0..1.0));
    let rounded = |mesh: &Mesh| {
        let single = mapped(&moved(&rotated(mesh, &matrix), by), false, |p| p.map(|x| f64::from(x as f32)));
        sound(&single).then_some(single)
    };
    match (rounded(&a), rounded(&b)) {
        (Some(a), Some(b)) => (Family::Single, a, b),
        _ => single(random),
    }
}

/// Coordinates of 1e12, sizes of one to a thousand: a unit in the last place is 1e-4.
fn far(random: &mut ChaCha8Rng) -> (Family, Mesh, Mesh) {
    let size = [10.0, 100.0, 1000.0][random.random_range(0..3)];
    let by = [0; 3].map(|_| 1e12 * random.random_range(-1.0..1.0));
    let mut one = || {
        let mesh = anywhere(&shapes::round_or_any(random), 0.4, random);
        moved(&mapped(&mesh, false, |p| p.map(|x| x * size)), by)
    };
    let (a, b) = (one(), one());
    if sound(&a) && sound(&b) { (Family::Far12, a, b) } else { far(random) }
}

/// Cut, turned and cut again; as files in between, too.
fn chain(family: Family, random: &mut ChaCha8Rng) -> (Family, Mesh, Mesh) {
    const FORMATS: [Format; 5] = [Format::Stl, Format::Obj, Format::Ply, Format::Off, Format::Glb];
    let mut body = shapes::round_or_any(random);
    for _ in 0..random.random_range(2..6) {
        let tool = anywhere(&shapes::round_or_any(random), 0.7, random);
        let operation =
            [Operation::Union, Operation::Difference, Operation::Difference, Operation::Intersection];
        let operation = operation[random.random_range(0..4)];
        let format = FORMATS[random.random_range(0..5)];
        let matrix = rotation(random);
        let Some(next) = combined(operation, &body, &tool) else { continue };
        let next = if family == Family::Files { through(&next, format) } else { Some(next) };
        // What is not an operand any more once it is rounded is left as it was.
        if let Some(next) = next.map(|mesh| rotated(&mesh, &matrix)).filter(sound) {
            body = next;
        }
    }
    (family, body, anywhere(&shapes::round_or_any(random), 0.7, random))
}

fn combined(operation: Operation, a: &Mesh, b: &Mesh) -> Option<Mesh> {
    let solids = [a, b].map(|mesh| Solid::try_from(mesh.clone()).expect("closed"));
    let outcome = BooleanOptions::new().threads(1).run(operation, [&solids[0], &solids[1]]).ok()?;
    (!outcome.solid().is_empty()).then(|| outcome.into_solid().into_mesh())
}

/// Written and read.
fn through(mesh: &Mesh, format: Format) -> Option<Mesh> {
    let mut bytes = Vec::new();
    trisect::io::write(mesh, format, &mut bytes, &WriteOptions::new()).ok()?;
    let read = trisect::io::read(&bytes, format, &ReadOptions::new()).ok()?.mesh;
    Some(Solid::try_from(read).ok()?.into_mesh())
}

/// Whether a mesh is an operand that does not cross itself.
fn sound(mesh: &Mesh) -> bool {
    let Ok(solid) = Solid::try_from(mesh.clone()) else { return false };
    !solid.is_empty()
        && solid.self_crossings(&Control::new()).is_ok_and(trisect::mesh::SelfCrossings::is_clean)
}
