//! Settings of a call, from the dictionary that Python makes of its arguments. It has only what was given.

use pyo3::prelude::*;
use pyo3::types::PyDict;
use trisect::{BooleanOptions, Contact, Control, CutFaces, Embed, FaceGroup, Grid, Rule};

use crate::failures;
use crate::running::Limits;

/// Limits of a call; other settings are left alone.
pub(crate) fn limits(settings: Option<&Bound<'_, PyDict>>) -> PyResult<Limits> {
    let mut limits = Limits::default();
    let Some(settings) = settings else { return Ok(limits) };
    if let Some(seconds) = settings.get_item("deadline")? {
        limits.deadline = Some(seconds.extract()?);
    }
    if let Some(bytes) = settings.get_item("memory")? {
        limits.memory = Some(bytes.extract()?);
    }
    if let Some(threads) = settings.get_item("threads")? {
        let threads: usize = threads.extract()?;
        if threads == 0 {
            return Err(failures::argument("threads are counted from 1"));
        }
        limits.threads = Some(threads);
    }
    if let Some(callback) = settings.get_item("progress")? {
        limits.progress = Some(callback.unbind());
    }
    Ok(limits)
}

/// Settings of an operation; limits and threads are [`Limits`]' own.
#[derive(Default)]
pub(crate) struct Settings {
    options: BooleanOptions,
}

impl Settings {
    /// Reads the dictionary.
    pub(crate) fn read(settings: Option<&Bound<'_, PyDict>>) -> PyResult<Self> {
        let mut options = BooleanOptions::new();
        let Some(settings) = settings else { return Ok(Self { options }) };
        let mut texture: Option<(String, f64)> = None;
        let mut faces = CutFaces::tool();
        for (key, value) in settings.iter() {
            let key: String = key.extract()?;
            options = match key.as_str() {
                "deadline" | "memory" | "threads" | "progress" => options,
                "contact" => options.contact(named::<Contact>(&value)?),
                "rule" => options.rule(named::<Rule>(&value)?),
                "rules" => {
                    let rules = value.try_iter()?.map(|rule| named::<Rule>(&rule?));
                    options.rules(rules.collect::<PyResult<Vec<Rule>>>()?)
                }
                "assume_clean" => options.assume_clean(value.extract()?),
                "remove_vertices" => options.remove_vertices(value.extract()?),
                "snap" => options.snap(value.extract()?),
                "embed" => options.embed(embed(&value)?),
                "cut_faces" => {
                    faces = cut_faces(&value)?;
                    options
                }
                "cut_uv" => {
                    texture = Some(value.extract()?);
                    options
                }
                _ => return Err(failures::argument(&format!("unknown setting '{key}'"))),
            };
        }
        faces = match texture {
            None => faces,
            Some((kind, per_unit)) if kind == "planar" => faces.planar(per_unit),
            Some((kind, per_unit)) if kind == "box" => faces.boxed(per_unit),
            Some((kind, _)) => {
                return Err(failures::argument(&format!("unknown cut_uv '{kind}': known are planar, box")));
            }
        };
        Ok(Self { options: options.cut_faces(faces) })
    }

    /// The options of one call.
    pub(crate) fn options(&self, control: &Control) -> BooleanOptions {
        self.options.clone().control(control.clone())
    }
}

/// One of the crate's names.
fn named<T: std::str::FromStr<Err: std::fmt::Display>>(value: &Bound<'_, PyAny>) -> PyResult<T> {
    let text: String = value.extract()?;
    text.parse().map_err(|error: T::Err| failures::argument(&error.to_string()))
}

fn embed(value: &Bound<'_, PyAny>) -> PyResult<Embed> {
    if let Ok(wanted) = value.extract::<bool>() {
        return Ok(if wanted { Embed::OnGrid(Grid::Double) } else { Embed::Never });
    }
    match value.extract::<String>()?.as_str() {
        "never" => Ok(Embed::Never),
        "where-needed" => Ok(Embed::WhereNeeded),
        "near-cut" => Ok(Embed::NearCut),
        "double" => Ok(Embed::OnGrid(Grid::Double)),
        "single" => Ok(Embed::OnGrid(Grid::Single)),
        other => Err(failures::argument(&format!(
            "unknown embed '{other}': known are never, where-needed, near-cut, double, single"
        ))),
    }
}

fn cut_faces(value: &Bound<'_, PyAny>) -> PyResult<CutFaces> {
    Ok(match value.extract::<String>()?.as_str() {
        "tool" => CutFaces::tool(),
        "body" => CutFaces::body(),
        name => CutFaces::group(FaceGroup { name: name.into(), material: None }),
    })
}
