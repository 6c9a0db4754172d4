//! A device on a line that a command reads as a whole.

use crate::config::{BusConfig, Config, DeviceConfig, LISTEN, LineConfig, Mode};
use crate::plant::Plant;
use crate::snapshot::{Taken, take, which};
use clap::ValueEnum;
use shared::device::Device;
use shared::frame::Framing;
use shared::icon3000::snapshot::Snapshot;
use shared::map::row::Model;
use shared::value::Value;
use std::io::IsTerminal;
use std::path::PathBuf;
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

/// Where the device is.
#[derive(Debug, clap::Args)]
pub(super) struct Where {
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
    #[arg(long, default_value_t = 9600, conflicts_with_all = ["device", "host"])]
    baud: u32,
    /// Data bits, parity and stop bits of the serial port.
    #[arg(
        long,
        default_value = "8E1",
        value_parser = mode,
        conflicts_with_all = ["device", "host"]
    )]
    mode: Mode,
    /// The serial line speaks Modbus ASCII.
    #[arg(long, conflicts_with_all = ["device", "host"])]
    ascii: bool,
    /// Unit address.
    #[arg(
        long,
        default_value_t = 1,
        value_parser = clap::value_parser!(u8).range(1..=247),
        conflicts_with = "device"
    )]
    unit: u8,
    /// Which model it is; `auto` asks the device. With --device the configuration says it.
    #[arg(long, value_enum, default_value_t = Kind::Auto, conflicts_with = "device")]
    kind: Kind,
}

/// Models of which snapshots can be taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Kind {
    /// What the device itself says.
    Auto,
    /// ICON3000v2.
    Icon3000v2,
    /// ICON3000.
    Icon3000,
    /// ICON2000v4.
    #[value(name = "icon2000v4")]
    Icon2000v4,
}

impl Kind {
    /// The device to configure; one that is not known yet can be asked as the newest.
    const fn device(self) -> Device {
        match self {
            Self::Auto | Self::Icon3000v2 => Device::Icon3000v2,
            Self::Icon3000 => Device::Icon3000,
            Self::Icon2000v4 => Device::Icon2000v4,
        }
    }
}

/// A device that was read.
#[derive(Debug)]
pub(super) struct Live {
    /// Everything that it gave.
    pub snapshot: Snapshot,
    /// How it went, in one line.
    pub summary: String,
}

fn mode(text: &str) -> Result<Mode, String> {
    Mode::parse(text).ok_or_else(|| format!("`{text}` is no mode; write it as 8E1"))
}

impl Where {
    /// True if a device is named at all.
    pub(super) const fn is_given(&self) -> bool {
        self.device.is_some() || self.port.is_some() || self.host.is_some()
    }

    /// Reads the whole device.
    pub(super) async fn read(&self) -> Result<Live, String> {
        let (config, tag) = self.target()?;
        let plant = Plant::start(&config);
        let found = config.devices.iter().find(|d| d.tag == tag);
        let (Some(device), Some((bus, at))) = (found, plant.device(&tag)) else {
            return Err(format!("there is no device \"{tag}\" in the configuration"));
        };
        let mut guess = None;
        let model = match device.device {
            _ if self.device.is_none() && self.kind == Kind::Auto => {
                let found = which(bus, at)
                    .await
                    .map_err(|why| format!("{tag}: {why}"))?;
                eprintln!("{tag}: {}", found.why);
                let model = found.model;
                guess = Some(found);
                model.ok_or("say which model it is, with --kind")?
            }
            Device::Icon3000v2 => Model::Icon3000v2,
            Device::Icon3000 => Model::Icon3000,
            Device::Icon2000v4 => Model::Icon2000v4,
            _ => {
                return Err(format!(
                    "{tag} is no ICON3000; snapshots are for that family"
                ));
            }
        };
        let mut empty = Snapshot::new(model, device.unit, &tag);
        empty.tool = concat!("valvescope ", env!("CARGO_PKG_VERSION")).to_owned();
        empty.taken = now();
        empty.guess = guess;
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
        let Taken { mut snapshot, wire } = taken.map_err(|why| format!("{tag}: {why}"))?;
        let took = begun.elapsed();
        snapshot.took_ms = u64::try_from(took.as_millis()).ok();
        let ideal = match config.buses.get(device.bus).map(|b| &b.line) {
            Some(LineConfig::Serial { baud, mode, .. }) => {
                let micros = wire.micros(*baud, mode.bits());
                let ideal = Duration::from_micros(micros).as_secs_f64();
                format!(" (the line alone needs {ideal:.1} s)")
            }
            _ => String::new(),
        };
        let summary = format!(
            "{tag}: {} requests in {:.1} s{ideal}, {} parts could not be read",
            wire.exchanges,
            took.as_secs_f64(),
            snapshot.failures.len()
        );
        Ok(Live { snapshot, summary })
    }

    /// The configuration and the tag of the device that is meant.
    fn target(&self) -> Result<(Config, String), String> {
        if let Some(tag) = &self.device {
            let config = Config::load(self.config.as_deref()).map_err(|error| error.to_string())?;
            return Ok((config, tag.clone()));
        }
        let line = match (&self.port, &self.host) {
            (Some(port), _) => LineConfig::Serial {
                framing: if self.ascii {
                    Framing::Ascii
                } else {
                    Framing::Rtu
                },
                port: port.clone(),
                baud: self.baud,
                mode: self.mode,
            },
            (None, Some(host)) => LineConfig::Tcp {
                host: with_port(host),
            },
            (None, None) => {
                return Err(
                    "say where the device is: --device TAG, --port PATH or --host ADDRESS"
                        .to_owned(),
                );
            }
        };
        let tag = "device".to_owned();
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
            devices: vec![DeviceConfig::simple(&tag, self.kind.device(), self.unit)],
        };
        Ok((config, tag))
    }
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
