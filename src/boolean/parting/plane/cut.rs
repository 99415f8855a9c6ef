//! Cutting at a plane, with all that may be chosen.

use super::assemble::{Arrays, assemble};
use super::cap::{Cap, cap};
use super::nodes::Nodes;
use super::pieces::{Piece, count_inverted, pieces};
use super::separate::{New, separate};
use super::split::{Half, Split};
use crate::boolean::complex::classes::Faces;
use crate::boolean::complex::origin::Origin;
use crate::boolean::many::expressions::is_simple;
use crate::boolean::many::made::Made;
use crate::boolean::many::options::BooleanOptions;
use crate::boolean::many::policy::Policy;
use crate::boolean::result::certificate::{Notes, OperandState};
use crate::boolean::result::origins::Origins;
use crate::boolean::result::outcome::Outcome;
use crate::exact::Plane;
use crate::mesh::{FaceGroup, FaceGroups};
use crate::parallel::Runner;
use crate::{Error, Mesh, Solid};

/// A cut at a plane.
///
/// ```
/// use trisect::exact::Plane;
/// use trisect::{FaceGroup, PlaneCut, Solid, primitives};
///
/// let ball = Solid::try_from(primitives::geodesic_sphere(1.0, 16)?)?;
/// let cap = FaceGroup { name: "cap".into(), material: None };
/// let half = PlaneCut::new(Plane::new([1.0, 2.0, 3.0], 0.5)?).cap(cap).below(&ball)?;
/// let groups = &half.solid().mesh().groups;
/// assert_eq!(groups.list[1].name, "cap");
/// # Ok::<(), trisect::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct PlaneCut {
    plane: Plane,
    cap: Option<FaceGroup>,
    options: BooleanOptions,
}

impl PlaneCut {
    /// A cut at a plane, with default [`BooleanOptions`].
    #[must_use]
    pub fn new(plane: Plane) -> Self {
        Self { plane, cap: None, options: BooleanOptions::new() }
    }

    /// The group of the faces in the plane that close the halves. Without one they are in an unnamed group, if the solid has groups.
    #[must_use]
    pub fn cap(mut self, group: FaceGroup) -> Self {
        self.cap = Some(group);
        self
    }

    /// Settings: limits, threads, whether needless vertices are left out, what is inside where the solid crosses itself, and
    /// what the cap shows ([`BooleanOptions::cut_faces`]): the group of the faces around, another one, texture coordinates. By
    /// default it has its own group. Its normals are flat where the solid has normals.
    #[must_use]
    pub fn options(mut self, options: BooleanOptions) -> Self {
        self.options = options;
        self
    }

    /// What is above the plane, and what is below it.
    ///
    /// # Errors
    /// [`Error::TooLarge`] if the points cannot be numbered with 32 bits; limits.
    pub fn halves(&self, solid: &Solid) -> Result<(Outcome, Outcome), Error> {
        let [below, above] = self.run(solid, &Half::BOTH)?.map(|half| half.unwrap_or_else(nothing));
        Ok((above, below))
    }

    /// What is above the plane.
    ///
    /// # Errors
    /// As [`halves`](Self::halves).
    pub fn above(&self, solid: &Solid) -> Result<Outcome, Error> {
        let [_, above] = self.run(solid, &[Half::Above])?;
        Ok(above.unwrap_or_else(nothing))
    }

    /// What is below the plane: its common part with the half-space.
    ///
    /// # Errors
    /// As [`halves`](Self::halves).
    pub fn below(&self, solid: &Solid) -> Result<Outcome, Error> {
        let [below, _] = self.run(solid, &[Half::Below])?;
        Ok(below.unwrap_or_else(nothing))
    }

    fn run(&self, solid: &Solid, wanted: &[Half]) -> Result<[Option<Outcome>; 2], Error> {
        let faces = self.options.checked_cut_faces()?;
        let halves: [Option<Outcome>; 2] = self.options.work(|policy, runner| {
            let cut = Cut { solid, plane: &self.plane, cap: self.cap.as_ref(), policy, runner };
            match cut.halves(wanted, Seen::NotYet)? {
                Some(halves) => Ok(halves),
                // What the section says: the surface must be resolved first.
                None => {
                    let resolved = self.options.resolve(solid)?;
                    let again = Cut { solid: resolved.solid(), ..cut };
                    let halves = again.halves(wanted, Seen::Resolved { of: solid, outcome: &resolved })?;
                    Ok(halves.unwrap_or([None, None]))
                }
            }
        })?;
        Ok(halves.map(|half| half.map(|outcome| outcome.with_cap(faces, 1))))
    }
}

fn nothing() -> Outcome {
    Outcome::new(Solid::empty(), Origins::default(), f64::EPSILON, Notes::default())
}

/// What is known of the solid beyond itself.
#[derive(Clone, Copy)]
enum Seen<'a> {
    NotYet,
    /// It is what another became when it was resolved.
    Resolved {
        of: &'a Solid,
        outcome: &'a Outcome,
    },
}

/// One cut.
#[derive(Clone, Copy)]
struct Cut<'a> {
    solid: &'a Solid,
    plane: &'a Plane,
    cap: Option<&'a FaceGroup>,
    policy: Policy,
    runner: Runner<'a>,
}

impl Cut<'_> {
    /// The wanted halves; `None` where the solid has to be resolved first.
    fn halves(&self, wanted: &[Half], seen: Seen<'_>) -> Result<Option<[Option<Outcome>; 2]>, Error> {
        let control = self.runner.control;
        let _tables = control.reserve(fixed_tables(self.solid.mesh(), wanted.len()))?;
        // 1. The sides of everything.
        let split = Split::new(self.solid.mesh(), self.plane, self.runner)?;
        if split.is_apart() {
            return self.whole(&split, wanted, seen).map(Some);
        }
        // 2. Where edges pass through.
        let nodes = Nodes::new(&split, self.merged_classes(&split).as_deref(), self.runner)?;
        control.check()?;
        // 3. and 4. The cap, and the pieces of each half.
        let cap = cap(&split, &nodes);
        control.check()?;
        if !cap.is_simple && matches!(seen, Seen::NotYet) && !is_simple(self.policy, self.solid, control)? {
            return Ok(None);
        }
        let one = |half: Half| -> Option<(Arrays, u64)> {
            wanted.contains(&half).then(|| half_of(&split, &nodes, &cap, half))
        };
        let (below, above) = self.runner.both(|| one(Half::Below), || one(Half::Above));
        control.check()?;
        // 7. What is known of them.
        let on = split.count_on();
        let finish =
            |made: Option<(Arrays, u64)>| made.map(|made| self.outcome(made, on, &cap, seen)).transpose();
        Ok(Some([finish(below)?, finish(above)?]))
    }

    /// The classes of faces that may be cut as one; no class where all may, nothing where none may.
    fn merged_classes(&self, split: &Split<'_>) -> Option<Vec<u32>> {
        if !self.policy.remove_vertices {
            return None;
        }
        let mesh = self.solid.mesh();
        if mesh.attributes.is_empty() {
            return Some(Vec::new());
        }
        let faces = Faces {
            positions: &mesh.positions,
            triangles: &mesh.triangles,
            groups: &mesh.groups.of_triangle,
            origin: |triangle: u32| Origin { operand: 0, triangle, reversed: false },
            givens: &[self.solid],
        };
        Some(faces.classes(&split.cut, 0))
    }

    /// The halves where the plane passes the solid by.
    fn whole(
        &self,
        split: &Split<'_>,
        wanted: &[Half],
        seen: Seen<'_>,
    ) -> Result<[Option<Outcome>; 2], Error> {
        let of = |half: Half| -> Result<Option<Outcome>, Error> {
            if !wanted.contains(&half) {
                return Ok(None);
            }
            let mesh = self.solid.mesh();
            // Bodies may lie on either side.
            if !(0..mesh.triangles.len() as u32).any(|triangle| split.half_of(triangle) == Some(half)) {
                return Ok(Some(nothing()));
            }
            let nodes = Nodes::new(split, None, self.runner)?;
            let new = New { pieces: Vec::new(), replaced: Vec::new(), copies: Vec::new() };
            let arrays = assemble(split, &nodes, half, &new);
            let cap = Cap { triangles: Vec::new(), is_simple: true, inverted: 0 };
            self.outcome((arrays, 0), 0, &cap, seen).map(Some)
        };
        Ok([of(Half::Below)?, of(Half::Above)?])
    }

    /// The result of a half.
    fn outcome(
        &self,
        (arrays, inverted): (Arrays, u64),
        contacts: u64,
        cap: &Cap,
        seen: Seen<'_>,
    ) -> Result<Outcome, Error> {
        let Arrays { mesh, mut origins } = arrays;
        let groups = self.groups(&mesh, &origins);
        let (mut given, mut operands) = (self.solid, vec![OperandState::of(self.solid)]);
        if let Seen::Resolved { of, outcome } = seen {
            given = of;
            operands.clone_from(&outcome.certificate().operands);
            let plane = Origins::of_operand(1, 1);
            origins = origins.compose(&[outcome.runs(), &plane]);
        }
        let notes = Notes { contacts, inverted, operands, ..Notes::default() };
        let made = Made {
            solid: Solid::from_closed_unchecked(mesh),
            origins,
            groups,
            notes,
            may_cross: inverted > 0 || !cap.is_simple,
            cut: Vec::new(),
            is_clean: self.solid.is_known_clean(),
        };
        // (The cap comes from no triangle; what it shows is given to it at the end.)
        made.finish(self.policy, &[given], self.runner)
    }

    /// The groups of a half.
    fn groups(&self, mesh: &Mesh, origins: &Origins) -> FaceGroups {
        let own = &self.solid.mesh().groups;
        if own.is_empty() && self.cap.is_none() {
            return FaceGroups { list: own.list.clone(), of_triangle: Vec::new() };
        }
        let mut list = own.list.clone();
        let mut number = |group: &FaceGroup| match list.iter().position(|other| other == group) {
            Some(number) => number as u32,
            None => {
                list.push(group.clone());
                list.len() as u32 - 1
            }
        };
        let unnamed = FaceGroup::default();
        let without = if own.is_empty() { number(&unnamed) } else { 0 };
        let of_cap = number(self.cap.unwrap_or(&unnamed));
        let group = |origin: Origin| match origin.operand {
            0 => own.of_triangle.get(origin.triangle as usize).copied().unwrap_or(without),
            _ => of_cap,
        };
        let mut of_triangle = Vec::with_capacity(mesh.triangles.len());
        of_triangle.extend(origins.iter().map(group));
        FaceGroups { list, of_triangle }
    }
}

/// Memory for the arrays whose size does not depend on the cut, in bytes: the marks and, for each half, the numbers of all vertices;
/// and the halves, which together have what the solid has.
fn fixed_tables(mesh: &Mesh, halves: usize) -> u64 {
    let per_vertex = size_of::<u8>() + halves * size_of::<u32>() + size_of::<[f64; 3]>();
    let per_triangle = size_of::<[u32; 3]>();
    (mesh.positions.len() * per_vertex + mesh.triangles.len() * per_triangle) as u64
}

/// Steps 3, 5 and 6 for one half, and how many triangles rounding turned over.
fn half_of(split: &Split<'_>, nodes: &Nodes, cap: &Cap, half: Half) -> (Arrays, u64) {
    // 3. Pieces.
    let mut new = pieces(split, nodes, half);
    let inverted = cap.inverted + count_inverted(split, nodes, &new);
    // 4. The cap, turned over above.
    new.extend(cap.triangles.iter().filter_map(|corners| {
        let [a, b, c] = corners.map(|point| nodes.in_half(half, point));
        let corners = if half == Half::Above { [a, c, b] } else { [a, b, c] };
        (a != b && b != c && c != a).then_some(Piece { corners, source: None })
    }));
    // 5. What touches comes apart.
    let touches = nodes.may_pinch || !cap.is_simple || split.touching(half).next().is_some();
    let new = if touches {
        separate(split, nodes, half, new)
    } else {
        New { pieces: new, replaced: Vec::new(), copies: Vec::new() }
    };
    // 6. The arrays.
    (assemble(split, nodes, half, &new), inverted)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::control::{Control, Limit};
    use crate::mesh::Attribute;
    use crate::{Sections, primitives};

    /// A solid whose triangles have their numbers as values.
    fn numbered(mut mesh: Mesh) -> Solid {
        let count = mesh.triangles.len();
        mesh.attributes = vec![Attribute {
            name: "_NUMBER".into(),
            components: 1,
            values: (0..count as u32).map(f64::from).collect(),
            of_corner: (0..3 * count as u32).map(|corner| corner / 3).collect(),
        }];
        Solid::try_from(mesh).unwrap()
    }

    /// The number of each triangle of a half that comes from the solid, and its area.
    fn numbers_and_areas(half: &Outcome) -> Vec<(f64, f64)> {
        let mesh = half.solid().mesh();
        let attribute = &mesh.attributes[0];
        let mut found = Vec::new();
        for (triangle, origin) in half.origins().iter().enumerate().filter(|(_, origin)| origin.operand == 0)
        {
            for corner in 0..3 {
                let value = attribute.value(attribute.of_corner[3 * triangle + corner]).unwrap();
                assert_eq!(value, [f64::from(origin.triangle)], "triangle {triangle}");
            }
            let alone = Mesh::new(mesh.positions.clone(), vec![mesh.triangles[triangle]]);
            found.push((f64::from(origin.triangle), alone.area()));
        }
        found
    }

    #[test]
    fn a_saddle_of_cut_faces_comes_apart() {
        // All four faces round a vertex in the plane are cut: the parts above touch there alone.
        let ring = [[1.0, 0.0, 1.0], [0.0, 1.0, -1.0], [-1.0, 0.0, 1.0], [0.0, -1.0, -1.0]];
        let positions = ring.into_iter().chain([[0.0; 3], [0.0, 0.0, -5.0]]).collect();
        let triangles = (0..4).flat_map(|k| [[4, k, (k + 1) % 4], [5, (k + 1) % 4, k]]).collect();
        let saddle = Solid::try_from(Mesh::new(positions, triangles)).unwrap();
        let (above, below) = saddle.cut(&Plane::across(2, 0.0).unwrap()).unwrap();
        assert!(above.solid().is_manifold() && below.solid().is_manifold());
        assert_eq!(above.solid().bodies().len(), 2);
    }

    #[test]
    fn cuts_keep_to_a_memory_ceiling() {
        let ball = Solid::try_from(primitives::geodesic_sphere(1.0, 16).unwrap()).unwrap();
        let plane = Plane::across(2, 0.1).unwrap();
        let bytes = ball.mesh().positions.len() as u64;
        let within = |limit: u64| BooleanOptions::new().control(Control::new().memory_limit(limit));
        let cut = |limit: u64| PlaneCut::new(plane).options(within(limit)).halves(&ball);
        let sections = |limit: u64| Sections::new().options(within(limit)).at(&ball, &[plane]);
        assert!(matches!(cut(bytes), Err(Error::Limit(Limit::Memory { .. }))));
        assert!(matches!(sections(bytes), Err(Error::Limit(Limit::Memory { .. }))));
        assert!(cut(1_000 * bytes).is_ok() && sections(1_000 * bytes).is_ok());
    }

    #[test]
    fn faces_with_different_attributes_are_cut_apart() {
        let block = numbered(primitives::cuboid([0.0; 3], [2.0, 3.0, 4.0]).unwrap());
        let (above, below) = block.cut(&Plane::new([1.0, 2.0, 3.0], 9.0).unwrap()).unwrap();
        let found: Vec<(f64, f64)> = [&above, &below].into_iter().flat_map(numbers_and_areas).collect();
        let mesh = block.mesh();
        for (number, corners) in mesh.triangles.iter().enumerate() {
            let of_number = found.iter().filter(|(value, _)| *value == number as f64).map(|(_, area)| area);
            let whole = Mesh::new(mesh.positions.clone(), vec![*corners]).area();
            assert!((of_number.sum::<f64>() - whole).abs() < 1e-12, "triangle {number}");
        }
    }

    #[test]
    fn attributes_outlive_resolving() {
        let blocks = [
            primitives::cuboid([0.0; 3], [2.0, 3.0, 4.0]).unwrap(),
            primitives::cuboid([1.0; 3], [3.0, 4.0, 5.0]).unwrap(),
            primitives::cuboid([7.0; 3], [8.0; 3]).unwrap(),
        ];
        let crossing = numbered(Mesh::merged(&blocks).unwrap());
        let (above, below) = crossing.cut(&Plane::across(2, 2.5).unwrap()).unwrap();
        assert!(!numbers_and_areas(&above).is_empty() && !numbers_and_areas(&below).is_empty());
    }
}
