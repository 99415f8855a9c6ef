//! Signed distance of a mesh.

use std::sync::OnceLock;
use std::sync::atomic::{AtomicU64, Ordering};

use glam::DVec3;

use super::pseudonormal::PseudoNormals;
use super::{inside, work};
use crate::parallel::get_or_compute;
use crate::spatial::{Closest, FastWinding, Feature, Side, TriangleTree, coherent_order};
use crate::{Control, Error, Mesh, Solid};

/// How inside and outside are decided.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum SignRule {
    /// The default: whichever of the following is right for the surface, found out once for each mesh. Pseudonormals on
    /// closed surfaces that do not cross themselves (and whose shells face as they should), the winding number on other
    /// closed ones, the fast winding number on open ones. [`SignedDistance::decided_by`] tells.
    #[default]
    Automatic,
    /// The side of the angle-weighted pseudonormal at the nearest point (Baerentzen, Aanaes 2005). The fastest; right
    /// for closed surfaces that do not cross or touch themselves. Where the normal is too near the horizon to decide
    /// (on the surface, at features without a reliable normal), the ray decides.
    PseudoNormal,
    /// The parity test of Choporov 2017: the section by the plane z = z_q, then crossings of a ray in +x, both
    /// half-open; exact. Where shells overlap an even number of times, the point counts as outside.
    Parity,
    /// The winding number along the same ray, exact: inside where positive. Overlapping shells are all inside,
    /// inward shells are cavities.
    Winding,
    /// The fast generalised winding number (Barill et al. 2018), inside above one half: for open or dirty surfaces.
    FastWinding,
}

/// A point's signed distance, with what it was measured to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SignedDistanceAt {
    /// Distance to the surface: positive inside, negative outside, 0 on it.
    pub distance: f64,
    /// Unit gradient of the distance: the direction in which it grows, hence inward on the surface. The zero vector
    /// where the nearest point has no normal.
    pub gradient: [f64; 3],
    /// The nearest point and the feature it lies on.
    pub closest: Closest,
}

/// Signed distance of a mesh: exact nearest points (Ericson 2005) with a sign by one of several rules.
///
/// **Positive inside**, the convention of Choporov 2017 (3) and of R-functions. An empty mesh is infinitely far
/// (negative infinity); a query that is not finite gives NaN.
///
/// ```
/// use trisect::field::SignedDistance;
/// # use trisect::{Mesh, Solid};
/// # let tetrahedron = Mesh::new(
/// #     vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
/// #     vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]],
/// # );
/// let solid = Solid::try_from(tetrahedron)?;
/// let distance = SignedDistance::new(&solid);
/// assert_eq!(distance.at([0.25, 0.25, -2.0]), -2.0);
/// assert_eq!(distance.at([0.3, 0.3, 0.125]), 0.125);
/// assert_eq!(distance.at([0.3, 0.3, 0.0]), 0.0);
/// # Ok::<(), trisect::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct SignedDistance {
    tree: TriangleTree,
    normals: PseudoNormals,
    winding: OnceLock<FastWinding>,
    rule: SignRule,
    /// What `SignRule::Automatic` means here.
    automatic: OnceLock<SignRule>,
    size: f64,
    /// Tells meshes apart.
    number: u64,
}

/// Roundings of the largest coordinate within which a point is on the surface, as far as directions are concerned: nearest points are
/// off by a few, and farther away their direction is by less than a twentieth.
const ON_SURFACE: f64 = 64.0;

/// How many meshes there have been.
static COUNT: AtomicU64 = AtomicU64::new(0);

/// Queries answered one after the other from each other's nearest triangle.
const RUN: usize = 512;

impl SignedDistance {
    /// Signed distance of a solid, its inside told by [`SignRule::Automatic`]. O(n log n), a search for crossings among it
    /// ([`Solid::self_crossings`], done once for each solid); about 250 bytes a triangle.
    #[must_use]
    pub fn new(solid: &Solid) -> Self {
        let distance = Self::undecided(solid.mesh(), SignRule::Automatic);
        let rule = inside::of_solid(solid, &distance.normals, &Control::new());
        Self { automatic: OnceLock::from(rule), ..distance }
    }

    /// Distance of any mesh with the given rule. For a mesh that is not closed only [`SignRule::FastWinding`], which
    /// [`SignRule::Automatic`] then is, gives a sign that means anything.
    ///
    /// ```
    /// use trisect::field::{SignRule, SignedDistance};
    /// use trisect::{Mesh, primitives};
    ///
    /// let boxes = [primitives::cuboid([0.0; 3], [1.0; 3])?, primitives::cuboid([0.5; 3], [1.5; 3])?];
    /// let overlapping = Mesh::merged(&boxes)?;
    /// let distance = SignedDistance::of_mesh(&overlapping, SignRule::Automatic);
    /// assert_eq!(distance.decided_by(), SignRule::Winding);
    /// assert_eq!(distance.at([0.75, 0.75, 1.25]), 0.25);
    /// # Ok::<(), trisect::Error>(())
    /// ```
    #[must_use]
    pub fn of_mesh(mesh: &Mesh, rule: SignRule) -> Self {
        Self::of_mesh_within(mesh, rule, &Control::new())
    }

    /// As [`of_mesh`](Self::of_mesh); the search for crossings that [`SignRule::Automatic`] makes stops at the limits of
    /// `control`, and the winding number, which is right for every closed mesh but slower, then decides.
    #[must_use]
    pub fn of_mesh_within(mesh: &Mesh, rule: SignRule, control: &Control) -> Self {
        let distance = Self::undecided(mesh, rule);
        if rule == SignRule::Automatic {
            let decided = inside::automatic(mesh, &distance.normals, control);
            return Self { automatic: OnceLock::from(decided), ..distance };
        }
        distance
    }

    /// The distance, before it is known what the automatic rule is.
    fn undecided(mesh: &Mesh, rule: SignRule) -> Self {
        let tree = TriangleTree::new(mesh);
        let normals = PseudoNormals::new(mesh);
        let size = tree.bounds().map_or(0.0, |[low, high]| {
            DVec3::from_array(low).abs().max(DVec3::from_array(high).abs()).max_element()
        });
        let number = COUNT.fetch_add(1, Ordering::Relaxed);
        Self { tree, normals, winding: OnceLock::new(), rule, automatic: OnceLock::new(), size, number }
    }

    /// The same surface with another sign rule.
    #[must_use]
    pub fn with_rule(mut self, rule: SignRule) -> Self {
        self.rule = rule;
        self
    }

    /// The rule that tells inside from outside: the one asked for, or if that is [`SignRule::Automatic`], what it is for
    /// this surface.
    #[must_use]
    pub fn decided_by(&self) -> SignRule {
        match self.rule {
            SignRule::Automatic => {
                let decide = || inside::automatic(&self.surface(), &self.normals, &Control::new());
                *get_or_compute(&self.automatic, decide)
            }
            rule => rule,
        }
    }

    /// The triangles as a mesh of their own corners.
    fn surface(&self) -> Mesh {
        let corners = (0..self.normals.len() as u32).filter_map(|triangle| self.tree.corners(triangle));
        let positions: Vec<[f64; 3]> = corners.flatten().map(|corner| corner.to_array()).collect();
        let triangles = (0..positions.len() as u32 / 3).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        Mesh::new(positions, triangles)
    }

    /// The hierarchy, for other queries.
    #[must_use]
    pub fn tree(&self) -> &TriangleTree {
        &self.tree
    }

    /// The signed distance at `query`.
    #[must_use]
    pub fn at(&self, query: [f64; 3]) -> f64 {
        self.tree.closest(query).map_or_else(|| self.without(query), |closest| self.sign(query, &closest))
    }

    /// The signed distance at `query`, its gradient, and the nearest point; nothing for an empty mesh or a query that
    /// is not finite.
    #[must_use]
    pub fn measure(&self, query: [f64; 3]) -> Option<SignedDistanceAt> {
        self.measure_from(query, None)
    }

    pub(crate) fn measure_from(&self, query: [f64; 3], guess: Option<u32>) -> Option<SignedDistanceAt> {
        Some(self.measured(query, self.tree.closest_from(query, guess)?))
    }

    /// A number that no other mesh of this process has; clones, which have the same surface, share it.
    pub(crate) fn number(&self) -> u64 {
        self.number
    }

    /// The distance and its gradient, from the nearest point.
    pub(crate) fn measured(&self, query: [f64; 3], closest: Closest) -> SignedDistanceAt {
        let distance = self.sign(query, &closest);
        let gradient = self.gradient_from(query, &closest, distance);
        SignedDistanceAt { distance, gradient: gradient.to_array(), closest }
    }

    /// The gradient: away from the nearest point, or towards it. As near to the surface as coordinates are rounded that difference points
    /// anywhere, and nearer to a face than to its edges it is along its normal in any case.
    fn gradient_from(&self, query: [f64; 3], closest: &Closest, distance: f64) -> DVec3 {
        let query = DVec3::from_array(query);
        let away = query - DVec3::from_array(closest.point);
        let direct = away.normalize_or_zero() * distance.signum();
        let known = || self.normals.of(closest.triangle, closest.feature).normalize_or_zero();
        if distance.abs() <= ON_SURFACE * f64::EPSILON * query.abs().max_element() {
            let inward = -known();
            return if inward == DVec3::ZERO && distance != 0.0 { direct } else { inward };
        }
        match closest.feature {
            Feature::Face => match known() {
                DVec3::ZERO => direct,
                normal if normal.dot(direct) < 0.0 => -normal,
                normal => normal,
            },
            Feature::Edge(_) | Feature::Vertex(_) => direct,
        }
    }

    /// Where `query` is, by the sign rule.
    #[must_use]
    pub fn side(&self, query: [f64; 3]) -> Side {
        self.tree
            .closest(query)
            .map_or(Side::Outside, |closest| self.side_from(query, &closest, closest.squared_distance.sqrt()))
    }

    /// Signed distances at many points, on several threads. Neighbouring points share work; the results are those of
    /// [`at`](Self::at), to the bit.
    ///
    /// # Errors
    /// Only the limits of `control`.
    pub fn at_all(&self, queries: &[[f64; 3]], control: &Control) -> Result<Vec<f64>, Error> {
        self.batch(queries, control, |query, closest| match closest {
            Some(closest) => self.sign(query, closest),
            None => self.without(query),
        })
    }

    /// [`measure`](Self::measure) at many points, on several threads.
    ///
    /// # Errors
    /// Only the limits of `control`.
    pub fn measure_all(
        &self,
        queries: &[[f64; 3]],
        control: &Control,
    ) -> Result<Vec<Option<SignedDistanceAt>>, Error> {
        self.batch(queries, control, |query, closest| {
            closest.and_then(|closest| self.measure_from(query, Some(closest.triangle)))
        })
    }

    fn batch<T: Clone + Send>(
        &self,
        queries: &[[f64; 3]],
        control: &Control,
        finish: impl Fn([f64; 3], Option<&Closest>) -> T + Sync,
    ) -> Result<Vec<T>, Error> {
        let order = coherent_order(queries);
        if self.decided_by() == SignRule::FastWinding {
            self.fast_winding();
        }
        let runs = work::pieces(order.len(), RUN, control, "distance", |range| {
            let mut guess = None;
            Ok(order[range]
                .iter()
                .map(|&index| {
                    let query = queries[index as usize];
                    let closest = self.tree.closest_from(query, guess);
                    guess = closest.map(|closest| closest.triangle);
                    finish(query, closest.as_ref())
                })
                .collect::<Vec<T>>())
        })?;
        let mut results: Vec<Option<T>> = vec![None; queries.len()];
        for (&index, result) in order.iter().zip(runs.into_iter().flatten()) {
            results[index as usize] = Some(result);
        }
        // Every index occurs in the order exactly once.
        Ok(results.into_iter().flatten().collect())
    }

    /// The value where there is no nearest point.
    fn without(&self, query: [f64; 3]) -> f64 {
        if query.iter().all(|x| x.is_finite()) { f64::NEG_INFINITY } else { f64::NAN }
    }

    pub(crate) fn sign(&self, query: [f64; 3], closest: &Closest) -> f64 {
        let distance = closest.squared_distance.sqrt();
        match self.side_from(query, closest, distance) {
            Side::Inside => distance,
            Side::On => 0.0,
            Side::Outside => -distance,
        }
    }

    fn side_from(&self, query: [f64; 3], closest: &Closest, distance: f64) -> Side {
        match self.decided_by() {
            SignRule::PseudoNormal => self.by_pseudonormal(query, closest, distance),
            SignRule::Automatic | SignRule::Winding => self.by_ray(query, distance, |_, winding| winding > 0),
            SignRule::Parity => self.by_ray(query, distance, |count, _| count % 2 == 1),
            SignRule::FastWinding => {
                if distance == 0.0 {
                    Side::On
                } else if self.fast_winding().at(&self.tree, query) > 0.5 {
                    Side::Inside
                } else {
                    Side::Outside
                }
            }
        }
    }

    fn by_pseudonormal(&self, query: [f64; 3], closest: &Closest, distance: f64) -> Side {
        let away = DVec3::from_array(query) - DVec3::from_array(closest.point);
        let normal = self.normals.of(closest.triangle, closest.feature);
        let cosine = away.dot(normal);
        // The nearest point is rounded to a few units in the last place of the coordinates, which turns `away` by
        // about this angle.
        let reach = self.size.max(DVec3::from_array(query).abs().max_element());
        let doubt = (1e-9 * distance + 32.0 * f64::EPSILON * reach) * normal.length();
        if cosine > doubt {
            Side::Outside
        } else if cosine < -doubt {
            Side::Inside
        } else {
            self.by_ray(query, distance, |_, winding| winding > 0)
        }
    }

    fn by_ray(&self, query: [f64; 3], distance: f64, inside: impl Fn(u32, i32) -> bool) -> Side {
        let reach = self.size.max(DVec3::from_array(query).abs().max_element());
        if distance <= 64.0 * f64::EPSILON * reach && self.tree.touches(query) {
            return Side::On;
        }
        let crossings = self.tree.crossings(query);
        if crossings.on_surface {
            Side::On
        } else if inside(crossings.count, crossings.winding) {
            Side::Inside
        } else {
            Side::Outside
        }
    }

    fn fast_winding(&self) -> &FastWinding {
        self.winding.get_or_init(|| FastWinding::new(&self.tree))
    }

    /// Whether the distance grows inwards of the nearest face everywhere: not beside a hole, nor at walls inside bodies that
    /// overlap. Where the caller chose the winding number, overlaps are not looked for.
    pub(crate) fn follows_normals(&self) -> bool {
        let found_to_overlap = self.rule == SignRule::Automatic && self.normals.is_regular();
        match self.decided_by() {
            SignRule::PseudoNormal => true,
            _ => self.normals.is_closed() && !found_to_overlap,
        }
    }

    /// Bytes held.
    #[must_use]
    pub fn memory(&self) -> usize {
        self.tree.memory() + self.normals.memory()
    }

    /// Outward unit normal of a feature; zero where there is none.
    #[must_use]
    pub fn normal(&self, triangle: u32, feature: Feature) -> [f64; 3] {
        if self.tree.corners(triangle).is_none() {
            return [0.0; 3];
        }
        self.normals.of(triangle, feature).normalize_or_zero().to_array()
    }
}
