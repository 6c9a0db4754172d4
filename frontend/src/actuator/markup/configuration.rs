//! All that can be set: present value, range, level, and what is out of its range.

use shared::address::{Address, Table};
use shared::map::row::{Access, Kind, Row};
use shared::value::{Quality, Value};

use super::rows::{Around, cell, list};
use super::{heading, rows};
use crate::actuator::state::dossier::Dossier;
use crate::format::count;
use crate::markup::Markup;
use crate::markup::control::{Choice, tick};

/// The user level logged in.
const LEVEL: u16 = 3480;

/// What is looked for among the settings.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Filter {
    /// Text in the name, or an address.
    pub text: String,
    /// A group, empty for all.
    pub group: String,
    /// True for those that are out of range, disputed or not valid.
    pub marked: bool,
}

/// Registers of a device that can be written, in the order of the map.
#[must_use]
pub fn writable(dossier: &Dossier) -> Vec<&'static Row> {
    let Some(map) = dossier.device.map() else {
        return Vec::new();
    };
    let rows = map.rows_of(Table::Holding).iter().copied();
    rows.filter(|row| matches!(row.access, Access::Write | Access::WriteGuarded))
        .filter(|row| row.kind != Kind::Reserved)
        .collect()
}

/// Groups in the order in which the map has them first, with their rows.
#[must_use]
pub fn groups(rows: &[&'static Row]) -> Vec<(&'static str, Vec<&'static Row>)> {
    let mut groups: Vec<(&'static str, Vec<&'static Row>)> = Vec::new();
    for &row in rows {
        match groups.iter_mut().find(|(name, _)| *name == row.group) {
            Some((_, rows)) => rows.push(row),
            None => groups.push((row.group, vec![row])),
        }
    }
    groups
}

/// True if something speaks against the value of a row.
#[must_use]
pub fn is_marked(dossier: &Dossier, row: &'static Row) -> bool {
    let cell = cell(dossier, row);
    cell.is_some_and(|c| matches!(c.quality, Quality::OutOfRange | Quality::Invalid))
}

impl Filter {
    fn passes(&self, dossier: &Dossier, row: &'static Row) -> bool {
        let text = self.text.trim().to_ascii_lowercase();
        let named = text.is_empty()
            || row.label.to_ascii_lowercase().contains(&text)
            || row.address.get().to_string().starts_with(&text);
        let grouped = self.group.is_empty() || row.group == self.group;
        named && grouped && (!self.marked || is_marked(dossier, row))
    }
}

/// The filters.
pub fn filters(html: &mut Markup, dossier: &Dossier, filter: &Filter) {
    html.open(
        "input",
        &[
            ("type", "search"),
            ("data-act", "text"),
            ("data-testid", "config-filter"),
            ("data-value", &filter.text),
            ("value", &filter.text),
            ("placeholder", "Name or address"),
            ("aria-label", "Name or address of a setting"),
            ("data-find", ""),
        ],
    );
    let writable = writable(dossier);
    let groups = groups(&writable);
    Choice {
        act: "group",
        testid: "config-group",
        label: "All groups",
        value: &filter.group,
        ..Choice::default()
    }
    .draw(html, groups.iter().map(|(name, _)| (*name, *name)));
    let marked = writable.iter().filter(|r| is_marked(dossier, r)).count();
    let words = format!("Out of range ({marked})");
    tick(html, "marked", "config-marked", &words, filter.marked);
}

/// Who is logged in, as far as the device tells.
pub fn logged_in(html: &mut Markup, dossier: &Dossier) {
    html.open(
        "p",
        &[("class", "icon-level-now"), ("data-testid", "level")],
    );
    html.text("User level logged in: ");
    let row = dossier
        .device
        .map()
        .and_then(|map| map.row_at(Table::Holding, Address::new(LEVEL)))
        .filter(|row| row.access != Access::Absent);
    match row {
        Some(row) => {
            let cell = cell(dossier, row);
            rows::value(html, row, cell.as_ref());
            let words = match dossier.image.row(row).map(|seen| seen.judged.value) {
                Some(Value::Code { raw: 0, .. }) => {
                    " Nothing but a login is accepted; other writes are discarded without an error."
                }
                Some(Value::Code { raw: 1, .. }) => {
                    " The level after power-up. Writes that need Service are discarded without an error."
                }
                _ => "",
            };
            html.text(words)
                .text(" ")
                .node("span", "quiet", "HR 3480, section 11")
        }
        None => html.node(
            "span",
            "quiet",
            "this model has no user levels (section 11: ICON3000v2 only)",
        ),
    };
    html.close("p");
}

/// The settings in their groups.
pub fn settings(html: &mut Markup, dossier: &Dossier, filter: &Filter, around: &Around) {
    let rows: Vec<_> = writable(dossier)
        .into_iter()
        .filter(|row| filter.passes(dossier, row))
        .collect();
    if rows.is_empty() {
        html.open("p", &[("class", "empty"), ("data-testid", "icon-nothing")]);
        html.text(if dossier.device.map().is_none() {
            "The kind of this device is not known yet."
        } else {
            "No setting passes these filters. Clear the text, or choose another group."
        })
        .close("p");
    }
    for (name, rows) in groups(&rows) {
        let n = u64::try_from(rows.len()).unwrap_or(0);
        heading(html, name, &count(n, "setting"));
        list(html, dossier, &rows, around);
    }
}

#[cfg(test)]
mod tests {
    use super::super::rows::tests::device;
    use super::*;

    fn drawn(dossier: &Dossier, filter: &Filter) -> String {
        let mut html = Markup::new();
        let around = Around {
            settings: true,
            ..Around::default()
        };
        settings(&mut html, dossier, filter, &around);
        html.finish()
    }

    /// Reading E57: every RW row of table 5 can be written, 471 registers on a v2; as values.
    #[test]
    fn everything_writable_is_there_once() {
        let dossier = device(&[]);
        let rows = writable(&dossier);
        let words: u32 = rows.iter().map(|r| u32::from(r.words)).sum();
        assert_eq!(words, 471);
        let all = drawn(&dossier, &Filter::default());
        assert_eq!(all.matches("data-testid=\"icon-row\"").count(), rows.len());
    }

    #[test]
    fn filters_narrow() {
        let dossier = device(&[(3615, &[50])]);
        let text = Filter {
            text: "pst travel".into(),
            ..Filter::default()
        };
        assert!(drawn(&dossier, &text).contains("data-address=\"3615\""));
        let marked = Filter {
            marked: true,
            ..Filter::default()
        };
        assert_eq!(drawn(&dossier, &marked).matches("icon-line").count(), 1);
        let none = Filter {
            text: "nonsense".into(),
            ..Filter::default()
        };
        assert!(drawn(&dossier, &none).contains("icon-nothing"));
    }

    #[test]
    fn the_level_is_told() {
        let say = |dossier: &Dossier| {
            let mut html = Markup::new();
            logged_in(&mut html, dossier);
            html.finish()
        };
        let html = say(&device(&[(3480, &[1])]));
        assert!(html.contains(">User (1)</b>"), "{html}");
        assert!(say(&device(&[])).contains("not read"));
        let old = Dossier::new("XV", shared::device::Device::Icon3000);
        assert!(say(&old).contains("no user levels"));
    }
}
