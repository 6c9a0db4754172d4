//! What a unit says: its state in words, its faults, the position of its valve.
//!
//! The bits and their names are those of the map of the unit's type; here stands only which of them
//! are states, which are faults, and how grave.

use shared::address::{Address, Table};
use shared::device::Device;
use shared::image::Image;
use shared::map::row::{Member, Row};
use shared::value::Value;

use super::net::{Reach, Unit};
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

/// A bit that is set.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bit {
    /// The register.
    pub row: &'static Row,
    /// The bit.
    pub member: &'static Member,
}

impl Bit {
    /// The register as the guide counts, and the bit: `9.7`.
    #[must_use]
    pub fn place(self) -> String {
        let register = u32::from(self.row.address.get()) + 1;
        format!("{register}.{}", self.member.value)
    }
}

/// What a unit says.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Said {
    /// True once its status register was read.
    pub known: bool,
    /// What its valve does, in words; for a unit without a valve that it answers.
    pub state: String,
    /// True if the valve is not operated from the network.
    pub local: bool,
    /// Fault bits of registers 9, 10, 14 and 15, its channel bits left out.
    pub faults: Vec<Bit>,
    /// True if one of them stops the valve.
    pub grave: bool,
    /// Its own bits 10 and 11 of register 9: channel A and B fault.
    pub channels: [Option<bool>; 2],
    /// Register 8, as transmitted.
    pub position: Option<u16>,
}

/// Bits of register 9 that are states, and how they are said.
const STATES: [(&str, &str); 5] = [
    ("opening", "opening"),
    ("closing", "closing"),
    ("opened", "open"),
    ("closed", "closed"),
    ("stopped", "stopped"),
];

/// Bits that mean that the valve can't move, or that it is not known whether it does.
const GRAVE: [&str; 5] = [
    "combined_fault",
    "valve_jammed",
    "over_temperature_fault",
    "failing_to_de_energize",
    "phase_error",
];

/// Bits of the fault registers that report a state rather than a fault.
const REPORTS: [&str; 3] = ["processor_reset", "opening_in_local", "closing_in_local"];

/// Registers whose bits are faults, zero-based: 9, 10, 14, 15.
const FAULTS: [u16; 4] = [8, 9, 13, 14];

/// The bits of a register that are set; `None` if it was not read or has no bits on this type.
#[must_use]
pub fn bits(device: Device, image: &Image, register: u16) -> Option<Vec<Bit>> {
    let row = device
        .map()?
        .row_at(Table::Holding, Address::new(register))?;
    let Value::Flags { raw, set } = image.row(row)?.judged.value else {
        return None;
    };
    let on = |m: &&Member| raw.wrapping_shr(u32::from(m.value)) & 1 == 1;
    let members = set.members.iter().filter(on);
    Some(members.map(|member| Bit { row, member }).collect())
}

/// A register as transmitted.
#[must_use]
pub fn word(image: &Image, register: u16) -> Option<u16> {
    let cell = image.cell(Table::Holding, Address::new(register))?;
    Some(cell.word)
}

impl Said {
    /// Reads what is known of a unit.
    #[must_use]
    pub fn of(device: Device, image: &Image) -> Self {
        let Some(status) = bits(device, image, 8) else {
            return Self {
                state: "status not read".into(),
                ..Self::default()
            };
        };
        let has = |key: &str| status.iter().any(|b| b.member.key == key);
        let words: Vec<&str> = STATES
            .iter()
            .filter(|(key, _)| has(key))
            .map(|(_, words)| *words)
            .collect();
        let valve = device != Device::Ddc100Io;
        let state = match (words.is_empty(), valve) {
            (true, true) => "in mid-travel".to_owned(),
            (true, false) => "no valve".to_owned(),
            (false, _) => words.join(", "),
        };
        let mut faults = Vec::new();
        for register in FAULTS {
            faults.extend(bits(device, image, register).into_iter().flatten());
        }
        let is_fault = |bit: &Bit| {
            let key = bit.member.key;
            let said = STATES.iter().any(|(state, _)| *state == key);
            let channel = key.starts_with("channel_") && bit.row.address.get() == 8;
            !said && !channel && key != "local_mode" && !REPORTS.contains(&key)
        };
        faults.retain(is_fault);
        Self {
            known: true,
            state,
            local: has("local_mode"),
            grave: faults.iter().any(|b| GRAVE.contains(&b.member.key)),
            channels: [Some(has("channel_a_fault")), Some(has("channel_b_fault"))],
            position: word(image, 7).filter(|_| valve),
            faults,
        }
    }

    /// How the unit is, with what the host knows of it.
    #[must_use]
    pub fn health(&self, reach: Reach) -> Health {
        match reach {
            Reach::Lost => Health::Lost,
            Reach::Unknown => Health::Unknown,
            _ if self.grave => Health::Fault,
            _ if !self.faults.is_empty() => Health::Warning,
            Reach::Only(_) => Health::OnePort,
            _ if self.local => Health::Local,
            _ if !self.known => Health::Unknown,
            _ => Health::Good,
        }
    }

    /// The fault bits in words, at most so many.
    #[must_use]
    pub fn fault_words(&self, most: usize) -> String {
        let names: Vec<&str> = self
            .faults
            .iter()
            .take(most)
            .map(|b| b.member.label)
            .collect();
        let rest = self.faults.len().saturating_sub(most);
        if rest > 0 {
            format!("{} and {rest} more", names.join(", "))
        } else {
            names.join(", ")
        }
    }
}

/// The type of a unit, as short as a column wants it.
#[must_use]
pub fn kind(device: Device) -> &'static str {
    let label = device.label();
    label.strip_prefix("Limitorque DDC-100 ").unwrap_or(label)
}

/// What a unit says and how it is, of so many ports.
#[must_use]
pub fn judge(unit: &Unit, ports: usize) -> (Said, Health) {
    let said = Said::of(unit.device, &unit.image);
    let health = said.health(unit.reach(ports));
    (said, health)
}

#[cfg(test)]
mod tests {
    use super::*;
    use shared::capture::Micros;

    /// Registers 8 to 16.
    pub(crate) fn image(words: [u16; 9]) -> Image {
        let mut image = Image::new();
        let mut response = vec![3, 18];
        for word in words {
            response.extend(word.to_be_bytes());
        }
        image
            .absorb(&[3, 0, 7, 0, 9], &response, Micros::new(1))
            .unwrap();
        image
    }

    /// Section 3.2.3 of the guide: position 61 %, status 0801: opened, channel B fault.
    #[test]
    fn an_open_valve_without_channel_b_is_good() {
        let image = image([61, 0x0801, 0, 0, 0, 0, 0, 0, 0]);
        let said = Said::of(Device::Ddc100Uec, &image);
        assert_eq!(said.state, "open");
        assert_eq!(said.channels, [Some(false), Some(true)]);
        assert_eq!(said.position, Some(61));
        assert!(said.faults.is_empty() && !said.local);
        assert_eq!(said.health(Reach::Full), Health::Good);
        assert_eq!(said.health(Reach::Only(1)), Health::OnePort);
        assert_eq!(said.health(Reach::Lost), Health::Lost);
    }

    #[test]
    fn faults_are_named_and_weighed() {
        // Combined fault, phase error; wrong rotation; user fault 2.
        let image = image([50, 0x8084, 0x2000, 0, 0, 0, 0, 4, 0]);
        let said = Said::of(Device::Ddc100Uec, &image);
        let names: Vec<_> = said.faults.iter().map(|b| b.member.label).collect();
        assert_eq!(
            names,
            [
                "Combined fault",
                "Phase error",
                "Wrong rotation",
                "User fault 2"
            ]
        );
        assert_eq!(said.faults[0].place(), "9.7");
        assert_eq!(said.faults[3].place(), "15.2");
        assert_eq!(said.state, "stopped");
        assert_eq!(said.health(Reach::Full), Health::Fault);
        assert_eq!(
            said.fault_words(2),
            "Combined fault, Phase error and 2 more"
        );
        // A torque switch is not in the combined fault (D8).
        let image = self::image([50, 0x1004, 0, 0, 0, 0, 0, 0, 0]);
        let said = Said::of(Device::Ddc100Mx, &image);
        assert_eq!(said.health(Reach::Full), Health::Warning);
        // Local is somebody at work, not a fault.
        let image = self::image([50, 0x0048, 0x4000, 0, 0, 0, 0, 0, 0]);
        let said = Said::of(Device::Ddc100Mx, &image);
        assert_eq!(said.health(Reach::Full), Health::Local);
        assert_eq!(said.state, "opening");
    }

    #[test]
    fn what_was_not_read_is_not_good() {
        let said = Said::of(Device::Ddc100Uec, &Image::new());
        assert_eq!(said.state, "status not read");
        assert_eq!(said.channels, [None, None]);
        assert_eq!(said.health(Reach::Full), Health::Unknown);
        assert_eq!(said.health(Reach::Unknown), Health::Unknown);
        let io = Said::of(Device::Ddc100Io, &image([7, 0x0800, 0, 0, 0, 0, 0, 0, 0]));
        assert_eq!((io.state.as_str(), io.position), ("no valve", None));
    }

    #[test]
    fn every_named_bit_is_in_a_map() {
        for key in STATES
            .iter()
            .map(|(key, _)| key)
            .chain(&GRAVE)
            .chain(&REPORTS)
        {
            let known = Device::ALL.into_iter().filter_map(Device::map).any(|map| {
                let sets = map.rows.iter().filter_map(|row| row.set);
                sets.filter(|s| s.name.starts_with("status_m") || s.name.starts_with("faults_m"))
                    .any(|s| s.members.iter().any(|m| m.key == *key))
            });
            assert!(known, "{key}");
        }
    }
}
