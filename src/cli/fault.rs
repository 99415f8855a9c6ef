//! Failures of a run: exit codes, the line printed, the JSON object.

use std::io;

use serde_json::{Map, Value, json};
use trisect::io::FormatError;
use trisect::{Error, Failure, FileAction, MeshError};

use super::json::json_of;
use super::remedy::Remedy;

/// The version of the JSON objects' layout. It rises when a key changes its meaning or goes; new keys may come
/// without.
pub(crate) const SCHEMA: u32 = 1;

/// How a run ended. The numbers are the exit codes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u8)]
pub(crate) enum Exit {
    /// Done.
    Fine = 0,
    /// The command line makes no sense.
    Usage = 1,
    /// An input cannot be read, or an output cannot be written.
    Unreadable = 2,
    /// An input was read but cannot be used as asked.
    Unusable = 3,
    /// A limit was hit, or the run was cancelled.
    Limit = 4,
    /// Done, with warnings, and those were to count.
    Warnings = 5,
    /// A fault of the program.
    Internal = 70,
}

impl Exit {
    /// The exit code.
    pub(crate) fn code(self) -> u8 {
        self as u8
    }

    /// The name in JSON.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Fine => "fine",
            Self::Usage => "usage",
            Self::Unreadable => "unreadable",
            Self::Unusable => "unusable",
            Self::Limit => "limit",
            Self::Warnings => "warnings",
            Self::Internal => "internal",
        }
    }
}

/// A failure that ends the run.
#[derive(Debug)]
pub(crate) struct Fault {
    pub(crate) exit: Exit,
    pub(crate) message: String,
    /// What the library said, if it was the library.
    error: Option<Box<Error>>,
    /// Options that have been tried and would do.
    remedy: Option<String>,
}

impl Fault {
    /// A command line that makes no sense.
    pub(crate) fn usage(message: impl Into<String>) -> Self {
        Self { exit: Exit::Usage, message: message.into(), error: None, remedy: None }
    }

    /// An input that cannot be used, and the options that would make it usable.
    pub(crate) fn of_unusable(error: Error, remedy: Option<Remedy>) -> Self {
        let way_out = way_out(&error, remedy.as_ref());
        let mut fault = Self::from(error);
        fault.message.extend(way_out.map(|text| format!("; {text}")));
        fault.remedy = remedy.map(|remedy| remedy.options);
        fault
    }

    /// Inputs that cannot be used as asked.
    pub(crate) fn unusable(message: impl Into<String>) -> Self {
        Self { exit: Exit::Unusable, message: message.into(), error: None, remedy: None }
    }

    /// A fault of the program itself.
    pub(crate) fn internal(message: impl Into<String>) -> Self {
        Self { exit: Exit::Internal, message: message.into(), error: None, remedy: None }
    }

    /// An output that cannot be written.
    pub(crate) fn output(path: impl Into<std::path::PathBuf>, source: io::Error) -> Self {
        Error::File { action: FileAction::Write, path: path.into(), source }.into()
    }

    /// This fault, said to have come while `what` was done.
    pub(crate) fn during(mut self, what: &str) -> Self {
        self.message = format!("{what}: {}", self.message);
        self
    }

    /// Whether the reader of our standard output went away, which is no failure.
    pub(crate) fn is_broken_pipe(&self) -> bool {
        matches!(self.error.as_deref(), Some(Error::File { action: FileAction::Write, source, .. })
            if source.kind() == io::ErrorKind::BrokenPipe)
    }

    /// The JSON value of the key `error`.
    pub(crate) fn to_json(&self) -> Value {
        let mut object = Map::new();
        object.insert("kind".into(), self.exit.name().into());
        object.insert("message".into(), self.message.as_str().into());
        object.extend(self.remedy.iter().map(|options| ("remedy".to_owned(), options.as_str().into())));
        let mut error = self.error.as_deref();
        while let Some(current) = error {
            error = None;
            match current {
                Error::Operand { operand, name, source } => {
                    object.insert("operand".into(), json!(operand + 1));
                    object.insert("file".into(), name.as_str().into());
                    error = Some(source);
                }
                Error::InNode { node, source } => {
                    object.insert("node".into(), node.as_str().into());
                    error = Some(source);
                }
                Error::Format(FormatError::Malformed { format, place, .. }) => {
                    object.insert("format".into(), format.to_string().to_lowercase().into());
                    object.insert("place".into(), place.as_str().into());
                }
                Error::Mesh(MeshError::NotClosed(diagnosis)) => {
                    object.insert("diagnosis".into(), json_of(diagnosis));
                }
                Error::Mesh(MeshError::InsideOutShells(shells)) => {
                    object.insert("inside_out_shells".into(), json_of(shells));
                }
                _ => {}
            }
        }
        object.into()
    }

    /// The whole JSON object of a run that ended before it could be described further.
    pub(crate) fn to_object(&self) -> Value {
        json!({ "schema": SCHEMA, "exit_code": self.exit.code(), "error": self.to_json() })
    }
}

impl From<Error> for Fault {
    fn from(error: Error) -> Self {
        Self { exit: exit_of(&error), message: text_of(&error), error: Some(Box::new(error)), remedy: None }
    }
}

/// What is printed of a library error: its text in one line.
pub(crate) fn text_of(error: &Error) -> String {
    match error {
        Error::Operand { operand, name, source } => {
            format!("operand {} ({name}): {}", operand + 1, text_of(source))
        }
        Error::Mesh(MeshError::NotClosed(diagnosis)) => {
            format!("the mesh is not a closed surface: {}", diagnosis.listed(2).join("; "))
        }
        other => one_line(&other.to_string()),
    }
}

/// What can be done about an input that cannot be used: the options that were found, or why there are none. `None` where
/// the error itself says it.
pub(crate) fn way_out(error: &Error, remedy: Option<&Remedy>) -> Option<String> {
    let mut cause = error;
    while let Error::Operand { source, .. } = cause {
        cause = source;
    }
    match (remedy, cause) {
        (Some(remedy), _) => Some(remedy.text()),
        (None, Error::Mesh(MeshError::NotClosed(diagnosis))) => Some(
            if diagnosis.open_edges.is_none() {
                "no option closes it: its faces cannot be turned to agree (a surface with one side, or sheets that meet in \
                 an edge); repair it in a mesh editor"
            } else {
                "no option closes it: its open edges are rims of holes, and filled it encloses nothing (a sheet must be given \
                 a thickness; `trim` takes it as it is)"
            }
            .into(),
        ),
        _ => None,
    }
}

/// The exit code of a library error.
pub(crate) fn exit_of(error: &Error) -> Exit {
    match error.failure() {
        Failure::Usage => Exit::Usage,
        Failure::Unreadable => Exit::Unreadable,
        Failure::Unusable => Exit::Unusable,
        Failure::Limit => Exit::Limit,
        _ => Exit::Internal,
    }
}

/// A message with its line ends replaced, so that an error is one line.
pub(crate) fn one_line(text: &str) -> String {
    text.lines().map(str::trim).filter(|line| !line.is_empty()).collect::<Vec<_>>().join("; ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn faults_tell_the_operand_and_the_place() {
        let inner = Error::from(FormatError::Malformed {
            format: trisect::io::Format::Obj,
            place: "line 12".into(),
            what: "a face has two corners".into(),
        });
        let fault = Fault::from(inner.of_operand(1, "tool.obj"));
        assert_eq!(fault.exit, Exit::Unreadable);
        assert_eq!(fault.message, "operand 2 (tool.obj): damaged OBJ file, line 12: a face has two corners");
        let object = fault.to_object();
        assert_eq!(object["schema"], 1);
        assert_eq!(object["exit_code"], 2);
        assert_eq!(object["error"]["operand"], 2);
        assert_eq!(object["error"]["file"], "tool.obj");
        assert_eq!(object["error"]["place"], "line 12");
        assert_eq!(object["error"]["kind"], "unreadable");
    }

    #[test]
    fn messages_are_one_line() {
        assert_eq!(one_line("first:\n  second\n\n  third\n"), "first:; second; third");
    }

    #[test]
    fn only_a_broken_pipe_is_no_failure() {
        assert!(Fault::output("-", io::ErrorKind::BrokenPipe.into()).is_broken_pipe());
        assert!(!Fault::output("-", io::ErrorKind::PermissionDenied.into()).is_broken_pipe());
        assert!(!Fault::usage("x").is_broken_pipe());
    }
}
