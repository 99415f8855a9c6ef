//! What rounding to single precision does to a mesh: what the file holds against what was to be written.

use std::borrow::Cow;

use rustc_hash::FxHashMap;

use super::{Format, Precision, WriteOptions, unsupported};
use crate::exact::collinear;
use crate::mesh::star::mixed;
use crate::mesh::{BitSet, Bounds, enclosed_volume_within, is_closed, volume_change};
use crate::parallel::{self, read_ahead};
use crate::spatial::{Film, lost_films, radix_sort};
use crate::{Error, Mesh};

/// How far the volume of the file may be from that of the mesh, relative to it, without a warning. Rounding each coordinate
/// of a model at the origin changes its volume by some 1e-7 times its area and size over its volume: below this for walls
/// thicker than a hundredth of the model.
const VOLUME_TOLERANCE: f64 = 1e-5;
/// Where coordinates are larger than this many times the model, moving it to the origin makes steps finer that much.
const FAR: f64 = 2.0;
/// Where no more than one vertex of so many is moved, most of the surface is asked for nothing.
const FEW: usize = 16;
/// Bits for each vertex that was moved, to tell those that may lie where one of them does from most others.
const PLACES: usize = 64;
/// Triangles whose corners are read ahead.
const RUN: usize = 16;
/// Below this ratio of doubled area to the product of two sides, whether corners are on a line is decided exactly.
const THIN: f64 = 1e-9;

/// What became of a mesh that was written.
#[derive(Clone, Debug, Default)]
#[non_exhaustive]
pub struct Written {
    /// What the format could not keep, one sentence each; that of [`Rounding::warning`] is the last.
    pub warnings: Vec<String>,
    /// What rounding to single precision did; nothing where the file holds every coordinate exactly.
    pub rounding: Option<Rounding>,
}

/// What rounding to single precision did to a mesh.
///
/// A closed mesh stays closed: vertices that become equal leave no boundary. No part of the surface is moved by more than
/// half a step along each axis, so around every point farther from it than that the winding number is what it was. Crossings
/// that come are of that size, and [`Solid::self_crossings`](crate::Solid::self_crossings) tolerates them but where needles
/// turned over, or where the file has an offset, since its coordinates are then no numbers of single precision.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct Rounding {
    /// The distance of neighbouring numbers of single precision at the largest coordinate of the file.
    pub step: f64,
    /// The most that a coordinate was moved by.
    pub largest_shift: f64,
    /// Whether the surface in the file is closed: told by a sum of hashes of its edges, wrong by a chance of one in 2^64.
    pub closed: bool,
    /// The volume of the mesh; nothing if it is not closed.
    pub volume: Option<f64>,
    /// The volume of what the file holds.
    pub written_volume: Option<f64>,
    /// Triangles two of whose corners, different before, are equal.
    pub collapsed_triangles: usize,
    /// Triangles whose three corners are on a line now.
    pub flat_triangles: usize,
    /// Triangles whose normal points to the other side.
    pub turned_triangles: usize,
    /// Which are flat or turned over now, in order, by their numbers in the mesh that was written: where the surface in the file may cross itself
    /// ([`Solid::self_crossings_moved`](crate::Solid::self_crossings_moved)).
    #[cfg_attr(feature = "serde", serde(skip))]
    pub overturned: Vec<u32>,
    /// Vertices that are at the place of another one now.
    pub joined_vertices: usize,
    /// Pairs of triangles, back to back, between which there was material and is none now.
    pub lost_films: usize,
    /// Pairs of triangles, face to face, between which there was a gap and is none now.
    pub lost_gaps: usize,
    /// A film, else a gap, that was lost: its place.
    pub lost_place: Option<[f64; 3]>,
    /// How thick it was.
    pub lost_thickness: Option<f64>,
    /// Whether the file measures from an offset or in a unit of its own (glTF): then readers get coordinates that are no
    /// numbers of single precision, though they were rounded to it.
    pub has_offset: bool,
    /// Whether the steps would be finer with the model at the origin ([`Mesh::recentered`]).
    pub finer_at_origin: bool,
}

impl Rounding {
    /// Whether the file holds something else than the mesh is, and a warning is due: the volume differs in the first five
    /// digits, a triangle has lost a corner, vertices that were apart are not, a film or gap is closed.
    #[must_use]
    pub fn differs(&self) -> bool {
        let volume = self.changed_volume().is_some();
        volume || self.collapsed_triangles + self.joined_vertices + self.lost_films + self.lost_gaps > 0
    }

    /// The volume before and after, where they differ by more than is told without a warning.
    fn changed_volume(&self) -> Option<[f64; 2]> {
        let (volume, written) = (self.volume?, self.written_volume?);
        ((written - volume).abs() > VOLUME_TOLERANCE * volume.abs()).then_some([volume, written])
    }

    /// What is different in the file, in one sentence, and what to do; nothing unless it [`differs`](Self::differs).
    #[must_use]
    pub fn warning(&self, format: Format) -> Option<String> {
        let mut changes = Vec::new();
        if let Some([volume, written]) = self.changed_volume() {
            changes.push(format!("changes the volume from {volume} to {written}"));
        }
        if self.collapsed_triangles > 0 {
            changes.push(format!("makes two corners of {} triangles equal", self.collapsed_triangles));
        }
        if self.joined_vertices > 0 {
            let vertices = if self.joined_vertices == 1 { "vertex" } else { "vertices" };
            changes.push(format!("puts {} {vertices} onto others", self.joined_vertices));
        }
        if let (Some([x, y, z]), Some(thickness)) = (self.lost_place, self.lost_thickness) {
            let (what, count) =
                if self.lost_films > 0 { ("film", self.lost_films) } else { ("gap", self.lost_gaps) };
            changes.push(format!(
                "leaves nothing of a {what} {thickness:.1e} thick at ({x}, {y}, {z}) ({count} pairs of triangles in all)"
            ));
        }
        let last = changes.pop()?;
        let changes = if changes.is_empty() { last } else { format!("{} and {last}", changes.join(", ")) };
        Some(format!("rounding to single precision {changes}; {}", self.advice(format)))
    }

    fn advice(&self, format: Format) -> String {
        let keeps = match format {
            Format::Stl => "OBJ or PLY keep all digits",
            Format::Gltf | Format::Glb => "OBJ and PLY keep all digits",
            _ => "double precision keeps all digits",
        };
        match (self.finer_at_origin, format) {
            (false, _) => keeps.to_owned(),
            (true, Format::Gltf | Format::Glb) => format!("{keeps}, and so does a model moved to the origin"),
            (true, _) => format!("{keeps}, GLB an offset, and a model moved to the origin loses less"),
        }
    }
}

/// Where the coordinates of a file are measured from, and in which unit.
#[derive(Clone, Copy)]
pub(super) struct Measure {
    pub(super) offset: [f64; 3],
    /// A power of two.
    pub(super) scale: f64,
}

impl Measure {
    /// Coordinates as they are.
    pub(super) const PLAIN: Self = Self { offset: [0.0; 3], scale: 1.0 };

    fn is_plain(self) -> bool {
        self.offset == [0.0; 3] && self.scale == 1.0
    }
}

/// Refuses a mesh whose coordinates are beyond single precision, and says what rounding does to it.
pub(super) fn of_single(mesh: &Mesh, format: Format, options: &WriteOptions) -> Result<Written, Error> {
    let (mut largest, mut is_held) = (0.0_f64, true);
    for &x in mesh.positions.as_flattened() {
        largest = largest.max(x.abs());
        is_held &= f64::from(x as f32) == x;
    }
    if !(largest as f32).is_finite() {
        return Err(unsupported(
            format,
            format!(
                "coordinate {largest:e} is beyond single precision; write OBJ, PLY or OFF in double precision"
            ),
        ));
    }
    if is_held {
        return Ok(Written::default());
    }
    examined(mesh, format, Measure::PLAIN, options)
}

/// The same where single precision was asked for; nothing to say of double precision.
pub(super) fn of_precision(mesh: &Mesh, format: Format, options: &WriteOptions) -> Result<Written, Error> {
    match options.precision {
        Precision::Single => of_single(mesh, format, options),
        Precision::Double => Ok(Written::default()),
    }
}

/// Says what rounding does to a mesh whose coordinates single precision does not hold.
pub(super) fn examined(
    mesh: &Mesh,
    format: Format,
    measure: Measure,
    options: &WriteOptions,
) -> Result<Written, Error> {
    let rounding = Examination::new(mesh, measure, options)?.rounding(options)?;
    Ok(Written { warnings: rounding.warning(format).into_iter().collect(), rounding: Some(rounding) })
}

/// A mesh before and after rounding, in the unit of the file.
struct Examination<'a> {
    mesh: &'a Mesh,
    measure: Measure,
    before: Cow<'a, [[f64; 3]]>,
    after: Vec<[f64; 3]>,
    /// The vertices that are elsewhere after it.
    moved: BitSet,
    moved_count: usize,
    /// The largest absolute value of a coordinate after it.
    largest: f64,
    /// The most that a coordinate was moved by.
    largest_shift: f64,
}

/// A point in single precision.
#[inline]
fn rounded(point: &[f64; 3]) -> [f64; 3] {
    point.map(|x| f64::from(x as f32))
}

impl<'a> Examination<'a> {
    fn new(mesh: &'a Mesh, measure: Measure, options: &WriteOptions) -> Result<Self, Error> {
        let _reservation = options.control.reserve(48 * mesh.positions.len() as u64)?;
        let unit = measure.scale.recip();
        let local = |point: &[f64; 3]| [0, 1, 2].map(|k| (point[k] - measure.offset[k]) * unit);
        let before: Cow<'_, [[f64; 3]]> = if measure.is_plain() {
            (&*mesh.positions).into()
        } else {
            mesh.positions.iter().map(local).collect()
        };
        let mut after = Vec::with_capacity(before.len());
        let mut moved = BitSet::new(before.len());
        let (mut largest, mut largest_shift) = (0.0_f64, 0.0_f64);
        for (v, point) in (0..).zip(&*before) {
            let rounded = rounded(point);
            for k in 0..3 {
                largest = largest.max(rounded[k].abs());
                largest_shift = largest_shift.max((point[k] - rounded[k]).abs());
            }
            if rounded != *point {
                moved.insert(v);
            }
            after.push(rounded);
        }
        let moved_count = moved.count();
        Ok(Self { mesh, measure, before, after, moved, moved_count, largest, largest_shift })
    }

    /// Whether hardly a vertex was moved: what was read in single precision has new vertices only where it was cut.
    fn has_hardly_moved(&self) -> bool {
        FEW * self.moved_count <= self.before.len()
    }

    fn has_moved(&self, triangle: &[u32; 3]) -> bool {
        triangle.iter().any(|&v| self.moved.contains(v))
    }

    /// The distance of neighbouring numbers at the largest coordinate: each is moved by half of it at most.
    fn step(&self) -> f64 {
        f64::from((self.largest as f32).next_up()) - self.largest
    }

    fn rounding(&self, options: &WriteOptions) -> Result<Rounding, Error> {
        let Self { mesh, measure, before, after, moved, largest, largest_shift, .. } = self;
        let (scale, largest) = (measure.scale, *largest);
        let step = self.step();
        let bounds = Bounds::of_corners(before, &mesh.triangles);
        let size = bounds.map_or(0.0, |bounds| bounds.size().into_iter().fold(0.0, f64::max));
        // (What takes longest, beside all the rest.)
        let (films, (closed, volumes, lost, joined_vertices)) = parallel::join(
            mesh.triangles.len(),
            || lost_films(before, after, moved, &mesh.triangles, step, &options.control),
            || {
                let closed = is_closed(mesh);
                let volumes = closed.then(|| self.volumes(bounds));
                (closed, volumes, self.lost_triangles(), self.joined_vertices())
            },
        );
        options.control.check()?;
        let films = films?;
        let found: Option<Film> = films.first_film.or(films.first_gap);
        let ([collapsed_triangles, flat_triangles, turned_triangles], overturned) = lost;
        let told = |k: usize| volumes.map(|both| both[k]).filter(|volume: &f64| volume.is_finite());
        Ok(Rounding {
            step: step * scale,
            largest_shift: largest_shift * scale,
            closed,
            volume: told(0),
            written_volume: told(1),
            collapsed_triangles,
            flat_triangles,
            turned_triangles,
            overturned,
            joined_vertices,
            lost_films: films.films,
            lost_gaps: films.gaps,
            lost_place: found.map(|film| [0, 1, 2].map(|k| film.place[k] * scale + measure.offset[k])),
            lost_thickness: found.map(|film| film.thickness * scale),
            has_offset: !measure.is_plain(),
            finer_at_origin: largest > FAR * size,
        })
    }

    /// The volume before and after.
    fn volumes(&self, bounds: Option<Bounds>) -> [f64; 2] {
        let Self { mesh, measure, before, after, .. } = self;
        if !measure.is_plain() || !self.has_hardly_moved() {
            // (Numbers keep their order as they are rounded.)
            let held = bounds.map(|Bounds { low, high }| Bounds { low: rounded(&low), high: rounded(&high) });
            let scale = measure.scale;
            let written = enclosed_volume_within(after, &mesh.triangles, held) * scale * scale * scale;
            let volume = match measure.is_plain() {
                true => enclosed_volume_within(before, &mesh.triangles, bounds),
                false => mesh.volume(),
            };
            return [volume, written];
        }
        let volume = enclosed_volume_within(before, &mesh.triangles, bounds);
        let changed: Vec<[u32; 3]> =
            mesh.triangles.iter().copied().filter(|triangle| self.has_moved(triangle)).collect();
        let change = bounds.map_or(0.0, |bounds| volume_change(before, after, &changed, &bounds));
        [volume, volume + change]
    }

    /// How many triangles lose a corner, lose their area, and turn over; and which do one of the latter.
    fn lost_triangles(&self) -> ([usize; 3], Vec<u32>) {
        let (triangles, step) = (&self.mesh.triangles, self.step());
        let count = triangles.len();
        let ranges = parallel::ranges(count, parallel::piece_count(count, 1 << 16));
        let lost = parallel::map(ranges, |range| {
            let mut lost = Vec::new();
            for (first, run) in range.clone().step_by(RUN).zip(triangles[range].chunks(RUN)) {
                if !self.has_hardly_moved() {
                    read_ahead(run.iter().flatten().map(|&v| self.before[v as usize][0].to_bits() as u32));
                }
                for (t, triangle) in (first as u32..).zip(run) {
                    lost.extend(self.loss(triangle, step).map(|kind| (t, kind)));
                }
            }
            lost
        })
        .concat();
        let mut counts = [0; 3];
        lost.iter().for_each(|&(_, kind)| counts[kind] += 1);
        (counts, lost.into_iter().filter(|&(_, kind)| kind > 0).map(|(t, _)| t).collect())
    }

    /// What a triangle loses, if anything: 0 a corner, 1 its area, 2 its side.
    fn loss(&self, triangle: &[u32; 3], step: f64) -> Option<usize> {
        if !self.has_moved(triangle) {
            return None;
        }
        // 1. Nearly all are too wide for it: two sides u and v change by no more than a step along each axis, so that their product n changes by 2 step
        //    (u + v + step) along each axis at most, less than 3.5 of it in length. If n is longer, it goes on pointing to its side.
        let [p, q, r] = triangle.map(|v| self.before[v as usize]);
        let between = |a: [f64; 3], b: [f64; 3]| [0, 1, 2].map(|k| b[k] - a[k]);
        let longest = |x: [f64; 3]| x[0].abs().max(x[1].abs()).max(x[2].abs());
        let spanned = |a: [f64; 3], b: [f64; 3], c: [f64; 3]| {
            let (u, v) = (between(a, b), between(a, c));
            let normal = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
            (normal, longest(u), longest(v))
        };
        let (old, u, v) = spanned(p, q, r);
        if longest(old) > 4.0 * step * (u + v + step) {
            return None;
        }
        // 2. The others before and after.
        let [a, b, c] = [p, q, r].map(|point| rounded(&point));
        if a == b || b == c || c == a {
            return ((a == b && p != q) || (b == c && q != r) || (c == a && r != p)).then_some(0);
        }
        let (normal, u, v) = spanned(a, b, c);
        if longest(normal) <= THIN * u * v && collinear(&a, &b, &c) {
            return (!collinear(&p, &q, &r)).then_some(1);
        }
        (normal[0] * old[0] + normal[1] * old[1] + normal[2] * old[2] < 0.0).then_some(2)
    }

    /// How many vertices come to lie at the place of one that was elsewhere.
    fn joined_vertices(&self) -> usize {
        let Self { before, after, moved, .. } = self;
        let key = |v: u32| after[v as usize].map(|x| (x as f32 + 0.0).to_bits());
        // 1. Those that are not alone at theirs, and a few of which a hash cannot tell.
        let hash = |v: u32| {
            let [x, y, z] = key(v).map(u64::from);
            mixed(mixed(x | y << 32) ^ z)
        };
        let vertices = 0..after.len() as u32;
        let together: Vec<u32> = if self.has_hardly_moved() {
            // Where hardly one was moved: those whose hash is that of one of these.
            let size = (PLACES * self.moved_count).next_power_of_two();
            let place = |v: u32| hash(v) as u32 & (size - 1) as u32;
            let mut taken = BitSet::new(size);
            moved.iter().for_each(|v| taken.insert(place(v)));
            vertices.filter(|&v| taken.contains(place(v))).collect()
        } else {
            // Sorted, equal hashes are side by side.
            let mut hashes: Vec<u64> =
                vertices.map(|v| hash(v) & !u64::from(u32::MAX) | u64::from(v)).collect();
            radix_sort(&mut hashes, &mut Vec::new(), |hash| (hash >> 32) as u32, u32::BITS);
            let groups = hashes.chunk_by(|x, y| x >> 32 == y >> 32).filter(|group| group.len() > 1);
            let mut together: Vec<u32> = groups.flatten().map(|&hash| hash as u32).collect();
            together.sort_unstable();
            together
        };
        // 2. The first that has come to each place.
        let mut first: FxHashMap<[u32; 3], u32> = FxHashMap::default();
        for &v in together.iter().filter(|&&v| moved.contains(v)) {
            first.entry(key(v)).or_insert(v);
        }
        let is_joined =
            |v: &&u32| first.get(&key(**v)).is_some_and(|&w| before[w as usize] != before[**v as usize]);
        together.iter().filter(is_joined).count()
    }
}

#[cfg(test)]
mod tests {
    use rand::rngs::ChaCha8Rng;
    use rand::{RngExt, SeedableRng};

    use super::*;

    /// What a triangle loses, by its corners before and after alone.
    fn plain_loss(before: [[f64; 3]; 3], after: [[f64; 3]; 3]) -> Option<usize> {
        let ([p, q, r], [a, b, c]) = (before, after);
        if a == b || b == c || c == a {
            return ((a == b && p != q) || (b == c && q != r) || (c == a && r != p)).then_some(0);
        }
        let normal = |a: [f64; 3], b: [f64; 3], c: [f64; 3]| {
            let [u, v] = [b, c].map(|end| glam::DVec3::from_array(end) - glam::DVec3::from_array(a));
            u.cross(v)
        };
        if collinear(&a, &b, &c) {
            return (!collinear(&p, &q, &r)).then_some(1);
        }
        (normal(p, q, r).dot(normal(a, b, c)) < 0.0).then_some(2)
    }

    #[test]
    fn short_cuts_count_what_all_are_asked_for() {
        let mut random = ChaCha8Rng::seed_from_u64(37);
        let mut sums = [[0; 4]; 2];
        for round in 0..120 {
            // Points a few steps of single precision apart, along a line, on a plane and in space; and some that it holds.
            let spread = [1e-7, 1e-6, 1e-3][round % 3];
            let mut coordinate = |k: usize| match random.random_range(0..4) {
                _ if k > round / 3 % 3 => -0.0,
                0 => f64::from((spread * random.random_range(-1.0..1.0)) as f32),
                _ => 1.0 + spread * random.random_range(-1.0..1.0),
            };
            let mut positions: Vec<[f64; 3]> = (0..900).map(|_| [0, 1, 2].map(&mut coordinate)).collect();
            // Of every other surface hardly a vertex is moved.
            let is_few = round >= 60;
            if is_few {
                (0..900).filter(|v| v % 30 > 0).for_each(|v| positions[v] = rounded(&positions[v]));
            }
            let triangles: Vec<[u32; 3]> =
                (0..2_000).map(|_| [0; 3].map(|_| random.random_range(0..850))).collect();
            let mesh = Mesh::new(positions.clone(), triangles.clone());
            let seen = Examination::new(&mesh, Measure::PLAIN, &WriteOptions::new()).unwrap();
            assert_eq!(seen.has_hardly_moved(), is_few || seen.moved_count == 0, "round {round}");
            let after: Vec<[f64; 3]> = positions.iter().map(rounded).collect();
            let mut lost = [0; 3];
            for corners in &triangles {
                let [before, after] = [&positions, &after].map(|of| corners.map(|v| of[v as usize]));
                plain_loss(before, after).into_iter().for_each(|kind| lost[kind] += 1);
            }
            assert_eq!(seen.lost_triangles().0, lost, "round {round}");
            let joins =
                |v: usize| (0..positions.len()).find(|&w| positions[w] != after[w] && after[w] == after[v]);
            let joined =
                (0..positions.len()).filter(|&v| joins(v).is_some_and(|w| positions[w] != positions[v]));
            let joined = joined.count();
            assert_eq!(seen.joined_vertices(), joined, "round {round}");
            let sums = &mut sums[usize::from(is_few)];
            (0..3).for_each(|kind| sums[kind] += lost[kind]);
            sums[3] += joined;
        }
        assert!(sums[0].iter().all(|&sum| sum > 100) && sums[1].iter().all(|&sum| sum > 50), "{sums:?}");
    }

    #[test]
    fn a_volume_is_told_by_what_was_moved_alone() {
        for every in [1, 40] {
            let mut ball = crate::primitives::icosphere(1.0, 4).unwrap().translated([3.0, -2.0, 5.0]);
            for (v, position) in ball.positions.iter_mut().enumerate() {
                *position = if v % every == 0 { position.map(|x| x + 1e-9) } else { rounded(position) };
            }
            let of = |mesh: &Mesh| examined(mesh, Format::Stl, Measure::PLAIN, &WriteOptions::new());
            let rounding = of(&ball).unwrap().rounding.unwrap();
            assert_eq!(rounding.volume, Some(ball.volume()));
            let mut written = ball.clone();
            written.positions.iter_mut().for_each(|position| *position = rounded(position));
            let (told, right) = (rounding.written_volume.unwrap(), written.volume());
            assert!((told - right).abs() < 1e-15 * right, "{told} {right}");
            assert!((right - ball.volume()).abs() > 1e-10, "{right}");
        }
    }
}
