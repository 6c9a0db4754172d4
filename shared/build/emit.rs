//! Records → Rust source of static tables. The rules hold by now, so every lookup succeeds.

use std::collections::BTreeMap;
use std::fmt::{self, Write};

use crate::types::{
    ACCESS, Data, Device, Doc, EXTENTS, File, LEVELS, Member, Model, Row, SETTLED, TABLES, TRUST,
    Word,
};

/// The text of `maps.rs`.
pub fn maps(data: &Data) -> String {
    let mut out = String::from("// Written by shared/build.rs from shared/data.\n\n");
    // Writing to a String cannot fail.
    let _ = models(data, &mut out);
    for device in &data.devices {
        let _ = device_tables(device, &data.docs, &mut out);
    }
    out
}

/// The enumeration of all models.
fn models(data: &Data, out: &mut String) -> fmt::Result {
    let models: Vec<_> = data.devices.iter().flat_map(|d| &d.models).collect();
    writeln!(
        out,
        "/// The models that have a map; in a line of descent a later one has what the earlier ones have.\n\
         #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]\npub enum Model {{"
    )?;
    for m in &models {
        writeln!(out, "    /// {}.\n    {},", m.name, variant(&m.key))?;
    }
    writeln!(out, "}}\n\nimpl Model {{\n    /// All models.")?;
    writeln!(out, "    pub const ALL: [Self; {}] = [", models.len())?;
    for m in &models {
        writeln!(out, "        Self::{},", variant(&m.key))?;
    }
    writeln!(
        out,
        "    ];\n\n    /// The word used in JSON, configuration and the command line.\n    #[must_use]\n    \
         pub const fn key(self) -> &'static str {{\n        match self {{"
    )?;
    for m in &models {
        writeln!(out, "            Self::{} => {:?},", variant(&m.key), m.key)?;
    }
    writeln!(
        out,
        "        }}\n    }}\n\n    /// Its map.\n    #[must_use]\n    \
         pub fn map(self) -> &'static DeviceMap {{\n        match self {{"
    )?;
    for m in &models {
        writeln!(
            out,
            "            Self::{} => &{},",
            variant(&m.key),
            screaming(&m.key)
        )?;
    }
    writeln!(out, "        }}\n    }}\n}}\n")
}

fn device_tables(device: &Device, docs: &[Doc], out: &mut String) -> fmt::Result {
    let prefix = screaming(&device.key);
    sets(device, &prefix, out)?;
    readings(device, &prefix, out)?;
    functions(device, docs, &prefix, out)?;
    writeln!(
        out,
        "static {prefix}_ROWS: [Row; {}] = [",
        device.rows.len()
    )?;
    for row in &device.rows {
        if let Some(file) = device.files.get(row.file) {
            write_row(device, docs, file, row, &prefix, out)?;
        }
    }
    writeln!(out, "];\n")?;
    for position in 0..device.models.len() {
        map(device, docs, position, &prefix, out)?;
    }
    Ok(())
}

/// `esd_action` → `ESD_ACTION`, `ddc100-mx` → `DDC100_MX`.
pub fn screaming(key: &str) -> String {
    key.replace('-', "_").to_ascii_uppercase()
}

/// `icon3000v2` → `Icon3000v2`, `ddc100-mx` → `Ddc100Mx`, the variant of `map::Model`.
fn variant(key: &str) -> String {
    let capital = |part: &str| {
        let (first, rest) = part.split_at_checked(1).unwrap_or((part, ""));
        format!("{}{rest}", first.to_ascii_uppercase())
    };
    key.split('-').map(capital).collect()
}

fn name(words: &[Word], position: usize) -> &'static str {
    words.get(position).map_or("", |w| w.1)
}

fn sets(device: &Device, prefix: &str, out: &mut String) -> fmt::Result {
    let mut sets: BTreeMap<&str, Vec<&Member>> = BTreeMap::new();
    for member in &device.members {
        sets.entry(&member.set).or_default().push(member);
    }
    for (set, mut members) in sets {
        members.sort_by_key(|m| m.value);
        let bits = members.iter().any(|m| m.bits);
        let mask = members
            .iter()
            .filter(|m| m.bits)
            .fold(0_u32, |mask, m| mask | 1 << m.value);
        writeln!(
            out,
            "pub(crate) static {prefix}_SET_{}: Set = Set {{",
            screaming(set)
        )?;
        writeln!(
            out,
            "    name: {set:?}, bits: {bits}, mask: {mask:#x}, members: &["
        )?;
        for m in members {
            let states = if m.zero.is_empty() {
                "None".to_owned()
            } else {
                format!("Some(({:?}, {:?}))", m.zero, m.one)
            };
            writeln!(
                out,
                "        Member {{ value: {}, last: {}, key: {:?}, label: {:?}, states: {states} }},",
                m.value, m.last, m.key, m.label
            )?;
        }
        writeln!(out, "    ],\n}};\n")?;
    }
    Ok(())
}

fn readings(device: &Device, prefix: &str, out: &mut String) -> fmt::Result {
    let count = device.readings.len();
    writeln!(
        out,
        "pub(crate) static {prefix}_READINGS: [Reading; {count}] = ["
    )?;
    for r in &device.readings {
        let settled = name(SETTLED, r.settled);
        writeln!(
            out,
            "    Reading {{ id: {:?}, settled: Settled::{settled}, text: {:?} }},",
            r.id, r.text
        )?;
    }
    writeln!(out, "];\n")
}

fn functions(device: &Device, docs: &[Doc], prefix: &str, out: &mut String) -> fmt::Result {
    let count = device.functions.len();
    writeln!(out, "static {prefix}_FUNCTIONS: [Function; {count}] = [")?;
    for f in &device.functions {
        let part = format!("{}, p. {}", f.part, f.page.unwrap_or_default());
        writeln!(
            out,
            "    Function {{ code: {}, sub: {:?}, label: {:?}, note: {:?}, \
             source: Source {{ doc: {:?}, part: {part:?} }}, reading: {} }},",
            f.code,
            f.sub,
            f.label,
            f.note,
            doc_name(docs, &f.doc),
            reading(device, prefix, &f.reading),
        )?;
    }
    writeln!(out, "];\n")
}

fn write_row(
    device: &Device,
    docs: &[Doc],
    file: &File,
    row: &Row,
    prefix: &str,
    out: &mut String,
) -> fmt::Result {
    let set = if row.set.is_empty() {
        "None".to_owned()
    } else {
        format!("Some(&{prefix}_SET_{})", screaming(&row.set))
    };
    let scale = row.scale.map_or("Scale::ONE".to_owned(), |s| {
        format!("Scale::new({}, {}, {})", s.num, s.den, s.decimals)
    });
    let level = row.level.map_or("None".to_owned(), |l| {
        format!("Some(Level::{})", name(LEVELS, l))
    });
    let range = match (row.min, row.max) {
        (Some(min), Some(max)) => format!("Some(({min}, {max}))"),
        _ => "None".to_owned(),
    };
    let since = row.since.and_then(|since| device.models.get(since));
    let since = since.map_or("None".to_owned(), |m| {
        format!("Some(Model::{})", variant(&m.key))
    });
    let page = row.page.unwrap_or_default();
    let part = format!("{}, p. {page}", file.part);
    writeln!(
        out,
        "    Row {{ table: Table::{}, address: Address::new({}), words: {}, key: {:?}, label: {:?}, \
         kind: Kind::{}, scale: {scale}, unit: {:?}, set: {set}, access: Access::{}, level: {level}, \
         range: {range}, group: {:?}, since: {since}, note: {:?}, \
         source: Source {{ doc: {:?}, part: {part:?} }}, trust: Trust::{}, reading: {} }},",
        name(TABLES, file.table),
        row.address,
        row.words,
        row.key,
        row.label,
        row.kind.variant,
        row.unit,
        name(ACCESS, row.access),
        row.group,
        row.note,
        doc_name(docs, &file.doc),
        name(TRUST, row.trust),
        reading(device, prefix, &row.reading),
    )
}

/// A reference to the reading with this id.
fn reading(device: &Device, prefix: &str, id: &str) -> String {
    device
        .readings
        .iter()
        .position(|r| r.id == id)
        .map_or("None".to_owned(), |index| {
            format!("Some(&{prefix}_READINGS[{index}])")
        })
}

pub fn doc_name<'a>(docs: &'a [Doc], key: &str) -> &'a str {
    docs.iter()
        .find(|d| d.key == key)
        .map_or("", |d| d.name.as_str())
}

/// A stretch of addresses that a model lacks.
struct Gap<'a> {
    since: &'a Model,
    file: &'a File,
    start: u16,
    end: u32,
}

/// The map of one model: references to shared rows, and a row of its own for each gap.
fn map(
    device: &Device,
    docs: &[Doc],
    position: usize,
    prefix: &str,
    out: &mut String,
) -> fmt::Result {
    let Some(model) = device.models.get(position) else {
        return Ok(());
    };
    let own = screaming(&model.key);
    let mut gaps: Vec<Gap<'_>> = Vec::new();
    let mut items: Vec<String> = Vec::new();
    let mut keys: Vec<u32> = Vec::new();
    for table in 0..TABLES.len() {
        let mut rows = device.rows_of(position, table);
        rows.sort_by_key(|(_, row)| row.address);
        for (index, row) in rows {
            let key = (table as u32) << 16 | u32::from(row.address);
            let later = row.since.filter(|since| *since > position);
            let Some(later) = later else {
                keys.push(key);
                items.push(format!("&{prefix}_ROWS[{index}]"));
                continue;
            };
            let (Some(since), Some(file)) = (device.models.get(later), device.files.get(row.file))
            else {
                continue;
            };
            match gaps.last_mut() {
                Some(gap)
                    if gap.end == u32::from(row.address)
                        && gap.since.key == since.key
                        && gap.file.table == table =>
                {
                    gap.end = row.end();
                }
                _ => {
                    keys.push(key);
                    items.push(format!("&{own}_ABSENT[{}]", gaps.len()));
                    gaps.push(Gap {
                        since,
                        file,
                        start: row.address,
                        end: row.end(),
                    });
                }
            }
        }
    }
    if !gaps.is_empty() {
        writeln!(out, "static {own}_ABSENT: [Row; {}] = [", gaps.len())?;
        for gap in &gaps {
            write_gap(device, docs, gap, prefix, out)?;
        }
        writeln!(out, "];\n")?;
    }
    writeln!(out, "/// The map of {}.", model.name)?;
    writeln!(out, "pub static {own}: DeviceMap = DeviceMap {{")?;
    writeln!(
        out,
        "    model: Model::{}, name: {:?},",
        variant(&model.key),
        model.name
    )?;
    let known = device.functions.iter().enumerate();
    let known = known.filter(|(_, f)| (f.first..=f.last).contains(&position));
    let codes = known
        .clone()
        .filter(|(_, f)| f.sub.is_none())
        .fold(0_u128, |codes, (_, f)| codes | 1 << f.code);
    // A program that never shows these devices keeps the name of a map only.
    let (only, none) = match device.key.as_str() {
        "ddc100" => ("if cfg!(feature = \"ddc100\") { ", " } else { &[] }"),
        _ => ("", ""),
    };
    writeln!(
        out,
        "    whole: {}, last_unit: {}, codes: {codes:#x}, functions: {only}&[",
        name(EXTENTS, model.extent),
        model.units
    )?;
    for (index, _) in known {
        writeln!(out, "        &{prefix}_FUNCTIONS[{index}],")?;
    }
    writeln!(out, "    ]{none},")?;
    writeln!(
        out,
        "    readings: {only}&{prefix}_READINGS{none}, rows: {only}&["
    )?;
    for item in items {
        writeln!(out, "        {item},")?;
    }
    writeln!(out, "    ]{none},\n    keys: {only}&{keys:?}{none},\n}};\n")
}

fn write_gap(
    device: &Device,
    docs: &[Doc],
    gap: &Gap<'_>,
    prefix: &str,
    out: &mut String,
) -> fmt::Result {
    writeln!(
        out,
        "    Row {{ table: Table::{}, address: Address::new({start}), words: {}, \
         key: \"absent_{start}\", label: {:?}, kind: Kind::Reserved, scale: Scale::ONE, unit: \"\", \
         set: None, access: Access::Absent, level: None, range: None, group: \"Reserved\", \
         since: Some(Model::{}), note: \"\", source: Source {{ doc: {:?}, part: {:?} }}, \
         trust: Trust::Reading, reading: {} }},",
        name(TABLES, gap.file.table),
        gap.end.saturating_sub(u32::from(gap.start)),
        gap.since.absent,
        variant(&gap.since.key),
        doc_name(docs, &gap.file.doc),
        gap.since.part,
        reading(device, prefix, &gap.since.reading),
        start = gap.start,
    )
}
