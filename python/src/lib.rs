//! The compiled half of the Python package `trisect`: a narrow door between NumPy arrays and the crate.
//!
//! What users see (names, documentation, conversions, classes) is Python, in `trisect/`; here is only what must be compiled.
//! Every call that may take long lets go of Python's lock and looks for Ctrl-C (`running`). Arrays that leave are views of
//! the solid's own memory (`views`), arrays that come in are read once (`arrays`).
//!
//! - `arrays`, `views`: arrays in, arrays out;
//! - `running`: limits, threads, Ctrl-C, progress, forked processes;
//! - `failures`: errors become exceptions with data;
//! - `solids`, `meshes`: the two classes of surfaces;
//! - `settings`, `booleans`, `planes`: operations;
//! - `cages`: subdivision surfaces; `places`: transforms;
//! - `files`, `fields`, `pictures`, `shapes`: the other rooms.

mod arrays;
mod booleans;
mod cages;
mod failures;
mod fields;
mod files;
mod meshes;
mod pictures;
mod places;
mod planes;
mod running;
mod settings;
mod shapes;
mod solids;
mod views;

use pyo3::prelude::*;

/// The compiled half of `trisect`; use the package.
#[pymodule]
fn _trisect(module: &Bound<'_, PyModule>) -> PyResult<()> {
    running::note_process();
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add_class::<solids::Core>()?;
    module.add_class::<meshes::Surface>()?;
    module.add_class::<views::View>()?;
    module.add_class::<fields::Distance>()?;
    module.add_class::<fields::Field>()?;
    module.add_class::<cages::Cage>()?;
    for function in [
        wrap_pyfunction!(booleans::combine, module)?,
        wrap_pyfunction!(booleans::evaluate, module)?,
        wrap_pyfunction!(booleans::trim, module)?,
        wrap_pyfunction!(booleans::part, module)?,
        wrap_pyfunction!(cages::combine_cages, module)?,
        wrap_pyfunction!(planes::cut, module)?,
        wrap_pyfunction!(planes::sections, module)?,
        wrap_pyfunction!(planes::drawing, module)?,
        wrap_pyfunction!(planes::level, module)?,
        wrap_pyfunction!(files::load, module)?,
        wrap_pyfunction!(files::save_solid, module)?,
        wrap_pyfunction!(files::save_mesh, module)?,
        wrap_pyfunction!(files::model, module)?,
        wrap_pyfunction!(fields::extract, module)?,
        wrap_pyfunction!(pictures::picture, module)?,
        wrap_pyfunction!(shapes::shape, module)?,
    ] {
        module.add_function(function)?;
    }
    Ok(())
}
