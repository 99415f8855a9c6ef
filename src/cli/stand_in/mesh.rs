//! Measures, transforms and checks of meshes. `// replaced when mesh lands`: inherent methods of `Mesh`, `Solid`
//! and `Diagnosis`, `trisect::mesh::diagnose`, `Solid::try_from`.

use std::collections::HashMap;

use serde_json::{Value, json};
use trisect::mesh::Diagnosis;
use trisect::{Control, Error, Mesh, Solid};

pub(crate) trait MeshOperations: Sized {
    fn translated(self, offset: [f64; 3]) -> Mesh;
    fn rotated(self, axis: [f64; 3], degrees: f64) -> Result<Mesh, Error>;
    fn scaled(self, factors: [f64; 3]) -> Result<Mesh, Error>;
    fn transformed(self, matrix: &[f64]) -> Result<Mesh, Error>;
    fn oriented(self) -> Mesh;
    fn volume(&self) -> f64;
    fn area(&self) -> f64;
    fn bounds(&self) -> Option<Bounds>;
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct Bounds {
    pub(crate) low: [f64; 3],
    pub(crate) high: [f64; 3],
}

impl Bounds {
    pub(crate) fn size(&self) -> [f64; 3] {
        [0, 1, 2].map(|axis| self.high[axis] - self.low[axis])
    }
}

fn moved(mut mesh: Mesh, f: impl Fn([f64; 3]) -> [f64; 3], mirrored: bool) -> Mesh {
    mesh.positions.iter_mut().for_each(|p| *p = f(*p));
    if mirrored {
        mesh.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    }
    mesh
}

fn corners(mesh: &Mesh) -> impl Iterator<Item = [[f64; 3]; 3]> {
    mesh.triangles.iter().map(|t| t.map(|corner| mesh.positions[corner as usize]))
}

impl MeshOperations for Mesh {
    fn translated(self, offset: [f64; 3]) -> Mesh {
        moved(self, |p| std::array::from_fn(|k| p[k] + offset[k]), false)
    }

    /// About coordinate axes only.
    fn rotated(self, axis: [f64; 3], degrees: f64) -> Result<Mesh, Error> {
        let axis = axis.iter().position(|&x| x != 0.0).unwrap_or(2);
        let (sine, cosine) = match degrees.rem_euclid(360.0) {
            0.0 => (0.0, 1.0),
            90.0 => (1.0, 0.0),
            180.0 => (0.0, -1.0),
            270.0 => (-1.0, 0.0),
            other => other.to_radians().sin_cos(),
        };
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        let turn = |mut p: [f64; 3]| {
            (p[u], p[v]) = (cosine * p[u] - sine * p[v], sine * p[u] + cosine * p[v]);
            p
        };
        Ok(moved(self, turn, false))
    }

    fn scaled(self, by: [f64; 3]) -> Result<Mesh, Error> {
        Ok(moved(self, |p| std::array::from_fn(|k| p[k] * by[k]), by.iter().product::<f64>() < 0.0))
    }

    fn transformed(self, m: &[f64]) -> Result<Mesh, Error> {
        let row = |p: [f64; 3], k: usize| {
            m[4 * k] * p[0] + m[4 * k + 1] * p[1] + m[4 * k + 2] * p[2] + m[4 * k + 3]
        };
        let determinant = m[0] * (m[5] * m[10] - m[6] * m[9]) - m[1] * (m[4] * m[10] - m[6] * m[8])
            + m[2] * (m[4] * m[9] - m[5] * m[8]);
        Ok(moved(self, |p| std::array::from_fn(|k| row(p, k)), determinant < 0.0))
    }

    fn oriented(self) -> Mesh {
        let inwards = self.volume() < 0.0;
        moved(self, |p| p, inwards)
    }

    fn volume(&self) -> f64 {
        let six = |[a, b, c]: [[f64; 3]; 3]| {
            a[0] * (b[1] * c[2] - b[2] * c[1])
                + a[1] * (b[2] * c[0] - b[0] * c[2])
                + a[2] * (b[0] * c[1] - b[1] * c[0])
        };
        corners(self).map(six).sum::<f64>() / 6.0
    }

    fn area(&self) -> f64 {
        let doubled = |[a, b, c]: [[f64; 3]; 3]| {
            let edge = |to: [f64; 3]| -> [f64; 3] { std::array::from_fn(|axis| to[axis] - a[axis]) };
            let (u, v) = (edge(b), edge(c));
            let minor = |i: usize, j: usize| u[i] * v[j] - u[j] * v[i];
            minor(1, 2).hypot(minor(2, 0)).hypot(minor(0, 1))
        };
        corners(self).map(doubled).sum::<f64>() / 2.0
    }

    fn bounds(&self) -> Option<Bounds> {
        corners(self).flatten().fold(None, |bounds, p| {
            let Bounds { low, high } = bounds.unwrap_or(Bounds { low: p, high: p });
            Some(Bounds {
                low: std::array::from_fn(|axis| low[axis].min(p[axis])),
                high: std::array::from_fn(|axis| high[axis].max(p[axis])),
            })
        })
    }
}

pub(crate) trait DiagnosisJson {
    fn to_json(&self) -> Value;
}

impl DiagnosisJson for Diagnosis {
    fn to_json(&self) -> Value {
        json!({})
    }
}

pub(crate) fn diagnose(_: &Mesh) -> Diagnosis {
    Diagnosis::default()
}

/// `Solid::try_from`, but with the check that a solid is closed.
pub(crate) fn solid(mesh: Mesh) -> Result<Solid, Error> {
    let mut balance: HashMap<(u32, u32), i32> = HashMap::new();
    for [a, b, c] in &mesh.triangles {
        for (from, to) in [(a, b), (b, c), (c, a)] {
            *balance.entry((*from.min(to), *from.max(to))).or_default() += if from < to { 1 } else { -1 };
        }
    }
    if balance.values().any(|&sum| sum != 0) {
        return Err(Error::NotClosed(Box::default()));
    }
    if mesh.volume() < 0.0 {
        return Err(Error::InsideOut { volume: mesh.volume() });
    }
    Solid::try_from(mesh)
}

pub(crate) struct SelfCrossings;

impl SelfCrossings {
    pub(crate) fn tolerated(&self) -> usize {
        0
    }

    pub(crate) fn refusal(&self) -> Option<Error> {
        None
    }

    pub(crate) fn to_json(&self) -> Value {
        json!({ "deep": 0, "tolerated": self.tolerated() })
    }
}

#[derive(Clone, Copy, Default)]
pub(crate) struct Cleaning {
    pub(crate) repeated_corners: usize,
    pub(crate) opposite_pairs: usize,
    pub(crate) welded_vertices: usize,
    pub(crate) unreferenced_vertices: usize,
}

pub(crate) trait SolidMeasures {
    fn cleaning(&self) -> Cleaning;
    fn is_manifold(&self) -> bool;
    fn components(&self) -> usize;
    fn genus(&self) -> Option<usize>;
    fn self_crossings(&self, control: &Control) -> Result<&SelfCrossings, Error>;
}

impl SolidMeasures for Solid {
    fn cleaning(&self) -> Cleaning {
        Cleaning::default()
    }

    fn is_manifold(&self) -> bool {
        true
    }

    fn components(&self) -> usize {
        usize::from(!self.mesh().is_empty())
    }

    fn genus(&self) -> Option<usize> {
        Some(0)
    }

    fn self_crossings(&self, control: &Control) -> Result<&SelfCrossings, Error> {
        control.check()?;
        Ok(&SelfCrossings)
    }
}
