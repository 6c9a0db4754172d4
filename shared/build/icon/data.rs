//! What the files say, before it is checked.

use serde::Deserialize;

use crate::types::At;

/// what function 20 offers, and what alarms mean.
#[derive(Debug, Default)]
pub struct Data {
    pub files: Vec<(At, File)>,
    pub fields: Vec<(At, Field)>,
    pub codes: Vec<(At, Code)>,
    pub readings: Vec<(At, Reading)>,
    pub health: Vec<(At, Health)>,
    pub mirrors: Vec<(At, Mirror)>,
}

impl Data {
    /// The fields of a part of a layout, in the order of their records.
    pub fn part<'a>(&'a self, layout: &'a str, part: &'a str) -> impl Iterator<Item = &'a Field> {
        self.fields
            .iter()
            .map(|(_, field)| field)
            .filter(move |field| field.layout == layout && field.part == part)
    }

    /// Records that a part of a layout takes.
    pub fn words(&self, layout: &str, part: &str) -> u16 {
        self.part(layout, part).map(Field::all_words).sum()
    }
}

/// A file, or a run of files of the same layout.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct File {
    pub key: String,
    /// Empty if the records are not described.
    pub layout: String,
    pub first: u16,
    pub last: u16,
    pub label: String,
    /// What one entry, or one file of a run, is called.
    pub item: String,
    pub numbering: String,
    /// Bytes before the entries, and of one entry, as printed.
    pub head: Option<u16>,
    pub entry: Option<u16>,
    pub part: String,
    pub page: u16,
    pub reading: String,
    pub note: String,
}

/// One value of a layout, or a run of equal ones.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Field {
    pub layout: String,
    pub part: String,
    pub key: String,
    pub label: String,
    pub r#type: String,
    pub words: u16,
    pub count: u16,
    pub from: Option<u16>,
    pub scale: String,
    pub unit: String,
    pub set: String,
    pub min: Option<i32>,
    pub max: Option<i32>,
    pub note: String,
    pub table: u16,
    pub page: u16,
    pub reading: String,
    pub trust: String,
}

impl Field {
    /// Records that it takes.
    pub fn all_words(&self) -> u16 {
        self.words.saturating_mul(self.count)
    }
}

/// A code that only files have.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Code {
    pub set: String,
    pub value: u16,
    pub key: String,
    pub label: String,
}

/// A reading that no row of a map rests on.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Reading {
    pub id: String,
    pub settled: String,
    pub text: String,
}

/// What a bit or a code means for the device.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Health {
    pub set: String,
    pub key: String,
    pub status: String,
    pub reason: String,
    pub check: String,
}

/// A place that shows the value of a holding register once more, or one bit of it.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Mirror {
    pub table: String,
    pub address: u16,
    pub home: u16,
    pub bit: Option<u8>,
}
