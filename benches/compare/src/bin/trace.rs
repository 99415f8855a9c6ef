//! What one case costs inside: time, allocations, page faults and memory of the gate and of the operation, one thread.
//!
//!     python -c "import cases; cases.exported(cases.stored('a_80k', '/tmp'), '/tmp/a_80k.case')"
//!     trace /tmp/a_80k.case union [RUNS]
//!
//! One JSON object a line. Made for profilers too: `perf record -g trace FILE OPERATION 50`.

use std::alloc::{GlobalAlloc, Layout, System};
use std::error::Error;
use std::fs;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering::Relaxed};
use std::time::Instant;

use serde_json::json;
use trisect::{BooleanOptions, Mesh, Operation, Solid};

/// The system's allocator, counting while [`COUNTING`].
struct Counting;

static COUNTING: AtomicBool = AtomicBool::new(false);
static CALLS: AtomicU64 = AtomicU64::new(0);
static BYTES: AtomicU64 = AtomicU64::new(0);
static LIVE: AtomicU64 = AtomicU64::new(0);
static PEAK: AtomicU64 = AtomicU64::new(0);

fn count(grown: usize, shrunk: usize) {
    if COUNTING.load(Relaxed) {
        CALLS.fetch_add(u64::from(grown > 0), Relaxed);
        BYTES.fetch_add(grown as u64, Relaxed);
        // Modulo 2^64: what was allocated before the count may be freed within it.
        let live = LIVE.fetch_add((grown as u64).wrapping_sub(shrunk as u64), Relaxed);
        let live = live.wrapping_add((grown as u64).wrapping_sub(shrunk as u64));
        if (live as i64) > PEAK.load(Relaxed) as i64 {
            PEAK.store(live, Relaxed);
        }
    }
}

// SAFETY: hands every request on to the system's allocator.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        count(layout.size(), 0);
        unsafe { System.alloc(layout) }
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        count(layout.size(), 0);
        unsafe { System.alloc_zeroed(layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        count(size, layout.size());
        unsafe { System.realloc(pointer, layout, size) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        count(0, layout.size());
        unsafe { System.dealloc(pointer, layout) };
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let path = arguments.next().ok_or("trace FILE OPERATION [RUNS]")?;
    let operation = match arguments.next().as_deref() {
        Some("union") => Operation::Union,
        Some("intersection") => Operation::Intersection,
        Some("difference") => Operation::Difference,
        other => return Err(format!("union, intersection or difference, not {other:?}").into()),
    };
    let runs: usize = arguments.next().map_or(Ok(3), |text| text.parse())?;
    let meshes = read(&fs::read(&path)?).ok_or("not a case file")?;

    let mut solids = Vec::new();
    traced("gate", || {
        solids = meshes.iter().map(|mesh| Solid::try_from(mesh.clone())).collect::<Result<_, _>>()?;
        Ok(json!({ "triangles": meshes.iter().map(|mesh| mesh.triangles.len()).sum::<usize>() }))
    })?;
    let options = BooleanOptions::new().threads(1);
    let mut last = None;
    for _ in 0..runs {
        drop(last.take());
        traced("operation", || {
            let made = options.run(operation, &solids)?;
            let mesh = made.solid().mesh();
            let sizes = json!({ "vertices": mesh.positions.len(), "triangles": mesh.triangles.len() });
            last = Some(made);
            Ok(sizes)
        })?;
    }
    if let Some(made) = last {
        let mut certificate = made.certificate().to_json();
        certificate.as_object_mut().map(|fields| fields.remove("operands"));
        println!("{certificate}");
    }
    Ok(())
}

/// Runs a stage and prints what it took, with what it has to tell itself.
fn traced(
    stage: &str,
    run: impl FnOnce() -> Result<serde_json::Value, Box<dyn Error>>,
) -> Result<(), Box<dyn Error>> {
    for counter in [&CALLS, &BYTES, &LIVE, &PEAK] {
        counter.store(0, Relaxed);
    }
    let (faults, processor, start) = (page_faults(), processor_time(), Instant::now());
    COUNTING.store(true, Relaxed);
    let told = run();
    COUNTING.store(false, Relaxed);
    println!(
        "{}",
        json!({
            "stage": stage,
            "seconds": start.elapsed().as_secs_f64(),
            "processor": processor_time() - processor,
            "allocations": CALLS.load(Relaxed),
            "allocated": BYTES.load(Relaxed),
            "peak": PEAK.load(Relaxed),
            "page_faults": page_faults() - faults,
            "result": told?,
        })
    );
    Ok(())
}

fn page_faults() -> u64 {
    // The name in parentheses may hold spaces; the tenth field of all is the eighth after it.
    let stat = fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let after = stat.rsplit(')').next().unwrap_or("");
    after.split_whitespace().nth(7).and_then(|field| field.parse().ok()).unwrap_or(0)
}

/// Seconds all threads of this process have run.
fn processor_time() -> f64 {
    let mut time = libc::timespec { tv_sec: 0, tv_nsec: 0 };
    // SAFETY: the clock exists and the pointer is to a live value.
    unsafe { libc::clock_gettime(libc::CLOCK_PROCESS_CPUTIME_ID, &mut time) };
    time.tv_sec as f64 + 1e-9 * time.tv_nsec as f64
}

/// Meshes in the layout of `cases.exported`.
fn read(bytes: &[u8]) -> Option<Vec<Mesh>> {
    let mut rest = bytes;
    let mut take = |count: usize| {
        let (taken, left) = rest.split_at_checked(count)?;
        rest = left;
        Some(taken)
    };
    let number = |bytes: &[u8]| bytes.try_into().ok().map(u64::from_le_bytes);
    let count = number(take(8)?)?;
    let mut sizes = Vec::new();
    for _ in 0..count {
        sizes.push((number(take(8)?)? as usize, number(take(8)?)? as usize));
    }
    let mut meshes = Vec::new();
    for (vertices, triangles) in sizes {
        let positions = take(vertices.checked_mul(24)?)?
            .chunks_exact(24)
            .map(|point| [0, 8, 16].map(|k| f64::from_le_bytes(std::array::from_fn(|i| point[k + i]))))
            .collect();
        let triangles = take(triangles.checked_mul(12)?)?
            .chunks_exact(12)
            .map(|corners| [0, 4, 8].map(|k| u32::from_le_bytes(std::array::from_fn(|i| corners[k + i]))))
            .collect();
        meshes.push(Mesh::new(positions, triangles));
    }
    Some(meshes)
}
