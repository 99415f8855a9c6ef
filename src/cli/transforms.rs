//! Transforms of inputs: what they are called, how they are read, what they do.

use std::fmt;
use std::path::PathBuf;

use clap::ArgMatches;
use trisect::making::Pattern;
use trisect::mesh::BoundsSide;
use trisect::{Control, Error, Mesh};

use super::points;
use super::requests::placed;
#[cfg(feature = "subdivision")]
use super::smoothing::Smoothing;
use super::values;

/// A transform of an input.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Transform {
    Translate([f64; 3]),
    /// Degrees about x, then y, then z.
    Rotate([f64; 3]),
    Scale([f64; 3]),
    /// Rows of an affine map.
    Matrix([[f64; 4]; 4]),
    /// The middle of the bounds to the origin, along some axes.
    Center([bool; 3]),
    Align(Alignment),
    /// The lowest point to z = 0.
    Drop,
    /// In the plane through the origin across an axis.
    Mirror(usize),
    /// Evenly into a box of this size.
    Fit([f64; 3]),
    Repeat(Repetition),
    /// A cage to its limit surface.
    #[cfg(feature = "subdivision")]
    Subdivide(Smoothing),
}

/// A side of the bounds to a coordinate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Alignment {
    axis: usize,
    side: BoundsSide,
    at: f64,
}

/// A pattern, or a file of places to make one of.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Repetition {
    Given(Pattern),
    Points(PathBuf),
    Along { file: PathBuf, count: u32, turn: bool },
}

/// The names of the axes.
const AXES: [&str; 3] = ["x", "y", "z"];

/// All transforms on a command line, each with its place and the option's name.
pub(crate) fn all(matches: &ArgMatches) -> Vec<(usize, &'static str, Transform)> {
    let mut found = Vec::new();
    let mut add = |name: &'static str, values: Vec<(usize, Transform)>| {
        found.extend(values.into_iter().map(|(at, transform)| (at, name, transform)));
    };
    add("--translate", placed(matches, "translate").map(|(at, v)| (at, Transform::Translate(v))).collect());
    add("--rotate", placed(matches, "rotate").map(|(at, v)| (at, Transform::Rotate(v))).collect());
    add("--scale", placed(matches, "scale").map(|(at, v)| (at, Transform::Scale(v))).collect());
    add("--matrix", placed(matches, "matrix").map(|(at, v)| (at, Transform::Matrix(v))).collect());
    add("--center", placed(matches, "center").map(|(at, v)| (at, Transform::Center(v))).collect());
    add("--align", placed(matches, "align").map(|(at, v)| (at, Transform::Align(v))).collect());
    add("--drop", placed::<bool>(matches, "drop").map(|(at, _)| (at, Transform::Drop)).collect());
    add("--mirror", placed(matches, "mirror").map(|(at, v)| (at, Transform::Mirror(v))).collect());
    add("--fit", placed(matches, "fit").map(|(at, v)| (at, Transform::Fit(v))).collect());
    add("--pattern", placed(matches, "pattern").map(|(at, v)| (at, Transform::Repeat(v))).collect());
    #[cfg(feature = "subdivision")]
    if matches.try_contains_id("subdivide").is_ok() {
        let all = placed(matches, "subdivide");
        found.extend(all.map(|(at, v)| (at, "--subdivide", Transform::Subdivide(v))));
    }
    found
}

impl Transform {
    /// The mesh, moved. Copies are not begun that would take more than the memory ceiling.
    pub(crate) fn apply(&self, mesh: Mesh, control: &Control) -> Result<Mesh, Error> {
        Ok(match self {
            Self::Translate(by) => mesh.translated(*by),
            Self::Rotate([x, y, z]) => mesh
                .rotated([1.0, 0.0, 0.0], *x)?
                .rotated([0.0, 1.0, 0.0], *y)?
                .rotated([0.0, 0.0, 1.0], *z)?,
            Self::Scale(by) => mesh.scaled(*by)?,
            Self::Matrix(rows) => mesh.transformed(rows.as_flattened())?,
            Self::Center(axes) => mesh.centered(*axes),
            Self::Align(Alignment { axis, side, at }) => mesh.aligned(*axis, *side, *at),
            Self::Drop => mesh.aligned(2, BoundsSide::Low, 0.0),
            Self::Mirror(axis) => mesh.mirrored(*axis),
            Self::Fit(size) => mesh.fitted(*size)?,
            Self::Repeat(repetition) => {
                let pattern = repetition.pattern()?;
                let _copies = control.reserve(pattern.memory(&mesh))?;
                pattern.repeat(&mesh)?
            }
            // What becomes of cages is done where files are read (`cages::input`).
            #[cfg(feature = "subdivision")]
            Self::Subdivide(_) => mesh,
        })
    }

    /// Whether it keeps all lengths, and which way faces look.
    #[cfg(feature = "subdivision")]
    pub(crate) fn is_rigid(&self) -> bool {
        use Transform::{Align, Center, Drop, Rotate, Translate};
        matches!(self, Translate(_) | Rotate(_) | Center(_) | Align(_) | Drop)
    }

    /// Whether it makes more of the input than there was.
    #[cfg(feature = "subdivision")]
    pub(crate) fn is_repetition(&self) -> bool {
        matches!(self, Self::Repeat(_))
    }

    /// Whether it turns faces over.
    #[cfg(feature = "subdivision")]
    pub(crate) fn reflects(&self) -> bool {
        match self {
            Self::Mirror(_) => true,
            Self::Scale(by) => by.iter().product::<f64>() < 0.0,
            Self::Matrix([[a, b, c, _], [d, e, f, _], [g, h, i, _], _]) => {
                a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g) < 0.0
            }
            _ => false,
        }
    }
}

impl Repetition {
    fn pattern(&self) -> Result<Pattern, Error> {
        Ok(match self {
            Self::Given(pattern) => pattern.clone(),
            Self::Points(file) => Pattern::Points(points::of_file(file)?),
            Self::Along { file, count, turn } => {
                Pattern::Along { line: points::of_file(file)?, count: *count, turn: *turn }
            }
        })
    }
}

impl fmt::Display for Transform {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (name, values) = match self {
            Self::Translate(by) => ("translate", by.as_slice()),
            Self::Rotate(degrees) => ("rotate", degrees.as_slice()),
            Self::Scale(by) => ("scale", by.as_slice()),
            Self::Matrix(rows) => ("matrix", rows.as_flattened()),
            Self::Fit(size) => ("fit", size.as_slice()),
            Self::Center(axes) => {
                let names: String = (0..3).filter(|&k| axes[k]).map(|k| AXES[k]).collect();
                return write!(f, "center {names}");
            }
            Self::Align(Alignment { axis, side, at }) => {
                let side = match side {
                    BoundsSide::Low => "low",
                    BoundsSide::Middle => "middle",
                    BoundsSide::High => "high",
                };
                return write!(f, "align {}={side}:{at}", AXES[*axis]);
            }
            Self::Drop => return f.write_str("drop"),
            Self::Mirror(axis) => return write!(f, "mirror {}", AXES[*axis]),
            Self::Repeat(repetition) => return write!(f, "pattern {repetition}"),
            #[cfg(feature = "subdivision")]
            Self::Subdivide(smoothing) => return write!(f, "subdivide {smoothing}"),
        };
        let values: Vec<String> = values.iter().map(ToString::to_string).collect();
        write!(f, "{name} {}", values.join(","))
    }
}

impl fmt::Display for Repetition {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let list = |values: &[f64]| values.iter().map(ToString::to_string).collect::<Vec<_>>().join(",");
        match self {
            Self::Given(Pattern::Linear { count, step }) => write!(f, "linear:{count}:{}", list(step)),
            Self::Given(Pattern::Grid { counts: [x, y, z], steps }) => {
                write!(f, "grid:{x}x{y}x{z}:{}", list(steps))
            }
            Self::Given(Pattern::Circular { count, axis, degrees, .. }) => {
                let axis = axis.iter().position(|&x| x != 0.0).unwrap_or_default();
                write!(f, "circular:{count}:{}:{degrees}", AXES[axis])
            }
            Self::Given(other) => write!(f, "{} places", other.count()),
            Self::Points(file) => write!(f, "points:{}", file.display()),
            Self::Along { file, count, turn } => {
                write!(f, "along:{}:{count}{}", file.display(), if *turn { ":turn" } else { "" })
            }
        }
    }
}

/// `x`, `y` or `z`.
pub(crate) fn axis(text: &str) -> Result<usize, String> {
    AXES.iter()
        .position(|name| name.eq_ignore_ascii_case(text.trim()))
        .ok_or_else(|| format!("expected x, y or z, not '{text}'"))
}

/// The axes along which something is centred: `xyz`, or some of them.
pub(crate) fn axes(text: &str) -> Result<[bool; 3], String> {
    let mut axes = [false; 3];
    for letter in text.chars() {
        axes[axis(&letter.to_string())?] = true;
    }
    if axes == [false; 3] { Err("expected one or more of x, y and z, such as xy".into()) } else { Ok(axes) }
}

/// `AXIS=SIDE` or `AXIS=SIDE:AT`.
pub(crate) fn alignment(text: &str) -> Result<Alignment, String> {
    let expected =
        "expected an axis, a side of the bounds (low, middle, high) and where it goes, such as z=low:10";
    let (name, rest) = text.split_once('=').ok_or(expected)?;
    let (side, at) = rest.split_once(':').unwrap_or((rest, "0"));
    let side = match side.trim() {
        "low" | "min" => BoundsSide::Low,
        "middle" | "center" | "centre" | "mid" => BoundsSide::Middle,
        "high" | "max" => BoundsSide::High,
        _ => return Err(expected.into()),
    };
    Ok(Alignment { axis: axis(name)?, side, at: values::number(at)? })
}

/// One angle about z, or three about x, y and z.
pub(crate) fn rotation(text: &str) -> Result<[f64; 3], String> {
    match values::number(text) {
        Ok(angle) => Ok([0.0, 0.0, angle]),
        Err(_) if text.contains([',', ' ']) => values::vector(text),
        Err(error) => Err(format!("{error} (degrees about z, or three about x, y and z)")),
    }
}

/// A length, or three.
pub(crate) fn size(text: &str) -> Result<[f64; 3], String> {
    let size = match values::number(text) {
        Ok(size) => [size; 3],
        Err(_) if text.contains([',', ' ']) => values::vector(text)?,
        Err(error) => return Err(format!("{error} (the largest extent, or three of a box)")),
    };
    if size.iter().all(|&x| x > 0.0) { Ok(size) } else { Err("sizes must be more than zero".into()) }
}

/// `KIND:...`, as the help says.
pub(crate) fn repetition(text: &str) -> Result<Repetition, String> {
    let expected = "expected linear:COUNT:X,Y,Z, grid:NXxNYxNZ:X,Y,Z, circular:COUNT[:AXIS[:DEGREES]], points:FILE or \
                    along:FILE:COUNT[:turn]";
    let count = |text: &str| {
        text.trim()
            .parse::<u32>()
            .ok()
            .filter(|&count| count > 0)
            .ok_or_else(|| format!("'{text}' is no number of copies; {expected}"))
    };
    let (kind, rest) = text.split_once(':').ok_or(expected)?;
    let words: Vec<&str> = rest.split(':').collect();
    Ok(match (kind, &*words) {
        ("linear", [copies, step]) => {
            Repetition::Given(Pattern::Linear { count: count(copies)?, step: values::vector(step)? })
        }
        ("grid", [copies, steps]) => {
            let mut counts = [1; 3];
            let given: Vec<&str> = copies.split(['x', 'X', ',']).collect();
            if given.len() > 3 {
                return Err(expected.into());
            }
            for (place, copies) in counts.iter_mut().zip(&given) {
                *place = count(copies)?;
            }
            let steps = match steps.split(',').count() {
                // Two of them leave out the third.
                2 => values::vector(&format!("{steps},0"))?,
                1 => [values::number(steps)?; 3],
                _ => values::vector(steps)?,
            };
            Repetition::Given(Pattern::Grid { counts, steps })
        }
        ("circular", [copies, rest @ ..]) if rest.len() <= 2 => {
            let mut direction = [0.0; 3];
            direction[rest.first().map_or(Ok(2), |name| axis(name))?] = 1.0;
            let degrees = rest.get(1).map_or(Ok(360.0), |degrees| values::number(degrees))?;
            let count = count(copies)?;
            Repetition::Given(Pattern::Circular { count, axis: direction, center: [0.0; 3], degrees })
        }
        ("points", _) if !rest.is_empty() => Repetition::Points(rest.into()),
        // (A file's name may have colons.)
        ("along", _) => {
            let (rest, turn) = rest.strip_suffix(":turn").map_or((rest, false), |rest| (rest, true));
            let (file, copies) = rest.rsplit_once(':').ok_or(expected)?;
            Repetition::Along { file: file.into(), count: count(copies)?, turn }
        }
        _ => return Err(expected.into()),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_angle_is_about_z_and_factors_may_be_per_cent() {
        assert_eq!(rotation("45"), Ok([0.0, 0.0, 45.0]));
        assert_eq!(rotation("1,2,3"), Ok([1.0, 2.0, 3.0]));
        assert!(rotation("east").unwrap_err().contains("about z"));
        assert_eq!(size("10"), Ok([10.0; 3]));
        assert!(size("0").is_err() && size("1,2").is_err() && size("-1,1,1").is_err());
        assert_eq!(axes("zx"), Ok([true, false, true]));
        assert!(axes("").is_err() && axes("xw").is_err());
    }

    #[test]
    fn what_is_read_is_told_the_same() {
        let told = |text: &str| Transform::Repeat(repetition(text).unwrap()).to_string();
        for text in [
            "linear:5:1,0,-2",
            "grid:3x4x1:1,2,0",
            "circular:6:z:360",
            "circular:6:x:180",
            "points:a/b.txt",
            "along:C:/line.xyz:20:turn",
        ] {
            assert_eq!(told(text), format!("pattern {text}"));
        }
        assert_eq!(told("grid:3x4:1,2"), "pattern grid:3x4x1:1,2,0");
        assert_eq!(told("circular:4"), "pattern circular:4:z:360");
        for bad in
            ["", "5", "linear:5", "linear:0:1,0,0", "grid:2x2x2x2:1", "circular:x", "points:", "along:f"]
        {
            assert!(repetition(bad).unwrap_err().contains("expected"), "{bad}");
        }
        let align = |text: &str| Transform::Align(alignment(text).unwrap()).to_string();
        assert_eq!(
            (align("z=low").as_str(), align("x=max:2.5").as_str()),
            ("align z=low:0", "align x=high:2.5")
        );
        assert!(alignment("z").is_err() && alignment("z=up").is_err() && alignment("w=low").is_err());
    }
}
