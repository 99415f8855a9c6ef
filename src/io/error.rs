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
    /// A part of a file was asked for by a name that no part has, or only parts without triangles.
    #[error("{}", no_such_part(*format, name, *empty, near))]
    NoSuchPart {
        /// The format of the file.
        format: Format,
        /// The name or pattern asked for.
        name: String,
        /// Whether there are such parts, but without triangles.
        empty: bool,
        /// The names in the file that are most like it; none if the file has no names.
        near: Vec<String>,
    },
}

fn no_such_part(format: Format, name: &str, empty: bool, near: &[String]) -> String {
    if empty {
        return format!("what is named {name:?} has no triangles");
    }
    match near {
        [] => format!("no part is named {name:?}: the {format} file has no names of parts"),
        [only] => format!("no part is named {name:?}; the nearest is {only:?}"),
        [first @ .., last] => {
            let first: Vec<String> = first.iter().map(|name| format!("{name:?}")).collect();
            format!("no part is named {name:?}; nearest are {} and {last:?}", first.join(", "))
        }
    }
}

/// The extensions of all formats.
fn known_formats() -> String {
    Format::ALL.map(Format::extension).join(", ")
}
