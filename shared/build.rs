//! Turns `data/` into static tables: `OUT_DIR/maps.rs`, included by `map/mod.rs`, `OUT_DIR/dop.rs`,
//! included by `dop/mod.rs`, `OUT_DIR/hart.rs`, included by `hart/mod.rs`, `OUT_DIR/icon3000.rs`,
//! included by `icon3000/model.rs`, and `OUT_DIR/ddc100.rs`, included by `ddc100/tables.rs`.
//!
//! A map with a mistake must not build. All problems are printed, each with file, line and the
//! number of its rule (see `build/rules.rs`, `build/ddc100.rs` and the `rules.rs` of the folders
//! there), before the build stops.

#[path = "build/ddc100.rs"]
mod ddc100;
#[path = "build/dop/mod.rs"]
mod dop;
#[path = "build/emit.rs"]
mod emit;
#[path = "build/hart/mod.rs"]
mod hart;
#[path = "build/icon/mod.rs"]
mod icon;
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
    let (mut data, mut problems) = read::all(Path::new("data"))?;
    let times = ddc100::read(Path::new("data"), &mut problems)?;
    if let Some(device) = data.devices.iter_mut().find(|d| d.key == "ddc100") {
        device.cited = times.cited();
    }
    // Rules judge what was read; with unreadable cells they would only echo them.
    if problems.is_empty() {
        problems = rules::check(&data);
        problems.extend(ddc100::check(&times));
    }
    let objects = dop::read(Path::new("data"), &mut problems)?;
    if problems.is_empty() {
        problems = dop::check(&objects, &data.docs);
    }
    let commands = hart::read(Path::new("data"), &mut problems)?;
    if problems.is_empty() {
        problems = hart::check(&commands, &data.docs);
    }
    let records = icon::read(Path::new("data"), &mut problems)?;
    let device = data.devices.iter().find(|d| d.key == "icon3000");
    let device = device.ok_or_else(|| io::Error::other("no folder data/icon3000"))?;
    if problems.is_empty() {
        problems = icon::check(&records, device);
    }
    if problems.is_empty() {
        let out = env::var_os("OUT_DIR").ok_or_else(|| io::Error::other("OUT_DIR is not set"))?;
        fs::write(Path::new(&out).join("maps.rs"), emit::maps(&data))?;
        fs::write(
            Path::new(&out).join("dop.rs"),
            dop::emit(&objects, &data.docs),
        )?;
        fs::write(Path::new(&out).join("ddc100.rs"), ddc100::emit(&times))?;
        fs::write(
            Path::new(&out).join("hart.rs"),
            hart::emit(&commands, &data.docs),
        )?;
        fs::write(
            Path::new(&out).join("icon3000.rs"),
            icon::emit(&records, device, &data.docs),
        )?;
    }
    Ok(problems)
}
