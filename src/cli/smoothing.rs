//! `--subdivide`: an input that is a cage, taken as its limit surface.

use std::fmt;

use trisect::Error;
use trisect::subdivision::{Cage, Rules, Scheme};

use super::values;

/// How near to its limit surface an input is to be, and how it is read.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Smoothing {
    pub(crate) tolerance: Option<f64>,
    pub(crate) creases_from_angle: Option<f64>,
    pub(crate) rules: Option<Rules>,
    pub(crate) scheme: Option<Scheme>,
}

/// The distance from the surface if none is given, over the cage's diagonal.
const TOLERANCE: f64 = 1e-3;

/// A tolerance, `creases:DEGREES`, a scheme and rules, with commas between them, or `auto`.
pub(crate) fn smoothing(text: &str) -> Result<Smoothing, String> {
    let mut found = Smoothing::default();
    for word in text.split(',').map(str::trim).filter(|&word| word != "auto") {
        if let Some(angle) = word.strip_prefix("creases:") {
            found.creases_from_angle = Some(values::number(angle)?);
        } else if let Some(scheme) = Scheme::named(word) {
            found.scheme = Some(scheme);
        } else if let Some(rules) = Rules::named(word) {
            found.rules = Some(rules);
        } else {
            found.tolerance = Some(values::length(word).map_err(|_| {
                format!(
                    "'{word}' is none of a tolerance more than zero, creases:DEGREES, a scheme ({}) and rules ({})",
                    Scheme::ALL.map(Scheme::name).join(", "),
                    Rules::ALL.map(Rules::name).join(", ")
                )
            })?);
        }
    }
    Ok(found)
}

impl Smoothing {
    /// The cage's limit surface as triangles.
    pub(crate) fn mesh(&self, cage: &Cage) -> Result<trisect::Mesh, Error> {
        let creased = self.creases_from_angle.map(|degrees| cage.with_creases_from_angle(degrees));
        let creased = creased.transpose()?;
        let cage = creased.as_ref().unwrap_or(cage);
        cage.limit_mesh(self.tolerance.unwrap_or_else(|| TOLERANCE * super::cages::diagonal(cage)))
    }
}

impl fmt::Display for Smoothing {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let words = [
            self.tolerance.map(|tolerance| tolerance.to_string()),
            self.creases_from_angle.map(|angle| format!("creases:{angle}")),
            self.scheme.map(|scheme| scheme.name().to_owned()),
            self.rules.map(|rules| rules.name().to_owned()),
        ];
        let words: Vec<String> = words.into_iter().flatten().collect();
        f.write_str(if words.is_empty() { "auto" } else { "" })?;
        f.write_str(&words.join(","))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_read_is_told_the_same() {
        for text in ["auto", "0.01", "0.01,creases:30,catmull-clark", "loop", "0.5,opensubdiv", "creases:0"] {
            assert_eq!(smoothing(text).map(|found| found.to_string()), Ok(text.to_owned()));
        }
        for bad in ["0", "-1", "fine", "creases:", "0.1;2", ""] {
            assert!(smoothing(bad).is_err(), "{bad}");
        }
    }
}
