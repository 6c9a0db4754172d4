//! `valvescope maps`: the register map of a device.

use super::{DeviceArg, refuse};
use clap::ValueEnum;
use shared::device::Device;
use shared::map::export::{CSV_HEADER, csv_line, json_line, text_line};
use std::io::{self, BufWriter, ErrorKind, Write};
use std::process::ExitCode;

/// Print a map.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    /// Which device.
    #[arg(long, value_enum, default_value_t = DeviceArg::Icon3000v2)]
    device: DeviceArg,
    /// What to print: readable text, one JSON object a line, or a table for spreadsheets.
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
pub(super) fn run(args: &Args) -> ExitCode {
    let Some(map) = Device::from(args.device).map() else {
        return refuse("there is no map of no device; choose icon3000 or icon3000v2");
    };
    let mut out = BufWriter::new(io::stdout().lock());
    let mut print = || -> io::Result<()> {
        if args.format == Format::Csv {
            writeln!(out, "{CSV_HEADER}")?;
        }
        let mut table = None;
        for row in map.rows {
            match args.format {
                Format::Json => writeln!(out, "{}", json_line(map, row))?,
                Format::Csv => writeln!(out, "{}", csv_line(map, row))?,
                Format::Text => {
                    if table != Some(row.table) {
                        let gap = if table.is_some() { "\n" } else { "" };
                        writeln!(
                            out,
                            "{gap}{}, {}s",
                            map.name,
                            row.table.label().to_lowercase()
                        )?;
                        table = Some(row.table);
                    }
                    writeln!(out, "{}", text_line(row))?;
                }
            }
        }
        out.flush()
    };
    match print() {
        Ok(()) => ExitCode::SUCCESS,
        // Whoever read our output has seen enough.
        Err(error) if error.kind() == ErrorKind::BrokenPipe => ExitCode::SUCCESS,
        Err(error) => refuse(format_args!("can't print the map: {error}")),
    }
}
