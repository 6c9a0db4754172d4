//! How long a scan takes, beside what the guide prints.

use shared::ddc100::estimate::{Estimate, compared};
use shared::ddc100::tables::is_fast;
use shared::device::Device;

use super::head::seconds;
use crate::format::millis;
use crate::markup::Markup;
use crate::network::state::scan::{BAUDS, KINDS, Mixed, Scan};
use crate::network::state::unit::kind;

/// What is entered.
/// `here` are the types of the network that is shown; empty without one.
pub fn controls(html: &mut Markup, scan: &Scan, here: &str) {
    let choice =
        |html: &mut Markup, act: &str, words: &str, value: &str, all: &[(String, String)]| {
            html.open("label", &[("class", "choice")]).text(words);
            let testid = format!("scan-{act}");
            html.open(
                "select",
                &[
                    ("data-act", act),
                    ("data-testid", &testid),
                    ("data-value", value),
                ],
            );
            for (key, label) in all {
                let mut attributes = vec![("value", key.as_str())];
                if key == value {
                    attributes.push(("selected", ""));
                }
                html.open("option", &attributes).text(label).close("option");
            }
            html.close("select").close("label");
        };
    let number = |html: &mut Markup, act: &str, words: &str, value: u16, most: &str| {
        html.open("label", &[("class", "choice")]).text(words);
        let (testid, value) = (format!("scan-{act}"), value.to_string());
        html.open(
            "input",
            &[
                ("type", "number"),
                ("min", "1"),
                ("max", most),
                ("data-act", act),
                ("data-testid", &testid),
                ("data-value", &value),
                ("value", &value),
            ],
        );
        html.close("label");
    };
    let mut kinds: Vec<_> = KINDS
        .map(|k| (k.key().to_owned(), kind(k).to_owned()))
        .into();
    if !here.is_empty() {
        kinds.insert(0, ("here".to_owned(), format!("as here: {here}")));
    }
    let of = scan.kind.map_or("here", |kind| kind.key());
    choice(html, "kind", "Type", of, &kinds);
    number(html, "units", "Units", scan.units, "250");
    number(html, "registers", "Registers of each", scan.registers, "56");
    let bauds = BAUDS.map(|b| (b.to_string(), b.to_string()));
    choice(html, "baud", "Baud", &scan.baud.to_string(), &bauds);
    let framings = [("modbus-rtu", "RTU"), ("modbus-ascii", "ASCII")]
        .map(|(key, words)| (key.to_owned(), words.to_owned()));
    choice(html, "framing", "Framing", scan.framing.key(), &framings);
    number(html, "turn", "Turn time, ms", scan.turn_ms, "1000");
}

/// The estimate and on what it rests.
pub fn result(html: &mut Markup, scan: &Scan, estimate: &Estimate) {
    html.open("p", &[("class", "big"), ("data-testid", "scan-time")]);
    html.text(&seconds(estimate.scan_us)).close("p");
    html.open("p", &[]);
    html.text(&format!(
        "{} units × ({} for query and answer + {} ms turn time), by {}.",
        scan.units,
        millis(estimate.exchange_us),
        scan.turn_ms,
        estimate.basis.label()
    ));
    html.close("p");
    html.open("dl", &[("class", "fact-list")]);
    let fact = |html: &mut Markup, label: &str, text: &str| {
        crate::markup::facts::fact(html, label, text);
    };
    fact(html, "Without turn time", &seconds(estimate.bare_us));
    fact(
        html,
        "The least that the line allows",
        &format!(
            "{} for characters and silences only",
            seconds(estimate.least_scan_us)
        ),
    );
    let printed = match estimate.printed {
        Some(printed) => format!("{} s, without turn time", printed.text),
        None => "no such line (RTU, 9600 baud; 1, 5 or 10 registers)".to_owned(),
    };
    fact(html, "Table 4.2 prints", &printed);
    html.close("dl");
    turn(html, scan);
}

/// The estimate for the network that is shown, each unit by its type.
pub fn mixed(html: &mut Markup, scan: &Scan, (here, mixed): (&str, Mixed), printed: &str) {
    html.open("p", &[("class", "big"), ("data-testid", "scan-time")]);
    html.text(&seconds(mixed.scan_us)).close("p");
    html.node(
        "p",
        "",
        &format!(
            "{here}: each by table 4.1 of its type or the nearest one, and {} ms turn time.",
            scan.turn_ms
        ),
    );
    html.open("dl", &[("class", "fact-list")]);
    for (label, text) in [
        ("Without turn time", seconds(mixed.bare_us).as_str()),
        (
            "The least that the line allows",
            &format!(
                "{} for characters and silences only",
                seconds(mixed.least_us)
            ),
        ),
        ("Table 4.2 prints", printed),
    ] {
        crate::markup::facts::fact(html, label, text);
    }
    html.close("dl");
    turn(html, scan);
}

fn turn(html: &mut Markup, scan: &Scan) {
    if !(21..50).contains(&scan.turn_ms) {
        html.node(
            "p",
            "notice",
            "The guide wants a turn time of more than 20 and less than 50 ms (section 4.3).",
        );
    }
}

/// Table 4.2 beside the units times table 4.1, which it contradicts in places (reading D23).
pub fn tables(html: &mut Markup, of: Device) {
    let fast = is_fast(of);
    let model = if fast {
        Device::Ddc100Mx
    } else {
        Device::Ddc100Uec
    };
    html.node(
        "h3",
        "",
        &format!(
            "Table 4.2 for {}, beside the units times table 4.1",
            if fast { "MX-DDC" } else { "UEC-3-DDC" }
        ),
    );
    html.node(
        "p",
        "quiet net-small",
        "RTU, 9600 baud, 8N1, function 03, without turn time. Printed, then the percentage of the units times table 4.1 (40, 50, 62 ms on an MX-DDC; 71, 109, 162 ms on a UEC-3-DDC). The print is not proportional (reading D23), so the estimate rests on table 4.1.",
    );
    html.open(
        "table",
        &[("class", "plain scan-table"), ("data-testid", "scan-table")],
    );
    html.open("thead", &[]).open("tr", &[]);
    for words in ["Units", "1 register", "5 registers", "10 registers"] {
        html.open("th", &[("scope", "col"), ("class", "num")])
            .text(words)
            .close("th");
    }
    html.close("tr").close("thead").open("tbody", &[]);
    let cells = compared(model);
    let mut units: Vec<u16> = Vec::new();
    for cell in &cells {
        if !units.contains(&cell.units) {
            units.push(cell.units);
        }
    }
    for count in units {
        html.open("tr", &[]);
        html.open("th", &[("scope", "row"), ("class", "num")])
            .text(&count.to_string())
            .close("th");
        for registers in [1, 5, 10] {
            html.open("td", &[("class", "num")]);
            let cell = cells
                .iter()
                .find(|c| c.units == count && c.registers == registers);
            if let Some(cell) = cell {
                html.text(cell.printed.text).text(" s ");
                let class = if cell.is_too_short() {
                    "bit-on"
                } else {
                    "quiet"
                };
                html.node("span", class, &format!("{} %", cell.percent()));
            }
            html.close("td");
        }
        html.close("tr");
    }
    html.close("tbody").close("table");
    html.node(
        "p",
        "quiet net-small",
        "Bold: shorter than table 4.1 allows, by more than rounding.",
    );
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_estimate_stands_beside_the_print() {
        let scan = Scan::default();
        let mut html = Markup::new();
        controls(&mut html, &scan, "");
        result(&mut html, &scan, &scan.estimate().unwrap());
        tables(&mut html, Device::Ddc100Mx);
        let html = html.finish();
        assert!(html.contains("data-testid=\"scan-time\">1.42 s<"), "{html}");
        assert!(html.contains(".98 s, without turn time"));
        assert!(html.contains("50.0 ms for query and answer + 21 ms"));
        assert_eq!(
            html.matches("scope=\"row\"").count(),
            7,
            "lines of table 4.2"
        );
        assert_eq!(html.matches("bit-on").count(), 2);
    }

    #[test]
    fn a_mixed_network_has_its_own_estimate() {
        let scan = Scan {
            kind: None,
            ..Scan::default()
        };
        let of = Mixed {
            scan_us: 1_154_000,
            bare_us: 854_000,
            least_us: 400_000,
        };
        let mut html = Markup::new();
        controls(&mut html, &scan, "4 MX-DDC, 6 UEC-3-DDC");
        mixed(&mut html, &scan, ("4 MX-DDC, 6 UEC-3-DDC", of), "1.4 s");
        let html = html.finish();
        assert!(
            html.contains("value=\"here\" selected=\"\">as here: 4 MX-DDC"),
            "{html}"
        );
        assert!(html.contains("data-testid=\"scan-time\">1.15 s<"));
        assert!(html.contains("0.85 s") && html.contains("<dd>1.4 s") || html.contains(">1.4 s<"));
    }
}
