//! What cut faces show.

use trisect::mesh::Attribute;
use trisect::{BooleanOptions, CutFaces, FaceGroup, Material, Mesh, Operation, Outcome, Solid, primitives};

use crate::common::solid;
use crate::maps::mapped;

fn group(name: &str) -> FaceGroup {
    FaceGroup { name: name.into(), material: Some(Material::plain(name, [0.5; 4])) }
}

/// A block with one material below z = 0 and another above, maps and normals.
fn body() -> Solid {
    let mut halves = Mesh::merged([
        &primitives::cuboid([-1.0, -1.0, -1.0], [1.0, 1.0, -0.25]).unwrap(),
        &primitives::cuboid([-1.0, -1.0, 0.25], [1.0, 1.0, 1.0]).unwrap(),
    ])
    .unwrap();
    halves.groups.list = vec![group("below"), group("above")];
    halves.groups.of_triangle = (0..24).map(|t| t / 12).collect();
    halves.set_attribute(halves.flat_normals());
    solid(mapped(halves, |t| t as f64))
}

fn tool() -> Solid {
    let mut tool = primitives::icosphere(0.6, 3).unwrap().translated([1.0, 0.1, 0.2]);
    tool.set_attribute(tool.crease_normals(30.0));
    tool.groups.list = vec![group("tool")];
    tool.groups.of_triangle = vec![0; tool.triangles.len()];
    solid(mapped(tool, |t| 100.0 + t as f64))
}

fn cut(faces: CutFaces) -> Outcome {
    BooleanOptions::new().cut_faces(faces).run(Operation::Difference, [&body(), &tool()]).unwrap()
}

fn is_cut(outcome: &Outcome, t: usize) -> bool {
    outcome.origins()[t].operand == 1
}

fn group_of(mesh: &Mesh, t: usize) -> &str {
    &mesh.groups.list[mesh.groups.of_triangle[t] as usize].name
}

fn attribute<'a>(mesh: &'a Mesh, name: &str) -> &'a Attribute {
    mesh.attribute(name).unwrap()
}

/// All that is no cut face is as with the tool's own.
fn assert_only_cut_faces_differ(outcome: &Outcome, plain: &Outcome) {
    let (mesh, plain) = (outcome.solid().mesh(), plain.solid().mesh());
    assert_eq!((&mesh.positions, &mesh.triangles), (&plain.positions, &plain.triangles));
    for t in (0..mesh.triangles.len()).filter(|&t| !is_cut(outcome, t)) {
        assert_eq!(group_of(mesh, t), group_of(plain, t));
        for other in &plain.attributes {
            (0..3).for_each(|k| assert_eq!(attribute(mesh, &other.name).at(t, k), other.at(t, k)));
        }
    }
    assert!(Solid::try_from(mesh.clone()).is_ok());
}

#[test]
fn the_tools_own_by_default() {
    let outcome = cut(CutFaces::tool());
    let mesh = outcome.solid().mesh();
    let mut count = 0;
    for t in (0..mesh.triangles.len()).filter(|&t| is_cut(&outcome, t)) {
        count += 1;
        assert_eq!(group_of(mesh, t), "tool");
        assert!(attribute(mesh, "_FACE").at(t, 0).unwrap()[0] >= 100.0);
    }
    assert!(count > 50);
}

#[test]
fn the_bodys_material_where_it_is_cut() {
    let outcome = cut(CutFaces::body());
    let mesh = outcome.solid().mesh();
    assert_only_cut_faces_differ(&outcome, &cut(CutFaces::tool()));
    let flat = mesh.flat_normals();
    let mut seen = [0; 2];
    for (t, triangle) in mesh.triangles.iter().enumerate().filter(|&(t, _)| is_cut(&outcome, t)) {
        let is_above = mesh.positions[triangle[0] as usize][2] > 0.0;
        seen[usize::from(is_above)] += 1;
        assert_eq!(group_of(mesh, t), if is_above { "above" } else { "below" });
        for k in 0..3 {
            assert_eq!(attribute(mesh, "NORMAL").at(t, k), flat.at(t, 0));
            assert_eq!(attribute(mesh, "TEXCOORD_0").at(t, k), None);
            assert_eq!(attribute(mesh, "_FACE").at(t, k), None);
        }
    }
    assert!(seen.iter().all(|&count| count > 0), "{seen:?}");
}

#[test]
fn a_group_of_their_own_with_a_texture_laid_on() {
    let outcome = cut(CutFaces::group(group("cut")).boxed(4.0));
    assert_only_cut_faces_differ(&outcome, &cut(CutFaces::tool()));
    let mesh = outcome.solid().mesh();
    let uv = attribute(mesh, "TEXCOORD_0");
    for (t, triangle) in mesh.triangles.iter().enumerate().filter(|&(t, _)| is_cut(&outcome, t)) {
        assert_eq!(group_of(mesh, t), "cut");
        let places = triangle.map(|v| mesh.positions[v as usize]);
        let at = [0, 1, 2].map(|k| uv.at(t, k).unwrap());
        for k in 0..3 {
            let (p, q) = (places[k], places[(k + 1) % 3]);
            let length = (0..3).map(|i| (p[i] - q[i]).powi(2)).sum::<f64>().sqrt();
            let (u, v) = (at[k], at[(k + 1) % 3]);
            let measured = ((u[0] - v[0]).powi(2) + (u[1] - v[1]).powi(2)).sqrt();
            // A side is seen at 55 degrees at most.
            assert!(measured <= 4.0 * length * (1.0 + 1e-12));
        }
        let [a, b, c] = at;
        let area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
        assert!(area > 0.0, "triangle {t} is mirrored");
    }
}

#[test]
fn a_plane_cut_has_true_lengths() {
    let knife = solid(
        primitives::cuboid([-3.0, -3.0, 0.6], [3.0; 3]).unwrap().rotated([1.0, 0.4, 0.0], 20.0).unwrap(),
    );
    let options = BooleanOptions::new().cut_faces(CutFaces::body().planar(3.0));
    let outcome = options.run(Operation::Difference, [&body(), &knife]).unwrap();
    let mesh = outcome.solid().mesh();
    let uv = attribute(mesh, "TEXCOORD_0");
    let mut count = 0;
    for (t, triangle) in mesh.triangles.iter().enumerate().filter(|&(t, _)| is_cut(&outcome, t)) {
        count += 1;
        let places = triangle.map(|v| mesh.positions[v as usize]);
        for k in 0..3 {
            let (p, q) = (places[k], places[(k + 1) % 3]);
            let (u, v) = (uv.at(t, k).unwrap(), uv.at(t, (k + 1) % 3).unwrap());
            let length = (0..3).map(|i| (p[i] - q[i]).powi(2)).sum::<f64>().sqrt();
            let measured = ((u[0] - v[0]).powi(2) + (u[1] - v[1]).powi(2)).sqrt();
            assert!((measured - 3.0 * length).abs() < 1e-12, "{measured} {length}");
        }
    }
    assert!(count > 0);
}

#[test]
fn senseless_densities_are_refused() {
    for per_unit in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let options = BooleanOptions::new().cut_faces(CutFaces::body().boxed(per_unit));
        let error = options.run(Operation::Difference, [&body(), &tool()]).unwrap_err().to_string();
        assert!(error.contains("positive number"), "{error}");
    }
}

/// Where nothing has groups or attributes, a new group still tells the cut faces.
#[test]
fn bare_operands_get_a_group() {
    let [a, b] = [crate::common::cube([0.0; 3], 1.0), crate::common::cube([0.5; 3], 1.0)];
    let options = BooleanOptions::new().cut_faces(CutFaces::group(group("cut")));
    let outcome = options.run(Operation::Difference, [&a, &b]).unwrap();
    let mesh = outcome.solid().mesh();
    for t in 0..mesh.triangles.len() {
        assert_eq!(group_of(mesh, t), if is_cut(&outcome, t) { "cut" } else { "" });
    }
    assert!(mesh.attributes.is_empty());
    let untouched = options.run(Operation::Union, [&a, &b]).unwrap();
    assert!(untouched.solid().mesh().groups.list.is_empty());
}
