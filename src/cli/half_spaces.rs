//! Half-spaces in the expressions of `combine`: `above(z=2)` and `below(z=2)`.
//!
//! A half-space across an axis is the part of it in a box around all operands, one face of which lies in the plane: exactly the same
//! set wherever an operand is, and so is every expression that is bounded.

use trisect::exact::Plane;
use trisect::{Expression, Solid, primitives};

use super::fault::Fault;
use super::values;

/// A half-space across an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct HalfSpace {
    axis: usize,
    at: f64,
    is_above: bool,
}

/// The names of half-spaces in an expression, which no file can have.
fn name(number: usize) -> String {
    format!("_half_space_{number}")
}

/// An expression with names in the place of its half-spaces, these names, and the half-spaces.
pub(crate) fn named(text: &str) -> Result<(String, Vec<String>, Vec<HalfSpace>), Fault> {
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
        let (axis, at) = plane.as_level().ok_or_else(|| {
            fault("the plane must be x=, y= or z= and a number here; `cut` takes any plane, and so do model files")
        })?;
        names.push(name(found.len()));
        named.push_str(before);
        named.push_str(names.last().map_or("", String::as_str));
        found.push(HalfSpace { axis, at, is_above: is_above == looks_up(&plane, axis) });
        rest = after;
    }
    named.push_str(rest);
    Ok((named, names, found))
}

/// Whether more of the axis is above the plane.
fn looks_up(plane: &Plane, axis: usize) -> bool {
    plane.normal()[axis] > 0.0
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

/// Half-spaces as solids, for an expression of so many other operands before them: what of them is in a box around those.
pub(crate) fn solids(
    half_spaces: &[HalfSpace],
    expression: &Expression,
    others: &[&Solid],
) -> Result<Vec<Solid>, Fault> {
    /// All sets of half-spaces are looked through for one that leaves the expression unbounded.
    const MOST: usize = 16;
    if half_spaces.is_empty() {
        return Ok(Vec::new());
    }
    if half_spaces.len() > MOST {
        return Err(Fault::usage(format!("--expr: more than {MOST} half-spaces")));
    }
    let unbounded = (0..1u32 << half_spaces.len()).any(|set| {
        expression.contains(&|operand| operand >= others.len() && set >> (operand - others.len()) & 1 == 1)
    });
    if unbounded {
        return Err(Fault::usage(
            "--expr: this is unbounded, as half-spaces are: intersect them with a body, or take them off one",
        ));
    }
    // A box that is larger than what there is, on every side.
    let bounds = others.iter().filter_map(|solid| solid.bounds());
    let mut low = [0.0f64; 3];
    let mut high = [0.0f64; 3];
    for (k, bounds) in bounds.enumerate() {
        for axis in 0..3 {
            low[axis] = if k == 0 { bounds.low[axis] } else { low[axis].min(bounds.low[axis]) };
            high[axis] = if k == 0 { bounds.high[axis] } else { high[axis].max(bounds.high[axis]) };
        }
    }
    let size = (0..3).map(|axis| high[axis] - low[axis]).fold(1.0f64, f64::max);
    let solid = |of: &HalfSpace| {
        let (mut low, mut high) = (low.map(|x| x - size), high.map(|x| x + size));
        let beyond = if of.is_above { &mut low[of.axis] } else { &mut high[of.axis] };
        *beyond = of.at;
        if low[of.axis] >= high[of.axis] {
            // All operands are beyond it.
            return Ok(Solid::empty());
        }
        let solid = primitives::cuboid(low, high).and_then(|mesh| Ok(Solid::try_from(mesh)?));
        solid.map_err(|error| Fault::usage(format!("--expr: {error}")))
    };
    half_spaces.iter().map(solid).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_spaces_get_names() {
        let (text, names, found) = named("body & below(z = 2) - above (x=-1) + belowed").unwrap();
        assert_eq!(text, "body & _half_space_0 - _half_space_1 + belowed");
        assert_eq!(names.len(), 2);
        assert_eq!(found[0], HalfSpace { axis: 2, at: 2.0, is_above: false });
        assert_eq!(found[1], HalfSpace { axis: 0, at: -1.0, is_above: true });
        for bad in ["a & below(w=1)", "a & below(z=1", "a - above(1,1,0,2)"] {
            assert!(named(bad).is_err(), "{bad}");
        }
        assert_eq!(named("above + below").unwrap().2, []);
    }
}
