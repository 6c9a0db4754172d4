//! The parts of the Rust toolchain that a fresh machine lacks.

use crate::{Result, shell};
use std::path::Path;

/// The target of the page.
pub const WASM: &str = "wasm32-unknown-unknown";

/// Adds the wasm target unless it is there.
pub fn ensure_wasm_target() -> Result {
    let sysroot = shell::capture(&mut shell::program("rustc", ["--print", "sysroot"]))?;
    if Path::new(sysroot.trim())
        .join("lib/rustlib")
        .join(WASM)
        .is_dir()
    {
        return Ok(());
    }
    rustup(&["target", "add", WASM])
}

/// Adds clippy and rustfmt unless they are there (rustup's minimal profile lacks them).
pub fn ensure_checkers() -> Result {
    for (verb, component) in [("clippy", "clippy"), ("fmt", "rustfmt")] {
        if !shell::succeeds(&mut shell::cargo([verb, "--version"])) {
            rustup(&["component", "add", component])?;
        }
    }
    Ok(())
}

/// Calls rustup, and says what to do when there is none or when it fails.
fn rustup(args: &[&str]) -> Result {
    let mut command = shell::program("rustup", args);
    println!("adding to the toolchain: {}", shell::line(&command));
    shell::run(&mut command).map_err(|error| {
        let wanted = args.last().copied().unwrap_or_default();
        format!(
            "{error}\n  The toolchain lacks `{wanted}`. Install rustup (https://rustup.rs) and run \
             `rustup {}`,\n  or install `{wanted}` for this toolchain by your package manager.",
            args.join(" ")
        )
        .into()
    })
}
