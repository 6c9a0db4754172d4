//! `valvescope simulate --ddc100`: a network of field units behind one or two serial ports.

use super::say;
use crate::cli::{asked_to_end, refuse};
use crate::clock::Clock;
use crate::config::{DeviceConfig, Mode, Parity};
use crate::serial;
use crate::sim::ddc::{Fault, Network, Pace, serve};
use clap::ValueEnum;
use shared::ddc100::HostPort;
use shared::device::Device;
use shared::frame::Framing;
use shared::proto::DdcShape;
use shared::sim::ddc100::UnitTrouble;
use std::io;
use std::process::ExitCode;
use std::time::Duration;
use tokio_serial::{SerialPort, SerialStream};

/// In place of a path: a new pseudo terminal.
const PTY: &str = "pty";
/// Types of the units if only their number is given.
const MIXED: [Device; 4] = [
    Device::Ddc100Mx,
    Device::Ddc100Uec,
    Device::Ddc100Clamshell,
    Device::Ddc100Io,
];
/// Shortest silence that ends a frame: less can't be told apart from a busy computer.
const SHORTEST_GAP: Duration = Duration::from_millis(4);

/// How the network is.
#[derive(Debug, clap::Args)]
#[command(next_help_heading = "With --ddc100")]
pub(super) struct NetworkArgs {
    /// Number of units, of all types in turn, or types with their numbers: `mx:10,uec:5,io:1`.
    #[arg(long, value_name = "UNITS", default_value = "12", value_parser = units, requires = "ddc100")]
    units: Units,
    /// How the cable runs; a loop with two ports, else single-ended.
    #[arg(long, value_enum, requires = "ddc100")]
    shape: Option<ShapeArg>,
    /// RTU or ASCII.
    #[arg(long, value_enum, default_value_t = FramingArg::Rtu, requires = "ddc100")]
    framing: FramingArg,
    /// Take the time of the characters too, as on a real cable; for pseudo terminals.
    #[arg(long, requires = "ddc100")]
    paced: bool,
    /// Answer at once instead of after the time of table 4.1.
    #[arg(long, requires = "ddc100", conflicts_with = "paced")]
    at_once: bool,
    /// Open and close the valves now and then, and let the inputs of I/O modules change.
    #[arg(long, requires = "ddc100")]
    lively: bool,
}

/// Every name of a fault.
pub(super) fn fault_help() -> String {
    format!(
        "with a DDC-100 network `break-3` or `short-3` (behind the third unit, 0 before the first), `port-2`, \
         or one of these with the address of a unit, as `off-7`: {}. A number in brackets may be \
         left out: `user-fault-3-7` is user fault 3 of unit 7, `user-fault-7` its first. With its \
         time in seconds: `break-3 from 60 to 120 every 240`",
        UnitTrouble::names()
    )
}

/// Shapes of a cable.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum ShapeArg {
    /// From one host port through all units to the other.
    Loop,
    /// From one host port through all units.
    SingleEnded,
    /// All units beside each other.
    MultiDrop,
}

/// Framings.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum FramingArg {
    /// Modbus RTU.
    Rtu,
    /// Modbus ASCII.
    Ascii,
}

/// Types of all units in the order of the cable.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Units(Vec<Device>);

fn units(text: &str) -> Result<Units, String> {
    let wrong = || {
        "write a number from 1 to 250, or types with numbers, as mx:10,uec:5 (mx, mx-b, uec, \
         clamshell, io)"
            .to_owned()
    };
    let all: Vec<Device> = match text.parse::<usize>() {
        Ok(count) => MIXED.into_iter().cycle().take(count.min(251)).collect(),
        Err(_) => {
            let mut all = Vec::new();
            for part in text.split(',') {
                let (kind, count) = part.trim().split_once(':').unwrap_or((part.trim(), "1"));
                let kind = Device::from_key(&format!("ddc100-{kind}"));
                let kind = kind.filter(|k| k.is_ddc()).ok_or_else(wrong)?;
                let count: usize = count.parse().map_err(|_| wrong())?;
                all.extend(std::iter::repeat_n(kind, count.min(251)));
            }
            all
        }
    };
    match all.len() {
        1..=250 => Ok(Units(all)),
        _ => Err(wrong()),
    }
}

/// Runs the network on these ports until it is asked to end.
pub(super) async fn run(
    args: &NetworkArgs,
    faults: &[Fault],
    paths: &[String],
    baud: u32,
) -> ExitCode {
    let shape = match args.shape {
        Some(ShapeArg::Loop) => DdcShape::Loop,
        Some(ShapeArg::SingleEnded) => DdcShape::SingleEnded,
        Some(ShapeArg::MultiDrop) => DdcShape::MultiDrop,
        None if paths.len() > 1 => DdcShape::Loop,
        None => DdcShape::SingleEnded,
    };
    if shape != DdcShape::Loop && paths.len() > 1 {
        return refuse("only a loop has a second port; give one path, or --shape loop");
    }
    let devices: Vec<DeviceConfig> = (1..=u8::MAX)
        .zip(&args.units.0)
        .map(|(unit, device)| DeviceConfig {
            tag: format!("MOV-{unit}"),
            device: *device,
            bus: 0,
            unit,
            description: String::new(),
            faults: Vec::new(),
            profile: None,
            target: None,
        })
        .collect();
    let network = match Network::new(shape, &devices, faults, Clock::start()) {
        Ok(network) => network,
        Err(fault) => {
            let count = devices.len();
            return refuse(format_args!(
                "--fault {fault} can't be: there are {count} units, and no place or unit of that \
                 number, or the unit is of a type that has no such thing"
            ));
        }
    };
    let network = match args.lively {
        true => network.lively(&devices),
        false => network,
    };
    let framing = match args.framing {
        FramingArg::Rtu => Framing::Rtu,
        FramingArg::Ascii => Framing::Ascii,
    };
    let pace = Pace::new(framing, baud, SHORTEST_GAP);
    let pace = match (args.paced, args.at_once) {
        (true, _) => pace,
        (_, true) => pace.at_once(),
        _ => pace.on_the_wire(),
    };
    let mut lines = Vec::new();
    let mut kept = Vec::new();
    for path in paths {
        let opened = open(path, baud).map(|(line, other, path)| {
            kept.push(other);
            lines.push(line);
            path
        });
        match opened {
            Ok(path) => {
                let number = lines.len();
                let count = devices.len();
                let last = number == paths.len();
                let units = if last {
                    format!(", units 1 to {count}")
                } else {
                    String::new()
                };
                say(&format!("port {number} on {path} {baud} 8N1{units}"));
            }
            Err(text) => return refuse(text),
        }
    }
    let mut lines = lines.into_iter();
    let end = |line: Option<SerialStream>, port| {
        let network = network.clone();
        async move {
            match line {
                Some(line) => serve(line, port, &network, pace).await,
                None => std::future::pending().await,
            }
        }
    };
    let ended = tokio::select! {
        ended = end(lines.next(), HostPort::One) => ended,
        ended = end(lines.next(), HostPort::Two) => ended,
        () = asked_to_end() => Ok(()),
    };
    drop(kept);
    match ended {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => refuse(format_args!("the line is lost: {error}")),
    }
}

/// Opens a port, or makes one: our end, the other end to keep it alive, and the path to name.
fn open(path: &str, baud: u32) -> Result<(SerialStream, Option<SerialStream>, String), String> {
    if path == PTY {
        let made = SerialStream::pair();
        let (ours, theirs) = made.map_err(|e| format!("can't make a pseudo terminal: {e}"))?;
        let path = theirs.name().unwrap_or_default();
        return Ok((ours, Some(theirs), path));
    }
    // Table 3.1 knows no other.
    let mode = Mode {
        data: 8,
        parity: Parity::None,
        stop: 1,
    };
    let line = serial::open(path, baud, mode);
    let why = |error: io::Error| crate::bus::words::serial(path, &error);
    Ok((line.map_err(why)?, None, path.to_owned()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_help_names_every_fault() {
        let help = fault_help();
        for name in [
            "off,",
            "local-esd,",
            "channel-b,",
            "verify-close-stays,",
            "user-fault[-0..9]",
            "analog-lost[-1..4]",
            "timer[-0..15]",
            "input[-0..19]",
            "state[-0..5]",
        ] {
            assert!(help.contains(name), "{name} is not in: {help}");
        }
    }

    #[test]
    fn units_are_counted_or_named() {
        assert_eq!(units("5").unwrap().0.len(), 5);
        assert_eq!(units("250").unwrap().0.len(), 250);
        let named = units("mx:2, uec,io:1").unwrap().0;
        use Device::{Ddc100Io, Ddc100Mx, Ddc100Uec};
        assert_eq!(named, [Ddc100Mx, Ddc100Mx, Ddc100Uec, Ddc100Io]);
        for bad in [
            "0",
            "251",
            "",
            "mx:0",
            "dop:1",
            "mx:x",
            "mx:200,uec:51",
            "mx:99999",
        ] {
            assert!(units(bad).is_err(), "{bad}");
        }
    }
}
