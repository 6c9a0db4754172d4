//! The fields of the files as text: JSON lines and CSV for tools, aligned lines for people. They
//! follow the rows of the map of an ICON3000v2.

use core::fmt::{self, Write};

use super::model::{FILES, Field, File, Layout};
use crate::json::Quoted;
use crate::map::export::csv_cell;
use crate::map::row::{Model, Set};

/// A field with the file and the part of it that it belongs to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line {
    /// The file, or run of files.
    pub file: &'static File,
    /// Its layout.
    pub layout: &'static Layout,
    /// True for a value of an entry, false for one of the head.
    pub entry: bool,
    /// The field.
    pub field: &'static Field,
}

/// All fields of all files, in the order of files and records.
pub fn lines() -> impl Iterator<Item = Line> {
    FILES.iter().flat_map(|file| {
        let layout = file.layout;
        let part = move |entry: bool| {
            let fields = layout.map_or(&[][..], |l| if entry { l.entry } else { l.head });
            fields.iter().filter_map(move |field| {
                Some(Line {
                    file,
                    layout: layout?,
                    entry,
                    field,
                })
            })
        };
        part(false).chain(part(true))
    })
}

impl Line {
    /// First record of the value: in the file, or of the first entry.
    #[must_use]
    pub const fn record(&self) -> u16 {
        if self.entry {
            self.layout.head_records.saturating_add(self.field.offset)
        } else {
            self.field.offset
        }
    }

    const fn part(&self) -> &'static str {
        if self.entry { "entry" } else { "head" }
    }

    /// One JSON object, without a line end. Keys and order are a documented contract.
    ///
    /// # Errors
    /// Only if writing fails.
    pub fn write_json(&self, out: &mut impl Write) -> fmt::Result {
        let field = self.field;
        write!(
            out,
            r#"{{"device":"{}","table":"file","file":{},"last":{},"part":"{}","record":{},"words":{},"count":{},"from":{},"key":"{}","label":{},"type":"{}","scale":"{}","unit":"{}","min":"#,
            Model::Icon3000v2.key(),
            self.file.first,
            self.file.last,
            self.part(),
            self.record(),
            field.words,
            field.count,
            field.from,
            field.key,
            Quoted(field.label),
            field.kind.key(),
            field.scale,
            field.unit,
        )?;
        match field.range {
            Some((min, max)) => write!(out, r#"{min},"max":{max}"#)?,
            None => out.write_str(r#"null,"max":null"#)?,
        }
        out.write_str(r#","set":"#)?;
        set(out, field.set)?;
        write!(
            out,
            r#","source":{},"trust":"{}","group":{},"repeats":{},"note":{},"reading":"#,
            Quoted(&field.source.to_string()),
            field.trust.key(),
            Quoted(self.file.label),
            if self.entry {
                self.layout.entry_records
            } else {
                0
            },
            Quoted(field.note),
        )?;
        match field.reading {
            Some(reading) => write!(
                out,
                r#"{{"id":"{}","settled":"{}","text":{}}}}}"#,
                reading.id,
                reading.settled.key(),
                Quoted(reading.text)
            ),
            None => out.write_str("null}"),
        }
    }

    /// One CSV line in the columns of the map's rows: `address` is the record, `number` the file or
    /// the run of files.
    #[must_use]
    pub fn csv(&self) -> String {
        let field = self.field;
        let number = |n: Option<i32>| n.map(|n| n.to_string()).unwrap_or_default();
        let members = field.set.map_or_else(String::new, |set| {
            let texts: Vec<_> = set
                .members
                .iter()
                .map(|m| format!("{}={}", m.value, m.label))
                .collect();
            texts.join("; ")
        });
        let files = if self.file.first == self.file.last {
            self.file.first.to_string()
        } else {
            format!("{}-{}", self.file.first, self.file.last)
        };
        let cells = [
            Model::Icon3000v2.key(),
            "file",
            &self.record().to_string(),
            &files,
            &field.records().to_string(),
            field.key,
            field.label,
            field.kind.key(),
            &field.scale.to_string(),
            field.unit,
            "r",
            "false",
            "",
            &number(field.range.map(|r| r.0)),
            &number(field.range.map(|r| r.1)),
            &members,
            self.file.label,
            Model::Icon3000v2.key(),
            field.note,
            &field.source.to_string(),
            field.trust.key(),
            field.reading.map_or("", |r| r.id),
        ];
        cells.map(csv_cell).join(",")
    }

    /// Aligned columns for people, without a line end.
    #[must_use]
    pub fn text(&self) -> String {
        let field = self.field;
        let records = match field.records() {
            1 => self.record().to_string(),
            n => {
                let last = self.record().saturating_add(n).saturating_sub(1);
                format!("{}-{last}", self.record())
            }
        };
        format!(
            "{records:>9} {:<5} {:<50} {:<8} {:<4} {}",
            self.part(),
            field.label.replace("{}", "n"),
            field.kind.key(),
            field.unit,
            field.source
        )
    }
}

/// A set as the map's JSON has it.
fn set(out: &mut impl Write, set: Option<&Set>) -> fmt::Result {
    let Some(set) = set else {
        return out.write_str("null");
    };
    let kind = if set.bits { "bits" } else { "enum" };
    write!(out, r#"{{"kind":"{kind}","values":["#)?;
    for (at, member) in set.members.iter().enumerate() {
        let comma = if at > 0 { "," } else { "" };
        write!(out, "{comma}[{},{}]", member.value, Quoted(member.label))?;
    }
    out.write_str("]}")
}

/// The heading of a file for people: `Files 1000 to 1100, FST Open Torque Curve`.
#[must_use]
pub fn heading(file: &File) -> String {
    let numbers = if file.first == file.last {
        format!("File {}", file.first)
    } else {
        format!("Files {} to {}", file.first, file.last)
    };
    let log = file.layout.filter(|l| l.is_log());
    let entries = log.map_or_else(String::new, |l| {
        format!("; an entry has {} records", l.entry_records)
    });
    let unknown = if file.layout.is_none() {
        "; its records are not described"
    } else {
        ""
    };
    format!(
        "{numbers}, {}{entries}{unknown} ({})",
        file.label, file.source
    )
}
