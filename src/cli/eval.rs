//! `trisect eval`: a model file evaluated to a mesh, or to contours.

use std::path::PathBuf;

use serde_json::{Value, json};
use trisect::field::Contours;
use trisect::model::{Evaluated, Evaluation, Model};
use trisect::{Control, Error};

/// What is asked of `eval`.
#[derive(Clone, Debug, Default)]
pub(crate) struct EvalRequest {
    /// The model file.
    pub(crate) model: PathBuf,
    /// Overrides every tolerance in the model.
    pub(crate) tolerance: Option<f64>,
}

/// The model's result as a closed mesh; writing and drawing it is the caller's.
pub(crate) fn eval(request: &EvalRequest, control: &Control) -> Result<Evaluated, Error> {
    let model = Model::load(&request.model)?;
    evaluation(request, control).run(&model)
}

/// The boundary of the model's result in the plane z = `height`.
pub(crate) fn contours(request: &EvalRequest, height: f64, control: &Control) -> Result<Contours, Error> {
    let model = Model::load(&request.model)?;
    evaluation(request, control).contours(&model, height)
}

fn evaluation(request: &EvalRequest, control: &Control) -> Evaluation {
    let evaluation = Evaluation::new().control(control.clone());
    match request.tolerance {
        Some(tolerance) => evaluation.tolerance(tolerance),
        None => evaluation,
    }
}

/// The `extraction` object of the report; null for a result of exact operations alone.
pub(crate) fn extraction_json(found: &Evaluated) -> Value {
    found.extraction.map_or(Value::Null, |report| {
        json!({
            "tolerance": report.tolerance,
            "deviation": report.deviation,
            "cells": report.cells,
            "divided_cells": report.divided_cells,
        })
    })
}

/// One line about an extraction, for people.
pub(crate) fn extraction_line(found: &Evaluated) -> Option<String> {
    found.extraction.map(|report| {
        format!(
            "extracted over {} cells; largest deviation found {:.3e}, tolerance {:.3e}",
            report.cells, report.deviation, report.tolerance
        )
    })
}
