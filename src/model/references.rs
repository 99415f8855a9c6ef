//! Nodes that refer to others by name: looked up, and refused where they go in circles.

use super::{Kind, Model, fault};
use crate::Error;

/// Longest chain of nodes in nodes.
const DEEPEST: usize = 400;

/// Looks up all names.
pub(super) fn resolve(model: &mut Model) -> Result<(), Error> {
    let names = model.names.clone();
    for node in &mut model.nodes {
        match &mut node.kind {
            Kind::Reference(name, target) => match names.get(name) {
                Some(&index) => *target = index,
                None => {
                    let what = format!("there is no node named `{name}`, and it is not the name of a file");
                    return Err(fault(what).in_node(&node.label));
                }
            },
            Kind::Formula { formula, uses, .. } => {
                for name in formula.free_names() {
                    if let Some(&index) = names.get(&name) {
                        uses.push((name, index));
                    }
                }
            }
            _ => {}
        }
    }
    Ok(())
}

/// Refuses cycles and chains too long to follow.
pub(super) fn check_order(model: &Model) -> Result<(), Error> {
    let mut finished = vec![false; model.nodes.len()];
    for start in 0..model.nodes.len() {
        let mut path: Vec<(usize, Vec<usize>)> = Vec::new();
        if !finished[start] {
            path.push((start, model.operands(start)));
        }
        while let Some((node, pending)) = path.last_mut() {
            let node = *node;
            let Some(next) = pending.pop() else {
                finished[node] = true;
                path.pop();
                continue;
            };
            if let Some(from) = path.iter().position(|entry| entry.0 == next) {
                let round: Vec<&str> =
                    path[from..].iter().map(|entry| model.nodes[entry.0].label.as_str()).collect();
                let what = format!("cyclic reference: {} -> {}", round.join(" -> "), round[0]);
                return Err(fault(what).in_node(&model.nodes[next].label));
            }
            if path.len() >= DEEPEST {
                let what = format!("nodes are nested more than {DEEPEST} deep");
                return Err(fault(what).in_node(&model.nodes[next].label));
            }
            if !finished[next] {
                path.push((next, model.operands(next)));
            }
        }
    }
    Ok(())
}
