//! Jobs: lines of a file, and the command lines that they mean.

use std::collections::HashSet;
use std::ffi::OsString;
use std::fs::File;
use std::hash::{DefaultHasher, Hash as _, Hasher as _};
use std::io::{BufRead as _, BufReader};
use std::path::{Path, PathBuf};
use std::time::Duration;

use serde_json::{Map, Value};
use trisect::{Error, FileAction};

use crate::cli::fault::Fault;

/// The keys of a job.
const KEYS: [&str; 5] = ["id", "verb", "inputs", "output", "options"];

/// Verbs of jobs: those that make one output of inputs, and `check`, which makes none.
const VERBS: [&str; 12] = [
    "union",
    "difference",
    "intersection",
    "xor",
    "combine",
    "resolve",
    "cut",
    "section",
    "split",
    "trim",
    "convert",
    "check",
];

/// What is known of a job by its name: a number.
pub(super) fn number_of(id: &str) -> u64 {
    let mut hasher = DefaultHasher::new();
    id.hash(&mut hasher);
    hasher.finish()
}

/// Limits of every job that has none of its own.
#[derive(Clone, Copy, Debug)]
pub(super) struct Limits {
    pub(super) timeout: Option<Duration>,
    pub(super) memory: Option<u64>,
}

/// A job: its name, and what it says or what is wrong with it.
#[derive(Debug)]
pub(super) struct Job {
    pub(super) id: String,
    said: Result<Map<String, Value>, String>,
}

/// The jobs of a file, one after the other, without those that are known.
#[derive(Debug)]
pub(super) struct Jobs {
    reader: BufReader<File>,
    path: PathBuf,
    known: HashSet<u64>,
    /// Jobs read so far.
    read: u64,
    pub(super) skipped: u64,
}

impl Jobs {
    /// Opens a file.
    pub(super) fn open(path: &Path, known: HashSet<u64>) -> Result<Self, Fault> {
        let fail = |source| Error::File { action: FileAction::Read, path: path.to_path_buf(), source };
        let reader = BufReader::new(File::open(path).map_err(fail)?);
        Ok(Self { reader, path: path.to_path_buf(), known, read: 0, skipped: 0 })
    }

    /// The next job that is not known; `None` at the end of the file.
    pub(super) fn next(&mut self) -> Result<Option<Job>, Fault> {
        let mut line = Vec::new();
        loop {
            line.clear();
            let read = self.reader.read_until(b'\n', &mut line).map_err(|source| Error::File {
                action: FileAction::Read,
                path: self.path.clone(),
                source,
            })?;
            if read == 0 {
                return Ok(None);
            }
            if line.trim_ascii().is_empty() {
                continue;
            }
            self.read += 1;
            let job = Job::read(&line, self.read);
            if self.known.contains(&number_of(&job.id)) {
                self.skipped += 1;
                continue;
            }
            return Ok(Some(job));
        }
    }
}

impl Job {
    /// The job of a line, the one with this number. Without an id it is called by the number.
    fn read(line: &[u8], number: u64) -> Self {
        let said = match serde_json::from_slice(line) {
            Ok(Value::Object(object)) => Ok(object),
            Ok(_) => Err(format!("line {number} is no JSON object")),
            Err(error) => Err(format!("line {number} is no JSON: {error}")),
        };
        let id = match said.as_ref().ok().and_then(|object| object.get("id")) {
            Some(Value::String(id)) => id.clone(),
            Some(Value::Null) | None => number.to_string(),
            Some(other) => other.to_string(),
        };
        Self { id, said }
    }

    /// The command line of the job, without the program.
    pub(super) fn arguments(&self, limits: &Limits) -> Result<Vec<OsString>, String> {
        let job = self.said.as_ref().map_err(Clone::clone)?;
        if let Some(key) = job.keys().find(|key| !KEYS.contains(&key.as_str())) {
            return Err(format!("unknown key '{key}' in the job: known are {}", KEYS.join(", ")));
        }
        let verb = job.get("verb").and_then(Value::as_str).unwrap_or_default();
        if !VERBS.contains(&verb) {
            return Err(format!("unknown verb '{verb}' in the job: known are {}", VERBS.join(", ")));
        }
        let mut line: Vec<OsString> = vec![verb.into(), "--json".into(), "--quiet".into()];
        let options = object(job.get("options"), "options")?;
        // What is said of all inputs stands before the first.
        let given = |key: &str| options.contains_key(key);
        if !given("threads") {
            line.push("--threads=1".into());
        }
        if let (Some(timeout), false) = (limits.timeout, given("timeout")) {
            line.push(format!("--timeout={}", timeout.as_secs_f64()).into());
        }
        if let (Some(memory), false) = (limits.memory, given("memory")) {
            line.push(format!("--memory={memory}").into());
        }
        for (key, value) in &options {
            option(&mut line, key, value)?;
        }
        let inputs = job.get("inputs").and_then(Value::as_array).filter(|inputs| !inputs.is_empty());
        for input in inputs.ok_or("a job has a list of inputs")? {
            let (file, own) = match input {
                Value::String(file) => (file.as_str(), Map::new()),
                Value::Object(object) => {
                    let file = object.get("file").and_then(Value::as_str);
                    (file.ok_or("an input has a file")?, object.clone())
                }
                _ => return Err("an input is a path, or an object with a file".into()),
            };
            line.push(path(file).into());
            for (key, value) in own.iter().filter(|(key, _)| *key != "file") {
                option(&mut line, key, value)?;
            }
        }
        if let Some(output) = self.output()? {
            line.extend(["-o".into(), path(output).into()]);
        }
        Ok(line)
    }

    /// The file that the job makes.
    pub(super) fn output(&self) -> Result<Option<&str>, String> {
        match self.said.as_ref().ok().and_then(|job| job.get("output")) {
            None | Some(Value::Null) => Ok(None),
            Some(Value::String(output)) => Ok(Some(output)),
            Some(_) => Err("the output of a job is a path".into()),
        }
    }
}

fn object(value: Option<&Value>, what: &str) -> Result<Map<String, Value>, String> {
    match value {
        None | Some(Value::Null) => Ok(Map::new()),
        Some(Value::Object(object)) => Ok(object.clone()),
        Some(_) => Err(format!("the {what} of a job are an object")),
    }
}

/// A path as it stands on a command line: never an option, never standard input.
fn path(path: &str) -> String {
    if path.starts_with('-') { format!("./{path}") } else { path.into() }
}

/// An option as it stands on a command line.
fn option(line: &mut Vec<OsString>, key: &str, value: &Value) -> Result<(), String> {
    let is_name = !key.is_empty() && key.chars().all(|c| c.is_ascii_lowercase() || c == '-');
    if !is_name || key.starts_with('-') || ["json", "report", "output"].contains(&key) {
        return Err(format!("'{key}' is no option of a job"));
    }
    let wrong = || format!("the option '{key}' is a text, a number, true, false, or a list of them");
    match value {
        Value::Null | Value::Bool(false) => {}
        Value::Bool(true) => line.push(format!("--{key}").into()),
        Value::String(text) => line.push(format!("--{key}={text}").into()),
        Value::Number(number) => line.push(format!("--{key}={number}").into()),
        Value::Array(list) if list.iter().all(Value::is_number) => {
            let numbers: Vec<String> = list.iter().map(ToString::to_string).collect();
            line.push(format!("--{key}={}", numbers.join(",")).into());
        }
        Value::Array(list) => {
            for text in list {
                line.push(format!("--{key}={}", text.as_str().ok_or_else(wrong)?).into());
            }
        }
        Value::Object(_) => return Err(wrong()),
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    const NONE: Limits = Limits { timeout: None, memory: None };

    fn line(text: &str, limits: &Limits) -> Result<String, String> {
        let words = Job::read(text.as_bytes(), 7).arguments(limits)?;
        Ok(words.iter().map(|word| word.to_string_lossy().into_owned()).collect::<Vec<_>>().join(" "))
    }

    #[test]
    fn a_job_is_a_command_line() {
        let text = r#"{"id": "a", "verb": "difference", "inputs": ["-x.stl", {"file": "b.stl", "translate": [1, 0, -0.5],
            "weld": "auto"}], "output": "c.ply", "options": {"assume-clean": true, "embed": false, "timeout": 5,
            "plane": ["z=1", "x=2"]}}"#;
        let limits = Limits { timeout: Some(Duration::from_secs(9)), memory: Some(1024) };
        let words = line(text, &limits).unwrap();
        assert!(words.starts_with("difference --json --quiet --threads=1 --memory=1024 "), "{words}");
        for part in ["--assume-clean", "--timeout=5", "--plane=z=1 --plane=x=2"] {
            assert!(words.contains(part), "{words}");
        }
        assert!(!words.contains("--embed") && !words.contains("--timeout=9"), "{words}");
        assert!(words.ends_with("./-x.stl b.stl --translate=1,0,-0.5 --weld=auto -o c.ply"), "{words}");
    }

    /// An object has no order: transforms of an input are done in that of their names.
    #[test]
    fn transforms_are_in_the_order_of_their_names() {
        let text = r#"{"verb": "convert", "inputs": [{"translate": [1, 0, 0], "file": "a.stl", "scale": 2, "rotate": 90}]}"#;
        let words = line(text, &NONE).unwrap();
        assert!(words.ends_with(" a.stl --rotate=90 --scale=2 --translate=1,0,0"), "{words}");
    }

    #[test]
    fn what_is_no_job_is_told() {
        for (text, words) in [
            ("{", "line 7 is no JSON"),
            ("[]", "line 7 is no JSON object"),
            (r#"{"verb": "merge", "inputs": ["a"]}"#, "unknown verb 'merge'"),
            (r#"{"verb": "union"}"#, "list of inputs"),
            (r#"{"verb": "union", "inputs": []}"#, "list of inputs"),
            (r#"{"verb": "union", "inputs": [7]}"#, "an input is a path"),
            (r#"{"verb": "union", "inputs": ["a"], "outputs": "b"}"#, "unknown key 'outputs'"),
            (r#"{"verb": "union", "inputs": ["a"], "options": {"report": "x"}}"#, "'report' is no option"),
            (r#"{"verb": "union", "inputs": ["a"], "options": {"-o": "x"}}"#, "'-o' is no option"),
            (r#"{"verb": "union", "inputs": ["a"], "options": {"snap": {}}}"#, "the option 'snap'"),
            (r#"{"verb": "union", "inputs": ["a"], "output": 7}"#, "the output of a job"),
        ] {
            let told = line(text, &NONE).unwrap_err();
            assert!(told.contains(words), "{text}: {told}");
        }
    }

    #[test]
    fn jobs_are_called_by_id_or_number() {
        for (text, id) in [(r#"{"id": "x"}"#, "x"), (r#"{"id": 3}"#, "3"), ("{}", "7"), ("nonsense", "7")] {
            assert_eq!(Job::read(text.as_bytes(), 7).id, id);
        }
        assert_ne!(number_of("a"), number_of("b"));
    }
}
