//! Nodes of cuts as meshes: solids of soups, parts; and surfaces trimmed by solids, which stay open.

use glam::DAffine3;

use super::meshes::moved;
use super::state::State;
use crate::boolean::{BooleanOptions, Solidify};
use crate::model::Kind;
use crate::model::cuts::{Cut, MeshFile, Sheet};
use crate::{Error, Mesh, Solid};

impl State<'_> {
    /// A mesh file, mended as the node asks for; what was done is told.
    pub(super) fn mesh_file(&mut self, node: usize, file: &MeshFile) -> Result<Mesh, Error> {
        let label = self.label(node);
        let mesh = self.loaded(&self.model.folder.join(&file.file)).map_err(|error| error.in_node(label))?;
        let Some(gate) = file.gate else { return Ok(mesh) };
        let solid = gate.solid(mesh).map_err(|refusal| Error::from(refusal.error).in_node(label))?;
        let mending = solid.mending();
        if !mending.is_none() {
            self.warnings.push(format!("{label}: mended: {mending}"));
        }
        Ok(solid.into_mesh())
    }

    /// What a cut makes, closed.
    pub(super) fn cut(&mut self, node: usize, cut: &Cut, operands: &[usize]) -> Result<Mesh, Error> {
        let label = self.label(node);
        let within = |error: Error| error.in_node(label);
        match cut {
            Cut::Solidify { file, weld } => {
                let soup = self.loaded(&self.model.folder.join(file)).map_err(within)?;
                let how = Solidify::new().options(self.boolean_options()).weld(*weld);
                let made = soup.solidify(&how).map_err(within)?;
                let report = made.report;
                self.warnings.push(format!(
                    "{label}: solidified: {} of {} cells inside, an area of {:.4e} added, one of {:.4e} dropped",
                    report.cells_inside, report.cells, report.added_area, report.dropped_area
                ));
                Ok(made.solid.into_mesh())
            }
            Cut::Part { sheets, number } => {
                let solid = self.solid_of(operands.first().copied().unwrap_or(node))?;
                let mut parts = if sheets.is_empty() {
                    // (What crosses itself has no bodies of its own.)
                    let is_clean = solid.self_crossings(&self.settings.control).map_err(within)?.is_clean();
                    if is_clean {
                        solid.bodies()
                    } else {
                        self.boolean_options().resolve(&solid).map_err(within)?.solid().bodies()
                    }
                } else {
                    let sheets =
                        sheets.iter().map(|sheet| self.sheet(node, sheet)).collect::<Result<Vec<_>, _>>()?;
                    let sheets: Vec<&Mesh> = sheets.iter().collect();
                    let cells = self.boolean_options().split(&solid, &sheets).map_err(within)?;
                    cells.into_iter().map(|cell| cell.solid).collect()
                };
                parts.sort_by(|x, y| y.volume().total_cmp(&x.volume()));
                let count = parts.len();
                parts.into_iter().nth(number - 1).map(Solid::into_mesh).ok_or_else(|| {
                    let parts = if count == 1 { "1 part".to_owned() } else { format!("{count} parts") };
                    Error::Model(format!("`part` is {number}, and there are {parts}")).in_node(label)
                })
            }
            Cut::Trim { .. } => {
                let what = "a trimmed surface is open: it is the result of a model, and no operand";
                Err(Error::Model(what.into()).in_node(label))
            }
        }
    }

    /// The model's result where it is a trimmed surface.
    pub(super) fn trimmed(&mut self) -> Result<Option<Mesh>, Error> {
        let mut node = self.model.result;
        let mut transform = DAffine3::IDENTITY;
        loop {
            let at = &self.model.nodes[node];
            transform *= at.transform;
            match &at.kind {
                // (Names do not lead round in a circle: that is checked when a model is read.)
                Kind::Reference(_, target) if at.extrude.is_none() => node = *target,
                Kind::Cut(Cut::Trim { sheet, side }, operands) if at.extrude.is_none() => {
                    let (sheet, side) = (sheet.clone(), *side);
                    let surface = self.sheet(node, &sheet)?;
                    let by = self.solid_of(operands.first().copied().unwrap_or(node))?;
                    let trimmed = self.boolean_options().trim(&surface, &by, side);
                    let mesh = trimmed.map_err(|error| error.in_node(self.label(node)))?.mesh;
                    let moved = moved(mesh, transform);
                    return moved.map(Some).map_err(|error| Error::from(error).in_node(self.label(node)));
                }
                _ => return Ok(None),
            }
        }
    }

    fn sheet(&mut self, node: usize, sheet: &Sheet) -> Result<Mesh, Error> {
        let label = self.label(node);
        let mesh = self.loaded(&self.model.folder.join(&sheet.file)).map_err(|error| error.in_node(label))?;
        sheet.readied(mesh).map_err(|error| error.in_node(label))
    }

    pub(super) fn boolean_options(&self) -> BooleanOptions {
        BooleanOptions::new().control(self.settings.control.clone())
    }
}
