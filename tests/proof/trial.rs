//! Runs operations, compares results with what is expected, and collects what differs.

use std::fmt::Write as _;
use std::panic::{AssertUnwindSafe, catch_unwind};

use trisect::{Mesh, Operation, Solid};

use super::common::same_bits;
use super::judge::surface::Properties;

/// How much of a systematic battery to try: one case in `usual`, or as the environment says.
pub(crate) fn one_in(usual: usize) -> usize {
    match std::env::var("TRISECT_PROOF").as_deref() {
        Ok("all") => 1,
        Ok(times) => {
            (usual / times.parse::<usize>().expect("TRISECT_PROOF is a number or all").max(1)).max(1)
        }
        Err(_) => usual,
    }
}

/// What a result must be; what is `None` is not asked.
#[derive(Clone, Debug, Default)]
pub(crate) struct Expected {
    pub(crate) volume: Option<f64>,
    pub(crate) area: Option<f64>,
    pub(crate) empty: Option<bool>,
    pub(crate) components: Option<usize>,
    pub(crate) euler: Option<i64>,
    pub(crate) triangles: Option<usize>,
    /// Relative to the volume and area of the box round the operands; 0: exact.
    pub(crate) tolerance: f64,
    /// Whether triangles without area are let pass. (Only where contacts are off by rounding.)
    pub(crate) flat_triangles: bool,
}

/// What failed so far.
#[derive(Default)]
pub(crate) struct Trial {
    tried: usize,
    failures: Vec<String>,
}

impl Trial {
    /// Runs an operation, and notes where its result is not as expected. Returns the result unless there was a panic.
    pub(crate) fn run(
        &mut self,
        context: &str,
        operation: Operation,
        operands: [&Solid; 2],
        expected: &Expected,
    ) -> Option<Solid> {
        self.tried += 1;
        let run = || same_bits::run(operation, &operands);
        let Ok(outcome) = catch_unwind(AssertUnwindSafe(run)) else {
            self.fail(context, operation, operands, None, "panic");
            return None;
        };
        let found = Properties::of(outcome.solid().mesh());
        let faults = faults(&found, outcome.solid().mesh(), operands, expected);
        if outcome.origins().len() != outcome.solid().mesh().triangles.len() {
            self.fail(context, operation, operands, None, "not one origin for each triangle");
        }
        if !faults.is_empty() {
            self.fail(context, operation, operands, Some(outcome.solid().mesh()), &faults);
        }
        Some(outcome.into_solid())
    }

    /// Notes a failure that was found elsewhere.
    pub(crate) fn note(&mut self, failure: String) {
        self.failures.push(failure);
    }

    fn fail(
        &mut self,
        context: &str,
        operation: Operation,
        operands: [&Solid; 2],
        result: Option<&Mesh>,
        faults: &str,
    ) {
        if let Ok(folder) = std::env::var("TRISECT_PROOF_SAVE") {
            let number = self.failures.len();
            for (name, mesh) in
                [("a", Some(operands[0].mesh())), ("b", Some(operands[1].mesh())), ("r", result)]
            {
                if let Some(mesh) = mesh {
                    mesh.save(format!("{folder}/{number}-{operation:?}-{name}.obj"))
                        .expect("a writable folder");
                }
            }
        }
        self.failures.push(format!("{context} {operation:?}: {faults}"));
    }

    /// Panics if anything failed, naming the first few; and if too little was tried.
    pub(crate) fn finish(self, at_least: usize) {
        let mut text = String::new();
        self.failures.iter().take(12).for_each(|failure| writeln!(text, "{failure}").expect("memory"));
        assert!(self.failures.is_empty(), "{} of {} failed:\n{text}", self.failures.len(), self.tried);
        assert!(self.tried >= at_least, "only {} tried", self.tried);
    }
}

fn faults(found: &Properties, mesh: &Mesh, operands: [&Solid; 2], expected: &Expected) -> String {
    let mut faults = Vec::new();
    if !found.closed {
        faults.push("not closed".to_string());
    }
    if !found.manifold {
        faults.push("not a manifold".to_string());
    }
    if found.zero_area > 0 && !expected.flat_triangles {
        faults.push(format!("{} triangles without area", found.zero_area));
    }
    let [low, high] = super::judge::vector::extent(operands.iter().flat_map(|solid| &solid.mesh().positions));
    let size = [0, 1, 2].map(|k| high[k] - low[k]);
    let box_area = 2.0 * (size[0] * size[1] + size[1] * size[2] + size[2] * size[0]);
    let mut number = |name: &str, found: f64, expected: Option<f64>, tolerance: f64| {
        if let Some(expected) = expected
            && (found - expected).abs() > tolerance
        {
            faults.push(format!("{name} {found:?}, not {expected:?} (off by {:e})", found - expected));
        }
    };
    number("volume", found.volume, expected.volume, expected.tolerance * size.iter().product::<f64>());
    // A sum of square roots is not exact even where the surface is.
    number("area", found.area, expected.area, expected.tolerance.max(1e-14) * box_area);
    let mut count = |name: &str, found: i64, expected: Option<i64>| {
        if expected.is_some_and(|expected| found != expected) {
            faults.push(format!("{name} {found}, not {}", expected.unwrap_or_default()));
        }
    };
    let signed = |count: usize| i64::try_from(count).expect("a small number");
    count("components", signed(found.components), expected.components.map(signed));
    count("Euler characteristic", found.euler, expected.euler);
    count("triangles", signed(mesh.triangles.len()), expected.triangles.map(signed));
    if expected.empty.is_some_and(|empty| empty != mesh.triangles.is_empty()) {
        faults.push(format!("{} triangles where the result is (not) empty", mesh.triangles.len()));
    }
    faults.join(", ")
}
