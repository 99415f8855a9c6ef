//! The functions and constants every formula knows.

use crate::field::{Graph, NodeId, System};

/// Names that are not free in a formula.
pub(super) fn is_known(name: &str) -> bool {
    matches!(name, "x" | "y" | "z") || constant(name).is_some() || arity(name).is_some()
}

pub(super) fn constant(name: &str) -> Option<f64> {
    match name {
        "pi" => Some(std::f64::consts::PI),
        "e" => Some(std::f64::consts::E),
        _ => None,
    }
}

/// Least and greatest number of arguments of a function.
pub(super) fn arity(name: &str) -> Option<(usize, usize)> {
    Some(match name {
        "sin" | "cos" | "tan" | "sqrt" | "exp" | "ln" | "abs" | "round" | "normalise" | "normalize" => (1, 1),
        "min" | "max" | "length" => (1, 64),
        "pow" => (2, 2),
        "clamp" | "circle" => (3, 3),
        "repeat" => (2, 3),
        "rectangle" | "sphere" => (4, 4),
        "block" => (6, 6),
        "torus" => (5, 5),
        "blend" => (5, 5),
        _ => return None,
    })
}

/// Every function's name, for the suggestion in an error.
pub(super) const FUNCTIONS: [&str; 23] = [
    "sin",
    "cos",
    "tan",
    "sqrt",
    "exp",
    "ln",
    "abs",
    "round",
    "normalise",
    "normalize",
    "min",
    "max",
    "length",
    "pow",
    "clamp",
    "circle",
    "repeat",
    "rectangle",
    "sphere",
    "block",
    "torus",
    "blend",
    "system",
];

/// The node of a call with as many arguments as [`arity`] allows.
///
/// # Errors
/// What is wrong with an argument's value.
pub(super) fn call(
    graph: &mut Graph,
    system: System,
    name: &str,
    arguments: &[NodeId],
) -> Result<NodeId, String> {
    Ok(match name {
        "sin" => graph.sin(arguments[0]),
        "cos" => graph.cos(arguments[0]),
        "tan" => {
            let (sine, cosine) = (graph.sin(arguments[0]), graph.cos(arguments[0]));
            graph.div(sine, cosine)
        }
        "sqrt" => graph.sqrt(arguments[0]),
        "exp" => graph.exp(arguments[0]),
        "ln" => graph.ln(arguments[0]),
        "abs" => graph.abs(arguments[0]),
        "round" => graph.round(arguments[0]),
        "normalise" | "normalize" => graph.normalised(arguments[0]),
        "min" => arguments[1..].iter().fold(arguments[0], |a, &b| graph.min(a, b)),
        "max" => arguments[1..].iter().fold(arguments[0], |a, &b| graph.max(a, b)),
        "length" => {
            let squares = squares(graph, arguments);
            graph.sqrt(squares)
        }
        "pow" => graph.pow(arguments[0], arguments[1]),
        "clamp" => {
            let above = graph.max(arguments[0], arguments[1]);
            graph.min(above, arguments[2])
        }
        "repeat" => repeat(graph, arguments)?,
        "circle" | "sphere" => ball(graph, arguments),
        "rectangle" | "block" => block(graph, system, arguments),
        "torus" => torus(graph, arguments),
        "blend" => blend(graph, arguments)?,
        _ => return Err(format!("unknown function `{name}`")),
    })
}

/// An argument that must be a constant.
fn constant_argument(graph: &Graph, name: &str, argument: NodeId, what: &str) -> Result<f64, String> {
    graph.as_constant(argument).ok_or_else(|| format!("{what} of `{name}` must be a constant"))
}

fn repeat(graph: &mut Graph, arguments: &[NodeId]) -> Result<NodeId, String> {
    let period = constant_argument(graph, "repeat", arguments[1], "the period")?;
    if !(period > 0.0) {
        return Err("the period of `repeat` must be positive".to_owned());
    }
    let copies = match arguments.get(2) {
        Some(&copies) => match constant_argument(graph, "repeat", copies, "the number of copies")? {
            copies if (0.0..=1e9).contains(&copies) && copies.fract() == 0.0 => Some(copies as u32),
            _ => return Err("the number of copies of `repeat` must be a whole number".to_owned()),
        },
        None => None,
    };
    Ok(graph.repeated(arguments[0], period, copies))
}

/// Circle and sphere (Choporov 2017): 1 - (x^2 + y^2) / r^2.
fn ball(graph: &mut Graph, arguments: &[NodeId]) -> NodeId {
    let (radius, at) = (arguments[arguments.len() - 1], &arguments[..arguments.len() - 1]);
    let squares = squares(graph, at);
    let radius = graph.square(radius);
    let ratio = graph.div(squares, radius);
    let one = graph.constant(1.0);
    graph.sub(one, ratio)
}

/// Rectangle and block (Choporov 2017): [1 - (2x / w)^2] AND [1 - (2y / h)^2].
fn block(graph: &mut Graph, system: System, arguments: &[NodeId]) -> NodeId {
    let half = arguments.len() / 2;
    let sides: Vec<NodeId> = (0..half)
        .map(|k| {
            let (one, two) = (graph.constant(1.0), graph.constant(2.0));
            let doubled = graph.mul(two, arguments[k]);
            let ratio = graph.div(doubled, arguments[half + k]);
            let square = graph.square(ratio);
            graph.sub(one, square)
        })
        .collect();
    sides[1..].iter().fold(sides[0], |a, &b| graph.and(system, a, b))
}

/// Torus about the axis z (Choporov 2010, w9): 2R sqrt(x^2 + y^2) - x^2 - y^2 - z^2 - R^2 + r^2.
fn torus(graph: &mut Graph, arguments: &[NodeId]) -> NodeId {
    let [x, y, z, large, small] = [0, 1, 2, 3, 4].map(|k| arguments[k]);
    let around = squares(graph, &[x, y]);
    let distance = graph.sqrt(around);
    let off = graph.sub(distance, large);
    let spread = squares(graph, &[off, z]);
    let radius = graph.square(small);
    graph.sub(radius, spread)
}

fn blend(graph: &mut Graph, arguments: &[NodeId]) -> Result<NodeId, String> {
    let amounts = [
        constant_argument(graph, "blend", arguments[2], "the amount")?,
        constant_argument(graph, "blend", arguments[3], "the reach")?,
        constant_argument(graph, "blend", arguments[4], "the reach")?,
    ];
    if amounts[1] == 0.0 || amounts[2] == 0.0 {
        return Err("the reaches of `blend` must not be zero".to_owned());
    }
    Ok(graph.blending(arguments[0], arguments[1], amounts))
}

/// The sum of the squares.
fn squares(graph: &mut Graph, arguments: &[NodeId]) -> NodeId {
    let mut sum = graph.constant(0.0);
    for &argument in arguments {
        let square = graph.square(argument);
        sum = graph.add(sum, square);
    }
    sum
}
