//! What rounding to single precision does to a mesh: what the file holds against what was to be written.

use rustc_hash::FxHashMap;

use super::{Format, Precision, WriteOptions, unsupported};
use crate::exact::collinear;
use crate::mesh::{enclosed_volume, is_closed};
use crate::parallel;
use crate::spatial::{Film, lost_films};
use crate::{Error, Mesh};

/// How far the volume of the file may be from that of the mesh, relative to it, without a warning. Rounding each coordinate
/// of a model at the origin changes its volume by some 1e-7 times its area and size over its volume: below this for walls
/// thicker than a hundredth of the model.
const VOLUME_TOLERANCE: f64 = 1e-5;
/// Where coordinates are larger than this many times the model, moving it to the origin makes steps finer that much.
const FAR: f64 = 2.0;
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
    /// Whether the surface in the file is closed.
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
}

/// Refuses a mesh whose coordinates are beyond single precision, and says what rounding does to it.
pub(super) fn of_single(mesh: &Mesh, format: Format, options: &WriteOptions) -> Result<Written, Error> {
    let largest = mesh.positions.as_flattened().iter().fold(0.0_f64, |size, x| size.max(x.abs()));
    if !(largest as f32).is_finite() {
        return Err(unsupported(
            format,
            format!(
                "coordinate {largest:e} is beyond single precision; write OBJ, PLY or OFF in double precision"
            ),
        ));
    }
    if mesh.positions.as_flattened().iter().all(|&x| f64::from(x as f32) == x) {
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
    before: Vec<[f64; 3]>,
    after: Vec<[f64; 3]>,
}

impl<'a> Examination<'a> {
    fn new(mesh: &'a Mesh, measure: Measure, options: &WriteOptions) -> Result<Self, Error> {
        let _reservation = options.control.reserve(48 * mesh.positions.len() as u64)?;
        let unit = measure.scale.recip();
        let local = |point: &[f64; 3]| [0, 1, 2].map(|k| (point[k] - measure.offset[k]) * unit);
        let before: Vec<[f64; 3]> = mesh.positions.iter().map(local).collect();
        let after = before.iter().map(|point| point.map(|x| f64::from(x as f32))).collect();
        Ok(Self { mesh, measure, before, after })
    }

    fn rounding(&self, options: &WriteOptions) -> Result<Rounding, Error> {
        let Self { mesh, measure, before, after } = self;
        let scale = measure.scale;
        let largest = after.as_flattened().iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        let step = f64::from((largest as f32).next_up()) - largest;
        let shifts = before.as_flattened().iter().zip(after.as_flattened()).map(|(x, y)| (x - y).abs());
        let largest_shift = shifts.fold(0.0, f64::max);
        let bounds = mesh.bounds();
        let size = bounds.map_or(0.0, |bounds| bounds.size().into_iter().fold(0.0, f64::max)) / scale;
        let closed = is_closed(mesh);
        options.control.check()?;
        let films = lost_films(before, after, &mesh.triangles, step, &options.control)?;
        let found: Option<Film> = films.first_film.or(films.first_gap);
        let [collapsed_triangles, flat_triangles, turned_triangles] = self.lost_triangles();
        let written_volume = || enclosed_volume(after, &mesh.triangles) * scale * scale * scale;
        Ok(Rounding {
            step: step * scale,
            largest_shift: largest_shift * scale,
            closed,
            volume: closed.then(|| mesh.volume()).filter(|volume| volume.is_finite()),
            written_volume: closed.then(written_volume).filter(|volume| volume.is_finite()),
            collapsed_triangles,
            flat_triangles,
            turned_triangles,
            joined_vertices: self.joined_vertices(),
            lost_films: films.films,
            lost_gaps: films.gaps,
            lost_place: found.map(|film| [0, 1, 2].map(|k| film.place[k] * scale + measure.offset[k])),
            lost_thickness: found.map(|film| film.thickness * scale),
            has_offset: measure.offset != [0.0; 3] || scale != 1.0,
            finer_at_origin: largest > FAR * size,
        })
    }

    /// How many triangles lose a corner, lose their area, and turn over.
    fn lost_triangles(&self) -> [usize; 3] {
        let triangles = &self.mesh.triangles;
        let count = triangles.len();
        let ranges = parallel::ranges(count, parallel::piece_count(count, 1 << 16));
        let parts = parallel::map(ranges, |range| {
            let mut counts = [0; 3];
            for triangle in &triangles[range] {
                if let Some(kind) = self.loss(triangle) {
                    counts[kind] += 1;
                }
            }
            counts
        });
        parts.into_iter().fold([0; 3], |sum, part| [0, 1, 2].map(|k| sum[k] + part[k]))
    }

    /// What a triangle loses, if anything: 0 a corner, 1 its area, 2 its side.
    fn loss(&self, triangle: &[u32; 3]) -> Option<usize> {
        let [a, b, c] = triangle.map(|v| self.after[v as usize]);
        let [p, q, r] = triangle.map(|v| self.before[v as usize]);
        if a == b || b == c || c == a {
            return ((a == b && p != q) || (b == c && q != r) || (c == a && r != p)).then_some(0);
        }
        let spanned = |a: [f64; 3], b: [f64; 3], c: [f64; 3]| {
            let (u, v) = ([0, 1, 2].map(|k| b[k] - a[k]), [0, 1, 2].map(|k| c[k] - a[k]));
            let normal = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
            let length = |x: [f64; 3]| x.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
            (normal, length(normal), length(u) * length(v))
        };
        let (normal, area, sides) = spanned(a, b, c);
        if area <= THIN * sides && collinear(&a, &b, &c) {
            return (!collinear(&p, &q, &r)).then_some(1);
        }
        let (old, ..) = spanned(p, q, r);
        (normal[0] * old[0] + normal[1] * old[1] + normal[2] * old[2] < 0.0).then_some(2)
    }

    /// How many vertices come to lie at the place of one that was elsewhere.
    fn joined_vertices(&self) -> usize {
        let Self { before, after, .. } = self;
        let key = |v: usize| after[v].map(|x| (x as f32 + 0.0).to_bits());
        let mut first: FxHashMap<[u32; 3], u32> = FxHashMap::default();
        for v in (0..after.len()).filter(|&v| before[v] != after[v]) {
            first.entry(key(v)).or_insert(v as u32);
        }
        let joins = |v: &usize| first.get(&key(*v)).is_some_and(|&w| before[w as usize] != before[*v]);
        (0..after.len()).filter(joins).count()
    }
}
