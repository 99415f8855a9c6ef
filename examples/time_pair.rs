//! Times one pair.
use std::collections::HashMap;
use std::time::Instant;
use trisect::*;
fn ico(sub: u32) -> Mesh {
    let p = (1.0 + 5f64.sqrt()) / 2.0;
    let mut v: Vec<[f64; 3]> = vec![
        [-1., p, 0.],
        [1., p, 0.],
        [-1., -p, 0.],
        [1., -p, 0.],
        [0., -1., p],
        [0., 1., p],
        [0., -1., -p],
        [0., 1., -p],
        [p, 0., -1.],
        [p, 0., 1.],
        [-p, 0., -1.],
        [-p, 0., 1.],
    ];
    let mut f: Vec<[u32; 3]> = vec![
        [0, 11, 5],
        [0, 5, 1],
        [0, 1, 7],
        [0, 7, 10],
        [0, 10, 11],
        [1, 5, 9],
        [5, 11, 4],
        [11, 10, 2],
        [10, 7, 6],
        [7, 1, 8],
        [3, 9, 4],
        [3, 4, 2],
        [3, 2, 6],
        [3, 6, 8],
        [3, 8, 9],
        [4, 9, 5],
        [2, 4, 11],
        [6, 2, 10],
        [8, 6, 7],
        [9, 8, 1],
    ];
    let norm = |q: [f64; 3]| {
        let l = (q[0] * q[0] + q[1] * q[1] + q[2] * q[2]).sqrt();
        [q[0] / l, q[1] / l, q[2] / l]
    };
    v.iter_mut().for_each(|q| *q = norm(*q));
    for _ in 0..sub {
        let mut m: HashMap<(u32, u32), u32> = HashMap::new();
        let mut g = vec![];
        for t in &f {
            let mut mid = |a: u32, b: u32| {
                *m.entry((a.min(b), a.max(b))).or_insert_with(|| {
                    let (x, y) = (v[a as usize], v[b as usize]);
                    v.push(norm([x[0] + y[0], x[1] + y[1], x[2] + y[2]]));
                    v.len() as u32 - 1
                })
            };
            let (a, b, c) = (mid(t[0], t[1]), mid(t[1], t[2]), mid(t[2], t[0]));
            g.extend([[t[0], a, c], [t[1], b, a], [t[2], c, b], [a, b, c]]);
        }
        f = g;
    }
    Mesh::new(v, f)
}
fn rot(m: &Mesh, ang: f64, ax: [f64; 3], t: [f64; 3], s: f64) -> Mesh {
    let l = (ax[0] * ax[0] + ax[1] * ax[1] + ax[2] * ax[2]).sqrt();
    let [x, y, z] = [ax[0] / l, ax[1] / l, ax[2] / l];
    let (sn, c) = ang.sin_cos();
    let k = 1. - c;
    let r = [
        [c + x * x * k, x * y * k - z * sn, x * z * k + y * sn],
        [y * x * k + z * sn, c + y * y * k, y * z * k - x * sn],
        [z * x * k - y * sn, z * y * k + x * sn, c + z * z * k],
    ];
    let p = m
        .positions
        .iter()
        .map(|q| {
            let q = [q[0] * s, q[1] * s, q[2] * s];
            std::array::from_fn(|i| r[i][0] * q[0] + r[i][1] * q[1] + r[i][2] * q[2] + t[i])
        })
        .collect();
    Mesh::new(p, m.triangles.clone())
}
fn bumpy(sub: u32, ph: [f64; 3]) -> Mesh {
    let mut m = ico(sub);
    for v in &mut m.positions {
        let r =
            1. + 0.02 * (40. * v[0] + ph[0]).sin() * (40. * v[1] + ph[1]).sin() * (40. * v[2] + ph[2]).sin();
        *v = [v[0] * r, v[1] * r, v[2] * r];
    }
    m
}
fn main() {
    let which = std::env::args().nth(1).unwrap_or("a7".into());
    let threads: usize = std::env::args().nth(2).and_then(|x| x.parse().ok()).unwrap_or(1);
    let (a, b, op) = match which.as_str() {
        "b" => (
            rot(&ico(8), 3f64.sqrt(), [3., -1., 2.], [0.; 3], 1.),
            rot(&ico(4), 2f64.sqrt(), [1., 2., 3.], [1.0, 0.013, -0.007], 0.05),
            Operation::Difference,
        ),
        "c" => (
            bumpy(7, [0.1, 0.7, 1.9]),
            rot(&bumpy(7, [1.3, 2.1, 0.4]), 0.3 * 2f64.sqrt(), [1., 2., 3.], [0.; 3], 1.),
            Operation::Union,
        ),
        s => {
            let m = ico(s[1..].parse().unwrap());
            (
                rot(&m, 3f64.sqrt(), [3., -1., 2.], [0.; 3], 1.),
                rot(&m, 2f64.sqrt(), [1., 2., 3.], [0.5, 0.013, -0.007], 1.),
                Operation::Union,
            )
        }
    };
    let (a, b) = (Solid::try_from(a).unwrap(), Solid::try_from(b).unwrap());
    for _ in 0..7 {
        let t = Instant::now();
        let o = if threads == 1 {
            Options::new().threads(1).run(op, &[&a, &b]).unwrap()
        } else {
            boolean(op, &a, &b).unwrap()
        };
        println!("{:.1} ms  {} triangles", t.elapsed().as_secs_f64() * 1e3, o.solid().mesh().triangles.len());
    }
}
