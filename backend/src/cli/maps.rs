//! `valvescope maps`: the register map of a device.

use super::{DeviceArg, refuse};
use clap::ValueEnum;
use shared::device::{Device, Family};
use shared::dop::export as dop;
use shared::dop::profile::Profile;
use shared::icon3000::{self, export};
use shared::map::export::{
    CSV_HEADER, csv_line, json_line, text_function, text_line, text_members,
};
use shared::map::row::Model;
use std::io::{self, BufWriter, ErrorKind, Write};
use std::process::ExitCode;

/// Print a map.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    /// Which device.
    #[arg(long, value_enum, default_value_t = DeviceArg::Icon3000v2)]
    device: DeviceArg,
    /// What to print: readable text, one JSON object a line, or a table for spreadsheets. A Rotork
    /// device is printed as JSON only.
    #[arg(long, value_enum, default_value_t = Format::Text)]
    format: Format,
    /// Diagnostic objects: also the layouts that the number of registers can choose.
    #[arg(long)]
    alternatives: bool,
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
    if args.device == DeviceArg::Dop {
        return ended(objects(args));
    }
    if let Some(family) = Device::from(args.device).family() {
        if args.format != Format::Json {
            return refuse("a HART device has no registers; add --format json");
        }
        return ended(hart(family));
    }
    let Some(map) = Device::from(args.device).map() else {
        return refuse("there is no map of no device; choose one of the others");
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
                    out.write_all(text_members(row).as_bytes())?;
                }
            }
        }
        if map.model == Model::Icon3000v2 {
            files(args.format, &mut out)?;
        }
        if args.format == Format::Text {
            writeln!(out, "\n{}, functions", map.name)?;
            for function in map.functions {
                writeln!(out, "{}", text_function(function))?;
            }
        }
        out.flush()
    };
    ended(print())
}

/// Every field of every file of function 20.
fn files(format: Format, out: &mut impl Write) -> io::Result<()> {
    let mut line = String::new();
    for file in &icon3000::FILES {
        if format == Format::Text {
            writeln!(out, "\n{}", export::heading(file))?;
        }
        for field in export::lines().filter(|l| l.file == file) {
            line.clear();
            match format {
                Format::Json => field.write_json(&mut line).map_err(io::Error::other)?,
                Format::Csv => line.push_str(&field.csv()),
                Format::Text => line.push_str(&field.text()),
            }
            writeln!(out, "{line}")?;
        }
    }
    Ok(())
}

/// Every command, status bit and unit of a HART device.
fn hart(family: Family) -> io::Result<()> {
    let mut text = String::new();
    shared::hart::export::write(&mut text, family).map_err(io::Error::other)?;
    io::stdout().lock().write_all(text.as_bytes())
}

/// Every field of every diagnostic object.
fn objects(args: &Args) -> io::Result<()> {
    let format = args.format;
    let mut out = BufWriter::new(io::stdout().lock());
    if format == Format::Csv {
        writeln!(out, "{}", dop::CSV_HEADER)?;
    }
    let (mut line, mut before) = (String::new(), None);
    for field in dop::lines(args.alternatives) {
        line.clear();
        let written = match format {
            Format::Json => field.write_json(&mut line),
            Format::Csv => field.write_csv(&mut line),
            Format::Text => {
                let request = field.object.request(field.choice, &Profile::default());
                let head = (request, field.layout.key);
                if before != Some(head) {
                    let gap = if before.is_some() { "\n" } else { "" };
                    let option = field.choice.label;
                    let comma = if option.is_empty() { "" } else { ", " };
                    let (label, registers) = (field.object.label, field.layout.words);
                    writeln!(
                        out,
                        "{gap}{request} {label}{comma}{option}: {registers} registers"
                    )?;
                    before = Some(head);
                }
                field.write_text(&mut line)
            }
        };
        written.map_err(io::Error::other)?;
        writeln!(out, "{line}")?;
    }
    out.flush()
}

/// How it went.
fn ended(printed: io::Result<()>) -> ExitCode {
    match printed {
        Ok(()) => ExitCode::SUCCESS,
        // Whoever read our output has seen enough.
        Err(error) if error.kind() == ErrorKind::BrokenPipe => ExitCode::SUCCESS,
        Err(error) => refuse(format_args!("can't print the map: {error}")),
    }
}
