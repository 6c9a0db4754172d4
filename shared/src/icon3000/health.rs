//! What alarms and warnings mean for the device: one list, worst first, with what to check.
//!
//! The manual has no categories of NAMUR NE 107; the mapping in `health.csv` is ours, and each line
//! gives its reason.

use super::model::{HEALTH, MIRRORS, Meaning, Ne107};
use crate::address::Table;
use crate::few;
use crate::image::Image;
use crate::map::row::{Kind, Model, Row, Source};

/// Something that is not as it should be.
#[derive(Clone, Debug, PartialEq)]
pub struct Finding {
    /// What it means, why, and what to check.
    pub meaning: &'static Meaning,
    /// The register that says so.
    pub row: &'static Row,
}

impl Finding {
    /// Where it stands: `HR 3010, bit 7` or `DI 4`.
    #[must_use]
    pub fn place(&self) -> String {
        let (table, address) = (self.row.table, self.row.address);
        if table.is_bits() {
            return format!("{} {address}", table.short());
        }
        format!("{} {address}, bit {}", table.short(), self.meaning.value)
    }

    /// Where the bit is described; its category is ours.
    #[must_use]
    pub const fn source(&self) -> Source {
        self.row.source
    }
}

/// How a device is.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Health {
    /// What is not as it should be, worst first; of one category in the order of the data.
    pub findings: Vec<Finding>,
    /// Registers and bits that were not read: what they would say is not known.
    pub unread: Vec<&'static Row>,
    /// What the model has no place for: it may be so or not. Reading E41: discrete inputs 29 to 31
    /// of an ICON2000v4 tell nothing.
    pub untold: Vec<&'static Meaning>,
}

impl Health {
    /// The worst category; `None` if nothing was found.
    #[must_use]
    pub fn worst(&self) -> Option<Ne107> {
        self.findings.first().map(|f| f.meaning.status)
    }

    /// True if everything that the model tells was read, and nothing was found.
    #[must_use]
    pub fn is_good(&self) -> bool {
        self.findings.is_empty() && self.unread.is_empty()
    }
}

/// Place of a category in the list: failure, function check, out of specification, maintenance.
#[must_use]
pub const fn rank(status: Ne107) -> u8 {
    match status {
        Ne107::Failure => 0,
        Ne107::CheckFunction => 1,
        Ne107::OutOfSpecification => 2,
        Ne107::Maintenance => 3,
    }
}

/// The set of warnings, and its bit that is set with any of them.
const WARNINGS: &str = "warnings";
const GENERAL_WARNING: u16 = 15;

/// The health of a device from what was read of it.
///
/// General Warning is a finding only while no warning with a bit of its own is active: then one
/// without a bit is (reading E50), or one whose bit was not read.
#[must_use]
pub fn health(model: Model, image: &Image) -> Health {
    let mut health = Health::default();
    let mut sets: Vec<&str> = Vec::new();
    for meaning in &HEALTH {
        if sets.contains(&meaning.set) {
            continue;
        }
        sets.push(meaning.set);
        let Some(row) = register(model, image, meaning.set) else {
            health.read_bits(model, image, meaning.set);
            continue;
        };
        let Some(bytes) = image.bytes(row) else {
            health.unread.push(row);
            continue;
        };
        let word = bytes
            .first_chunk::<2>()
            .map_or(0, |pair| u16::from_be_bytes(*pair));
        let set = HEALTH.iter().filter(|m| m.set == meaning.set);
        let active = set.filter(|m| word.wrapping_shr(m.value.into()) & 1 != 0);
        health
            .findings
            .extend(active.map(|meaning| Finding { meaning, row }));
    }
    let warns = |f: &Finding| f.meaning.set == WARNINGS;
    let is_general = |f: &Finding| warns(f) && f.meaning.value == GENERAL_WARNING;
    if health.findings.iter().any(|f| warns(f) && !is_general(f)) {
        health.findings.retain(|f| !is_general(f));
    }
    few::sort_by_key(&mut health.findings, |f| rank(f.meaning.status));
    health
}

impl Health {
    /// Bits of a register that the model does not have, from the discrete inputs that show the same
    /// (reading E41). Codes of the logs are no bits.
    fn read_bits(&mut self, model: Model, image: &Image, set: &str) {
        let Some(home) = register(Model::Icon3000v2, image, set) else {
            return;
        };
        for meaning in HEALTH.iter().filter(|m| m.set == set) {
            let copy = MIRRORS
                .iter()
                .find(|m| m.home == home.address && m.bit.map(u16::from) == Some(meaning.value));
            let row = copy.and_then(|m| model.map().row_at(m.table, m.address));
            match row.map(|row| (row, image.cell(row.table, row.address))) {
                None => self.untold.push(meaning),
                Some((row, None)) => self.unread.push(row),
                Some((row, Some(cell))) if cell.word != 0 => {
                    self.findings.push(Finding { meaning, row });
                }
                Some(_) => {}
            }
        }
    }
}

/// The register that holds a set of bits: of several, one that was read; holding registers first.
fn register(model: Model, image: &Image, set: &str) -> Option<&'static Row> {
    let map = model.map();
    let rows = [Table::Holding, Table::Input]
        .into_iter()
        .flat_map(|table| map.rows_of(table).iter().copied())
        .filter(|r| r.kind == Kind::Bits && r.set.is_some_and(|s| s.name == set));
    let rows: Vec<_> = rows.collect();
    let read = rows.iter().find(|row| image.bytes(row).is_some());
    read.or(rows.first()).copied()
}

/// What a code of the alarms log (file 2, registers 3090 and on) means.
#[must_use]
pub fn alarm(code: u16) -> Option<&'static Meaning> {
    of_code("alarm_code", code)
}

/// What a code of the warnings log (file 3, registers 3115 and on) means.
#[must_use]
pub fn warning(code: u16) -> Option<&'static Meaning> {
    of_code("warning_code", code)
}

fn of_code(set: &str, code: u16) -> Option<&'static Meaning> {
    HEALTH.iter().find(|m| m.set == set && m.value == code)
}
