//! A whole device at one time: its tables as words, identity, counters and files.
//!
//! A snapshot is filled by requests and their answers ([`Snapshot::absorb`]), written to a file
//! ([`Snapshot::to_text`], the format is documented in [`file`]) and compared with another by
//! meaning ([`diff`]).

pub mod diff;
pub mod file;
mod kind;
mod logs;
pub mod parse;
#[cfg(test)]
mod tests;

use std::collections::BTreeMap;

use super::identity::{Guess, Report};
use super::model::{FILES, File, Numbering};
use super::plan::Span;
use super::records::Files;
use crate::address::{Address, Table};
use crate::capture::Micros;
use crate::image::Image;
use crate::map::row::{Access, Kind, Model};

pub use diff::{Change, Diff, diff};
pub use kind::Sort;
pub use parse::{FileProblem, parse};

/// Everything that was read of a device.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Snapshot {
    /// Which model it was read as.
    pub model: Model,
    /// Unit address.
    pub unit: u8,
    /// The name that the site gives it; empty if it has none.
    pub tag: String,
    /// Program and version that read it: `valvescope 0.1.0`.
    pub tool: String,
    /// When the read began, in words of RFC 3339; empty if that is not known.
    pub taken: String,
    /// How long the read took, in milliseconds; `None` if that is not known.
    pub took_ms: Option<u64>,
    /// When the clock of the device was read, in words of RFC 3339; empty if that is not known, as
    /// in snapshots whose parts were all read one after the other.
    pub clock_read: String,
    /// Which model the device itself says it is, and why; `None` if it was not asked, as when
    /// somebody chose [`model`](Self::model).
    pub guess: Option<Guess>,
    /// Coils, inputs and registers.
    pub image: Image,
    /// The response PDU of function 17.
    pub identity: Option<Vec<u8>>,
    /// Counters of function 08 by sub-function.
    pub counters: BTreeMap<u16, u16>,
    /// Files of function 20.
    pub files: Files,
    /// What was asked for and not had, and why.
    pub failures: Vec<Failure>,
}

/// Something that was asked for and not had.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Failure {
    /// What it was.
    pub part: Part,
    /// Why: `illegal data address`, `no answer`.
    pub why: String,
}

/// A part of a device.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// A stretch of a table: first address and count.
    Block(Table, Address, u16),
    /// The report of function 17.
    Identity,
    /// A counter of function 08.
    Counter(u16),
    /// A stretch of a file.
    File(Span),
}

impl core::fmt::Display for Part {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Block(table, start, count) => {
                let last = u32::from(start.get()).saturating_add((*count).max(1).into());
                let last = last.saturating_sub(1);
                write!(f, "{} {start} to {last}", table.label())
            }
            Self::Identity => f.write_str("report of server ID (FC 17)"),
            Self::Counter(sub) => write!(f, "diagnostic counter {sub} (FC 08)"),
            Self::File(span) => {
                let last = span.end().saturating_sub(1);
                write!(f, "file {}, records {} to {last}", span.file, span.start)
            }
        }
    }
}

/// A stretch of a table that a snapshot does not have.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Hole {
    /// The table.
    pub table: Table,
    /// First address.
    pub start: Address,
    /// How many addresses.
    pub count: u32,
    /// Why: `reserved`, `not read`, or what the device said.
    pub why: String,
}

impl Snapshot {
    /// A snapshot of a device of which nothing was read yet.
    #[must_use]
    pub fn new(model: Model, unit: u8, tag: &str) -> Self {
        Self {
            model,
            unit,
            tag: tag.to_owned(),
            tool: String::new(),
            taken: String::new(),
            took_ms: None,
            clock_read: String::new(),
            guess: None,
            image: Image::new(),
            identity: None,
            counters: BTreeMap::new(),
            files: Files::default(),
            failures: Vec::new(),
        }
    }

    /// Takes in a good answer to any read that it can keep (functions 1 to 4, 8, 17 and 20); false,
    /// and nothing changes, if it is none.
    pub fn absorb(&mut self, request: &[u8], response: &[u8]) -> bool {
        match (request, response) {
            ([1..=4, ..], _) => self
                .image
                .absorb(request, response, Micros::default())
                .is_some(),
            ([8, a, b, ..], [8, c, d, high, low]) if (a, b) == (c, d) => {
                let sub = u16::from_be_bytes([*a, *b]);
                let counts = super::counters::NAMES.iter().any(|n| n.sub == sub);
                if counts {
                    let count = u16::from_be_bytes([*high, *low]);
                    self.counters.insert(sub, count);
                }
                counts
            }
            ([17], [17, _, ..]) => {
                self.identity = Some(response.to_vec());
                true
            }
            ([20, ..], _) => self.files.absorb(request, response).is_some(),
            _ => false,
        }
    }

    /// The report of function 17, if it was read.
    #[must_use]
    pub fn report(&self) -> Option<Report> {
        self.identity.as_deref().and_then(Report::of_pdu)
    }

    /// What the tables of its model have and this snapshot has not, by table and address.
    #[must_use]
    pub fn holes(&self) -> Vec<Hole> {
        let mut holes: Vec<Hole> = Vec::new();
        for row in self.model.map().rows {
            if row.access == Access::Absent {
                continue;
            }
            for index in 0..row.words {
                let Some(address) = row.address.checked_add(index) else {
                    continue;
                };
                if self.image.cell(row.table, address).is_some() {
                    continue;
                }
                let why = match self.failed(row.table, address) {
                    Some(why) => why,
                    None if row.kind == Kind::Reserved => "reserved",
                    None => "not read",
                };
                let at = u32::from(address.get());
                match holes.last_mut() {
                    Some(hole)
                        if hole.table == row.table
                            && hole.why == why
                            && u32::from(hole.start.get()).saturating_add(hole.count) == at =>
                    {
                        hole.count = hole.count.saturating_add(1);
                    }
                    _ => holes.push(Hole {
                        table: row.table,
                        start: address,
                        count: 1,
                        why: why.to_owned(),
                    }),
                }
            }
        }
        holes
    }

    /// Stretches of files that the model has and this snapshot has not, by number; what failed is
    /// not among them. Of curves those count that HR 3511 to 3514 say are stored.
    #[must_use]
    pub fn file_holes(&self) -> Vec<Span> {
        let mut holes = Vec::new();
        if !self.model.map().implements(20) {
            return holes;
        }
        let failed = |number| {
            let mut failures = self.failures.iter();
            failures.any(|f| matches!(f.part, Part::File(span) if span.file == number))
        };
        for file in &FILES {
            let Some(layout) = file.layout else { continue };
            let (mut first, mut last) = (file.first, file.last);
            if file.numbering == Numbering::Curves {
                let stored = self.curves_stored(file).unwrap_or(0);
                first = first.saturating_add(1);
                last = last.min(file.first.saturating_add(stored));
            }
            for number in (first..=last).filter(|n| !failed(*n)) {
                match self.files.get(number) {
                    Some(records) => holes.extend(records.missing(number)),
                    None => holes.push(Span::new(number, 0, layout.head_records)),
                }
            }
        }
        holes
    }

    /// How many curves of a kind are stored besides the reference (HR 3511 to 3514, in the order of
    /// the files); `None` if that was not read.
    fn curves_stored(&self, file: &File) -> Option<u16> {
        let curves = FILES.iter().filter(|f| f.numbering == Numbering::Curves);
        let (address, _) = (3511..).zip(curves).find(|(_, f)| f.first == file.first)?;
        let cell = self.image.cell(Table::Holding, Address::new(address))?;
        Some(cell.word)
    }

    /// True if every curve of a kind was read that the device says is stored.
    fn has_all_curves(&self, file: &File) -> bool {
        let Some(stored) = self.curves_stored(file) else {
            return false;
        };
        let last = file.last.min(file.first.saturating_add(stored));
        let whole = |n: u16| self.files.get(n).is_some_and(|r| r.is_complete(n));
        (file.first.saturating_add(1)..=last).all(whole)
    }

    fn failed(&self, table: Table, address: Address) -> Option<&str> {
        let hit = |f: &&Failure| match f.part {
            Part::Block(of, start, count) => {
                let end = u32::from(start.get()).saturating_add(count.into());
                of == table && start <= address && u32::from(address.get()) < end
            }
            _ => false,
        };
        self.failures.iter().find(hit).map(|f| f.why.as_str())
    }
}
