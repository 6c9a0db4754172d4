//! From what is written to what is meant.

use super::{
    BusConfig, Config, DeviceConfig, LISTEN, LineConfig, Mode, ddc, hart, profile, raw, tags,
};
use shared::device::{Device, Family};
use shared::frame::Framing;
use shared::sim::Fault;
use std::ops::RangeInclusive;
use std::path::Path;
use std::sync::Arc;
use std::time::Duration;
use toml::Spanned;

/// How long a device may take to begin its answer, if nothing else is said.
pub(super) const TIMEOUT: Duration = Duration::from_millis(500);
/// How often a read is repeated, if nothing else is said.
pub(super) const RETRIES: u8 = 2;

/// Baud rates: those of the ICON3000 (VCIOM-16345-EN, section 3) and two faster ones.
const BAUDS: [u32; 9] = [600, 1200, 2400, 4800, 9600, 19_200, 38_400, 57_600, 115_200];
/// Modes of RTU, which needs eight data bits.
const RTU_MODES: [&str; 4] = ["8E1", "8N1", "8O1", "8N2"];
/// Modes of ASCII.
const ASCII_MODES: [&str; 7] = ["7E1", "7O1", "7N2", "8E1", "8N1", "8O1", "8N2"];

/// A value that is refused.
pub(super) struct Wrong {
    /// Offset in the file.
    pub at: usize,
    /// What is wrong and what to do.
    pub text: String,
}

pub(super) fn wrong<T, V>(value: &Spanned<V>, text: impl Into<String>) -> Result<T, Wrong> {
    Err(Wrong {
        at: value.span().start,
        text: text.into(),
    })
}

/// Checks a whole file; `beside` is the directory in which it lies.
pub(super) fn check(file: raw::File, beside: &Path) -> Result<Config, Wrong> {
    let listen = match &file.server.listen {
        None => LISTEN,
        Some(text) => match text.get_ref().parse() {
            Ok(address) => address,
            Err(_) => {
                return wrong(
                    text,
                    format!(
                        "`listen` is \"{}\"; write an address with a port, as \"127.0.0.1:8080\"",
                        text.get_ref()
                    ),
                );
            }
        },
    };
    let hosts = file.server.hosts.into_iter().map(Spanned::into_inner);
    let mut config = Config {
        listen,
        hosts: hosts.map(|h| h.to_ascii_lowercase()).collect(),
        buses: Vec::new(),
        devices: Vec::new(),
    };
    for bus in &file.bus {
        let bus = self::bus(bus, &config)?;
        config.buses.push(bus);
    }
    for (at, bus) in file.bus.iter().enumerate() {
        if let Some(name) = &bus.get_ref().tags {
            let list = tags::read(name, beside, at, &config)?;
            config.devices.extend(list.units);
            if let Some(LineConfig::Ddc(ddc)) = config.buses.get_mut(at).map(|b| &mut b.line) {
                Arc::make_mut(ddc).scalings = list.scalings;
            }
        }
    }
    for device in file.device {
        let at = device.span().start;
        let device = self::device(device.into_inner(), at, &config, beside)?;
        config.devices.push(device);
    }
    hart::loops(&mut config);
    for (bus, raw) in config.buses.iter().zip(&file.bus) {
        ddc::network(bus, raw.get_ref(), &config)?;
    }
    Ok(config)
}

fn bus(bus: &Spanned<raw::Bus>, config: &Config) -> Result<BusConfig, Wrong> {
    let raw = bus.get_ref();
    let name = raw.name.get_ref();
    if name.trim().is_empty() {
        return wrong(&raw.name, "`name` is empty; give the bus a name");
    }
    if config.buses.iter().any(|b| b.name == *name) {
        let text = format!("there is a bus \"{name}\" already; names must differ");
        return wrong(&raw.name, text);
    }
    let kind = raw.kind.get_ref().as_str();
    let line = match kind {
        "rtu" => serial(bus, Framing::Rtu)?,
        "ascii" => serial(bus, Framing::Ascii)?,
        "tcp" => LineConfig::Tcp {
            host: host(bus, 502)?,
        },
        "rtu-over-tcp" => LineConfig::RtuOverTcp {
            host: host(bus, 4001)?,
        },
        "simulator" => LineConfig::Simulator,
        "ddc100" | "ddc100-simulator" => {
            strays(raw, kind)?;
            return ddc::bus(bus, kind == "ddc100-simulator");
        }
        "hart" | "hart-ip" => {
            strays(raw, kind)?;
            return hart::bus(bus, kind == "hart-ip");
        }
        other => {
            let text = format!(
                "`kind` is \"{other}\"; a bus is \"rtu\", \"ascii\", \"tcp\", \"rtu-over-tcp\", \
                 \"hart\", \"hart-ip\", \"ddc100\", \"ddc100-simulator\" or \"simulator\""
            );
            return wrong(&raw.kind, text);
        }
    };
    strays(raw, kind)?;
    let timeout = number(raw.timeout_ms.as_ref(), "timeout_ms", 20..=60_000)?;
    let retries = number(raw.retries.as_ref(), "retries", 0..=10)?;
    let turnaround = number(raw.turnaround_ms.as_ref(), "turnaround_ms", 0..=1_000)?;
    Ok(BusConfig {
        name: name.clone(),
        line,
        timeout: timeout.map_or(TIMEOUT, |ms| Duration::from_millis(ms.into())),
        retries: retries.and_then(|n| n.try_into().ok()).unwrap_or(RETRIES),
        turnaround: Duration::from_millis(turnaround.unwrap_or(0).into()),
    })
}

/// A key of another kind is a mistake, not a default.
fn strays(raw: &raw::Bus, kind: &str) -> Result<(), Wrong> {
    let serial = matches!(kind, "rtu" | "ascii");
    let network = matches!(kind, "tcp" | "rtu-over-tcp");
    let ddc = matches!(kind, "ddc100" | "ddc100-simulator");
    let (modem, gateway) = (kind == "hart", kind == "hart-ip");
    let hart = modem || gateway;
    let strays = [
        (
            raw.port.as_ref(),
            serial || modem || kind == "ddc100",
            "port",
        ),
        (raw.port2.as_ref(), kind == "ddc100", "port2"),
        (raw.mode.as_ref(), serial || ddc || modem, "mode"),
        (raw.host.as_ref(), network || gateway, "host"),
        (raw.master.as_ref(), hart, "master"),
        (raw.transport.as_ref(), gateway, "transport"),
        (raw.shape.as_ref(), ddc, "shape"),
        (raw.framing.as_ref(), ddc, "framing"),
        (raw.registers.as_ref(), ddc, "registers"),
        (raw.tags.as_ref(), ddc, "tags"),
        (
            raw.faults.as_ref().and_then(|f| f.first()),
            kind == "ddc100-simulator",
            "faults",
        ),
    ];
    let strays = strays.map(|(value, belongs, key)| (value.map(Spanned::span), belongs, key));
    let numbers = [
        (raw.baud.as_ref(), serial || ddc || modem, "baud"),
        (raw.preambles.as_ref(), modem, "preambles"),
        (raw.gap_ms.as_ref(), modem, "gap_ms"),
        (raw.rts_lead_ms.as_ref(), modem, "rts_lead_ms"),
        (raw.rts_tail_ms.as_ref(), modem, "rts_tail_ms"),
        (raw.turn_ms.as_ref(), ddc, "turn_ms"),
        (raw.turnaround_ms.as_ref(), !ddc && !hart, "turnaround_ms"),
    ];
    let numbers = numbers.map(|(value, belongs, key)| (value.map(Spanned::span), belongs, key));
    let flags = [(
        raw.retry_faulty.as_ref().map(Spanned::span),
        ddc,
        "retry_faulty",
    )];
    for (span, belongs, key) in strays.into_iter().chain(numbers).chain(flags) {
        if let (Some(span), false) = (span, belongs) {
            let instead = if key == "turnaround_ms" && ddc {
                "write `turn_ms`"
            } else {
                "remove the line"
            };
            return Err(Wrong {
                at: span.start,
                text: format!("a bus of kind \"{kind}\" has no `{key}`; {instead}"),
            });
        }
    }
    Ok(())
}

/// An integer within its range, if it is there.
pub(super) fn number(
    value: Option<&Spanned<i64>>,
    key: &str,
    range: RangeInclusive<u32>,
) -> Result<Option<u32>, Wrong> {
    let Some(value) = value else { return Ok(None) };
    match u32::try_from(*value.get_ref()) {
        Ok(n) if range.contains(&n) => Ok(Some(n)),
        _ => {
            let (min, max) = (range.start(), range.end());
            let text = format!("`{key}` is {}; write {min} to {max}", value.get_ref());
            wrong(value, text)
        }
    }
}

fn serial(bus: &Spanned<raw::Bus>, framing: Framing) -> Result<LineConfig, Wrong> {
    let raw = bus.get_ref();
    let port = match &raw.port {
        Some(port) if !port.get_ref().is_empty() => port.get_ref().clone(),
        Some(port) => return wrong(port, "`port` is empty; write its path, as \"/dev/ttyUSB0\""),
        None => {
            return wrong(
                &raw.name,
                "the bus has no `port`; write its path, as port = \"/dev/ttyUSB0\"",
            );
        }
    };
    let baud = match &raw.baud {
        None => 9600,
        Some(baud) => match BAUDS.iter().find(|b| i64::from(**b) == *baud.get_ref()) {
            Some(known) => *known,
            None => {
                let list = BAUDS.map(|b| b.to_string()).join(", ");
                let text = format!("`baud` is {}; write one of {list}", baud.get_ref());
                return wrong(baud, text);
            }
        },
    };
    let (modes, usual) = match framing {
        Framing::Ascii => (&ASCII_MODES[..], "7E1"),
        _ => (&RTU_MODES[..], "8E1"),
    };
    let text = raw.mode.as_ref().map_or(usual, |m| m.get_ref().as_str());
    let mode = Mode::parse(text).filter(|m| modes.contains(&m.to_string().as_str()));
    match (mode, &raw.mode) {
        (Some(mode), _) => Ok(LineConfig::Serial {
            framing,
            port,
            baud,
            mode,
        }),
        (None, Some(mode)) => {
            let list = modes.join(", ");
            wrong(mode, format!("`mode` is \"{text}\"; write one of {list}"))
        }
        (None, None) => wrong(&raw.name, "the bus needs a `mode`"),
    }
}

/// A name or address; without a port it gets the usual one.
pub(super) fn host(bus: &Spanned<raw::Bus>, usual: u16) -> Result<String, Wrong> {
    let raw = bus.get_ref();
    let Some(host) = &raw.host else {
        let text = format!("the bus has no `host`; write it as host = \"10.0.0.5:{usual}\"");
        return wrong(&raw.name, text);
    };
    let text = host.get_ref().trim();
    // `[fe80::1]:502` has its port behind the bracket, `10.0.0.5:502` behind its only colon.
    let port = match text.rsplit_once(':') {
        Some((before, port)) if before.ends_with(']') || !before.contains(':') => Some(port),
        _ => None,
    };
    let good = match port {
        _ if text.is_empty() || text.contains(char::is_whitespace) || text.contains('/') => None,
        None if text.contains(':') && !text.starts_with('[') => Some(format!("[{text}]:{usual}")),
        None => Some(format!("{text}:{usual}")),
        Some(port) => port
            .parse::<u16>()
            .ok()
            .filter(|p| *p > 0 && !text.starts_with(':'))
            .map(|_| text.to_owned()),
    };
    match good {
        Some(good) => Ok(good),
        None => {
            let text = format!(
                "`host` is \"{text}\"; write a name or address and a port, as \"10.0.0.5:{usual}\""
            );
            wrong(host, text)
        }
    }
}

/// A device whose section begins at this offset.
fn device(
    raw: raw::Device,
    at: usize,
    config: &Config,
    beside: &Path,
) -> Result<DeviceConfig, Wrong> {
    let tag = raw.tag.get_ref();
    if tag.trim().is_empty() {
        return wrong(&raw.tag, "`tag` is empty; give the device a tag");
    }
    if config.devices.iter().any(|d| d.tag == *tag) {
        let text = format!("there is a device \"{tag}\" already; tags must differ");
        return wrong(&raw.tag, text);
    }
    let Some(device) = Device::from_key(raw.kind.get_ref()) else {
        let hart = Family::ALL.into_iter().map(Device::Rotork);
        let kinds = Device::ALL.into_iter().chain(hart);
        let list: Vec<String> = kinds.map(|d| format!("\"{}\"", d.key())).collect();
        let list = list.join(", ");
        let text = format!("`kind` is \"{}\"; write one of {list}", raw.kind.get_ref());
        return wrong(&raw.kind, text);
    };
    let name = raw.bus.get_ref();
    let Some(bus) = config.buses.iter().position(|b| b.name == *name) else {
        let text = if config.buses.is_empty() {
            "there is no bus; add a [[bus]] before the devices".to_owned()
        } else {
            let names: Vec<String> = config
                .buses
                .iter()
                .map(|b| format!("\"{}\"", b.name))
                .collect();
            format!("there is no bus \"{name}\"; write {}", names.join(" or "))
        };
        return wrong(&raw.bus, text);
    };
    let (unit, target) = match device.family() {
        Some(_) => {
            let (unit, target) = hart::target(&raw, at)?;
            hart::device(&raw, bus, &target, config)?;
            (unit, Some(target))
        }
        None => {
            hart::none(&raw, bus, config)?;
            (modbus_unit(&raw, at, device, bus, config)?, None)
        }
    };
    let line = config.buses.get(bus).map(|b| &b.line);
    let simulated = line == Some(&LineConfig::Simulator);
    if simulated && !(device.is_icon() || device.is_dop() || target.is_some()) {
        let mut text =
            "the simulator can be an \"icon3000v2\", \"icon3000\" or \"icon2000v4\", a \"dop\", or a \"rotork-…\" only".to_owned();
        if device.is_ddc() {
            text += "; for field units write a bus of kind = \"ddc100-simulator\"";
        }
        return wrong(&raw.kind, text);
    }
    if line.is_some_and(|l| l.hart().is_some()) && target.is_none() {
        let text = format!(
            "`kind` is \"{}\"; on the HART line \"{name}\" it is one of {}",
            device.key(),
            hart::kinds()
        );
        return wrong(&raw.kind, text);
    }
    if line.is_some_and(|l| l.ddc().is_some()) && !device.is_ddc() {
        let kinds = Device::ALL.iter().filter(|d| d.is_ddc());
        let list: Vec<String> = kinds.map(|d| format!("\"{}\"", d.key())).collect();
        let text = format!(
            "`kind` is \"{}\"; on the DDC-100 network \"{name}\" it is one of {}",
            device.key(),
            list.join(", ")
        );
        return wrong(&raw.kind, text);
    }
    let profile = match &raw.profile {
        Some(path) if !device.is_dop() => {
            let kind = device.key();
            let text = format!("a device of kind \"{kind}\" has no `profile`; remove the line");
            return wrong(path, text);
        }
        Some(path) => Some(Arc::new(profile::read(path, beside)?)),
        None if device.is_dop() && simulated => Some(crate::sim::dop_profile()),
        // Nothing can be read then, and the page says what is missing.
        None if device.is_dop() => Some(Arc::default()),
        None => None,
    };
    let faults = faults(&raw, device, simulated)?;
    Ok(DeviceConfig {
        tag: tag.clone(),
        device,
        bus,
        unit,
        description: raw.description.map(Spanned::into_inner).unwrap_or_default(),
        profile,
        target,
        faults,
    })
}

/// What is wrong with a simulated ICON.
fn faults(raw: &raw::Device, device: Device, simulated: bool) -> Result<Vec<Fault>, Wrong> {
    let mut faults = Vec::new();
    for key in raw.faults.iter().flatten() {
        if !(simulated && device.is_icon()) {
            let text = "`faults` is for a simulated icon3000v2, icon3000 or icon2000v4; remove it";
            return wrong(key, text.to_owned());
        }
        let Some(fault) = Fault::from_key(key.get_ref()) else {
            let keys = Fault::ALL.map(Fault::key).join(", ");
            let text = format!("`faults`: \"{}\" is none of {keys}", key.get_ref());
            return wrong(key, text);
        };
        if fault.is_of_tests() && device == Device::Icon2000v4 {
            let text = format!(
                "`faults`: \"{}\" shows in stroke tests, and an icon2000v4 has none; remove it",
                fault.key()
            );
            return wrong(key, text);
        }
        faults.push(fault);
    }
    Ok(faults)
}

/// The unit address of a device on a Modbus line.
fn modbus_unit(
    raw: &raw::Device,
    at: usize,
    device: Device,
    bus: usize,
    config: &Config,
) -> Result<u8, Wrong> {
    let last = device.last_unit();
    let Some(given) = &raw.unit else {
        let text = format!("the device has no `unit`; add it with its address, 1 to {last}");
        return Err(Wrong { at, text });
    };
    let unit = match u8::try_from(*given.get_ref()) {
        Ok(unit) if (1..=last).contains(&unit) => unit,
        Ok(0) => {
            let text =
                format!("`unit` is 0, which speaks to all devices at once; write 1 to {last}");
            return wrong(given, text);
        }
        _ => {
            let text = format!("`unit` is {}; write 1 to {last}", given.get_ref());
            return wrong(given, text);
        }
    };
    let name = raw.bus.get_ref();
    if let Some(other) = config
        .devices
        .iter()
        .find(|d| d.bus == bus && d.unit == unit)
    {
        let text = format!(
            "unit {unit} on bus \"{name}\" is \"{}\" already; two devices can't share an address",
            other.tag
        );
        return wrong(given, text);
    }
    Ok(unit)
}
