//! What a verb wants of its operands: an operation, or expressions.

use trisect::{BooleanOptions, Expression, Leaf, Operation, Outcome, Solid};

use super::arguments::Combination;
use super::fault::Fault;
use super::half_spaces;
use super::requests::Request;

/// What is wanted.
#[derive(Clone, Debug)]
pub(crate) enum Task {
    Operation(Operation),
    /// What the surface of one input winds around.
    Resolve,
    /// What each of some expressions is, in words, and what its outputs' names end with.
    Expressions(Vec<Part>),
}

/// One expression of several.
#[derive(Clone, Debug)]
pub(crate) struct Part {
    pub(crate) name: String,
    /// Appended to the names of outputs; empty if there is but one expression.
    pub(crate) suffix: &'static str,
    pub(crate) expression: Expression,
    /// Its last operands, which are no inputs.
    pub(crate) half_spaces: Vec<Leaf<'static>>,
}

impl Task {
    /// What `combine` asks for, of so many inputs. Takes the names of operands off the paths.
    pub(crate) fn of(combination: &Combination, requests: &mut [Request]) -> Result<Self, Fault> {
        let names = names(requests);
        let one = |name: String, expression, half_spaces| {
            Self::Expressions(vec![Part { name, suffix: "", expression, half_spaces }])
        };
        if let Some(text) = &combination.expr {
            let (named, of_half_spaces, half_spaces) = half_spaces::named(text)?;
            let all = [&names[..], &of_half_spaces[..]].concat();
            let expression =
                Expression::parse(&named, &all).map_err(|error| Fault::usage(format!("--expr: {error}")))?;
            if let Some(unused) = (0..names.len()).find(|&i| !expression.operands().contains(&i)) {
                return Err(Fault::usage(format!(
                    "--expr does not name operand {} ({})",
                    names[unused],
                    requests[unused].name()
                )));
            }
            return Ok(one(text.clone(), expression, half_spaces));
        }
        let operand = Expression::Operand;
        if let Some(count) = combination.at_least {
            if usize::from(count) > names.len() {
                return Err(Fault::usage(format!("--at-least {count} of {} inputs is nothing", names.len())));
            }
            let expression = Expression::AtLeast(count.into(), (0..names.len()).map(operand).collect());
            return Ok(one(format!("what is in at least {count}"), expression, Vec::new()));
        }
        if names.len() != 2 {
            return Err(Fault::usage(format!("--all takes two inputs, and there are {}", names.len())));
        }
        let part = |suffix: &'static str, expression: Expression| Part {
            name: suffix[1..].to_owned(),
            suffix,
            expression,
            half_spaces: Vec::new(),
        };
        let both = || vec![operand(0), operand(1)];
        Ok(Self::Expressions(vec![
            part("-union", Expression::Union(both())),
            part("-intersection", Expression::Intersection(both())),
            part("-difference", Expression::Difference(both())),
            part("-reverse", Expression::Difference(vec![operand(1), operand(0)])),
        ]))
    }

    /// The task in words, as the object of a sentence.
    pub(crate) fn words(&self) -> String {
        match self {
            Self::Operation(operation) => format!("the {operation}"),
            Self::Resolve => "what is inside".into(),
            Self::Expressions(parts) => {
                parts.iter().map(|part| part.name.as_str()).collect::<Vec<_>>().join(", ")
            }
        }
    }

    /// How many inputs there must be.
    pub(crate) fn least_inputs(&self) -> usize {
        match self {
            Self::Operation(Operation::Union) | Self::Resolve | Self::Expressions(_) => 1,
            Self::Operation(_) => 2,
        }
    }

    /// Whether all inputs but the first are taken off it.
    pub(crate) fn is_difference(&self) -> bool {
        matches!(self, Self::Operation(Operation::Difference))
    }

    /// Whether inputs are known by their places, so that each must stay one operand.
    pub(crate) fn numbers_inputs(&self) -> bool {
        match self {
            Self::Operation(_) => false,
            Self::Resolve | Self::Expressions(_) => true,
        }
    }

    /// The ends of the names of outputs.
    pub(crate) fn suffixes(&self) -> Vec<&'static str> {
        match self {
            Self::Operation(_) | Self::Resolve => vec![""],
            Self::Expressions(parts) => parts.iter().map(|part| part.suffix).collect(),
        }
    }

    /// The results, one for each suffix.
    pub(crate) fn run(&self, options: &BooleanOptions, operands: &[&Solid]) -> Result<Vec<Outcome>, Fault> {
        let all = operands.iter().copied();
        match self {
            Self::Operation(operation) => Ok(vec![options.run(*operation, all)?]),
            Self::Resolve => match operands {
                [operand] => Ok(vec![options.resolve(operand)?]),
                _ => Err(Fault::usage(format!("resolve takes one operand, not {}", operands.len()))),
            },
            Self::Expressions(parts) if parts.len() == 1 => {
                let Part { expression, half_spaces, .. } = &parts[0];
                let leaves: Vec<Leaf<'_>> = all.map(Leaf::Solid).chain(half_spaces.iter().copied()).collect();
                Ok(vec![options.evaluate_leaves(expression, &leaves)?])
            }
            Self::Expressions(parts) => {
                let expressions: Vec<Expression> = parts.iter().map(|part| part.expression.clone()).collect();
                Ok(options.evaluate_all(&expressions, all)?)
            }
        }
    }
}

/// The names of the operands: a, b, c and so on by their places, or those before `=` in `name=file`, which are taken off.
fn names(requests: &mut [Request]) -> Vec<String> {
    let mut names = Vec::new();
    for (index, request) in requests.iter_mut().enumerate() {
        let path = request.path.to_string_lossy().into_owned();
        let given = path.split_once('=').filter(|(name, file)| {
            let is_name = !name.is_empty() && name.chars().all(|c| c.is_alphanumeric() || c == '_');
            // A file whose own name has the sign in it is that file.
            is_name && !file.is_empty() && !request.path.exists()
        });
        names.push(match given {
            Some((name, file)) => {
                request.path = file.into();
                name.to_owned()
            }
            None => letter(index),
        });
    }
    names
}

/// a to z, then a1 to z1 and so on.
fn letter(index: usize) -> String {
    let letter = char::from(b'a' + (index % 26) as u8);
    if index < 26 { letter.to_string() } else { format!("{letter}{}", index / 26) }
}
