//! What can be wrong with the format of a file.

use super::Format;

/// A file that cannot be read as a mesh, or a mesh that a format cannot hold.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum FormatError {
    /// The name or the first bytes of a file do not tell its format.
    #[error("cannot tell the format of {name}; known formats: {}", known_formats())]
    Unknown {
        /// The file's name, or "standard input".
        name: String,
    },
    /// A file is damaged: truncated, out of range, not of the format it claims.
    #[error("damaged {format} file, {place}: {what}")]
    Malformed {
        /// The format the file was read as.
        format: Format,
        /// Where: "line 12", "byte 84", "/meshes/0/primitives/1".
        place: String,
        /// What is wrong and, where that helps, how to mend it.
        what: String,
    },
    /// A file is sound but uses something this reader or writer cannot do.
    #[error("unsupported in {format}: {what}")]
    Unsupported {
        /// The format of the file.
        format: Format,
        /// What is not supported, and how to convert the file.
        what: String,
    },
}

/// The extensions of all formats.
fn known_formats() -> String {
    Format::ALL.map(Format::extension).join(", ")
}
