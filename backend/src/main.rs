//! The `valvescope` binary.

use clap::Parser;
use std::process::ExitCode;

fn main() -> ExitCode {
    backend::cli::run(backend::cli::Cli::parse())
}
