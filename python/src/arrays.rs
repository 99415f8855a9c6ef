//! Arrays that come in, and new ones that leave. What is no array of two dimensions yet is made one by `trisect/_arrays.py`.

use numpy::{Element, PyArray1, PyArray2, PyArrayMethods as _, PyReadonlyArray2, PyUntypedArrayMethods as _};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use trisect::Mesh;

use crate::failures;

/// Positions from an array of `f64` or `f32` of shape (n, 3), in any memory order.
pub(crate) fn positions(array: &Bound<'_, PyAny>) -> PyResult<Vec<[f64; 3]>> {
    if let Ok(array) = array.cast::<PyArray2<f64>>() {
        let array = array.try_readonly()?;
        return match in_rows(&array) {
            Some(numbers) if array.shape()[1] == 3 => Ok(numbers.as_chunks::<3>().0.to_vec()),
            _ => rows(&array, "vertices", |x| x),
        };
    }
    if let Ok(array) = array.cast::<PyArray2<f32>>() {
        return rows(&array.try_readonly()?, "vertices", f64::from);
    }
    Err(PyTypeError::new_err("coordinates are an array of shape (n, 3) of float32 or float64"))
}

/// The rows of an array of three columns.
fn rows<T: Element + Copy>(
    array: &PyReadonlyArray2<'_, T>,
    what: &str,
    number: impl Fn(T) -> f64,
) -> PyResult<Vec<[f64; 3]>> {
    let &[count, columns] = array.shape() else { return Err(failures::shape(what, array.shape())) };
    if columns != 3 {
        return Err(failures::shape(what, array.shape()));
    }
    if let Some(numbers) = in_rows(array) {
        return Ok(numbers.as_chunks::<3>().0.iter().map(|row| [0, 1, 2].map(|k| number(row[k]))).collect());
    }
    let view = array.as_array();
    Ok((0..count).map(|i| [0, 1, 2].map(|k| number(view[[i, k]]))).collect())
}

/// The numbers row by row, if they lie so. (NumPy's columns one after the other are in one piece too.)
fn in_rows<'a, T: Element>(array: &'a PyReadonlyArray2<'_, T>) -> Option<&'a [T]> {
    if array.is_c_contiguous() { array.as_slice().ok() } else { None }
}

/// Triangles from an array of `i64` of shape (m, 3) whose rows lie one after the other; `None` for other arrays. (What NumPy makes
/// unless asked for something else is read where the crate is optimised for speed, and not copied once more.)
pub(crate) fn triangles(array: &Bound<'_, PyAny>, vertices: usize) -> PyResult<Option<Vec<[u32; 3]>>> {
    let Ok(array) = array.cast::<PyArray2<i64>>() else { return Ok(None) };
    let array = array.try_readonly()?;
    let Some(numbers) = in_rows(&array).filter(|_| array.shape()[1] == 3) else { return Ok(None) };
    let found = Mesh::triangles_of(numbers, vertices);
    found.map(Some).map_err(|place| failures::index(place / 3, numbers[place], vertices))
}

/// Faces from an array of integers of shape (m, k), `k` corners each, in any memory order: the corners one after the other, and
/// `k`. `vertices` is how many there are.
pub(crate) fn faces(array: &Bound<'_, PyAny>, vertices: usize) -> PyResult<(Vec<u32>, usize)> {
    if let Ok(array) = array.cast::<PyArray2<i64>>() {
        return corners(&array.try_readonly()?, vertices, |x| x);
    }
    if let Ok(array) = array.cast::<PyArray2<i32>>() {
        return corners(&array.try_readonly()?, vertices, i64::from);
    }
    if let Ok(array) = array.cast::<PyArray2<u32>>() {
        return corners(&array.try_readonly()?, vertices, i64::from);
    }
    Err(PyTypeError::new_err("faces are an array of shape (m, 3) of int32, int64 or uint32"))
}

fn corners<T: Element + Copy>(
    array: &PyReadonlyArray2<'_, T>,
    vertices: usize,
    number: impl Fn(T) -> i64,
) -> PyResult<(Vec<u32>, usize)> {
    let &[count, columns] = array.shape() else { return Err(failures::shape("faces", array.shape())) };
    let mut found = Vec::with_capacity(count * columns);
    if let Some(numbers) = in_rows(array) {
        found.extend(numbers.iter().map(|&corner| number(corner) as u32));
    } else {
        found.extend(array.as_array().iter().map(|&corner| number(corner) as u32));
    }
    // (A number that is no index, negative or larger than 32 bits, is looked for by itself: the loop above stays fast.)
    let limit = vertices.min(u32::MAX as usize) as i64;
    let is_off = |&corner: &T| !(0..limit).contains(&number(corner));
    let off = match in_rows(array) {
        Some(numbers) => numbers.iter().position(is_off),
        None => array.as_array().iter().position(is_off),
    };
    if let Some(place) = off {
        let (face, corner) = (place / columns.max(1), place % columns.max(1));
        return Err(failures::index(face, number(array.as_array()[[face, corner]]), vertices));
    }
    Ok((found, columns))
}

/// Polygons of different sizes: all corners one after the other, and how many each has.
pub(crate) fn ragged(
    corners: &Bound<'_, PyArray1<i64>>,
    sizes: &[u32],
    vertices: usize,
) -> PyResult<Vec<u32>> {
    let corners = corners.try_readonly()?;
    let corners = corners.as_array();
    let limit = vertices.min(u32::MAX as usize) as i64;
    if let Some(place) = corners.iter().position(|corner| !(0..limit).contains(corner)) {
        let mut end = 0usize;
        let face = sizes.iter().position(|&size| {
            end += size as usize;
            place < end
        });
        return Err(failures::index(face.unwrap_or_default(), corners[place], vertices));
    }
    Ok(corners.iter().map(|&corner| corner as u32).collect())
}

/// A new array with a row for each of `rows`.
pub(crate) fn table<'py, const N: usize>(
    py: Python<'py>,
    rows: &[[f64; N]],
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    PyArray1::from_slice(py, rows.as_flattened()).reshape([rows.len(), N])
}
