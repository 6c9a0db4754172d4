//! What is connected where: `valvescope.toml`.
//!
//! Every refusal names the file, the line and what to write instead.

mod check;
mod ddc;
pub mod hart;
mod profile;
mod raw;
mod tags;
#[cfg(test)]
mod tests;

pub use ddc::{DdcConfig, DdcPorts};
pub use hart::HartConfig;

use shared::device::Device;
use shared::dop::Profile;
use shared::frame::Framing;
use shared::hart::link::Target;
use shared::sim::Fault;
use std::fmt;
use std::net::SocketAddr;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

/// Where the page is served if nothing else is said.
pub const LISTEN: SocketAddr =
    SocketAddr::new(std::net::IpAddr::V4(std::net::Ipv4Addr::LOCALHOST), 8080);

/// The file that is read if it is in the current directory.
pub const FILE: &str = "valvescope.toml";

/// The commented example.
pub const EXAMPLE: &str = include_str!("../valvescope.example.toml");

/// A checked configuration.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Config {
    /// Where to listen.
    pub listen: SocketAddr,
    /// Names besides those of loopback under which the page may be opened.
    pub hosts: Vec<String>,
    /// The buses.
    pub buses: Vec<BusConfig>,
    /// The devices on them.
    pub devices: Vec<DeviceConfig>,
}

/// One bus.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BusConfig {
    /// Its name, unique.
    pub name: String,
    /// Where it goes.
    pub line: LineConfig,
    /// How long a device may take to begin its answer.
    pub timeout: Duration,
    /// How often a read without a sound answer is repeated.
    pub retries: u8,
    /// Silence before a request that the devices need, where it is longer than the standard says.
    pub turnaround: Duration,
}

/// Where a bus goes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum LineConfig {
    /// A serial port.
    Serial {
        /// RTU or ASCII.
        framing: Framing,
        /// Path of the port: `/dev/ttyUSB0`.
        port: String,
        /// Bits a second.
        baud: u32,
        /// Data bits, parity and stop bits.
        mode: Mode,
    },
    /// Modbus TCP.
    Tcp {
        /// Name or address with port.
        host: String,
    },
    /// A gateway that passes Modbus RTU frames through unchanged.
    RtuOverTcp {
        /// Name or address with port.
        host: String,
    },
    /// The built-in plant: its devices are simulated.
    Simulator,
    /// A DDC-100 network, on one or two serial ports or simulated.
    Ddc(Arc<DdcConfig>),
    /// A HART line: a modem, a gateway, or simulated.
    Hart(Arc<HartConfig>),
}

impl LineConfig {
    /// How frames are marked off.
    #[must_use]
    pub fn framing(&self) -> Framing {
        match self {
            Self::Serial { framing, .. } => *framing,
            Self::Ddc(ddc) => ddc.framing,
            Self::Hart(hart) => hart.framing(),
            Self::Tcp { .. } => Framing::Tcp,
            Self::RtuOverTcp { .. } | Self::Simulator => Framing::Rtu,
        }
    }
}

impl LineConfig {
    /// The network, if it is one of DDC-100 units.
    #[must_use]
    pub const fn ddc(&self) -> Option<&Arc<DdcConfig>> {
        match self {
            Self::Ddc(ddc) => Some(ddc),
            _ => None,
        }
    }

    /// The line, if it is one of HART devices.
    #[must_use]
    pub const fn hart(&self) -> Option<&Arc<HartConfig>> {
        match self {
            Self::Hart(hart) => Some(hart),
            _ => None,
        }
    }

    /// True if nothing of it is real.
    #[must_use]
    pub fn is_simulated(&self) -> bool {
        match self {
            Self::Simulator => true,
            Self::Ddc(ddc) => matches!(ddc.ports, DdcPorts::Simulated(_)),
            Self::Hart(hart) => hart.way == hart::HartWay::Simulated,
            _ => false,
        }
    }
}

impl fmt::Display for LineConfig {
    /// As people name it: `/dev/ttyUSB0 9600 8E1`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Serial {
                port, baud, mode, ..
            } => write!(f, "{port} {baud} {mode}"),
            Self::Tcp { host } => f.write_str(host),
            Self::RtuOverTcp { host } => write!(f, "{host}, RTU over TCP"),
            Self::Simulator => f.write_str("built-in simulator"),
            Self::Ddc(ddc) => write!(f, "{ddc}"),
            Self::Hart(hart) => write!(f, "{hart}"),
        }
    }
}

/// Parity of a serial line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Parity {
    /// `N`.
    None,
    /// `E`.
    Even,
    /// `O`.
    Odd,
}

/// Data bits, parity and stop bits of a serial line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Mode {
    /// 7 or 8.
    pub data: u8,
    /// The parity.
    pub parity: Parity,
    /// 1 or 2.
    pub stop: u8,
}

impl Mode {
    /// Reads `8E1`.
    #[must_use]
    pub fn parse(text: &str) -> Option<Self> {
        let [data, parity, stop] = <[u8; 3]>::try_from(text.as_bytes()).ok()?;
        Some(Self {
            data: match data {
                b'7' => 7,
                b'8' => 8,
                _ => return None,
            },
            parity: match parity.to_ascii_uppercase() {
                b'N' => Parity::None,
                b'E' => Parity::Even,
                b'O' => Parity::Odd,
                _ => return None,
            },
            stop: match stop {
                b'1' => 1,
                b'2' => 2,
                _ => return None,
            },
        })
    }

    /// Bits of one character on the wire, start bit included.
    #[must_use]
    pub const fn bits(self) -> u32 {
        let parity = if matches!(self.parity, Parity::None) {
            0
        } else {
            1
        };
        1 + self.data as u32 + parity + self.stop as u32
    }
}

impl fmt::Display for Mode {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let parity = match self.parity {
            Parity::None => 'N',
            Parity::Even => 'E',
            Parity::Odd => 'O',
        };
        write!(f, "{}{parity}{}", self.data, self.stop)
    }
}

/// One device.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DeviceConfig {
    /// Its tag, unique.
    pub tag: String,
    /// Its kind.
    pub device: Device,
    /// Index of its bus.
    pub bus: usize,
    /// Its unit address; of a HART device its polling address.
    pub unit: u8,
    /// What it does in the plant.
    pub description: String,
    /// For a DOP device: what the manual leaves open, as this site has it.
    pub profile: Option<Arc<Profile>>,
    /// For a HART device: how it is found.
    pub target: Option<Target>,
    /// For a simulated ICON: what is wrong with it from the start.
    pub faults: Vec<Fault>,
}

impl DeviceConfig {
    /// A device of the first bus with nothing but what it must have.
    #[must_use]
    pub fn simple(tag: &str, device: Device, unit: u8) -> Self {
        Self {
            tag: tag.to_owned(),
            device,
            bus: 0,
            unit,
            description: String::new(),
            profile: None,
            target: None,
            faults: Vec::new(),
        }
    }
}

/// Why a configuration is refused.
#[derive(Debug, thiserror::Error)]
pub enum ConfigError {
    /// The file can't be read.
    #[error("can't read {}: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// Something in it is wrong.
    #[error("{}, line {line}: {text}", path.display())]
    Wrong {
        /// The file.
        path: PathBuf,
        /// Line, counted from 1.
        line: usize,
        /// What is wrong and what to do.
        text: String,
    },
}

impl Config {
    /// The configuration of the command line: the file named, else the one in the current
    /// directory, else the simulated plant.
    ///
    /// # Errors
    /// If a file can't be read or understood.
    pub fn load(named: Option<&Path>) -> Result<Self, ConfigError> {
        let path = match named {
            Some(path) => path,
            None if Path::new(FILE).is_file() => Path::new(FILE),
            None => return Ok(Self::simulated()),
        };
        let text = std::fs::read_to_string(path).map_err(|source| ConfigError::Read {
            path: path.to_owned(),
            source,
        })?;
        Self::parse(path, &text)
    }

    /// Reads and checks the text of a file.
    ///
    /// # Errors
    /// If anything in it is wrong; nothing is guessed.
    pub fn parse(path: &Path, text: &str) -> Result<Self, ConfigError> {
        let wrong = |at: usize, what: String| ConfigError::Wrong {
            path: path.to_owned(),
            line: 1 + text.get(..at).map_or(0, |t| t.matches('\n').count()),
            text: what,
        };
        let raw: raw::File = toml::from_str(text).map_err(|error| {
            let at = error.span().map_or(0, |s| s.start);
            wrong(at, explain(text, at, error.message()))
        })?;
        let beside = path.parent().unwrap_or(Path::new(""));
        check::check(raw, beside).map_err(|check::Wrong { at, text }| wrong(at, text))
    }

    /// The devices of a bus, in the order of the file.
    pub fn on(&self, bus: &BusConfig) -> impl Iterator<Item = &DeviceConfig> {
        let at = self.buses.iter().position(|b| b.name == bus.name);
        self.devices.iter().filter(move |d| Some(d.bus) == at)
    }

    /// What is served without a configuration: a plant of four valves that is alive, a loop of
    /// field units whose cable breaks now and then, and a HART loop with a valve of
    /// each family.
    #[must_use]
    pub fn simulated() -> Self {
        let on = |bus: usize, tag: &str, device: Device, unit, description: &str| DeviceConfig {
            tag: tag.into(),
            device,
            bus,
            unit,
            description: description.into(),
            faults: Vec::new(),
            profile: (device == Device::Dop).then(crate::sim::dop_profile),
            target: None,
        };
        let mut devices = vec![
            on(
                0,
                "XV-101",
                Device::Icon3000v2,
                1,
                "Feed inlet, isolating valve",
            ),
            on(
                0,
                "FV-102",
                Device::Icon3000v2,
                2,
                "Feed flow, control valve",
            ),
            on(
                0,
                "XV-201",
                Device::Icon3000,
                3,
                "Tank 2 outlet, isolating valve",
            ),
            on(
                0,
                "MX-301",
                Device::Dop,
                4,
                "Tank 3 inlet, isolating valve with diagnostics",
            ),
        ];
        devices.extend(
            ddc::SIMULATED
                .iter()
                .map(|(tag, device, unit, what)| on(1, tag, *device, *unit, what)),
        );
        devices.extend(hart::simulated(2));
        Self {
            listen: LISTEN,
            hosts: Vec::new(),
            buses: vec![
                BusConfig {
                    name: "Simulated plant".into(),
                    line: LineConfig::Simulator,
                    timeout: check::TIMEOUT,
                    retries: check::RETRIES,
                    turnaround: Duration::ZERO,
                },
                ddc::simulated(),
                hart::simulated_bus(),
            ],
            devices,
        }
    }
}

/// What the parser says, with the key that it is about.
fn explain(text: &str, at: usize, message: &str) -> String {
    let message = message
        .replace('\n', "; ")
        .replace("expected i64", "expected a whole number without quotes")
        .replace("expected a string", "expected text in quotes");
    if message.starts_with("missing field") {
        return format!("{message}; add it to this section");
    }
    let before = text.get(..at).unwrap_or("");
    let line = before.rsplit('\n').next().unwrap_or("");
    match line.split_once('=') {
        Some((key, _)) if !message.contains('`') => format!("`{}`: {message}", key.trim()),
        _ => message,
    }
}
