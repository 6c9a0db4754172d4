//! Records into the decode tree.

use super::model::{Field, File, Kind};
use super::read::value;
use crate::pdu::defs;
use crate::place::Place;
use crate::problem::{Finding, Problem};
use crate::reader::Reader;
use crate::tree::{Decoded, FieldId, Name};
use crate::value::{ACTIVE, Quality, Value};

/// Decodes the records of a group from record `first` of a file into fields below `parent`; false,
/// and nothing is taken, if the manual does not describe the file.
pub(crate) fn records(
    out: &mut Decoded,
    parent: FieldId,
    number: u16,
    first: u16,
    data: &mut Reader<'_>,
) -> bool {
    let Some(file) = File::of(number) else {
        return false;
    };
    let Some(layout) = file.layout else {
        return false;
    };
    let whole = out.push(
        Some(parent),
        Name::File(file, number),
        Value::Group,
        data.here(),
    );
    let mut at = first;
    let mut entry: Option<(u16, FieldId)> = None;
    while data.left() >= 2 {
        let Some(slot) = layout.slot(at) else { break };
        let left = u16::try_from(data.left() / 2).unwrap_or(u16::MAX);
        let around = match slot.entry {
            None => whole,
            Some(n) => match entry {
                Some((seen, id)) if seen == n => id,
                _ => {
                    let into = slot.field.offset.saturating_add(slot.word);
                    let words = layout.entry_records.saturating_sub(into).min(left);
                    let mut ahead = *data;
                    let part = ahead.sub(usize::from(words).saturating_mul(2));
                    let place = part.map_or(data.here(), |p| p.here());
                    let id = out.push(Some(whole), Name::Entry(file, n), Value::Group, place);
                    entry = Some((n, id));
                    id
                }
            },
        };
        let words = slot.field.words.saturating_sub(slot.word).min(left);
        let Some(mut part) = data.sub(usize::from(words).saturating_mul(2)) else {
            break;
        };
        if words == slot.field.words {
            one(out, around, slot.field, slot.index, &mut part);
        } else {
            let place = part.here();
            let name = Name::RecordPart(slot.field, slot.index);
            out.push(Some(around), name, Value::Raw, place);
            let words = slot.field.words;
            out.problem(Problem::new(Finding::Part { words }, place));
        }
        at = at.saturating_add(words);
    }
    // Beyond the layout: words that nothing is said about.
    while let Some((word, place)) = data.u16() {
        let name = Name::Item(&defs::RECORD_DATA, at);
        out.push(Some(whole), name, Value::Hex(word.into()), place);
        out.problem(Problem::new(Finding::NotInMap, place));
        at = at.saturating_add(1);
    }
    // Half a record.
    let (_, place) = data.take_rest();
    if place.len > 0 {
        out.push(Some(whole), Name::Def(&defs::UNKNOWN), Value::Raw, place);
    }
    true
}

/// One value with all its words.
fn one(
    out: &mut Decoded,
    parent: FieldId,
    field: &'static Field,
    index: u16,
    data: &mut Reader<'_>,
) {
    let place = data.here();
    let inside = *data;
    let mut words = Vec::new();
    while let Some((word, _)) = data.u16() {
        words.push(word);
    }
    let judged = value(field, &words);
    let id = out.push(
        Some(parent),
        Name::Record(field, index),
        judged.value,
        place,
    );
    out.mark(id, judged.quality);
    if let Some(finding) = finding(field, judged.value, judged.quality) {
        out.problem(Problem::new(finding, place));
    }
    if let (Kind::Bits, Value::Flags { raw, set }) = (field.kind, judged.value) {
        for member in set.members {
            let on = raw.wrapping_shr(member.value.into()) & 1 != 0;
            let words = member.states.as_ref().unwrap_or(&ACTIVE);
            out.push(
                Some(id),
                Name::RecordBit(field, member),
                Value::Bit { on, words },
                byte_of_bit(inside, member.value),
            );
        }
    }
}

/// The byte that holds a bit: the lowest stands in the last byte.
fn byte_of_bit(data: Reader<'_>, bit: u16) -> Place {
    let back = usize::from(bit >> 3).saturating_add(1);
    let mut byte = data;
    let _before = byte.take(data.left().saturating_sub(back));
    byte.u8().map_or(data.here(), |(_, place)| place)
}

fn finding(field: &Field, value: Value, quality: Quality) -> Option<Finding> {
    match (quality, value) {
        (Quality::OutOfRange, Value::Number { raw, .. }) => {
            let (min, max) = field.range?;
            Some(Finding::Range { got: raw, min, max })
        }
        (Quality::Invalid, Value::Code { raw, .. }) => Some(Finding::NoName { code: raw }),
        (_, Value::Flags { raw, set }) if raw & !set.mask != 0 => Some(Finding::UnusedBits {
            bits: raw & !set.mask,
        }),
        (Quality::Invalid, _) => Some(Finding::BadDigits {
            what: "printable characters",
        }),
        _ => None,
    }
}
