//! Half-spaces in the expressions of `combine`: `above(z=2)` and `below(1,0,1,2)`.

use trisect::Leaf;

use super::fault::Fault;
use super::values;

/// The names of half-spaces in an expression, which no file can have.
fn name(number: usize) -> String {
    format!("_half_space_{number}")
}

/// An expression with names in the place of its half-spaces, these names, and the half-spaces.
pub(crate) fn named(text: &str) -> Result<(String, Vec<String>, Vec<Leaf<'static>>), Fault> {
    let (mut rest, mut named) = (text, String::new());
    let (mut names, mut found) = (Vec::new(), Vec::new());
    while let Some((place, is_above)) = first(rest) {
        let word = if is_above { "above" } else { "below" };
        let (before, after) = rest.split_at(place);
        let after = after[word.len()..].trim_start();
        let inner = after.strip_prefix('(').and_then(|inner| inner.split_once(')'));
        let fault = |problem: &str| Fault::usage(format!("--expr: {word}(...): {problem}"));
        let (inner, after) = inner.ok_or_else(|| fault("a parenthesis is missing"))?;
        let plane = values::plane(inner).map_err(|problem| fault(&problem))?;
        names.push(name(found.len()));
        named.push_str(before);
        named.push_str(names.last().map_or("", String::as_str));
        found.push(if is_above { Leaf::Above(plane) } else { Leaf::Below(plane) });
        rest = after;
    }
    named.push_str(rest);
    Ok((named, names, found))
}

/// Where the first word `above` or `below` is that a parenthesis follows, and whether it is `above`.
fn first(text: &str) -> Option<(usize, bool)> {
    let is_word = |c: char| c.is_alphanumeric() || c == '_';
    let of = |word: &str, is_above: bool| {
        text.match_indices(word)
            .find(|&(at, _)| {
                let begins = !text[..at].ends_with(is_word);
                begins && text[at + word.len()..].trim_start().starts_with('(')
            })
            .map(|(at, _)| (at, is_above))
    };
    [of("above", true), of("below", false)].into_iter().flatten().min()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_spaces_get_names() {
        let (text, names, found) = named("body & below(z = 2) - above (x=-1) + belowed").unwrap();
        assert_eq!(text, "body & _half_space_0 - _half_space_1 + belowed");
        assert_eq!(names.len(), 2);
        let level = |plane: &trisect::exact::Plane| plane.as_level();
        assert!(matches!(&found[0], Leaf::Below(plane) if level(plane) == Some((2, 2.0))));
        assert!(matches!(&found[1], Leaf::Above(plane) if level(plane) == Some((0, -1.0))));
        let askew = named("a - above(1, -1, 1, 0) & below(0,0,0, 1,0,1, 0,1,0)").unwrap().2;
        assert!(
            matches!(&askew[..], [Leaf::Above(a), Leaf::Below(b)] if level(a).is_none() && level(b).is_none())
        );
        for bad in ["a & below(w=1)", "a & below(z=1", "a - above(1,1,1)", "a - above(0,0,0,1)"] {
            assert!(named(bad).is_err(), "{bad}");
        }
        assert!(named("above + below").unwrap().2.is_empty());
    }
}
