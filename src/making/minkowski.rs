//! Minkowski sums: what a convex tool sweeps while its origin goes through all of a solid.

use super::convex_hull;
use super::hull::hull_of_convex;
use crate::boolean::{BooleanOptions, Embed, Grid};
use crate::{Control, Error, Mesh, Operation, Solid};

/// Bodies of triangles that are united at once before all unions are: more make one arrangement too deep (a few dozen lie on each
/// other at every place), fewer give more rounds.
const AT_ONCE: usize = 64;

/// The Minkowski sum of a solid and a convex tool: all points a + b with a in the solid and b in the tool. A ball rounds the
/// solid's edges and thickens it by its radius, a box thickens it along the axes.
///
/// Where both are convex, it is the hull of all sums of vertices, each coordinate rounded once; exact where the sums are (integers,
/// say). Otherwise it is the union of the solid, moved by a vertex of the tool, with the hull of every triangle's sum with the tool:
/// exact but for the rounding of sums and of each union. That is many bodies that lie on each other: some milliseconds for each
/// triangle of the solid; `benches/README.md` has figures.
///
/// ```
/// use trisect::{Control, Solid, making, primitives};
///
/// let block = Solid::try_from(primitives::cuboid([0.0; 3], [4.0, 3.0, 2.0])?)?;
/// let tool = Solid::try_from(primitives::octahedron(1.0)?)?;
/// let sum = making::minkowski_sum(&block, &tool, &Control::new())?;
/// // V + A d + (edges) + the tool itself, for a tool as wide as 2 d
/// assert_eq!(sum.bounds().unwrap().size(), [6.0, 5.0, 4.0]);
/// # Ok::<(), trisect::Error>(())
/// ```
///
/// # Errors
/// [`Error::InvalidArgument`] if the tool is empty or not convex; limits; as [`boolean`](crate::boolean).
pub fn minkowski_sum(solid: &Solid, tool: &Solid, control: &Control) -> Result<Solid, Error> {
    let Some(tool) = hull_of_convex(tool) else {
        let what = "the second operand of a Minkowski sum must be convex: take its hull, or sum its convex parts one by one";
        return Err(Error::InvalidArgument(what.into()));
    };
    if solid.is_empty() {
        return Ok(Solid::empty());
    }
    let tool = tool.positions;
    if let Some(hull) = hull_of_convex(solid) {
        let corners = hull.positions;
        let count = corners.len() as u64 * tool.len() as u64;
        if count > u64::from(u32::MAX) {
            return Err(Error::TooLarge { what: format!("{count} sums of vertices of a Minkowski sum") });
        }
        let _sums = control.reserve(count * size_of::<[f64; 3]>() as u64)?;
        return Ok(Solid::try_from(convex_hull(&sums(&corners, &tool))?)?);
    }
    general(solid, &tool, control)
}

/// All sums of a point of each.
fn sums(a: &[[f64; 3]], b: &[[f64; 3]]) -> Vec<[f64; 3]> {
    let added = |a: &[f64; 3], b: &[f64; 3]| [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
    a.iter().flat_map(|a| b.iter().map(move |b| added(a, b))).collect()
}

/// The union of the solid with what the tool sweeps over its triangles.
fn general(solid: &Solid, tool: &[[f64; 3]], control: &Control) -> Result<Solid, Error> {
    let mesh = solid.mesh();
    let options = BooleanOptions::new().control(control.clone());
    // 1. The tool along every triangle.
    let mut bodies = Vec::with_capacity(mesh.triangles.len() + 1);
    for triangle in &mesh.triangles {
        control.check()?;
        let corners = triangle.map(|corner| mesh.positions[corner as usize]);
        bodies.push(Solid::try_from(convex_hull(&sums(&corners, tool))?)?);
    }
    // 2. What is farther inside than the tool reaches: the solid moved by any point of the tool.
    bodies.push(Solid::try_from(Mesh::new(sums(&mesh.positions, &tool[..1]), mesh.triangles.clone()))?);
    // 3. Unions of a few neighbours at a time, and of those again.
    while bodies.len() > 1 {
        // Each round rounds again; what that makes cross is resolved at last.
        let is_last = bodies.len() <= AT_ONCE;
        let embed = if is_last { Embed::OnGrid(Grid::Double) } else { Embed::WhereNeeded };
        let options = options.clone().embed(embed);
        let groups = bodies.chunks(AT_ONCE).map(|group| {
            let outcome = options.run(Operation::Union, group)?;
            Ok(outcome.into_solid())
        });
        bodies = groups.collect::<Result<_, Error>>()?;
    }
    Ok(bodies.pop().unwrap_or_default())
}

#[cfg(test)]
mod tests {
    use rand::rngs::ChaCha8Rng;
    use rand::{RngExt as _, SeedableRng as _};

    use super::*;
    use crate::primitives;
    use crate::spatial::TriangleTree;

    fn solid(mesh: Mesh) -> Solid {
        Solid::try_from(mesh).unwrap()
    }

    #[test]
    fn sums_of_boxes_are_boxes() {
        let a = solid(primitives::cuboid([1.0, 2.0, 3.0], [2.0, 4.0, 6.0]).unwrap());
        let b = solid(primitives::cuboid([-1.0, 0.0, 0.0], [0.0, 1.0, 7.0]).unwrap());
        let sum = minkowski_sum(&a, &b, &Control::new()).unwrap();
        assert_eq!(sum.mesh().triangles.len(), 12);
        let bounds = sum.bounds().unwrap();
        assert_eq!((bounds.low, bounds.high), ([0.0, 2.0, 3.0], [2.0, 5.0, 13.0]));
    }

    #[test]
    fn a_box_and_an_octahedron_have_the_faces_of_both_and_of_their_edges() {
        // 6 squares of the box, 8 triangles of the octahedron, 12 edges times 12 edges where normals cross: each box edge
        // meets two octahedron edges' arcs, 24 parallelograms in 12 planes: one hexagon-free face for each edge of the box.
        let cube = solid(primitives::cuboid([0.0; 3], [2.0; 3]).unwrap());
        let tool = solid(primitives::octahedron(1.0).unwrap());
        let sum = minkowski_sum(&cube, &tool, &Control::new()).unwrap();
        // V + sum over faces A h + edges + V of the tool: 8 + 24 + 12 * 2 * 1/2 + 4/3.
        assert!((sum.volume() - (8.0 + 24.0 + 12.0 + 4.0 / 3.0)).abs() < 1e-12, "{}", sum.volume());
        assert_eq!(sum.mesh().positions.len(), 24);
    }

    #[test]
    fn commutes_and_keeps_supports() {
        let mut random = ChaCha8Rng::seed_from_u64(3);
        for _ in 0..20 {
            let mut cloud = |count: usize| -> Solid {
                let points: Vec<[f64; 3]> = (0..count)
                    .map(|_| std::array::from_fn(|_| f64::from(random.random_range(-9..=9))))
                    .collect();
                solid(convex_hull(&points).unwrap())
            };
            let (a, b) = (cloud(14), cloud(9));
            let (ab, ba) = (
                minkowski_sum(&a, &b, &Control::new()).unwrap(),
                minkowski_sum(&b, &a, &Control::new()).unwrap(),
            );
            assert!((ab.volume() - ba.volume()).abs() <= 1e-9 * ab.volume());
            // How far it reaches in a direction is the sum of how far both do, exactly.
            for direction in [[1.0, 0.0, 0.0], [3.0, -2.0, 5.0], [-1.0, -7.0, 2.0]] {
                let reach = |solid: &Solid| {
                    let along = |p: &[f64; 3]| (0..3).map(|k| p[k] * direction[k]).sum::<f64>();
                    solid.mesh().positions.iter().map(along).fold(f64::NEG_INFINITY, f64::max)
                };
                assert_eq!(reach(&ab), reach(&a) + reach(&b));
            }
        }
    }

    #[test]
    fn a_body_with_a_notch_grows_by_the_tool_everywhere() {
        let body = solid(primitives::cuboid([0.0; 3], [6.0, 4.0, 3.0]).unwrap());
        let notch = solid(primitives::cuboid([2.0, -1.0, 1.0], [4.0, 5.0, 9.0]).unwrap());
        let body = body.difference(&notch).unwrap().into_solid();
        let tool = solid(primitives::cuboid([-0.5; 3], [0.5; 3]).unwrap());
        let sum = minkowski_sum(&body, &tool, &Control::new()).unwrap();
        assert!(sum.is_manifold());
        // 7 x 5 x 4 less the notch, narrower by one and as deep as before.
        assert!((sum.volume() - (140.0 - 5.0 * 2.0)).abs() < 1e-9, "{}", sum.volume());
        // And a hollow with a tool away from the origin.
        let shell = solid(primitives::cuboid([-9.0; 3], [9.0; 3]).unwrap())
            .difference(&solid(primitives::cuboid([-5.0; 3], [5.0; 3]).unwrap()))
            .unwrap()
            .into_solid();
        let away = solid(primitives::octahedron(1.0).unwrap().translated([100.0, 0.0, 0.0]));
        let sum = minkowski_sum(&shell, &away, &Control::new()).unwrap();
        let tree = TriangleTree::new(sum.mesh());
        assert_eq!(sum.components(), 2);
        assert_eq!(tree.crossings([100.0, 0.0, 0.0]).winding, 0);
        assert_eq!(tree.crossings([104.5, 0.0, 0.0]).winding, 1);
    }

    #[test]
    fn sums_beyond_the_memory_ceiling_are_not_begun() {
        let ball = solid(primitives::icosphere(1.0, 3).unwrap());
        let control = Control::new().memory_limit(1_000_000);
        let refused = minkowski_sum(&ball, &ball, &control).unwrap_err();
        assert!(matches!(refused, Error::Limit(crate::Limit::Memory { .. })), "{refused}");
    }

    #[test]
    fn tools_must_be_convex() {
        let block = solid(primitives::cuboid([0.0; 3], [1.0; 3]).unwrap());
        let ring = solid(primitives::torus(2.0, 0.5, 8, 8).unwrap());
        assert!(minkowski_sum(&block, &ring, &Control::new()).unwrap_err().to_string().contains("convex"));
        assert!(minkowski_sum(&Solid::empty(), &block, &Control::new()).unwrap().is_empty());
    }
}
