//! What the scan time is worked out from.

use shared::ddc100::estimate::{Estimate, estimate};
use shared::ddc100::timing::Line;
use shared::device::Device;
use shared::frame::Framing;

use super::net::Net;

/// Speeds of a network (table 3.1).
pub const BAUDS: [u32; 5] = [1200, 2400, 4800, 9600, 19_200];

/// The types.
pub const KINDS: [Device; 5] = [
    Device::Ddc100Mx,
    Device::Ddc100MxB,
    Device::Ddc100Uec,
    Device::Ddc100Clamshell,
    Device::Ddc100Io,
];

/// What was entered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Scan {
    /// Type of the units.
    pub kind: Device,
    /// How many.
    pub units: u16,
    /// Registers that are read of each.
    pub registers: u16,
    /// Bits a second.
    pub baud: u32,
    /// RTU or ASCII.
    pub framing: Framing,
    /// From an answer to the next request, in milliseconds.
    pub turn_ms: u16,
}

impl Default for Scan {
    /// The example of section 4.3.
    fn default() -> Self {
        Self {
            kind: Device::Ddc100Mx,
            units: 20,
            registers: 5,
            baud: 9600,
            framing: Framing::Rtu,
            turn_ms: 21,
        }
    }
}

impl Scan {
    /// What a network on the line is like; the type that most of its units have.
    #[must_use]
    pub fn of(net: &Net) -> Self {
        let many = |kind: Device| net.units.iter().filter(|u| u.device == kind).count();
        let kind = KINDS.into_iter().max_by_key(|kind| many(*kind));
        Self {
            kind: kind.unwrap_or(Device::Ddc100Mx),
            units: u16::try_from(net.units.len()).unwrap_or(250),
            registers: net.count,
            baud: net.baud,
            framing: Framing::from_key(&net.framing).unwrap_or(Framing::Rtu),
            turn_ms: u16::try_from(net.turn_ms).unwrap_or(50),
        }
    }

    /// Takes an entry in; one that is none changes nothing.
    pub fn set(&mut self, key: &str, text: &str) {
        let number = text.trim().parse::<u32>().ok();
        let small = |low: u16, high: u16| {
            let number = number.and_then(|n| u16::try_from(n).ok());
            number.filter(|n| (low..=high).contains(n))
        };
        match key {
            "units" => self.units = small(1, 250).unwrap_or(self.units),
            "registers" => self.registers = small(1, 56).unwrap_or(self.registers),
            "turn" => self.turn_ms = small(0, 1000).unwrap_or(self.turn_ms),
            "baud" => self.baud = number.filter(|b| BAUDS.contains(b)).unwrap_or(self.baud),
            "framing" => self.framing = Framing::from_key(text).unwrap_or(self.framing),
            "kind" => self.kind = Device::from_key(text).unwrap_or(self.kind),
            _ => {}
        }
    }

    /// The estimate.
    #[must_use]
    pub fn estimate(&self) -> Option<Estimate> {
        let line = Line {
            framing: self.framing,
            baud: self.baud,
            ..Line::GUIDE
        };
        let turn_us = u64::from(self.turn_ms) * 1000;
        estimate(self.kind, self.units, self.registers, line, turn_us)
    }
}

#[cfg(test)]
mod tests {
    use super::super::net::tests::network;
    use super::*;
    use shared::proto::DdcShape;

    /// 20 MX/DDC with 5 registers: 20 times 50 ms, and the turn time (section 4.3).
    #[test]
    fn the_example_of_the_guide() {
        let estimate = Scan::default().estimate().unwrap();
        assert_eq!(estimate.bare_us, 1_000_000);
        assert_eq!(estimate.scan_us, 1_420_000);
        assert_eq!(estimate.printed.unwrap().text, ".98");
    }

    #[test]
    fn entries_that_are_none_change_nothing() {
        let mut scan = Scan::default();
        for (key, text) in [
            ("units", "0"),
            ("units", "x"),
            ("baud", "9601"),
            ("kind", "?"),
        ] {
            scan.set(key, text);
        }
        assert_eq!(scan, Scan::default());
        for (key, text) in [
            ("units", "250"),
            ("registers", "10"),
            ("kind", "ddc100-uec"),
            ("baud", "1200"),
            ("framing", "modbus-ascii"),
            ("turn", "30"),
        ] {
            scan.set(key, text);
        }
        assert_eq!((scan.units, scan.registers, scan.baud), (250, 10, 1200));
        assert_eq!(
            (scan.kind, scan.framing),
            (Device::Ddc100Uec, Framing::Ascii)
        );
        let of = Scan::of(&network(24, DdcShape::Loop, 2));
        assert_eq!(
            (of.kind, of.units, of.registers),
            (Device::Ddc100Uec, 24, 9)
        );
    }
}
