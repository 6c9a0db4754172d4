//! Records → Rust source of static tables. The rules hold by now, so every lookup succeeds.

use std::collections::BTreeMap;
use std::fmt::{self, Write};

use super::data::{Code, Data, Field, File};
use super::rules::STATUS;
use crate::emit::{doc_name, screaming};
use crate::types::{Device, Doc, TABLES};

/// The document that all of it is from.
const DOC: &str = "icon-mrt";

/// The text of `icon3000.rs`.
pub fn emit(data: &Data, device: &Device, docs: &[Doc]) -> String {
    let mut out = String::from("// Written by shared/build.rs from shared/data/icon3000.\n\n");
    // Writing to a String cannot fail.
    let _ = sets(data, &mut out);
    let _ = readings(data, &mut out);
    let _ = layouts(data, device, docs, &mut out);
    let _ = files(data, device, docs, &mut out);
    let _ = health(data, device, &mut out);
    let _ = mirrors(data, &mut out);
    out
}

fn sets(data: &Data, out: &mut String) -> fmt::Result {
    let mut sets: BTreeMap<&str, Vec<&Code>> = BTreeMap::new();
    for (_, code) in &data.codes {
        sets.entry(&code.set).or_default().push(code);
    }
    for (set, mut codes) in sets {
        codes.sort_by_key(|c| c.value);
        writeln!(
            out,
            "static SET_{}: Set = Set {{ name: {set:?}, bits: false, mask: 0, members: &[",
            screaming(set)
        )?;
        for c in codes {
            writeln!(
                out,
                "    Member {{ value: {0}, last: {0}, key: {1:?}, label: {2:?}, states: None }},",
                c.value, c.key, c.label
            )?;
        }
        writeln!(out, "] }};\n")?;
    }
    Ok(())
}

fn readings(data: &Data, out: &mut String) -> fmt::Result {
    writeln!(
        out,
        "/// Readings that no row of a map rests on.\npub static READINGS: [Reading; {}] = [",
        data.readings.len()
    )?;
    for (_, r) in &data.readings {
        let settled = match r.settled.as_str() {
            "yes" => "Yes",
            "likely" => "Likely",
            _ => "No",
        };
        writeln!(
            out,
            "    Reading {{ id: {:?}, settled: Settled::{settled}, text: {:?} }},",
            r.id, r.text
        )?;
    }
    writeln!(out, "];\n")
}

/// A reference to a reading, of the maps or of the files.
fn reading(data: &Data, device: &Device, id: &str) -> String {
    let of_map = device.readings.iter().position(|r| r.id == id);
    let own = data.readings.iter().position(|(_, r)| r.id == id);
    match (of_map, own) {
        (Some(at), _) => format!(
            "Some(&crate::map::{}_READINGS[{at}])",
            screaming(&device.key)
        ),
        (None, Some(at)) => format!("Some(&READINGS[{at}])"),
        (None, None) => "None".to_owned(),
    }
}

fn set(data: &Data, device: &Device, name: &str) -> String {
    if name.is_empty() {
        "None".to_owned()
    } else if data.codes.iter().any(|(_, c)| c.set == name) {
        format!("Some(&SET_{})", screaming(name))
    } else {
        format!(
            "Some(&crate::map::{}_SET_{})",
            screaming(&device.key),
            screaming(name)
        )
    }
}

fn layouts(data: &Data, device: &Device, docs: &[Doc], out: &mut String) -> fmt::Result {
    let mut done: Vec<&str> = Vec::new();
    for (_, field) in &data.fields {
        if done.contains(&field.layout.as_str()) {
            continue;
        }
        done.push(&field.layout);
        let layout = &field.layout;
        writeln!(
            out,
            "static LAYOUT_{}: Layout = Layout {{ key: {layout:?},",
            screaming(layout)
        )?;
        for part in ["head", "entry"] {
            writeln!(
                out,
                "    {part}_records: {}, {part}: &[",
                data.words(layout, part)
            )?;
            let mut offset = 0;
            for field in data.part(layout, part) {
                write_field(data, device, docs, field, offset, out)?;
                offset += field.all_words();
            }
            writeln!(out, "    ],")?;
        }
        writeln!(out, "}};\n")?;
    }
    Ok(())
}

fn write_field(
    data: &Data,
    device: &Device,
    docs: &[Doc],
    field: &Field,
    offset: u16,
    out: &mut String,
) -> fmt::Result {
    let kind = match field.r#type.as_str() {
        "u16" => "Unsigned",
        "i16" => "Signed",
        "enum" => "Enum",
        "bits" => "Bits",
        "stamp" => "Stamp",
        "ascii" => "Ascii",
        _ => "Unused",
    };
    let scale = crate::read::scale(&field.scale).filter(|_| !field.scale.is_empty());
    let scale = scale.map_or("Scale::ONE".to_owned(), |s| {
        format!("Scale::new({}, {}, {})", s.num, s.den, s.decimals)
    });
    let range = match (field.min, field.max) {
        (Some(min), Some(max)) => format!("Some(({min}, {max}))"),
        _ => "None".to_owned(),
    };
    let trust = if field.reading.is_empty() {
        "Manual"
    } else {
        "Reading"
    };
    writeln!(
        out,
        "        Field {{ key: {:?}, label: {:?}, kind: Kind::{kind}, offset: {offset}, words: {}, \
         count: {}, from: {}, scale: {scale}, unit: {:?}, set: {}, range: {range}, note: {:?}, \
         source: Source {{ doc: {:?}, part: \"table {}, p. {}\" }}, trust: Trust::{trust}, \
         reading: {} }},",
        field.key,
        field.label,
        field.words,
        field.count,
        field.from.unwrap_or(0),
        field.unit,
        set(data, device, &field.set),
        field.note,
        doc_name(docs, DOC),
        field.table,
        field.page,
        reading(data, device, &field.reading),
    )
}

fn files(data: &Data, device: &Device, docs: &[Doc], out: &mut String) -> fmt::Result {
    writeln!(
        out,
        "/// All files, by number.\npub static FILES: [File; {}] = [",
        data.files.len()
    )?;
    for (_, file) in &data.files {
        write_file(data, device, docs, file, out)?;
    }
    writeln!(out, "];\n")
}

fn write_file(
    data: &Data,
    device: &Device,
    docs: &[Doc],
    file: &File,
    out: &mut String,
) -> fmt::Result {
    let layout = if file.layout.is_empty() {
        "None".to_owned()
    } else {
        format!("Some(&LAYOUT_{})", screaming(&file.layout))
    };
    let numbering = match file.numbering.as_str() {
        "single" => "Single",
        "curves" => "Curves",
        _ => "Named(&SET_CARD)",
    };
    writeln!(
        out,
        "    File {{ key: {:?}, label: {:?}, item: {:?}, first: {}, last: {}, layout: {layout}, \
         numbering: Numbering::{numbering}, note: {:?}, \
         source: Source {{ doc: {:?}, part: \"{}, p. {}\" }}, reading: {} }},",
        file.key,
        file.label,
        file.item,
        file.first,
        file.last,
        file.note,
        doc_name(docs, DOC),
        file.part,
        file.page,
        reading(data, device, &file.reading),
    )
}

fn health(data: &Data, device: &Device, out: &mut String) -> fmt::Result {
    writeln!(
        out,
        "/// What bits and codes mean for the device.\npub static HEALTH: [Meaning; {}] = [",
        data.health.len()
    )?;
    for (_, line) in &data.health {
        let member = device
            .members
            .iter()
            .find(|m| m.set == line.set && m.key == line.key);
        let status = STATUS.iter().find(|s| s.0 == line.status);
        writeln!(
            out,
            "    Meaning {{ set: {:?}, value: {}, key: {:?}, label: {:?}, \
             status: Ne107::{}, reason: {:?}, check: {:?} }},",
            line.set,
            member.map_or(0, |m| m.value),
            line.key,
            member.map_or("", |m| m.label.as_str()),
            status.map_or("Failure", |s| s.1),
            line.reason,
            line.check,
        )?;
    }
    writeln!(out, "];")
}

fn mirrors(data: &Data, out: &mut String) -> fmt::Result {
    writeln!(
        out,
        "/// Places that show the value of a holding register once more (reading E44).\n\
         pub static MIRRORS: [Mirror; {}] = [",
        data.mirrors.len()
    )?;
    for (_, m) in &data.mirrors {
        let table = TABLES.iter().find(|t| t.0 == m.table).map_or("", |t| t.1);
        writeln!(
            out,
            "    Mirror {{ table: Table::{table}, address: Address::new({}), \
             home: Address::new({}), bit: {:?} }},",
            m.address, m.home, m.bit
        )?;
    }
    writeln!(out, "];")
}
