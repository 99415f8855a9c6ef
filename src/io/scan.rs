//! Walking over the words and numbers of a text file.

use super::{Format, malformed};
use crate::Error;

/// The line, counted from 1, that holds a byte of the file. Lines end with a line feed, a carriage return, or both.
pub(super) fn line_of(bytes: &[u8], offset: usize) -> usize {
    let before = &bytes[..offset.min(bytes.len())];
    let feeds = memchr::memchr_iter(b'\n', before).count();
    if feeds > 0 { feeds + 1 } else { memchr::memchr_iter(b'\r', before).count() + 1 }
}

/// "line 12", for messages.
pub(super) fn line_place(bytes: &[u8], offset: usize) -> String {
    format!("line {}", line_of(bytes, offset))
}

/// Bytes as text for a message or a name: UTF-8, or Latin-1 where it is not.
pub(super) fn decode(bytes: &[u8]) -> String {
    match std::str::from_utf8(bytes) {
        Ok(text) => text.to_string(),
        Err(_) => bytes.iter().map(|&byte| char::from(byte)).collect(),
    }
}

/// A word of the file as shown in a message: shortened, without control characters.
pub(super) fn quote(word: &[u8]) -> String {
    let shown: String = decode(&word[..word.len().min(40)])
        .chars()
        .map(|character| if character.is_control() { '\u{fffd}' } else { character })
        .collect();
    let dots = if word.len() > 40 { "..." } else { "" };
    format!("\"{shown}{dots}\"")
}

/// Whether a byte ends a word.
fn ends_word(byte: u8) -> bool {
    byte.is_ascii_whitespace() || byte == 0x0b
}

/// What stands where a number was expected.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct NotANumber;

/// A place in a text file, moving forward. A backslash before the end of a line makes one line of two.
#[derive(Clone, Copy, Debug)]
pub(super) struct Scanner<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Scanner<'a> {
    /// At byte `at`.
    pub(super) fn new(bytes: &'a [u8], at: usize) -> Self {
        Self { bytes, at }
    }

    /// The byte it stands at.
    pub(super) fn offset(&self) -> usize {
        self.at
    }

    /// The byte there, if the file has not ended.
    #[inline(always)]
    pub(super) fn peek(&self) -> Option<u8> {
        self.bytes.get(self.at).copied()
    }

    /// What is left.
    #[inline(always)]
    pub(super) fn rest(&self) -> &'a [u8] {
        self.bytes.get(self.at..).unwrap_or(&[])
    }

    /// Moves on by `count` bytes that were peeked at.
    #[inline(always)]
    pub(super) fn advance(&mut self, count: usize) {
        self.at += count;
    }

    /// Skips blanks and continued line ends, but no line end.
    #[inline(always)]
    pub(super) fn skip_blanks(&mut self) {
        loop {
            match self.peek() {
                Some(b' ' | b'\t') => self.at += 1,
                Some(b'\\') if self.skip_continuation() => {}
                Some(0x0b | 0x0c) => self.at += 1,
                _ => return,
            }
        }
    }

    /// Skips a backslash with the line end that follows it, if one does.
    #[cold]
    fn skip_continuation(&mut self) -> bool {
        let length = match self.rest() {
            [b'\\', b'\r', b'\n', ..] => 3,
            [b'\\', b'\r' | b'\n', ..] => 2,
            _ => return false,
        };
        self.at += length;
        true
    }

    /// Whether the line ends here, or a comment begins.
    #[inline(always)]
    pub(super) fn at_line_end(&self) -> bool {
        matches!(self.peek(), None | Some(b'\n' | b'\r' | b'#'))
    }

    /// Skips blanks, line ends and comments.
    #[inline(always)]
    pub(super) fn skip_to_word(&mut self) {
        loop {
            match self.peek() {
                Some(b'#') => self.skip_line(),
                Some(byte) if ends_word(byte) => self.at += 1,
                Some(b'\\') if self.skip_continuation() => {}
                _ => return,
            }
        }
    }

    /// Skips the rest of the line with its end.
    #[inline(always)]
    pub(super) fn skip_line(&mut self) {
        if self.peek() == Some(b'\n') {
            self.at += 1;
        } else {
            self.skip_to_line_end();
        }
    }

    fn skip_to_line_end(&mut self) {
        match memchr::memchr2(b'\n', b'\r', self.rest()) {
            None => self.at = self.bytes.len(),
            Some(length) => {
                let end = self.at + length;
                self.at = end + if self.bytes[end..].starts_with(b"\r\n") { 2 } else { 1 };
            }
        }
    }

    /// Skips the rest of a statement: of the line and those that continue it.
    pub(super) fn skip_statement(&mut self) {
        loop {
            let start = self.at;
            self.skip_line();
            let line = &self.bytes[start..self.at];
            let end = line.iter().rposition(|byte| !matches!(byte, b'\n' | b'\r'));
            if end.is_none_or(|end| line[end] != b'\\') {
                return;
            }
        }
    }

    /// The word here, up to the next blank or line end; empty at a line end.
    pub(super) fn word(&mut self) -> &'a [u8] {
        let rest = self.rest();
        let length = rest.iter().position(|&byte| ends_word(byte)).unwrap_or(rest.len());
        self.at += length;
        &rest[..length]
    }

    /// The word here, without moving.
    pub(super) fn peek_word(&self) -> &'a [u8] {
        let mut ahead = *self;
        ahead.word()
    }

    /// The rest of the line without blanks around it; moves past the line's end.
    pub(super) fn line(&mut self) -> &'a [u8] {
        let start = self.at;
        self.skip_line();
        self.bytes[start..self.at].trim_ascii()
    }

    /// A number, which must end with its word.
    #[inline(always)]
    pub(super) fn float(&mut self) -> Result<f64, NotANumber> {
        let (value, length) = fast_float2::parse_partial(self.rest()).map_err(|_| NotANumber)?;
        match self.bytes.get(self.at + length) {
            Some(&byte) if !ends_word(byte) && byte != b'#' && byte != b'\\' => Err(NotANumber),
            _ => {
                self.at += length;
                Ok(value)
            }
        }
    }

    /// Digits of a number without sign; `None` where there are none. Values beyond `u64` give `u64::MAX`.
    #[inline(always)]
    pub(super) fn digits(&mut self) -> Option<u64> {
        let start = self.at;
        let mut value = 0_u64;
        while let Some(digit) = self.peek().map(|byte| byte.wrapping_sub(b'0')).filter(|&digit| digit < 10) {
            value = value.wrapping_mul(10).wrapping_add(u64::from(digit));
            self.at += 1;
        }
        match self.at - start {
            0 => None,
            1..=19 => Some(value),
            // Leading zeros are legal at any length; anything else this long is beyond every limit.
            _ if self.bytes[start..self.at - 19].iter().all(|&byte| byte == b'0') => Some(value),
            _ => Some(u64::MAX),
        }
    }

    /// A whole number without sign, which must end with its word.
    pub(super) fn unsigned(&mut self) -> Result<u64, NotANumber> {
        let start = self.at;
        let value = self.digits().ok_or(NotANumber)?;
        match self.peek() {
            Some(byte) if !ends_word(byte) && byte != b'#' => {
                self.at = start;
                Err(NotANumber)
            }
            _ => Ok(value),
        }
    }

    /// The error for a word that is not what was expected.
    #[cold]
    pub(super) fn expected(&self, format: Format, what: &str) -> Error {
        let word = self.peek_word();
        let found = match word {
            b"" if self.rest().is_empty() => "the file ends".to_string(),
            b"" => "the line ends".to_string(),
            _ if word.contains(&b',') => {
                format!("found {} (decimals need a point, and numbers are parted by blanks)", quote(word))
            }
            _ => format!("found {}", quote(word)),
        };
        malformed(format, line_place(self.bytes, self.at), format!("expected {what}, {found}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_counted_for_every_line_end() {
        assert_eq!(line_of(b"a\nb\nc", 4), 3);
        assert_eq!(line_of(b"a\r\nb\r\nc", 6), 3);
        assert_eq!(line_of(b"a\rb\rc", 4), 3);
        assert_eq!(line_of(b"a", 100), 1);
    }

    #[test]
    fn numbers_end_with_their_word() {
        let number = |text: &str| Scanner::new(text.as_bytes(), 0).float().ok();
        assert_eq!(number("1.5e3 2"), Some(1500.0));
        assert_eq!(number("+.5"), Some(0.5));
        assert_eq!(number("-0"), Some(-0.0));
        assert_eq!(number("0.1#comment"), Some(0.1));
        assert_eq!(number("1,5"), None);
        assert_eq!(number("1e"), None);
        assert_eq!(number("0x10"), None);
        assert_eq!(number(""), None);
        let whole = |text: &str| Scanner::new(text.as_bytes(), 0).unsigned().ok();
        assert_eq!(whole("0000000000000000000000000012 "), Some(12));
        assert_eq!(whole("123456789012345678901234567890"), Some(u64::MAX));
        assert_eq!(whole("12.0"), None);
        assert_eq!(whole("-1"), None);
    }

    #[test]
    fn backslash_joins_lines() {
        let mut scanner = Scanner::new(b"1 \\\r\n 2\\\n3\nnext", 0);
        assert_eq!(scanner.float(), Ok(1.0));
        scanner.skip_blanks();
        assert_eq!(scanner.float(), Ok(2.0));
        scanner.skip_blanks();
        assert_eq!(scanner.float(), Ok(3.0));
        assert!(scanner.at_line_end());
        let mut scanner = Scanner::new(b"a \\\r\nb\nnext", 0);
        scanner.skip_statement();
        assert_eq!(scanner.word(), b"next");
        let mut comment = Scanner::new(b"# C:\\models\\\nv", 0);
        comment.skip_to_word();
        assert_eq!(comment.word(), b"v");
    }
}
