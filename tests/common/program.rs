//! Runs the program in a folder of its own.
#![allow(dead_code, reason = "every test file uses a part of it")]

use std::ffi::OsStr;
use std::fs;
use std::io::{BufRead as _, BufReader, Read as _, Write as _};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::sync::atomic::{AtomicU32, Ordering};

use serde_json::Value;

/// The program.
pub(crate) fn program() -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_trisect"));
    command.env_remove("RUST_BACKTRACE").env_remove("NO_COLOR");
    command
}

/// A folder that is removed at the end of the test.
pub(crate) struct Folder {
    path: PathBuf,
}

/// What a run of the program gave.
#[derive(Debug)]
pub(crate) struct Ran {
    pub(crate) code: i32,
    pub(crate) out: String,
    pub(crate) err: String,
    pub(crate) bytes: Vec<u8>,
}

impl Folder {
    pub(crate) fn new() -> Self {
        static COUNT: AtomicU32 = AtomicU32::new(0);
        let name = format!("trisect-test-{}-{}", std::process::id(), COUNT.fetch_add(1, Ordering::Relaxed));
        let path = std::env::temp_dir().join(name);
        fs::create_dir(&path).expect("a fresh folder");
        Self { path }
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.path.join(name)
    }

    pub(crate) fn write(&self, name: &str, content: impl AsRef<[u8]>) {
        fs::write(self.path(name), content).expect("the file can be written");
    }

    pub(crate) fn read(&self, name: &str) -> String {
        fs::read_to_string(self.path(name)).expect("the file can be read")
    }

    pub(crate) fn exists(&self, name: &str) -> bool {
        self.path(name).exists()
    }

    /// The names of everything in the folder, hidden files included.
    pub(crate) fn names(&self) -> Vec<String> {
        let entries = fs::read_dir(&self.path).expect("the folder can be read");
        let mut names: Vec<String> = entries
            .map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned())
            .collect();
        names.sort();
        names
    }

    /// A command in this folder, its arguments separated by blanks.
    pub(crate) fn command(&self, line: &str) -> Command {
        let mut command = program();
        command.current_dir(&self.path).args(line.split_whitespace()).stdin(Stdio::null());
        command
    }

    pub(crate) fn run(&self, line: &str) -> Ran {
        ran(self.command(line).output().expect("the program starts"))
    }

    pub(crate) fn run_args<S: AsRef<OsStr>>(&self, arguments: &[S]) -> Ran {
        let mut command = self.command("");
        ran(command.args(arguments).output().expect("the program starts"))
    }

    /// Runs with standard input.
    pub(crate) fn run_with(&self, line: &str, input: &[u8]) -> Ran {
        let mut command = self.command(line);
        command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut child = command.spawn().expect("the program starts");
        let mut pipe = child.stdin.take().expect("a pipe");
        let input = input.to_vec();
        // A program that ends early closes the pipe.
        let writer = std::thread::spawn(move || drop(pipe.write_all(&input)));
        let output = child.wait_with_output().expect("the program ends");
        writer.join().expect("the writer ends");
        ran(output)
    }

    /// Starts the program with all three streams piped.
    pub(crate) fn start(&self, line: &str) -> Child {
        let mut command = self.command(line);
        command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
        command.spawn().expect("the program starts")
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.path);
    }
}

impl Ran {
    /// The JSON object on standard output.
    pub(crate) fn json(&self) -> Value {
        serde_json::from_str(&self.out).unwrap_or_else(|error| panic!("{error}: {self:?}"))
    }

    /// Asserts the exit code, and shows everything if it is another one.
    #[track_caller]
    pub(crate) fn exits(self, code: i32) -> Self {
        assert_eq!(self.code, code, "{self:?}");
        self
    }

    /// Asserts that standard output contains `text`.
    #[track_caller]
    pub(crate) fn prints(self, text: &str) -> Self {
        assert!(self.out.contains(text), "'{text}' is missing: {self:?}");
        self
    }

    /// Asserts that standard error contains `text`.
    #[track_caller]
    pub(crate) fn says(self, text: &str) -> Self {
        assert!(self.err.contains(text), "'{text}' is missing: {self:?}");
        self
    }
}

pub(crate) fn ran(output: Output) -> Ran {
    Ran {
        code: output.status.code().unwrap_or(-1),
        out: String::from_utf8_lossy(&output.stdout).into_owned(),
        err: String::from_utf8_lossy(&output.stderr).into_owned(),
        bytes: output.stdout,
    }
}

/// Sends a signal such as `INT` to a running program.
fn signal(child: &Child, name: &str) {
    // The shell's own: not every system has the program.
    let status = Command::new("sh").args(["-c", &format!("kill -{name} {}", child.id())]).status();
    assert!(status.expect("a shell").success());
}

/// Waits for a line of the running program that `is_due` accepts, sends a signal, and returns the exit code and what it says after
/// that line. Panics if it ends without such a line.
pub(crate) fn interrupted(
    mut child: Child,
    is_due: impl Fn(&str) -> bool,
    name: &str,
) -> (Option<i32>, String) {
    let mut lines = BufReader::new(child.stderr.take().expect("a pipe"));
    let mut line = String::new();
    while !is_due(&line) {
        line.clear();
        assert_ne!(lines.read_line(&mut line).expect("text"), 0, "it ended without the line");
    }
    signal(&child, name);
    let code = child.wait().expect("the program ends").code();
    let mut rest = String::new();
    lines.read_to_string(&mut rest).expect("text");
    (code, rest)
}

/// A box between two corners as OBJ.
pub(crate) fn cube(low: [f64; 3], high: [f64; 3]) -> String {
    let mut text = String::new();
    for k in 0..8 {
        let at = |axis: usize| if k >> axis & 1 == 0 { low[axis] } else { high[axis] };
        text.push_str(&format!("v {} {} {}\n", at(0), at(1), at(2)));
    }
    for [a, b, c, d] in [[1, 3, 4, 2], [5, 6, 8, 7], [1, 2, 6, 5], [3, 7, 8, 4], [1, 5, 7, 3], [2, 4, 8, 6]] {
        text.push_str(&format!("f {a} {b} {c}\nf {a} {c} {d}\n"));
    }
    text
}

/// The unit cube.
pub(crate) fn unit_cube() -> String {
    cube([0.0; 3], [1.0; 3])
}

/// A folder with a few inputs.
pub(crate) fn workshop() -> Folder {
    let folder = Folder::new();
    folder.write("a.obj", unit_cube());
    folder.write("b.obj", cube([0.5; 3], [1.5; 3]));
    folder.write("open.obj", opened(&unit_cube()));
    folder.write("inside.obj", inside_out(&unit_cube()));
    folder.write("damaged.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 x\nf 1 2 3\n");
    folder.write("warned.obj", format!("mtllib missing.mtl\n{}", unit_cube()));
    folder
}

/// The same surface with its faces inwards.
pub(crate) fn inside_out(obj: &str) -> String {
    obj.lines()
        .map(|line| match line.split(' ').collect::<Vec<_>>().as_slice() {
            ["f", a, b, c] => format!("f {a} {c} {b}\n"),
            _ => format!("{line}\n"),
        })
        .collect()
}

/// The same surface without its last triangle.
pub(crate) fn opened(obj: &str) -> String {
    let lines: Vec<&str> = obj.lines().collect();
    lines[..lines.len() - 1].join("\n") + "\n"
}

/// A sphere of `2 * bands * bands` triangles, roughly, as OFF.
pub(crate) fn sphere(bands: usize, radius: f64, centre: [f64; 3]) -> String {
    let around = 2 * bands;
    let mut points = vec![[centre[0], centre[1], centre[2] + radius]];
    for band in 1..bands {
        let (height, width) = {
            let angle = std::f64::consts::PI * band as f64 / bands as f64;
            (angle.cos(), angle.sin())
        };
        for k in 0..around {
            let angle = std::f64::consts::TAU * k as f64 / around as f64;
            points.push([
                centre[0] + radius * width * angle.cos(),
                centre[1] + radius * width * angle.sin(),
                centre[2] + radius * height,
            ]);
        }
    }
    points.push([centre[0], centre[1], centre[2] - radius]);
    let ring = |band: usize, k: usize| 1 + (band - 1) * around + k % around;
    let mut faces = Vec::new();
    for k in 0..around {
        faces.push([0, ring(1, k), ring(1, k + 1)]);
        faces.push([points.len() - 1, ring(bands - 1, k + 1), ring(bands - 1, k)]);
        for band in 1..bands - 1 {
            faces.push([ring(band, k), ring(band + 1, k), ring(band + 1, k + 1)]);
            faces.push([ring(band, k), ring(band + 1, k + 1), ring(band, k + 1)]);
        }
    }
    let mut text = format!("OFF\n{} {} 0\n", points.len(), faces.len());
    points.iter().for_each(|[x, y, z]| text.push_str(&format!("{x} {y} {z}\n")));
    faces.iter().for_each(|[a, b, c]| text.push_str(&format!("3 {a} {b} {c}\n")));
    text
}

/// The vertices of an OBJ text.
pub(crate) fn vertices(obj: &str) -> Vec<[f64; 3]> {
    obj.lines()
        .filter_map(|line| line.strip_prefix("v "))
        .map(|line| {
            let numbers: Vec<f64> =
                line.split_whitespace().map(|word| word.parse().expect("a number")).collect();
            [numbers[0], numbers[1], numbers[2]]
        })
        .collect()
}

/// The signed volume inside an OBJ text of triangles.
pub(crate) fn volume(obj: &str) -> f64 {
    let points = vertices(obj);
    let corner = |word: &str| {
        let index = word.split('/').next().expect("an index");
        points[index.parse::<usize>().expect("a positive index") - 1]
    };
    let faces = obj.lines().filter_map(|line| line.strip_prefix("f "));
    let six = faces.map(|line| {
        let [a, b, c]: [[f64; 3]; 3] =
            line.split_whitespace().map(corner).collect::<Vec<_>>().try_into().expect("a triangle");
        a[0] * (b[1] * c[2] - b[2] * c[1])
            + a[1] * (b[2] * c[0] - b[0] * c[2])
            + a[2] * (b[0] * c[1] - b[1] * c[0])
    });
    six.sum::<f64>() / 6.0
}

/// The bytes of a file.
pub(crate) fn bytes(path: &Path) -> Vec<u8> {
    fs::read(path).expect("the file can be read")
}
