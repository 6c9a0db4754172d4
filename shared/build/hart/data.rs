//! What the files say, before it is checked.

use std::collections::BTreeMap;

use serde::Deserialize;
use toml::Spanned;

use crate::types::At;

/// Everything below `data/hart`.
#[derive(Debug, Default)]
pub struct Data {
    pub commands: Commands,
    /// The text of the file of commands, for its lines.
    pub text: String,
    pub files: Vec<(At, File)>,
    pub sets: Vec<(At, Set)>,
    pub codes: Vec<(At, Named)>,
    pub bits: Vec<(At, Bit)>,
    pub status: Vec<(At, Status)>,
    pub families: Vec<(At, Family)>,
    pub units: Vec<(At, Unit)>,
    pub makers: Vec<(At, Maker)>,
    pub responses: Vec<(At, Response)>,
    pub timers: Vec<(At, Timer)>,
    pub presets: Vec<(At, Preset)>,
    pub readings: Vec<(At, Reading)>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Commands {
    #[serde(rename = "command")]
    pub list: Vec<Spanned<Command>>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Command {
    pub number: u16,
    pub key: String,
    pub label: String,
    pub group: String,
    pub effect: Vec<String>,
    pub families: Vec<String>,
    pub table: Option<u8>,
    pub page: Option<u16>,
    pub layout: String,
    pub part: Option<String>,
    pub address: Option<String>,
    #[serde(default)]
    pub note: String,
    #[serde(default)]
    pub readings: Vec<String>,
    pub codes: BTreeMap<String, String>,
    pub sourced: Sourced,
    pub request: Forms,
    pub response: Forms,
}

/// Which codes have a source: `"all"`, or those listed.
#[derive(Debug, Deserialize)]
#[serde(untagged)]
pub enum Sourced {
    Word(String),
    Codes(Vec<u8>),
}

/// Forms, or those of `"request"` or of another command.
#[derive(Debug, Deserialize)]
#[serde(untagged)]
pub enum Forms {
    Same(String),
    Own(Vec<Form>),
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Form {
    pub lengths: Vec<u16>,
    #[serde(default)]
    pub ends_anywhere: bool,
    #[serde(default)]
    pub revision: u8,
    pub effect: Option<Vec<String>>,
    #[serde(default)]
    pub readings: Vec<String>,
    pub fields: Vec<Field>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Field {
    pub key: String,
    pub label: String,
    #[serde(rename = "type")]
    pub kind: String,
    #[serde(default)]
    pub unit: String,
    pub of: Option<String>,
    #[serde(default)]
    pub hex: bool,
    pub expected: Option<u32>,
    pub min: Option<i32>,
    pub max: Option<i32>,
    #[serde(default)]
    pub parts: Vec<Part>,
    #[serde(default)]
    pub fields: Vec<Field>,
    #[serde(default)]
    pub readings: Vec<String>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Part {
    pub key: String,
    pub label: String,
    pub high: u8,
    pub low: u8,
    #[serde(rename = "type")]
    pub kind: String,
}

/// A file without a document of its own in each line.
#[derive(Debug, Deserialize)]
pub struct File {
    pub file: String,
    pub doc: String,
    pub part: String,
}

#[derive(Debug, Deserialize)]
pub struct Set {
    pub set: String,
    pub kind: String,
    pub label: String,
    pub doc: String,
    pub part: String,
    pub tail: String,
    pub trust: String,
    pub reading: String,
    #[serde(rename = "note")]
    pub _note: String,
}

#[derive(Debug, Deserialize)]
pub struct Named {
    pub set: String,
    pub value: u16,
    pub key: String,
    pub label: String,
    pub reading: String,
}

#[derive(Debug, Deserialize)]
pub struct Bit {
    pub set: String,
    pub bit: u8,
    pub key: String,
    pub label: String,
    pub zero: String,
    pub one: String,
    pub reading: String,
}

#[derive(Debug, Deserialize)]
pub struct Status {
    pub part: String,
    pub family: String,
    pub byte: Option<u8>,
    pub bit: String,
    pub key: String,
    pub label: String,
    pub alias: String,
    pub kind: String,
    pub doc: String,
    pub table: u8,
    pub page: Option<u16>,
    pub trust: String,
    pub reading: String,
}

impl Status {
    /// The bits of the line: one, or a range of reserved ones.
    pub fn bits(&self) -> Option<std::ops::RangeInclusive<u8>> {
        let (first, last) = self.bit.split_once('-').unwrap_or((&self.bit, &self.bit));
        Some(first.parse().ok()?..=last.parse().ok()?)
    }

    pub fn is_reserved(&self) -> bool {
        self.kind == "reserved"
    }
}

#[derive(Debug, Deserialize)]
pub struct Family {
    pub key: String,
    pub name: String,
    pub range: String,
    pub bits: usize,
    pub reading: String,
}

#[derive(Debug, Deserialize)]
pub struct Unit {
    pub code: u8,
    pub symbol: String,
    pub classification: Option<u8>,
    pub name: String,
    pub reading: String,
}

#[derive(Debug, Deserialize)]
pub struct Maker {
    pub id: u16,
    pub name: String,
    pub reading: String,
}

#[derive(Debug, Deserialize)]
pub struct Response {
    pub first: u8,
    pub last: u8,
    pub class: String,
    pub key: String,
    pub label: String,
    pub trust: String,
    pub reading: String,
}

#[derive(Debug, Deserialize)]
pub struct Timer {
    pub key: String,
    pub characters: u16,
    pub label: String,
    pub note: String,
    pub trust: String,
    pub reading: String,
}

#[derive(Debug, Deserialize)]
pub struct Preset {
    pub preset: String,
    pub label: String,
    pub family: String,
    pub byte: u8,
    pub bit: u8,
    pub category: u8,
    pub printed: String,
    pub table: u8,
    pub page: u16,
    pub trust: String,
    pub reading: String,
}

#[derive(Debug, Deserialize)]
pub struct Reading {
    pub id: String,
    pub settled: String,
    #[serde(rename = "where")]
    pub place: String,
    pub text: String,
}

/// How a type of the data file is stored: bytes, and the set that it needs.
pub enum Kind<'a> {
    Unsigned(u8),
    Float,
    Date,
    Time,
    Packed(u8),
    Latin(u8),
    Named(u8, &'a str),
    Bits(u8, &'a str),
    Unit,
    Variable,
    VariableStatus,
    Additional(u8),
    Nibbles(&'a str),
    Split,
    Repeat(u8),
    Raw(u8),
}

impl<'a> Kind<'a> {
    /// What a type means; `None` if it is unknown.
    pub fn of(text: &'a str, most: Option<i32>) -> Option<Self> {
        let (word, rest) = text.split_once(':').unwrap_or((text, ""));
        let number = || rest.parse::<u8>().ok();
        Some(match word {
            "u8" => Self::Unsigned(1),
            "u16" => Self::Unsigned(2),
            "u24" => Self::Unsigned(3),
            "u32" => Self::Unsigned(4),
            "f32" => Self::Float,
            "date" => Self::Date,
            "time32" => Self::Time,
            // Four characters in three bytes.
            "packed" => Self::Packed(number().filter(|n| n.is_multiple_of(4))? / 4 * 3),
            "latin1" => Self::Latin(number()?),
            "enum" => Self::Named(1, rest),
            "enum16" => Self::Named(2, rest),
            "classification" => Self::Named(1, "classification"),
            "bits" => Self::Bits(1, rest),
            "bits16" => Self::Bits(2, rest),
            "unit" => Self::Unit,
            "variable" => Self::Variable,
            "variable-status" => Self::VariableStatus,
            "additional" => Self::Additional(number()?),
            "nibbles" => Self::Nibbles(rest),
            "split" => Self::Split,
            "repeat" => Self::Repeat(u8::try_from(most?).ok()?),
            "raw" => Self::Raw(number()?),
            _ => return None,
        })
    }

    /// Bytes of a field of fixed size.
    pub fn width(&self) -> u16 {
        match self {
            Self::Unsigned(n)
            | Self::Packed(n)
            | Self::Latin(n)
            | Self::Raw(n)
            | Self::Named(n, _)
            | Self::Bits(n, _) => u16::from(*n),
            Self::Float | Self::Time => 4,
            Self::Date => 3,
            Self::Unit
            | Self::Variable
            | Self::VariableStatus
            | Self::Additional(_)
            | Self::Split => 1,
            Self::Nibbles(_) | Self::Repeat(_) => 0,
        }
    }
}
