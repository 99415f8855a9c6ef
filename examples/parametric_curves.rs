//! The plane cases of Choporov 2017: a closed Bezier curve of degree 9 and a polygon as meshes, the NACA 0011 profile
//! with its holes by exact operations and by R-functions. Writes SVG pictures into the folder given as argument
//! (without: `out`).
#![allow(clippy::print_stdout, reason = "the program's output")]

use std::path::PathBuf;

use trisect::parametric::json::{AnyCurve, curve, parse, region, solid};
use trisect::parametric::svg::{Ink, Picture};
use trisect::parametric::{CurveMeshing, Polygons, Refinement, SharedCurve};
use trisect::{Control, Error};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = PathBuf::from(std::env::args().nth(1).unwrap_or_else(|| "out".into()));
    std::fs::create_dir_all(&folder)?;

    let degree9 = plane_curve(include_str!("parametric/degree9.json"))?;
    let nurbs = degree9.to_nurbs();
    for (name, meshing) in [
        ("halving", CurveMeshing::new(0.02).initial_nodes(41).refinement(Refinement::Halving)),
        ("levelled", CurveMeshing::new(0.02)),
    ] {
        let mesh = meshing.mesh(degree9.as_ref())?;
        println!("degree 9, {name}: {} edges", mesh.points.len() - 1);
        let mut picture = Picture::new();
        picture.control_polygon(nurbs.control(), Ink::Faint);
        picture.curve(degree9.as_ref(), Ink::Second)?;
        picture.polygon(&mesh.points, Ink::First);
        picture.dots(&mesh.points, Ink::First);
        std::fs::write(folder.join(format!("degree9-{name}.svg")), picture.svg(700.0))?;
    }

    let polygon = plane_curve(include_str!("parametric/polygon.json"))?;
    let mesh = CurveMeshing::new(0.02).initial_nodes(13).mesh(polygon.as_ref())?;
    println!("polygon: {} edges", mesh.points.len() - 1);
    let mut picture = Picture::new();
    picture.polygon(&mesh.points, Ink::Main);
    picture.dots(&mesh.points, Ink::First);
    std::fs::write(folder.join("polygon.svg"), picture.svg(400.0))?;

    naca(&folder)
}

fn plane_curve(text: &str) -> Result<SharedCurve<2>, Error> {
    match curve(&parse(text)?)? {
        AnyCurve::Plane(curve) => Ok(curve),
        AnyCurve::Space(_) => Err(Error::InvalidArgument("a plane curve was expected".into())),
    }
}

/// The profile by both routes: polygons combined exactly and extruded; the signed distance of the outline combined
/// with implicit functions by R-functions.
fn naca(folder: &std::path::Path) -> Result<(), Box<dyn std::error::Error>> {
    let leaf = parse(include_str!("parametric/naca0011.json"))?;
    let exact = region(&leaf["region"], &CurveMeshing::new(1e-3))?;
    let outline = region(&leaf["region"]["regions"][0], &CurveMeshing::new(1e-3))?;
    let mesh = solid(&leaf, &Control::new())?;
    // Columns that end where the holes do.
    let [n, m] = [4200, 60];
    let field_area = area_of_positive(|p| with_holes(&outline, p), [-1.0, -3.0], [41.0, 3.0], [n, m]);
    println!("NACA 0011 with holes: area {} by exact operations, {field_area} by R-functions", exact.area());
    println!("extruded: {} vertices, {} triangles", mesh.positions.len(), mesh.triangles.len());
    let mut picture = Picture::new();
    picture.region(&exact, Ink::First);
    let outline = outline.contours().flatten().copied().collect::<Vec<_>>();
    picture.dots(&outline, Ink::Faint);
    Ok(std::fs::write(folder.join("naca0011.svg"), picture.svg(1000.0))?)
}

/// distance AND NOT rectangle AND NOT circle AND NOT rectangle, positive inside, by the system R_0.
fn with_holes(outline: &Polygons, [x, y]: [f64; 2]) -> f64 {
    let and = |a: f64, b: f64| a + b - a.hypot(b);
    let rectangle =
        |x: f64, y: f64, w: f64, h: f64| and(1.0 - (2.0 * x / w).powi(2), 1.0 - (2.0 * y / h).powi(2));
    let circle = |x: f64, y: f64, r: f64| 1.0 - (x * x + y * y) / (r * r);
    let distance = outline.signed_distance([x, y]);
    let without = and(distance, -rectangle(x - 10.0, y, 6.0, 3.0));
    let without = and(without, -circle(x - 20.0, y, 1.5));
    and(without, -rectangle(x - 25.0, y, 2.0, 2.0))
}

/// Area where the function is positive: along every column's middle the lengths between sign changes, found by samples
/// and bisection.
fn area_of_positive(f: impl Fn([f64; 2]) -> f64, low: [f64; 2], high: [f64; 2], cells: [u32; 2]) -> f64 {
    let step = [0, 1].map(|k| (high[k] - low[k]) / f64::from(cells[k]));
    let mut area = 0.0;
    for i in 0..cells[0] {
        let x = low[0] + (f64::from(i) + 0.5) * step[0];
        let is_in = |y: f64| f([x, y]) > 0.0;
        for j in 0..cells[1] {
            let (bottom, top) = (low[1] + f64::from(j) * step[1], low[1] + f64::from(j + 1) * step[1]);
            let (starts_in, ends_in) = (is_in(bottom), is_in(top));
            let (mut a, mut b) = (bottom, top);
            while starts_in != ends_in && b - a > 1e-9 {
                let middle = 0.5 * (a + b);
                if is_in(middle) == starts_in { a = middle } else { b = middle }
            }
            area += step[0]
                * match (starts_in, ends_in) {
                    (true, true) => top - bottom,
                    (true, false) => a - bottom,
                    (false, true) => top - b,
                    (false, false) => 0.0,
                };
        }
    }
    area
}
