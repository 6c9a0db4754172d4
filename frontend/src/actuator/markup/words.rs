//! What the settings say in words: whether a partial stroke could run, positioner, fail-safe, modes,
//! interlocks, inputs and relays.

use shared::icon3000::words::{
    Contact, Statement, Truth, fail_safe, inputs, interlocks, modes, positioner, pst, relays,
};
use shared::map::row::Source;
use shared::problem::Severity;

use super::tools::read_at;
use crate::actuator::state::dossier::Dossier;
use crate::actuator::state::health::inputs as inputs_of;
use crate::actuator::state::saved::model;
use crate::actuator::state::wanted::within;
use crate::markup::Markup;

/// Registers that the sentences rest on: the first and how many.
pub const REGISTERS: [(u16, u16); 8] = [
    (3001, 22),
    (3027, 4),
    (3480, 1),
    (3500, 2),
    (3515, 3),
    (3563, 67),
    (3920, 1),
    (3940, 1),
];

/// All sentences.
pub fn words(html: &mut Markup, dossier: &Dossier, now: i64) {
    let Some(model) = model(dossier.device) else {
        return;
    };
    let image = &dossier.image;
    let mut rows = dossier.rows(&|row| within(row, &REGISTERS));
    rows.extend(inputs_of(dossier));
    read_at(html, dossier, &rows, now);
    let test = pst(model, image);
    html.open("div", &[("class", "icon-words")]);
    html.open("section", &[("data-testid", "words-pst")]);
    html.node("h3", "", "Could a partial stroke (PST) run now?");
    html.open("p", &[("class", "icon-answer")]);
    truth(html, test.could_run);
    html.text(&test.text).close("p");
    statements(html, &test.reasons);
    html.close("section");
    for (key, title, said) in [
        ("positioner", "Positioner", positioner(model, image)),
        ("fail-safe", "Fail-safe", fail_safe(model, image)),
        ("modes", "Who commands", modes(model, image)),
        ("interlocks", "Interlocks", interlocks(model, image)),
    ] {
        html.open("section", &[("data-testid", &format!("words-{key}"))]);
        html.node("h3", "", title);
        statements(html, &said);
        html.close("section");
    }
    html.close("div");
    for (key, title, contacts) in [
        ("inputs", "Input bits DIN1 to DIN6", inputs(model, image)),
        ("relays", "Relays AS1 to AS8", relays(model, image)),
    ] {
        if !contacts.is_empty() {
            table(html, key, title, &contacts);
        }
    }
}

/// A mark for what does not hold or is not known; what holds has none.
fn truth(html: &mut Markup, holds: Truth) {
    match holds {
        Truth::Yes => {}
        Truth::No => {
            html.severity(Severity::Error).text(" ");
        }
        Truth::Unknown => {
            html.severity(Severity::Note).text(" ");
        }
    }
}

fn statements(html: &mut Markup, statements: &[Statement]) {
    html.open("ul", &[]);
    for said in statements {
        html.open("li", &[("data-testid", "words"), ("data-key", said.key)]);
        if let Some(holds) = said.holds {
            truth(html, holds);
        }
        html.text(&said.text).text(" ");
        if said.inferred {
            html.node("em", "trust", "inferred").text(" ");
        }
        proof(html, &said.from, &said.source);
        html.close("li");
    }
    html.close("ul");
}

/// Where a sentence comes from.
fn proof(html: &mut Markup, from: &[String], source: &Source) {
    let text = format!("{} · {source}", from.join(", "));
    html.node("span", "quiet proof", &text);
}

fn table(html: &mut Markup, key: &str, title: &str, contacts: &[Contact]) {
    html.node("h3", "", title);
    html.open("div", &[("class", "icon-table")]);
    html.open("table", &[("class", "plain"), ("data-testid", key)])
        .open("thead", &[])
        .open("tr", &[]);
    let relays = contacts.iter().any(|c| c.contact.is_some());
    let mut names = vec!["", "Shows", "Now", "Registers"];
    if relays {
        names.insert(2, "Contact");
    }
    for name in names {
        html.open("th", &[("scope", "col")]).text(name).close("th");
    }
    html.close("tr").close("thead").open("tbody", &[]);
    for contact in contacts {
        html.open(
            "tr",
            &[("data-testid", "contact"), ("data-name", &contact.name)],
        );
        html.open("th", &[("scope", "row")])
            .text(&contact.name)
            .close("th");
        html.node("td", "", &contact.function);
        if relays {
            html.node("td", "", contact.contact.as_deref().unwrap_or(""));
        }
        html.open("td", &[]);
        match (contact.is_on, relays) {
            (None, _) => html.node("span", "quiet", "not read"),
            (Some(true), true) => html.node("b", "", "closed"),
            (Some(true), false) => html.node("b", "", "on"),
            (Some(false), true) => html.text("open"),
            (Some(false), false) => html.text("off"),
        };
        html.close("td");
        let registers: Vec<_> = contact.registers.iter().map(u16::to_string).collect();
        html.node("td", "quiet", &format!("HR {}", registers.join(", ")));
        html.close("tr");
    }
    html.close("tbody").close("table").close("div");
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::actuator::markup::rows::tests::device;

    fn drawn(dossier: &Dossier) -> String {
        let mut html = Markup::new();
        words(&mut html, dossier, 0);
        html.finish()
    }

    /// Section 12: EFS input mode 0 (PST-EFS) and interlock mode 1 (Advanced); section 9.3: the
    /// delay is 10 s and the 5 s that are set.
    #[test]
    fn sentences_carry_their_proof() {
        let html = drawn(&device(&[
            (3019, &[1, 5, 0]),
            (3027, &[0, 0]),
            (3940, &[1]),
        ]));
        for part in [
            "Interlock mode must be Advanced",
            "after 15 s",
            "section 12",
            "HR 3027",
            "data-name=\"AS8\"",
            "data-name=\"DIN1\"",
        ] {
            assert!(html.contains(part), "{part}: {html}");
        }
        let answer = html.split("icon-answer").nth(1).unwrap();
        assert!(
            answer.split("</p>").next().unwrap().contains("No."),
            "{html}"
        );
    }

    /// On an ICON2000v4 discrete input 5 is what bit 5 of HR 3001 is later: REMOTE (tables 2 and 5).
    #[test]
    fn an_older_model_tells_by_its_inputs() {
        let mut dossier = Dossier::new("x", shared::device::Device::Icon2000v4);
        let addresses: Vec<_> = inputs_of(&dossier)
            .iter()
            .map(|r| r.address.get())
            .collect();
        assert_eq!((addresses.len(), addresses.first()), (30 + 5, Some(&0)));
        let response = [2, 4, 0b0010_0000, 0, 0, 0];
        assert!(dossier.absorb(&[2, 0, 0, 0, 30], &response, 1));
        let html = drawn(&dossier);
        assert!(
            html.contains("in REMOTE") && html.contains("DI 5"),
            "{html}"
        );
        assert!(html.contains("read-at"));
    }

    #[test]
    fn what_was_not_read_is_not_known() {
        let html = drawn(&device(&[]));
        assert!(
            html.contains("Not known.") && html.contains("not read"),
            "{html}"
        );
        assert!(!html.contains("Yes:"));
    }
}
