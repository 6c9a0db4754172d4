//! `valvescope simulate`.

use super::refuse;
use std::process::ExitCode;

/// Be a device.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
}

/// Runs the device until it is asked to end.
pub(super) fn run(_args: &Args) -> ExitCode {
    refuse("not yet")
}
