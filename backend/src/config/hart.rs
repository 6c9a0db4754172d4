//! A HART line: a modem on a serial port, a HART-IP gateway, or a simulated loop.

use super::check::{Wrong, host, number, wrong};
use super::{BusConfig, Config, DeviceConfig, LineConfig, raw};
use shared::device::{Device, Family};
use shared::frame::Framing;
use shared::hart::frame::PREAMBLE;
use shared::hart::link::{
    BATCHED_GAP, BAUD, LAST_POLLING, PATIENT_GAP, RETRIES, Setup, Target, Timing,
};
use std::fmt;
use std::sync::Arc;
use std::time::Duration;
use toml::Spanned;

/// The port of HART-IP.
pub const PORT: u16 = 5094;
/// How long a gateway may take to answer: it asks the device itself, and repeats.
const GATEWAY_TIMEOUT: Duration = Duration::from_secs(5);
/// Tries beyond the first, where a gateway repeats by itself.
const GATEWAY_RETRIES: u8 = 1;
/// From the carrier to the first bit, and from the last bit to the end of the carrier.
const LEAD: Duration = Duration::from_millis(5);
const TAIL: Duration = Duration::from_millis(5);
/// Bit rates: that of the standard, and faster ones for simulated lines.
const BAUDS: [u32; 8] = [1200, 2400, 4800, 9600, 19_200, 38_400, 57_600, 115_200];
/// Name and kind of the keys that say how a device is found.
const KEYS: &str = "poll = 0 to 63, address = ten hexadecimal digits, tag or long_tag";

/// What is special about a HART line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct HartConfig {
    /// Where it goes.
    pub way: HartWay,
    /// We are the primary master, else the secondary one.
    pub primary: bool,
    /// At least so many preambles in each request; `None` for what the device wants.
    pub preambles: Option<u8>,
    /// Longest silence within a frame, as the port delivers it; `None` for what is usual.
    pub gap: Option<Duration>,
    /// Of a simulated loop: some of its devices have something to report.
    pub faulty: bool,
}

/// Where a HART line goes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum HartWay {
    /// A modem on a serial port.
    Serial {
        /// Path of the port.
        port: String,
        /// Bits a second.
        baud: u32,
        /// How the carrier is switched.
        keying: Keying,
    },
    /// A gateway.
    Ip {
        /// Name or address with port.
        host: String,
        /// UDP instead of TCP.
        udp: bool,
    },
    /// The built-in loop: its devices are simulated.
    Simulated,
}

/// How the carrier of a modem is switched by RTS.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Keying {
    /// From the carrier to the first bit.
    pub lead: Duration,
    /// From the last bit to the end of the carrier.
    pub tail: Duration,
}

impl Default for Keying {
    fn default() -> Self {
        Self {
            lead: LEAD,
            tail: TAIL,
        }
    }
}

impl HartConfig {
    /// How frames are marked off.
    #[must_use]
    pub const fn framing(&self) -> Framing {
        match self.way {
            HartWay::Ip { .. } => Framing::HartIp,
            HartWay::Serial { .. } | HartWay::Simulated => Framing::Hart,
        }
    }

    /// The master that we are.
    #[must_use]
    pub fn setup(&self, retries: u8) -> Setup {
        let gap = self
            .gap
            .map(|gap| gap.as_micros().try_into().unwrap_or(u64::MAX));
        let baud = match &self.way {
            HartWay::Serial { baud, .. } => *baud,
            HartWay::Ip { .. } | HartWay::Simulated => BAUD,
        };
        // All of these ports are heard through an operating system.
        let timing = match gap {
            Some(gap) => Timing::new(baud, Some(gap)),
            None => Timing::new(baud, Some(BATCHED_GAP)).patient(PATIENT_GAP),
        };
        Setup {
            primary: self.primary,
            retries,
            timing,
        }
    }

    /// A line as it is if nothing else is said.
    #[must_use]
    pub const fn of(way: HartWay) -> Self {
        Self {
            way,
            primary: true,
            preambles: None,
            gap: None,
            faulty: false,
        }
    }

    /// The bus of such a line.
    #[must_use]
    pub fn bus(self, name: &str) -> BusConfig {
        let (timeout, retries) = match self.way {
            HartWay::Ip { .. } => (GATEWAY_TIMEOUT, GATEWAY_RETRIES),
            HartWay::Serial { .. } | HartWay::Simulated => (super::check::TIMEOUT, RETRIES),
        };
        BusConfig {
            name: name.to_owned(),
            line: LineConfig::Hart(Arc::new(self)),
            timeout,
            retries,
            turnaround: Duration::ZERO,
        }
    }
}

impl fmt::Display for HartConfig {
    /// `/dev/ttyUSB0 1200 8O1, primary master`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.way {
            HartWay::Serial { port, baud, .. } => write!(f, "{port} {baud} 8O1")?,
            HartWay::Ip { host, udp: false } => write!(f, "{host}, HART-IP")?,
            HartWay::Ip { host, udp: true } => write!(f, "{host}, HART-IP over UDP")?,
            HartWay::Simulated => f.write_str("built-in simulator")?,
        }
        f.write_str(if self.primary {
            ", primary master"
        } else {
            ", secondary master"
        })
    }
}

/// Checks a bus of kind `hart` or `hart-ip`.
pub(super) fn bus(bus: &Spanned<raw::Bus>, network: bool) -> Result<BusConfig, Wrong> {
    let raw = bus.get_ref();
    let way = if network {
        HartWay::Ip {
            host: host(bus, PORT)?,
            udp: transport(raw)?,
        }
    } else {
        serial(raw)?
    };
    let gap = number(raw.gap_ms.as_ref(), "gap_ms", 10..=500)?;
    let preambles = number(
        raw.preambles.as_ref(),
        "preambles",
        low(*PREAMBLE.start())..=low(*PREAMBLE.end()),
    )?;
    let timeout = number(raw.timeout_ms.as_ref(), "timeout_ms", 100..=60_000)?;
    let retries = number(raw.retries.as_ref(), "retries", 0..=10)?;
    let mut config = HartConfig {
        primary: master(raw)?,
        preambles: preambles.and_then(|n| n.try_into().ok()),
        gap: gap.map(|ms| Duration::from_millis(ms.into())),
        ..HartConfig::of(way)
    }
    .bus(raw.name.get_ref());
    if let Some(retries) = retries.and_then(|n| n.try_into().ok()) {
        config.retries = retries;
    }
    if let Some(ms) = timeout {
        config.timeout = Duration::from_millis(ms.into());
    }
    Ok(config)
}

fn low(count: usize) -> u32 {
    u32::try_from(count).unwrap_or(u32::MAX)
}

fn transport(raw: &raw::Bus) -> Result<bool, Wrong> {
    let Some(text) = &raw.transport else {
        return Ok(false);
    };
    match text.get_ref().as_str() {
        "tcp" => Ok(false),
        "udp" => Ok(true),
        other => wrong(
            text,
            format!("`transport` is \"{other}\"; write \"tcp\" or \"udp\""),
        ),
    }
}

fn master(raw: &raw::Bus) -> Result<bool, Wrong> {
    let Some(text) = &raw.master else {
        return Ok(true);
    };
    match text.get_ref().as_str() {
        "primary" => Ok(true),
        "secondary" => Ok(false),
        other => wrong(
            text,
            format!(
                "`master` is \"{other}\"; write \"primary\", or \"secondary\" beside a control system"
            ),
        ),
    }
}

fn serial(raw: &raw::Bus) -> Result<HartWay, Wrong> {
    let port = match &raw.port {
        Some(port) if !port.get_ref().is_empty() => port.get_ref().clone(),
        Some(port) => return wrong(port, "`port` is empty; write its path, as \"/dev/ttyUSB0\""),
        None => {
            return wrong(
                &raw.name,
                "the bus has no `port`; write the path of the modem, as port = \"/dev/ttyUSB0\"",
            );
        }
    };
    let baud = match &raw.baud {
        None => BAUD,
        Some(baud) => match BAUDS.iter().find(|b| i64::from(**b) == *baud.get_ref()) {
            Some(known) => *known,
            None => {
                let text = format!(
                    "`baud` is {}; a HART line has 1200, which is what it gets without this line",
                    baud.get_ref()
                );
                return wrong(baud, text);
            }
        },
    };
    if let Some(mode) = raw.mode.as_ref().filter(|m| m.get_ref() != "8O1") {
        let text = format!(
            "`mode` is \"{}\"; a HART line has 8O1, which is what it gets without this line",
            mode.get_ref()
        );
        return wrong(mode, text);
    }
    let ms = |value, key, usual| {
        let ms = number(value, key, 0..=200)?;
        Ok(ms.map_or(usual, |ms| Duration::from_millis(ms.into())))
    };
    Ok(HartWay::Serial {
        port,
        baud,
        keying: Keying {
            lead: ms(raw.rts_lead_ms.as_ref(), "rts_lead_ms", LEAD)?,
            tail: ms(raw.rts_tail_ms.as_ref(), "rts_tail_ms", TAIL)?,
        },
    })
}

/// How a HART device is found, from its keys; and its polling address, 0 where it has none.
pub(super) fn target(raw: &raw::Device, at: usize) -> Result<(u8, Target), Wrong> {
    let given = [
        raw.poll.as_ref().map(Spanned::span),
        raw.address.as_ref().map(Spanned::span),
        raw.hart_tag.as_ref().map(Spanned::span),
        raw.long_tag.as_ref().map(Spanned::span),
    ];
    let mut given = given.into_iter().flatten();
    let (first, second) = (given.next(), given.next());
    if let Some(second) = second {
        return Err(Wrong {
            at: second.start,
            text: format!("one way to find the device is enough; write only one of {KEYS}"),
        });
    }
    if first.is_none() {
        let text = format!("nothing says how the device is found; add one of {KEYS}");
        return Err(Wrong { at, text });
    }
    if let Some(poll) = &raw.poll {
        return match u8::try_from(*poll.get_ref()) {
            Ok(n) if n <= LAST_POLLING => Ok((n, Target::Polling(n))),
            _ => wrong(
                poll,
                format!("`poll` is {}; write 0 to {LAST_POLLING}", poll.get_ref()),
            ),
        };
    }
    if let Some(address) = &raw.address {
        return match Target::unique(address.get_ref()) {
            Some(target) => Ok((0, target)),
            None => wrong(
                address,
                format!(
                    "`address` is \"{}\"; write the ten hexadecimal digits of the long address, as \
                     \"AEDD012345\"",
                    address.get_ref()
                ),
            ),
        };
    }
    if let Some(tag) = &raw.hart_tag {
        return match Target::tag(tag.get_ref()) {
            Some(target) => Ok((0, target)),
            None => wrong(
                tag,
                format!(
                    "`hart_tag` is \"{}\"; a tag has 1 to 8 characters: capital letters, digits and \
                     signs up to \"_\"",
                    tag.get_ref()
                ),
            ),
        };
    }
    match &raw.long_tag {
        Some(tag) => match Target::long_tag(tag.get_ref()) {
            Some(target) => Ok((0, target)),
            None => wrong(
                tag,
                format!(
                    "`long_tag` is \"{}\"; it has 1 to 32 characters of ISO 8859-1",
                    tag.get_ref()
                ),
            ),
        },
        None => Ok((0, Target::Polling(0))),
    }
}

/// The kinds of device on a HART line.
pub(super) fn kinds() -> String {
    let list = Family::ALL.map(|f| format!("\"{}\"", f.key()));
    list.join(", ")
}

/// Checks that a HART device is on a line of its kind, and alone at its address.
pub(super) fn device(
    raw: &raw::Device,
    bus: usize,
    target: &Target,
    config: &Config,
) -> Result<(), Wrong> {
    if let Some(unit) = &raw.unit {
        return wrong(
            unit,
            "a HART device has no `unit`; write its polling address as `poll`",
        );
    }
    let (name, kind) = (raw.bus.get_ref(), raw.kind.get_ref());
    let line = config.buses.get(bus).map(|b| &b.line);
    let simulated = line == Some(&LineConfig::Simulator);
    if !simulated && line.is_none_or(|l| l.hart().is_none()) {
        let text = format!(
            "\"{name}\" is no HART line, and a \"{kind}\" speaks HART only; put it on a bus of kind \
             \"hart\", \"hart-ip\" or \"simulator\""
        );
        return wrong(&raw.bus, text);
    }
    let mut others = config.devices.iter().filter(|d| d.bus == bus);
    if let Some(other) = others.clone().find(|d| d.target.is_none()) {
        let text = format!(
            "\"{}\" on \"{name}\" speaks Modbus; put HART devices on a simulator of their own",
            other.tag
        );
        return wrong(&raw.bus, text);
    }
    if let Some(other) = others.find(|d| d.target.as_ref() == Some(target)) {
        let text = format!(
            "\"{}\" on bus \"{name}\" is found in the same way; two devices can't share an address",
            other.tag
        );
        return wrong(&raw.tag, text);
    }
    if simulated && !matches!(target, Target::Polling(_)) {
        let text = "a simulated device is found by its polling address; write poll = 0 to 63";
        return wrong(&raw.tag, text);
    }
    Ok(())
}

/// Refuses keys of HART devices on other devices, and other devices on a HART loop.
pub(super) fn none(raw: &raw::Device, bus: usize, config: &Config) -> Result<(), Wrong> {
    let mut others = config.devices.iter().filter(|d| d.bus == bus);
    if let Some(other) = others.find(|d| d.target.is_some()) {
        let (tag, name) = (&other.tag, raw.bus.get_ref());
        let line = config.buses.get(bus).map(|b| &b.line);
        if line == Some(&LineConfig::Simulator) {
            let text = format!(
                "\"{tag}\" on \"{name}\" speaks HART; put other devices on a simulator of their own"
            );
            return wrong(&raw.bus, text);
        }
    }
    let strays = [
        (raw.poll.as_ref().map(Spanned::span), "poll"),
        (raw.address.as_ref().map(Spanned::span), "address"),
        (raw.hart_tag.as_ref().map(Spanned::span), "hart_tag"),
        (raw.long_tag.as_ref().map(Spanned::span), "long_tag"),
    ];
    for (span, key) in strays {
        if let Some(span) = span {
            let kind = raw.kind.get_ref();
            return Err(Wrong {
                at: span.start,
                text: format!("a device of kind \"{kind}\" has no `{key}`; write its `unit`"),
            });
        }
    }
    Ok(())
}

/// A simulator whose devices are HART devices is a HART loop.
pub(super) fn loops(config: &mut Config) {
    for (at, bus) in config.buses.iter_mut().enumerate() {
        let mut own = config.devices.iter().filter(|d| d.bus == at);
        if bus.line == LineConfig::Simulator && own.any(|d| d.device.family().is_some()) {
            *bus = HartConfig::of(HartWay::Simulated).bus(&bus.name);
        }
    }
}

/// The simulated loop of the built-in plant.
pub(super) fn simulated_bus() -> BusConfig {
    HartConfig {
        faulty: true,
        ..HartConfig::of(HartWay::Simulated)
    }
    .bus("Simulated HART loop")
}

/// Its devices, on this bus: one of each family.
pub(super) fn simulated(bus: usize) -> [DeviceConfig; 5] {
    let device = |unit, tag: &str, family, description: &str| DeviceConfig {
        tag: tag.into(),
        device: Device::Rotork(family),
        bus,
        unit,
        description: description.into(),
        faults: Vec::new(),
        profile: None,
        target: Some(Target::Polling(unit)),
    };
    [
        device(
            0,
            "FV-401",
            Family::Iq,
            "Cooling water return, control valve",
        ),
        device(1, "FV-402", Family::Cva, "Reactor feed, control valve"),
        device(2, "FV-403", Family::Cma, "Steam to reboiler, control valve"),
        device(3, "FV-404", Family::Ck, "Wash water, control valve"),
        device(4, "FV-405", Family::Si, "Fuel gas, spring-return valve"),
    ]
}
