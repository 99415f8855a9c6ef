//! The formula language: expressions of `x`, `y`, `z` as text, with definitions and parameters.
//!
//! ```
//! use trisect::field::{Formula, System};
//! let formula = Formula::parse("(1 - x^2) and (1 - y^2) or not circle(x - 1, y, 0.5)")?;
//! let field = formula.compile(System::R0, &[], &[])?;
//! assert!(field.at([0.2, 0.2, 0.0]) > 0.0);
//! # Ok::<(), trisect::field::FormulaError>(())
//! ```
//!
//! `docs/fields.md` has the whole language.

mod builtin;
mod lower;
mod syntax;
mod token;

use std::fmt;

use super::{Expression, Graph, NodeId, System};
pub(crate) use lower::named_system;
use syntax::Program;

/// A parsed formula.
#[derive(Clone, Debug)]
pub struct Formula {
    program: Program,
    text: String,
}

/// What is wrong with a formula, and where.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FormulaError {
    /// What is wrong and, where that helps, how to mend it.
    pub what: String,
    /// Line, from 1.
    pub line: usize,
    /// Column in characters, from 1.
    pub column: usize,
    /// The line's text.
    pub excerpt: String,
}

impl fmt::Display for FormulaError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "formula, line {}, column {}: {}", self.line, self.column, self.what)?;
        write!(f, "\n    {}\n    {:>width$}", self.excerpt, "^", width = self.column)
    }
}

impl std::error::Error for FormulaError {}

/// A fault at a place in the text, before line and column are known.
#[derive(Debug)]
struct Fault {
    at: usize,
    what: String,
}

impl Fault {
    fn new(at: usize, what: impl Into<String>) -> Self {
        Self { at, what: what.into() }
    }

    fn located(self, text: &str) -> FormulaError {
        let at = (0..=self.at.min(text.len())).rev().find(|&at| text.is_char_boundary(at)).unwrap_or(0);
        let before = &text[..at];
        let start = before.rfind('\n').map_or(0, |newline| newline + 1);
        let end = text[at..].find('\n').map_or(text.len(), |newline| at + newline);
        FormulaError {
            what: self.what,
            line: before.matches('\n').count() + 1,
            column: text[start..at].chars().count() + 1,
            excerpt: text[start..end].trim_end_matches('\r').to_owned(),
        }
    }
}

impl Formula {
    /// Parses a formula.
    ///
    /// # Errors
    /// What is wrong with the text, with line and column.
    pub fn parse(text: &str) -> Result<Self, FormulaError> {
        let program = token::tokens(text).and_then(|tokens| syntax::program(&tokens, text.len()));
        match program {
            Ok(program) => Ok(Self { program, text: text.to_owned() }),
            Err(fault) => Err(fault.located(text)),
        }
    }

    /// Names the formula uses without defining them: parameters and other fields, in order of first use.
    #[must_use]
    pub fn free_names(&self) -> Vec<String> {
        self.program.free_names()
    }

    /// The expression, with R-functions of `system` (unless the formula sets its own), the `parameters` as constants,
    /// and the `fields` as functions of one to three coordinates.
    ///
    /// # Errors
    /// Unknown names, wrong numbers of arguments, definitions that call themselves, formulas that unfold to more
    /// than a million operations.
    pub fn compile(
        &self,
        system: System,
        parameters: &[(String, f64)],
        fields: &[(String, Expression)],
    ) -> Result<Expression, FormulaError> {
        let mut graph = Graph::new();
        let fields: Vec<(String, NodeId)> = fields
            .iter()
            .map(|(name, field)| {
                let (other, root) = field.graph();
                (name.clone(), graph.import(other, root))
            })
            .collect();
        let root = lower::lower(&self.program, &mut graph, system, parameters, &fields)
            .map_err(|fault| fault.located(&self.text))?;
        Ok(Expression::new(graph, root))
    }
}
