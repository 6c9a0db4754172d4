//! Registers as lines: name, value with unit and quality, and on demand everything about them.

use shared::address::Address;
use shared::icon3000::config::range;
use shared::icon3000::say::bytes_of;
use shared::map::row::{Access, DeviceMap, Kind, Level, Row, Trust};
use shared::value::{Quality, Value};

use crate::actuator::state::dossier::Dossier;
use crate::components::icon::Glyph;
use crate::format::age;
use crate::markup::Markup;
use crate::markup::facts::{fact, reading as reading_fact, trust};
use crate::state::values::{access, addresses};

/// A value as it is shown. By its own words: to decode the answer that brought it, as the first
/// program does, would bring the decoders of all protocols along.
#[derive(Clone, Debug)]
pub struct Cell {
    /// Without unit.
    pub text: String,
    /// Empty if there is none.
    pub unit: &'static str,
    /// True if nothing is set, or if it is not available.
    pub faint: bool,
    /// How far to rely on it.
    pub quality: Quality,
    /// When its oldest word was read, in microseconds.
    pub at: u64,
    /// Its words.
    pub words: Vec<u16>,
}

/// The value of a row as last read; `None` if it never was.
#[must_use]
pub fn cell(dossier: &Dossier, row: &'static Row) -> Option<Cell> {
    let seen = dossier.image.row(row)?;
    let bytes = dossier.image.bytes(row)?;
    let value = seen.judged.value;
    let numeric = matches!(value, Value::Number { .. });
    Some(Cell {
        text: if numeric {
            value.to_string()
        } else {
            bytes_of(row, &bytes)
        },
        unit: if numeric { row.unit } else { "" },
        faint: matches!(value, Value::Unavailable(_) | Value::Flags { raw: 0, .. }),
        quality: seen.judged.quality,
        at: seen.at.get(),
        words: bytes
            .chunks_exact(2)
            .filter_map(|pair| pair.first_chunk::<2>())
            .map(|pair| u16::from_be_bytes(*pair))
            .collect(),
    })
}

/// What a list of lines needs besides the device.
#[derive(Clone, Debug, Default)]
pub struct Around {
    /// Keys of the lines that are open.
    pub opened: Vec<&'static str>,
    /// Microseconds now; 0 for a saved device, whose values have no age.
    pub now: u64,
    /// True for the columns of what can be set: range and user level.
    pub settings: bool,
    /// Lines whose register says something else than the one that it shows once more, and which
    /// that is.
    pub differ: Vec<(&'static str, Address)>,
}

/// A list of registers.
pub fn list(html: &mut Markup, dossier: &Dossier, rows: &[&'static Row], around: &Around) {
    let class = if around.settings {
        "icon-rows icon-settings"
    } else {
        "icon-rows"
    };
    html.open("div", &[("class", class), ("role", "list")]);
    for row in rows {
        line(html, dossier, row, around);
    }
    html.close("div");
}

/// One register.
fn line(html: &mut Markup, dossier: &Dossier, row: &'static Row, around: &Around) {
    let cell = cell(dossier, row);
    let open = around.opened.contains(&row.key);
    let (address, _) = addresses(row);
    let quality = cell.as_ref().map_or("not read", |c| c.quality.label());
    html.open(
        "div",
        &[
            ("class", "icon-line"),
            ("role", "listitem"),
            ("data-testid", "icon-row"),
            ("data-address", &address),
            ("data-key", row.key),
            ("data-quality", quality),
        ],
    );
    html.open(
        "button",
        &[
            ("class", "icon-row"),
            ("data-act", "open"),
            ("data-key", row.key),
            ("aria-expanded", if open { "true" } else { "false" }),
        ],
    );
    html.icon(Glyph::Chevron);
    html.node("span", "icon-name", row.label);
    html.open(
        "span",
        &[("class", "icon-value"), ("data-testid", "icon-value")],
    );
    value(html, row, cell.as_ref());
    html.close("span");
    html.open("span", &[("class", "icon-quality")]);
    marks(html, row, cell.as_ref());
    if let Some((_, home)) = around.differ.iter().find(|(key, _)| *key == row.key) {
        html.node("em", "quality", &format!("HR {home} says something else"));
    }
    html.close("span");
    if around.settings {
        html.node("span", "icon-range quiet", &range(row));
        html.node("span", "icon-level quiet", row.level.map_or("", level));
    }
    html.open("span", &[("class", "icon-age quiet num")]);
    if let Some(cell) = cell.as_ref().filter(|_| around.now > 0) {
        html.text(&age(around.now.saturating_sub(cell.at)));
    }
    html.close("span").close("button");
    if open {
        details(html, dossier, row, cell.as_ref());
    }
    html.close("div");
}

/// The value with its unit, or that there is none.
pub fn value(html: &mut Markup, row: &Row, cell: Option<&Cell>) {
    match cell {
        Some(cell) => {
            let class = if cell.faint { "faint" } else { "" };
            html.node("b", class, &cell.text);
            if !cell.unit.is_empty() {
                html.text(" ").node("i", "unit", cell.unit);
            }
        }
        None if row.access == Access::Absent => {
            html.node("span", "quiet", "not on this model");
        }
        None => {
            html.node("span", "quiet", "not read");
        }
    }
}

/// What speaks against a value, and the readings that it rests on.
fn marks(html: &mut Markup, row: &Row, cell: Option<&Cell>) {
    if let Some(cell) = cell.filter(|c| c.quality != Quality::Good) {
        html.node("em", "quality", cell.quality.label()).text(" ");
    }
    if let Some(read) = row.reading {
        // The open line has its words.
        html.node("em", "trust", read.id).text(" ");
    } else if row.trust == Trust::Inferred {
        html.node("em", "trust", row.trust.key());
    }
}

/// A user level in words.
#[must_use]
pub const fn level(level: Level) -> &'static str {
    match level {
        Level::Observer => "Observer",
        Level::User => "User",
        Level::Service => "Service",
        Level::Manufacturer => "Manufacturer",
    }
}

/// Everything about a register.
fn details(html: &mut Markup, dossier: &Dossier, row: &'static Row, cell: Option<&Cell>) {
    html.open(
        "dl",
        &[("class", "icon-details"), ("data-testid", "icon-details")],
    );
    let (address, number) = addresses(row);
    let table = row.table.label();
    fact(html, "Address", &format!("{address} · {number} · {table}"));
    if let Some(cell) = cell {
        let words: Vec<_> = cell.words.iter().map(|w| format!("{w:04X}")).collect();
        html.node("dt", "", "Raw")
            .node("dd", "mono wrap", &words.join(" "));
        if let [word] = cell.words[..] {
            fact(html, "", &word.to_string());
        }
        fact(html, "Quality", cell.quality.label());
    }
    if !row.scale.is_one() || !row.unit.is_empty() {
        fact(html, "Scale", &format!("{} {}", row.scale, row.unit));
    }
    if let Some((min, max)) = row.range {
        fact(html, "Raw range", &format!("{min} to {max}"));
    }
    fact(html, "Access", access(row.access));
    if let Some(needed) = row.level {
        fact(html, "User level", level(needed));
    }
    let source = format!("{}, {}", row.source, trust(row.trust));
    fact(html, "Source", &source);
    if !row.note.is_empty() {
        fact(html, "Note", row.note);
    }
    let mentioned = dossier.device.map().into_iter();
    let mentioned = mentioned.flat_map(|map: &DeviceMap| map.mentioned(row.note));
    for read in row.reading.into_iter().chain(mentioned) {
        reading_fact(html, read);
    }
    html.close("dl");
    if row.kind == Kind::Bits {
        bits(html, row, cell);
    }
}

/// The bits of a word, those that are set first to be seen.
fn bits(html: &mut Markup, row: &'static Row, cell: Option<&Cell>) {
    let Some((set, cell)) = row.set.zip(cell) else {
        return;
    };
    let raw = cell
        .words
        .iter()
        .fold(0_u32, |all, w| all << 16 | u32::from(*w));
    html.open("ul", &[("class", "icon-bits")]);
    for member in set.members {
        let on = raw.wrapping_shr(member.value.into()) & 1 == 1;
        let (no, yes) = member.states.unwrap_or(shared::value::ACTIVE);
        html.open("li", &[("class", if on { "on" } else { "" })]);
        html.node("code", "quiet", &format!("b{}", member.value))
            .text(" ")
            .node("span", "", member.label)
            .text(" ")
            .node(if on { "b" } else { "span" }, "", if on { yes } else { no });
        html.close("li");
    }
    html.close("ul");
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use shared::address::Table;
    use shared::device::Device;

    /// A device whose holding registers say this from an address on.
    pub(crate) fn device(parts: &[(u16, &[u16])]) -> Dossier {
        let mut dossier = Dossier::new("XV-101", Device::Icon3000v2);
        for (start, words) in parts {
            put(&mut dossier, *start, words, 1_000_000);
        }
        dossier
    }

    /// Holding registers as if they had been read.
    pub(crate) fn put(dossier: &mut Dossier, start: u16, words: &[u16], at: u64) {
        let count = u16::try_from(words.len()).unwrap();
        let mut request = vec![3];
        request.extend(start.to_be_bytes());
        request.extend(count.to_be_bytes());
        let mut response = vec![3, u8::try_from(words.len() * 2).unwrap()];
        response.extend(words.iter().flat_map(|w| w.to_be_bytes()));
        assert!(dossier.absorb(&request, &response, at));
    }

    fn row(address: u16) -> &'static Row {
        let map = Device::Icon3000v2.map().unwrap();
        map.row_at(Table::Holding, Address::new(address)).unwrap()
    }

    fn drawn(dossier: &Dossier, address: u16, open: bool) -> String {
        let row = row(address);
        let around = Around {
            opened: if open { vec![row.key] } else { Vec::new() },
            now: 5_000_000,
            settings: true,
            differ: Vec::new(),
        };
        let mut html = Markup::new();
        list(&mut html, dossier, &[row], &around);
        html.finish()
    }

    /// HR 3529, battery voltage: 90 is 9.0 V, range 0 to 159 (reading E87).
    #[test]
    fn a_value_has_unit_range_and_source() {
        let html = drawn(&device(&[(3529, &[90])]), 3529, true);
        for part in [
            ">9.0</b>",
            ">V</i>",
            "0.0 to 15.9 V",
            "Observer",
            "4.0 s",
            "005A",
            "VCIOM-16345-EN",
            "E87",
        ] {
            assert!(html.contains(part), "{part}: {html}");
        }
    }

    /// HR 3615, PST travel: 5 to 40 % (reading E03).
    #[test]
    fn what_is_out_of_range_or_not_read_says_so() {
        let html = drawn(&device(&[(3615, &[50])]), 3615, false);
        assert!(
            html.contains("data-quality=\"out of range\"") && html.contains("5 to 40 %"),
            "{html}"
        );
        let html = drawn(&device(&[]), 3615, false);
        assert!(html.contains("not read") && !html.contains("<b class=\"\">0"));
    }

    /// HR 3516, last PST status: bit 3 is an overtravel.
    #[test]
    fn bits_are_named() {
        let html = drawn(&device(&[(3516, &[0b1000])]), 3516, true);
        assert!(
            html.contains("b3") && html.matches("class=\"on\"").count() == 1,
            "{html}"
        );
    }
}
