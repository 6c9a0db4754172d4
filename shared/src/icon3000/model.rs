//! The shape of the files of function 20 and of the health list. The data are in
//! `shared/data/icon3000`, the build turns them into static tables of these types.

use std::borrow::Cow;

use crate::address::{Address, Table};
pub use crate::dop::profile::Ne107;
use crate::map::row::{Member, Reading, Set, Settled, Source, Trust};
use crate::scale::Scale;

include!(concat!(env!("OUT_DIR"), "/icon3000.rs"));

/// How the records of a value make it up.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Kind {
    /// One record, unsigned.
    Unsigned,
    /// One record, two's complement.
    Signed,
    /// One record whose values have names.
    Enum,
    /// One record of named bits, or two, high word first.
    Bits,
    /// Two records, high word first: seconds since 2000-01-01 00:00:00 by the clock of the device.
    Stamp,
    /// Two ASCII characters a record, the first in the high byte.
    Ascii,
    /// The content means nothing.
    Unused,
}

impl Kind {
    /// The word used in JSON and the data files.
    #[must_use]
    pub const fn key(self) -> &'static str {
        match self {
            Self::Unsigned => "u16",
            Self::Signed => "i16",
            Self::Enum => "enum",
            Self::Bits => "bits",
            Self::Stamp => "stamp",
            Self::Ascii => "ascii",
            Self::Unused => "unused",
        }
    }
}

/// One value of a layout, or a run of equal ones such as the samples of a curve.
#[derive(Debug, PartialEq)]
pub struct Field {
    /// Frozen identifier, unique within its part of the layout.
    pub key: &'static str,
    /// What people read; in the label of a run `{}` stands for the position.
    pub label: &'static str,
    /// How the records make up the value.
    pub kind: Kind,
    /// First record, counted from the start of its part.
    pub offset: u16,
    /// Records of one value.
    pub words: u16,
    /// How many values follow each other; 1 for a single one.
    pub count: u16,
    /// Position of the first of a run.
    pub from: u16,
    /// Factor from raw counts to the unit.
    pub scale: Scale,
    /// Engineering unit, empty if it has none.
    pub unit: &'static str,
    /// Names of codes or bits.
    pub set: Option<&'static Set>,
    /// Smallest and largest raw value.
    pub range: Option<(i32, i32)>,
    /// A remark in our words, empty if there is none.
    pub note: &'static str,
    /// Where the manual says so.
    pub source: Source,
    /// How far it can be trusted.
    pub trust: Trust,
    /// Why it differs from the print.
    pub reading: Option<&'static Reading>,
}

impl Field {
    /// Records that it takes, all values of a run together.
    #[must_use]
    pub const fn records(&self) -> u16 {
        self.words.saturating_mul(self.count)
    }

    /// True for several equal values.
    #[must_use]
    pub const fn is_run(&self) -> bool {
        self.count > 1
    }

    /// The label of one value: `Torque at 37 %`. `index` counts from 0.
    #[must_use]
    pub fn label_of(&self, index: u16) -> Cow<'static, str> {
        if self.is_run() {
            let at = self.from.saturating_add(index).to_string();
            Cow::Owned(self.label.replace("{}", &at))
        } else {
            Cow::Borrowed(self.label)
        }
    }
}

/// The records of a file: a head, then, in a log, entries of equal length.
#[derive(Debug, PartialEq)]
pub struct Layout {
    /// Frozen identifier.
    pub key: &'static str,
    /// Records before the entries; all of them in a file without entries.
    pub head_records: u16,
    /// The values there, in order.
    pub head: &'static [Field],
    /// Records of one entry, 0 if the file has none.
    pub entry_records: u16,
    /// The values of one entry.
    pub entry: &'static [Field],
}

impl Layout {
    /// True if entries follow the head.
    #[must_use]
    pub const fn is_log(&self) -> bool {
        self.entry_records > 0
    }

    /// Records of a file with so many entries.
    #[must_use]
    pub fn records(&self, entries: u16) -> u32 {
        u32::from(self.entry_records)
            .saturating_mul(entries.into())
            .saturating_add(self.head_records.into())
    }

    /// What stands at a record.
    #[must_use]
    pub fn slot(&self, record: u16) -> Option<Slot> {
        let (entry, within, fields) = match record.checked_sub(self.head_records) {
            None => (None, record, self.head),
            Some(after) => {
                let entry = after.checked_div(self.entry_records)?;
                let within = after.checked_rem(self.entry_records)?;
                (Some(entry.saturating_add(1)), within, self.entry)
            }
        };
        let field = fields
            .iter()
            .find(|f| within >= f.offset && within < f.offset.saturating_add(f.records()))?;
        let into = within.saturating_sub(field.offset);
        Some(Slot {
            entry,
            field,
            index: into.checked_div(field.words)?,
            word: into.checked_rem(field.words)?,
        })
    }

    /// The value of the head with this key.
    #[must_use]
    pub fn head_field(&self, key: &str) -> Option<&'static Field> {
        self.head.iter().find(|f| f.key == key)
    }

    /// The value of an entry with this key.
    #[must_use]
    pub fn entry_field(&self, key: &str) -> Option<&'static Field> {
        self.entry.iter().find(|f| f.key == key)
    }
}

/// What stands at a record.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slot {
    /// Which entry, from 1; `None` in the head.
    pub entry: Option<u16>,
    /// The value.
    pub field: &'static Field,
    /// Which value of a run, from 0.
    pub index: u16,
    /// Which record of the value, from 0.
    pub word: u16,
}

/// How the files of a run differ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Numbering {
    /// One file.
    Single,
    /// The first is the reference, the second the latest curve, the last the oldest.
    Curves,
    /// Each has a name.
    Named(&'static Set),
}

/// A file of function 20, or a run of files with the same layout.
#[derive(Debug, PartialEq)]
pub struct File {
    /// Frozen identifier.
    pub key: &'static str,
    /// What people read.
    pub label: &'static str,
    /// What one entry of a log is called, or one file of a run.
    pub item: &'static str,
    /// First file number.
    pub first: u16,
    /// Last file number; the same for a single file.
    pub last: u16,
    /// Its records; `None` where the manual describes none.
    pub layout: Option<&'static Layout>,
    /// How the files of a run differ.
    pub numbering: Numbering,
    /// A remark in our words.
    pub note: &'static str,
    /// Where the manual says so.
    pub source: Source,
    /// Why it differs from the print, or what the print leaves open.
    pub reading: Option<&'static Reading>,
}

impl File {
    /// The file, or run of files, that has this number.
    #[must_use]
    pub fn of(number: u16) -> Option<&'static Self> {
        FILES.iter().find(|f| (f.first..=f.last).contains(&number))
    }

    /// The file, or run of files, with this key.
    #[must_use]
    pub fn by_key(key: &str) -> Option<&'static Self> {
        FILES.iter().find(|f| f.key == key)
    }

    /// True if entries follow a head.
    #[must_use]
    pub fn is_log(&self) -> bool {
        self.layout.is_some_and(Layout::is_log)
    }

    /// What one file of it is called: `FST Open Torque Curve, reference`, `Base Card`.
    #[must_use]
    pub fn name(&self, number: u16) -> Cow<'static, str> {
        match self.numbering {
            Numbering::Single => Cow::Borrowed(self.label),
            Numbering::Named(set) => match set.get(number.into()) {
                Some(member) => Cow::Owned(format!("{}: {}", self.label, member.label)),
                None => Cow::Owned(format!("{} {number}", self.label)),
            },
            Numbering::Curves => Cow::Owned(match number.saturating_sub(self.first) {
                0 => format!("{}, reference", self.label),
                1 => format!("{} 1 (latest)", self.label),
                n => format!("{} {n}", self.label),
            }),
        }
    }
}

/// What a bit, or a code of a log, means for the device.
#[derive(Debug, PartialEq, Eq)]
pub struct Meaning {
    /// The set of bits or codes it belongs to.
    pub set: &'static str,
    /// Bit number or code.
    pub value: u16,
    /// Its frozen identifier.
    pub key: &'static str,
    /// Its label in the map.
    pub label: &'static str,
    /// Category of NAMUR NE 107.
    pub status: Ne107,
    /// Why it is in this category.
    pub reason: &'static str,
    /// What to check.
    pub check: &'static str,
}

/// A place that shows the value of a holding register once more, or one bit of it.
///
/// Reading E44: that they are one value is inferred from name and format.
#[derive(Debug, PartialEq, Eq)]
pub struct Mirror {
    /// Table of the copy.
    pub table: Table,
    /// First address of the copy.
    pub address: Address,
    /// First address of the holding register.
    pub home: Address,
    /// Which bit of it, for a coil or discrete input.
    pub bit: Option<u8>,
}

impl Mirror {
    /// The holding register that a place shows, and which bit of it; the place itself if it is no
    /// mirror.
    #[must_use]
    pub fn home(table: Table, address: Address) -> (Table, Address, Option<u8>) {
        MIRRORS
            .iter()
            .find(|m| m.table == table && m.address == address)
            .map_or((table, address, None), |m| (Table::Holding, m.home, m.bit))
    }
}
