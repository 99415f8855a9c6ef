//! The words of a formula.

use winnow::LocatingSlice;
use winnow::Parser;
use winnow::ascii::{float, multispace1};
use winnow::combinator::{alt, preceded, repeat};
use winnow::error::{EmptyError, ModalResult};
use winnow::stream::Location;
use winnow::token::{one_of, take_while};

use super::Fault;

#[derive(Clone, Debug, PartialEq)]
pub(super) enum Token {
    Number(f64),
    Name(String),
    And,
    Or,
    Not,
    /// One of `+ - * / ^ ( ) , ; =`.
    Sign(char),
}

/// A token and where it begins, in bytes.
#[derive(Clone, Debug)]
pub(super) struct Placed {
    pub(super) token: Token,
    pub(super) at: usize,
}

type Input<'a> = LocatingSlice<&'a str>;

pub(super) fn tokens(text: &str) -> Result<Vec<Placed>, Fault> {
    let mut input = LocatingSlice::new(text);
    let mut tokens = Vec::new();
    while blank.parse_next(&mut input).is_ok() {
        let at = input.current_token_start();
        if at >= text.len() {
            break;
        }
        let Ok(token) = token.parse_next(&mut input) else {
            let found = text[at..].chars().next().unwrap_or(' ');
            return Err(Fault::new(at, format!("unexpected character `{found}`")));
        };
        if let Token::Number(value) = token
            && !value.is_finite()
        {
            return Err(Fault::new(at, "number too large"));
        }
        tokens.push(Placed { token, at });
    }
    Ok(tokens)
}

/// White space and comments from `#` to the end of the line.
fn blank(input: &mut Input<'_>) -> ModalResult<(), EmptyError> {
    let comment = preceded('#', take_while(0.., |c| c != '\n')).void();
    repeat(0.., alt((multispace1.void(), comment))).parse_next(input)
}

fn token(input: &mut Input<'_>) -> ModalResult<Token, EmptyError> {
    alt((number, name, logic, one_of("+-*/^(),;=".chars().collect::<Vec<_>>().as_slice()).map(Token::Sign)))
        .parse_next(input)
}

/// Unsigned: a sign before it is an operation.
fn number(input: &mut Input<'_>) -> ModalResult<Token, EmptyError> {
    let first = winnow::combinator::peek(one_of(|c: char| c.is_ascii_digit() || c == '.'));
    preceded(first, float).map(Token::Number).parse_next(input)
}

fn name(input: &mut Input<'_>) -> ModalResult<Token, EmptyError> {
    (
        one_of(|c: char| c.is_alphabetic() || c == '_'),
        take_while(0.., |c: char| c.is_alphanumeric() || c == '_'),
    )
        .take()
        .map(|word: &str| match word {
            "and" | "AND" => Token::And,
            "or" | "OR" => Token::Or,
            "not" | "NOT" => Token::Not,
            _ => Token::Name(word.to_owned()),
        })
        .parse_next(input)
}

fn logic(input: &mut Input<'_>) -> ModalResult<Token, EmptyError> {
    alt((alt(("&&", "&")).value(Token::And), alt(("||", "|")).value(Token::Or), "!".value(Token::Not)))
        .parse_next(input)
}
