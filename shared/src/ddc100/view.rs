//! What the registers of a unit say together: status in words, faults, inputs, outputs, analog
//! values, timers, user faults.

use core::fmt;

use super::scaling::{Scaled, Scaling};
use super::words::{FAULTS, INPUTS_1, OUTPUTS, POSITION, STATUS, bit, register, was_clear};
use super::{HostPort, Pair, tables};
use crate::address::{Address, Table};
use crate::capture::Micros;
use crate::device::Device;
use crate::image::{Cell, Image};
use crate::map::row::{Kind, Member, Row};

/// One named bit of a register.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bit {
    /// The register that holds it.
    pub row: &'static Row,
    /// Its name.
    pub member: &'static Member,
    /// As transmitted.
    pub on: bool,
    /// When it was read.
    pub at: Micros,
    /// When its register last changed, if it ever did.
    pub changed: Option<Micros>,
}

impl Bit {
    /// True if what the bit stands for is the case. Some bits are inverted: their words say so.
    #[must_use]
    pub fn is_active(&self) -> bool {
        match self.member.states {
            Some((zero, "not active")) => zero == "active" && !self.on,
            _ => self.on,
        }
    }

    /// What its state means.
    #[must_use]
    pub const fn text(&self) -> &'static str {
        match (self.member.states, self.on) {
            (Some((zero, _)), false) => zero,
            (Some((_, one)), true) => one,
            (None, false) => "not active",
            (None, true) => "active",
        }
    }
}

/// One analog value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Analog {
    /// The register that holds it.
    pub row: &'static Row,
    /// As transmitted.
    pub raw: u16,
    /// What it means on the chosen scale; `None` for a value that has its own unit.
    pub scaled: Option<Scaled>,
    /// When it was read.
    pub at: Micros,
}

impl fmt::Display for Analog {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.scaled {
            Some(scaled) => scaled.fmt(f),
            None => write!(f, "{} {}", self.raw, self.row.unit),
        }
    }
}

/// Who may operate the valve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    /// Not known yet.
    Unknown,
    /// The selector stands at REMOTE.
    Remote,
    /// At LOCAL, or at STOP on a unit that reports both alike. So too if neither REMOTE nor LOCAL is
    /// reported by a type for which the guide does not say what that means.
    LocalOrStop,
    /// At STOP: neither REMOTE nor LOCAL, on an MX from before the second quarter of 1999.
    Stop,
    /// Not at LOCAL; the register that tells REMOTE was not read.
    NotLocal,
    /// Both are reported.
    Contradictory,
}

impl Mode {
    /// From bit 6 of register 9 (local) and bit 0 of register 12 (remote); section 6.2, item 2. What
    /// it means that neither is set is told for an MX only (reading D9).
    #[must_use]
    pub const fn of(kind: Device, local: Option<bool>, remote: Option<bool>) -> Self {
        match (local, remote) {
            (Some(true), Some(true)) => Self::Contradictory,
            (_, Some(true)) => Self::Remote,
            (Some(true), _) => Self::LocalOrStop,
            (Some(false), Some(false)) if tables::is_fast(kind) => Self::Stop,
            (Some(false), Some(false)) => Self::LocalOrStop,
            (Some(false), None) => Self::NotLocal,
            (None, Some(false)) => Self::LocalOrStop,
            (None, None) => Self::Unknown,
        }
    }

    /// In words.
    #[must_use]
    pub const fn label(self) -> &'static str {
        match self {
            Self::Unknown => "not read yet",
            Self::Remote => "Remote",
            Self::LocalOrStop => "Local or stop",
            Self::Stop => "Stop",
            Self::NotLocal => "Not local",
            Self::Contradictory => "Local and remote at once",
        }
    }
}

/// What a unit says about one of its own channels (bits 10 and 11 of register 9). That is another
/// thing than the host's faults: see [`FaultTable`](super::FaultTable).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Own {
    /// Not read yet.
    Unknown,
    /// No fault.
    Good,
    /// A fault.
    Fault,
    /// The bit was never seen clear: the optional channel B is not fitted (section 4.3.1), or it has
    /// a fault since before the first poll.
    NotFitted,
}

impl Own {
    /// In words.
    #[must_use]
    pub const fn label(self) -> &'static str {
        match self {
            Self::Unknown => "not read yet",
            Self::Good => "no fault",
            Self::Fault => "fault",
            Self::NotFitted => {
                "not fitted, or a fault: the bit is always set without the optional board"
            }
        }
    }
}

/// What the unit says about its channels. A channel B that was good once is there: later it has a
/// fault.
#[must_use]
pub fn own(kind: Device, image: &Image) -> Pair<Own> {
    let of = |port: HostPort, at| match bit(image, STATUS, at) {
        None => Own::Unknown,
        Some(false) => Own::Good,
        Some(true) if port == HostPort::Two && !tables::is_fast(kind) => {
            match was_clear(image, STATUS, at) {
                true => Own::Fault,
                false => Own::NotFitted,
            }
        }
        Some(true) => Own::Fault,
    };
    Pair {
        one: of(HostPort::One, 10),
        two: of(HostPort::Two, 11),
    }
}

/// Combined fault as the formula of table 3.5, note 3, has it, from register 9 as received: bit 5,
/// 8, 9 or 15, or 10 and 11 together (reading D8).
#[must_use]
pub const fn combined(register_9: u16) -> bool {
    const ANY: u16 = 1 << 5 | 1 << 8 | 1 << 9 | 1 << 15;
    const BOTH: u16 = 1 << 10 | 1 << 11;
    register_9 & ANY != 0 || register_9 & BOTH == BOTH
}

/// A unit, from its registers.
#[derive(Clone, Debug, PartialEq)]
pub struct View {
    /// What the valve does, in words.
    pub state: String,
    /// Who may operate it.
    pub mode: Mode,
    /// Register 8 of a valve; `None` on an I/O module or if it was not read.
    pub position: Option<Analog>,
    /// Faults that are active: of registers 9, 10, 14 and 15.
    pub faults: Vec<Bit>,
    /// Those that [`set_aside`](Self::set_aside) took out of them: active when their register was
    /// read, but that was too long ago.
    pub old_faults: Vec<Bit>,
    /// True if bit 7 of register 9 is not what the other bits make of it.
    pub combined_disputed: bool,
    /// All bits of register 9 and 16.
    pub status: Vec<Bit>,
    /// All bits of registers 12 and 13.
    pub inputs: Vec<Bit>,
    /// All bits of register 11 that are outputs.
    pub outputs: Vec<Bit>,
    /// Bits 8 to 15 of register 11 on the types that have their software version there (D14).
    pub software: Option<u8>,
    /// Analog values, by register.
    pub analog: Vec<Analog>,
    /// All bits of register 14.
    pub timers: Vec<Bit>,
    /// All bits of register 15.
    pub user_faults: Vec<Bit>,
    /// The unit's own view of its channels.
    pub own: Pair<Own>,
    /// When the oldest register of all this was read.
    pub at: Option<Micros>,
}

/// Bits of register 9 that are faults by themselves; channels and combined fault apart.
const STATUS_FAULTS: [&str; 8] = [
    "valve_jammed",
    "over_temperature_fault",
    "failing_to_de_energize",
    "open_torque_switch_fault",
    "close_torque_switch_fault",
    "operated_manually_fault",
    "phase_error",
    "combined_fault",
];

/// A register of a unit with its row.
fn row_of(kind: Device, number: u16) -> Option<&'static Row> {
    let address = Address::new(number.checked_sub(1)?);
    kind.map()?.row_at(Table::Holding, address)
}

/// All named bits of a register, if it was read.
fn bits(kind: Device, image: &Image, number: u16) -> Vec<Bit> {
    let Some((row, cell)) = row_of(kind, number).zip(register(image, number)) else {
        return Vec::new();
    };
    let members = row.set.filter(|s| s.bits).map_or(&[][..], |s| s.members);
    let bit = |member: &'static Member| Bit {
        row,
        member,
        on: cell.word.wrapping_shr(u32::from(member.value)) & 1 == 1,
        at: cell.at,
        changed: cell.changed,
    };
    members.iter().map(bit).collect()
}

impl View {
    /// Reads what is known of a unit. `scaling` says how each analog register is set.
    #[must_use]
    pub fn of(kind: Device, image: &Image, scaling: impl Fn(&Row) -> Scaling) -> Self {
        let analog = |number: u16| {
            let row = row_of(kind, number).filter(|r| r.kind != Kind::Reserved)?;
            let cell = register(image, number)?;
            let scaled = Scaling::applies_to(row).then(|| scaling(row).read(cell.word));
            Some(Analog {
                row,
                raw: cell.word,
                scaled,
                at: cell.at,
            })
        };
        let status = bits(kind, image, STATUS);
        let outputs = bits(kind, image, OUTPUTS);
        let (software, outputs): (Vec<Bit>, Vec<Bit>) = outputs
            .into_iter()
            .partition(|b| b.member.key.starts_with("software_bit"));
        let software = software.first().and_then(|_| {
            let [high, _] = register(image, OUTPUTS)?.word.to_be_bytes();
            Some(high)
        });
        let timers = bits(kind, image, 14);
        let user_faults = bits(kind, image, 15);
        let mut faults: Vec<Bit> = status
            .iter()
            .filter(|b| STATUS_FAULTS.contains(&b.member.key))
            .copied()
            .collect();
        faults.extend(bits(kind, image, FAULTS));
        // Bits 11 and 12 of register 14 repeat the channels; that of an absent one is no fault.
        let own = own(kind, image);
        faults.extend(timers.iter().filter(|b| match b.member.key {
            "channel_a_time_out" => own.one == Own::Fault,
            "channel_b_time_out" => own.two == Own::Fault,
            _ => true,
        }));
        faults.extend(user_faults.iter().copied());
        faults.retain(Bit::is_active);
        let word = register(image, STATUS).map(|c| c.word);
        let numbers = (3..=16).filter_map(|n| register(image, n));
        Self {
            state: state(kind, word),
            mode: Mode::of(kind, bit(image, STATUS, 6), bit(image, INPUTS_1, 0)),
            position: analog(POSITION).filter(|_| kind != Device::Ddc100Io),
            combined_disputed: kind != Device::Ddc100Io
                && word.is_some_and(|w| combined(w) != (w & 1 << 7 != 0)),
            faults,
            old_faults: Vec::new(),
            inputs: [12, 13]
                .into_iter()
                .flat_map(|n| bits(kind, image, n))
                .collect(),
            outputs,
            software,
            analog: (2..=8).filter_map(analog).collect(),
            timers,
            user_faults,
            own,
            at: numbers.map(|c: Cell| c.at).min(),
            status: status.into_iter().chain(bits(kind, image, 16)).collect(),
        }
    }

    /// Takes faults that were read before a moment out of the active ones: polls may leave their
    /// register out, and the unit may have cleared them since.
    pub fn set_aside(&mut self, before: Micros) {
        let faults = core::mem::take(&mut self.faults);
        let (old, fresh) = faults.into_iter().partition(|b: &Bit| b.at < before);
        (self.old_faults, self.faults) = (old, fresh);
    }
}

/// True if a type has named bits in a register, read or not. Those of the software version are
/// none.
#[must_use]
pub fn has_bits(kind: Device, number: u16) -> bool {
    let members = row_of(kind, number)
        .and_then(|row| row.set.filter(|s| s.bits))
        .map_or(&[][..], |s| s.members);
    members.iter().any(|m| !m.key.starts_with("software_bit"))
}

/// True if a type has its software version in register 11 (reading D14).
#[must_use]
pub fn has_software(kind: Device) -> bool {
    let set = row_of(kind, OUTPUTS).and_then(|row| row.set);
    set.is_some_and(|s| s.members.iter().any(|m| m.key.starts_with("software_bit")))
}

/// What the valve does, from register 9.
fn state(kind: Device, word: Option<u16>) -> String {
    let Some(word) = word else {
        return "Not read yet".to_owned();
    };
    if kind == Device::Ddc100Io {
        return "I/O module".to_owned();
    }
    let on = |bit: u32| word.wrapping_shr(bit) & 1 == 1;
    let jammed = if on(5) { ", valve jammed" } else { "" };
    let text = match (on(3), on(4), on(0), on(1)) {
        (true, true, ..) => "Opening and closing reported at once",
        (true, false, ..) => "Opening",
        (false, true, ..) => "Closing",
        (false, false, true, true) => "Open and closed reported at once",
        (false, false, true, false) => "Open",
        (false, false, false, true) => "Closed",
        (false, false, false, false) if on(2) => "Stopped between the ends",
        (false, false, false, false) => "No position reported",
    };
    format!("{text}{jammed}")
}

#[cfg(test)]
mod tests;
