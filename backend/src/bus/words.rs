//! What happened on a line, in words: what, where, and what to do next.

use super::Fault;
use crate::config::hart::HartWay;
use crate::config::{BusConfig, LineConfig};
use shared::pdu::names;
use shared::proto::Outcome;
use std::io;
use std::time::Duration;

/// The outcome that a fault means.
pub const fn outcome(fault: &Fault) -> Outcome {
    match fault {
        Fault::Line(_) => Outcome::Down,
        Fault::Silence | Fault::Closed => Outcome::Silence,
        Fault::Noise(_) | Fault::Damaged(_) | Fault::Two => Outcome::Damaged,
    }
}

/// Why a read failed.
pub fn fault(fault: &Fault, bus: &BusConfig, unit: u8, tries: u8) -> String {
    let tries = if tries > 1 {
        format!(", {tries} tries")
    } else {
        String::new()
    };
    let ms = bus.timeout.as_millis();
    match fault {
        Fault::Silence => match &bus.line {
            LineConfig::Serial { baud, mode, .. } => format!(
                "no answer within {ms} ms{tries}; check that the device is powered, that its \
                 address is {unit}, and that it runs at {baud} {mode}"
            ),
            LineConfig::Tcp { host } | LineConfig::RtuOverTcp { host } => {
                format!("no answer within {ms} ms{tries}; check that {host} knows a unit {unit}")
            }
            LineConfig::Simulator | LineConfig::Ddc(_) | LineConfig::Hart(_) => {
                format!("no answer within {ms} ms{tries}")
            }
        },
        Fault::Closed => format!(
            "the other side closed the connection{tries}; check whether it takes another client"
        ),
        Fault::Noise(what) | Fault::Damaged(what) => match &bus.line {
            LineConfig::Serial { .. } => {
                format!("{what}{tries}; check baud rate and parity, wiring and termination")
            }
            _ => format!("{what}{tries}"),
        },
        Fault::Two => {
            format!("{fault}{tries}; give the device more time with `timeout_ms`, now {ms}")
        }
        Fault::Line(error) => error.to_string(),
    }
}

/// A good answer.
pub fn good(latency: Duration) -> String {
    format!("answered in {:.1} ms", latency.as_secs_f64() * 1000.0)
}

/// A refusal by the device.
pub fn exception(code: u8) -> String {
    match names::exception(code) {
        Some((name, meaning)) => {
            format!(
                "the device refused with exception {code:02}, {}: {meaning}",
                name.to_lowercase()
            )
        }
        None => {
            format!("the device refused with exception {code:02}, which the standard does not know")
        }
    }
}

/// Why a line is down.
pub fn down(line: &LineConfig, error: &io::Error) -> String {
    match line {
        LineConfig::Serial { port, .. } => serial(port, error),
        LineConfig::Tcp { host } | LineConfig::RtuOverTcp { host } => network(host, error),
        LineConfig::Hart(hart) => match &hart.way {
            HartWay::Serial { port, .. } => serial(port, error),
            HartWay::Ip { host, .. } => network(host, error),
            HartWay::Simulated => format!("the simulator ended: {error}"),
        },
        LineConfig::Simulator | LineConfig::Ddc(_) => format!("the simulator ended: {error}"),
    }
}

/// Why a serial port is not there.
pub(crate) fn serial(port: &str, error: &io::Error) -> String {
    use io::ErrorKind as K;
    let text = error.to_string();
    let busy = text.to_lowercase();
    match error.kind() {
        K::NotFound => format!("{port} is not there; plug the adapter in, or correct `port`"),
        K::PermissionDenied => format!(
            "no permission to open {port}; add yourself to its group (often `sudo usermod -aG \
             dialout $USER`) and log in again"
        ),
        K::ResourceBusy | K::WouldBlock => taken(port),
        _ if busy.contains("busy") || busy.contains("lock") => taken(port),
        K::UnexpectedEof => format!("{port} was closed; was the adapter unplugged?"),
        // ENXIO, ENODEV and EIO are how a port that was pulled out says so.
        _ if matches!(error.raw_os_error(), Some(5 | 6 | 19)) => {
            format!("{port} is gone; was the adapter unplugged? ({text})")
        }
        _ => format!("{port}: {text}"),
    }
}

fn taken(port: &str) -> String {
    format!("{port} is in use by another program; close that program")
}

fn network(host: &str, error: &io::Error) -> String {
    use io::ErrorKind as K;
    match error.kind() {
        K::ConnectionRefused => format!(
            "{host} refuses the connection; check the port and that the device takes another client"
        ),
        K::TimedOut => format!("{host} does not answer; check cable, address and firewall"),
        K::HostUnreachable | K::NetworkUnreachable => {
            format!("{host} can't be reached; check the network of this computer")
        }
        K::UnexpectedEof | K::ConnectionReset | K::BrokenPipe => {
            format!("{host} closed the connection")
        }
        _ => format!("{host}: {error}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lost_ports_say_what_to_do() {
        let say = |error: io::Error| serial("/dev/ttyUSB0", &error);
        assert!(say(io::ErrorKind::NotFound.into()).contains("plug the adapter in"));
        assert!(say(io::ErrorKind::PermissionDenied.into()).contains("dialout"));
        assert!(say(io::Error::from_raw_os_error(16)).contains("another program"));
        assert!(say(io::Error::from_raw_os_error(5)).contains("unplugged"));
        let lock = io::Error::other("Unable to acquire exclusive lock on serial port");
        assert!(say(lock).contains("another program"));
    }
}
