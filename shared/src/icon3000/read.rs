//! Records as typed values.

use std::borrow::Cow;

use super::judge;
use super::model::{Field, File, Kind, Layout};
use super::records::Records;
use crate::map::decode::Judged;
use crate::render::text_of;
use crate::value::{Quality, Value};

/// One value of a file, with the words it was read from.
#[derive(Clone, Debug, PartialEq)]
pub struct Item {
    /// What it is.
    pub field: &'static Field,
    /// Which value of a run, from 0.
    pub index: u16,
    /// Its first record in the file.
    pub record: u16,
    /// Its words.
    pub words: Vec<u16>,
    /// What it says.
    pub value: Value,
    /// How much it can be relied on.
    pub quality: Quality,
}

impl Item {
    fn new(field: &'static Field, index: u16, record: u16, words: Vec<u16>) -> Self {
        let judged = value(field, &words);
        Self {
            field,
            index,
            record,
            words,
            value: judged.value,
            quality: judged.quality,
        }
    }

    /// What people read.
    #[must_use]
    pub fn label(&self) -> Cow<'static, str> {
        self.field.label_of(self.index)
    }

    /// The value in words, without its unit.
    #[must_use]
    pub fn text(&self) -> String {
        match self.value {
            Value::Text => text_of(&bytes(&self.words)),
            Value::Raw => self.raw(),
            value => value.to_string(),
        }
    }

    /// The value in words, with its unit.
    #[must_use]
    pub fn text_with_unit(&self) -> String {
        match self.value {
            Value::Number { .. } if !self.field.unit.is_empty() => {
                format!("{} {}", self.text(), self.field.unit)
            }
            _ => self.text(),
        }
    }

    /// Its words in hexadecimal, with a blank between each.
    #[must_use]
    pub fn raw(&self) -> String {
        let words: Vec<_> = self.words.iter().map(|w| format!("{w:04X}")).collect();
        words.join(" ")
    }

    /// Raw counts of a number or code.
    #[must_use]
    pub const fn number(&self) -> Option<i64> {
        match self.value {
            Value::Number { raw, .. } => Some(raw),
            _ => None,
        }
    }

    /// Seconds since 2000 of a time.
    #[must_use]
    pub const fn time(&self) -> Option<u32> {
        match self.value {
            Value::DeviceTime(seconds) => Some(seconds),
            _ => None,
        }
    }
}

/// Words as bytes, high byte first.
#[must_use]
pub fn bytes(words: &[u16]) -> Vec<u8> {
    words.iter().flat_map(|w| w.to_be_bytes()).collect()
}

/// The value of a field from the words of one value.
///
/// A code without a name and a number outside its range keep their raw value and say so.
#[must_use]
pub fn value(field: &'static Field, words: &[u16]) -> Judged {
    let long = |words: &[u16]| {
        words
            .iter()
            .fold(0_u32, |all, w| all.wrapping_shl(16) | u32::from(*w))
    };
    let one = words.first().copied().unwrap_or(0);
    let good = |value| Judged {
        value,
        quality: Quality::Good,
    };
    match (field.kind, field.set) {
        (Kind::Unsigned, _) => number(field, i64::from(one)),
        (Kind::Signed, _) => signed(field, one.cast_signed()),
        (Kind::Enum, Some(set)) => Judged {
            value: Value::Code {
                raw: one.into(),
                set,
            },
            quality: if set.get(one.into()).is_some() {
                Quality::Good
            } else {
                Quality::Invalid
            },
        },
        (Kind::Bits, Some(set)) => good(Value::Flags {
            raw: long(words),
            set,
        }),
        (Kind::Stamp, _) => good(Value::DeviceTime(long(words))),
        (Kind::Ascii, _) => text(words),
        (Kind::Unused | Kind::Enum | Kind::Bits, _) => good(Value::Raw),
    }
}

/// Reading E20: two's complement; in a record of -127 to 127, a word of 129 to 255 can only be an
/// 8-bit value that was widened without its sign.
fn signed(field: &Field, raw: i16) -> Judged {
    if field.range == Some((-127, 127)) && (129..=255).contains(&raw) {
        return Judged {
            value: Value::Number {
                raw: i64::from(raw).saturating_sub(256),
                scale: field.scale,
            },
            quality: Quality::Disputed,
        };
    }
    number(field, raw.into())
}

fn number(field: &Field, raw: i64) -> Judged {
    let within = field
        .range
        .is_none_or(|(min, max)| (i64::from(min)..=i64::from(max)).contains(&raw));
    Judged {
        value: Value::Number {
            raw,
            scale: field.scale,
        },
        quality: if within {
            Quality::Good
        } else {
            Quality::OutOfRange
        },
    }
}

/// Reading E19: padding with blanks or zeros is not stated, so both are.
fn text(words: &[u16]) -> Judged {
    let bytes = bytes(words);
    if bytes.iter().all(|b| matches!(b, 0 | b' ')) {
        return Judged {
            value: Value::Unavailable("empty"),
            quality: Quality::Good,
        };
    }
    let printable = bytes.iter().all(|b| matches!(b, 0 | 0x20..=0x7E | 0xA0..));
    Judged {
        value: Value::Text,
        quality: if printable {
            Quality::Good
        } else {
            Quality::Invalid
        },
    }
}

/// One entry of a log.
#[derive(Clone, Debug, PartialEq)]
pub struct Entry {
    /// Its number, from 1: the latest.
    pub number: u16,
    /// Its values in the order of the layout; `None` where a record was not read.
    pub items: Vec<Option<Item>>,
}

impl Entry {
    /// The value with this key.
    #[must_use]
    pub fn get(&self, key: &str) -> Option<&Item> {
        self.items.iter().flatten().find(|i| i.field.key == key)
    }

    /// When it happened: seconds since 2000 by the clock of the device.
    #[must_use]
    pub fn time(&self) -> Option<u32> {
        self.get("time").and_then(Item::time)
    }

    /// True if no whole value of it was read.
    #[must_use]
    pub fn is_unread(&self) -> bool {
        self.items.iter().all(Option::is_none)
    }
}

/// What is wrong with the records of a file, and where.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RecordProblem {
    /// The record.
    pub record: u16,
    /// What happened and what it means.
    pub text: String,
}

/// A file as values: a log with its entries, or a curve or report with its head only.
#[derive(Clone, Debug, PartialEq)]
pub struct Log {
    /// Which file, or run of files.
    pub file: &'static File,
    /// Its number.
    pub number: u16,
    /// The values of the head, runs spread out; `None` where a record was not read.
    pub head: Vec<Option<Item>>,
    /// Entries that record 0 announces; `None` if it was not read or the file is no log.
    pub stored: Option<u16>,
    /// Entries of which a record was read, the latest first, by number.
    pub entries: Vec<Entry>,
    /// True if everything was read that the file should have.
    pub complete: bool,
    /// What is wrong.
    pub problems: Vec<RecordProblem>,
}

impl Log {
    /// Reads the records of a file. `None` if the manual does not describe it: then only
    /// [`Records::iter`] tells its words.
    #[must_use]
    pub fn read(number: u16, records: &Records) -> Option<Self> {
        let file = File::of(number)?;
        let layout = file.layout?;
        let mut problems = Vec::new();
        let head = items(layout.head, 0, records);
        let stored = records.announced(layout);
        let entries = entries(layout, records);
        judge::judge(layout, records, &head, &entries, stored, &mut problems);
        Some(Self {
            file,
            number,
            head,
            stored,
            entries,
            complete: records.is_complete(number),
            problems,
        })
    }

    /// The value of the head with this key; the first of a run.
    #[must_use]
    pub fn get(&self, key: &str) -> Option<&Item> {
        self.head.iter().flatten().find(|i| i.field.key == key)
    }

    /// All values of a run, `None` where a record was not read.
    #[must_use]
    pub fn run(&self, key: &str) -> Vec<Option<&Item>> {
        let Some(field) = self.file.layout.and_then(|l| l.head_field(key)) else {
            return Vec::new();
        };
        (0..field.count)
            .map(|index| {
                self.head
                    .iter()
                    .flatten()
                    .find(|i| i.field == field && i.index == index)
            })
            .collect()
    }

    /// What the file is called.
    #[must_use]
    pub fn name(&self) -> Cow<'static, str> {
        self.file.name(self.number)
    }
}

fn items(fields: &'static [Field], start: u16, records: &Records) -> Vec<Option<Item>> {
    let mut found = Vec::new();
    for field in fields {
        for index in 0..field.count {
            let into = field
                .offset
                .saturating_add(index.saturating_mul(field.words));
            let record = start.saturating_add(into);
            let words = records.run(record, field.words);
            found.push(words.map(|words| Item::new(field, index, record, words)));
        }
    }
    found
}

fn entries(layout: &'static Layout, records: &Records) -> Vec<Entry> {
    let mut found = Vec::new();
    if !layout.is_log() {
        return found;
    }
    let mut before = 0;
    for (record, _) in records.iter() {
        let Some(number) = layout.slot(record).and_then(|s| s.entry) else {
            continue;
        };
        if number == before {
            continue;
        }
        before = number;
        let start = number
            .saturating_sub(1)
            .saturating_mul(layout.entry_records)
            .saturating_add(layout.head_records);
        found.push(Entry {
            number,
            items: items(layout.entry, start, records),
        });
    }
    found
}
