//! Where each triangle of a result came from, and the curves in which the operands meet.
//!
//!     cargo run --release --example provenance -- [OUTPUT.obj]
//!
//! Drills two holes through a plate, puts the faces that each operand left into a named group of its own, and lists the
//! intersection curves.

use trisect::{BooleanOptions, Error, FaceGroup, FaceGroups, Material, Operation, Solid, primitives};

fn main() -> Result<(), Error> {
    let output = std::env::args().nth(1);
    let plate = primitives::cuboid([0.0, 0.0, 0.0], [60.0, 30.0, 5.0])?;
    let drill = primitives::cylinder(6.0, 20.0, 48)?;
    let operands = [
        ("plate", Solid::try_from(plate)?),
        ("first hole", Solid::try_from(drill.clone().translated([15.0, 15.0, -7.5]))?),
        ("second hole", Solid::try_from(drill.translated([45.0, 15.0, -7.5]))?),
    ];
    let solids = operands.iter().map(|(_, solid)| solid);
    let drilled = BooleanOptions::new().run(Operation::Difference, solids)?;

    // One origin for each triangle: the operand, its triangle, and whether it was turned over.
    let origins = drilled.origins();
    for (number, (name, solid)) in operands.iter().enumerate() {
        let of_this = || origins.iter().filter(|origin| origin.operand == number as u32);
        let (total, reversed) = (of_this().count(), of_this().filter(|origin| origin.reversed).count());
        let all = solid.mesh().triangles.len();
        println!("{name}: {total} triangles of the result, {reversed} of them turned over; it had {all}");
    }

    // Curves are chains of vertex numbers of the result; a closed one ends where it began.
    let mesh = drilled.solid().mesh();
    for curve in drilled.curves() {
        let length: f64 = curve
            .windows(2)
            .map(|ends| {
                let [p, q] = [0, 1].map(|i| mesh.positions[ends[i] as usize]);
                (0..3).map(|k| (q[k] - p[k]).powi(2)).sum::<f64>().sqrt()
            })
            .sum();
        let kind = if curve.first() == curve.last() { "closed" } else { "open" };
        println!("{kind} curve of {} edges, {length:.3} long", curve.len() - 1);
    }

    // Groups, with a colour each; OBJ and glTF files keep them.
    if let Some(path) = output {
        let colours = [[0.6, 0.65, 0.7, 1.0], [0.9, 0.5, 0.2, 1.0], [0.2, 0.6, 0.5, 1.0]];
        let group = |(name, base_color): (&str, [f32; 4])| FaceGroup {
            name: name.into(),
            material: Some(Material::plain(name, base_color)),
        };
        let mut coloured = mesh.clone();
        coloured.groups = FaceGroups {
            list: operands.iter().map(|(name, _)| *name).zip(colours).map(group).collect(),
            of_triangle: origins.iter().map(|origin| origin.operand).collect(),
        };
        coloured.save(&path)?;
        println!("wrote {path}");
    }
    Ok(())
}
