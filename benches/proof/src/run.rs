//! One case, run and judged.

use std::panic::{AssertUnwindSafe, catch_unwind};

use crate::judge::cases::{Case, Family};
use crate::judge::contacts::{self, Parted, Topology, touches_itself_along};
use crate::judge::oracle;
use crate::judge::surface::Properties;
use crate::judge::vector::extent;
use crate::judge::wide;
use trisect::mesh::SelfCrossing;
use trisect::{BooleanOptions, Control, Mesh, Operation, Outcome, Solid};

/// The topology of a mesh with its contacts parted. Vertices nearer than a part of its size are one: on the grid 1e-9, less
/// where features are so small that they would collapse. `part` is the size of the smallest of the operands in that of the mesh.
pub(crate) fn parted(mesh: &Mesh, part: f64) -> Option<Parted> {
    [1e-9, 1e-11, 1e-13].into_iter().find_map(|reach| contacts::parted(mesh, part * reach))
}

/// The same with every distance at which vertices may be one, the largest first; with the last only those a rounding apart are.
pub(crate) fn parted_by_reach(mesh: &Mesh, part: f64) -> Vec<Parted> {
    [1e-9, 1e-11, 1e-13, 1e-16].into_iter().filter_map(|reach| contacts::parted(mesh, part * reach)).collect()
}

/// The size of the smallest of some meshes in that of another; 1 unless they are far apart.
pub(crate) fn smallest_part(of: &[&Mesh], whole: &Mesh) -> f64 {
    let size = |mesh: &Mesh| {
        let [low, high] = extent(&mesh.positions);
        (0..3).map(|k| high[k] - low[k]).fold(0.0, f64::max)
    };
    let part = of.iter().map(|mesh| size(mesh)).fold(f64::INFINITY, f64::min) / size(whole);
    if part < 1e-3 { part } else { 1.0 }
}

pub(crate) const PANIC: u16 = 1;
pub(crate) const OPEN: u16 = 2;
pub(crate) const NOT_MANIFOLD: u16 = 4;
pub(crate) const ZERO_AREA: u16 = 8;
pub(crate) const IDENTITY: u16 = 16;
pub(crate) const CERTIFICATE: u16 = 32;
pub(crate) const OPERAND: u16 = 64;
pub(crate) const CROSSES_ITSELF: u16 = 128;
/// Fused where touching material should be apart, or with walls of no thickness. Asked on the grid only.
pub(crate) const CONTACT: u16 = 256;
/// The result crosses itself, but only where an operand does, within the rounding of single precision.
pub(crate) const INHERITED: u16 = 512;

/// The names of the faults, in the order of their bits.
pub(crate) const FAULTS: [&str; 10] = [
    "panic",
    "open",
    "not manifold",
    "zero area",
    "identity",
    "certificate",
    "operand crosses itself",
    "crosses itself",
    "contact",
    "crosses itself as an operand does",
];

/// What was found of a result.
#[derive(Clone, Debug, Default)]
pub(crate) struct Found {
    pub(crate) faults: u16,
    pub(crate) volume: f64,
    pub(crate) area: f64,
    pub(crate) euler: i64,
    pub(crate) components: usize,
    pub(crate) triangles: usize,
    pub(crate) judged: usize,
    pub(crate) mistakes: usize,
    pub(crate) identity_error: f64,
    pub(crate) farthest_rounded: f64,
}

/// The operands of a case; nothing after a panic. What is found out about them is remembered there, for all operations.
pub(crate) fn operands(case: &Case) -> Option<[Solid; 2]> {
    let made = || [&case.a, &case.b].map(|mesh| Solid::try_from(mesh.clone()).expect("closed operands"));
    catch_unwind(AssertUnwindSafe(made)).ok()
}

/// The result of the case's own operation.
pub(crate) fn attempt(case: &Case) -> Option<Mesh> {
    Some(run(case.operation, &operands(case)?)?.into_mesh())
}

/// What an operation makes; nothing after a panic.
fn run(operation: Operation, solids: &[Solid; 2]) -> Option<Made> {
    made(|| BooleanOptions::new().threads(1).run(operation, [&solids[0], &solids[1]]).expect("no limits"))
}

/// What comes of a call.
pub(crate) struct Made {
    outcome: Outcome,
    pub(crate) properties: Properties,
}

pub(crate) fn made(call: impl FnOnce() -> Outcome) -> Option<Made> {
    let outcome = catch_unwind(AssertUnwindSafe(call)).ok()?;
    let properties = Properties::of(outcome.solid().mesh());
    Some(Made { outcome, properties })
}

impl Made {
    pub(crate) fn mesh(&self) -> &Mesh {
        self.outcome.solid().mesh()
    }

    pub(crate) fn into_mesh(self) -> Mesh {
        self.outcome.into_solid().into_mesh()
    }

    /// Whether the certificate says what is so.
    fn certificate_agrees(&self) -> bool {
        let (certificate, found) = (self.outcome.certificate(), &self.properties);
        let close = |a: f64, b: f64| (a - b).abs() <= 1e-9 * (a.abs() + b.abs()) + 1e-12;
        certificate.closed == found.closed
            && certificate.manifold == found.manifold
            && certificate.components == found.components
            && certificate.zero_area == found.zero_area
            && close(certificate.area, found.area)
    }

    /// The fault of a result that crosses itself, or 0. It must be an operand in its turn.
    fn crossings(&self, operands: &[Solid]) -> u16 {
        let Ok(solid) = Solid::try_from(self.mesh().clone()) else { return CROSSES_ITSELF };
        let Ok(found) = solid.self_crossings(&Control::new()) else { return CROSSES_ITSELF };
        if found.is_clean() {
            return 0;
        }
        // Operands whose coordinates are all of single precision may cross by its rounding. A result has others as well, and is
        // measured by double precision.
        let origins = self.outcome.origins();
        let is_of_operand = |crossing: &SelfCrossing| {
            let [a, b] = crossing.triangles.map(|t| origins[solid.source_triangle(t) as usize].operand);
            let known = operands[a as usize].known_self_crossings();
            a == b && known.is_some_and(|known| known.tolerated > 0 && crossing.depth <= known.tolerance)
        };
        if found.places.iter().all(is_of_operand) { INHERITED } else { CROSSES_ITSELF }
    }
}

/// Whether a solid crosses itself by more than rounding.
fn crosses_itself(solid: &Solid) -> bool {
    solid.self_crossings(&Control::new()).map_or(true, |found| !found.is_clean())
}

/// Whether touching material is apart all over a result, but where it is stated that it stays joined: in an edge in which an operand touches itself,
/// and where an edge touches a face from inside.
fn is_parted(mesh: &Mesh, properties: &Properties, operands: &[&Mesh]) -> bool {
    let actual = Topology { components: properties.components, euler: properties.euler };
    parted(mesh, 1.0).is_some_and(|Parted { topology, pinched, mispaired }| {
        let is_own = |edge: &_| operands.iter().any(|operand| touches_itself_along(operand, edge));
        topology == actual || ((pinched || !mispaired.is_empty()) && mispaired.iter().all(is_own))
    })
}

/// The volume of the result of another operation on the same operands; not a number after a panic.
fn volume_of(operation: Operation, solids: &[Solid; 2]) -> f64 {
    run(operation, solids).map_or(f64::NAN, |made| made.properties.volume)
}

/// How far the volumes of this result and another are from what they should be together, relative to the volume of the box
/// round both operands.
fn identity_error(case: &Case, solids: &[Solid; 2], volume: f64) -> f64 {
    let [va, vb] = [&case.a, &case.b].map(crate::judge::surface::volume);
    let (all, either) = (va + vb, Operation::Intersection);
    let error = match case.operation {
        Operation::Union => volume + volume_of(either, solids) - all,
        Operation::Intersection => volume + volume_of(Operation::Difference, solids) - va,
        Operation::Difference => volume + volume_of(either, solids) - va,
        Operation::SymmetricDifference => volume + 2.0 * volume_of(either, solids) - all,
        other => unreachable!("nothing is expected of {other}"),
    };
    let [low, high] = extent(case.a.positions.iter().chain(&case.b.positions));
    error / (0..3).map(|k| high[k] - low[k]).product::<f64>()
}

/// The smallest relative error of a volume that is a fault: rounding of coordinates far from the origin counts.
pub(crate) fn identity_tolerance(case: &Case) -> f64 {
    let [low, high] = extent(case.a.positions.iter().chain(&case.b.positions));
    let size = (0..3).map(|k| high[k] - low[k]).fold(f64::INFINITY, f64::min);
    let largest = low.iter().chain(&high).fold(0.0f64, |most, x| most.max(x.abs()));
    1e-12 + 64.0 * f64::EPSILON * largest / size
}

pub(crate) fn examine(seed: u64, case: &Case, points: usize) -> Found {
    let mut found = Found::default();
    let solids = operands(case);
    let made = solids.as_ref().and_then(|solids| run(case.operation, solids));
    let (Some(solids), Some(made)) = (&solids, made) else {
        found.faults |= PANIC;
        return found;
    };
    let (mesh, properties) = (made.mesh(), &made.properties);
    let given_zero_area: usize = [&case.a, &case.b].map(|mesh| Properties::of(mesh).zero_area).iter().sum();
    found.faults |= faults_of_result(seed, &made, solids, given_zero_area);
    for (fault, is_so) in [
        (OPERAND, solids.iter().any(crosses_itself)),
        (CONTACT, case.family == Family::Grid && !is_parted(mesh, properties, &[&case.a, &case.b])),
    ] {
        if is_so {
            found.faults |= fault;
        }
    }
    if case.family == Family::Apart {
        return apart(seed, case, solids, mesh, points, properties, found);
    }
    let verdict = oracle::judge(case.operation, &[&case.a, &case.b], mesh, points, seed);
    found.identity_error = identity_error(case, solids, properties.volume);
    // Not "greater": a panic of the other operation leaves no number.
    if !(found.identity_error.abs() <= identity_tolerance(case)) {
        found.faults |= IDENTITY;
    }
    Found {
        volume: properties.volume,
        area: properties.area,
        euler: properties.euler,
        components: properties.components,
        triangles: mesh.triangles.len(),
        judged: verdict.judged,
        mistakes: verdict.mistakes.len(),
        farthest_rounded: verdict.farthest_rounded,
        ..found
    }
}

/// What is asked of every result.
pub(crate) fn faults_of_result(seed: u64, made: &Made, operands: &[Solid], given_zero_area: usize) -> u16 {
    let (mesh, properties) = (made.mesh(), &made.properties);
    // Of large results only every eighth is asked whether it crosses itself: that takes longer than all the rest.
    let asks = mesh.triangles.len() < 1_000 || seed.is_multiple_of(8);
    let mut faults = if asks { made.crossings(operands) } else { 0 };
    for (fault, is_so) in [
        (CERTIFICATE, !made.certificate_agrees()),
        (OPEN, !properties.closed),
        (NOT_MANIFOLD, !properties.manifold),
        // What an operand has, as files in single precision do, its untouched parts keep.
        (ZERO_AREA, properties.zero_area > given_zero_area),
    ] {
        if is_so {
            faults |= fault;
        }
    }
    faults
}

/// Triangles that lie on others in one plane: walls without thickness.
pub(crate) fn walls(mesh: &Mesh) -> usize {
    let solid = Solid::try_from(mesh.clone()).ok();
    solid
        .and_then(|solid| solid.self_crossings(&Control::new()).map(|found| found.touching).ok())
        .unwrap_or(0)
}

/// The judgement of a case whose sizes are so far apart that the volume of the box says nothing, and products overflow: volumes
/// and points exactly, at the scale of the smaller operand.
fn apart(
    seed: u64,
    case: &Case,
    solids: &[Solid; 2],
    mesh: &Mesh,
    points: usize,
    properties: &Properties,
    mut found: Found,
) -> Found {
    // Measures that overflow say nothing.
    if !(properties.volume.is_finite() && properties.area.is_finite()) {
        found.faults &= !CERTIFICATE;
    }
    let at = wide::points_beside(&case.a, &case.b, std::slice::from_ref(mesh), points, seed);
    let (judged, mistakes) = wide::judge(case.operation, [&case.a, &case.b], mesh, &at);
    let other = match case.operation {
        Operation::Intersection => Operation::Difference,
        _ => Operation::Intersection,
    };
    let is_right = run(other, solids).is_some_and(|second| {
        let second = second.into_mesh();
        let [a, b, this, that] = [&case.a, &case.b, mesh, &second].map(wide::six_volumes);
        let error = match case.operation {
            Operation::Union => this + that - a - b,
            Operation::SymmetricDifference => this + &that + that - a - b,
            _ => this + that - a,
        };
        let slack = |of: &Mesh| wide::six_volumes_of_rounding(of, &[&case.a, &case.b], 2);
        let slack = slack(mesh) + slack(&second) + slack(&second);
        -&slack <= error && error <= slack
    });
    if !is_right {
        found.faults |= IDENTITY;
    }
    Found {
        volume: properties.volume,
        area: properties.area,
        euler: properties.euler,
        components: properties.components,
        triangles: mesh.triangles.len(),
        judged,
        mistakes: mistakes.len(),
        ..found
    }
}

/// What is wrong with a case, as bits; a mistake that the oracle sees counts as a fault of the volume. Nothing is wrong with
/// an operand that crosses itself: such a pair is no case.
pub(crate) fn faults_of(case: &Case) -> u16 {
    let found = examine(1, case, 200);
    let faults = if found.mistakes > 0 { found.faults | IDENTITY } else { found.faults };
    if faults & OPERAND != 0 { 0 } else { faults }
}

/// Prints all that is known of a case.
pub(crate) fn show(seed: u64, case: &Case) {
    println!(
        "seed {seed}: {:?} {:?}, {} and {} triangles",
        case.family,
        case.operation,
        case.a.triangles.len(),
        case.b.triangles.len()
    );
    println!("  A {:?}\n  B {:?}", Properties::of(&case.a), Properties::of(&case.b));
    let found = examine(seed, case, 2_000);
    let faults: Vec<&str> =
        (0..10).filter(|bit| found.faults >> bit & 1 == 1).map(|bit| FAULTS[bit]).collect();
    println!("  faults {faults:?} (identity tolerance {:e})\n  {found:?}", identity_tolerance(case));
    if let Some(mesh) = attempt(case) {
        println!("  result {:?}, contacts parted {:?}", Properties::of(&mesh), parted(&mesh, 1.0));
        let verdict = oracle::judge(case.operation, &[&case.a, &case.b], &mesh, 2_000, seed);
        for mistake in verdict.mistakes.iter().take(3) {
            println!("  {mistake:?}");
        }
    }
}
