//! What was found lately.

use crate::components::icon::Glyph;
use crate::markup::Markup;
use crate::markup::control::Button;
use crate::network::state::log::{Log, MOST};
use crate::network::state::names::named;

/// What can be done with the list.
pub fn tools(html: &mut Markup, log: &Log) {
    for (act, testid, words, glyph) in [
        ("copy", "copy-log", "Copy", Glyph::Copy),
        ("csv", "save-log", "CSV", Glyph::Save),
    ] {
        Button {
            act,
            testid,
            words,
            glyph: Some(glyph),
            disabled: log.events.is_empty(),
            ..Button::default()
        }
        .draw(html);
    }
    html.node(
        "span",
        "quiet",
        &format!("What this page found, the newest first; the last {MOST} are kept while the network is shown."),
    );
}

/// The events. `time` writes a moment, `name` gives the tag of a unit.
pub fn events(
    html: &mut Markup,
    log: &Log,
    time: &dyn Fn(u64) -> String,
    name: &dyn Fn(u8) -> String,
) {
    if log.events.is_empty() {
        html.node(
            "p",
            "empty",
            "Nothing was found since this page was opened.",
        );
        return;
    }
    html.open(
        "table",
        &[("class", "plain net-log"), ("data-testid", "log")],
    );
    html.open("thead", &[]).open("tr", &[]);
    for words in ["Time", "Found"] {
        html.open("th", &[("scope", "col")]).text(words).close("th");
    }
    html.close("tr").close("thead").open("tbody", &[]);
    for event in &log.events {
        html.open("tr", &[("data-testid", "log-row")]);
        html.node("td", "num mono quiet", &time(event.at_ms));
        html.node("td", "", &named(&event.text(), name)).close("tr");
    }
    html.close("tbody").close("table");
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::network::state::net::tests::{network, poll};
    use shared::proto::DdcShape;

    #[test]
    fn events_have_their_time_and_tags() {
        let mut net = network(3, DdcShape::Loop, 2);
        let drawn = |log: &Log| {
            let mut html = Markup::new();
            tools(&mut html, log);
            events(&mut html, log, &|ms| format!("at {ms}"), &|unit| {
                format!("MOV-{unit}")
            });
            html.finish()
        };
        let html = drawn(&net.log);
        assert!(html.contains("Nothing was found") && html.contains("disabled"));
        net.log.now_ms = 77;
        poll(&mut net, 2, [Some(true), Some(false)], &[0; 9]);
        let html = drawn(&net.log);
        assert!(html.contains("at 77"), "{html}");
        assert!(html.contains("unit 2 (MOV-2): no answer on port 1"));
        assert_eq!(html.matches("log-row").count(), 1);
    }
}
