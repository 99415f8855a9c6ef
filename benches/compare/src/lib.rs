//! A C interface to trisect for the benchmark that compares engines through Python. Arrays in, arrays out.
//!
//! Every function that returns a pointer returns null on failure; `trisect_error` then tells why.

use std::cell::RefCell;
use std::ffi::{CString, c_char};

use trisect::{BooleanOptions, Error, Mesh, Operation, Solid};

thread_local! {
    static MESSAGE: RefCell<CString> = RefCell::default();
}

fn or_null<T>(result: Result<T, Error>) -> *mut T {
    match result {
        Ok(value) => Box::into_raw(Box::new(value)),
        Err(error) => {
            MESSAGE
                .with(|message| *message.borrow_mut() = CString::new(error.to_string()).unwrap_or_default());
            std::ptr::null_mut()
        }
    }
}

/// Why the last call on this thread failed.
#[unsafe(no_mangle)]
pub extern "C" fn trisect_error() -> *const c_char {
    MESSAGE.with(|message| message.borrow().as_ptr())
}

/// A solid from `vertex_count` positions (three doubles each) and `triangle_count` triangles (three 32-bit indices each).
///
/// # Safety
/// The arrays must be as long as stated.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn trisect_solid(
    positions: *const [f64; 3],
    vertex_count: usize,
    triangles: *const [u32; 3],
    triangle_count: usize,
) -> *mut Solid {
    let (positions, triangles) = unsafe {
        (
            if vertex_count == 0 { &[] } else { std::slice::from_raw_parts(positions, vertex_count) },
            if triangle_count == 0 { &[] } else { std::slice::from_raw_parts(triangles, triangle_count) },
        )
    };
    or_null(Solid::try_from(Mesh::new(positions.to_vec(), triangles.to_vec())).map_err(Error::from))
}

/// Combines solids; operation 0 union, 1 intersection, 2 difference, 3 symmetric difference; `threads` 0: all.
///
/// # Safety
/// `operands` must point to `count` live solids.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn trisect_boolean(
    operation: u32,
    operands: *const *const Solid,
    count: usize,
    threads: usize,
) -> *mut Solid {
    let operands = unsafe { std::slice::from_raw_parts(operands, count).iter().map(|&solid| &*solid) };
    let operation =
        [Operation::Union, Operation::Intersection, Operation::Difference, Operation::SymmetricDifference]
            [operation as usize % 4];
    let options = if threads == 0 { BooleanOptions::new() } else { BooleanOptions::new().threads(threads) };
    or_null(options.run(operation, operands).map(trisect::Outcome::into_solid))
}

/// Number of vertices (0) or triangles (1) of a solid.
///
/// # Safety
/// `solid` must be live.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn trisect_count(solid: *const Solid, what: u32) -> usize {
    let mesh = unsafe { (*solid).mesh() };
    if what == 0 { mesh.positions.len() } else { mesh.triangles.len() }
}

/// Copies a solid's arrays out.
///
/// # Safety
/// `solid` must be live and the arrays as long as its counts.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn trisect_copy(
    solid: *const Solid,
    positions: *mut [f64; 3],
    triangles: *mut [u32; 3],
) {
    unsafe {
        let mesh = (*solid).mesh();
        std::ptr::copy_nonoverlapping(mesh.positions.as_ptr(), positions, mesh.positions.len());
        std::ptr::copy_nonoverlapping(mesh.triangles.as_ptr(), triangles, mesh.triangles.len());
    }
}

/// Frees a solid.
///
/// # Safety
/// `solid` must be live; it is not afterwards.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn trisect_free(solid: *mut Solid) {
    drop(unsafe { Box::from_raw(solid) });
}

/// Number of pairs of triangles of a solid that cross each other in earnest.
///
/// # Safety
/// `solid` must be live.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn trisect_self_crossings(solid: *const Solid) -> i64 {
    let found = unsafe { (*solid).self_crossings(&trisect::Control::new()) };
    found.map_or(-1, |found| found.count as i64)
}
