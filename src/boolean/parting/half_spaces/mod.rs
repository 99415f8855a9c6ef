//! Expressions with half-spaces among their operands.
//!
//! A half-space has neither a size nor edges, so it is not arranged like a solid:
//!
//! 1. One across an axis is the part of it in a box around all there is, one face of which lies in the plane: exactly the same set
//!    wherever a solid is. It is an operand like others.
//! 2. Numbers have no box that ends exactly in any other plane. Such a half-space cuts the smallest set around it that has an end (`work`):
//!    with all of space for the half-space the set is what is to be kept on its side, with nothing for it what is to be kept on the
//!    other side. Nearly always one of the two is empty.
//! 3. What was cut is a solid in what is left of the expression.

mod work;

use std::sync::Arc;

use crate::boolean::expression::Expression;
use crate::boolean::expression::rule::Rule;
use crate::boolean::many::options::BooleanOptions;
use crate::boolean::result::origins::Origins;
use crate::boolean::result::outcome::Outcome;
use crate::exact::Plane;
use crate::mesh::Bounds;
use crate::{Error, Solid, primitives};
use work::{Held, Part, Work};

/// A leaf of an expression: a solid, or a half-space.
#[derive(Clone, Copy, Debug)]
pub enum Leaf<'a> {
    /// A solid.
    Solid(&'a Solid),
    /// All that is above a plane.
    Above(Plane),
    /// All that is below a plane.
    Below(Plane),
}

impl<'a> Leaf<'a> {
    fn solid(&self) -> Option<&'a Solid> {
        match self {
            Self::Solid(solid) => Some(solid),
            Self::Above(_) | Self::Below(_) => None,
        }
    }

    /// The plane of a half-space, and whether the half-space is above it.
    fn half_space(&self) -> Option<(Plane, bool)> {
        match self {
            Self::Solid(_) => None,
            Self::Above(plane) => Some((*plane, true)),
            Self::Below(plane) => Some((*plane, false)),
        }
    }

    /// The same as the part of an axis, and whether it is the part where the coordinate is larger.
    fn level(&self) -> Option<(usize, f64, bool)> {
        let (plane, is_above) = self.half_space()?;
        let (axis, at) = plane.as_level()?;
        Some((axis, at, is_above == (plane.normal()[axis] > 0.0)))
    }

    /// Whether it is a half-space that is not across an axis.
    fn is_askew(&self) -> bool {
        self.half_space().is_some() && self.level().is_none()
    }
}

impl BooleanOptions {
    /// Evaluates an expression whose operands are solids and half-spaces. A plane has no size and no edges, and is exactly the one that
    /// its numbers tell. What remains must have an end.
    ///
    /// Where all half-spaces are across axes everything is evaluated at once, and nothing is rounded in between. What a plane askew
    /// cuts is rounded before the rest of the expression goes on with it. In [`Outcome::origins`] a half-space is the operand that
    /// it is here; [`Outcome::operand_states`] has those of the solids, in their order.
    ///
    /// ```
    /// use trisect::exact::Plane;
    /// use trisect::{BooleanOptions, Leaf, Solid, primitives};
    ///
    /// let block = Solid::try_from(primitives::cuboid([0.0; 3], [2.0; 3])?)?;
    /// let post = Solid::try_from(primitives::cuboid([0.5, 0.5, -1.0], [1.0, 1.0, 3.0])?)?;
    /// let roof = Plane::new([1.0, 0.0, 1.0], 2.0)?;
    /// let leaves = [Leaf::Solid(&block), Leaf::Solid(&post), Leaf::Below(roof)];
    /// let expression = "a & c + b".parse().expect("letters are operands");
    /// let house = BooleanOptions::new().evaluate_leaves(&expression, &leaves)?;
    /// assert_eq!(house.solid().volume(), 4.0 + 0.25 + 0.25 * 1.75);
    /// # Ok::<(), trisect::Error>(())
    /// ```
    ///
    /// # Errors
    /// As [`evaluate`](Self::evaluate), and [`Error::InvalidArgument`] where the set has no end.
    pub fn evaluate_leaves(&self, expression: &Expression, leaves: &[Leaf<'_>]) -> Result<Outcome, Error> {
        if leaves.iter().all(|leaf| leaf.solid().is_some()) {
            return self.evaluate(expression, leaves.iter().filter_map(Leaf::solid));
        }
        let needed = expression.operands().last().map_or(0, |last| last + 1);
        if needed > leaves.len() {
            let what = format!("the expression needs {needed} operands, and there are {}", leaves.len());
            return Err(Error::InvalidArgument(what));
        }
        if !has_end(expression, leaves) {
            return Err(unbounded());
        }
        // 1. What is across axes, and all of space.
        let space = Space::around(leaves);
        let mut parts: Vec<Part<'_>> = (0u32..)
            .zip(leaves)
            .map(|(operand, leaf)| space.part(operand, leaf, self.rule_of(operand as usize)))
            .collect::<Result<_, _>>()?;
        let of_none = Arc::new(Origins::of_operand(u32::MAX, 0));
        parts.push(Part { solid: Held::Box(space.whole()?, of_none), rule: Rule::Positive });
        // 2. What is cut, and the rest.
        Work::new(self, leaves, parts).result(expression)
    }
}

fn unbounded() -> Error {
    let what = "this is unbounded, as half-spaces are: intersect them with a body, or take them off one";
    Error::InvalidArgument(what.into())
}

/// Whether a set ends, wherever its half-spaces meet.
fn has_end(expression: &Expression, leaves: &[Leaf<'_>]) -> bool {
    /// Where its form does not tell, all sets of so many half-spaces are looked through for one that leaves it without an end.
    const MOST: usize = 16;
    if expression.is_bounded(&|operand| leaves[operand].half_space().is_some()) {
        return true;
    }
    let is_half_space = |operand: &usize| leaves[*operand].half_space().is_some();
    let half_spaces: Vec<usize> = expression.operands().into_iter().filter(is_half_space).collect();
    half_spaces.len() <= MOST
        && !(0..1u32 << half_spaces.len()).any(|set| {
            expression.contains(&|operand| {
                half_spaces.binary_search(&operand).is_ok_and(|place| set >> place & 1 == 1)
            })
        })
}

/// A box around all solids, larger than these on every side.
struct Space(Bounds);

impl Space {
    fn around(leaves: &[Leaf<'_>]) -> Self {
        let bounds = leaves.iter().filter_map(Leaf::solid).filter_map(Solid::bounds);
        let mut all = bounds.reduce(Bounds::united).unwrap_or(Bounds { low: [0.0; 3], high: [0.0; 3] });
        let size = (0..3).map(|axis| all.high[axis] - all.low[axis]).fold(1.0f64, f64::max);
        all.low = all.low.map(|x| x - size);
        all.high = all.high.map(|x| x + size);
        Self(all)
    }

    fn whole(&self) -> Result<Arc<Solid>, Error> {
        Ok(Arc::new(Solid::try_from(primitives::cuboid(self.0.low, self.0.high)?)?))
    }

    /// A leaf as a solid; nothing for planes askew.
    fn part<'a>(&self, operand: u32, leaf: &Leaf<'a>, rule: Rule) -> Result<Part<'a>, Error> {
        let origins = |solid: &Solid| Arc::new(Origins::of_operand(operand, solid.mesh().triangles.len()));
        if let Some(solid) = leaf.solid() {
            return Ok(Part { solid: Held::Given(solid, origins(solid)), rule });
        }
        let Bounds { mut low, mut high } = self.0;
        let solid = match leaf.level() {
            Some((axis, at, is_above)) => {
                let end = if is_above { &mut low[axis] } else { &mut high[axis] };
                *end = at;
                // (Where all is beyond the plane nothing is left.)
                if low[axis] < high[axis] {
                    Solid::try_from(primitives::cuboid(low, high)?)?
                } else {
                    Solid::empty()
                }
            }
            None => Solid::empty(),
        };
        let origins = origins(&solid);
        Ok(Part { solid: Held::Box(Arc::new(solid), origins), rule: Rule::Positive })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::boolean::PlaneCut;
    use rand::rngs::ChaCha8Rng;
    use rand::{RngExt, SeedableRng};

    fn block(low: [f64; 3], high: [f64; 3]) -> Solid {
        Solid::try_from(primitives::cuboid(low, high).unwrap()).unwrap()
    }

    fn random(rng: &mut ChaCha8Rng, operands: usize, depth: usize) -> Expression {
        if depth == 0 || rng.random_bool(0.15) {
            return Expression::Operand(rng.random_range(0..operands));
        }
        let sets = (0..rng.random_range(1..4)).map(|_| random(rng, operands, depth - 1)).collect();
        match rng.random_range(0..5) {
            0 => Expression::Union(sets),
            1 => Expression::Intersection(sets),
            2 => Expression::Difference(sets),
            3 => Expression::SymmetricDifference(sets),
            _ => Expression::AtLeast(rng.random_range(1..3), sets),
        }
    }

    /// A half-space as a solid: a huge box turned so that a face of it is nearly in the plane.
    fn nearly(plane: &Plane, is_above: bool) -> Solid {
        let normal = plane.normal();
        let side = |v: [f64; 3], w: [f64; 3]| -> [f64; 3] {
            std::array::from_fn(|k| v[(k + 1) % 3] * w[(k + 2) % 3] - v[(k + 2) % 3] * w[(k + 1) % 3])
        };
        let least = (0..3).min_by(|&i, &j| normal[i].abs().total_cmp(&normal[j].abs())).unwrap();
        let u = side(normal, std::array::from_fn(|k| f64::from(u8::from(k == least))));
        let v = side(normal, u);
        let point = plane.point();
        let far = if is_above { [0.0, 50.0] } else { [-50.0, 0.0] };
        let rows: [[f64; 4]; 3] = std::array::from_fn(|k| [u[k], v[k], normal[k], point[k]]);
        let mesh = primitives::cuboid([-50.0, -50.0, far[0]], [50.0, 50.0, far[1]]).unwrap();
        Solid::try_from(mesh.transformed(rows.as_flattened()).unwrap()).unwrap()
    }

    #[test]
    fn expressions_are_those_of_huge_boxes() {
        let mut rng = ChaCha8Rng::seed_from_u64(33);
        let options = BooleanOptions::new();
        let (mut bounded, mut unbounded) = (0, 0);
        for round in 0..400 {
            let mut low = || std::array::from_fn::<f64, 3, _>(|_| rng.random_range(-1.0..0.5));
            let blocks: Vec<Solid> =
                (0..2).map(|_| low()).map(|low| block(low, low.map(|x| x + 1.3))).collect();
            let planes: Vec<Plane> = (0..2)
                .map(|_| {
                    let mut normal: [f64; 3] = std::array::from_fn(|_| rng.random_range(-1.0..1.0));
                    if rng.random_bool(0.3) {
                        normal = [0.0, 0.0, 1.0];
                    }
                    Plane::new(normal, rng.random_range(-0.4..0.4)).unwrap()
                })
                .collect();
            let leaves = [
                Leaf::Solid(&blocks[0]),
                Leaf::Below(planes[0]),
                Leaf::Solid(&blocks[1]),
                Leaf::Above(planes[1]),
            ];
            let expression = random(&mut rng, leaves.len(), 3);
            match options.evaluate_leaves(&expression, &leaves) {
                Ok(outcome) => {
                    bounded += 1;
                    let made = [nearly(&planes[0], false), nearly(&planes[1], true)];
                    let all = [&blocks[0], &made[0], &blocks[1], &made[1]];
                    let expected = options.evaluate(&expression, all).unwrap();
                    let (found, expected) = (outcome.solid().volume(), expected.solid().volume());
                    assert!(
                        (found - expected).abs() < 1e-9,
                        "round {round}: {expression:?}: {found}, {expected}"
                    );
                    let certificate = outcome.certificate();
                    assert!(certificate.closed && certificate.operands.len() <= 2, "round {round}");
                    for origin in outcome.origins() {
                        let leaf = &leaves[origin.operand as usize];
                        let of_solid = leaf
                            .solid()
                            .is_some_and(|solid| (origin.triangle as usize) < solid.mesh().triangles.len());
                        assert!(of_solid || leaf.half_space().is_some(), "round {round}");
                    }
                }
                Err(error) => {
                    unbounded += 1;
                    assert!(error.to_string().contains("unbounded"), "round {round}: {error}");
                }
            }
        }
        assert!(bounded > 100 && unbounded > 100, "{bounded} {unbounded}");
    }

    #[test]
    fn many_planes_cut_one_by_one() {
        let ball = Solid::try_from(primitives::geodesic_sphere(2.0, 12).unwrap()).unwrap();
        let mut rng = ChaCha8Rng::seed_from_u64(34);
        let planes: Vec<Plane> = (0..60)
            .map(|_| Plane::new(std::array::from_fn(|_| rng.random_range(-1.0..1.0)), 1.2).unwrap())
            .collect();
        let leaves: Vec<Leaf<'_>> = std::iter::once(Leaf::Solid(&ball))
            .chain(planes.iter().map(|&plane| Leaf::Below(plane)))
            .collect();
        let all = Expression::Intersection((0..leaves.len()).map(Expression::Operand).collect());
        let options = BooleanOptions::new();
        let at_once = options.evaluate_leaves(&all, &leaves).unwrap();
        let mut one_by_one = ball.clone();
        for plane in &planes {
            one_by_one = PlaneCut::new(*plane).below(&one_by_one).unwrap().into_solid();
        }
        assert!(at_once.solid().mesh() == one_by_one.mesh());
        let too_many = Expression::AtLeast(31, (0..leaves.len()).map(Expression::Operand).collect());
        let set = Expression::Intersection(vec![Expression::Operand(0), too_many]);
        assert!(options.evaluate_leaves(&set, &leaves).is_err());
    }
}
