//! `--recenter`: outputs moved to the origin.

use std::borrow::Cow;

use serde_json::json;
use trisect::Mesh;

use super::argument_groups::Writing;
use super::session::Session;
use super::surface;

/// The mesh to be written, with the normals and at the place that the command line asks for; what it was moved by is said and noted.
pub(crate) fn placed<'m>(mesh: &'m Mesh, writing: &Writing, session: &mut Session<'_>) -> Cow<'m, Mesh> {
    if !writing.recenter {
        return surface::shaded(Cow::Borrowed(mesh), writing.normals);
    }
    let (moved, by) = mesh.clone().recentered();
    session.note("moved_by", json!(by));
    let [x, y, z] = by;
    session.console.say(&format!(
        "moved by {x},{y},{z} (the outputs; --translate={},{},{} moves back)",
        0.0 - x,
        0.0 - y,
        0.0 - z
    ));
    surface::shaded(Cow::Owned(moved), writing.normals)
}
