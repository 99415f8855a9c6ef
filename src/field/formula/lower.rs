//! From a parsed formula to a graph: definitions unfolded, names looked up.

use rustc_hash::FxHashMap;

use super::syntax::{Definition, Infix, Prefix, Program, Term};
use super::{Fault, builtin};
use crate::field::{Graph, NodeId, System};

/// Most terms a formula may unfold to.
const MOST: usize = 1_000_000;
/// Deepest calls of definitions from definitions.
const DEEPEST: usize = 100;

struct Lowering<'a> {
    program: &'a Program,
    graph: &'a mut Graph,
    system: System,
    parameters: FxHashMap<&'a str, f64>,
    fields: FxHashMap<&'a str, NodeId>,
    /// Plain definitions already lowered.
    values: FxHashMap<usize, NodeId>,
    /// Definitions being unfolded.
    open: Vec<usize>,
    spent: usize,
}

pub(super) fn lower(
    program: &Program,
    graph: &mut Graph,
    system: System,
    parameters: &[(String, f64)],
    fields: &[(String, NodeId)],
) -> Result<NodeId, Fault> {
    let system = match &program.system {
        None => system,
        Some((name, number, at)) => named_system(name, *number).map_err(|what| Fault::new(*at, what))?,
    };
    for (index, definition) in program.definitions.iter().enumerate() {
        if program.definitions[..index].iter().any(|earlier| earlier.name == definition.name) {
            return Err(Fault::new(definition.at, format!("`{}` is defined twice", definition.name)));
        }
        if builtin::is_known(&definition.name) {
            let what = format!("`{}` is built in and cannot be defined anew", definition.name);
            return Err(Fault::new(definition.at, what));
        }
    }
    let mut lowering = Lowering {
        program,
        graph,
        system,
        parameters: parameters.iter().map(|(name, value)| (name.as_str(), *value)).collect(),
        fields: fields.iter().map(|(name, node)| (name.as_str(), *node)).collect(),
        values: FxHashMap::default(),
        open: Vec::new(),
        spent: 0,
    };
    lowering.term(program.result, &FxHashMap::default())
}

/// A system by its name in formulas and model files.
pub(crate) fn named_system(name: &str, number: Option<f64>) -> Result<System, String> {
    let system = match (name, number) {
        ("R1" | "r1", None) => System::R1,
        ("R0" | "r0", None) => System::R0,
        ("R0m" | "r0m", Some(order)) if order >= 0.0 && order.fract() == 0.0 => System::R0m(order as u32),
        ("Ralpha" | "ralpha", Some(alpha)) => System::Alpha(alpha),
        _ => return Err("unknown system; known: R1, R0, R0m(order), Ralpha(alpha)".to_owned()),
    };
    if system.is_valid() {
        Ok(system)
    } else {
        Err(format!("{system} is out of range: -1 < alpha <= 1, order at most 64"))
    }
}

type Arguments = FxHashMap<String, NodeId>;

impl Lowering<'_> {
    fn term(&mut self, index: usize, arguments: &Arguments) -> Result<NodeId, Fault> {
        let program = self.program;
        let (term, at) = &program.terms[index];
        self.spent += 1;
        if self.spent > MOST {
            return Err(Fault::new(*at, format!("the formula unfolds to more than {MOST} operations")));
        }
        match term {
            Term::Number(value) => Ok(self.graph.constant(*value)),
            Term::Name(name) => self.name(name, *at, arguments),
            Term::Call(name, operands) => {
                let operands = operands
                    .iter()
                    .map(|&operand| self.term(operand, arguments))
                    .collect::<Result<Vec<NodeId>, Fault>>()?;
                self.call(name, &operands, *at)
            }
            Term::Prefix(operator, operand) => {
                let operand = self.term(*operand, arguments)?;
                Ok(match operator {
                    Prefix::Not | Prefix::Minus => self.graph.neg(operand),
                    Prefix::Plus => operand,
                })
            }
            Term::Infix(..) => self.chain(index, arguments),
        }
    }

    /// A chain of infix operators, down its left side without recursion: sums may have thousands of terms.
    fn chain(&mut self, index: usize, arguments: &Arguments) -> Result<NodeId, Fault> {
        let mut pending = Vec::new();
        let mut first = index;
        while let (Term::Infix(operator, left, right), at) = &self.program.terms[first] {
            pending.push((*operator, *right, *at));
            first = *left;
        }
        let mut value = self.term(first, arguments)?;
        for (operator, right, _) in pending.into_iter().rev() {
            let right = self.term(right, arguments)?;
            value = match operator {
                Infix::Or => self.graph.or(self.system, value, right),
                Infix::And => self.graph.and(self.system, value, right),
                Infix::Add => self.graph.add(value, right),
                Infix::Sub => self.graph.sub(value, right),
                Infix::Mul => self.graph.mul(value, right),
                Infix::Div => self.graph.div(value, right),
                Infix::Pow => self.graph.pow(value, right),
            };
        }
        Ok(value)
    }

    fn name(&mut self, name: &str, at: usize, arguments: &Arguments) -> Result<NodeId, Fault> {
        if let Some(&node) = arguments.get(name) {
            return Ok(node);
        }
        if let Some(axis) = ["x", "y", "z"].iter().position(|&axis| axis == name) {
            return Ok(self.graph.axes()[axis]);
        }
        if let Some((index, definition)) = self.definition(name) {
            if definition.parameters.is_some() {
                return Err(Fault::new(at, format!("`{name}` is a function: give it its arguments")));
            }
            return self.value(index, at);
        }
        if let Some(&value) = self.parameters.get(name) {
            return Ok(self.graph.constant(value));
        }
        if let Some(&node) = self.fields.get(name) {
            return Ok(node);
        }
        match builtin::constant(name) {
            Some(value) => Ok(self.graph.constant(value)),
            None if builtin::arity(name).is_some() => {
                Err(Fault::new(at, format!("`{name}` is a function: give it its arguments")))
            }
            None => Err(Fault::new(at, format!("unknown name `{name}`{}", self.suggestion(name)))),
        }
    }

    fn definition(&self, name: &str) -> Option<(usize, &Definition)> {
        self.program.definitions.iter().enumerate().find(|(_, definition)| definition.name == name)
    }

    fn enter(&mut self, index: usize, at: usize) -> Result<(), Fault> {
        let name = &self.program.definitions[index].name;
        if self.open.contains(&index) {
            return Err(Fault::new(at, format!("`{name}` is defined by itself")));
        }
        if self.open.len() >= DEEPEST {
            return Err(Fault::new(at, format!("definitions call each other more than {DEEPEST} deep")));
        }
        self.open.push(index);
        Ok(())
    }

    fn value(&mut self, index: usize, at: usize) -> Result<NodeId, Fault> {
        if let Some(&node) = self.values.get(&index) {
            return Ok(node);
        }
        self.enter(index, at)?;
        let node = self.term(self.program.definitions[index].body, &FxHashMap::default())?;
        self.open.pop();
        self.values.insert(index, node);
        Ok(node)
    }

    fn call(&mut self, name: &str, operands: &[NodeId], at: usize) -> Result<NodeId, Fault> {
        let wrong = |wanted: String| {
            Fault::new(at, format!("`{name}` takes {wanted}, but is given {}", count(operands.len())))
        };
        let program = self.program;
        if let Some((index, _)) = self.definition(name) {
            let definition = &program.definitions[index];
            let Some(parameters) = &definition.parameters else {
                return Err(Fault::new(at, format!("`{name}` is a value, not a function")));
            };
            if parameters.len() != operands.len() {
                return Err(wrong(count(parameters.len())));
            }
            self.enter(index, at)?;
            let arguments = parameters.iter().cloned().zip(operands.iter().copied()).collect();
            let node = self.term(definition.body, &arguments)?;
            self.open.pop();
            return Ok(node);
        }
        if let Some(&field) = self.fields.get(name) {
            if operands.is_empty() || operands.len() > 3 {
                return Err(wrong("one to three coordinates".to_owned()));
            }
            let mut point = self.graph.axes();
            point[..operands.len()].copy_from_slice(operands);
            return Ok(self.graph.substitute(field, point));
        }
        match builtin::arity(name) {
            None => {
                let what = format!("unknown function `{name}`{}", self.suggestion(name));
                Err(Fault::new(at, what))
            }
            Some((least, most)) if operands.len() < least || operands.len() > most => {
                Err(wrong(if least == most { count(least) } else { format!("{least} to {most} arguments") }))
            }
            Some(_) => {
                builtin::call(self.graph, self.system, name, operands).map_err(|what| Fault::new(at, what))
            }
        }
    }

    /// A known name within two typing errors of `name`.
    fn suggestion(&self, name: &str) -> String {
        let defined = self.program.definitions.iter().map(|definition| definition.name.as_str());
        let mut known: Vec<&str> = defined
            .chain(self.parameters.keys().copied())
            .chain(self.fields.keys().copied())
            .chain(builtin::FUNCTIONS)
            .collect();
        known.sort_unstable();
        known
            .into_iter()
            .map(|candidate| (distance(name, candidate), candidate))
            .filter(|&(distance, candidate)| distance <= 2 && distance < candidate.len())
            .min()
            .map_or(String::new(), |(_, candidate)| format!("; did you mean `{candidate}`?"))
    }
}

fn count(arguments: usize) -> String {
    if arguments == 1 { "1 argument".to_owned() } else { format!("{arguments} arguments") }
}

/// Levenshtein's distance.
fn distance(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, x) in a.chars().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, &y) in b.iter().enumerate() {
            let replaced = diagonal + usize::from(x != y);
            diagonal = row[j + 1];
            row[j + 1] = replaced.min(diagonal + 1).min(row[j] + 1);
        }
    }
    row[b.len()]
}
