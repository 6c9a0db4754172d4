//! The logs of the device as tables.

use shared::icon3000::model::{HEALTH, Meaning};
use shared::value::Quality;

use crate::actuator::state::dossier::Dossier;
use crate::actuator::state::logs::{Column, Filter, LOGS, Row, Table};
use crate::chart::time::stamp;
use crate::components::icon::Glyph;
use crate::dop::markup::sign_of;
use crate::dop::when::{ago, span};
use crate::format::count;
use crate::markup::Markup;
use crate::markup::control::{Button, Choice, search, tick};
use crate::markup::device::sign;

/// Which log is open. `address` makes the address of a log.
pub fn choose(html: &mut Markup, logs: &[u16], open: u16, address: impl Fn(&str) -> String) {
    for &file in logs {
        let name = match file {
            2 => "Alarms",
            3 => "Warnings",
            4 => "Connections",
            5000 => "Events",
            _ => "File 5, raw",
        };
        let id = file.to_string();
        html.open(
            "a",
            &[
                ("class", "option"),
                ("href", &address(&format!("log={id}"))),
                ("data-testid", &format!("icon-log-{id}")),
                ("aria-current", if file == open { "page" } else { "false" }),
            ],
        );
        html.text(name);
        if file != 5 && !is_old(logs) {
            html.text(" ").node("code", "quiet", &id);
        }
        html.close("a");
    }
    if is_old(logs) {
        html.node(
            "span",
            "quiet",
            "The five latest of each, from registers: longer logs, connections, events and file 5 came with the ICON3000v2.",
        );
    }
}

/// True for the logs of a model that has no files.
const fn is_old(logs: &[u16]) -> bool {
    logs.len() < LOGS.len()
}

/// What is looked for, and the files.
pub fn filters(html: &mut Markup, table: &Table, filter: &Filter) {
    search(
        html,
        "text",
        "log-filter",
        "Text, number or time",
        &filter.text,
    );
    if let Some((_, field)) = table.codes() {
        let members = field.set.map_or(&[][..], |s| s.members);
        let codes: Vec<(String, &str)> = members
            .iter()
            .map(|m| (m.value.to_string(), m.label))
            .collect();
        let value = filter.code.map_or_else(String::new, |c| c.to_string());
        let label = format!("Every {}", field.label.to_ascii_lowercase());
        Choice {
            act: "code",
            testid: "log-code",
            label: &label,
            value: &value,
            ..Choice::default()
        }
        .draw(html, codes.iter().map(|(c, w)| (c.as_str(), *w)));
    }
    if table.has_times() {
        tick(html, "raw", "log-raw", "Raw words", filter.raw);
    }
    for (act, words) in [("csv", "CSV"), ("json", "JSON")] {
        Button {
            act,
            testid: &format!("log-{act}"),
            words,
            glyph: Some(Glyph::Save),
            disabled: table.rows.is_empty(),
            ..Button::default()
        }
        .draw(html);
    }
}

/// How many entries there are, whose clock their times are of, what is wrong.
pub fn status(html: &mut Markup, dossier: &Dossier, table: &Table, shown: usize) {
    html.open("p", &[]);
    let rows = u64::try_from(table.rows.len()).unwrap_or(0);
    let noun = if table.has_times() {
        table.item
    } else {
        "record"
    };
    html.node("b", "", &count(rows, &noun.to_ascii_lowercase()));
    if let Some(stored) = table.stored.filter(|s| u64::from(*s) != rows) {
        html.text(&format!(" of {stored} stored"));
    }
    if shown != table.rows.len() {
        html.text(&format!(", {shown} shown"));
    }
    for (name, text) in &table.head {
        html.text(" · ");
        html.node("span", "quiet", name).text(" ").text(text);
    }
    html.text(" · ").node(
        "span",
        "quiet",
        &format!("{}, {}", table.place, table.source),
    );
    html.close("p");
    if table.has_times() {
        html.open("p", &[("class", "quiet"), ("data-testid", "log-clock")]);
        html.text(&clock(dossier.clock_offset())).close("p");
    } else {
        html.node("p", "quiet", table.note);
    }
    for problem in table.problems.iter().take(5) {
        html.open("p", &[("data-testid", "log-problem")]);
        html.severity(shared::problem::Severity::Warning);
        html.text(" ").text(problem).close("p");
    }
    if let Some(more) = table.problems.len().checked_sub(5).filter(|n| *n > 0) {
        html.node("p", "quiet", &format!("and {more} more"));
    }
}

/// Whose clock times are of, and how far it is from ours.
#[must_use]
pub fn clock(offset: Option<i64>) -> String {
    let lead = "Times are those of the clock in the actuator, whose time zone it does not tell; ";
    let by = |seconds: i64| span(seconds.unsigned_abs());
    let words = match offset {
        None => "how far it is from ours is not known: its date and time were not read.".to_owned(),
        Some(-2..=2) => "it goes with UTC to 2 seconds.".to_owned(),
        Some(ahead @ 1..) => format!("it is {} ahead of UTC.", by(ahead)),
        Some(behind) => format!("it is {} behind UTC.", by(behind)),
    };
    format!("{lead}{words}")
}

/// Names of the columns, each a button to sort by.
pub fn head(html: &mut Markup, table: &Table, filter: &Filter) {
    html.open("div", &[("class", &class(table)), ("role", "row")]);
    let column = |html: &mut Markup, column: Column, name: &str| {
        let key = match column {
            Column::Number => "number".to_owned(),
            Column::Time => "time".to_owned(),
            Column::Value(at) => at.to_string(),
        };
        let sort = match (filter.column == column, filter.down) {
            (false, _) => "none",
            (true, false) => "ascending",
            (true, true) => "descending",
        };
        html.open("span", &[("role", "columnheader"), ("aria-sort", sort)]);
        html.open(
            "button",
            &[
                ("class", "quiet-button"),
                ("data-act", "sort"),
                ("data-column", &key),
                ("data-testid", "log-sort"),
            ],
        );
        html.text(name);
        if sort != "none" {
            html.icon(if filter.down { Glyph::Down } else { Glyph::Up });
        }
        html.close("button").close("span");
    };
    let number = if table.has_times() { "No." } else { "Record" };
    column(html, Column::Number, number);
    if table.has_times() {
        column(html, Column::Time, "Time, device clock");
    }
    for (at, name) in table.names().iter().enumerate() {
        column(html, Column::Value(at), name);
    }
    html.close("div");
}

fn class(table: &Table) -> String {
    format!("icon-log-row log-{}", table.file)
}

/// One entry.
pub fn row(html: &mut Markup, table: &Table, row: &Row, raw: bool, offset: Option<i64>, now: i64) {
    html.open(
        "div",
        &[
            ("class", &class(table)),
            ("data-testid", "log-row"),
            ("data-number", &row.number.to_string()),
        ],
    );
    html.node("code", "quiet num", &row.number.to_string());
    if table.has_times() {
        html.open("span", &[("class", "log-when")]);
        match row.time {
            Some(time) => {
                html.node("span", "exact", &stamp(time)).text(" ");
                if let Some(offset) = offset {
                    html.node("span", "quiet log-ago", &ago(time - offset, now));
                }
            }
            None => {
                html.node("span", "quiet", "not read");
            }
        }
        html.close("span");
    }
    for (at, cell) in row.cells.iter().enumerate() {
        html.open("span", &[("class", "log-cell")]);
        match cell {
            Some(cell) => {
                let set = table.columns.get(at).and_then(|f| f.set);
                let set = set.map_or("", |s| s.name);
                if let Some(meaning) = cell.number.and_then(|code| meaning(set, code)) {
                    sign(html, sign_of(meaning.status), "18");
                    html.text(" ");
                }
                if raw {
                    html.node("code", "", &cell.raw);
                } else {
                    html.text(&cell.text);
                }
                if !raw && !cell.unit.is_empty() {
                    html.text(" ").node("i", "unit", cell.unit);
                }
                if cell.quality != Quality::Good && table.has_times() {
                    html.text(" ").node("em", "quality", cell.quality.label());
                }
            }
            None => {
                html.node("span", "quiet", "not read");
            }
        }
        html.close("span");
    }
    html.close("div");
}

/// What a code means for the device, if it means anything.
fn meaning(set: &str, code: i64) -> Option<&'static Meaning> {
    HEALTH
        .iter()
        .find(|m| m.set == set && i64::from(m.value) == code)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::actuator::state::logs::{Y2K, logs_of};
    use shared::device::Device;

    /// An alarm that code 12 names, a minute before second 100 000 of 2000.
    fn device() -> Dossier {
        let mut dossier = Dossier::new("XV", Device::Icon3000v2);
        let request = [0x14, 7, 6, 0, 2, 0, 0, 0, 4];
        let response = [0x14, 10, 9, 6, 0, 1, 0, 1, 0x86, 0xA0, 0, 12];
        assert!(dossier.absorb(&request, &response, 1));
        dossier
    }

    fn drawn(draw: impl Fn(&mut Markup)) -> String {
        let mut html = Markup::new();
        draw(&mut html);
        html.finish()
    }

    #[test]
    fn an_entry_has_sign_time_and_raw() {
        let table = Table::of(&device(), 2);
        let now = Y2K + 100_000 + 3 * 3600;
        let said = |raw| drawn(|html| row(html, &table, &table.rows[0], raw, Some(0), now));
        for part in ["2000-01-02 03:46:40", "3 hours ago", "Lost", "sign-f"] {
            assert!(said(false).contains(part), "{part}: {}", said(false));
        }
        assert!(said(true).contains(">000C<") && !said(true).contains("Lost"));
    }

    #[test]
    fn an_older_model_says_what_it_has_not() {
        let open =
            |dossier: &Dossier| drawn(|html| choose(html, logs_of(dossier), 2, str::to_owned));
        let html = open(&Dossier::new("x", Device::Icon3000));
        assert_eq!(html.matches("icon-log-").count(), 2, "{html}");
        assert!(html.contains("came with the ICON3000v2"));
        let html = open(&device());
        assert_eq!(html.matches("icon-log-").count(), 5, "{html}");
        assert!(!html.contains("came with"));
    }

    #[test]
    fn columns_say_how_they_are_sorted() {
        let table = Table::of(&device(), 2);
        let mut filter = Filter::default();
        filter.sort(Column::Time);
        let html = drawn(|html| head(html, &table, &filter));
        assert_eq!(html.matches("ascending").count(), 1);
        assert_eq!(html.matches("data-act=\"sort\"").count(), 3);
    }

    #[test]
    fn the_clock_is_compared_in_words() {
        assert!(clock(Some(1)).contains("goes with UTC"));
        assert!(clock(Some(3600)).contains("60 minutes ahead"));
        assert!(clock(Some(-7200)).contains("2 hours behind"));
        assert!(clock(None).contains("not known"));
    }

    #[test]
    fn status_counts() {
        let dossier = device();
        let table = Table::of(&dossier, 2);
        let html = drawn(|html| status(html, &dossier, &table, 0));
        assert!(
            html.contains("1 alarm<") && html.contains(", 0 shown"),
            "{html}"
        );
        assert!(html.contains("table 31"));
    }
}
