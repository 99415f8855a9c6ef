//! Values on the command line: vectors, sizes, times, formats, directions.

use std::time::Duration;

use trisect::exact::{Plane, PlaneFault};
use trisect::io::Format;
use trisect::mesh::Welding;
use trisect::{FaceGroup, Material};

/// `count` finite numbers separated by commas or blanks.
fn numbers<const COUNT: usize>(text: &str) -> Result<[f64; COUNT], String> {
    let words: Vec<&str> = text.split([',', ' ', '\t', '\n']).filter(|word| !word.is_empty()).collect();
    let mut values = [0.0; COUNT];
    if words.len() != COUNT {
        return Err(format!("expected {COUNT} numbers separated by commas, found {}", words.len()));
    }
    for (value, word) in values.iter_mut().zip(words) {
        let number: f64 = word.parse().map_err(|_| format!("'{word}' is not a number"))?;
        if !number.is_finite() {
            return Err(format!("'{word}' is not a finite number"));
        }
        *value = number;
    }
    Ok(values)
}

/// `x,y,z`.
pub(crate) fn vector(text: &str) -> Result<[f64; 3], String> {
    numbers(text)
}

/// A length that is not negative.
pub(crate) fn distance(text: &str) -> Result<f64, String> {
    match numbers::<1>(text) {
        Ok([distance]) if distance >= 0.0 => Ok(distance),
        Ok(_) => Err("a distance is not negative".into()),
        Err(error) => Err(error.replace("1 numbers separated by commas", "one number")),
    }
}

/// `auto`, or a length that is not negative.
pub(crate) fn welding(text: &str) -> Result<Welding, String> {
    match text {
        "auto" => Ok(Welding::Closing),
        _ => distance(text).map(Welding::Within).map_err(|error| format!("{error} (or auto)")),
    }
}

/// The most edges of a hole: a number of at least 3, or `all`.
pub(crate) fn hole(text: &str) -> Result<usize, String> {
    match text.parse::<usize>() {
        _ if text == "all" => Ok(usize::MAX),
        Ok(most) if most >= 3 => Ok(most),
        _ => Err("expected the most edges that a hole may have, a number of at least 3".into()),
    }
}

/// A plane: `x=1.5`, `y=..` or `z=..`; `a,b,c,d` for a x + b y + c z = d; or three points as nine numbers.
pub(crate) fn plane(text: &str) -> Result<Plane, String> {
    let told = |fault: PlaneFault| fault.to_string();
    if let Some((axis, at)) = text.split_once('=') {
        let axis = ["x", "y", "z"].iter().position(|name| name.eq_ignore_ascii_case(axis.trim()));
        let axis = axis.ok_or("expected x=, y= or z= and a number")?;
        return Plane::across(axis, number(at)?).map_err(told);
    }
    let text = text.replace(';', ",");
    match text.split([',', ' ', '\t', '\n']).filter(|word| !word.is_empty()).count() {
        4 => numbers(&text).and_then(|[a, b, c, d]| Plane::new([a, b, c], d).map_err(told)),
        9 => numbers(&text).and_then(|[a, b, c, d, e, f, g, h, i]| {
            Plane::through([a, b, c], [d, e, f], [g, h, i]).map_err(told)
        }),
        _ => Err(
            "expected z=12.5 (or x=, y=), a,b,c,d for a x + b y + c z = d, or three points x,y,z,x,y,z,x,y,z"
                .into(),
        ),
    }
}

/// Heights: `first:step:last`, or numbers separated by commas.
pub(crate) fn heights(text: &str) -> Result<Heights, String> {
    /// So many sections of one file are a mistake.
    const MOST: f64 = 1e6;
    let list = if text.contains(':') {
        let [first, step, last]: [f64; 3] = numbers(&text.replace(':', ","))?;
        let count = ((last - first) / step * (1.0 + f64::EPSILON)).floor();
        if !(step > 0.0 && (0.0..MOST).contains(&count)) {
            return Err(
                "expected FIRST:STEP:LAST with a positive step and LAST not below FIRST, such as 0:0.2:10"
                    .into(),
            );
        }
        (0..=count as u32).map(|i| first + f64::from(i) * step).collect()
    } else {
        let words = text.split([',', ' ']).filter(|word| !word.is_empty());
        words.map(number).collect::<Result<Vec<f64>, _>>()?
    };
    if list.is_empty() { Err("expected at least one height".into()) } else { Ok(Heights(list)) }
}

/// Several heights.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Heights(pub(crate) Vec<f64>);

/// The group of the faces that close a cut: a name, and a colour if it ends with #RRGGBB.
pub(crate) fn material(text: &str) -> Result<FaceGroup, String> {
    let (name, colour) = match text.rsplit_once('#') {
        None => (text, None),
        Some((name, digits)) => {
            let value = u32::from_str_radix(digits, 16).ok().filter(|_| digits.len() == 6);
            let value = value.ok_or("a colour is # and six digits, such as cap#d08030")?;
            (name, Some([16, 8, 0].map(|shift| (value >> shift & 0xff) as u8)))
        }
    };
    if name.is_empty() {
        return Err("expected a name, such as cap or cap#d08030".into());
    }
    let material = colour.map(|colour| plain_material(name, colour));
    Ok(FaceGroup { name: name.to_owned(), material })
}

/// A material of one colour, which is given as screens show it; materials have it linear.
pub(crate) fn plain_material(name: &str, [r, g, b]: [u8; 3]) -> Material {
    let linear = |byte: u8| {
        let x = f32::from(byte) / 255.0;
        if x <= 0.04045 { x / 12.92 } else { ((x + 0.055) / 1.055).powf(2.4) }
    };
    Material::plain(name, [linear(r), linear(g), linear(b), 1.0])
}

/// A length that is positive.
pub(crate) fn length(text: &str) -> Result<f64, String> {
    match numbers::<1>(text) {
        Ok([length]) if length > 0.0 => Ok(length),
        Ok(_) => Err("must be more than zero".into()),
        Err(error) => Err(error.replace("1 numbers separated by commas", "one number")),
    }
}

/// A number.
pub(crate) fn number(text: &str) -> Result<f64, String> {
    match numbers::<1>(text) {
        Ok([number]) => Ok(number),
        Err(error) => Err(error.replace("1 numbers separated by commas", "one number")),
    }
}

/// Two opposite corners of a box: `x,y,z,x,y,z`, the lower one first.
pub(crate) fn corners(text: &str) -> Result<[[f64; 3]; 2], String> {
    let [a, b, c, d, e, f] = numbers(text)?;
    let (low, high) = ([a, b, c], [d, e, f]);
    match (0..3).all(|axis| low[axis] < high[axis]) {
        true => Ok([low, high]),
        false => Err("the first corner must be below the second along every axis".into()),
    }
}

/// `s` or `x,y,z`, none of them zero.
pub(crate) fn scale(text: &str) -> Result<[f64; 3], String> {
    let words = text.split([',', ' ']).filter(|word| !word.is_empty());
    let per_cent: Vec<bool> = words.clone().map(|word| word.ends_with('%')).collect();
    let text = &words.map(|word| word.strip_suffix('%').unwrap_or(word)).collect::<Vec<_>>().join(",");
    let in_hundredths = |factor: f64, word: usize| match per_cent.get(word) {
        Some(true) => factor / 100.0,
        _ => factor,
    };
    let factors = match numbers::<1>(text) {
        Ok([factor]) => [in_hundredths(factor, 0); 3],
        Err(_) if text.contains([',', ' ']) => {
            let factors = vector(text)?;
            [0, 1, 2].map(|k| in_hundredths(factors[k], k))
        }
        Err(error) => return Err(error.replace("1 numbers separated by commas", "one number or three")),
    };
    match factors.contains(&0.0) {
        true => Err("a factor of zero would flatten the model".into()),
        false => Ok(factors),
    }
}

/// Sixteen numbers, row by row as written on paper; the last row must be 0 0 0 1.
pub(crate) fn matrix(text: &str) -> Result<[[f64; 4]; 4], String> {
    let flat: [f64; 16] = numbers(text)?;
    let rows = std::array::from_fn(|row| std::array::from_fn(|column| flat[4 * row + column]));
    if rows[3] != [0.0, 0.0, 0.0, 1.0] {
        return Err("the last row must be 0,0,0,1: numbers are expected row by row, the translation in the \
                    fourth column"
            .into());
    }
    Ok(rows)
}

/// A direction to look from: a name or `x,y,z`.
pub(crate) fn direction(text: &str) -> Result<[f64; 3], String> {
    Ok(match text {
        "front" => [0.0, -1.0, 0.0],
        "back" => [0.0, 1.0, 0.0],
        "left" => [-1.0, 0.0, 0.0],
        "right" => [1.0, 0.0, 0.0],
        "top" => [0.0, 0.0, 1.0],
        "bottom" => [0.0, 0.0, -1.0],
        _ => match vector(text) {
            Ok([0.0, 0.0, 0.0]) => return Err("0,0,0 is no direction".into()),
            Ok(direction) => direction,
            Err(error) => {
                return Err(format!("{error}; or one of front, back, left, right, top, bottom"));
            }
        },
    })
}

/// Bytes, with an optional suffix K, M, G or T (powers of 1024; `KB` and `KiB` mean the same).
pub(crate) fn bytes(text: &str) -> Result<u64, String> {
    let lower = text.trim().to_ascii_lowercase();
    let digits = lower.trim_end_matches(|c: char| c.is_ascii_alphabetic());
    let factor = match &lower[digits.len()..] {
        "" | "b" => 1_u64,
        "k" | "kb" | "kib" => 1 << 10,
        "m" | "mb" | "mib" => 1 << 20,
        "g" | "gb" | "gib" => 1 << 30,
        "t" | "tb" | "tib" => 1 << 40,
        suffix => return Err(format!("unknown unit '{suffix}'; use K, M, G or T, such as 4G")),
    };
    let count: f64 = digits.trim().parse().map_err(|_| "expected a size such as 512M or 4G".to_string())?;
    let bytes = count * factor as f64;
    if !(1.0..1e18).contains(&bytes) {
        return Err("the size must be at least one byte and less than 10^18".into());
    }
    Ok(bytes as u64)
}

/// Seconds, fractions allowed.
pub(crate) fn seconds(text: &str) -> Result<Duration, String> {
    let seconds: f64 = text.trim().parse().map_err(|_| "expected a number of seconds".to_string())?;
    if !(seconds > 0.0 && seconds < 1e9) {
        return Err("the time must be more than 0 and less than 10^9 seconds".into());
    }
    Ok(Duration::from_secs_f64(seconds))
}

/// The name of a format.
pub(crate) fn format(text: &str) -> Result<Format, String> {
    Format::from_name(text).ok_or_else(|| {
        let known: Vec<&str> = Format::ALL.iter().map(|format| format.extension()).collect();
        format!("unknown format; known formats: {}", known.join(", "))
    })
}

/// The largest side of a picture, in pixels: the samples behind it take 32 bytes per pixel.
const MAX_PICTURE: u32 = 4096;

/// `WIDTHxHEIGHT` in pixels.
pub(crate) fn picture_size(text: &str) -> Result<[u32; 2], String> {
    let side = |text: &str| text.parse::<u32>().ok().filter(|side| (1..=MAX_PICTURE).contains(side));
    text.split_once(['x', 'X'])
        .and_then(|(width, height)| Some([side(width)?, side(height)?]))
        .ok_or_else(|| format!("expected WIDTHxHEIGHT such as 1024x768, each from 1 to {MAX_PICTURE}"))
}

/// A rule by its name.
pub(crate) fn rule(text: &str) -> Result<trisect::Rule, String> {
    text.parse().map_err(|error: trisect::UnknownName| error.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn vectors_take_commas_or_blanks_and_refuse_the_rest() {
        assert_eq!(vector("1,-2.5,3e2"), Ok([1.0, -2.5, 300.0]));
        assert_eq!(vector("1, -2.5  3e2"), Ok([1.0, -2.5, 300.0]));
        assert!(vector("1,2").unwrap_err().contains("found 2"));
        assert!(vector("1,2,x").unwrap_err().contains("'x'"));
        assert!(vector("1,2,inf").unwrap_err().contains("finite"));
    }

    #[test]
    fn scale_takes_one_or_three_factors_but_not_zero() {
        assert_eq!(scale("2"), Ok([2.0; 3]));
        assert_eq!(scale("1,-1,2"), Ok([1.0, -1.0, 2.0]));
        assert_eq!(scale("200%"), Ok([2.0; 3]));
        assert_eq!(scale("50%,1,-25%"), Ok([0.5, 1.0, -0.25]));
        assert!(scale("%").is_err() && scale("0%").is_err());
        assert!(scale("0").is_err());
        assert!(scale("1,2").is_err());
        assert!(scale("big").is_err());
    }

    #[test]
    fn planes_are_levels_coefficients_or_points() {
        assert_eq!(plane("z=12.5"), Ok(Plane::across(2, 12.5).unwrap()));
        assert_eq!(plane("1,2,3,4"), Ok(Plane::new([1.0, 2.0, 3.0], 4.0).unwrap()));
        let points = Plane::through([0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 1.0]).unwrap();
        assert_eq!(plane("0,0,0;1,0,0;0,1,1"), Ok(points));
        for bad in ["w=1", "z=", "1,2,3", "0,0,0,1", "0,0,0,1,1,1,2,2,2"] {
            assert!(plane(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn heights_are_ranges_or_lists() {
        assert_eq!(heights("0:0.25:1"), Ok(Heights(vec![0.0, 0.25, 0.5, 0.75, 1.0])));
        assert_eq!(heights("0:0.1:0.3").unwrap().0.len(), 4);
        assert_eq!(heights("3,1,2"), Ok(Heights(vec![3.0, 1.0, 2.0])));
        for bad in ["", "0:0:1", "1:0.1:0", "0:1e-9:1", "0:1"] {
            assert!(heights(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn materials_have_a_name_and_perhaps_a_colour() {
        assert_eq!(material("cap"), Ok(FaceGroup { name: "cap".into(), material: None }));
        assert_eq!(material("cap#ff0000").unwrap().material.unwrap().base_color, [1.0, 0.0, 0.0, 1.0]);
        assert!(material("#ff0000").is_err() && material("cap#red").is_err());
    }

    #[test]
    fn matrices_are_row_by_row() {
        let rows = matrix("1 0 0 5  0 1 0 6  0 0 1 7  0 0 0 1").expect("a translation");
        assert_eq!([rows[0][3], rows[1][3], rows[2][3]], [5.0, 6.0, 7.0]);
        assert!(matrix("1,0,0,0, 0,1,0,0, 0,0,1,0, 5,6,7,1").unwrap_err().contains("last row"));
        assert!(matrix("1,2,3").unwrap_err().contains("16"));
    }

    #[test]
    fn sizes_have_units() {
        assert_eq!(bytes("4G"), Ok(4 << 30));
        assert_eq!(bytes("1.5kib"), Ok(1536));
        assert_eq!(bytes("100"), Ok(100));
        for bad in ["", "G", "-1", "4X", "nan", "1e30"] {
            assert!(bytes(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn seconds_are_positive() {
        assert_eq!(seconds("0.5"), Ok(Duration::from_millis(500)));
        for bad in ["0", "-1", "nan", "inf", "soon"] {
            assert!(seconds(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn pictures_have_two_sides_within_bounds() {
        assert_eq!(picture_size("640x480"), Ok([640, 480]));
        for bad in ["640", "0x3", "5000x10", "axb", "-1x2"] {
            assert!(picture_size(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn directions_are_names_or_vectors() {
        assert_eq!(direction("top"), Ok([0.0, 0.0, 1.0]));
        assert_eq!(direction("-1,0,0"), Ok([-1.0, 0.0, 0.0]));
        assert!(direction("0,0,0").is_err());
        assert!(direction("sideways").unwrap_err().contains("front"));
    }
}
