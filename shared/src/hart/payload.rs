//! The data of a command to fields.

use super::decode::{flags, note};
use super::model::{Command, Item, Kind, Names, Part, form};
use super::problem::Hart;
use super::shape::{class_ahead, is_class, longest, nearest, width};
use super::values::{Real, clock, is_date, real, unpack};
use super::{DEVICE_VARIABLE, ROTORK_VARIABLE, additional, unit};
use crate::device::Family;
use crate::place::Place;
use crate::problem::{Finding, Problem};
use crate::reader::Reader;
use crate::scale::Scale;
use crate::tree::{Decoded, FieldId, Name};
use crate::value::{Quality, Value};

/// Stands for "not one of several" in a [`Name`].
pub(crate) const ALONE: u16 = u16::MAX;

/// Which way the data went.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Way {
    Request,
    Response,
}

/// Reads the data of one frame.
pub(super) struct Data<'o> {
    pub(super) way: Way,
    pub(super) family: Option<Family>,
    pub(super) out: &'o mut Decoded,
    /// The last unit code, for the values behind it.
    unit: Option<u8>,
    /// The last classification, which some units depend on.
    class: u8,
    /// First index and number of entries of a condensed status map.
    start: u8,
    count: u8,
}

impl<'o> Data<'o> {
    pub(super) const fn new(way: Way, family: Option<Family>, out: &'o mut Decoded) -> Self {
        Self {
            way,
            family,
            out,
            unit: None,
            class: 0,
            start: 0,
            count: 0,
        }
    }

    /// The number of an extended command, in the data of command 31.
    pub(super) fn carrier(
        &mut self,
        carrier: &'static Command,
        reader: &mut Reader<'_>,
    ) -> Option<u16> {
        let mut own = reader.sub(2)?;
        let number = own.rest().try_into().map(u16::from_be_bytes).ok()?;
        self.command(carrier, &mut own);
        Some(number)
    }

    /// The data of a command. What does not fit stays in the reader.
    pub(super) fn command(&mut self, command: &'static Command, reader: &mut Reader<'_>) {
        let forms = match self.way {
            Way::Request => command.request,
            Way::Response => command.response,
        };
        let len = reader.left();
        let found = form(forms, len);
        if found.is_none() && !forms.is_empty() {
            let got = u16::try_from(len).unwrap_or(u16::MAX);
            let want = nearest(forms, got);
            note(self.out, Hart::Length { got, want }, reader.here());
        }
        let Some(form) = found.or_else(|| longest(forms)) else {
            return;
        };
        if len == 0 || form.items.is_empty() {
            return;
        }
        let before = reader.here();
        self.class = class_ahead(form.items, reader.rest());
        let group = self
            .out
            .push(None, Name::HartCommand(command), Value::Group, before);
        self.items(form.items, group, reader);
        let taken = before.len.saturating_sub(reader.here().len);
        self.out.shrink(group, taken);
    }

    fn items(&mut self, items: &'static [Item], parent: FieldId, reader: &mut Reader<'_>) {
        let mut rest = items;
        while let Some((item, tail)) = rest.split_first() {
            rest = tail;
            if reader.is_empty() {
                return;
            }
            if let Kind::Repeat(_, inner) = item.kind {
                let behind: usize = tail.iter().map(width).sum();
                self.repeat(item, inner, behind, parent, reader);
                continue;
            }
            let len = match item.kind {
                Kind::Raw(most) => reader.left().min(usize::from(most)),
                Kind::Nibbles(_) => reader.left(),
                _ => width(item),
            };
            let Some((bytes, place)) = reader.take(len) else {
                return;
            };
            self.item(item, bytes, place, parent);
        }
    }

    /// As many of the same fields as there is room for.
    fn repeat(
        &mut self,
        item: &'static Item,
        inner: &'static [Item],
        behind: usize,
        parent: FieldId,
        reader: &mut Reader<'_>,
    ) {
        let size: usize = inner.iter().map(width).sum();
        let mut at = 0;
        while size > 0 && reader.left() >= size.saturating_add(behind) {
            let Some(mut slot) = reader.sub(size) else {
                return;
            };
            let name = Name::Hart(item, None, at);
            let group = self.out.push(Some(parent), name, Value::Group, slot.here());
            self.items(inner, group, &mut slot);
            at = at.saturating_add(1);
        }
    }

    fn item(&mut self, item: &'static Item, bytes: &[u8], place: Place, parent: FieldId) {
        let number = bytes
            .iter()
            .take(4)
            .fold(0_u32, |n, byte| n << 8 | u32::from(*byte));
        let low = u8::try_from(number & 0xFF).unwrap_or(0);
        let name = Name::Hart(item, None, ALONE);
        let parent = Some(parent);
        match item.kind {
            Kind::Unsigned(_) => self.unsigned(item, number, place, parent),
            Kind::Float => self.float(item, number, place, parent),
            Kind::Date => self.date(name, bytes, place, parent),
            Kind::Time => {
                let value = Value::Number {
                    raw: i64::from(number),
                    scale: Scale::new(1, 32_000, 3),
                };
                let id = self.out.push(parent, name, value, place);
                self.out.say(id, clock(number));
            }
            Kind::Packed(_) => {
                let id = self.out.push(parent, name, Value::Text, place);
                self.out.say(id, unpack(bytes).trim_end().to_owned());
            }
            Kind::Latin(_) => {
                self.out.push(parent, name, Value::Text, place);
            }
            Kind::Named(_, names) => {
                if is_class(item) {
                    self.class = low;
                }
                let (value, quality) = named(names, number);
                self.coded(name, value, quality, number, place, parent);
            }
            Kind::Bits(_, bits) => {
                flags(self.out, parent, name, number, bits, place);
            }
            Kind::Unit => {
                self.unit = Some(low);
                let known = unit(low, self.class);
                let words = known.map(|u| {
                    if u.symbol.is_empty() {
                        u.name
                    } else {
                        u.symbol
                    }
                });
                // Reading G24: 170 to 219 mean nothing without a classification.
                let own = match low {
                    170..=219 if self.class == 0 => Some("depends on the classification"),
                    240..=249 => Some("manufacturer specific"),
                    _ => None,
                };
                let value = Value::Named(number, words.or(own));
                self.out.push(parent, name, value, place);
            }
            Kind::Variable => {
                let own = self.family.and_then(|_| ROTORK_VARIABLE.name(number));
                let value = Value::Named(number, own.or_else(|| DEVICE_VARIABLE.name(number)));
                let value = match value {
                    Value::Named(_, None) => plain(number),
                    named => named,
                };
                self.out.push(parent, name, value, place);
            }
            Kind::Additional(byte) => self.additional(name, byte, number, place, parent),
            Kind::Nibbles(names) => self.nibbles(item, names, bytes, place, parent),
            Kind::Split(parts) => self.split(name, parts, number, place, parent),
            Kind::Raw(_) | Kind::Repeat(..) => {
                self.out.push(parent, name, Value::Raw, place);
            }
        }
    }

    fn unsigned(
        &mut self,
        item: &'static Item,
        number: u32,
        place: Place,
        parent: Option<FieldId>,
    ) {
        let low = u8::try_from(number & 0xFF).unwrap_or(0);
        match item.key {
            "start" => self.start = low,
            "count" => self.count = low,
            _ => {}
        }
        let value = if item.hex {
            Value::Hex(number)
        } else {
            plain(number)
        };
        let name = Name::Hart(item, None, ALONE);
        let id = self.out.push(parent, name, value, place);
        if let Some(want) = item.expected
            && want != number
        {
            note(self.out, Hart::Expected { got: number, want }, place);
        }
        let got = i64::from(number);
        if let Some((min, max)) = item.range
            && !(i64::from(min)..=i64::from(max)).contains(&got)
        {
            self.out.mark(id, Quality::OutOfRange);
            let finding = Finding::Range { got, min, max };
            self.out.problem(Problem::new(finding, place));
        }
    }

    fn float(&mut self, item: &'static Item, bits: u32, place: Place, parent: Option<FieldId>) {
        let known = self.unit.filter(|_| item.by_code);
        let known = known.and_then(|code| unit(code, self.class));
        let name = Name::Hart(item, known, ALONE);
        let value = match real(bits) {
            Real::Number(raw, scale) => Value::Number { raw, scale },
            Real::Missing => Value::Unavailable("not a number"),
            Real::Far => Value::Raw,
        };
        let id = self.out.push(parent, name, value, place);
        if value == Value::Raw {
            let value = f32::from_bits(bits);
            self.out.say(id, format!("{value:e}"));
            if value.is_infinite() {
                self.out.mark(id, Quality::Invalid);
            }
        }
        if let (Value::Number { raw, scale }, Some((min, max))) = (value, item.range) {
            let amount = scale.to_f64(raw);
            if amount < f64::from(min) || amount > f64::from(max) {
                self.out.mark(id, Quality::OutOfRange);
            }
        }
    }

    /// Reading G13: zeros and impossible dates mean that none was set.
    fn date(&mut self, name: Name, bytes: &[u8], place: Place, parent: Option<FieldId>) {
        let value = match *bytes {
            [day, month, year] if is_date(day, month, year) => Value::Date {
                year: u16::from(year).saturating_add(1900),
                month,
                day,
            },
            _ => Value::Unavailable("no date set"),
        };
        self.out.push(parent, name, value, place);
    }

    fn coded(
        &mut self,
        name: Name,
        value: Value,
        quality: Quality,
        code: u32,
        place: Place,
        parent: Option<FieldId>,
    ) {
        let id = self.out.push(parent, name, value, place);
        if quality != Quality::Good {
            self.out.mark(id, quality);
            self.out
                .problem(Problem::new(Finding::NoName { code }, place));
        }
    }

    /// A byte of the device's own status.
    fn additional(
        &mut self,
        name: Name,
        byte: u8,
        raw: u32,
        place: Place,
        parent: Option<FieldId>,
    ) {
        let known = self.family.and_then(|family| additional(family, byte));
        if let Some(bits) = known {
            flags(self.out, parent, name, raw, bits, place);
            return;
        }
        self.out.push(parent, name, Value::Hex(raw), place);
        if self.family.is_some() && raw != 0 {
            let finding = Finding::UnusedBits { bits: raw };
            self.out.problem(Problem::new(finding, place));
        }
    }

    /// Entries of a condensed status map: the smaller index in the low half of a byte.
    fn nibbles(
        &mut self,
        item: &'static Item,
        names: &'static Names,
        bytes: &[u8],
        place: Place,
        parent: Option<FieldId>,
    ) {
        let name = Name::Hart(item, None, ALONE);
        let id = self.out.push(parent, name, Value::Raw, place);
        let entries = bytes.iter().flat_map(|b| [b & 0x0F, b >> 4]);
        for (at, code) in (0_u16..).zip(entries) {
            let byte = usize::from(place.start).saturating_add(usize::from(at / 2));
            let index = at.saturating_add(u16::from(self.start));
            let (value, _) = named(names, u32::from(code));
            let name = Name::HartPart(item, index);
            self.out.push(Some(id), name, value, Place::new(byte, 1));
        }
        let want = place.len.saturating_mul(2);
        let got = u16::from(self.count);
        if got != want {
            self.out
                .problem(Problem::new(Finding::Count { got, want }, place));
        }
    }

    fn split(
        &mut self,
        name: Name,
        parts: &'static [Part],
        raw: u32,
        place: Place,
        parent: Option<FieldId>,
    ) {
        let id = self.out.push(parent, name, Value::Hex(raw), place);
        let mut words = Vec::new();
        for part in parts {
            let width = u32::from(part.high.saturating_sub(part.low)).saturating_add(1);
            let mask = 1_u32.wrapping_shl(width).wrapping_sub(1);
            let bits = raw.wrapping_shr(u32::from(part.low)) & mask;
            let value = part
                .names
                .map_or_else(|| plain(bits), |names| named(names, bits).0);
            let name = Name::HartPart(&part.item, ALONE);
            self.out.push(Some(id), name, value, place);
            let name = part.names.and_then(|names| names.name(bits));
            words.push(match name {
                Some(name) => name.to_owned(),
                None => format!("{} {bits}", part.item.label),
            });
        }
        self.out.say(id, words.join(", "));
    }
}

const fn plain(number: u32) -> Value {
    Value::Number {
        raw: i64_of(number),
        scale: Scale::ONE,
    }
}

/// Widens in const context, where `From` is not available.
#[expect(
    clippy::as_conversions,
    reason = "lossless, and `i64::from` is not const"
)]
const fn i64_of(value: u32) -> i64 {
    value as i64
}

fn named(names: &'static Names, code: u32) -> (Value, Quality) {
    if names.set.get(code).is_some() {
        let set = &names.set;
        return (Value::Code { raw: code, set }, Quality::Good);
    }
    let name = names.name(code);
    let quality = if name.is_some() {
        Quality::Good
    } else {
        Quality::Invalid
    };
    (Value::Named(code, name), quality)
}
