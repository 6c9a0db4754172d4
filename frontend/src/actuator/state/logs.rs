//! A log as a table: sorted, filtered, exported.

mod export;
#[cfg(test)]
pub(crate) mod tests;

pub use export::{csv, json};

use core::cmp::Ordering;

use shared::icon3000::model::{Field, File, Kind};
use shared::icon3000::say::bytes_of;
use shared::icon3000::{Item, Log};
use shared::map::row::Row as MapRow;
use shared::value::{Quality, Value};

use super::dossier::{CHANGED, Dossier};
use super::wanted::LIMITS;
use crate::chart::ticks::ordered;
use crate::chart::time::{Civil, stamp};

/// Seconds from 1970 to 2000, where the clock of the device begins (reading E73).
pub const Y2K: i64 = 946_684_800;

/// Logs that the screen shows, by file. Before the ICON3000v2 there are no files, but the five
/// latest alarms and warnings in registers.
pub const LOGS: [u16; 5] = [2, 3, 4, 5000, LIMITS];

/// The logs that a device has.
#[must_use]
pub fn logs_of(dossier: &Dossier) -> &'static [u16] {
    if dossier.device.implements(20) {
        &LOGS
    } else {
        &LOGS[..2]
    }
}

/// Registers with the latest alarms and warnings, on a model without files.
#[must_use]
pub fn rows(dossier: &Dossier) -> Vec<&'static MapRow> {
    if dossier.device.implements(20) {
        return Vec::new();
    }
    dossier.rows(&|row| LISTS.iter().any(|list| row.key.starts_with(list)))
}

/// How the keys of the registers of a log begin: those of alarms, those of warnings.
const LISTS: [&str; 2] = ["alarm_log_", "warning_log_"];

/// A cell.
#[derive(Clone, Debug, PartialEq)]
pub struct Cell {
    /// As shown, without unit.
    pub text: String,
    /// Its unit.
    pub unit: &'static str,
    /// Its words in hexadecimal.
    pub raw: String,
    /// How far to rely on it.
    pub quality: Quality,
    /// The number by which it is sorted: a code, a count, seconds.
    pub number: Option<i64>,
}

/// An entry.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// Its number, 1 is the latest; the record itself in a file that is not described.
    pub number: u16,
    /// When, in seconds since 1970 by the clock of the device.
    pub time: Option<i64>,
    /// Its values in the order of the columns; `None` where a record was not read.
    pub cells: Vec<Option<Cell>>,
}

/// A log.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    /// Number of the file.
    pub file: u16,
    /// Where its entries stand: `file 2`, or registers.
    pub place: String,
    /// What an entry is called.
    pub item: &'static str,
    /// Where the manual describes it.
    pub source: String,
    /// A remark on the file.
    pub note: &'static str,
    /// Values of the head besides the number of entries: name and text.
    pub head: Vec<(String, String)>,
    /// Its columns.
    pub columns: Vec<&'static Field>,
    /// Its entries.
    pub rows: Vec<Row>,
    /// Entries that the device has, as far as it told.
    pub stored: Option<u16>,
    /// What is wrong with it.
    pub problems: Vec<String>,
}

impl Table {
    /// A log of a device, with nothing in it if nothing was read.
    #[must_use]
    pub fn of(dossier: &Dossier, file: u16) -> Self {
        let Some(described) = File::of(file) else {
            return Self::default();
        };
        let mut table = Self {
            file,
            place: format!("file {file}"),
            item: described.item,
            source: described.source.to_string(),
            note: described.note,
            ..Self::default()
        };
        let Some(layout) = described.layout else {
            table.raw(dossier);
            return table;
        };
        let shown = |f: &&Field| f.kind != Kind::Unused && f.key != "time";
        table.columns = layout.entry.iter().filter(shown).collect();
        let Some(log) = dossier.log(file) else {
            if !dossier.device.implements(20) {
                table.registers(dossier);
            }
            return table;
        };
        table.stored = log.stored;
        table.head = head(&log);
        let problem =
            |p: &shared::icon3000::read::RecordProblem| format!("record {}: {}", p.record, p.text);
        table.problems = log.problems.iter().map(problem).collect();
        if dossier.changed(file) {
            table.problems.push(CHANGED.to_owned());
        }
        // Entries beyond what the head announces are left from before.
        let valid = |number: u16| log.stored.is_none_or(|stored| number <= stored);
        for entry in log
            .entries
            .iter()
            .filter(|e| valid(e.number) && !e.is_unread())
        {
            let cells = table.columns.iter().map(|f| entry.get(f.key).map(cell));
            table.rows.push(Row {
                number: entry.number,
                time: entry.time().map(|t| Y2K + i64::from(t)),
                cells: cells.collect(),
            });
        }
        table
    }

    /// The five latest entries in registers: code, date and time of each. Code 0 is no entry.
    fn registers(&mut self, dossier: &Dossier) {
        let list = LISTS[usize::from(self.file != 2)];
        let rows = dossier.rows(&|row| row.key.starts_with(list));
        if let (Some(first), Some(last)) = (rows.first(), rows.last()) {
            let end = last.address.get() + last.words - 1;
            self.place = format!("{} {} to {end}", first.table.short(), first.address);
            self.source = first.source.to_string();
        }
        for (number, entry) in (1..).zip(rows.chunks(3)) {
            let part = |at: usize| Some((*entry.get(at)?, dossier.image.row(entry.get(at)?)?));
            let Some((row, seen)) = part(0) else { continue };
            let Value::Code { raw, .. } = seen.judged.value else {
                continue;
            };
            let value = |at: usize| part(at).map(|(_, seen)| seen.judged.value);
            if raw > 0 {
                let bytes = dossier.image.bytes(row).unwrap_or_default();
                self.rows.push(Row {
                    number,
                    time: moment(value(1), value(2)),
                    cells: vec![Some(Cell {
                        text: bytes_of(row, &bytes),
                        unit: "",
                        raw: format!("{raw:04X}"),
                        quality: seen.judged.quality,
                        number: Some(raw.into()),
                    })],
                });
            }
        }
    }

    /// Reading E69: nothing is known about the file, so each record is a row of its own.
    fn raw(&mut self, dossier: &Dossier) {
        for (record, word) in dossier.records(self.file, 0).iter() {
            let text = |text: String| {
                Some(Cell {
                    text,
                    unit: "",
                    raw: format!("{word:04X}"),
                    quality: Quality::Disputed,
                    number: Some(i64::from(word)),
                })
            };
            let signed = word.cast_signed();
            let bytes = word.to_be_bytes();
            let letter = |b: u8| {
                if b.is_ascii_graphic() {
                    char::from(b)
                } else {
                    '·'
                }
            };
            self.rows.push(Row {
                number: record,
                time: None,
                cells: vec![
                    text(format!("{word:04X}")),
                    text(word.to_string()),
                    text(signed.to_string()),
                    text(bytes.map(letter).iter().collect()),
                ],
            });
        }
    }

    /// Names of the columns besides number and time.
    #[must_use]
    pub fn names(&self) -> Vec<String> {
        if self.columns.is_empty() {
            let names = ["Hexadecimal", "Unsigned", "Signed", "Characters"];
            return names.map(str::to_owned).to_vec();
        }
        let name = |f: &&Field| match f.unit {
            "" => f.label.to_owned(),
            unit => format!("{}, {unit}", f.label),
        };
        self.columns.iter().map(name).collect()
    }

    /// True if its entries have times.
    #[must_use]
    pub fn has_times(&self) -> bool {
        !self.columns.is_empty()
    }

    /// Places of the rows that pass a filter, in its order.
    #[must_use]
    pub fn matching(&self, filter: &Filter) -> Vec<usize> {
        let wanted = filter.text.trim().to_ascii_lowercase();
        let mut found: Vec<usize> = self
            .rows
            .iter()
            .enumerate()
            .filter(|(_, row)| row.passes(&wanted, filter.code, &self.columns))
            .map(|(at, _)| at)
            .collect();
        let order = ordered(found.len(), &|a, b| {
            let (a, b) = (&self.rows[found[a]], &self.rows[found[b]]);
            let order = a.compare(b, filter.column);
            let order = if filter.down { order.reverse() } else { order };
            order == Ordering::Less
        });
        found = order.into_iter().map(|at| found[at]).collect();
        found
    }

    /// Codes that a column of names can have, for a filter: that of the alarms, warnings, sources.
    #[must_use]
    pub fn codes(&self) -> Option<(usize, &'static Field)> {
        // The last is what happened: alarm, warning, device, source.
        let mut named = self.columns.iter().enumerate();
        named
            .rfind(|(_, f)| f.kind == Kind::Enum)
            .map(|(at, f)| (at, *f))
    }
}

impl Row {
    fn passes(&self, wanted: &str, code: Option<i64>, columns: &[&'static Field]) -> bool {
        let cells = self.cells.iter().flatten();
        let named = wanted.is_empty()
            || self.number.to_string() == wanted
            || self.time.is_some_and(|t| stamp(t).contains(wanted))
            || cells
                .clone()
                .any(|c| c.text.to_ascii_lowercase().contains(wanted));
        let coded = code.is_none_or(|code| {
            let last = columns.iter().rposition(|f| f.kind == Kind::Enum);
            let cell = last.and_then(|at| self.cells.get(at)?.as_ref());
            cell.is_some_and(|c| c.number == Some(code))
        });
        named && coded
    }

    fn compare(&self, other: &Self, column: Column) -> Ordering {
        let by = match column {
            Column::Number => Ordering::Equal,
            Column::Time => self.time.cmp(&other.time),
            Column::Value(at) => {
                let cell = |row: &Self| row.cells.get(at).cloned().flatten();
                match (cell(self), cell(other)) {
                    (Some(a), Some(b)) => match (a.number, b.number) {
                        (Some(a), Some(b)) => a.cmp(&b),
                        _ => a.text.cmp(&b.text),
                    },
                    (a, b) => a.is_some().cmp(&b.is_some()).reverse(),
                }
            }
        };
        by.then(self.number.cmp(&other.number))
    }
}

/// Seconds since 1970 of a date and a time.
#[must_use]
pub fn moment(date: Option<Value>, time: Option<Value>) -> Option<i64> {
    let (
        Value::Date { year, month, day },
        Value::Time {
            hour,
            minute,
            second,
        },
    ) = (date?, time?)
    else {
        return None;
    };
    let civil = Civil {
        year: i64::from(year),
        month: i64::from(month),
        day: i64::from(day),
        second: i64::from(hour) * 3600 + i64::from(minute) * 60 + i64::from(second),
    };
    Some(civil.seconds())
}

/// The values of a head that say more than how many entries there are.
fn head(log: &Log) -> Vec<(String, String)> {
    let items = log.head.iter().flatten();
    items
        .filter(|item| item.field.key != "count")
        .map(|item| (item.label().into_owned(), item.text_with_unit()))
        .collect()
}

fn cell(item: &Item) -> Cell {
    Cell {
        text: item.text(),
        unit: item.field.unit,
        raw: item.raw(),
        quality: item.quality,
        number: match item.value {
            Value::Code { raw, .. } | Value::Flags { raw, .. } => Some(i64::from(raw)),
            _ => item.number(),
        },
    }
}

/// A column that a log can be sorted by.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Column {
    /// The number of the entry.
    #[default]
    Number,
    /// The time.
    Time,
    /// A value, by its place.
    Value(usize),
}

/// What is looked for, and in which order.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Filter {
    /// Text of a cell, a number or a part of a time.
    pub text: String,
    /// A code of the column that says what happened.
    pub code: Option<i64>,
    /// The column to sort by.
    pub column: Column,
    /// True for the largest first.
    pub down: bool,
    /// True to show the words of the device and not what they mean.
    pub raw: bool,
}

impl Filter {
    /// Sorts by a column, or the other way round if it is sorted by that already.
    pub fn sort(&mut self, column: Column) {
        self.down = self.column == column && !self.down;
        self.column = column;
    }
}
