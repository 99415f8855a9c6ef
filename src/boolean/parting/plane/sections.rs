//! Sections at one plane or at many parallel ones, in one pass over the solid.

use super::cap::outline;
use super::nodes::Nodes;
use super::pieces::numbered;
use super::rings::{Rings, Twins, Walker};
use super::section::Section;
use super::split::{ABOVE, BELOW, ON, Split};
use crate::boolean::many::expressions::is_simple;
use crate::boolean::many::options::BooleanOptions;
use crate::exact::Plane;
use crate::mesh::Buckets;
use crate::parallel::Runner;
use crate::polygon;
use crate::{Error, Solid};

/// What a section is where faces of the solid lie in the plane.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum SectionSide {
    /// What has the solid on both sides: what a cut at the plane closes its halves with. Nothing where the solid begins or ends.
    #[default]
    Inside,
    /// What has the solid above it: the section a little above the plane. Where the solid begins at the plane that is its lower face.
    Above,
    /// What has the solid below it.
    Below,
}

/// Sections of solids.
///
/// ```
/// use trisect::exact::Plane;
/// use trisect::{SectionSide, Sections, Solid, primitives};
///
/// let cone = Solid::try_from(primitives::cone(2.0, 4.0, 24)?)?;
/// # let bounds = cone.bounds().unwrap();
/// let planes: Vec<Plane> = (0..4).map(|i| Plane::across(2, bounds.low[2] + f64::from(i))).collect::<Result<_, _>>()?;
/// let layers = Sections::new().side(SectionSide::Above).at(&cone, &planes)?;
/// assert!(layers.windows(2).all(|pair| pair[0].area() > pair[1].area()));
/// # Ok::<(), trisect::Error>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct Sections {
    side: SectionSide,
    options: BooleanOptions,
}

/// Here and not with [`Solid`], which lies below the booleans, because users look for it at the solid.
impl Solid {
    /// Where the plane meets the solid: polygons with holes. O(n).
    ///
    /// # Errors
    /// As [`Sections::at`].
    pub fn section(&self, plane: &Plane) -> Result<Section, Error> {
        let mut sections = Sections::new().at(self, std::slice::from_ref(plane))?;
        Ok(sections.swap_remove(0))
    }
}

/// A triangle meets planes one after another, if they are parallel and ascend.
const AT_ONCE: usize = 1 << 14;
/// Layers that one thread makes with the same scratch memory, one bit of which is cleared for each triangle of the solid.
const LAYERS_AT_ONCE: usize = 64;

impl Sections {
    /// Default settings.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// What counts where faces lie in the plane. Default: [`SectionSide::Inside`].
    #[must_use]
    pub fn side(mut self, side: SectionSide) -> Self {
        self.side = side;
        self
    }

    /// Settings: limits, threads, whether corners between faces of one plane are left out, what is inside where the solid crosses
    /// itself.
    #[must_use]
    pub fn options(mut self, options: BooleanOptions) -> Self {
        self.options = options;
        self
    }

    /// The section at each plane. A solid that crosses itself is resolved first where an outline shows it; it is looked through for that
    /// once. Planes across
    /// one axis are taken in one pass, whatever their order: O(n + k log k) for k crossings of edges with planes. Others are taken one
    /// by one, in O(n) each.
    ///
    /// # Errors
    /// [`Error::TooLarge`] if the points of a plane cannot be numbered with 32 bits; limits.
    pub fn at(&self, solid: &Solid, planes: &[Plane]) -> Result<Vec<Section>, Error> {
        self.options.work(|policy, runner| {
            let merge = policy.remove_vertices;
            if is_simple(policy, solid, runner.control)? {
                let found = self.take(solid, planes, merge, Trust::Outlines, runner)?;
                return Ok(found.into_iter().flatten().collect());
            }
            // What outlines show decides, as for a cut: where one crosses itself, or winds other than once around what is inside.
            let mut found = self.take(solid, planes, merge, Trust::SimpleOutlines, runner)?;
            let doubtful: Vec<Plane> = planes
                .iter()
                .zip(&found)
                .filter(|(_, found)| found.is_none())
                .map(|(plane, _)| *plane)
                .collect();
            if !doubtful.is_empty() {
                let resolved = self.options.resolve(solid)?;
                let mut again =
                    self.take(resolved.solid(), &doubtful, merge, Trust::Outlines, runner)?.into_iter();
                found
                    .iter_mut()
                    .filter(|found| found.is_none())
                    .for_each(|found| *found = again.next().flatten());
            }
            Ok(found.into_iter().flatten().collect())
        })
    }

    /// The sections of a solid as it is; `None` where an outline is not trusted.
    fn take(
        &self,
        solid: &Solid,
        planes: &[Plane],
        merge: bool,
        trust: Trust,
        runner: Runner<'_>,
    ) -> Result<Vec<Option<Section>>, Error> {
        if let Some((axis, order)) = levels(planes) {
            return self.sweep(solid, planes, axis, &order, (merge, trust), runner);
        }
        let mesh = solid.mesh();
        let numbers = mesh.positions.len() + mesh.triangles.len();
        let _numbers = runner.control.reserve((numbers * size_of::<u32>()) as u64)?;
        let all: Vec<u32> = (0..mesh.triangles.len() as u32).collect();
        let section = |plane: &Plane| {
            let ranks: Vec<u32> = mesh.positions.iter().map(|p| (1 + plane.side(p) as i8) as u32).collect();
            let split = Split::of_rank(mesh, plane, &ranks, 1, self.mark(), &all);
            one(&split, merge, trust, runner)
        };
        planes.iter().map(section).collect()
    }

    /// What a vertex on the plane counts as.
    fn mark(&self) -> u8 {
        match self.side {
            SectionSide::Inside => ON,
            // The plane is a little above it, or a little below.
            SectionSide::Above => BELOW,
            SectionSide::Below => ABOVE,
        }
    }

    /// Planes across one axis, which `order` puts into ascending order.
    fn sweep(
        &self,
        solid: &Solid,
        planes: &[Plane],
        axis: usize,
        order: &[usize],
        (merge, trust): (bool, Trust),
        runner: Runner<'_>,
    ) -> Result<Vec<Option<Section>>, Error> {
        let mesh = solid.mesh();
        let _ranks = runner.control.reserve((mesh.positions.len() * size_of::<u32>()) as u64)?;
        let levels: Vec<f64> = order.iter().filter_map(|&i| planes[i].as_level()).map(|(_, at)| at).collect();
        // 1. How many planes each vertex has passed.
        let mut ranks = vec![0u32; mesh.positions.len()];
        runner.fill(&mut ranks, AT_ONCE, |first, ranks| {
            let positions = &mesh.positions[first..first + ranks.len()];
            for (rank, position) in ranks.iter_mut().zip(positions) {
                let passed = levels.partition_point(|&at| at < position[axis]);
                *rank =
                    2 * passed as u32 + u32::from(levels.get(passed).is_some_and(|&at| at == position[axis]));
            }
        })?;
        // 2. The triangles that meet each plane: from the lowest corner's rank to the highest one's.
        let meetings = |range: std::ops::Range<usize>, found: &mut Vec<(u32, u32)>| {
            let first = range.start as u32;
            for (triangle, corners) in (first..).zip(&mesh.triangles[range]) {
                let [a, b, c] = corners.map(|v| ranks[v as usize]);
                let (low, high) = (a.min(b).min(c), a.max(b).max(c));
                // Plane j has rank 2 j + 1.
                found.extend((low / 2..high.div_ceil(2)).map(|plane| (plane, triangle)));
            }
        };
        let met = runner.gather(mesh.triangles.len(), AT_ONCE, 0, meetings)?;
        let _met = runner.control.reserve((met.len() * size_of::<(u32, u32)>()) as u64)?;
        let met = Buckets::new(order.len(), met.into_iter());
        // 3. Layers on all threads, so many at once that what a thread needs for one is of use for the others.
        let is_worth_it = trust == Trust::Outlines && met.total() >= mesh.triangles.len();
        let twins = if is_worth_it { Twins::of(mesh) } else { None };
        let found = runner.pieces(order.len(), LAYERS_AT_ONCE, |range| {
            let mut walker = twins.as_ref().map(|twins| Walker::new(mesh, twins));
            let layer = |place: usize| {
                let plane = &planes[order[place]];
                let rank = 2 * place as u32 + 1;
                let split = Split::of_rank(mesh, plane, &ranks, rank, self.mark(), met.get(place));
                if let Some(rings) = walker.as_mut().and_then(|walker| walker.rings(&split, merge)) {
                    return Ok(Some(of_rings(plane, rings)));
                }
                one(&split, merge, trust, runner.serial())
            };
            range.map(layer).collect::<Result<Vec<Option<Section>>, Error>>()
        })?;
        let found: Vec<Vec<Option<Section>>> = found.into_iter().collect::<Result<_, Error>>()?;
        let mut sections: Vec<(usize, Option<Section>)> =
            order.iter().copied().zip(found.into_iter().flatten()).collect();
        sections.sort_by_key(|(plane, _)| *plane);
        Ok(sections.into_iter().map(|(_, section)| section).collect())
    }
}

/// The axis that all planes are across, and their order; `None` if they are not.
fn levels(planes: &[Plane]) -> Option<(usize, Vec<usize>)> {
    let (axis, _) = planes.first()?.as_level()?;
    let at: Vec<f64> = planes
        .iter()
        .map(|plane| plane.as_level().filter(|level| level.0 == axis).map(|level| level.1))
        .collect::<Option<_>>()?;
    let mut order: Vec<usize> = (0..planes.len()).collect();
    order.sort_by(|&i, &j| at[i].total_cmp(&at[j]));
    // The same twice cannot be told apart by ranks.
    order.windows(2).all(|pair| at[pair[0]] != at[pair[1]]).then_some((axis, order))
}

/// The section that outlines make.
fn of_rings(plane: &Plane, rings: Rings) -> Section {
    let Rings { points: places, loops } = rings;
    let projection = plane.projection();
    let flat: Vec<[f64; 2]> = places.iter().map(|place| projection.project(place)).collect();
    Section::new(*plane, &in_space(polygon::polygons_of_loops(&flat, loops), &places))
}

/// Polygons by the numbers of their corners, with their places.
fn in_space(polygons: Vec<Vec<Vec<u32>>>, places: &[[f64; 3]]) -> Vec<Vec<Vec<[f64; 3]>>> {
    let ring = |ring: Vec<u32>| ring.into_iter().map(|number| places[number as usize]).collect();
    polygons.into_iter().map(|polygon| polygon.into_iter().map(ring).collect()).collect()
}

/// What outlines are taken for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Trust {
    /// The solid does not cross itself: all are right.
    Outlines,
    /// Those that wind once around all that is inside, and neither cross nor touch themselves.
    SimpleOutlines,
}

/// The section at one plane; `None` where its outline is not trusted.
fn one(split: &Split<'_>, merge: bool, trust: Trust, runner: Runner<'_>) -> Result<Option<Section>, Error> {
    // (Outlines have no attributes: faces of all classes are one.)
    let nodes = Nodes::new(split, merge.then_some(&[]), runner)?;
    let (points, edges) = numbered(&outline(split, &nodes));
    let places: Vec<[f64; 3]> = points.iter().map(|&point| nodes.position(split, point)).collect();
    let projection = split.plane.projection();
    let flat: Vec<[f64; 2]> = places.iter().map(|place| projection.project(place)).collect();
    if trust == Trust::SimpleOutlines && !polygon::fill_wound(&flat, &edges).is_simple {
        return Ok(None);
    }
    let polygons = in_space(polygon::polygons(&flat, &edges), &places);
    Ok(Some(Section::new(*split.plane, &polygons)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::primitives;

    #[test]
    fn planes_in_one_pass_are_those_one_by_one() {
        let torus = Solid::try_from(primitives::torus(2.0, 0.7, 24, 11).unwrap()).unwrap();
        let heights = [0.3, -0.7, 0.0, 0.7, -0.2, 5.0];
        for axis in 0..3 {
            let planes: Vec<Plane> = heights.iter().map(|&at| Plane::across(axis, at).unwrap()).collect();
            for side in [SectionSide::Inside, SectionSide::Above, SectionSide::Below] {
                let sections = Sections::new().side(side);
                let together = sections.at(&torus, &planes).unwrap();
                for (plane, section) in planes.iter().zip(&together) {
                    assert_eq!(section, &sections.at(&torus, &[*plane]).unwrap()[0]);
                }
            }
        }
    }

    #[test]
    fn faces_in_the_plane_count_as_they_are_asked_to() {
        let block = Solid::try_from(primitives::cuboid([0.0; 3], [2.0, 3.0, 1.0]).unwrap()).unwrap();
        let area = |side, at| {
            let plane = Plane::across(2, at).unwrap();
            Sections::new().side(side).at(&block, &[plane]).unwrap()[0].area()
        };
        assert_eq!([0.0, 0.5, 1.0].map(|at| area(SectionSide::Inside, at)), [0.0, 6.0, 0.0]);
        assert_eq!([0.0, 0.5, 1.0].map(|at| area(SectionSide::Above, at)), [6.0, 6.0, 0.0]);
        assert_eq!([0.0, 0.5, 1.0].map(|at| area(SectionSide::Below, at)), [0.0, 6.0, 6.0]);
        let middle = block.section(&Plane::across(2, 0.5).unwrap()).unwrap();
        assert_eq!(middle.shapes()[0][0].len(), 4, "no corner on the diagonals");
        assert_eq!(middle.perimeter(), 10.0);
        let across_y = block.section(&Plane::across(1, 1.0).unwrap()).unwrap();
        assert!(across_y.rings().flatten().all(|&point| across_y.place(point)[1] == 1.0));
    }

    #[test]
    fn slanted_sections_lead_back_to_space() {
        let block = Solid::try_from(primitives::cuboid([-1.0; 3], [1.0; 3]).unwrap()).unwrap();
        let plane = Plane::new([1.0, 1.0, 1.0], 0.0).unwrap();
        let section = block.section(&plane).unwrap();
        assert_eq!(section.shapes()[0][0].len(), 6);
        assert!((section.area() - 6.0 * 3.0f64.sqrt() / 2.0).abs() < 1e-12);
        for &point in &section.shapes()[0][0] {
            assert!(section.place(point).iter().sum::<f64>().abs() < 1e-12);
        }
    }
}
