//! Whether a result far from the origin is what it is at the origin, where next to nothing is rounded.

use trisect::{BooleanOptions, Mesh, Solid};

use super::cases::Case;
use super::contacts::{self, Topology};
use super::surface::Properties;
use super::vector::{minus, plus};

/// Units in the last place that a vertex may be beside its place at the origin: half of one, and what is rounded there.
const ULPS: f64 = 0.51;

/// Runs the operation on the operands moved to the origin, without rounding. `Ok` if the result there has the same vertices in
/// the same order, each rounded once, is connected as often, and has its contacts parted; else what differs.
pub(crate) fn compared_at_origin(case: &Case, far: &Mesh) -> Result<(), String> {
    let from = case.a.positions.first().copied().unwrap_or_default();
    let moved = |mesh: &Mesh| {
        let positions: Vec<_> = mesh.positions.iter().map(|p| minus(*p, from)).collect();
        let exact = mesh.positions.iter().zip(&positions).all(|(p, q)| plus(*q, from, 1.0) == *p);
        exact
            .then(|| Mesh::new(positions, mesh.triangles.clone()))
            .ok_or("operands are rounded when they are moved")
    };
    let operands = [moved(&case.a)?, moved(&case.b)?];
    let solids = operands.map(|mesh| Solid::try_from(mesh).expect("closed as before"));
    let outcome = BooleanOptions::new().threads(1).run(case.operation, &solids).expect("no limits");
    let near = outcome.solid().mesh();
    if near.positions.len() != far.positions.len() {
        return Err(format!("{} vertices for {}", far.positions.len(), near.positions.len()));
    }
    for (p, q) in far.positions.iter().zip(&near.positions) {
        for k in 0..3 {
            let ulp = p[k].abs().next_up() - p[k].abs();
            if ((p[k] - from[k]) - q[k]).abs() > ULPS * ulp {
                return Err(format!("{p:?} for {q:?}"));
            }
        }
    }
    let own = |mesh: &Mesh| {
        let found = Properties::of(mesh);
        Topology { components: found.components, euler: found.euler }
    };
    let parted = [1e-9, 1e-11, 1e-13].into_iter().filter_map(|reach| contacts::parted(near, reach));
    if own(far) != own(near) || parted.map(|parted| parted.topology).all(|topology| topology != own(near)) {
        return Err(format!("{:?} for {:?}", own(far), own(near)));
    }
    Ok(())
}
