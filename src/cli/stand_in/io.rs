//! OFF and OBJ, triangles only. `// replaced when io lands`: `use trisect::io` instead.

use std::io::Write;
use std::path::{Path, PathBuf};

use trisect::io::Format;
use trisect::{Control, Error, FaceGroup, Mesh};

pub(crate) trait FormatNames: Sized {
    const ALL: [Format; 6] = [Format::Obj, Format::Gltf, Format::Glb, Format::Stl, Format::Ply, Format::Off];
    fn extension(self) -> &'static str;
    fn from_name(name: &str) -> Option<Self>;
    fn from_path(path: &Path) -> Option<Self>;
}

impl FormatNames for Format {
    fn extension(self) -> &'static str {
        match self {
            Self::Obj => "obj",
            Self::Gltf => "gltf",
            Self::Glb => "glb",
            Self::Stl => "stl",
            Self::Ply => "ply",
            Self::Off => "off",
            _ => "",
        }
    }

    fn from_name(name: &str) -> Option<Self> {
        <Self as FormatNames>::ALL.into_iter().find(|format| format.extension().eq_ignore_ascii_case(name))
    }

    fn from_path(path: &Path) -> Option<Self> {
        Self::from_name(path.extension()?.to_str()?)
    }
}

pub(crate) struct Loaded {
    pub(crate) mesh: Mesh,
    pub(crate) format: Format,
    pub(crate) warnings: Vec<String>,
}

#[derive(Clone, Default)]
pub(crate) struct ReadOptions;

impl ReadOptions {
    pub(crate) fn new() -> Self {
        Self
    }

    pub(crate) fn folder(self, _: impl Into<PathBuf>) -> Self {
        self
    }

    pub(crate) fn control(self, _: Control) -> Self {
        self
    }
}

#[derive(Clone, Copy, Default)]
pub(crate) enum Encoding {
    #[default]
    Binary,
    Ascii,
}

#[derive(Clone, Copy, Default)]
pub(crate) enum Precision {
    #[default]
    Double,
    Single,
}

#[derive(Clone, Default)]
pub(crate) struct WriteOptions;

impl WriteOptions {
    pub(crate) fn new() -> Self {
        Self
    }

    pub(crate) fn encoding(self, _: Encoding) -> Self {
        self
    }

    pub(crate) fn precision(self, _: Precision) -> Self {
        self
    }

    pub(crate) fn control(self, _: Control) -> Self {
        self
    }
}

pub(crate) fn load(path: &Path, options: &ReadOptions) -> Result<Loaded, Error> {
    let bytes =
        std::fs::read(path).map_err(|source| Error::File { action: "read", path: path.into(), source })?;
    let unknown = || Error::UnknownFormat { name: path.display().to_string() };
    read(&bytes, Format::from_path(path).ok_or_else(unknown)?, options)
}

pub(crate) fn read(bytes: &[u8], format: Format, _: &ReadOptions) -> Result<Loaded, Error> {
    let damaged = |line: usize, what: &str| Error::Malformed {
        format,
        place: format!("line {}", line + 1),
        what: what.to_string(),
    };
    let text = String::from_utf8_lossy(bytes);
    let mut mesh = Mesh::default();
    let mut warnings = Vec::new();
    match format {
        Format::Obj => {
            for (line, words) in
                text.lines().map(|line| line.split_whitespace().collect::<Vec<_>>()).enumerate()
            {
                match words.as_slice() {
                    ["v", rest @ ..] if rest.len() >= 3 => {
                        let number = |k: usize| rest[k].parse().map_err(|_| damaged(line, "not a number"));
                        mesh.positions.push([number(0)?, number(1)?, number(2)?]);
                    }
                    ["f", a, b, c] => {
                        let index = |word: &str| match word.split('/').next().map(str::parse::<u32>) {
                            Some(Ok(index)) if (1..=mesh.positions.len()).contains(&(index as usize)) => {
                                Ok(index - 1)
                            }
                            _ => Err(damaged(line, "no such vertex")),
                        };
                        mesh.triangles.push([index(a)?, index(b)?, index(c)?]);
                        if let Some(last) = mesh.groups.list.len().checked_sub(1) {
                            mesh.groups.of_triangle.push(last as u32);
                        }
                    }
                    ["o" | "g", name] => {
                        mesh.groups.list.push(FaceGroup { name: (*name).to_string(), material: None });
                    }
                    ["mtllib", name] => warnings.push(format!("material library {name} was not found")),
                    ["f" | "v", ..] => return Err(damaged(line, "not a triangle or a vertex")),
                    _ => {}
                }
            }
        }
        Format::Off => {
            let mut words = text.split_whitespace().skip(1);
            let mut number = || words.next().and_then(|word| word.parse::<f64>().ok());
            let mut next = || number().ok_or_else(|| damaged(0, "a number is missing"));
            let (vertices, faces) = (next()? as usize, next()? as usize);
            next()?;
            for _ in 0..vertices {
                mesh.positions.push([next()?, next()?, next()?]);
            }
            for _ in 0..faces {
                next()?;
                mesh.triangles.push([next()? as u32, next()? as u32, next()? as u32]);
            }
        }
        _ => return Err(Error::Unsupported { format, what: "not built yet".into() }),
    }
    Ok(Loaded { mesh, format, warnings })
}

pub(crate) fn save(mesh: &Mesh, path: &Path, options: &WriteOptions) -> Result<Vec<String>, Error> {
    let unknown = || Error::UnknownFormat { name: path.display().to_string() };
    let format = Format::from_path(path).ok_or_else(unknown)?;
    let mut file = std::fs::File::create(path).map_err(|source| Error::File {
        action: "create",
        path: path.into(),
        source,
    })?;
    write(mesh, format, &mut file, options)
}

pub(crate) fn write(
    mesh: &Mesh,
    format: Format,
    output: &mut impl Write,
    _: &WriteOptions,
) -> Result<Vec<String>, Error> {
    use std::fmt::Write as _;
    let mut text = String::new();
    let (vertex, face, base) = match format {
        Format::Obj => ("v ", "f ", 1),
        Format::Off => {
            let _ = writeln!(text, "OFF\n{} {} 0", mesh.positions.len(), mesh.triangles.len());
            ("", "3 ", 0)
        }
        _ => return Err(Error::Unsupported { format, what: "not built yet".into() }),
    };
    for [x, y, z] in &mesh.positions {
        let _ = writeln!(text, "{vertex}{x} {y} {z}");
    }
    for triangle in &mesh.triangles {
        let [a, b, c] = triangle.map(|corner| corner + base);
        let _ = writeln!(text, "{face}{a} {b} {c}");
    }
    output.write_all(text.as_bytes()).map_err(|source| Error::File {
        action: "write",
        path: "the output".into(),
        source,
    })?;
    Ok(Vec::new())
}
