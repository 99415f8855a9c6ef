//! Models by others, with volumes and areas that CGAL's exact booleans and manifold3d agree on to nine digits.

use std::path::Path;

use trisect::Operation::{self, Difference, Intersection, Union};
use trisect::{Mesh, Solid};

use crate::common::same_bits;
use crate::judge::oracle;
use crate::trial::{Expected, Trial};

/// Operands, operation; volume, area, components and Euler characteristic of the result.
type Row = (&'static str, &'static str, Operation, f64, f64, usize, i64);

const RESULTS: [Row; 18] = [
    ("ballA.off", "ballB.off", Union, 2477.660029811463, 954.2886987456174, 1, 2),
    ("ballA.off", "ballB.off", Intersection, 324.54999416656864, 257.53011070831366, 1, 2),
    ("ballA.off", "ballB.off", Difference, 1076.5550619882792, 605.9233110219459, 1, 2),
    ("elephant.off", "sphere.off", Union, 0.5068657162993948, 3.1293927590498947, 1, 2),
    ("elephant.off", "sphere.off", Intersection, 0.04528766635405579, 1.1982469818103687, 1, -4),
    ("elephant.off", "sphere.off", Difference, 0.0009135683720260896, 0.0975255868362053, 4, 8),
    ("center_cylinder.obj", "offset_cylinder.obj", Union, 9.288047134306995, 25.06872578749377, 1, 2),
    (
        "center_cylinder.obj",
        "offset_cylinder.obj",
        Intersection,
        3.1977337057070034,
        12.509443209048056,
        1,
        2,
    ),
    ("center_cylinder.obj", "offset_cylinder.obj", Difference, 3.045157074779997, 18.789084147340102, 1, 2),
    ("stairs.obj", "bar.obj", Union, 170.22076135365535, 274.86173323044596, 1, -2),
    ("stairs.obj", "bar.obj", Intersection, 0.3715859607578537, 7.861813779715364, 3, 6),
    ("stairs.obj", "bar.obj", Difference, 169.57644899403815, 276.82662196610954, 1, -4),
    ("Havocglass8_left.obj", "Havocglass8_right.obj", Union, 3059894.5711100884, 1039038.7958188099, 1, 2),
    (
        "Havocglass8_left.obj",
        "Havocglass8_right.obj",
        Intersection,
        68524.43509081239,
        36507.67763451068,
        1,
        2,
    ),
    (
        "Havocglass8_left.obj",
        "Havocglass8_right.obj",
        Difference,
        2710897.8084396496,
        929452.5793465513,
        5,
        8,
    ),
    ("Offset3.obj", "Offset4.obj", Union, 24655.83234039845, 6218.534884611436, 1, 2),
    ("Offset3.obj", "Offset4.obj", Intersection, 1388.2232646680256, 1153.0546023896738, 1, 2),
    ("Offset3.obj", "Offset4.obj", Difference, 9415.249424127096, 3378.435015294921, 1, 2),
];

#[test]
fn models_by_others() {
    let _bits = same_bits::group("models by others");
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let folder = root.ancestors().find(|folder| folder.join("fixtures/solids").is_dir()).expect("fixtures");
    let load = |name: &str| {
        let mesh = Mesh::load(folder.join("fixtures/solids").join(name)).expect("a fixture");
        Solid::try_from(mesh).expect("a solid")
    };
    let mut trial = Trial::default();
    for (a, b, operation, volume, area, components, euler) in RESULTS {
        let solids = [load(a), load(b)];
        let expected = Expected {
            volume: Some(volume),
            area: Some(area),
            components: Some(components),
            euler: Some(euler),
            tolerance: 1e-10,
            ..Expected::default()
        };
        let context = format!("{a} {b}");
        let Some(result) = trial.run(&context, operation, [&solids[0], &solids[1]], &expected) else {
            continue;
        };
        let verdict = oracle::judge(operation, &[solids[0].mesh(), solids[1].mesh()], result.mesh(), 200, 9);
        if let Some(mistake) = verdict.mistakes.first() {
            trial.note(format!("{context} {operation:?}: {mistake:?}"));
        }
    }
    trial.finish(RESULTS.len());
}
