//! Vertices on top of each other taken away.
//!
//! A lattice that is cut next to its points has vertices there that are a thousandth of a cell apart, and triangles between them that face
//! anywhere. They are nothing to go by: a crease that is looked for from each of them has its vertices out of order.

use super::edit::{self, TURNED};
use super::mend::may_go;
use super::net::Net;

/// Collapses edges no longer than `length`, short ones first, where no triangle comes to face another way than it did.
pub(super) fn clear(net: &mut Net, length: f64) {
    let apart = |net: &Net, [a, b]: [u32; 2]| net.place(a).distance(net.place(b));
    let short = net.edges().map(|edge| (apart(net, edge).to_bits(), edge));
    let mut edges: Vec<(u64, [u32; 2])> = short.filter(|edge| f64::from_bits(edge.0) <= length).collect();
    edges.sort_unstable();
    for (_, [a, b]) in edges {
        // (Collapses before this one may have moved an end.)
        let Some([left, right]) = net.beside(a, b).filter(|_| apart(net, [a, b]) <= length) else { continue };
        for (from, to, beside) in [(a, b, [left, right]), (b, a, [right, left])] {
            if may_collapse(net, from, to, beside, length) {
                net.collapse(from, to, beside);
                break;
            }
        }
    }
}

fn may_collapse(net: &Net, from: u32, to: u32, beside: [u32; 2], length: f64) -> bool {
    may_go(net, from, to, length)
        && edit::stays_one(net, from, to, beside)
        && net.star(from).iter().all(|&triangle| {
            let corners = net.corners(triangle);
            let moved = corners.map(|corner| if corner == from { to } else { corner });
            match (net.shape_of(triangle), net.shape(moved, net.side(triangle))) {
                (Some(old), Some(new)) => beside.contains(&triangle) || new.angle <= old.angle.max(TURNED),
                _ => false,
            }
        })
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::super::mend::tests::plane;
    use super::*;

    #[test]
    fn vertices_on_top_of_each_other_become_one() {
        let mut net = plane();
        net.vertices[14].place = net.place(15) - DVec3::X * 1e-3;
        clear(&mut net, 1e-4);
        assert_eq!(net.present().count(), 50);
        clear(&mut net, 0.01);
        assert_eq!(net.present().count(), 48);
    }
}
