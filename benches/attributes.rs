//! What attributes cost a boolean: the same one with and without texture coordinates and normals.
//!
//! `cargo bench --bench attributes --no-default-features`; a number after `--` sets how fine the meshes are: 91 makes two balls of 165,620
//! triangles each, 181 two of 655,220. One thread, by the time of the processor, so that a busy machine matters little. Twice: of operands known not to
//! cross themselves, and as called with default options on what has just been read, where each operand is looked through first.

use trisect::mesh::Attribute;
use trisect::{BooleanOptions, Mesh, Operation, Solid, primitives};

/// Runs of each kind, taken in turns; the fastest counts.
const RUNS: usize = 9;

fn main() {
    let frequency: u32 = std::env::args().skip(1).find_map(|argument| argument.parse().ok()).unwrap_or(128);
    for (name, far) in
        [("balls that cross", [0.7, 0.11, 0.05]), ("balls that hardly meet", [1.97, 0.11, 0.05])]
    {
        let ball = |at| primitives::geodesic_sphere(1.0, frequency).expect("a ball").translated(at);
        let bare = [ball([0.0; 3]), ball(far)];
        let with = bare.clone().map(dressed);
        let [bare, with] = [bare, with].map(|pair| pair.map(|mesh| Solid::try_from(mesh).expect("a solid")));
        let triangles: usize = bare.iter().map(|solid| solid.mesh().triangles.len()).sum();
        println!("{name}: {triangles} triangles");
        for (assume_clean, operands) in [(true, "known"), (false, "just read")] {
            for operation in Operation::ALL {
                let (fastest, bytes) = fastest(operation, [&bare, &with], assume_clean);
                println!(
                    "  {operands:<10} {:<22} {:7.2} ms bare, {:7.2} ms with UV and normals: {:.2} x; attributes {:.1} MB",
                    format!("{operation:?}"),
                    1e3 * fastest[0],
                    1e3 * fastest[1],
                    fastest[1] / fastest[0],
                    bytes as f64 / 1e6
                );
            }
        }
    }
}

/// The least seconds of some runs without attributes and with them, taken in turns, and the bytes of the result's attributes.
fn fastest(operation: Operation, pairs: [&[Solid; 2]; 2], assume_clean: bool) -> ([f64; 2], usize) {
    let mut fastest = [f64::MAX; 2];
    let mut bytes = 0;
    for _ in 0..RUNS {
        for (kind, operands) in pairs.into_iter().enumerate() {
            // What has just been read knows nothing of itself.
            let fresh = (!assume_clean)
                .then(|| operands.clone().map(|solid| Solid::try_from(solid.into_mesh()).expect("a solid")));
            let operands = fresh.as_ref().unwrap_or(operands);
            let start = seconds();
            let options = BooleanOptions::new().assume_clean(assume_clean).threads(1);
            let outcome = options.run(operation, operands).expect("a result");
            fastest[kind] = fastest[kind].min(seconds() - start);
            bytes = outcome.solid().mesh().attributes.iter().map(size).sum();
        }
    }
    (fastest, bytes)
}

/// Seconds that the processor has worked for this thread; of the clock where the system does not tell.
fn seconds() -> f64 {
    let told = std::fs::read_to_string("/proc/self/schedstat").ok();
    let nanoseconds = told.and_then(|text| text.split(' ').next()?.parse::<f64>().ok());
    nanoseconds.map_or_else(
        || {
            std::time::SystemTime::now()
                .duration_since(std::time::UNIX_EPOCH)
                .map_or(0.0, |time| time.as_secs_f64())
        },
        |nanoseconds| 1e-9 * nanoseconds,
    )
}

fn size(attribute: &Attribute) -> usize {
    size_of_val(attribute.values.as_slice()) + size_of_val(attribute.of_corner.as_slice())
}

/// A mesh with a normal and texture coordinates at every vertex.
fn dressed(mut mesh: Mesh) -> Mesh {
    let normals = mesh.crease_normals(30.0);
    let mut uv = Attribute::new("TEXCOORD_0", 2);
    uv.values = mesh.positions.iter().flat_map(|p| [0.5 + 0.4 * p[0], 0.5 + 0.4 * p[2]]).collect();
    uv.of_corner = mesh.triangles.as_flattened().to_vec();
    mesh.attributes = vec![normals, uv];
    mesh
}
