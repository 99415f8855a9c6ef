//! Files of points: three numbers a line.

use std::path::Path;

use trisect::{Error, FileAction};

use super::stream::STANDARD;

/// The points of a file: three numbers a line, separated by blanks, commas or semicolons; what follows on a line is not looked
/// at, nor are empty lines, those that begin with `#`, and a first line of words.
pub(crate) fn of_file(path: &Path) -> Result<Vec<[f64; 3]>, Error> {
    let failed = |source| Error::File { action: FileAction::Read, path: path.to_path_buf(), source };
    let text = if path == Path::new(STANDARD) {
        std::io::read_to_string(std::io::stdin()).map_err(failed)?
    } else {
        std::fs::read_to_string(path).map_err(failed)?
    };
    of_text(&text).map_err(|what| failed(std::io::Error::new(std::io::ErrorKind::InvalidData, what)))
}

fn of_text(text: &str) -> Result<Vec<[f64; 3]>, String> {
    let mut points = Vec::new();
    for (number, line) in (1..).zip(text.lines()) {
        let line = line.trim();
        if line.is_empty() || line.starts_with('#') {
            continue;
        }
        let mut words = line.split([',', ';', ' ', '\t']).filter(|word| !word.is_empty());
        let mut next = || words.next().and_then(|word| word.parse::<f64>().ok()).filter(|x| x.is_finite());
        match (next(), next(), next()) {
            (Some(x), Some(y), Some(z)) => points.push([x, y, z]),
            // Names of columns.
            (None, None, None)
                if points.is_empty() && line.starts_with(|c: char| c.is_alphabetic() || c == '"') => {}
            _ => return Err(format!("line {number}: expected three numbers, x y z, not '{line}'")),
        }
    }
    if points.is_empty() { Err("no points: expected three numbers a line, x y z".into()) } else { Ok(points) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_are_three_numbers_a_line() {
        let read = of_text("x,y,z\n# holes\n1,2,3\n\n4 5\t6 comment\n7;8;9\r\n");
        assert_eq!(read, Ok(vec![[1.0, 2.0, 3.0], [4.0, 5.0, 6.0], [7.0, 8.0, 9.0]]));
        assert!(of_text("1,2,3\nx,y,z\n").unwrap_err().contains("line 2"));
        assert!(of_text("1,2\n").unwrap_err().contains("line 1"));
        assert!(of_text("1,2,inf\n").is_err() && of_text("# nothing\n").is_err());
    }
}
