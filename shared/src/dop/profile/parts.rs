//! The sections of a profile and the words in them.

use serde::{Deserialize, Serialize};

use crate::address::Table;

/// The table in which the five areas are read; the request is always written to a holding register.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ReadTable {
    /// Holding registers, function code 3.
    #[default]
    Holding,
    /// Input registers, function code 4.
    Input,
}

impl ReadTable {
    /// The table of the Modbus layer.
    #[must_use]
    pub const fn table(self) -> Table {
        match self {
            Self::Holding => Table::Holding,
            Self::Input => Table::Input,
        }
    }
}

/// Unit of temperatures.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Temperature {
    /// Degrees Celsius.
    #[default]
    #[serde(rename = "degC")]
    DegC,
    /// Degrees Fahrenheit.
    #[serde(rename = "degF")]
    DegF,
}

/// What one count of time is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum TimeUnit {
    /// A second.
    #[default]
    S,
    /// A millisecond.
    Ms,
}

/// Category of NAMUR NE 107.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Ne107 {
    /// Failure.
    #[serde(rename = "F")]
    Failure,
    /// Check function.
    #[serde(rename = "C")]
    CheckFunction,
    /// Out of specification.
    #[serde(rename = "S")]
    OutOfSpecification,
    /// Maintenance required.
    #[serde(rename = "M")]
    Maintenance,
}

impl Ne107 {
    /// The letter of the recommendation.
    #[must_use]
    pub const fn letter(self) -> &'static str {
        match self {
            Self::Failure => "F",
            Self::CheckFunction => "C",
            Self::OutOfSpecification => "S",
            Self::Maintenance => "M",
        }
    }

    /// What people read.
    #[must_use]
    pub const fn label(self) -> &'static str {
        match self {
            Self::Failure => "Failure",
            Self::CheckFunction => "Check function",
            Self::OutOfSpecification => "Out of specification",
            Self::Maintenance => "Maintenance required",
        }
    }

    /// The category of a record of the event log, `None` for the codes of engineering mode.
    #[must_use]
    pub const fn from_log(code: u16) -> Option<Self> {
        match code {
            0 => Some(Self::Maintenance),
            1 => Some(Self::OutOfSpecification),
            2 => Some(Self::CheckFunction),
            3 => Some(Self::Failure),
            _ => None,
        }
    }
}

/// A command of the logs (reading M5).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum LogCommand {
    /// The newest records.
    Newest,
    /// The oldest records.
    Oldest,
    /// The records before the last ones read.
    Older,
    /// The records after the last ones read.
    Newer,
    /// Whether there is a log.
    Present,
}

/// First addresses of the five areas, zero-based; `None` is not configured (reading M7).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Registers {
    /// The register that takes the request.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub request: Option<u16>,
    /// The four registers of user indicators.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub indicators: Option<u16>,
    /// The register of the response status.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub status: Option<u16>,
    /// The register that counts the registers of the response.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub count: Option<u16>,
    /// The 512 registers of the response.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub response: Option<u16>,
}

/// The response status.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Status {
    /// Lowest bit of the three status bits, 11 to 13; `None` to learn it (reading M2).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub shift: Option<u8>,
}

/// Orders of registers, characters and bytes (section 2.1.6, reading C17).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Words {
    /// The low word of a long number comes first.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub low_word_first: Option<bool>,
    /// The first of two characters is in the low byte.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub text_low_byte_first: Option<bool>,
    /// The two bytes of every register arrive the wrong way round.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub byte_swap: Option<bool>,
}

/// What times count (reading C16).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Time {
    /// Seconds from 1970-01-01 UTC to time 0.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub epoch: Option<i64>,
    /// What one count is.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub unit: Option<TimeUnit>,
}

/// Counts per unit where the manual contradicts itself (readings C8 and C14).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Scales {
    /// Counts per turn of the drive sleeve in objects 203 and 204.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub dst_trend: Option<u32>,
    /// Counts per turn of the drive sleeve in objects 205 and 206.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub dst_statistics: Option<u32>,
    /// Counts per percent of position in object 1203.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub movement_position: Option<u32>,
    /// Counts per turn a minute in object 1203.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub movement_speed: Option<u32>,
    /// Counts per percent of torque in object 1203.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub movement_torque: Option<u32>,
}

/// Command options of the logs (reading M5).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Log {
    /// Asks for the newest records.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub newest: Option<u8>,
    /// Asks for the oldest records.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub oldest: Option<u8>,
    /// Asks for older records than the last ones.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub older: Option<u8>,
    /// Asks for newer records than the last ones.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub newer: Option<u8>,
    /// Asks whether there is a log.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub present: Option<u8>,
}

/// How objects are read (readings M8 and M9).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Reading {
    /// Most registers of one read.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub max_registers: Option<u16>,
    /// Pause between two looks at the status.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub poll_ms: Option<u32>,
    /// How long the unit may be busy.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub timeout_ms: Option<u32>,
    /// How often a failed read is tried again.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub retries: Option<u32>,
    /// Most requests of one log.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub log_limit: Option<u32>,
}

/// The name of a bit that the manual only shows in a figure (readings M3 and M4).
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BitName {
    /// The bit, 0 is the least significant.
    pub bit: u8,
    /// What people read.
    pub name: String,
    /// Its category.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ne107: Option<Ne107>,
}
