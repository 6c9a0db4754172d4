//! Registers to values, by the rows of a device map; `fields` puts them into a tree.

use super::row::{Access, DeviceMap, Kind, Row, Settled};
use crate::address::{Address, Table};
use crate::problem::Finding;
use crate::value::{Quality, Value};

/// A value together with how far it can be relied on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Judged {
    /// What the words say.
    pub value: Value,
    /// How far to rely on it; [`finding`] says why.
    pub quality: Quality,
}

/// Reads one value of a device from exactly the bytes of its words, high byte first.
///
/// Allocates nothing; this is the hot path of bulk decoding. Bytes of another length than the row
/// wants give [`Value::Raw`].
#[must_use]
#[inline]
pub fn value(row: &'static Row, bytes: &[u8]) -> Judged {
    // Changed in place: to copy it whole costs more than to decode it.
    let mut judged = by_kind(row, bytes);
    if row.reading.is_some_and(|r| r.settled == Settled::No)
        && judged.quality == Quality::Good
        && row.kind != Kind::Reserved
    {
        judged.quality = Quality::Disputed;
    }
    judged
}

/// What is to be said about a value that [`value`] read from these bytes.
#[must_use]
pub fn finding(row: &Row, judged: &Judged, bytes: &[u8]) -> Option<Finding> {
    match (judged.quality, judged.value) {
        (Quality::OutOfRange, Value::Number { raw, .. }) => out_of_range(row, raw),
        (Quality::OutOfRange, Value::Code { raw, .. }) => out_of_range(row, i64::from(raw)),
        (Quality::Invalid, Value::Code { raw, .. }) => Some(Finding::NoName { code: raw }),
        (Quality::Invalid, Value::Amount { .. }) => Some(Finding::NoName {
            code: u32::from(*bytes.first()?),
        }),
        (Quality::Invalid, Value::Text) => Some(Finding::BadDigits {
            what: "printable characters",
        }),
        (Quality::Invalid, _) if row.kind == Kind::BcdDate => Some(Finding::BadDigits {
            what: "a BCD date (DDMM YYYY)",
        }),
        (Quality::Invalid, _) => Some(Finding::BadDigits {
            what: "a BCD time (00HH MMSS)",
        }),
        (_, Value::Flags { raw, set }) if raw & !set.mask != 0 => Some(Finding::UnusedBits {
            bits: raw & !set.mask,
        }),
        _ => None,
    }
}

fn out_of_range(row: &Row, got: i64) -> Option<Finding> {
    row.range.map(|(min, max)| Finding::Range { got, min, max })
}

/// One word is by far the most frequent; the other shapes stay out of the loop.
#[inline]
fn by_kind(row: &'static Row, bytes: &[u8]) -> Judged {
    let &[high, low] = bytes else {
        return longer(row, bytes);
    };
    let word = u16::from_be_bytes([high, low]);
    match row.kind {
        Kind::U16 => number(row, i64::from(word)),
        Kind::I16 => signed(row, i16::from_be_bytes([high, low])),
        Kind::Enum => code(row, u32::from(word)),
        Kind::Bits => flags(row, u32::from(word)),
        Kind::Hex => good(Value::Hex(u32::from(word))),
        Kind::Ascii => characters(bytes),
        _ => good(Value::Raw),
    }
}

fn longer(row: &'static Row, bytes: &[u8]) -> Judged {
    match (row.kind, bytes) {
        (Kind::U32, &[a, b, c, d]) => number(row, i64::from(u32::from_be_bytes([a, b, c, d]))),
        (Kind::Bits, &[a, b, c, d]) => flags(row, u32::from_be_bytes([a, b, c, d])),
        (Kind::BcdDate, &[day, month, century, year]) => date(day, month, [century, year]),
        (Kind::BcdTime, &[0, hour, minute, second]) => time(hour, minute, second),
        (Kind::BcdTime, &[_, _, _, _]) => INVALID,
        (Kind::Ascii | Kind::Ascii7, text) => characters(text),
        (Kind::Torque, &[unit, ..]) => amount(row, unit),
        (Kind::Curve, _) => good(Value::Group),
        (Kind::Hex, &[a, b, c, d]) => good(Value::Hex(u32::from_be_bytes([a, b, c, d]))),
        _ => good(Value::Raw),
    }
}

/// Bytes that are no value of their type.
const INVALID: Judged = Judged {
    value: Value::Raw,
    quality: Quality::Invalid,
};

pub(super) const fn good(value: Value) -> Judged {
    Judged {
        value,
        quality: Quality::Good,
    }
}

fn number(row: &'static Row, raw: i64) -> Judged {
    Judged {
        value: Value::Number {
            raw,
            scale: row.scale,
        },
        quality: in_range(row, raw),
    }
}

fn in_range(row: &Row, raw: i64) -> Quality {
    match row.range {
        Some((min, max)) if raw < i64::from(min) || raw > i64::from(max) => Quality::OutOfRange,
        _ => Quality::Good,
    }
}

/// Reading E20: two's complement; in a register of -127 to 127, a word of 129 to 255 can only be
/// an 8-bit value that was widened without its sign.
fn signed(row: &'static Row, raw: i16) -> Judged {
    if row.range == Some((-127, 127)) && (129..=255).contains(&raw) {
        let value = Value::Number {
            raw: i64::from(raw).saturating_sub(256),
            scale: row.scale,
        };
        return Judged {
            value,
            quality: Quality::Disputed,
        };
    }
    number(row, i64::from(raw))
}

/// A code can have a name and still be outside the range of its register.
fn code(row: &'static Row, raw: u32) -> Judged {
    let Some(set) = row.set else {
        return good(Value::Hex(raw));
    };
    let named = set.get(raw).is_some();
    let quality = if named {
        in_range(row, i64::from(raw))
    } else {
        Quality::Invalid
    };
    Judged {
        value: Value::Code { raw, set },
        quality,
    }
}

fn flags(row: &'static Row, raw: u32) -> Judged {
    good(
        row.set
            .map_or(Value::Hex(raw), |set| Value::Flags { raw, set }),
    )
}

/// Two decimal digits in one byte.
fn bcd(byte: u8) -> Option<u8> {
    let (high, low) = (byte >> 4, byte & 0x0F);
    (high < 10 && low < 10).then(|| high.wrapping_mul(10).wrapping_add(low))
}

pub(super) fn date(day: u8, month: u8, year: [u8; 2]) -> Judged {
    if (day, month, year) == (0, 0, [0, 0]) {
        return good(Value::Unavailable("no date stored"));
    }
    let [century, year] = year;
    match (bcd(day), bcd(month), bcd(century), bcd(year)) {
        (Some(day @ 1..=31), Some(month @ 1..=12), Some(century), Some(year)) => {
            let year = u16::from(century)
                .wrapping_mul(100)
                .wrapping_add(u16::from(year));
            good(Value::Date { year, month, day })
        }
        _ => INVALID,
    }
}

pub(super) fn time(hour: u8, minute: u8, second: u8) -> Judged {
    match (bcd(hour), bcd(minute), bcd(second)) {
        (Some(hour @ 0..=23), Some(minute @ 0..=59), Some(second @ 0..=59)) => good(Value::Time {
            hour,
            minute,
            second,
        }),
        _ => INVALID,
    }
}

fn characters(text: &[u8]) -> Judged {
    if text.iter().all(|b| matches!(b, 0 | b' ')) {
        return good(Value::Unavailable("empty"));
    }
    let printable = text.iter().all(|b| matches!(b, 0 | 0x20..=0x7E | 0xA0..));
    let quality = if printable {
        Quality::Good
    } else {
        Quality::Invalid
    };
    Judged {
        value: Value::Text,
        quality,
    }
}

/// Reading E17: the first byte is a unit code 0 to 3, perhaps as a character.
fn amount(row: &'static Row, unit: u8) -> Judged {
    let code = if (0x30..=0x33).contains(&unit) {
        unit & 0x0F
    } else {
        unit
    };
    let name = row
        .set
        .and_then(|s| s.get(u32::from(code)))
        .map(|m| m.label);
    let quality = if name.is_some() {
        Quality::Good
    } else {
        Quality::Invalid
    };
    Judged {
        value: Value::Amount { unit: name },
        quality,
    }
}

/// Visits the values of a block of registers without a tree: each whole row with its judged value.
///
/// Rows of which only a part lies in the block are left out. `data` are the words from `start`.
/// A visitor and no iterator, because an item that travels through an `Option` is copied several
/// times, which costs more than to decode it.
#[inline]
pub fn each_value(
    map: &'static DeviceMap,
    table: Table,
    start: Address,
    data: &[u8],
    mut visit: impl FnMut(&'static Row, Judged),
) {
    let (rows, mut data) = whole(map, table, start, data);
    for row in rows {
        let Some((bytes, rest)) = data.split_at_checked(usize::from(row.words) << 1) else {
            return;
        };
        data = rest;
        visit(row, value(row, bytes));
    }
}

/// The rows that begin in a block, and its data from the first of them on.
fn whole<'a>(
    map: &'static DeviceMap,
    table: Table,
    start: Address,
    data: &'a [u8],
) -> (&'static [&'static Row], &'a [u8]) {
    let count = u16::try_from(data.len() / 2).unwrap_or(u16::MAX);
    let rows = map.slice_in(table, start, count);
    match rows.split_first() {
        Some((first, rest)) if first.address < start => {
            let skip = usize::try_from(first.end())
                .unwrap_or(0)
                .saturating_sub(start.get().into());
            (rest, data.get(skip.saturating_mul(2)..).unwrap_or(&[]))
        }
        _ => (rows, data),
    }
}

/// Number of addresses of a table that the device has, as far as its map goes.
#[must_use]
pub fn len(map: &'static DeviceMap, table: Table) -> u32 {
    map.rows
        .iter()
        .filter(|r| r.table == table && r.access != Access::Absent)
        .map(|r| u32::from(r.address.get()).saturating_add(u32::from(r.words)))
        .fold(0, u32::max)
}
