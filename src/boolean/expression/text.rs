//! Expressions as text.

use std::str::FromStr;

use super::Expression;

/// A text that is no expression.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("expression, character {}: {problem}", .place + 1)]
#[non_exhaustive]
pub struct ExpressionError {
    /// Where, in characters from the start.
    pub place: usize,
    /// What is wrong there.
    pub problem: String,
}

/// The deepest nesting of parentheses that is read.
const DEEPEST: usize = 200;
/// The most changes between unions and differences that are read: each puts what is to the left of it in another set.
const MOST_CHANGES: usize = 500;

impl Expression {
    /// Reads an expression. Operands are called by `names`, by their places. `+` or `|` is a union, `-` a difference, `^` a
    /// symmetric difference and `&` an intersection, which binds more tightly than `^`, and that more tightly than `+` and `-`;
    /// equals are taken from left to right. `atleast(2, a, b, c)` is what is in at least two of three.
    ///
    /// ```
    /// use trisect::Expression::{self, *};
    ///
    /// let read = Expression::parse("body - (hole + slot)", &["body", "hole", "slot"])?;
    /// assert_eq!(read, Difference(vec![Operand(0), Union(vec![Operand(1), Operand(2)])]));
    /// assert_eq!("a & b - c".parse(), Ok(Difference(vec![Intersection(vec![Operand(0), Operand(1)]), Operand(2)])));
    /// # Ok::<(), trisect::ExpressionError>(())
    /// ```
    ///
    /// # Errors
    /// [`ExpressionError`] with the place.
    pub fn parse(text: &str, names: &[impl AsRef<str>]) -> Result<Self, ExpressionError> {
        let place_of = |name: &str| names.iter().position(|known| known.as_ref() == name);
        let known = || names.iter().map(AsRef::as_ref).collect::<Vec<_>>().join(", ");
        Parser {
            text: text.chars().collect(),
            at: 0,
            depth: 0,
            changes: 0,
            place_of: &place_of,
            known: &known,
        }
        .whole()
    }
}

/// Operands are called a, b, c and so on.
impl FromStr for Expression {
    type Err = ExpressionError;

    fn from_str(text: &str) -> Result<Self, ExpressionError> {
        let names: Vec<String> = ('a'..='z').map(String::from).collect();
        Self::parse(text, &names)
    }
}

struct Parser<'a> {
    text: Vec<char>,
    at: usize,
    depth: usize,
    changes: usize,
    place_of: &'a dyn Fn(&str) -> Option<usize>,
    known: &'a dyn Fn() -> String,
}

impl Parser<'_> {
    fn whole(mut self) -> Result<Expression, ExpressionError> {
        let read = self.sums()?;
        match self.peek() {
            None => Ok(read),
            Some(other) => Err(self.fault(format!("'{other}' where an operator or the end should be"))),
        }
    }

    fn fault(&self, problem: impl Into<String>) -> ExpressionError {
        ExpressionError { place: self.at, problem: problem.into() }
    }

    /// The next character that is no space.
    fn peek(&mut self) -> Option<char> {
        while self.text.get(self.at).is_some_and(|c| c.is_whitespace()) {
            self.at += 1;
        }
        self.text.get(self.at).copied()
    }

    fn take(&mut self, wanted: char) -> bool {
        let found = self.peek() == Some(wanted);
        self.at += usize::from(found);
        found
    }

    /// Unions and differences, from left to right.
    fn sums(&mut self) -> Result<Expression, ExpressionError> {
        let mut left = self.exclusive()?;
        loop {
            let is_union = self.take('+') || self.take('|');
            if !is_union && !self.take('-') {
                return Ok(left);
            }
            let right = self.exclusive()?;
            left = match left {
                Expression::Union(mut sets) if is_union => {
                    sets.push(right);
                    Expression::Union(sets)
                }
                Expression::Difference(mut sets) if !is_union => {
                    sets.push(right);
                    Expression::Difference(sets)
                }
                left => {
                    let is_change = matches!(left, Expression::Union(_) | Expression::Difference(_));
                    self.changes += usize::from(is_change);
                    if self.changes > MOST_CHANGES {
                        return Err(self.fault(format!("more than {MOST_CHANGES} changes between + and -")));
                    }
                    let sets = vec![left, right];
                    if is_union { Expression::Union(sets) } else { Expression::Difference(sets) }
                }
            };
        }
    }

    /// Symmetric differences.
    fn exclusive(&mut self) -> Result<Expression, ExpressionError> {
        let mut sets = vec![self.common()?];
        while self.take('^') {
            sets.push(self.common()?);
        }
        Ok(one_or(sets, Expression::SymmetricDifference))
    }

    /// Intersections.
    fn common(&mut self) -> Result<Expression, ExpressionError> {
        let mut sets = vec![self.single()?];
        while self.take('&') {
            sets.push(self.single()?);
        }
        Ok(one_or(sets, Expression::Intersection))
    }

    /// An operand, something in parentheses, or a count.
    fn single(&mut self) -> Result<Expression, ExpressionError> {
        match self.peek() {
            Some('(') => {
                self.at += 1;
                self.depth += 1;
                if self.depth > DEEPEST {
                    return Err(self.fault(format!("more than {DEEPEST} parentheses in each other")));
                }
                let inner = self.sums()?;
                self.depth -= 1;
                if self.take(')') { Ok(inner) } else { Err(self.fault("')' is missing")) }
            }
            Some(c) if is_of_name(c) => {
                let start = self.at;
                let name = self.name();
                if name == "atleast" && self.take('(') {
                    return self.at_least();
                }
                (self.place_of)(&name).map(Expression::Operand).ok_or_else(|| ExpressionError {
                    place: start,
                    problem: format!("no operand is called '{name}'; there are {}", (self.known)()),
                })
            }
            Some(other) => Err(self.fault(format!("'{other}' where an operand should be"))),
            None => Err(self.fault("it ends where an operand should be")),
        }
    }

    fn name(&mut self) -> String {
        let start = self.at;
        while self.text.get(self.at).is_some_and(|&c| is_of_name(c)) {
            self.at += 1;
        }
        self.text[start..self.at].iter().collect()
    }

    /// The rest of `atleast(k, set, ...)`.
    fn at_least(&mut self) -> Result<Expression, ExpressionError> {
        self.peek();
        let start = self.at;
        let count = self.name().parse::<usize>().ok().filter(|&count| count > 0);
        let count = count.ok_or_else(|| ExpressionError {
            place: start,
            problem: "atleast begins with a count, such as atleast(2, a, b, c)".into(),
        })?;
        self.depth += 1;
        if self.depth > DEEPEST {
            return Err(self.fault(format!("more than {DEEPEST} parentheses in each other")));
        }
        let mut sets = Vec::new();
        while self.take(',') {
            sets.push(self.sums()?);
        }
        self.depth -= 1;
        if self.take(')') { Ok(Expression::AtLeast(count, sets)) } else { Err(self.fault("')' is missing")) }
    }
}

fn is_of_name(c: char) -> bool {
    c.is_alphanumeric() || c == '_' || c == '.'
}

fn one_or(mut sets: Vec<Expression>, make: fn(Vec<Expression>) -> Expression) -> Expression {
    if sets.len() == 1 { sets.swap_remove(0) } else { make(sets) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::boolean::expression::Expression::{
        AtLeast, Difference, Intersection, Operand, SymmetricDifference, Union,
    };

    #[test]
    fn operators_bind_as_documented() {
        let read = |text: &str| text.parse::<Expression>().unwrap();
        let [a, b, c] = [0, 1, 2].map(Operand);
        assert_eq!(read("a"), a);
        assert_eq!(read(" a+b | c "), Union(vec![a.clone(), b.clone(), c.clone()]));
        assert_eq!(read("a-b-c"), Difference(vec![a.clone(), b.clone(), c.clone()]));
        assert_eq!(read("a-(b-c)"), Difference(vec![a.clone(), Difference(vec![b.clone(), c.clone()])]));
        let xor = SymmetricDifference(vec![Intersection(vec![a.clone(), b.clone()]), c.clone()]);
        assert_eq!(read("a & b ^ c"), xor);
        assert_eq!(read("atleast(2, a, b, c)"), AtLeast(2, vec![a, b, c]));
    }

    #[test]
    fn faults_have_a_place() {
        let fault = |text: &str| text.parse::<Expression>().unwrap_err().to_string();
        assert_eq!(fault("a - "), "expression, character 5: it ends where an operand should be");
        assert_eq!(fault("a b"), "expression, character 3: 'b' where an operator or the end should be");
        assert_eq!(fault("(a + b"), "expression, character 7: ')' is missing");
        assert!(
            fault("a - body")
                .starts_with("expression, character 5: no operand is called 'body'; there are a, b")
        );
        assert!(fault("atleast(a, b)").contains("begins with a count"));
        let deep = format!("{}a{}", "(".repeat(100_000), ")".repeat(100_000));
        assert!(fault(&deep).contains("more than 200 parentheses"));
        let changing = format!("a{}", "+b-a".repeat(100_000));
        assert!(fault(&changing).contains("more than 500 changes"));
    }
}
