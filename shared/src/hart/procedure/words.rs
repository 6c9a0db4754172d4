//! Steps in words: what a request asks, and what an answer means.

use super::Procedure;
use crate::hart::command;

/// What a command does in a procedure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Act {
    /// Looks for a device.
    Find,
    /// Reads what a device says about itself.
    About,
    /// Fixes the loop current at so many mA.
    Fix(f32),
    /// Ends the fixed current.
    Free,
    /// Trims the end point for so many mA to the measured current.
    Trim(f32, f32),
    /// Reads entries of the map: first and count.
    ReadMap(u8, u8),
    /// Writes entries of the map.
    WriteMap(u8, u8),
    /// No category for any bit.
    ResetMap,
    /// Switches status simulation.
    Simulate(bool),
    /// Simulates a bit.
    SimulateBit(u8, bool),
    /// Forces a variable to a value.
    Force(u8, f32),
    /// Gives a variable back.
    Release(u8),
    /// Controls the valve by this ACTCON register.
    Control(u8),
    /// Gives the valve back to the signal.
    Analog,
    /// Writes the additional status back.
    WriteStatus,
    /// Resets the device.
    Reset,
}

fn float(data: &[u8], at: usize) -> Option<f32> {
    let bytes = data.get(at..)?.first_chunk::<4>()?;
    Some(f32::from_be_bytes(*bytes))
}

impl Act {
    /// What a request with these data does; `None` if it is no part of a procedure.
    pub fn of(number: u16, data: &[u8]) -> Option<Self> {
        Some(match (number, data) {
            (0 | 11 | 21, _) => Self::Find,
            (7 | 8 | 12..=16 | 20 | 128 | 131, _) => Self::About,
            (40, _) => match float(data, 0)? {
                0.0 => Self::Free,
                current => Self::Fix(current),
            },
            (42, _) => Self::Reset,
            (45, _) => Self::Trim(4.0, float(data, 0)?),
            (46, _) => Self::Trim(20.0, float(data, 0)?),
            (48, [_, ..]) => Self::WriteStatus,
            (79, [variable, 0, ..]) => Self::Release(*variable),
            (79, [variable, 1, ..]) => Self::Force(*variable, float(data, 3)?),
            (132, [register, ..]) if register & 0x20 == 0 => Self::Analog,
            (132, [register, ..]) => Self::Control(*register),
            (523, [first, count, ..]) => Self::ReadMap(*first, *count),
            (524, [first, count, ..]) => Self::WriteMap(*first, *count),
            (525, _) => Self::ResetMap,
            (526, [mode, ..]) => Self::Simulate(*mode != 0),
            (527, [index, value, ..]) => Self::SimulateBit(*index, *value != 0),
            _ => return None,
        })
    }

    /// The procedure that it belongs to; reset belongs to all of them.
    pub const fn procedure(self) -> Option<Procedure> {
        Some(match self {
            Self::Find | Self::About => Procedure::Identify,
            Self::Fix(_) | Self::Free | Self::Trim(..) => Procedure::Trim,
            Self::ReadMap(..) | Self::WriteMap(..) | Self::ResetMap => Procedure::StatusMap,
            Self::Simulate(_) | Self::SimulateBit(..) => Procedure::StatusSimulation,
            Self::Force(..) | Self::Release(_) => Procedure::ForcedVariable,
            Self::Control(_) | Self::Analog => Procedure::DigitalControl,
            Self::WriteStatus => Procedure::Acknowledge,
            Self::Reset => return None,
        })
    }

    /// True if it changes something in the device.
    pub const fn changes(self) -> bool {
        !matches!(self, Self::Find | Self::About | Self::ReadMap(..))
    }

    /// Frozen identifier of the step.
    pub const fn key(self) -> &'static str {
        match self {
            Self::Find => "find",
            Self::About => "read-about",
            Self::Fix(_) => "fix-current",
            Self::Free => "end-fixed-current",
            Self::Trim(4.0, _) => "trim-zero",
            Self::Trim(..) => "trim-gain",
            Self::ReadMap(..) => "read-map",
            Self::WriteMap(..) => "write-map",
            Self::ResetMap => "reset-map",
            Self::Simulate(true) => "simulation-on",
            Self::Simulate(false) => "simulation-off",
            Self::SimulateBit(..) => "simulate-bit",
            Self::Force(..) => "force",
            Self::Release(_) => "release",
            Self::Control(_) => "control",
            Self::Analog => "return-to-signal",
            Self::WriteStatus => "write-back",
            Self::Reset => "reset",
        }
    }

    /// The request in words.
    pub fn asks(self, number: u16) -> String {
        match self {
            Self::Find => "Looks for a device.".to_owned(),
            Self::About => format!("Asks the device about itself: {}.", lower(number)),
            Self::Fix(current) => format!("Asks to fix the loop current at {current} mA."),
            Self::Free => "Asks to end fixed current mode.".to_owned(),
            Self::Trim(end, measured) => format!(
                "Asks to trim the {}: {measured} mA were measured outside.",
                end_name(end)
            ),
            Self::ReadMap(first, count) => {
                format!("Asks for {count} entries of the map from index {first} on.")
            }
            Self::WriteMap(first, count) => {
                format!("Asks to write {count} entries of the map from index {first} on.")
            }
            Self::ResetMap => "Asks to reset the map.".to_owned(),
            Self::Simulate(true) => "Asks to switch status simulation on.".to_owned(),
            Self::Simulate(false) => "Asks to switch status simulation off.".to_owned(),
            Self::SimulateBit(index, on) => {
                let state = if on { "set" } else { "clear" };
                format!("Asks to {state} the status bit of index {index}.")
            }
            Self::Force(variable, value) => {
                format!("Asks to force device variable {variable} to {value} %.")
            }
            Self::Release(variable) => format!("Asks to give device variable {variable} back."),
            Self::Control(register) => {
                format!("Asks for digital control: {}.", actcon(register))
            }
            Self::Analog => "Asks to follow the analogue signal again.".to_owned(),
            Self::WriteStatus => "Writes the additional status back.".to_owned(),
            Self::Reset => "Asks for a reset.".to_owned(),
        }
    }

    /// The answer in words, if the device agreed.
    pub fn agrees(self, number: u16) -> String {
        match self {
            Self::Find => "A device answers with its identity.".to_owned(),
            Self::About => format!("The device answers: {}.", lower(number)),
            Self::Fix(current) => {
                format!("The loop current is fixed at {current} mA; the valve follows it.")
            }
            Self::Free => "Fixed current mode is over; the loop current counts again.".to_owned(),
            Self::Trim(end, _) => format!("The {} is trimmed.", end_name(end)),
            Self::ReadMap(first, count) => match first.saturating_add(count).checked_sub(1) {
                Some(last) if count > 0 => format!("Entries {first} to {last} of the map."),
                _ => "No entries of the map.".to_owned(),
            },
            Self::WriteMap(..) => "The entries of the map are written.".to_owned(),
            Self::ResetMap => "The map is reset: no bit has a category.".to_owned(),
            Self::Simulate(true) => {
                "Status simulation is on: the device no longer changes its status by itself."
                    .to_owned()
            }
            Self::Simulate(false) => "Status simulation is off.".to_owned(),
            Self::SimulateBit(index, on) => {
                let state = if on { "set" } else { "cleared" };
                format!("The status bit of index {index} is {state}.")
            }
            Self::Force(variable, value) => format!(
                "Device variable {variable} is forced to {value} %; the signal does not count."
            ),
            Self::Release(variable) => format!("Device variable {variable} is given back."),
            Self::Control(register) => format!("Digital control: {}.", actcon(register)),
            Self::Analog => "The valve follows the analogue signal again.".to_owned(),
            Self::WriteStatus => "More status available is acknowledged.".to_owned(),
            Self::Reset => "The device resets: forced modes and simulation are over.".to_owned(),
        }
    }
}

fn end_name(end: f32) -> &'static str {
    if end < 12.0 {
        "zero (4 mA)"
    } else {
        "gain (20 mA)"
    }
}

/// Bits of ACTCON in words (table 16).
fn actcon(register: u8) -> String {
    let names = ["stop", "close", "open", "ESD", "partial stroke"];
    let set = names.iter().enumerate().filter(|(bit, _)| {
        register
            .checked_shr(u32::try_from(*bit).unwrap_or(8))
            .unwrap_or(0)
            & 1
            != 0
    });
    let words: Vec<&str> = set.map(|(_, name)| *name).collect();
    if words.is_empty() {
        "no command".to_owned()
    } else {
        words.join(", ")
    }
}

fn lower(number: u16) -> String {
    let label = command(number).map_or("unknown command", |c| c.label);
    let mut chars = label.chars();
    let first = chars.next().map(|c| c.to_ascii_lowercase());
    first.into_iter().chain(chars).collect()
}
