//! The register browser: which lines are shown, and what a value says.

#[cfg(test)]
mod tests;

use shared::address::{RegisterNumber, Table};
use shared::capture::Capture;
use shared::decode::Context;
use shared::device::Device;
use shared::encode::{Read, frame};
use shared::frame::Framing;
use shared::image::{Image, Seen};
use shared::map::row::{Access, DeviceMap, Kind, Level, Member, Row};
use shared::map::search::{Filter, Query, Writes};
use shared::session::Session;
use shared::tree::{Decoded, Name};
use shared::value::{Quality, Value};

use super::order::Order;

/// A line of the register browser.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Item {
    /// A value.
    Row(&'static Row),
    /// One bit of a value whose bits are shown.
    Bit(&'static Row, &'static Member),
}

impl Item {
    /// The row it belongs to.
    #[must_use]
    pub const fn row(self) -> &'static Row {
        match self {
            Self::Row(row) | Self::Bit(row, _) => row,
        }
    }

    /// Which line it is: table, address, and the bit.
    #[must_use]
    pub const fn place(self) -> (Table, u16, Option<u16>) {
        let row = self.row();
        let bit = match self {
            Self::Row(_) => None,
            Self::Bit(_, member) => Some(member.value),
        };
        (row.table, row.address.get(), bit)
    }
}

/// Which rows have their bits shown, by table and address.
pub type Opened = Vec<(Table, u16)>;

/// Shows or hides the bits of a row.
pub fn toggle(opened: &mut Opened, place: (Table, u16)) {
    match opened.iter().position(|p| *p == place) {
        Some(at) => {
            opened.swap_remove(at);
        }
        None => opened.push(place),
    }
}

/// Where a row is, for [`Opened`].
#[must_use]
pub const fn place(row: &Row) -> (Table, u16) {
    (row.table, row.address.get())
}

/// True if the bits of a row can be shown.
#[must_use]
pub fn has_bits(row: &Row) -> bool {
    row.kind == Kind::Bits && row.set.is_some()
}

/// The lines that pass a filter, in an order that may depend on what was read.
#[must_use]
pub fn items(
    map: &'static DeviceMap,
    filter: &Filter,
    opened: &Opened,
    order: Order,
    image: &Image,
) -> Vec<Item> {
    let mut rows: Vec<_> = filter.rows(map).collect();
    order.sort(&mut rows, image);
    let mut items = Vec::with_capacity(rows.len());
    for row in rows {
        items.push(Item::Row(row));
        if has_bits(row) && opened.contains(&place(row)) {
            let members = row.set.map_or(&[][..], |s| s.members);
            items.extend(members.iter().map(|m| Item::Bit(row, m)));
        }
    }
    items
}

/// What the register browser is narrowed to, as the address bar has it.
#[must_use]
pub fn filter(get: impl Fn(&str) -> Option<String>) -> Filter {
    let get = |key| get(key).filter(|v| !v.is_empty());
    Filter {
        query: Query::parse(&get("q").unwrap_or_default()),
        table: get("table").and_then(|k| Table::from_key(&k)),
        group: get("group"),
        access: get("access").and_then(|k| match k.as_str() {
            "r" => Some(Writes::No),
            "rw" => Some(Writes::Any),
            "rw!" => Some(Writes::Guarded),
            _ => None,
        }),
        level: get("level").and_then(|k| LEVELS.into_iter().find(|l| l.key() == k)),
        hide_reserved: get("reserved").is_none(),
    }
}

/// All user levels.
pub const LEVELS: [Level; 4] = [
    Level::Observer,
    Level::User,
    Level::Service,
    Level::Manufacturer,
];

/// A line as text with tabs between its columns, as spreadsheets take it: table, address, number,
/// name, value, unit, quality, raw words, source. What was not read is empty.
#[must_use]
pub fn as_text(item: Item, cell: Option<&Cell>) -> String {
    let row = item.row();
    let (address, number) = addresses(row);
    let name = match item {
        Item::Row(_) => row.label.to_owned(),
        Item::Bit(_, member) => format!("{}, bit {}: {}", row.label, member.value, member.label),
    };
    let raw: Vec<_> = cell
        .iter()
        .flat_map(|c| &c.words)
        .map(|w| format!("{w:04X}"))
        .collect();
    [
        row.table.key(),
        &address,
        &number,
        &name,
        cell.map_or("", |c| &c.text),
        cell.map_or("", |c| c.unit),
        cell.map_or("not read", |c| c.quality.label()),
        &raw.join(" "),
        &row.source.to_string(),
    ]
    .join("\t")
}

/// The words for an access.
#[must_use]
pub const fn access(access: Access) -> &'static str {
    match access {
        Access::Read => "read",
        Access::Write => "write",
        Access::WriteGuarded => "write, moves or reconfigures",
        Access::WriteOnly => "write only, moves or reconfigures",
        Access::Absent => "not on this model",
    }
}

/// Address and register number: `3004` and `403005`.
#[must_use]
pub fn addresses(row: &Row) -> (String, String) {
    (
        row.address.to_string(),
        RegisterNumber::of(row.table, row.address).to_string(),
    )
}

/// A value as it is shown.
#[derive(Clone, Debug, PartialEq)]
pub struct Cell {
    /// Without unit.
    pub text: String,
    /// Empty if there is none.
    pub unit: &'static str,
    /// True for numbers.
    pub numeric: bool,
    /// True if nothing is set, unavailable or zero in a way that is of no interest.
    pub faint: bool,
    /// How far to rely on it.
    pub quality: Quality,
    /// When its oldest word was read, in microseconds.
    pub at: u64,
    /// When it last changed.
    pub changed: Option<u64>,
    /// Its words.
    pub words: Vec<u16>,
}

/// The value of a line as last read; `None` if it never was.
#[must_use]
pub fn cell(item: Item, image: &Image) -> Option<Cell> {
    let row = item.row();
    let seen = image.row(row)?;
    let words = words(row, image);
    let base = Cell {
        text: String::new(),
        unit: "",
        numeric: false,
        faint: false,
        quality: seen.judged.quality,
        at: seen.at.get(),
        changed: seen.changed.map(shared::capture::Micros::get),
        words,
    };
    if let Item::Bit(_, member) = item {
        let Value::Flags { raw, .. } = seen.judged.value else {
            return None;
        };
        let on = raw.wrapping_shr(u32::from(member.value)) & 1 == 1;
        let (no, yes) = member.states.unwrap_or(shared::value::ACTIVE);
        return Some(Cell {
            text: if on { yes } else { no }.to_owned(),
            faint: !on,
            ..base
        });
    }
    let numeric = matches!(seen.judged.value, Value::Number { .. });
    Some(Cell {
        text: text(row, &seen, image),
        unit: if numeric { row.unit } else { "" },
        numeric,
        faint: matches!(
            seen.judged.value,
            Value::Unavailable(_) | Value::Flags { raw: 0, .. } | Value::Bit { on: false, .. }
        ) || row.kind == Kind::Reserved,
        ..base
    })
}

fn words(row: &Row, image: &Image) -> Vec<u16> {
    (0..row.words)
        .filter_map(|at| image.cell(row.table, row.address.checked_add(at)?))
        .map(|c| c.word)
        .collect()
}

fn text(row: &'static Row, seen: &Seen, image: &Image) -> String {
    match seen.judged.value {
        Value::Text | Value::Amount { .. } | Value::Samples | Value::Raw | Value::Group => {
            decoded_text(row, image).unwrap_or_default()
        }
        value => value.to_string(),
    }
}

/// Values that need their bytes are decoded as the answer that brought them.
fn decoded_text(row: &'static Row, image: &Image) -> Option<String> {
    let decoded = as_answer(row, image)?;
    let (id, field) = decoded
        .iter()
        .find(|(_, f)| matches!(f.name, Name::Row(r) if core::ptr::eq(r, row)))?;
    let text = decoded.bare_text(field);
    if !text.is_empty() {
        return Some(text);
    }
    // A curve: its first part says what it is.
    let (_, part) = decoded.iter().find(|(_, f)| f.parent == Some(id))?;
    Some(decoded.text(part))
}

/// The words of a row as a request and its answer, decoded like any other.
#[must_use]
pub fn as_answer(row: &'static Row, image: &Image) -> Option<Decoded> {
    let bytes = image.bytes(row)?;
    let request = Read::new(row.table, row.address, row.words)?.pdu();
    let mut answer = vec![row.table.read_function(), u8::try_from(bytes.len()).ok()?];
    answer.extend_from_slice(&bytes);
    let mut session = Session::new(Framing::Tcp);
    for pdu in [&request[..], &answer] {
        let bytes = frame(Framing::Tcp, 1, 1, pdu);
        session.push(&Capture::of(&bytes));
    }
    session.finish();
    let context = Context {
        framing: Framing::Tcp,
        device: Device::Icon3000v2,
    };
    let mut decoded = Decoded::default();
    session.decode(1, &context, &mut decoded).then_some(decoded)
}

/// How raw words are written.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum RawForm {
    /// Hexadecimal.
    #[default]
    Hex,
    /// Decimal, word by word.
    Decimal,
    /// Binary, word by word.
    Binary,
}

impl RawForm {
    /// All forms.
    pub const ALL: [Self; 3] = [Self::Hex, Self::Decimal, Self::Binary];

    /// The word in the list and the address bar.
    #[must_use]
    pub const fn key(self) -> &'static str {
        match self {
            Self::Hex => "hex",
            Self::Decimal => "dec",
            Self::Binary => "bin",
        }
    }

    /// The form after this one.
    #[must_use]
    pub const fn next(self) -> Self {
        match self {
            Self::Hex => Self::Decimal,
            Self::Decimal => Self::Binary,
            Self::Binary => Self::Hex,
        }
    }

    /// Writes words.
    #[must_use]
    pub fn write(self, words: &[u16], is_bits: bool) -> String {
        if is_bits {
            return words.iter().map(u16::to_string).collect();
        }
        let word = |w: &u16| match self {
            Self::Hex => format!("{w:04X}"),
            Self::Decimal => w.to_string(),
            Self::Binary => super::tree::binary(u32::from(*w), 2),
        };
        let most = 4;
        let mut text: Vec<_> = words.iter().take(most).map(word).collect();
        if words.len() > most {
            text.push("…".to_owned());
        }
        text.join(" ")
    }
}
