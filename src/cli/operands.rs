//! Inputs made operands.

use std::time::Instant;

#[cfg(feature = "parallel")]
use rayon::prelude::*;
use trisect::control::Reservation;
use trisect::io::{Contents, Format};
use trisect::{Control, Solid};

use super::fault::Fault;
use super::limits::Limits;
use super::mended;
use super::progress::Console;
use super::reading::{self, Input};
use super::requests::Request;
use super::usable::{self, Crossings, Unusable, Usable};

/// An input that can take part in a boolean.
pub(crate) struct Operand {
    pub(crate) request: Request,
    pub(crate) solid: Solid,
    pub(crate) format: Format,
    pub(crate) warnings: Vec<String>,
    /// What its file holds besides the mesh.
    pub(crate) contents: Contents,
    pub(crate) crossings: Option<Crossings>,
    pub(crate) seconds: f64,
    _reserved: Reservation,
}

/// Reads all inputs and makes them operands; the first fault in the order of the command line counts.
pub(crate) fn operands(
    requests: Vec<Request>,
    assume_clean: bool,
    limits: &Limits,
    control: &Control,
    console: &Console,
) -> Result<Vec<Operand>, Fault> {
    let one = |(index, request): (usize, Request)| {
        console.stage(&format!("reading {}", request.name()), 0.0);
        let name = request.name();
        operand(request, assume_clean, limits, control).map_err(|unusable| {
            let Unusable { error, remedy } = *unusable;
            Fault::of_unusable(error.of_operand(index, name), remedy)
        })
    };
    #[cfg(feature = "parallel")]
    let operands: Vec<Result<Operand, Fault>> = requests.into_par_iter().enumerate().map(one).collect();
    #[cfg(not(feature = "parallel"))]
    let operands: Vec<Result<Operand, Fault>> = requests.into_iter().enumerate().map(one).collect();
    operands.into_iter().collect()
}

fn operand(
    request: Request,
    assume_clean: bool,
    limits: &Limits,
    control: &Control,
) -> Result<Operand, Box<Unusable>> {
    let start = Instant::now();
    let Input { mesh, format, mut warnings, contents, reserved } =
        reading::read(&request, limits, control)
            .map_err(|error| Box::new(Unusable { error, remedy: None }))?;
    let Usable { solid, crossings } = usable::usable(mesh, request.repairs, assume_clean, control)?;
    warnings.extend(mended::left_out(solid.mending()));
    warnings.extend(usable::nothing_left(&solid));
    // What touches itself in single vertices would do so in the result as well.
    let solid = if solid.is_manifold() { solid } else { solid.separated().0 };
    let seconds = start.elapsed().as_secs_f64();
    Ok(Operand { request, solid, format, warnings, contents, crossings, seconds, _reserved: reserved })
}
