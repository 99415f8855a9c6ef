//! Expressions: sets made of operands, and what is inside an operand.

use std::fmt;
use std::str::FromStr;

use super::complex::operation::{Operation, UnknownName};

/// What counts as the inside of an operand, by how often its surface winds around a point.
///
/// For a surface that does not cross itself all rules are the same. In text `positive`, `nonzero` or `even-odd`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum Rule {
    /// What is wound around more often outwards than inwards: overlapping bodies become one, inverted ones are no material.
    #[default]
    Positive,
    /// What is wound around at all.
    NonZero,
    /// What is wound around an odd number of times: overlaps are no material.
    EvenOdd,
}

impl Rule {
    /// All rules.
    pub const ALL: [Self; 3] = [Self::Positive, Self::NonZero, Self::EvenOdd];

    /// The name in text.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Positive => "positive",
            Self::NonZero => "nonzero",
            Self::EvenOdd => "even-odd",
        }
    }

    /// Whether a point is inside that is wound around so many times.
    #[must_use]
    pub const fn is_inside(self, winding: i32) -> bool {
        match self {
            Self::Positive => winding > 0,
            Self::NonZero => winding != 0,
            Self::EvenOdd => winding % 2 != 0,
        }
    }
}

impl fmt::Display for Rule {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

impl FromStr for Rule {
    type Err = UnknownName;

    fn from_str(text: &str) -> Result<Self, UnknownName> {
        let found = Self::ALL.into_iter().find(|rule| rule.name() == text);
        found.ok_or_else(|| UnknownName::new(text, "rule", &["positive", "nonzero", "even-odd"]))
    }
}

/// A set made of operands. An operand may occur any number of times.
///
/// In text operands are letters or names, `+` is a union, `&` an intersection, `-` a difference and `^` a symmetric difference;
/// see [`Expression::parse`].
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Expression {
    /// An operand, by its place in the list of operands.
    Operand(usize),
    /// What is in any of some sets; nothing for none.
    Union(Vec<Self>),
    /// What is in all of some sets; nothing for none.
    Intersection(Vec<Self>),
    /// What is in the first of some sets and in none of the others; nothing for none.
    Difference(Vec<Self>),
    /// What is in an odd number of some sets.
    SymmetricDifference(Vec<Self>),
    /// What is in at least so many of some sets. 0 counts as 1: nothing bounded is everywhere.
    AtLeast(usize, Vec<Self>),
}

impl Expression {
    /// Whether a point is in the set, of which is asked what operands it is in.
    pub fn contains(&self, is_in: &dyn Fn(usize) -> bool) -> bool {
        match self {
            Self::Operand(operand) => is_in(*operand),
            Self::Union(sets) => sets.iter().any(|set| set.contains(is_in)),
            Self::Intersection(sets) => !sets.is_empty() && sets.iter().all(|set| set.contains(is_in)),
            Self::Difference(sets) => match sets.split_first() {
                Some((first, others)) => {
                    first.contains(is_in) && !others.iter().any(|set| set.contains(is_in))
                }
                None => false,
            },
            Self::SymmetricDifference(sets) => sets.iter().filter(|set| set.contains(is_in)).count() % 2 == 1,
            Self::AtLeast(count, sets) => {
                sets.iter().filter(|set| set.contains(is_in)).count() >= (*count).max(1)
            }
        }
    }

    /// The same set as one operation on operands, each once, if it is one: nested unions are opened, and so is a union of what
    /// is taken off.
    pub(crate) fn as_operation(&self) -> Option<(Operation, Vec<usize>)> {
        let mut list = Vec::new();
        let operation = match self {
            Self::Operand(_) => Operation::Union,
            Self::Union(_) => Operation::Union,
            Self::Intersection(_) => Operation::Intersection,
            Self::Difference(_) => Operation::Difference,
            Self::SymmetricDifference(_) => Operation::SymmetricDifference,
            Self::AtLeast(..) => return None,
        };
        let is_flat = match self {
            Self::Difference(sets) => {
                let (first, others) = sets.split_first()?;
                matches!(first, Self::Operand(_))
                    && first.add_united(&mut list)
                    && others.iter().all(|set| set.add_united(&mut list))
            }
            Self::Intersection(sets) | Self::SymmetricDifference(sets) => {
                sets.iter().all(|set| matches!(set, Self::Operand(_)) && set.add_united(&mut list))
            }
            _ => self.add_united(&mut list),
        };
        let mut distinct = list.clone();
        distinct.sort_unstable();
        distinct.dedup();
        (is_flat && distinct.len() == list.len()).then_some((operation, list))
    }

    /// Adds the operands of a union of unions; false if there is anything else.
    fn add_united(&self, list: &mut Vec<usize>) -> bool {
        match self {
            Self::Operand(operand) => {
                list.push(*operand);
                true
            }
            Self::Union(sets) => sets.iter().all(|set| set.add_united(list)),
            _ => false,
        }
    }

    /// The operands that occur, by their places.
    #[must_use]
    pub fn operands(&self) -> std::collections::BTreeSet<usize> {
        match self {
            Self::Operand(operand) => std::iter::once(*operand).collect(),
            Self::Union(sets)
            | Self::Intersection(sets)
            | Self::Difference(sets)
            | Self::SymmetricDifference(sets)
            | Self::AtLeast(_, sets) => sets.iter().flat_map(Self::operands).collect(),
        }
    }
}

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
        Parser { text: text.chars().collect(), at: 0, depth: 0, place_of: &place_of, known: &known }.whole()
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
            if self.take('+') || self.take('|') {
                let right = self.exclusive()?;
                left = match left {
                    Expression::Union(mut sets) => {
                        sets.push(right);
                        Expression::Union(sets)
                    }
                    left => Expression::Union(vec![left, right]),
                };
            } else if self.take('-') {
                let right = self.exclusive()?;
                left = match left {
                    Expression::Difference(mut sets) => {
                        sets.push(right);
                        Expression::Difference(sets)
                    }
                    left => Expression::Difference(vec![left, right]),
                };
            } else {
                return Ok(left);
            }
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
    use super::Expression::{AtLeast, Difference, Intersection, Operand, SymmetricDifference, Union};
    use super::*;

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
    fn nested_unions_are_one_operation() {
        let operation = |text: &str| text.parse::<Expression>().unwrap().as_operation();
        assert_eq!(operation("a + (b + c)"), Some((Operation::Union, vec![0, 1, 2])));
        assert_eq!(operation("a - (b + (c + d)) - e"), Some((Operation::Difference, vec![0, 1, 2, 3, 4])));
        assert_eq!(operation("b & a"), Some((Operation::Intersection, vec![1, 0])));
        assert_eq!(operation("a - (b - c)"), None);
        assert_eq!(operation("a - a"), None);
        assert_eq!(operation("(a + b) - c"), None);
        assert_eq!(operation("atleast(1, a, b)"), None);
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
    }

    #[test]
    fn rules_are_those_of_winding_numbers() {
        let inside = |rule: Rule| [-2, -1, 0, 1, 2].map(|winding| rule.is_inside(winding));
        assert_eq!(inside(Rule::Positive), [false, false, false, true, true]);
        assert_eq!(inside(Rule::NonZero), [true, true, false, true, true]);
        assert_eq!(inside(Rule::EvenOdd), [false, true, false, true, false]);
        for rule in Rule::ALL {
            assert_eq!(rule.to_string().parse(), Ok(rule));
        }
    }
}
