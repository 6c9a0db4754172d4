//! Lists of tags, in the style of table 6.1 of the guide, as CSV.
//!
//! Each line is a point of a unit: its tag, what it is, and by which register and command it is
//! reached. A line without a register names the unit itself and may say its type.
//!
//! ```csv
//! Tag name,Description,Unit,Type,Register,Command data,Scaling,Comments
//! MOV-4141,Inlet valve,1,ddc100-uec,,,,
//! 80-HS-4141A,Open actuator,1,,40001,256,,Command to open the valve
//! 80-POS-4141,Position feedback,1,,40008,,0-100,Valve position in % of open
//! ```
//!
//! The printed table can be read as it stands: its columns are known by their printed names too.
//! Whatever does not fit is told with line and column, and the rest is read.

mod cells;
mod fields;

use core::fmt::{self, Write};

use super::scaling::Scaling;
use crate::device::Device;
use crate::map::export::csv_cell;
use cells::Cell;

/// Lines that are read; a network of 250 units with 40 points each has as many.
pub const MOST_LINES: usize = 10_000;
/// Characters of a cell.
pub const MOST_CHARACTERS: usize = 200;

/// A line of the list.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Tag {
    /// Its name, unique in the list.
    pub tag: String,
    /// What it is.
    pub description: String,
    /// The unit, 1 to 250.
    pub unit: u8,
    /// The unit's type, if the line says it.
    pub kind: Option<Device>,
    /// Number of the holding register, as printed after the 4: 8 for 40008. `None` for the unit
    /// itself.
    pub register: Option<u16>,
    /// What is written there to command it.
    pub data: Option<Data>,
    /// How the value is scaled.
    pub scaling: Option<Scaling>,
    /// Remarks.
    pub comments: String,
}

/// Command data.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Data {
    /// One value.
    Value(u16),
    /// Any value from one to another.
    Range(u16, u16),
}

impl fmt::Display for Data {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Value(value) => write!(f, "{value}"),
            Self::Range(from, to) => write!(f, "{from}-{to}"),
        }
    }
}

/// What is wrong with a list, and where.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TagProblem {
    /// Line of the text, from 1.
    pub line: u32,
    /// Column in characters, from 1.
    pub column: u32,
    /// What it is and what would fit.
    pub text: String,
}

impl fmt::Display for TagProblem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "Line {}, column {}: {}",
            self.line, self.column, self.text
        )
    }
}

/// A list, and what could not be read of it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct TagList {
    /// The lines that could be read, in their order.
    pub tags: Vec<Tag>,
    /// What could not.
    pub problems: Vec<TagProblem>,
}

/// The columns, with the names that are known; the first is the one that is written.
const COLUMNS: [(Column, &[&str]); 8] = [
    (Column::Tag, &["Tag name", "Tag"]),
    (Column::Description, &["Description"]),
    (
        Column::Unit,
        &[
            "Unit",
            "Address",
            "Modbus slave address",
            "Slave address",
            "Unit address",
        ],
    ),
    (Column::Type, &["Type", "Kind", "Device"]),
    (Column::Register, &["Register", "Modbus register"]),
    (
        Column::Data,
        &["Command data", "Modbus command data", "Data", "Command"],
    ),
    (Column::Scaling, &["Scaling", "Scale"]),
    (Column::Comments, &["Comments", "Comment", "Remarks"]),
];

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Column {
    Tag,
    Description,
    Unit,
    Type,
    Register,
    Data,
    Scaling,
    Comments,
}

/// Which column a name means.
fn column(name: &str) -> Option<Column> {
    let known = |names: &[&str]| names.iter().any(|n| n.eq_ignore_ascii_case(name.trim()));
    let found = COLUMNS.iter().find(|(_, names)| known(names));
    found.map(|(column, _)| *column)
}

impl TagList {
    /// Reads a list: comma, semicolon or tab between the cells, quotes as in RFC 4180. The first
    /// line names the columns.
    #[must_use]
    pub fn read(text: &str) -> Self {
        let mut list = Self::default();
        let text = text.strip_prefix('\u{FEFF}').unwrap_or(text);
        let mut rows = cells::rows(text, &mut list.problems).into_iter();
        let Some(header) = rows.next() else {
            list.problem(1, 1, "The list is empty: its first line names the columns.");
            return list;
        };
        let columns: Vec<Option<Column>> = header.iter().map(|c| column(&c.text)).collect();
        for (cell, found) in header.iter().zip(&columns) {
            if found.is_none() && !cell.text.trim().is_empty() {
                let text = format!(
                    "column {} is not known and left out; known are {}.",
                    quoted(&cell.text),
                    names()
                );
                list.problem(cell.line, cell.column, text);
            }
        }
        for (column, (at, cell)) in columns.iter().zip(header.iter().enumerate()) {
            if column.is_some() && columns.iter().position(|c| c == column) != Some(at) {
                let text = format!("column {} is there twice.", quoted(&cell.text));
                list.problem(cell.line, cell.column, text);
            }
        }
        for (wanted, name) in [(Column::Tag, "Tag name"), (Column::Unit, "Unit")] {
            if !columns.contains(&Some(wanted)) {
                list.problem(1, 1, format!("a column {name:?} is missing."));
                return list;
            }
        }
        for (count, row) in rows.enumerate() {
            if count >= MOST_LINES {
                let at = row.first().map_or((1, 1), |c| (c.line, c.column));
                list.problem(at.0, at.1, format!("more than {MOST_LINES} lines."));
                break;
            }
            list.row(&columns, &row);
        }
        list.check();
        list
    }

    fn problem(&mut self, line: u32, column: u32, text: impl Into<String>) {
        self.problems.push(TagProblem {
            line,
            column,
            text: text.into(),
        });
    }

    /// Takes in a line, unless its tag or unit can't be read.
    fn row(&mut self, columns: &[Option<Column>], row: &[Cell]) {
        let mut tag = Tag::default();
        let mut sound = true;
        if let Some(cell) = row.get(columns.len()) {
            self.problem(
                cell.line,
                cell.column,
                "more cells than the first line names; put a cell with the separator in quotes.",
            );
        }
        for (column, cell) in columns.iter().zip(row) {
            let text = cell.text.trim();
            let Some(column) = column else { continue };
            if text.chars().count() > MOST_CHARACTERS {
                let text = format!("more than {MOST_CHARACTERS} characters in a cell.");
                self.problem(cell.line, cell.column, text);
                sound = false;
                continue;
            }
            if let Err(problem) = tag.set(*column, text) {
                self.problem(cell.line, cell.column, problem);
                sound &= !matches!(column, Column::Tag | Column::Unit);
            }
        }
        let at = row.first().map_or((1, 1), |c| (c.line, c.column));
        if sound && tag.tag.is_empty() {
            self.problem(at.0, at.1, "the line has no tag name.");
            sound = false;
        }
        if sound && tag.unit == 0 {
            self.problem(at.0, at.1, "the line has no unit address, 1 to 250.");
            sound = false;
        }
        if sound && let Some(before) = self.tags.iter().find(|t| t.tag == tag.tag) {
            let text = format!(
                "tag {} is there already, at unit {}; each tag needs a name of its own.",
                quoted(&tag.tag),
                before.unit
            );
            self.problem(at.0, at.1, text);
            sound = false;
        }
        if sound {
            self.tags.push(tag);
        }
    }

    /// What only shows when all lines are there.
    fn check(&mut self) {
        let mut found = Vec::new();
        for (at, tag) in self.tags.iter().enumerate() {
            let before = self.tags.iter().take(at);
            let other = before
                .filter(|t| t.unit == tag.unit)
                .find_map(|t| t.kind.filter(|k| tag.kind.is_some_and(|kind| kind != *k)));
            if let (Some(kind), Some(other)) = (tag.kind, other) {
                found.push(format!(
                    "tag {} says that unit {} is {}, a line before says {}.",
                    quoted(&tag.tag),
                    tag.unit,
                    kind.key(),
                    other.key()
                ));
            }
        }
        for text in found {
            self.problem(1, 1, text);
        }
    }

    /// The list as CSV, with all columns.
    #[must_use]
    pub fn to_csv(&self) -> String {
        let header: Vec<&str> = COLUMNS
            .iter()
            .filter_map(|(_, names)| names.first().copied())
            .collect();
        let mut out = header.join(",");
        out.push('\n');
        for tag in &self.tags {
            let cells = COLUMNS.map(|(column, _)| csv_cell(&tag.get(column)));
            // Writing to a String cannot fail.
            let _ = writeln!(out, "{}", cells.join(","));
        }
        out
    }

    /// The line that names a unit itself, else the first of its points.
    #[must_use]
    pub fn of_unit(&self, unit: u8) -> Option<&Tag> {
        let mut all = self.tags.iter().filter(|t| t.unit == unit);
        all.clone()
            .find(|t| t.register.is_none())
            .or_else(|| all.next())
    }

    /// The type of a unit, if any of its lines says it.
    #[must_use]
    pub fn kind(&self, unit: u8) -> Option<Device> {
        let mut all = self.tags.iter().filter(|t| t.unit == unit);
        all.find_map(|t| t.kind)
    }

    /// How a register of a unit is scaled, if a line says it.
    #[must_use]
    pub fn scaling(&self, unit: u8, register: u16) -> Option<Scaling> {
        let mut all = self.tags.iter();
        all.find(|t| t.unit == unit && t.register == Some(register) && t.scaling.is_some())?
            .scaling
    }
}

/// Text of a user in a sentence: in quotes, and not too long.
fn quoted(text: &str) -> String {
    let mut short: String = text.trim().chars().take(40).collect();
    if short.len() < text.trim().len() {
        short.push('…');
    }
    format!("{short:?}")
}

fn names() -> String {
    let names: Vec<&str> = COLUMNS
        .iter()
        .filter_map(|(_, names)| names.first().copied())
        .collect();
    names.join(", ")
}

#[cfg(test)]
mod tests;
