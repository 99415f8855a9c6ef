//! The same bits from version to version: hashes of the results of a group of operations, compared with `fixtures/same-bits.txt`.
//!
//! A test opens a [`group`]; from then on every [`run`] on its thread hashes its operands and its result (positions, triangles,
//! origins), asserts that 1 thread and 8 give the same, and the end of the group compares the hashes with the table. A line of the table
//! stands for at most [`CASES_A_LINE`] operations: name of the group, number of the first operation, number of operations, hash of
//! the operands, hash of the results. Where only the second hash differs, the boolean changed; where both do, look at the operands first.
//!
//! The table is rewritten by `TRISECT_RECORD_BITS=1 cargo test --test proof`: only on purpose, with a reason in the changelog.
//! `TRISECT_BITS_CASES=folder` writes the hashes of every single operation of a group into a file of its name, so that
//! the folders of two versions can be compared. Samples other than the plain ones (`TRISECT_PROOF`), and other platforms, are not compared.

use std::cell::RefCell;
use std::fmt::Write as _;
use std::path::PathBuf;
use std::sync::{Mutex, OnceLock, PoisonError};

use trisect::{BooleanOptions, Mesh, Operation, Outcome, Solid};

/// Operations that one line of the table stands for, at most: few enough to find the first that differs.
const CASES_A_LINE: usize = 500;

/// The threads that results are compared on, beside one.
const THREADS: usize = 8;

/// A hash that is the same on every machine: multiplication by the odd number next to 2^64 over the golden ratio, and a shift
/// that brings the upper half down, word by word.
#[derive(Clone, Copy)]
struct Hash(u64);

impl Hash {
    const START: Self = Self(0xcbf2_9ce4_8422_2325);

    fn add(&mut self, word: u64) {
        self.0 = (self.0 ^ word).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        self.0 ^= self.0 >> 32;
    }

    fn add_mesh(&mut self, mesh: &Mesh) {
        self.add(mesh.positions.len() as u64);
        mesh.positions.iter().flatten().for_each(|x| self.add(x.to_bits()));
        self.add(mesh.triangles.len() as u64);
        mesh.triangles.iter().flatten().for_each(|&corner| self.add(u64::from(corner)));
    }

    fn of_outcome(outcome: &Outcome) -> Self {
        let mut hash = Self::START;
        hash.add_mesh(outcome.solid().mesh());
        for origin in outcome.origins() {
            hash.add(u64::from(origin.operand));
            hash.add(u64::from(origin.triangle));
            hash.add(u64::from(origin.reversed));
        }
        hash
    }
}

/// The hashes of a group so far.
struct Cases {
    name: &'static str,
    /// Of each case: its operands, its result.
    hashes: Vec<[Hash; 2]>,
}

thread_local! {
    /// The group that operations of this thread belong to.
    static OPEN: RefCell<Option<Cases>> = const { RefCell::new(None) };
}

/// Compares the group with the table when it is dropped.
#[must_use]
pub(crate) struct Group(());

/// Opens a group: all operations of this thread belong to it until the returned value is dropped.
pub(crate) fn group(name: &'static str) -> Group {
    OPEN.with_borrow_mut(|open| {
        assert!(open.is_none(), "groups do not nest");
        *open = Some(Cases { name, hashes: Vec::new() });
    });
    Group(())
}

/// Runs a boolean with default settings; within a group on 1 thread and on 8.
pub(crate) fn run(operation: Operation, operands: &[&Solid]) -> Outcome {
    run_with(&BooleanOptions::new(), operation, operands)
}

/// Runs a boolean; within a group on 1 thread and on 8.
pub(crate) fn run_with(options: &BooleanOptions, operation: Operation, operands: &[&Solid]) -> Outcome {
    if OPEN.with_borrow(Option::is_none) {
        return options.run(operation, operands.iter().copied()).expect("no limits");
    }
    let one = options.clone().threads(1).run(operation, operands.iter().copied()).expect("no limits");
    let many = eight().install(|| options.run(operation, operands.iter().copied())).expect("no limits");
    let mut of_operands = Hash::START;
    operands.iter().for_each(|solid| of_operands.add_mesh(solid.mesh()));
    note([of_operands, Hash::of_outcome(&one)], &format!("{operation:?}"), &many);
    one
}

/// Notes a mesh that was made without a boolean, of 1 thread and of 8, in the open group.
pub(crate) fn note_mesh(make: impl Fn() -> Mesh + Send + Sync) {
    let hash = |threads: &rayon::ThreadPool| {
        let mut hash = Hash::START;
        hash.add_mesh(&threads.install(&make));
        hash
    };
    let [one, many] = [hash(single()), hash(eight())];
    assert_eq!(one.0, many.0, "1 and {THREADS} threads give different bits");
    push([Hash::START, one]);
}

fn note(hashes: [Hash; 2], context: &str, many: &Outcome) {
    push(hashes);
    assert_eq!(
        hashes[1].0,
        Hash::of_outcome(many).0,
        "{context}: 1 and {THREADS} threads give different bits"
    );
}

fn push(hashes: [Hash; 2]) {
    OPEN.with_borrow_mut(|open| open.as_mut().expect("a group").hashes.push(hashes));
}

fn pool(threads: usize) -> rayon::ThreadPool {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads")
}

fn single() -> &'static rayon::ThreadPool {
    static POOL: OnceLock<rayon::ThreadPool> = OnceLock::new();
    POOL.get_or_init(|| pool(1))
}

fn eight() -> &'static rayon::ThreadPool {
    static POOL: OnceLock<rayon::ThreadPool> = OnceLock::new();
    POOL.get_or_init(|| pool(THREADS))
}

impl Drop for Group {
    fn drop(&mut self) {
        let cases = OPEN.take().expect("the group is open");
        if !std::thread::panicking() {
            cases.finish();
        }
    }
}

impl Cases {
    fn finish(&self) {
        if let Some(folder) = std::env::var_os("TRISECT_BITS_CASES") {
            let path = PathBuf::from(folder).join(self.name.replace(' ', "-"));
            std::fs::write(path, self.lines(1)).expect("a writable folder");
        }
        // Balls and cylinders are made with the sines of the platform's library.
        let comparable = cfg!(all(target_os = "linux", target_env = "gnu"));
        if !comparable || std::env::var_os("TRISECT_PROOF").is_some() {
            return;
        }
        let table = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("fixtures/same-bits.txt");
        let found = self.lines(CASES_A_LINE);
        if std::env::var_os("TRISECT_RECORD_BITS").is_some() {
            self.record(&table, &found);
            return;
        }
        let text = std::fs::read_to_string(&table).expect("the table of hashes");
        let recorded: String =
            text.lines().filter(|line| self.owns(line)).flat_map(|line| [line, "\n"]).collect();
        assert!(
            found == recorded,
            "results differ in bits from those recorded in fixtures/same-bits.txt:\n{found}recorded:\n{recorded}"
        );
    }

    /// One line for so many cases each.
    fn lines(&self, cases_a_line: usize) -> String {
        let mut text = String::new();
        for (index, chunk) in self.hashes.chunks(cases_a_line).enumerate() {
            let mut sums = [Hash::START; 2];
            for hashes in chunk {
                (0..2).for_each(|k| sums[k].add(hashes[k].0));
            }
            let (first, [operands, results]) = (index * cases_a_line, sums.map(|hash| hash.0));
            writeln!(text, "{}: {first} {} {operands:016x} {results:016x}", self.name, chunk.len())
                .expect("memory");
        }
        text
    }

    fn owns(&self, line: &str) -> bool {
        line.split_once(':').is_some_and(|(name, _)| name == self.name)
    }

    /// Replaces the group's lines in the table.
    fn record(&self, table: &std::path::Path, found: &str) {
        static WRITING: Mutex<()> = Mutex::new(());
        let _one_at_a_time = WRITING.lock().unwrap_or_else(PoisonError::into_inner);
        let text = std::fs::read_to_string(table).unwrap_or_default();
        let (head, rest): (Vec<&str>, Vec<&str>) = text.lines().partition(|line| line.starts_with('#'));
        let mut groups: Vec<(&str, &str)> = rest
            .iter()
            .filter_map(|line| line.split_once(':'))
            .filter(|(name, _)| *name != self.name)
            .collect();
        groups.extend(found.lines().filter_map(|line| line.split_once(':')));
        // Stable: the lines of a group stay in their order.
        groups.sort_by_key(|(name, _)| *name);
        let mut text: String = head.iter().flat_map(|line| [line, "\n"]).collect();
        groups.iter().for_each(|(name, line)| writeln!(text, "{name}:{line}").expect("memory"));
        std::fs::write(table, text).expect("a writable table");
    }
}
