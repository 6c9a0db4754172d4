//! The shape of the HART facts. The data are in `shared/data/hart`, the build turns them into
//! static tables of these types.

use crate::device::Family;
use crate::map::row::{Reading, Set, Source, Trust};

pub use super::effect::Effect;

/// Which part of the standard a command belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Group {
    /// Every device has it.
    Universal,
    /// Many devices have it.
    Common,
    /// Rotork's own.
    Device,
}

impl Group {
    /// The word used in JSON.
    #[must_use]
    pub const fn key(self) -> &'static str {
        match self {
            Self::Universal => "universal",
            Self::Common => "common",
            Self::Device => "device",
        }
    }
}

/// How a master addresses a command.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Reach {
    /// By the long address.
    Long,
    /// By the long or the short one.
    Any,
    /// By the broadcast address; only the device that is meant answers.
    Broadcast,
}

/// A command: what it does, what its requests and responses hold.
#[derive(Debug, PartialEq)]
pub struct Command {
    /// Its number; from 256 on it travels in command 31.
    pub number: u16,
    /// Frozen identifier.
    pub key: &'static str,
    /// What people read.
    pub label: &'static str,
    /// Which part of the standard it belongs to.
    pub group: Group,
    /// What it may do, the main effect first.
    pub effects: &'static [Effect],
    /// The Rotork families that have it, by the manual.
    pub families: &'static [Family],
    /// How a master addresses it.
    pub reach: Reach,
    /// Forms of the request.
    pub request: &'static [Form],
    /// Forms of the response.
    pub response: &'static [Form],
    /// Its response codes besides success.
    pub codes: &'static [Code],
    /// A remark in our words, empty if there is none.
    pub note: &'static str,
    /// Where the manual lists it, else where the standard does.
    pub source: Source,
    /// Why the description differs from the print, or what is open; the first decides.
    pub readings: &'static [&'static Reading],
}

impl Command {
    /// True if asking it changes nothing, whatever the form.
    #[must_use]
    pub fn is_read(&self) -> bool {
        self.effects == [Effect::Reads] && self.request.iter().all(|f| f.effects.is_none())
    }

    /// True if a request may have so many bytes, and then changes nothing.
    #[must_use]
    pub fn reads_with(&self, len: usize) -> bool {
        let has = |f: &Form| f.lengths.iter().any(|l| usize::from(*l) == len);
        self.request.iter().any(has) && self.effects_of(len) == [Effect::Reads]
    }

    /// What a request with so many bytes may do.
    #[must_use]
    pub fn effects_of(&self, len: usize) -> &'static [Effect] {
        form(self.request, len)
            .and_then(|f| f.effects)
            .unwrap_or(self.effects)
    }
}

/// The data of a request or response for certain lengths.
#[derive(Debug, PartialEq)]
pub struct Form {
    /// Lengths that it can have, the longest first.
    pub lengths: &'static [u16],
    /// True if the data may end after any byte.
    pub ends_anywhere: bool,
    /// Oldest HART revision that sends it, 0 if that makes no difference.
    pub revision: u8,
    /// What the form does where it differs from the command.
    pub effects: Option<&'static [Effect]>,
    /// The fields, in order and without holes.
    pub items: &'static [Item],
    /// Why the form is as it is.
    pub readings: &'static [&'static Reading],
}

/// The form for data of this length: one that has it, else one that may end anywhere.
#[must_use]
pub fn form(forms: &'static [Form], len: usize) -> Option<&'static Form> {
    let has = |f: &&Form| f.lengths.iter().any(|l| usize::from(*l) == len);
    let reaches = |f: &&Form| f.ends_anywhere && len > 0;
    forms
        .iter()
        .find(has)
        .or_else(|| forms.iter().find(reaches))
}

/// A response code of a command.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Code {
    /// The code.
    pub code: u8,
    /// What it means for this command; empty if it means the same everywhere.
    pub words: &'static str,
    /// False if no source lists it for this command.
    pub sourced: bool,
}

/// Whether a response code lets data follow.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Class {
    /// All is well.
    Success,
    /// Done, with a remark.
    Warning,
    /// Not done; no data follow.
    Error,
}

impl Class {
    /// The word used in JSON.
    #[must_use]
    pub const fn key(self) -> &'static str {
        match self {
            Self::Success => "success",
            Self::Warning => "warning",
            Self::Error => "error",
        }
    }
}

/// Response codes that are of one class.
#[derive(Debug)]
pub struct Codes {
    /// First code.
    pub first: u8,
    /// Last code.
    pub last: u8,
    /// Their class.
    pub class: Class,
    /// What they mean for every command; empty if each command has its own meaning.
    pub label: &'static str,
    /// What that rests on where it is no print.
    pub reading: Option<&'static Reading>,
}

/// One field of the data, or a field of the device's status.
#[derive(Debug, PartialEq)]
pub struct Item {
    /// Frozen identifier.
    pub key: &'static str,
    /// What people read.
    pub label: &'static str,
    /// How its bytes make up the value.
    pub kind: Kind,
    /// Unit that the standard fixes, empty if it has none.
    pub unit: &'static str,
    /// True if the unit is the one that the last unit code names.
    pub by_code: bool,
    /// True if people read it in hexadecimal.
    pub hex: bool,
    /// The only value that is expected.
    pub expected: Option<u32>,
    /// Smallest and largest value.
    pub range: Option<(i32, i32)>,
    /// Where it is described.
    pub source: Source,
    /// How far the description can be trusted.
    pub trust: Trust,
    /// Why it differs from the print, or what is open; the first decides.
    pub readings: &'static [&'static Reading],
}

/// How the bytes of a field make up its value.
#[derive(Debug, PartialEq)]
pub enum Kind {
    /// A number of one to four bytes.
    Unsigned(u8),
    /// IEEE 754, single precision.
    Float,
    /// Day, month, year since 1900.
    Date,
    /// Counts of 1/32 ms.
    Time,
    /// So many bytes, four characters in three.
    Packed(u8),
    /// So many characters of ISO 8859-1.
    Latin(u8),
    /// A code of one or two bytes with names.
    Named(u8, &'static Names),
    /// One or two bytes of named bits.
    Bits(u8, &'static Bits),
    /// A code of table 2.
    Unit,
    /// A code of a device variable.
    Variable,
    /// A byte of the device's own status; its bits depend on the family.
    Additional(u8),
    /// Codes of four bits, the smaller index in the low half.
    Nibbles(&'static Names),
    /// One byte with parts.
    Split(&'static [Part]),
    /// The same fields at most so many times.
    Repeat(u8, &'static [Item]),
    /// So many bytes without a known meaning.
    Raw(u8),
}

/// A part of a byte.
#[derive(Debug, PartialEq)]
pub struct Part {
    /// Highest bit.
    pub high: u8,
    /// Lowest bit.
    pub low: u8,
    /// Its names, if it has any.
    pub names: Option<&'static Names>,
    /// Key, label and source.
    pub item: Item,
}

/// Names of codes.
#[derive(Debug, PartialEq)]
pub struct Names {
    /// The names.
    pub set: Set,
    /// True if 240 to 249 belong to the manufacturer and 250 to 253 mean not used, none, unknown
    /// and special.
    pub tail: bool,
    /// Where they are listed.
    pub source: Source,
}

impl Names {
    /// The name of a code.
    #[must_use]
    pub fn name(&self, code: u32) -> Option<&'static str> {
        match self.set.get(code) {
            Some(member) => Some(member.label),
            None if self.tail => match code {
                240..=249 => Some("Manufacturer specific"),
                250 => Some("Not used"),
                251 => Some("None"),
                252 => Some("Unknown"),
                253 => Some("Special"),
                _ => None,
            },
            None => None,
        }
    }
}

/// Named bits with what is known of each.
#[derive(Debug, PartialEq)]
pub struct Bits {
    /// The names, for showing all at once.
    pub set: Set,
    /// The same bits one by one.
    pub bits: &'static [Bit],
}

/// One bit of a status.
#[derive(Debug, PartialEq)]
pub struct Bit {
    /// Number, 0 is the least significant.
    pub bit: u8,
    /// Frozen identifier.
    pub key: &'static str,
    /// What people read.
    pub label: &'static str,
    /// Another name that the manual has for it, empty if there is none.
    pub alias: &'static str,
    /// True for a fault, false for a plain state.
    pub alarm: bool,
    /// What 0 and 1 mean.
    pub states: (&'static str, &'static str),
    /// Where it is described.
    pub source: Source,
    /// How far the description can be trusted.
    pub trust: Trust,
    /// Why it differs from the print.
    pub reading: Option<&'static Reading>,
}

/// An engineering unit.
#[derive(Debug, PartialEq, Eq)]
pub struct Unit {
    /// Its code.
    pub code: u8,
    /// Classification under which the code means this, 0 if it always does.
    pub class: u8,
    /// What stands beside a value; empty for `not used` and the like.
    pub symbol: &'static str,
    /// What people read where there is no symbol.
    pub name: &'static str,
}

/// A category of a bit in the condensed status map.
#[derive(Debug)]
pub struct Mapped {
    /// Byte of the device's own status.
    pub byte: u8,
    /// Bit of the byte.
    pub bit: u8,
    /// Code of the category.
    pub category: u8,
    /// The name that the table has for the bit.
    pub printed: &'static str,
    /// Table of the manual.
    pub source: Source,
    /// What is open about it.
    pub reading: Option<&'static Reading>,
}

/// An example of the manual for the condensed status map.
#[derive(Debug)]
pub struct Preset {
    /// Frozen identifier.
    pub key: &'static str,
    /// What people read.
    pub label: &'static str,
    /// For which family.
    pub family: Family,
    /// The bits that have an effect.
    pub bits: &'static [Mapped],
}

/// A time of the link, in characters of 11 bits at 1200 bit/s.
#[derive(Debug)]
pub struct Timer {
    /// Frozen identifier.
    pub key: &'static str,
    /// The name of the standard.
    pub label: &'static str,
    /// How long.
    pub characters: u16,
    /// What it is.
    pub note: &'static str,
    /// What it rests on.
    pub reading: Option<&'static Reading>,
}

impl Timer {
    /// How long in microseconds, rounded down.
    #[must_use]
    pub const fn micros(&self) -> u64 {
        // 11 bits a character; u16 counts stay far below the limit.
        let bits = u64_of(self.characters).saturating_mul(11);
        bits.saturating_mul(1_000_000) / 1200
    }
}

/// Widens in const context, where `From` is not available.
#[expect(
    clippy::as_conversions,
    reason = "lossless, and `u64::from` is not const"
)]
const fn u64_of(value: u16) -> u64 {
    value as u64
}
