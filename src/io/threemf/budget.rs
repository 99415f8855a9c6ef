//! Memory and text that reading a package may take.

use super::super::ReadOptions;
use super::SMALLEST_LIMIT;
use crate::control::Reservation;
use crate::{Control, Error};

/// What was taken so far, against what the file allows. Packed text may be a thousand times its file, and components may show an
/// object any number of times; this is where that ends.
pub(super) struct Budget {
    control: Control,
    file_bytes: u64,
    limit: u64,
    /// Bytes of text that were unpacked.
    unpacked: u64,
    /// Bytes of text since the last that is done with, and the most that were held so at once.
    text: u64,
    most_text: u64,
    /// Bytes of memory.
    charged: u64,
    reserved: u64,
    reservations: Vec<Reservation>,
    /// Why the text of a part was not given to the end.
    fault: Option<Error>,
}

impl Budget {
    pub(super) fn new(file_bytes: u64, options: &ReadOptions) -> Self {
        let limit = file_bytes.saturating_mul(options.expansion).max(SMALLEST_LIMIT);
        let control = options.control.clone();
        Self {
            control,
            file_bytes,
            limit,
            unpacked: 0,
            text: 0,
            most_text: 0,
            charged: 0,
            reserved: 0,
            reservations: Vec::new(),
            fault: None,
        }
    }

    /// Accounts for text that was unpacked; false, with the fault noted, where that is to end.
    pub(super) fn unpack(&mut self, bytes: u64) -> bool {
        self.unpacked = self.unpacked.saturating_add(bytes);
        self.text = self.text.saturating_add(bytes);
        let more = self.text.saturating_sub(self.most_text);
        self.most_text += more;
        self.fault = if self.unpacked > self.limit {
            Some(self.too_large("the unpacked models are"))
        } else {
            self.charge(more).and_then(|()| Ok(self.control.check()?)).err()
        };
        self.fault.is_none()
    }

    /// Notes that the text so far is done with: an element of a model, or a part as a whole. What comes takes its place.
    pub(super) fn release_text(&mut self) {
        self.text = 0;
    }

    /// Why unpacking ended, if it was not for the package.
    pub(super) fn take_fault(&mut self) -> Option<Error> {
        self.fault.take()
    }

    /// Accounts for memory about to be used.
    pub(super) fn charge(&mut self, bytes: u64) -> Result<(), Error> {
        self.charged = self.charged.saturating_add(bytes);
        if self.charged > self.limit {
            return Err(self.too_large("the models and what the build shows need"));
        }
        // What `read` reserved for usual files is twice the file.
        if self.charged > 2 * self.file_bytes + self.reserved {
            let more = (self.charged - 2 * self.file_bytes - self.reserved).max(1 << 20);
            self.reservations.push(self.control.reserve(more)?);
            self.reserved += more;
            self.control.check()?;
        }
        Ok(())
    }

    /// The error for a package that needs more than it may.
    fn too_large(&self, what: &str) -> Error {
        let (limit, times) = (self.limit, self.limit / self.file_bytes.max(1));
        Error::TooLarge {
            what: format!(
                "{what} more than {limit} bytes, {times} times the file, the most that was allowed"
            ),
        }
    }
}
