//! Turns `data/` into static tables: `OUT_DIR/maps.rs`, included by `map/mod.rs`.
//!
//! A map with a mistake must not build. All problems are printed, each with file, line and the
//! number of its rule (see `build/rules.rs`), before the build stops.

#[path = "build/emit.rs"]
mod emit;
#[path = "build/read.rs"]
mod read;
#[path = "build/rules.rs"]
mod rules;
#[path = "build/sets.rs"]
mod sets;
#[path = "build/types.rs"]
mod types;

use std::path::Path;
use std::process::ExitCode;
use std::{env, fs, io};

fn main() -> ExitCode {
    println!("cargo::rerun-if-changed=data");
    println!("cargo::rerun-if-changed=build");
    match generate() {
        Ok(problems) if problems.is_empty() => ExitCode::SUCCESS,
        Ok(problems) => {
            for problem in &problems {
                eprintln!("{problem}");
            }
            eprintln!("{} problem(s) in the maps", problems.len());
            ExitCode::FAILURE
        }
        Err(error) => {
            eprintln!("shared/build.rs: {error}");
            ExitCode::FAILURE
        }
    }
}

/// Reads, checks and writes all maps. Nothing is written while there are problems.
fn generate() -> io::Result<Vec<types::Problem>> {
    let (data, mut problems) = read::all(Path::new("data"))?;
    // Rules judge what was read; with unreadable cells they would only echo them.
    if problems.is_empty() {
        problems = rules::check(&data);
    }
    if problems.is_empty() {
        let out = env::var_os("OUT_DIR").ok_or_else(|| io::Error::other("OUT_DIR is not set"))?;
        fs::write(Path::new(&out).join("maps.rs"), emit::maps(&data))?;
    }
    Ok(problems)
}
