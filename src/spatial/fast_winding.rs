//! Fast winding numbers (Barill, Dickson, Schmidt, Levin, Jacobson 2018): the generalised winding number of a
//! surface, clusters of far triangles replaced by their dipole expansion to second order.

use glam::{DMat3, DVec3};

use super::wide::Child;
use super::{LANES, TriangleTree};

/// A cluster is expanded where the query is farther than this many of its radii.
const ACCURACY: f64 = 2.0;

/// The moments of every cluster of a [`TriangleTree`], for fast winding numbers of open or dirty surfaces.
#[derive(Clone, Debug)]
pub struct FastWinding {
    clusters: Vec<Cluster>,
}

/// Moments of the triangles below a node: sums over their area vectors `a` and centroids' offsets `d` from `centre`.
#[derive(Clone, Copy, Debug, Default)]
struct Cluster {
    centre: DVec3,
    radius: f64,
    /// Sum of a.
    area: DVec3,
    /// Sum of d a^T (rows: offset, columns: area).
    first: DMat3,
    /// Half the sum of (d d^T) a_k, one symmetric matrix for each component k of a.
    second: [DMat3; 3],
    weight: f64,
}

impl FastWinding {
    /// Moments for all clusters of `tree`; O(n log n). About 400 bytes for every three triangles.
    #[must_use]
    pub fn new(tree: &TriangleTree) -> Self {
        // Every node's leaves are a contiguous range: children come after their parent in a depth-first layout.
        let nodes = &tree.tree.nodes;
        let mut clusters = vec![Cluster::default(); nodes.len()];
        for index in (0..nodes.len()).rev() {
            let mut sums = (DVec3::ZERO, 0.0);
            for lane in 0..LANES {
                let (centre, weight) = match nodes[index].child(lane) {
                    Child::Node(child) => (clusters[child as usize].centre, clusters[child as usize].weight),
                    Child::Leaf(leaf) => {
                        let [a, b, c] = tree.leaves[leaf as usize].corners;
                        ((a + b + c) / 3.0, (b - a).cross(c - a).length() * 0.5)
                    }
                    Child::None => continue,
                };
                sums = (sums.0 + centre * weight, sums.1 + weight);
            }
            let fallback = (tree.low + tree.high) * 0.5;
            let centre = if sums.1 > 0.0 { sums.0 / sums.1 } else { fallback };
            let mut cluster = Cluster { centre, weight: sums.1, ..Cluster::default() };
            for lane in 0..LANES {
                match nodes[index].child(lane) {
                    Child::Node(child) => cluster.add_cluster(&clusters[child as usize]),
                    Child::Leaf(leaf) => cluster.add_triangle(tree.leaves[leaf as usize].corners),
                    Child::None => {}
                }
            }
            clusters[index] = cluster;
        }
        Self { clusters }
    }

    /// The winding number of the surface around `query`: 1 inside and 0 outside a closed one, in between and smooth
    /// for an open one. Clusters are expanded beyond twice their radius, which keeps errors near 0.01.
    #[must_use]
    pub fn at(&self, tree: &TriangleTree, query: [f64; 3]) -> f64 {
        let query = DVec3::from_array(query);
        if tree.is_empty() || !query.is_finite() {
            return 0.0;
        }
        let mut solid_angle = 0.0;
        let mut stack: smallvec::SmallVec<[u32; 96]> = smallvec::smallvec![0];
        while let Some(index) = stack.pop() {
            let cluster = &self.clusters[index as usize];
            let reach = ACCURACY * cluster.radius;
            if cluster.centre.distance_squared(query) > reach * reach {
                solid_angle += cluster.solid_angle(query);
                continue;
            }
            let node = &tree.tree.nodes[index as usize];
            for lane in 0..LANES {
                match node.child(lane) {
                    Child::Node(child) => stack.push(child),
                    Child::Leaf(leaf) => {
                        solid_angle += triangle_solid_angle(tree.leaves[leaf as usize].corners, query);
                    }
                    Child::None => {}
                }
            }
        }
        solid_angle / (4.0 * std::f64::consts::PI)
    }
}

impl Cluster {
    fn add_triangle(&mut self, corners: [DVec3; 3]) {
        let [a, b, c] = corners;
        let area = (b - a).cross(c - a) * 0.5;
        let centroid = (a + b + c) / 3.0;
        // The second moment over the triangle's area: the centroid's and the corners' spread about it.
        let mut spread = outer(centroid - self.centre, centroid - self.centre);
        for corner in corners {
            spread += outer(corner - centroid, corner - centroid) * (1.0 / 12.0);
            self.radius = self.radius.max(corner.distance(self.centre));
        }
        self.add_moments(area, outer(centroid - self.centre, area), |k| spread * (0.5 * area[k]));
    }

    fn add_cluster(&mut self, child: &Self) {
        let shift = child.centre - self.centre;
        let first = child.first + outer(shift, child.area);
        self.radius = self.radius.max(shift.length() + child.radius);
        self.add_moments(child.area, first, |k| {
            let column = child.first.col(k);
            child.second[k]
                + (outer(shift, column) + outer(column, shift) + outer(shift, shift) * child.area[k]) * 0.5
        });
    }

    fn add_moments(&mut self, area: DVec3, first: DMat3, second: impl Fn(usize) -> DMat3) {
        self.area += area;
        self.first += first;
        for (k, sum) in self.second.iter_mut().enumerate() {
            *sum += second(k);
        }
    }

    /// The solid angle of the cluster from `query`, by the expansion of the dipole a . r / |r|^3 about the centre.
    fn solid_angle(&self, query: DVec3) -> f64 {
        let r = self.centre - query;
        let inverse = r.length_recip();
        let inverse2 = inverse * inverse;
        let inverse3 = inverse2 * inverse;
        let zeroth = self.area.dot(r) * inverse3;
        // d_i a_k (delta_ik - 3 r_i r_k / r^2) / r^3
        let trace = self.first.x_axis.x + self.first.y_axis.y + self.first.z_axis.z;
        let first = (trace - 3.0 * r.dot(self.first * r) * inverse2) * inverse3;
        // Third derivatives of the potential, contracted with the second moments.
        let mut contracted = 0.0;
        for k in 0..3 {
            let moment = &self.second[k];
            let trace = moment.x_axis.x + moment.y_axis.y + moment.z_axis.z;
            contracted += 15.0 * r[k] * r.dot(*moment * r) * inverse2 - 3.0 * r[k] * trace;
            contracted -= 6.0 * moment.col(k).dot(r);
        }
        zeroth + first + contracted * inverse2 * inverse3
    }
}

/// u v^T, stored so that column k is `u v_k`.
fn outer(u: DVec3, v: DVec3) -> DMat3 {
    DMat3::from_cols(u * v.x, u * v.y, u * v.z)
}

/// The signed solid angle of a triangle (Van Oosterom, Strackee 1983).
fn triangle_solid_angle(corners: [DVec3; 3], query: DVec3) -> f64 {
    let [a, b, c] = corners.map(|corner| corner - query);
    let (la, lb, lc) = (a.length(), b.length(), c.length());
    let determinant = a.dot(b.cross(c));
    let denominator = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
    if determinant == 0.0 && denominator <= 0.0 { 0.0 } else { 2.0 * determinant.atan2(denominator) }
}
