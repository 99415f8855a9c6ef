//! Surfaces of the same formulas by trisect and by the mesher of `fidget` (Manifold Dual Contouring), measured alike.
//!
//! `cargo run --release -- PATH/TO/trisect` prints a row for each: triangles, the largest deviation as a part of the tolerance, the
//! degrees that 95 of 100 facets are within of the gradient, facets turned against it, and seconds. fidget takes a depth of its
//! octree in place of a tolerance: all from 4 to 8 are rows. `-- PATH/TO/trisect bracket` is one formula.

use std::path::Path;
use std::process::Command;
use std::time::Instant;

use fidget::context::Tree;
use fidget::jit::JitShape;
use fidget::mesh::{Octree, Settings};

/// Half the side of the box.
const HALF: f64 = 1.2;
/// The least depth tried, and the largest: at 9 a gyroid takes gigabytes.
const DEPTHS: std::ops::RangeInclusive<u8> = 4..=8;

/// The formulas, positive inside, of numbers and of fidget's trees.
macro_rules! formulas {
    ($module:ident, $t:ty) => {
        mod $module {
            #[allow(unused_imports, reason = "numbers need none")]
            use super::Tree;

            fn c(value: f64) -> $t {
                // (fidget's are single; the difference is a hundred millionth.)
                <$t>::from(value as f32)
            }

            fn square(x: $t) -> $t {
                x.clone() * x
            }

            fn length(x: $t, y: $t) -> $t {
                (square(x) + square(y)).sqrt()
            }

            fn ball(x: $t, y: $t, z: $t) -> $t {
                c(1.0) - square(x) - square(y) - square(z)
            }

            pub fn value(name: &str, x: $t, y: $t, z: $t) -> $t {
                match name {
                    "sphere" => ball(x - c(0.1), y, z),
                    "torus" => c(0.0625) - square(length(x, y) - c(0.8)) - square(z),
                    "gyroid in a ball" => {
                        let wave = |a: &$t, b: &$t| (a.clone() * c(6.0)).sin() * (b.clone() * c(6.0)).cos();
                        (wave(&x, &y) + wave(&y, &z) + wave(&z, &x)).min(ball(x, y, z))
                    }
                    _ => {
                        let plate = (c(1.0) - x.clone().abs())
                            .min(c(0.6) - y.clone().abs())
                            .min(c(0.15) - (z.clone() + c(0.6)).abs());
                        let boss = (c(0.4) - length(x.clone(), y.clone())).min(c(0.7) - z.abs());
                        plate
                            .max(boss)
                            .min(length(x.clone(), y.clone()) - c(0.25))
                            .min(length(x - c(0.75), y) - c(0.12))
                    }
                }
            }
        }
    };
}

formulas!(numbers, f64);
formulas!(trees, Tree);

/// The same as trisect reads them.
const TEXTS: [(&str, &str); 4] = [
    ("sphere", "sphere(x - 0.1, y, z, 1)"),
    ("torus", "torus(x, y, z, 0.8, 0.25)"),
    (
        "gyroid in a ball",
        "min(sin(6*x)*cos(6*y) + sin(6*y)*cos(6*z) + sin(6*z)*cos(6*x), sphere(x, y, z, 1))",
    ),
    (
        "bracket",
        "min(max(min(1 - abs(x), 0.6 - abs(y), 0.15 - abs(z + 0.6)), min(0.4 - length(x, y), 0.7 - abs(z))), \
         length(x, y) - 0.25, length(x - 0.75, y) - 0.12)",
    ),
];

struct Surface {
    vertices: Vec<[f64; 3]>,
    triangles: Vec<[usize; 3]>,
    seconds: f64,
}

fn main() {
    let program = std::env::args().nth(1).expect("the path of trisect");
    // The default tolerance of models: a thousandth of the diagonal.
    let tolerance = 2e-3 * HALF * 3f64.sqrt();
    println!(
        "formula | by | triangles | deviation / tolerance | normals 95% | turned | least angle 5% | seconds"
    );
    let only = std::env::args().nth(2);
    for (name, text) in TEXTS.into_iter().filter(|(name, _)| only.as_ref().is_none_or(|only| only == name)) {
        row(name, "trisect", &by_trisect(Path::new(&program), text, tolerance), tolerance);
        for depth in DEPTHS {
            row(name, &format!("fidget, depth {depth}"), &by_fidget(name, depth), tolerance);
        }
    }
}

/// By the program, through files; the time is the program's own, from the model to the mesh.
fn by_trisect(program: &Path, text: &str, tolerance: f64) -> Surface {
    let folder = std::env::temp_dir().join(format!("dual-contouring-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder");
    let (model, mesh) = (folder.join("model.json"), folder.join("mesh.off"));
    let (low, high) = (format!("[-{HALF}, -{HALF}, -{HALF}]"), format!("[{HALF}, {HALF}, {HALF}]"));
    let content = format!(r#"{{"kind": "formula", "formula": "{text}", "bounds": [{low}, {high}]}}"#);
    std::fs::write(&model, content).expect("written");
    let ran = Command::new(program)
        .args(["eval", "--json", "--tolerance", &tolerance.to_string()])
        .arg(&model)
        .arg("-o")
        .arg(&mesh)
        .output()
        .expect("trisect runs");
    let report = String::from_utf8_lossy(&ran.stdout).into_owned();
    assert!(ran.status.success(), "{report}");
    let seconds = report.split("\"run\":").nth(1).and_then(|rest| rest.split([',', '}']).next());
    let seconds = seconds.and_then(|text| text.trim().parse().ok()).expect("a time");
    let surface = read_off(&std::fs::read_to_string(&mesh).expect("a mesh"), seconds);
    std::fs::remove_dir_all(&folder).expect("the folder goes");
    surface
}

fn read_off(text: &str, seconds: f64) -> Surface {
    let mut words = text.split_whitespace().skip(1);
    let mut count = || words.next().and_then(|word| word.parse::<usize>().ok()).expect("a count");
    let (vertices, triangles, _) = (count(), count(), count());
    let mut number = || words.next().and_then(|word| word.parse::<f64>().ok()).expect("a number");
    let vertices = (0..vertices).map(|_| [number(), number(), number()]).collect();
    let corner = |[_, a, b, c]: [f64; 4]| [a as usize, b as usize, c as usize];
    let triangles = (0..triangles).map(|_| corner([number(), number(), number(), number()])).collect();
    Surface { vertices, triangles, seconds }
}

/// By fidget's compiled functions on all threads, the best of three.
fn by_fidget(name: &str, depth: u8) -> Surface {
    let scaled = |axis: Tree| axis * (HALF as f32);
    // (It is negative inside.)
    let tree = -trees::value(name, scaled(Tree::x()), scaled(Tree::y()), scaled(Tree::z()));
    let mut best: Option<Surface> = None;
    for _ in 0..3 {
        let start = Instant::now();
        let shape = JitShape::from(tree.clone());
        let shape = shape.try_into().expect("no variables but x, y, z");
        let settings = Settings { depth, ..Default::default() };
        let mesh = Octree::build(&shape, &settings).expect("not cancelled").walk_dual();
        let seconds = start.elapsed().as_secs_f64();
        if best.as_ref().is_none_or(|best| seconds < best.seconds) {
            best = Some(Surface {
                vertices: mesh
                    .vertices
                    .iter()
                    .map(|v| [v.x, v.y, v.z].map(|x| f64::from(x) * HALF))
                    .collect(),
                triangles: mesh.triangles.iter().map(|t| [t[0], t[1], t[2]]).collect(),
                seconds,
            });
        }
    }
    best.expect("three")
}

fn row(name: &str, by: &str, surface: &Surface, tolerance: f64) {
    let (mut deviation, mut turns, mut angles) = (0f64, Vec::new(), Vec::new());
    for triangle in &surface.triangles {
        let p = triangle.map(|k| surface.vertices[k]);
        let at = |weights: [f64; 3]| {
            std::array::from_fn(|axis| (0..3).map(|k| weights[k] * p[k][axis]).sum::<f64>())
        };
        let third = 1.0 / 3.0;
        // Where the library measures: the middle and six places more.
        for weights in [
            [third; 3],
            [0.5, 0.5, 0.0],
            [0.0, 0.5, 0.5],
            [0.5, 0.0, 0.5],
            [0.6, 0.2, 0.2],
            [0.2, 0.6, 0.2],
            [0.2, 0.2, 0.6],
        ] {
            let point: [f64; 3] = at(weights);
            let gradient = gradient(name, point);
            deviation =
                deviation.max(numbers::value(name, point[0], point[1], point[2]).abs() / norm(gradient));
        }
        let normal = cross(minus(p[1], p[0]), minus(p[2], p[0]));
        turns.push(between(normal, gradient(name, at([third; 3])).map(|x| -x)));
        let corner = |k: usize| between(minus(p[(k + 1) % 3], p[k]), minus(p[(k + 2) % 3], p[k]));
        angles.push((0..3).map(corner).fold(180.0, f64::min));
    }
    turns.sort_by(f64::total_cmp);
    angles.sort_by(f64::total_cmp);
    let last = turns.len() - 1;
    println!(
        "{name} | {by} | {} | {:.2} | {:.1} | {} | {:.0} | {:.3}",
        surface.triangles.len(),
        deviation / tolerance,
        turns[last * 95 / 100],
        turns.iter().filter(|turn| **turn > 90.0).count(),
        angles[last * 5 / 100],
        surface.seconds,
    );
}

/// By central differences.
fn gradient(name: &str, point: [f64; 3]) -> [f64; 3] {
    const STEP: f64 = 1e-6;
    std::array::from_fn(|axis| {
        let at = |step: f64| {
            let mut moved = point;
            moved[axis] += step;
            numbers::value(name, moved[0], moved[1], moved[2])
        };
        (at(STEP) - at(-STEP)) / (2.0 * STEP)
    })
}

fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|axis| a[axis] - b[axis])
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|axis| {
        let (next, last) = ((axis + 1) % 3, (axis + 2) % 3);
        a[next] * b[last] - a[last] * b[next]
    })
}

fn norm(a: [f64; 3]) -> f64 {
    a.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// Degrees; 180 where there is no direction.
fn between(a: [f64; 3], b: [f64; 3]) -> f64 {
    let dot: f64 = (0..3).map(|axis| a[axis] * b[axis]).sum();
    let degrees = norm(cross(a, b)).atan2(dot).to_degrees();
    if norm(a) > 0.0 && norm(b) > 0.0 { degrees } else { 180.0 }
}
