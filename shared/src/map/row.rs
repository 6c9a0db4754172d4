//! The shape of a map: rows, sets of names, readings and sources. The data are in `shared/data`,
//! the build turns them into static tables of these types.

use std::borrow::Cow;

use crate::address::{Address, Table};
use crate::scale::Scale;

/// Generated with the maps, from `models.csv`.
pub use super::Model;

/// A document and the place in it that a fact was taken from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Source {
    /// Short name of the document as printed beside a value: `VCIOM-16345-EN`.
    pub doc: &'static str,
    /// Section, table or page: `table 5, p. 24`.
    pub part: &'static str,
}

impl core::fmt::Display for Source {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(f, "{}, {}", self.doc, self.part)
    }
}

/// How far a fact can be trusted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Trust {
    /// The manual says so.
    Manual,
    /// The manual is wrong, silent or contradicts itself; a reading was chosen and says why.
    Reading,
    /// Concluded from other facts, not printed.
    Inferred,
}

impl Trust {
    /// The word used in JSON and the map files.
    #[must_use]
    pub const fn key(self) -> &'static str {
        match self {
            Self::Manual => "manual",
            Self::Reading => "reading",
            Self::Inferred => "inferred",
        }
    }
}

/// Whether a reading is certain.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Settled {
    /// The text itself is enough.
    Yes,
    /// Recommended with a reason, not proved by the text.
    Likely,
    /// Open: the raw value decides.
    No,
}

impl Settled {
    /// `yes`, `likely` or `no`.
    #[must_use]
    pub const fn key(self) -> &'static str {
        match self {
            Self::Yes => "yes",
            Self::Likely => "likely",
            Self::No => "no",
        }
    }
}

/// Why a row differs from the print, or what the print leaves open.
#[derive(Debug, PartialEq, Eq)]
pub struct Reading {
    /// Our number for it: `E04`.
    pub id: &'static str,
    /// How certain it is.
    pub settled: Settled,
    /// What we read, and why, in one or two sentences.
    pub text: &'static str,
}

/// What kind of value a row holds, and how its words make it up.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Kind {
    /// One bit of a coil or discrete input.
    Bool,
    /// One word, unsigned.
    U16,
    /// One word, two's complement.
    I16,
    /// Two words, unsigned, high word first.
    U32,
    /// One word whose values have names.
    Enum,
    /// One word (or two, high word first) of named bits.
    Bits,
    /// Two words of BCD: `0xDDMM`, `0xYYYY`.
    BcdDate,
    /// Two words of BCD: `0x00HH`, `0xMMSS`.
    BcdTime,
    /// Two ASCII characters a word, the first in the high byte.
    Ascii,
    /// Four words: unit code in the first byte, then seven ASCII characters.
    Torque,
    /// Four words: seven ASCII characters, the eighth byte is padding.
    Ascii7,
    /// 64 words: 101 samples of one byte, then date, time, temperatures, voltage, stroke time.
    Curve,
    /// Words whose type is not known; shown in hexadecimal.
    Hex,
    /// Reserved or spare; the content means nothing.
    Reserved,
}

impl Kind {
    /// The word used in JSON and the map files.
    #[must_use]
    pub const fn key(self) -> &'static str {
        match self {
            Self::Bool => "bool",
            Self::U16 => "u16",
            Self::I16 => "i16",
            Self::U32 => "u32",
            Self::Enum => "enum",
            Self::Bits => "bits",
            Self::BcdDate => "bcd-date",
            Self::BcdTime => "bcd-time",
            Self::Ascii => "ascii",
            Self::Torque => "torque",
            Self::Ascii7 => "ascii7",
            Self::Curve => "curve",
            Self::Hex => "hex",
            Self::Reserved => "reserved",
        }
    }
}

/// Who may write a row, and whether writing it moves or reconfigures equipment.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Access {
    /// Read-only.
    Read,
    /// Writable, without effect on the equipment (a note, a date, a tag).
    Write,
    /// Writable, and a write moves or reconfigures equipment.
    WriteGuarded,
    /// Only to be written, and a write moves or reconfigures equipment.
    WriteOnly,
    /// Not there on this model.
    Absent,
}

impl Access {
    /// `r`, `rw`, `rw!`, `w!` or `none`, as in the map files.
    #[must_use]
    pub const fn key(self) -> &'static str {
        match self {
            Self::Read => "r",
            Self::Write => "rw",
            Self::WriteGuarded => "rw!",
            Self::WriteOnly => "w!",
            Self::Absent => "none",
        }
    }

    /// True if a write moves or reconfigures equipment.
    #[must_use]
    pub const fn is_guarded(self) -> bool {
        matches!(self, Self::WriteGuarded | Self::WriteOnly)
    }
}

/// User level that a write needs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Level {
    /// Level 0: reads only.
    Observer,
    /// Level 1: the level after power-up.
    User,
    /// Level 2.
    Service,
    /// Level 3.
    Manufacturer,
}

impl Level {
    /// The lower-case name.
    #[must_use]
    pub const fn key(self) -> &'static str {
        match self {
            Self::Observer => "observer",
            Self::User => "user",
            Self::Service => "service",
            Self::Manufacturer => "manufacturer",
        }
    }
}

/// One named value of an enumeration, or one named bit.
#[derive(Debug, PartialEq, Eq)]
pub struct Member {
    /// Code, or bit number with 0 as the least significant.
    pub value: u16,
    /// Last code if it stands for a run of codes, otherwise the same.
    pub last: u16,
    /// Frozen identifier: `close_limit`.
    pub key: &'static str,
    /// What people read; in the label of a run of codes `{}` stands for the code less the first.
    pub label: &'static str,
    /// For a bit: what 0 and 1 mean where that is not "not active" and "active".
    pub states: Option<(&'static str, &'static str)>,
}

impl Member {
    /// True if this code is its own, or one of its run.
    #[must_use]
    pub fn has(&self, code: u32) -> bool {
        (u32::from(self.value)..=u32::from(self.last)).contains(&code)
    }

    /// The label for one of its codes: `Move to 50 %`.
    #[must_use]
    pub fn name(&self, code: u32) -> Cow<'static, str> {
        if self.value == self.last {
            return Cow::Borrowed(self.label);
        }
        let steps = code.saturating_sub(u32::from(self.value));
        Cow::Owned(self.label.replace("{}", &steps.to_string()))
    }
}

/// A named enumeration or bit set, reused by rows.
#[derive(Debug, PartialEq, Eq)]
pub struct Set {
    /// Frozen identifier: `alarms_1`.
    pub name: &'static str,
    /// True for bits, false for an enumeration.
    pub bits: bool,
    /// The members, by value.
    pub members: &'static [Member],
    /// For bits: all that have a name.
    pub mask: u32,
}

impl Set {
    /// The member with this code or bit number.
    #[must_use]
    pub fn get(&self, value: u32) -> Option<&'static Member> {
        // Most sets count from 0 without holes.
        let guess = usize::try_from(value)
            .ok()
            .and_then(|at| self.members.get(at));
        if guess.is_some_and(|m| m.has(value)) {
            return guess;
        }
        self.members.iter().find(|m| m.has(value))
    }
}

/// One value of a device: where it is, what it means, who says so.
#[derive(Debug, PartialEq)]
pub struct Row {
    /// Table that holds it.
    pub table: Table,
    /// Address of its first word or bit.
    pub address: Address,
    /// Number of words (bits for coils and discrete inputs: 1).
    pub words: u16,
    /// Frozen identifier, unique within the table of a device.
    pub key: &'static str,
    /// What people read, spelling corrected.
    pub label: &'static str,
    /// How the words make up the value.
    pub kind: Kind,
    /// Factor from raw counts to the unit.
    pub scale: Scale,
    /// Engineering unit, empty if it has none.
    pub unit: &'static str,
    /// Names of codes or bits.
    pub set: Option<&'static Set>,
    /// Who may write.
    pub access: Access,
    /// Level that a write needs, where the manual has levels.
    pub level: Option<Level>,
    /// Smallest and largest raw value.
    pub range: Option<(i32, i32)>,
    /// Group by which people look for it.
    pub group: &'static str,
    /// First model that has it, where the models are a line of descent.
    pub since: Option<Model>,
    /// A remark in our words, empty if there is none.
    pub note: &'static str,
    /// Where the manual says so.
    pub source: Source,
    /// How far it can be trusted.
    pub trust: Trust,
    /// Why it differs from the print.
    pub reading: Option<&'static Reading>,
}

/// A function code, or a sub-function of FC 08, that a device knows.
#[derive(Debug, PartialEq, Eq)]
pub struct Function {
    /// The function code.
    pub code: u8,
    /// The sub-function, `None` for the function as such.
    pub sub: Option<u16>,
    /// Its name in the manual.
    pub label: &'static str,
    /// A remark in our words, empty if there is none.
    pub note: &'static str,
    /// Where the manual says so.
    pub source: Source,
    /// Why it differs from the print.
    pub reading: Option<&'static Reading>,
}

/// The map of one model.
#[derive(Debug)]
pub struct DeviceMap {
    /// Which model.
    pub model: Model,
    /// Name shown to people: `ICON3000v2`.
    pub name: &'static str,
    /// True if the device has nothing beyond the map, false if the manual leaves the rest open.
    pub whole: bool,
    /// Highest unit address that it can be given.
    pub last_unit: u8,
    /// What it can be asked, as far as the manual lists it.
    pub functions: &'static [&'static Function],
    /// The same as a bit for each function code.
    pub(super) codes: u128,
    /// Its rows by table and address; they cover their tables without holes or overlaps.
    pub rows: &'static [&'static Row],
    /// All readings of its manual, by id; rows name one, notes may mention others.
    pub readings: &'static [Reading],
    /// For each row its table (0 to 3) and address as one number, close together for searching.
    pub(super) keys: &'static [u32],
}
