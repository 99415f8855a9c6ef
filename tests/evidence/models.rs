//! The models, and ways to place them.

use std::path::{Path, PathBuf};

use rand::{RngExt, rngs::ChaCha8Rng};
use trisect::{Control, Mesh, Solid};

/// The number an environment variable gives, or the usual one.
pub(crate) fn number(variable: &str, usual: u64) -> u64 {
    std::env::var(variable).map_or(usual, |text| text.parse().expect("a number"))
}

/// A folder of `fixtures/`.
pub(crate) fn fixtures(folder: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures").join(folder)
}

/// The folder with all models, if there is one beside the fixtures.
pub(crate) fn model_folder() -> Option<PathBuf> {
    std::env::var_os("TRISECT_MODELS").map(PathBuf::from)
}

/// Every file in a folder and the folders inside it, in the order of their names.
pub(crate) fn files(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let mut entries: Vec<PathBuf> = std::fs::read_dir(folder)
        .unwrap_or_else(|error| panic!("{}: {error}", folder.display()))
        .map(|entry| entry.expect("an entry").path())
        .collect();
    entries.sort();
    for path in entries {
        if path.is_dir() { found.extend(files(&path)) } else { found.push(path) }
    }
    found
}

/// Finds a file by its name, whatever folder it is in.
pub(crate) fn find(name: &str) -> PathBuf {
    let wanted = Path::new(name).file_name().expect("a name");
    let folder = model_folder().unwrap_or_else(|| fixtures(""));
    let found = files(&folder).into_iter().find(|path| path.file_name() == Some(wanted));
    found.unwrap_or_else(|| panic!("{name} is not in {}", folder.display()))
}

/// A model that can be an operand.
pub(crate) struct Model {
    pub(crate) name: String,
    pub(crate) solid: Solid,
}

/// All models that are closed and do not cross themselves, moved to the middle and scaled to a largest extent of one.
pub(crate) fn clean_models() -> Vec<Model> {
    let paths = match model_folder() {
        Some(folder) => files(&folder),
        None => [files(&fixtures("solids")), files(&fixtures("models"))].concat(),
    };
    let clean = |path: &PathBuf| {
        // Textures and notes are among them.
        let mesh = normalised(Mesh::load(path).ok()?)?;
        let solid = Solid::try_from(mesh).ok().filter(|solid| solid.volume() > 0.0)?;
        // As the program does: what touches itself in single vertices would do so in the result as well.
        let solid = if solid.is_manifold() { solid } else { solid.separated().0 };
        let crossings = solid.self_crossings(&Control::new()).expect("no limits");
        let name = path.file_name()?.to_string_lossy().into_owned();
        (crossings.is_clean() && solid.inside_out_shells().is_none()).then_some(Model { name, solid })
    };
    paths.iter().filter_map(clean).collect()
}

fn normalised(mesh: Mesh) -> Option<Mesh> {
    let bounds = mesh.bounds()?;
    let middle = [0, 1, 2].map(|k| 0.5 * (bounds.low[k] + bounds.high[k]));
    let extent = (0..3).map(|k| bounds.high[k] - bounds.low[k]).fold(0.0, f64::max);
    if !(extent > 0.0 && extent.is_finite()) {
        return None;
    }
    mesh.translated(middle.map(|x| -x)).scaled([1.0 / extent; 3]).ok()
}

/// A model turned at random about its middle, and moved by up to `reach` along each axis.
pub(crate) fn placed(model: &Solid, reach: f64, random: &mut ChaCha8Rng) -> Solid {
    // A random unit quaternion, by rejection from the ball.
    let [w, x, y, z] = loop {
        let q = [0; 4].map(|_| random.random_range(-1.0..1.0f64));
        let length = q.iter().map(|c| c * c).sum::<f64>().sqrt();
        if (0.1..=1.0).contains(&length) {
            break q.map(|c| c / length);
        }
    };
    let rows = [
        [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)],
        [2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)],
        [2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)],
    ];
    let matrix: Vec<f64> =
        rows.iter().flat_map(|r| [r[0], r[1], r[2], random.random_range(-reach..=reach)]).collect();
    let mesh = model.mesh().clone().transformed(&matrix).expect("a rotation");
    Solid::try_from(mesh).expect("a turned solid is one")
}
