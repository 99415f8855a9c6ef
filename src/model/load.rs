//! Reading the mesh files of a model: OBJ and OFF, until the readers of all formats take over.

use std::path::Path;

use crate::io::Format;
use crate::{Error, Mesh};

pub(super) fn mesh(path: &Path) -> Result<Mesh, Error> {
    let fault = |source| Error::File { action: "read", path: path.to_owned(), source };
    let text = std::fs::read_to_string(path).map_err(fault)?;
    match path.extension().and_then(|e| e.to_str()).map(str::to_ascii_lowercase).as_deref() {
        Some("obj") => obj(&text),
        Some("off") => off(&text),
        _ => Err(Error::UnknownFormat { name: path.display().to_string() }),
    }
}

fn malformed(format: Format, line: usize, what: &str) -> Error {
    Error::Malformed { format, place: format!("line {}", line + 1), what: what.to_owned() }
}

fn polygon(mesh: &mut Mesh, corners: &[u32]) {
    for k in 1..corners.len().saturating_sub(1) {
        mesh.triangles.push([corners[0], corners[k], corners[k + 1]]);
    }
}

fn obj(text: &str) -> Result<Mesh, Error> {
    let mut mesh = Mesh::default();
    for (number, line) in text.lines().enumerate() {
        let mut words = line.split_whitespace();
        let fault = |what| malformed(Format::Obj, number, what);
        match words.next() {
            Some("v") => {
                let mut next =
                    || words.next().and_then(|word| word.parse().ok()).ok_or_else(|| fault("not a vertex"));
                mesh.positions.push([next()?, next()?, next()?]);
            }
            Some("f") => {
                let corner = |word: &str| {
                    let index: i64 = word.split('/').next()?.parse().ok()?;
                    let count = mesh.positions.len() as i64;
                    let index = if index < 0 { count + index } else { index - 1 };
                    u32::try_from(index).ok().filter(|&index| i64::from(index) < count)
                };
                let corners: Option<Vec<u32>> = words.map(corner).collect();
                polygon(&mut mesh, &corners.ok_or_else(|| fault("a face names a vertex that is not there"))?);
            }
            _ => {}
        }
    }
    Ok(mesh)
}

fn off(text: &str) -> Result<Mesh, Error> {
    let mut lines = text
        .lines()
        .enumerate()
        .map(|(number, line)| (number, line.split('#').next().unwrap_or("").trim()))
        .filter(|(_, line)| !line.is_empty());
    let mut next = || {
        let (number, line) =
            lines.next().ok_or_else(|| malformed(Format::Off, 0, "the file ends too early"))?;
        Ok::<_, Error>((number, line.split_whitespace().collect::<Vec<&str>>()))
    };
    let (number, words) = next()?;
    if !words[0].ends_with("OFF") {
        return Err(malformed(Format::Off, number, "no OFF header"));
    }
    let counts = if words.len() > 2 { (number, words[1..].to_vec()) } else { next()? };
    let count = |k: usize| {
        let word = counts.1.get(k).and_then(|word| word.parse::<usize>().ok());
        word.ok_or_else(|| malformed(Format::Off, counts.0, "no counts"))
    };
    let (vertices, faces) = (count(0)?, count(1)?);
    let mut mesh = Mesh::default();
    for _ in 0..vertices {
        let (number, words) = next()?;
        let coordinate = |k: usize| {
            let word = words.get(k).and_then(|word| word.parse::<f64>().ok());
            word.ok_or_else(|| malformed(Format::Off, number, "not a vertex"))
        };
        mesh.positions.push([coordinate(0)?, coordinate(1)?, coordinate(2)?]);
    }
    for _ in 0..faces {
        let (number, words) = next()?;
        let indices: Option<Vec<u32>> = words.iter().map(|word| word.parse().ok()).collect();
        let bad = || malformed(Format::Off, number, "not a face");
        let indices = indices.or_else(|| {
            // Colours after the corners need not be whole numbers.
            let count = words.first()?.parse::<usize>().ok()?;
            words.get(..=count)?.iter().map(|word| word.parse().ok()).collect()
        });
        let indices = indices.ok_or_else(bad)?;
        let corners = indices.get(1..=indices[0] as usize).ok_or_else(bad)?;
        if corners.iter().any(|&corner| corner as usize >= vertices) {
            return Err(malformed(Format::Off, number, "a face names a vertex that is not there"));
        }
        polygon(&mut mesh, corners);
    }
    Ok(mesh)
}
