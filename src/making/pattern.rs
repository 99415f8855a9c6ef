//! Patterns: many copies of a mesh as one mesh, and so as one operand.

use std::collections::TryReserveError;

use crate::mesh::Attribute;
use crate::{Error, Mesh, MeshError};

/// Where copies of a mesh go. The first place is always that of the mesh itself, but for points and lines.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "lowercase", deny_unknown_fields))]
#[non_exhaustive]
pub enum Pattern {
    /// Along a direction.
    Linear {
        /// How many copies.
        count: u32,
        /// From one to the next.
        step: [f64; 3],
    },
    /// In rows along the axes.
    Grid {
        /// How many along x, y and z.
        counts: [u32; 3],
        /// From one to the next along each.
        steps: [f64; 3],
    },
    /// Around an axis. A full turn ends one step before the first copy, a part of one with the last.
    Circular {
        /// How many copies.
        count: u32,
        /// The direction of the axis; z unless it is said.
        #[cfg_attr(feature = "serde", serde(default = "upwards"))]
        axis: [f64; 3],
        /// A point on it; the origin unless it is said.
        #[cfg_attr(feature = "serde", serde(default))]
        center: [f64; 3],
        /// From the first to the last, counter-clockwise seen against the axis; 360 or more (or -360 or less) is a full turn, and
        /// what is meant if it is not said.
        #[cfg_attr(feature = "serde", serde(default = "full_turn"))]
        degrees: f64,
    },
    /// The mesh's origin moved to each point.
    Points(Vec<[f64; 3]>),
    /// The mesh's origin moved along a broken line, in equal steps from its first point to its last.
    Along {
        /// The points of the line; a closed one ends where it begins.
        line: Vec<[f64; 3]>,
        /// How many copies.
        count: u32,
        /// Whether the mesh's x axis turns with the line (about z, for a line that climbs also up and down).
        #[cfg_attr(feature = "serde", serde(default))]
        turn: bool,
    },
}

#[cfg(feature = "serde")]
fn upwards() -> [f64; 3] {
    [0.0, 0.0, 1.0]
}

#[cfg(feature = "serde")]
fn full_turn() -> f64 {
    360.0
}

/// The most copies: what is more is a slip of the pen.
const MOST: u64 = 10_000_000;

/// One place: moved by an offset, after being turned about an axis through a point.
#[derive(Clone, Copy, Debug, Default)]
struct Place {
    by: [f64; 3],
    turns: [Option<Turn>; 2],
}

#[derive(Clone, Copy, Debug)]
struct Turn {
    axis: [f64; 3],
    center: [f64; 3],
    degrees: f64,
}

fn invalid<T>(what: impl Into<String>) -> Result<T, Error> {
    Err(Error::InvalidArgument(format!("pattern: {}", what.into())))
}

impl Pattern {
    /// How many copies it makes.
    #[must_use]
    pub fn count(&self) -> u64 {
        match self {
            Self::Linear { count, .. } | Self::Circular { count, .. } | Self::Along { count, .. } => {
                (*count).into()
            }
            Self::Grid { counts, .. } => {
                counts.iter().fold(1, |all, &count| u64::from(count).saturating_mul(all))
            }
            Self::Points(points) => points.len() as u64,
        }
    }

    /// How many bytes the positions and triangles of the copies take, so that a ceiling on memory
    /// ([`Control::reserve`](crate::Control::reserve)) stops them before they are made.
    #[must_use]
    pub fn memory(&self, mesh: &Mesh) -> u64 {
        let one = size_of_val(&*mesh.positions) + size_of_val(&*mesh.triangles);
        // (Absurd numbers are refused by `repeat`; they are not to overflow an account.)
        self.count().saturating_mul(one as u64).min(u64::MAX / 4)
    }

    /// The copies as one mesh, one after the other. They keep the groups and attributes of the mesh, as one and the same group;
    /// what they overlap is an operand that crosses itself, and resolved as such. Offsets are multiplied, not added up, so
    /// that copy n is off by one rounding and not by n. O(copies times size).
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] if there is no copy, or more than ten million; if a number is not finite, an axis has no direction, or a
    /// line no length. [`MeshError::TooLarge`] if there are more vertices than 32 bits can name, or there is no memory for them.
    pub fn repeat(&self, mesh: &Mesh) -> Result<Mesh, Error> {
        let count = self.count();
        if count == 0 || count > MOST {
            return invalid(format!("{count} copies; there must be at least one, and at most {MOST}"));
        }
        let (vertices, triangles) = (mesh.positions.len(), mesh.triangles.len());
        let times = |size: usize| (size as u64).saturating_mul(count);
        let too_large =
            MeshError::TooLarge { vertices: times(vertices) as usize, triangles: times(triangles) as usize };
        if times(vertices).max(times(3 * triangles)) > u64::from(u32::MAX) {
            return Err(too_large.into());
        }
        let places = self.places()?;
        let mut all = Copies::new(mesh, places.len()).map_err(|_| too_large)?;
        for place in places {
            all.add(place.apply(mesh)?);
        }
        Ok(all.mesh)
    }

    fn places(&self) -> Result<Vec<Place>, Error> {
        let finite = |values: &[f64]| match values.iter().find(|x| !x.is_finite()) {
            Some(x) => invalid(format!("a number is not finite: {x}")),
            None => Ok(()),
        };
        let moved = |by: [f64; 3]| Place { by, ..Place::default() };
        Ok(match self {
            Self::Linear { count, step } => {
                finite(step)?;
                (0..*count).map(|k| moved(step.map(|x| f64::from(k) * x))).collect()
            }
            Self::Grid { counts: [x, y, z], steps } => {
                finite(steps)?;
                let cells = (0..*z).flat_map(|k| (0..*y).flat_map(move |j| (0..*x).map(move |i| [i, j, k])));
                cells.map(|cell| moved([0, 1, 2].map(|axis| f64::from(cell[axis]) * steps[axis]))).collect()
            }
            Self::Circular { count, axis, center, degrees } => {
                finite(&[*axis, *center, [*degrees; 3]].concat())?;
                let parts = if degrees.abs() >= 360.0 { *count } else { (*count).max(2) - 1 };
                let whole = degrees.clamp(-360.0, 360.0);
                let turn = |k: u32| {
                    let degrees = whole * f64::from(k) / f64::from(parts);
                    Some(Turn { axis: *axis, center: *center, degrees })
                };
                (0..*count)
                    .map(|k| Place { by: [0.0; 3], turns: [turn(k).filter(|_| k > 0), None] })
                    .collect()
            }
            Self::Points(points) => {
                finite(points.as_flattened())?;
                points.iter().map(|&point| moved(point)).collect()
            }
            Self::Along { line, count, turn } => {
                finite(line.as_flattened())?;
                along(line, *count, *turn)?
            }
        })
    }
}

/// Places in equal steps along a broken line.
fn along(line: &[[f64; 3]], count: u32, turn: bool) -> Result<Vec<Place>, Error> {
    let between = |a: [f64; 3], b: [f64; 3]| [0, 1, 2].map(|k| b[k] - a[k]);
    // Segments without length have no direction.
    let mut line = line.to_vec();
    line.dedup();
    let lengths: Vec<f64> =
        line.windows(2).map(|ends| between(ends[0], ends[1])).map(|[x, y, z]| x.hypot(y).hypot(z)).collect();
    let whole: f64 = lengths.iter().sum();
    if !(whole > 0.0 && whole.is_finite()) {
        return invalid("the line has no length");
    }
    // A closed line's last place is its first.
    let is_closed = line.first() == line.last();
    let steps = if is_closed { count } else { count.max(2) - 1 };
    let (mut segment, mut before) = (0, 0.0);
    let mut places = Vec::new();
    for k in 0..count {
        let at = whole * f64::from(k) / f64::from(steps);
        while segment + 1 < lengths.len() && at > before + lengths[segment] {
            before += lengths[segment];
            segment += 1;
        }
        let t = ((at - before) / lengths[segment]).clamp(0.0, 1.0);
        let (a, b) = (line[segment], line[segment + 1]);
        let by = [0, 1, 2].map(|k| if t == 1.0 { b[k] } else { a[k] + t * (b[k] - a[k]) });
        let [x, y, z] = between(a, b);
        let about = |axis: [f64; 3], degrees: f64| {
            Some(Turn { axis, center: [0.0; 3], degrees }).filter(|turn| turn.degrees != 0.0)
        };
        let turns = [
            about([0.0, 1.0, 0.0], -z.atan2(x.hypot(y)).to_degrees()),
            about([0.0, 0.0, 1.0], y.atan2(x).to_degrees()),
        ];
        places.push(Place { by, turns: if turn { turns } else { [None; 2] } });
    }
    Ok(places)
}

impl Place {
    fn apply(&self, mesh: &Mesh) -> Result<Mesh, MeshError> {
        let mut mesh = mesh.clone();
        for Turn { axis, center, degrees } in self.turns.iter().flatten() {
            if *center != [0.0; 3] {
                mesh = mesh.translated(center.map(|x| -x));
            }
            mesh = mesh.rotated(*axis, *degrees)?;
            if *center != [0.0; 3] {
                mesh = mesh.translated(*center);
            }
        }
        Ok(if self.by == [0.0; 3] { mesh } else { mesh.translated(self.by) })
    }
}

/// Copies side by side, in the groups of the original.
struct Copies<'a> {
    original: &'a Mesh,
    mesh: Mesh,
}

impl<'a> Copies<'a> {
    fn new(original: &'a Mesh, count: usize) -> Result<Self, TryReserveError> {
        let mut mesh = Mesh::default();
        mesh.positions.try_reserve_exact(count * original.positions.len())?;
        mesh.triangles.try_reserve_exact(count * original.triangles.len())?;
        mesh.groups.list.clone_from(&original.groups.list);
        mesh.attributes.clone_from(&original.attributes);
        mesh.attributes.iter_mut().for_each(|attribute| attribute.of_corner.clear());
        Ok(Self { original, mesh })
    }

    fn add(&mut self, copy: Mesh) {
        let all = &mut self.mesh;
        let first = all.positions.len() as u32;
        all.positions.extend(copy.positions);
        all.triangles.extend(copy.triangles.iter().map(|triangle| triangle.map(|corner| corner + first)));
        all.groups.of_triangle.extend(copy.groups.of_triangle);
        for ((whole, copy), original) in
            all.attributes.iter_mut().zip(copy.attributes).zip(&self.original.attributes)
        {
            // Values that turning has not changed are shared.
            let offset = if copy.values == original.values {
                0
            } else {
                let offset = whole.len() as u32;
                whole.values.extend(copy.values);
                offset
            };
            let moved =
                |value: u32| if value == Attribute::NONE { value } else { value.saturating_add(offset) };
            whole.of_corner.extend(copy.of_corner.into_iter().map(moved));
        }
        let count = copy.triangles.len();
        all.polygons.append(all.triangles.len() - count, &copy.polygons, count);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::FaceGroup;
    use crate::{Solid, primitives};

    fn peg() -> Mesh {
        let mut mesh = primitives::cuboid([-0.25; 3], [0.25; 3]).unwrap();
        mesh.groups.list = vec![FaceGroup { name: "peg".into(), material: None }];
        mesh.groups.of_triangle = vec![0; 12];
        let normals = mesh.flat_normals();
        mesh.set_attribute(normals);
        mesh
    }

    #[test]
    fn copies_share_groups_and_values() {
        let pattern = Pattern::Grid { counts: [3, 4, 2], steps: [1.0, 2.0, 3.0] };
        let all = pattern.repeat(&peg()).unwrap();
        assert_eq!((pattern.count(), all.triangles.len()), (24, 24 * 12));
        assert_eq!((all.groups.list.len(), all.groups.of_triangle.len()), (1, 24 * 12));
        assert_eq!(all.attributes[0].values, peg().attributes[0].values);
        let solid = Solid::try_from(all).unwrap();
        assert_eq!((solid.components(), solid.volume()), (24, 3.0));
        assert_eq!(solid.bounds().unwrap().high, [2.25, 6.25, 3.25]);
    }

    #[test]
    fn full_turns_and_parts_of_one() {
        let at = peg().translated([2.0, 0.0, 0.0]);
        let circular =
            |count, degrees| Pattern::Circular { count, axis: [0.0, 0.0, 1.0], center: [0.0; 3], degrees };
        let whole = circular(4, 360.0).repeat(&at).unwrap();
        let bounds = whole.bounds().unwrap();
        assert_eq!((bounds.low, bounds.high), ([-2.25, -2.25, -0.25], [2.25, 2.25, 0.25]));
        let half = circular(3, 180.0).repeat(&at).unwrap().bounds().unwrap();
        assert_eq!((half.low, half.high), ([-2.25, -0.25, -0.25], [2.25, 2.25, 0.25]));
        // Normals turn with the copies.
        let normals = whole.attribute("NORMAL").unwrap();
        assert_eq!(normals.len(), 4 * peg().attribute("NORMAL").unwrap().len());
        let about =
            Pattern::Circular { count: 2, axis: [0.0, 0.0, 5.0], center: [2.0, 1.0, 0.0], degrees: 360.0 };
        assert_eq!(about.repeat(&at).unwrap().bounds().unwrap().high[1], 2.25);
    }

    #[test]
    fn along_lines_in_equal_steps() {
        let line = vec![[0.0; 3], [4.0, 0.0, 0.0], [4.0, 0.0, 0.0], [4.0, 4.0, 0.0]];
        let along = |count, turn| Pattern::Along { line: line.clone(), count, turn };
        let rod = primitives::cuboid([-0.5, -0.1, -0.1], [0.5, 0.1, 0.1]).unwrap();
        let middles = |mesh: &Mesh| -> Vec<[f64; 3]> {
            mesh.positions
                .chunks(8)
                .map(|copy| {
                    [0, 1, 2].map(|k| (copy.iter().map(|p| p[k]).sum::<f64>() / 8.0 * 64.0).round() / 64.0)
                })
                .collect()
        };
        let plain = along(5, false).repeat(&rod).unwrap();
        let wanted = [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [4.0, 0.0, 0.0], [4.0, 2.0, 0.0], [4.0, 4.0, 0.0]];
        assert_eq!(middles(&plain), wanted);
        let turned = along(5, true).repeat(&rod).unwrap();
        assert_eq!(middles(&turned), wanted);
        let last = Mesh::new(turned.positions[32..].to_vec(), rod.triangles.clone()).bounds().unwrap();
        assert!((last.size()[1] - 1.0).abs() < 1e-15, "the rod lies along y there: {last:?}");
        // A closed line has no place twice.
        let ring: Vec<[f64; 3]> =
            [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [0.0, 0.0]].map(|[x, y]| [x, y, 0.0]).to_vec();
        let closed = Pattern::Along { line: ring, count: 4, turn: false }.repeat(&rod).unwrap();
        assert_eq!(middles(&closed), [[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]]);
    }

    #[test]
    fn the_last_copy_turns_with_the_line_though_its_end_is_there_twice() {
        let rod = primitives::cuboid([-0.5, -0.1, -0.1], [0.5, 0.1, 0.1]).unwrap();
        for count in 2..100 {
            let line = vec![[0.0; 3], [0.0, 0.9, 0.0], [0.0, 0.9, 0.0]];
            let all = Pattern::Along { line, count, turn: true }.repeat(&rod).unwrap();
            let last = Mesh::new(all.positions[all.positions.len() - 8..].to_vec(), rod.triangles.clone());
            assert!((last.bounds().unwrap().size()[1] - 1.0).abs() < 1e-12, "{count} copies");
        }
    }

    #[test]
    fn senseless_patterns_are_refused() {
        let refused = |pattern: Pattern| pattern.repeat(&peg()).unwrap_err().to_string();
        assert!(refused(Pattern::Points(Vec::new())).contains("0 copies"));
        assert!(refused(Pattern::Linear { count: 0, step: [1.0; 3] }).contains("0 copies"));
        assert!(refused(Pattern::Grid { counts: [u32::MAX; 3], steps: [1.0; 3] }).contains("copies"));
        assert!(refused(Pattern::Linear { count: 2, step: [f64::NAN; 3] }).contains("finite"));
        assert!(
            refused(Pattern::Along { line: vec![[1.0; 3]; 3], count: 2, turn: true }).contains("no length")
        );
        assert!(refused(Pattern::Points(vec![[0.0; 3]; 10_000_001])).contains("10000001 copies"));
        let axis = Pattern::Circular { count: 3, axis: [0.0; 3], center: [0.0; 3], degrees: 360.0 };
        assert!(refused(axis).contains("axis"));
        assert_eq!(Pattern::Points(vec![[1.0; 3]]).repeat(&peg()).unwrap(), peg().translated([1.0; 3]));
    }
}
