//! What the scan time is worked out from.

use shared::address::{Address, Table};
use shared::ddc100::estimate::{self, Estimate, estimate};
use shared::ddc100::setup::{Member, Setup};
use shared::ddc100::tables::{is_fast, nearest, printed};
use shared::ddc100::timing::Line;
use shared::device::Device;
use shared::encode::Read;
use shared::frame::Framing;
use shared::proto::DdcShape;

use super::net::Net;
use super::unit::kind;

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
    /// Type of the units; `None` for those of the network that is shown, whatever they are.
    pub kind: Option<Device>,
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
            kind: Some(Device::Ddc100Mx),
            units: 20,
            registers: 5,
            baud: 9600,
            framing: Framing::Rtu,
            turn_ms: 21,
        }
    }
}

impl Scan {
    /// What a network on the line is like.
    #[must_use]
    pub fn of(net: &Net) -> Self {
        let first = net.units.first().map(|u| u.device);
        let same = net.units.iter().all(|u| Some(u.device) == first);
        Self {
            kind: first.filter(|_| same),
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
            "kind" => self.kind = Device::from_key(text).or(self.kind),
            _ => {}
        }
    }

    fn line(&self) -> Line {
        Line {
            framing: self.framing,
            baud: self.baud,
            ..Line::GUIDE
        }
    }

    /// The estimate for units of one type; `None` if so many registers can't be read at once.
    #[must_use]
    pub fn estimate(&self) -> Option<Estimate> {
        let turn_us = u64::from(self.turn_ms) * 1000;
        estimate(self.kind?, self.units, self.registers, self.line(), turn_us)
    }

    /// The estimate for the units of a network as they are, each by its type.
    #[must_use]
    pub fn mixed(&self, net: &Net) -> Option<Mixed> {
        let member = |u: &super::net::Unit| Member {
            unit: u.info.unit,
            kind: u.device,
        };
        let setup = Setup {
            shape: net.shape.unwrap_or(DdcShape::Loop),
            second: net.ports.len() > 1,
            units: net.units.iter().map(member).collect(),
            read: Read::new(Table::Holding, Address::new(0), self.registers)?,
            line: self.line(),
            retries: 0,
            retry_faulty: false,
            turn_us: u64::from(self.turn_ms) * 1000,
            timeout_us: 0,
        };
        let turns = setup.turn_us.saturating_mul(net.units.len() as u64);
        // The estimate for one type has a turn time after the last unit too.
        let scan_us = estimate::pass(&setup).saturating_add(setup.turn_us);
        Some(Mixed {
            scan_us,
            bare_us: scan_us.saturating_sub(turns),
            least_us: estimate::least(&setup),
        })
    }
}

/// The estimate for a network of several types.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Mixed {
    /// The whole scan, with a turn time after each unit.
    pub scan_us: u64,
    /// The same without turn time.
    pub bare_us: u64,
    /// The least that the line allows: characters and silences only.
    pub least_us: u64,
}

/// The types of a network and how many of each: `18 UEC-3-DDC, 6 MX-DDC`.
#[must_use]
pub fn types(net: &Net) -> String {
    let many = |of: Device| net.units.iter().filter(|u| u.device == of).count();
    let all = KINDS.into_iter().map(|of| (many(of), kind(of)));
    let words: Vec<String> = all
        .filter(|(many, _)| *many > 0)
        .map(|(many, name)| format!("{many} {name}"))
        .collect();
    words.join(", ")
}

/// The cell of table 4.2 for a network, in words; the nearest one if it has none for it.
#[must_use]
pub fn table_4_2(net: &Net) -> String {
    let scan = Scan::of(net);
    let guide = scan.line() == Line::GUIDE;
    if let Some(kind) = scan.kind.filter(|_| guide)
        && let Some(cell) = printed(kind, scan.units, scan.registers)
    {
        return format!("{} s, without turn time", cell.text);
    }
    let Some(cell) = nearest(scan.units, scan.registers) else {
        return "no cell for so many registers".to_owned();
    };
    let fast = net.units.iter().any(|u| is_fast(u.device));
    let slow = net.units.iter().any(|u| !is_fast(u.device));
    let time = match (fast, slow) {
        (true, true) => format!(
            "{} s (MX-DDC), {} s (UEC-3-DDC)",
            cell.mx.text, cell.uec.text
        ),
        (true, false) => format!("{} s", cell.mx.text),
        _ => format!("{} s", cell.uec.text),
    };
    format!(
        "none for this; {} units with {} registers {time}{}",
        cell.units,
        cell.registers,
        if guide { "" } else { ", at RTU and 9600 baud" }
    )
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
            (Some(Device::Ddc100Uec), Framing::Ascii)
        );
        let of = Scan::of(&network(24, DdcShape::Loop, 2));
        assert_eq!(
            (of.kind, of.units, of.registers),
            (Some(Device::Ddc100Uec), 24, 9)
        );
    }

    /// Table 4.1: 5 registers take 50 ms on an MX/DDC and 109 ms on a UEC-3-DDC; 4 and 6 of them
    /// with 30 ms turn time are 4 × 80 + 6 × 139 ms.
    #[test]
    fn a_mixed_network_is_summed_up_by_type() {
        let mut net = network(10, DdcShape::Loop, 2);
        net.count = 5;
        for unit in net.units.iter_mut().take(4) {
            unit.device = Device::Ddc100Mx;
        }
        let scan = Scan::of(&net);
        assert_eq!((scan.kind, scan.estimate()), (None, None));
        let mixed = scan.mixed(&net).unwrap();
        assert_eq!(mixed.scan_us, 4 * 80_000 + 6 * 139_000);
        assert_eq!(mixed.bare_us, 4 * 50_000 + 6 * 109_000);
        assert!(mixed.least_us < mixed.bare_us);
        assert_eq!(types(&net), "4 MX, 6 UEC-3");
        assert_eq!(
            table_4_2(&net),
            "none for this; 10 units with 5 registers .50 s (MX-DDC), 1.4 s (UEC-3-DDC)"
        );
    }

    /// Table 4.2: 10 UEC-3-DDC with 5 registers 1.4 s; 24 with 9 have no cell, 40 with 10 have 7.6 s.
    #[test]
    fn the_cell_of_table_4_2() {
        let mut net = network(10, DdcShape::Loop, 2);
        net.count = 5;
        assert_eq!(table_4_2(&net), "1.4 s, without turn time");
        net.baud = 19_200;
        assert_eq!(
            table_4_2(&net),
            "none for this; 10 units with 5 registers 1.4 s, at RTU and 9600 baud"
        );
        let net = network(24, DdcShape::Loop, 2);
        assert_eq!(
            table_4_2(&net),
            "none for this; 40 units with 10 registers 7.6 s"
        );
    }
}
