//! `valvescope maps`: the register map of a device.

use super::{DeviceArg, refuse};
use clap::ValueEnum;
use std::process::ExitCode;

/// Print a map.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    /// Which device.
    #[arg(long, value_enum, default_value_t = DeviceArg::Icon3000v2)]
    device: DeviceArg,
    /// What to print.
    #[arg(long, value_enum, default_value_t = Format::Text)]
    format: Format,
}

/// Forms of output.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Format {
    /// For people.
    Text,
    /// For programs.
    Json,
    /// For spreadsheets.
    Csv,
}

/// Prints the map that the arguments name.
pub(super) fn run(_args: &Args) -> ExitCode {
    refuse("not yet")
}
