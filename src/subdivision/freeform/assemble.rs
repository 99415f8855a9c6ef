//! The result's cage: what is kept of the operands' cages in its order, then what is new.

use glam::DVec3;
use rustc_hash::{FxHashMap, FxHashSet};

use super::VertexOrigin;
use super::curve::Chain;
use super::operand::Operand;
use super::work::{Sharp, Work, key};
use crate::Error;
use crate::subdivision::control_mesh::ControlMesh;
use crate::subdivision::tags::{Corner, Crease, Sector, Tags};

/// The result's cage before the fit.
pub(super) struct Draft {
    pub(super) cage: ControlMesh,
    /// For each vertex where it comes from.
    pub(super) origins: Vec<VertexOrigin>,
    /// For each face its operand.
    pub(super) operand_of: Vec<u16>,
    /// For each face one of its operand's fine triangles near it.
    pub(super) seeds: Vec<u32>,
    /// For each face the operand and its control face that it is.
    pub(super) sources: Vec<Option<(usize, u32)>>,
    /// For each face whether it is one.
    pub(super) whole: Vec<bool>,
    /// For each vertex whether it is new, or its faces are not all the old ones.
    pub(super) changed: Vec<bool>,
    /// For each vertex where it is on the exact result.
    pub(super) targets: Vec<DVec3>,
    /// For each vertex on the curve its chain and length.
    pub(super) on_curve: Vec<Option<(u32, f64)>>,
    /// Vertices that must be met: ends and turns of curves, corners.
    pub(super) fixed: Vec<bool>,
    /// Tagged edges, ends in order.
    pub(super) sharp: FxHashMap<(u32, u32), Sharp>,
}

impl Draft {
    /// The draft after one subdivision: for details. Every face is one of the band, every new vertex new.
    pub(super) fn refined(&self, chains: &[Chain]) -> Result<Self, Error> {
        let level = self.cage.level();
        let cage = self.cage.subdivided(1)?;
        let before = level.vertex_count as u32;
        let count = cage.positions().len();
        let mut sharp = FxHashMap::default();
        let mut on_curve = self.on_curve.clone();
        on_curve.resize(count, None);
        for (e, &h) in level.edges.iter().enumerate() {
            let (u, v, middle) = (level.from(h), level.to(h), before + e as u32);
            let Some(&tag) = self.sharp.get(&key(u, v)) else { continue };
            sharp.insert(key(u, middle), tag);
            sharp.insert(key(middle, v), tag);
            if let Sharp::Curve(c) = tag {
                let x = DVec3::from(cage.positions()[middle as usize]);
                let near = chains[c as usize].nearest(x, 0.0, f64::INFINITY);
                on_curve[middle as usize] = Some((c, near.length));
            }
        }
        let resized = |of: &[bool]| -> Vec<bool> {
            of.iter().copied().chain((of.len()..count).map(|_| false)).collect()
        };
        let four = |of: &[bool]| -> Vec<bool> { of.iter().flat_map(|&value| [value; 4]).collect() };
        Ok(Self {
            origins: Vec::new(),
            operand_of: self.operand_of.iter().flat_map(|&o| [o; 4]).collect(),
            seeds: self.seeds.iter().flat_map(|&seed| [seed; 4]).collect(),
            sources: vec![None; cage.faces().len()],
            whole: four(&self.whole),
            changed: vec![false; count],
            targets: self
                .targets
                .iter()
                .copied()
                .chain((self.targets.len()..count).map(|_| DVec3::ZERO))
                .collect(),
            on_curve,
            fixed: resized(&self.fixed),
            sharp,
            cage,
        })
    }
}

/// A face with its lowest corner first.
fn turned(face: [u32; 3]) -> [u32; 3] {
    let k = (0..3).min_by_key(|&k| face[k]).unwrap_or(0);
    [face[k], face[(k + 1) % 3], face[(k + 2) % 3]]
}

/// Puts the cage together.
pub(super) fn assemble(work: &Work, operands: &[Operand], reversed: &[bool]) -> Result<Draft, Error> {
    // 1. Faces: whole ones by their number in the operand, with its corners, then the others.
    let faces = ordered_faces(work, operands, reversed);
    // 2. Vertices: control vertices of the operands one after the other, then new ones.
    let mut used: Vec<u32> = faces.iter().flat_map(|&(_, _, corners)| corners).collect();
    used.sort_unstable();
    used.dedup();
    used.sort_by_key(|&v| (work.vertices[v as usize].control.unwrap_or((u16::MAX, v)), v));
    let numbers: FxHashMap<u32, u32> = used.iter().enumerate().map(|(i, &v)| (v, i as u32)).collect();
    let corners: Vec<[u32; 3]> = faces.iter().map(|&(_, _, corners)| corners.map(|v| numbers[&v])).collect();
    let sources: Vec<_> = faces.iter().map(|&(o, f, _)| (o != REST).then_some((o, f))).collect();
    let whole: Vec<bool> = sources.iter().map(Option::is_some).collect();
    let operand_of = faces
        .iter()
        .map(|&(o, f, _)| if o == REST { work.faces[f as usize].operand } else { o as u16 })
        .collect();

    let seeds = faces
        .iter()
        .map(|&(o, f, _)| match o {
            REST => work.faces[f as usize].seed,
            o => operands[o].fine.first[f as usize],
        })
        .collect();
    let origins: Vec<VertexOrigin> = used
        .iter()
        .map(|&v| match work.vertices[v as usize].control {
            Some((operand, vertex)) => VertexOrigin::Kept { operand: usize::from(operand), vertex },
            None => VertexOrigin::New,
        })
        .collect();
    let changed = changed(operands, &origins, &corners, &whole);
    let targets: Vec<DVec3> = used.iter().map(|&v| work.position(v)).collect();
    let positions: Vec<[f64; 3]> = origins
        .iter()
        .zip(&targets)
        .map(|(origin, target)| match *origin {
            VertexOrigin::Kept { operand, vertex } | VertexOrigin::Fitted { operand, vertex } => {
                operands[operand].cage.positions()[vertex as usize]
            }
            VertexOrigin::New => target.to_array(),
        })
        .collect();
    // 3. Tags.
    let mut sharp = FxHashMap::default();
    for (&(u, v), &tag) in &work.sharp {
        if let (Some(&u), Some(&v)) = (numbers.get(&u), numbers.get(&v)) {
            sharp.insert(key(u, v), tag);
        }
    }
    let fixed: Vec<bool> = used.iter().map(|&v| work.vertices[v as usize].fixed).collect();
    let tags = tags(operands, reversed, &origins, &fixed, &sharp, &corners);
    let rules = operands[0].cage.rules();
    let cage = ControlMesh::new(positions, corners, tags, rules)?;
    let on_curve = used.iter().map(|&v| work.vertices[v as usize].on_curve).collect();
    Ok(Draft { cage, origins, operand_of, seeds, sources, whole, changed, targets, on_curve, fixed, sharp })
}

/// Stands for the operand of faces that are none of its control faces.
const REST: usize = usize::MAX;

/// The faces in the result's order: operand and control face, or [`REST`] and the number in the working mesh; and the corners.
fn ordered_faces(work: &Work, operands: &[Operand], reversed: &[bool]) -> Vec<(usize, u32, [u32; 3])> {
    let mut faces: Vec<(usize, u32, [u32; 3])> = Vec::new();
    let known = operands.iter().map(|operand| {
        let all = operand.cage.faces().iter().enumerate();
        all.map(|(f, &corners)| (turned(corners), f as u32)).collect()
    });
    let known: Vec<FxHashMap<[u32; 3], u32>> = known.collect();
    for (i, face) in work.faces.iter().enumerate().filter(|(_, face)| face.alive) {
        let o = usize::from(face.operand);
        let mut corners = face.corners;
        if reversed[o] {
            corners.swap(1, 2);
        }
        let control = corners.map(|v| match work.vertices[v as usize].control {
            Some((owner, w)) if usize::from(owner) == o => w,
            _ => u32::MAX,
        });
        match known[o].get(&turned(control)).filter(|_| !control.contains(&u32::MAX)) {
            Some(&f) => {
                let original = operands[o].cage.faces()[f as usize];
                let mut own = original.map(|w| corners[control.iter().position(|&c| c == w).unwrap_or(0)]);
                if reversed[o] {
                    own.swap(1, 2);
                }
                faces.push((o, f, own));
            }
            None => faces.push((REST, i as u32, face.corners)),
        }
    }
    faces.sort_by_key(|&(o, f, _)| (o, f));
    faces
}

/// Which vertices are new, or have other faces than before.
fn changed(operands: &[Operand], origins: &[VertexOrigin], faces: &[[u32; 3]], whole: &[bool]) -> Vec<bool> {
    let mut count = vec![0usize; origins.len()];
    let mut changed = vec![false; origins.len()];
    for (corners, &whole) in faces.iter().zip(whole) {
        for &v in corners {
            count[v as usize] += 1;
            changed[v as usize] |= !whole;
        }
    }
    for (v, origin) in origins.iter().enumerate() {
        changed[v] |= match *origin {
            VertexOrigin::Kept { operand, vertex } | VertexOrigin::Fitted { operand, vertex } => {
                operands[operand].surface.level.ring(vertex).face_count() != count[v]
            }
            VertexOrigin::New => true,
        };
    }
    changed
}

fn tags(
    operands: &[Operand],
    reversed: &[bool],
    origins: &[VertexOrigin],
    fixed: &[bool],
    sharp: &FxHashMap<(u32, u32), Sharp>,
    faces: &[[u32; 3]],
) -> Tags {
    let mut tags = Tags::default();
    let mut degree = vec![0usize; origins.len()];
    let infinite = f64::INFINITY;
    for &(u, v) in sharp.keys() {
        tags.creases.push(Crease { edge: [u, v], sharpness: infinite });
        degree[u as usize] += 1;
        degree[v as usize] += 1;
    }
    let mut number: Vec<FxHashMap<u32, u32>> = vec![FxHashMap::default(); operands.len()];
    for (v, origin) in origins.iter().enumerate() {
        let kept_corner = match *origin {
            VertexOrigin::Kept { operand, vertex } | VertexOrigin::Fitted { operand, vertex } => {
                number[operand].insert(vertex, v as u32);
                operands[operand].cage.tags().corners.iter().any(|corner| corner.vertex == vertex)
            }
            VertexOrigin::New => false,
        };
        // Where a curve turns there are two creases only: the turn has to be said.
        if kept_corner || (fixed[v] && degree[v] == 2) {
            tags.corners.push(Corner { vertex: v as u32, sharpness: infinite });
        }
    }
    // Concave sectors of corners that are still there, with the crease they begin with. Turned over, a sector begins with
    // the crease it ended with; what is not found is seen from the faces again.
    let edges: FxHashSet<(u32, u32)> =
        faces.iter().flat_map(|f| [key(f[0], f[1]), key(f[1], f[2]), key(f[2], f[0])]).collect();
    for o in 0..operands.len() {
        if reversed[o] {
            continue;
        }
        for sector in &operands[o].cage.tags().sectors {
            if let (Some(&vertex), Some(&first)) =
                (number[o].get(&sector.vertex), number[o].get(&sector.first))
                && edges.contains(&key(vertex, first))
            {
                tags.sectors.push(Sector { vertex, first, ..*sector });
            }
        }
    }
    tags
}
