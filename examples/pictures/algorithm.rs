//! One picture for each step of the algorithm, made of real operands and results where there are any.

use trisect::render::{Picture, palette};
use trisect::{BooleanOptions, Error, Mesh, Operation, Outcome, Solid, primitives};

use crate::scene::{BLUE, Colour, DARK, GREEN, GREY, ORANGE, Point, RED, Scene, beside, blend, view};

const FROM: Point = [0.7, -1.5, 0.9];
/// What to show of the sphere and the ring.
const FRAME: [Point; 2] = [[-0.85, -0.9, -0.65], [1.6, 0.8, 0.95]];
const PALE_BLUE: Colour = [206, 220, 238];
const PALE_ORANGE: Colour = [250, 226, 196];

/// The operands of most pictures: a sphere A, and a ring B that reaches into it.
fn sphere_and_ring() -> Result<[Solid; 2], Error> {
    let sphere = primitives::geodesic_sphere(1.0, 8)?;
    let ring = primitives::torus(0.8, 0.3, 28, 14)?;
    let ring = ring.rotated([1.0, 0.0, 0.0], 62.0)?.translated([0.85, -0.2, 0.45]);
    Ok([Solid::try_from(sphere)?, Solid::try_from(ring)?])
}

/// Low and high corner.
type Box3 = (Point, Point);

fn box_of(mesh: &Mesh, triangle: usize) -> Box3 {
    let corners = mesh.triangles[triangle].map(|v| mesh.positions[v as usize]);
    let extreme = |pick: fn(f64, f64) -> f64| {
        [0, 1, 2].map(|k| pick(pick(corners[0][k], corners[1][k]), corners[2][k]))
    };
    (extreme(f64::min), extreme(f64::max))
}

fn meet(x: &Box3, y: &Box3) -> bool {
    (0..3).all(|k| x.0[k] <= y.1[k] && y.0[k] <= x.1[k])
}

/// Step 1: what of each operand can meet the other.
pub(crate) fn candidates() -> Result<Picture, Error> {
    let solids = sphere_and_ring()?;
    let bounds =
        solids.each_ref().map(|solid| solid.bounds().map_or(([0.0; 3], [0.0; 3]), |b| (b.low, b.high)));
    let common = (
        [0, 1, 2].map(|k| bounds[0].0[k].max(bounds[1].0[k])),
        [0, 1, 2].map(|k| bounds[0].1[k].min(bounds[1].1[k])),
    );
    let mut frame = view(480, 420, FROM);
    frame.frame = Some(FRAME);
    let mut pictures = Vec::new();
    for side in 0..2 {
        let (mesh, other) = (solids[side].mesh(), solids[1 - side].mesh());
        let colours = [[GREY, PALE_BLUE, BLUE], [GREY, PALE_ORANGE, ORANGE]][side];
        let others: Vec<Box3> = (0..other.triangles.len()).map(|t| box_of(other, t)).collect();
        let mut scene = Scene::default();
        scene.add(mesh, |t| {
            let own = box_of(mesh, t);
            let near = meet(&own, &bounds[1 - side]);
            let candidate = near && others.iter().any(|theirs| meet(&own, theirs));
            colours[usize::from(near) + usize::from(candidate)]
        })?;
        scene.edges(mesh, 0.003, DARK, |_, _| true)?;
        let cuboid = primitives::cuboid(common.0, common.1)?;
        scene.edges(&cuboid, 0.012, RED, |p, q| (0..3).filter(|&k| p[k] != q[k]).count() == 1)?;
        pictures.push(scene.draw(&frame));
    }
    Ok(beside(&pictures))
}

/// A triangle as a sheet that shows its front to a viewer.
fn sheet(corners: [Point; 3], from: Point) -> Mesh {
    let [a, b, c] = corners;
    let edge = |p: Point| [0, 1, 2].map(|k| p[k] - a[k]);
    let (u, v) = (edge(b), edge(c));
    let normal = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
    let front = (0..3).map(|k| normal[k] * from[k]).sum::<f64>() > 0.0;
    Mesh::new(corners.to_vec(), vec![if front { [0, 1, 2] } else { [0, 2, 1] }])
}

/// Where the line from `p` to `q` passes the plane of a triangle, as a part of the way.
fn parameter(p: Point, q: Point, [a, b, c]: [Point; 3]) -> f64 {
    let height = |x: Point| {
        let [u, v, w] = [b, c, x].map(|y| [0, 1, 2].map(|k| y[k] - a[k]));
        w[0] * (u[1] * v[2] - u[2] * v[1])
            + w[1] * (u[2] * v[0] - u[0] * v[2])
            + w[2] * (u[0] * v[1] - u[1] * v[0])
    };
    height(p) / (height(p) - height(q))
}

/// Step 2: two triangles, the two crossings, the segment between them.
pub(crate) fn crossings() -> Result<Picture, Error> {
    let a: [Point; 3] = [[-1.3, -0.2, -0.3], [1.2, -0.9, -0.1], [0.3, 1.3, 0.2]];
    let b: [Point; 3] = [[-0.3, 0.0, -1.0], [1.5, 0.75, -0.3], [0.2, 0.1, 1.3]];
    let mut scene = Scene::default();
    for (corners, colour) in [(a, BLUE), (b, ORANGE)] {
        let triangle = sheet(corners, FROM);
        scene.add(&triangle, |_| colour)?;
        scene.edges(&triangle, 0.012, DARK, |_, _| true)?;
    }
    // Seen from outside A, its edge enters B here: the tail; B's edge enters A: the head.
    let tail = blend(a[1], a[2], parameter(a[1], a[2], b));
    let head = blend(b[0], b[2], parameter(b[0], b[2], a));
    scene.dot(tail, 0.055, GREEN)?;
    scene.dot(head, 0.055, RED)?;
    scene.arrow(tail, blend(head, tail, 0.05), 0.022, DARK)?;
    Ok(scene.draw(&view(720, 480, FROM)))
}

/// Step 3: the nodes of one edge in their order.
pub(crate) fn order() -> Result<Picture, Error> {
    let from = [-0.75, -1.2, 0.5];
    let (p, q): (Point, Point) = ([-2.2, -0.5, -0.25], [2.2, 0.5, 0.35]);
    let mut scene = Scene::default();
    let mut nodes = Vec::new();
    for step in 0..5 {
        let x = -1.5 + 0.75 * f64::from(step);
        let lean = 0.28 * (f64::from(step) * 2.1).sin();
        let triangle: [Point; 3] = [[x - lean, -0.9, -0.75], [x + lean, 1.0, -0.6], [x + 0.2, 0.1, 0.95]];
        let sheet = sheet(triangle, from);
        scene.add(&sheet, |_| if step % 2 == 0 { ORANGE } else { PALE_ORANGE })?;
        scene.edges(&sheet, 0.008, DARK, |_, _| true)?;
        nodes.push(parameter(p, q, triangle));
    }
    scene.line(p, q, 0.02, BLUE)?;
    for end in [p, q] {
        scene.dot(end, 0.06, BLUE)?;
    }
    nodes.sort_by(f64::total_cmp);
    for (i, &t) in nodes.iter().enumerate() {
        // From green to red along the edge.
        let part = i as f64 / (nodes.len() - 1) as f64;
        let mix = |k: usize| (f64::from(GREEN[k]) * (1.0 - part) + f64::from(RED[k]) * part) as u8;
        scene.dot(blend(p, q, t), 0.07, [mix(0), mix(1), mix(2)])?;
    }
    Ok(scene.draw(&view(900, 360, from)))
}

/// Step 4: how often B winds round the vertices of A.
pub(crate) fn winding() -> Result<Picture, Error> {
    let [sphere, ring] = sphere_and_ring()?;
    let inside = BooleanOptions::new().run(Operation::Intersection, [&sphere, &ring])?;
    // A's vertices inside B are those the intersection kept.
    let kept = &inside.solid().mesh().positions;
    let mesh = sphere.mesh();
    let winding: Vec<bool> = mesh.positions.iter().map(|p| kept.contains(p)).collect();
    let mut scene = Scene::default();
    scene.add(mesh, |t| match mesh.triangles[t].iter().filter(|&&v| winding[v as usize]).count() {
        0 => PALE_BLUE,
        3 => PALE_ORANGE,
        _ => GREY,
    })?;
    scene.edges(mesh, 0.003, DARK, |_, _| true)?;
    for (p, &inside) in mesh.positions.iter().zip(&winding) {
        scene.dot(*p, 0.024, if inside { ORANGE } else { BLUE })?;
    }
    let mut alone = Scene::default();
    alone.add(mesh, |_| BLUE)?;
    alone.add(ring.mesh(), |_| ORANGE)?;
    let mut frame = view(480, 420, FROM);
    frame.frame = Some(FRAME);
    Ok(beside(&[alone.draw(&frame), scene.draw(&frame)]))
}

/// A result with all its edges.
fn wires(outcome: &Outcome, radius: f64, dots: f64) -> Result<Scene, Error> {
    let mesh = outcome.solid().mesh();
    let mut scene = Scene::default();
    scene.add(mesh, |t| palette(outcome.origins()[t].operand as usize))?;
    scene.edges(mesh, radius, DARK, |_, _| true)?;
    if dots > 0.0 {
        for &p in &mesh.positions {
            scene.dot(p, dots, RED)?;
        }
    }
    Ok(scene)
}

fn boxed(low: Point, high: Point) -> Result<Solid, Error> {
    Solid::try_from(primitives::cuboid(low, high)?)
}

/// Step 5: what the perturbation kept apart, and the limit.
pub(crate) fn identify() -> Result<Picture, Error> {
    const EPSILON: f64 = 0.09;
    let b = boxed([1.0, 0.0, 0.0], [3.0, 2.0, 2.0])?;
    let options = BooleanOptions::new().remove_vertices(false);
    let mut pictures = Vec::new();
    for shift in [EPSILON, 0.0] {
        let a = boxed([-shift; 3], [2.0 + shift; 3])?;
        let outcome = options.run(Operation::Union, [&a, &b])?;
        let mut frame = view(480, 400, [-0.5, -1.5, 1.0]);
        frame.frame = Some([[-EPSILON; 3], [3.0, 2.0 + EPSILON, 2.0 + EPSILON]]);
        pictures.push(wires(&outcome, 0.012, 0.035)?.draw(&frame));
    }
    Ok(beside(&pictures))
}

/// Step 6: a face with what is kept of it, triangulated.
pub(crate) fn cut() -> Result<Picture, Error> {
    let plate = boxed([0.0, 0.0, 0.0], [6.0, 4.0, 1.0])?;
    let star: Vec<[f64; 2]> = (0..14)
        .map(|i| {
            let angle = std::f64::consts::PI * f64::from(i) / 7.0;
            let radius = if i % 2 == 0 { 0.95 } else { 0.45 };
            [radius * angle.cos(), radius * angle.sin()]
        })
        .collect();
    let tools = [
        primitives::extrusion(&star, &[], 3.0)?.translated([1.5, 2.4, -1.0]),
        primitives::cylinder(0.7, 3.0, 24)?.translated([4.4, 2.8, -1.0]),
        primitives::cylinder(0.5, 3.0, 6)?.translated([3.1, 1.0, -1.0]),
        primitives::geodesic_sphere(1.1, 6)?.translated([5.6, 0.4, 1.2]),
    ];
    let tools: Vec<Solid> = tools.into_iter().map(Solid::try_from).collect::<Result<_, Error>>()?;
    let operands = std::iter::once(&plate).chain(&tools);
    let outcome = BooleanOptions::new().remove_vertices(false).run(Operation::Difference, operands)?;
    let mesh = outcome.solid().mesh();
    let mut scene = Scene::default();
    // The two triangles of the plate's upper face in two tints.
    let top = |t: &usize| {
        let origin = outcome.origins()[*t];
        origin.operand == 0 && mesh.triangles[*t].iter().all(|&v| mesh.positions[v as usize][2] == 1.0)
    };
    let Some(first) = (0..mesh.triangles.len()).find(top).map(|t| outcome.origins()[t].triangle) else {
        return Err(Error::InvalidArgument("the plate lost its upper face".into()));
    };
    scene.add(mesh, |t| {
        let origin = outcome.origins()[t];
        match (top(&t), origin.triangle == first) {
            (true, true) => BLUE,
            (true, false) => PALE_BLUE,
            (false, _) => {
                if origin.operand == 0 {
                    GREY
                } else {
                    ORANGE
                }
            }
        }
    })?;
    scene.edges(mesh, 0.012, DARK, |p, q| p[2] == 1.0 && q[2] == 1.0)?;
    let mut frame = view(900, 560, [0.15, -0.55, 1.6]);
    frame.edges = false;
    Ok(scene.draw(&frame))
}

/// Step 7: needless vertices go, and what touches separates.
pub(crate) fn tidy() -> Result<Picture, Error> {
    let mut cubes = Vec::new();
    for i in 0..27 {
        let low = [i % 3, i / 3 % 3, i / 9].map(f64::from);
        if low != [2.0, 0.0, 2.0] {
            cubes.push(boxed(low, low.map(|x| x + 1.0))?);
        }
    }
    let from = [1.0, -1.4, 0.9];
    let mut pictures = Vec::new();
    for remove in [false, true] {
        let outcome = BooleanOptions::new().remove_vertices(remove).run(Operation::Union, &cubes)?;
        let mut scene = Scene::default();
        scene.add(outcome.solid().mesh(), |_| BLUE)?;
        scene.edges(outcome.solid().mesh(), 0.014, DARK, |_, _| true)?;
        pictures.push(scene.draw(&view(320, 330, from)));
    }
    // Two boxes that touch in an edge, drawn apart.
    let pair = [boxed([0.0; 3], [1.0; 3])?, boxed([1.0, 0.0, 1.0], [2.0, 1.0, 2.0])?];
    let touching = BooleanOptions::new().run(Operation::Union, [&pair[0], &pair[1]])?;
    let labels = touching.solid().component_labels();
    let mut apart = touching.solid().mesh().clone();
    let upper: Vec<u32> =
        apart.triangles.iter().zip(&labels).filter(|(_, label)| **label == 1).flat_map(|(t, _)| *t).collect();
    for (v, position) in apart.positions.iter_mut().enumerate() {
        if upper.contains(&(v as u32)) {
            *position = position.map(|x| x + 0.15);
        }
    }
    let mut scene = Scene::default();
    scene.add(&apart, |t| palette(labels[t] as usize))?;
    pictures.push(scene.draw(&view(320, 330, from)));
    Ok(beside(&pictures))
}

/// The result, and the curve in which the surfaces meet.
pub(crate) fn result() -> Result<Picture, Error> {
    let [sphere, ring] = sphere_and_ring()?;
    let mut pictures = Vec::new();
    for operation in [Operation::Union, Operation::Intersection, Operation::Difference] {
        let outcome = BooleanOptions::new().run(operation, [&sphere, &ring])?;
        let mesh = outcome.solid().mesh();
        let mut scene = Scene::default();
        scene.add(mesh, |t| palette(outcome.origins()[t].operand as usize))?;
        scene.edges(mesh, 0.003, DARK, |_, _| true)?;
        for curve in outcome.curves() {
            for ends in curve.windows(2) {
                let [p, q] = [0, 1].map(|i| mesh.positions[ends[i] as usize]);
                scene.line(p, q, 0.014, RED)?;
            }
        }
        let mut frame = view(330, 300, FROM);
        frame.frame = Some(FRAME);
        pictures.push(scene.draw(&frame));
    }
    Ok(beside(&pictures))
}
