//! Who the device is: what function 17, the registers and the cards say, and whether they agree.

use shared::address::Table;
use shared::icon3000::identity::{Fact, REPORT, Report, facts};
use shared::icon3000::model::READINGS;
use shared::icon3000::say;
use shared::map::row::Row;
use shared::render::Spaced;
use shared::value::Value;

use super::tools::{read_at, when};
use super::{heading, reading};
use crate::actuator::state::dossier::Dossier;
use crate::actuator::state::saved::{guess, model};
use crate::actuator::state::wanted::within;
use crate::markup::Markup;

/// Holding registers that say who the device is: numbers, tags, versions, types, dates, and those
/// that say it once more.
const WHO: [(u16, u16); 7] = [
    (19, 2),
    (3000, 1),
    (3034, 54),
    (3460, 14),
    (3654, 2),
    (3742, 47),
    (3909, 2),
];

/// True for a row that says who the device is; in the input registers those that an ICON2000v4 has
/// nowhere else.
#[must_use]
pub fn is_told(row: &Row) -> bool {
    match row.table {
        Table::Input => row.group == "Identity",
        _ => within(row, &WHO),
    }
}

/// Everything about who the device is.
pub fn identity(html: &mut Markup, dossier: &Dossier, now: i64) {
    let pdu = dossier.identity.as_ref().map(|a| a.pdu.as_slice());
    let report = pdu.and_then(Report::of_pdu);
    which(html, dossier);
    let Some(model) = model(dossier.device) else {
        return;
    };
    let mut all = facts(model, &dossier.image, report.as_ref(), &dossier.all_files());
    more(dossier, &mut all);
    let (cards, told): (Vec<_>, Vec<_>) = all.iter().partition(|f| f.from.starts_with("file"));
    heading(html, "What it says of itself", "");
    if told.is_empty() {
        html.open("p", &[("class", "empty"), ("data-testid", "icon-nothing")]);
        html.text("Nothing was read yet.").close("p");
    } else {
        read_at(html, dossier, &dossier.rows(&is_told), now);
        table(html, &told);
    }
    server_id(html, dossier, report.as_ref(), now);
    heading(html, "Card reports", "files 5300 to 5304, table 49");
    if cards.is_empty() {
        html.node("p", "quiet", "None was read.");
    }
    let mut name = "";
    let mut of_card: Vec<&Fact> = Vec::new();
    for fact in cards {
        if fact.from != name {
            card(html, name, &of_card);
            of_card.clear();
            name = &fact.from;
        }
        of_card.push(fact);
    }
    card(html, name, &of_card);
}

/// Adds what else the registers tell: versions and types, and the nominal torque once more.
fn more(dossier: &Dossier, facts: &mut Vec<Fact>) {
    let image = &dossier.image;
    let unit = dossier.row("torque_thrust_engineering_unit");
    let value = dossier.row("torque_thrust_value");
    if let (Some(unit), Some(value)) = (unit, value)
        && let (Some(seen), Some(amount)) = (image.row(unit), say::row(image, value))
        && let Value::Code { raw, set } = seen.judged.value
    {
        let unit_name = set.get(raw).map_or("(unit unknown)", |m| m.label);
        let value = format!("{} {unit_name}", amount.trim());
        let same = |f: &&mut Fact| f.key == TORQUE.0;
        let differ = facts.iter_mut().filter(same).any(|f| f.value != value);
        facts
            .iter_mut()
            .filter(same)
            .for_each(|f| f.disputed |= differ);
        let at = facts.iter().rposition(|f| f.key == TORQUE.0);
        facts.insert(
            at.map_or(0, |at| at + 1),
            Fact {
                key: TORQUE.0,
                label: TORQUE.1,
                value,
                from: "HR 3784 to 3788 (E04)".to_owned(),
                source: unit.source,
                disputed: differ,
            },
        );
    }
    let last = facts.iter().rposition(|f| !f.from.starts_with("file"));
    let mut at = last.map_or(0, |at| at + 1);
    for row in dossier.rows(&is_told) {
        let from = format!("{} {}", row.table.short(), row.address);
        let who = row.group == "Identity" || row.key.contains("revision");
        let known = row.key.starts_with("torque_thrust") || facts.iter().any(|f| f.from == from);
        // Dates of maintenance are settings, but for the start-up.
        if known || !(who || row.key.ends_with("start_up_date")) {
            continue;
        }
        if let Some(value) = say::row(image, row) {
            let fact = Fact {
                key: row.key,
                label: row.label,
                value,
                from,
                source: row.source,
                disputed: false,
            };
            facts.insert(at, fact);
            at += 1;
        }
    }
}

/// Key and label of the nominal torque.
const TORQUE: (&str, &str) = ("nominal_torque", "Nominal torque or thrust");

/// Which model it is, and why.
fn which(html: &mut Markup, dossier: &Dossier) {
    let guess = guess(dossier);
    html.open("p", &[("class", "icon-lead"), ("data-testid", "model")]);
    match guess.model {
        Some(model) => {
            html.text("It is an ")
                .node("b", "", model.map().name)
                .text(".");
        }
        None => {
            html.text("Which model it is, is not known.");
        }
    }
    html.text(" ").node("span", "quiet", &guess.why);
    let configured = dossier.device.map().map(|map| map.model);
    if let (Some(found), Some(set)) = (guess.model, configured)
        && found != set
    {
        html.text(" ");
        html.severity(shared::problem::Severity::Warning);
        html.text(&format!(
            " The configuration says {}; change it to see all that this one has.",
            set.map().name
        ));
    }
    html.close("p");
}

/// Statements, one a row.
fn table(html: &mut Markup, facts: &[&Fact]) {
    html.open("div", &[("class", "icon-table")]);
    html.open("table", &[("class", "plain identity")])
        .open("thead", &[])
        .open("tr", &[]);
    for name in ["What", "Value", "From", "Source"] {
        html.open("th", &[("scope", "col")]).text(name).close("th");
    }
    html.close("tr").close("thead").open("tbody", &[]);
    let mut before = "";
    for fact in facts {
        html.open(
            "tr",
            &[
                ("data-testid", "identity"),
                ("data-key", fact.key),
                ("data-from", &fact.from),
            ],
        );
        html.open("th", &[("scope", "row")]);
        if before == fact.key {
            html.node("span", "quiet", "the same");
        } else {
            html.text(fact.label);
        }
        html.close("th");
        before = fact.key;
        html.open("td", &[]).node("b", "", &fact.value);
        if fact.disputed {
            html.text(" ")
                .node("em", "quality", "says otherwise elsewhere");
        }
        html.close("td");
        html.node("td", "", &fact.from);
        html.node("td", "quiet", &fact.source.to_string())
            .close("tr");
    }
    html.close("tbody").close("table").close("div");
}

/// The answer to function 17 as it came.
fn server_id(html: &mut Markup, dossier: &Dossier, report: Option<&Report>, now: i64) {
    heading(html, "Report of server ID", "FC 17, section 8.10");
    let Some(answer) = &dossier.identity else {
        html.node("p", "quiet", "It was not read.");
        return;
    };
    when(html, dossier, Some(answer.at), now);
    html.open("p", &[("data-testid", "report")]);
    match report {
        Some(report) => {
            let words = match report.count {
                0x52 => {
                    "Byte count 0x52 (82): as the manual prints it, without server ID and run indicator, which the standard counts in."
                }
                _ => {
                    "Byte count 0x54 (84): as the standard counts, with server ID and run indicator; the manual prints 0x52."
                }
            };
            html.text(words);
            html.text(&format!(
                " Server ID {}, run indicator {}.",
                report.server_id, report.run
            ));
        }
        None => {
            html.text("The answer has not the 84 bytes that the manual describes, so nothing of it is shown but its bytes.");
        }
    }
    for id in ["E63", "E64"] {
        if let Some(read) = READINGS.iter().find(|r| r.id == id) {
            html.text(" ");
            reading(html, read);
        }
    }
    html.text(" ").node("span", "quiet", &REPORT.to_string());
    html.close("p");
    html.open("details", &[("class", "raw")]);
    html.open("summary", &[]).text("Bytes").close("summary");
    html.node("code", "mono wrap", &Spaced(&answer.pdu).to_string());
    html.close("details");
}

/// One card.
fn card(html: &mut Markup, name: &str, facts: &[&Fact]) {
    if facts.is_empty() {
        return;
    }
    html.open(
        "section",
        &[("class", "icon-card"), ("data-testid", "card")],
    );
    html.node("h3", "", name)
        .open("dl", &[("class", "icon-items")]);
    for fact in facts {
        html.open("div", &[("data-key", fact.key)]);
        html.node("dt", "", fact.label);
        html.open("dd", &[]);
        html.node("b", "", &fact.value).close("dd").close("div");
    }
    html.close("dl").close("section");
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::actuator::markup::rows::tests::device;
    use crate::actuator::state::logs::tests::put;
    use shared::icon3000::identity::PROBES;

    fn drawn(dossier: &Dossier) -> String {
        let mut html = Markup::new();
        identity(&mut html, dossier, 0);
        html.finish()
    }

    /// The report of table 29: 82 additional bytes, with `count` before them.
    fn report(count: u8) -> Vec<u8> {
        let mut pdu = vec![0x11, count, 0, 0];
        for (text, len) in [
            ("Biffi ICON3000", 16),
            ("SER-1", 28),
            ("XV-101", 28),
            ("9.02", 4),
            ("", 2),
            ("4.01", 4),
        ] {
            pdu.extend(format!("{text:<len$}").bytes());
        }
        pdu
    }

    #[test]
    fn both_byte_counts_are_explained() {
        for (count, words) in [
            (0x52, "as the manual prints it"),
            (0x54, "as the standard counts"),
        ] {
            let mut dossier = device(&[]);
            assert!(dossier.absorb(&[0x11], &report(count), 1));
            let html = drawn(&dossier);
            for part in [words, "ICON3000v2", "SER-1", "4.01", "E63", "FC 17"] {
                assert!(html.contains(part), "{part}: {html}");
            }
        }
    }

    /// The tag in HR 3056 says something else than function 17.
    #[test]
    fn what_disagrees_is_marked() {
        let mut words = [0x2020; 14];
        words[0] = 0x5A5A;
        let mut dossier = device(&[(3056, &words)]);
        assert!(dossier.absorb(&[0x11], &report(0x52), 1));
        let html = drawn(&dossier);
        assert_eq!(
            html.matches("says otherwise elsewhere").count(),
            2,
            "{html}"
        );
    }

    /// Readings E35 and E84: HR 22 came with the ICON3000, HR 3480 with the v2. Only exception 02 says that a
    /// register is not there; silence says nothing.
    #[test]
    fn what_is_refused_tells_the_model() {
        use shared::proto::{Block, IconStep, Outcome, TableName};
        let fail = |dossier: &mut Dossier, start, outcome, code| {
            let table = TableName::Holding;
            let step = IconStep::Block(Block {
                table,
                start,
                count: 1,
            });
            dossier.fail(step, outcome, code, "", 1);
        };
        let not_known = "Which model it is, is not known";
        let mut dossier = Dossier::new("x", shared::device::Device::Icon2000v4);
        for start in PROBES {
            fail(&mut dossier, start, Outcome::Silence, 0);
        }
        assert!(drawn(&dossier).contains(not_known));
        fail(&mut dossier, 3480, Outcome::Exception, 2);
        fail(&mut dossier, 22, Outcome::Exception, 2);
        assert!(drawn(&dossier).contains("It is an <b class=\"\">ICON2000v4</b>"));
        let mut dossier = device(&[(22, &[0])]);
        fail(&mut dossier, 3480, Outcome::Exception, 2);
        assert!(drawn(&dossier).contains("It is an <b class=\"\">ICON3000</b>"));
        let html = drawn(&device(&[(3480, &[1])]));
        assert!(
            html.contains("It is an <b class=\"\">ICON3000v2</b>"),
            "{html}"
        );
        let mut opened = Dossier::new("x", shared::device::Device::Icon3000);
        opened.guess = Some(shared::icon3000::identity::Guess {
            model: Some(shared::map::row::Model::Icon3000),
            why: "Its file says so.".to_owned(),
        });
        let html = drawn(&opened);
        assert!(html.contains("It is an <b class=\"\">ICON3000</b>. "));
        assert!(html.contains("Its file says so."), "{html}");
    }

    /// HR 3074 says 500 Nm; HR 3784 (reading E04: 1 is Nm) and 3785 say 400 Nm. HR 3772 is hardware
    /// revision 12 of the logic card.
    #[test]
    fn nominal_torque_and_versions_are_told() {
        let html = drawn(&device(&[
            (3074, &[0x0135, 0x3030, 0x2020, 0x2020]),
            (3784, &[1, 0x3430, 0x3020, 0x2020, 0x2020]),
            (3772, &[12]),
        ]));
        for part in [
            "500 Nm",
            "400 Nm",
            "HR 3784 to 3788 (E04)",
            "Logic Card HW Revision",
            "HR 3772",
        ] {
            assert!(html.contains(part), "{part}: {html}");
        }
        assert_eq!(
            html.matches("says otherwise elsewhere").count(),
            2,
            "{html}"
        );
        let html = drawn(&device(&[
            (3074, &[0x0134, 0x3030, 0x2020, 0x2020]),
            (3784, &[1, 0x3430, 0x3020, 0x2020, 0x2020]),
        ]));
        assert!(!html.contains("says otherwise elsewhere"), "{html}");
    }

    /// An ICON2000v4 tells its test date in IR 14 and its start-up date in HR 19 (tables 3 and 4).
    #[test]
    fn an_older_model_tells_who_it_is() {
        let mut dossier = Dossier::new("x", shared::device::Device::Icon2000v4);
        let date = [4, 4, 0x15, 0x03, 0x20, 0x19];
        assert!(dossier.absorb(&[4, 0, 14, 0, 2], &date, 1));
        let date = [3, 4, 0x16, 0x04, 0x20, 0x20];
        assert!(dossier.absorb(&[3, 0, 19, 0, 2], &date, 1));
        let html = drawn(&dossier);
        for part in ["2019-03-15", "IR 14", "2020-04-16", "HR 19"] {
            assert!(html.contains(part), "{part}: {html}");
        }
    }

    #[test]
    fn cards_stand_apart() {
        let mut dossier = device(&[]);
        put(&mut dossier, 5300, &[0x4142; 32]);
        put(&mut dossier, 5304, &[0x4344; 32]);
        let html = drawn(&dossier);
        assert_eq!(html.matches("data-testid=\"card\"").count(), 2, "{html}");
        assert!(html.contains("Base Card") && html.contains("ABABABABAB"));
        assert!(drawn(&device(&[])).contains("Which model it is, is not known"));
    }
}
