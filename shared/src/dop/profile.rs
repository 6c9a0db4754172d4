//! The settings that the manual leaves open, one file per site (readings M1 to M9).
//!
//! Every key is optional. What a file does not set is an assumption, and [`Profile::is_assumed`]
//! says so wherever it shows. The file is JSON; [`Profile::from_json`] checks it.

mod check;
mod file;
mod keys;
mod parts;

use serde::{Deserialize, Serialize};

use crate::address::Table;
use crate::scale::Scale;

pub use check::ProfileProblem;
pub use parts::{
    BitName, Log, LogCommand, Ne107, ReadTable, Reading, Registers, Scales, Status, Temperature,
    Time, TimeUnit, Words,
};

/// Value of the key `format`.
pub const FORMAT: &str = "valvescope-dop-profile";
/// Value of the key `version`.
pub const VERSION: u32 = 1;

/// A setting that may be an assumption.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Setting {
    /// Table in which the areas are read.
    Table,
    /// Function code that writes the request.
    RequestFunction,
    /// Position of the status bits.
    StatusShift,
    /// Order of the registers of a long number.
    LowWordFirst,
    /// Order of the characters in a register.
    TextLowByteFirst,
    /// Order of the bytes in a register.
    ByteSwap,
    /// What time 0 is.
    TimeEpoch,
    /// What one count of time is.
    TimeUnit,
    /// Unit of temperatures.
    Temperature,
    /// Scale of final positions in the trends.
    DstTrend,
    /// Scale of final positions in the statistics.
    DstStatistics,
    /// Scale of positions in the movement log.
    MovementPosition,
    /// Scale of speeds in the movement log.
    MovementSpeed,
    /// Scale of torques in the movement log.
    MovementTorque,
    /// Command options of the logs.
    LogCommands,
}

impl Setting {
    /// All settings.
    pub const ALL: [Self; 15] = [
        Self::Table,
        Self::RequestFunction,
        Self::StatusShift,
        Self::LowWordFirst,
        Self::TextLowByteFirst,
        Self::ByteSwap,
        Self::TimeEpoch,
        Self::TimeUnit,
        Self::Temperature,
        Self::DstTrend,
        Self::DstStatistics,
        Self::MovementPosition,
        Self::MovementSpeed,
        Self::MovementTorque,
        Self::LogCommands,
    ];

    /// The key in the file, with the keys around it: `scales.dst_trend`.
    #[must_use]
    pub const fn key(self) -> &'static str {
        match self {
            Self::Table => "table",
            Self::RequestFunction => "request_function",
            Self::StatusShift => "status.shift",
            Self::LowWordFirst => "words.low_word_first",
            Self::TextLowByteFirst => "words.text_low_byte_first",
            Self::ByteSwap => "words.byte_swap",
            Self::TimeEpoch => "time.epoch",
            Self::TimeUnit => "time.unit",
            Self::Temperature => "temperature",
            Self::DstTrend => "scales.dst_trend",
            Self::DstStatistics => "scales.dst_statistics",
            Self::MovementPosition => "scales.movement_position",
            Self::MovementSpeed => "scales.movement_speed",
            Self::MovementTorque => "scales.movement_torque",
            Self::LogCommands => "log",
        }
    }
}

/// The settings of a site. See the [module](self).
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Profile {
    /// [`FORMAT`].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub format: Option<String>,
    /// [`VERSION`].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub version: Option<u32>,
    /// Name of the site.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub name: String,
    /// Where the areas are.
    #[serde(skip_serializing_if = "is_default")]
    pub registers: Registers,
    /// In which table the areas are read.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub table: Option<ReadTable>,
    /// Function code that writes the request: 6 or 16.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub request_function: Option<u8>,
    /// The response status.
    #[serde(skip_serializing_if = "is_default")]
    pub status: Status,
    /// Orders of registers, characters and bytes.
    #[serde(skip_serializing_if = "is_default")]
    pub words: Words,
    /// What times count.
    #[serde(skip_serializing_if = "is_default")]
    pub time: Time,
    /// Unit of temperatures.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub temperature: Option<Temperature>,
    /// Scales that the manual contradicts itself about.
    #[serde(skip_serializing_if = "is_default")]
    pub scales: Scales,
    /// Command options of the logs.
    #[serde(skip_serializing_if = "is_default")]
    pub log: Log,
    /// How objects are read.
    #[serde(skip_serializing_if = "is_default")]
    pub reading: Reading,
    /// Names of the 64 user indicators.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub indicators: Vec<BitName>,
    /// Names of the 32 alarms of object 1005.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub alarms: Vec<BitName>,
    /// Names of the 32 warnings of object 1005.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub warnings: Vec<BitName>,
}

fn is_default<T: Default + PartialEq>(value: &T) -> bool {
    *value == T::default()
}

/// A word of bits whose names only the site knows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum BitWord {
    /// The 64 user indicators.
    Indicators,
    /// The 32 alarms.
    Alarms,
    /// The 32 warnings.
    Warnings,
}

/// A bit as people read it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BitLabel {
    /// The bit, 0 is the least significant.
    pub bit: u8,
    /// The name from the profile, else one with its number.
    pub name: String,
    /// The category from the profile.
    pub ne107: Option<Ne107>,
    /// True if the profile has no name for it.
    pub assumed: bool,
}

impl Profile {
    /// Reads and checks a file.
    ///
    /// # Errors
    /// Everything that is wrong with it, each with its line and key and with what to write there.
    pub fn from_json(text: &str) -> Result<Self, Vec<ProfileProblem>> {
        check::read(text)
    }

    /// A profile that was checked already, such as that of the backend. What is no value of its
    /// type counts as not set.
    #[must_use]
    pub fn from_value(value: &serde_json::Value) -> Self {
        file::read(value)
    }

    /// The file: only what is set, with format and version.
    #[must_use]
    pub fn to_json(&self) -> String {
        file::write(self)
    }

    /// True if the file does not say it.
    #[must_use]
    pub const fn is_assumed(&self, setting: Setting) -> bool {
        match setting {
            Setting::Table => self.table.is_none(),
            Setting::RequestFunction => self.request_function.is_none(),
            Setting::StatusShift => self.status.shift.is_none(),
            Setting::LowWordFirst => self.words.low_word_first.is_none(),
            Setting::TextLowByteFirst => self.words.text_low_byte_first.is_none(),
            Setting::ByteSwap => self.words.byte_swap.is_none(),
            Setting::TimeEpoch => self.time.epoch.is_none(),
            Setting::TimeUnit => self.time.unit.is_none(),
            Setting::Temperature => self.temperature.is_none(),
            Setting::DstTrend => self.scales.dst_trend.is_none(),
            Setting::DstStatistics => self.scales.dst_statistics.is_none(),
            Setting::MovementPosition => self.scales.movement_position.is_none(),
            Setting::MovementSpeed => self.scales.movement_speed.is_none(),
            Setting::MovementTorque => self.scales.movement_torque.is_none(),
            Setting::LogCommands => {
                self.log.newest.is_none()
                    || self.log.oldest.is_none()
                    || self.log.older.is_none()
                    || self.log.newer.is_none()
            }
        }
    }

    /// The table in which the areas are read.
    #[must_use]
    pub fn table(&self) -> Table {
        self.table.unwrap_or_default().table()
    }

    /// Function code that writes the request: 6 or 16.
    #[must_use]
    pub fn request_function(&self) -> u8 {
        self.request_function.unwrap_or(6)
    }

    /// True if the low word of a long number comes first.
    #[must_use]
    pub fn low_word_first(&self) -> bool {
        self.words.low_word_first.unwrap_or(true)
    }

    /// True if the first of two characters is in the low byte.
    #[must_use]
    pub fn text_low_byte_first(&self) -> bool {
        self.words.text_low_byte_first.unwrap_or(true)
    }

    /// True if the bytes of every register arrive the wrong way round.
    #[must_use]
    pub fn byte_swap(&self) -> bool {
        self.words.byte_swap.unwrap_or(false)
    }

    /// Unit of temperatures.
    #[must_use]
    pub fn temperature(&self) -> Temperature {
        self.temperature.unwrap_or_default()
    }

    /// Seconds since 1970-01-01 UTC of a time as transmitted.
    #[must_use]
    pub fn seconds(&self, raw: i64) -> i64 {
        let seconds = match self.time.unit.unwrap_or_default() {
            TimeUnit::S => raw,
            TimeUnit::Ms => raw.div_euclid(1000),
        };
        seconds.saturating_add(self.time.epoch.unwrap_or(0))
    }

    /// The scale that the file sets, `None` if it does not or the setting is no scale.
    #[must_use]
    pub fn scale(&self, setting: Setting) -> Option<Scale> {
        let counts = match setting {
            Setting::DstTrend => self.scales.dst_trend,
            Setting::DstStatistics => self.scales.dst_statistics,
            Setting::MovementPosition => self.scales.movement_position,
            Setting::MovementSpeed => self.scales.movement_speed,
            Setting::MovementTorque => self.scales.movement_torque,
            _ => None,
        }?;
        let decimals = counts.checked_ilog10().unwrap_or(0);
        Some(Scale::new(1, counts, u8::try_from(decimals).unwrap_or(0)))
    }

    /// The option of a log's command.
    #[must_use]
    pub fn log_option(&self, command: LogCommand) -> u8 {
        match command {
            LogCommand::Newest => self.log.newest.unwrap_or(0),
            LogCommand::Oldest => self.log.oldest.unwrap_or(1),
            LogCommand::Older => self.log.older.unwrap_or(2),
            LogCommand::Newer => self.log.newer.unwrap_or(3),
            LogCommand::Present => self.log.present.unwrap_or(4),
        }
    }

    /// Most registers of one read.
    #[must_use]
    pub fn max_registers(&self) -> u16 {
        self.reading.max_registers.unwrap_or(125)
    }

    /// Pause between two looks at the status, in milliseconds.
    #[must_use]
    pub fn poll_ms(&self) -> u32 {
        self.reading.poll_ms.unwrap_or(250)
    }

    /// How long the unit may be busy, in milliseconds.
    #[must_use]
    pub fn timeout_ms(&self) -> u32 {
        self.reading.timeout_ms.unwrap_or(10_000)
    }

    /// How often a failed read is tried again.
    #[must_use]
    pub fn retries(&self) -> u32 {
        self.reading.retries.unwrap_or(2)
    }

    /// Most requests of one log.
    #[must_use]
    pub fn log_limit(&self) -> u32 {
        self.reading.log_limit.unwrap_or(10_000)
    }

    /// How a bit is called.
    #[must_use]
    pub fn bit(&self, word: BitWord, bit: u8) -> BitLabel {
        let (names, plain) = match word {
            BitWord::Indicators => (&self.indicators, "User indicator bit"),
            BitWord::Alarms => (&self.alarms, "Alarm bit"),
            BitWord::Warnings => (&self.warnings, "Warning bit"),
        };
        let named = names.iter().find(|name| name.bit == bit);
        BitLabel {
            bit,
            name: named.map_or_else(|| format!("{plain} {bit}"), |n| n.name.clone()),
            ne107: named.and_then(|n| n.ne107),
            assumed: named.is_none(),
        }
    }

    /// The bits that are set in a word, the lowest first.
    #[must_use]
    pub fn active(&self, word: BitWord, raw: u64) -> Vec<BitLabel> {
        (0..64_u8)
            .filter(|bit| raw.wrapping_shr(u32::from(*bit)) & 1 != 0)
            .map(|bit| self.bit(word, bit))
            .collect()
    }

    /// The 64 user indicators from their four registers, the low word first or as the profile says.
    #[must_use]
    pub fn indicators(&self, words: [u16; 4]) -> u64 {
        super::words::unsigned(&words, self)
    }
}
