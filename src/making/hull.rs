//! Convex hulls, every decision exact.
//!
//! Quickhull (Barber, Dobkin and Huhdanpaa 1996): a point beyond a facet takes the place of all facets that it is beyond; points
//! left over are kept with one facet each that they are beyond. Which side of a facet a point is on is an exact sign, and *beyond*
//! means strictly: a point in a facet's plane does not see it. So the facets that a point sees are always a disc with a simple
//! rim, no new facet is without area, and the surface is closed and nowhere concave, whatever the input. What the crates at hand
//! do with points in one plane is told in `docs/making.md`.

use rustc_hash::FxHashMap;

use crate::exact::{Sign, collinear, orient3d};
use crate::spatial::{Closest, TriangleTree};
use crate::{Error, Mesh, Solid};

/// Marks a facet that is no more.
const GONE: u32 = u32::MAX;

/// The convex hull of points: a closed mesh with a vertex for every extreme point, in the order of the input, and no others.
/// Points inside, on faces and on edges are left out; of equal points one counts. Exact for every finite `f64`; faces with more
/// than three corners are triangulated. Groups and attributes there are none. O(n log n) for points as they come.
///
/// ```
/// use trisect::{Solid, making, primitives};
///
/// // The corners of a cube, and all that is between them.
/// let points: Vec<[f64; 3]> = (0..27).map(|k| [k % 3, k / 3 % 3, k / 9].map(f64::from)).collect();
/// let hull = Solid::try_from(making::convex_hull(&points)?)?;
/// assert_eq!((hull.mesh().positions.len(), hull.volume()), (8, 8.0));
/// # Ok::<(), trisect::Error>(())
/// ```
///
/// # Errors
/// [`Error::InvalidArgument`] if a coordinate is not finite, or if all points lie in one plane and so enclose nothing.
pub fn convex_hull(points: &[[f64; 3]]) -> Result<Mesh, Error> {
    let invalid = |what: String| Err(Error::InvalidArgument(what));
    if let Some(point) = points.iter().position(|point| point.iter().any(|x| !x.is_finite())) {
        return invalid(format!("convex hull: point {point} is not finite: {:?}", points[point]));
    }
    if u32::try_from(points.len()).is_err() {
        return Err(Error::TooLarge { what: format!("{} points of a convex hull", points.len()) });
    }
    let Some(start) = tetrahedron(points) else {
        return invalid(format!(
            "convex hull: all {} points lie in one plane, and so enclose no volume",
            points.len()
        ));
    };
    let facets = Hull::new(points, start).completed();
    // Vertices in the middle of edges and faces came before what made them so. Of extreme points alone none is.
    let extreme = extreme_vertices(points, &facets);
    let chosen: Vec<[f64; 3]> = extreme.iter().map(|&vertex| points[vertex as usize]).collect();
    let used = facets.iter().flatten().copied().collect::<std::collections::BTreeSet<u32>>().len();
    let mut triangles = facets;
    if used == chosen.len() {
        let place = |vertex: u32| extreme.partition_point(|&other| other < vertex) as u32;
        triangles.iter_mut().for_each(|triangle| *triangle = triangle.map(place));
    } else if let Some(start) = tetrahedron(&chosen) {
        triangles = Hull::new(&chosen, start).completed();
    }
    for triangle in &mut triangles {
        let first = (0..3).min_by_key(|&k| triangle[k]).unwrap_or_default();
        triangle.rotate_left(first);
    }
    triangles.sort_unstable();
    Ok(Mesh::new(chosen, triangles))
}

/// Here and not with [`Solid`], which lies below, because users look for it at the solid.
impl Solid {
    /// Whether the solid is convex, to rounding: one manifold surface without handles, all of whose vertices lie on its convex
    /// hull, within 32 units in the last place of its largest coordinate, and which encloses the same volume. (Flat faces that
    /// are triangulated after rounding are nowhere flat to the last bit.) O(n log n).
    #[must_use]
    pub fn is_convex(&self) -> bool {
        hull_of_convex(self).is_some()
    }
}

/// The convex hull of a solid that is convex, as [`Solid::is_convex`] says; `None` if it is not.
pub(super) fn hull_of_convex(solid: &Solid) -> Option<Mesh> {
    // What rounding of coordinates by half a unit comes to where planes of small faces are far from their corners.
    const ROUNDING: f64 = 32.0 * f64::EPSILON;
    // Volumes are right to this; a dent between vertices that lie on the hull is far larger.
    const SAME: f64 = 1e-9;
    if solid.components() != 1 || solid.genus() != Some(0) || !solid.is_manifold() {
        return None;
    }
    let positions = &solid.mesh().positions;
    let hull = convex_hull(positions).ok()?;
    let volume = hull.volume();
    let is_same = (solid.volume() - volume).abs() <= SAME * volume;
    if !is_same {
        return None;
    }
    let largest = positions.iter().flatten().fold(0.0, |largest: f64, x| largest.max(x.abs()));
    let tree = TriangleTree::new(&hull);
    let is_near = |closest: Closest| closest.squared_distance.sqrt() <= ROUNDING * largest;
    positions.iter().all(|&vertex| tree.closest(vertex).is_some_and(is_near)).then_some(hull)
}

/// Four points that are not in one plane, the last one inside the plane of the first three; `None` if there are none.
fn tetrahedron(points: &[[f64; 3]]) -> Option<[u32; 4]> {
    let indices = || 0..points.len();
    let squared = |a: usize, b: usize| (0..3).map(|k| (points[a][k] - points[b][k]).powi(2)).sum::<f64>();
    // 1. Far from each other, so that the first tetrahedron is a large one; decisions are exact all the same.
    let first =
        indices().min_by(|&a, &b| points[a].partial_cmp(&points[b]).unwrap_or(std::cmp::Ordering::Equal))?;
    let second =
        indices().max_by(|&a, &b| squared(a, first).total_cmp(&squared(b, first)).then(b.cmp(&a)))?;
    let second = if points[second] == points[first] {
        // (Where squares underflow or overflow, any other point will do.)
        indices().find(|&k| points[k] != points[first])?
    } else {
        second
    };
    let (a, b) = (&points[first], &points[second]);
    let from_line = |k: usize| {
        let [u, v] = [b, &points[k]].map(|p| [0, 1, 2].map(|axis| p[axis] - a[axis]));
        let across = [0, 1, 2].map(|i| {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            u[j] * v[k] - u[k] * v[j]
        });
        across.iter().map(|x| x * x).sum::<f64>()
    };
    let third = indices().max_by(|&j, &k| from_line(j).total_cmp(&from_line(k)).then(k.cmp(&j)))?;
    let third = if collinear(a, b, &points[third]) {
        indices().find(|&k| !collinear(a, b, &points[k]))?
    } else {
        third
    };
    let c = &points[third];
    // 2. The farthest from their plane, on either side.
    let from_plane = |k: usize| height([a, b, c], &points[k]).abs();
    let fourth = indices().max_by(|&j, &k| from_plane(j).total_cmp(&from_plane(k)).then(k.cmp(&j)))?;
    let side = |k: usize| orient3d(a, b, c, &points[k]);
    let fourth =
        if side(fourth) == Sign::Zero { indices().find(|&k| side(k) != Sign::Zero)? } else { fourth };
    let [first, second, third, fourth] = [first, second, third, fourth].map(|k| k as u32);
    Some(match side(fourth as usize) {
        Sign::Positive => [first, second, third, fourth],
        _ => [second, first, third, fourth],
    })
}

/// About six times the volume between a triangle and a point, negative outside of it: what the farthest point is told by, which
/// needs no more than that.
fn height([a, b, c]: [&[f64; 3]; 3], point: &[f64; 3]) -> f64 {
    let [u, v, w] = [b, c, point].map(|p| [0, 1, 2].map(|k| p[k] - a[k]));
    let n = [0, 1, 2].map(|i| {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        u[j] * v[k] - u[k] * v[j]
    });
    -(n[0] * w[0] + n[1] * w[1] + n[2] * w[2])
}

/// A facet of a hull that grows.
#[derive(Debug)]
struct Facet {
    /// Counter-clockwise seen from outside; the first one is [`GONE`] where it has been taken away.
    corners: [u32; 3],
    /// The facets over the edges from each corner to the next.
    over: [u32; 3],
    /// Points beyond it and perhaps beyond others, each with one facet.
    beyond: Vec<u32>,
    /// The last point it was asked for, and whether it is beyond.
    seen_by: (u32, bool),
}

/// A hull that grows point by point.
struct Hull<'a> {
    points: &'a [[f64; 3]],
    facets: Vec<Facet>,
    /// Facets that have points beyond them, and some that had.
    pending: Vec<u32>,
}

impl<'a> Hull<'a> {
    fn new(points: &'a [[f64; 3]], [a, b, c, d]: [u32; 4]) -> Self {
        let facet = |corners, over| Facet { corners, over, beyond: Vec::new(), seen_by: (GONE, false) };
        let facets = vec![
            facet([a, b, c], [1, 2, 3]),
            facet([b, a, d], [0, 3, 2]),
            facet([c, b, d], [0, 1, 3]),
            facet([a, c, d], [0, 2, 1]),
        ];
        let mut hull = Self { points, facets, pending: Vec::new() };
        let all: Vec<u32> = (0..points.len() as u32).filter(|point| ![a, b, c, d].contains(point)).collect();
        hull.hand_out(&all, 0..4);
        hull
    }

    /// Whether a point is strictly beyond a facet.
    fn is_beyond(&self, facet: u32, point: u32) -> bool {
        let [a, b, c] = self.facets[facet as usize].corners.map(|corner| &self.points[corner as usize]);
        orient3d(a, b, c, &self.points[point as usize]) == Sign::Negative
    }

    /// Gives each point to the first of some facets that it is beyond; those beyond none are inside.
    fn hand_out(&mut self, points: &[u32], facets: std::ops::Range<u32>) {
        for &point in points {
            if let Some(facet) = facets.clone().find(|&facet| self.is_beyond(facet, point)) {
                self.facets[facet as usize].beyond.push(point);
            }
        }
        self.pending.extend(facets.filter(|&facet| !self.facets[facet as usize].beyond.is_empty()));
    }

    /// The facets once no point is beyond any.
    fn completed(mut self) -> Vec<[u32; 3]> {
        while let Some(facet) = self.pending.pop() {
            let Facet { corners, beyond, .. } = &self.facets[facet as usize];
            if corners[0] == GONE {
                continue;
            }
            let plane = corners.map(|corner| &self.points[corner as usize]);
            let far = |point: &u32| -height(plane, &self.points[*point as usize]);
            let farthest = beyond.iter().max_by(|a, b| far(a).total_cmp(&far(b)).then(b.cmp(a)));
            if let Some(&point) = farthest {
                self.grow(facet, point);
            }
        }
        let left = self.facets.into_iter().map(|facet| facet.corners);
        left.filter(|corners| corners[0] != GONE).collect()
    }

    /// Takes a point in that is beyond a facet.
    fn grow(&mut self, facet: u32, point: u32) {
        // 1. All facets that the point sees, and the rim: edges as the seen facet has them, and the facet over each.
        let (mut seen, mut rim) = (vec![facet], Vec::new());
        self.facets[facet as usize].seen_by = (point, true);
        let mut next = 0;
        while let Some(&facet) = seen.get(next) {
            next += 1;
            let Facet { corners, over, .. } = self.facets[facet as usize];
            for k in 0..3 {
                let other = over[k];
                if self.facets[other as usize].seen_by.0 != point {
                    let beyond = self.is_beyond(other, point);
                    self.facets[other as usize].seen_by = (point, beyond);
                    if beyond {
                        seen.push(other);
                    }
                }
                if !self.facets[other as usize].seen_by.1 {
                    rim.push(([corners[k], corners[(k + 1) % 3]], other));
                }
            }
        }
        // 2. A new facet for each edge of the rim. It is a simple closed walk, so each corner begins one edge.
        let first = self.facets.len() as u32;
        let begins: FxHashMap<u32, u32> =
            rim.iter().zip(first..).map(|(&([a, _], _), new)| (a, new)).collect();
        let ends: FxHashMap<u32, u32> = rim.iter().zip(first..).map(|(&([_, b], _), new)| (b, new)).collect();
        for (&([a, b], other), new) in rim.iter().zip(first..) {
            let across = &mut self.facets[other as usize];
            if let Some(k) = (0..3).find(|&k| across.corners[k] == b && across.corners[(k + 1) % 3] == a) {
                across.over[k] = new;
            }
            let side = |found: Option<&u32>| found.copied().unwrap_or(new);
            let over = [other, side(begins.get(&b)), side(ends.get(&a))];
            self.facets.push(Facet {
                corners: [a, b, point],
                over,
                beyond: Vec::new(),
                seen_by: (GONE, false),
            });
        }
        // 3. What was beyond the seen facets is beyond a new one, or inside.
        let mut left = Vec::new();
        for facet in seen {
            let facet = &mut self.facets[facet as usize];
            left.extend(std::mem::take(&mut facet.beyond).into_iter().filter(|&other| other != point));
            facet.corners[0] = GONE;
        }
        let last = self.facets.len() as u32;
        self.hand_out(&left, first..last);
    }
}

/// The vertices of a hull at which at least three edges are bent, in order.
fn extreme_vertices(points: &[[f64; 3]], facets: &[[u32; 3]]) -> Vec<u32> {
    let at = |corner: u32| &points[corner as usize];
    let edges = |&[a, b, c]: &[u32; 3]| [([a, b], c), ([b, c], a), ([c, a], b)];
    let opposite: FxHashMap<[u32; 2], u32> = facets.iter().flat_map(edges).collect();
    let mut bent: FxHashMap<u32, u32> = FxHashMap::default();
    for facet in facets {
        for ([a, b], c) in edges(facet) {
            let over = opposite.get(&[b, a]).copied().unwrap_or(c);
            if orient3d(at(a), at(b), at(c), at(over)) != Sign::Zero {
                // Each edge is met from both its facets; here it counts at the end it begins with.
                *bent.entry(a).or_default() += 1;
            }
        }
    }
    let mut extreme: Vec<u32> =
        bent.into_iter().filter(|&(_, count)| count >= 3).map(|(vertex, _)| vertex).collect();
    extreme.sort_unstable();
    extreme
}

#[cfg(test)]
mod tests {
    use rand::rngs::ChaCha8Rng;
    use rand::{RngExt as _, SeedableRng as _};

    use super::*;
    use crate::primitives;

    /// Every point is inside by our own predicate, the surface is closed, and every vertex is a point that is needed.
    fn checked(points: &[[f64; 3]]) -> Solid {
        let mesh = convex_hull(points).expect("a hull");
        for triangle in &mesh.triangles {
            let [a, b, c] = triangle.map(|corner| &mesh.positions[corner as usize]);
            assert!(!collinear(a, b, c));
            assert!(points.iter().all(|point| orient3d(a, b, c, point) != Sign::Negative));
        }
        let solid = Solid::try_from(mesh.clone()).expect("closed");
        assert!(solid.is_manifold() && solid.components() == 1 && solid.genus() == Some(0));
        assert!(mesh.positions.iter().all(|vertex| points.contains(vertex)));
        // Without any one vertex the hull is smaller: the vertex is outside of it.
        if mesh.positions.len() < 30 && mesh.positions.len() > 4 {
            for left_out in 0..mesh.positions.len() {
                let mut others = mesh.positions.clone();
                let vertex = others.remove(left_out);
                let Ok(smaller) = convex_hull(&others) else { continue };
                let is_outside = smaller.triangles.iter().any(|triangle| {
                    let [a, b, c] = triangle.map(|corner| &smaller.positions[corner as usize]);
                    orient3d(a, b, c, &vertex) == Sign::Negative
                });
                assert!(is_outside, "{vertex:?} is not extreme");
            }
        }
        solid
    }

    #[test]
    fn hulls_of_degenerate_points_are_exact() {
        let mut random = ChaCha8Rng::seed_from_u64(7);
        for round in 0..300 {
            let (count, grid) = (random.random_range(4..60), random.random_range(1..6));
            let scale = [1.0, 0.1, 1e-300, 1e100][round % 4];
            let points: Vec<[f64; 3]> = (0..count)
                .map(|_| std::array::from_fn(|_| scale * f64::from(random.random_range(0..=grid))))
                .collect();
            match convex_hull(&points) {
                Ok(_) => drop(checked(&points)),
                Err(error) => assert!(error.to_string().contains("one plane"), "round {round}: {error}"),
            }
        }
    }

    #[test]
    fn hulls_of_spheres_cylinders_and_grids() {
        let ball = primitives::icosphere(3.0, 3).unwrap();
        assert_eq!(checked(&ball.positions).mesh().positions.len(), ball.positions.len());
        let can = primitives::cylinder(1.0, 5.0, 40).unwrap();
        let hull = checked(&can.positions);
        assert!((hull.volume() - can.volume()).abs() < 1e-12);
        assert_eq!(hull.mesh().triangles.len(), can.triangles.len());
        let ring = primitives::torus(3.0, 1.0, 24, 12).unwrap();
        assert!(checked(&ring.positions).volume() > ring.volume());
        let grid: Vec<[f64; 3]> = (0..1000).map(|k| [k % 10, k / 10 % 10, k / 100].map(f64::from)).collect();
        assert_eq!(checked(&grid).mesh().positions.len(), 8);
        // A rounded plane: nearly flat, and everything near it.
        let mut random = ChaCha8Rng::seed_from_u64(8);
        let nearly: Vec<[f64; 3]> = (0..200)
            .map(|_| {
                let [x, y]: [f64; 2] = std::array::from_fn(|_| random.random_range(-1.0..1.0));
                [x, y, 0.3 * x + 0.7 * y]
            })
            .collect();
        checked(&nearly);
    }

    #[test]
    fn flat_and_broken_points_have_no_hull() {
        for points in [&[][..], &[[0.0; 3]; 5], &[[0.0; 3], [1.0; 3], [2.0; 3], [3.0; 3]]] {
            assert!(convex_hull(points).unwrap_err().to_string().contains("one plane"));
        }
        let flat: Vec<[f64; 3]> = (0..9).map(|k| [f64::from(k % 3), f64::from(k / 3), 0.1]).collect();
        assert!(convex_hull(&flat).is_err());
        assert!(convex_hull(&[[0.0; 3], [f64::NAN; 3]]).unwrap_err().to_string().contains("not finite"));
    }

    #[test]
    fn convex_is_what_its_hull_is() {
        let solid = |mesh: Mesh| Solid::try_from(mesh).unwrap();
        assert!(solid(primitives::cuboid([0.0; 3], [1.0; 3]).unwrap()).is_convex());
        assert!(solid(primitives::cylinder(1.0, 2.0, 17).unwrap()).is_convex());
        // Its quadrangles are not flat to the last bit.
        assert!(solid(primitives::uv_sphere(0.7, 24, 12).unwrap().translated([3.0, 0.1, 0.2])).is_convex());
        let dented = {
            let mut mesh = primitives::icosphere(1.0, 3).unwrap();
            mesh.positions[100] = mesh.positions[100].map(|x| x * 0.9);
            mesh
        };
        assert!(!solid(dented).is_convex());
        assert!(!solid(primitives::torus(2.0, 0.5, 9, 9).unwrap()).is_convex());
        let (a, b) = (
            primitives::cuboid([0.0; 3], [1.0; 3]).unwrap(),
            primitives::cuboid([0.5; 3], [2.0; 3]).unwrap(),
        );
        assert!(!solid(a.clone()).union(&solid(b)).unwrap().solid().is_convex());
        let apart = Mesh::merged([&a, &a.clone().translated([9.0; 3])]).unwrap();
        assert!(!solid(apart).is_convex());
    }
}
