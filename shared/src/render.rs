//! Fields as people and programs read them: path, label, text, raw, source.

use core::fmt::{self, Write};

use crate::address::RegisterNumber;
use crate::map::row::{Kind, Reading, Source, Trust};
use crate::reader::Layout;
use crate::tree::{Decoded, Field, FieldId, Name};
use crate::value::{Value, civil};

impl Name {
    /// What people read.
    #[must_use]
    pub fn label(&self) -> String {
        match self {
            Self::Def(def) | Self::Within(_, def) => def.label.to_owned(),
            Self::Item(def, at) => format!("{} {at}", def.label),
            Self::Register(table, address) => format!("{} {address}", table.label()),
            Self::Row(row) => row.label.to_owned(),
            Self::Part(row, _) => format!("{} (part)", row.label),
            Self::Bit(_, member) | Self::DopBit(_, member) => member.label.to_owned(),
            Self::Dop(field, at) => field.item_label(*at),
            Self::DopArray(field) => field.label.to_owned(),
            Self::DopWord(_, at) => format!("Register {at}"),
            #[cfg(feature = "hart")]
            Self::HartCommand(command) => command.label.to_owned(),
            #[cfg(feature = "hart")]
            Self::Hart(item, _, u16::MAX) | Self::HartPart(item, u16::MAX) => item.label.to_owned(),
            #[cfg(feature = "hart")]
            Self::Hart(item, _, at) | Self::HartPart(item, at) => format!("{} {at}", item.label),
            #[cfg(feature = "hart")]
            Self::HartBit(bit) if bit.alias.is_empty() => bit.label.to_owned(),
            #[cfg(feature = "hart")]
            Self::HartBit(bit) => format!("{} (also: {})", bit.label, bit.alias),
            #[cfg(feature = "icon")]
            Self::File(file, number) => file.name(*number).into_owned(),
            #[cfg(feature = "icon")]
            Self::Entry(file, at) => format!("{} {at}", file.item),
            #[cfg(feature = "icon")]
            Self::Record(field, at) => field.label_of(*at).into_owned(),
            #[cfg(feature = "icon")]
            Self::RecordPart(field, at) => format!("{} (part)", field.label_of(*at)),
            #[cfg(feature = "icon")]
            Self::RecordBit(_, member) => member.label.to_owned(),
        }
    }

    /// Unit of the value, empty if it has none.
    #[must_use]
    pub const fn unit(&self) -> &'static str {
        match self {
            Self::Def(def) | Self::Item(def, _) | Self::Within(_, def) => def.unit,
            Self::Row(row) => row.unit,
            Self::Dop(field, _) | Self::DopArray(field) => field.unit,
            Self::Register(..)
            | Self::Part(..)
            | Self::Bit(..)
            | Self::DopBit(..)
            | Self::DopWord(..) => "",
            #[cfg(feature = "hart")]
            Self::Hart(_, Some(unit), _) => unit.symbol,
            #[cfg(feature = "hart")]
            Self::Hart(item, None, _) => item.unit,
            #[cfg(feature = "hart")]
            Self::HartCommand(_) | Self::HartPart(..) | Self::HartBit(_) => "",
            #[cfg(feature = "icon")]
            Self::Record(field, _) => field.unit,
            #[cfg(feature = "icon")]
            Self::File(..) | Self::Entry(..) | Self::RecordPart(..) | Self::RecordBit(..) => "",
        }
    }

    /// Where it is described; `None` for a register that no map knows.
    #[must_use]
    pub const fn source(&self) -> Option<Source> {
        match self {
            Self::Def(def) | Self::Item(def, _) => Some(def.source),
            Self::Row(row) | Self::Part(row, _) | Self::Bit(row, _) | Self::Within(row, _) => {
                Some(row.source)
            }
            Self::Dop(field, _) | Self::DopArray(field) | Self::DopBit(field, _) => {
                Some(field.source)
            }
            Self::Register(..) | Self::DopWord(..) => None,
            #[cfg(feature = "hart")]
            Self::HartCommand(command) => Some(command.source),
            #[cfg(feature = "hart")]
            Self::Hart(item, ..) | Self::HartPart(item, _) => Some(item.source),
            #[cfg(feature = "hart")]
            Self::HartBit(bit) => Some(bit.source),
            #[cfg(feature = "icon")]
            Self::File(file, _) | Self::Entry(file, _) => Some(file.source),
            #[cfg(feature = "icon")]
            Self::Record(field, _) | Self::RecordPart(field, _) | Self::RecordBit(field, _) => {
                Some(field.source)
            }
        }
    }

    /// How far the description can be trusted.
    #[must_use]
    pub const fn trust(&self) -> Trust {
        match self {
            Self::Row(row) | Self::Part(row, _) | Self::Bit(row, _) | Self::Within(row, _) => {
                row.trust
            }
            Self::Def(_) | Self::Item(..) => Trust::Manual,
            Self::Dop(field, _) | Self::DopArray(field) | Self::DopBit(field, _) => field.trust,
            Self::Register(..) | Self::DopWord(..) => Trust::Inferred,
            #[cfg(feature = "hart")]
            Self::HartCommand(_) => Trust::Manual,
            #[cfg(feature = "hart")]
            Self::Hart(item, ..) | Self::HartPart(item, _) => item.trust,
            #[cfg(feature = "hart")]
            Self::HartBit(bit) => bit.trust,
            #[cfg(feature = "icon")]
            Self::File(..) | Self::Entry(..) => Trust::Manual,
            #[cfg(feature = "icon")]
            Self::Record(field, _) | Self::RecordPart(field, _) | Self::RecordBit(field, _) => {
                field.trust
            }
        }
    }

    /// Why the description differs from the print.
    #[must_use]
    pub const fn reading(&self) -> Option<&'static Reading> {
        match self {
            Self::Row(row) | Self::Part(row, _) | Self::Bit(row, _) | Self::Within(row, _) => {
                row.reading
            }
            Self::Dop(field, _) | Self::DopArray(field) | Self::DopBit(field, _) => field.reading,
            Self::Def(_) | Self::Item(..) | Self::Register(..) | Self::DopWord(..) => None,
            #[cfg(feature = "hart")]
            Self::HartCommand(command) => first(command.readings),
            #[cfg(feature = "hart")]
            Self::Hart(item, ..) | Self::HartPart(item, _) => first(item.readings),
            #[cfg(feature = "hart")]
            Self::HartBit(bit) => bit.reading,
            #[cfg(feature = "icon")]
            Self::File(file, _) | Self::Entry(file, _) => file.reading,
            #[cfg(feature = "icon")]
            Self::Record(field, _) | Self::RecordPart(field, _) | Self::RecordBit(field, _) => {
                field.reading
            }
        }
    }

    /// Further readings that concern it.
    #[must_use]
    pub const fn also(&self) -> &'static [&'static Reading] {
        match self {
            Self::Dop(field, _) | Self::DopArray(field) | Self::DopBit(field, _) => field.also,
            _ => &[],
        }
    }
}

/// The reading that decides.
#[cfg(feature = "hart")]
const fn first(readings: &[&'static Reading]) -> Option<&'static Reading> {
    match readings {
        [first, ..] => Some(*first),
        [] => None,
    }
}

impl Decoded {
    /// The path of a field: `crc`, `sub_request[1].file`, `holding.3001.close_limit`.
    ///
    /// The path of a register begins with its table and address, whatever is around it.
    #[must_use]
    pub fn path(&self, id: FieldId) -> String {
        let mut path = String::new();
        self.write_path(id, &mut path);
        path
    }

    fn write_path(&self, id: FieldId, path: &mut String) {
        let Some(field) = self.field(id) else { return };
        let below = |path: &mut String| {
            if let Some(parent) = field.parent {
                self.write_path(parent, path);
                path.push('.');
            }
        };
        // Writing to a String does not fail.
        let _infallible = match field.name {
            Name::Def(def) | Name::Within(_, def) => {
                below(path);
                path.write_str(def.key)
            }
            Name::Item(def, at) => {
                below(path);
                write!(path, "{}[{at}]", def.key)
            }
            Name::Register(table, address)
            | Name::Part(&crate::map::row::Row { table, .. }, address) => {
                write!(path, "{}.{address}", table.key())
            }
            Name::Row(row) => write!(path, "{}.{}", row.table.key(), row.address),
            Name::Dop(field, at) if field.is_indexed() => {
                write!(path, "dop.{}.{}[{at}]", field.object, field.key)
            }
            Name::Dop(field, _) | Name::DopArray(field) => {
                write!(path, "dop.{}.{}", field.object, field.key)
            }
            Name::DopWord(object, at) => write!(path, "dop.{object}.word[{at}]"),
            Name::Bit(_, member) | Name::DopBit(_, member) => {
                below(path);
                path.write_str(member.key)
            }
            #[cfg(feature = "hart")]
            Name::HartCommand(command) => write!(path, "command.{}", command.number),
            #[cfg(feature = "hart")]
            Name::HartPart(item, at) if at < u16::MAX => {
                // The entries of a map are named by their index, not by the bytes around them.
                let around = field.parent.and_then(|p| self.field(p)?.parent);
                if let Some(around) = around {
                    self.write_path(around, path);
                    path.push('.');
                }
                write!(path, "{}[{at}]", item.key)
            }
            #[cfg(feature = "hart")]
            Name::Hart(item, _, at) if at < u16::MAX => {
                below(path);
                write!(path, "{}[{at}]", item.key)
            }
            #[cfg(feature = "hart")]
            Name::Hart(item, ..) | Name::HartPart(item, _) => {
                below(path);
                path.write_str(item.key)
            }
            #[cfg(feature = "hart")]
            Name::HartBit(bit) => {
                below(path);
                path.write_str(bit.key)
            }
            // As for registers: the path of a file does not tell which group brought it.
            #[cfg(feature = "icon")]
            Name::File(_, number) => write!(path, "file.{number}"),
            #[cfg(feature = "icon")]
            Name::Entry(_, at) => {
                below(path);
                write!(path, "entry[{at}]")
            }
            #[cfg(feature = "icon")]
            Name::Record(field, at) | Name::RecordPart(field, at) if field.is_run() => {
                below(path);
                write!(path, "{}[{}]", field.key, field.from.saturating_add(at))
            }
            #[cfg(feature = "icon")]
            Name::Record(field, _) | Name::RecordPart(field, _) => {
                below(path);
                path.write_str(field.key)
            }
            #[cfg(feature = "icon")]
            Name::RecordBit(_, member) => {
                below(path);
                path.write_str(member.key)
            }
        };
    }

    /// The bytes of a field in hexadecimal without blanks. In a Modbus ASCII frame these are the
    /// characters themselves; the start and line end are given as bytes.
    #[must_use]
    pub fn raw(&self, field: &Field) -> String {
        let bytes = self.bytes.get(field.place.range()).unwrap_or(&[]);
        match self.layout {
            Layout::HexPairs if bytes.iter().all(u8::is_ascii_hexdigit) && !bytes.is_empty() => {
                bytes
                    .iter()
                    .map(|b| char::from(b.to_ascii_uppercase()))
                    .collect()
            }
            _ => hex(bytes),
        }
    }

    /// The payload bytes of a field, decoded from their characters in a Modbus ASCII frame.
    #[must_use]
    pub fn payload(&self, field: &Field) -> Vec<u8> {
        let bytes = self.bytes.get(field.place.range()).unwrap_or(&[]);
        match self.layout {
            Layout::Plain => bytes.to_vec(),
            Layout::HexPairs => bytes
                .chunks_exact(2)
                .filter_map(crate::frame::ascii::hex_pair)
                .collect(),
        }
    }

    /// The value of a field in words, with its unit: `24.0 %`.
    #[must_use]
    pub fn text(&self, field: &Field) -> String {
        let text = self.bare_text(field);
        let unit = field.name.unit();
        match field.value {
            Value::Number { .. } if !unit.is_empty() => format!("{text} {unit}"),
            _ => text,
        }
    }

    /// The value of a field in words, without its unit.
    #[must_use]
    pub fn bare_text(&self, field: &Field) -> String {
        if let Some(words) = self.words_of(field) {
            return words.to_owned();
        }
        match field.value {
            Value::Text => self.characters(field),
            Value::Amount { unit } => {
                let amount = self.payload(field);
                let amount = text_of(amount.get(1..).unwrap_or(&[]));
                match unit {
                    Some(unit) => format!("{amount} {unit}"),
                    None => format!("{amount} (unit unknown)"),
                }
            }
            Value::Samples => {
                let samples = self.payload(field);
                let peak = samples.iter().max().copied().unwrap_or(0);
                format!("{} samples, peak {peak}", samples.len())
            }
            Value::Raw => match self.payload(field) {
                bytes if bytes.is_empty() => self.raw(field),
                bytes => Spaced(&bytes).to_string(),
            },
            Value::Group => String::new(),
            Value::Hex(raw) => {
                let width = self.payload(field).len().saturating_mul(2);
                format!("0x{raw:0width$X}")
            }
            value => value.to_string(),
        }
    }

    /// The words that were set for a field.
    fn words_of(&self, field: &Field) -> Option<&str> {
        if self.said.is_empty() {
            return None;
        }
        // A field is told by its name and place: bits share a place.
        let (id, _) = self
            .iter()
            .find(|(_, f)| f.place == field.place && f.name == field.name)?;
        let at = self.said.binary_search_by_key(&id, |(id, _)| *id).ok()?;
        self.said.get(at).map(|(_, words)| words.as_str())
    }

    fn characters(&self, field: &Field) -> String {
        let bytes = self.payload(field);
        if let Name::Row(row) = field.name
            && row.kind == Kind::Ascii7
            && let Some((last, body)) = bytes.split_last()
            && body.last().is_some_and(|b| !matches!(b, 0 | b' '))
        {
            // Reading E18: the seventh character is in the high byte, the low byte is padding.
            let _padding = last;
            return text_of(body);
        }
        text_of(&bytes)
    }
}

/// Characters without the padding at both ends; what is not printable becomes a middle dot.
pub(crate) fn text_of(bytes: &[u8]) -> String {
    let text: String = bytes
        .iter()
        .map(|b| match b {
            0 => ' ',
            0x20..=0x7E | 0xA0.. => char::from(*b),
            _ => '·',
        })
        .collect();
    text.trim().to_owned()
}

impl fmt::Display for Value {
    /// The value in words; text, samples and raw bytes need their frame, see [`Decoded::text`].
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Group | Self::Text | Self::Samples | Self::Raw => Ok(()),
            Self::Amount { unit } => f.write_str(unit.unwrap_or("unit unknown")),
            Self::Number { raw, scale } => scale.apply(raw).fmt(f),
            Self::Hex(raw) if raw <= 0xFF => write!(f, "0x{raw:02X}"),
            Self::Hex(raw) if raw <= 0xFFFF => write!(f, "0x{raw:04X}"),
            Self::Hex(raw) => write!(f, "0x{raw:08X}"),
            Self::Address(table, address) => {
                write!(f, "{address} ({})", RegisterNumber::of(table, address))
            }
            Self::Code { raw, set } => match set.get(raw) {
                Some(member) => write!(f, "{} ({raw})", member.name(raw)),
                None => write!(f, "unknown code ({raw})"),
            },
            Self::Named(raw, Some(name)) => write!(f, "{name} ({raw})"),
            Self::Named(raw, None) => write!(f, "unknown ({raw})"),
            Self::Flags { raw, set } => {
                let mut none = true;
                for member in set.members {
                    if raw.wrapping_shr(u32::from(member.value)) & 1 != 0 {
                        f.write_str(if none { "" } else { ", " })?;
                        f.write_str(member.label)?;
                        none = false;
                    }
                }
                if none { f.write_str("none") } else { Ok(()) }
            }
            Self::Bit {
                on,
                words: &(no, yes),
            } => f.write_str(if on { yes } else { no }),
            Self::Date { year, month, day } => write!(f, "{year:04}-{month:02}-{day:02}"),
            Self::Time {
                hour,
                minute,
                second,
            } => write!(f, "{hour:02}:{minute:02}:{second:02}"),
            Self::Stamp(seconds) => {
                let (year, month, day, second) = civil(seconds);
                let (hour, minute) = (second / 3600, (second % 3600) / 60);
                write!(
                    f,
                    "{year:04}-{month:02}-{day:02} {hour:02}:{minute:02}:{:02} UTC",
                    second % 60
                )
            }
            #[cfg(feature = "icon")]
            Self::DeviceTime(seconds) => {
                let (year, month, day, second) =
                    civil(crate::value::Y2K.saturating_add(i64::from(seconds)));
                let (hour, minute) = (second / 3600, (second % 3600) / 60);
                write!(
                    f,
                    "{year:04}-{month:02}-{day:02} {hour:02}:{minute:02}:{:02}",
                    second % 60
                )
            }
            Self::Unavailable(why) => write!(f, "not available ({why})"),
        }
    }
}

/// Bytes in hexadecimal without blanks.
#[must_use]
pub fn hex(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 16] = b"0123456789ABCDEF";
    let mut text = String::with_capacity(bytes.len().saturating_mul(2));
    for byte in bytes {
        for nibble in [byte >> 4, byte & 0x0F] {
            text.push(char::from(
                DIGITS.get(usize::from(nibble)).copied().unwrap_or(b'?'),
            ));
        }
    }
    text
}

/// Bytes in hexadecimal with a blank between each.
#[derive(Clone, Copy, Debug)]
pub struct Spaced<'a>(pub &'a [u8]);

impl fmt::Display for Spaced<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (at, byte) in self.0.iter().enumerate() {
            if at > 0 {
                f.write_str(" ")?;
            }
            write!(f, "{byte:02X}")?;
        }
        Ok(())
    }
}
