//! Random booleans by seed, run by trisect and judged by the oracle of the tests, and handed on for comparison.
//!
//! ```text
//! trisect-proof emit FIRST COUNT [POINTS]    cases and results as binary records on standard output (see record.rs)
//! trisect-proof show SEED...                 what is known of each case, in words
//! trisect-proof save SEED FOLDER             the operands and the result of a case as OBJ files
//! trisect-proof judge                        trisect's and another engine's results at the same points (see arbiter.rs)
//! trisect-proof limits                       how soon a running operation stops, and its account of memory
//! trisect-proof minimise SEED FOLDER NAME    the smallest pair found that fails like the case, as NAME-a.obj and NAME-b.obj
//! ```

mod arbiter;
#[path = "../../../tests/proof/judge/mod.rs"]
#[allow(dead_code, reason = "shared with the tests")]
mod judge;
mod limits;
mod many;
mod record;
mod run;

use std::io::{BufWriter, Write};
use std::process::ExitCode;

use judge::cases::Case;
use judge::many::{MANY_FROM, Many};
use trisect::Mesh;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match command(&words) {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("{message}");
            ExitCode::FAILURE
        }
    }
}

fn command(words: &[&str]) -> Result<(), String> {
    let models = judge::cases::models(concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/solids"));
    match words {
        ["emit", first, count, points @ ..] => {
            let points = points.first().map_or(Ok(48), |word| number(word))?;
            emit(number(first)?, number(count)?, points as usize, &models).map_err(|error| error.to_string())
        }
        ["judge"] => {
            let (input, out) = (std::io::stdin().lock(), std::io::stdout().lock());
            arbiter::serve(&mut { input }, &mut { out }, &models).map_err(|error| error.to_string())
        }
        ["limits"] => {
            limits::measure();
            Ok(())
        }
        ["show", seeds @ ..] => seeds.iter().try_for_each(|word| {
            let seed = number(word)?;
            if seed >= MANY_FROM {
                many::show(seed, &Many::new(seed));
            } else {
                run::show(seed, &Case::new(seed, &models));
            }
            Ok(())
        }),
        ["save", seed, folder] if number(seed)? >= MANY_FROM => {
            let case = Many::new(number(seed)?);
            for (index, operand) in case.merged().iter().enumerate() {
                save(operand, folder, &format!("operand-{index}"))?;
            }
            many::attempt(&case).map_or(Ok(()), |mesh| save(&mesh, folder, "result"))
        }
        ["save", seed, folder] => {
            let case = Case::new(number(seed)?, &models);
            save(&case.a, folder, "a")?;
            save(&case.b, folder, "b")?;
            run::attempt(&case).map_or(Ok(()), |mesh| save(&mesh, folder, "result"))
        }
        ["minimise", seed, folder, name] => {
            let seed = number(seed)?;
            let case = Case::new(seed, &models);
            let faults = |pair: &[Mesh; 2]| run::faults_of(&Case { a: pair[0].clone(), b: pair[1].clone(), ..case.clone() });
            let pair = [case.a.clone(), case.b.clone()];
            let fault = faults(&pair);
            if fault == 0 {
                return Err(format!("seed {seed} does not fail"));
            }
            std::panic::set_hook(Box::new(|_| {}));
            let small = judge::minimise::minimised(&pair, |pair| faults(pair) & fault != 0);
            println!("{:?}: {} and {} triangles", case.operation, small[0].triangles.len(), small[1].triangles.len());
            small.iter().zip(["a", "b"]).try_for_each(|(mesh, which)| save(mesh, folder, &format!("{name}-{which}")))
        }
        _ => Err("usage: trisect-proof emit FIRST COUNT [POINTS] | judge | limits | show SEED... | save SEED FOLDER | \
                  minimise SEED FOLDER NAME"
            .into()),
    }
}

fn number(word: &str) -> Result<u64, String> {
    word.parse().map_err(|_| format!("not a number: {word}"))
}

fn save(mesh: &Mesh, folder: &str, name: &str) -> Result<(), String> {
    mesh.save(format!("{folder}/{name}.obj")).map_err(|error| error.to_string())
}

fn emit(first: u64, count: u64, points: usize, models: &[Mesh]) -> std::io::Result<()> {
    // A panic is a finding, not noise.
    std::panic::set_hook(Box::new(|_| {}));
    let mut out = BufWriter::new(std::io::stdout().lock());
    for seed in first..first + count {
        if seed >= MANY_FROM {
            let case = Many::new(seed);
            record::write_many(&mut out, seed, &case, &many::examine(seed, &case, points))?;
        } else {
            let case = Case::new(seed, models);
            record::write(&mut out, seed, &case, &run::examine(seed, &case, points))?;
        }
        // A crash must not take the cases before it along.
        out.flush()?;
    }
    Ok(())
}
