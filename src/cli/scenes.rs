//! Scenes that stay around what a verb makes of one of their nodes.

use trisect::io::{Contents, KeptScene, WriteOptions};

use super::argument_groups::{SceneChoice, Writing};
use super::fault::Fault;
use super::requests::Request;

/// What an input loses that its file holds besides meshes; the first one nothing if its scene stays.
pub(crate) fn lost(contents: &Contents, writing: &Writing, index: usize) -> Vec<String> {
    if index == 0 && writing.scene == SceneChoice::Keep { Vec::new() } else { contents.not_kept() }
}

/// Names the node of the first input, if `--node` does, and tells whether its scene stays.
pub(crate) fn name_node(requests: &mut [Request], writing: &Writing) -> Result<(), Fault> {
    if let Some(first) = requests.first_mut() {
        first.is_place = writing.scene == SceneChoice::Keep && !first.is_standard();
    }
    let Some(node) = &writing.node else { return Ok(()) };
    match requests.first_mut() {
        Some(first) if first.part.is_none() => first.part = Some(node.clone()),
        Some(first) => {
            return Err(Fault::usage(format!(
                "--node {node} and the name in {} both mean a node of the first input; leave one out",
                first.name()
            )));
        }
        None => {}
    }
    Ok(())
}

/// Refuses what verbs without a scene among their inputs cannot do.
pub(crate) fn refuse(writing: &Writing) -> Result<(), Fault> {
    if writing.scene == SceneChoice::Keep || writing.node.is_some() {
        return Err(Fault::usage(
            "--scene and --node are for verbs whose first input can be a node of a scene: booleans, cut, split, trim and convert",
        ));
    }
    Ok(())
}

/// The options with the scene of the first input, if that is to be kept.
pub(crate) fn kept(
    options: WriteOptions,
    writing: &Writing,
    first: Option<&Request>,
) -> Result<WriteOptions, Fault> {
    let Some(first) = first.filter(|_| writing.scene == SceneChoice::Keep) else { return Ok(options) };
    let part = first.part.as_ref().filter(|_| !first.is_standard());
    let Some(part) = part else {
        return Err(Fault::usage(
            "--scene keep takes a node of a glTF file as the first input: FILE.glb#NODE, or --node NODE",
        ));
    };
    // A pattern that means one node has found its name.
    let found = first.chosen.as_ref().and_then(|chosen| chosen.name.clone());
    let name = if part.contains(['*', '?']) { found.unwrap_or_else(|| part.clone()) } else { part.clone() };
    Ok(options.in_scene(KeptScene::load(&first.path, name)?))
}
