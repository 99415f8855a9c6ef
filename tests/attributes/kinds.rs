//! What becomes of normals, tangents, colours and joints, and of operands that lack what others have.

use trisect::mesh::Attribute;
use trisect::{BooleanOptions, Mesh, Operation, Solid, primitives};

use crate::common::solid;

fn length(v: &[f64]) -> f64 {
    v.iter().fold(0.0, |length: f64, x| length.hypot(*x))
}

/// A ball with the normals of a ball, one for each vertex, and tangents around the axis.
fn ball(at: [f64; 3]) -> Mesh {
    let mut mesh = primitives::icosphere(1.0, 3).unwrap();
    let mut normals = Attribute::new("NORMAL", 3);
    let mut tangents = Attribute::new("TANGENT", 4);
    for p in &mesh.positions {
        normals.values.extend(p.map(|x| x / length(p)));
        let around = [-p[1], p[0], 0.0];
        let size = length(&around);
        let tangent = if size > 0.0 { around.map(|x| x / size) } else { [1.0, 0.0, 0.0] };
        tangents.values.extend(tangent);
        tangents.values.push(1.0);
    }
    normals.of_corner = mesh.triangles.as_flattened().to_vec();
    tangents.of_corner = normals.of_corner.clone();
    mesh.attributes = vec![normals, tangents];
    mesh.translated(at)
}

#[test]
fn normals_look_out_of_the_result() {
    let (a, b) = (solid(ball([0.0; 3])), solid(ball([0.9, 0.2, 0.1])));
    for operation in Operation::ALL {
        let outcome = BooleanOptions::new().run(operation, [&a, &b]).unwrap();
        let mesh = outcome.solid().mesh();
        let [normals, tangents] = ["NORMAL", "TANGENT"].map(|name| mesh.attribute(name).unwrap());
        for (t, (triangle, origin)) in mesh.triangles.iter().zip(outcome.origins()).enumerate() {
            let centre = if origin.operand == 0 { [0.0; 3] } else { [0.9, 0.2, 0.1] };
            let side = if origin.reversed { -1.0 } else { 1.0 };
            for k in 0..3 {
                let normal = normals.at(t, k).unwrap();
                let p = mesh.positions[triangle[k] as usize];
                let out: [f64; 3] = std::array::from_fn(|i| side * (p[i] - centre[i]));
                let dot: f64 = (0..3).map(|i| normal[i] * out[i]).sum::<f64>() / length(&out);
                // A chord of the ball turns by a few degrees.
                assert!(dot > 0.99 && (length(normal) - 1.0).abs() < 1e-14, "{operation:?}: {dot}");
                let tangent = tangents.at(t, k).unwrap();
                assert_eq!(tangent[3], side);
                assert!((length(&tangent[..3]) - 1.0).abs() < 1e-14);
            }
        }
    }
}

#[test]
fn operands_without_an_attribute_have_no_values() {
    let mut coloured = primitives::cuboid([0.0; 3], [1.0; 3]).unwrap();
    let mut colour = Attribute::new("COLOR_0", 3);
    colour.values = coloured.positions.iter().flat_map(|p| *p).collect();
    colour.of_corner = coloured.triangles.as_flattened().to_vec();
    coloured.attributes.push(colour);
    let coloured = solid(coloured);
    let bare = crate::common::cube([0.5; 3], 1.0);
    let mut faded = primitives::cuboid([-0.5; 3], [0.5; 3]).unwrap();
    let rgba = Attribute {
        name: "COLOR_0".into(),
        components: 4,
        values: vec![1.0, 0.5, 0.25, 0.5],
        of_corner: vec![0; 36],
    };
    faded.attributes.push(rgba);
    let faded = solid(faded);
    let outcome = BooleanOptions::new().run(Operation::Union, [&coloured, &bare, &faded]).unwrap();
    let mesh = outcome.solid().mesh();
    let colour = mesh.attribute("COLOR_0").unwrap();
    assert_eq!(colour.components, 4);
    let mut seen = [0; 3];
    for (t, (triangle, origin)) in mesh.triangles.iter().zip(outcome.origins()).enumerate() {
        for k in 0..3 {
            let p = mesh.positions[triangle[k] as usize];
            seen[origin.operand as usize] += 1;
            match (origin.operand, colour.at(t, k)) {
                (0, Some(value)) => {
                    assert!((0..3).all(|i| (value[i] - p[i]).abs() < 1e-15) && value[3] == 1.0);
                }
                (1, None) => {}
                (2, Some(value)) => assert_eq!(value, [1.0, 0.5, 0.25, 0.5]),
                other => panic!("{other:?}"),
            }
        }
    }
    assert!(seen.iter().all(|&count| count > 0), "{seen:?}");
    // One value for all of the third, as it was.
    assert_eq!(colour.values.chunks(4).filter(|value| value[3] == 0.5).count(), 1);
}

#[test]
fn joints_stay_whole_numbers_and_weights_add_up_to_one() {
    let mut mesh = primitives::cylinder(1.0, 8.0, 24).unwrap();
    let (low, high) = (mesh.bounds().unwrap().low[2], mesh.bounds().unwrap().high[2]);
    let mut joints = Attribute::new("JOINTS_0", 4);
    let mut weights = Attribute::new("WEIGHTS_0", 4);
    for p in &mesh.positions {
        let at = (p[2] - low) / (high - low);
        // At the lower end joints 5 and 3, at the upper end 3 and 8.
        joints.values.extend(if at < 0.5 { [5.0, 3.0, 0.0, 0.0] } else { [3.0, 8.0, 0.0, 0.0] });
        weights.values.extend(if at < 0.5 { [0.75, 0.25, 0.0, 0.0] } else { [0.5, 0.5, 0.0, 0.0] });
    }
    joints.of_corner = mesh.triangles.as_flattened().to_vec();
    weights.of_corner = joints.of_corner.clone();
    mesh.attributes = vec![joints, weights];
    let tool = solid(primitives::icosphere(0.8, 2).unwrap().translated([0.9, 0.1, 0.5 * (low + high)]));
    let outcome = BooleanOptions::new().run(Operation::Difference, [&solid(mesh), &tool]).unwrap();
    let mesh = outcome.solid().mesh();
    let [joints, weights] = ["JOINTS_0", "WEIGHTS_0"].map(|name| mesh.attribute(name).unwrap());
    let mut new = 0;
    for (t, (triangle, origin)) in mesh.triangles.iter().zip(outcome.origins()).enumerate() {
        for k in (0..3).filter(|_| origin.operand == 0) {
            let at = (mesh.positions[triangle[k] as usize][2] - low) / (high - low);
            let (joints, weights) = (joints.at(t, k).unwrap(), weights.at(t, k).unwrap());
            let of = |joint: f64| -> f64 { (0..4).filter(|&i| joints[i] == joint).map(|i| weights[i]).sum() };
            assert!((weights.iter().sum::<f64>() - 1.0).abs() < 1e-15);
            for (joint, expected) in [(5.0, 0.75 * (1.0 - at)), (3.0, 0.25 + 0.25 * at), (8.0, 0.5 * at)] {
                assert!((of(joint) - expected).abs() < 1e-12, "{joints:?} {weights:?} at {at}");
            }
            new += usize::from(at > 0.01 && at < 0.99);
        }
    }
    assert!(new > 20, "{new}");
}

#[test]
fn values_at_the_ends_of_the_numbers_stay_finite() {
    let mut mesh = primitives::cuboid([-1.0; 3], [1.0; 3]).unwrap();
    let mut own = Attribute::new("_HUGE", 1);
    own.values = vec![f64::MAX, f64::MIN, 0.0];
    own.of_corner = (0..36).map(|corner| corner % 3).collect();
    mesh.attributes.push(own);
    let body = solid(mesh);
    let tool = solid(primitives::icosphere(0.7, 2).unwrap().translated([1.0, 0.2, 0.3]));
    let outcome = BooleanOptions::new().run(Operation::Difference, [&body, &tool]).unwrap();
    let result: &Solid = outcome.solid();
    assert!(result.mesh().attributes[0].values.iter().all(|x| x.is_finite()));
    // An operand again.
    assert!(Solid::try_from(result.mesh().clone()).is_ok());
}
