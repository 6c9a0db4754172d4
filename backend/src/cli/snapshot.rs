//! `valvescope snapshot`: a whole device as one file.

use super::{block_on, refuse};
use crate::config::{BusConfig, Config, DeviceConfig, LISTEN, LineConfig, Mode};
use crate::plant::Plant;
use crate::snapshot::{Taken, take};
use clap::ValueEnum;
use shared::device::Device;
use shared::frame::Framing;
use shared::icon3000::snapshot::{Snapshot, parse};
use shared::map::row::Model;
use shared::value::Value;
use std::fs;
use std::io::{IsTerminal, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

/// Save a whole ICON3000 as one file: registers, identity, counters, logs, curves.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    /// Tag of a device of the configuration; without it, --port or --host says where the device is.
    #[arg(long, value_name = "TAG", conflicts_with_all = ["port", "host"])]
    device: Option<String>,
    /// What is connected where; without it `valvescope.toml`, else the simulated plant.
    #[arg(long, value_name = "FILE", requires = "device")]
    config: Option<PathBuf>,
    /// Serial port of the device.
    #[arg(long, value_name = "PATH", conflicts_with = "host")]
    port: Option<String>,
    /// Modbus TCP device or gateway, as 192.0.2.5:502.
    #[arg(long, value_name = "ADDRESS")]
    host: Option<String>,
    /// Bits a second of the serial port.
    #[arg(long, default_value_t = 9600)]
    baud: u32,
    /// Data bits, parity and stop bits of the serial port.
    #[arg(long, default_value = "8E1", value_parser = mode)]
    mode: Mode,
    /// The serial line speaks Modbus ASCII.
    #[arg(long)]
    ascii: bool,
    /// Unit address.
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u8).range(1..=247))]
    unit: u8,
    /// Which model it is.
    #[arg(long, value_enum, default_value_t = Kind::Icon3000v2)]
    kind: Kind,
    /// Where to write the snapshot; without it, to standard output.
    #[arg(long, short, value_name = "FILE")]
    output: Option<PathBuf>,
}

/// Models of which snapshots can be taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Kind {
    /// ICON3000v2.
    Icon3000v2,
    /// ICON3000.
    Icon3000,
}

fn mode(text: &str) -> Result<Mode, String> {
    Mode::parse(text).ok_or_else(|| format!("`{text}` is no mode; write it as 8E1"))
}

/// Takes a snapshot. 0: all was read; 1: some of it could not be; 2: nothing could.
pub(super) fn run(args: &Args) -> ExitCode {
    let (config, tag) = match target(args) {
        Ok(target) => target,
        Err(why) => return refuse(why),
    };
    block_on(snapshot(args, config, tag))
}

async fn snapshot(args: &Args, config: Config, tag: String) -> ExitCode {
    let plant = Plant::start(&config);
    let found = config.devices.iter().find(|d| d.tag == tag);
    let (Some(device), Some((bus, at))) = (found, plant.device(&tag)) else {
        return refuse(format_args!(
            "there is no device \"{tag}\" in the configuration"
        ));
    };
    let model = match device.device {
        Device::Icon3000v2 => Model::Icon3000v2,
        Device::Icon3000 => Model::Icon3000,
        _ => {
            return refuse(format_args!(
                "{tag} is no ICON3000; snapshots are for that family"
            ));
        }
    };
    let mut empty = Snapshot::new(model, device.unit, &tag);
    empty.tool = concat!("valvescope ", env!("CARGO_PKG_VERSION")).to_owned();
    empty.taken = now();
    let begun = Instant::now();
    let progress = std::io::stderr().is_terminal();
    let taken = take(bus, at, empty, |done, total, what| {
        if progress {
            eprint!("\r\x1b[K{done} of {total} requests: {what}");
        }
    })
    .await;
    if progress {
        eprintln!("\r\x1b[K");
    }
    let Taken { mut snapshot, wire } = match taken {
        Ok(taken) => taken,
        Err(why) => return refuse(format_args!("{tag}: {why}")),
    };
    let took = begun.elapsed();
    snapshot.took_ms = u64::try_from(took.as_millis()).ok();
    if let Err(error) = write(args.output.as_deref(), &snapshot.to_text()) {
        return refuse(format_args!("can't write the snapshot: {error}"));
    }
    let ideal = match config.buses.get(device.bus).map(|b| &b.line) {
        Some(LineConfig::Serial { baud, mode, .. }) => {
            let micros = wire.micros(*baud, mode.bits());
            let ideal = Duration::from_micros(micros).as_secs_f64();
            format!(" (the line alone needs {ideal:.1} s)")
        }
        _ => String::new(),
    };
    eprintln!(
        "{}: {} requests in {:.1} s{ideal}, {} parts could not be read",
        tag,
        wire.exchanges,
        took.as_secs_f64(),
        snapshot.failures.len()
    );
    ExitCode::from(u8::from(!snapshot.failures.is_empty()))
}

/// The configuration and the tag of the device that is meant.
fn target(args: &Args) -> Result<(Config, String), String> {
    if let Some(tag) = &args.device {
        let config = Config::load(args.config.as_deref()).map_err(|error| error.to_string())?;
        return Ok((config, tag.clone()));
    }
    let line = match (&args.port, &args.host) {
        (Some(port), _) => LineConfig::Serial {
            framing: if args.ascii {
                Framing::Ascii
            } else {
                Framing::Rtu
            },
            port: port.clone(),
            baud: args.baud,
            mode: args.mode,
        },
        (None, Some(host)) => LineConfig::Tcp {
            host: with_port(host),
        },
        (None, None) => {
            return Err(
                "say where the device is: --device TAG, --port PATH or --host ADDRESS".to_owned(),
            );
        }
    };
    let tag = "device".to_owned();
    let kind = match args.kind {
        Kind::Icon3000v2 => Device::Icon3000v2,
        Kind::Icon3000 => Device::Icon3000,
    };
    let bus = BusConfig {
        name: "line".into(),
        line,
        timeout: Duration::from_millis(1000),
        retries: 2,
        turnaround: Duration::ZERO,
    };
    let config = Config {
        listen: LISTEN,
        hosts: Vec::new(),
        buses: vec![bus],
        devices: vec![DeviceConfig::simple(&tag, kind, args.unit)],
    };
    Ok((config, tag))
}

/// An address with the usual port, if it has none.
fn with_port(host: &str) -> String {
    let has_port = host
        .rsplit_once(':')
        .is_some_and(|(before, _)| before.ends_with(']') || !before.contains(':'));
    if has_port {
        host.to_owned()
    } else {
        format!("{host}:502")
    }
}

/// The time in words of RFC 3339, in UTC; empty if the clock stands before 1970.
fn now() -> String {
    let Ok(since) = SystemTime::now().duration_since(UNIX_EPOCH) else {
        return String::new();
    };
    i64::try_from(since.as_secs()).map_or_else(
        |_| String::new(),
        |seconds| Value::Stamp(seconds).to_string(),
    )
}

fn write(path: Option<&Path>, text: &str) -> std::io::Result<()> {
    match path {
        Some(path) => fs::write(path, text),
        None => std::io::stdout().lock().write_all(text.as_bytes()),
    }
}

/// Reads a file; says which, and what is wrong with it, if it holds no snapshot. What could not be
/// read of one is told on standard error.
pub(super) fn open(path: &Path) -> Result<Snapshot, String> {
    let name = path.display();
    let bytes = fs::read(path).map_err(|error| format!("can't read {name}: {error}"))?;
    let (snapshot, problems) = parse(&bytes);
    for problem in &problems {
        eprintln!("{name}: {problem}");
    }
    snapshot.ok_or_else(|| {
        format!("{name} is no snapshot; `valvescope snapshot` and the page write them")
    })
}
