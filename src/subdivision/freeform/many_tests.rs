//! Many cages at once, and cages that cross themselves.

use glam::DVec3;

use super::tests::{ball, check, diagonal, moved, sampled, seeded, tube};
use super::*;
use crate::subdivision::tags::{Corner, Tags};

fn at(cage: &ControlMesh, place: [f64; 3]) -> ControlMesh {
    moved(cage, |p| p + DVec3::from(place))
}

/// Three balls have two points in common, where three creases meet; folded, the second step would see the first one's result alone.
#[test]
fn three_balls_meet_in_two_corners() {
    let balls = [ball(2), at(&ball(2), [0.9, 0.1, 0.2]), at(&ball(1), [0.4, 0.8, 0.1])];
    let cages = balls.each_ref();
    for (operation, chains, genus) in
        [(Operation::Union, 3, 0), (Operation::Intersection, 3, 0), (Operation::Difference, 3, 0)]
    {
        let outcome = FreeForm::new().attempts(0).run_all(operation, &cages).expect("a cage");
        check(&outcome, &cages, operation.name());
        let report = outcome.report();
        assert_eq!((report.chains, report.junctions), (chains, 2), "{operation}");
        assert_eq!(outcome.exact().solid().euler_characteristic(), 2 - 2 * genus);
        let d = diagonal(&outcome);
        assert!(
            report.errors.largest() < 6e-3 * d,
            "{operation}: {:e} of {report:?}",
            report.errors.largest() / d
        );
        let found = sampled(&outcome, &mut seeded(7));
        assert!(found <= report.errors.largest() + report.errors.allowance, "{operation}: {found}");
        let corners: &[Corner] = &outcome.surface().tags().corners;
        assert!(corners.len() <= 2, "{corners:?}");
    }
}

/// What is taken from a ball at once is as near as what is taken step by step, and keeps as many points.
#[test]
fn tools_at_once_are_no_worse_than_one_by_one() {
    let body = ball(2);
    let tools = [[1.0, 0.0, 0.1], [-0.9, 0.3, 0.0], [0.1, 1.05, 0.0], [0.0, -0.2, 0.95]]
        .map(|place| moved(&ball(1), |p| 0.4 * p + DVec3::from(place)));
    let mut cages = vec![&body];
    cages.extend(&tools);
    let settings = FreeForm::new().attempts(0);
    let outcome = settings.run_all(Operation::Difference, &cages).expect("a cage");
    check(&outcome, &cages, "at once");
    assert_eq!((outcome.report().chains, outcome.report().junctions), (4, 0));
    let mut step = body.clone();
    let mut apart = 0.0;
    for tool in &tools {
        let done = settings.run(Operation::Difference, &step, tool).expect("a cage");
        apart += done.report().errors.largest();
        step = done.into_surface();
    }
    assert!(outcome.report().errors.largest() <= apart);
    // Later steps see finer faces where earlier ones cut, so that numbers differ, but little.
    let [at_once, one_by_one] = [outcome.surface(), &step].map(|cage| cage.faces().len() as f64);
    assert!((0.9..1.1).contains(&(at_once / one_by_one)), "{at_once} {one_by_one}");
}

/// A tube along a figure of eight goes through itself.
#[test]
fn a_cage_that_crosses_itself_becomes_one_that_does_not() {
    let eight = tube(40, 10, 0.16, |t| DVec3::new(t.sin(), t.sin() * t.cos(), 0.05 * t.cos()));
    let outcome = FreeForm::new().attempts(1).run_all(Operation::Union, &[&eight]).expect("a cage");
    check(&outcome, &[&eight], "eight");
    let report = outcome.report();
    assert_eq!(outcome.exact().solid().euler_characteristic(), -2);
    assert!(report.chains > 0 && report.unchanged > 100, "{report:?}");
    let d = diagonal(&outcome);
    assert!(report.errors.largest() < 5e-3 * d, "{:e} of {report:?}", report.errors.largest() / d);
    // And with another: the crossing is resolved in the same step.
    let both = FreeForm::new().attempts(0).run(Operation::Difference, &eight, &at(&ball(1), [1.5, 0.0, 0.0]));
    let both = both.expect("a cage");
    check(&both, &[&eight, &at(&ball(1), [1.5, 0.0, 0.0])], "eight less ball");
    assert!(both.report().chains > report.chains);
}

/// Nothing to resolve: the cage, bit for bit.
#[test]
fn one_cage_alone_stays_as_it_is() {
    let ball = ball(2);
    let outcome = FreeForm::new().run_all(Operation::Union, &[&ball]).expect("a cage");
    assert_eq!(outcome.surface().positions(), ball.positions());
    assert_eq!(outcome.surface().faces(), ball.faces());
    assert_eq!(outcome.surface().tags(), &Tags::default());
    let none = FreeForm::new().run_all(Operation::Union, &[]);
    assert!(none.is_err());
}
