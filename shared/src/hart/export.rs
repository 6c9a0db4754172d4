//! Everything that is known of a family, one JSON object a line: commands with their fields,
//! status bits, names of codes, units, response codes, times of the link, examples of the condensed
//! status map.

use core::fmt::{self, Write};

use super::model::{Bits, Command, Form, Item, Kind};
use super::ne107::Map;
use super::shape::width;
use super::{
    ADDITIONAL, BITS_SETS, CODES, COMMANDS, CONDENSED_STATUS, ENUM_SETS, MANUFACTURER, PRESETS,
    RESPONSE_CODES_SOURCE, TIMERS, TIMERS_SOURCE, UNITS, UNITS_SOURCE,
};
use crate::device::Family;
use crate::json::Quoted;
use crate::map::row::{Reading, Source, Trust};

/// Writes all lines for a family.
///
/// # Errors
/// Only if writing fails.
pub fn write(out: &mut impl Write, family: Family) -> fmt::Result {
    for command in &COMMANDS {
        write_command(out, family, command)?;
        for (role, forms) in [("request", command.request), ("response", command.response)] {
            for form in forms {
                write_form(out, family, command, role, form)?;
            }
        }
    }
    for bits in BITS_SETS {
        write_bits(out, family, bits.set.name, bits)?;
    }
    let own = ADDITIONAL.iter().find(|(f, _)| *f == family);
    for (byte, bits) in own.iter().flat_map(|(_, bytes)| bytes.iter().enumerate()) {
        if let Some(bits) = bits {
            write_bits(out, family, &format!("byte_{byte}"), bits)?;
        }
    }
    for names in ENUM_SETS.into_iter().chain([&MANUFACTURER]) {
        for member in names.set.members {
            write!(
                out,
                r#"{{"device":"{}","kind":"code","set":"{}","code":{},"key":"{}","label":{}"#,
                family.key(),
                names.set.name,
                member.value,
                member.key,
                Quoted(member.label)
            )?;
            write_source(out, names.source)?;
            out.write_str("}\n")?;
        }
    }
    for unit in &UNITS {
        write!(
            out,
            r#"{{"device":"{}","kind":"unit","code":{},"classification":"#,
            family.key(),
            unit.code
        )?;
        match unit.class {
            0 => out.write_str("null")?,
            class => write!(out, "{class}")?,
        }
        let text = if unit.symbol.is_empty() {
            unit.name
        } else {
            unit.symbol
        };
        write!(out, r#","text":{}"#, Quoted(text))?;
        write_source(out, UNITS_SOURCE)?;
        // What depends on a classification rests on this one.
        let why = super::reading("G24").filter(|_| unit.class != 0);
        write_readings(out, why.as_slice())?;
        out.write_str("}\n")?;
    }
    write_codes(out, family)?;
    write_timers(out, family)?;
    write_presets(out, family)
}

/// Response codes by class, with what they mean for every command.
fn write_codes(out: &mut impl Write, family: Family) -> fmt::Result {
    for codes in &CODES {
        write!(
            out,
            r#"{{"device":"{}","kind":"response_code","first":{},"last":{},"class":"{}","label":{}"#,
            family.key(),
            codes.first,
            codes.last,
            codes.class.key(),
            Quoted(codes.label)
        )?;
        write_source(out, RESPONSE_CODES_SOURCE)?;
        write_readings(out, codes.reading.as_slice())?;
        out.write_str("}\n")?;
    }
    Ok(())
}

/// Times of the link.
fn write_timers(out: &mut impl Write, family: Family) -> fmt::Result {
    for timer in &TIMERS {
        write!(
            out,
            r#"{{"device":"{}","kind":"timer","key":"{}","label":{},"characters":{},"micros":{},"note":{}"#,
            family.key(),
            timer.key,
            Quoted(timer.label),
            timer.characters,
            timer.micros(),
            Quoted(timer.note)
        )?;
        write_source(out, TIMERS_SOURCE)?;
        write_readings(out, timer.reading.as_slice())?;
        out.write_str("}\n")?;
    }
    Ok(())
}

/// What the manual's example of the condensed status map for this family maps.
fn write_presets(out: &mut impl Write, family: Family) -> fmt::Result {
    for preset in PRESETS.iter().filter(|p| p.family == family) {
        for bit in preset.bits {
            write!(
                out,
                r#"{{"device":"{}","kind":"preset","key":"{}","label":{},"byte":{},"bit":{},"index":{},"category":{},"category_label":{}"#,
                family.key(),
                preset.key,
                Quoted(preset.label),
                bit.byte,
                bit.bit,
                Map::index(bit.byte, bit.bit),
                bit.category,
                Quoted(CONDENSED_STATUS.name(bit.category.into()).unwrap_or(""))
            )?;
            write_source(out, bit.source)?;
            write_readings(out, bit.reading.as_slice())?;
            out.write_str("}\n")?;
        }
    }
    Ok(())
}

fn write_command(out: &mut impl Write, family: Family, command: &Command) -> fmt::Result {
    write!(
        out,
        r#"{{"device":"{}","kind":"command","command":{},"key":"{}","label":{},"group":"{}","effects":["#,
        family.key(),
        command.number,
        command.key,
        Quoted(command.label),
        command.group.key()
    )?;
    for (at, effect) in command.effects.iter().enumerate() {
        let comma = if at > 0 { "," } else { "" };
        write!(out, r#"{comma}"{}""#, effect.key())?;
    }
    let listed = command.families.contains(&family);
    write!(out, r#"],"listed":{listed},"codes":["#)?;
    for (at, code) in command.codes.iter().enumerate() {
        let comma = if at > 0 { "," } else { "" };
        write!(
            out,
            r#"{comma}{{"code":{},"class":"{}","text":{},"sourced":{}}}"#,
            code.code,
            super::class(code.code).0.key(),
            Quoted(super::code_words(Some(command), code.code)),
            code.sourced
        )?;
    }
    write!(out, r#"],"note":{}"#, Quoted(command.note))?;
    write_source(out, command.source)?;
    write_readings(out, command.readings)?;
    out.write_str("}\n")
}

fn write_form(
    out: &mut impl Write,
    family: Family,
    command: &Command,
    role: &str,
    form: &Form,
) -> fmt::Result {
    let mut offset = 0_usize;
    for item in form.items {
        write_item(out, family, command, role, form, offset, item)?;
        if let Kind::Split(parts) = item.kind {
            for part in parts {
                write_item(out, family, command, role, form, offset, &part.item)?;
            }
        }
        if let Kind::Repeat(_, inner) = item.kind {
            let mut within = offset;
            for item in inner {
                write_item(out, family, command, role, form, within, item)?;
                within = within.saturating_add(width(item));
            }
        }
        offset = offset.saturating_add(width(item));
    }
    Ok(())
}

fn write_item(
    out: &mut impl Write,
    family: Family,
    command: &Command,
    role: &str,
    form: &Form,
    offset: usize,
    item: &Item,
) -> fmt::Result {
    write!(
        out,
        r#"{{"device":"{}","kind":"field","command":{},"role":"{role}","length":{},"revision":{},"offset":{offset},"bytes":{},"key":"{}","label":{},"type":"{}","unit":"{}","set":"#,
        family.key(),
        command.number,
        form.lengths.first().copied().unwrap_or(0),
        form.revision,
        width(item),
        item.key,
        Quoted(item.label),
        kind_key(&item.kind),
        item.unit
    )?;
    match item.kind {
        Kind::Named(_, names) | Kind::Nibbles(names) => write!(out, "{}", Quoted(names.set.name))?,
        Kind::Bits(_, bits) => write!(out, "{}", Quoted(bits.set.name))?,
        _ => out.write_str("null")?,
    }
    write_source(out, item.source)?;
    write_trust(out, item.trust)?;
    write_readings(out, item.readings)?;
    out.write_str("}\n")
}

const fn kind_key(kind: &Kind) -> &'static str {
    match kind {
        Kind::Unsigned(1) => "u8",
        Kind::Unsigned(2) => "u16",
        Kind::Unsigned(3) => "u24",
        Kind::Unsigned(_) => "u32",
        Kind::Float => "f32",
        Kind::Date => "date",
        Kind::Time => "time",
        Kind::Packed(_) => "packed-ascii",
        Kind::Latin(_) => "latin1",
        Kind::Named(..) => "enum",
        Kind::Bits(..) => "bits",
        Kind::Unit => "unit",
        Kind::Variable => "device-variable",
        Kind::Additional(_) => "additional-status",
        Kind::Nibbles(_) => "nibbles",
        Kind::Split(_) => "parts",
        Kind::Repeat(..) => "repeat",
        Kind::Raw(_) => "raw",
    }
}

fn write_bits(out: &mut impl Write, family: Family, name: &str, bits: &Bits) -> fmt::Result {
    for bit in bits.bits {
        write!(
            out,
            r#"{{"device":"{}","kind":"bit","set":"{name}","bit":{},"key":"{}","label":{},"alias":{},"alarm":{}"#,
            family.key(),
            bit.bit,
            bit.key,
            Quoted(bit.label),
            Quoted(bit.alias),
            bit.alarm
        )?;
        write_source(out, bit.source)?;
        write_trust(out, bit.trust)?;
        write_readings(out, bit.reading.as_slice())?;
        out.write_str("}\n")?;
    }
    Ok(())
}

fn write_source(out: &mut impl Write, source: Source) -> fmt::Result {
    write!(out, r#","source":{}"#, Quoted(&source.to_string()))
}

fn write_trust(out: &mut impl Write, trust: Trust) -> fmt::Result {
    write!(out, r#","trust":"{}""#, trust.key())
}

fn write_readings(out: &mut impl Write, readings: &[&Reading]) -> fmt::Result {
    out.write_str(r#","readings":["#)?;
    for (at, reading) in readings.iter().enumerate() {
        let comma = if at > 0 { "," } else { "" };
        write!(
            out,
            r#"{comma}{{"id":"{}","settled":"{}","text":{}}}"#,
            reading.id,
            reading.settled.key(),
            Quoted(reading.text)
        )?;
    }
    out.write_char(']')
}
