//! A DDC-100 network: one or two host ports, and a cable on which the units have an order.

use super::check::{Wrong, number, wrong};
use super::{BusConfig, Config, DeviceConfig, LineConfig, Mode, Parity, raw};
use crate::clock::Clock;
use crate::sim::ddc::{Fault, Network, Span};
use shared::ddc100::scaling::Scaling;
use shared::ddc100::setup::{
    Setup, USUAL_REGISTERS, USUAL_RETRIES, USUAL_TIMEOUT_US, USUAL_TURN_US,
};
use shared::device::Device;
use shared::frame::Framing;
use shared::proto::DdcShape;
use shared::sim::ddc100::{Trouble, UnitTrouble};
use std::collections::BTreeMap;
use std::fmt;
use std::sync::Arc;
use std::time::Duration;
use toml::Spanned;

/// Baud rates of the field units (LMAIM4019-00, table 3.1).
const BAUDS: [u32; 5] = [1200, 2400, 4800, 9600, 19_200];
/// Modes: eight data bits. The first is the only one that the guide knows; converters know others.
const MODES: [&str; 4] = ["8N1", "8E1", "8O1", "8N2"];
/// Registers that a unit has, as printed (LMAIM4019-00, table 3.5).
const REGISTERS: u16 = 56;
/// Registers that every poll reads: status and faults (LMAIM4019-00, section 3.2.3).
const LEAST: (u16, u16) = (9, 10);

/// What is special about a DDC-100 network.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DdcConfig {
    /// Its host ports.
    pub ports: DdcPorts,
    /// RTU or ASCII.
    pub framing: Framing,
    /// Bits a second.
    pub baud: u32,
    /// Data bits, parity and stop bits.
    pub mode: Mode,
    /// How the cable runs.
    pub shape: DdcShape,
    /// Address of the first register of each poll.
    pub start: u16,
    /// Registers of each poll.
    pub count: u16,
    /// Polls are repeated also where a fault is known already.
    pub retry_faulty: bool,
    /// How the analog values of units are scaled, where the tag list says it.
    pub scalings: BTreeMap<u8, Scaling>,
}

/// The host ports of a network.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum DdcPorts {
    /// Serial ports: host port 1, and host port 2 if there is one.
    Serial(String, Option<String>),
    /// The built-in network, with as many ports as its shape has ends, and what is wrong with it.
    Simulated(Vec<Fault>),
}

impl DdcConfig {
    /// Paths of the host ports; of simulated ones what stands in their place.
    #[must_use]
    pub fn paths(&self) -> Vec<&str> {
        const SIMULATED: &str = "built-in simulator";
        match (&self.ports, self.shape) {
            (DdcPorts::Serial(one, two), _) => {
                let two = two.as_deref();
                std::iter::once(one.as_str()).chain(two).collect()
            }
            (DdcPorts::Simulated(_), DdcShape::Loop) => vec![SIMULATED; 2],
            (DdcPorts::Simulated(_), _) => vec![SIMULATED],
        }
    }

    /// One of its ports as a serial line.
    #[must_use]
    pub fn serial(&self, path: &str) -> LineConfig {
        LineConfig::Serial {
            framing: self.framing,
            port: path.to_owned(),
            baud: self.baud,
            mode: self.mode,
        }
    }
}

impl fmt::Display for DdcConfig {
    /// `/dev/ttyUSB0, /dev/ttyUSB1 9600 8N1`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.ports {
            DdcPorts::Serial(one, None) => write!(f, "{one}")?,
            DdcPorts::Serial(one, Some(two)) => write!(f, "{one}, {two}")?,
            DdcPorts::Simulated(_) => f.write_str("built-in simulator")?,
        }
        write!(f, " {} {}", self.baud, self.mode)
    }
}

/// Checks a bus of kind `ddc100` or `ddc100-simulator`.
pub(super) fn bus(bus: &Spanned<raw::Bus>, simulated: bool) -> Result<BusConfig, Wrong> {
    let raw = bus.get_ref();
    let shape = shape(raw)?;
    let ports = if simulated {
        DdcPorts::Simulated(faults(raw)?)
    } else {
        ports(raw, shape)?
    };
    let framing = match &raw.framing {
        None => Framing::Rtu,
        Some(text) => match text.get_ref().as_str() {
            "rtu" => Framing::Rtu,
            "ascii" => Framing::Ascii,
            other => {
                let text_ = format!("`framing` is \"{other}\"; write \"rtu\" or \"ascii\"");
                return wrong(text, text_);
            }
        },
    };
    let baud = match &raw.baud {
        None => 9600,
        Some(baud) => match BAUDS.iter().find(|b| i64::from(**b) == *baud.get_ref()) {
            Some(known) => *known,
            None => {
                let list = BAUDS.map(|b| b.to_string()).join(", ");
                let text = format!(
                    "`baud` is {}; on a DDC-100 network it is one of {list}",
                    baud.get_ref()
                );
                return wrong(baud, text);
            }
        },
    };
    let text = raw.mode.as_ref().map_or("8N1", |m| m.get_ref().as_str());
    let mode = Mode::parse(text).filter(|m| MODES.contains(&m.to_string().as_str()));
    let mode = match (mode, &raw.mode) {
        (Some(mode), _) => mode,
        (None, Some(mode)) => {
            let list = MODES.join(", ");
            let text = format!(
                "`mode` is \"{text}\"; field units have 8N1, and nothing else than {list} is possible"
            );
            return wrong(mode, text);
        }
        (None, None) => return wrong(&raw.name, "the bus needs a `mode`"),
    };
    let (first, last) = registers(raw)?;
    let count = last - first + 1;
    let turn = number(raw.turn_ms.as_ref(), "turn_ms", 21..=49)?;
    let asked = number(raw.timeout_ms.as_ref(), "timeout_ms", 201..=60_000)?;
    let retries = number(raw.retries.as_ref(), "retries", 0..=3)?;
    Ok(BusConfig {
        name: raw.name.get_ref().clone(),
        timeout: time(asked, USUAL_TIMEOUT_US),
        retries: retries
            .and_then(|n| n.try_into().ok())
            .unwrap_or(USUAL_RETRIES),
        turnaround: time(turn, USUAL_TURN_US),
        line: LineConfig::Ddc(Arc::new(DdcConfig {
            ports,
            framing,
            baud,
            mode,
            shape,
            start: first - 1,
            count,
            retry_faulty: raw.retry_faulty.as_ref().is_some_and(|r| *r.get_ref()),
            scalings: BTreeMap::new(),
        })),
    })
}

/// Milliseconds that were asked for, or the usual microseconds.
fn time(asked: Option<u32>, usual_us: u64) -> Duration {
    asked.map_or(Duration::from_micros(usual_us), |ms| {
        Duration::from_millis(ms.into())
    })
}

fn shape(raw: &raw::Bus) -> Result<DdcShape, Wrong> {
    let Some(text) = &raw.shape else {
        return wrong(
            &raw.name,
            "the bus has no `shape`; write how the cable runs, as shape = \"loop\", \
             \"single-ended\" or \"multi-drop\"",
        );
    };
    match text.get_ref().as_str() {
        "loop" => Ok(DdcShape::Loop),
        "single-ended" => Ok(DdcShape::SingleEnded),
        "multi-drop" => Ok(DdcShape::MultiDrop),
        other => wrong(
            text,
            format!("`shape` is \"{other}\"; write \"loop\", \"single-ended\" or \"multi-drop\""),
        ),
    }
}

fn ports(raw: &raw::Bus, shape: DdcShape) -> Result<DdcPorts, Wrong> {
    let one = match &raw.port {
        Some(port) if !port.get_ref().is_empty() => port.get_ref().clone(),
        Some(port) => return wrong(port, "`port` is empty; write its path, as \"/dev/ttyUSB0\""),
        None => {
            return wrong(
                &raw.name,
                "the bus has no `port`; write the path of host port 1, as port = \"/dev/ttyUSB0\"",
            );
        }
    };
    let two = match &raw.port2 {
        Some(port) if shape != DdcShape::Loop => {
            return wrong(
                port,
                "only a \"loop\" comes back to a second host port; remove `port2`, or write \
                 shape = \"loop\"",
            );
        }
        Some(port) if port.get_ref().is_empty() => {
            return wrong(port, "`port2` is empty; write its path, or remove the line");
        }
        Some(port) if *port.get_ref() == one => {
            return wrong(
                port,
                "`port2` is the same as `port`; write the path of the port at the other end",
            );
        }
        Some(port) => Some(port.get_ref().clone()),
        // One port cannot go round: with it a loop is polled as if it were open at the far end.
        None if shape == DdcShape::Loop => {
            return wrong(
                &raw.name,
                "a \"loop\" needs `port2`, the host port at its other end; with one port the \
                 cable is polled as shape = \"single-ended\"",
            );
        }
        None => None,
    };
    Ok(DdcPorts::Serial(one, two))
}

/// Checks a network as a whole, when its units are known.
pub(super) fn network(bus: &BusConfig, raw: &raw::Bus, config: &Config) -> Result<(), Wrong> {
    let LineConfig::Ddc(ddc) = &bus.line else {
        return Ok(());
    };
    let units: Vec<DeviceConfig> = config.on(bus).cloned().collect();
    if units.is_empty() {
        let text = format!(
            "the network \"{}\" has no units; add a [[device]] for each, in the order of the cable \
             from host port 1, or a tag list as tags = \"units.csv\"",
            bus.name
        );
        return wrong(&raw.name, text);
    }
    let setup = crate::bus::ddc::setup(bus, ddc, &units);
    let problems = setup.as_ref().map(Setup::problems).unwrap_or_default();
    if let Some(problem) = problems.first() {
        return wrong(&raw.name, problem.to_string());
    }
    // There are repeaters, which nothing here knows of.
    if let Some(hint) = setup.as_ref().and_then(Setup::hint) {
        tracing::warn!("{}: {hint}", bus.name);
    }
    if let DdcPorts::Simulated(faults) = &ddc.ports
        && let Err(fault) = Network::new(ddc.shape, &units, faults, Clock::start())
        && let Some(text) = raw.faults.iter().flatten().find(|text| {
            let read: Result<Fault, _> = text.get_ref().parse();
            read.is_ok_and(|read| read == fault)
        })
    {
        let why = format!(
            "`faults`: \"{fault}\" can't be: the network has {} units, and no place or unit of \
             that number, or the unit is of a type that has no such thing",
            units.len()
        );
        return wrong(text, why);
    }
    Ok(())
}

/// What is wrong with a simulated network.
fn faults(raw: &raw::Bus) -> Result<Vec<Fault>, Wrong> {
    let faults = raw.faults.iter().flatten();
    let read = |text: &Spanned<String>| match text.get_ref().parse() {
        Ok(fault) => Ok(fault),
        Err(why) => wrong(text, format!("`faults`: {why}")),
    };
    faults.map(read).collect()
}

/// First and last register of a poll, as printed in the guide.
fn registers(raw: &raw::Bus) -> Result<(u16, u16), Wrong> {
    let Some(text) = &raw.registers else {
        return Ok(USUAL_REGISTERS);
    };
    let range = text.get_ref().split_once('-').and_then(|(first, last)| {
        let first: u16 = first.trim().parse().ok()?;
        let last: u16 = last.trim().parse().ok()?;
        (1 <= first && first <= last && last <= REGISTERS).then_some((first, last))
    });
    let Some((first, last)) = range else {
        let text_ = format!(
            "`registers` is \"{}\"; write the first and the last register of a poll as the guide \
             numbers them, 1 to {REGISTERS}, as \"8-16\"",
            text.get_ref()
        );
        return wrong(text, text_);
    };
    if first > LEAST.0 || last < LEAST.1 {
        let text_ = format!(
            "`registers` is \"{first}-{last}\"; every poll reads at least 9 (status) and 10 \
             (faults), and 8 with analog feedback"
        );
        return wrong(text, text_);
    }
    Ok((first, last))
}

/// The units of the built-in network, in the order of the cable.
pub(super) const SIMULATED: [(&str, Device, u8, &str); 12] = [
    ("MOV-401", Device::Ddc100Mx, 1, "Jetty 1, loading line"),
    ("MOV-402", Device::Ddc100Mx, 2, "Jetty 1, vapour return"),
    ("MOV-403", Device::Ddc100Uec, 3, "Jetty 1, fire water"),
    ("MOV-404", Device::Ddc100Uec, 4, "Jetty 2, loading line"),
    ("MOV-405", Device::Ddc100MxB, 5, "Jetty 2, vapour return"),
    ("MOV-406", Device::Ddc100Mx, 6, "Jetty 2, fire water"),
    (
        "IO-407",
        Device::Ddc100Io,
        7,
        "Jetty shelter, lamps and horn",
    ),
    ("MOV-408", Device::Ddc100Clamshell, 8, "Tank 4, inlet"),
    ("MOV-409", Device::Ddc100Clamshell, 9, "Tank 4, outlet"),
    ("MOV-410", Device::Ddc100Uec, 10, "Tank 5, inlet"),
    ("MOV-411", Device::Ddc100Mx, 11, "Tank 5, outlet"),
    ("MOV-412", Device::Ddc100Mx, 12, "Tank 5, drain"),
];

/// The built-in network: in each four minutes the cable breaks for one, and then a unit loses its
/// power for half of one.
pub(super) fn simulated() -> BusConfig {
    let fault = |trouble, from, to| Fault {
        trouble,
        span: Some(Span {
            from,
            to,
            every: 240,
        }),
    };
    let faults = vec![
        fault(Trouble::Break(5), 60, 120),
        fault(Trouble::Unit(9, UnitTrouble::Off), 180, 210),
    ];
    let (first, last) = USUAL_REGISTERS;
    BusConfig {
        name: "Simulated DDC-100 loop".into(),
        timeout: time(None, USUAL_TIMEOUT_US),
        retries: USUAL_RETRIES,
        turnaround: time(None, USUAL_TURN_US),
        line: LineConfig::Ddc(Arc::new(DdcConfig {
            ports: DdcPorts::Simulated(faults),
            framing: Framing::Rtu,
            baud: 9600,
            mode: Mode {
                data: 8,
                parity: Parity::None,
                stop: 1,
            },
            shape: DdcShape::Loop,
            start: first - 1,
            count: last - first + 1,
            retry_faulty: false,
            scalings: BTreeMap::new(),
        })),
    }
}
