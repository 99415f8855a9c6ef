//! What the faces show that a tool has cut: its own material and attributes, the body's, or something new.

use std::collections::BTreeMap;

use rustc_hash::FxHashMap;

use crate::mesh::{
    Attribute, AttributeKind, FaceGroup, FaceGroups, Mesh, UnionFind, area_vector, cross, unit,
};

/// What the cut faces of a result show: those that come from a tool and face the other way now, as the wall of a hole does.
/// The default is what the tool has there, its material and its attributes.
///
/// ```
/// use trisect::{BooleanOptions, CutFaces, FaceGroup, Material, Operation, Solid, primitives};
///
/// let block = Solid::try_from(primitives::cuboid([0.0; 3], [1.0; 3])?)?;
/// let ball = Solid::try_from(primitives::icosphere(0.5, 3)?.translated([1.0; 3]))?;
/// let steel = FaceGroup { name: "cut".into(), material: Some(Material::plain("steel", [0.6, 0.6, 0.65, 1.0])) };
/// let options = BooleanOptions::new().cut_faces(CutFaces::group(steel).boxed(4.0));
/// let cut = options.run(Operation::Difference, [&block, &ball])?;
/// let mesh = cut.solid().mesh();
/// assert_eq!(mesh.groups.list.last().map(|group| group.name.as_str()), Some("cut"));
/// assert!(mesh.attribute("TEXCOORD_0").is_some());
/// # Ok::<(), trisect::Error>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct CutFaces {
    material: CutMaterial,
    texture: Option<CutTexture>,
}

#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
enum CutMaterial {
    #[default]
    Tool,
    Body,
    Group(FaceGroup),
}

/// How texture coordinates are laid on cut faces, and how many units of them are in a unit of length.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
enum CutTexture {
    Planar(f64),
    Boxed(f64),
}

impl CutFaces {
    /// The tool's own material and attributes.
    #[must_use]
    pub fn tool() -> Self {
        Self::default()
    }

    /// The group of the body around: of each piece of cut surface that of the faces with the longest border to it. Normals are
    /// flat; of other attributes they have none, but texture coordinates if they are laid.
    #[must_use]
    pub fn body() -> Self {
        Self { material: CutMaterial::Body, texture: None }
    }

    /// A group of their own, or one that the operands have. Attributes as with [`body`](Self::body).
    #[must_use]
    pub fn group(group: FaceGroup) -> Self {
        Self { material: CutMaterial::Group(group), texture: None }
    }

    /// Lays texture coordinates (`TEXCOORD_0`) along the plane of each piece of cut surface, its mean one, with `per_unit` of
    /// them to a unit of length.
    #[must_use]
    pub fn planar(mut self, per_unit: f64) -> Self {
        self.texture = Some(CutTexture::Planar(per_unit));
        self
    }

    /// The same from the six sides of a box along the axes: each triangle from the one it faces most.
    #[must_use]
    pub fn boxed(mut self, per_unit: f64) -> Self {
        self.texture = Some(CutTexture::Boxed(per_unit));
        self
    }

    /// What is wrong with the numbers, if anything.
    pub(crate) fn fault(&self) -> Option<f64> {
        let (CutTexture::Planar(per_unit) | CutTexture::Boxed(per_unit)) = self.texture?;
        (!(per_unit.is_finite() && per_unit > 0.0)).then_some(per_unit)
    }

    /// Whether there is anything to do.
    pub(crate) fn are_the_tools(&self) -> bool {
        self.material == CutMaterial::Tool && self.texture.is_none()
    }

    /// Gives the faces that close a cut at a plane what they are to show: as [`apply`](Self::apply), but where that is what the
    /// tool has, they keep their group. Normals are flat in any case, and only the mesh's own attributes are given. O(n).
    pub(crate) fn apply_to_cap(&self, mesh: &mut Mesh, cap: &[bool]) {
        if !cap.contains(&true) {
            return;
        }
        if self.material == CutMaterial::Tool {
            strip(mesh, cap);
        }
        self.apply(mesh, cap);
    }

    /// Gives the cut faces of a result what they are to show; `cut` tells for each triangle whether it is one. O(n).
    pub(crate) fn apply(&self, mesh: &mut Mesh, cut: &[bool]) {
        if !cut.contains(&true) {
            return;
        }
        let pieces = Pieces::new(mesh, cut);
        match &self.material {
            CutMaterial::Tool => {}
            CutMaterial::Body => pieces.take_groups_around(mesh),
            CutMaterial::Group(group) => put_in_group(&mut mesh.groups, group, cut),
        }
        if self.material != CutMaterial::Tool {
            strip(mesh, cut);
        }
        if let Some(texture) = self.texture {
            lay(mesh, cut, &pieces, texture);
        }
    }
}

/// The pieces that the cut faces make, connected by edges.
struct Pieces {
    /// For each triangle its piece; [`NONE`](Self::NONE) if it is no cut face.
    of_triangle: Vec<u32>,
    count: usize,
    /// Edges between a piece and another face: the piece, the triangle beyond, and the length.
    borders: Vec<(u32, u32, f64)>,
}

impl Pieces {
    const NONE: u32 = u32::MAX;

    fn new(mesh: &Mesh, cut: &[bool]) -> Self {
        let numbers: Vec<u32> = (0..).zip(cut).filter(|(_, cut)| **cut).map(|(t, _)| t).collect();
        let mut place = vec![Self::NONE; cut.len()];
        (0..).zip(&numbers).for_each(|(i, &t)| place[t as usize] = i);
        // 1. The edges of cut faces.
        let mut open: FxHashMap<(u32, u32), u32> = FxHashMap::default();
        let mut together = UnionFind::new(numbers.len());
        for (i, &t) in (0..).zip(&numbers) {
            let corners = mesh.triangles[t as usize];
            for k in 0..3 {
                let (u, v) = (corners[k], corners[(k + 1) % 3]);
                match open.remove(&(v, u)) {
                    Some(other) => together.join(i, other),
                    None => {
                        open.insert((u, v), i);
                    }
                }
            }
        }
        let (count, labels) = together.labels();
        // 2. What lies beyond those that are left.
        let mut borders = Vec::new();
        for (t, corners) in (0..).zip(&mesh.triangles).filter(|&(t, _)| !cut[t as usize]) {
            for k in 0..3 {
                let (u, v) = (corners[k], corners[(k + 1) % 3]);
                if let Some(&i) = open.get(&(v, u)) {
                    let [p, q] = [u, v].map(|v| mesh.positions[v as usize]);
                    let length = (0..3).fold(0.0f64, |length, k| length.hypot(q[k] - p[k]));
                    borders.push((labels[i as usize], t, length));
                }
            }
        }
        let of_triangle = place.iter().map(|&i| if i == Self::NONE { i } else { labels[i as usize] });
        Self { of_triangle: of_triangle.collect(), count, borders }
    }

    /// Puts each piece into the group with the longest border to it; one without any border (the wall of a cavity) into the one
    /// with the longest border to all pieces, or the first.
    fn take_groups_around(&self, mesh: &mut Mesh) {
        if mesh.groups.is_empty() {
            return;
        }
        let groups = mesh.groups.list.len();
        let mut lengths = vec![0.0; groups];
        let mut of_piece: Vec<BTreeMap<u32, f64>> = vec![BTreeMap::new(); self.count];
        for &(piece, t, length) in &self.borders {
            let group = mesh.groups.of_triangle[t as usize];
            lengths[group as usize] += length;
            *of_piece[piece as usize].entry(group).or_default() += length;
        }
        let overall = longest((0..).zip(lengths)).unwrap_or(0);
        let of_lengths = |lengths: BTreeMap<u32, f64>| longest(lengths).unwrap_or(overall);
        let chosen: Vec<u32> = of_piece.into_iter().map(of_lengths).collect();
        for (group, &piece) in mesh.groups.of_triangle.iter_mut().zip(&self.of_triangle) {
            if piece != Self::NONE {
                *group = chosen[piece as usize];
            }
        }
    }
}

/// Of groups with lengths, ascending, the first with the greatest length.
fn longest(lengths: impl IntoIterator<Item = (u32, f64)>) -> Option<u32> {
    let longer = |best: (u32, f64), next: (u32, f64)| if best.1 >= next.1 { best } else { next };
    lengths.into_iter().reduce(longer).map(|(group, _)| group)
}

fn put_in_group(groups: &mut FaceGroups, group: &FaceGroup, cut: &[bool]) {
    if groups.is_empty() {
        groups.list = vec![FaceGroup::default()];
        groups.of_triangle = vec![0; cut.len()];
    }
    let known = groups.list.iter().position(|other| other == group);
    let number = known.unwrap_or(groups.list.len());
    if known.is_none() {
        groups.list.push(group.clone());
    }
    groups.of_triangle.iter_mut().zip(cut).filter(|(_, cut)| **cut).for_each(|(of, _)| *of = number as u32);
}

/// Takes the tool's attributes off the cut faces; normals become flat.
fn strip(mesh: &mut Mesh, cut: &[bool]) {
    let Mesh { positions, triangles, attributes, .. } = mesh;
    for attribute in attributes {
        let is_normal = attribute.kind() == AttributeKind::Normal;
        for (t, corners) in attribute.of_corner.chunks_exact_mut(3).enumerate().filter(|&(t, _)| cut[t]) {
            corners.fill(Attribute::NONE);
            if is_normal {
                corners.fill((attribute.values.len() / 3) as u32);
                attribute.values.extend(unit(area_vector(positions, &triangles[t])));
            }
        }
    }
}

/// Lays texture coordinates on the cut faces.
fn lay(mesh: &mut Mesh, cut: &[bool], pieces: &Pieces, texture: CutTexture) {
    // 1. The two directions along which each triangle is measured.
    let means = match texture {
        CutTexture::Planar(_) => mean_normals(mesh, pieces),
        CutTexture::Boxed(_) => Vec::new(),
    };
    let name = "TEXCOORD_0";
    if mesh.attribute(name).is_none() {
        let of_corner = vec![Attribute::NONE; 3 * mesh.triangles.len()];
        mesh.attributes.push(Attribute { of_corner, ..Attribute::new(name, 2) });
    }
    let Some(place) = mesh.attributes.iter().position(|attribute| attribute.name == name) else { return };
    let mut uv = std::mem::take(&mut mesh.attributes[place]);
    // 2. Corners of one piece at one vertex, measured alike, share a value.
    let mut known: FxHashMap<(u32, [u64; 2]), u32> = FxHashMap::default();
    for (t, triangle) in mesh.triangles.iter().enumerate().filter(|&(t, _)| cut[t]) {
        let (normal, per_unit) = match texture {
            CutTexture::Planar(per_unit) => (means[pieces.of_triangle[t] as usize], per_unit),
            CutTexture::Boxed(per_unit) => {
                let own = unit(area_vector(&mesh.positions, triangle));
                let most = (1..3).fold(0, |most, k| if own[k].abs() > own[most].abs() { k } else { most });
                let mut axis = [0.0; 3];
                axis[most] = 1.0f64.copysign(own[most]);
                (axis, per_unit)
            }
        };
        let [along, across] = directions(normal);
        for (k, &vertex) in triangle.iter().enumerate() {
            let p = mesh.positions[vertex as usize];
            let measured = [along, across]
                .map(|direction| per_unit * (direction[0] * p[0] + direction[1] * p[1] + direction[2] * p[2]))
                .map(|x| x.clamp(f64::MIN, f64::MAX));
            let next = uv.len() as u32;
            let number = *known.entry((vertex, measured.map(f64::to_bits))).or_insert(next);
            if number == next {
                uv.values.extend(measured);
            }
            uv.of_corner[3 * t + k] = number;
        }
    }
    mesh.attributes[place] = uv;
}

/// The mean normal of each piece, by area.
fn mean_normals(mesh: &Mesh, pieces: &Pieces) -> Vec<[f64; 3]> {
    let mut sums = vec![[0.0; 3]; pieces.count];
    for (triangle, &piece) in mesh.triangles.iter().zip(&pieces.of_triangle) {
        if piece == Pieces::NONE {
            continue;
        }
        let area = area_vector(&mesh.positions, triangle);
        (0..3).for_each(|k| sums[piece as usize][k] += area[k]);
    }
    sums.into_iter().map(|sum| unit_or(sum, [0.0, 0.0, 1.0])).collect()
}

/// Two directions in the plane of a normal, to the right and upwards as it is seen from outside.
fn directions(normal: [f64; 3]) -> [[f64; 3]; 2] {
    // Upwards is z, or y where that is looked along.
    let up = if normal[2].abs() > 0.9 { [0.0, 1.0, 0.0] } else { [0.0, 0.0, 1.0] };
    let along = unit_or(cross(up, normal), [1.0, 0.0, 0.0]);
    [along, cross(normal, along)]
}

/// The direction of a vector with length 1, or another if it has none.
fn unit_or(v: [f64; 3], other: [f64; 3]) -> [f64; 3] {
    let direction = unit(v);
    if direction == [0.0; 3] { other } else { direction }
}
