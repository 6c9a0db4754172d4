//! `valvescope ddc100`: what belongs to DDC-100 networks.

mod poll;

use super::{block_on, log_to_stderr, refuse};
use clap::{Subcommand, ValueEnum};
use serde_json::json;
use shared::ddc100::estimate::{Estimate, estimate};
use shared::ddc100::tables::{RESPONSE_TIMES, SCAN_TIMES};
use shared::ddc100::timing::Line;
use shared::device::Device;
use shared::frame::Framing;
use std::io::{self, ErrorKind, Write};
use std::process::ExitCode;

/// Where the tables stand.
const SOURCE: &str = "LMAIM4019-00, tables 4.1 and 4.2";

/// What to do.
#[derive(Debug, clap::Args)]
pub(super) struct Ddc100Args {
    #[command(subcommand)]
    verb: Verb,
}

#[derive(Debug, Subcommand)]
enum Verb {
    /// Poll a network of the configuration and print its units, ports and diagnosis.
    Poll(poll::PollArgs),
    /// Estimate how long a scan takes, beside tables 4.1 and 4.2 of the guide.
    ScanTime(ScanArgs),
}

/// What to estimate.
#[derive(Debug, clap::Args)]
struct ScanArgs {
    /// Numbers of units; those of table 4.2 if none is given.
    #[arg(long, value_delimiter = ',', value_parser = clap::value_parser!(u16).range(1..=250))]
    units: Vec<u16>,
    /// Registers of a poll; those of table 4.1 if none is given.
    #[arg(long, value_delimiter = ',', value_parser = clap::value_parser!(u16).range(1..=125))]
    registers: Vec<u16>,
    /// Types of the units; the two of the tables if none is given.
    #[arg(long, value_enum, value_delimiter = ',')]
    device: Vec<UnitArg>,
    /// Bits a second.
    #[arg(long, default_value_t = 9600, value_parser = baud)]
    baud: u32,
    /// RTU or ASCII.
    #[arg(long, value_enum, default_value_t = FramingArg::Rtu)]
    framing: FramingArg,
    /// From an answer to the next request, in milliseconds: more than 20 and less than 50.
    #[arg(long, default_value_t = 21, value_parser = clap::value_parser!(u16).range(21..=49))]
    turn_ms: u16,
    /// How to print it.
    #[arg(long, value_enum, default_value_t = Format::Text)]
    format: Format,
}

/// Types of field units.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum UnitArg {
    /// MX/DDC.
    Ddc100Mx,
    /// MX or QX of series B.
    Ddc100MxB,
    /// UEC-3-DDC.
    Ddc100Uec,
    /// Clamshell.
    Ddc100Clamshell,
    /// I/O module.
    Ddc100Io,
}

impl UnitArg {
    const fn device(self) -> Device {
        match self {
            Self::Ddc100Mx => Device::Ddc100Mx,
            Self::Ddc100MxB => Device::Ddc100MxB,
            Self::Ddc100Uec => Device::Ddc100Uec,
            Self::Ddc100Clamshell => Device::Ddc100Clamshell,
            Self::Ddc100Io => Device::Ddc100Io,
        }
    }
}

/// Framings.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum FramingArg {
    /// Modbus RTU.
    Rtu,
    /// Modbus ASCII.
    Ascii,
}

impl From<FramingArg> for Framing {
    fn from(arg: FramingArg) -> Self {
        match arg {
            FramingArg::Rtu => Self::Rtu,
            FramingArg::Ascii => Self::Ascii,
        }
    }
}

/// Forms of output.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Format {
    /// For people.
    Text,
    /// For programs.
    Json,
}

/// The speeds of table 3.1.
fn baud(text: &str) -> Result<u32, String> {
    let known = [1200, 2400, 4800, 9600, 19_200];
    let read = text.parse().ok().filter(|b| known.contains(b));
    read.ok_or_else(|| "field units have 1200, 2400, 4800, 9600 or 19200 baud".to_owned())
}

/// Does what is asked.
pub(super) fn run(args: &Ddc100Args) -> ExitCode {
    let args = match &args.verb {
        Verb::Poll(args) => {
            log_to_stderr();
            return block_on(poll::run(args));
        }
        Verb::ScanTime(args) => args,
    };
    match scan_time(args) {
        Ok(()) => ExitCode::SUCCESS,
        // Whoever read our output has seen enough.
        Err(error) if error.kind() == ErrorKind::BrokenPipe => ExitCode::SUCCESS,
        Err(error) => refuse(format_args!("can't print the estimate: {error}")),
    }
}

fn or<T: Copy + PartialEq>(given: &[T], usual: impl Iterator<Item = T>) -> Vec<T> {
    let mut all: Vec<T> = Vec::new();
    let usual: Vec<T> = if given.is_empty() {
        usual.collect()
    } else {
        given.to_vec()
    };
    for value in usual {
        if !all.contains(&value) {
            all.push(value);
        }
    }
    all
}

fn scan_time(args: &ScanArgs) -> io::Result<()> {
    let line = Line {
        framing: args.framing.into(),
        baud: args.baud,
        bits: 10,
    };
    let units = or(&args.units, SCAN_TIMES.iter().map(|s| s.units));
    let registers = or(&args.registers, RESPONSE_TIMES.iter().map(|r| r.registers));
    let usual = [UnitArg::Ddc100Mx, UnitArg::Ddc100Uec];
    let kinds = or(&args.device, usual.into_iter());
    let turn_us = u64::from(args.turn_ms) * 1000;
    let mut out = io::stdout().lock();
    if args.format == Format::Text {
        let framing = line.framing.key();
        let (baud, turn) = (args.baud, args.turn_ms);
        writeln!(
            out,
            "{framing}, {baud} baud 8N1, {turn} ms from an answer to the next request"
        )?;
        writeln!(
            out,
            "{SOURCE}; * below the units times table 4.1 (reading D23)"
        )?;
    }
    for kind in kinds {
        for (at, registers) in registers.iter().enumerate() {
            let each = units
                .iter()
                .filter_map(|n| estimate(kind.device(), *n, *registers, line, turn_us));
            for (row, estimate) in each.enumerate() {
                match args.format {
                    Format::Json => writeln!(out, "{}", json_line(&estimate, line, args.turn_ms))?,
                    Format::Text => {
                        if row == 0 {
                            text_head(&mut out, &estimate, at == 0)?;
                        }
                        text_row(&mut out, &estimate)?;
                    }
                }
            }
        }
    }
    out.flush()
}

/// Microseconds as seconds.
fn seconds(us: u64) -> String {
    format!(
        "{}.{:02}",
        (us + 5_000) / 1_000_000,
        (us + 5_000) / 10_000 % 100
    )
}

/// Microseconds as milliseconds.
fn millis(us: u64) -> String {
    format!("{}.{}", (us + 50) / 1000, (us + 50) / 100 % 10)
}

fn text_head(out: &mut impl Write, e: &Estimate, first: bool) -> io::Result<()> {
    if first {
        writeln!(out, "\n{}", e.kind.label())?;
    }
    writeln!(
        out,
        "  {} register{}: {} ms a unit ({}); at least {} ms by the line alone",
        e.registers,
        if e.registers == 1 { "" } else { "s" },
        millis(e.exchange_us),
        e.basis.label(),
        millis(e.least_us)
    )?;
    writeln!(
        out,
        "    units   scan s   without turn s   table 4.2 s   by the line alone s"
    )
}

fn text_row(out: &mut impl Write, e: &Estimate) -> io::Result<()> {
    let printed = match e.printed {
        Some(printed) => format!("{}{}", printed.text, if is_short(e) { " *" } else { "" }),
        None => "-".to_owned(),
    };
    writeln!(
        out,
        "    {:>5}   {:>6}   {:>14}   {:>11}   {:>19}",
        e.units,
        seconds(e.scan_us),
        seconds(e.bare_us),
        printed,
        seconds(e.least_scan_us)
    )
}

/// True if the print is less than the sum, by more than its rounding.
fn is_short(e: &Estimate) -> bool {
    e.printed
        .is_some_and(|printed| printed.us + printed.rounding_us < e.bare_us)
}

fn json_line(e: &Estimate, line: Line, turn_ms: u16) -> serde_json::Value {
    let ms = |us: u64| us as f64 / 1000.0;
    json!({
        "device": e.kind.key(),
        "units": e.units,
        "registers": e.registers,
        "framing": line.framing.key(),
        "baud": line.baud,
        "turn_ms": turn_ms,
        "exchange_ms": ms(e.exchange_us),
        "basis": e.basis.label(),
        "scan_ms": ms(e.scan_us),
        "without_turn_ms": ms(e.bare_us),
        "line_ms": ms(e.least_scan_us),
        "table_4_2": e.printed.map(|p| p.text),
        "table_4_2_ms": e.printed.map(|p| ms(p.us)),
        "below_table_4_1": is_short(e),
        "source": SOURCE,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_rounded() {
        assert_eq!(seconds(994_999), "0.99");
        assert_eq!(seconds(995_000), "1.00");
        assert_eq!(seconds(12_345_678), "12.35");
        assert_eq!(millis(49_949), "49.9");
        assert_eq!(millis(49_950), "50.0");
    }

    /// The example of section 4.3: 20 MX/DDC with 5 registers, and the turn time on top; the print is
    /// less than 20 times 50 ms.
    #[test]
    fn the_example_of_the_guide_as_json() {
        let e = estimate(Device::Ddc100Mx, 20, 5, Line::GUIDE, 21_000).unwrap();
        let json = json_line(&e, Line::GUIDE, 21);
        assert_eq!(json["scan_ms"], 1420.0);
        assert_eq!(json["without_turn_ms"], 1000.0);
        assert_eq!(json["table_4_2_ms"], 980.0);
        assert_eq!(json["below_table_4_1"], true);
    }

    #[test]
    fn only_speeds_of_the_units_are_taken() {
        assert_eq!(baud("19200"), Ok(19_200));
        assert!(baud("38400").is_err() && baud("fast").is_err());
    }
}
