//! Records → Rust source of static tables. The rules hold by now, so every lookup succeeds.
//!
//! Fields are written once for each object that can have them, because a field knows its object.

use std::fmt::{self, Write};

use super::Objects;
use super::data::{Choice, Data, Field, Layout, Member, Object, Set};
use super::place::{self, KINDS, Placed};
use crate::types::{Doc, SETTLED};

/// Units of each temperature: the default, and the other one that a profile can choose.
const FAHRENHEIT: (&str, &str) = ("°C", "°F");

/// The text of `dop.rs`.
pub fn emit(objects: &Objects, docs: &[Doc]) -> String {
    let mut out = String::from("// Written by shared/build.rs from shared/data/dop.\n\n");
    let doc = docs
        .iter()
        .find(|d| d.key == "dop")
        .map_or("", |d| d.name.as_str());
    let emitter = Emitter {
        data: &objects.data,
        doc,
    };
    // Writing to a String cannot fail.
    let _ = emitter.all(&mut out);
    out
}

struct Emitter<'a> {
    data: &'a Data,
    doc: &'a str,
}

/// `vibration_trend_24` → `VIBRATION_TREND_24`.
fn screaming(key: &str) -> String {
    key.to_ascii_uppercase()
}

/// `high_low` → `HighLow`, the variant of an enumeration.
fn variant(key: &str) -> String {
    key.split('_')
        .map(|word| {
            let (first, rest) = word.split_at_checked(1).unwrap_or((word, ""));
            format!("{}{rest}", first.to_ascii_uppercase())
        })
        .collect()
}

impl Emitter<'_> {
    fn all(&self, out: &mut String) -> fmt::Result {
        writeln!(
            out,
            "/// All readings of the manual, as `dop.md` numbers them."
        )?;
        writeln!(
            out,
            "pub static READINGS: [Reading; {}] = [",
            self.data.readings.len()
        )?;
        for reading in &self.data.readings {
            let reading = reading.get_ref();
            let settled = SETTLED
                .iter()
                .find(|s| s.0 == reading.settled)
                .map_or("", |s| s.1);
            writeln!(
                out,
                "    Reading {{ id: {:?}, settled: Settled::{settled}, text: {:?} }},",
                reading.id, reading.text
            )?;
        }
        writeln!(out, "];\n")?;
        for set in &self.data.sets {
            self.set(set.get_ref(), out)?;
        }
        for object in &self.data.objects {
            self.layouts(object.get_ref(), out)?;
        }
        writeln!(out, "/// All objects, by number.")?;
        writeln!(
            out,
            "pub static OBJECTS: [Object; {}] = [",
            self.data.objects.len()
        )?;
        for object in &self.data.objects {
            self.object(object.get_ref(), out)?;
        }
        writeln!(out, "];")
    }

    fn set(&self, set: &Set, out: &mut String) -> fmt::Result {
        let mut members = set.all();
        members.sort_by_key(Member::value);
        let mask = members
            .iter()
            .filter(|_| set.bits)
            .fold(0_u32, |mask, m| mask | 1 << m.value());
        let name = &set.name;
        writeln!(out, "/// The set `{name}`.")?;
        writeln!(out, "pub static {}: Set = Set {{", screaming(name))?;
        writeln!(
            out,
            "    name: {name:?}, bits: {}, mask: {mask:#x}, members: &[",
            set.bits
        )?;
        for member in &members {
            let states = match member {
                Member::Plain(..) => "None".to_owned(),
                Member::States(_, _, _, zero, one) => format!("Some(({zero:?}, {one:?}))"),
            };
            writeln!(
                out,
                "        Member {{ value: {0}, last: {0}, key: {1:?}, label: {2:?}, states: {states} }},",
                member.value(),
                member.key(),
                member.label()
            )?;
        }
        writeln!(out, "    ],\n}};\n")
    }

    fn reading(&self, id: &str) -> String {
        let found = self.data.readings.iter().position(|r| r.get_ref().id == id);
        found.map_or(String::new(), |index| format!("&READINGS[{index}]"))
    }

    /// `Some(..)` of the first id, and the list of the rest.
    fn readings(&self, ids: &[&str]) -> (String, String) {
        let all: Vec<String> = ids.iter().map(|id| self.reading(id)).collect();
        match all.split_first() {
            None => ("None".to_owned(), "&[]".to_owned()),
            Some((first, rest)) => (format!("Some({first})"), format!("&[{}]", rest.join(", "))),
        }
    }

    fn source(&self, section: &str, page: Option<u16>) -> String {
        let page = page.map_or(String::new(), |page| format!(", p. {page}"));
        format!(
            "Source {{ doc: {:?}, part: {:?} }}",
            self.doc,
            format!("section {section}{page}")
        )
    }

    fn layouts(&self, object: &Object, out: &mut String) -> fmt::Result {
        for (layout, index) in place::used(self.data, object) {
            let key = place::key(layout, index);
            let name = format!("D{}_{}", object.id, screaming(&key));
            let fields = place::place(layout, index);
            for placed in fields.iter().filter(|p| p.field.unit == FAHRENHEIT.0) {
                writeln!(
                    out,
                    "static {name}_{}: Field = {};",
                    screaming(&placed.field.key),
                    self.field(object, layout, index, placed, FAHRENHEIT.1, "None")
                )?;
            }
            writeln!(out, "static {name}: Layout = Layout {{")?;
            let words = layout.words.get(index).copied().unwrap_or_default();
            let record = layout.record.map_or("None".to_owned(), |r| {
                format!("Some(Record {{ stride: {}, max: {} }})", r.stride, r.max)
            });
            let reading = layout.reading.as_deref().map_or("None".to_owned(), |id| {
                format!("Some({})", self.reading(id))
            });
            writeln!(
                out,
                "    key: {key:?}, words: {words}, record: {record}, reading: {reading}, fields: &["
            )?;
            for placed in &fields {
                let twin = if placed.field.unit == FAHRENHEIT.0 {
                    format!("Some(&{name}_{})", screaming(&placed.field.key))
                } else {
                    "None".to_owned()
                };
                let unit = &placed.field.unit;
                writeln!(
                    out,
                    "        {},",
                    self.field(object, layout, index, placed, unit, &twin)
                )?;
            }
            writeln!(out, "    ],\n}};\n")?;
        }
        Ok(())
    }

    fn field(
        &self,
        object: &Object,
        layout: &Layout,
        index: usize,
        placed: &Placed<'_>,
        unit: &str,
        twin: &str,
    ) -> String {
        let field = placed.field;
        let kind = KINDS.iter().find(|k| k.0 == field.kind).map_or("", |k| k.2);
        let kind = if kind == "Text" {
            format!("Text({})", placed.words)
        } else {
            kind.to_owned()
        };
        let set = if field.set.is_empty() {
            "None".to_owned()
        } else {
            format!("Some(&{})", screaming(&field.set))
        };
        let (reading, also) = self.readings(&place::readings(self.data, field));
        let trust = match (&field.trust, reading.as_str()) {
            (Some(trust), _) => variant(trust),
            (None, "None") => "Manual".to_owned(),
            (None, _) => "Reading".to_owned(),
        };
        let setting = match (&field.setting, unit) {
            (Some(setting), _) => format!("Some(Setting::{})", variant(setting)),
            (None, "°C" | "°F") => "Some(Setting::Temperature)".to_owned(),
            (None, _) => "None".to_owned(),
        };
        let limit = field
            .first
            .map_or("None".to_owned(), |first| format!("Some({first})"));
        format!(
            "Field {{ object: {}, at: {}, count: {}, kind: FieldKind::{kind}, key: {:?}, label: {:?}, \
             unit: {unit:?}, scale: {}, set: {set}, part: Part::{}, axis: {}, limit: {limit}, \
             record: {}, setting: {setting}, fahrenheit: {twin}, source: {}, trust: Trust::{trust}, \
             reading: {reading}, also: {also}, note: {:?} }}",
            object.id,
            placed.at,
            placed.count,
            field.key,
            field.label,
            scale(field),
            field.part.as_deref().map_or("Other".to_owned(), variant),
            axis(layout, index, field),
            field.record,
            self.source(&layout.section, layout.page),
            field.note,
        )
    }

    fn object(&self, object: &Object, out: &mut String) -> fmt::Result {
        let ids: Vec<&str> = object.readings.iter().map(String::as_str).collect();
        let (reading, also) = self.readings(&ids);
        writeln!(
            out,
            "    Object {{ id: {}, key: {:?}, label: {:?}, group: Group::{}, shape: Shape::{}, \
             section: {}, note: {:?}, reading: {reading}, also: {also}, options: &[",
            object.id,
            object.key,
            object.label,
            variant(&object.group),
            variant(&object.shape),
            self.source(&object.section, object.page),
            object.note,
        )?;
        for choice in &object.options {
            self.choice(object, choice.get_ref(), out)?;
        }
        writeln!(out, "    ] }},")
    }

    fn choice(&self, object: &Object, choice: &Choice, out: &mut String) -> fmt::Result {
        let name = |layout: &Layout, index: usize| {
            let key = place::key(layout, index);
            format!("&D{}_{}", object.id, screaming(&key))
        };
        let Some(layout) = place::layout(self.data, &choice.layout) else {
            return Ok(());
        };
        let own = place::variant(layout, choice.points).map_or(String::new(), |i| name(layout, i));
        let others: Vec<String> = choice
            .others
            .iter()
            .filter_map(|key| place::layout(self.data, key))
            .flat_map(|layout| (0..place::variants(layout)).map(move |i| (layout, i)))
            .map(|(layout, i)| name(layout, i))
            .filter(|other| *other != own)
            .collect();
        let command = choice.command.as_deref().map_or("None".to_owned(), |c| {
            format!("Some(LogCommand::{})", variant(c))
        });
        let ids: Vec<&str> = choice.readings.iter().map(String::as_str).collect();
        let (reading, _) = self.readings(&ids);
        let trust = if ids.is_empty() { "Manual" } else { "Reading" };
        writeln!(
            out,
            "        Choice {{ option: {}, key: {:?}, label: {:?}, layout: {own}, others: &[{}], \
             command: {command}, trust: Trust::{trust}, reading: {reading} }},",
            choice.option,
            choice.key,
            choice.label,
            others.join(", ")
        )
    }
}

/// `0.1` is one tenth.
fn scale(field: &Field) -> String {
    let Some(text) = &field.scale else {
        return "Scale::ONE".to_owned();
    };
    let decimals = text.split_once('.').map_or(0, |(_, tail)| tail.len());
    format!(
        "Scale::new(1, {}, {decimals})",
        10_u32.pow(u32::try_from(decimals).unwrap_or(0))
    )
}

/// What the elements stand for: steps back in time, axes, or bins as in `0+0.4 G`.
fn axis(layout: &Layout, index: usize, field: &Field) -> String {
    match field.axis.as_deref() {
        None => "Axis::One".to_owned(),
        Some("xyz") => "Axis::Xyz".to_owned(),
        Some("ago") => {
            let step = layout.steps.get(index).map_or("", String::as_str);
            format!("Axis::Ago({step:?})")
        }
        Some(bins) => {
            let (from, step, unit) = super::rules::bins(bins).unwrap_or_default();
            format!("Axis::Bins {{ from: {from}, step: {step}, unit: {unit:?} }}")
        }
    }
}
