//! Finding the line of a fault that showed only after the whole file was read.

use super::super::scan::{Scanner, line_place};

/// The line of the vertex with this index, counted from 0.
pub(super) fn vertex(bytes: &[u8], index: usize) -> String {
    let mut scanner = Scanner::new(bytes, 0);
    let mut before = 0;
    while !scanner.rest().is_empty() {
        scanner.skip_blanks();
        if matches!(scanner.rest(), [b'v', b' ' | b'\t', ..]) {
            if before == index {
                return line_place(bytes, scanner.offset());
            }
            before += 1;
        }
        skip(&mut scanner);
    }
    format!("vertex {index}")
}

/// The line of the first face that names a vertex beyond `vertices`, and that vertex counted from 0.
pub(super) fn face_out_of_range(bytes: &[u8], vertices: usize) -> (String, u64) {
    let mut scanner = Scanner::new(bytes, 0);
    while !scanner.rest().is_empty() {
        scanner.skip_blanks();
        if matches!(scanner.rest(), [b'f', b' ' | b'\t', ..]) {
            let mut face = scanner;
            face.advance(2);
            face.skip_blanks();
            while !face.at_line_end() {
                let start = face.offset();
                match face.digits() {
                    Some(index) if index > vertices as u64 => {
                        return (line_place(bytes, scanner.offset()), index - 1);
                    }
                    _ => {}
                }
                face.word();
                if face.offset() == start {
                    break;
                }
                face.skip_blanks();
            }
        }
        skip(&mut scanner);
    }
    ("some line".to_string(), vertices as u64)
}

fn skip(scanner: &mut Scanner<'_>) {
    if scanner.peek() == Some(b'#') { scanner.skip_line() } else { scanner.skip_statement() }
}
