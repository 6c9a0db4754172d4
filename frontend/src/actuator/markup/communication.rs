//! The Modbus interface of the device: its channels, its counters, its settings.

use shared::address::Table;
use shared::icon3000::counters::{Counter, NAMES, SOURCE, of_channel};
use shared::icon3000::model::READINGS;
use shared::map::row::{Reading, Row};

use super::tools::when;
use super::{heading, reading};
use crate::actuator::state::dossier::Dossier;
use crate::format::thousands;
use crate::markup::Markup;
use crate::markup::control::tick;

/// Registers of the Modbus interface besides its counters, in the order of the map.
#[must_use]
pub fn registers(dossier: &Dossier) -> Vec<&'static Row> {
    let counted = |row: &Row| {
        let mut all = NAMES.iter().flat_map(|c| c.registers);
        all.any(|address| address == row.address.get())
    };
    all_registers(dossier)
        .into_iter()
        .filter(|row| !counted(row))
        .collect()
}

/// Registers of the Modbus interface, in the order of the map.
#[must_use]
pub fn all_registers(dossier: &Dossier) -> Vec<&'static Row> {
    dossier.rows(&|row| row.group == "Modbus" && row.table == Table::Holding)
}

/// The counters, by FC 08 and in the registers of both channels.
pub fn counters(html: &mut Markup, dossier: &Dossier, now: i64) {
    heading(html, "Counters", "FC 08 and HR 3531 to 3542");
    let read = NAMES.iter().filter_map(|c| dossier.count(c.sub));
    when(html, dossier, read.map(|r| r.at).min(), now);
    html.open("div", &[("class", "icon-table")]);
    html.open("table", &[("class", "plain counters")])
        .open("thead", &[])
        .open("tr", &[]);
    for name in [
        "Counter",
        "FC 08",
        "Channel 1",
        "Channel 2",
        "What it counts",
    ] {
        html.open("th", &[("scope", "col")]).text(name).close("th");
    }
    html.close("tr").close("thead").open("tbody", &[]);
    for counter in &NAMES {
        row(html, dossier, counter);
    }
    html.close("tbody").close("table").close("div");
    html.open("p", &[("class", "quiet")]);
    html.text("They begin at 0 with power up; no sub-function clears them. Which channel FC 08 counts is not stated, presumably the one that is asked. ");
    if let Some(read) = found("E60") {
        reading(html, read);
    }
    html.text(&format!(" {SOURCE}")).close("p");
}

fn found(id: &str) -> Option<&'static Reading> {
    let maps = shared::device::Device::Icon3000v2.map();
    let of_map = maps.and_then(|map| map.reading(id));
    of_map.or_else(|| READINGS.iter().find(|r| r.id == id))
}

fn row(html: &mut Markup, dossier: &Dossier, counter: &Counter) {
    let sub = counter.sub.to_string();
    html.open("tr", &[("data-testid", "counter"), ("data-sub", &sub)]);
    html.open("th", &[("scope", "row")]);
    html.text(counter.label)
        .text(" ")
        .node("code", "quiet", &sub)
        .close("th");
    let fc08 = dossier.count(counter.sub).map(|r| r.count);
    let channels = [0, 1].map(|channel| of_channel(&dossier.image, counter, channel));
    let places = [None].into_iter().chain(counter.registers.map(Some));
    for (count, place) in [fc08].into_iter().chain(channels).zip(places) {
        html.open("td", &[("class", "num")]);
        match count {
            Some(count) => {
                html.text(&thousands(count.into()));
                if counter.is_error && count > 0 {
                    html.text(" ");
                    html.severity(shared::problem::Severity::Note);
                }
            }
            None => {
                let there = place.is_none_or(|place| has(dossier, place));
                let why = if there {
                    "not read"
                } else {
                    "not on this model"
                };
                html.node("span", "quiet", why);
            }
        }
        if let Some(place) = place {
            html.text(" ")
                .node("small", "quiet", &format!("HR {place}"));
        }
        html.close("td");
    }
    html.open("td", &[("class", "quiet")]).text(counter.meaning);
    if let Some(read) = found(counter.reading).filter(|_| counter.reading == "E59") {
        html.text(" ");
        reading(html, read);
    }
    html.close("td").close("tr");
}

/// True if the model has a holding register.
fn has(dossier: &Dossier, address: u16) -> bool {
    let block = shared::proto::Block {
        table: shared::proto::TableName::Holding,
        start: address,
        count: 1,
    };
    dossier.has(shared::proto::IconStep::Block(block))
}

/// Reads the counters again and again while it is on.
pub fn watch(html: &mut Markup, on: bool, rounds: usize) {
    heading(html, "Error rates over time", "");
    html.open("p", &[("class", "icon-watch")]);
    tick(html, "watch", "watch", "Read the counters every 5 s", on);
    if rounds < 2 {
        html.text(" ")
            .node("span", "quiet", "Two readings make a rate.");
    }
    html.close("p");
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::actuator::markup::rows::tests::device;

    #[test]
    fn counters_stand_beside_each_other() {
        let mut dossier = device(&[(3531, &[1207, 900, 0, 3, 0, 0])]);
        assert!(dossier.absorb(&[8, 0, 13, 0, 0], &[8, 0, 13, 0, 3], 1));
        let mut html = Markup::new();
        counters(&mut html, &dossier, 0);
        let html = html.finish();
        assert_eq!(html.matches("data-testid=\"counter\"").count(), 6);
        assert!(
            html.contains("1\u{2009}207") && html.contains("HR 3534"),
            "{html}"
        );
        // FC 08 but one, and channel 2 throughout.
        assert_eq!(html.matches("not read").count(), 5 + 6);
        assert!(html.contains("E59") && html.contains("E60"));
    }

    /// HR 3531 and on came with the ICON3000v2 (table 5).
    #[test]
    fn an_older_model_has_no_counters_of_channels() {
        let mut html = Markup::new();
        counters(
            &mut html,
            &Dossier::new("x", shared::device::Device::Icon3000),
            0,
        );
        let html = html.finish();
        assert_eq!(html.matches("not on this model").count(), 12, "{html}");
        assert_eq!(html.matches("not read").count(), 6);
    }

    #[test]
    fn settings_are_listed_without_counters() {
        let dossier = device(&[]);
        let all = all_registers(&dossier).len();
        assert_eq!(registers(&dossier).len(), all - 12);
    }
}
