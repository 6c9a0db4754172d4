//! The shape of a diagnostic object: which requests read it, which layouts its answer can have and
//! what each register of a layout means. The data are in `shared/data/dop`, the build turns them
//! into static tables of these types.

mod field;

use core::fmt;

use super::profile::{LogCommand, Profile};
use crate::map::row::{Reading, Source, Trust};

pub use field::{Axis, Field, FieldKind, Part};

/// The word that asks for an object: its id in bits 0 to 10, a command option in bits 12 to 15
/// (reading M1).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Request(u16);

impl Request {
    /// Bits of the object id.
    pub const OBJECT: u16 = 0x07FF;

    /// The request for an option of an object; `None` if one of them does not fit its bits.
    #[must_use]
    pub const fn new(object: u16, option: u8) -> Option<Self> {
        if object > Self::OBJECT || option > 0x0F {
            return None;
        }
        Some(Self(u16::from_be_bytes([option << 4, 0]) | object))
    }

    /// The request that is this word, whatever it says.
    #[must_use]
    pub const fn from_word(word: u16) -> Self {
        Self(word)
    }

    /// The word as written to the request register.
    #[must_use]
    pub const fn word(self) -> u16 {
        self.0
    }

    /// The object id.
    #[must_use]
    pub const fn object(self) -> u16 {
        self.0 & Self::OBJECT
    }

    /// The command option.
    #[must_use]
    pub const fn option(self) -> u8 {
        let [high, _] = self.0.to_be_bytes();
        high >> 4
    }

    /// The object and the option that this word asks for, if both are known. The options of the
    /// logs are those of the profile (reading M5).
    #[must_use]
    pub fn find(self, profile: &Profile) -> Option<(&'static Object, &'static Choice)> {
        if self.0 & !(Self::OBJECT | 0xF000) != 0 {
            return None;
        }
        let object = super::object(self.object())?;
        Some((object, object.choice(self.option(), profile)?))
    }

    /// True if this is a typed read: a known object and an option that it has.
    #[must_use]
    pub fn is_known(self, profile: &Profile) -> bool {
        self.find(profile).is_some()
    }
}

impl fmt::Display for Request {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "0x{:04X}", self.0)
    }
}

/// What an object is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Group {
    /// Vibration of the unit.
    Vibration,
    /// Final positions, on-time, starts and strokes.
    Position,
    /// Torque.
    Torque,
    /// Temperatures.
    Environment,
    /// Supply, counters, alarms, identity and clock.
    Operation,
    /// Records with a time.
    Log,
}

impl Group {
    /// All groups, in the order of the manual.
    pub const ALL: [Self; 6] = [
        Self::Vibration,
        Self::Position,
        Self::Torque,
        Self::Environment,
        Self::Operation,
        Self::Log,
    ];

    /// What people read.
    #[must_use]
    pub const fn label(self) -> &'static str {
        match self {
            Self::Vibration => "Vibration",
            Self::Position => "Position",
            Self::Torque => "Torque",
            Self::Environment => "Temperature",
            Self::Operation => "Operation",
            Self::Log => "Logs",
        }
    }
}

/// Which picture suits an object.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Shape {
    /// Points from the newest to the oldest.
    Trend,
    /// Bins.
    Histogram,
    /// Torque over a stroke, one point a percent.
    Profile,
    /// Single values with the times at which they occurred.
    Cards,
    /// The same values for each of three axes.
    Axes,
    /// Records with a time, page by page.
    Log,
    /// Bits that are active or not.
    Alarms,
    /// Texts that say what is built in.
    Identity,
    /// A clock.
    Clock,
}

/// How the records of a log repeat.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Record {
    /// Registers of a record.
    pub stride: u16,
    /// Records that one response has room for.
    pub max: u16,
}

/// What the registers of a response mean.
#[derive(Debug, PartialEq)]
pub struct Layout {
    /// Frozen identifier, unique within an object: `trend_24`.
    pub key: &'static str,
    /// Registers of the whole response; the most that there can be for a log.
    pub words: u16,
    /// Its fields, in the order of their registers and without a hole.
    pub fields: &'static [Field],
    /// For a log: how the fields that are [`Field::record`] repeat.
    pub record: Option<Record>,
    /// Why there is another one for the same request.
    pub reading: Option<&'static Reading>,
}

impl Layout {
    /// The field with this key.
    #[must_use]
    pub fn field(&self, key: &str) -> Option<&'static Field> {
        self.fields.iter().find(|field| field.key == key)
    }

    /// True if a response of so many registers fits: all of them, or whole records of a log.
    #[must_use]
    pub fn fits(&self, words: usize) -> bool {
        let Some(record) = self.record else {
            return words == usize::from(self.words);
        };
        let stride = usize::from(record.stride);
        let body = words.checked_sub(1);
        body.is_some_and(|body| body.is_multiple_of(stride)) && words <= usize::from(self.words)
    }
}

/// A command option of an object.
#[derive(Debug, PartialEq)]
pub struct Choice {
    /// Bits 12 to 15 of the request; for a log the default of reading M5.
    pub option: u8,
    /// Frozen identifier: `days_30`.
    pub key: &'static str,
    /// What people read: `30 days`. Empty if the object has no options.
    pub label: &'static str,
    /// What the response means.
    pub layout: &'static Layout,
    /// What it means if its number of registers says so (readings B1a and B2a).
    pub others: &'static [&'static Layout],
    /// For a log: which of its commands this is.
    pub command: Option<LogCommand>,
    /// How far the option can be trusted.
    pub trust: Trust,
    /// Why it differs from the print.
    pub reading: Option<&'static Reading>,
}

impl Choice {
    /// All layouts that a response can have, the recommended one first.
    pub fn layouts(&self) -> impl Iterator<Item = &'static Layout> {
        core::iter::once(self.layout).chain(self.others.iter().copied())
    }
}

/// A diagnostic object.
#[derive(Debug, PartialEq)]
pub struct Object {
    /// Its number, bits 0 to 10 of the request.
    pub id: u16,
    /// Frozen identifier: `vibration_trend`.
    pub key: &'static str,
    /// What people read.
    pub label: &'static str,
    /// What it is about.
    pub group: Group,
    /// Which picture suits it.
    pub shape: Shape,
    /// Its command options, at least one.
    pub options: &'static [Choice],
    /// Where the manual describes it.
    pub section: Source,
    /// A remark in our words, empty if there is none.
    pub note: &'static str,
    /// What the manual gets wrong about its command or title.
    pub reading: Option<&'static Reading>,
    /// Further readings that concern it.
    pub also: &'static [&'static Reading],
}

impl Object {
    /// The choice behind an option. For a log the profile says which command it is.
    #[must_use]
    pub fn choice(&self, option: u8, profile: &Profile) -> Option<&'static Choice> {
        self.options.iter().find(|choice| match choice.command {
            Some(command) => profile.log_option(command) == option,
            None => choice.option == option,
        })
    }

    /// The request of one of its choices.
    #[must_use]
    pub fn request(&self, choice: &Choice, profile: &Profile) -> Request {
        let option = choice
            .command
            .map_or(choice.option, |command| profile.log_option(command));
        Request::new(self.id, option).unwrap_or_default()
    }

    /// The request of a log's command.
    #[must_use]
    pub fn log_request(&self, command: LogCommand, profile: &Profile) -> Option<Request> {
        let choice = self.options.iter().find(|c| c.command == Some(command))?;
        Some(self.request(choice, profile))
    }

    /// The choice with this key.
    #[must_use]
    pub fn choice_by_key(&self, key: &str) -> Option<&'static Choice> {
        self.options.iter().find(|choice| choice.key == key)
    }
}
