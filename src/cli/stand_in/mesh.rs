//! Measures, transforms and checks of meshes. `// replaced when mesh lands`: inherent methods of `Mesh`, `Solid`
//! and `Diagnosis`.

use std::collections::HashMap;

use serde_json::{Value, json};
use trisect::mesh::Diagnosis;
use trisect::{Control, Error, Mesh, Solid};

pub(crate) trait MeshOperations {
    fn translated(&self, by: [f64; 3]) -> Mesh;
    fn rotated(&self, degrees: [f64; 3]) -> Mesh;
    fn scaled(&self, by: [f64; 3]) -> Mesh;
    fn transformed(&self, rows: [[f64; 4]; 4]) -> Mesh;
    fn oriented(&self) -> Mesh;
    fn diagnose(&self) -> Diagnosis;
}

fn moved(mesh: &Mesh, f: impl Fn([f64; 3]) -> [f64; 3], mirrored: bool) -> Mesh {
    let mut mesh = mesh.clone();
    mesh.positions.iter_mut().for_each(|p| *p = f(*p));
    if mirrored {
        mesh.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    }
    mesh
}

impl MeshOperations for Mesh {
    fn translated(&self, by: [f64; 3]) -> Mesh {
        moved(self, |p| std::array::from_fn(|k| p[k] + by[k]), false)
    }

    fn rotated(&self, degrees: [f64; 3]) -> Mesh {
        (0..3).fold(self.clone(), |mesh, axis| {
            let (sine, cosine) = match degrees[axis].rem_euclid(360.0) {
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
            moved(&mesh, turn, false)
        })
    }

    fn scaled(&self, by: [f64; 3]) -> Mesh {
        moved(self, |p| std::array::from_fn(|k| p[k] * by[k]), by.iter().product::<f64>() < 0.0)
    }

    fn transformed(&self, rows: [[f64; 4]; 4]) -> Mesh {
        let row =
            |p: [f64; 3], k: usize| rows[k][0] * p[0] + rows[k][1] * p[1] + rows[k][2] * p[2] + rows[k][3];
        let [a, b, c, _] = rows;
        let determinant = a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0])
            + a[2] * (b[0] * c[1] - b[1] * c[0]);
        moved(self, |p| std::array::from_fn(|k| row(p, k)), determinant < 0.0)
    }

    fn oriented(&self) -> Mesh {
        let mut mesh = self.clone();
        if volume(&mesh) < 0.0 {
            mesh.triangles.iter_mut().for_each(|t| t.swap(1, 2));
        }
        mesh
    }

    fn diagnose(&self) -> Diagnosis {
        Diagnosis::default()
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

pub(crate) fn volume(mesh: &Mesh) -> f64 {
    let p = |corner: u32| mesh.positions[corner as usize];
    let six = |[a, b, c]: [[f64; 3]; 3]| {
        a[0] * (b[1] * c[2] - b[2] * c[1])
            + a[1] * (b[2] * c[0] - b[0] * c[2])
            + a[2] * (b[0] * c[1] - b[1] * c[0])
    };
    mesh.triangles.iter().map(|t| six(t.map(p))).sum::<f64>() / 6.0
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
    if volume(&mesh) < 0.0 {
        return Err(Error::InsideOut { volume: volume(&mesh) });
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

pub(crate) trait SolidMeasures {
    fn is_manifold(&self) -> bool;
    fn components(&self) -> usize;
    fn genus(&self) -> i64;
    fn self_crossings(&self, control: &Control) -> Result<&SelfCrossings, Error>;
}

impl SolidMeasures for Solid {
    fn is_manifold(&self) -> bool {
        true
    }

    fn components(&self) -> usize {
        usize::from(!self.mesh().is_empty())
    }

    fn genus(&self) -> i64 {
        0
    }

    fn self_crossings(&self, control: &Control) -> Result<&SelfCrossings, Error> {
        control.check()?;
        Ok(&SelfCrossings)
    }
}
