//! What the file says, before it is checked.

use serde::Deserialize;
use toml::Spanned;

/// The whole file.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Data {
    pub defaults: Defaults,
    #[serde(rename = "object")]
    pub objects: Vec<Spanned<Object>>,
    #[serde(rename = "layout")]
    pub layouts: Vec<Spanned<Layout>>,
    #[serde(rename = "set")]
    pub sets: Vec<Spanned<Set>>,
    #[serde(rename = "reading")]
    pub readings: Vec<Spanned<Reading>>,
}

/// Readings that concern every field of a kind.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Defaults {
    pub time: Vec<String>,
    pub text: Vec<String>,
    pub points: Vec<String>,
    pub temperature: Vec<String>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Object {
    pub id: u16,
    pub key: String,
    pub label: String,
    pub group: String,
    pub shape: String,
    pub section: String,
    pub page: Option<u16>,
    #[serde(default)]
    pub note: String,
    #[serde(default)]
    pub readings: Vec<String>,
    pub options: Vec<Spanned<Choice>>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Choice {
    pub option: u16,
    pub key: String,
    pub label: String,
    pub layout: String,
    /// Which variant of the layout.
    pub points: Option<u16>,
    /// Layouts that the number of registers can choose; all variants of each.
    #[serde(default)]
    pub others: Vec<String>,
    pub command: Option<String>,
    /// The request word as printed.
    pub printed: Option<String>,
    #[serde(default)]
    pub readings: Vec<String>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Layout {
    pub key: String,
    pub section: String,
    pub page: Option<u16>,
    /// Variants by their number of points.
    #[serde(default)]
    pub points: Vec<u16>,
    /// What a point of each variant is.
    #[serde(default)]
    pub steps: Vec<String>,
    pub words: OneOrMany<u16>,
    pub record: Option<Record>,
    pub reading: Option<String>,
    pub fields: Vec<Spanned<Field>>,
}

#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Record {
    pub stride: u16,
    pub max: u16,
}

/// One value, or one for each variant of a layout.
#[derive(Debug, Deserialize)]
#[serde(untagged)]
pub enum OneOrMany<T> {
    One(T),
    Many(Vec<T>),
}

impl<T> OneOrMany<T> {
    /// The value for a variant.
    pub fn get(&self, variant: usize) -> Option<&T> {
        match self {
            Self::One(value) => Some(value),
            Self::Many(values) => values.get(variant),
        }
    }
}

/// A number of values: given, or that of the points.
#[derive(Debug, Deserialize)]
#[serde(untagged)]
pub enum Count {
    Of(u16),
    Points(String),
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Field {
    pub key: String,
    pub label: String,
    #[serde(rename = "type")]
    pub kind: String,
    /// Where the manual has it; empty if it does not say.
    pub printed: OneOrMany<String>,
    pub count: Option<Count>,
    /// Bytes of a text.
    pub text: Option<u16>,
    #[serde(default)]
    pub unit: String,
    pub scale: Option<String>,
    #[serde(default)]
    pub set: String,
    pub part: Option<String>,
    pub axis: Option<String>,
    pub first: Option<u16>,
    #[serde(default)]
    pub record: bool,
    pub setting: Option<String>,
    #[serde(default)]
    pub readings: Vec<String>,
    pub trust: Option<String>,
    #[serde(default)]
    pub note: String,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Set {
    pub name: String,
    pub bits: bool,
    #[serde(default)]
    pub members: Vec<Member>,
    /// Members that only have numbers.
    pub numbered: Option<Numbered>,
}

/// Value, key, label, and for a bit what 0 and 1 mean.
#[derive(Clone, Debug, Deserialize)]
#[serde(untagged)]
pub enum Member {
    Plain(u16, String, String),
    States(u16, String, String, String, String),
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Numbered {
    pub label: String,
    pub count: u16,
}

impl Member {
    pub fn value(&self) -> u16 {
        match self {
            Self::Plain(value, ..) | Self::States(value, ..) => *value,
        }
    }

    pub fn key(&self) -> &str {
        match self {
            Self::Plain(_, key, _) | Self::States(_, key, ..) => key,
        }
    }

    pub fn label(&self) -> &str {
        match self {
            Self::Plain(_, _, label) | Self::States(_, _, label, ..) => label,
        }
    }
}

impl Set {
    /// All members, those with numbers only included.
    pub fn all(&self) -> Vec<Member> {
        let mut members = self.members.clone();
        if let Some(numbered) = &self.numbered {
            members.extend((0..numbered.count).map(|bit| {
                Member::Plain(
                    bit,
                    format!("bit_{bit}"),
                    format!("{} {bit}", numbered.label),
                )
            }));
        }
        members
    }
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Reading {
    pub id: String,
    pub settled: String,
    pub text: String,
    /// What it is about, if that is no field, object or option.
    pub concerns: Option<String>,
}
