//! Grids of values and pictures of sections.

use crate::common::shapes::{cuboid, sphere};
use trisect::field::{Formula, Grid, GridFormat, Section, SignRule, SignedDistance, System};
use trisect::{Control, Error};

#[test]
fn bands_are_dense_grids_cut_off() {
    let mesh = sphere([0.1, 0.0, -0.05], 1.0, 16, 0.1);
    let distance = SignedDistance::of_mesh(&mesh, SignRule::Automatic);
    let grid = || Grid::over([-1.4; 3], [1.4, 1.3, 1.2], 0.05).expect("a grid");
    let dense = grid().dense(&distance, &Control::new()).expect("no limits");
    let band = 0.12;
    let banded = grid().banded(&distance, band, &Control::new()).expect("no limits");
    assert_eq!(dense.shape, [57, 55, 53]);
    for i in 0..57 {
        for j in 0..55 {
            for k in 0..53 {
                let at = (i * 55 + j) * 53 + k;
                let exact = distance.at(dense.point([i, j, k]));
                assert_eq!(dense.values[at], exact as f32);
                assert_eq!(banded.values[at], exact.clamp(-band, band) as f32);
            }
        }
    }
}

#[test]
fn files_say_what_they_hold() {
    let distance = SignedDistance::of_mesh(&cuboid([0.0; 3], [1.0; 3]), SignRule::Automatic);
    let grid = Grid::over([-0.5; 3], [1.5, 1.5, 2.0], 0.25).and_then(|g| g.dense(&distance, &Control::new()));
    let grid = grid.expect("a grid");
    let mut npy = Vec::new();
    grid.write(GridFormat::Npy, &mut npy).expect("memory");
    assert_eq!(&npy[..8], b"\x93NUMPY\x01\x00");
    let header = usize::from(u16::from_le_bytes([npy[8], npy[9]]));
    assert_eq!((10 + header) % 64, 0);
    let text = std::str::from_utf8(&npy[10..10 + header]).expect("text");
    assert!(
        text.starts_with("{'descr': '<f4', 'fortran_order': False, 'shape': (9, 9, 11), }")
            && text.ends_with('\n')
    );
    assert_eq!(npy.len(), 10 + header + 9 * 9 * 11 * 4);
    let mut raw = Vec::new();
    grid.write(GridFormat::Raw, &mut raw).expect("memory");
    let line = raw.iter().position(|&b| b == b'\n').expect("a line");
    let said = std::str::from_utf8(&raw[..line]).expect("text");
    assert_eq!(said, "trisect-grid 1 float32 little-endian 9 9 11 -0.5 -0.5 -0.5 0.25");
    assert_eq!(raw[line + 1..], npy[10 + header..]);
    // z runs fastest: the value at (4, 4, 0) is half a unit below the box.
    let at = line + 1 + 4 * ((4 * 9 + 4) * 11);
    assert_eq!(f32::from_le_bytes(raw[at..at + 4].try_into().expect("four")), -0.5);
}

#[test]
fn absurd_grids_are_refused() {
    let grid = |spacing| Grid::over([0.0; 3], [1.0; 3], spacing);
    assert!(matches!(grid(0.0), Err(Error::InvalidArgument(_))));
    assert!(matches!(grid(f64::NAN), Err(Error::InvalidArgument(_))));
    assert!(matches!(grid(1e-7), Err(Error::TooLarge { .. })));
    assert!(Grid::over([0.0; 3], [-1.0; 3], 0.1).is_err());
    let field = Formula::parse("x").and_then(|f| f.compile(System::R0, &[], &[])).expect("x");
    let limited = Control::new().memory_limit(100);
    let sampled = grid(0.1).and_then(|g| g.sample(&field, &limited));
    assert!(matches!(sampled, Err(Error::Limit(trisect::Limit::Memory { .. }))));
}

#[cfg(feature = "render")]
#[test]
fn pictures_show_the_inside_warm_and_the_zero_line_dark() {
    let field =
        Formula::parse("1 - length(x, y)").and_then(|f| f.compile(System::R0, &[], &[])).expect("a disc");
    let section = Section::across(2, 0.0, [-2.0; 3], [2.0; 3]).expect("a section");
    let drawn = |field, width| section.picture(field, width, None, &Control::new());
    let picture = drawn(&field, 200).expect("a picture");
    assert_eq!((picture.width(), picture.height()), (200, 200));
    let at = |x: u32, y: u32| picture.get(x, y).expect("a pixel");
    let warm = |p: [u8; 3]| p[0] > p[2];
    assert!(warm(at(100, 60)) && !warm(at(100, 5)));
    // The circle's leftmost point, at x = -1: a quarter across.
    assert!(at(50, 100).iter().all(|&c| c < 80), "{:?}", at(50, 100));
    // The upper half plane is up.
    let up = Formula::parse("y").and_then(|f| f.compile(System::R0, &[], &[])).expect("a half plane");
    let picture = drawn(&up, 20).expect("a picture");
    assert!(warm(picture.pixels()[0]) && !warm(picture.pixels()[399]));
    assert!(drawn(&field, 0).is_err());
    assert!(Section::across(3, 0.0, [0.0; 3], [1.0; 3]).is_err());
    let undefined = Formula::parse("sqrt(x)").and_then(|f| f.compile(System::R0, &[], &[])).expect("a root");
    let picture = drawn(&undefined, 20).expect("a picture");
    assert_eq!(picture.pixels()[0], [128; 3]);
}
