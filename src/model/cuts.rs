//! Nodes of files that need mending, and of cuts: solids of soups, parts, trimmed surfaces.

use std::path::PathBuf;

use serde::Deserialize;
use serde_json::{Map, Value};

use super::{fault, take};
use crate::boolean::TrimSide;
use crate::mesh::{Gate, Welding};
use crate::{Error, Mesh};

/// The kinds of cuts.
pub(super) const KINDS: [&str; 3] = ["solidify", "split", "trim"];

/// A mesh file, and what is done to make it a solid.
#[derive(Clone, Debug)]
pub(super) struct MeshFile {
    pub(super) file: PathBuf,
    /// `None` where nothing was asked for.
    pub(super) gate: Option<Gate>,
}

/// What is cut, of operands.
#[derive(Clone, Debug)]
pub(super) enum Cut {
    /// The solid that a file's triangles enclose, of no operand.
    Solidify { file: PathBuf, weld: Welding },
    /// One of the bodies of a solid, or of the cells that surfaces make of it, by size.
    Part { sheets: Vec<Sheet>, number: usize },
    /// What of a surface is inside a solid, or outside it.
    Trim { sheet: Sheet, side: TrimSide },
}

/// A file with a surface that may be open.
#[derive(Clone, Debug)]
pub(super) struct Sheet {
    pub(super) file: PathBuf,
    weld: Welding,
    orient: bool,
}

/// A distance, or `auto`.
#[derive(Deserialize)]
#[serde(untagged)]
enum Weld {
    Within(f64),
    Word(String),
}

/// True, or the most edges of a hole.
#[derive(Deserialize)]
#[serde(untagged)]
enum Holes {
    All(bool),
    UpTo(usize),
}

/// A file's name alone, or with keys.
#[derive(Deserialize)]
#[serde(untagged)]
enum SheetKeys {
    File(String),
    With(Map<String, Value>),
}

fn weld_of(object: &mut Map<String, Value>) -> Result<Option<Welding>, Error> {
    let what = "`weld` is a distance, 0 or more, or \"auto\"";
    let weld = take(object, "weld").map_err(|_| fault(what))?;
    match weld {
        None => Ok(None),
        Some(Weld::Within(distance)) if distance >= 0.0 && distance.is_finite() => {
            Ok(Some(Welding::Within(distance)))
        }
        Some(Weld::Word(word)) if word == "auto" => Ok(Some(Welding::Closing)),
        Some(_) => Err(fault(what)),
    }
}

fn flag(object: &mut Map<String, Value>, key: &str) -> Result<bool, Error> {
    Ok(take(object, key)?.unwrap_or(false))
}

fn file_of(object: &mut Map<String, Value>) -> Result<PathBuf, Error> {
    take::<String>(object, "file")?.map(PathBuf::from).ok_or_else(|| fault("`file` is missing"))
}

impl MeshFile {
    /// A file as it is.
    pub(super) fn plain(file: impl Into<PathBuf>) -> Self {
        Self { file: file.into(), gate: None }
    }

    /// Takes the keys of a `mesh` node.
    pub(super) fn take(object: &mut Map<String, Value>) -> Result<Self, Error> {
        let what = "`fill_holes` is true, or the most edges that a hole may have, 3 or more";
        let file = file_of(object)?;
        let asked = object.len();
        let mut gate =
            Gate::new().orient(flag(object, "orient")?).closed_parts(flag(object, "closed_parts")?);
        if let Some(weld) = weld_of(object)? {
            gate = gate.weld(weld);
        }
        let holes = take(object, "fill_holes").map_err(|_| fault(what))?;
        let refine = flag(object, "refine_holes")?;
        gate = match holes {
            Some(Holes::UpTo(most)) if most >= 3 => gate.fill_holes(most),
            Some(Holes::UpTo(_)) => return Err(fault(what)),
            Some(Holes::All(true)) => gate.fill_holes(usize::MAX),
            _ if refine => gate.fill_holes(usize::MAX),
            Some(Holes::All(false)) | None => gate,
        };
        let gate = (object.len() < asked).then_some(gate.refine_holes(refine));
        Ok(Self { file, gate })
    }
}

impl Sheet {
    fn parse(keys: SheetKeys) -> Result<Self, Error> {
        let mut object = match keys {
            SheetKeys::File(file) => {
                return Ok(Self { file: file.into(), weld: Welding::Rounding, orient: false });
            }
            SheetKeys::With(object) => object,
        };
        let file = file_of(&mut object)?;
        let weld = weld_of(&mut object)?.unwrap_or_default();
        let orient = flag(&mut object, "orient")?;
        match object.keys().next() {
            Some(key) => Err(fault(format!("unknown key `{key}` of a sheet; known: file, weld, orient"))),
            None => Ok(Self { file, weld, orient }),
        }
    }

    /// The surface with its vertices joined and its faces turned where that was asked for. It may stay open.
    pub(super) fn readied(&self, mesh: Mesh) -> Result<Mesh, Error> {
        let mesh = match self.weld {
            Welding::Rounding => mesh,
            weld => match (Gate::new().weld(weld).solid(mesh), weld) {
                (Ok(solid), _) => solid.into_mesh(),
                (Err(refusal), Welding::Within(distance)) => refusal.mesh.welded(distance)?,
                (Err(refusal), _) => refusal.mesh,
            },
        };
        Ok(if self.orient { mesh.oriented() } else { mesh })
    }
}

impl Cut {
    /// Reads a node's own keys, and gives its operands with their places.
    pub(super) fn parse(
        kind: &str,
        object: &mut Map<String, Value>,
    ) -> Result<(Self, Vec<(String, Value)>), Error> {
        let mut node = |key: &str, what: &str| {
            let value = object.remove(key).ok_or_else(|| fault(format!("`{key}`, {what}, is missing")))?;
            Ok::<_, Error>((key.to_owned(), value))
        };
        match kind {
            "solidify" => {
                let (file, weld) = (file_of(object)?, weld_of(object)?.unwrap_or(Welding::Closing));
                Ok((Self::Solidify { file, weld }, Vec::new()))
            }
            "split" => {
                let operand = node("operand", "the node that is split")?;
                let sheets: Vec<SheetKeys> = take(object, "sheets")
                    .map_err(|_| fault("`sheets` is a list of files, or of objects with `file`"))?
                    .unwrap_or_default();
                let sheets = sheets.into_iter().map(Sheet::parse).collect::<Result<_, _>>()?;
                let number = take(object, "part")?
                    .filter(|&number: &usize| number > 0)
                    .ok_or_else(|| fault("`part` is missing: 1 is the largest part, 2 the next"))?;
                Ok((Self::Part { sheets, number }, vec![operand]))
            }
            _ => {
                let (side, by) = match (object.remove("inside"), object.remove("outside")) {
                    (Some(node), None) => (TrimSide::Inside, ("inside".to_owned(), node)),
                    (None, Some(node)) => (TrimSide::Outside, ("outside".to_owned(), node)),
                    _ => {
                        return Err(fault(
                            "`trim` needs `inside` or `outside`: the node that tells what is kept",
                        ));
                    }
                };
                let sheet: SheetKeys = take(object, "sheet")
                    .map_err(|_| fault("`sheet` is a file, or an object with `file`"))?
                    .ok_or_else(|| fault("`sheet`, the file that is trimmed, is missing"))?;
                Ok((Self::Trim { sheet: Sheet::parse(sheet)?, side }, vec![by]))
            }
        }
    }

    /// The files that the node names.
    pub(super) fn files(&self) -> Vec<&PathBuf> {
        match self {
            Self::Solidify { file, .. } => vec![file],
            Self::Part { sheets, .. } => sheets.iter().map(|sheet| &sheet.file).collect(),
            Self::Trim { sheet, .. } => vec![&sheet.file],
        }
    }
}
