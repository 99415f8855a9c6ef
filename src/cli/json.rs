//! Values of the library as JSON.

use serde::Serialize;
use serde_json::Value;

/// What the library has to say of something, as JSON; numbers that are not finite are null.
pub(crate) fn json_of(value: &impl Serialize) -> Value {
    // Nothing of the library fails to serialize: it has no maps with strange keys.
    serde_json::to_value(value).unwrap_or_default()
}
