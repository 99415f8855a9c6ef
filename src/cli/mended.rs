//! What mending did to an input, in words.

use trisect::mesh::{Fault, Mending};

use super::words::{counted, short};

/// Warnings of what mending left out: pieces of surface that the file has and the operand has not. (What was joined, split
/// or stored twice is no warning: the surface is the file's but for rounding.)
pub(crate) fn left_out(mending: &Mending) -> Vec<String> {
    let mut warnings = Vec::new();
    for (one, several, fault) in mending.left_out() {
        let mut text = fault.text(one, several, 2);
        if one.contains("open part") {
            text.push_str(&format!(" ({}, area {})", parts(mending), short(mending.open_area)));
        }
        warnings.push(text);
    }
    warnings
}

fn parts(mending: &Mending) -> String {
    counted(mending.open_part_count, "part")
}

/// What mending does, in a few words.
pub(crate) fn effect(mending: &Mending) -> String {
    let mut text = mending.to_string();
    if let Some(distance) = mending.distance {
        text.push_str(&format!(", by a distance of {distance:.3e}"));
    }
    if mending.open_part_count > 0 {
        text.push_str(&format!(", {} of area {}", parts(mending), short(mending.open_area)));
    }
    text
}

/// How many vertices `--weld` joined.
pub(crate) fn welded_vertices(mending: &Mending) -> usize {
    if mending.distance.is_some() { mending.seams.count } else { 0 }
}

/// What a summary line says of mending.
pub(crate) fn in_line(mending: &Mending) -> String {
    let mut line = String::new();
    let mut done = mending.clone();
    done.turned = 0;
    if !done.is_none() {
        line.push_str(&format!(", mended: {}", effect(&done)));
    }
    if mending.turned > 0 {
        line.push_str(", turned outwards");
    }
    line
}

/// A line for each kind of what was mended, with its first places.
pub(crate) fn listed(mending: &Mending) -> Vec<String> {
    let kinds = mending.sewn().into_iter().chain(mending.left_out());
    let line = |(one, several, fault): (&str, &str, &Fault)| fault.text(one, several, usize::MAX);
    kinds.map(line).collect()
}

/// What a summary line says of `--weld` where nothing else is mended.
pub(crate) fn welded(vertices: usize) -> String {
    match vertices {
        0 => String::new(),
        1 => ", 1 vertex welded".into(),
        several => format!(", {several} vertices welded"),
    }
}
