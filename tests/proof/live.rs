//! Cases of the live comparison (`benches/proof`) in the plain tests: a sample of operands of several bodies and of expressions, and
//! what the comparison once found.

use rand::SeedableRng;
use rand::rngs::ChaCha8Rng;
use trisect::{BooleanOptions, Control, Mesh, Solid};

use crate::judge::cases::Case;
use crate::judge::many::{MANY_FROM, Many};
use crate::judge::surface::Properties;
use crate::judge::{contacts, oracle, samples};

fn solid(mesh: &Mesh) -> Solid {
    Solid::try_from(mesh.clone()).expect("closed")
}

#[test]
fn operands_of_several_bodies_are_right_at_points() {
    let times = match std::env::var("TRISECT_PROOF").as_deref() {
        Ok("all") => 10,
        Ok(times) => times.parse::<u64>().expect("TRISECT_PROOF is a number or all").max(1),
        Err(_) => 1,
    };
    let mut judged = 0;
    for seed in MANY_FROM..MANY_FROM + 200 * times {
        let case = Many::new(seed);
        let merged = case.merged();
        let solids: Vec<Solid> = merged.iter().map(solid).collect();
        let outcome = BooleanOptions::new().evaluate(&case.expression, &solids).expect("no limits");
        let mesh = outcome.solid().mesh();
        let found = Properties::of(mesh);
        assert!(found.closed && found.manifold, "seed {seed}: {found:?}");
        let operands: Vec<&Mesh> = merged.iter().collect();
        let points = samples::points(&operands, mesh, 24, &mut ChaCha8Rng::seed_from_u64(seed));
        let verdict = oracle::judge_by(&|windings| case.expected(windings), &operands, mesh, &points);
        assert!(verdict.mistakes.is_empty(), "seed {seed}: {:?}", verdict.mistakes);
        judged += verdict.judged;
    }
    assert!(judged > 4_000, "{judged}");
}

#[test]
fn needles_do_not_make_results_cross_themselves() {
    // Said to cross themselves by 1e-11 to 3e-5 while depth was measured across planes of needles.
    let seeds = [
        4_294_968_070,
        4_294_971_342,
        4_294_971_425,
        4_294_973_240,
        4_294_973_828,
        4_294_973_917,
        4_294_976_536,
        4_294_977_673,
        4_294_984_403,
        4_294_985_093,
        4_294_988_236,
        4_294_990_391,
    ];
    for seed in seeds {
        let case = Case::new(seed, &[]);
        let solids = [&case.a, &case.b].map(solid);
        let outcome = BooleanOptions::new().run(case.operation, &solids).expect("no limits");
        let found = outcome.solid().self_crossings(&Control::new()).expect("no limits");
        assert!(found.is_clean(), "seed {seed}: {found}");
    }
}

#[test]
fn what_rounding_turns_far_from_the_origin_is_no_wall() {
    // At 1e12 a unit in the last place is 1e-4.
    for seed in [4_294_968_311, 4_294_968_809, 4_294_970_635] {
        let case = Case::new(seed, &[]);
        let result = |operands: [&Mesh; 2]| {
            let solids = operands.map(solid);
            let outcome = BooleanOptions::new().run(case.operation, &solids).expect("no limits");
            outcome.into_solid().into_mesh()
        };
        let far = result([&case.a, &case.b]);
        // The same operands at the origin, which takes no rounding.
        let from = case.a.positions[0];
        let near = |mesh: &Mesh| mesh.clone().translated(from.map(|x| -x));
        let (a, b) = (near(&case.a), near(&case.b));
        let back = |mesh: &Mesh| mesh.clone().translated(from);
        assert!(back(&a) == case.a && back(&b) == case.b, "seed {seed}");
        let at_origin = result([&a, &b]);
        // The same vertices, each rounded once.
        assert_eq!(far.positions.len(), at_origin.positions.len(), "seed {seed}");
        for (p, q) in far.positions.iter().zip(&at_origin.positions) {
            for k in 0..3 {
                let ulp = p[k].abs().next_up() - p[k].abs();
                assert!(((p[k] - from[k]) - q[k]).abs() <= 0.51 * ulp, "seed {seed}: {p:?} {q:?}");
            }
        }
        // Connected alike, with no wall without thickness.
        let topology = |mesh: &Mesh| contacts::parted(mesh, 1e-13).map(|parted| parted.topology);
        assert!(topology(&far).is_some(), "seed {seed}");
        assert_eq!(topology(&far), topology(&at_origin), "seed {seed}");
    }
}
