//! How a unit is: what it says of itself, weighed together with what the host found.

use shared::capture::Micros;
use shared::ddc100::view::{Bit, Mode, Own, View};
use shared::device::Device;
use shared::map::row::Row;

use super::net::{Net, Reach, Unit};
use super::tags::Tags;
use crate::components::ne107::Sign;

/// How a unit is, the worst last.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Health {
    /// Nothing is wrong.
    Good,
    /// Not tried yet, or it never answered and nobody knows.
    Unknown,
    /// Somebody operates it locally.
    Local,
    /// One of two ports does not reach it.
    OnePort,
    /// A fault bit is set.
    Warning,
    /// The combined fault, or a fault that belongs to it.
    Fault,
    /// No port reaches it.
    Lost,
}

impl Health {
    /// Its sign, if it has one. That only one port reaches a unit is the cable's trouble, and is
    /// shown there.
    #[must_use]
    pub const fn sign(self) -> Option<Sign> {
        match self {
            Self::Good | Self::Unknown | Self::OnePort => None,
            Self::Local => Some(Sign::FunctionCheck),
            Self::Warning => Some(Sign::Warning),
            Self::Fault | Self::Lost => Some(Sign::Failure),
        }
    }
}

/// Bits that mean that the valve can't move, or that it is not known whether it does.
const GRAVE: [&str; 5] = [
    "combined_fault",
    "valve_jammed",
    "over_temperature_fault",
    "failing_to_de_energize",
    "phase_error",
];

/// Bits of the fault registers that report what happens rather than a fault.
pub const REPORTS: [&str; 3] = ["processor_reset", "opening_in_local", "closing_in_local"];

/// A unit with what it says, and how it is.
#[derive(Clone, Debug, PartialEq)]
pub struct Judged {
    /// What its registers say.
    pub view: View,
    /// How it is.
    pub health: Health,
    /// True once its status register was read.
    pub known: bool,
    /// True if it is not the network that operates the valve.
    pub local: bool,
}

/// True if the selector of a valve does not stand at REMOTE. An I/O module has none; its register
/// 12 holds inputs of the user.
fn is_local(device: Device, view: &View) -> bool {
    device != Device::Ddc100Io
        && matches!(
            view.mode,
            Mode::LocalOrStop | Mode::Stop | Mode::Contradictory
        )
}

impl Judged {
    /// Judges a unit of a network. Fault bits that were read a few passes before its newest answer
    /// do not count: the unit may have cleared them since.
    #[must_use]
    pub fn of(unit: &Unit, net: &Net, tags: &Tags) -> Self {
        let scaling = |row: &Row| tags.scaling(unit, row.address.get().saturating_add(1));
        let mut view = View::of(unit.device, &unit.image, scaling);
        if let Some(newest) = unit.newest() {
            view.set_aside(Micros::new(newest.saturating_sub(net.bits_last_us())));
        }
        let known = view.own.one != Own::Unknown;
        let reach = unit.reach(net.ports.len());
        let has = |is: fn(&Bit) -> bool| view.faults.iter().any(is);
        let health = match reach {
            Reach::Lost => Health::Lost,
            Reach::Unknown => Health::Unknown,
            _ if has(|b| GRAVE.contains(&b.member.key)) => Health::Fault,
            _ if has(|b| !REPORTS.contains(&b.member.key)) => Health::Warning,
            Reach::Only(_) => Health::OnePort,
            _ if is_local(unit.device, &view) => Health::Local,
            _ if !known => Health::Unknown,
            _ => Health::Good,
        };
        Self {
            local: known && is_local(unit.device, &view),
            view,
            health,
            known,
        }
    }

    /// All units of a network.
    #[must_use]
    pub fn all(net: &Net, tags: &Tags) -> Vec<Self> {
        let units = net.units.iter();
        units.map(|unit| Self::of(unit, net, tags)).collect()
    }

    /// Who operates the valve, if it is not the network; empty otherwise.
    #[must_use]
    pub fn local(&self) -> &'static str {
        if self.local {
            self.view.mode.label()
        } else {
            ""
        }
    }

    /// The fault bits in words, at most so many.
    #[must_use]
    pub fn fault_words(&self, most: usize) -> String {
        let faults = &self.view.faults;
        let names: Vec<&str> = faults.iter().take(most).map(|b| b.member.label).collect();
        match faults.len().saturating_sub(most) {
            0 => names.join(", "),
            rest => format!("{} and {rest} more", names.join(", ")),
        }
    }
}

/// Where a bit is, as the guide counts registers: `9.7`.
#[must_use]
pub fn place(bit: &Bit) -> String {
    let register = u32::from(bit.row.address.get()) + 1;
    format!("{register}.{}", bit.member.value)
}

/// The type of a unit, as short as a column wants it.
#[must_use]
pub fn kind(device: Device) -> &'static str {
    let label = device.label();
    label.strip_prefix("Limitorque DDC-100 ").unwrap_or(label)
}

#[cfg(test)]
mod tests {
    use super::super::net::tests::{network, poll};
    use super::*;
    use shared::proto::DdcShape;

    const GOOD: [Option<bool>; 2] = [Some(false), Some(false)];

    fn judged(kind: &str, fault: [Option<bool>; 2], words: &[u16]) -> Judged {
        let mut net = network(1, DdcShape::Loop, 2);
        net.units[0].device = Device::from_key(kind).unwrap();
        if !words.is_empty() {
            poll(&mut net, 1, fault, words);
        }
        net.units[0].fault = fault;
        Judged::of(&net.units[0], &net, &Tags::default())
    }

    /// Section 3.2.3 of the guide: position 61 %, status 0801: opened, channel B fault.
    #[test]
    fn an_open_valve_without_channel_b_is_good() {
        let words = [61, 0x0801, 0, 0, 1, 0, 0, 0, 0];
        let unit = judged("ddc100-uec", GOOD, &words);
        assert_eq!(unit.view.state, "Open");
        assert_eq!(unit.view.position.unwrap().to_string(), "61 %");
        assert!(unit.view.faults.is_empty() && unit.local().is_empty());
        assert_eq!(unit.health, Health::Good);
        let one = judged("ddc100-uec", [Some(false), Some(true)], &words);
        assert_eq!(one.health, Health::OnePort);
        let lost = judged("ddc100-uec", [Some(true), Some(true)], &words);
        assert_eq!(lost.health, Health::Lost);
    }

    #[test]
    fn faults_are_named_and_weighed() {
        // Combined fault, phase error; wrong rotation; user fault 2.
        let words = [50, 0x8084, 0x2000, 0, 1, 0, 0, 4, 0];
        let unit = judged("ddc100-uec", GOOD, &words);
        assert_eq!(unit.view.faults.len(), 4);
        assert_eq!(unit.health, Health::Fault);
        assert!(
            unit.fault_words(2).ends_with(" and 2 more"),
            "{}",
            unit.fault_words(2)
        );
        let places: Vec<_> = unit.view.faults.iter().map(place).collect();
        assert!(places.contains(&"9.7".to_owned()) && places.contains(&"15.2".to_owned()));
        // A torque switch is not in the combined fault (D8).
        let torque = [50, 0x1004, 0, 0, 1, 0, 0, 0, 0];
        assert_eq!(judged("ddc100-mx", GOOD, &torque).health, Health::Warning);
        // Local is somebody at work, not a fault.
        let local = [50, 0x0048, 0x4000, 0, 0, 0, 0, 0, 0];
        let unit = judged("ddc100-mx", GOOD, &local);
        assert_eq!(unit.health, Health::Local);
        assert_eq!(
            (unit.view.state.as_str(), unit.local()),
            ("Opening", "Local or stop")
        );
    }

    /// Registers 14 and 15 read once, then cleared at the unit; polls bring 8 to 13 only.
    #[test]
    fn bits_that_were_read_long_ago_are_no_faults() {
        let mut net = network(1, DdcShape::Loop, 2);
        poll(&mut net, 1, GOOD, &[50, 0x0804, 0, 0, 1, 0, 1, 4, 0]);
        let judged = |net: &Net| Judged::of(&net.units[0], net, &Tags::default());
        assert_eq!(judged(&net).health, Health::Warning);
        assert_eq!(judged(&net).view.faults.len(), 2);
        // All was read at 5 s. 15 s later it still counts, after that no longer.
        let later = |net: &mut Net, seconds: u64| {
            let at = Micros::new(seconds * 1_000_000);
            net.units[0]
                .image
                .absorb(&[3, 0, 8, 0, 1], &[3, 2, 0x08, 0x04], at);
        };
        later(&mut net, 20);
        assert_eq!(judged(&net).health, Health::Warning);
        later(&mut net, 21);
        assert_eq!(judged(&net).health, Health::Good);
        let view = judged(&net).view;
        assert_eq!((view.faults.len(), view.old_faults.len()), (0, 2));
        // With slow passes it counts for three of them.
        net.ports[0].pass = Some((10_000_000, 9_000_000));
        assert_eq!(judged(&net).health, Health::Warning);
    }

    #[test]
    fn what_was_not_read_is_not_good() {
        let unit = judged("ddc100-uec", GOOD, &[]);
        assert_eq!((unit.known, unit.health), (false, Health::Unknown));
        assert_eq!(unit.local(), "");
        let untried = judged("ddc100-uec", [None, None], &[]);
        assert_eq!(untried.health, Health::Unknown);
        let io = judged("ddc100-io", GOOD, &[7, 0x0800, 0, 0, 0, 0, 0, 0, 0]);
        assert_eq!((io.view.position, io.health), (None, Health::Good));
    }

    #[test]
    fn every_named_bit_is_in_a_map() {
        for key in GRAVE.iter().chain(&REPORTS) {
            let known = Device::ALL.into_iter().filter_map(Device::map).any(|map| {
                let sets = map.rows.iter().filter_map(|row| row.set);
                sets.filter(|s| s.name.starts_with("status_m") || s.name.starts_with("faults_m"))
                    .any(|s| s.members.iter().any(|m| m.key == *key))
            });
            assert!(known, "{key}");
        }
    }
}
