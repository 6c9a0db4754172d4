//! Rows of the register browser, and all that is known about one.

#[cfg(test)]
mod tests;

use shared::map::row::{DeviceMap, Kind, Row, Trust};
use shared::value::Quality;

use super::Markup;
use super::control::Button;
use super::facts::{fact, reading, trust};
use crate::components::icon::Glyph;
use crate::format::age;
use crate::state::health::{Freshness, freshness};
use crate::state::order::{Column, Order};
use crate::state::sorted::Columns as _;
use crate::state::tree::{Facts, binary};
use crate::state::values::{Cell, Item, RawForm, access, addresses, has_bits};

/// What a row needs besides its value.
#[derive(Clone, Copy, Debug)]
pub struct Around {
    /// Microseconds now, on the clock of the values.
    pub now: u64,
    /// How often the row is read again, `None` if it was read once.
    pub period: Option<u64>,
    /// False while connection or device are away.
    pub reachable: bool,
    /// How raw words are written.
    pub raw: RawForm,
    /// True if the bits of the row are shown below it.
    pub open: bool,
}

/// How long a change stays marked, in microseconds.
const FADE: u64 = 600_000;

/// Names of the columns; those that the list can be sorted by are buttons.
pub fn head(html: &mut Markup, raw: RawForm, order: Order) {
    html.node("span", "", "");
    sortable(html, "num", Column::Address, order);
    plain(html, "num", "Number");
    sortable(html, "", Column::Name, order);
    sortable(html, "right", Column::Value, order);
    plain(html, "", "Unit");
    sortable(html, "", Column::Age, order);
    html.open("span", &[("role", "columnheader")]).open(
        "button",
        &[
            ("class", "quiet-button"),
            ("data-act", "raw"),
            ("data-testid", "raw-form"),
        ],
    );
    html.text("Raw, ").text(raw.key()).close("button");
    html.close("span");
}

fn plain(html: &mut Markup, class: &str, text: &str) {
    html.open("span", &[("class", class), ("role", "columnheader")]);
    html.text(text).close("span");
}

fn sortable(html: &mut Markup, class: &str, column: Column, order: Order) {
    html.open(
        "span",
        &[
            ("class", &format!("{class} sortable")),
            ("role", "columnheader"),
            ("aria-sort", order.aria(column)),
        ],
    );
    html.open(
        "button",
        &[
            ("class", "quiet-button"),
            ("data-act", "sort"),
            ("data-column", column.key()),
            ("data-testid", &format!("sort-{}", column.key())),
        ],
    );
    html.text(column.label());
    if order.column == column {
        html.icon(if order.down { Glyph::Down } else { Glyph::Up });
    }
    html.close("button").close("span");
}

/// Why the list is empty, and what to do.
pub fn nothing(html: &mut Markup, query: &str, hide_reserved: bool) {
    let mut words = if query.is_empty() {
        "No register passes these filters.".to_owned()
    } else {
        format!("No register matches \u{201c}{query}\u{201d} with these filters.")
    };
    if hide_reserved {
        words.push_str(" Reserved addresses are left out; tick Reserved to see them.");
    }
    html.open("p", &[("class", "empty"), ("data-testid", "nothing")]);
    html.text(&words).text(" ");
    Button {
        act: "widen",
        testid: "widen",
        words: "Clear search and filters",
        ..Button::default()
    }
    .draw(html);
    html.close("p");
}

/// One line of the register browser.
pub fn row(html: &mut Markup, item: Item, cell: Option<&Cell>, around: &Around) {
    let row = item.row();
    let (address, number) = addresses(row);
    let is_bit = matches!(item, Item::Bit(..));
    html.open(
        "div",
        &[
            ("class", if is_bit { "value-row bit" } else { "value-row" }),
            ("data-testid", "register-row"),
            ("data-address", &address),
            ("data-table", row.table.key()),
            ("data-key", row.key),
        ],
    );
    html.open("span", &[("class", "value-chevron")]);
    if !is_bit && has_bits(row) {
        let words = if around.open {
            "Hide bits"
        } else {
            "Show bits"
        };
        let class = if around.open { "open" } else { "" };
        html.open(
            "button",
            &[
                ("class", class),
                ("tabindex", "-1"),
                ("aria-label", words),
                ("data-toggle", ""),
            ],
        );
        html.icon(Glyph::Chevron).close("button");
    }
    html.close("span");
    match item {
        Item::Row(_) => {
            html.node("span", "num mono", &address)
                .node("span", "num mono quiet", &number)
                .node("span", "value-label", row.label);
        }
        Item::Bit(_, member) => {
            html.node("span", "num mono quiet", &format!("bit {}", member.value))
                .node("span", "", "")
                .node("span", "value-label", member.label);
        }
    }
    value(html, cell, around);
    html.node("span", "unit", cell.map_or("", |c| c.unit));
    quality(html, row, cell, around);
    let raw = cell.filter(|_| !is_bit).map_or_else(String::new, |c| {
        around.raw.write(&c.words, row.table.is_bits())
    });
    html.node("code", "value-raw", &raw).close("div");
}

fn value(html: &mut Markup, cell: Option<&Cell>, around: &Around) {
    let Some(cell) = cell else {
        html.open(
            "span",
            &[("class", "value quiet"), ("data-testid", "register-value")],
        );
        html.text("–").close("span");
        return;
    };
    let mut class = String::from("value");
    for (is, name) in [
        (cell.numeric, " numeric"),
        (cell.faint, " faint"),
        (is_stale(cell, around), " stale"),
    ] {
        if is {
            class.push_str(name);
        }
    }
    // The fade began when the value came; a row drawn anew goes on with it.
    let passed = cell.changed.map(|at| around.now.saturating_sub(at));
    if let Some(passed) = passed.filter(|p| *p < FADE) {
        class.push_str(" changed fade-");
        class.push_str(&(passed / 100_000).to_string());
    }
    html.open(
        "span",
        &[
            ("class", &class),
            ("title", &cell.text),
            ("data-testid", "register-value"),
        ],
    );
    html.text(&cell.text).close("span");
}

fn is_stale(cell: &Cell, around: &Around) -> bool {
    let old = around.now.saturating_sub(cell.at);
    freshness(old, around.period, around.reachable) == Freshness::Stale
}

fn quality(html: &mut Markup, row: &Row, cell: Option<&Cell>, around: &Around) {
    html.open(
        "span",
        &[("class", "value-age"), ("data-testid", "register-age")],
    );
    match cell {
        None if row.kind == Kind::Reserved => {
            html.text("reserved");
        }
        None => {
            html.text("not read");
        }
        Some(cell) => {
            if cell.quality != Quality::Good {
                html.node("em", "quality", cell.quality.label()).text(" ");
            } else if row.trust != Trust::Manual {
                html.node("em", "trust", row.trust.key()).text(" ");
            }
            if is_stale(cell, around) {
                html.node("em", "quality stale-mark", "stale").text(" ");
            }
            html.text(&age(around.now.saturating_sub(cell.at)));
        }
    }
    html.close("span");
}

/// Everything about a line of the register browser.
pub fn detail(
    html: &mut Markup,
    map: &DeviceMap,
    item: Item,
    cell: Option<&Cell>,
    parts: &[Facts],
    copied: &str,
) {
    let row = item.row();
    let (address, number) = addresses(row);
    Button {
        act: "close",
        words: "Close",
        ..Button::default()
    }
    .draw(html);
    Button {
        act: "copy-row",
        testid: "copy-row",
        words: if copied.is_empty() {
            "Copy row"
        } else {
            copied
        },
        glyph: Some(Glyph::Copy),
        ..Button::default()
    }
    .draw(html);
    html.node("h3", "", row.label);
    html.open("p", &[("class", "detail-value")]);
    html.node("b", "", cell.map_or("not read yet", |c| &c.text));
    html.text(" ").text(cell.map_or("", |c| c.unit));
    html.close("p").open("dl", &[]);
    if let Item::Bit(_, member) = item {
        fact(
            html,
            "Bit",
            &format!("{} · {} · {}", member.value, member.label, member.key),
        );
    }
    fact(html, "Table", row.table.label());
    fact(html, "Address", &format!("{address} · number {number}"));
    if let Some(cell) = cell {
        raw_words(html, row, cell);
        fact(html, "Quality", cell.quality.label());
    }
    let words = match row.words {
        1 => String::new(),
        n => format!(", {n} words"),
    };
    fact(html, "Type", &format!("{}{words}", row.kind.key()));
    if !row.scale.is_one() || !row.unit.is_empty() {
        fact(html, "Scale", &format!("{} {}", row.scale, row.unit));
    }
    if let Some((min, max)) = row.range {
        fact(html, "Raw range", &format!("{min} to {max}"));
    }
    fact(html, "Access", access(row.access));
    if let Some(level) = row.level {
        fact(html, "User level", level.key());
    }
    fact(html, "Group", row.group);
    if let Some(since) = row.since {
        fact(html, "Since", since.key());
    }
    fact(html, "Key", row.key);
    fact(
        html,
        "Source",
        &format!("{}, {}", row.source, trust(row.trust)),
    );
    if !row.note.is_empty() {
        fact(html, "Note", row.note);
    }
    for read in row.reading.into_iter().chain(map.mentioned(row.note)) {
        reading(html, read);
    }
    html.close("dl");
    members(html, row, cell);
    decoded_parts(html, parts);
}

fn raw_words(html: &mut Markup, row: &Row, cell: &Cell) {
    let hex: Vec<_> = cell.words.iter().map(|w| format!("{w:04X}")).collect();
    html.node("dt", "", "Raw");
    html.node("dd", "mono wrap", &hex.join(" "));
    if let ([word], false) = (&cell.words[..], row.table.is_bits()) {
        let word = u32::from(*word);
        fact(html, "", &format!("{word} · {}", binary(word, 2)));
    }
}

/// The names of codes or bits; the present ones are marked.
fn members(html: &mut Markup, row: &Row, cell: Option<&Cell>) {
    let Some(set) = row.set else { return };
    let raw = cell.map(|c| {
        c.words
            .iter()
            .take(2)
            .fold(0_u32, |n, w| (n << 16) | u32::from(*w))
    });
    html.node("h4", "", if set.bits { "Bits" } else { "Codes" });
    html.open("table", &[("class", "members")])
        .open("tbody", &[]);
    for member in set.members {
        let code = u32::from(member.value);
        let is_now = raw.is_some_and(|raw| {
            if set.bits {
                raw.wrapping_shr(code) & 1 == 1
            } else {
                member.has(raw)
            }
        });
        html.open("tr", &[("class", if is_now { "now" } else { "" })]);
        html.node("td", "num mono", &member.value.to_string());
        let label = match raw {
            Some(raw) if is_now && !set.bits => member.name(raw),
            _ => member.label.into(),
        };
        html.node("td", "", &label);
        let mark = if is_now { "now" } else { "" };
        html.node("td", "quiet", mark).close("tr");
    }
    html.close("tbody").close("table");
}

/// The parts of a value that has parts, such as a torque curve.
fn decoded_parts(html: &mut Markup, parts: &[Facts]) {
    if parts.is_empty() {
        return;
    }
    html.node("h4", "", "Parts").open("dl", &[]);
    for part in parts {
        fact(html, &part.label, &format!("{} {}", part.value, part.unit));
    }
    html.close("dl");
}
