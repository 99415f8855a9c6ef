//! The grammar: definitions, then an expression, parsed by operator precedence.

use super::Fault;
use super::token::{Placed, Token};

/// Deepest nesting of parentheses, calls and prefix operators.
const DEEPEST: usize = 200;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Infix {
    Or,
    And,
    Add,
    Sub,
    Mul,
    Div,
    Pow,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Prefix {
    Not,
    Minus,
    Plus,
}

#[derive(Clone, Debug)]
pub(super) enum Term {
    Number(f64),
    Name(String),
    Call(String, Vec<usize>),
    Prefix(Prefix, usize),
    Infix(Infix, usize, usize),
}

/// `name = body` or `name(parameters) = body`.
#[derive(Clone, Debug)]
pub(super) struct Definition {
    pub(super) name: String,
    /// Nothing for a plain value.
    pub(super) parameters: Option<Vec<String>>,
    pub(super) body: usize,
    pub(super) at: usize,
}

/// A whole formula. Terms are numbered operands first, each with its place in the text.
#[derive(Clone, Debug, Default)]
pub(super) struct Program {
    pub(super) terms: Vec<(Term, usize)>,
    pub(super) definitions: Vec<Definition>,
    /// `system NAME` or `system NAME(number)`.
    pub(super) system: Option<(String, Option<f64>, usize)>,
    pub(super) result: usize,
}

impl Program {
    pub(super) fn free_names(&self) -> Vec<String> {
        let mut names: Vec<String> = Vec::new();
        for (term, _) in &self.terms {
            if let Term::Name(name) | Term::Call(name, _) = term {
                let defined = self.definitions.iter().any(|definition| {
                    definition.name == *name
                        || definition.parameters.as_ref().is_some_and(|list| list.contains(name))
                });
                if !defined && !super::builtin::is_known(name) && !names.contains(name) {
                    names.push(name.clone());
                }
            }
        }
        names
    }
}

struct Parser<'a> {
    tokens: &'a [Placed],
    next: usize,
    end: usize,
    program: Program,
}

pub(super) fn program(tokens: &[Placed], end: usize) -> Result<Program, Fault> {
    let mut parser = Parser { tokens, next: 0, end, program: Program::default() };
    while parser.definition()? {}
    if parser.peek().is_none() {
        return Err(Fault::new(end, "expected an expression: the formula's value"));
    }
    let result = parser.expression(0, 0)?;
    parser.take(';');
    if parser.peek().is_some() {
        return Err(parser.unexpected("the end of the formula (definitions come before the expression)"));
    }
    parser.program.result = result;
    Ok(parser.program)
}

impl Parser<'_> {
    fn peek(&self) -> Option<&Token> {
        self.tokens.get(self.next).map(|placed| &placed.token)
    }

    fn at(&self) -> usize {
        self.tokens.get(self.next).map_or(self.end, |placed| placed.at)
    }

    fn is(&self, ahead: usize, sign: char) -> bool {
        self.tokens.get(self.next + ahead).is_some_and(|placed| placed.token == Token::Sign(sign))
    }

    fn take(&mut self, sign: char) -> bool {
        let found = self.is(0, sign);
        self.next += usize::from(found);
        found
    }

    fn expect(&mut self, sign: char, purpose: &str) -> Result<(), Fault> {
        if self.take(sign) { Ok(()) } else { Err(self.unexpected(&format!("`{sign}` {purpose}"))) }
    }

    fn unexpected(&self, wanted: &str) -> Fault {
        let found = match self.peek() {
            None => "the formula ends".to_owned(),
            Some(Token::Number(value)) => format!("found the number {value}"),
            Some(Token::Name(name)) => format!("found `{name}`"),
            Some(Token::And) => "found `and`".to_owned(),
            Some(Token::Or) => "found `or`".to_owned(),
            Some(Token::Not) => "found `not`".to_owned(),
            Some(Token::Sign(sign)) => format!("found `{sign}`"),
        };
        Fault::new(self.at(), format!("expected {wanted}, but {found}"))
    }

    fn name(&mut self, purpose: &str) -> Result<String, Fault> {
        match self.peek() {
            Some(Token::Name(name)) => {
                let name = name.clone();
                self.next += 1;
                Ok(name)
            }
            _ => Err(self.unexpected(purpose)),
        }
    }

    /// Parses a definition or a `system` statement, if there is one.
    fn definition(&mut self) -> Result<bool, Fault> {
        let at = self.at();
        if self.peek() == Some(&Token::Name("system".to_owned())) && !self.is(1, '=') && !self.is(1, '(') {
            self.next += 1;
            let name = self.name("the name of a system: R1, R0, R0m(order) or Ralpha(alpha)")?;
            let mut number = None;
            if self.take('(') {
                let sign = if self.take('-') { -1.0 } else { 1.0 };
                match self.peek() {
                    Some(&Token::Number(value)) => number = Some(sign * value),
                    _ => return Err(self.unexpected("a number")),
                }
                self.next += 1;
                self.expect(')', "after the system's number")?;
            }
            self.expect(';', "after the system")?;
            self.program.system = Some((name, number, at));
            return Ok(true);
        }
        let Some(parameters) = self.head() else { return Ok(false) };
        let name = self.name("a name")?;
        let list = parameters.then(|| self.parameters()).transpose()?;
        self.expect('=', "in a definition")?;
        let body = self.expression(0, 0)?;
        self.expect(';', "after a definition")?;
        self.program.definitions.push(Definition { name, parameters: list, body, at });
        Ok(true)
    }

    /// Whether a definition begins here (`name =` or `name(names) =`), and if so whether it has parameters.
    fn head(&self) -> Option<bool> {
        let Some(Token::Name(_)) = self.peek() else { return None };
        if self.is(1, '=') {
            return Some(false);
        }
        if !self.is(1, '(') {
            return None;
        }
        let mut ahead = 2;
        while let Some(Token::Name(_) | Token::Sign(',')) =
            self.tokens.get(self.next + ahead).map(|p| &p.token)
        {
            ahead += 1;
        }
        (self.is(ahead, ')') && self.is(ahead + 1, '=')).then_some(true)
    }

    fn parameters(&mut self) -> Result<Vec<String>, Fault> {
        self.expect('(', "before parameters")?;
        let mut list: Vec<String> = Vec::new();
        while !self.take(')') {
            if !list.is_empty() {
                self.expect(',', "between parameters")?;
            }
            let at = self.at();
            let name = self.name("a parameter's name")?;
            if list.contains(&name) {
                return Err(Fault::new(at, format!("parameter `{name}` is named twice")));
            }
            list.push(name);
        }
        Ok(list)
    }

    fn push(&mut self, term: Term, at: usize) -> usize {
        self.program.terms.push((term, at));
        self.program.terms.len() - 1
    }

    /// An expression of operators that bind at least as tightly as `least`.
    fn expression(&mut self, least: u8, depth: usize) -> Result<usize, Fault> {
        if depth > DEEPEST {
            return Err(Fault::new(self.at(), format!("nested more than {DEEPEST} deep")));
        }
        let mut left = self.operand(depth)?;
        while let Some((operator, binding, right_binding)) = self.peek().and_then(infix) {
            if binding < least {
                break;
            }
            let at = self.at();
            self.next += 1;
            let right = self.expression(right_binding, depth + 1)?;
            left = self.push(Term::Infix(operator, left, right), at);
        }
        Ok(left)
    }

    fn operand(&mut self, depth: usize) -> Result<usize, Fault> {
        let at = self.at();
        match self.peek().cloned() {
            Some(Token::Number(value)) => {
                self.next += 1;
                Ok(self.push(Term::Number(value), at))
            }
            Some(Token::Name(name)) => {
                self.next += 1;
                if !self.take('(') {
                    return Ok(self.push(Term::Name(name), at));
                }
                let mut arguments = Vec::new();
                while !self.take(')') {
                    if !arguments.is_empty() {
                        self.expect(',', "between arguments, or `)` after them")?;
                    }
                    arguments.push(self.expression(0, depth + 1)?);
                }
                Ok(self.push(Term::Call(name, arguments), at))
            }
            Some(Token::Sign('(')) => {
                self.next += 1;
                let inner = self.expression(0, depth + 1)?;
                self.expect(')', "to close the parenthesis")?;
                Ok(inner)
            }
            Some(token) => {
                let (operator, binding) = match token {
                    Token::Not => (Prefix::Not, 30),
                    Token::Sign('-') => (Prefix::Minus, 60),
                    Token::Sign('+') => (Prefix::Plus, 60),
                    _ => return Err(self.unexpected("a number, a name or `(`")),
                };
                self.next += 1;
                let operand = self.expression(binding, depth + 1)?;
                Ok(self.push(Term::Prefix(operator, operand), at))
            }
            None => Err(self.unexpected("a number, a name or `(`")),
        }
    }
}

/// An infix operator with how tightly it binds, and what its right side must bind at least.
fn infix(token: &Token) -> Option<(Infix, u8, u8)> {
    Some(match token {
        Token::Or => (Infix::Or, 10, 11),
        Token::And => (Infix::And, 20, 21),
        Token::Sign('+') => (Infix::Add, 40, 41),
        Token::Sign('-') => (Infix::Sub, 40, 41),
        Token::Sign('*') => (Infix::Mul, 50, 51),
        Token::Sign('/') => (Infix::Div, 50, 51),
        // Right associative, and tighter than a minus before it: -x^2 is -(x^2).
        Token::Sign('^') => (Infix::Pow, 70, 60),
        _ => return None,
    })
}
