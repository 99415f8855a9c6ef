//! Faults of a smoothed surface, and the care that the next attempt takes around them.

use glam::{DVec3, I64Vec3};
use rustc_hash::FxHashMap;

/// Of the size of a triangle at fault: how far around it care is taken.
const NEARBY: f64 = 1.5;

/// How careful smoothing is with a vertex of the cells' surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Care {
    None,
    /// It is moved and left out only where triangles face quite another way than the surface.
    Calm,
    /// It and its triangles stay.
    Frozen,
}

/// A triangle that must not be: its middle, and how far its corners are from there.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fault {
    middle: DVec3,
    radius: f64,
}

impl Fault {
    pub(super) fn of(corners: [DVec3; 3]) -> Self {
        let middle = corners.iter().sum::<DVec3>() / 3.0;
        let radius = corners.iter().map(|corner| corner.distance(middle)).fold(0.0, f64::max);
        Self { middle, radius }
    }
}

/// Takes more care of the vertices that are within `times` the size of a fault.
pub(super) fn take_care(places: &[DVec3], faults: &[Fault], times: f64, care: &mut [Care]) {
    let reach = |fault: &Fault| NEARBY * times * fault.radius;
    let largest = faults.iter().map(reach).fold(0.0, f64::max);
    if !(largest > 0.0) {
        return;
    }
    // Boxes as large as the largest reach: what reaches a place is in its box or in one beside it.
    let box_of = |place: DVec3| (place / largest).floor().as_i64vec3();
    let mut boxes: FxHashMap<I64Vec3, Vec<&Fault>> = FxHashMap::default();
    for fault in faults {
        boxes.entry(box_of(fault.middle)).or_default().push(fault);
    }
    let beside: Vec<I64Vec3> =
        (0..27).map(|k: i64| I64Vec3::new(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1)).collect();
    for (&place, care) in places.iter().zip(care) {
        let own = box_of(place);
        let near = beside.iter().filter_map(|&step| boxes.get(&own.wrapping_add(step))).flatten();
        if near.into_iter().any(|fault| fault.middle.distance(place) <= reach(fault)) {
            *care = if *care == Care::None { Care::Calm } else { Care::Frozen };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn care_grows_around_faults_alone() {
        let places = [DVec3::ZERO, DVec3::X, DVec3::new(-3.1, 0.0, 0.0), DVec3::new(2.5, 2.5, 0.0)];
        let mut care = vec![Care::None; 4];
        let fault = |x: f64, radius: f64| Fault { middle: DVec3::new(x, 0.0, 0.0), radius };
        take_care(&places, &[fault(0.5, 0.5), fault(-3.0, 0.1)], 1.0, &mut care);
        assert_eq!(care, [Care::Calm, Care::Calm, Care::Calm, Care::None]);
        take_care(&places, &[fault(0.5, 0.4)], 1.0, &mut care);
        assert_eq!(care, [Care::Frozen, Care::Frozen, Care::Calm, Care::None]);
        take_care(&places, &[], 1.0, &mut care);
        assert_eq!(care[3], Care::None);
    }
}
