//! Determinants in `f64` with bounds on their errors: the first stage of every sign.

/// Relative error bound of `orient3d` in `f64`: (7 + 56 u) u with u = 2^-53 (Shewchuk 1997, section 4.3).
pub(super) const ORIENT3D_BOUND: f64 = (7.0 + 56.0 * HALF_ULP) * HALF_ULP;
/// Relative error bound of `orient2d` in `f64`: (3 + 16 u) u (Shewchuk 1997, section 4.3).
pub(super) const ORIENT2D_BOUND: f64 = (3.0 + 16.0 * HALF_ULP) * HALF_ULP;
const HALF_ULP: f64 = f64::EPSILON / 2.0;
/// What a determinant must exceed for its filter to count, in its own unit (a volume or an area): 2^-700. A product of two
/// differences that underflows loses at most 2^-1075, and at most one further factor multiplies it. That factor is at
/// most 2^351 where coordinates keep to [`FILTER_RANGE`], so that a dozen of such losses stay below 2^-720.
pub(super) const UNDERFLOW_FLOOR: f64 = f64::from_bits((1023 - 700) << 52);
/// The largest absolute value of a coordinate, or of a factor after the first two, for which [`UNDERFLOW_FLOOR`] covers
/// what underflow can lose: 2^350. Overflow needs no limit: it makes the bound infinite or not a number, and the comparison
/// with it fails. Determinants of two rows have no third factor, and their filter holds for every finite coordinate.
pub(crate) const FILTER_RANGE: f64 = f64::from_bits((1023 + 350) << 52);

/// The determinant of `a-d, b-d, c-d` in `f64` and a bound: where its absolute value is larger than the bound its sign is
/// right. Never wrong for finite coordinates within [`FILTER_RANGE`].
#[inline(always)]
pub(crate) fn orient3d_filter(a: &[f64; 3], b: &[f64; 3], c: &[f64; 3], d: &[f64; 3]) -> (f64, f64) {
    let (adx, ady, adz) = (a[0] - d[0], a[1] - d[1], a[2] - d[2]);
    let (bdx, bdy, bdz) = (b[0] - d[0], b[1] - d[1], b[2] - d[2]);
    let (cdx, cdy, cdz) = (c[0] - d[0], c[1] - d[1], c[2] - d[2]);
    let (bdxcdy, cdxbdy) = (bdx * cdy, cdx * bdy);
    let (cdxady, adxcdy) = (cdx * ady, adx * cdy);
    let (adxbdy, bdxady) = (adx * bdy, bdx * ady);
    let determinant = adz * (bdxcdy - cdxbdy) + bdz * (cdxady - adxcdy) + cdz * (adxbdy - bdxady);
    let permanent = (bdxcdy.abs() + cdxbdy.abs()) * adz.abs()
        + (cdxady.abs() + adxcdy.abs()) * bdz.abs()
        + (adxbdy.abs() + bdxady.abs()) * cdz.abs();
    (determinant, ORIENT3D_BOUND * permanent + UNDERFLOW_FLOOR)
}

/// [`orient3d_filter`] of many points against one plane: what depends on the plane alone is computed once.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PlaneFilter {
    origin: [f64; 3],
    normal: [f64; 3],
    /// The sums of the absolute values of the products in the normal.
    permanent: [f64; 3],
}

impl PlaneFilter {
    /// The plane through three points.
    #[inline(always)]
    pub(crate) fn new(a: &[f64; 3], b: &[f64; 3], c: &[f64; 3]) -> Self {
        let (ux, uy, uz) = (b[0] - a[0], b[1] - a[1], b[2] - a[2]);
        let (vx, vy, vz) = (c[0] - a[0], c[1] - a[1], c[2] - a[2]);
        let (uyvz, uzvy) = (uy * vz, uz * vy);
        let (uzvx, uxvz) = (uz * vx, ux * vz);
        let (uxvy, uyvx) = (ux * vy, uy * vx);
        Self {
            origin: *a,
            normal: [uzvy - uyvz, uxvz - uzvx, uyvx - uxvy],
            permanent: [uyvz.abs() + uzvy.abs(), uzvx.abs() + uxvz.abs(), uxvy.abs() + uyvx.abs()],
        }
    }

    /// `orient3d` of the plane's points and `d` in `f64`, and a bound as that of [`orient3d_filter`]: the same determinant,
    /// relative to another of the points and transposed.
    #[inline(always)]
    pub(crate) fn determinant(&self, d: &[f64; 3]) -> (f64, f64) {
        let (x, y, z) = (d[0] - self.origin[0], d[1] - self.origin[1], d[2] - self.origin[2]);
        let determinant = x * self.normal[0] + y * self.normal[1] + z * self.normal[2];
        let permanent =
            x.abs() * self.permanent[0] + y.abs() * self.permanent[1] + z.abs() * self.permanent[2];
        (determinant, ORIENT3D_BOUND * permanent + UNDERFLOW_FLOOR)
    }
}

/// As [`orient3d_filter`], for `orient2d`; never wrong for any finite coordinates.
#[inline(always)]
pub(super) fn orient2d_filter(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> (f64, f64) {
    let left = (a[0] - c[0]) * (b[1] - c[1]);
    let right = (a[1] - c[1]) * (b[0] - c[0]);
    (left - right, ORIENT2D_BOUND * (left.abs() + right.abs()) + UNDERFLOW_FLOOR)
}
