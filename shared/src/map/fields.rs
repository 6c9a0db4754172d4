//! Registers into the decode tree.

use super::decode::{Judged, date, finding, good, time, value};
use super::row::{DeviceMap, Kind, Row};
use crate::address::{Address, Table};
use crate::pdu::defs;
use crate::place::Place;
use crate::problem::{Finding, Problem};
use crate::reader::Reader;
use crate::scale::Scale;
use crate::tree::{Decoded, FieldId, Name};
use crate::value::{ACTIVE, Quality, Value};

/// Decodes words from `start` into fields.
pub(crate) fn words(
    out: &mut Decoded,
    map: Option<&'static DeviceMap>,
    table: Table,
    start: Address,
    mut data: Reader<'_>,
) {
    let mut at = start;
    if let Some(map) = map {
        let count = u16::try_from(data.left().checked_div(2).unwrap_or(0)).unwrap_or(u16::MAX);
        for row in map.rows_in(table, start, count) {
            let seen = at.get().saturating_sub(row.address.get());
            let words = row.words.saturating_sub(seen);
            let here = u16::try_from(data.left().checked_div(2).unwrap_or(0)).unwrap_or(u16::MAX);
            let taken = words.min(here);
            let Some(part) = data.sub(usize::from(taken).saturating_mul(2)) else {
                break;
            };
            if taken == row.words {
                whole(out, row, part);
            } else {
                fragment(out, row, at, part);
            }
            at = at.checked_add(taken).unwrap_or(at);
        }
    }
    while let Some((word, place)) = data.u16() {
        let value = Value::Number {
            raw: i64::from(word),
            scale: Scale::ONE,
        };
        out.push(None, Name::Register(table, at), value, place);
        if map.is_some() {
            out.problem(Problem::new(Finding::NotInMap, place));
        }
        at = at.checked_add(1).unwrap_or(at);
    }
    let (_, place) = data.take_rest();
    if place.len > 0 {
        out.push(None, Name::Def(&defs::UNKNOWN), Value::Raw, place);
    }
}

/// A row of which some words are missing.
fn fragment(out: &mut Decoded, row: &'static Row, at: Address, part: Reader<'_>) {
    let place = part.here();
    out.push(None, Name::Part(row, at), Value::Raw, place);
    if row.kind != Kind::Reserved {
        out.problem(Problem::new(Finding::Part { words: row.words }, place));
    }
}

/// A row with all its words.
fn whole(out: &mut Decoded, row: &'static Row, mut data: Reader<'_>) {
    let place = data.here();
    let judged = value(row, data.rest());
    let id = out.push(None, Name::Row(row), judged.value, place);
    out.mark(id, judged.quality);
    if let Some(finding) = finding(row, &judged, data.rest()) {
        out.problem(Problem::new(finding, place));
    }
    match (row.kind, judged.value) {
        (Kind::Bits, Value::Flags { raw, .. }) => bits(out, row, id, raw, data),
        (Kind::Torque, _) => torque(out, row, id, &mut data),
        (Kind::Curve, _) => curve(out, row, id, &mut data),
        _ => {}
    }
}

fn bits(out: &mut Decoded, row: &'static Row, parent: FieldId, raw: u32, data: Reader<'_>) {
    let Some(set) = row.set else { return };
    for member in set.members {
        let on = raw.wrapping_shr(u32::from(member.value)) & 1 != 0;
        // The lowest bit stands in the last byte.
        let back = usize::from(member.value >> 3).saturating_add(1);
        let mut byte = data;
        let _before = byte.take(data.left().saturating_sub(back));
        let Some((_, place)) = byte.u8() else {
            continue;
        };
        let words = member.states.as_ref().unwrap_or(&ACTIVE);
        out.push(
            Some(parent),
            Name::Bit(row, member),
            Value::Bit { on, words },
            place,
        );
    }
}

fn torque(out: &mut Decoded, row: &'static Row, parent: FieldId, data: &mut Reader<'_>) {
    if let Some((unit, place)) = data.u8() {
        let name = Name::Within(row, &defs::TORQUE_UNIT);
        out.push(Some(parent), name, Value::Hex(u32::from(unit)), place);
    }
    let (_, place) = data.take_rest();
    out.push(
        Some(parent),
        Name::Within(row, &defs::TORQUE_VALUE),
        Value::Text,
        place,
    );
}

/// A torque curve: reading E34.
fn curve(out: &mut Decoded, row: &'static Row, parent: FieldId, data: &mut Reader<'_>) {
    let mut field = |def, value: Judged, place| {
        let id = out.push(Some(parent), Name::Within(row, def), value.value, place);
        out.mark(id, value.quality);
        if value.quality == Quality::Invalid {
            out.problem(Problem::new(
                Finding::BadDigits { what: "BCD digits" },
                place,
            ));
        }
    };
    let Some((_, place)) = data.take(101) else {
        return;
    };
    field(&defs::CURVE_SAMPLES, good(Value::Samples), place);
    if let Some((&[day, month, year], place)) = data.take(3).map(array::<3>).and_then(|x| x) {
        let judged = match (day, month, year) {
            (0, 0, 0) => good(Value::Unavailable("no curve stored")),
            _ => date(day, month, [0x20, year]),
        };
        field(&defs::CURVE_DATE, judged, place);
    }
    if let Some((&[second, minute, hour], place)) = data.take(3).map(array::<3>).and_then(|x| x) {
        field(&defs::CURVE_TIME, time(hour, minute, second), place);
    }
    for def in [
        &defs::CURVE_ELECTRONICS,
        &defs::CURVE_TERMINALS,
        &defs::CURVE_MOTOR,
    ] {
        if let Some((byte, place)) = data.u8() {
            let raw = i64::from(i8::from_be_bytes([byte]));
            field(
                def,
                good(Value::Number {
                    raw,
                    scale: Scale::ONE,
                }),
                place,
            );
        }
    }
    for def in [&defs::CURVE_VOLTAGE, &defs::CURVE_STROKE] {
        if let Some((word, place)) = data.u16() {
            field(
                def,
                good(Value::Number {
                    raw: i64::from(word),
                    scale: Scale::ONE,
                }),
                place,
            );
        }
    }
    let (_, place) = data.take_rest();
    field(&defs::CURVE_RESERVED, good(Value::Raw), place);
}

/// Bytes of a known number as an array.
fn array<const N: usize>((bytes, place): (&[u8], Place)) -> Option<(&[u8; N], Place)> {
    bytes.first_chunk::<N>().map(|array| (array, place))
}
