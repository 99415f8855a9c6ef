//! Bodies and cells.

use trisect::{BooleanOptions, Expression, Mesh, Solid, primitives};

use crate::common::solid;

#[test]
fn the_bodies_of_a_solid_add_up_to_it() {
    // A grid of balls, each second one hollow.
    let mut all = Mesh::default();
    for i in 0..27 {
        let place = [f64::from(i % 3), f64::from(i / 3 % 3), f64::from(i / 9)].map(|x| 3.0 * x);
        all.append(&primitives::geodesic_sphere(1.0, 4).expect("a ball").translated(place))
            .expect("few vertices");
        if i % 2 == 1 {
            let cavity = primitives::geodesic_sphere(0.5, 3).expect("a ball").reversed().translated(place);
            all.append(&cavity).expect("few vertices");
        }
    }
    let all = solid(all);
    let bodies = all.bodies();
    assert_eq!(bodies.len(), 27);
    assert_eq!(bodies.iter().filter(|body| body.components() == 2).count(), 13);
    let sum: f64 = bodies.iter().map(Solid::volume).sum();
    assert!((sum - all.volume()).abs() < 1e-12 * sum);
    let triangles: usize = bodies.iter().map(|body| body.mesh().triangles.len()).sum();
    assert_eq!(triangles, all.mesh().triangles.len());
}

#[test]
fn cells_share_their_seams_and_fill_the_union() {
    let a = solid(primitives::torus(2.0, 0.7, 30, 15).expect("a ring"));
    let b = solid(primitives::geodesic_sphere(1.2, 8).expect("a ball").translated([1.7, 0.3, 0.1]));
    let both = || vec![Expression::Operand(0), Expression::Operand(1)];
    let cells = [
        Expression::Difference(both()),
        Expression::Intersection(both()),
        Expression::Difference(vec![Expression::Operand(1), Expression::Operand(0)]),
    ];
    let found = BooleanOptions::new().evaluate_all(&cells, [&a, &b]).expect("cells");
    let sum: f64 = found.iter().map(|cell| cell.solid().volume()).sum();
    let union = a.union(&b).expect("a union").solid().volume();
    assert!((sum - union).abs() < 1e-12 * union);
    let seam = |cell: &trisect::Outcome| {
        let mesh = cell.solid().mesh();
        let mut seam: Vec<[u64; 3]> =
            cell.curves().iter().flatten().map(|&v| mesh.positions[v as usize].map(f64::to_bits)).collect();
        seam.sort_unstable();
        seam.dedup();
        seam
    };
    assert!(seam(&found[0]).len() > 20);
    assert_eq!(seam(&found[0]), seam(&found[1]));
    assert_eq!(seam(&found[0]), seam(&found[2]));
}
