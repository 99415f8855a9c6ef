//! XML of packages: values of attributes, and errors with their place.

use std::borrow::Cow;

use quick_xml::XmlVersion;
use quick_xml::events::attributes::Attribute;

use super::super::scan::quote;
use super::super::{Format, malformed};
use super::package;
use crate::Error;

/// The value of an attribute. Entities are the five of XML and characters by their number: no document type can add any.
pub(super) fn value<'a>(attribute: &Attribute<'a>, part: &str, at: u64) -> Result<Cow<'a, str>, Error> {
    attribute.normalized_value(XmlVersion::Implicit1_0).map_err(|e| error(part, at, &e))
}

/// "part, byte 12", for messages.
pub(super) fn place(part: &str, at: u64) -> String {
    format!("{part}, byte {at}")
}

/// The error for text that is no XML, or cannot be read.
pub(super) fn error(part: &str, at: u64, error: &quick_xml::Error) -> Error {
    match error {
        quick_xml::Error::Io(source) => package::read_error(part, source),
        error => malformed(Format::ThreeMf, place(part, at), format!("{error}; the XML is damaged")),
    }
}

/// The error for a document type, which could name files and multiply text.
pub(super) fn doctype(part: &str, at: u64) -> Error {
    let what = "has a document type declaration, which 3MF forbids and which is not read; take it out";
    malformed(Format::ThreeMf, place(part, at), what)
}

/// A coordinate or another number; XML allows blanks around it.
pub(super) fn number(text: &str) -> Option<f64> {
    fast_float2::parse(text.trim_ascii()).ok()
}

/// A whole number without sign.
pub(super) fn whole(text: &str) -> Option<u32> {
    // The usual case by hand: `parse` of the standard library looks at every digit twice.
    let bytes = text.as_bytes();
    if matches!(bytes.len(), 1..=9) && bytes.iter().all(u8::is_ascii_digit) {
        return Some(bytes.iter().fold(0, |value, digit| 10 * value + u32::from(digit - b'0')));
    }
    text.trim_ascii().parse().ok()
}

/// A colour, `#RRGGBB` or `#RRGGBBAA`.
pub(super) fn colour(text: &str) -> Option<[u8; 4]> {
    let digits = text.trim_ascii().strip_prefix('#')?;
    if !matches!(digits.len(), 6 | 8) || !digits.bytes().all(|digit| digit.is_ascii_hexdigit()) {
        return None;
    }
    let byte = |k: usize| u8::from_str_radix(&digits[2 * k..2 * k + 2], 16).ok();
    Some([byte(0)?, byte(1)?, byte(2)?, if digits.len() == 8 { byte(3)? } else { 255 }])
}

/// The beginning of a value in quotes, for messages.
pub(super) fn quoted(text: &str) -> String {
    quote(text.as_bytes())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_read() {
        assert_eq!(colour("#ff8000"), Some([255, 128, 0, 255]));
        assert_eq!(colour(" #FF800040 "), Some([255, 128, 0, 64]));
        for text in ["ff8000", "#ff80", "#ff80000", "#gg8000", "#+f8000", "\u{e9}\u{e9}\u{e9}"] {
            assert_eq!(colour(text), None, "{text}");
        }
        assert_eq!(
            (whole("123456789"), whole(" 4294967295 "), whole("4294967296")),
            (Some(123_456_789), Some(u32::MAX), None)
        );
        assert_eq!((whole(""), whole("-1"), whole("1x")), (None, None, None));
        assert_eq!((number(" 1.5e3\n"), number("1,5"), number("")), (Some(1500.0), None, None));
    }
}
