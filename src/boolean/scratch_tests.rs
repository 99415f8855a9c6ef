use super::*;
use crate::Mesh;
use std::collections::BTreeMap;

pub(crate) fn cube(lo: [f64; 3], hi: [f64; 3]) -> Mesh {
    let p = |i: usize| {
        [
            if i & 1 == 0 { lo[0] } else { hi[0] },
            if i & 2 == 0 { lo[1] } else { hi[1] },
            if i & 4 == 0 { lo[2] } else { hi[2] },
        ]
    };
    Mesh::new(
        (0..8).map(p).collect(),
        vec![
            [0, 2, 1],
            [1, 2, 3],
            [4, 5, 6],
            [5, 7, 6],
            [0, 1, 4],
            [1, 5, 4],
            [2, 6, 3],
            [3, 6, 7],
            [0, 4, 2],
            [2, 4, 6],
            [1, 3, 5],
            [3, 7, 5],
        ],
    )
}
pub(crate) fn sphere(n: u32, c: [f64; 3], turn: f64) -> Mesh {
    // uv sphere
    let m = 2 * n;
    let mut p = vec![[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]];
    let mut t = vec![];
    for i in 1..n {
        for j in 0..m {
            let a = std::f64::consts::PI * i as f64 / n as f64;
            let b = std::f64::consts::TAU * j as f64 / m as f64;
            p.push([a.sin() * b.cos(), a.sin() * b.sin(), a.cos()]);
        }
    }
    let id = |i: u32, j: u32| {
        if i == 0 {
            0
        } else if i == n {
            1
        } else {
            2 + (i - 1) * m + j % m
        }
    };
    for i in 0..n {
        for j in 0..m {
            let (a, b, c, d) = (id(i, j), id(i + 1, j), id(i + 1, j + 1), id(i, j + 1));
            if i + 1 < n {
                t.push([a, b, c]);
            }
            if i > 0 {
                t.push([a, c, d]);
            }
        }
    }
    let (s, k) = turn.sin_cos();
    for q in &mut p {
        *q = [q[0] * k - q[2] * s + c[0], q[1] + c[1], q[0] * s + q[2] * k + c[2]];
        let r = [q[0], q[1] * k - q[2] * s, q[1] * s + q[2] * k];
        *q = r;
    }
    Mesh::new(p, t)
}
pub(crate) fn volume(m: &Mesh) -> f64 {
    m.triangles
        .iter()
        .map(|t| {
            let [a, b, c] = t.map(|v| m.positions[v as usize]);
            (a[0] * (b[1] * c[2] - b[2] * c[1])
                + a[1] * (b[2] * c[0] - b[0] * c[2])
                + a[2] * (b[0] * c[1] - b[1] * c[0]))
                / 6.0
        })
        .sum()
}
pub(crate) fn state(m: &Mesh) -> (usize, usize, bool, bool, usize) {
    let mut e: BTreeMap<(u32, u32), (i32, i32)> = BTreeMap::new();
    let mut zero = 0;
    for t in &m.triangles {
        for k in 0..3 {
            let (u, v) = (t[k], t[(k + 1) % 3]);
            let x = e.entry((u.min(v), u.max(v))).or_default();
            if u < v { x.0 += 1 } else { x.1 += 1 }
        }
        let [a, b, c] = t.map(|v| m.positions[v as usize]);
        if crate::exact::collinear(&a, &b, &c) {
            zero += 1;
        }
    }
    (
        m.positions.len(),
        m.triangles.len(),
        e.values().all(|x| x.0 == x.1),
        e.values().all(|x| *x == (1, 1)),
        zero,
    )
}
pub(crate) fn run(op: Operation, a: &Mesh, b: &Mesh) -> Mesh {
    let s = |m: &Mesh| Solid::try_from(m.clone()).unwrap();
    boolean(op, &s(a), &s(b)).unwrap().into_solid().mesh().clone()
}

#[test]
fn table() {
    let c = |x: f64, y: f64, z: f64, s: f64| cube([x, y, z], [x + s, y + s, z + s]);
    let unit = c(0., 0., 0., 1.);
    let cases: Vec<(&str, Mesh, Mesh)> = vec![
        ("generic", unit.clone(), c(0.5, 0.4, 0.3, 1.)),
        ("face", unit.clone(), c(1., 0., 0., 1.)),
        ("partial face", unit.clone(), c(1., 0.25, 0.5, 1.)),
        ("inside flush", unit.clone(), cube([0.25, 0.25, 0.5], [0.75, 0.75, 1.0])),
        ("corner", unit.clone(), c(0., 0., 0., 0.5)),
        ("through", unit.clone(), cube([0.25, 0.25, 0.], [0.75, 0.75, 1.0])),
        ("half", unit.clone(), c(0.5, 0., 0., 1.)),
        ("identical", unit.clone(), unit.clone()),
        ("edge", unit.clone(), c(1., 1., 0., 1.)),
        ("vertex", unit.clone(), c(1., 1., 1., 1.)),
        ("nested", unit.clone(), c(0.25, 0.25, 0.25, 0.5)),
        ("disjoint", unit.clone(), c(3., 0., 0., 1.)),
        ("spheres", sphere(20, [0.; 3], 0.3), sphere(20, [0.5, 0.2, 0.1], 0.7)),
        ("same spheres", sphere(20, [0.; 3], 0.3), sphere(20, [0.; 3], 0.3)),
    ];
    for (n, a, b) in &cases {
        for op in
            [Operation::Union, Operation::Intersection, Operation::Difference, Operation::SymmetricDifference]
        {
            let r = run(op, a, b);
            println!("{n:14} {op:?} vol {:.6} v,t,closed,manifold,zero {:?}", volume(&r), state(&r));
        }
    }
}
#[test]
fn corner_case() {
    let r = run(Operation::Difference, &cube([0.; 3], [1.; 3]), &cube([0.; 3], [0.5; 3]));
    for t in &r.triangles {
        let [a, b, c] = t.map(|v| r.positions[v as usize]);
        println!("{t:?} {a:?} {b:?} {c:?} {}", crate::exact::collinear(&a, &b, &c));
    }
}
