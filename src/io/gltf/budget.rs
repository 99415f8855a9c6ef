//! Memory that reading a scene may take.

use super::super::ReadOptions;
use super::SMALLEST_LIMIT;
use super::buffers::Buffers;
use crate::Error;
use crate::control::Reservation;

/// What was taken so far, against what the file allows. Counts in accessors, instances of meshes and pictures may ask for
/// far more than the file has; this is where that ends.
pub(super) struct Budget<'a> {
    buffers: &'a Buffers<'a>,
    options: &'a ReadOptions,
    file_bytes: u64,
    charged: u64,
    reserved: u64,
    reservations: Vec<Reservation>,
}

impl<'a> Budget<'a> {
    pub(super) fn new(buffers: &'a Buffers<'a>, options: &'a ReadOptions, file_bytes: u64) -> Self {
        Self { buffers, options, file_bytes, charged: 0, reserved: 0, reservations: Vec::new() }
    }

    /// Accounts for memory about to be used.
    pub(super) fn charge(&mut self, bytes: u64) -> Result<(), Error> {
        self.charged = self.charged.saturating_add(bytes);
        let whole = self.file_bytes.saturating_add(self.buffers.external_bytes());
        let limit = whole.saturating_mul(self.options.expansion).max(SMALLEST_LIMIT);
        if self.charged > limit {
            return Err(Error::TooLarge {
                what: format!(
                    "the flattened scene needs more than {limit} bytes, {} times its file, the most that was \
                     allowed",
                    limit / whole.max(1)
                ),
            });
        }
        // Instances can make the mesh larger than the file, so this memory is accounted for as it is needed.
        if self.charged > 2 * whole + self.reserved {
            let more = self.charged - 2 * whole - self.reserved;
            self.reservations.push(self.options.control.reserve(more.max(1 << 20))?);
            self.reserved += more.max(1 << 20);
        }
        Ok(self.options.control.check()?)
    }
}
